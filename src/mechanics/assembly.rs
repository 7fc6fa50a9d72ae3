//! The stiffness matrix of a mesh: its sparsity analysed once per topology, its values found per body. Twin of
//! `shaders/assemble.wgsl`, which gathers the values of two nodes at a time, and sums over the points of their elements there.
//!
//! Rows gather from their elements: every value is the sum of its own short list of element entries, always in
//! the same order, so there is no scatter, nothing to lock, and a run repeats bit for bit.
//!
//! ```text
//!   element entries   [element][i][j], i <= j          one block of (2 nodes)^2 an element
//!                          |   \
//!   sources           source_starts[k] .. source_starts[k + 1]      which entries value k is the sum of
//!                          |
//!   values            row_starts[row] .. row_starts[row + 1], columns[k]      CSR over the free unknowns
//! ```

use crate::mechanics::element::stiffness::{Elasticity, ElementRule, ElementStiffness, element_stiffness};
use crate::mechanics::element::{ElementKind, MAX_NODES};
use crate::mechanics::mesh::{RingTopology, SUPPORTED};
use crate::mechanics::real::Real;

/// Why a mesh has no stiffness.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AssemblyError {
    #[error("node {node} is at ({x}, {y})")]
    CoordinateNotFinite { node: usize, x: f64, y: f64 },
    #[error("element {element} is turned inside out")]
    InvertedElement { element: usize },
}

/// A square sparse matrix by rows; columns ascend within a row.
#[derive(Clone, Copy, Debug)]
pub struct Csr<'a, T> {
    pub row_starts: &'a [u32],
    pub columns: &'a [u32],
    pub values: &'a [T],
}

impl<T: Real> Csr<'_, T> {
    pub fn row_count(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// The columns and values of one row.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, T)> {
        let range = self.row_starts[row] as usize..self.row_starts[row + 1] as usize;
        self.columns[range.clone()]
            .iter()
            .zip(&self.values[range])
            .map(|(&column, &value)| (column as usize, value))
    }

    /// product = self x.
    pub fn multiply(&self, x: &[T], product: &mut [T]) {
        for (row, sum) in product.iter_mut().enumerate() {
            *sum = T::zero();
            for (column, value) in self.row(row) {
                *sum += value * x[column];
            }
        }
    }

    pub fn diagonal(&self) -> Vec<T> {
        let at = |row: usize| {
            self.row(row).find(|&(column, _)| column == row).map_or(T::zero(), |(_, value)| value)
        };
        (0..self.row_count()).map(at).collect()
    }
}

/// Where every stiffness value comes from; shared by all bodies of one topology.
pub struct Assembly {
    rule: ElementRule,
    connectivity: Vec<u32>,
    row_starts: Vec<u32>,
    columns: Vec<u32>,
    source_starts: Vec<u32>,
    sources: Vec<u32>,
}

impl Assembly {
    /// Analyses any mesh of quadrilaterals.
    ///
    /// * `connectivity` -- nodes of each element, `element.node_count()` a piece, in the order of `ElementKind`
    /// * `unknowns` -- of each dof (2 * node + component) its unknown, or `SUPPORTED`
    /// * `unknown_count` -- unknowns are `0..unknown_count`
    pub fn new(
        element: ElementKind,
        connectivity: &[u32],
        unknowns: &[u32],
        unknown_count: usize,
    ) -> Assembly {
        let size = 2 * element.node_count();
        let mut entries: Vec<(u32, u32, u32)> = Vec::new();
        for (number, nodes) in connectivity.chunks_exact(element.node_count()).enumerate() {
            let unknown: Vec<u32> = dofs(nodes).map(|dof| unknowns[dof]).collect();
            for i in 0..size {
                for j in 0..size {
                    if unknown[i] != SUPPORTED && unknown[j] != SUPPORTED {
                        let source = number * size * size + i.min(j) * size + i.max(j);
                        entries.push((unknown[i], unknown[j], source as u32));
                    }
                }
            }
        }
        entries.sort_unstable();
        let mut row_starts = vec![0; unknown_count + 1];
        let mut columns: Vec<u32> = Vec::new();
        let mut source_starts: Vec<u32> = Vec::new();
        let mut previous = None;
        for (place, &(row, column, _)) in entries.iter().enumerate() {
            if previous != Some((row, column)) {
                row_starts[row as usize + 1] += 1;
                columns.push(column);
                source_starts.push(place as u32);
                previous = Some((row, column));
            }
        }
        source_starts.push(entries.len() as u32);
        for row in 0..unknown_count {
            row_starts[row + 1] += row_starts[row];
        }
        Assembly {
            rule: ElementRule::new(element),
            connectivity: connectivity.to_vec(),
            row_starts,
            columns,
            source_starts,
            sources: entries.into_iter().map(|(_, _, source)| source).collect(),
        }
    }

