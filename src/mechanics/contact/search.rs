//! From loads to states on a curve: searches of the half angle, as many abreast as a register has lanes.
//!
//! What is searched for is the place q on the curve where a sum h of delta/e and F/e is 1 (`load::Target`). h grows about like a power
//! of the half angle and q like the angle itself, so that y = h^(1/2) is nearly proportional to q, and the polynomial P through the
//! nodes around, taken as q of y, is close to q at y = 1. What it is wrong by, q - P(y), is zero at these nodes, so that over the product
//! W(y) of the distances to them it hardly changes: the next q is P(1) and W(1) times that quotient, to first order in y by the last
//! two that were tried.

use super::curve::ContactCurve;
use super::load::{DimensionlessLoad, NoState, Target};
use super::reduced::FreeEdge;
use super::state::ContactState;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Or how narrow its bracket is, relative.
const NARROWEST: f64 = 1e-15;

/// Steps of a search at most, and those that P is asked for: from then on there is bisection alone.
const MOST_STEPS: usize = 100;
pub const MOST_OF_POLYNOMIALS: usize = 8;

/// Nodes that P goes through.
const AROUND: usize = 6;

/// In place of a node: loads beyond the widest one and below the narrowest.
const TOO_WIDE: usize = usize::MAX;
const TOO_NARROW: usize = usize::MAX - 1;

/// Where a search that has a target above this does not end, it is because products of h^(1/2) are no numbers.
const OVERFLOWING: f64 = 1e50;

/// So many loads take half as many lanes.
const FEW: usize = LANES / 2;

struct Loads<'a> {
    curve: &'a ContactCurve<'a>,
    loads: &'a mut dyn Iterator<Item = DimensionlessLoad>,
    states: &'a mut Vec<Result<(ContactState, usize), NoState>>,
}

impl LaneWork for Loads<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const WIDTH: usize>(self) {
        let Loads { curve, loads, states } = self;
        loop {
            let mut targets = Targets { of_indentation: Lanes::<WIDTH>::zero(), of_force: Lanes::zero() };
            let mut count = 0;
            for load in (&mut *loads).take(LANES) {
                let target = Target::new(curve.outlines.radial_clearance, load);
                targets.of_indentation.0[count] = target.of_indentation;
                targets.of_force.0[count] = target.of_force;
                count += 1;
            }
            if count > FEW {
                let found = curve.search(&targets);
                states.extend((0..count).map(|lane| targets.told(lane, found.state(curve, lane))));
            } else if count > 0 {
                let found = curve.search(&targets.first::<FEW>());
                states.extend((0..count).map(|lane| targets.told(lane, found.state(curve, lane))));
            }
            if count < LANES {
                return;
            }
        }
    }
}

/// As many as there are lanes; zero where there is none, which no state comes to.
struct Targets<const WIDTH: usize, const COUNT: usize> {
    of_indentation: Lanes<WIDTH, COUNT>,
    of_force: Lanes<WIDTH, COUNT>,
}

impl<const WIDTH: usize, const COUNT: usize> Targets<WIDTH, COUNT> {
    #[inline(always)]
    fn first<const FIRST: usize>(&self) -> Targets<WIDTH, FIRST> {
        let first = |lanes: &Lanes<WIDTH, COUNT>| Lanes(std::array::from_fn(|lane| lanes.0[lane]));
        Targets { of_indentation: first(&self.of_indentation), of_force: first(&self.of_force) }
    }

    /// What is found of a load, which may be why there is nothing.
    #[inline(always)]
    fn told<T>(&self, lane: usize, found: Result<T, NoState>) -> Result<T, NoState> {
        let overflows = self.of_indentation.0[lane].max(self.of_force.0[lane]) > OVERFLOWING;
        found.map_err(|reason| match reason {
            NoState::BrokenCompliance if overflows => NoState::ContactTooNarrow,
            _ => reason,
        })
    }

    /// h.
    #[inline(always)]
    fn sum(&self, indentation: Lanes<WIDTH, COUNT>, force: Lanes<WIDTH, COUNT>) -> Lanes<WIDTH, COUNT> {
        (self.of_indentation * indentation).minus_product(-self.of_force, force)
    }
}

