//! The nodes of curves: arcs up to a limit, what a curve's functions are polynomials of, and the polynomials at the nodes.

use std::f64::consts::FRAC_PI_2;

use super::arc_pressure::ArcPressure;
use super::outlines::Outlines;
use crate::mechanics::body::Side;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::arc::{ArcMap, ContactArc};
use crate::mechanics::compliance::arc_lanes::{ForEach, one_by_one};
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::compliance::pressure_space::{ComplianceRoom, JointCompliance, PressureSpace, Tilt};
use crate::mechanics::compliance::thin_wall::bed_matrix;
use crate::mechanics::real::{LANES, Lanes, Real};

/// What the functions of a curve are polynomials of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variable {
    /// z.
    Root,
    /// ln b, down to `NARROWEST` of its limit.
    Logarithm,
    /// cos(eps/2), from the whole ring down to `OPENED`: of press fits.
    Gap,
}

/// The most nodes of a space.
pub const MOST_NODES: usize = 96;

/// The narrowest contact beside beds over the widest.
const NARROWEST: f64 = 1e-9;

/// cos(eps/2) of the narrowest contact of press fits, 60 deg: those of neat fits, at which they end, were 83 deg and more
/// (`tests/mechanics/press_fits.rs`).
const OPENED: f64 = 0.866;

/// The arcs of curves up to a limit: Chebyshev nodes in a variable.
#[derive(Clone)]
pub struct CurveSpace {
    /// On arcs of the pin.
    pub pressures: PressureSpace,
    /// The largest contact half angle of the pin, rad.
    pub limit: f64,
    variable: Variable,
    /// tan(limit/4), or ln tan(limit/2); 0 of press fits.
    widest: f64,
    /// z^2, or b, or 1 - cos^2(eps/2)/`OPENED`^2, at the nodes: where loads are searched.
    pub(super) places: Vec<f64>,
    /// Logarithms of z, or of b.
    pub(super) logarithms: Vec<f64>,
    /// What functions are polynomials of, from 0 to 1, at the nodes, x_i, and 1/product of all x_i - x_j.
    pub(super) weighted: Vec<(f64, f64)>,
    /// T_degree(x) of the Chebyshev nodes x > 0: `[degree / LANES][node]`, as many degrees as there are lanes. Even degrees before odd
    /// ones, each in whole chunks.
    pub(super) chebyshev: Vec<Vec<[f64; LANES]>>,
    /// Of press fits, angles all around the ring with the pressures there of each trial pressure on it.
    pub(super) around: Vec<(f64, Vec<f64>)>,
}

impl CurveSpace {
    /// `terms` trial pressures at so many nodes, a multiple of `LANES`, up to a half angle, rad. Of press fits that is the whole ring
    /// whatever is given, and the first node.
    pub fn new(variable: Variable, terms: usize, nodes: usize, limit: f64) -> CurveSpace {
        CurveSpace::made(variable, terms, nodes, limit, &one_by_one)
    }

