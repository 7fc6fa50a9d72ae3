//! Plane meshes of quadrilaterals on a rectangle's grid, and their full (uncondensed) solution.

use jointsweep::internals::mechanics::assembly::Assembly;
use jointsweep::internals::mechanics::element::stiffness::Elasticity;
use jointsweep::internals::mechanics::element::{ElementKind, MAX_NODES, ShapeFunctions};
use jointsweep::internals::mechanics::mesh::SUPPORTED;
use jointsweep::internals::mechanics::solve::cholesky::CholeskyAnalysis;

pub const ELEMENTS: [ElementKind; 2] = [ElementKind::Quad4, ElementKind::Quad8];

/// The image of a grid of columns x rows cells on the unit square.
pub struct PlaneMesh {
    pub element: ElementKind,
    pub coordinates: Vec<[f64; 2]>,
    pub connectivity: Vec<u32>,
    /// Column and row of each node, in half elements.
    pub grid: Vec<(usize, usize)>,
    /// Cells along both axes.
    pub cells: (usize, usize),
}

impl PlaneMesh {
    /// Corner nodes at `corner(x, y)` of the unit square, mid-side nodes half-way between them.
    pub fn new(
        element: ElementKind,
        cells: (usize, usize),
        corner: impl Fn(f64, f64) -> [f64; 2],
    ) -> PlaneMesh {
        let step = if element == ElementKind::Quad8 { 1 } else { 2 };
        let at = |column: usize, row: usize| {
            corner(column as f64 / (2 * cells.0) as f64, row as f64 / (2 * cells.1) as f64)
        };
        let middle = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [0.5 * (a + c), 0.5 * (b + d)];
        let mut number = vec![u32::MAX; (2 * cells.0 + 1) * (2 * cells.1 + 1)];
        let (mut grid, mut coordinates) = (Vec::new(), Vec::new());
        for row in (0..=2 * cells.1).step_by(step) {
            for column in (0..=2 * cells.0).step_by(step) {
                let place = match (column % 2, row % 2) {
                    (1, 1) => continue,
                    (1, 0) => middle(at(column - 1, row), at(column + 1, row)),
                    (0, 1) => middle(at(column, row - 1), at(column, row + 1)),
                    _ => at(column, row),
                };
                number[row * (2 * cells.0 + 1) + column] = grid.len() as u32;
                grid.push((column, row));
                coordinates.push(place);
            }
        }
        let mut connectivity = Vec::new();
        for row in (0..2 * cells.1).step_by(2) {
            for column in (0..2 * cells.0).step_by(2) {
                let places = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)];
                let node = |&(i, j): &(usize, usize)| number[(row + j) * (2 * cells.0 + 1) + column + i];
                connectivity.extend(places[..element.node_count()].iter().map(node));
            }
        }
        PlaneMesh { element, coordinates, connectivity, grid, cells }
    }

    pub fn node_count(&self) -> usize {
        self.coordinates.len()
    }

    pub fn on_boundary(&self, node: usize) -> bool {
        let (column, row) = self.grid[node];
        column == 0 || row == 0 || column == 2 * self.cells.0 || row == 2 * self.cells.1
    }

    /// Unknowns of all dofs but those that are `supported`, in the order of the dofs.
    pub fn unknowns(&self, supported: impl Fn(usize) -> bool) -> (Vec<u32>, usize) {
        let mut count = 0;
        let number = |dof| {
            if supported(dof) {
                return SUPPORTED;
            }
            count += 1;
            count - 1
        };
        let unknowns = (0..2 * self.node_count()).map(number).collect();
        (unknowns, count as usize)
    }

    /// Displacement of all dofs under `load`, where `prescribed` holds that of the supported dofs (and zero
    /// elsewhere), and the force that each dof exerts on the body.
    pub fn solve(
        &self,
        elasticity: &Elasticity<f64>,
        supported: impl Fn(usize) -> bool,
        prescribed: &[f64],
        load: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let (unknowns, count) = self.unknowns(supported);
        let assembly = Assembly::new(self.element, &self.connectivity, &unknowns, count);
        let values = assembly.stiffness_values(elasticity, &self.coordinates).unwrap();
        let matrix = assembly.matrix(&values);
        let held = assembly.internal_force(elasticity, &self.coordinates, prescribed).unwrap();
        let mut column = vec![0.0; count];
        for (dof, &unknown) in unknowns.iter().enumerate().filter(|(_, unknown)| **unknown != SUPPORTED) {
            column[unknown as usize] = load[dof] - held[dof];
        }
        CholeskyAnalysis::new(matrix).unwrap().factorize(matrix).unwrap().solve_in_place(&mut column);
        let mut displacement = prescribed.to_vec();
        for (dof, &unknown) in unknowns.iter().enumerate().filter(|(_, unknown)| **unknown != SUPPORTED) {
            displacement[dof] = column[unknown as usize];
        }
        let force = assembly.internal_force(elasticity, &self.coordinates, &displacement).unwrap();
        (displacement, force)
    }

    /// Calls `visit` with (nodes, shape values, gradients by x and y, weight |J|) at every point of a
    /// `rule` x `rule` quadrature.
    pub fn integrate(&self, rule: &[(f64, f64)], mut visit: impl FnMut(&[u32], &[f64], &[[f64; 2]], f64)) {
        for nodes in self.connectivity.chunks_exact(self.element.node_count()) {
            for &(xi, weight_xi) in rule {
                for &(eta, weight_eta) in rule {
                    let shape = ShapeFunctions::at(self.element, xi, eta);
                    let mut jacobian = [[0.0; 2]; 2];
                    for (i, &node) in nodes.iter().enumerate() {
                        for (axis, x) in self.coordinates[node as usize].into_iter().enumerate() {
                            jacobian[0][axis] += shape.by_xi[i] * x;
                            jacobian[1][axis] += shape.by_eta[i] * x;
                        }
                    }
                    let [[a, b], [c, d]] = jacobian;
                    let determinant = a * d - b * c;
                    let mut gradients = [[0.0; 2]; MAX_NODES];
                    for (i, gradient) in gradients.iter_mut().enumerate() {
                        let (xi, eta) = (shape.by_xi[i], shape.by_eta[i]);
                        *gradient = [(d * xi - b * eta) / determinant, (a * eta - c * xi) / determinant];
                    }
                    let count = nodes.len();
                    visit(
                        nodes,
                        &shape.value[..count],
                        &gradients[..count],
                        weight_xi * weight_eta * determinant,
                    );
                }
            }
        }
    }
}

/// Repeatable numbers in [-1, 1] without a pattern (splitmix64).
pub fn scatter(seed: u64) -> f64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Order of convergence from the errors of two meshes, the second with half the spacing.
pub fn order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}
