//! From loads to states on a curve: searches of the half angle, as many abreast as a register has lanes, and the polynomials
//! there.

use std::f64::consts::{FRAC_PI_2, PI};

use pulp::{Simd, WithSimd};

use super::{CURVE_NODES, CurveState, SmoothCurve};
use crate::mechanics::contact::loading::{DimensionlessLoad, Target, inverse_interpolation};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Where a search ends: the excess of a load.
const TOLERANCE: f64 = 1e-9;

/// Steps of one search at most; bisection alone would need fewer.
const MOST_STEPS: usize = 100;

/// Functions of a curve: the columns of `SmoothCurve::coefficients` that are used.
const FUNCTIONS: usize = 7;

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
    /// Where a search ends the next load takes its lane.
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Loads { curve, clearance, mut loads, states } = self;
        let mut lanes: [Option<(usize, Search)>; LANES] = [None; LANES];
        loop {
            for lane in lanes.iter_mut().filter(|lane| lane.is_none()) {
                for load in loads.by_ref() {
                    states.push(None);
                    *lane =
                        curve.begin(Target::new(clearance, load)).map(|search| (states.len() - 1, search));
                    if lane.is_some() {
                        break;
                    }
                }
            }
            if lanes.iter().all(Option::is_none) {
                return;
            }
            let mut ln_z = [0.0; LANES];
            for (next, lane) in ln_z.iter_mut().zip(&lanes) {
                *next = lane.as_ref().map_or(0.0, |(_, search)| search.next);
            }
            let at = curve.at::<FUSED>(ln_z);
            for (number, lane) in lanes.iter_mut().enumerate() {
                let Some((place, search)) = lane else { continue };
                if !at.is_sound(number) {
                    *lane = None;
                } else if search.ends(at.indentation.0[number], at.force.0[number]) {
                    states[*place] = Some(curve.state(&at, number, search.above));
                    *lane = None;
                } else if search.steps == MOST_STEPS {
                    *lane = None;
                }
            }
        }
    }
}

/// One search in ln z: a bracket with the excess at its ends, and the next point.
#[derive(Clone, Copy)]
struct Search {
    target: Target,
    a: (f64, f64),
    b: (f64, f64),
    next: f64,
    steps: usize,
    /// The node at or above the state.
    above: usize,
}

impl Search {
    /// Takes the load at `next`: it is the one searched for, or inverse quadratic interpolation goes on through it and the
    /// bracket, or bisection where that leaves the bracket.
    #[inline(always)]
    fn ends(&mut self, indentation: f64, force: f64) -> bool {
        let excess = self.target.excess(indentation, force);
        if excess.abs() < TOLERANCE || (self.b.0 - self.a.0).abs() < 1e-14 {
            return true;
        }
        self.steps += 1;
        let latest = (self.next, excess);
        let dropped = if excess < 0.0 {
            std::mem::replace(&mut self.a, latest)
        } else {
            std::mem::replace(&mut self.b, latest)
        };
        let (a, b) = (self.a, self.b);
        let guess = if a.1.is_finite() && dropped.1.is_finite() {
            inverse_interpolation(&[a, b, dropped])
        } else if a.1.is_finite() {
            inverse_interpolation(&[a, b])
        } else {
            b.0 - 0.25 * b.1
        };
        self.next = if guess > a.0 && guess < b.0 { guess } else { 0.5 * (a.0 + b.0) };
        false
    }
}

/// The joint at as many angles as there are lanes; units as in `CurveState`.
struct Abreast<const FUSED: bool> {
    b: Lanes<FUSED>,
    indentation: Lanes<FUSED>,
    force: Lanes<FUSED>,
    tangent_stiffness: Lanes<FUSED>,
    energy: Lanes<FUSED>,
    peak_pressure: Lanes<FUSED>,
    /// What must be positive of a compliance.
    singular: Lanes<FUSED>,
}

impl<const FUSED: bool> Abreast<FUSED> {
    #[inline(always)]
    fn is_sound(&self, lane: usize) -> bool {
        self.singular.0[lane] > 0.0 && self.indentation.0[lane] > 0.0 && self.force.0[lane].is_finite()
    }
}

impl SmoothCurve<'_> {
    /// The bracket of a load among the nodes, and a first guess between them; `None` where it is beyond the curve.
    #[inline(always)]
    fn begin(&self, target: Target) -> Option<Search> {
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
        let from = above.saturating_sub(1).max(self.first);
        for (place, node) in points.iter_mut().zip(from..=last) {
            *place = point(node);
        }
        let guess = inverse_interpolation(&points[..=last - from]);
        let b = points[above - from];
        let (a, otherwise) = if below < CURVE_NODES {
            let a = points[below - from];
            (a, 0.5 * (a.0 + b.0))
        } else {
            // Below all nodes the load is a power of the angle: more than the fourth, with the logarithm.
            let a = (b.0 - 0.5 * b.1 - 1.0, f64::NEG_INFINITY);
            (a, (b.0 - 0.25 * b.1).max(a.0))
        };
        let next = if guess > a.0 && guess < b.0 { guess } else { otherwise };
        Some(Search { target, a, b, next, steps: 0, above })
    }

    #[inline(always)]
    fn at<const FUSED: bool>(&self, ln_z: [f64; LANES]) -> Abreast<FUSED> {
        let number = Lanes::<FUSED>::from_f64;
        let mut z = Lanes::<FUSED>(ln_z);
        z.0.iter_mut().for_each(|ln_z| *ln_z = ln_z.exp());
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
        let [log_free, edge, edge_w, against, work, peak, peak_w] = current;
        let b = self.nodes.b(z);
        let b2 = b * b;
        let singular = log_free.minus_product(number(PI * self.amplitude), Lanes(ln_z));
        let first = b2 * edge_w / edge;
        let (against, work) = (b2 * against, b2 * b2 * work);
        let arm = number(FRAC_PI_2) - against;
        Abreast {
            b,
            indentation: (singular * first + against) / number(FRAC_PI_2),
            force: number(2.0) * (first * arm + work),
            tangent_stiffness: number(2.0) * (arm * arm / singular + work),
            energy: singular * first * first + work,
            peak_pressure: (first * peak - b2 * peak_w) / (b + b),
            singular,
        }
    }

    /// One lane, with what is known node by node.
    #[inline(always)]
    fn state<const FUSED: bool>(&self, at: &Abreast<FUSED>, lane: usize, above: usize) -> CurveState {
        let below = (above + 1).min(CURVE_NODES - 1);
        CurveState {
            half_angle: 2.0 * at.b.0[lane].atan(),
            indentation: at.indentation.0[lane],
            force: at.force.0[lane],
            tangent_stiffness: at.tangent_stiffness.0[lane],
            energy: at.energy.0[lane],
            peak_pressure: at.peak_pressure.0[lane],
            truncation: self.truncation[above].max(self.truncation[below]),
            curvature: self.curvature,
            pressure_is_positive: self.positive[above] && self.positive[below],
            node: above,
        }
    }
}
