//! Bodies that a fit is checked on: the bound of its error.

use rayon::prelude::*;

use crate::engine::accuracy::fit_bound::{FitBound, NEAR_END, changes, worst_near};
use crate::engine::accuracy::known_errors::known_error;
use crate::engine::accuracy::mesh_change::Trust;
use crate::engine::bodies::BodyLibrary;
use crate::engine::body_request::BodyRequest;
use crate::engine::interpolation::basis::Basis;
use crate::engine::interpolation::family::{Family, body_at};
use crate::engine::interpolation::samples::Expense;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::body_fit::{BodyFit, FitScratch};
use crate::mechanics::compliance::{BodyCompliance, infinite};
use crate::mechanics::contact::curve_space::Variable;

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
    /// The error of that mesh, `[body][arc]`.
    of_mesh: Vec<Vec<f64>>,
    /// Whether it is known, without a coarser one; exact bodies have none.
    known: bool,
    exact: bool,
}

impl HeldOut {
    pub(super) fn new(family: &Family, known: bool) -> HeldOut {
        let points = family.held_out_points();
        let bodies = points.iter().map(|point| body_at(&family.example, point)).collect();
        let space = judging_space(family.key.half_ring);
        HeldOut {
            points,
            bodies,
            space,
            expected: Vec::new(),
            of_mesh: Vec::new(),
            known,
            exact: family.exact,
        }
    }

    /// Goes on to a mesh; where its error is not known the change since the one before tells it, as far as
    /// each body's is trusted.
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
            .map(|(body, numbers)| basis.compliance(infinite(body), &numbers))
            .collect();
        let coarse = std::mem::replace(&mut self.expected, fine);
        expense.add(family, self.points.len(), level);
        spaces.prepare(self.expected.iter().map(|body| (self.space, body)));
        let space = spaces.get(self.space);
        self.of_mesh = if self.exact {
            vec![vec![0.0; space.arcs().len()]; self.points.len()]
        } else if self.known {
            let known = |body: &Body| {
                let at = |half_angle| known_error(body, level, half_angle).unwrap_or(f64::INFINITY);
                space.arcs().iter().map(|arc| at(arc.half_angle)).collect()
            };
            self.bodies.iter().map(known).collect()
        } else {
            (self.bodies.par_iter().zip(&self.expected).zip(&coarse))
                .map(|((body, fine), coarse)| {
                    let trust =
                        Trust::of(&BodyRequest { body: body.clone(), fidelity: family.fidelity(level) });
                    let changes = changes(space, fine, coarse).into_iter();
                    changes.map(|change| trust.error(level, change)).collect()
                })
                .collect()
        };
    }

    /// The error of the meshes that few bodies exceed, at the worst of the arcs that contact comes to.
    pub(super) fn worst_of_mesh(&self, spaces: &Spaces) -> f64 {
        worst_near(spaces.get(self.space), &self.of_mesh)
    }

    /// Of a fit on meshes of this level.
    pub(super) fn bound(&self, fit: &BodyFit, basis: &Basis, spaces: &Spaces, level: usize) -> FitBound {
        let space = spaces.get(self.space);
        let of_fit: Vec<Vec<f64>> = (self.points.par_iter().zip(&self.bodies).zip(&self.expected))
            .map_init(FitScratch::default, |scratch, ((point, body), expected)| {
                let found = basis.compliance(infinite(body), &fit.at(point, scratch));
                changes(space, expected, &found)
            })
            .collect();
        let bodies = self.bodies.iter().zip(&self.points);
        let bodies = bodies.map(|(body, point)| (body.clone(), fit.polynomials.is_inside(point, NEAR_END)));
        FitBound::new(
            space,
            &bodies.collect::<Vec<_>>(),
            &of_fit,
            &self.of_mesh,
            (self.known && !self.exact).then_some(level),
        )
    }
}
