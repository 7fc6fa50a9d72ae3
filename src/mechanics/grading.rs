//! How finely a body is divided: mesh levels, and the few classes into which bodies fall at each level.
//!
//! Contact is resolved by the trial pressures and the exact near field (`compliance::near_field`), not by the mesh;
//! the mesh only carries how a body differs from a concentric one, which is smooth. So the division follows the
//! body's own depth, not the contact angle, and one mesh serves every load. Depths are rounded to classes, so that
//! bodies of one class share their topology and the near-field correction.

use std::f64::consts::PI;

use crate::mechanics::body::Body;
use crate::mechanics::element::ElementKind;
use crate::mechanics::mesh::{Grading, Layers};

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

const LEVELS: [Level; LEVEL_COUNT + 1] = [
    Level { first: 0.40, spread: 1.5, widest: 45.0, growth: 2.2 },
    Level { first: 0.30, spread: 2.0, widest: 36.0, growth: 2.0 },
    Level { first: 0.20, spread: 2.5, widest: 24.0, growth: 1.55 },
    Level { first: 0.13, spread: 3.5, widest: 16.0, growth: 1.45 },
    Level { first: 0.085, spread: 5.0, widest: 11.0, growth: 1.3 },
    Level { first: 0.055, spread: 7.0, widest: 7.5, growth: 1.2 },
    Level { first: 0.036, spread: 10.0, widest: 5.0, growth: 1.13 },
];

/// Levels a sweep may climb, coarsest first.
pub const LEVEL_COUNT: usize = 6;

/// One finer than all of them, to measure them by.
pub const REFERENCE_LEVEL: usize = LEVEL_COUNT;

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
    /// Whether the far boundary has corners, where the stress may be singular.
    pub cornered: bool,
}

/// Thickness of the layer at a boundary with corners, over what its growth makes it.
const LAST_LAYER: f64 = 0.5;

