//! From the compliances of a design's bodies to its states, by contact with a moving edge.

use crate::engine::joint_scale::JointScale;
use crate::engine::outcome::Method;
use crate::engine::spaces::{SpaceKey, Spaces};
use crate::lab::tradeoff::answer::State;
use crate::mechanics::body::Side;
use crate::mechanics::compliance::BodyCompliance;
use crate::mechanics::contact::curve::ContactCurve;
use crate::study::design::{DesignCase, Load};

/// The states of one design, one for each step, in a space that was prepared for both bodies.
pub fn states(
    case: &DesignCase,
    (key, spaces): (SpaceKey, &Spaces),
    pin: &BodyCompliance,
    plate: &BodyCompliance,
) -> Vec<Option<State>> {
    let joint = &case.joint;
    let space = spaces.get(key);
    let shares = [&joint.pin, &joint.plate].map(|part| 1.0 / part.contact_material().youngs_modulus);
    let scale = JointScale::of(joint);
    let pin = space.part(Side::Pin, &[(pin, shares[0])], &scale.outlines);
    let plate = space.part(Side::Plate, &[(plate, shares[1])], &scale.outlines);
    let Some(curve) = ContactCurve::new(space, &[&pin, &plate], scale.outlines) else {
        return vec![None; case.steps.len()];
    };
    let mut found = curve.states(&mut scale.loads_in_contact(&case.steps)).into_iter();
    let state = |load: &Load| {
        scale.load(*load)?;
        let (state, _) = found.next()?.ok()?;
        State::of(&scale.response(*load, &state, 0.0, Method::Fe))
    };
    case.steps.iter().map(state).collect()
}
