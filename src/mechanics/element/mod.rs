//! Isoparametric quadrilaterals: which there are, and what all of them share.

pub mod quadrature;
pub mod quad4;
pub mod quad8;
pub mod stiffness;

/// The family of an element. Nodes run counter-clockwise over the corners, then over the mid-sides, the first
/// of which lies between corners 0 and 1. Strain order (xx, yy, engineering xy); dof = 2 * node + component.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementKind {
    /// Four nodes, bilinear, with the mean dilatation (B-bar): no volumetric locking.
    Quad4,
    /// Eight nodes, serendipity, integrated at 2 x 2 points: no volumetric locking.
    Quad8,
}

impl ElementKind {
    pub const fn node_count(self) -> usize {
        match self {
            ElementKind::Quad4 => 4,
            ElementKind::Quad8 => 8,
        }
    }

    /// Nodes along one side, ends included.
    pub const fn side_node_count(self) -> usize {
        match self {
            ElementKind::Quad4 => 2,
            ElementKind::Quad8 => 3,
        }
    }
}

/// The most nodes any element has.
pub const MAX_NODES: usize = 8;

/// Shape functions and their derivatives by xi and eta at one point; entries past the node count are zero.
#[derive(Clone, Copy, Debug)]
pub struct ShapeFunctions {
    pub value: [f64; MAX_NODES],
    pub by_xi: [f64; MAX_NODES],
    pub by_eta: [f64; MAX_NODES],
}

impl ShapeFunctions {
    /// At a point of the reference square [-1, 1]^2.
    pub fn at(kind: ElementKind, xi: f64, eta: f64) -> ShapeFunctions {
        match kind {
            ElementKind::Quad4 => quad4::shape_functions(xi, eta),
            ElementKind::Quad8 => quad8::shape_functions(xi, eta),
        }
    }
}

/// Lagrange polynomials of one side at `xi` in [-1, 1], ordered along the side; what a ring's trace is made of.
pub fn side_functions(kind: ElementKind, xi: f64) -> ([f64; 3], usize) {
    match kind {
        ElementKind::Quad4 => ([0.5 * (1.0 - xi), 0.5 * (1.0 + xi), 0.0], 2),
        ElementKind::Quad8 => ([0.5 * xi * (xi - 1.0), 1.0 - xi * xi, 0.5 * xi * (xi + 1.0)], 3),
    }
}
