//! `block`: a rectangular plate around the hole, held at its bottom edge or at its bottom, sides and top.

use super::{Shape, ShapeParameter, Side};

const fn ratio(name: &'static str) -> ShapeParameter {
    ShapeParameter { name, default: None, above: 1.0, below: f64::INFINITY }
}

pub static SHAPE: Shape = Shape {
    name: "block",
    side: Side::Plate,
    parameters: &[ratio("half_width_ratio"), ratio("depth_ratio"), ratio("height_ratio")],
    supports: &["base", "outer"],
};