    pub fn of_ring(topology: &RingTopology) -> Assembly {
        Assembly::new(topology.element, &topology.connectivity, &topology.unknowns, topology.unknown_count)
    }

    pub fn unknown_count(&self) -> usize {
        self.row_starts.len() - 1
    }

    /// Values of the sparse matrix.
    pub fn value_count(&self) -> usize {
        self.columns.len()
    }

    /// The sparse matrix that `values` (of `stiffness_values`) belong to.
    pub fn matrix<'a, T>(&'a self, values: &'a [T]) -> Csr<'a, T> {
        Csr { row_starts: &self.row_starts, columns: &self.columns, values }
    }

    /// K = sum over elements of integral of B^T D B, over the free unknowns; one value for each of `columns`.
    ///
    /// `coordinates` are those of all nodes. They are made relative to a node of their element in f64, so that
    /// elements far smaller than the body keep their shape in f32.
    pub fn stiffness_values<T: Real>(
        &self,
        elasticity: &Elasticity<f64>,
        coordinates: &[[f64; 2]],
    ) -> Result<Vec<T>, AssemblyError> {
        self.stiffness_values_by(|_| *elasticity, coordinates)
    }

    /// The same of elements with elasticities of their own.
    pub fn stiffness_values_by<T: Real>(
        &self,
        elasticity: impl Fn(usize) -> Elasticity<f64>,
        coordinates: &[[f64; 2]],
    ) -> Result<Vec<T>, AssemblyError> {
        let size = 2 * self.rule.kind.node_count();
        let mut entries: Vec<T> = Vec::with_capacity(self.element_count() * size * size);
        for element in 0..self.element_count() {
            let stiffness: ElementStiffness<T> = self.element(element, &elasticity(element), coordinates)?;
            for row in &stiffness.values[..size] {
                entries.extend_from_slice(&row[..size]);
            }
        }
        let gather = |range: &[u32]| {
            let sources = &self.sources[range[0] as usize..range[1] as usize];
            sources.iter().fold(T::zero(), |sum, &source| sum + entries[source as usize])
        };
        Ok(self.source_starts.windows(2).map(gather).collect())
    }

    /// Force on each dof that holds the body at `displacement` (both over 2 * node + component, supported dofs
    /// included): the load of prescribed displacements with its sign turned, and the reactions of the supports.
    pub fn internal_force(
        &self,
        elasticity: &Elasticity<f64>,
        coordinates: &[[f64; 2]],
        displacement: &[f64],
    ) -> Result<Vec<f64>, AssemblyError> {
        let mut force = vec![0.0; displacement.len()];
        for element in 0..self.element_count() {
            let stiffness: ElementStiffness<f64> = self.element(element, elasticity, coordinates)?;
            for (i, row) in dofs(self.nodes(element)).enumerate() {
                for (j, column) in dofs(self.nodes(element)).enumerate() {
                    force[row] += stiffness.values[i.min(j)][i.max(j)] * displacement[column];
                }
            }
        }
        Ok(force)
    }

    fn element_count(&self) -> usize {
        self.connectivity.len() / self.rule.kind.node_count()
    }

    fn nodes(&self, element: usize) -> &[u32] {
        let count = self.rule.kind.node_count();
        &self.connectivity[element * count..(element + 1) * count]
    }

    fn element<T: Real>(
        &self,
        element: usize,
        elasticity: &Elasticity<f64>,
        coordinates: &[[f64; 2]],
    ) -> Result<ElementStiffness<T>, AssemblyError> {
        let nodes = self.nodes(element);
        let [x0, y0] = coordinates[nodes[0] as usize];
        let mut relative = [[0.0; 2]; MAX_NODES];
        for (place, &node) in relative.iter_mut().zip(nodes) {
            let [x, y] = coordinates[node as usize];
            if !(x.is_finite() && y.is_finite()) {
                return Err(AssemblyError::CoordinateNotFinite { node: node as usize, x, y });
            }
            *place = [x - x0, y - y0];
        }
        let Elasticity { direct, cross, shear } = *elasticity;
        let elasticity =
            Elasticity { direct: T::from_f64(direct), cross: T::from_f64(cross), shear: T::from_f64(shear) };
        let stiffness =
            element_stiffness(&self.rule, &elasticity, &relative.map(|node| node.map(T::from_f64)));
        if stiffness.smallest_jacobian.is_positive() {
            Ok(stiffness)
        } else {
            Err(AssemblyError::InvertedElement { element })
        }
    }
}

/// Dofs of an element's nodes, in the order of its stiffness.
fn dofs(nodes: &[u32]) -> impl Iterator<Item = usize> {
    nodes.iter().flat_map(|&node| [2 * node as usize, 2 * node as usize + 1])
}
