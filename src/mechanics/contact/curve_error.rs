//! What a curve leaves between its nodes, told by the last of its coefficients.

use smallvec::SmallVec;

use super::curve::ContactCurve;
use super::curve_space::MOST_NODES;
use super::reduced::DECISIVE;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes, Real};

impl ContactCurve<'_> {
    /// Bounds of the relative error of force and energy that the curve leaves between its nodes. Where the compliance is itself not exact
    /// there is the noise of meshes and fits between them, which does not fall with the degree.
    pub fn errors(&self, is_exact: bool) -> CurveErrors {
        if is_exact {
            let scale = SAFETY * self.falling();
            return CurveErrors { everywhere: 0.0, of_nodes: self.of_nodes(scale) };
        }
        let nodes = self.states.count();
        let last_two = |function| self.share(function, nodes - 2, 2);
        let everywhere = ROUGH * (0..DECISIVE).map(last_two).fold(0.0, f64::max);
        // Over the greatest coefficient little where functions change by orders of magnitude.
        let of_nodes = if self.space.is_beside_beds() { self.of_nodes(ROUGH) } else { OfNodes::new() };
        CurveErrors { everywhere, of_nodes }
    }

    /// What the last coefficients are worth, at the worst of the nodes that loads reach.
    pub(super) fn left_out(&self) -> f64 {
        CurveErrors { everywhere: 0.0, of_nodes: self.of_nodes(1.0) }.up_to(0)
    }

    /// The same at each node or one behind it, times a scale; of those that no load reaches that of the first behind them.
    fn of_nodes(&self, scale: f64) -> OfNodes {
        let mut of_nodes = in_lanes(Without { curve: self });
        let mut worst = 0.0_f64;
        for own in of_nodes.iter_mut().rev() {
            worst = worst.max(scale * *own);
            *own = worst;
        }
        of_nodes
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

/// A number for each node.
type OfNodes = SmallVec<[f64; MOST_NODES]>;

/// What a curve leaves between its nodes.
pub struct CurveErrors {
    everywhere: f64,
    /// At each node or one behind it.
    of_nodes: OfNodes,
}

impl CurveErrors {
    /// Of states behind a node, and all narrower ones.
    pub fn up_to(&self, node: usize) -> f64 {
        let of_node = self.of_nodes.get(node.saturating_sub(BESIDE)).copied();
        self.everywhere.max(of_node.unwrap_or(0.0))
    }
}

/// What force and indentation change at the nodes, relative, if the last four coefficients are dropped; nothing where no load reaches.
struct Without<'a> {
    curve: &'a ContactCurve<'a>,
}

impl LaneWork for Without<'_> {
    type Output = OfNodes;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> OfNodes {
        let ContactCurve { space, states, first, .. } = self.curve;
        let count = states.count();
        let mut of_nodes = SmallVec::from_elem(0.0, count);
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
            for node in at.max(*first)..at + LANES {
                let found = [found.force, found.indentation].map(|lanes| lanes.0[node - at]);
                let known = [states.force(node), states.indentation(node)];
                let change = |(found, known): (f64, f64)| (found / known - 1.0).abs();
                of_nodes[node] = found.into_iter().zip(known).map(change).fold(0.0, f64::max);
            }
        }
        of_nodes
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
