//! The curve of a joint: its states between a few arcs.
//!
//! What `edge` finds at an arc is smooth down to the angle zero once S is without its logarithm (of z, whose square is b but for
//! a smooth factor), and N/b^2, V/b^2 and Q/b^4 are taken in place of N, V and Q. So the equations are solved at a few nodes,
//! and between them these functions are polynomials: a load costs no system of equations.
//!
//! A bed adds to the compliance what grows like 1/b. With s = b (c + lambda)/(c b + lambda) the functions s S, N/(s b^2) and
//! Q/(s b^4) are smooth beside beds, too; without one s is 1.

use pulp::{Arch, Simd, WithSimd};

use super::edge::{Edge, EdgeStates, Reduced};
use super::load::{DimensionlessLoad, NoState};
use super::search::Loads;
use super::state::ContactState;
use crate::mechanics::compliance::arc::ContactArc;
use crate::mechanics::compliance::pressure_space::{JointCompliance, PressureSpace};
use crate::mechanics::real::{LANES, Lanes, Real};

/// The arcs of curves up to a limit: Chebyshev nodes in z, tan(eps/4) = tan(limit/4) z^2, which needs no logarithm and no
/// angle to go from z to b.
pub struct CurveSpace {
    pub pressures: PressureSpace,
    /// The largest contact half angle, rad.
    pub limit: f64,
    /// tan(limit/4).
    steepest: f64,
    pub(super) ln_z: Vec<f64>,
    /// Of the Chebyshev transform: `[degree][node]`.
    transform: Vec<Vec<f64>>,
}

impl CurveSpace {
    /// `terms` trial pressures at so many nodes, a multiple of `LANES`, up to a half angle, rad.
    pub fn new(terms: usize, nodes: usize, limit: f64) -> CurveSpace {
        let steepest = (0.25 * limit).tan();
        let angle = |node: usize| std::f64::consts::PI * (node as f64 + 0.5) / nodes as f64;
        let z: Vec<f64> = (0..nodes).map(|node| 0.5 * (1.0 + angle(node).cos())).collect();
        let arcs = z.iter().map(|z| ContactArc::new(4.0 * (steepest * z * z).atan())).collect();
        let of_degree = |degree: usize| {
            let scale = if degree == 0 { 1.0 } else { 2.0 } / nodes as f64;
            (0..nodes).map(|node| scale * (degree as f64 * angle(node)).cos()).collect()
        };
        CurveSpace {
            pressures: PressureSpace::new(terms, arcs),
            limit,
            steepest,
            ln_z: z.iter().map(|z| z.ln()).collect(),
            transform: (0..nodes).map(of_degree).collect(),
        }
    }

    /// The arcs of the nodes, descending.
    pub fn arcs(&self) -> &[ContactArc] {
        &self.pressures.arcs
    }

    #[inline(always)]
    pub(super) fn b<const FUSED: bool>(&self, z: Lanes<FUSED>) -> Lanes<FUSED> {
        let quarter = Lanes::from_f64(self.steepest) * z * z;
        (quarter + quarter) / Lanes::from_f64(1.0).minus_product(quarter, quarter)
    }
}

/// What leaving out further polynomials costs, over what the highest have, where that is above 1e-5: `tests/curves.rs` holds it.
const CURVE_SHARE: f64 = 0.5;

/// Functions whose polynomials tell the error of force and energy: all but those of the peak pressure.
const DECISIVE: usize = 5;

/// The curve of a joint.
pub struct ContactCurve<'a> {
    pub(super) space: &'a CurveSpace,
    even: f64,
    bed: f64,
    /// In z: `[degree][function]`, in the order of `Reduced`.
    pub(super) coefficients: Vec<[f64; LANES]>,
    pub(super) curve_error: f64,
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
        for ((Edge { reduced, .. }, arc), ln_z) in states.edges.iter().zip(space.arcs()).zip(&space.ln_z) {
            let scale = scale(even, bed, arc.b);
            functions.push([
                scale * (reduced.singular + std::f64::consts::PI * even * ln_z),
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
        let coefficients = Arch::new().dispatch(Transform { rows: &space.transform, values: &functions });
        let share = |function: usize| {
            let of_degrees = coefficients.iter().map(|of_degree| of_degree[function].abs());
            let most = of_degrees.clone().fold(f64::MIN_POSITIVE, f64::max);
            of_degrees.skip(count - 2).sum::<f64>() / most
        };
        let curve_error = CURVE_SHARE * (0..DECISIVE).map(share).fold(0.0, f64::max);
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
        Some(ContactCurve { space, even, bed, coefficients, curve_error, states, first })
    }

    /// What polynomials come to at z, b being the arc's.
    #[inline(always)]
    pub(super) fn reduced<const FUSED: bool>(
        &self,
        z: Lanes<FUSED>,
        ln_z: Lanes<FUSED>,
        b: Lanes<FUSED>,
    ) -> Reduced<Lanes<FUSED>> {
        const FUNCTIONS: usize = 7;
        let number = Lanes::<FUSED>::from_f64;
        let turn = number(2.0) - number(4.0) * z;
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
        let [smooth, edge, edge_of_versine, versine, work, peak, peak_of_versine] = current;
        let logarithm = number(std::f64::consts::PI * self.even);
        if self.bed == 0.0 {
            let singular = smooth.minus_product(logarithm, ln_z);
            return Reduced { singular, edge, edge_of_versine, versine, work, peak, peak_of_versine };
        }
        let scale = scale(self.even, self.bed, b);
        Reduced {
            singular: (smooth / scale).minus_product(logarithm, ln_z),
            edge,
            edge_of_versine: edge_of_versine * scale,
            versine,
            work: work * scale,
            peak,
            peak_of_versine: peak_of_versine * scale,
        }
    }

    /// The states under loads (> 0), for a radial clearance over the hole's radius, >= 0, each with the widest node that is not
    /// wider: what is known node by node holds between it and the next.
    pub fn states(
        &self,
        clearance: f64,
        loads: impl Iterator<Item = DimensionlessLoad>,
    ) -> Vec<Result<(ContactState, usize), NoState>> {
        let mut states = Vec::new();
        Arch::new().dispatch(Loads { curve: self, clearance, loads, states: &mut states });
        states
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

impl WithSimd for Transform<'_> {
    type Output = Vec<[f64; LANES]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        if S::IS_SCALAR { self.run::<false>() } else { self.run::<true>() }
    }
}

impl Transform<'_> {
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
