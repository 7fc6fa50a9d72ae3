//! `annulus`: a plate with a concentric circular outer boundary, which is fixed.

use super::{Shape, ShapeParameter, Side};

pub static SHAPE: Shape = Shape {
    name: "annulus",
    side: Side::Plate,
    parameters: &[ShapeParameter { name: "outer_radius_ratio", default: None, above: 1.0, below: f64::INFINITY }],
    supports: &[],
};
