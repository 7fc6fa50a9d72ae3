//! The pressure of a press fit on the whole ring: closed all around, or open in places that are not the far side alone.
//!
//! With b_1 and b_c the integrals of the trial pressures and of their products with cos(phi), and lengths over |dR|, the pressure that is
//! closed all around is linear in the offset e from where pin and hole are concentric,
//!
//! ```text
//!   A c = b_1 + e b_c,    c = c_1 + e c_c,    F = 2 b_c.c = 2 (b_c.c_1 + e b_c.c_c),    U = (b_1 + e b_c).c.
//! ```
//!
//! A body that is not concentric is pushed aside by the overlap alone: F is zero at a certain e, where the joint is at rest, open or closed. The
//! offset of a press fit is counted from there. Modes of concentric bodies do not couple: b_c.c_1 is zero, at rest they are concentric, and
//! with the compliance lambda_n of both bodies to cos(n phi)
//!
//! ```text
//!   p = 1/lambda_0 + e cos(phi)/lambda_1,     F = pi e/lambda_1,     up to e = lambda_1/lambda_0,
//! ```
//!
//! where the pressure ends at phi = pi. Of other bodies it may end elsewhere first; until that gap has reached the far side there are two arcs of
//! contact. Of all pressures that nowhere pull, the true one has the least complementary energy,
//!
//! ```text
//!   c.A c/2 - (b_1 + e b_c).c = min,     p >= 0 at places all around:     A c = b_1 + e b_c + sum of g_i l_i,
//! ```
//!
//! l_i >= 0 where p = g_i.c is zero, a gap. Places with a gap are found one by one (Lawson & Hanson, Solving Least Squares Problems, chapter 23).
//! Few trial pressures carry the edges of a gap, but the force, a slope of the least energy, is off by the square of what they leave. The stiffness is a
//! difference of forces: with the gaps held where they are it would be off by some percent.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use super::arc_pressure::ArcPressure;
use super::curve::ContactCurve;
use crate::mechanics::compliance::arc::packed;

/// The joint on the whole ring. Lengths are over |dR|, offsets from where pin and hole are concentric.
pub(super) struct WholeRing<'a> {
    /// Angles, and g at each.
    places: &'a [(f64, Vec<f64>)],
    /// Of A.
    inverse: Mat<f64>,
    /// c_1 and c_c.
    of_overlap: Vec<f64>,
    of_offset: Vec<f64>,
    /// Where there is no force, whether the contact is closed there or not.
    pub rest: f64,
}

/// A state of it.
pub(super) struct RingState {
    pub offset: f64,
    /// Where the pressure ends, rad.
    pub half_angle: f64,
    pub force: f64,
    /// dF/de.
    pub stiffness: f64,
    pub energy: f64,
    pub pressure: ArcPressure,
}

/// Tension that is left at places, over the greatest pressure.
const TENSION: f64 = 1e-7;

/// Pressure that is that of few trial pressures beside a gap, over the greatest.
const FAINT: f64 = 2e-3;

/// So many times as many gaps are tried at most as there are places.
const MOST_TRIED: usize = 4;

/// Steps of a search for the offset at most.
const MOST_STEPS: usize = 50;

/// Of differences of forces, over the offset from where the joint is at rest, or |dR| if that is more.
const SLOPE_STEP: f64 = 0.01;

/// Where it ends: the offset that is left, by the stiffness of the closed contact.
const TOLERANCE: f64 = 1e-9;

