//! Q4: the bilinear quadrilateral.

use super::{MAX_NODES, ShapeFunctions};

const CORNERS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

/// N_i = (1 + xi_i xi)(1 + eta_i eta)/4 and its derivatives.
pub fn shape_functions(xi: f64, eta: f64) -> ShapeFunctions {
    let mut shape =
        ShapeFunctions { value: [0.0; MAX_NODES], by_xi: [0.0; MAX_NODES], by_eta: [0.0; MAX_NODES] };
    for (node, (a, b)) in CORNERS.into_iter().enumerate() {
        shape.value[node] = 0.25 * (1.0 + a * xi) * (1.0 + b * eta);
        shape.by_xi[node] = 0.25 * a * (1.0 + b * eta);
        shape.by_eta[node] = 0.25 * b * (1.0 + a * xi);
    }
    shape
}
