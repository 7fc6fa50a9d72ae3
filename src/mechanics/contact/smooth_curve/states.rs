//! From loads to states on a curve: the search of the half angle, and the polynomials there.

use std::f64::consts::FRAC_PI_2;

use pulp::{Simd, WithSimd};

use super::{CURVE_NODES, CurveState, SmoothCurve};
use crate::mechanics::contact::loading::{DimensionlessLoad, Target, inverse_interpolation};
use crate::mechanics::real::{Lanes, Real};

/// Where a search ends: the excess of a load.
const TOLERANCE: f64 = 1e-9;

/// Steps of one search at most; bisection alone would need fewer.
const MOST_STEPS: usize = 100;

pub(super) struct Loads<'a, I> {
    pub(super) curve: &'a SmoothCurve<'a>,
    pub(super) clearance: f64,
    pub(super) loads: I,
    pub(super) states: &'a mut Vec<Option<CurveState>>,
}

impl<I: Iterator<Item = DimensionlessLoad>> WithSimd for Loads<'_, I> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        if S::IS_SCALAR { self.run::<false>() } else { self.run::<true>() }
    }
}

impl<I: Iterator<Item = DimensionlessLoad>> Loads<'_, I> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        for load in self.loads {
            self.states.push(self.curve.search::<FUSED>(self.clearance, load));
        }
    }
}

impl SmoothCurve<'_> {
    #[inline(always)]
    fn search<const FUSED: bool>(&self, clearance: f64, load: DimensionlessLoad) -> Option<CurveState> {
        let target = Target::new(clearance, load);
        let point = |node: usize| {
            let excess = target.excess(self.indentation[node], self.force[node]);
            (self.nodes.ln_z[node], excess)
        };
        // Nodes go down with the angle: the last one that is not below the load.
        let reached = |node: &usize| target.is_reached(self.indentation[*node], self.force[*node]);
        let above = (self.first..CURVE_NODES).rev().find(reached)?;
        let below = above + 1;
        let last = (below + 1).min(CURVE_NODES - 1);
        let mut points = [(0.0, 0.0); 4];
        let mut count = 0;
        for node in above.saturating_sub(1).max(self.first)..=last {
            points[count] = point(node);
            count += 1;
        }
        let guess = inverse_interpolation(&points[..count]);
        let (mut a, mut b);
        if below < CURVE_NODES {
            (a, b) = (point(below), point(above));
        } else {
            // Below all nodes the load is a power of the angle: more than the fourth, with the logarithm.
            b = point(above);
            a = (b.0 - 0.5 * b.1 - 1.0, f64::NEG_INFINITY);
        }
        let mut next = if guess > a.0 && guess < b.0 {
            guess
        } else if below < CURVE_NODES {
            0.5 * (a.0 + b.0)
        } else {
            (b.0 - 0.25 * b.1).max(a.0)
        };
        for _ in 0..MOST_STEPS {
            let z = next.exp();
            let state = self.state::<FUSED>(z)?;
            let excess = target.excess(state.indentation, state.force);
            if excess.abs() < TOLERANCE || (b.0 - a.0).abs() < 1e-14 {
                let below = below.min(CURVE_NODES - 1);
                return Some(CurveState {
                    truncation: self.truncation[above].max(self.truncation[below]),
                    pressure_is_positive: self.positive[above] && self.positive[below],
                    node: above,
                    ..state
                });
            }
            let latest = (next, excess);
            let dropped = if excess < 0.0 {
                std::mem::replace(&mut a, latest)
            } else {
                std::mem::replace(&mut b, latest)
            };
            let guess = if a.1.is_finite() && dropped.1.is_finite() {
                inverse_interpolation(&[a, b, dropped])
            } else if a.1.is_finite() {
                inverse_interpolation(&[a, b])
            } else {
                b.0 - 0.25 * b.1
            };
            next = if guess > a.0 && guess < b.0 { guess } else { 0.5 * (a.0 + b.0) };
        }
        None
    }

    /// The state at an angle, but for what is known node by node.
    #[inline(always)]
    fn state<const FUSED: bool>(&self, z: f64) -> Option<CurveState> {
        let turn = Lanes::<FUSED>::from_f64(-2.0 * (2.0 * z - 1.0));
        let (mut current, mut previous) = (Lanes::<FUSED>::zero(), Lanes::<FUSED>::zero());
        for of_degree in self.coefficients[1..].iter().rev() {
            let next = (Lanes::<FUSED>(*of_degree) - previous).minus_product(turn, current);
            (current, previous) = (next, current);
        }
        let half = Lanes::<FUSED>::from_f64(0.5) * turn;
        let sum = (Lanes::<FUSED>(self.coefficients[0]) - previous).minus_product(half, current);
        let [log_free, edge, edge_w, against, work, peak, peak_w, _] = sum.0;
        let b = self.nodes.b(z);
        let b2 = b * b;
        let singular = log_free - FRAC_PI_2 * self.amplitude * b.ln();
        let first = b2 * edge_w / edge;
        let (against, work) = (b2 * against, b2 * b2 * work);
        let arm = FRAC_PI_2 - against;
        let state = CurveState {
            half_angle: 2.0 * b.atan(),
            indentation: (singular * first + against) / FRAC_PI_2,
            force: 2.0 * (first * arm + work),
            tangent_stiffness: 2.0 * (arm * arm / singular + work),
            energy: singular * first * first + work,
            peak_pressure: (first * peak - b2 * peak_w) / (2.0 * b),
            truncation: 0.0,
            curvature: self.curvature,
            pressure_is_positive: false,
            node: 0,
        };
        (singular > 0.0 && state.indentation > 0.0 && state.force.is_finite()).then_some(state)
    }
}
