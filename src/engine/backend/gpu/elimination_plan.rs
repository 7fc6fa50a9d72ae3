//! How bodies of many topologies are cut into dispatches of `assemble` and `eliminate`: pure arithmetic.
//!
//! ```text
//!   jobs         A A A A A A A B B B C C C C C      bodies of a topology each; those with fronts on chip first, small ones before large ones
//!   steps        |----- 0 -----|------ 1 -----|     as many bodies as one dispatch of `assemble` takes, then one of `eliminate` for each
//!                                                   size of fronts
//!   flight       |-------------- 0 -----------|     as many steps as travel together: one wait
//! ```

use std::ops::Range;

use bytemuck::Pod;

use super::batch::TARGET;
use super::context::DeviceLimits;
use super::dispatch::ALIGNMENT;
use super::front::{EliminateParameters, Front};
use super::front_topology::{FrontTopology, Job};
use super::layout::AssembleParameters;
use super::shared_data::SharedBuffers;

/// What a plan must keep to.
pub(super) struct Room<'a> {
    pub limits: &'a DeviceLimits,
    /// Of what the bodies of a step need while they are worked on, bytes.
    pub scratch: u64,
    /// Of what a flight takes up and down, bytes.
    pub travelling: u64,
    /// Time of a product of tiles, s.
    pub pace: f64,
    /// Bytes of a wide number.
    pub wide: u64,
}

/// How far the bodies of jobs are planned: all before this place in the order, and so many bodies of the job there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cursor {
    pub place: usize,
    pub body: usize,
}

/// Bodies of a job in a step.
pub(super) struct Piece {
    pub job: usize,
    pub bodies: Range<usize>,
    /// Bytes of their works in the flight.
    pub works: Range<u64>,
}

/// Bodies of one dispatch of `eliminate`.
pub(super) struct FrontStep {
    /// Of each of its topologies: the smaller it is, the more workgroups the device works on at a time.
    pub front: Front,
    pub bodies: u32,
    pub topologies: Vec<EliminateParameters>,
    /// Bytes of those in the flight.
    pub topology_bytes: Range<u64>,
}

/// Bodies of one dispatch of `assemble`.
pub(super) struct Step {
    pub shared: SharedBuffers,
    pub pieces: Vec<Piece>,
    pub bodies: u32,
    pub topologies: Vec<AssembleParameters>,
    /// Bytes of those in the flight.
    pub topology_bytes: Range<u64>,
    /// Of each size of fronts, those on chip before those in storage.
    pub fronts: Vec<FrontStep>,
    /// Products of tiles.
    pub products: u64,
    /// Bytes of numbers and of works in the flight.
    pub numbers: Range<u64>,
    pub works: Range<u64>,
    /// Bytes of geometry, values, states and of fronts in storage.
    pub scratch: [u64; 4],
}

/// Steps that travel together.
#[derive(Default)]
pub(super) struct FlightPlan {
    pub steps: Vec<Step>,
    /// Bytes up and down: of numbers, of the topologies of all dispatches, and of works.
    pub numbers: u64,
    pub topologies: Vec<u8>,
    pub works: u64,
}

/// The order in which jobs are planned: what shares buffers and has fronts of one kind side by side.
pub(super) fn order(jobs: &[Job]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..jobs.len()).filter(|job| jobs[*job].count() > 0).collect();
    order.sort_by_key(|job| {
        let FrontTopology { shared, front, .. } = &jobs[*job].topology;
        (shared.number, !front.is_on_chip, front.rows)
    });
    order
}

impl FlightPlan {
    /// As much of what is left as travels together, at least one body; moves the cursor behind it.
    pub fn next(jobs: &[Job], order: &[usize], cursor: &mut Cursor, room: &Room) -> FlightPlan {
        let mut plan = FlightPlan::default();
        while let Some(&job) = order.get(cursor.place) {
            let mut step = Step::new(&jobs[job].topology, &plan);
            while let Some(&job) = order.get(cursor.place) {
                let Job { topology, .. } = &jobs[job];
                let left = jobs[job].count() - cursor.body;
                let mut bodies = step.room_for(topology, room).min(left as u64) as usize;
                if bodies == 0 && step.bodies == 0 && plan.steps.is_empty() {
                    bodies = 1;
                }
                if bodies == 0 {
                    break;
                }
                step.add(job, topology, cursor.body..cursor.body + bodies, room.wide);
                cursor.body += bodies;
                if bodies == left {
                    *cursor = Cursor { place: cursor.place + 1, body: 0 };
                }
            }
            if step.bodies == 0 {
                break;
            }
            plan.add(step);
        }
        plan
    }

