//! The engine against converged finite-element references with the true geometry, and against plain fine meshes with it.
//!
//! Source: GetFEM, CalculiX and scikit-fem, which agree within 1e-4 of the force. Plane stress, E = 200 GPa, nu = 0.3,
//! R2 = 100 mm, t = 1 mm, a half disc under a rigid plane (or a disc around a rigid core), an annulus fixed outside.
//!
//! Run with `--nocapture` for the figures of docs/theory.md, section 10.

use crate::common::length;
use crate::common::plain_mesh::{Pairing, State, meshed};
use crate::common::study_joint::{ACCURACY, HOLE_RADIUS, Solver, joint};
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::Response;
use jointsweep::internals::mechanics::body::{block, cored_disc, half_disc};
use jointsweep::internals::mechanics::contact::outlines::Outlines;
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

struct Reference {
    outer_radius_ratio: f64,
    /// Of the pin; 0 for the half disc.
    core_radius_ratio: f64,
    radial_clearance: f64,
    indentation: f64,
    force: f64,
    /// At the hole's centre, deg.
    contact_half_angle: f64,
}

impl Reference {
    fn joint(&self) -> JointDesign {
        let shape = if self.core_radius_ratio == 0.0 { &half_disc::SHAPE } else { &cored_disc::SHAPE };
        joint(shape, self.core_radius_ratio, self.outer_radius_ratio, self.radial_clearance)
    }

    /// What is said to be left of the outlines at 5 % of clearance is no mesh's to mend.
    fn accuracy(&self) -> f64 {
        if self.radial_clearance == 5.0 { 8.0 * ACCURACY } else { ACCURACY }
    }

    fn engine(&self) -> Response {
        Solver::new(self.accuracy()).solve(self.joint(), Load::Indentation(self.indentation))
    }

    fn meshed(&self, pairing: Pairing) -> State {
        meshed(&self.joint(), self.indentation, self.contact_half_angle.to_radians(), pairing)
    }
}

const fn reference(
    outer_radius_ratio: f64,
    core_radius_ratio: f64,
    radial_clearance: f64,
    indentation: f64,
    force: f64,
    contact_half_angle: f64,
) -> Reference {
    Reference {
        outer_radius_ratio,
        core_radius_ratio,
        radial_clearance,
        indentation,
        force,
        contact_half_angle,
    }
}

const REFERENCES: [Reference; 6] = [
    reference(3.0, 0.0, 5.0, 0.2, 11417.8, 9.42),
    reference(3.0, 0.0, 0.2, 0.02, 1418.31, 16.65),
    reference(3.0, 0.0, 0.2, 0.1, 11266.1, 40.18),
    reference(3.0, 0.0, 0.2, 0.2, 26919.8, 53.29),
    reference(2.0, 0.0, 0.2, 0.1, 13776.6, 41.64),
    reference(10.0, 0.1, 0.1, 0.1, 8212.4, 47.02),
];

/// The references' own uncertainty.
const UNCERTAINTY: f64 = 1e-4;

#[test]
fn the_engine_meets_the_references() {
    let mut published = 0;
    for reference in &REFERENCES {
        let Response { force, contact_half_angle, peak_pressure, tangent_stiffness, .. } = reference.engine();
        let deviation = force / reference.force - 1.0;
        let angle = contact_half_angle.unwrap().to_degrees();
        println!(
            "ratio {}, dR {}, delta {}: F {force:.2} ({:+.3} %), eps {angle:.2}",
            reference.outer_radius_ratio,
            reference.radial_clearance,
            reference.indentation,
            100.0 * deviation
        );
        // The reference's uncertainty and the accuracy asked; seen: 0.006 %.
        assert!(deviation.abs() < UNCERTAINTY + reference.accuracy(), "{deviation}");
        // Half of the reference's last digit, and the 0.02 deg by which node contact finds an edge; seen 0.02.
        assert!((angle - reference.contact_half_angle).abs() < 0.03, "{angle}");
        if reference.force == 11266.1 {
            // p0 = 109.92 MPa, k_t = 1.447e5 N/mm: last digits.
            assert!((peak_pressure.unwrap() / 109.92 - 1.0).abs() < 3e-4, "{peak_pressure:?}");
            assert!((tangent_stiffness / 1.447e5 - 1.0).abs() < 4e-4, "{tangent_stiffness}");
            published += 1;
        }
    }
    assert_eq!(published, 1, "one reference has a peak pressure and a stiffness");
}

