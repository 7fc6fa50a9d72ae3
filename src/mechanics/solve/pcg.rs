//! Conjugate gradients with Jacobi's preconditioner: the readable twin of `shaders/pcg.wgsl`.
//!
//! Hestenes & Stiefel, J. Res. Nat. Bur. Standards 49 (1952) 409-436; with the preconditioner as in Saad, Iterative
//! Methods for Sparse Linear Systems (2003), algorithm 9.1. M = diag K:
//!
//! ```text
//!   x = 0, r = b, z = M^-1 r, p = z, rho = r.z
//!   until sqrt(rho) <= tolerance sqrt(b.M^-1 b):
//!       q = K p,  alpha = rho / p.q
//!       x += alpha p,  r -= alpha q,  z = M^-1 r
//!       beta = r.z / rho,  rho = r.z,  p = z + beta p
//! ```
//!
//! One workgroup of the kernel owns four systems, that is right-hand sides, of one body: the whole iteration runs inside
//! it, its invocations stride over the rows, sums are taken over the strides and then as a tree, and each system stops
//! on its own. Here the systems go one after the other, with the same sums in the same order.
//!
//! **Norm.** Both sides of the stop test, and both residuals reported, are |r| = sqrt(r.M^-1 r) over |b| in the same
//! norm: rho is at hand, and it weighs large and small elements of a graded mesh alike. The recursive r drifts from
//! b - K x, in f32 long before the tolerances one would like, so the true residual is recomputed at the end, in f64.

use crate::mechanics::assembly::Csr;
use crate::mechanics::real::Real;

/// Invocations of a workgroup, hence partial sums of a dot product.
const INVOCATIONS: usize = 64;

/// A true residual this many times the tolerance is not what was asked: rounding has taken over.
pub const ALLOWED_DRIFT: f64 = 2.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PcgSettings {
    /// Residual to reach, relative, in the norm above.
    pub tolerance: f64,
    pub iteration_limit: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PcgOutcome {
    Converged,
    /// The recursive residual reached the tolerance, the true one is more than `ALLOWED_DRIFT` times as large.
    Stagnated,
    IterationLimit,
    /// p.K p or an entry of the diagonal is not positive.
    Indefinite,
    /// NaN or an infinity in the matrix, the load or an iterate.
    NotFinite,
}

/// How one system ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PcgReport {
    pub outcome: PcgOutcome,
    /// Products with K.
    pub iterations: usize,
    /// |r|/|b| of the recursion, what the stop test saw.
    pub recursive_residual: f64,
    /// |b - K x|/|b| in f64.
    pub true_residual: f64,
}

/// Solutions, one contiguous column for each right-hand side, and how each was reached.
#[derive(Clone, Debug)]
pub struct PcgSolution<T> {
    pub columns: Vec<T>,
    pub reports: Vec<PcgReport>,
}

/// Solves K x = b for every column b of `loads`.
///
/// * `matrix` -- K in the precision of the iteration
/// * `exact` -- the same K in f64, for the true residual
/// * `loads` -- right-hand sides, each one contiguous
pub fn pcg<T: Real + PartialOrd + Into<f64>>(
    matrix: Csr<'_, T>,
    exact: Csr<'_, f64>,
    loads: &[f64],
    settings: &PcgSettings,
) -> PcgSolution<T> {
    let size = matrix.row_count();
    let mut columns = vec![T::zero(); loads.len()];
    let diagonal = exact.diagonal();
    let reports = loads.chunks_exact(size).zip(columns.chunks_exact_mut(size)).map(|(load, x)| {
        let b: Vec<T> = load.iter().map(|&value| T::from_f64(value)).collect();
        let mut report = pcg_system(matrix, &b, settings, x);
        report.true_residual = true_residual(exact, &diagonal, load, x);
        let drifted =
            report.true_residual > ALLOWED_DRIFT * settings.tolerance || report.true_residual.is_nan();
        if report.outcome == PcgOutcome::Converged && drifted {
            report.outcome = PcgOutcome::Stagnated;
        }
        report
    });
    let reports = reports.collect();
    PcgSolution { columns, reports }
}

/// One workgroup's work: x from 0 to the solution of K x = b. The true residual is left to the host.
pub(super) fn pcg_system<T: Real + PartialOrd + Into<f64>>(
    matrix: Csr<'_, T>,
    b: &[T],
    settings: &PcgSettings,
    x: &mut [T],
) -> PcgReport {
    let size = matrix.row_count();
    let diagonal = matrix.diagonal();
    let mut r = b.to_vec();
    let mut z: Vec<T> = r.iter().zip(&diagonal).map(|(&r, &d)| r / d).collect();
    let mut p = z.clone();
    let mut q = vec![T::zero(); size];
    let mut rho = dot(&r, &z);
    let norm_b = rho.sqrt();
    let stop = T::from_f64(settings.tolerance) * norm_b;
    let mut iterations = 0;
    let indefinite = diagonal.iter().any(|&d| d <= T::zero());
    let outcome = loop {
        if indefinite {
            break PcgOutcome::Indefinite;
        }
        if !rho.into().is_finite() {
            break PcgOutcome::NotFinite;
        }
        if rho.sqrt() <= stop {
            break PcgOutcome::Converged;
        }
        if iterations == settings.iteration_limit {
            break PcgOutcome::IterationLimit;
        }
        matrix.multiply(&p, &mut q);
        iterations += 1;
        let curvature = dot(&p, &q);
        if !curvature.into().is_finite() {
            break PcgOutcome::NotFinite;
        }
        if curvature <= T::zero() {
            break PcgOutcome::Indefinite;
        }
        let alpha = rho / curvature;
        for row in 0..size {
            x[row] += alpha * p[row];
            r[row] -= alpha * q[row];
            z[row] = r[row] / diagonal[row];
        }
        let next = dot(&r, &z);
        let beta = next / rho;
        rho = next;
        for row in 0..size {
            p[row] = z[row] + beta * p[row];
        }
    };
    PcgReport {
        outcome,
        iterations,
        recursive_residual: relative(rho.into().sqrt(), norm_b.into()),
        true_residual: f64::NAN,
    }
}

/// sum a_i b_i, as a workgroup does it: strided partial sums, then a tree.
fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    let mut partial = [T::zero(); INVOCATIONS];
    for (row, (&a, &b)) in a.iter().zip(b).enumerate() {
        partial[row % INVOCATIONS] += a * b;
    }
    let mut width = INVOCATIONS / 2;
    while width > 0 {
        for invocation in 0..width {
            let other = partial[invocation + width];
            partial[invocation] += other;
        }
        width /= 2;
    }
    partial[0]
}

/// |b - K x|/|b|, all in f64, |v| = sqrt(v.M^-1 v).
fn true_residual<T: Real + Into<f64>>(exact: Csr<'_, f64>, diagonal: &[f64], load: &[f64], x: &[T]) -> f64 {
    let (mut squares, mut load_squares) = (0.0, 0.0);
    for (row, (&load, &diagonal)) in load.iter().zip(diagonal).enumerate() {
        let product: f64 = exact.row(row).map(|(column, value)| value * x[column].into()).sum();
        squares += (load - product) * (load - product) / diagonal;
        load_squares += load * load / diagonal;
    }
    relative(squares.sqrt(), load_squares.sqrt())
}

/// A load of zero is solved by zero.
pub(super) fn relative(norm: f64, norm_b: f64) -> f64 {
    if norm == 0.0 { 0.0 } else { norm / norm_b }
}