impl<'a> WholeRing<'a> {
    /// `None` where the compliance is not positive definite.
    pub(super) fn of(curve: &ContactCurve<'a>) -> Option<WholeRing<'a>> {
        let (terms, ring) = (curve.space.pressures.terms, curve.states.whole_ring());
        let matrix = Mat::from_fn(terms, terms, |i, j| ring[packed(i.max(j), i.min(j))]);
        let inverse = matrix.llt(Side::Lower).ok()?.solve(Mat::<f64>::identity(terms, terms));
        let column = |place, times: f64| (0..terms).map(|k| times * inverse[(k, place)]).collect();
        // On the whole ring cos(phi) is -cos(2 tau).
        let (of_overlap, of_offset) = (column(0, FRAC_PI_2), column(1, -FRAC_PI_4));
        let mut ring = WholeRing { places: &curve.space.around, of_overlap, of_offset, inverse, rest: 0.0 };
        ring.rest = ring.rest_of_closed();
        if curve.is_coupled() && ring.opening() < 0.0 {
            ring.rest = ring.under_force(0.0, ring.rest)?.offset;
        }
        Some(ring)
    }

    /// dF/de of the contact that is closed all around.
    pub(super) fn stiffness(&self) -> f64 {
        force(&self.of_offset)
    }

    /// Where there is no force as long as the contact is closed all around.
    fn rest_of_closed(&self) -> f64 {
        -force(&self.of_overlap) / self.stiffness()
    }

    /// Of the contact that is closed all around, at an offset.
    pub(super) fn closed(&self, offset: f64) -> RingState {
        let coefficients = self.closed_coefficients(offset);
        let force = (offset - self.rest_of_closed()) * self.stiffness();
        RingState { force, ..self.state(offset, coefficients, self.stiffness()) }
    }

    fn closed_coefficients(&self, offset: f64) -> Vec<f64> {
        self.of_overlap.iter().zip(&self.of_offset).map(|(own, more)| own + offset * more).collect()
    }

    fn state(&self, offset: f64, coefficients: Vec<f64>, stiffness: f64) -> RingState {
        let force = force(&coefficients);
        let energy = FRAC_PI_2 * coefficients[0] + 0.5 * offset * force;
        let pressure = ArcPressure::of_whole_ring(coefficients);
        RingState { offset, half_angle: PI, force, stiffness, energy, pressure }
    }

    /// The offset, from where the joint is at rest, at which the pressure that is closed all around ends first; below zero where it does so at rest.
    pub(super) fn opening(&self) -> f64 {
        let at_rest = self.closed_coefficients(self.rest_of_closed());
        let ends = |(_, row): &(f64, Vec<f64>)| {
            let (pressure, slope) = (dot(row, &at_rest), dot(row, &self.of_offset));
            match slope < 0.0 {
                _ if pressure < 0.0 => f64::NEG_INFINITY,
                true => -pressure / slope,
                false => f64::INFINITY,
            }
        };
        self.places.iter().map(ends).fold(f64::INFINITY, f64::min)
    }

    /// Of the contact with gaps wherever it would pull, at an offset; `None` where gaps are not found.
    pub(super) fn open(&self, offset: f64) -> Option<RingState> {
        self.with_slope(self.with_gaps_at(offset)?)
    }

    /// With the slope of the forces in place of the stiffness of gaps that stay where they are, which is off by some percent because their edges move
    /// with the load. The difference is taken over more places than one, and not across the opening.
    fn with_slope(&self, state: RingState) -> Option<RingState> {
        let most = SLOPE_STEP * (state.offset - self.rest).abs().max(1.0);
        let opening = self.rest_of_closed() + self.opening();
        let step = (state.offset - opening).max(0.1 * most).min(most);
        let [before, behind] = [(state.offset - step).max(opening), state.offset + step];
        let more = self.with_gaps_at(behind)?.force - self.with_gaps_at(before)?.force;
        Some(RingState { stiffness: more / (behind - before), ..state })
    }

    /// The same with the stiffness of gaps that stay where they are.
    pub(super) fn with_gaps_at(&self, offset: f64) -> Option<RingState> {
        let closed = self.closed_coefficients(offset);
        let mut gaps: Vec<Gap> = Vec::new();
        for _ in 0..MOST_TRIED * self.places.len() {
            let coefficients = with_gaps(&closed, &gaps, gaps.iter().map(|gap| gap.width));
            let pressures: Vec<f64> = self.places.iter().map(|(_, row)| dot(row, &coefficients)).collect();
            let greatest = pressures.iter().copied().fold(0.0, f64::max);
            let least = (0..pressures.len()).min_by(|a, b| pressures[*a].total_cmp(&pressures[*b]))?;
            if pressures[least] >= -TENSION * greatest || gaps.iter().any(|gap| gap.place == least) {
                let change = with_gaps(&self.of_offset, &gaps, widths(&gaps, &self.of_offset)?.into_iter());
                let last = pressures.iter().rposition(|pressure| *pressure > FAINT * greatest)?;
                let half_angle = self.places[last].0;
                return Some(RingState { half_angle, ..self.state(offset, coefficients, force(&change)) });
            }
            gaps.push(self.gap(least));
            loop {
                let wanted = widths(&gaps, &closed)?;
                // As far on the way there as no gap is negative; the one that closes first is none.
                let of_gap = |(place, gap): (usize, &Gap)| (place, gap.width / (gap.width - wanted[place]));
                let closing = gaps.iter().enumerate().filter(|(place, _)| wanted[*place] <= 0.0).map(of_gap);
                let first = closing.min_by(|a, b| a.1.total_cmp(&b.1));
                let share = first.map_or(1.0, |(_, share)| share.clamp(0.0, 1.0));
                for (gap, wanted) in gaps.iter_mut().zip(&wanted) {
                    gap.width += share * (wanted - gap.width);
                }
                match first {
                    Some((place, _)) => drop(gaps.swap_remove(place)),
                    None => break,
                }
            }
        }
        None
    }

    /// A new one.
    fn gap(&self, place: usize) -> Gap<'a> {
        let row = &self.places[place].1;
        let answer = |i: usize| (0..row.len()).map(|j| self.inverse[(i, j)] * row[j]).sum();
        Gap { place, row, answer: (0..row.len()).map(answer).collect(), width: 0.0 }
    }

