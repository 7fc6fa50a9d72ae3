//! Contact with a free edge on given arcs: the state of a joint as a function of its contact half angle.
//!
//! On the hole's ray at phi the pin has come nearer by delta cos(phi), and the gap was dR (1 - cos phi') (`outlines`). So the pressure
//! on |phi| < eps closes
//!
//! ```text
//!   u_pin[p] + u_plate[p] = delta cos(phi) - dR (1 - cos phi'),
//! ```
//!
//! in the weak sense: integral of p_j times both sides, for every trial pressure. The system is linear in delta and dR, and the
//! edge is free of singularity where the coefficients of the pressure sum to zero. Hence, without iteration, x = delta/e and F/e as
//! functions of eps, with e = dR + delta, the offset of the centres. All that is singular in the compliance A of an arc is
//! -pi/2 c ln b in entry (0, 0). With that row eliminated last,
//!
//! ```text
//!   A = | A_00  r^T |    y = B^-1 r,      S = A_00 - r.y,                   D = 1 - sum(y),
//!       |  r     B  |    w_v = B^-1 v',   V = v_0 - y.v',   Q = w_v.v',     N = sum(w_v),
//!                        w_g = B^-1 g',   G = g_0 - y.g',   Q_vg = w_v.g',  N_g = sum(w_g),   Q_gg = w_g.g',
//! ```
//!
//! where v and g are the integrals of p_k (1 - cos phi) and p_k (1 - cos phi'), the state with a free edge is
//!
//! ```text
//!   x = (G + S N_g/D)/[pi/2 - V + G - S (N - N_g)/D],      W = [x N + (1 - x) N_g]/D,
//!   p_0 = W,    p' = -W y - x w_v - (1 - x) w_g,
//!   F/e = 2 [W (pi/2 - V) + x Q + (1 - x) Q_vg],           dF/d delta = 2 [(pi/2 - V)^2/S + Q],
//!   U/e^2 = S W^2 + x^2 Q + 2 x (1 - x) Q_vg + (1 - x)^2 Q_gg.
//! ```
//!
//! The stiffness is that of a punch that keeps its arc, because the pressure at a free edge does not change to first order as
//! the edge moves (Barber, Contact Mechanics, section 9.3; Mossakovskii 1963).

use std::f64::consts::FRAC_PI_2;

use super::outlines::Outlines;
use super::reduced::{FUNCTIONS, Functions, Reduced};
use crate::mechanics::compliance::arc::{ArcMap, ContactArc, packed};
use crate::mechanics::compliance::lane_work::{LaneWork, TermWork, in_lanes, in_lanes_with_terms};
use crate::mechanics::compliance::pressure_space::{JointCompliance, PressureSpace};
use crate::mechanics::real::{LANES, Lanes, Real};

/// Of two trial pressures over the two before: slower than that their fall is not told by four.
pub const SLOWEST: f64 = 0.9;

/// Tension that truncation may leave at the edge, over the peak pressure.
pub const TENSION: f64 = 0.01;

/// The joint at as many arcs as there are lanes.
#[derive(Clone, Copy)]
struct Edges {
    /// Of `Reduced`.
    functions: Functions,
    /// delta/e and F/e of the state with a free edge.
    indentation: [f64; LANES],
    force: [f64; LANES],
    truncation: [f64; LANES],
    /// The least pressure above the tension allowed.
    least_pressure: [f64; LANES],
    /// Work of the pressure over e^2 b^4.
    work: [f64; LANES],
}

impl Edges {
    const ZERO: Edges = Edges {
        functions: [[0.0; LANES]; FUNCTIONS],
        indentation: [0.0; LANES],
        force: [0.0; LANES],
        truncation: [0.0; LANES],
        least_pressure: [0.0; LANES],
        work: [0.0; LANES],
    };
}

/// The joint at the arcs of a space.
#[derive(Clone, Default)]
pub struct EdgeStates {
    edges: Vec<Edges>,
    /// Coefficients of the trial pressures over e b^2: `[arc / LANES][k]`, an arc a lane.
    pressure: Vec<[f64; LANES]>,
    /// A of the first arc, packed, where that is the whole ring; else nothing.
    whole_ring: Vec<f64>,
}

impl EdgeStates {
    /// The joint's compliance is the sum of its `parts`, of `space`, whose arcs are the pin's.
    pub fn new(space: &PressureSpace, parts: &[&JointCompliance], outlines: &Outlines) -> EdgeStates {
        EdgeStates::default().again(space, parts, outlines)
    }

    /// The same where others were before.
    pub(super) fn again(
        self,
        space: &PressureSpace,
        parts: &[&JointCompliance],
        outlines: &Outlines,
    ) -> EdgeStates {
        in_lanes_with_terms(space.terms, Solve { space, parts, outlines, found: self })
    }

