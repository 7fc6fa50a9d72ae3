//! Bodies that a fit is checked on: the bound of its error.

use rayon::prelude::*;

use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::family::{Family, body_at};
use crate::engine::interpolation::samples::Expense;
use crate::engine::known_errors::known_error;
use crate::engine::plan::mesh_error;
use crate::mechanics::compliance::body_fit::BodyFit;
use crate::mechanics::contact::smooth_curve::CURVE_NODES;
use crate::mechanics::contact::smooth_curve::at_nodes::relative_changes;
use crate::mechanics::contact::smooth_curve::nodes::CurveNodes;

/// Share of the bodies held out whose error is below the bound: what two bodies have is averaged in a joint, so far more
/// of the joints are (`tests/interpolation.rs`).
const BOUNDED: f64 = 0.98;

/// The fit's own error is raised by this: bodies held out are not the worst.
const SAFETY: f64 = 1.25;

/// Arcs beyond which contact with free edges hardly goes, rad: what a fit does there decides nothing.
const WIDEST: f64 = 1.8;

/// Bodies that a fit is checked on.
pub(super) struct HeldOut {
    points: Vec<Vec<f64>>,
    amplitudes: Vec<f64>,
    /// Their compliances on the finest mesh so far.
    expected: Vec<Vec<f64>>,
    /// The error of that mesh.
    pub(super) of_mesh: Vec<[f64; CURVE_NODES]>,
    /// Whether it is known, without a coarser one.
    known: bool,
}

impl HeldOut {
    pub(super) fn new(family: &Family, known: bool) -> HeldOut {
        let points = family.held_out_points();
        let amplitude = |point: &Vec<f64>| {
            let body = body_at(&family.example, point);
            2.0 / body.idealization.plane_modulus_ratio(body.poissons_ratio)
        };
        let amplitudes = points.iter().map(amplitude).collect();
        HeldOut { points, amplitudes, expected: Vec::new(), of_mesh: Vec::new(), known }
    }

    /// Goes on to a mesh; where its error is not known the change since the one before tells it.
    pub(super) fn solve(
        &mut self,
        family: &Family,
        level: usize,
        library: &mut BodyLibrary,
        nodes: &CurveNodes,
        expense: &mut Expense,
    ) {
        let coarse = std::mem::take(&mut self.expected);
        self.expected = family.solve(library, nodes, &self.points, family.fidelity(level));
        expense.add(family, self.points.len(), level);
        self.of_mesh = if family.exact {
            vec![[0.0; CURVE_NODES]; self.points.len()]
        } else if self.known {
            let known = |point: &Vec<f64>| {
                let body = body_at(&family.example, point);
                nodes.arcs.map(|arc| known_error(&body, level, arc.half_angle).unwrap_or(f64::INFINITY))
            };
            self.points.iter().map(known).collect()
        } else {
            (self.expected.par_iter().zip(&coarse).zip(&self.amplitudes))
                .map(|((fine, coarse), amplitude)| {
                    changes(nodes, *amplitude, fine, coarse).map(|change| mesh_error(level, change))
                })
                .collect()
        };
    }

    /// Of the errors of a fit and of the meshes together.
    pub(super) fn bound(&self, fit: &BodyFit, nodes: &CurveNodes) -> [f64; CURVE_NODES] {
        let errors: Vec<[f64; CURVE_NODES]> = (self.points.par_iter().zip(&self.expected))
            .zip(self.of_mesh.par_iter().zip(&self.amplitudes))
            .map(|((point, expected), (of_mesh, amplitude))| {
                let changes = changes(nodes, *amplitude, expected, &fit.at(point));
                std::array::from_fn(|node| SAFETY * changes[node] + of_mesh[node])
            })
            .collect();
        quantile(&errors)
    }
}

/// Relative changes of the work of a body alone at each node; infinite where they have no value.
fn changes(nodes: &CurveNodes, amplitude: f64, expected: &[f64], found: &[f64]) -> [f64; CURVE_NODES] {
    let difference: Vec<f64> = found.iter().zip(expected).map(|(found, expected)| found - expected).collect();
    relative_changes(nodes, amplitude, expected, &difference)
        .map(|change| if change.is_finite() { change.abs() } else { f64::INFINITY })
}

/// At each node what few of the bounds exceed.
pub(super) fn quantile(bounds: &[[f64; CURVE_NODES]]) -> [f64; CURVE_NODES] {
    std::array::from_fn(|node| {
        let mut of_node: Vec<f64> = bounds.iter().map(|of_body| of_body[node]).collect();
        of_node.sort_by(f64::total_cmp);
        let place = (BOUNDED * of_node.len() as f64) as usize;
        of_node.get(place.min(of_node.len().saturating_sub(1))).copied().unwrap_or(f64::INFINITY)
    })
}

/// Those of the arcs that contact comes to.
pub(super) fn bounds_near(nodes: &CurveNodes, bound: &[f64; CURVE_NODES]) -> impl Iterator<Item = f64> {
    let near = nodes.arcs.iter().zip(bound).filter(|(arc, _)| arc.half_angle < WIDEST);
    near.map(|(_, bound)| *bound)
}

pub(super) fn worst_near(nodes: &CurveNodes, bound: &[f64; CURVE_NODES]) -> f64 {
    bounds_near(nodes, bound).fold(0.0, f64::max)
}
