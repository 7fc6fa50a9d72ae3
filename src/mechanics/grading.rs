//! How finely a body is divided: mesh levels, and the few classes into which bodies fall at each level.
//!
//! Contact is resolved by the trial pressures and the exact near field (`compliance::near_field`), not by the mesh;
//! the mesh only carries how a body differs from a concentric one, which is smooth. So the division follows the
//! body's own depth, not the contact angle, and one mesh serves every load. Depths are rounded to classes, so that
//! bodies of one class share their topology and the near-field correction.

use crate::mechanics::body::Body;
use crate::mechanics::element::ElementKind;
use crate::mechanics::layers::{Layers, SHRINK};
use crate::mechanics::material::Idealization;
use crate::mechanics::mesh::{Grading, holding_changes};

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
    /// Layers that shrink towards a far boundary with corners where the holding changes.
    shrinking: usize,
}

const LEVELS: [Level; LEVEL_COUNT + 1] = [
    Level { first: 0.40, spread: 1.5, widest: 45.0, growth: 2.2, shrinking: 2 },
    Level { first: 0.30, spread: 2.0, widest: 36.0, growth: 2.0, shrinking: 2 },
    Level { first: 0.20, spread: 2.7, widest: 26.0, growth: 1.7, shrinking: 3 },
    Level { first: 0.13, spread: 2.8, widest: 22.0, growth: 1.45, shrinking: 4 },
    Level { first: 0.085, spread: 3.8, widest: 13.0, growth: 1.3, shrinking: 4 },
    Level { first: 0.055, spread: 7.0, widest: 7.5, growth: 1.2, shrinking: 4 },
    Level { first: 0.036, spread: 10.0, widest: 5.0, growth: 1.13, shrinking: 5 },
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
    /// Layers that shrink towards the far boundary.
    pub shrinking: usize,
    /// Whether the ring ends where a held face begins: a corner that contact may come near.
    pub ends_held: bool,
}

/// How a ring that ends held is divided towards its end: its widest spacing and its first layer over those of a whole ring, and
/// so many more elements at the end that shrink.
const WIDEST_ENDS_HELD: f64 = 0.8;
const FIRST_ENDS_HELD: f64 = 0.6;
const SHRINKING_AT_HELD_END: usize = 3;

/// Stiff bodies have stronger singularities, and so many more layers that shrink from this level on; before it there are as
/// many as f32 bears.
const MORE_WHERE_STIFF: usize = 2;
const STIFF_LEVEL: usize = 2;

/// In plane strain from here on, beside the shear modulus.
pub const STIFF: f64 = 0.42;

fn is_stiff(body: &Body) -> bool {
    body.idealization == Idealization::PlaneStrain && body.poissons_ratio > STIFF
}

impl GradingClass {
    /// The class of `body` at `level` (below `LEVEL_COUNT`, or `REFERENCE_LEVEL`).
    pub fn of(body: &Body, element: ElementKind, level: usize) -> GradingClass {
        let (least, greatest) = body.depth_range();
        let depth_class = (-CLASSES_PER_OCTAVE * least.log2()).ceil().max(0.0) as u32;
        let corners = body.shape.sides.len().saturating_sub(1);
        let shrinking = match (0..corners).any(|corner| holding_changes(body, corner)) {
            true if is_stiff(body) && level >= STIFF_LEVEL => LEVELS[level].shrinking + MORE_WHERE_STIFF,
            true => LEVELS[level].shrinking,
            // Stresses are high in any corner.
            false => corners.min(1),
        };
        let ends_held = body.shape.end_face_held;
        let mut class = GradingClass { level, element, depth_class, layer_count: 2, shrinking, ends_held };
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
        let part = if self.ends_held { FIRST_ENDS_HELD } else { 1.0 };
        part * LEVELS[self.level].first * self.class_depth()
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
            shrinking: self.shrinking,
        }
    }

    /// The class of a body with a round boundary of the same layers, as many as reach a depth when they grow so.
    pub fn cut_at(&self, depth: f64, growth: f64) -> GradingClass {
        let mut cut = GradingClass { layer_count: 2, shrinking: 0, ..*self };
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
        let evenness = if self.ends_held { thinness.min(WIDEST_ENDS_HELD) } else { thinness };
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
        if self.ends_held {
            let last = end_angle - angles[count - 2];
            let shrunk = (1..=SHRINKING_AT_HELD_END).map(|i| end_angle - last * SHRINK.powi(i as i32));
            angles.splice(count - 1..count - 1, shrunk);
        }
        Grading { element: self.element, angles, layers: self.layers() }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::mechanics::body::{annulus, block, cored_disc, half_disc};

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
            // Where the ring ends held, a little thinner.
            let part = if body.shape.end_face_held { 0.6 } else { 1.0 };
            let least = part * (body.shape.depth_range)(&body.parameters).0.min(1.0);
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
            let Layers { first, thickest, shrinking, .. } = class.grading(body.shape.end_angle).layers;
            assert_eq!(first, class.first_layer());
            assert_eq!(thickest, first.max(level.growth.ln()));
            assert_eq!(shrinking, if body.shape.name == "block" { level.shrinking } else { 0 });
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
            let evenness = (depth / 0.7).clamp(1.0 / 3.0, if end < PI { 0.8 } else { 1.0 });
            let widest = evenness * level.widest.to_radians();
            // What shrinks towards a held end was one element.
            let shrinking = if end < PI { 3 } else { 0 };
            let count = angles.len() - 1 - shrinking;
            let ruled: Vec<f64> = angles[..count].iter().copied().chain([end]).collect();
            for pair in ruled.windows(2) {
                let rule = (pair[0] / level.spread).max(class.first_layer()).min(widest);
                let share = (pair[1] - pair[0]) / rule;
                assert!((0.7..1.4).contains(&share), "{body:?} {class:?}: {share} at {}", pair[0]);
            }
            let last = end - ruled[count - 1];
            for (shrunk, angle) in (1..).zip(&angles[count..angles.len() - 1]) {
                assert!((end - angle - last * 0.4_f64.powi(shrunk)).abs() < 1e-12, "{body:?} {class:?}");
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
