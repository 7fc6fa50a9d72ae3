//! The breakpoints of a table: chosen among the places where its curves are known so that every rule stays within an error.

use crate::engine::explain::percent;
use crate::error::Error;
use crate::output::export::interpolation::{Interpolant, Interpolation};
use crate::output::export::numbers::rounded;
use crate::output::export::samples::Samples;

/// The most points of an axis.
const MOST_POINTS: usize = 400;

/// Places where curves are asked: every fourth may become a point, the other even ones choose them, and the odd
/// ones, which nothing has seen, measure what was reached.
pub const PLACES: usize = 2400;

/// Every how many of them may become points.
pub const STRIDE: usize = 4;

/// Points at the start.
const SPARSEST: usize = 8;

/// What choosing aims at, of what is asked.
const AIM: f64 = 0.8;

/// The stiffness of Hermite's rule may be off by so many times the force.
const OF_STIFFNESS: f64 = 3.0;

/// Errors that are tried in turn where the one that is asked cannot be had, to say which can.
const LARGER: [f64; 14] = [1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2];

/// What points are chosen from, and for.
pub struct Choice<'a> {
    pub places: &'a [f64],
    /// Places where curves bend. They are points in any case: beside them halving would end with steps in which the digits of a force do not tell its
    /// slope.
    pub bends: &'a [usize],
    pub curves: &'a [Samples],
    pub rules: &'a [Interpolation],
    /// Between points, mm.
    pub least_step: f64,
}

impl Choice<'_> {
    /// Indices of places that become points: halves segments until all rules are good on all curves.
    pub fn points(&self, error: f64) -> Result<Vec<usize>, Error> {
        self.points_within(error).map_err(|needs| {
            let is_had = |larger: &f64| *larger > error && self.points_within(*larger).is_ok();
            let advice = match LARGER.into_iter().find(is_had) {
                Some(larger) => format!("{} can be had", percent(larger)),
                None => "ask for a larger error".into(),
            };
            let problem = format!("{} needs {needs}: {advice}", percent(error));
            Error::Export { what: "error".into(), problem }
        })
    }

    /// The same, or what so small an error needs.
    fn points_within(&self, error: f64) -> Result<Vec<usize>, String> {
        let Choice { places, bends, curves, rules, least_step } = *self;
        let too_many = || format!("more than {MOST_POINTS} points");
        let too_close = || format!("points closer than {least_step} mm, which this format does not take");
        let mut aim = AIM * error;
        loop {
            let even = (0..=SPARSEST).map(|i| i * PLACES / SPARSEST);
            let mut points: Vec<usize> = even.chain(bends.iter().copied()).collect();
            points.sort_unstable();
            points.dedup();
            loop {
                let mut bad = vec![false; points.len() - 1];
                let off = |i: usize, force: f64, slope: f64| {
                    if i.is_multiple_of(2) && force.max(slope / OF_STIFFNESS) > aim {
                        bad[points.partition_point(|point| *point < i) - 1] = true;
                    }
                };
                deviations(places, curves, rules, &points, off);
                if !bad.contains(&true) {
                    break;
                }
                let mut finer = vec![points[0]];
                for (pair, is_bad) in points.windows(2).zip(bad) {
                    let middle = (pair[0] + pair[1]) / (2 * STRIDE) * STRIDE;
                    if is_bad && middle == pair[0] {
                        return Err(too_many());
                    }
                    let steps = [places[middle] - places[pair[0]], places[pair[1]] - places[middle]];
                    if is_bad && steps.into_iter().any(|step| step < least_step) {
                        return Err(too_close());
                    }
                    finer.extend(is_bad.then_some(middle));
                    finer.push(pair[1]);
                }
                points = finer;
                // With zero and the gap's.
                if points.len() + 3 > MOST_POINTS {
                    return Err(too_many());
                }
            }
            let mut worst = 0.0_f64;
            deviations(places, curves, rules, &points, |i, force, slope| {
                if i % 2 == 1 {
                    worst = worst.max(force).max(slope / OF_STIFFNESS);
                }
            });
            if worst <= error {
                return Ok(points);
            }
            aim *= 0.5;
        }
    }
}

/// Tells the relative deviations of force and (of Hermite's rule) stiffness at every place that is no point.
pub fn deviations(
    places: &[f64],
    curves: &[Samples],
    rules: &[Interpolation],
    points: &[usize],
    mut tell: impl FnMut(usize, f64, f64),
) {
    for curve in curves {
        let (x, y, slopes) = with_gap(places, curve, points);
        for rule in rules {
            let interpolant = Interpolant::new(*rule, &x, &y, &slopes);
            for i in (0..places.len()).filter(|i| points.binary_search(i).is_err()) {
                let (force, slope) = interpolant.at(places[i]);
                let of_slope = match rule {
                    Interpolation::Hermite => (slope / curve.stiffness[i] - 1.0).abs(),
                    _ => 0.0,
                };
                tell(i, (force / curve.force[i] - 1.0).abs(), of_slope);
            }
        }
    }
}

/// Rows of the gap, zero and the points, as they are written.
fn with_gap(places: &[f64], curve: &Samples, points: &[usize]) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let end = places[places.len() - 1];
    let at = |values: &[f64]| -> Vec<f64> { points.iter().map(|i| rounded(values[*i], 9)).collect() };
    let x = [-end, -0.5 * end, 0.0].into_iter().chain(points.iter().map(|i| places[*i])).collect();
    let y = [0.0; 3].into_iter().chain(at(&curve.force)).collect();
    let slopes = [0.0; 3].into_iter().chain(at(&curve.stiffness)).collect();
    (x, y, slopes)
}
