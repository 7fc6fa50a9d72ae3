//! How much of the energy and of the force each material decides: against the modes of press fits, and against what it must add up to.

use std::f64::consts::PI;

use crate::common::stepped_ring::{Beyond, Ring};
use jointsweep::internals::mechanics::body::Side;
use jointsweep::{
    Dimensions, Idealization, Joint, Layer, Load, Material, MethodChoice, Options, Part, material_shares,
};

fn material(youngs_modulus: f64, poissons_ratio: f64) -> Material {
    Material { youngs_modulus, poissons_ratio }
}

const OPTIONS: Options = Options { accuracy: 1e-4, method: MethodChoice::Auto };

fn joint(radial_clearance: f64, plate: Part) -> Joint {
    let pin = Part::new("rigid-core", &[("core_radius_ratio", 0.2)], None, material(210e3, 0.3)).unwrap();
    let sizes = Dimensions { hole_radius: 10.0, radial_clearance, thickness: 2.0 };
    Joint::new(sizes, Idealization::PlaneStress, pin, plate).unwrap()
}

fn bush(radial_clearance: f64) -> Joint {
    let plate = Part::new("annulus", &[("outer_radius_ratio", 3.0)], None, material(70e3, 0.33)).unwrap();
    let layer = Layer::new(1.0, material(3e3, 0.4));
    joint(radial_clearance, plate.with_layers(&[layer]).unwrap())
}

/// At rest, and closed all around: each mode divides its energy as the bodies divide its compliance.
#[test]
fn shares_of_a_closed_press_fit_are_those_of_its_modes() {
    let ring = |fixed_radius_ratio, youngs_modulus, poissons_ratio, beyond| Ring {
        fixed_radius_ratio,
        youngs_modulus,
        poissons_ratio,
        idealization: Idealization::PlaneStress,
        beyond,
    };
    let beyond: &'static [Beyond] =
        &[Beyond { radius_ratio: 1.1, youngs_modulus: 70e3, poissons_ratio: 0.33 }];
    let (pin, plate) = (ring(0.2, 210e3, 0.3, &[]), ring(3.0, 3e3, 0.4, beyond));
    let energies = |offset: f64| {
        let of = |ring: &Ring, n: usize| ring.mode(n) / (pin.mode(n) + plate.mode(n)).powi(2);
        let both = |ring| 2.0 * PI * 0.02_f64.powi(2) * of(ring, 0) + PI * offset * offset * of(ring, 1);
        [both(&pin), both(&plate)]
    };
    let offsets = [0.0, 0.01];
    let shares = material_shares(&bush(-0.02), &offsets.map(Load::Offset), OPTIONS).unwrap();
    assert_eq!(shares.len(), 2);
    for (offset, shares) in offsets.into_iter().zip(shares) {
        let shares = shares.unwrap();
        let places: Vec<(Side, usize)> = shares.iter().map(|share| (share.side, share.layer)).collect();
        assert_eq!(places, [(Side::Pin, 0), (Side::Plate, 1), (Side::Plate, 0)]);
        let [of_pin, of_plate] = energies(offset);
        let expected = of_pin / (of_pin + of_plate);
        assert!((shares[0].energy - expected).abs() < 1e-5, "{offset}: {} {expected}", shares[0].energy);
        let plates = shares[1].energy + shares[2].energy;
        assert!((plates - (1.0 - expected)).abs() < 1e-5, "{offset}: {plates}");
        assert!(shares[1].energy > shares[2].energy);
        // At rest there is no force to divide.
        assert_eq!(shares[0].force.is_nan(), offset == 0.0);
    }
}

/// With clearance, by exact modes and on meshes: all add up to one, and say what a stiffer material does.
#[test]
fn shares_add_up_and_foretell() {
    let ratios = [("half_width_ratio", 2.0), ("depth_ratio", 2.0), ("height_ratio", 2.0)];
    let block = Part::new("block", &ratios, None, material(70e3, 0.33)).unwrap();
    let mut compared = 0;
    for joint in [bush(0.03), bush(-0.01), joint(0.03, block)] {
        let loads = [Load::Offset(0.05), Load::Force(5e3)];
        let curve = joint.curve(OPTIONS).unwrap();
        let shares = material_shares(&joint, &loads, OPTIONS).unwrap();
        for (load, shares) in loads.into_iter().zip(shares) {
            let shares = shares.unwrap();
            assert_eq!(shares.len(), 2 + usize::from(!joint.design().plate.layers.is_empty()));
            for sum in [
                shares.iter().map(|share| share.energy).sum::<f64>(),
                shares.iter().map(|share| share.force).sum(),
            ] {
                assert!((sum - 1.0).abs() < 1e-5, "{load}: {sum}");
            }
            assert!(shares.iter().all(|share| share.energy > 0.0 && share.energy < 1.0), "{shares:?}");
            // A tenth more of the pin's modulus, at the same offset.
            let before = curve.at(load).unwrap();
            let mut stiffer = joint.design().clone();
            stiffer.pin.material.youngs_modulus *= 1.1;
            let stiffer = Joint::try_from(stiffer).unwrap().curve(OPTIONS).unwrap();
            let after = stiffer.at(Load::Offset(before.offset)).unwrap();
            for (grown, share) in [
                (after.force / before.force, shares[0].force),
                (after.energy.unwrap() / before.energy.unwrap(), shares[0].energy),
            ] {
                assert!(
                    (grown.ln() / 1.1_f64.ln() / share - 1.0).abs() < 0.06,
                    "{load}: {grown} for {share}"
                );
            }
            compared += 1;
        }
    }
    assert_eq!(compared, 6);
}

#[test]
fn what_presses_nothing_has_no_shares() {
    let shares = material_shares(&bush(0.03), &[Load::Offset(0.01), Load::Force(0.0)], OPTIONS).unwrap();
    assert!(shares.iter().all(|shares| shares.as_ref().is_some_and(Vec::is_empty)), "{shares:?}");
    let said = material_shares(&bush(-0.03), &[Load::Indentation(0.01)], OPTIONS).unwrap_err().to_string();
    assert!(said.contains("a press fit has none"), "{said}");
}
