//! The dimensionless half of a joint: a shape with its ratios, Poisson's ratio and the idealization.
//!
//! In two dimensions a body's compliance times Young's modulus depends on nothing else, so `Body` is the key
//! under which a sweep solves each distinct body once. A new shape is one new file and one line in `SHAPES`.

use std::hash::{Hash, Hasher};

use lining::Lining;
use smallvec::SmallVec;

use crate::mechanics::material::Idealization;

pub mod lining;
pub mod half_disc;
pub mod cored_disc;
pub mod annulus;
pub mod block;

/// Which half of the joint a shape can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    Pin,
    Plate,
}

impl Side {
    /// Which way the body lies from its ring, and a pressure pushes it: 1 outwards, -1 inwards.
    pub fn outward(self) -> f64 {
        match self {
            Side::Pin => -1.0,
            Side::Plate => 1.0,
        }
    }
}

/// One ratio of a shape, as it is called in configs and tables. Ratios are lengths over the ring's radius.
#[derive(Debug)]
pub struct ShapeParameter {
    pub name: &'static str,
    /// Used when the config leaves the parameter out; `None` makes it required.
    pub default: Option<f64>,
    /// Exclusive bounds.
    pub above: f64,
    pub below: f64,
}

/// The most ratios any shape has.
pub const MAX_PARAMETERS: usize = 3;

/// The most corners any far boundary has.
pub const MOST_CORNERS: usize = 2;

/// Something of each corner of a far boundary.
pub type OfCorners<T> = SmallVec<[T; MOST_CORNERS]>;

/// A family of bodies. One static per shape file.
#[derive(Debug)]
pub struct Shape {
    /// The `model` in configs and tables.
    pub name: &'static str,
    pub side: Side,
    pub parameters: &'static [ShapeParameter],
    /// Names of the ways the shape can be held, the first is the default; empty when there is only one.
    pub supports: &'static [&'static str],
    /// Angle of the ring's end from the load line, rad: pi, or pi/2 for half a disc.
    pub end_angle: f64,
    /// Whether the face at the end angle is held.
    pub end_face_held: bool,
    /// How deep below the ring the far boundary lies along the ray at an angle: |ln r|, r over the ring's radius; for a
    /// shape that `reaches_centre`, where ln r has no value, a depth given to the centre.
    pub depth: fn(&[f64; MAX_PARAMETERS], f64) -> f64,
    /// Whether the shape lies between the ring and a concentric circle that is held, the radius ratio of which is its
    /// first parameter: `series` has the exact compliance.
    pub concentric: bool,
    /// Whether the shape includes the ring's centre, where ln r has no value. Elsewhere layers are even in ln r, which
    /// resolves a small core as well as a distant boundary.
    pub reaches_centre: bool,
    /// Angles of the far boundary's corners, ascending.
    pub corners: fn(&[f64; MAX_PARAMETERS]) -> OfCorners<f64>,
    /// The straight sides of the far boundary, in order, one more than corners. Empty where the boundary is round; only plates can have them.
    pub sides: &'static [StraightSide],
    /// Whether a side of the far boundary (counted from the load line, between corners) is held by a support.
    pub boundary_held: fn(usize, usize) -> bool,
    /// The least and the greatest depth.
    pub depth_range: fn(&[f64; MAX_PARAMETERS]) -> (f64, f64),
    /// What is as thin as the least depth, in the words of a status: "the wall of the annulus".
    pub wall: &'static str,
    /// The least depth that meshes carry, measured (docs/verification.md, "Thin bodies").
    pub thinnest_meshed: f64,
}

/// A straight side of a far boundary, by its perpendicular from the ring's centre.
#[derive(Clone, Copy, Debug)]
pub struct StraightSide {
    /// Angle of the foot, which is on the side.
    pub foot: f64,
    /// Which parameter its length is, over the ring's radius.
    pub distance: usize,
}

/// Each is there once.
impl PartialEq for Shape {
    fn eq(&self, other: &Shape) -> bool {
        std::ptr::eq(self, other)
    }
}

impl Eq for Shape {}

impl Hash for Shape {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // Names differ in length, and hashes may be alike.
        self.name.len().hash(state);
    }
}

