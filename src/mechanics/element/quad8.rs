//! Q8: the quadratic serendipity quadrilateral.

use super::{MAX_NODES, ShapeFunctions};

const CORNERS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];

/// Corners: N_i = (1 + xi_i xi)(1 + eta_i eta)(xi_i xi + eta_i eta - 1)/4; mid-sides: (1 - xi^2)(1 + eta_i eta)/2 and
/// (1 + xi_i xi)(1 - eta^2)/2.
pub fn shape_functions(xi: f64, eta: f64) -> ShapeFunctions {
    let mut shape =
        ShapeFunctions { value: [0.0; MAX_NODES], by_xi: [0.0; MAX_NODES], by_eta: [0.0; MAX_NODES] };
    for (node, (a, b)) in CORNERS.into_iter().enumerate() {
        shape.value[node] = 0.25 * (1.0 + a * xi) * (1.0 + b * eta) * (a * xi + b * eta - 1.0);
        shape.by_xi[node] = 0.25 * a * (1.0 + b * eta) * (2.0 * a * xi + b * eta);
        shape.by_eta[node] = 0.25 * b * (1.0 + a * xi) * (a * xi + 2.0 * b * eta);
    }
    for (node, b) in [(4, -1.0), (6, 1.0)] {
        shape.value[node] = 0.5 * (1.0 - xi * xi) * (1.0 + b * eta);
        shape.by_xi[node] = -xi * (1.0 + b * eta);
        shape.by_eta[node] = 0.5 * b * (1.0 - xi * xi);
    }
    for (node, a) in [(5, 1.0), (7, -1.0)] {
        shape.value[node] = 0.5 * (1.0 + a * xi) * (1.0 - eta * eta);
        shape.by_xi[node] = 0.5 * a * (1.0 - eta * eta);
        shape.by_eta[node] = -eta * (1.0 + a * xi);
    }
    shape
}
