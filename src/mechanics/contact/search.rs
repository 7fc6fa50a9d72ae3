//! From loads to states on a curve: searches of the half angle, as many abreast as a register has lanes.
//!
//! What is searched for is the place s on the curve where a sum h of delta/e and F/e is 1 (`load::Target`). h grows about like a power
//! of the half angle and s like its root, so that y = h^(1/4) is nearly proportional to s, and the polynomial P through the nodes
//! around, taken as s of y, is close to s at y = 1. What is left there is mended by P too: after s comes s + P(1) - P(y(s)).

use super::curve::ContactCurve;
use super::edge::FreeEdge;
use super::load::{DimensionlessLoad, NoState, Target};
use super::state::ContactState;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Where a search ends: what h differs from 1.
const TOLERANCE: f64 = 1e-11;

/// Or how narrow its bracket is, relative.
const NARROWEST: f64 = 1e-15;

/// Steps of a search at most, and those that P is asked for: from then on there is bisection alone.
const MOST_STEPS: usize = 100;
const MOST_OF_POLYNOMIALS: usize = 8;

/// Nodes that P goes through.
const AROUND: usize = 8;

struct Loads<'a, I> {
    curve: &'a ContactCurve<'a>,
    loads: I,
    states: &'a mut Vec<Result<(ContactState, usize), NoState>>,
}

impl<I: Iterator<Item = DimensionlessLoad>> LaneWork for Loads<'_, I> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Loads { curve, mut loads, states } = self;
        loop {
            let mut targets = [Target::NONE; LANES];
            let mut count = 0;
            for (target, load) in targets.iter_mut().zip(loads.by_ref()) {
                *target = Target::new(curve.outlines.radial_clearance, load);
                count += 1;
            }
            if count > 0 {
                let found = curve.search::<FUSED>(targets);
                states.extend((0..count).map(|lane| found.state(curve, lane)));
            }
            if count < LANES {
                return;
            }
        }
    }
}

/// What searches have come to.
struct Found<const FUSED: bool> {
    /// Of the pin.
    b: Lanes<FUSED>,
    edge: FreeEdge<Lanes<FUSED>>,
    /// The node at or above each; `usize::MAX` where the load is beyond the curve.
    above: [usize; LANES],
    has_ended: [bool; LANES],
}

impl<const FUSED: bool> Found<FUSED> {
    /// One lane, with what is known node by node.
    #[inline(always)]
    fn state(&self, curve: &ContactCurve, lane: usize) -> Result<(ContactState, usize), NoState> {
        let above = self.above[lane];
        if above == usize::MAX {
            return Err(NoState::ContactTooWide);
        }
        if !self.has_ended[lane] {
            return Err(NoState::BrokenCompliance);
        }
        let states = &curve.states;
        let below = (above + 1).min(states.count() - 1);
        let state = ContactState {
            half_angle: 2.0 * (self.b.0[lane] / curve.outlines.ratio()).atan(),
            indentation: self.edge.indentation.0[lane],
            force: self.edge.force.0[lane],
            tangent_stiffness: self.edge.tangent_stiffness.0[lane],
            energy: self.edge.energy.0[lane],
            peak_pressure: self.edge.peak_pressure.0[lane],
            truncation: states.truncation(above).max(states.truncation(below)),
            pressure_is_positive: states.pressure_is_positive(above) && states.pressure_is_positive(below),
        };
        Ok((state, above))
    }
}

/// P, a polynomial of y through places.
struct Inverse<const FUSED: bool> {
    y: [Lanes<FUSED>; AROUND],
    /// Places over the products of y's distances to all others.
    weights: [Lanes<FUSED>; AROUND],
}

impl<const FUSED: bool> Inverse<FUSED> {
    #[inline(always)]
    fn new(places: [Lanes<FUSED>; AROUND], y: [Lanes<FUSED>; AROUND]) -> Inverse<FUSED> {
        let mut products = [Lanes::from_f64(1.0); AROUND];
        for i in 0..AROUND {
            for j in 0..i {
                let distance = y[j] - y[i];
                products[i] = products[i] * distance;
                products[j] = products[j] * -distance;
            }
        }
        Inverse { y, weights: std::array::from_fn(|i| places[i] / products[i]) }
    }

