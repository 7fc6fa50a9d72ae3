//! From the compliances of a design's bodies to its states, by contact with a moving edge.

use crate::mechanics::compliance::PressureCompliance;
use crate::mechanics::compliance::pressure_space::PressureSpace;
use crate::mechanics::contact::arc_state::ArcState;
use crate::mechanics::contact::loading::{DimensionlessLoad, JointCurve};
use crate::mechanics::contact::pressure::JointCompliance;
use crate::study::design::{DesignCase, Load};
use crate::tradeoff::state::State;

/// The states of one design, one for each step.
pub fn states(
    case: &DesignCase,
    space: &PressureSpace,
    pin: &PressureCompliance,
    plate: &PressureCompliance,
) -> Vec<Option<State>> {
    let joint = &case.joint;
    let moduli = [joint.pin.material.youngs_modulus, joint.plate.material.youngs_modulus];
    let joined = JointCompliance::new(space, (pin, moduli[0]), (plate, moduli[1]));
    let Ok(curve) = JointCurve::new(joined) else { return vec![None; case.steps.len()] };
    let (radius, thickness) = (joint.hole_radius, joint.thickness);
    let clearance = joint.radial_clearance / radius;
    let dimensionless = |load: &Load| match *load {
        Load::Indentation(delta) => DimensionlessLoad::Indentation(delta / radius),
        Load::Force(force) => DimensionlessLoad::Force(force / (thickness * radius)),
    };
    let is_loaded = |load: &&Load| !matches!(load, Load::Indentation(0.0) | Load::Force(0.0));
    let loads: Vec<DimensionlessLoad> = case.steps.iter().filter(is_loaded).map(dimensionless).collect();
    let mut found = curve.states(clearance, &loads).into_iter();
    let state = |load: &Load| {
        let state = Some(load).filter(is_loaded).and_then(|_| found.next())?.ok()?;
        let offset = match dimensionless(load) {
            DimensionlessLoad::Indentation(delta) => clearance + delta,
            DimensionlessLoad::Force(force) => force / state.force,
        };
        whole(&state, offset, radius, thickness).sound()
    };
    case.steps.iter().map(state).collect()
}

/// A state with its sizes: `offset` is e over the hole's radius.
pub fn whole(state: &ArcState, offset: f64, radius: f64, thickness: f64) -> State {
    State {
        indentation: radius * offset * state.indentation,
        force: thickness * radius * offset * state.force,
        tangent_stiffness: thickness * state.tangent_stiffness,
        contact_half_angle: Some(state.arc.half_angle),
        peak_pressure: Some(offset * state.peak_pressure()),
        iterations: None,
    }
}
