//! The fit of a family, with its checked error.

use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::family::{Family, fit_space};
use crate::engine::interpolation::held_out::{HeldOut, bounds_near, quantile, worst_near};
use crate::engine::interpolation::points::DEGREES;
use crate::engine::interpolation::samples::{Expense, FINEST, Meshes};
use crate::engine::spaces::Spaces;
use crate::mechanics::compliance::body_fit::BodyFit;

/// A fit with its error.
pub struct FittedFamily {
    pub fit: BodyFit,
    /// Bound of the relative error of the force at each node of a curve, of fit and meshes together.
    pub bound: Vec<f64>,
    /// Bodies solved for it, on every mesh.
    pub solved: u64,
}

/// Modes end where what is left is below this share of the accuracy.
const MODE_SHARE: f64 = 0.1;

/// A fit whose bound is below this share of the accuracy is good enough.
const GOOD: f64 = 0.6;

/// One below this share is used where a better one would cost much: the rest is for what a design adds.
const FAIR: f64 = 0.9;

/// Share of the budget from which on a better fit costs much.
const FAIR_BUDGET: f64 = 0.1;

/// Meshes whose own error is above this share of the accuracy are not worth a fit.
const MESH_SHARE: f64 = 0.7;

impl Family {
    /// The best fit for an accuracy of the force; `None` where none is good enough. `budget` is the time, s by
    /// `unit_costs`, that may be spent.
    pub fn fit(
        &self,
        accuracy: f64,
        budget: f64,
        library: &mut BodyLibrary,
        spaces: &mut Spaces,
    ) -> Option<FittedFamily> {
        let Meshes { first, known } = self.meshes(accuracy);
        let levels = if self.exact { first..=first } else { first..=FINEST };
        let mut expense = Expense::default();
        let mut held_out = HeldOut::new(self, known);
        if !known {
            held_out.solve(self, first - 1, library, spaces, &mut expense);
        }
        let mut best: Option<(f64, FittedFamily)> = None;
        // What is only fair is good enough where a better one would cost much.
        let is_enough = |best: &Option<(f64, FittedFamily)>, expense: &Expense| {
            let least = best.as_ref().map_or(f64::INFINITY, |(worst, _)| *worst) / accuracy;
            least <= GOOD || (least <= FAIR && expense.seconds > FAIR_BUDGET * budget)
        };
        for level in levels {
            held_out.solve(self, level, library, spaces, &mut expense);
            let space = fit_space(self.key.half_ring);
            if worst_near(spaces.get(space), &quantile(&held_out.of_mesh)) > MESH_SHARE * accuracy
                && level < FINEST
            {
                continue;
            }
            let mut samples: Vec<Vec<f64>> = Vec::new();
            for degrees in DEGREES[self.free()] {
                let polynomials = self.polynomials(*degrees);
                let points = self.sample_points(self.sample_count(*degrees));
                // Those of lower degrees come first.
                let new = points.get(samples.len()..).unwrap_or_default();
                expense.add(self, new.len(), level);
                if expense.seconds > budget || is_enough(&best, &expense) {
                    break;
                }
                samples.extend(self.solve(library, spaces, new, self.fidelity(level)));
                let Some(fit) = BodyFit::new(polynomials, &points, &samples, MODE_SHARE * accuracy) else {
                    continue;
                };
                let bound = held_out.bound(&fit, spaces.get(space));
                let worst = worst_near(spaces.get(space), &bound);
                if best.as_ref().is_none_or(|(least, _)| worst < *least) {
                    best = Some((worst, FittedFamily { fit, bound, solved: 0 }));
                }
                if worst <= GOOD * accuracy {
                    break;
                }
            }
            if expense.seconds > budget || is_enough(&best, &expense) {
                break;
            }
        }
        let (_, fitted) = best?;
        // A design at an arc whose bound is too large goes on to the meshes; not too many may.
        let near: Vec<f64> = bounds_near(spaces.get(fit_space(self.key.half_ring)), &fitted.bound).collect();
        let fair = near.iter().filter(|bound| **bound <= FAIR * accuracy).count();
        (2 * fair >= near.len()).then_some(FittedFamily { solved: expense.bodies, ..fitted })
    }
}
