//! `rigid-core`: the whole disc of the pin around a concentric rigid core that carries the motion.

use std::f64::consts::PI;

use super::{OfCorners, Shape, ShapeParameter, Side, THINNEST_RING};

pub static SHAPE: Shape = Shape {
    name: "rigid-core",
    side: Side::Pin,
    parameters: &[ShapeParameter { name: "core_radius_ratio", default: Some(0.1), above: 0.0, below: 1.0 }],
    supports: &[],
    end_angle: PI,
    end_face_held: false,
    depth: |&[core, ..], _| -core.ln(),
    concentric: true,
    reaches_centre: false,
    corners: |_| OfCorners::new(),
    sides: &[],
    boundary_held: |_, _| true,
    depth_range: |&[core, ..]| (-core.ln(), -core.ln()),
    wall: "the pin around its core",
    thinnest_meshed: THINNEST_RING,
};
