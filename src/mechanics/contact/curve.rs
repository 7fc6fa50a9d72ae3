//! The curve of a joint: its states between a few arcs.
//!
//! What `edge` finds at an arc is smooth once S is without its logarithm, and N/b^2, V/b^2 and Q/b^4 are taken in place of N, V
//! and Q. So the equations are solved at a few nodes, and between them these functions are polynomials: a load costs no system
//! of equations. They are polynomials of z, tan(eps/4) = tan(limit/4) z^2, down to the angle zero.
//!
//! A bed adds to the compliance what grows like 1/b: as contact becomes wider than lambda/c the elastic part takes over from the
//! bed, at b of any smallness. Beside beds the functions are polynomials of ln b, and with s = b (c + lambda)/(c b + lambda) it is
//! s S, N/(s b^2) and Q/(s b^4) that are bounded.

use super::edge::{Edge, EdgeStates, Reduced};
use crate::mechanics::compliance::arc::ContactArc;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::compliance::pressure_space::{JointCompliance, PressureSpace};
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
    pub pressures: PressureSpace,
    /// The largest contact half angle, rad.
    pub limit: f64,
    variable: Variable,
    /// tan(limit/4), or ln tan(limit/2).
    widest: f64,
    /// Logarithm of z, or of b, at the nodes: where loads are searched.
    pub(super) logarithms: Vec<f64>,
    /// Of the Chebyshev transform: `[degree][node]`.
    transform: Vec<Vec<f64>>,
}

impl CurveSpace {
    /// `terms` trial pressures at so many nodes, a multiple of `LANES`, up to a half angle, rad.
    pub fn new(variable: Variable, terms: usize, nodes: usize, limit: f64) -> CurveSpace {
        let angle = |node: usize| std::f64::consts::PI * (node as f64 + 0.5) / nodes as f64;
        // From 0 to 1.
        let units = (0..nodes).map(|node| 0.5 * (1.0 + angle(node).cos()));
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
            transform: (0..nodes).map(of_degree).collect(),
        }
    }

    /// The arcs of the nodes, descending.
    pub fn arcs(&self) -> &[ContactArc] {
        &self.pressures.arcs
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

    /// What of S is left out of its polynomials goes with this times the logarithm: a logarithm is a polynomial of itself.
    fn logarithm_share(&self, even: f64) -> f64 {
        match self.variable {
            Variable::Root => std::f64::consts::PI * even,
            Variable::Logarithm => 0.0,
        }
    }
}

/// Functions whose polynomials tell the error of force and energy: all but those of the peak pressure.
const DECISIVE: usize = 5;

/// The curve of a joint.
pub struct ContactCurve<'a> {
    pub space: &'a CurveSpace,
    even: f64,
    bed: f64,
    /// `[degree][function]`, in the order of `Reduced`.
    pub(super) coefficients: Vec<[f64; LANES]>,
    pub(super) curve_error: f64,
    /// `ContactState::curve_error` where the compliance is itself not exact: what meshes and fits leave does not fall with the degree.
    pub rough_error: f64,
    /// What is known node by node.
    pub states: EdgeStates,
    /// The widest node that a load can reach, and no node from there on.
    pub(super) first: usize,
}