impl GradingClass {
    /// The class of `body` at `level` (below `LEVEL_COUNT`, or `REFERENCE_LEVEL`).
    pub fn of(body: &Body, element: ElementKind, level: usize) -> GradingClass {
        let (least, greatest) = (body.shape.depth_range)(&body.parameters);
        let depth_class = (-CLASSES_PER_OCTAVE * least.log2()).ceil().max(0.0) as u32;
        let cornered = !body.shape.sides.is_empty();
        let mut class = GradingClass { level, element, depth_class, layer_count: 2, cornered };
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

    /// Depth of all layers, each `growth` times as thick as the one before.
    pub fn depth_at_growth(&self, growth: f64) -> f64 {
        self.layers().depth(growth)
    }

    pub fn layers(&self) -> Layers {
        Layers {
            first: self.first_layer(),
            thickest: self.thickest_layer(),
            count: self.layer_count,
            last: if self.cornered { LAST_LAYER } else { 1.0 },
        }
    }

    /// The class of a body without corners of the same layers, as many as reach a depth when they grow so.
    pub fn cut_at(&self, depth: f64, growth: f64) -> GradingClass {
        let mut cut = GradingClass { layer_count: 2, cornered: false, ..*self };
        while cut.layer_count < self.layer_count && cut.depth_at_growth(growth) < depth {
            cut.layer_count += 1;
        }
        cut
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
        Grading { element: self.element, angles, layers: self.layers() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::body::{annulus, block, cored_disc, half_disc};
    use crate::mechanics::material::Idealization;

    fn body(shape: &'static crate::mechanics::body::Shape, parameters: [f64; 3]) -> Body {
        Body { shape, parameters, support: 0, poissons_ratio: 0.3, idealization: Idealization::PlaneStress }
    }

    /// Bodies of all shapes, ratios from 1.001 to 1e4 in uneven steps.
    fn bodies() -> Vec<Body> {
        let ratio = |i: usize| 1.001 * 1e4_f64.powf((i as f64 * 0.618_034).fract());
        let mut bodies = vec![body(&half_disc::SHAPE, [0.0; 3])];
        for i in 0..200 {
            bodies.push(body(&annulus::SHAPE, [ratio(i), 0.0, 0.0]));
            bodies.push(body(&cored_disc::SHAPE, [1.0 / ratio(i), 0.0, 0.0]));
            bodies.push(body(&block::SHAPE, [ratio(i), ratio(3 * i + 1), ratio(5 * i + 2)]));
        }
        bodies
    }

    fn all(check: impl Fn(&Body, &Level, &GradingClass)) {
        for body in bodies() {
            for (level, of_level) in LEVELS.iter().enumerate() {
                check(&body, of_level, &GradingClass::of(&body, ElementKind::Quad8, level));
            }
        }
    }

    /// The first layer is the level's share of the body's least depth, rounded down by less than half an octave.
    #[test]
    fn the_first_layer_fits_the_thinnest_place() {
        all(|body, level, class| {
            let least = (body.shape.depth_range)(&body.parameters).0.min(1.0);
            let share = class.first_layer() / (level.first * least);
            assert!(share <= 1.0 + 1e-12 && share > 0.5_f64.sqrt() - 1e-12, "{body:?}: {share}");
        });
    }

    /// There are as many layers as the deepest place needs, no more.
    #[test]
    fn layers_reach_the_deepest_place() {
        all(|body, level, class| {
            let depth = (body.shape.depth_range)(&body.parameters).1;
            let fewer = GradingClass { layer_count: class.layer_count - 1, ..*class };
            let (reached, before) =
                (class.depth_at_growth(level.growth), fewer.depth_at_growth(level.growth));
            assert!(reached >= depth && (class.layer_count == 2 || before < depth), "{body:?} {class:?}");
            // Cut short, they reach no less than asked.
            let cut = class.cut_at(0.5 * depth, level.growth);
            assert!(
                cut.layer_count <= class.layer_count && cut.depth_at_growth(level.growth) >= 0.5 * depth,
                "{body:?} {class:?}: {cut:?}"
            );
        });
    }

    /// Layers are as thick as their place asks: no outer radius is more than `growth` times its inner one.
    #[test]
    fn layers_keep_their_proportions() {
        all(|body, level, class| {
            let Layers { first, thickest, last, .. } = class.grading(body.shape.end_angle).layers;
            assert_eq!(first, class.first_layer());
            assert_eq!(thickest, first.max(level.growth.ln()));
            assert_eq!(last, if body.shape.name == "block" { 0.5 } else { 1.0 });
        });
    }

    /// Ring angles ascend from 0 to the end, spaced by the rule but for the stretch that makes them fit: by half of
    /// an element at most, which its neighbours share.
    #[test]
    fn ring_angles_follow_the_rule_to_the_end() {
        all(|body, level, class| {
            let end = body.shape.end_angle;
            let angles = class.grading(end).angles;
            assert_eq!((angles[0], angles[angles.len() - 1]), (0.0, end));
            let depth = 2.0_f64.powf(-0.5 * f64::from(class.depth_class));
            let evenness = (depth / 0.7).clamp(1.0 / 3.0, if end < PI { 0.4 } else { 1.0 });
            let widest = evenness * level.widest.to_radians();
            for pair in angles.windows(2) {
                let rule = (pair[0] / level.spread).max(class.first_layer()).min(widest);
                let share = (pair[1] - pair[0]) / rule;
                assert!((0.75..1.3).contains(&share), "{body:?} {class:?}: {share} at {}", pair[0]);
            }
            // The load line is where narrow contacts are.
            assert!((angles[1] / class.first_layer().min(widest) - 1.0).abs() < 0.05, "{body:?} {class:?}");
        });
    }

    /// Nearby bodies share a class, bodies half as deep do not; finer levels are finer in every way.
    #[test]
    fn classes_are_few_and_levels_ordered() {
        let class = |ratio: f64, level| {
            GradingClass::of(&body(&annulus::SHAPE, [ratio, 0.0, 0.0]), ElementKind::Quad8, level)
        };
        for level in 0..LEVEL_COUNT {
            assert_eq!(class(1.30, level), class(1.31, level));
            assert_ne!(class(1.30, level), class(1.14, level));
            // A little deeper than where a class ends.
            let depths = |octaves: i32| class((1.1 * 2_f64.powi(-octaves)).exp(), level).depth_class;
            assert_eq!([0, 1, 2, 10].map(depths), [0, 2, 4, 20]);
        }
        for level in 1..LEVEL_COUNT {
            for ratio in [1.001, 1.3, 3.0, 1e4] {
                let [coarse, fine] = [level - 1, level].map(|level| class(ratio, level));
                assert!(fine.first_layer() < coarse.first_layer());
                assert!(fine.layer_count >= coarse.layer_count);
                assert!(fine.grading(PI).angles.len() > coarse.grading(PI).angles.len());
            }
        }
    }
}
