//! Bodies of a joint.

use jointsweep::internals::mechanics::body::{Body, MAX_PARAMETERS, SHAPES, Shape};
use jointsweep::internals::mechanics::material::Idealization;

pub use super::meshed_body::MeshedBody;

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
        all_around: false,
    }
}
