//! From a meshed body to the compliance of its ring: C = B^T K^-1 B, where the columns of B are unit forces on the
//! ring's unknowns, which are the last ones. `variational_compliance` is the twin of `shaders/condense.wgsl`.

use crate::mechanics::assembly::{Assembly, AssemblyError, Csr};
use crate::mechanics::compliance::RingCompliance;
use crate::mechanics::element::stiffness::Elasticity;
use crate::mechanics::solve::cholesky::{CholeskyAnalysis, CholeskyError};

/// Right-hand sides solved together: enough to keep the solver busy, few enough to stay in the cache.
const BLOCK: usize = 32;

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CondenseError {
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    #[error(transparent)]
    Cholesky(#[from] CholeskyError),
}

/// By the sparse Cholesky factor of K, in f64.
///
/// * `assembly`, `analysis` -- of the body's topology
/// * `ring_start` -- the first unknown of the ring
/// * `elasticity`, `coordinates` -- of the body, as `Assembly::stiffness_values` takes them
pub fn by_cholesky(
    assembly: &Assembly,
    analysis: &CholeskyAnalysis,
    ring_start: usize,
    elasticity: &Elasticity<f64>,
    coordinates: &[[f64; 2]],
) -> Result<RingCompliance, CondenseError> {
    let values = assembly.stiffness_values(elasticity, coordinates)?;
    let factor = analysis.factorize(assembly.matrix(&values))?;
    let unknowns = assembly.unknown_count();
    let size = unknowns - ring_start;
    let mut compliance = Vec::with_capacity(size * size);
    for first in (0..size).step_by(BLOCK) {
        let mut columns = unit_loads(unknowns, ring_start + first..ring_start + size.min(first + BLOCK));
        factor.solve_in_place(&mut columns);
        compliance.extend(columns.chunks_exact(unknowns).flat_map(|column| &column[ring_start..]));
    }
    Ok(symmetric(size, compliance))
}

/// C = B^T U + U^T (B - K U) from approximate columns U of K U = B.
///
/// With U = K^-1 B + E this is B^T K^-1 B - E^T K E: first-order errors cancel (the Rayleigh-Ritz functional; Pierce
/// & Giles, SIAM Review 42 (2000) 247-264, for the general form).
pub fn variational_compliance(exact: Csr<'_, f64>, ring_start: usize, columns: &[f64]) -> RingCompliance {
    let unknowns = exact.row_count();
    let size = unknowns - ring_start;
    let mut compliance = Vec::with_capacity(size * size);
    let mut residual = vec![0.0; unknowns];
    for (j, column) in columns.chunks_exact(unknowns).enumerate() {
        exact.multiply(column, &mut residual);
        residual.iter_mut().for_each(|value| *value = -*value);
        residual[ring_start + j] += 1.0;
        for (i, other) in columns.chunks_exact(unknowns).enumerate() {
            let correction: f64 = other.iter().zip(&residual).map(|(u, r)| u * r).sum();
            compliance.push(column[ring_start + i] + correction);
        }
    }
    symmetric(size, compliance)
}

/// C = B^T U from approximate columns U of K U = B: what `variational_compliance` is worth. Errors are of first order.
pub fn plain_compliance(unknowns: usize, ring_start: usize, columns: &[f64]) -> RingCompliance {
    let ring = columns.chunks_exact(unknowns).flat_map(|column| &column[ring_start..]).copied();
    symmetric(unknowns - ring_start, ring.collect())
}

/// B: unit forces on the ring's unknowns, each a contiguous column.
pub fn ring_unit_loads(unknowns: usize, ring_start: usize) -> Vec<f64> {
    unit_loads(unknowns, ring_start..unknowns)
}

/// Unit forces on the unknowns of `range`, each a contiguous column.
fn unit_loads(unknowns: usize, range: std::ops::Range<usize>) -> Vec<f64> {
    let mut loads = vec![0.0; unknowns * range.len()];
    for (column, unknown) in range.enumerate() {
        loads[column * unknowns + unknown] = 1.0;
    }
    loads
}

/// Takes the mean of both triangles, which differ by rounding.
fn symmetric(size: usize, mut values: Vec<f64>) -> RingCompliance {
    for i in 0..size {
        for j in 0..i {
            let mean = 0.5 * (values[i * size + j] + values[j * size + i]);
            values[i * size + j] = mean;
            values[j * size + i] = mean;
        }
    }
    RingCompliance { size, values }
}
