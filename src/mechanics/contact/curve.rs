//! The curve of a joint: its states between a few arcs.
//!
//! What `edge` finds at an arc is smooth once S is without its logarithm, and N/b^2, V/b^2 and Q/b^4 are taken in place of N, V
//! and Q, and so on. So the equations are solved at a few nodes, and between them these functions are polynomials: a load costs no system
//! of equations. They are polynomials of z, tan(eps/4) = tan(limit/4) z^2, down to the angle zero.
//!
//! A bed adds to the compliance what grows like 1/b: as contact becomes wider than lambda/c the elastic part takes over from the
//! bed, at b of any smallness. Beside beds the functions are polynomials of ln b, and with s = b (c + lambda)/(c b + lambda) it is
//! s S, N/(s b^2) and Q/(s b^4) that are bounded.

use std::f64::consts::FRAC_PI_2;

use super::edge::{DECISIVE, EdgeStates, FUNCTIONS, Functions, OF_LOAD, Reduced};
use super::outlines::Outlines;
use crate::mechanics::body::Side;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::arc::ContactArc;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::compliance::pressure_space::{JointCompliance, PressureSpace, Tilt};
use crate::mechanics::compliance::thin_wall::bed_matrix;
use crate::mechanics::real::{LANES, Lanes, Real};

/// What the functions of a curve are polynomials of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Variable {
    /// z.
    Root,
    /// ln b, down to `NARROWEST` of its limit.
    Logarithm,
}

/// The most nodes of a space.
pub const MOST_NODES: usize = 96;

/// The narrowest contact beside beds over the widest.
const NARROWEST: f64 = 1e-9;

/// The arcs of curves up to a limit: Chebyshev nodes in a variable.
pub struct CurveSpace {
    /// On arcs of the pin.
    pub pressures: PressureSpace,
    /// The largest contact half angle of the pin, rad.
    pub limit: f64,
    variable: Variable,
    /// tan(limit/4), or ln tan(limit/2).
    widest: f64,
    /// z^2, or b, at the nodes: where loads are searched.
    pub(super) places: Vec<f64>,
    /// Logarithms of z, or of b.
    logarithms: Vec<f64>,
    /// What functions are polynomials of, from 0 to 1, at the nodes, x_i, and 1/product of all x_i - x_j.
    weighted: Vec<(f64, f64)>,
    /// T_degree(x) of the Chebyshev nodes x > 0: `[degree / LANES][node]`, as many degrees as there are lanes. Even degrees before odd
    /// ones, each in whole chunks.
    chebyshev: Vec<Vec<[f64; LANES]>>,
}

