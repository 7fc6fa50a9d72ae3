//! The curve of a joint: its states between a few arcs.
//!
//! What `edge` finds at an arc is smooth once S is without its logarithm, and N/b^2, V/b^2 and Q/b^4 are taken in place of N, V
//! and Q, and so on. So the equations are solved at a few nodes, and between them these functions are polynomials: a load costs no system
//! of equations. They are polynomials of z, tan(eps/4) = tan(limit/4) z^2, down to the angle zero.
//!
//! A bed adds to the compliance what grows like 1/b: as contact becomes wider than lambda/c the elastic part takes over from the
//! bed, at b of any smallness. Beside beds the functions are polynomials of ln b, and with s = b (c + lambda)/(c b + lambda) it is
//! s S, N/(s b^2) and Q/(s b^4) that are bounded. Beside soft layers that are no beds, which yield as bodies to narrow contacts and as
//! beds to wide ones, these still change by orders of magnitude; ln S, N S/b^2 and Q S/b^4 do not. The polynomials are of those of which
//! the last coefficients are worth less.

use super::curve_space::{CurveSpace, chunk_of};
use super::edge::EdgeStates;
use super::outlines::Outlines;
use super::reduced::{FUNCTIONS, Functions, OF_LOAD, Reduced};
use crate::mechanics::compliance::arc::ArcMap;
use crate::mechanics::compliance::lane_work::{LaneWork, in_lanes};
use crate::mechanics::compliance::pressure_space::JointCompliance;
use crate::mechanics::real::{LANES, Lanes, Real};
use crate::mechanics::registers::ANY;

/// Where a search of a load ends unless less will do.
const TOLERANCE: f64 = 1e-10;

/// The curve of a joint.
#[derive(Clone)]
pub struct ContactCurve<'a> {
    pub space: &'a CurveSpace,
    pub outlines: Outlines,
    even: f64,
    form: Form,
    /// Degrees as in `CurveSpace::chebyshev`, functions in the order of `Reduced::functions`.
    pub(super) coefficients: Vec<Functions>,
    /// What is known node by node.
    pub states: EdgeStates,
    /// Where a search of a load ends: what its h differs from 1.
    pub tolerance: f64,
    /// The widest node that a load can reach, and no node from there on.
    pub(super) first: usize,
}

/// What of S, N and Q the polynomials are of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// These, S without its logarithm.
    Plain,
    /// These with s, of a bed.
    Scaled { bed: f64 },
    /// ln S, and the others times S.
    Logarithm,
}

/// Room for a curve, kept from one to the next.
#[derive(Default)]
pub struct CurveRoom {
    coefficients: Vec<Functions>,
    states: EdgeStates,
}

impl<'a> ContactCurve<'a> {
    /// The room it takes, for the next one.
    pub fn into_room(self) -> CurveRoom {
        CurveRoom { coefficients: self.coefficients, states: self.states }
    }

