//! Meshed and condensed bodies of a joint.

use jointsweep::internals::mechanics::assembly::Assembly;
use jointsweep::internals::mechanics::body::Body;
use jointsweep::internals::mechanics::compliance::RingCompliance;
use jointsweep::internals::mechanics::compliance::condense::by_cholesky;
use jointsweep::internals::mechanics::element::stiffness::Elasticity;
use jointsweep::internals::mechanics::lines::coordinates;
use jointsweep::internals::mechanics::mesh::{Grading, RingTopology};
use jointsweep::internals::mechanics::solve::cholesky::CholeskyAnalysis;

/// A body with its mesh.
pub struct MeshedBody {
    pub topology: RingTopology,
    pub coordinates: Vec<[f64; 2]>,
    pub elasticity: Elasticity<f64>,
    pub assembly: Assembly,
}

impl MeshedBody {
    pub fn new(body: &Body, grading: &Grading) -> MeshedBody {
        let topology = RingTopology::new(body, grading);
        let coordinates = coordinates(body, grading, &topology);
        let elasticity = Elasticity::new(body.idealization, body.poissons_ratio);
        let assembly = Assembly::of_ring(&topology);
        MeshedBody { topology, coordinates, elasticity, assembly }
    }

    pub fn stiffness_values(&self) -> Vec<f64> {
        self.assembly.stiffness_values(&self.elasticity, &self.coordinates).unwrap()
    }

    pub fn condense(&self) -> RingCompliance {
        let values = self.stiffness_values();
        let analysis = CholeskyAnalysis::new(self.assembly.matrix(&values)).unwrap();
        let ring_start = self.topology.ring_start;
        by_cholesky(&self.assembly, &analysis, ring_start, &self.elasticity, &self.coordinates).unwrap()
    }
}
