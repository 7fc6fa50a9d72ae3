//! The fit of a family, with its checked error.

use foldhash::HashMap;

use crate::engine::accuracy::fit_bound::{BodyBound, FitBound, NEAR_END};
use crate::engine::backend::joints::{Amplitudes, DeviceBody, MOST_COORDINATES};
use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::basis::Basis;
use crate::engine::interpolation::family::{Family, Point, body_at, coordinate_count};
use crate::engine::interpolation::held_out::HeldOut;
use crate::engine::interpolation::points::DEGREES;
use crate::engine::interpolation::samples::{Expense, FINEST, Meshes};
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::body::{Body, Side};
use crate::mechanics::compliance::body_fit::{BodyFit, FitScratch};
use crate::mechanics::compliance::pressure_space::{JointCompliance, Tilt};
use crate::mechanics::compliance::row_sums::{Rows, WeightedSum};
use crate::mechanics::compliance::{BodyCompliance, Boundary, infinite};
use crate::mechanics::contact::compliance_rows::{NARROW, rows_of_units};
use crate::mechanics::contact::curve_space::CurveSpace;
use crate::mechanics::contact::outlines::Outlines;

/// A fit with its error.
pub struct FittedFamily {
    pub fit: BodyFit,
    side: Side,
    basis: Basis,
    /// In each space that was prepared, what `even`, `odd` and the amplitude of each member add to a compliance, and behind that what
    /// they add to that of a pin by unit tilt of either order, to that of a plate times the clearance ratio, its square and its cube.
    in_spaces: HashMap<SpaceKey, Rows>,
    pub bound: FitBound,
    /// Among the fits of its plan, once that is known.
    pub number: usize,
    /// Bodies solved for it, on every mesh.
    pub solved: u64,
}

/// Members end where what is left is below this share of the accuracy.
const MEMBER_SHARE: f64 = 0.1;

