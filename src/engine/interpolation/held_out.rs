//! Bodies that a fit is checked on: the bound of its error.

use rayon::prelude::*;

use crate::engine::accuracy::known_errors::known_error;
use crate::engine::accuracy::mesh_change::mesh_error;
use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::basis::Basis;
use crate::engine::interpolation::family::{Family, body_at};
use crate::engine::interpolation::samples::Expense;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::compliance::body_fit::BodyFit;
use crate::mechanics::contact::curve::{CurveSpace, Variable};
use crate::mechanics::contact::edge::EdgeStates;

/// Share of the bodies held out whose error is below the bound: what two bodies have is averaged in a joint, so far more
/// of the joints are (`tests/interpolation.rs`).
const BOUNDED: f64 = 0.97;

/// The fit's own error is raised by this: bodies held out are not the worst.
const SAFETY: f64 = 1.5;

/// Arcs beyond which contact with free edges hardly goes, rad: what a fit does there decides nothing.
pub(super) const WIDEST: f64 = 1.8;

/// The space that errors are told in.
fn judging_space(half_ring: bool) -> SpaceKey {
    SpaceKey { half_ring, terms: 10, nodes: 24, variable: Variable::Root }
}

/// Bodies that a fit is checked on.
pub(super) struct HeldOut {
    points: Vec<Vec<f64>>,
    bodies: Vec<Body>,
    space: SpaceKey,
    /// What they change at their boundary on the finest mesh so far.
    expected: Vec<BodyCompliance>,
    /// The error of that mesh.
    pub(super) of_mesh: Vec<Vec<f64>>,
    /// Whether it is known, without a coarser one.
    known: bool,
}

impl HeldOut {
    pub(super) fn new(family: &Family, known: bool) -> HeldOut {
        let points = family.held_out_points();
        let bodies = points.iter().map(|point| body_at(&family.example, point)).collect();
        let space = judging_space(family.key.half_ring);
        HeldOut { points, bodies, space, expected: Vec::new(), of_mesh: Vec::new(), known }
    }

    /// Goes on to a mesh; where its error is not known the change since the one before tells it. What was made for `basis` is
    /// there when the space is asked for.
    pub(super) fn solve(
        &mut self,
        family: &Family,
        level: usize,
        basis: &Basis,
        library: &mut BodyLibrary,
        spaces: &mut Spaces,
        expense: &mut Expense,
    ) {
        let numbers = family.solve(library, &self.points, family.fidelity(level), basis);
        let fine: Vec<BodyCompliance> = (self.bodies.iter().zip(numbers))
            .map(|(body, numbers)| BodyCompliance::new(body, basis.boundary(numbers)))
            .collect();
        let coarse = std::mem::replace(&mut self.expected, fine);
        expense.add(family, self.points.len(), level);
        spaces.prepare(self.expected.iter().map(|body| (self.space, body)));
        let space = self.space(spaces);
        self.of_mesh = if family.exact {
            vec![vec![0.0; space.arcs().len()]; self.points.len()]
        } else if self.known {
            let known = |body: &Body| {
                let at = |half_angle| known_error(body, level, half_angle).unwrap_or(f64::INFINITY);
                space.arcs().iter().map(|arc| at(arc.half_angle)).collect()
            };
            self.bodies.iter().map(known).collect()
        } else {
            (self.expected.par_iter().zip(&coarse))
                .map(|(fine, coarse)| {
                    let changes = changes(space, fine, coarse).into_iter();
                    changes.map(|change| mesh_error(level, change)).collect()
                })
                .collect()
        };
    }

    /// Where errors are told.
    pub(super) fn space<'a>(&self, spaces: &'a Spaces) -> &'a CurveSpace {
        spaces.get(self.space)
    }

    /// Of the errors of a fit at each node; with those of the meshes, where these are not known of any body.
    pub(super) fn bound(&self, fit: &BodyFit, basis: &Basis, spaces: &Spaces) -> Vec<f64> {
        let space = self.space(spaces);
        let errors: Vec<Vec<f64>> = (self.points.par_iter().zip(&self.bodies))
            .zip(self.expected.par_iter().zip(&self.of_mesh))
            .map(|((point, body), (expected, of_mesh))| {
                let found = BodyCompliance::new(body, basis.boundary(fit.at(point)));
                let changes = changes(space, expected, &found);
                let own = |of_mesh: &f64| if self.known { 0.0 } else { *of_mesh };
                changes.iter().zip(of_mesh).map(|(change, of_mesh)| SAFETY * change + own(of_mesh)).collect()
            })
            .collect();
        quantile(&errors)
    }
}

/// Relative changes of the work of a body alone at each node; infinite where they have no value.
fn changes(space: &CurveSpace, expected: &BodyCompliance, found: &BodyCompliance) -> Vec<f64> {
    let alone = space.pressures.joint(&[(expected, 1.0)]);
    let change = space.pressures.joint(&[(found, 1.0), (expected, -1.0)]);
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

/// The worst at arcs that contact comes to.
pub(super) fn worst_near(space: &CurveSpace, bound: &[f64]) -> f64 {
    let near = space.arcs().iter().zip(bound).filter(|(arc, _)| arc.half_angle < WIDEST);
    near.fold(0.0, |worst, (_, bound)| worst.max(*bound))
}
