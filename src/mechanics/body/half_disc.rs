//! `rigid-midplane`: the lower half disc of the pin, its flat face through the centre rigid, moving straight down.
//!
//! The pin of Liu, Zhang & Yang, Mechanism and Machine Theory 42 (2007) 183-197.

use std::f64::consts::FRAC_PI_2;

use super::{OfCorners, Shape, Side};

pub static SHAPE: Shape = Shape {
    name: "rigid-midplane",
    side: Side::Pin,
    parameters: &[],
    supports: &[],
    end_angle: FRAC_PI_2,
    end_face_held: true,
    depth: |_, _| CENTRE,
    concentric: false,
    reaches_centre: true,
    corners: |_| OfCorners::new(),
    sides: &[],
    boundary_held: |_, _| true,
    depth_range: |_| (CENTRE, CENTRE),
    wall: "the half disc",
    thinnest_meshed: 0.0,
};

/// The depth given to the centre: layers towards it end at about exp(-CENTRE).
const CENTRE: f64 = 1.5;