    /// How many arcs there are.
    pub fn count(&self) -> usize {
        self.edges.len() * LANES
    }

    /// What the equations come to at as many arcs as there are lanes.
    #[inline(always)]
    pub(super) fn functions(&self, chunk: usize) -> &Functions {
        &self.edges[chunk].functions
    }

    pub(super) fn functions_mut(&mut self) -> impl Iterator<Item = &mut Functions> {
        self.edges.iter_mut().map(|edges| &mut edges.functions)
    }

    /// Of the state at an arc, delta/e.
    #[inline(always)]
    pub fn indentation(&self, arc: usize) -> f64 {
        self.edges[arc / LANES].indentation[arc % LANES]
    }

    /// F/e.
    #[inline(always)]
    pub(super) fn force(&self, arc: usize) -> f64 {
        self.edges[arc / LANES].force[arc % LANES]
    }

    #[inline(always)]
    pub(super) fn truncation(&self, arc: usize) -> f64 {
        self.edges[arc / LANES].truncation[arc % LANES]
    }

    #[inline(always)]
    pub(super) fn pressure_is_positive(&self, arc: usize) -> bool {
        self.edges[arc / LANES].least_pressure[arc % LANES] >= 0.0
    }

    /// Whether the compliance is positive definite at an arc: the square root of a negative pivot makes everything after it NaN, and S
    /// has no pivot of its own.
    pub(super) fn is_sound(&self, arc: usize) -> bool {
        // S is the first.
        self.edges[arc / LANES].functions[0][arc % LANES] > 0.0
    }

    /// What the equations come to at an arc.
    pub fn reduced(&self, arc: usize) -> Reduced<f64> {
        Reduced::of_functions(self.functions(arc / LANES).map(|lanes| lanes[arc % LANES]))
    }

    /// That of a trial pressure, of so many, over e b^2 at an arc.
    pub(super) fn coefficient(&self, terms: usize, arc: usize, k: usize) -> f64 {
        self.pressure[arc / LANES * terms + k][arc % LANES]
    }

    /// The compliance of the joint on the whole ring, the first arc of press fits, packed.
    pub(super) fn whole_ring(&self) -> &[f64] {
        &self.whole_ring
    }

    /// At each arc, the share by which a change of the joint's compliance changes the work of the pressure: since that is
    /// stationary in the pressure, to first order the relative change of the energy at a given indentation, and of the force
    /// where it changes evenly with the load. Of a whole body it is the share of the work that goes into it.
    pub fn work_shares(&self, space: &PressureSpace, change: &JointCompliance) -> Vec<f64> {
        in_lanes(WorkShares { space, change, states: self })
    }
}

struct Solve<'a> {
    space: &'a PressureSpace,
    parts: &'a [&'a JointCompliance<'a>],
    outlines: &'a Outlines,
    /// All of it is overwritten.
    found: EdgeStates,
}

impl TermWork for Solve<'_> {
    type Output = EdgeStates;

    #[inline(always)]
    fn run<const WIDTH: usize, const TERMS: usize>(mut self) -> EdgeStates {
        let chunks = self.space.arcs.len() / LANES;
        let mut found = std::mem::take(&mut self.found);
        found.edges.resize(chunks, Edges::ZERO);
        found.pressure.resize(TERMS * chunks, [0.0; LANES]);
        for chunk in 0..chunks {
            self.run_chunk::<WIDTH, TERMS>(chunk, &mut found);
        }
        found
    }
}

/// Versines of arcs whose b is smaller by a ratio, over the square of b.
#[inline(always)]
fn versines_over<T: Real, const TERMS: usize>(b: T, ratio: f64) -> [T; TERMS] {
    let mut versines: [T; TERMS] = ContactArc::versines(b * T::from_f64(1.0 / ratio));
    for value in &mut versines {
        *value = *value * T::from_f64(1.0 / (ratio * ratio));
    }
    versines
}

