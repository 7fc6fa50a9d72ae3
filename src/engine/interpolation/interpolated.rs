//! Designs with interpolated bodies: two points, a few members, one curve.

use std::collections::HashMap;
use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::engine::accuracy::body_errors::{BodyErrors, ErrorSource, JudgedBody};
use crate::engine::accuracy::{ForceError, Want};
use crate::engine::bodies::BodyLibrary;
use crate::engine::expected_contact::ExpectedContact;
use crate::engine::interpolation::family::{FamilyKey, coordinate_count, coordinates};
use crate::engine::interpolation::fit::FittedFamily;
use crate::engine::interpolation::fit_plan::{InterpolationPlan, pair};
use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::{BackendKind, DesignOutcome, Method};
use crate::engine::row::Solving;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::body::Body;
use crate::mechanics::compliance::body_fit::{BODIES, FitScratch};
use crate::mechanics::compliance::infinite;
use crate::mechanics::compliance::pressure_space::JointCompliance;
use crate::mechanics::contact::curve::{ContactCurve, CurveSpace};
use crate::mechanics::contact::state::ContactState;
use crate::study::design::DesignCase;

/// The rung: fits of a plan, made when the first designs come.
pub struct Interpolation {
    plan: InterpolationPlan,
    fitted: Option<HashMap<FamilyKey, FittedFamily>>,
    /// Time spent on fits, from start to end.
    pub fit_time: Duration,
    /// Time spent on designs, summed over threads.
    pub design_time: Duration,
}

/// Designs that are solved together, so that those of one pair read its members together.
const TOGETHER: usize = 64;

/// What some designs leave for the next.
#[derive(Default)]
struct Scratch {
    fit: FitScratch,
    /// Of the bodies of all designs, one behind the other.
    amplitudes: Vec<f64>,
    /// Of the pins of a few designs, and of their plates, one behind the other.
    values: [Vec<f64>; 2],
}

/// A design with its bodies as points of fits.
#[derive(Clone)]
struct Placed<'a> {
    /// Among those solved together.
    number: usize,
    bodies: [Body; 2],
    families: [&'a FittedFamily; 2],
    /// Of those with one of these members are read together.
    key: (FamilyKey, FamilyKey, SpaceKey),
    /// `even` and `odd` of each body, over its modulus.
    infinite: [[f64; 2]; 2],
    /// Where the amplitudes of the bodies' members are.
    members: [Range<usize>; 2],
}

impl Interpolation {
    pub fn new(plan: InterpolationPlan) -> Interpolation {
        Interpolation { plan, fitted: None, fit_time: Duration::ZERO, design_time: Duration::ZERO }
    }

    /// Fits every family of the plan, whatever designs come first.
    fn prepare(&mut self, library: &mut BodyLibrary, spaces: &mut Spaces) {
        if self.fitted.is_some() {
            return;
        }
        let started = Instant::now();
        let mut fitted = HashMap::new();
        for (family, budget) in &self.plan.families {
            if let Some(mut fit) = family.fit(self.plan.accuracy, *budget, library, spaces) {
                let coarsest = SpaceKey::beside_thick_walls(family.key.half_ring, self.plan.accuracy);
                fit.prepare(coarsest.flat_map(|key| [Some(key), key.with_more_terms()]).flatten(), spaces);
                fitted.insert(family.key, fit);
            }
        }
        self.fitted = Some(fitted);
        self.fit_time += started.elapsed();
    }

    /// Bodies solved for the fits.
    pub fn solved_bodies(&self) -> u64 {
        self.fitted.iter().flat_map(HashMap::values).map(|family| family.solved).sum()
    }

    /// The fits, with the ranges they hold over.
    pub fn fits(&self) -> impl Iterator<Item = &FittedFamily> {
        self.fitted.iter().flat_map(HashMap::values)
    }

    /// The outcomes of the designs that are known well enough; `None` for those that are left to others.
    pub fn solve(
        &mut self,
        library: &mut BodyLibrary,
        spaces: &mut Spaces,
        cases: &[DesignCase],
    ) -> Vec<Option<DesignOutcome>> {
        self.prepare(library, spaces);
        let (this, spaces) = (&*self, &*spaces);
        let solved: Vec<(Vec<Option<DesignOutcome>>, Duration)> = cases
            .par_chunks(TOGETHER)
            .map_init(Scratch::default, |scratch, cases| {
                let started = Instant::now();
                (this.solve_together(spaces, cases, scratch), started.elapsed())
            })
            .collect();
        self.design_time += solved.iter().map(|(_, time)| *time).sum::<Duration>();
        solved.into_iter().flat_map(|(outcomes, _)| outcomes).collect()
    }

