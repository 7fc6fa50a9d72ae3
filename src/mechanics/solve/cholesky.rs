//! Sparse Cholesky by faer, in f64: the reference for every other solver, and the path for any topology.
//!
//! The ordering and the factor's pattern are found once per topology, the numbers per body; one thread.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::LltError;
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::mechanics::assembly::Csr;

/// Why a matrix has no Cholesky factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CholeskyError {
    #[error("the stiffness is not positive definite: pivot {pivot} is not positive")]
    NotPositiveDefinite { pivot: usize },
    #[error("not enough memory for the Cholesky factor")]
    OutOfMemory,
}

/// The pattern of a factor; shared by all bodies of one topology.
pub struct CholeskyAnalysis {
    symbolic: SymbolicCholesky<u32>,
}

/// The factor of one body's stiffness.
pub struct Cholesky<'a> {
    symbolic: &'a SymbolicCholesky<u32>,
    values: Vec<f64>,
}

/// A symmetric matrix by rows is the same matrix by columns.
fn pattern<'a, T>(matrix: Csr<'a, T>) -> SymbolicSparseColMatRef<'a, u32> {
    let size = matrix.row_starts.len() - 1;
    SymbolicSparseColMatRef::new_checked(size, size, matrix.row_starts, None, matrix.columns)
}

impl CholeskyAnalysis {
    /// Analyses the pattern of a symmetric `matrix`, which holds both of its triangles; values are not read.
    pub fn new<T>(matrix: Csr<'_, T>) -> Result<CholeskyAnalysis, CholeskyError> {
        let (ordering, parameters) = (SymmetricOrdering::Amd, Default::default());
        let symbolic = factorize_symbolic_cholesky(pattern(matrix), Side::Lower, ordering, parameters)
            .map_err(|_| CholeskyError::OutOfMemory)?;
        Ok(CholeskyAnalysis { symbolic })
    }

    /// L with L L^T = `matrix`, which has the pattern that was analysed.
    pub fn factorize(&self, matrix: Csr<'_, f64>) -> Result<Cholesky<'_>, CholeskyError> {
        let matrix = SparseColMatRef::new(pattern(matrix), matrix.values);
        let mut values = vec![0.0; self.symbolic.len_val()];
        let scratch = self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| CholeskyError::OutOfMemory)?;
        self.symbolic
            .factorize_numeric_llt(
                &mut values,
                matrix,
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| CholeskyError::NotPositiveDefinite {
                pivot: index,
            })?;
        Ok(Cholesky { symbolic: &self.symbolic, values })
    }
}

impl Cholesky<'_> {
    /// Solves for all of `columns` at once: right-hand sides in, solutions out, each one contiguous.
    pub fn solve_in_place(&self, columns: &mut [f64]) {
        let size = self.symbolic.nrows();
        let count = columns.len() / size;
        let scratch = self.symbolic.solve_in_place_scratch::<f64>(count, Par::Seq);
        LltRef::new(self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(columns, size, count),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}