    /// The same under a force, from an offset on: forces grow ever less with it, so that after the first of Newton's steps all end short of it.
    pub(super) fn under_force(&self, wanted: f64, least: f64) -> Option<RingState> {
        let mut state = self.with_gaps_at(least)?;
        for _ in 0..MOST_STEPS {
            let left = wanted - state.force;
            if left.abs() <= TOLERANCE * self.stiffness() {
                return self.with_slope(state);
            }
            state = self.with_gaps_at(state.offset + left / state.stiffness)?;
        }
        None
    }
}

/// A place where the bodies do not touch.
struct Gap<'a> {
    place: usize,
    /// g, and what it is answered by.
    row: &'a [f64],
    answer: Vec<f64>,
    /// l.
    width: f64,
}

/// Coefficients with what gaps of such widths add.
fn with_gaps(coefficients: &[f64], gaps: &[Gap], widths: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = coefficients.to_vec();
    for (width, gap) in widths.zip(gaps) {
        sum.iter_mut().zip(&gap.answer).for_each(|(sum, own)| *sum += width * own);
    }
    sum
}

/// Those that leave no pressure at the gaps.
fn widths(gaps: &[Gap], coefficients: &[f64]) -> Option<Vec<f64>> {
    if gaps.is_empty() {
        return Some(Vec::new());
    }
    let matrix = Mat::from_fn(gaps.len(), gaps.len(), |i, j| dot(gaps[i].row, &gaps[j].answer));
    let right = Mat::from_fn(gaps.len(), 1, |i, _| -dot(gaps[i].row, coefficients));
    let widths = matrix.llt(Side::Lower).ok()?.solve(&right);
    Some((0..gaps.len()).map(|i| widths[(i, 0)]).collect())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Of both halves.
fn force(coefficients: &[f64]) -> f64 {
    -FRAC_PI_2 * coefficients[1]
}