    /// The same with the arcs' shares of the work given out.
    pub fn made(variable: Variable, terms: usize, nodes: usize, limit: f64, for_each: ForEach) -> CurveSpace {
        let angle = |node: usize| std::f64::consts::PI * (node as f64 + 0.5) / nodes as f64;
        // From 0 to 1.
        let unit = |node: usize| 0.5 * (1.0 + angle(node).cos());
        // The product of all x - x_j is a Chebyshev polynomial: its slope at a node is known.
        let size = 4.0_f64.powi(nodes as i32 - 1) / nodes as f64;
        let weight = |node: usize| {
            let weight = size * angle(node).sin();
            if node.is_multiple_of(2) { weight } else { -weight }
        };
        let units = (0..nodes).map(unit);
        let widest = match variable {
            Variable::Root => (0.25 * limit).tan(),
            Variable::Logarithm => (0.5 * limit).tan().ln(),
            Variable::Gap => 0.0,
        };
        // From 0 at the first node on.
        let opened = |node: usize| 1.0 - unit(node) / unit(0);
        let logarithms: Vec<f64> = match variable {
            Variable::Root => units.map(f64::ln).collect(),
            Variable::Logarithm => units.map(|unit| widest + (1.0 - unit) * NARROWEST.ln()).collect(),
            Variable::Gap => (0..nodes).map(|node| gap_arc(opened(node)).ln_b).collect(),
        };
        let chebyshev = (0..2 * chunks_of_parity(nodes)).map(|chunk| {
            let degree = |lane: usize| degree_at(nodes, chunk, lane) as f64;
            (0..nodes / 2)
                .map(|node| std::array::from_fn(|lane| (degree(lane) * angle(node)).cos()))
                .collect()
        });
        let arc = |node: usize| match variable {
            Variable::Root => ContactArc::new(4.0 * (widest * (2.0 * logarithms[node]).exp()).atan()),
            Variable::Logarithm => ContactArc::new(2.0 * logarithms[node].exp().atan()),
            Variable::Gap => gap_arc(opened(node)),
        };
        CurveSpace {
            pressures: PressureSpace::made(terms, (0..nodes).map(arc).collect(), for_each),
            limit,
            variable,
            widest,
            places: match variable {
                Variable::Root => (0..nodes).map(|node| unit(node) * unit(node)).collect(),
                Variable::Logarithm => logarithms.iter().map(|logarithm| logarithm.exp()).collect(),
                Variable::Gap => (0..nodes).map(|node| 1.0 - opened(node).powi(2)).collect(),
            },
            logarithms,
            weighted: (0..nodes).map(|node| (unit(node), weight(node))).collect(),
            chebyshev: chebyshev.collect(),
            around: if variable == Variable::Gap { ArcPressure::around(terms) } else { Vec::new() },
        }
    }

    /// The arcs of the nodes, descending.
    pub fn arcs(&self) -> &[ContactArc] {
        &self.pressures.arcs
    }

    /// Of each node b, ln b, the logarithm that S is without, and the place, where loads are searched.
    pub fn node_numbers(&self) -> impl Iterator<Item = [f64; 4]> {
        let of_arcs = self.arcs().iter().zip(&self.logarithms).zip(&self.places);
        of_arcs.map(|((arc, logarithm), place)| [arc.b, arc.ln_b, *logarithm, *place])
    }

    /// tan(limit/4), where functions are polynomials of z.
    pub fn widest(&self) -> f64 {
        self.widest
    }