impl Solve<'_> {
    /// Of the joint's compliance, as many arcs as there are lanes. A function, because closures are not always inlined, and what is not
    /// is not compiled for the vectors.
    #[inline(always)]
    fn entry<const WIDTH: usize>(&self, chunk: usize, row: usize, column: usize) -> Lanes<WIDTH> {
        let at = packed(row, column) * self.space.arcs.len() + chunk * LANES;
        let mut sum = Lanes::zero();
        for part in self.parts {
            sum += Lanes::from_slice(&part.values[at..]);
        }
        sum
    }

    #[inline(always)]
    fn run_chunk<const WIDTH: usize, const TERMS: usize>(&self, chunk: usize, found: &mut EdgeStates) {
        let Solve { space: PressureSpace { arcs, turns, .. }, parts, outlines, .. } = *self;
        let even: f64 = parts.iter().map(|part| part.even).sum();
        let (zero, one) = (Lanes::<WIDTH>::zero(), Lanes::<WIDTH>::from_f64(1.0));
        let at = chunk * LANES;
        let mut matrix = [[zero; TERMS]; TERMS];
        for row in 1..TERMS {
            for column in 1..=row {
                matrix[row][column] = self.entry(chunk, row, column);
            }
        }
        let mut coupling = [zero; TERMS];
        for row in 0..TERMS {
            coupling[row] = self.entry(chunk, row, 0);
        }
        let (mut b, mut logarithm) = (zero, zero);
        for (lane, arc) in arcs[at..at + LANES].iter().enumerate() {
            (b.0[lane], logarithm.0[lane]) = (arc.b, FRAC_PI_2 * even * arc.ln_b);
        }
        let [versine, mut gap] = match arcs[at].map {
            ArcMap::Tangent => {
                [versines_over(b, outlines.ratio()), versines_over(b, outlines.ratio().sqrt())]
            }
            ArcMap::Sine => {
                let mut versine = [zero; TERMS];
                for (lanes, own) in versine.iter_mut().zip(ContactArc::versines_of_sines::<TERMS>()) {
                    *lanes = Lanes::from_f64(own);
                }
                [versine; 2]
            }
        };
        let bend = outlines.bend();
        if bend != 0.0 {
            let own: [Lanes<WIDTH>; TERMS] = ContactArc::bent_versines(b);
            for k in 0..TERMS {
                gap[k] = gap[k].minus_product(Lanes::from_f64(-bend), own[k]);
            }
        }
        if at == 0 {
            found.whole_ring.clear();
            if arcs[0].map == ArcMap::Sine {
                for row in 0..TERMS {
                    for column in 0..=row {
                        found.whole_ring.push(self.entry::<WIDTH>(0, row, column).0[0]);
                    }
                }
            }
        }
        let mut solved = [coupling, versine, gap];
        solve_in_place(&mut matrix, &mut solved);
        let [y, w_v, w_g] = solved;
        let mut reduced = Reduced {
            singular: coupling[0] - logarithm,
            edge: one,
            edge_of_versine: zero,
            edge_of_gap: zero,
            versine: versine[0],
            gap: gap[0],
            work: zero,
            mixed_work: zero,
            work_of_gap: zero,
            peak: one,
            peak_of_versine: zero,
            peak_of_gap: zero,
        };
        for k in 1..TERMS {
            reduced.singular = reduced.singular.minus_product(coupling[k], y[k]);
            reduced.versine = reduced.versine.minus_product(y[k], versine[k]);
            reduced.gap = reduced.gap.minus_product(y[k], gap[k]);
            reduced.work = reduced.work.minus_product(-w_v[k], versine[k]);
            reduced.mixed_work = reduced.mixed_work.minus_product(-w_v[k], gap[k]);
            reduced.work_of_gap = reduced.work_of_gap.minus_product(-w_g[k], gap[k]);
            reduced.edge -= y[k];
            reduced.edge_of_versine += w_v[k];
            reduced.edge_of_gap += w_g[k];
            if k % 2 == 0 {
                reduced.peak -= y[k];
                reduced.peak_of_versine += w_v[k];
                reduced.peak_of_gap += w_g[k];
            } else {
                reduced.peak += y[k];
                reduced.peak_of_versine -= w_v[k];
                reduced.peak_of_gap -= w_g[k];
            }
        }
        let (indentation, force) = reduced.load(b);
        // Over e b^2.
        let first = reduced.first(indentation);
        let mut pressure = [first; TERMS];
        for k in 1..TERMS {
            pressure[k] = -(first * y[k] + reduced.between(indentation, w_v[k], w_g[k]));
        }
        let mut most = Lanes::<WIDTH>::from_f64(f64::MIN_POSITIVE);
        for value in &pressure {
            most = -(-most).least(-value.size());
        }
        let last = pressure[TERMS - 2].size() + pressure[TERMS - 1].size();
        let before = match TERMS.checked_sub(4) {
            Some(from) => pressure[from].size() + pressure[from + 1].size(),
            None => most,
        };
        // What was left out goes on falling as these do.
        let ratio = (last / before).least(Lanes::from_f64(SLOWEST));
        let falling = one - ratio;
        let tail = last / (most * falling);
        let least = least_pressure::<WIDTH, TERMS>(&pressure, turns);
        let work = reduced.energy(indentation);
        // Films that are squeezed along a wall yield most to what was left out.
        let mut of_last = zero;
        for k in TERMS - 2..TERMS {
            of_last += self.entry(chunk, k, k) * pressure[k] * pressure[k];
        }
        let tail_work = of_last / (work * falling * falling);
        let tail = tail * tail;
        // Field by field: what is made elsewhere is copied once more.
        let edges = &mut found.edges[chunk];
        let functions = reduced.functions();
        for function in 0..FUNCTIONS {
            edges.functions[function] = functions[function].0;
        }
        edges.indentation = indentation.0;
        edges.force = force.0;
        edges.truncation = (-(-tail_work).least(-tail)).0;
        edges.least_pressure = least.0;
        edges.work = work.0;
        for k in 0..TERMS {
            found.pressure[chunk * TERMS + k] = pressure[k].0;
        }
    }
}

