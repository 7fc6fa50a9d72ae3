//! Loads on the rings of meshed bodies, and what a compliance makes of them.

use std::f64::consts::PI;

use super::rings::MeshedBody;
use jointsweep::internals::mechanics::compliance::RingCompliance;
use jointsweep::internals::mechanics::contact::node_contact::ring_joint::RingBody;
use jointsweep::internals::mechanics::element::{ElementKind, side_functions};
use jointsweep::internals::mechanics::layers::Layers;
use jointsweep::internals::mechanics::mesh::{Grading, SUPPORTED};

impl MeshedBody {
    pub fn ring<'a>(&'a self, compliance: &'a RingCompliance, youngs_modulus: f64) -> RingBody<'a> {
        RingBody { topology: &self.topology, compliance, youngs_modulus }
    }

    /// Work-equivalent forces on the ring's unknowns of unit pressure that pushes away from the centre: sum over
    /// sides of integral N_i n ds, with n ds = (dy, -dx) along the side.
    pub fn unit_pressure(&self) -> Vec<f64> {
        let topology = &self.topology;
        let element = topology.element;
        let mut load = vec![0.0; topology.ring_unknown_count()];
        let points = [(-0.6_f64.sqrt(), 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.6_f64.sqrt(), 5.0 / 9.0)];
        let sides =
            topology.ring_nodes.windows(element.side_node_count()).step_by(element.side_node_count() - 1);
        for side in sides {
            for (xi, weight) in points {
                let (functions, count) = side_functions(element, xi);
                // The functions are at most quadratic, so their central difference is exact.
                let (ahead, behind) =
                    (side_functions(element, xi + 0.5).0, side_functions(element, xi - 0.5).0);
                let (mut by_x, mut by_y) = (0.0, 0.0);
                for i in 0..count {
                    let [x, y] = self.coordinates[side[i] as usize];
                    by_x += (ahead[i] - behind[i]) * x;
                    by_y += (ahead[i] - behind[i]) * y;
                }
                for i in 0..count {
                    for (component, share) in [by_y, -by_x].into_iter().enumerate() {
                        let unknown = topology.unknowns[2 * side[i] as usize + component];
                        if unknown != SUPPORTED {
                            load[unknown as usize - topology.ring_start] += weight * functions[i] * share;
                        }
                    }
                }
            }
        }
        load
    }
}

/// C times forces on the ring's unknowns.
pub fn ring_displacement(compliance: &RingCompliance, load: &[f64]) -> Vec<f64> {
    compliance.values.chunks_exact(compliance.size).map(|row| dot(row, load)).collect()
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `count` equal ring elements and layers that grow like the radius, for a concentric body of far radius `ratio`.
pub fn concentric_grading(element: ElementKind, ratio: f64, count: usize, layer_count: usize) -> Grading {
    let first = ratio.ln().abs() / layer_count as f64;
    let angles = (0..=count).map(|i| PI * i as f64 / count as f64).collect();
    let layers = Layers { first, thickest: first, count: layer_count, shrinking: 0 };
    Grading { element, angles, layers, lining: Default::default() }
}
