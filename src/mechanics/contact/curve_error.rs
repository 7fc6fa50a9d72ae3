//! What a curve leaves between its nodes, told by the last of its coefficients.

use super::curve::ContactCurve;
use super::reduced::DECISIVE;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes, Real};

impl ContactCurve<'_> {
    /// Bound of the relative error of force and energy that the curve leaves between its nodes, of states behind `widest` and all
    /// narrower ones. Where the compliance is itself not exact there is the noise of meshes and fits between them, which does not fall
    /// with the degree.
    pub fn error(&self, is_exact: bool, widest: usize) -> f64 {
        let first = widest.saturating_sub(BESIDE).max(self.first);
        if is_exact {
            return SAFETY * in_lanes(Without { curve: self, first }) * self.falling();
        }
        let nodes = self.states.count();
        let last_two = |function| self.share(function, nodes - 2, 2);
        let noise = (0..DECISIVE).map(last_two).fold(0.0, f64::max);
        // Over the greatest coefficient little where functions change by orders of magnitude.
        let of_loads = match self.space.is_beside_beds() {
            true => in_lanes(Without { curve: self, first }),
            false => 0.0,
        };
        ROUGH * noise.max(of_loads)
    }

    /// What the last coefficients are worth, at the worst of the nodes that loads reach.
    pub(super) fn left_out(&self) -> f64 {
        in_lanes(Without { curve: self, first: self.first })
    }

    /// So many coefficients of a function from one on, over the greatest; those of the logarithm of S are relative as they are.
    fn share(&self, function: usize, from: usize, count: usize) -> f64 {
        let own = (from..from + count).map(|degree| self.coefficient(degree, function).abs()).sum::<f64>();
        if function == 0 && self.has_logarithm() {
            return own;
        }
        // Lane by lane, which the compiler keeps in registers.
        let mut most = [f64::MIN_POSITIVE; LANES];
        for chunk in &self.coefficients {
            for (most, value) in most.iter_mut().zip(&chunk[function]) {
                *most = if value.abs() > *most { value.abs() } else { *most };
            }
        }
        let most = most.into_iter().fold(0.0, f64::max);
        own / most
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
}

/// What force and indentation change, relative, at the worst of the nodes from one on, if the last four coefficients are dropped.
struct Without<'a> {
    curve: &'a ContactCurve<'a>,
    first: usize,
}

impl LaneWork for Without<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> f64 {
        let (ContactCurve { space, states, .. }, first) = (self.curve, self.first);
        let count = states.count();
        let mut worst = 0.0_f64;
        for at in (first / LANES * LANES..count).step_by(LANES) {
            let lanes = |of: &dyn Fn(usize) -> f64| Lanes::<WIDTH>(std::array::from_fn(|lane| of(at + lane)));
            let mut left = states.functions(at / LANES).map(Lanes::<WIDTH>);
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
            for node in at.max(first)..at + LANES {
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

/// Nodes before a state whose changes count as well: between some nodes a polynomial happens to change little.
const BESIDE: usize = 3;

/// Coefficients that are taken together.
const FOUR: usize = 4;

/// Nodes between which noise is interpolated make this of the last two coefficients, about.
pub const ROUGH: f64 = 2.0;

/// How much faster or slower than this the coefficients of a function fall, four by four, is not told by eight of them
/// (`tests/mechanics/curves.rs` holds what follows).
const LEAST_RATIO: f64 = 0.5;
const GREATEST_RATIO: f64 = 0.9;