impl CurveSpace {
    /// `terms` trial pressures at so many nodes, a multiple of `LANES`, up to a half angle, rad.
    pub fn new(variable: Variable, terms: usize, nodes: usize, limit: f64) -> CurveSpace {
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
        };
        let logarithms: Vec<f64> = match variable {
            Variable::Root => units.map(f64::ln).collect(),
            Variable::Logarithm => units.map(|unit| widest + (1.0 - unit) * NARROWEST.ln()).collect(),
        };
        let chebyshev = (0..2 * chunks_of_parity(nodes)).map(|chunk| {
            let degree = |lane: usize| degree_at(nodes, chunk, lane) as f64;
            (0..nodes / 2)
                .map(|node| std::array::from_fn(|lane| (degree(lane) * angle(node)).cos()))
                .collect()
        });
        let half_angle = |logarithm: &f64| match variable {
            Variable::Root => 4.0 * (widest * (2.0 * logarithm).exp()).atan(),
            Variable::Logarithm => 2.0 * logarithm.exp().atan(),
        };
        CurveSpace {
            pressures: PressureSpace::new(
                terms,
                logarithms.iter().map(|logarithm| ContactArc::new(half_angle(logarithm))).collect(),
            ),
            limit,
            variable,
            widest,
            places: match variable {
                Variable::Root => (0..nodes).map(|node| unit(node) * unit(node)).collect(),
                Variable::Logarithm => logarithms.iter().map(|logarithm| logarithm.exp()).collect(),
            },
            logarithms,
            weighted: (0..nodes).map(|node| (unit(node), weight(node))).collect(),
            chebyshev: chebyshev.collect(),
        }
    }

    /// The arcs of the nodes, descending.
    pub fn arcs(&self) -> &[ContactArc] {
        &self.pressures.arcs
    }

    /// The part of a joint's compliance of bodies of one side with their shares, as `PressureSpace::joint` has them: a pin's under its
    /// tilt, a plate's on the hole's arcs.
    pub fn part(
        &self,
        side: Side,
        bodies: &[(&BodyCompliance, f64)],
        outlines: &Outlines,
    ) -> JointCompliance<'static> {
        match side {
            Side::Pin => self.pressures.joint(bodies, outlines.tilt()),
            Side::Plate => {
                let (plate, mut moved) = (self.pressures.joint(bodies, Tilt::NONE), Vec::new());
                self.to_hole(&plate, outlines, &mut moved);
                JointCompliance { values: moved.into(), ..plate }
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
        moved.resize(plate.values.len(), 0.0);
        if plate.bed == 0.0 {
            in_lanes(OnHole { space: self, ratio: outlines.ratio(), values: &plate.values, moved });
        } else {
            for (place, arc) in self.arcs().iter().enumerate() {
                let matrix = bed_matrix(arc.b / outlines.ratio(), self.pressures.terms);
                for (entry, value) in matrix.into_iter().enumerate() {
                    moved[entry * count + place] = plate.bed * value;
                }
            }
        }
        // What is left out of entry (0, 0) goes with the pin's b, not the hole's.
        let logarithm = FRAC_PI_2 * plate.even * outlines.ratio().ln();
        moved[..count].iter_mut().for_each(|value| *value += logarithm);
    }

    /// T_degree at a node.
    fn chebyshev_at(&self, degree: usize, node: usize) -> f64 {
        let (count, is_far) = (self.arcs().len(), node >= self.arcs().len() / 2);
        let near = if is_far { count - 1 - node } else { node };
        let value = self.chebyshev[chunk_of(count, degree)][near][degree / 2 % LANES];
        if is_far && degree % 2 == 1 { -value } else { value }
    }

    /// Whether a curve goes on below its narrowest node, to the angle zero.
    pub(super) fn goes_to_zero(&self) -> bool {
        self.variable == Variable::Root
    }

    /// From places to what polynomials are of, from 0 to 1, b, and logarithms.
    #[inline(always)]
    fn at_places<const FUSED: bool>(&self, places: Lanes<FUSED>) -> [Lanes<FUSED>; 3] {
        let number = Lanes::<FUSED>::from_f64;
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
        }
    }

    /// The first of these from b, as far as the polynomials reach down.
    #[inline(always)]
    pub(super) fn place<const FUSED: bool>(&self, b: Lanes<FUSED>) -> Lanes<FUSED> {
        let number = Lanes::<FUSED>::from_f64;
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
        }
    }

    /// What of S is left out of its polynomials goes with this times the logarithm: a logarithm is a polynomial of itself.
    fn logarithm_share(&self, even: f64) -> f64 {
        match self.variable {
            Variable::Root => std::f64::consts::PI * even,
            Variable::Logarithm => 0.0,
        }
    }
}

/// The curve of a joint.
pub struct ContactCurve<'a> {
    pub space: &'a CurveSpace,
    pub outlines: Outlines,
    even: f64,
    bed: f64,
    /// Degrees as in `CurveSpace::chebyshev`, functions in the order of `Reduced::functions`.
    coefficients: Vec<Functions>,
    /// What is known node by node.
    pub states: EdgeStates,
    /// The widest node that a load can reach, and no node from there on.
    pub(super) first: usize,
}

