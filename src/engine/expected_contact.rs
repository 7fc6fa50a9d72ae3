//! What a design will come to, roughly, before it is solved: enough to choose where to begin, never to say how good an
//! answer is. That is judged when it is there.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::mechanics::material::effective_modulus;
use crate::study::design::{DesignCase, JointDesign, Load};

/// What is foreseen of a design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedContact {
    /// Of the widest contact among the steps, rad; rather too wide, since bodies are taken for Winkler beds.
    pub half_angle: f64,
    /// Of the narrowest one, rad: as wide as the widest where there is no contact.
    pub narrowest: f64,
    /// Of the work that goes into the pin and into the plate: as their moduli have it.
    pub shares: [f64; 2],
}

impl ExpectedContact {
    pub fn of(case: &DesignCase) -> ExpectedContact {
        let joint = &case.joint;
        let of_pin = joint.share_of_pin();
        // It grows with the load: those of the least and the greatest of either kind tell it.
        let none = [f64::INFINITY, 0.0];
        let (mut indentations, mut forces) = (none, none);
        for load in &*case.steps {
            let (range, value) = match joint.from_first_touch(*load) {
                Load::Indentation(value) | Load::Offset(value) => (&mut indentations, value),
                Load::Force(value) => (&mut forces, value),
            };
            if value > 0.0 {
                *range = [range[0].min(value), range[1].max(value)];
            }
        }
        let mut half_angles = none;
        for ([least, greatest], load) in
            [(indentations, Load::Indentation as fn(f64) -> Load), (forces, Load::Force)]
        {
            if greatest > 0.0 || joint.is_press_fit() {
                let [narrowest, widest] = [least, greatest].map(|value| half_angle(joint, load(value)));
                half_angles = [half_angles[0].min(narrowest), half_angles[1].max(widest)];
            }
        }
        let [narrowest, half_angle] = half_angles;
        let shares = [of_pin, 1.0 - of_pin];
        ExpectedContact { half_angle, narrowest: narrowest.min(half_angle), shares }
    }
}

/// Of the contact under one load, rad.
pub fn half_angle(joint: &JointDesign, load: Load) -> f64 {
    let radial_clearance = joint.radial_clearance;
    match joint.from_first_touch(load) {
        _ if joint.is_press_fit() => PI,
        // A neat fit opens at once.
        _ if joint.is_neat() => FRAC_PI_2,
        // Where the rigid outlines cross.
        Load::Indentation(delta) | Load::Offset(delta) => {
            (radial_clearance / (radial_clearance + delta)).acos()
        }
        // Persson's narrow contact, tan(eps/2)^2 = F/(pi E* dR).
        Load::Force(force) => {
            let modulus = effective_modulus(
                &joint.pin.contact_material(),
                &joint.plate.contact_material(),
                joint.idealization,
            );
            let half_tangent = (force / joint.thickness / (PI * modulus * radial_clearance)).sqrt();
            (2.0 * half_tangent.atan()).min(FRAC_PI_2)
        }
    }
}
