//! Designs with interpolated bodies: two points, a few modes, one curve.

use std::collections::HashMap;
use std::ops::Range;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::engine::bodies::BodyLibrary;
use crate::engine::interpolation::family::{FamilyKey, coordinate_count, coordinates};
use crate::engine::interpolation::fit::FittedFamily;
use crate::engine::interpolation::plan::{InterpolationPlan, pair};
use crate::engine::outcome::{BackendKind, DesignOutcome};
use crate::engine::plan::Want;
use crate::engine::request::SpaceKey;
use crate::engine::respond::{LoadState, Solving, Way, loads_in_contact};
use crate::mechanics::compliance::body_fit::{BODIES, FitScratch};
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

/// Designs that are solved together, so that those of one pair read its modes together.
const TOGETHER: usize = 64;

/// What some designs leave for the next.
#[derive(Default)]
struct Scratch {
    fit: FitScratch,
    /// Of the bodies of all designs, one behind the other.
    amplitudes: Vec<f64>,
    values: Vec<f64>,
    states: Vec<Option<CurveState>>,
}

/// A design with its bodies as points of fits.
struct Placed<'a> {
    /// Among those solved together.
    number: usize,
    pair: (FamilyKey, FamilyKey),
    families: [&'a FittedFamily; 2],
    nodes: &'a CurveNodes,
    /// Of the singular part of the joint's compliance.
    amplitude: f64,
    /// Where the amplitudes of the bodies' modes are.
    modes: [Range<usize>; 2],
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
        let solved: Vec<(Vec<Option<DesignOutcome>>, Duration)> = cases
            .par_chunks(TOGETHER)
            .map_init(Scratch::default, |scratch, cases| {
                let started = Instant::now();
                (this.solve_together(cases, scratch), started.elapsed())
            })
            .collect();
        self.design_time += solved.iter().map(|(_, time)| *time).sum::<Duration>();
        solved.into_iter().flat_map(|(outcomes, _)| outcomes).collect()
    }

    fn solve_together(&self, cases: &[DesignCase], scratch: &mut Scratch) -> Vec<Option<DesignOutcome>> {
        let mut outcomes = vec![None; cases.len()];
        scratch.amplitudes.clear();
        let mut placed: Vec<Placed> = cases
            .iter()
            .enumerate()
            .filter_map(|(number, case)| self.place(number, case, &mut scratch.fit, &mut scratch.amplitudes))
            .collect();
        while let Some(first) = placed.first() {
            let pair = first.pair;
            let (alike, others): (Vec<Placed>, Vec<Placed>) =
                placed.into_iter().partition(|one| one.pair == pair);
            placed = others;
            for alike in alike.chunks(BODIES) {
                scratch.values.clear();
                scratch.values.resize(alike.len() * ENTRY_COUNT, 0.0);
                for side in 0..2 {
                    let amplitudes: Vec<&[f64]> =
                        alike.iter().map(|one| &scratch.amplitudes[one.modes[side].clone()]).collect();
                    alike[0].families[side].fit.add_modes(&amplitudes, &mut scratch.values);
                }
                for (one, values) in alike.iter().zip(scratch.values.chunks_exact(ENTRY_COUNT)) {
                    outcomes[one.number] =
                        self.solve_design(&cases[one.number], one, values, &mut scratch.states);
                }
            }
        }
        outcomes
    }

    /// A design whose bodies are in the boxes of fits; appends the amplitudes of their modes.
    fn place(
        &self,
        number: usize,
        case: &DesignCase,
        scratch: &mut FitScratch,
        amplitudes: &mut Vec<f64>,
    ) -> Option<Placed<'_>> {
        let joint = &case.joint;
        let [pin, plate] = pair(joint)?;
        let keys = (pin.0, plate.0);
        if !self.plan.pairs.contains(&keys) {
            return None;
        }
        let fitted = self.fitted.as_ref()?;
        let families = [fitted.get(&keys.0)?, fitted.get(&keys.1)?];
        let nodes = self.nodes.get(&keys.0.half_ring)?;
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
            amplitude += 2.0 / (body.idealization.plane_modulus_ratio(body.poissons_ratio) * modulus);
            let from = amplitudes.len();
            let point = &points[side][..coordinate_count(body.shape)];
            families[side].fit.amplitudes(point, 1.0 / modulus, scratch, amplitudes);
            from..amplitudes.len()
        });
        Some(Placed { number, pair: keys, families, nodes, amplitude, modes })
    }

    /// From the joint's compliance at the nodes of its curve to the outcome, `None` where that is not known well enough.
    fn solve_design(
        &self,
        case: &DesignCase,
        placed: &Placed,
        values: &[f64],
        states: &mut Vec<Option<CurveState>>,
    ) -> Option<DesignOutcome> {
        let Placed { pair, families, nodes, amplitude, .. } = placed;
        let joint = &case.joint;
        let curve = SmoothCurve::new(nodes, *amplitude, values)?;
        let clearance = joint.radial_clearance / joint.hole_radius;
        states.clear();
        curve.states(clearance, loads_in_contact(case), states);
        // As `JointCompliance::relative_changes` of the sum: no more than that of the worse body.
        let bound = |state: &CurveState| {
            let next = (state.node + 1).min(CURVE_NODES - 1);
            let worst = families.iter().flat_map(|family| [family.bound[state.node], family.bound[next]]);
            state.curve_error() + worst.fold(0.0, f64::max)
        };
        let solving = Solving {
            backend: BackendKind::Cpu,
            way: Way::Interpolated,
            limit: SpaceKey { half_ring: pair.0.half_ring, terms: CURVE_TERMS }.limit(),
            accuracy: self.plan.accuracy,
        };
        if states.iter().any(Option::is_none) {
            return None;
        }
        let states = states.iter().map(|state| {
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
                thin_walls: 0.0,
                pressure_is_positive: state.pressure_is_positive,
            })
        });
        let (outcome, want) = solving.respond(case, states);
        (want == Want::Nothing).then_some(outcome)
    }
}
