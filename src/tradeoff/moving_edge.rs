//! From the compliances of a design's bodies to its states, by contact with a moving edge.

use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::Method;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::contact::curve::ContactCurve;
use crate::study::design::{DesignCase, Load};
use crate::tradeoff::answer::State;

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
    let scale = JointScale::of(joint);
    let mut found = curve.states(scale.radial_clearance, scale.loads_in_contact(&case.steps)).into_iter();
    let state = |load: &Load| {
        scale.load(*load)?;
        let (state, _) = found.next()?.ok()?;
        State::of(&scale.response(*load, &state, 0.0, Method::Fe))
    };
    case.steps.iter().map(state).collect()
}