/// The thinnest ring that modes and meshes carry, |ln r|: thinner ones would need more than a thousand modes, and their compliance
/// is not interpolated well between half angles. `series` takes them for Winkler beds (`compliance::thin_wall`).
pub const THINNEST_RING: f64 = 0.0198;

/// The greatest depth that meshes carry: a far boundary a million radii away, or a core of a millionth.
pub const DEEPEST_MESHED: f64 = 13.9;

/// Every shape there is, pins first.
pub static SHAPES: [&Shape; 4] = [&half_disc::SHAPE, &cored_disc::SHAPE, &annulus::SHAPE, &block::SHAPE];

impl Shape {
    /// The shapes of one side, in table order.
    pub fn of_side(side: Side) -> impl Iterator<Item = &'static Shape> {
        SHAPES.into_iter().filter(move |shape| shape.side == side)
    }
}

/// A body: everything its dimensionless compliance depends on.
#[derive(Clone, Debug)]
pub struct Body {
    pub shape: &'static Shape,
    /// Values of `shape.parameters`, in order; the rest is zero.
    pub parameters: [f64; MAX_PARAMETERS],
    /// Index into `shape.supports`; 0 when there is only one.
    pub support: usize,
    /// At the ring.
    pub poissons_ratio: f64,
    pub idealization: Idealization,
    pub lining: Lining,
    /// Whether it may be pressed all around its ring, as in a press fit: its mesh is as good there as at the load line.
    pub all_around: bool,
}

impl Body {
    /// What tells it from others, as bits.
    fn bits(&self) -> ([u64; MAX_PARAMETERS], usize, u64, Idealization, bool) {
        let parameters = self.parameters.map(f64::to_bits);
        (parameters, self.support, self.poissons_ratio.to_bits(), self.idealization, self.all_around)
    }
}

/// Equal to the bit.
impl PartialEq for Body {
    fn eq(&self, other: &Body) -> bool {
        self.shape == other.shape && self.bits() == other.bits() && self.lining == other.lining
    }
}

impl Eq for Body {}

/// In few words, since sweeps hash every body they draw.
impl Hash for Body {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let (parameters, support, poissons_ratio, idealization, all_around) = self.bits();
        parameters.into_iter().for_each(|ratio| state.write_u64(ratio));
        state.write_u64(poissons_ratio);
        // Hashes may be alike.
        let kind = (self.shape.name.len() << 16) + (support << 8) + (2 * idealization as usize);
        state.write_usize(kind + usize::from(all_around));
        self.lining.list().iter().for_each(|interface| interface.hash(state));
    }
}

impl Body {
    /// A bare one between its ring and a concentric circle that is held, of a radius over the ring's.
    pub fn concentric(fixed_radius_ratio: f64, poissons_ratio: f64, idealization: Idealization) -> Body {
        let mut parameters = [0.0; MAX_PARAMETERS];
        parameters[0] = fixed_radius_ratio;
        let shape = if fixed_radius_ratio > 1.0 { &annulus::SHAPE } else { &cored_disc::SHAPE };
        Body::bare(shape, parameters, poissons_ratio, idealization)
    }

    /// One without layers, on the first of its shape's supports.
    pub fn bare(
        shape: &'static Shape,
        parameters: [f64; MAX_PARAMETERS],
        poissons_ratio: f64,
        idealization: Idealization,
    ) -> Body {
        let (support, lining) = (0, Lining::NONE);
        Body { shape, parameters, support, poissons_ratio, idealization, lining, all_around: false }
    }

    /// Depth |ln r| of the thinnest place between the ring and the far boundary, and of the deepest.
    pub fn depth_range(&self) -> (f64, f64) {
        (self.shape.depth_range)(&self.parameters)
    }

    /// Depth of the nearest place where something changes below the ring: the first interface, or the thinnest wall.
    pub fn nearest_depth(&self) -> f64 {
        let of_interface = self.lining.list().first().map(|first| first.radius_ratio.ln().abs());
        of_interface.unwrap_or(f64::INFINITY).min(self.depth_range().0)
    }

