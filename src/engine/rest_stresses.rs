//! Press fits at rest: Lame's stresses in all layers, from the overlap alone.

use crate::mechanics::body::Side;
use crate::mechanics::compliance::concentric_body::ConcentricBody;
use crate::study::design::JointDesign;

/// Whether the overlap of a press fit alone brings some material beyond the yield stress that it has been given.
pub fn yields_at_rest(joint: &JointDesign) -> bool {
    let is_given = |side| {
        let part = joint.part(side);
        (0..=part.layers.list().len()).any(|layer| part.yield_stress(layer).is_some())
    };
    let sides = [Side::Pin, Side::Plate];
    if !joint.is_press_fit() || !sides.into_iter().any(is_given) {
        return false;
    }
    let [Some(pin), Some(plate)] = sides.map(|side| ConcentricBody::of(&joint.body(joint.part(side)))) else {
        return false;
    };
    let yielding = |side, body: &ConcentricBody| {
        body.uniform_mode() / joint.part(side).contact_material().youngs_modulus
    };
    let overlap = -joint.radial_clearance / joint.hole_radius;
    let pressure = overlap / (yielding(Side::Pin, &pin) + yielding(Side::Plate, &plate));
    [(Side::Pin, pin), (Side::Plate, plate)].into_iter().any(|(side, body)| {
        let part = joint.part(side);
        body.circle_stresses(0).iter().enumerate().any(|(number, circles)| {
            let layer = part.layer_of(number);
            let axial_share = joint.idealization.axial_share(part.layer_material(layer).poissons_ratio);
            let greatest = circles.iter().map(|stress| stress.von_mises(axial_share)).fold(0.0, f64::max);
            part.yield_stress(layer).is_some_and(|least| pressure * greatest > least)
        })
    })
}
