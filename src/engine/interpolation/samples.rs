//! Samples of a family: solved, and what they cost.

use crate::engine::accuracy::known_errors::known_level;
use crate::engine::bodies::BodyLibrary;
use crate::engine::body_request::{BodyRequest, Fidelity, mesh_class, mesh_size};
use crate::engine::interpolation::basis::Basis;
use crate::engine::interpolation::family::{Family, MOST_COORDINATES, body_at};
use crate::engine::interpolation::points::DEGREES;
use crate::engine::plan::first_level;
use crate::engine::unit_costs::{Time, body_seconds, topology};
use crate::mechanics::compliance::ring_modes::RingModes;

/// Share of the lanes that samples of a box with so many coordinates fill, about.
const LANES_FILLED: [f64; MOST_COORDINATES + 1] = [0.2, 0.8, 0.7, 0.6, 0.4];

/// Topologies that a box with so many coordinates meets on two meshes, about.
const TOPOLOGIES: [f64; MOST_COORDINATES + 1] = [2.0, 20.0, 30.0, 60.0, 120.0];

/// Of meshes whose error is known: a fit must also take the steps where, from shape to shape, they get a layer more.
const KNOWN_SHARE: f64 = 0.25;

/// The finest mesh of a sample.
pub(super) const FINEST: usize = 4;

/// Bodies that a library is asked for at a time.
const BATCH: usize = 1024;

/// On which meshes samples are solved.
pub(super) struct Meshes {
    pub(super) first: usize,
    /// Whether their error is: no coarser mesh must tell it.
    pub(super) known: bool,
}

/// What a fit has taken so far.
#[derive(Default)]
pub(super) struct Expense {
    pub(super) bodies: u64,
    /// By `unit_costs`.
    pub(super) seconds: f64,
}

impl Expense {
    pub(super) fn add(&mut self, family: &Family, bodies: usize, level: usize) {
        self.bodies += bodies as u64;
        self.seconds += bodies as f64 * family.sample_seconds(level);
    }
}

impl Family {
    /// What bodies at points change at their boundary, in terms of a basis.
    pub(super) fn solve(
        &self,
        library: &mut BodyLibrary,
        points: &[Vec<f64>],
        fidelity: Fidelity,
        basis: &Basis,
    ) -> Vec<Vec<f64>> {
        let mut solved = Vec::with_capacity(points.len());
        for points in points.chunks(BATCH) {
            let requests: Vec<BodyRequest> = points
                .iter()
                .map(|point| BodyRequest { body: body_at(&self.example, point), fidelity })
                .collect();
            library.solve(&requests);
            solved.extend(basis.numbers(requests.iter().map(|request| &library.solved(request).compliance)));
        }
        solved
    }

    pub(super) fn fidelity(&self, level: usize) -> Fidelity {
        if self.exact { Fidelity::Series } else { Fidelity::Mesh { level } }
    }

    /// The meshes of the samples: the first that are known to do all over the box, else one finer than a design would begin with.
    pub(super) fn meshes(&self, accuracy: f64) -> Meshes {
        if self.exact {
            return Meshes { first: 0, known: true };
        }
        let levels = self
            .held_out_points()
            .into_iter()
            .map(|point| known_level(&body_at(&self.example, &point), KNOWN_SHARE * accuracy));
        match levels.max_by_key(|level| level.unwrap_or(usize::MAX)).flatten() {
            Some(first) => Meshes { first, known: true },
            None => Meshes { first: (first_level(accuracy) + 1).min(FINEST), known: false },
        }
    }

    /// Estimated time of one sample, s.
    fn sample_seconds(&self, level: usize) -> f64 {
        let filled = if self.exact { 1.0 } else { LANES_FILLED[self.free()] };
        body_seconds(&BodyRequest { body: self.example.clone(), fidelity: self.fidelity(level) }) / filled
    }

    /// Estimated time of one topology of samples, s.
    fn topology_seconds(&self, level: usize) -> f64 {
        let modes = RingModes::of(&mesh_class(&self.example, level)).count;
        topology(mesh_size(&self.example, level), modes).seconds()
    }

    /// Estimated time of the first fit.
    pub fn least_time(&self, accuracy: f64) -> Time {
        let Meshes { first: level, known } = self.meshes(accuracy);
        let free = self.free();
        let samples = self.sample_points_with(self.sample_count(DEGREES[free][0]));
        let held_out = self.held_out_points().len() as f64;
        let coarse = if known { 0.0 } else { held_out * self.sample_seconds(level - 1) };
        let in_lanes = (samples as f64 + held_out) * self.sample_seconds(level) + coarse;
        let others = if self.exact { 0.0 } else { TOPOLOGIES[free] * self.topology_seconds(level) };
        Time { in_lanes, others }
    }
}
