//! Joints on their way to a device and back: all threads make their numbers, and all threads judge what is found.

use foldhash::HashMap;
use rayon::prelude::*;

use crate::engine::accuracy::body_errors::OwnError;
use crate::engine::backend::joints::{
    BatchedJoint, CondensedBody, FoundState, JointBatch, JointTables, TablesKey,
};

/// Joints of condensed bodies that a thread takes at a time, to give them to a device or to judge what that has found.
pub const JOINTS_TOGETHER: usize = 128;

/// Numbers that there is room for at once, more than most joints have.
const NUMBERS_OF_JOINT: usize = 256;

/// A joint whose numbers are made, with what is kept of it until it is judged.
pub struct Given<'a, T> {
    pub tables: JointTables<'a>,
    pub load_count: u32,
    /// Numbers behind those of the loads.
    pub amplitude_count: u32,
    /// Of pin and plate, where the device condenses it.
    pub condensed: [Option<CondensedBody>; 2],
    pub kept: T,
}

impl<'a, T> Given<'a, T> {
    /// With something else that is kept.
    pub fn keeping<U>(self, kept: U) -> Given<'a, U> {
        let Given { tables, load_count, amplitude_count, condensed, .. } = self;
        Given { tables, load_count, amplitude_count, condensed, kept }
    }
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
        let mut portion = Portion::with_room_for(things.len());
        for thing in things {
            let at = portion.numbers.len();
            // Most have about as many as the first.
            if portion.kept.len() == 1 {
                portion.numbers.reserve(2 * at * things.len());
            }
            let given = give(thing, &mut portion.numbers);
            if given.is_none() {
                portion.numbers.truncate(at);
            }
            let own = given.map(|Given { tables, load_count, amplitude_count, condensed, kept }| {
                let (tables, numbers_at) = (portion.place_of(tables), at as u32);
                (kept, BatchedJoint { tables, numbers_at, load_count, amplitude_count, condensed })
            });
            portion.kept.push(own);
        }
        portion
    };
    // What is left to one thread is little: it says where numbers and tables of each portion are among all of them.
    let portions: Vec<_> = things.par_chunks(together).map(portion).collect();
    let mut batch = JointBatch::default();
    let mut places: HashMap<[TablesKey; 2], u32> = HashMap::default();
    let mut kept = Vec::with_capacity(things.len());
    for Portion { numbers, tables, kept: mut own } in portions {
        let place = |(key, tables): ([TablesKey; 2], JointTables<'a>)| {
            *places.entry(key).or_insert_with(|| {
                batch.tables.push(tables);
                batch.tables.len() as u32 - 1
            })
        };
        let tables: Vec<u32> = tables.into_iter().map(place).collect();
        let before = batch.numbers.count() as u32;
        for (_, joint) in own.iter_mut().flatten() {
            joint.tables = tables[joint.tables as usize];
            joint.numbers_at += before;
            batch.joints.push(*joint);
        }
        kept.append(&mut own);
        batch.numbers.push(numbers);
    }
    (batch, Underway { kept })
}

/// Joints of some things, with tables and numbers of their own.
struct Portion<'a, T> {
    numbers: Vec<f32>,
    /// Few: the joints of a portion have most in common.
    tables: Vec<([TablesKey; 2], JointTables<'a>)>,
    kept: Vec<Option<(T, BatchedJoint)>>,
}

impl<'a, T> Portion<'a, T> {
    fn with_room_for(joints: usize) -> Self {
        let (numbers, kept) = (Vec::with_capacity(NUMBERS_OF_JOINT), Vec::with_capacity(joints));
        Portion { numbers, tables: Vec::new(), kept }
    }

    /// Where tables are among its own, which they join if they are not there.
    fn place_of(&mut self, tables: JointTables<'a>) -> u32 {
        let key = tables.key();
        let known = self.tables.iter().position(|(known, _)| *known == key);
        known.unwrap_or_else(|| {
            self.tables.push((key, tables));
            self.tables.len() - 1
        }) as u32
    }
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
