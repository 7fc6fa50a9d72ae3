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

use super::edge::{DECISIVE, Edge, EdgeStates, FUNCTIONS, Reduced};
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
    /// Logarithm of z, or of b, at the nodes: where loads are searched.
    pub(super) logarithms: Vec<f64>,
    /// What functions are polynomials of, from 0 to 1, at the nodes, x_i, and 1/product of all x_i - x_j.
    weighted: Vec<(f64, f64)>,
    /// Of the Chebyshev transform: `[degree][node]`.
    transform: Vec<Vec<f64>>,
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
        let of_degree = |degree: usize| {
            let scale = if degree == 0 { 1.0 } else { 2.0 } / nodes as f64;
            (0..nodes).map(|node| scale * (degree as f64 * angle(node)).cos()).collect()
        };
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
            logarithms,
            weighted: (0..nodes).map(|node| (unit(node), weight(node))).collect(),
            transform: (0..nodes).map(of_degree).collect(),
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

    /// Whether a curve goes on below its narrowest node, to the angle zero.
    pub(super) fn goes_to_zero(&self) -> bool {
        self.variable == Variable::Root
    }

    /// From logarithms to what polynomials are of, from 0 to 1, and b.
    #[inline(always)]
    pub(super) fn places<const FUSED: bool>(&self, logarithms: [f64; LANES]) -> [Lanes<FUSED>; 2] {
        let number = Lanes::<FUSED>::from_f64;
        let powers = Lanes::<FUSED>(logarithms.map(f64::exp));
        match self.variable {
            Variable::Root => {
                let quarter = number(self.widest) * powers * powers;
                let b = (quarter + quarter) / number(1.0).minus_product(quarter, quarter);
                [powers, b]
            }
            Variable::Logarithm => {
                let scale = 1.0 / NARROWEST.ln();
                [Lanes(logarithms.map(|logarithm| 1.0 - scale * (logarithm - self.widest))), powers]
            }
        }
    }

    /// The same of one b, that the polynomials reach down to.
    pub(super) fn place(&self, b: f64) -> f64 {
        match self.variable {
            // tan(eps/4) from tan(eps/2).
            Variable::Root => (b / (1.0 + (1.0 + b * b).sqrt()) / self.widest).sqrt(),
            // Below the narrowest contact nothing but the bed changes.
            Variable::Logarithm => {
                (1.0 - (b.ln() - self.widest) / NARROWEST.ln()).max(self.weighted[self.weighted.len() - 1].0)
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
    /// `[degree][function]`, in the order of `Reduced::functions`.
    pub(super) coefficients: Vec<Functions>,
    /// The same at the nodes.
    functions: Vec<Functions>,
    /// What is known node by node.
    pub states: EdgeStates,
    /// The widest node that a load can reach, and no node from there on.
    pub(super) first: usize,
}

impl<'a> ContactCurve<'a> {
    /// Of a joint's compliance in the space. `None` where it is not positive definite.
    pub fn new(
        space: &'a CurveSpace,
        joint: &JointCompliance,
        outlines: Outlines,
    ) -> Option<ContactCurve<'a>> {
        let states = EdgeStates::new(&space.pressures, joint, &outlines);
        let count = states.edges.len();
        let (even, bed) = (joint.even, joint.bed);
        let share = space.logarithm_share(even);
        let nodes = states.edges.iter().zip(space.arcs()).zip(&space.logarithms);
        let of_node = |((Edge { reduced, .. }, arc), logarithm): ((&Edge, &ContactArc), &f64)| {
            let singular = reduced.singular + share * logarithm;
            let own = Reduced { singular, ..*reduced };
            let own = if bed == 0.0 { own } else { own.scaled(scale(even, bed, arc.b)) }.functions();
            let mut padded = [0.0; ROW];
            padded[..FUNCTIONS].copy_from_slice(&own);
            padded
        };
        let functions: Vec<Functions> = nodes.map(of_node).collect();
        if !functions.iter().flatten().all(|value| value.is_finite()) {
            return None;
        }
        let coefficients = in_lanes(Transform { rows: &space.transform, values: &functions });
        // Up to the first beyond a neat fit, and no further than the contact grows with the load: the pressure is the sum of what
        // punches of all smaller arcs add as the contact grows, each of them positive. Where it grows with the load the pressure
        // is positive and the gap beyond it open, and only there.
        let (mut first, mut before) = (count, 0.0);
        for (node, edge) in states.edges.iter().enumerate().rev() {
            let grown = edge.free.indentation;
            // Not where it is NaN.
            if !edge.is_sound() || grown.is_nan() || grown <= before {
                break;
            }
            first = node;
            before = grown;
            if grown >= 1.0 {
                break;
            }
        }
        Some(ContactCurve { space, outlines, even, bed, functions, coefficients, states, first })
    }

    /// Bound of the relative error of force and energy that the curve leaves between its nodes. Where the compliance is itself not exact
    /// there is the noise of meshes and fits between them, which does not fall with the degree.
    pub fn error(&self, is_exact: bool) -> f64 {
        if is_exact {
            SAFETY * in_lanes(Without { curve: self }) * self.falling()
        } else {
            let nodes = self.coefficients.len();
            let last_two = |function| self.share(function, nodes - 2, 2);
            ROUGH * (0..DECISIVE).map(last_two).fold(0.0, f64::max)
        }
    }

    /// So many coefficients of a function from one on, over the greatest.
    fn share(&self, function: usize, from: usize, count: usize) -> f64 {
        let sizes = self.coefficients.iter().map(|of_degree| of_degree[function].abs());
        let most = sizes.clone().fold(f64::MIN_POSITIVE, f64::max);
        sizes.skip(from).take(count).sum::<f64>() / most
    }

    /// What is left out of the polynomials over the last four coefficients, if they go on falling as the last eight do.
    fn falling(&self) -> f64 {
        let nodes = self.coefficients.len();
        let sum =
            |from: usize| -> f64 { (0..DECISIVE).map(|function| self.share(function, from, FOUR)).sum() };
        let before = sum(nodes - 2 * FOUR).max(f64::MIN_POSITIVE);
        let ratio = (sum(nodes - FOUR) / before).clamp(LEAST_RATIO, GREATEST_RATIO);
        ratio / (1.0 - ratio)
    }

    /// What polynomials come to at logarithms, with b.
    #[inline(always)]
    pub(super) fn reduced<const FUSED: bool>(
        &self,
        logarithms: [f64; LANES],
    ) -> (Reduced<Lanes<FUSED>>, Lanes<FUSED>) {
        let number = Lanes::<FUSED>::from_f64;
        let [place, b] = self.space.places(logarithms);
        let turn = number(2.0) - number(4.0) * place;
        // Clenshaw's sums, all functions side by side: no addition waits for the one before.
        let mut current = [Lanes::<FUSED>::zero(); FUNCTIONS];
        let mut previous = current;
        for of_degree in self.coefficients[1..].iter().rev() {
            for function in 0..FUNCTIONS {
                let next =
                    (number(of_degree[function]) - previous[function]).minus_product(turn, current[function]);
                (current[function], previous[function]) = (next, current[function]);
            }
        }
        let half = number(0.5) * turn;
        for (function, sum) in current.iter_mut().enumerate() {
            *sum = (number(self.coefficients[0][function]) - previous[function]).minus_product(half, *sum);
        }
        (self.reduced_of(current, Lanes(logarithms), b), b)
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
        let mut weights = vec![Lanes::<FUSED>::zero(); count];
        for chunk in 0..count / LANES {
            let wanted =
                std::array::from_fn(|lane| space.place(space.arcs()[chunk * LANES + lane].b / ratio));
            // Lagrange's polynomials: products of the distances to all nodes before, then to all behind.
            let wanted = Lanes::<FUSED>(wanted);
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
            let last = values.len() / count - ABREAST;
            for entry in (0..=last).step_by(ABREAST).chain((!last.is_multiple_of(ABREAST)).then_some(last)) {
                let own: [&[f64]; ABREAST] =
                    std::array::from_fn(|place| &values[(entry + place) * count..][..count]);
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
const ABREAST: usize = 3;

/// One number of each function, in whole registers.
type Functions = [f64; ROW];
const ROW: usize = FUNCTIONS.next_multiple_of(LANES);

/// Degrees that are summed side by side: each waits for itself alone.
const ROWS: usize = 4;

/// From values at the nodes, `[node][function]`, to Chebyshev coefficients, `[degree][function]`.
struct Transform<'a> {
    rows: &'a [Vec<f64>],
    values: &'a [Functions],
}

impl LaneWork for Transform<'_> {
    type Output = Vec<Functions>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<Functions> {
        let Transform { rows, values } = self;
        let half = values.len() / 2;
        let mut coefficients = Vec::with_capacity(rows.len());
        for rows in rows.as_chunks::<ROWS>().0 {
            let mut sums = [[Lanes::<FUSED>::zero(); ROW / LANES]; ROWS];
            for node in 0..half {
                // Even degrees are the same at the node opposite, odd ones its negative.
                let [near, far] =
                    [node, values.len() - 1 - node].map(|node| values[node].as_chunks::<LANES>().0);
                for lanes in 0..ROW / LANES {
                    let (near, far) = (Lanes::<FUSED>(near[lanes]), Lanes(far[lanes]));
                    let of_parity = [near + far, near - far];
                    for (degree, (sums, row)) in sums.iter_mut().zip(rows).enumerate() {
                        sums[lanes] =
                            sums[lanes].minus_product(Lanes::from_f64(-row[node]), of_parity[degree % 2]);
                    }
                }
            }
            for sums in sums {
                coefficients.push(std::array::from_fn(|function| sums[function / LANES].0[function % LANES]));
            }
        }
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
        let ContactCurve { space, functions, coefficients, states, first, .. } = self.curve;
        let count = functions.len();
        let mut worst = 0.0_f64;
        for at in (first / LANES * LANES..count).step_by(LANES) {
            let lanes = |of: &dyn Fn(usize) -> f64| Lanes::<FUSED>(std::array::from_fn(|lane| of(at + lane)));
            let mut left: [Lanes<FUSED>; FUNCTIONS] = std::array::from_fn(|function| {
                Lanes(std::array::from_fn(|lane| functions[at + lane][function]))
            });
            for degree in count - FOUR..count {
                let mut share = Lanes::<FUSED>::zero();
                share.0.copy_from_slice(&space.transform[degree][at..at + LANES]);
                let share = share * Lanes::from_f64(0.5 * count as f64);
                for (value, coefficient) in left[..DECISIVE].iter_mut().zip(&coefficients[degree]) {
                    *value = value.minus_product(share, Lanes::from_f64(*coefficient));
                }
            }
            let b = lanes(&|node| space.arcs()[node].b);
            let logarithm = lanes(&|node| space.logarithms[node]);
            let found = self.curve.reduced_of(left, logarithm, b).free_edge(b, &self.curve.outlines);
            for node in at.max(*first)..at + LANES {
                let known = &states.edges[node].free;
                let found = [found.force, found.indentation].map(|lanes| lanes.0[node - at]);
                for (found, known) in found.into_iter().zip([known.force, known.indentation]) {
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
