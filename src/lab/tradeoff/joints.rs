//! Designs as contact sees them: their distinct bodies, their loads over their sizes, and contact angles in advance.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::hash::Hash;

use crate::engine::expected_contact::half_angle;
use crate::engine::spaces::SpaceKey;
use crate::mechanics::body::{Body, Side};
use crate::mechanics::laws::HertzContact;
use crate::study::columns::side_name;
use crate::study::design::{DesignCase, JointDesign, Load};

/// The distinct bodies of some designs: each is solved once.
pub struct Joints<K> {
    /// With what else they depend on.
    pub bodies: Vec<(Body, K)>,
    /// Pin and plate of each design among them.
    pub of_case: Vec<[usize; 2]>,
}

impl<K: Copy + Eq + Hash> Joints<K> {
    /// `key` is what the body of one side of a joint depends on besides itself.
    pub fn new(cases: &[DesignCase], key: impl Fn(&JointDesign, Side) -> K) -> Joints<K> {
        let mut bodies = Vec::new();
        let mut known: HashMap<(Body, K), usize> = HashMap::new();
        let of_case = cases
            .iter()
            .map(|case| {
                [&case.joint.pin, &case.joint.plate].map(|part| {
                    let key = key(&case.joint, part.shape.side);
                    let body = case.joint.body(part);
                    *known.entry((body.clone(), key)).or_insert_with(|| {
                        bodies.push((body, key));
                        bodies.len() - 1
                    })
                })
            })
            .collect();
        Joints { bodies, of_case }
    }
}

/// How many trial pressures a joint is solved with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terms {
    /// As many as its thinner body asks for where the accuracy is no reason for fewer.
    ByDepth,
    Fixed(usize),
}

impl Terms {
    /// The pressure space of a joint.
    pub fn space(self, joint: &JointDesign) -> SpaceKey {
        let (pin, plate) = (joint.body(&joint.pin), joint.body(&joint.plate));
        let by_depth = SpaceKey::coarsest(&pin, &plate, 0.0, PI);
        match self {
            Terms::ByDepth => by_depth,
            Terms::Fixed(terms) => SpaceKey { terms, ..by_depth },
        }
    }
}

/// Whether both bodies of a design have exact modes.
pub fn is_concentric(joint: &JointDesign) -> bool {
    joint.pin.shape.concentric && joint.plate.shape.concentric
}

/// Why a design has no place in a comparison, as it goes on behind its number: closed forms, node contact and the oracle know neither
/// layers nor press fits. `is_listed` where the design is a row of a list, which has columns and no keys.
pub fn not_compared(joint: &JointDesign, is_listed: bool) -> Option<String> {
    if joint.is_press_fit() {
        let clearance = joint.radial_clearance;
        return Some(format!("is a press fit: its radial_clearance is {clearance} mm, below 0"));
    }
    let lined = [&joint.pin, &joint.plate].into_iter().find(|part| !part.layers.is_empty())?;
    let side = side_name(lined.shape.side);
    if lined.layers.list().iter().any(|layer| layer.is_tube) {
        return Some(format!("has a tube with an inner part as its pin (joint.{side}.inner)"));
    }
    let key = if is_listed { format!("{side}_layer1_thickness_mm") } else { format!("joint.{side}.layers") };
    Some(format!("has layers in its {side} ({key})"))
}

/// About the least contact half angle of all steps, rad: half of what the undeformed circles overlap by, or Hertz's strip
/// under a force. Never below 0.5 deg, where meshes would have no end, nor above 10 deg.
pub fn least_contact_angle(cases: &[DesignCase]) -> f64 {
    let angle = |joint: &JointDesign, load: Load| match joint.from_first_touch(load) {
        Load::Indentation(delta) if delta > 0.0 => Some(0.5 * half_angle(joint, load)),
        Load::Force(force) if force > 0.0 => {
            let contact = HertzContact::from_force(&joint.pair().ok()?, force / joint.thickness).ok()?;
            Some(contact.contact_half_width() / joint.hole_radius)
        }
        _ => None,
    };
    let angles = cases.iter().flat_map(|case| case.steps.iter().filter_map(|load| angle(&case.joint, *load)));
    let least = angles.filter(|angle| angle.is_finite()).fold(f64::INFINITY, f64::min);
    least.clamp(0.5_f64.to_radians(), 10.0_f64.to_radians())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::mechanics::body::{annulus, cored_disc};
    use crate::mechanics::material::{Idealization, Material};
    use crate::study::design::Part;

    fn case(ratio: f64, clearance: f64, steps: &[Load]) -> DesignCase {
        let material = Material { youngs_modulus: 200e3, poissons_ratio: 0.3 };
        let part = |shape, ratio: f64| Part {
            shape,
            parameters: [ratio, 0.0, 0.0],
            support: 0,
            material,
            layers: Default::default(),
            yield_stress: None,
        };
        let joint = JointDesign {
            idealization: Idealization::PlaneStress,
            hole_radius: 100.0,
            radial_clearance: clearance,
            thickness: 1.0,
            pin: part(&cored_disc::SHAPE, 0.2),
            plate: part(&annulus::SHAPE, ratio),
        };
        DesignCase { index: 0, joint, steps: steps.to_vec().into() }
    }

    /// Bodies are shared by designs that differ in sizes and loads, unless they are solved in another space.
    #[test]
    fn equal_bodies_are_solved_once() {
        let cases = [case(2.0, 0.1, &[]), case(2.0, 0.3, &[]), case(3.0, 0.3, &[]), case(1.3, 0.3, &[])];
        let joints = Joints::new(&cases, |joint, _| Terms::ByDepth.space(joint));
        assert_eq!(joints.of_case, [[0, 1], [0, 1], [0, 2], [3, 4]]);
        assert_eq!(joints.bodies[3].1.terms, 16);
        assert_eq!(Joints::new(&cases, |_, _| ()).of_case, [[0, 1], [0, 1], [0, 2], [0, 3]]);
    }

    #[test]
    fn the_least_contact_angle_is_that_of_the_lightest_step() {
        let degrees = |steps: &[Load]| least_contact_angle(&[case(2.0, 0.1, steps)]).to_degrees();
        // cos 60 deg = 0.1/0.2.
        assert!((degrees(&[Load::Indentation(0.1)]) - 10.0).abs() < 1e-9);
        assert!((degrees(&[Load::Indentation(0.001), Load::Indentation(0.1)]) - 4.03).abs() < 0.01);
        assert!((degrees(&[Load::Force(1e-9), Load::Force(0.0)]) - 0.5).abs() < 1e-9);
        // a^2 = 4 F R/(pi E*), R = 99.9 100/0.1.
        let half_width = (4.0 * 30.0 * 99_900.0 / (PI * 1e5)).sqrt();
        assert!((degrees(&[Load::Force(30.0)]) - (half_width / 100.0).to_degrees()).abs() < 1e-9);
    }
}
