//! The whole curve of one joint, solved once and asked as often as one likes.

use std::f64::consts::FRAC_PI_2;

use crate::engine::body_request::JointBodies;
use crate::engine::joint_contact::{ContactRoom, SolvedPlan, solve_designs, with_curve};
use crate::engine::joint_scale::JointScale;
use crate::engine::ladder::Ladder;
use crate::engine::outcome::StepOutcome;
use crate::engine::plan::JointPlan;
use crate::engine::status::Failure;
use crate::mechanics::compliance::near_field::InCommon;
use crate::mechanics::contact::arc_pressure::ArcPressure;
use crate::mechanics::contact::curve::ContactCurve;
use crate::study::config::{MethodChoice, SolveOptions};
use crate::study::design::{DesignCase, JointDesign, Load};

/// Of one joint, at one resolution from the first contact on: its values are those of one smooth curve.
pub struct JointCurve {
    joint: JointDesign,
    accuracy: f64,
    ladder: Ladder<'static>,
    plan: JointPlan,
    bodies: JointBodies,
}

/// Indentations that the resolution is chosen for, over the clearance.
const LOOKED_AT: [f64; 9] = [1e-3, 1e-2, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0];

/// That of a neat fit, over the hole's radius: it has one state.
const OF_NEAT_FIT: f64 = 1e-3;

impl JointCurve {
    /// Solves the bodies as finely as an accuracy of the force wants over the whole curve; where none does, as finely as can be,
    /// and every answer says so. Those that the joint of the curve before has are not solved again. `method` is not `closed-form`.
    pub fn after(
        before: Option<JointCurve>,
        joint: &JointDesign,
        options: SolveOptions,
    ) -> Result<JointCurve, Failure> {
        let SolveOptions { accuracy, method } = options;
        assert!(method != MethodChoice::ClosedForm, "a closed form has no curve of the joint");
        let steps: Vec<Load> = if joint.is_neat() {
            vec![Load::Indentation(OF_NEAT_FIT * joint.hole_radius)]
        } else {
            let looked_at = |ratio: f64| match ratio * joint.radial_clearance {
                overlap if overlap < 0.0 => Load::Offset(-overlap),
                indentation => Load::Indentation(indentation),
            };
            LOOKED_AT.map(looked_at).into()
        };
        let case = DesignCase { index: 0, joint: joint.clone(), steps: steps.into() };
        let plan = JointPlan::cheapest(&case, method, accuracy).map_err(Failure::Refused)?;
        let fresh = || Ladder::new(options).sharing(InCommon::ALL);
        let mut ladder = before.map_or_else(fresh, |curve| curve.ladder.with_options(options));
        let settled = ladder.climb(&[case], vec![(0, plan.clone())]).pop();
        let plan = settled.map_or(plan, |(_, plan, _)| plan);
        Ok(JointCurve::prepared(joint, accuracy, ladder, plan))
    }

    /// With its bodies solved.
    fn prepared(
        joint: &JointDesign,
        accuracy: f64,
        mut ladder: Ladder<'static>,
        plan: JointPlan,
    ) -> JointCurve {
        let bodies = ladder.prepare(&[(0, plan.clone())]).remove(0);
        JointCurve { joint: joint.clone(), accuracy, ladder, plan, bodies }
    }

    fn solved(&self) -> SolvedPlan<'_> {
        SolvedPlan { plan: &self.plan, bodies: self.bodies }
    }

    /// The curve of another joint of the same shapes, on the same meshes and nodes: its values differ by what the joints differ by, not by what
    /// the resolution leaves.
    pub fn of_other(self, joint: &JointDesign) -> JointCurve {
        let JointCurve { accuracy, ladder, plan, .. } = self;
        let plan = plan.of_other(joint);
        JointCurve::prepared(joint, accuracy, ladder, plan)
    }

    pub fn joint(&self) -> &JointDesign {
        &self.joint
    }

    /// The accuracy that was asked.
    pub fn accuracy(&self) -> f64 {
        self.accuracy
    }

    /// What a row of a table says under each of these loads (mm or N, not negative; press fits have no indentation).
    pub fn answers(&self, loads: &[Load]) -> Vec<StepOutcome> {
        let case = DesignCase { index: 0, joint: self.joint.clone(), steps: loads.into() };
        let Ladder { library, spaces, .. } = &self.ladder;
        let cases = std::iter::once(&case);
        let room = &mut ContactRoom::default();
        let answers = solve_designs(library, spaces, self.solved(), cases, self.accuracy, room);
        answers.into_iter().next().map_or(Vec::new(), |(answer, _)| answer.steps)
    }

    /// The contact pressure along the arc under a load, from the load line to where it ends, evenly spaced: angles at the hole's
    /// centre, rad, and MPa per area of the hole. Empty where the load has no state.
    pub fn pressure(&self, load: Load, points: usize) -> Vec<(f64, f64)> {
        let at_points = |half_angle: f64, pressure: &ArcPressure, unit: f64| {
            let place = |i: usize| i as f64 / (points.max(2) - 1) as f64;
            // Denser at the end, where the pressure falls like a root.
            let angle = |i: usize| half_angle * (FRAC_PI_2 * place(i)).sin();
            (0..points.max(2)).map(|i| (angle(i), unit * pressure.at(angle(i)))).collect()
        };
        self.with_pressure(load, at_points).unwrap_or_default()
    }

    /// The offset up to which a press fit stays closed all around, mm; `None` of joints with clearance.
    pub fn opening(&self) -> Option<f64> {
        if !self.joint.is_press_fit() {
            return None;
        }
        let opening = self.with_curve(|curve| curve.opening()).flatten()?;
        Some(opening * -self.joint.radial_clearance)
    }

    fn with_curve<T>(&self, ask: impl FnOnce(&ContactCurve) -> T) -> Option<T> {
        with_curve(&self.ladder.library, &self.ladder.spaces, self.solved(), &self.joint, ask)
    }

    /// Asks with the contact half angle, rad, the pressure and what it is per unit of, MPa; `None` where the load has no state.
    pub fn with_pressure<T>(&self, load: Load, ask: impl FnOnce(f64, &ArcPressure, f64) -> T) -> Option<T> {
        let scale = JointScale::of(&self.joint);
        let dimensionless = scale.load(load)?;
        self.with_curve(|curve| {
            let (state, above) = curve.states_of_fit(&mut std::iter::once(dimensionless)).pop()?.ok()?;
            Some(ask(state.half_angle, &curve.pressure(&state, above), scale.unit(load, &state)))
        })?
    }
}
