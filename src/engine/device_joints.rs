//! Joints on their way to a device and back: all threads make their numbers, and all threads judge what is found.

use foldhash::HashMap;
use rayon::prelude::*;

use crate::engine::accuracy::body_errors::OwnError;
use crate::engine::backend::joints::{BatchedJoint, FoundState, JointBatch, JointTables, TablesKey};

/// A joint whose numbers are made, with what is kept of it until it is judged.
pub struct Given<'a, T> {
    pub tables: JointTables<'a>,
    pub load_count: u32,
    pub kept: T,
}

/// Joints that a device has, of some things in their order; nothing for those that it has not.
pub struct Underway<T> {
    kept: Vec<Option<(T, BatchedJoint)>>,
}

/// The joints of things, so many of these to a thread at a time. `give` adds the numbers of one, if it has a joint for the device.
pub fn gathered<'a, I: Sync, T: Send>(
    things: &[I],
    together: usize,
    give: impl Fn(&I, &mut Vec<f32>) -> Option<Given<'a, T>> + Sync,
) -> (JointBatch<'a>, Underway<T>) {
    let portion = |things: &[I]| {
        let mut numbers = Vec::new();
        let mut given = Vec::with_capacity(things.len());
        for thing in things {
            let at = numbers.len();
            let own = give(thing, &mut numbers);
            if own.is_none() {
                numbers.truncate(at);
            }
            given.push((own, at));
        }
        (numbers, given)
    };
    let portions: Vec<_> = things.par_chunks(together).map(portion).collect();
    let mut batch = JointBatch::default();
    let mut places: HashMap<[TablesKey; 2], u32> = HashMap::default();
    let mut kept = Vec::with_capacity(things.len());
    batch.numbers.reserve(portions.iter().map(|(numbers, _)| numbers.len()).sum());
    for (numbers, given) in portions {
        let before = batch.numbers.len();
        batch.numbers.extend(numbers);
        for (given, at) in given {
            kept.push(given.map(|Given { tables, load_count, kept }| {
                let place = *places.entry(tables.key()).or_insert_with(|| {
                    batch.tables.push(tables);
                    batch.tables.len() as u32 - 1
                });
                let joint = BatchedJoint { tables: place, numbers_at: (before + at) as u32, load_count };
                batch.joints.push(joint);
                (kept, joint)
            }));
        }
    }
    (batch, Underway { kept })
}

/// The relative errors of the force that bodies leave, each by its share of the work: as `BodyErrors::at`.
pub fn errors_of_bodies(errors: &[OwnError; 2], found: &FoundState) -> [f64; 2] {
    let of_bodies = errors.iter().zip(found.shares());
    of_bodies.fold([0.0; 2], |[of_bodies, of_beds], (own, share)| {
        let [of_body, of_bed] = own.at(found.state.half_angle);
        [of_bodies + share * of_body, of_beds + share * of_bed]
    })
}

impl<T> Underway<T> {
    /// Of each thing whether the device has a joint of it.
    pub fn are_there(&self) -> impl Iterator<Item = bool> {
        self.kept.iter().map(Option::is_some)
    }
}

impl<T: Send> Underway<T> {
    /// What is made of that which a device has found of the joints of these things; nothing of those that it has not.
    pub fn judged<I: Sync, R: Send>(
        self,
        things: &[I],
        together: usize,
        found: &[f32],
        judge: impl Fn(&I, T, &[f32]) -> Option<R> + Sync,
    ) -> Vec<Option<R>> {
        let mut left = found;
        let with_found = |kept: Option<(T, BatchedJoint)>| {
            let (kept, joint) = kept?;
            let (own, others) = left.split_at_checked(joint.found())?;
            left = others;
            Some((kept, own))
        };
        let kept: Vec<Option<(T, &[f32])>> = self.kept.into_iter().map(with_found).collect();
        let judge = |(thing, kept): (&I, Option<(T, &[f32])>)| {
            let (kept, found) = kept?;
            judge(thing, kept, found)
        };
        things.par_iter().with_min_len(together).zip(kept).map(judge).collect()
    }
}