    /// Of a joint's compliance in the space, which is the sum of its parts. `None` where it is not positive definite.
    pub fn new(
        space: &'a CurveSpace,
        parts: &[&JointCompliance],
        outlines: Outlines,
    ) -> Option<ContactCurve<'a>> {
        ContactCurve::in_room(space, parts, outlines, &mut CurveRoom::default())
    }

    /// The same in the room of another one, which is taken where there is a curve.
    pub fn in_room(
        space: &'a CurveSpace,
        parts: &[&JointCompliance],
        outlines: Outlines,
        room: &mut CurveRoom,
    ) -> Option<ContactCurve<'a>> {
        let CurveRoom { coefficients, states } = std::mem::take(room);
        let states = states.again(&space.pressures, parts, &outlines);
        let even: f64 = parts.iter().map(|part| part.even).sum();
        let bed: f64 = parts.iter().map(|part| part.bed).sum();
        // Up to the first beyond a neat fit, of press fits to the last, and no further than the contact grows with the load: the pressure is the sum of what
        // punches of all smaller arcs add as the contact grows, each of them positive. Where it grows with the load the pressure
        // is positive and the gap beyond it open, and only there.
        let (mut first, mut before) = (states.count(), 0.0);
        for node in (0..states.count()).rev() {
            let grown = states.indentation(node);
            // Not where it is NaN.
            if !states.is_sound(node) || grown.is_nan() || grown <= before {
                break;
            }
            first = node;
            before = grown;
            if grown >= 1.0 && space.map() == ArcMap::Tangent {
                break;
            }
        }
        let form = if bed == 0.0 { Form::Plain } else { Form::Scaled { bed } };
        let curve =
            ContactCurve { space, outlines, even, form, coefficients, states, tolerance: TOLERANCE, first };
        if !space.is_beside_beds() {
            return curve.formed();
        }
        // Whichever leaves less.
        let other = ContactCurve { form: Form::Logarithm, ..curve.clone() };
        match (curve.formed(), other.formed()) {
            (Some(own), Some(other)) => Some(if other.left_out() < own.left_out() { other } else { own }),
            (own, other) => own.or(other),
        }
    }

    /// From what the nodes have to what polynomials are of, and these; `None` where that is no number.
    fn formed(self) -> Option<ContactCurve<'a>> {
        let ContactCurve { space, even, form, mut states, coefficients, .. } = self;
        let share = space.logarithm_share(even);
        let logarithms = space.logarithms.as_chunks::<LANES>().0;
        let nodes = states.functions_mut().zip(logarithms).zip(space.arcs().chunks(LANES));
        for ((functions, logarithms), arcs) in nodes {
            let singular = Lanes::<ANY>(functions[0]);
            let scaled = |scale| {
                let scaled = Reduced::of_functions(functions.map(Lanes)).scaled(scale);
                scaled.functions().map(|values| values.0)
            };
            match form {
                Form::Plain => {
                    for (singular, logarithm) in functions[0].iter_mut().zip(logarithms) {
                        *singular += share * logarithm;
                    }
                }
                Form::Scaled { bed } => {
                    let scale = std::array::from_fn(|lane| scale(even, bed, arcs[lane].b));
                    *functions = scaled(Lanes(scale));
                }
                Form::Logarithm => {
                    *functions = scaled(Lanes::from_f64(1.0) / singular);
                    functions[0] = singular.0.map(f64::ln);
                }
            }
            if !functions.as_flattened().iter().all(|value| value.is_finite()) {
                return None;
            }
        }
        let coefficients = in_lanes(Transform { rows: &space.chebyshev, states: &states, coefficients });
        Some(ContactCurve { states, coefficients, ..self })
    }

    /// Of a function, at a degree.
    #[inline(always)]
    pub(super) fn coefficient(&self, degree: usize, function: usize) -> f64 {
        let (chunk, lane) = (chunk_of(self.states.count(), degree), degree / 2 % LANES);
        self.coefficients[chunk][function][lane]
    }

    /// What the equations come to at places, as far as a load follows from it.
    #[inline(always)]
    pub(super) fn at<const WIDTH: usize, const COUNT: usize>(
        &self,
        places: Lanes<WIDTH, COUNT>,
    ) -> AtPlaces<WIDTH, COUNT> {
        let number = Lanes::<WIDTH, COUNT>::from_f64;
        let [unit, b, logarithms] = self.space.at_places(places);
        let turn = number(2.0) - number(4.0) * unit;
        let mut functions = [number(0.0); FUNCTIONS];
        functions[..OF_LOAD].copy_from_slice(&self.sums::<_, _, 0, OF_LOAD>(turn));
        AtPlaces { b, turn, functions, reduced: self.reduced_of(functions, logarithms, b), logarithms }
    }

    /// And all of it.
    #[inline(always)]
    pub(super) fn whole<const WIDTH: usize, const COUNT: usize>(
        &self,
        at: &AtPlaces<WIDTH, COUNT>,
    ) -> Reduced<Lanes<WIDTH, COUNT>> {
        let mut functions = at.functions;
        functions[OF_LOAD..].copy_from_slice(&self.sums::<_, _, OF_LOAD, { FUNCTIONS - OF_LOAD }>(at.turn));
        self.reduced_of(functions, at.logarithms, at.b)
    }

    /// Clenshaw's sums of functions from one on, side by side: no addition waits for the one before.
    #[inline(always)]
    fn sums<const WIDTH: usize, const COUNT: usize, const FROM: usize, const OF: usize>(
        &self,
        turn: Lanes<WIDTH, COUNT>,
    ) -> [Lanes<WIDTH, COUNT>; OF] {
        let number = Lanes::<WIDTH, COUNT>::from_f64;
        let (mut even, mut odd) = ([number(0.0); OF], [number(0.0); OF]);
        // Two degrees at a time, so that sums need not be moved.
        let (of_even, of_odd) = self.coefficients.split_at(self.coefficients.len() / 2);
        for pair in (0..self.states.count() / 2).rev() {
            let lane = pair % LANES;
            let (of_even, of_odd) = (&of_even[pair / LANES], &of_odd[pair / LANES]);
            let last = if pair == 0 { number(0.5) * turn } else { turn };
            for function in 0..OF {
                odd[function] = (number(of_odd[FROM + function][lane]) - odd[function])
                    .minus_product(turn, even[function]);
            }
            for function in 0..OF {
                even[function] = (number(of_even[FROM + function][lane]) - even[function])
                    .minus_product(last, odd[function]);
            }
        }
        even
    }

    /// From what is a polynomial to the functions themselves.
    #[inline(always)]
    pub(super) fn reduced_of<T: Real>(&self, functions: [T; FUNCTIONS], logarithm: T, b: T) -> Reduced<T> {
        let reduced = Reduced::of_functions(functions);
        match self.form {
            Form::Plain => {
                let share = T::from_f64(self.space.logarithm_share(self.even));
                Reduced { singular: reduced.singular.minus_product(share, logarithm), ..reduced }
            }
            Form::Scaled { bed } => reduced.scaled(T::from_f64(1.0) / scale(self.even, bed, b)),
            Form::Logarithm => {
                let singular = reduced.singular.exp();
                Reduced { singular, ..reduced.scaled(singular) }
            }
        }
    }

    /// Whether the first function is a logarithm.
    pub(super) fn has_logarithm(&self) -> bool {
        self.form == Form::Logarithm
    }

    /// The greater of what is known at the nodes around a state.
    pub fn around(node: usize, of_nodes: &[f64]) -> f64 {
        of_nodes[node].max(of_nodes[(node + 1).min(of_nodes.len() - 1)])
    }
}