#[test]
fn plain_meshes_meet_the_references() {
    let mut published = 0;
    for reference in &REFERENCES {
        let [at_touch, along_pin, displaced] = [Pairing::AtTouch, Pairing::AlongPin, Pairing::Displaced]
            .map(|pairing| reference.meshed(pairing));
        let of_reference = at_touch.force / reference.force - 1.0;
        println!(
            "ratio {}, dR {}, delta {}: {:.2} ({:+.4} % of the reference), hole's angle {:.3}, p0 {:.2}; along the pin's normal \
             {:+.4} %, displaced {:+.4} %",
            reference.outer_radius_ratio,
            reference.radial_clearance,
            reference.indentation,
            at_touch.force,
            100.0 * of_reference,
            at_touch.angle_at_hole.to_degrees(),
            at_touch.peak_pressure,
            100.0 * (along_pin.force / at_touch.force - 1.0),
            100.0 * (displaced.force / at_touch.force - 1.0),
        );
        // Seen: 0.002 %.
        assert!(of_reference.abs() < UNCERTAINTY);
        // Half of the reference's last digit, and the 0.02 deg by which node contact finds an edge; seen 0.015.
        assert!((at_touch.angle_at_hole.to_degrees() - reference.contact_half_angle).abs() < 0.02);
        if reference.force == 11266.1 {
            assert!(
                (at_touch.peak_pressure / 109.92 - 1.0).abs() < UNCERTAINTY,
                "{}",
                at_touch.peak_pressure
            );
            published += 1;
        }
    }
    assert_eq!(published, 1, "one reference has a peak pressure");
}