/// Solves for right-hand sides by Cholesky, A = L L^T in the lower triangle, of rows and columns from 1 on.
#[inline(always)]
fn solve_in_place<T: Real, const TERMS: usize, const SIDES: usize>(
    matrix: &mut [[T; TERMS]; TERMS],
    sides: &mut [[T; TERMS]; SIDES],
) {
    let mut inverse = [T::zero(); TERMS];
    for row in 1..TERMS {
        for column in 1..=row {
            let mut value = matrix[row][column];
            for k in 1..column {
                value = value.minus_product(matrix[row][k], matrix[column][k]);
            }
            matrix[row][column] = if column < row { value * inverse[column] } else { value };
        }
        inverse[row] = T::from_f64(1.0) / matrix[row][row].sqrt();
        // Each sum waits for itself: all sides abreast.
        for k in 1..row {
            for side in sides.iter_mut() {
                side[row] = side[row].minus_product(matrix[row][k], side[k]);
            }
        }
        for side in sides.iter_mut() {
            side[row] = side[row] * inverse[row];
        }
    }
    for row in (1..TERMS).rev() {
        for k in row + 1..TERMS {
            for side in sides.iter_mut() {
                side[row] = side[row].minus_product(matrix[k][row], side[k]);
            }
        }
        for side in sides.iter_mut() {
            side[row] = side[row] * inverse[row];
        }
    }
}

/// Places that are looked at side by side: each waits for itself alone.
const ABREAST: usize = 4;

/// The least pressure between the zeros of the highest trial pressure, above the tension allowed.
#[inline(always)]
fn least_pressure<const WIDTH: usize, const TERMS: usize>(
    pressure: &[Lanes<WIDTH>; TERMS],
    turns: &[f64],
) -> Lanes<WIDTH> {
    let mut peak = Lanes::<WIDTH>::zero();
    for (k, value) in pressure.iter().enumerate() {
        if k % 2 == 0 { peak += *value } else { peak -= *value }
    }
    let mut least = peak;
    for turns in turns.chunks(ABREAST) {
        let turns: [f64; ABREAST] = std::array::from_fn(|place| turns[place.min(turns.len() - 1)]);
        let mut current = [Lanes::<WIDTH>::zero(); ABREAST];
        let mut previous = current;
        for coefficient in pressure[1..].iter().rev() {
            for place in 0..ABREAST {
                let turn = Lanes::from_f64(-turns[place]);
                let next = (*coefficient - previous[place]).minus_product(turn, current[place]);
                (current[place], previous[place]) = (next, current[place]);
            }
        }
        for place in 0..ABREAST {
            let half = Lanes::from_f64(-0.5 * turns[place]);
            least = least.least((pressure[0] - previous[place]).minus_product(half, current[place]));
        }
    }
    least - peak * Lanes::from_f64(-TENSION)
}

/// p^T A p at each arc, over that of the joint.
struct WorkShares<'a> {
    space: &'a PressureSpace,
    change: &'a JointCompliance<'a>,
    states: &'a EdgeStates,
}

impl LaneWork for WorkShares<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<const WIDTH: usize>(self) -> Vec<f64> {
        let WorkShares { space: PressureSpace { arcs, terms, .. }, change, states } = self;
        let mut shares = Vec::with_capacity(arcs.len());
        for (chunk, (pressure, edges)) in states.pressure.chunks_exact(*terms).zip(&states.edges).enumerate()
        {
            let at = chunk * LANES;
            let mut work = Lanes::<WIDTH>::zero();
            for row in 0..*terms {
                let mut sum = Lanes::<WIDTH>::zero();
                for column in 0..=row {
                    let entry = Lanes::from_slice(&change.values[packed(row, column) * arcs.len() + at..]);
                    let own = Lanes::<WIDTH>(pressure[column]);
                    sum = sum.minus_product(if column < row { -(own + own) } else { -own }, entry);
                }
                work = work.minus_product(-sum, Lanes(pressure[row]));
            }
            let first = Lanes::<WIDTH>(pressure[0]);
            let logarithm = |lane: usize| FRAC_PI_2 * change.even * arcs[at + lane].ln_b;
            let work = work.minus_product(Lanes(std::array::from_fn(logarithm)), first * first);
            shares.extend((work / Lanes(edges.work)).0);
        }
        shares
    }
}