impl<'a> ContactCurve<'a> {
    /// Of a joint's compliance in the space, which is the sum of its parts. `None` where it is not positive definite.
    pub fn new<const PARTS: usize>(
        space: &'a CurveSpace,
        parts: [&JointCompliance; PARTS],
        outlines: Outlines,
    ) -> Option<ContactCurve<'a>> {
        let mut states = EdgeStates::new(&space.pressures, parts, &outlines);
        let even: f64 = parts.iter().map(|part| part.even).sum();
        let bed: f64 = parts.iter().map(|part| part.bed).sum();
        // Up to the first beyond a neat fit, and no further than the contact grows with the load: the pressure is the sum of what
        // punches of all smaller arcs add as the contact grows, each of them positive. Where it grows with the load the pressure
        // is positive and the gap beyond it open, and only there.
        let (mut first, mut before) = (states.count(), 0.0);
        for node in (0..states.count()).rev() {
            let grown = states.indentation(node);
            // Not where it is NaN.
            if !states.is_sound(node) || grown.is_nan() || grown <= before {
                break;
            }
            first = node;
            before = grown;
            if grown >= 1.0 {
                break;
            }
        }
        // From here on what is reduced is what polynomials are of.
        let share = space.logarithm_share(even);
        let logarithms = space.logarithms.as_chunks::<LANES>().0;
        let nodes = states.functions_mut().zip(logarithms).zip(space.arcs().chunks(LANES));
        for ((functions, logarithms), arcs) in nodes {
            for (singular, logarithm) in functions[0].iter_mut().zip(logarithms) {
                *singular += share * logarithm;
            }
            if bed != 0.0 {
                let scale = Lanes::<false>(std::array::from_fn(|lane| scale(even, bed, arcs[lane].b)));
                let scaled = Reduced::of_functions(functions.map(Lanes)).scaled(scale);
                *functions = scaled.functions().map(|values| values.0);
            }
            if !functions.as_flattened().iter().all(|value| value.is_finite()) {
                return None;
            }
        }
        let coefficients = in_lanes(Transform { rows: &space.chebyshev, states: &states });
        Some(ContactCurve { space, outlines, even, bed, coefficients, states, first })
    }

    /// Bound of the relative error of force and energy that the curve leaves between its nodes. Where the compliance is itself not exact
    /// there is the noise of meshes and fits between them, which does not fall with the degree.
    pub fn error(&self, is_exact: bool) -> f64 {
        if is_exact {
            SAFETY * in_lanes(Without { curve: self }) * self.falling()
        } else {
            let nodes = self.states.count();
            let last_two = |function| self.share(function, nodes - 2, 2);
            ROUGH * (0..DECISIVE).map(last_two).fold(0.0, f64::max)
        }
    }

    /// Of a function, at a degree.
    #[inline(always)]
    fn coefficient(&self, degree: usize, function: usize) -> f64 {
        let (chunk, lane) = (chunk_of(self.states.count(), degree), degree / 2 % LANES);
        self.coefficients[chunk][function][lane]
    }

    /// So many coefficients of a function from one on, over the greatest.
    fn share(&self, function: usize, from: usize, count: usize) -> f64 {
        // Lane by lane, which the compiler keeps in registers.
        let mut most = [f64::MIN_POSITIVE; LANES];
        for chunk in &self.coefficients {
            for (most, value) in most.iter_mut().zip(&chunk[function]) {
                *most = if value.abs() > *most { value.abs() } else { *most };
            }
        }
        let most = most.into_iter().fold(0.0, f64::max);
        (from..from + count).map(|degree| self.coefficient(degree, function).abs()).sum::<f64>() / most
    }

    /// What is left out of the polynomials over the last four coefficients, if they go on falling as the last eight do.
    fn falling(&self) -> f64 {
        let nodes = self.states.count();
        let sum =
            |from: usize| -> f64 { (0..DECISIVE).map(|function| self.share(function, from, FOUR)).sum() };
        let before = sum(nodes - 2 * FOUR).max(f64::MIN_POSITIVE);
        let ratio = (sum(nodes - FOUR) / before).clamp(LEAST_RATIO, GREATEST_RATIO);
        ratio / (1.0 - ratio)
    }

    /// What the equations come to at places, as far as a load follows from it.
    #[inline(always)]
    pub(super) fn at<const FUSED: bool>(&self, places: Lanes<FUSED>) -> AtPlaces<FUSED> {
        let number = Lanes::<FUSED>::from_f64;
        let [unit, b, logarithms] = self.space.at_places(places);
        let turn = number(2.0) - number(4.0) * unit;
        let mut functions = [number(0.0); FUNCTIONS];
        functions[..OF_LOAD].copy_from_slice(&self.sums::<FUSED, 0, OF_LOAD>(turn));
        AtPlaces { b, turn, functions, reduced: self.reduced_of(functions, logarithms, b), logarithms }
    }

    /// And all of it.
    #[inline(always)]
    pub(super) fn whole<const FUSED: bool>(&self, at: &AtPlaces<FUSED>) -> Reduced<Lanes<FUSED>> {
        let mut functions = at.functions;
        functions[OF_LOAD..].copy_from_slice(&self.sums::<FUSED, OF_LOAD, { FUNCTIONS - OF_LOAD }>(at.turn));
        self.reduced_of(functions, at.logarithms, at.b)
    }

    /// Clenshaw's sums of functions from one on, side by side: no addition waits for the one before.
    #[inline(always)]
    fn sums<const FUSED: bool, const FROM: usize, const COUNT: usize>(
        &self,
        turn: Lanes<FUSED>,
    ) -> [Lanes<FUSED>; COUNT] {
        let number = Lanes::<FUSED>::from_f64;
        let mut current = [Lanes::<FUSED>::zero(); COUNT];
        let mut previous = current;
        let nodes = self.states.count();
        for degree in (0..nodes).rev() {
            let (of_degree, lane) = (&self.coefficients[chunk_of(nodes, degree)], degree / 2 % LANES);
            let turn = if degree == 0 { number(0.5) * turn } else { turn };
            for function in 0..COUNT {
                let next = (number(of_degree[FROM + function][lane]) - previous[function])
                    .minus_product(turn, current[function]);
                (current[function], previous[function]) = (next, current[function]);
            }
        }
        current
    }

    /// From what is a polynomial to the functions themselves.
    #[inline(always)]
    fn reduced_of<T: Real>(&self, functions: [T; FUNCTIONS], logarithm: T, b: T) -> Reduced<T> {
        let share = T::from_f64(self.space.logarithm_share(self.even));
        let mut reduced = Reduced::of_functions(functions);
        // Most joints have no bed, and nothing to scale.
        if self.bed != 0.0 {
            reduced = reduced.scaled(T::from_f64(1.0) / scale(self.even, self.bed, b));
        }
        reduced.singular = reduced.singular.minus_product(share, logarithm);
        reduced
    }

    /// The greater of what is known at the nodes around a state.
    pub fn around(node: usize, of_nodes: &[f64]) -> f64 {
        of_nodes[node].max(of_nodes[(node + 1).min(of_nodes.len() - 1)])
    }
}

