//! Designs with interpolated bodies: two points, a few modes, one curve.

use std::collections::HashMap;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::family::{FamilyKey, FittedFamily, coordinate_count, coordinates};
use crate::engine::interpolation::plan::{InterpolationPlan, pair};
use crate::engine::outcome::{BackendKind, DesignOutcome};
use crate::engine::plan::Want;
use crate::engine::request::SpaceKey;
use crate::engine::respond::{LoadState, Solving, Way, loads_in_contact};
use crate::mechanics::compliance::body_fit::{FitScratch, add_modes};
use crate::mechanics::contact::loading::NoState;
use crate::mechanics::contact::smooth_curve::nodes::CurveNodes;
use crate::mechanics::contact::smooth_curve::{
    CURVE_NODES, CURVE_TERMS, CurveState, ENTRY_COUNT, SmoothCurve,
};
use crate::study::design::DesignCase;

/// The rung: fits of a plan, made when the first designs come.
pub struct Interpolation {
    plan: InterpolationPlan,
    /// Of half rings and of whole ones.
    nodes: HashMap<bool, CurveNodes>,
    fitted: Option<HashMap<FamilyKey, FittedFamily>>,
    /// Time spent on fits, from start to end.
    pub fit_time: Duration,
    /// Time spent on designs, summed over threads.
    pub design_time: Duration,
}

/// What one design leaves for the next.
#[derive(Default)]
struct Scratch {
    fit: FitScratch,
    amplitudes: [Vec<f64>; 2],
    values: Vec<f64>,
    states: Vec<Option<CurveState>>,
}

impl Interpolation {
    pub fn new(plan: InterpolationPlan) -> Interpolation {
        Interpolation {
            plan,
            nodes: HashMap::new(),
            fitted: None,
            fit_time: Duration::ZERO,
            design_time: Duration::ZERO,
        }
    }

    /// Fits every family of the plan, whatever designs come first.
    fn prepare(&mut self, library: &mut BodyLibrary) {
        if self.fitted.is_some() {
            return;
        }
        let started = Instant::now();
        let mut fitted = HashMap::new();
        for (family, budget) in &self.plan.families {
            let half_ring = family.key.half_ring;
            let nodes = self
                .nodes
                .entry(half_ring)
                .or_insert_with(|| CurveNodes::new(SpaceKey { half_ring, terms: CURVE_TERMS }.limit()));
            if let Some(fit) = family.fit(self.plan.accuracy, *budget, library, nodes) {
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
    pub fn solve(&mut self, library: &mut BodyLibrary, cases: &[DesignCase]) -> Vec<Option<DesignOutcome>> {
        self.prepare(library);
        let this = &*self;
        let solved: Vec<(Option<DesignOutcome>, Duration)> = cases
            .par_iter()
            .with_min_len(64)
            .map_init(Scratch::default, |scratch, case| {
                let started = Instant::now();
                let outcome = this.solve_design(case, scratch);
                (outcome, started.elapsed())
            })
            .collect();
        self.design_time += solved.iter().map(|(_, time)| *time).sum::<Duration>();
        solved.into_iter().map(|(outcome, _)| outcome).collect()
    }

    fn solve_design(&self, case: &DesignCase, scratch: &mut Scratch) -> Option<DesignOutcome> {
        let joint = &case.joint;
        let bodies = pair(joint)?;
        let [(pin_key, _), (plate_key, _)] = &bodies;
        if !self.plan.pairs.contains(&(*pin_key, *plate_key)) {
            return None;
        }
        let fitted = self.fitted.as_ref()?;
        let families = [fitted.get(pin_key)?, fitted.get(plate_key)?];
        let nodes = self.nodes.get(&pin_key.half_ring)?;
        let moduli = [joint.pin.material.youngs_modulus, joint.plate.material.youngs_modulus];
        let mut amplitude = 0.0;
        scratch.values.clear();
        scratch.values.resize(ENTRY_COUNT, 0.0);
        for (i, ((_, body), modulus)) in bodies.iter().zip(moduli).enumerate() {
            let point = coordinates(body);
            let point = &point[..coordinate_count(body.shape)];
            if !families[i].fit.polynomials.contains(point) {
                return None;
            }
            let amplitudes = &mut scratch.amplitudes[i];
            families[i].fit.amplitudes(point, 1.0 / modulus, &mut scratch.fit, amplitudes);
            amplitude += 2.0 / (body.idealization.plane_modulus_ratio(body.poissons_ratio) * modulus);
        }
        add_modes(
            [(&families[0].fit, &scratch.amplitudes[0]), (&families[1].fit, &scratch.amplitudes[1])],
            &mut scratch.values,
        );
        let curve = SmoothCurve::new(nodes, amplitude, &scratch.values)?;
        let clearance = joint.radial_clearance / joint.hole_radius;
        scratch.states.clear();
        curve.states(clearance, loads_in_contact(case), &mut scratch.states);
        // As `JointCompliance::relative_changes` of the sum: no more than that of the worse body.
        let bound = |state: &CurveState| {
            let next = (state.node + 1).min(CURVE_NODES - 1);
            let worst = families.iter().flat_map(|family| [family.bound[state.node], family.bound[next]]);
            state.curve_error() + worst.fold(0.0, f64::max)
        };
        let solving = Solving {
            backend: BackendKind::Cpu,
            way: Way::Interpolated,
            limit: SpaceKey { half_ring: pin_key.half_ring, terms: CURVE_TERMS }.limit(),
            accuracy: self.plan.accuracy,
        };
        if scratch.states.iter().any(Option::is_none) {
            return None;
        }
        let states = scratch.states.iter().map(|state| {
            let state = state.as_ref().ok_or(NoState::BrokenCompliance)?;
            Ok(LoadState {
                half_angle: state.half_angle,
                indentation: state.indentation,
                force: state.force,
                tangent_stiffness: state.tangent_stiffness,
                energy: state.energy,
                peak_pressure: state.peak_pressure,
                truncation: state.truncation,
                change: bound(state),
                pressure_is_positive: state.pressure_is_positive,
            })
        });
        let (outcome, want) = solving.respond(case, states);
        (want == Want::Nothing).then_some(outcome)
    }
}
