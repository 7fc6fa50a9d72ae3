//! From the compliances of a design's bodies to its states, by contact with a moving edge.

use crate::engine::row::dimensionless;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::contact::curve::ContactCurve;
use crate::mechanics::contact::load::DimensionlessLoad;
use crate::mechanics::contact::state::ContactState;
use crate::study::design::{DesignCase, JointDesign, Load};
use crate::tradeoff::state::State;

/// The states of one design, one for each step, in a space that was prepared for both bodies.
pub fn states(
    case: &DesignCase,
    (key, spaces): (SpaceKey, &Spaces),
    pin: &BodyCompliance,
    plate: &BodyCompliance,
) -> Vec<Option<State>> {
    let joint = &case.joint;
    let space = spaces.get(key);
    let shares = [&joint.pin, &joint.plate].map(|part| 1.0 / part.material.youngs_modulus);
    let joined = space.pressures.joint(&[(pin, shares[0]), (plate, shares[1])]);
    let Some(curve) = ContactCurve::new(space, &joined) else { return vec![None; case.steps.len()] };
    let clearance = joint.radial_clearance / joint.hole_radius;
    let is_loaded = |load: &Load| !matches!(load, Load::Indentation(0.0) | Load::Force(0.0));
    let load_over = |load: &Load| dimensionless(joint, *load).filter(|_| is_loaded(load));
    let mut found = curve.states(clearance, case.steps.iter().filter_map(load_over)).into_iter();
    let state = |load: &Load| {
        let load = load_over(load)?;
        let (state, _) = found.next()?.ok()?;
        let offset = match load {
            DimensionlessLoad::Indentation(delta) => clearance + delta,
            DimensionlessLoad::Force(force) => force / state.force,
        };
        whole(&state, offset, joint).sound()
    };
    case.steps.iter().map(state).collect()
}

/// A state with its sizes: `offset` is e over the hole's radius.
fn whole(state: &ContactState, offset: f64, joint: &JointDesign) -> State {
    let (radius, thickness) = (joint.hole_radius, joint.thickness);
    State {
        indentation: radius * offset * state.indentation,
        force: thickness * radius * offset * state.force,
        tangent_stiffness: thickness * state.tangent_stiffness,
        contact_half_angle: Some(state.half_angle),
        peak_pressure: Some(offset * state.peak_pressure),
        iterations: None,
    }
}
