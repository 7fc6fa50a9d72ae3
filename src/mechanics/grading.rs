//! How finely a body is divided: mesh levels, and the few classes into which bodies fall at each level.
//!
//! Contact is resolved by the trial pressures and the exact near field (`compliance::near_field`), not by the mesh;
//! the mesh only carries how a body differs from a concentric one, which is smooth. So the division follows the
//! body's own depth, not the contact angle, and one mesh serves every load. Depths are rounded to classes, so that
//! bodies of one class share their topology and the near-field correction.

use std::f64::consts::PI;

use crate::mechanics::body::Body;
use crate::mechanics::element::ElementKind;
use crate::mechanics::mesh::{Grading, layer_thicknesses};

/// One step on the ladder of resolutions.
#[derive(Clone, Copy, Debug)]
struct Level {
    /// Thickness of the first layer, and spacing of the ring at the load line, over the body's least depth (at most 1).
    first: f64,
    /// Ring spacing grows to angle/`spread` ...
    spread: f64,
    /// ... up to this, degrees.
    widest: f64,
    /// The most by which a layer may exceed the one before, and its outer radius its inner one.
    growth: f64,
}

const LEVELS: [Level; 6] = [
    Level { first: 0.40, spread: 1.5, widest: 45.0, growth: 2.2 },
    Level { first: 0.30, spread: 2.0, widest: 36.0, growth: 2.0 },
    Level { first: 0.20, spread: 2.5, widest: 24.0, growth: 1.55 },
    Level { first: 0.13, spread: 3.5, widest: 16.0, growth: 1.45 },
    Level { first: 0.085, spread: 5.0, widest: 11.0, growth: 1.3 },
    Level { first: 0.055, spread: 7.0, widest: 7.5, growth: 1.2 },
];

/// Levels there are, coarsest first.
pub const LEVEL_COUNT: usize = LEVELS.len();

/// More layers than any depth that a number can hold needs at any level, with room to spare.
const MOST_LAYERS: usize = 10_000;

/// Bodies deeper than this are not thin.
const THICK: f64 = 0.7;

/// Classes of depth per factor of two.
const CLASSES_PER_OCTAVE: f64 = 2.0;

/// The class of a body at a level. Bodies of one class have the same first layer, layer count and ring angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GradingClass {
    pub level: usize,
    pub element: ElementKind,
    /// The least depth is at least 2^(-depth_class/2), or 1 for class 0.
    pub depth_class: u32,
    pub layer_count: usize,
}

impl GradingClass {
    /// The class of `body` at `level` (below `LEVEL_COUNT`).
    pub fn of(body: &Body, element: ElementKind, level: usize) -> GradingClass {
        let (least, greatest) = (body.shape.depth_range)(&body.parameters);
        let depth_class = (-CLASSES_PER_OCTAVE * least.log2()).ceil().max(0.0) as u32;
        let mut class = GradingClass { level, element, depth_class, layer_count: 2 };
        while class.depth_at_growth(LEVELS[level].growth) < greatest && class.layer_count < MOST_LAYERS {
            class.layer_count += 1;
        }
        class
    }

    /// The depth that stands for the class: a lower bound, at most 1.
    fn class_depth(&self) -> f64 {
        (-f64::from(self.depth_class) / CLASSES_PER_OCTAVE).exp2()
    }

    /// Thickness of the first layer in the shape's measure of depth.
    pub fn first_layer(&self) -> f64 {
        LEVELS[self.level].first * self.class_depth()
    }

    fn thickest_layer(&self) -> f64 {
        LEVELS[self.level].growth.ln().max(self.first_layer())
    }

    fn depth_at_growth(&self, growth: f64) -> f64 {
        layer_thicknesses(self.first_layer(), self.thickest_layer(), growth).take(self.layer_count).sum()
    }

    /// Depth of the concentric body that stands for the class: its layers grow a little less than allowed.
    pub fn nominal_depth(&self) -> f64 {
        self.depth_at_growth(0.93 * LEVELS[self.level].growth)
    }

    /// The division of a ring that ends at `end_angle`.
    pub fn grading(&self, end_angle: f64) -> Grading {
        let Level { spread, widest, .. } = LEVELS[self.level];
        // A thin body answers locally, so its ring is divided evenly finer; by no more than three, where it is nearly
        // a Winkler bed, whose answer needs no resolution.
        let thinness = (self.class_depth() / THICK).clamp(1.0 / 3.0, 1.0);
        // The end of a half ring is a corner between a free and a held side, which contact may come near.
        let evenness = if end_angle < PI { thinness.min(0.4) } else { thinness };
        let widest = evenness * widest.to_radians();
        let mut angles = vec![0.0];
        let mut reached = 0.0;
        while reached < end_angle - 1e-9 {
            reached += (reached / spread).max(self.first_layer()).min(widest);
            angles.push(reached);
        }
        // Drop the last when its element would mostly lie beyond the end, then stretch, least near the load line.
        let overshoot = reached - end_angle;
        if angles.len() > 3 && overshoot > 0.5 * (reached - angles[angles.len() - 2]) {
            angles.pop();
        }
        let last = angles[angles.len() - 1];
        let stretch = end_angle / last - 1.0;
        angles.iter_mut().for_each(|angle| *angle *= 1.0 + stretch * *angle / last);
        let count = angles.len();
        angles[count - 1] = end_angle;
        Grading {
            element: self.element,
            angles,
            first_layer: self.first_layer(),
            thickest_layer: self.thickest_layer(),
            layer_count: self.layer_count,
        }
    }
}
