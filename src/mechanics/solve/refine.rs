//! Iterative refinement: conjugate gradients in a number type `T`, rounds of them around a residual in f64. The
//! readable twin of `shaders/refine.wgsl`, which calls f64 `wide` and `T` `real`.
//!
//! Moler, J. ACM 14 (1967) 316-321; with conjugate gradients inside as in Carson & Higham, SIAM J. Sci. Comput. 40
//! (2018) A817-A847. |v| = sqrt(v.M^-1 v) as in `pcg`:
//!
//! ```text
//!   x = 0
//!   until |b - K x| <= goal |b|:
//!       scale = the power of two below |b - K x|
//!       solve K d = (b - K x)/scale        in T, to tolerance, or to what the goal asks
//!       x += scale d                       in f64, as the residual
//! ```
//!
//! Each round works on a right-hand side of norm one to two, so that a small residual does not underflow in f32. The
//! correction of `condense` leaves an error of second order in x, once the residual is that of K in f64: hence few
//! rounds.

use crate::mechanics::assembly::Csr;
use crate::mechanics::real::Real;
use crate::mechanics::solve::pcg::{
    ALLOWED_DRIFT, PcgOutcome, PcgReport, PcgSettings, PcgSolution, pcg_system, relative,
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefineSettings {
    /// Residual that a round has to reach, over the one it began with, as the recursion has it.
    pub tolerance: f64,
    /// True residual that ends a system, over |b|.
    pub goal: f64,
    /// Rounds after the first.
    pub round_limit: u32,
    /// Of all rounds together.
    pub iteration_limit: usize,
}

impl From<PcgSettings> for RefineSettings {
    /// One round and no more.
    fn from(settings: PcgSettings) -> RefineSettings {
        let PcgSettings { tolerance, iteration_limit } = settings;
        RefineSettings { tolerance, goal: ALLOWED_DRIFT * tolerance, round_limit: 0, iteration_limit }
    }
}

/// Solves K x = b for every column b of `loads`; each report has the recursive residual of its last round.
///
/// * `matrix` -- K in the precision of the iteration
/// * `exact` -- the same K in f64
/// * `loads` -- right-hand sides, each one contiguous
pub fn refined<T: Real + PartialOrd + Into<f64>>(
    matrix: Csr<'_, T>,
    exact: Csr<'_, f64>,
    loads: &[f64],
    settings: &RefineSettings,
) -> PcgSolution<f64> {
    let size = matrix.row_count();
    let mut columns = vec![0.0; loads.len()];
    let systems = loads.chunks_exact(size).zip(columns.chunks_exact_mut(size));
    let reports = systems.map(|(load, x)| refined_system(matrix, exact, load, settings, x)).collect();
    PcgSolution { columns, reports }
}

fn refined_system<T: Real + PartialOrd + Into<f64>>(
    matrix: Csr<'_, T>,
    exact: Csr<'_, f64>,
    load: &[f64],
    settings: &RefineSettings,
    x: &mut [f64],
) -> PcgReport {
    let diagonal = exact.diagonal();
    let norm = |v: &[f64]| v.iter().zip(&diagonal).map(|(v, d)| v * (v / d)).sum::<f64>().sqrt();
    let norm_b = norm(load);
    let mut residual = load.to_vec();
    let mut d = vec![T::zero(); x.len()];
    let mut distance = relative(norm_b, norm_b);
    let mut iterations = 0;
    for round in 0.. {
        let scale = power_of_two(distance * norm_b);
        let scaled: Vec<T> = residual.iter().map(|&r| T::from_f64(r / scale)).collect();
        let of_round = PcgSettings {
            tolerance: settings.tolerance.max(0.5 * settings.goal / distance).min(1.0),
            iteration_limit: settings.iteration_limit - iterations,
        };
        d.fill(T::zero());
        let mut report = pcg_system(matrix, &scaled, &of_round, &mut d);
        iterations += report.iterations;
        report.iterations = iterations;
        report.true_residual = distance;
        // What broke down keeps the x of the round before.
        if !matches!(report.outcome, PcgOutcome::Converged | PcgOutcome::IterationLimit) {
            return report;
        }
        x.iter_mut().zip(&d).for_each(|(x, &d)| *x += scale * d.into());
        exact.multiply(x, &mut residual);
        residual.iter_mut().zip(load).for_each(|(r, b)| *r = b - *r);
        distance = relative(norm(&residual), norm_b);
        report.true_residual = distance;
        report.outcome = if !distance.is_finite() {
            PcgOutcome::NotFinite
        } else if distance <= settings.goal {
            PcgOutcome::Converged
        } else if iterations >= settings.iteration_limit {
            PcgOutcome::IterationLimit
        } else if round == settings.round_limit {
            PcgOutcome::Stagnated
        } else {
            continue;
        };
        return report;
    }
    unreachable!("the last round ends the system")
}

/// Not above a positive value, and 2^-126 at least: to scale by it rounds nothing.
fn power_of_two(value: f64) -> f64 {
    let exponent = (value as f32).to_bits() & 0x7f80_0000;
    f32::from_bits(exponent.max(0x0080_0000)).into()
}
