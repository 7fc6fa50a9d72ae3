//! Designs that are not solved, and why, in the words of the table's status. What is refused is known beforehand, so that
//! one design takes neither minutes nor gigabytes.

use std::f64::consts::PI;
use std::fmt;

use crate::engine::body_request::mesh_size;
use crate::mechanics::body::{Body, DEEPEST_MESHED, Side, THINNEST_RING};
use crate::mechanics::real::LANES;
use crate::study::columns::side_name;
use crate::study::config::MethodChoice;
use crate::study::design::{DesignCase, JointDesign, Load, NoRoom, Part};

/// Why a design is not solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// `series` was asked for bodies it has no modes of.
    NotConcentric,
    /// A part's layers, or the core of a tube's inner part, leave nothing of what they are on.
    NoRoom(NoRoom),
    /// A lined wall so thin that modes do not carry it.
    ThinLinedWall { part: &'static str },
    /// What layers leave of a part is thinner than meshes carry.
    ThinBeyondLayers { part: &'static str, wall: f64, thinnest: f64 },
    /// Closed forms know one material a part.
    LayersInClosedForm,
    /// A press fit of a pin that is no whole ring.
    PressFitOfHalfPin,
    /// A press fit in or of a wall so thin that modes do not carry it.
    ThinPressFit,
    /// Closed forms know clearance alone.
    PressFitInClosedForm,
    /// A press fit that is loaded from first touch, which it has none of.
    PressFitFromTouch,
    /// A place of a body on a mesh is thinner than meshes carry; `has_modes` where `series` needs no mesh.
    ThinWall { name: &'static str, wall: f64, thinnest: f64, has_modes: bool },
    /// The far boundary is farther from the ring than meshes carry, as a ratio of radii above 1.
    Deep { name: &'static str, side: Side, ratio: f64 },
}

impl Refusal {
    /// Of a joint that cannot be solved by this method, whatever its meshes.
    pub fn of_joint(case: &DesignCase, method: MethodChoice) -> Option<Refusal> {
        Refusal::of_press_fit(case, method).or_else(|| Refusal::of_layers(&case.joint, method))
    }

    /// Of a press fit.
    fn of_press_fit(case: &DesignCase, method: MethodChoice) -> Option<Refusal> {
        let joint = &case.joint;
        if !joint.is_press_fit() {
            return None;
        }
        let parts = [&joint.pin, &joint.plate];
        match method {
            MethodChoice::ClosedForm => Some(Refusal::PressFitInClosedForm),
            _ if case.steps.iter().any(|load| matches!(load, Load::Indentation(_))) => {
                Some(Refusal::PressFitFromTouch)
            }
            _ if parts.iter().any(|part| part.shape.end_angle < PI) => Some(Refusal::PressFitOfHalfPin),
            _ if parts.iter().any(|part| part.shape.concentric && is_thin(part)) => {
                Some(Refusal::ThinPressFit)
            }
            _ => None,
        }
    }

    /// Of layers.
    fn of_layers(joint: &JointDesign, method: MethodChoice) -> Option<Refusal> {
        [&joint.pin, &joint.plate].into_iter().find_map(|part| {
            if part.layers.is_empty() {
                return None;
            }
            let name = side_name(part.shape.side);
            match joint.no_room(part) {
                _ if method == MethodChoice::ClosedForm => Some(Refusal::LayersInClosedForm),
                Some(no_room) => Some(Refusal::NoRoom(no_room)),
                _ if part.shape.concentric && is_thin(part) => Some(Refusal::ThinLinedWall { part: name }),
                _ => None,
            }
        })
    }

    /// Of a body that is to be meshed.
    pub fn of_mesh(body: &Body) -> Option<Refusal> {
        let shape = body.shape;
        let (least, greatest) = body.depth_range();
        let thickness = |depth: f64| match shape.side {
            Side::Plate => depth.exp_m1(),
            Side::Pin => -(-depth).exp_m1(),
        };
        // Concentric walls beyond layers bear as little as there is of them.
        if !body.lining.is_empty() && !shape.concentric {
            let rest = body.beyond_lining().0.depth_range().0;
            if rest < shape.thinnest_meshed {
                let (wall, thinnest) = (thickness(rest), thickness(shape.thinnest_meshed));
                return Some(Refusal::ThinBeyondLayers { part: side_name(shape.side), wall, thinnest });
            }
        }
        if least < shape.thinnest_meshed {
            let (wall, thinnest) = (thickness(least), thickness(shape.thinnest_meshed));
            return Some(Refusal::ThinWall { name: shape.wall, wall, thinnest, has_modes: shape.concentric });
        }
        (greatest > DEEPEST_MESHED).then(|| Refusal::Deep {
            name: shape.name,
            side: shape.side,
            ratio: greatest.exp(),
        })
    }
}

/// Whether a wall is so thin that it is taken for a bed where there is nothing else.
fn is_thin(part: &Part) -> bool {
    (part.shape.depth_range)(&part.parameters).0 < THINNEST_RING
}

impl fmt::Display for Refusal {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            Refusal::NotConcentric => write!(out, "series needs a rigid-core pin in an annulus"),
            Refusal::NoRoom(no_room) => write!(out, "{no_room}"),
            Refusal::ThinLinedWall { part } => {
                let thinnest = one_digit(100.0 * THINNEST_RING);
                write!(out, "the {part} has layers in a wall below {thinnest} % of the radius")
            }
            Refusal::ThinBeyondLayers { part, wall, thinnest } => {
                let (wall, thinnest) = beside(100.0 * wall, 100.0 * thinnest, "just under");
                write!(
                    out,
                    "the layers of the {part} leave a wall of {wall} % of their radius; the thinnest that meshes carry is {thinnest} %"
                )
            }
            Refusal::LayersInClosedForm => write!(out, "closed forms know no layers"),
            Refusal::PressFitOfHalfPin => {
                write!(out, "half a pin is held by no press fit: the pin's model is rigid-core or tube")
            }
            Refusal::ThinPressFit => {
                let thinnest = one_digit(100.0 * THINNEST_RING);
                write!(out, "a wall of the press fit is below {thinnest} % of the radius")
            }
            Refusal::PressFitInClosedForm => write!(out, "closed forms know no press fits"),
            Refusal::PressFitFromTouch => {
                write!(out, "a press fit has no indentation; it is loaded by an offset or a force")
            }
            Refusal::ThinWall { name, wall, thinnest, has_modes } => {
                let (wall, thinnest) = beside(100.0 * wall, 100.0 * thinnest, "just under");
                let way_out = if has_modes { "; method auto needs no mesh for it" } else { "" };
                write!(
                    out,
                    "{name} is {wall} % of the radius; the thinnest that meshes carry is {thinnest} %{way_out}"
                )
            }
            Refusal::Deep { name, side, ratio } => {
                let (ratio, most) = beside(ratio, DEEPEST_MESHED.exp(), "just over");
                match side {
                    Side::Plate => write!(
                        out,
                        "the {name} is {ratio} times as large as the hole; the largest that meshes carry is {most} times"
                    ),
                    Side::Pin => write!(
                        out,
                        "the pin is {ratio} times as large as its core; the largest that meshes carry is {most} times"
                    ),
                }
            }
        }
    }
}

/// A value beyond a limit, and the limit, so that they never read the same.
fn beside(value: f64, limit: f64, beyond: &str) -> (String, String) {
    let (value, limit) = (one_digit(value), one_digit(limit));
    (if value == limit { format!("{beyond} {limit}") } else { value }, limit)
}

/// With one digit, so that a sweep has few different statuses.
fn one_digit(value: f64) -> String {
    let rounded = format!("{value:.0e}");
    let plain: f64 = rounded.parse().unwrap_or(value);
    if (1e-4..1e7).contains(&plain) { format!("{plain}") } else { rounded }
}

/// Bytes of the band of one lane batch at most.
const MOST_BAND_BYTES: u64 = 160 << 20;

/// Up to this level the mesh of any body without layers stays within them.
const ALWAYS_BOUNDED: usize = 2;

/// Whether the mesh of a body at a level stays within bounds of memory, and by that of time: some tenths of a second for
/// a body alone, with what it shares with others.
pub fn is_bounded(body: &Body, level: usize) -> bool {
    (level <= ALWAYS_BOUNDED && body.lining.is_empty()) || band_bytes(body, level) <= MOST_BAND_BYTES
}

/// Of the mesh of a body, in lanes.
fn band_bytes(body: &Body, level: usize) -> u64 {
    let size = mesh_size(body, level);
    size.unknowns * (size.unknowns / size.layers) * 8 * LANES as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::body::{annulus, block, cored_disc, half_disc};
    use crate::mechanics::grading::LEVEL_COUNT;
    use crate::mechanics::material::Idealization;

    #[test]
    fn a_refused_value_never_reads_like_the_limit() {
        let of_wall = |wall| {
            let refusal = Refusal::ThinWall { name: "the wall", wall, thinnest: 0.02, has_modes: false };
            refusal.to_string()
        };
        assert_eq!(
            of_wall(0.0199),
            "the wall is just under 2 % of the radius; the thinnest that meshes carry is 2 %"
        );
        assert_eq!(of_wall(1e-4), "the wall is 0.01 % of the radius; the thinnest that meshes carry is 2 %");
    }

    /// The thinnest walls beside the deepest bodies, of every shape and support.
    #[test]
    fn coarse_meshes_are_always_bounded() {
        let deep = DEEPEST_MESHED.exp();
        let [thin, ligament] =
            [THINNEST_RING, block::SHAPE.thinnest_meshed].map(|least| least.exp() * 1.000_001);
        let mut bodies = Vec::new();
        for (shape, parameters) in [
            (&half_disc::SHAPE, [0.0; 3]),
            (&cored_disc::SHAPE, [1.0 / thin, 0.0, 0.0]),
            (&cored_disc::SHAPE, [1.0 / deep, 0.0, 0.0]),
            (&annulus::SHAPE, [thin, 0.0, 0.0]),
            (&annulus::SHAPE, [deep, 0.0, 0.0]),
            (&block::SHAPE, [ligament, deep / 2.0, deep / 2.0]),
            (&block::SHAPE, [deep / 2.0, ligament, ligament]),
            (&block::SHAPE, [ligament, ligament, deep / 2.0]),
        ] {
            for support in 0..shape.supports.len().max(1) {
                for all_around in [false, true] {
                    let own = Body::concentric(2.0, 0.499, Idealization::PlaneStrain);
                    bodies.push(Body { shape, parameters, support, all_around, ..own });
                }
            }
        }
        assert!(bodies.iter().all(|body| Refusal::of_mesh(body).is_none()));
        let most = |level: usize| bodies.iter().map(|body| band_bytes(body, level)).max();
        println!("{:?}", [0, 1, 2, 3, 4, 5].map(most));
        assert!((0..=ALWAYS_BOUNDED).all(|level| most(level) <= Some(MOST_BAND_BYTES)));
        assert!(most(LEVEL_COUNT - 1) > Some(MOST_BAND_BYTES));
    }
}