/// Half discs and blocks, to 0.01 % at a clearance ratio of 1 % and to 0.1 % up to 8 %: pins up to a hundred times as stiff as plates
/// and the reverse.
#[test]
fn the_engine_has_the_true_geometry() {
    let block = Part {
        shape: &block::SHAPE,
        parameters: [2.0, 1.7, 2.4],
        support: 0,
        material: Material { youngs_modulus: 200e3, poissons_ratio: 0.3 },
        layers: Default::default(),
        yield_stress: None,
    };
    let of_each = length::count(1, 2) as usize;
    let mut compared = 0;
    for (name, pin, plate) in [
        ("half disc in annulus", &half_disc::SHAPE, None),
        ("half disc in block", &half_disc::SHAPE, Some(block.clone())),
        ("disc in block", &cored_disc::SHAPE, Some(block)),
    ] {
        for (eta, shares, of_pin) in [
            (0.01, [0.3, 1.5], 0.1),
            (0.05, [0.1, 1.0], 1.0),
            (0.05, [0.3, 0.6], 0.05),
            (0.08, [0.2, 1.0], 10.0),
            (0.08, [0.1, 0.5], 0.1),
            (0.05, [0.1, 1.0], 0.01),
            (0.08, [0.3, 3.0], 100.0),
        ] {
            let mut joint = joint(pin, 0.2, 2.5, eta * HOLE_RADIUS);
            joint.plate = plate.clone().unwrap_or(joint.plate);
            joint.pin.material.youngs_modulus *= of_pin;
            for share in shares.into_iter().skip(2 - of_each) {
                let load = Load::Indentation(share * joint.radial_clearance);
                let accuracy = if eta <= 0.01 { 1e-4 } else { 1e-3 };
                let options = SolveOptions { accuracy, method: MethodChoice::Auto };
                let case = DesignCase { index: 0, joint: joint.clone(), steps: vec![load].into() };
                let engine = Ladder::new(options).solve(&[case]).remove(0).steps[0].response.unwrap();
                let angle = engine.contact_half_angle.unwrap();
                let mean = 0.5 * (angle + Outlines::new(eta).of_pin(angle));
                let plain = meshed(&joint, share * joint.radial_clearance, mean, Pairing::AtTouch);
                let force = engine.force / plain.force - 1.0;
                let peak = engine.peak_pressure.unwrap() / plain.peak_pressure - 1.0;
                let at_edge = (angle - plain.angle_at_hole).to_degrees();
                println!(
                    "{name}, dR/R2 {eta}, E1/E2 {of_pin}, delta/dR {share}: eps {:.2} ({at_edge:+.3}), F {:+.4} %, said {:.4} %, p0 {:+.3} %",
                    angle.to_degrees(),
                    100.0 * force,
                    100.0 * engine.force_error,
                    100.0 * peak
                );
                assert!(force.abs() < accuracy && force.abs() < engine.force_error, "{force}");
                assert!(at_edge.abs() < 0.1 && peak.abs() < 1e-3, "{at_edge} {peak}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 21 * of_each);
}

/// Where the exact kernels' parts do not cancel (unlike materials), and where there is no exact compliance (a block).
///
/// `series` and the mesh's near field share their kernels, so an error there shows in neither when the two are compared.
#[test]
fn the_engine_equals_plain_meshes() {
    let aluminium = Material { youngs_modulus: 70e3, poissons_ratio: 0.45 };
    let mut dissimilar = joint(&cored_disc::SHAPE, 0.2, 3.0, 0.2);
    dissimilar.pin.material.poissons_ratio = 0.1;
    dissimilar.plate.material = aluminium;
    let strain = JointDesign { idealization: Idealization::PlaneStrain, ..dissimilar.clone() };
    let plate = Part {
        shape: &block::SHAPE,
        parameters: [2.0, 1.7, 2.4],
        support: 0,
        material: aluminium,
        layers: Default::default(),
        yield_stress: None,
    };
    let in_block = JointDesign { plate, ..joint(&half_disc::SHAPE, 0.0, 2.0, 0.2) };
    for (name, joint, accuracy) in [
        ("dissimilar", dissimilar, ACCURACY),
        ("plane strain", strain, ACCURACY),
        // The block's corners, where its held edge ends, slow the convergence.
        ("block", in_block, 1e-3),
    ] {
        for indentation in [0.02, 0.2] {
            let engine = Solver::new(accuracy).solve(joint.clone(), Load::Indentation(indentation));
            let angle = engine.contact_half_angle.unwrap();
            let plain = meshed(&joint, indentation, angle, Pairing::AtTouch);
            let (force, peak) =
                (engine.force / plain.force - 1.0, engine.peak_pressure.unwrap() / plain.peak_pressure - 1.0);
            let at_edge = (angle - plain.angle_at_hole).to_degrees();
            println!(
                "{name}, delta {indentation}: eps {:.2} ({at_edge:+.3}), F {:.2} ({:+.4} %, estimated {:.4} %), p0 {:+.3} %",
                angle.to_degrees(),
                plain.force,
                100.0 * force,
                100.0 * engine.force_error,
                100.0 * peak
            );
            assert!(force.abs() < accuracy);
            assert!(at_edge.abs() < 0.1 && peak.abs() < 0.01);
        }
    }
}

/// A half disc's elements at the ring are not its reference's, and a contact narrower than an element shows it.
#[test]
fn narrow_contacts_of_a_half_disc_are_within_a_fifth_of_a_percent() {
    for indentation in [4e-8, 3.3e-7, 2.6e-6] {
        let joint = joint(&half_disc::SHAPE, 0.0, 2.0, 1e-3);
        let engine = Solver::new(2.5e-3).solve(joint.clone(), Load::Indentation(indentation));
        let angle = engine.contact_half_angle.unwrap();
        let plain = meshed(&joint, indentation, angle, Pairing::AtTouch);
        let (force, peak) =
            (engine.force / plain.force - 1.0, engine.peak_pressure.unwrap() / plain.peak_pressure - 1.0);
        println!(
            "eps {:.3} deg: F {:+.3} % (estimated {:.3} %), p0 {:+.2} %",
            plain.angle_at_hole.to_degrees(),
            100.0 * force,
            100.0 * engine.force_error,
            100.0 * peak
        );
        // Seen: 0.11 % of the force where the estimate says 0.085 %; 0.22 % of the peak, 0.2 % of it the plain mesh's own.
        assert!(force.abs() < 2e-3 && peak.abs() < 5e-3);
    }
}