    fn solve_together(
        &self,
        spaces: &Spaces,
        cases: &[DesignCase],
        scratch: &mut Scratch,
    ) -> Vec<Option<DesignOutcome>> {
        let mut outcomes = vec![None; cases.len()];
        scratch.amplitudes.clear();
        let mut placed: Vec<Placed> =
            cases.iter().enumerate().filter_map(|(number, case)| self.place(number, case, scratch)).collect();
        while let Some(first) = placed.first() {
            let (key, families) = (first.key, first.families);
            let alike: Vec<Placed>;
            (alike, placed) = placed.into_iter().partition(|one| one.key == key);
            let space = spaces.get(key.2);
            for alike in alike.chunks(BODIES) {
                let count = space.pressures.entry_count();
                for (side, values) in scratch.values.iter_mut().enumerate() {
                    values.resize(alike.len() * count, 0.0);
                    for (one, values) in alike.iter().zip(values.chunks_exact_mut(count)) {
                        space.pressures.infinite(one.infinite[side], values);
                    }
                    let amplitudes: Vec<&[f64]> =
                        alike.iter().map(|one| &scratch.amplitudes[one.members[side].clone()]).collect();
                    families[side].members(key.2).add(&amplitudes, values);
                }
                for (place, one) in alike.iter().enumerate() {
                    let parts = [0, 1].map(|side| JointCompliance {
                        even: one.infinite[side][0],
                        bed: 0.0,
                        values: scratch.values[side][place * count..][..count].into(),
                    });
                    let Some((outcome, want)) = self.solve_design(&cases[one.number], one, space, &parts)
                    else {
                        continue;
                    };
                    let finer = key.2.with_more_terms().filter(|finer| families[0].is_prepared(*finer));
                    match (want, finer) {
                        (Want::Nothing, _) => outcomes[one.number] = Some(outcome),
                        (Want::MoreTerms, Some(finer)) => {
                            placed.push(Placed { key: (key.0, key.1, finer), ..one.clone() });
                        }
                        _ => {}
                    }
                }
            }
        }
        outcomes
    }

    /// A design whose bodies are in the boxes of fits; appends the amplitudes of their members.
    fn place<'a>(
        &'a self,
        number: usize,
        case: &DesignCase,
        Scratch { fit: scratch, amplitudes, .. }: &mut Scratch,
    ) -> Option<Placed<'a>> {
        let joint = &case.joint;
        let [pin, plate] = pair(joint)?;
        let keys = (pin.0, plate.0);
        if !self.plan.pairs.contains(&keys) {
            return None;
        }
        let fitted = self.fitted.as_ref()?;
        let families = [fitted.get(&keys.0)?, fitted.get(&keys.1)?];
        let bodies = [(pin.1, &joint.pin), (plate.1, &joint.plate)];
        let points = bodies.map(|(body, _)| coordinates(&body));
        let is_inside = |side: usize| {
            let count = coordinate_count(bodies[side].0.shape);
            families[side].fit.polynomials.contains(&points[side][..count])
        };
        if !(is_inside(0) && is_inside(1)) {
            return None;
        }
        let mut of_side = |side: usize| {
            let (body, part) = &bodies[side];
            let share = 1.0 / part.material.youngs_modulus;
            let from = amplitudes.len();
            let point = &points[side][..coordinate_count(body.shape)];
            families[side].fit.amplitudes(point, share, scratch, amplitudes);
            (infinite(body).map(|own| share * own), from..amplitudes.len())
        };
        let [(pin_infinite, pin_members), (plate_infinite, plate_members)] = [of_side(0), of_side(1)];
        let space =
            SpaceKey::coarsest(&pin.1, &plate.1, self.plan.accuracy, ExpectedContact::of(case).half_angle);
        Some(Placed {
            number,
            bodies: bodies.map(|(body, _)| body),
            key: (keys.0, keys.1, space),
            families,
            infinite: [pin_infinite, plate_infinite],
            members: [pin_members, plate_members],
        })
    }

    /// From the joint's compliance to the outcome and what that wants; `None` where there is no state.
    fn solve_design(
        &self,
        case: &DesignCase,
        placed: &Placed,
        space: &CurveSpace,
        parts: &[JointCompliance; 2],
    ) -> Option<(DesignOutcome, Want)> {
        let curve = ContactCurve::new(space, &JointCompliance::of_both(&parts[0], &parts[1]))?;
        let judged = [0, 1].map(|side| JudgedBody {
            body: &placed.bodies[side],
            source: ErrorSource::Fit(&placed.families[side].bound),
            part: &parts[side],
        });
        let errors = BodyErrors::new(&curve, &judged, None);
        let scale = JointScale::of(&case.joint);
        let states = curve.states(scale.radial_clearance, scale.loads_in_contact(&case.steps));
        if states.iter().any(Result::is_err) {
            return None;
        }
        let states = states.into_iter().map(|state| {
            let (state, node) = state?;
            // What fits leave does not fall with the degree, and is in their bounds.
            let state = ContactState { curve_error: curve.rough_error, ..state };
            let [of_bodies, of_beds] = errors.at(state.half_angle, node);
            Ok((state, ForceError::new(&state, of_bodies, of_beds)))
        });
        let solving = Solving {
            backend: BackendKind::Cpu,
            method: Method::Interpolated,
            limit: space.limit,
            accuracy: self.plan.accuracy,
        };
        Some(solving.respond(case, states))
    }
}
