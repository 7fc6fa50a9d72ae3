//! `rigid-core`: the whole disc of the pin around a concentric rigid core that carries the motion.

use super::{Shape, ShapeParameter, Side};

pub static SHAPE: Shape = Shape {
    name: "rigid-core",
    side: Side::Pin,
    parameters: &[ShapeParameter { name: "core_radius_ratio", default: Some(0.1), above: 0.0, below: 1.0 }],
    supports: &[],
};