/// What is known of the states at places on a curve.
pub(super) struct AtPlaces<const FUSED: bool> {
    /// Of the pin.
    pub(super) b: Lanes<FUSED>,
    /// Those `OF_LOAD`, the others being zero.
    pub(super) reduced: Reduced<Lanes<FUSED>>,
    functions: [Lanes<FUSED>; FUNCTIONS],
    /// -2 of the variable of the polynomials, from -1 to 1.
    turn: Lanes<FUSED>,
    logarithms: Lanes<FUSED>,
}

/// s, beside a bed.
#[inline(always)]
fn scale<T: Real>(even: f64, bed: f64, b: T) -> T {
    let number = T::from_f64;
    b * number(even + bed) / (number(even) * b + number(bed))
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
    fn run<const FUSED: bool>(self) {
        let OnHole { space, ratio, values, moved } = self;
        let number = Lanes::<FUSED>::from_f64;
        let count = space.weighted.len();
        let mut weights = [Lanes::<FUSED>::zero(); MOST_NODES];
        let weights = &mut weights[..count];
        for chunk in 0..count / LANES {
            let mut b = Lanes::<FUSED>::zero();
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
                let mut sums = [Lanes::<FUSED>::zero(); ABREAST];
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

/// Entries that are combined side by side: each waits for itself alone.
const ABREAST: usize = 7;

/// Chunks that even degrees take, below a count, and odd ones.
fn chunks_of_parity(count: usize) -> usize {
    (count / 2).div_ceil(LANES)
}

/// Where a degree below a count is, in lane degree / 2.
#[inline(always)]
fn chunk_of(count: usize, degree: usize) -> usize {
    degree % 2 * chunks_of_parity(count) + degree / 2 / LANES
}

/// The reverse.
fn degree_at(count: usize, chunk: usize, lane: usize) -> usize {
    let chunks = chunks_of_parity(count);
    2 * (chunk % chunks * LANES + lane) + chunk / chunks
}

/// From values at the nodes to Chebyshev coefficients.
struct Transform<'a> {
    rows: &'a [Vec<[f64; LANES]>],
    states: &'a EdgeStates,
}

impl LaneWork for Transform<'_> {
    type Output = Vec<Functions>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<Functions> {
        let Transform { rows, states } = self;
        let count = states.count();
        let (even, odd) = rows.split_at(rows.len() / 2);
        let mut coefficients = vec![[[0.0; LANES]; FUNCTIONS]; rows.len()];
        // Of degree 0 half as much.
        let share = Lanes::<FUSED>::from_f64(2.0 / count as f64);
        for chunk in 0..even.len() {
            let mut sums = [[Lanes::<FUSED>::zero(); FUNCTIONS]; 2];
            for (node, (even, odd)) in even[chunk].iter().zip(&odd[chunk]).enumerate() {
                let far = count - 1 - node;
                let (of_near, of_far) = (states.functions(node / LANES), states.functions(far / LANES));
                for function in 0..FUNCTIONS {
                    let (near, far) = (of_near[function][node % LANES], of_far[function][far % LANES]);
                    // Even degrees are the same at the node opposite, odd ones its negative.
                    let minus_sum = Lanes::from_f64(-near - far);
                    let minus_difference = Lanes::from_f64(far - near);
                    sums[0][function] = sums[0][function].minus_product(Lanes(*even), minus_sum);
                    sums[1][function] = sums[1][function].minus_product(Lanes(*odd), minus_difference);
                }
            }
            for parity in 0..2 {
                for function in 0..FUNCTIONS {
                    coefficients[parity * rows.len() / 2 + chunk][function] =
                        (sums[parity][function] * share).0;
                }
            }
        }
        coefficients[0].iter_mut().for_each(|sums| sums[0] *= 0.5);
        coefficients
    }
}

/// What force and indentation change, relative, at the worst of the nodes that loads reach, if the last four coefficients are
/// dropped.
struct Without<'a> {
    curve: &'a ContactCurve<'a>,
}