    /// Young's modulus over that at the ring and Poisson's ratio of a material: 0 at the ring, 1 beyond the first interface, and so on.
    pub fn material(&self, number: usize) -> [f64; 2] {
        self.lining.material(number, self.poissons_ratio)
    }

    /// What is left beyond all layers as a bare body whose ring is the outermost interface, and the radius of that over the ring's.
    pub fn beyond_lining(&self) -> (Body, f64) {
        let Some(last) = self.lining.list().last() else { return (self.clone(), 1.0) };
        let rest = Body {
            parameters: self.parameters.map(|ratio| ratio / last.radius_ratio),
            poissons_ratio: last.poissons_ratio,
            lining: Lining::NONE,
            ..*self
        };
        (rest, last.radius_ratio)
    }

    /// The radius of the outermost interface over the ring's: 1 without any.
    pub fn beyond_lining_radius(&self) -> f64 {
        self.lining.list().last().map_or(1.0, |last| last.radius_ratio)
    }

    /// Of a concentric body, the radius of the circle that is held over the ring's: its outer or its core radius ratio.
    pub fn fixed_radius_ratio(&self) -> Option<f64> {
        self.shape.concentric.then_some(self.parameters[0])
    }

    /// The body that stands for those of either plane state with the same shear modulus over the bulk modulus, and what this one yields
    /// over what that does: the same, but for E'. Without a lining.
    pub fn of_either_state(&self) -> (Body, f64) {
        let ratio = self.idealization.shear_to_bulk(self.poissons_ratio);
        let (idealization, poissons_ratio) = Idealization::of_shear_to_bulk(ratio);
        if idealization == self.idealization {
            return (self.clone(), 1.0);
        }
        let own = self.idealization.plane_modulus_ratio(self.poissons_ratio);
        let yields = idealization.plane_modulus_ratio(poissons_ratio) / own;
        (Body { idealization, poissons_ratio, ..self.clone() }, yields)
    }

    /// Whether only Poisson's ratio and the plane state may differ.
    pub fn has_outlines_of(&self, other: &Body) -> bool {
        let of = |body: &Body| (body.parameters.map(f64::to_bits), body.support);
        self.shape == other.shape && of(self) == of(other) && self.lining == other.lining
    }
}

#[cfg(test)]
mod tests {
    use std::hash::BuildHasher;

    use foldhash::fast::FixedState;

    use super::*;
    use crate::mechanics::body::lining::Interface;

    /// Bodies that differ in one thing only, each of them.
    #[test]
    fn whatever_tells_bodies_apart_is_hashed() {
        let hash = |body: &Body| FixedState::with_seed(0).hash_one(body);
        let own = Body::bare(&block::SHAPE, [3.0, 2.0, 2.5], 0.3, Idealization::PlaneStress);
        let interface = Interface { radius_ratio: 1.2, modulus_ratio: 2.0, poissons_ratio: 0.3 };
        let lining = |interface: Interface| Lining::new(vec![interface]);
        let lined = Body { lining: lining(interface), ..own.clone() };
        let mut all = vec![own.clone(), lined.clone()];
        all.extend((0..MAX_PARAMETERS).map(|place| {
            let mut other = own.clone();
            other.parameters[place] *= 1.0 + f64::EPSILON;
            other
        }));
        all.extend([
            Body { shape: &annulus::SHAPE, ..own.clone() },
            Body { support: 1, ..own.clone() },
            Body { poissons_ratio: 0.4, ..own.clone() },
            Body { idealization: Idealization::PlaneStrain, ..own.clone() },
            Body { all_around: true, ..own.clone() },
            Body { lining: lining(Interface { radius_ratio: 1.3, ..interface }), ..own.clone() },
            Body { lining: lining(Interface { modulus_ratio: 1.0, ..interface }), ..own.clone() },
            Body { lining: Lining::new(vec![interface; 2]), ..own.clone() },
        ]);
        let hashes: std::collections::HashSet<u64> = all.iter().map(hash).collect();
        assert_eq!(hashes.len(), all.len());
        // Equal ones have one hash, wherever their layers are.
        assert_eq!(hash(&lined), hash(&Body { lining: lining(interface), ..own }));
    }
}