/// A fit whose bound is below this share of the accuracy is good enough.
const GOOD: f64 = 0.5;

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
            // What tells the error of a mesh is told in terms of it.
            let basis = Basis::of(self, first);
            held_out.solve(self, first - 1, &basis, library, spaces, &mut expense);
        }
        let mut best: Option<(f64, FittedFamily)> = None;
        // What is only fair is good enough where a better one would cost much.
        let is_enough = |best: &Option<(f64, FittedFamily)>, expense: &Expense| {
            let least = best.as_ref().map_or(f64::INFINITY, |(worst, _)| *worst) / accuracy;
            least <= GOOD || (least <= FAIR && expense.seconds > FAIR_BUDGET * budget)
        };
        for level in levels {
            let basis = Basis::of(self, level);
            held_out.solve(self, level, &basis, library, spaces, &mut expense);
            let of_mesh = held_out.worst_of_mesh(spaces);
            if of_mesh > MESH_SHARE * accuracy && level < FINEST {
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
                samples.extend(self.solve(library, new, self.fidelity(level), &basis));
                let scales: Vec<f64> = (points.iter().zip(&samples))
                    .map(|(point, sample)| {
                        let [even, _] = infinite(&body_at(&self.example, point));
                        even + sample.iter().map(|value| value * value).sum::<f64>().sqrt()
                    })
                    .collect();
                let tolerance = MEMBER_SHARE * accuracy;
                let Some(fit) = BodyFit::new(polynomials, &points, &samples, &scales, tolerance) else {
                    continue;
                };
                let bound = held_out.bound(&fit, &basis, spaces, level);
                let of_mesh = if known { of_mesh } else { 0.0 };
                let worst = bound.near().fold(0.0, f64::max).hypot(of_mesh);
                if best.as_ref().is_none_or(|(least, _)| worst < *least) {
                    let (side, in_spaces) = (self.example.shape.side, HashMap::default());
                    best = Some((
                        worst,
                        FittedFamily { fit, side, basis, in_spaces, bound, number: 0, solved: 0 },
                    ));
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
        let near: Vec<f64> = fitted.bound.near().collect();
        let fair = near.iter().filter(|bound| **bound <= FAIR * accuracy).count();
        (2 * fair >= near.len()).then_some(FittedFamily { solved: expense.bodies, ..fitted })
    }
}

impl FittedFamily {
    /// Makes what joints in these spaces need.
    pub fn prepare(&mut self, keys: impl Iterator<Item = SpaceKey>, spaces: &mut Spaces) {
        let infinite = |even, odd| BodyCompliance {
            even,
            odd,
            bed: 0.0,
            boundary: Boundary::Nothing,
            second: Vec::new(),
        };
        let member = |numbers| self.basis.compliance([0.0; 2], numbers);
        let unit: Vec<BodyCompliance> = [infinite(1.0, 0.0), infinite(0.0, 1.0)]
            .into_iter()
            .chain(self.fit.members().map(member))
            .collect();
        for key in keys {
            spaces.prepare(unit.iter().map(|unit| (key, unit)));
            self.in_spaces.insert(key, rows_of_units(spaces.get(key), self.side, &unit));
        }
    }

    /// The bound of the error of a body at its coordinates.
    pub fn error<'a>(&'a self, body: &Body, point: &Point) -> BodyBound<'a> {
        let point = &point[..coordinate_count(body.shape)];
        self.bound.of(body, self.fit.polynomials.is_inside(point, NEAR_END))
    }

    pub fn side(&self) -> Side {
        self.side
    }

    /// What members add to compliances in a space that was prepared.
    pub fn rows(&self, key: SpaceKey) -> Option<&Rows> {
        self.in_spaces.get(&key)
    }

    /// A body at its coordinates with 1/E for a device; `None` where it is outside of the box.
    pub fn on_device(&self, (body, point, share): (&Body, &Point, f64)) -> Option<DeviceBody<'static>> {
        if !self.contains(body, point) {
            return None;
        }
        let mut place = [0.0; MOST_COORDINATES];
        let own = self.fit.polynomials.place(&point[..coordinate_count(body.shape)]);
        place.iter_mut().zip(own).for_each(|(place, own)| *place = own);
        Some(DeviceBody { infinite: infinite(body), share, amplitudes: Amplitudes::Fit(place) })
    }

    /// Whether a body at its coordinates is in the box.
    pub fn contains(&self, body: &Body, point: &Point) -> bool {
        self.fit.polynomials.contains(&point[..coordinate_count(body.shape)])
    }

    /// The amplitudes of a body at its coordinates in the box, yet to be summed from the rows of `fit.coefficients`.
    pub fn begin<'a>(&self, (body, point): (&Body, &Point), scratch: &'a mut FitScratch) -> WeightedSum<'a> {
        self.fit.begin(&point[..coordinate_count(body.shape)], scratch)
    }

    /// What such a body with 1/E adds to the compliance of a joint under its outlines, yet to be summed from the `rows` of a space.
    pub fn weigh<'a>(
        &self,
        (body, share): (&Body, f64),
        outlines: &Outlines,
        scratch: &'a mut FitScratch,
    ) -> WeightedSum<'a> {
        let (Tilt { first, second }, clearance) = (outlines.tilt(), outlines.radial_clearance.max(0.0));
        let shares = match self.side {
            Side::Pin => &[1.0, first, second][..],
            Side::Plate if self.is_moved(outlines) => &[1.0],
            Side::Plate => &[1.0, clearance, clearance * clearance, clearance.powi(3)],
        };
        scratch.weigh(shares, &infinite(body), share)
    }

    /// Whether a plate comes to the hole's arcs by polynomials, not by powers of the clearance.
    fn is_moved(&self, outlines: &Outlines) -> bool {
        self.side == Side::Plate && outlines.radial_clearance > NARROW
    }

    /// The part of a joint's compliance of a body with 1/E, that sum having been made.
    pub fn part<'a>(
        &self,
        (body, share): (&Body, f64),
        outlines: &Outlines,
        space: &CurveSpace,
        FitScratch { values, moved, .. }: &'a mut FitScratch,
    ) -> JointCompliance<'a> {
        let part =
            JointCompliance { even: share * infinite(body)[0], bed: 0.0, values: (&values[..]).into() };
        if !self.is_moved(outlines) {
            return part;
        }
        space.to_hole(&part, outlines, moved);
        JointCompliance { values: (&moved[..]).into(), ..part }
    }
}