/// What searches have come to.
struct Found<const WIDTH: usize, const COUNT: usize> {
    /// Of the pin.
    b: Lanes<WIDTH, COUNT>,
    edge: FreeEdge<Lanes<WIDTH, COUNT>>,
    /// The node at or above each, or `TOO_WIDE` or `TOO_NARROW`.
    above: [usize; COUNT],
    /// 1 where it has, else 0.
    has_ended: Lanes<WIDTH, COUNT>,
}

impl<const WIDTH: usize, const COUNT: usize> Found<WIDTH, COUNT> {
    /// One lane, with what is known node by node.
    #[inline(always)]
    fn state(&self, curve: &ContactCurve, lane: usize) -> Result<(ContactState, usize), NoState> {
        let above = self.above[lane];
        if above == TOO_WIDE {
            return Err(NoState::ContactTooWide);
        }
        if above == TOO_NARROW {
            return Err(NoState::ContactTooNarrow);
        }
        if self.has_ended.0[lane] == 0.0 {
            return Err(NoState::BrokenCompliance);
        }
        let states = &curve.states;
        let below = (above + 1).min(states.count() - 1);
        let state = ContactState {
            half_angle: curve.space.map().angle(self.b.0[lane] / curve.outlines.ratio()),
            indentation: self.edge.indentation.0[lane],
            force: self.edge.force.0[lane],
            tangent_stiffness: self.edge.tangent_stiffness.0[lane],
            energy: self.edge.energy.0[lane],
            peak_pressure: self.edge.peak_pressure.0[lane],
            peak_angle: 0.0,
            truncation: states.truncation(above).max(states.truncation(below)),
            pressure_is_positive: states.pressure_is_positive(above) && states.pressure_is_positive(below),
            on_whole_ring: false,
        };
        Ok((state, above))
    }
}

/// P, a polynomial of y through places.
struct Inverse<const WIDTH: usize, const COUNT: usize> {
    y: [Lanes<WIDTH, COUNT>; AROUND],
    /// Places over the products of y's distances to all others.
    weights: [Lanes<WIDTH, COUNT>; AROUND],
}

impl<const WIDTH: usize, const COUNT: usize> Inverse<WIDTH, COUNT> {
    #[inline(always)]
    fn new(
        places: &[Lanes<WIDTH, COUNT>; AROUND],
        y: [Lanes<WIDTH, COUNT>; AROUND],
    ) -> Inverse<WIDTH, COUNT> {
        let mut weights = *places;
        for (i, weight) in weights.iter_mut().enumerate() {
            // One at a time, which stays in a register.
            let mut product = Lanes::from_f64(1.0);
            for j in (0..i).chain(i + 1..AROUND) {
                product = product * (y[j] - y[i]);
            }
            *weight = *weight / product;
        }
        Inverse { y, weights }
    }

    /// P and W.
    #[inline(always)]
    fn at(&self, y: Lanes<WIDTH, COUNT>) -> [Lanes<WIDTH, COUNT>; 2] {
        let (mut sum, mut before) = (Lanes::zero(), Lanes::from_f64(1.0));
        // The sum so far has all distances so far as factors.
        for (own, weight) in self.y.iter().zip(&self.weights) {
            let distance = *own - y;
            sum = (sum * distance).minus_product(-before, *weight);
            before = before * distance;
        }
        [sum, before]
    }
}