impl LaneWork for Without<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let ContactCurve { space, states, first, .. } = self.curve;
        let count = states.count();
        let mut worst = 0.0_f64;
        for at in (first / LANES * LANES..count).step_by(LANES) {
            let lanes = |of: &dyn Fn(usize) -> f64| Lanes::<FUSED>(std::array::from_fn(|lane| of(at + lane)));
            let mut left = states.functions(at / LANES).map(Lanes::<FUSED>);
            for degree in count - FOUR..count {
                let share = lanes(&|node| space.chebyshev_at(degree, node));
                for (function, value) in left[..DECISIVE].iter_mut().enumerate() {
                    *value =
                        value.minus_product(share, Lanes::from_f64(self.curve.coefficient(degree, function)));
                }
            }
            let b = lanes(&|node| space.arcs()[node].b);
            let logarithm = lanes(&|node| space.logarithms[node]);
            let found = self.curve.reduced_of(left, logarithm, b).free_edge(b, &self.curve.outlines);
            for node in at.max(*first)..at + LANES {
                let found = [found.force, found.indentation].map(|lanes| lanes.0[node - at]);
                for (found, known) in found.into_iter().zip([states.force(node), states.indentation(node)]) {
                    worst = worst.max((found / known - 1.0).abs());
                }
            }
        }
        worst
    }
}

/// Between nodes more is left out than at them.
const SAFETY: f64 = 2.0;

/// Coefficients that are taken together.
const FOUR: usize = 4;

/// Nodes between which noise is interpolated make this of the last two coefficients, about.
const ROUGH: f64 = 2.0;

/// How much faster or slower than this the coefficients of a function fall, four by four, is not told by eight of them
/// (`tests/mechanics/curves.rs` holds what follows).
const LEAST_RATIO: f64 = 0.5;
const GREATEST_RATIO: f64 = 0.9;
