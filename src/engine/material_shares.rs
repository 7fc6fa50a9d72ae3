//! Which material decides a joint: the part of the strain energy that is stored in each, and the part of the force that it has.
//!
//! At a given offset of the pin all moduli together scale energy and force, so that the derivatives of ln U, and of ln F, by the
//! logarithms of the Young's moduli add up to 1. The derivative of ln U is the share of the energy in that material, because neither the pressure
//! nor where it ends changes the energy to first order. That of ln F says by how much the force grows with that modulus.

use crate::engine::joint_curve::JointCurve;
use crate::engine::outcome::Response;
use crate::mechanics::body::Side;
use crate::study::design::{JointDesign, Load, Part};
use crate::study::layers::Layers;

/// The shares of one material of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaterialShare {
    pub side: Side,
    /// From 1 at the contact; 0 is the part's own material.
    pub layer: usize,
    /// Of the strain energy; all of a joint add up to 1.
    pub energy: f64,
    /// Of the force: by how many per mille it grows with one per mille of this Young's modulus; all of a joint add up to 1. NaN where there is
    /// no force, as in a press fit at rest.
    pub force: f64,
}

/// By how much the logarithm of a modulus is changed. Series are good to 1e-8 and meshes change with the modulus only by its ratios: what
/// differences leave is below 1e-5.
const STEP: f64 = 1e-3;

/// Of each material of the joint of a curve under loads, the pin's first: `None` where a load has no answer, empty where it presses nothing.
pub fn material_shares(mut curve: JointCurve, loads: &[Load]) -> Vec<Option<Vec<MaterialShare>>> {
    let joint = curve.joint().clone();
    let responses = |curve: &JointCurve, loads: &[Load]| -> Vec<Option<Response>> {
        curve.answers(loads).into_iter().map(|step| step.response).collect()
    };
    let at_loads = responses(&curve, loads);
    // At the offsets that the loads come to.
    let offsets: Vec<Load> = at_loads
        .iter()
        .map(|response| Load::Offset(response.map_or(0.0, |response| response.offset)))
        .collect();
    let mut shares: Vec<Option<Vec<MaterialShare>>> =
        at_loads.iter().map(|response| response.map(|_| Vec::new())).collect();
    for (side, part) in [(Side::Pin, &joint.pin), (Side::Plate, &joint.plate)] {
        for layer in (1..=part.layers.list().len()).chain([0]) {
            let mut changed = Vec::new();
            for sign in [1.0_f64, -1.0] {
                let own = with_modulus(part, layer, (sign * STEP).exp());
                let other = match side {
                    Side::Pin => JointDesign { pin: own, ..joint.clone() },
                    Side::Plate => JointDesign { plate: own, ..joint.clone() },
                };
                curve = curve.of_other(&other);
                changed.push(responses(&curve, &offsets));
            }
            for (place, shares) in shares.iter_mut().enumerate() {
                let (Some(shares), Some(more), Some(less)) = (shares, changed[0][place], changed[1][place])
                else {
                    continue;
                };
                let slope = |of: fn(&Response) -> f64| (of(&more) / of(&less)).ln() / (2.0 * STEP);
                let share = MaterialShare {
                    side,
                    layer,
                    energy: slope(|response| response.energy.unwrap_or(f64::NAN)),
                    force: slope(|response| response.force),
                };
                // Nothing divided by nothing where nothing is pressed; at rest a press fit has energy and no force.
                if share.energy.is_finite() {
                    shares.push(share);
                }
            }
        }
    }
    shares
}

/// A part with one Young's modulus, of a layer or its own (0), times a factor.
fn with_modulus(part: &Part, layer: usize, factor: f64) -> Part {
    let mut changed = part.clone();
    match layer.checked_sub(1) {
        None => changed.material.youngs_modulus *= factor,
        Some(place) => {
            let mut layers = part.layers.list().to_vec();
            layers[place].material.youngs_modulus *= factor;
            changed.layers = Layers::new(layers);
        }
    }
    changed
}
