//! `annulus`: a plate with a concentric circular outer boundary, which is fixed.

use std::f64::consts::PI;

use super::{OfCorners, Shape, ShapeParameter, Side, THINNEST_RING};

pub static SHAPE: Shape = Shape {
    name: "annulus",
    side: Side::Plate,
    parameters: &[ShapeParameter {
        name: "outer_radius_ratio",
        default: None,
        above: 1.0,
        below: f64::INFINITY,
    }],
    supports: &[],
    end_angle: PI,
    end_face_held: false,
    depth: |&[ratio, ..], _| ratio.ln(),
    concentric: true,
    reaches_centre: false,
    corners: |_| OfCorners::new(),
    sides: &[],
    boundary_held: |_, _| true,
    depth_range: |&[ratio, ..]| (ratio.ln(), ratio.ln()),
    wall: "the wall of the annulus",
    thinnest_meshed: THINNEST_RING,
};