    fn add(&mut self, mut step: Step) {
        step.topology_bytes = placed(&mut self.topologies, &step.topologies);
        for front in &mut step.fronts {
            front.topology_bytes = placed(&mut self.topologies, &front.topologies);
        }
        (self.numbers, self.works) = (step.numbers.end, step.works.end);
        self.steps.push(step);
    }
}

/// Adds parameters from the next place where a binding may begin; gives back their bytes.
fn placed<T: Pod>(all: &mut Vec<u8>, parameters: &[T]) -> Range<u64> {
    all.resize(all.len().next_multiple_of(ALIGNMENT as usize), 0);
    let first = all.len() as u64;
    all.extend_from_slice(bytemuck::cast_slice(parameters));
    first..all.len() as u64
}

impl Step {
    /// Without bodies, after those of a plan.
    fn new(topology: &FrontTopology, plan: &FlightPlan) -> Step {
        let [numbers, works] = [plan.numbers, plan.works].map(|end| end.next_multiple_of(ALIGNMENT));
        Step {
            shared: topology.shared.clone(),
            pieces: Vec::new(),
            bodies: 0,
            topologies: Vec::new(),
            topology_bytes: 0..0,
            fronts: Vec::new(),
            products: 0,
            numbers: numbers..numbers,
            works: works..works,
            scratch: [0; 4],
        }
    }

    /// How many more bodies of a topology it takes. One of them may take longer than a dispatch should, if it is the only one.
    fn room_for(&self, topology: &FrontTopology, room: &Room) -> u64 {
        if self.shared != topology.shared {
            return 0;
        }
        let (mut used, of_body) = (self.scratch, topology.scratch);
        // Fronts of one size follow each other in storage; those of another begin there anew.
        let alike = self.fronts.last().filter(|last| last.front == topology.front);
        used[3] = alike.map_or(0, |last| u64::from(last.bodies) * of_body[3]);
        let [up, down] = topology.travelling;
        let buffer = room.limits.bound_buffer();
        let left = |most: u64, used: u64, of_body: u64| most.saturating_sub(used) / of_body.max(1);
        let in_buffers = used.iter().zip(&of_body).map(|(used, of_body)| left(buffer, *used, *of_body));
        let most_seconds = TARGET.as_secs_f64() - room.pace * self.products as f64;
        let in_time = (most_seconds / (room.pace * topology.tile_products as f64)) as u64;
        let others = [
            left(room.scratch, self.scratch.iter().sum::<u64>().max(used.iter().sum()), of_body.iter().sum()),
            left(buffer, self.numbers.end - self.numbers.start, up),
            left(buffer, self.works.end - self.works.start, down),
            // Works are in a buffer of the device and in one that the host reads.
            left(room.travelling, self.numbers.end + 2 * self.works.end, up + 2 * down),
            u64::from(room.limits.workgroups_per_dimension - self.bodies),
            if self.bodies == 0 { in_time.max(1) } else { in_time },
        ];
        in_buffers.chain(others).min().unwrap_or(0)
    }

    fn add(&mut self, job: usize, topology: &FrontTopology, bodies: Range<usize>, wide: u64) {
        let count = bodies.len() as u64;
        let [up, down] = topology.travelling.map(|of_body| count * of_body);
        let wides = |bytes: u64| (bytes / wide) as u32;
        let [geometry, values, ..] = self.scratch;
        let (values_at, states_at) = (wides(values), self.bodies);
        self.topologies.push(AssembleParameters {
            first_body: self.bodies,
            bodies_at: wides(self.numbers.end - self.numbers.start),
            // In fours.
            geometry_at: wides(geometry) / 4,
            values_at,
            states_at,
            ..topology.assembly
        });
        let works_at = wides(self.works.end - self.works.start);
        let is_alike = |last: &FrontStep| last.front == topology.front;
        if !self.fronts.last().is_some_and(is_alike) {
            let front = topology.front;
            self.fronts.push(FrontStep { front, bodies: 0, topologies: Vec::new(), topology_bytes: 0..0 });
        }
        let last = self.fronts.len() - 1;
        let front = &mut self.fronts[last];
        front.topologies.push(EliminateParameters {
            first_body: front.bodies,
            // In fours.
            values_at: values_at / 4,
            states_at,
            works_at,
            ..topology.elimination
        });
        front.bodies += count as u32;
        let in_storage = u64::from(front.bodies) * front.front.storage_bytes(wide);
        self.scratch[..3].iter_mut().zip(topology.scratch).for_each(|(all, of_body)| *all += count * of_body);
        self.scratch[3] = self.scratch[3].max(in_storage);
        self.pieces.push(Piece { job, bodies, works: self.works.end..self.works.end + down });
        self.bodies += count as u32;
        self.products += count * topology.tile_products;
        self.numbers.end += up;
        self.works.end += down;
    }
}