    /// The part of a joint's compliance of bodies of one side with their shares, as `PressureSpace::joint` has them: a pin's under its
    /// tilt, a plate's on the hole's arcs.
    pub fn part(
        &self,
        side: Side,
        bodies: &[(&BodyCompliance, f64)],
        outlines: &Outlines,
    ) -> JointCompliance<'static> {
        let mut room = PartRoom::default();
        let part = self.part_in(side, bodies, outlines, &mut room);
        JointCompliance { values: part.values.into_owned().into(), ..part }
    }

    /// The same in the room of another one.
    pub fn part_in<'a>(
        &self,
        side: Side,
        bodies: &[(&BodyCompliance, f64)],
        outlines: &Outlines,
        PartRoom { own, moved }: &'a mut PartRoom,
    ) -> JointCompliance<'a> {
        match side {
            Side::Pin => self.pressures.joint_in(bodies, outlines.tilt(), own),
            Side::Plate => {
                let plate = self.pressures.joint_in(bodies, Tilt::NONE, own);
                self.to_hole(&plate, outlines, moved);
                JointCompliance { values: moved[..].into(), ..plate }
            }
        }
    }

    /// The values of a plate's compliance on the hole's arcs that meet the pin's, from those on the arcs of the space.
    pub fn to_hole(&self, plate: &JointCompliance, outlines: &Outlines, moved: &mut Vec<f64>) {
        if outlines.ratio() == 1.0 {
            moved.clear();
            moved.extend_from_slice(&plate.values);
            return;
        }
        let count = self.arcs().len();
        // All of it is overwritten.
        moved.resize(plate.values.len(), 0.0);
        if plate.bed == 0.0 {
            in_lanes(OnHole { space: self, ratio: outlines.ratio(), values: &plate.values, moved });
        } else {
            // What a bed adds grows like 1/b, which is no polynomial.
            let bed_on = |ratio: f64, values: &mut [f64], share: f64| {
                for (place, arc) in self.arcs().iter().enumerate() {
                    let matrix = bed_matrix(arc.b / ratio, self.pressures.terms);
                    for (entry, value) in matrix.into_iter().enumerate() {
                        values[entry * count + place] += share * value;
                    }
                }
            };
            let mut elastic = plate.values.to_vec();
            bed_on(1.0, &mut elastic, -plate.bed);
            in_lanes(OnHole { space: self, ratio: outlines.ratio(), values: &elastic, moved });
            bed_on(outlines.ratio(), moved, plate.bed);
        }
        // What is left out of entry (0, 0) goes with the pin's b, not the hole's.
        let logarithm = FRAC_PI_2 * plate.even * outlines.ratio().ln();
        moved[..count].iter_mut().for_each(|value| *value += logarithm);
    }

    /// T_degree at a node.
    pub(super) fn chebyshev_at(&self, degree: usize, node: usize) -> f64 {
        let (count, is_far) = (self.arcs().len(), node >= self.arcs().len() / 2);
        let near = if is_far { count - 1 - node } else { node };
        let value = self.chebyshev[chunk_of(count, degree)][near][degree / 2 % LANES];
        if is_far && degree % 2 == 1 { -value } else { value }
    }

    /// Of all arcs.
    pub fn map(&self) -> ArcMap {
        if self.variable == Variable::Gap { ArcMap::Sine } else { ArcMap::Tangent }
    }

    /// The place, as `places` has them, of a cos(eps/2).
    pub(super) fn place_of_gap(&self, gap: f64) -> f64 {
        1.0 - (gap / OPENED).powi(2)
    }

    /// Whether polynomials are of ln b.
    #[inline(always)]
    pub(super) fn is_beside_beds(&self) -> bool {
        self.variable == Variable::Logarithm
    }

    /// Whether a curve goes on below its narrowest node, to the angle zero.
    pub(super) fn goes_to_zero(&self) -> bool {
        self.variable == Variable::Root
    }

    /// From places to what polynomials are of, from 0 to 1, b, and logarithms.
    #[inline(always)]
    pub(super) fn at_places<const WIDTH: usize, const COUNT: usize>(
        &self,
        places: Lanes<WIDTH, COUNT>,
    ) -> [Lanes<WIDTH, COUNT>; 3] {
        let number = Lanes::<WIDTH, COUNT>::from_f64;
        match self.variable {
            Variable::Root => {
                let quarter = number(self.widest) * places;
                let b = (quarter + quarter) / number(1.0).minus_product(quarter, quarter);
                [places.sqrt(), b, number(0.5) * places.ln()]
            }
            Variable::Logarithm => {
                let logarithms = places.ln();
                let scale = number(1.0 / NARROWEST.ln());
                [number(1.0).minus_product(scale, logarithms - number(self.widest)), places, logarithms]
            }
            Variable::Gap => {
                let left = number(1.0) - places;
                let square = number(1.0).minus_product(number(OPENED * OPENED), left);
                let unit = number(self.weighted[0].0) * (number(1.0) - left.sqrt());
                [unit, square.sqrt(), number(0.5) * square.ln()]
            }
        }
    }

    /// The first of these from b, as far as the polynomials reach down.
    #[inline(always)]
    pub(super) fn place<const WIDTH: usize>(&self, b: Lanes<WIDTH>) -> Lanes<WIDTH> {
        let number = Lanes::<WIDTH>::from_f64;
        match self.variable {
            // tan(eps/4) from tan(eps/2).
            Variable::Root => {
                let root = number(1.0) + (number(1.0) + b * b).sqrt();
                (b / (root * number(self.widest))).sqrt()
            }
            // Below the narrowest contact nothing but the bed changes.
            Variable::Logarithm => {
                let place = number(1.0) - (b.ln() - number(self.widest)) * number(1.0 / NARROWEST.ln());
                -(-place).least(number(-self.weighted[self.weighted.len() - 1].0))
            }
            Variable::Gap => {
                // Beyond the whole ring is nothing.
                let left = -(-number(1.0).minus_product(b, b)).least(number(0.0));
                let opened = left.sqrt() * number(1.0 / OPENED);
                number(self.weighted[0].0) * (number(1.0) - opened)
            }
        }
    }

    /// What of S is left out of its polynomials goes with this times the logarithm: a logarithm is a polynomial of itself.
    pub(super) fn logarithm_share(&self, even: f64) -> f64 {
        match self.variable {
            Variable::Root => std::f64::consts::PI * even,
            Variable::Logarithm => 0.0,
            Variable::Gap => FRAC_PI_2 * even,
        }
    }
}