    #[inline(always)]
    fn at(&self, y: Lanes<FUSED>) -> Lanes<FUSED> {
        let (mut sum, mut before) = (Lanes::zero(), Lanes::from_f64(1.0));
        // The sum so far has all distances so far as factors.
        for (own, weight) in self.y.iter().zip(&self.weights) {
            let distance = *own - y;
            sum = (sum * distance).minus_product(-before, *weight);
            before = before * distance;
        }
        sum
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

    /// Place, delta/e and F/e at a node; at the angle zero behind the last one.
    #[inline(always)]
    fn node(&self, node: usize) -> [f64; 3] {
        match self.space.roots.get(node) {
            Some(root) => [*root, self.states.indentation(node), self.states.force(node)],
            None => [0.0; 3],
        }
    }

    #[inline(always)]
    fn search<const FUSED: bool>(&self, targets: [Target; LANES]) -> Found<FUSED> {
        let of_indentation = Lanes::<FUSED>(targets.map(|target| target.of_indentation));
        let of_force = Lanes::<FUSED>(targets.map(|target| target.of_force));
        let sum = |indentation, force| (of_indentation * indentation).minus_product(-of_force, force);
        // Nodes go down with the angle: the last one that is not below the load.
        let mut above = [usize::MAX; LANES];
        for node in self.first..self.states.count() {
            let [_, indentation, force] = self.node(node).map(Lanes::from_f64);
            let reached: Lanes<FUSED> = sum(indentation, force);
            for (above, reached) in above.iter_mut().zip(reached.0) {
                *above = if reached >= 1.0 { node } else { *above };
            }
        }
        let end = self.states.count() + usize::from(self.space.goes_to_zero());
        above.iter_mut().filter(|above| **above >= end - 1).for_each(|above| *above = usize::MAX);
        // Nodes on either side, as many as there are, and the bracket among them. Loops, because closures in arrays are not inlined, and
        // what is not inlined is not compiled for the vectors.
        let (mut places, mut y) = ([Lanes::<FUSED>::zero(); AROUND], [Lanes::zero(); AROUND]);
        let (mut low, mut high) = ([0.0; LANES], [0.0; LANES]);
        let mut loads = [[Lanes::<FUSED>::zero(); 2]; AROUND];
        for lane in 0..LANES {
            let own = if above[lane] == usize::MAX { self.first } else { above[lane] };
            let from = (own + 1).saturating_sub(AROUND / 2).max(self.first).min(end - AROUND);
            for i in 0..AROUND {
                let [place, indentation, force] = self.node(from + i);
                (places[i].0[lane], loads[i][0].0[lane], loads[i][1].0[lane]) = (place, indentation, force);
            }
            (low[lane], high[lane]) = (self.node(own + 1)[0], self.node(own)[0]);
        }
        for (y, [indentation, force]) in y.iter_mut().zip(loads) {
            *y = sum(indentation, force).sqrt().sqrt();
        }
        let inverse = Inverse::new(places, y);
        let first = inverse.at(Lanes::from_f64(1.0));
        let mut next = first;
        let mut steps = 0;
        loop {
            let is_bisected = steps >= MOST_OF_POLYNOMIALS;
            let mut place = [0.0; LANES];
            for lane in 0..LANES {
                let (low, high, next) = (low[lane], high[lane], next.0[lane]);
                let is_within = !is_bisected && next >= low && next <= high;
                place[lane] = if is_within { next } else { 0.5 * (low + high) };
            }
            let (reduced, b) = self.reduced::<FUSED>(Lanes(place));
            let edge = reduced.free_edge(b, &self.outlines);
            let sum: Lanes<FUSED> = sum(edge.indentation, edge.force);
            next = Lanes(place) + first - inverse.at(sum.sqrt().sqrt());
            let (mut has_ended, mut goes_on) = ([false; LANES], false);
            for lane in 0..LANES {
                let (place, sum) = (place[lane], sum.0[lane]);
                let is_near = (sum - 1.0).abs() < TOLERANCE;
                // One that has come to its end stays there.
                low[lane] = if sum < 1.0 || is_near { place } else { low[lane] };
                high[lane] = if sum >= 1.0 || is_near { place } else { high[lane] };
                has_ended[lane] = high[lane] - low[lane] <= NARROWEST * high[lane];
                let is_sound =
                    reduced.singular.0[lane] > 0.0 && edge.indentation.0[lane] > 0.0 && sum.is_finite();
                goes_on |= is_sound && !has_ended[lane] && above[lane] != usize::MAX;
                has_ended[lane] &= is_sound;
            }
            steps += 1;
            if !goes_on || steps > MOST_STEPS {
                return Found { b, edge, above, has_ended };
            }
        }
    }
}
