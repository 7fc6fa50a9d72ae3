//! How finely a body is divided: mesh levels, and the few classes into which bodies fall at each level.
//!
//! Contact is resolved by the trial pressures and the exact near field (`compliance::near_field`), not by the mesh;
//! the mesh only carries how a body differs from a concentric one, which is smooth. So the division follows the
//! body's own depth, not the contact angle, and one mesh serves every load. Depths are rounded to classes, so that
//! bodies of one class share their topology and the near-field correction.

use crate::mechanics::body::Body;
use crate::mechanics::element::ElementKind;
use crate::mechanics::layers::{Layers, SHRINK};
use crate::mechanics::lining_rows::{LiningDivision, LiningRows};
use crate::mechanics::material::Compressibility;
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
    /// Whether contact may be anywhere on the ring.
    pub all_around: bool,
    /// Of the layers those that divide a lining; none of a bare body.
    pub lining: LiningRows,
    /// As `depth_class`, of what is left beyond the lining; 0 of a bare body.
    pub rest_depth_class: u32,
}

/// What the division of a ring depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingDivision {
    level: usize,
    depth_class: u32,
    ends_held: bool,
    end_angle: f64,
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

/// At the far boundary.
fn is_stiff(body: &Body) -> bool {
    Compressibility::of(body.beyond_lining().0.poissons_ratio, body.idealization) >= Compressibility::Stiff
}

/// Of a least depth: bodies of one class are deeper than half an octave less.
fn depth_class(least: f64) -> u32 {
    (-CLASSES_PER_OCTAVE * least.log2()).ceil().max(0.0) as u32
}

/// The depth that stands for a class: a lower bound, at most 1.
fn class_depth(depth_class: u32) -> f64 {
    (-f64::from(depth_class) / CLASSES_PER_OCTAVE).exp2()
}

/// Thickness of the first layer in the shape's measure of depth.
fn first_layer(level: usize, depth_class: u32, ends_held: bool) -> f64 {
    let part = if ends_held { FIRST_ENDS_HELD } else { 1.0 };
    part * LEVELS[level].first * class_depth(depth_class)
}

impl GradingClass {
    /// The class of `body` at `level` (below `LEVEL_COUNT`, or `REFERENCE_LEVEL`).
    pub fn of(body: &Body, element: ElementKind, level: usize) -> GradingClass {
        let (least, mut greatest) = body.depth_range();
        let corners = body.shape.sides.len().saturating_sub(1);
        let shrinking = match (0..corners).any(|corner| holding_changes(body, corner)) {
            true if is_stiff(body) && level >= STIFF_LEVEL => LEVELS[level].shrinking + MORE_WHERE_STIFF,
            true => LEVELS[level].shrinking,
            // Stresses are high in any corner.
            false => corners.min(1),
        };
        let ends_held = body.shape.end_face_held;
        let mut class = GradingClass {
            level,
            element,
            depth_class: depth_class(least),
            layer_count: 2,
            shrinking,
            ends_held,
            all_around: body.all_around,
            lining: LiningRows::default(),
            rest_depth_class: 0,
        };
        if !body.lining.is_empty() {
            let beyond = body.beyond_lining().0.depth_range();
            greatest = beyond.1;
            class.rest_depth_class = depth_class(beyond.0);
            let LiningDivision { growth, thickest_first, .. } = class.lining_division();
            class.lining = LiningDivision::of(body, class.layers(), growth, thickest_first).rows;
            class.layer_count += class.lining.total();
        }
        class.layer_count =
            class.layers_of(body).fewest(greatest, LEVELS[level].growth, MOST_LAYERS) + class.lining.total();
        class
    }

    /// Whether its bodies have layers.
    pub fn is_lined(&self) -> bool {
        self.lining != LiningRows::default()
    }

    fn lining_division(&self) -> LiningDivision {
        let Level { first, growth, .. } = LEVELS[self.level];
        let thickest_first = first * class_depth(self.rest_depth_class);
        LiningDivision { rows: self.lining, growth, thickest_first }
    }

    /// Layers beyond the lining of a body.
    pub fn layers_of(&self, body: &Body) -> Layers {
        if self.is_lined() { self.lining_division().divided(body, self.layers()).rest } else { self.layers() }
    }

