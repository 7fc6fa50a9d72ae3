//! The joint of Liu, Zhang & Yang (2007): steel in steel, plane stress, R2 = 100 mm, t = 1 mm, a plate fixed outside.

use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::Response;
use jointsweep::internals::mechanics::body::{Shape, annulus};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

pub const STEEL: Material = Material { youngs_modulus: 200e3, poissons_ratio: 0.3 };
pub const HOLE_RADIUS: f64 = 100.0;
/// Of the force: twenty times finer than the configs ask for.
pub const ACCURACY: f64 = 5e-5;

/// With a pin of `shape`, whose core is `core_radius_ratio` where it has one.
pub fn joint(
    shape: &'static Shape,
    core_radius_ratio: f64,
    outer_radius_ratio: f64,
    radial_clearance: f64,
) -> JointDesign {
    let part = |shape, ratio: f64| Part {
        shape,
        parameters: [ratio, 0.0, 0.0],
        support: 0,
        material: STEEL,
        layers: Default::default(),
        yield_stress: None,
    };
    JointDesign {
        idealization: Idealization::PlaneStress,
        hole_radius: HOLE_RADIUS,
        radial_clearance,
        thickness: 1.0,
        pin: part(shape, core_radius_ratio),
        plate: part(&annulus::SHAPE, outer_radius_ratio),
    }
}

/// Solves joints to an accuracy; keeps the bodies it has met.
pub struct Solver {
    backend: Ladder<'static>,
    accuracy: f64,
}

impl Solver {
    pub fn new(accuracy: f64) -> Solver {
        let options = SolveOptions { accuracy, method: MethodChoice::Auto };
        Solver { backend: Ladder::new(options), accuracy }
    }

    pub fn solve(&mut self, joint: JointDesign, load: Load) -> Response {
        let outcome =
            self.backend.solve(&[DesignCase { index: 0, joint, steps: vec![load].into() }]).remove(0);
        let step = &outcome.steps[0];
        let response = step.response.unwrap_or_else(|| panic!("{load:?}: {}", step.status));
        assert!(response.force_error <= self.accuracy, "{load:?}: {} {}", step.status, response.force_error);
        response
    }
}