/// What is known of the states at places on a curve.
pub(super) struct AtPlaces<const WIDTH: usize, const COUNT: usize> {
    /// Of the pin.
    pub(super) b: Lanes<WIDTH, COUNT>,
    /// Those `OF_LOAD`, the others being zero.
    pub(super) reduced: Reduced<Lanes<WIDTH, COUNT>>,
    functions: [Lanes<WIDTH, COUNT>; FUNCTIONS],
    /// -2 of the variable of the polynomials, from -1 to 1.
    turn: Lanes<WIDTH, COUNT>,
    logarithms: Lanes<WIDTH, COUNT>,
}

/// s, beside a bed.
#[inline(always)]
fn scale<T: Real>(even: f64, bed: f64, b: T) -> T {
    let number = T::from_f64;
    b * number(even + bed) / (number(even) * b + number(bed))
}

/// From values at the nodes to Chebyshev coefficients.
struct Transform<'a> {
    rows: &'a [Vec<[f64; LANES]>],
    states: &'a EdgeStates,
    /// All of it is overwritten.
    coefficients: Vec<Functions>,
}

impl LaneWork for Transform<'_> {
    type Output = Vec<Functions>;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> Vec<Functions> {
        let Transform { rows, states, mut coefficients } = self;
        let count = states.count();
        let (even, odd) = rows.split_at(rows.len() / 2);
        coefficients.resize(rows.len(), [[0.0; LANES]; FUNCTIONS]);
        // Of degree 0 half as much.
        let share = Lanes::<WIDTH>::from_f64(2.0 / count as f64);
        for chunk in 0..even.len() {
            let mut sums = [[Lanes::<WIDTH>::zero(); FUNCTIONS]; 2];
            for (node, (even, odd)) in even[chunk].iter().zip(&odd[chunk]).enumerate() {
                let far = count - 1 - node;
                let (of_near, of_far) = (states.functions(node / LANES), states.functions(far / LANES));
                for function in 0..FUNCTIONS {
                    let (near, far) = (of_near[function][node % LANES], of_far[function][far % LANES]);
                    // Even degrees are the same at the node opposite, odd ones its negative.
                    let minus_sum = Lanes::from_f64(-near - far);
                    let minus_difference = Lanes::from_f64(far - near);
                    sums[0][function] = sums[0][function].minus_product(Lanes(*even), minus_sum);
                    sums[1][function] = sums[1][function].minus_product(Lanes(*odd), minus_difference);
                }
            }
            for parity in 0..2 {
                for function in 0..FUNCTIONS {
                    coefficients[parity * rows.len() / 2 + chunk][function] =
                        (sums[parity][function] * share).0;
                }
            }
        }
        coefficients[0].iter_mut().for_each(|sums| sums[0] *= 0.5);
        coefficients
    }
}