    /// Thickness of the first layer in the shape's measure of depth.
    pub fn first_layer(&self) -> f64 {
        first_layer(self.level, self.depth_class, self.ends_held)
    }

    /// Depth of all layers, each `growth` times as thick as the one before.
    pub fn depth_at_growth(&self, growth: f64) -> f64 {
        self.layers().depth(growth)
    }

    pub fn layers(&self) -> Layers {
        let first = self.first_layer();
        Layers {
            first,
            thickest: LEVELS[self.level].growth.ln().max(first),
            count: self.layer_count - self.lining.total(),
            shrinking: self.shrinking,
        }
    }

    /// The class of the concentric body beside which a lined one is told, and how deep it is beyond the lining: the same layers, as
    /// many as reach a depth there when they grow so, or one more than the lined body has, but never as many as that.
    pub fn beside(&self, body: &Body, depth: f64, growth: f64) -> (GradingClass, f64) {
        let lining = self.lining.total();
        let mut beside = GradingClass { layer_count: lining + 2, shrinking: 0, ..*self };
        while beside.layer_count < self.layer_count && beside.layers_of(body).depth(growth) < depth {
            beside.layer_count += 1;
        }
        if beside.layer_count == self.layer_count {
            beside.layer_count += 1;
        }
        (beside, beside.layers_of(body).depth(growth))
    }

    /// The class of a body with a round boundary of the same layers, as many as reach a depth when they grow so.
    pub fn cut_at(&self, depth: f64, growth: f64) -> GradingClass {
        let mut cut = GradingClass { layer_count: 2, shrinking: 0, ..*self };
        while cut.layer_count < self.layer_count && cut.depth_at_growth(growth) < depth {
            cut.layer_count += 1;
        }
        cut
    }

    /// The division of a ring that ends at an angle, rad.
    pub fn ring(&self, end_angle: f64) -> RingDivision {
        let GradingClass { level, depth_class, ends_held, .. } = *self;
        RingDivision { level, depth_class, ends_held, end_angle }
    }

    /// The division of a body whose ring ends at `end_angle`.
    pub fn grading(&self, end_angle: f64) -> Grading {
        Grading {
            element: self.element,
            angles: self.ring(end_angle).corner_angles(),
            layers: self.layers(),
            lining: self.lining_division(),
        }
    }
}

