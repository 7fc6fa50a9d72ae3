//! Meshes for contact node by node, which must resolve the contact themselves: bodies of all shapes have ring nodes at the
//! same angles, as pin and plate must.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::mechanics::element::ElementKind;
use crate::mechanics::layers::{Layers, layer_thicknesses};
use crate::mechanics::lining_rows::LiningDivision;
use crate::mechanics::mesh::Grading;

/// A mesh as finely divided at every contact angle from `least_angle` up: ring spacing h = max(least_angle/q, phi/q),
/// with a node at pi/2, layers from the same least spacing growing at the same rate down to `depth`. The ring ends at
/// `end`, pi/2 or pi.
pub fn contact_grading(element: ElementKind, least_angle: f64, q: f64, end: f64, depth: f64) -> Grading {
    let first = least_angle / q;
    let mut angles = vec![0.0];
    for quarter in [FRAC_PI_2, PI] {
        let start = angles.len() - 1;
        let from = angles[start];
        let mut reached = from;
        while reached < quarter - 1e-9 {
            reached += (reached / q).max(first);
            angles.push(reached);
        }
        let scale = (quarter - from) / (reached - from);
        angles[start + 1..].iter_mut().for_each(|angle| *angle = from + (*angle - from) * scale);
        if let Some(last) = angles.last_mut() {
            *last = quarter;
        }
        if end <= quarter {
            break;
        }
    }
    let growth = 1.0 + 1.0 / q;
    let thickest_layer = growth.ln().max(first);
    let mut reached = 0.0;
    let enough = layer_thicknesses(first, thickest_layer, growth).take_while(|thickness| {
        let go_on = reached < depth;
        reached += thickness;
        go_on
    });
    let layer_count = enough.count().max(2);
    Grading {
        element,
        angles,
        layers: Layers { first, thickest: thickest_layer, count: layer_count, shrinking: 0 },
        lining: LiningDivision::default(),
    }
}