impl ContactCurve<'_> {
    /// The states under loads (> 0), each with the widest node that is not wider: what is known node by node holds between it and the
    /// next.
    pub fn states(
        &self,
        loads: &mut dyn Iterator<Item = DimensionlessLoad>,
    ) -> Vec<Result<(ContactState, usize), NoState>> {
        let mut states = Vec::with_capacity(loads.size_hint().1.unwrap_or(0));
        in_lanes(Loads { curve: self, loads, states: &mut states });
        states
    }

    /// Place, delta/e and F/e at a node; at the angle zero behind the last one.
    #[inline(always)]
    fn node(&self, node: usize) -> [f64; 3] {
        match self.space.places.get(node) {
            Some(place) => [*place, self.states.indentation(node), self.states.force(node)],
            None => [0.0; 3],
        }
    }

    #[inline(always)]
    fn search<const WIDTH: usize, const COUNT: usize>(
        &self,
        targets: &Targets<WIDTH, COUNT>,
    ) -> Found<WIDTH, COUNT> {
        // Nodes go down with the angle: the last one that is not below the load.
        let mut above = [TOO_WIDE; COUNT];
        for node in self.first..self.states.count() {
            let [_, indentation, force] = self.node(node);
            let reached = targets.sum(Lanes::from_f64(indentation), Lanes::from_f64(force));
            for (above, reached) in above.iter_mut().zip(&reached.0) {
                *above = if *reached >= 1.0 { node } else { *above };
            }
        }
        let end = self.states.count() + usize::from(self.space.goes_to_zero());
        // Nodes on either side, as many as there are, and the bracket among them. Loops, because closures in arrays are not inlined, and
        // what is not inlined is not compiled for the vectors.
        let (mut places, mut y) =
            ([Lanes::<WIDTH, COUNT>::zero(); AROUND], [Lanes::<WIDTH, COUNT>::zero(); AROUND]);
        let mut forces = [Lanes::<WIDTH, COUNT>::zero(); AROUND];
        let (mut low, mut high) = ([0.0; COUNT], [0.0; COUNT]);
        for lane in 0..COUNT {
            if above[lane] == TOO_WIDE {
                continue;
            }
            if above[lane] >= end - 1 {
                above[lane] = TOO_NARROW;
                continue;
            }
            let own = above[lane];
            let from = (own + 1).saturating_sub(AROUND / 2).max(self.first).min(end - AROUND);
            for i in 0..AROUND {
                [places[i].0[lane], y[i].0[lane], forces[i].0[lane]] = self.node(from + i);
            }
            (low[lane], high[lane]) = (self.node(own + 1)[0], self.node(own)[0]);
        }
        for (y, force) in y.iter_mut().zip(&forces) {
            *y = targets.sum(*y, *force).sqrt();
        }
        let inverse = Inverse::new(&places, y);
        let number = Lanes::<WIDTH, COUNT>::from_f64;
        let (zero, one) = (number(0.0), number(1.0));
        let [first, product] = inverse.at(one);
        let mut next = first;
        let (mut low, mut high) = (Lanes::<WIDTH, COUNT>(low), Lanes::<WIDTH, COUNT>(high));
        // 1 where a load is searched for.
        let mut searched = zero;
        for lane in 0..COUNT {
            searched.0[lane] = f64::from(u8::from(above[lane] < TOO_NARROW));
        }
        // y and (q - P(y))/W(y) of the step before.
        let mut before: Option<[Lanes<WIDTH, COUNT>; 2]> = None;
        let mut steps = 0;
        loop {
            let middle = number(0.5) * (low + high);
            let place = if steps >= MOST_OF_POLYNOMIALS {
                middle
            } else {
                low.if_at_most(next, next.if_at_most(high, next, middle), middle)
            };
            let at = self.at(place);
            let (indentation, force) = at.reduced.load(at.b);
            let sum = targets.sum(indentation, force);
            let y = sum.sqrt();
            let [of_polynomial, product_here] = inverse.at(y);
            let left = (place - of_polynomial) / product_here;
            let mut left_at_one = left;
            if let Some([y_before, left_before]) = before {
                left_at_one += (left - left_before) * (one - y) / (y - y_before);
            }
            next = first + product * left_at_one;
            before = Some([y, left]);
            // One that has come to its end stays there.
            let (off, near) = ((sum - one).size(), number(self.tolerance));
            low = sum.if_less(one, place, off.if_less(near, place, low));
            high = one.if_at_most(sum, place, off.if_less(near, place, high));
            // 1 where all is positive and finite.
            let is_sound = sum.size().if_less(number(f64::INFINITY), one, zero);
            let is_sound = zero.if_less(indentation, is_sound, zero);
            let is_sound = zero.if_less(at.reduced.singular, is_sound, zero);
            let (width, narrowest) = (high - low, number(NARROWEST) * high);
            let has_ended = width.if_at_most(narrowest, is_sound, zero);
            let goes_on = width.if_at_most(narrowest, zero, is_sound) * searched;
            steps += 1;
            if goes_on.is_zero() || steps > MOST_STEPS {
                let edge = self.whole(&at).free_edge(at.b, &self.outlines);
                return Found { b: at.b, edge, above, has_ended };
            }
        }
    }
}