/// What the part of a body takes, to be taken again by that of another one.
#[derive(Default)]
pub struct PartRoom {
    own: ComplianceRoom,
    moved: Vec<f64>,
}

/// Of a press fit that has opened by so much, from 0, nowhere, to 1, as far as its curve goes.
fn gap_arc(opened: f64) -> ContactArc {
    ContactArc::leaving(OPENED * opened)
}

/// From values on the arcs of a space, `[packed entry][arc]`, to those on arcs whose b is smaller by a ratio, by the polynomials
/// through them.
struct OnHole<'a> {
    space: &'a CurveSpace,
    ratio: f64,
    values: &'a [f64],
    moved: &'a mut [f64],
}

impl LaneWork for OnHole<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize>(self) {
        // Most spaces have few nodes, and room for many takes longer to clear than they take.
        match self.space.weighted.len() {
            ..=FEW_NODES => self.run_with::<WIDTH, FEW_NODES>(),
            _ => self.run_with::<WIDTH, MOST_NODES>(),
        }
    }
}

impl OnHole<'_> {
    #[inline(always)]
    fn run_with<const WIDTH: usize, const ROOM: usize>(self) {
        let OnHole { space, ratio, values, moved } = self;
        let number = Lanes::<WIDTH>::from_f64;
        let count = space.weighted.len();
        let mut weights = [Lanes::<WIDTH>::zero(); ROOM];
        let weights = &mut weights[..count];
        for chunk in 0..count / LANES {
            let mut b = Lanes::<WIDTH>::zero();
            for (b, arc) in b.0.iter_mut().zip(&space.arcs()[chunk * LANES..]) {
                *b = arc.b;
            }
            // Lagrange's polynomials: products of the distances to all nodes before, then to all behind.
            let wanted = space.place(b * number(1.0 / ratio));
            let distance = |place: f64| wanted - number(place);
            let mut before = number(1.0);
            for (own, (place, weight)) in weights.iter_mut().zip(&space.weighted) {
                *own = before * number(*weight);
                before = before * distance(*place);
            }
            let mut behind = number(1.0);
            for (own, (place, _)) in weights.iter_mut().zip(&space.weighted).rev() {
                *own = *own * behind;
                behind = behind * distance(*place);
            }
            // The last group begins where it ends with the entries.
            let entries = values.len() / count;
            let last = entries.saturating_sub(ABREAST);
            for entry in (0..=last).step_by(ABREAST).chain((!last.is_multiple_of(ABREAST)).then_some(last)) {
                // Of few trial pressures there are fewer entries than go abreast.
                let own: [&[f64]; ABREAST] =
                    std::array::from_fn(|place| &values[(entry + place).min(entries - 1) * count..][..count]);
                let mut sums = [Lanes::<WIDTH>::zero(); ABREAST];
                for node in 0..count {
                    for (sum, own) in sums.iter_mut().zip(own) {
                        *sum = sum.minus_product(-weights[node], Lanes::from_f64(own[node]));
                    }
                }
                for (sum, moved) in sums.iter().zip(moved[entry * count..].chunks_exact_mut(count)) {
                    moved[chunk * LANES..][..LANES].copy_from_slice(&sum.0);
                }
            }
        }
    }
}

/// Nodes of most spaces at most.
const FEW_NODES: usize = 24;

/// Entries that are combined side by side: each waits for itself alone.
const ABREAST: usize = 7;

/// Chunks that even degrees take, below a count, and odd ones.
fn chunks_of_parity(count: usize) -> usize {
    (count / 2).div_ceil(LANES)
}

/// Where a degree below a count is, in lane degree / 2.
#[inline(always)]
pub(super) fn chunk_of(count: usize, degree: usize) -> usize {
    degree % 2 * chunks_of_parity(count) + degree / 2 / LANES
}

/// The reverse.
fn degree_at(count: usize, chunk: usize, lane: usize) -> usize {
    let chunks = chunks_of_parity(count);
    2 * (chunk % chunks * LANES + lane) + chunk / chunks
}
