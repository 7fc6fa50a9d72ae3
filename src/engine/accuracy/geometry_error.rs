//! What the geometry of the model leaves of a force: outlines to first order in the clearance, and displacements that are small.
//! No mesh mends either.

use std::f64::consts::FRAC_PI_6;

use crate::engine::outcome::Response;
use crate::mechanics::contact::outlines::Outlines;
use crate::study::design::JointDesign;

/// Of the clearance ratio squared: with a rigid pin, and more by the pin's share of the work; less in narrow contacts, below 30 deg.
/// Above all that was seen in `tests/mechanics/geometry.rs`, at 2 to 8 % of clearance.
const OF_PLATE: f64 = 0.05;
const MORE_OF_PIN: f64 = 0.2;
const OF_SINE: f64 = 2.0;

/// From this clearance ratio on a row says so, whatever is left.
pub const WIDEST_CLEARANCE: f64 = 0.5;

/// Relative error of the force by the outlines being those of first order in the clearance, at a contact half angle, rad. The
/// shares of the work are taken for those of the moduli.
pub fn outline_error(joint: &JointDesign, outlines: &Outlines, half_angle: f64) -> f64 {
    let [pin, plate] = [&joint.pin, &joint.plate].map(|part| part.material.plane_modulus(joint.idealization));
    let of_pin = plate / (pin + plate);
    let of_width = if half_angle < FRAC_PI_6 { OF_SINE * half_angle.sin() } else { 1.0 };
    outlines.radial_clearance * outlines.radial_clearance * of_width * (OF_PLATE + MORE_OF_PIN * of_pin)
}

/// Of `linearity_error`, by which laws that agree at small strain differ from it and from each other.
const OF_STRAIN: f64 = 2.0;

/// Estimated relative difference of the force from laws of finite displacement and strain (docs/theory.md, section 10).
pub fn linearity_error(joint: &JointDesign, response: &Response) -> f64 {
    let softer = joint.pin.material.youngs_modulus.min(joint.plate.material.youngs_modulus);
    let displacement = response.indentation / joint.hole_radius;
    OF_STRAIN * displacement.max(response.peak_pressure.unwrap_or(0.0) / softer)
}

/// Below this no row remarks on it.
pub const LARGE_DISPLACEMENT: f64 = 0.01;