impl RingDivision {
    /// Angles of its corner nodes from the load line, rad.
    pub fn corner_angles(self) -> Vec<f64> {
        let RingDivision { level, depth_class, ends_held, end_angle } = self;
        let Level { spread, widest, .. } = LEVELS[level];
        // A thin body answers locally, so its ring is divided evenly finer; by no more than three, where it is nearly
        // a Winkler bed, whose answer needs no resolution.
        let thinness = (class_depth(depth_class) / THICK).clamp(1.0 / 3.0, 1.0);
        let evenness = if ends_held { thinness.min(WIDEST_ENDS_HELD) } else { thinness };
        let widest = evenness * widest.to_radians();
        // Room for those of most rings.
        let mut angles = Vec::with_capacity(16);
        angles.push(0.0);
        let first = first_layer(level, depth_class, ends_held);
        let mut reached = 0.0;
        while reached < end_angle - 1e-9 {
            reached += (reached / spread).max(first).min(widest);
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
        if ends_held {
            let last = end_angle - angles[count - 2];
            let shrunk = (1..=SHRINKING_AT_HELD_END).map(|i| end_angle - last * SHRINK.powi(i as i32));
            angles.splice(count - 1..count - 1, shrunk);
        }
        angles
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;
    use std::f64::consts::PI;

    use super::*;
    use crate::mechanics::body::{annulus, block, cored_disc, half_disc};
    use crate::mechanics::material::Idealization;

    fn body(shape: &'static crate::mechanics::body::Shape, parameters: [f64; 3]) -> Body {
        Body::bare(shape, parameters, 0.3, Idealization::PlaneStress)
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

    /// Every body on every level.
    fn all(mut check: impl FnMut(&Body, usize, &GradingClass)) {
        let mut count = 0;
        for body in bodies() {
            for level in 0..LEVELS.len() {
                check(&body, level, &GradingClass::of(&body, ElementKind::Quad8, level));
                count += 1;
            }
        }
        assert_eq!(count, 601 * 7);
    }

    /// The least and the greatest of positive numbers.
    fn span(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
        let values: Vec<f64> = values.into_iter().collect();
        assert!(!values.is_empty() && values.iter().all(|value| value.is_finite()), "{values:?}");
        values.iter().fold((f64::INFINITY, 0.0), |(least, most), value| (value.min(least), value.max(most)))
    }

    /// The layers of a class fill every place of its bodies: nowhere does one exceed the one before, or an outer radius its
    /// inner one, by more than the level allows; at the thinnest place none is less than 0.6 of the one before, and the
    /// first is a small part of the depth.
    #[test]
    fn layers_fit_the_thinnest_and_the_deepest_place() {
        let (mut growths, mut radii, mut at_thinnest, mut firsts) = (vec![], vec![], vec![], vec![]);
        all(|body, level, class| {
            let (least, greatest) = (body.shape.depth_range)(&body.parameters);
            let layers = class.layers();
            let [thinnest, deepest] = [least, greatest].map(|depth| {
                let growth = layers.growth(depth, 1.0);
                assert!((layers.depth(growth) / depth - 1.0).abs() < 1e-9, "{body:?} {class:?}");
                growth
            });
            let most = LEVELS[level].growth;
            growths.push(deepest / most);
            radii.push(span(layers.thicknesses(deepest)).1.exp() / most);
            at_thinnest.push(thinnest);
            firsts.push(class.first_layer() / least.min(1.0));
        });
        let [growths, radii, at_thinnest, firsts] = [growths, radii, at_thinnest, firsts].map(span);
        println!(
            "growth {growths:?}, radii {radii:?}, at the thinnest {at_thinnest:?}, first layer {firsts:?}"
        );
        assert!(growths.1 < 1.0 + 1e-9 && radii.1 < 1.0 + 1e-9, "{growths:?} {radii:?}");
        assert!(at_thinnest.0 > 0.6, "{at_thinnest:?}");
        assert!(firsts.0 > 0.02 && firsts.1 < 0.4 + 1e-9, "{firsts:?}");
    }

    /// There are as many layers as the deepest place needs, no more; and so where they are cut short.
    #[test]
    fn layers_are_as_few_as_reach_the_deepest_place() {
        let (mut needed, mut cut_short) = (0, 0);
        all(|body, level, class| {
            let greatest = (body.shape.depth_range)(&body.parameters).1;
            let growth = LEVELS[level].growth;
            let cut = class.cut_at(0.5 * greatest, growth);
            for (class, depth) in [(class, greatest), (&cut, 0.5 * greatest)] {
                let fewer = GradingClass { layer_count: class.layer_count - 1, ..*class };
                assert!(class.depth_at_growth(growth) >= depth, "{body:?} {class:?}");
                if class.layer_count > 2 {
                    needed += 1;
                    assert!(fewer.depth_at_growth(growth) < depth, "{body:?} {class:?}");
                }
            }
            assert!(cut.layer_count <= class.layer_count, "{body:?} {class:?}: {cut:?}");
            cut_short += usize::from(cut.layer_count < class.layer_count);
        });
        // Two layers are the fewest there are.
        println!("{needed} of more than two layers, {cut_short} cut short");
        assert!(needed > 8000 && cut_short > 4000, "{needed} {cut_short}");
    }

    /// Layers shrink towards corners where the holding changes, more of them in stiff bodies on fine meshes; towards round
    /// boundaries they do not.
    #[test]
    fn layers_shrink_towards_corners_alone() {
        let last = |class: &GradingClass| {
            let thicknesses: Vec<f64> = class.layers().thicknesses(1.0).collect();
            thicknesses[thicknesses.len() - 1] / thicknesses[0]
        };
        let mut blocks = 0;
        all(|body, _, class| match body.shape.name {
            "block" => {
                blocks += 1;
                assert!(last(class) < 0.17, "{class:?}");
            }
            _ => assert_eq!(last(class), 1.0, "{class:?}"),
        });
        assert_eq!(blocks, 200 * 7);
        let soft = Body { idealization: Idealization::PlaneStrain, ..body(&block::SHAPE, [3.0, 2.0, 2.0]) };
        let stiff = Body { poissons_ratio: 0.45, ..soft.clone() };
        let [soft, stiff] = [soft, stiff]
            .map(|body| [0, 3, 5].map(|level| last(&GradingClass::of(&body, ElementKind::Quad8, level))));
        // Two layers more, each 0.4 of what it would be.
        assert!(
            soft[0] == stiff[0] && stiff[1] < 0.2 * soft[1] && stiff[2] < 0.2 * soft[2],
            "{soft:?} {stiff:?}"
        );
    }

    /// Ring angles go from 0 to the end in steps that grow smoothly: the first as long as the first layer is thick, since
    /// narrow contacts are there, none more than 1.7 times the one before or wider than 52 degrees.
    /// Where the end is held they shrink towards it.
    #[test]
    fn ring_angles_grow_smoothly_from_the_load_line() {
        let (mut firsts, mut ratios, mut widest, mut ends) = (vec![], vec![], vec![], vec![]);
        all(|body, _, class| {
            let end = body.shape.end_angle;
            let angles = class.grading(end).angles;
            assert_eq!((angles[0], angles[angles.len() - 1]), (0.0, end));
            let steps: Vec<f64> = angles.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let mut growing = &steps[..];
            if body.shape.end_face_held {
                let shrinking;
                (growing, shrinking) = steps.split_at(steps.len() - 4);
                assert!(shrinking.windows(2).all(|pair| pair[1] < pair[0]), "{steps:?}");
                ends.push(shrinking[3] / growing[growing.len() - 1]);
            }
            firsts.push(steps[0] / class.first_layer());
            ratios.extend(growing.windows(2).map(|pair| pair[1] / pair[0]));
            widest.push(span(steps.iter().copied()).1);
        });
        assert_eq!((firsts.len(), ends.len()), (601 * 7, 7));
        let [firsts, ratios, widest, ends] = [firsts, ratios, widest, ends].map(span);
        println!("first {firsts:?}, ratios {ratios:?}, widest {widest:?} rad, at held ends {ends:?}");
        assert!(firsts.0 > 0.95 && firsts.1 < 1.05, "{firsts:?}");
        assert!(ratios.0 > 0.95 && ratios.1 < 1.7, "{ratios:?}");
        assert!(widest.1 < 52_f64.to_radians(), "{widest:?}");
        assert!(ends.1 < 0.12, "{ends:?}");
    }

    /// Bodies share a class, and with it a topology and the near field of one reference, where they are alike: their least
    /// depths, as far as they are below 1, are within half an octave. There are less than a third as many classes as bodies,
    /// though these are spread over four decades.
    #[test]
    fn classes_are_few_and_of_like_bodies() {
        let mut classes: HashMap<(&str, GradingClass), Vec<f64>> = HashMap::new();
        all(|body, _, class| {
            let least = (body.shape.depth_range)(&body.parameters).0.min(1.0);
            classes.entry((body.shape.name, *class)).or_default().push(least);
        });
        let (_, widest) = span(classes.values().map(|depths| {
            let (least, greatest) = span(depths.iter().copied());
            greatest / least
        }));
        println!("{} classes, least depths within {widest:.3}", classes.len());
        assert!(widest < 2_f64.sqrt() + 1e-9, "{widest}");
        assert!(classes.len() < 1150, "{}", classes.len());
    }

    /// Finer levels are finer in every way.
    #[test]
    fn levels_are_ordered() {
        let class = |ratio: f64, level| {
            GradingClass::of(&body(&annulus::SHAPE, [ratio, 0.0, 0.0]), ElementKind::Quad8, level)
        };
        for level in 1..LEVELS.len() {
            for ratio in [1.001, 1.3, 3.0, 1e4] {
                let [coarse, fine] = [level - 1, level].map(|level| class(ratio, level));
                assert!(fine.first_layer() < coarse.first_layer());
                assert!(fine.layer_count >= coarse.layer_count);
                assert!(fine.grading(PI).angles.len() > coarse.grading(PI).angles.len());
            }
        }
    }
}
