//! Bodies that a fit is checked on: the bound of its error.

use rayon::prelude::*;

use crate::engine::accuracy::known_errors::known_error;
use crate::engine::accuracy::mesh_change::mesh_error;
use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::family::{Family, body_at, fit_space};
use crate::engine::interpolation::samples::Expense;
use crate::engine::spaces::Spaces;
use crate::mechanics::compliance::body_fit::BodyFit;
use crate::mechanics::compliance::infinite;
use crate::mechanics::compliance::pressure_space::JointCompliance;
use crate::mechanics::contact::curve::CurveSpace;
use crate::mechanics::contact::edge::EdgeStates;

/// Share of the bodies held out whose error is below the bound: what two bodies have is averaged in a joint, so far more
/// of the joints are (`tests/interpolation.rs`).
const BOUNDED: f64 = 0.98;

/// The fit's own error is raised by this: bodies held out are not the worst.
const SAFETY: f64 = 1.5;

/// Arcs beyond which contact with free edges hardly goes, rad: what a fit does there decides nothing.
const WIDEST: f64 = 1.8;

/// Bodies that a fit is checked on.
pub(super) struct HeldOut {
    points: Vec<Vec<f64>>,
    amplitudes: Vec<f64>,
    /// Their compliances on the finest mesh so far.
    expected: Vec<Vec<f64>>,
    /// The error of that mesh.
    pub(super) of_mesh: Vec<Vec<f64>>,
    /// Whether it is known, without a coarser one.
    known: bool,
}

impl HeldOut {
    pub(super) fn new(family: &Family, known: bool) -> HeldOut {
        let points = family.held_out_points();
        let amplitude = |point: &Vec<f64>| infinite(&body_at(&family.example, point))[0];
        let amplitudes = points.iter().map(amplitude).collect();
        HeldOut { points, amplitudes, expected: Vec::new(), of_mesh: Vec::new(), known }
    }

    /// Goes on to a mesh; where its error is not known the change since the one before tells it.
    pub(super) fn solve(
        &mut self,
        family: &Family,
        level: usize,
        library: &mut BodyLibrary,
        spaces: &mut Spaces,
        expense: &mut Expense,
    ) {
        let coarse = std::mem::take(&mut self.expected);
        self.expected = family.solve(library, spaces, &self.points, family.fidelity(level));
        expense.add(family, self.points.len(), level);
        let space = spaces.get(fit_space(family.key.half_ring));
        self.of_mesh = if family.exact {
            vec![vec![0.0; space.arcs().len()]; self.points.len()]
        } else if self.known {
            let known = |point: &Vec<f64>| {
                let body = body_at(&family.example, point);
                let at = |half_angle| known_error(&body, level, half_angle).unwrap_or(f64::INFINITY);
                space.arcs().iter().map(|arc| at(arc.half_angle)).collect()
            };
            self.points.iter().map(known).collect()
        } else {
            (self.expected.par_iter().zip(&coarse).zip(&self.amplitudes))
                .map(|((fine, coarse), amplitude)| {
                    let changes = changes(space, *amplitude, fine, coarse).into_iter();
                    changes.map(|change| mesh_error(level, change)).collect()
                })
                .collect()
        };
    }

    /// Of the errors of a fit and of the meshes together.
    pub(super) fn bound(&self, fit: &BodyFit, space: &CurveSpace) -> Vec<f64> {
        let errors: Vec<Vec<f64>> = (self.points.par_iter().zip(&self.expected))
            .zip(self.of_mesh.par_iter().zip(&self.amplitudes))
            .map(|((point, expected), (of_mesh, amplitude))| {
                let changes = changes(space, *amplitude, expected, &fit.at(point));
                changes.iter().zip(of_mesh).map(|(change, of_mesh)| SAFETY * change + of_mesh).collect()
            })
            .collect();
        quantile(&errors)
    }
}

/// Relative changes of the work of a body alone at each node; infinite where they have no value.
fn changes(space: &CurveSpace, amplitude: f64, expected: &[f64], found: &[f64]) -> Vec<f64> {
    let alone = JointCompliance { even: amplitude, bed: 0.0, values: expected.into() };
    let difference = found.iter().zip(expected).map(|(found, expected)| found - expected).collect();
    let change = JointCompliance { even: 0.0, bed: 0.0, values: difference };
    let changes = EdgeStates::new(&space.pressures, &alone).work_shares(&space.pressures, &change);
    changes.into_iter().map(|change| if change.is_finite() { change.abs() } else { f64::INFINITY }).collect()
}

/// At each node what few of the bounds exceed.
pub(super) fn quantile(bounds: &[Vec<f64>]) -> Vec<f64> {
    let count = bounds.first().map_or(0, Vec::len);
    let of_node = |node: usize| {
        let mut of_node: Vec<f64> = bounds.iter().map(|of_body| of_body[node]).collect();
        of_node.sort_by(f64::total_cmp);
        let place = (BOUNDED * of_node.len() as f64) as usize;
        of_node.get(place.min(of_node.len().saturating_sub(1))).copied().unwrap_or(f64::INFINITY)
    };
    (0..count).map(of_node).collect()
}

/// Those of the arcs that contact comes to.
pub(super) fn bounds_near(space: &CurveSpace, bound: &[f64]) -> impl Iterator<Item = f64> {
    let near = space.arcs().iter().zip(bound).filter(|(arc, _)| arc.half_angle < WIDEST);
    near.map(|(_, bound)| *bound)
}

pub(super) fn worst_near(space: &CurveSpace, bound: &[f64]) -> f64 {
    bounds_near(space, bound).fold(0.0, f64::max)
}
