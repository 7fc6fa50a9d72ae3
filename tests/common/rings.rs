//! Meshed and condensed bodies of a joint.

use jointsweep::internals::mechanics::assembly::Assembly;
use jointsweep::internals::mechanics::body::{Body, MAX_PARAMETERS, SHAPES, Shape};
use jointsweep::internals::mechanics::compliance::RingCompliance;
use jointsweep::internals::mechanics::compliance::condense::by_cholesky;
use jointsweep::internals::mechanics::element::stiffness::Elasticity;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::mesh::{Grading, RingTopology, coordinates};
use jointsweep::internals::mechanics::solve::cholesky::CholeskyAnalysis;

pub fn shape(name: &str) -> &'static Shape {
    SHAPES.into_iter().find(|shape| shape.name == name).unwrap()
}

pub fn body(name: &str, ratios: &[f64], idealization: Idealization, poissons_ratio: f64) -> Body {
    let mut parameters = [0.0; MAX_PARAMETERS];
    parameters[..ratios.len()].copy_from_slice(ratios);
    Body {
        shape: shape(name),
        parameters,
        support: 0,
        poissons_ratio,
        idealization,
        lining: Default::default(),
    }
}

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
