//! Designs with interpolated bodies: two points, a few modes, one curve.

use std::collections::HashMap;
use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::engine::accuracy::{ForceError, Want};
use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::family::{FamilyKey, coordinate_count, coordinates, fit_space};
use crate::engine::interpolation::fit::FittedFamily;
use crate::engine::interpolation::plan::{InterpolationPlan, pair};
use crate::engine::outcome::{BackendKind, DesignOutcome, Method};
use crate::engine::row::{Solving, loads_in_contact};
use crate::engine::spaces::Spaces;
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

/// Designs that are solved together, so that those of one pair read its modes together.
const TOGETHER: usize = 64;

/// What some designs leave for the next.
#[derive(Default)]
struct Scratch {
    fit: FitScratch,
    /// Of the bodies of all designs, one behind the other.
    amplitudes: Vec<f64>,
    values: Vec<f64>,
}

/// A design with its bodies as points of fits.
struct Placed<'a> {
    /// Among those solved together.
    number: usize,
    pair: (FamilyKey, FamilyKey),
    families: [&'a FittedFamily; 2],
    space: &'a CurveSpace,
    /// Of the singular part of the joint's compliance.
    amplitude: f64,
    /// Where the amplitudes of the bodies' modes are.
    modes: [Range<usize>; 2],
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
            if let Some(fit) = family.fit(self.plan.accuracy, *budget, library, spaces) {
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
        let mut placed: Vec<Placed> = cases
            .iter()
            .enumerate()
            .filter_map(|(number, case)| self.place(spaces, number, case, scratch))
            .collect();
        while let Some(first) = placed.first() {
            let pair = first.pair;
            let (alike, others): (Vec<Placed>, Vec<Placed>) =
                placed.into_iter().partition(|one| one.pair == pair);
            placed = others;
            for alike in alike.chunks(BODIES) {
                let count = alike[0].families[0].fit.sample_length();
                scratch.values.clear();
                scratch.values.resize(alike.len() * count, 0.0);
                for side in 0..2 {
                    let amplitudes: Vec<&[f64]> =
                        alike.iter().map(|one| &scratch.amplitudes[one.modes[side].clone()]).collect();
                    alike[0].families[side].fit.add_modes(&amplitudes, &mut scratch.values);
                }
                for (one, values) in alike.iter().zip(scratch.values.chunks_exact(count)) {
                    outcomes[one.number] = self.solve_design(&cases[one.number], one, values);
                }
            }
        }
        outcomes
    }

    /// A design whose bodies are in the boxes of fits; appends the amplitudes of their modes.
    fn place<'a>(
        &'a self,
        spaces: &'a Spaces,
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
        let mut amplitude = 0.0;
        let modes = [0, 1].map(|side| {
            let (body, part) = &bodies[side];
            let modulus = part.material.youngs_modulus;
            amplitude += infinite(body)[0] / modulus;
            let from = amplitudes.len();
            let point = &points[side][..coordinate_count(body.shape)];
            families[side].fit.amplitudes(point, 1.0 / modulus, scratch, amplitudes);
            from..amplitudes.len()
        });
        let space = spaces.get(fit_space(keys.0.half_ring));
        Some(Placed { number, pair: keys, families, space, amplitude, modes })
    }

    /// From the joint's compliance to the outcome, `None` where that is not known well enough.
    fn solve_design(&self, case: &DesignCase, placed: &Placed, values: &[f64]) -> Option<DesignOutcome> {
        let Placed { families, space, amplitude, .. } = placed;
        let joint = &case.joint;
        let compliance = JointCompliance { even: *amplitude, bed: 0.0, values: values.into() };
        let curve = ContactCurve::new(space, &compliance)?;
        let clearance = joint.radial_clearance / joint.hole_radius;
        let states = curve.states(clearance, loads_in_contact(case));
        if states.iter().any(Result::is_err) {
            return None;
        }
        // Each body's error counts by its share of the work: together no more than that of the worse one.
        let states = states.into_iter().map(|state| {
            let (state, node) = state?;
            // What fits leave does not fall with the degree, and is in their bounds.
            let state = ContactState { curve_error: curve.rough_error, ..state };
            let of_bodies = families.iter().map(|family| ContactCurve::around(node, &family.bound));
            Ok((state, ForceError::new(&state, of_bodies.fold(0.0, f64::max), 0.0)))
        });
        let solving = Solving {
            backend: BackendKind::Cpu,
            method: Method::Interpolated,
            limit: space.limit,
            accuracy: self.plan.accuracy,
        };
        let (outcome, want) = solving.respond(case, states);
        (want == Want::Nothing).then_some(outcome)
    }
}
