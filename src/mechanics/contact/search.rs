//! From loads to states on a curve: searches of the half angle, as many abreast as a register has lanes.

use super::curve::ContactCurve;
use super::edge::FreeEdge;
use super::load::{DimensionlessLoad, NoState, Target};
use super::state::ContactState;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes};

/// Where a search ends: the excess of a load.
const TOLERANCE: f64 = 1e-11;

/// Steps of one search at most; bisection alone would need fewer.
const MOST_STEPS: usize = 100;

struct Loads<'a, I> {
    curve: &'a ContactCurve<'a>,
    loads: I,
    states: &'a mut Vec<Result<(ContactState, usize), NoState>>,
}

impl<I: Iterator<Item = DimensionlessLoad>> LaneWork for Loads<'_, I> {
    type Output = ();

    /// Where a search ends the next load takes its lane.
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Loads { curve, mut loads, states } = self;
        let radial_clearance = curve.outlines.radial_clearance;
        let mut lanes: [Option<(usize, Search)>; LANES] = [None; LANES];
        loop {
            for lane in lanes.iter_mut().filter(|lane| lane.is_none()) {
                for load in loads.by_ref() {
                    let search = curve.begin(Target::new(radial_clearance, load));
                    *lane = search.map(|search| (states.len(), search));
                    // Where the search does not end there is none.
                    let is_begun = lane.is_some();
                    states.push(Err(if is_begun {
                        NoState::BrokenCompliance
                    } else {
                        NoState::ContactTooWide
                    }));
                    if is_begun {
                        break;
                    }
                }
            }
            if lanes.iter().all(Option::is_none) {
                return;
            }
            let mut logarithms = [0.0; LANES];
            for (next, lane) in logarithms.iter_mut().zip(&lanes) {
                *next = lane.as_ref().map_or(0.0, |(_, search)| search.next);
            }
            let at = curve.at::<FUSED>(logarithms);
            for (number, lane) in lanes.iter_mut().enumerate() {
                let Some((place, search)) = lane else { continue };
                if !at.is_sound(number) {
                    *lane = None;
                } else if search.ends(at.edge.indentation.0[number], at.edge.force.0[number]) {
                    states[*place] = Ok((curve.state(&at, number, search.above), search.above));
                    *lane = None;
                } else if search.steps == MOST_STEPS {
                    *lane = None;
                }
            }
        }
    }
}

/// One search in the logarithm of the curve's space: a bracket with the excess at its ends, and the next point.
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

/// The joint at as many angles as there are lanes.
struct Abreast<const FUSED: bool> {
    /// Of the pin.
    b: Lanes<FUSED>,
    edge: FreeEdge<Lanes<FUSED>>,
    /// What must be positive of a compliance.
    singular: Lanes<FUSED>,
}

impl<const FUSED: bool> Abreast<FUSED> {
    #[inline(always)]
    fn is_sound(&self, lane: usize) -> bool {
        let FreeEdge { indentation, force, .. } = &self.edge;
        self.singular.0[lane] > 0.0 && indentation.0[lane] > 0.0 && force.0[lane].is_finite()
    }
}

impl ContactCurve<'_> {
    /// The states under loads (> 0), each with the widest node that is not wider: what is known node by node holds between it and the
    /// next.
    pub fn states(
        &self,
        loads: impl Iterator<Item = DimensionlessLoad>,
    ) -> Vec<Result<(ContactState, usize), NoState>> {
        let mut states = Vec::with_capacity(loads.size_hint().1.unwrap_or(0));
        in_lanes(Loads { curve: self, loads, states: &mut states });
        states
    }

    /// The bracket of a load among the nodes, and a first guess between them; `None` where it is beyond the curve.
    #[inline(always)]
    fn begin(&self, target: Target) -> Option<Search> {
        let edges = &self.states.edges;
        let count = edges.len();
        let point = |node: usize| {
            (self.space.logarithms[node], target.excess(edges[node].free.indentation, edges[node].free.force))
        };
        // Nodes go down with the angle: the last one that is not below the load.
        let reached =
            |node: &usize| target.is_reached(edges[*node].free.indentation, edges[*node].free.force);
        let above = (self.first..count).rev().find(reached)?;
        let below = above + 1;
        // Three nodes on either side, where there are so many.
        let (from, last) = (above.saturating_sub(2).max(self.first), (below + 2).min(count - 1));
        let mut points = [(0.0, 0.0); 6];
        for (place, node) in points.iter_mut().zip(from..=last) {
            *place = point(node);
        }
        let guess = inverse_interpolation(&points[..=last - from]);
        let b = points[above - from];
        let (a, otherwise) = if below < count {
            let a = points[below - from];
            (a, 0.5 * (a.0 + b.0))
        } else if !self.space.goes_to_zero() {
            return None;
        } else {
            // Below all nodes the load is a power of the angle: more than the fourth, with the logarithm.
            let a = (b.0 - 0.5 * b.1 - 1.0, f64::NEG_INFINITY);
            (a, (b.0 - 0.25 * b.1).max(a.0))
        };
        let next = if guess > a.0 && guess < b.0 { guess } else { otherwise };
        Some(Search { target, a, b, next, steps: 0, above })
    }

    #[inline(always)]
    fn at<const FUSED: bool>(&self, logarithms: [f64; LANES]) -> Abreast<FUSED> {
        let (reduced, b) = self.reduced(logarithms);
        Abreast { b, edge: reduced.free_edge(b, &self.outlines), singular: reduced.singular }
    }

    /// One lane, with what is known node by node.
    #[inline(always)]
    fn state<const FUSED: bool>(&self, at: &Abreast<FUSED>, lane: usize, above: usize) -> ContactState {
        let edges = &self.states.edges;
        let [above, below] = [above, (above + 1).min(edges.len() - 1)].map(|node| &edges[node]);
        ContactState {
            half_angle: 2.0 * (at.b.0[lane] / self.outlines.ratio()).atan(),
            indentation: at.edge.indentation.0[lane],
            force: at.edge.force.0[lane],
            tangent_stiffness: at.edge.tangent_stiffness.0[lane],
            energy: at.edge.energy.0[lane],
            peak_pressure: at.edge.peak_pressure.0[lane],
            truncation: above.truncation.max(below.truncation),
            pressure_is_positive: above.pressure_is_positive && below.pressure_is_positive,
        }
    }
}

/// The position at which the polynomial through (position, value), taken as position of value, has the value zero.
#[inline(always)]
fn inverse_interpolation(points: &[(f64, f64)]) -> f64 {
    let mut sum = 0.0;
    for (i, (position, value)) in points.iter().enumerate() {
        let (mut others, mut distances) = (*position, 1.0);
        for (j, (_, other)) in points.iter().enumerate() {
            if j != i {
                others *= other;
                distances *= other - value;
            }
        }
        sum += others / distances;
    }
    sum
}