impl<'a> ContactCurve<'a> {
    /// Of a joint's compliance in the space. `None` where it is not positive definite.
    pub fn new(space: &'a CurveSpace, joint: &JointCompliance) -> Option<ContactCurve<'a>> {
        let states = EdgeStates::new(&space.pressures, joint);
        let count = states.edges.len();
        let (even, bed) = (joint.even, joint.bed);
        let mut functions = Vec::with_capacity(count);
        let share = space.logarithm_share(even);
        for ((Edge { reduced, .. }, arc), logarithm) in
            states.edges.iter().zip(space.arcs()).zip(&space.logarithms)
        {
            let scale = scale(even, bed, arc.b);
            functions.push([
                scale * (reduced.singular + share * logarithm),
                reduced.edge,
                reduced.edge_of_versine / scale,
                reduced.versine,
                reduced.work / scale,
                reduced.peak,
                reduced.peak_of_versine / scale,
                0.0,
            ]);
        }
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
        let mut curve =
            ContactCurve { space, even, bed, coefficients, curve_error: 0.0, rough_error: 0.0, states, first };
        curve.rough_error = SAFETY * curve.without(&functions, 2);
        curve.curve_error = SAFETY * curve.without(&functions, FOUR) * curve.falling();
        Some(curve)
    }

    /// What force and indentation change, relative, at the worst of the nodes that loads reach, if so many last coefficients are
    /// dropped.
    fn without(&self, functions: &[[f64; LANES]], count: usize) -> f64 {
        let nodes = functions.len();
        let mut worst = 0.0_f64;
        for node in self.first..nodes {
            let mut left = functions[node];
            for degree in nodes - count..nodes {
                let share = 0.5 * nodes as f64 * self.space.transform[degree][node];
                left.iter_mut().zip(&self.coefficients[degree]).for_each(|(value, of)| *value -= share * of);
            }
            let b = self.space.arcs()[node].b;
            let found = self.from_functions(&left, self.space.logarithms[node], b).free_edge(b);
            let known = &self.states.edges[node].free;
            for (found, known) in [(found.force, known.force), (found.indentation, known.indentation)] {
                worst = worst.max((found / known - 1.0).abs());
            }
        }
        worst
    }

    /// What is left out of the polynomials over the last four coefficients, if they go on falling as the last eight do.
    fn falling(&self) -> f64 {
        let nodes = self.coefficients.len();
        let sum = |from: usize| -> f64 {
            let size = |function: usize| {
                let sizes = self.coefficients.iter().map(|of_degree| of_degree[function].abs());
                let most = sizes.clone().fold(f64::MIN_POSITIVE, f64::max);
                sizes.skip(from).take(FOUR).sum::<f64>() / most
            };
            (0..DECISIVE).map(size).sum()
        };
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
        const FUNCTIONS: usize = 7;
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
        (self.from_functions(&current, Lanes(logarithms), b), b)
    }

    /// From what is a polynomial to the functions themselves.
    #[inline(always)]
    fn from_functions<T: Real>(&self, functions: &[T], logarithm: T, b: T) -> Reduced<T> {
        let share = T::from_f64(self.space.logarithm_share(self.even));
        let scale = scale(self.even, self.bed, b);
        Reduced {
            singular: (functions[0] / scale).minus_product(share, logarithm),
            edge: functions[1],
            edge_of_versine: functions[2] * scale,
            versine: functions[3],
            work: functions[4] * scale,
            peak: functions[5],
            peak_of_versine: functions[6] * scale,
        }
    }

    /// The greater of what is known at the nodes around a state.
    pub fn around(node: usize, of_nodes: &[f64]) -> f64 {
        of_nodes[node].max(of_nodes[(node + 1).min(of_nodes.len() - 1)])
    }
}

/// s.
#[inline(always)]
fn scale<T: Real>(even: f64, bed: f64, b: T) -> T {
    let number = T::from_f64;
    if bed == 0.0 { number(1.0) } else { b * number(even + bed) / (number(even) * b + number(bed)) }
}

/// From values at the nodes, `[node][function]`, to Chebyshev coefficients, `[degree][function]`.
struct Transform<'a> {
    rows: &'a [Vec<f64>],
    values: &'a [[f64; LANES]],
}

impl LaneWork for Transform<'_> {
    type Output = Vec<[f64; LANES]>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<[f64; LANES]> {
        let mut coefficients = Vec::with_capacity(self.rows.len());
        for row in self.rows {
            let mut sum = Lanes::<FUSED>::zero();
            for (values, weight) in self.values.iter().zip(row) {
                sum = sum.minus_product(Lanes::from_f64(-weight), Lanes(*values));
            }
            coefficients.push(sum.0);
        }
        coefficients
    }
}

/// Between nodes more is left out than at them.
const SAFETY: f64 = 2.0;

/// Coefficients that are taken together.
const FOUR: usize = 4;

/// How much faster or slower than this the coefficients of a function fall, four by four, is not told by eight of them
/// (`tests/curves.rs` holds what follows).
const LEAST_RATIO: f64 = 0.5;
const GREATEST_RATIO: f64 = 0.9;
