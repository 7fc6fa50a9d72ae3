//! The engine against converged finite-element references with the true geometry, and why the two differ.
//!
//! Source: GetFEM, CalculiX and scikit-fem, which agree within 1e-4 of the force. Plane stress, E = 200 GPa, nu = 0.3,
//! R2 = 100 mm, t = 1 mm, a half disc under a rigid plane (or a disc around a rigid core), an annulus fixed outside.
//!
//! The engine lets pin and plate meet at a common angle. `Pairing::TrueGeometry` below does not: each point of the pin
//! meets the point of the hole beneath it where the pin first touches, an angle of about (dR/R2) sin(phi) further down,
//! and is pressed along the hole's normal there. It meets every reference, so nothing else is left to explain.
//!
//! Run with `--nocapture` for the figures of docs/theory.md, section 10.

#[path = "common/plain_mesh.rs"]
mod plain_mesh;
#[path = "common/study_joint.rs"]
mod study_joint;

use jointsweep::engine::outcome::Response;
use jointsweep::mechanics::body::{block, cored_disc, half_disc};
use jointsweep::mechanics::material::{Idealization, Material};
use jointsweep::study::design::{JointDesign, Load, Part};
use plain_mesh::{Pairing, State, meshed};
use study_joint::{ACCURACY, HOLE_RADIUS, Solver, joint};

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

    fn engine(&self) -> Response {
        Solver::new(ACCURACY).solve(self.joint(), Load::Indentation(self.indentation))
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
        // Seen: -0.047 % at worst; the linearised gap alone makes -0.049 % (see below).
        assert!(deviation.abs() < 6e-4, "{deviation}");
        // The engine's angle is the mean of the hole's and the pin's: dR/(2 R2) sin(eps) wider than the hole's.
        let at_hole =
            angle.to_radians() - 0.5 * reference.radial_clearance / HOLE_RADIUS * angle.to_radians().sin();
        // 0.005 deg of the reference's last digit, 0.03 deg of the mesh; seen 0.03.
        assert!((at_hole.to_degrees() - reference.contact_half_angle).abs() < 0.04, "{angle}");
        if reference.force == 11266.1 {
            // p0 = 109.92 MPa, k_t = 1.447e5 N/mm: last digits, and what the linearised gap makes of p0 (0.08 %).
            assert!((peak_pressure.unwrap() / 109.92 - 1.0).abs() < 1e-3, "{peak_pressure:?}");
            assert!((tangent_stiffness / 1.447e5 - 1.0).abs() < 1e-3, "{tangent_stiffness}");
            published += 1;
        }
    }
    assert_eq!(published, 1, "one reference has a peak pressure and a stiffness");
}

#[test]
fn what_is_left_is_the_linearised_gap() {
    let mut published = 0;
    for reference in &REFERENCES {
        let common = reference.meshed(Pairing::CommonAngle);
        let exact = reference.meshed(Pairing::TrueGeometry);
        let displaced = reference.meshed(Pairing::Displaced);
        let linearised = common.force / exact.force - 1.0;
        let engine = reference.engine();
        println!(
            "ratio {}, dR {}, delta {}: true geometry {:.2} ({:+.4} % of the reference), hole's angle {:.3}, p0 {:.2}; \
             displaced {:+.4} %; common angle {:.2} ({:+.4} %), engine {:+.4} % from that",
            reference.outer_radius_ratio,
            reference.radial_clearance,
            reference.indentation,
            exact.force,
            100.0 * (exact.force / reference.force - 1.0),
            exact.angle_at_hole.to_degrees(),
            exact.peak_pressure,
            100.0 * (displaced.force / exact.force - 1.0),
            common.force,
            100.0 * linearised,
            100.0 * (engine.force / common.force - 1.0),
        );
        // Seen: 0.002 %.
        assert!((exact.force / reference.force - 1.0).abs() < UNCERTAINTY);
        // What small displacements leave open is of the size of the linearised gap's error; seen 0.04 and 0.05 %.
        assert!((displaced.force / exact.force - 1.0).abs() < 6e-4 && linearised.abs() < 6e-4);
        // Half of the reference's last digit, and the 0.02 deg by which node contact finds an edge; seen 0.015.
        assert!((exact.angle_at_hole.to_degrees() - reference.contact_half_angle).abs() < 0.02);
        // The engine solves the common angle's problem to the accuracy asked; seen 0.004 %.
        assert!((engine.force / common.force - 1.0).abs() < ACCURACY);
        if reference.force == 11266.1 {
            assert!((exact.peak_pressure / 109.92 - 1.0).abs() < UNCERTAINTY, "{}", exact.peak_pressure);
            published += 1;
        }
    }
    assert_eq!(published, 1, "one reference has a peak pressure");
}

/// At one delta/dR the common angle's force is proportional to dR, and the error it makes to (dR/R2)^2.
#[test]
fn the_linearised_gap_errs_in_proportion_to_the_clearance() {
    let errors = [0.02, 0.2, 2.0].map(|radial_clearance| {
        let scaled = Reference {
            radial_clearance,
            indentation: 0.5 * radial_clearance,
            force: f64::NAN,
            ..reference(2.0, 0.0, 0.0, 0.0, 0.0, 41.68)
        };
        let [common, exact] =
            [Pairing::CommonAngle, Pairing::TrueGeometry].map(|pairing| scaled.meshed(pairing).force);
        let error = 1.0 - common / exact;
        println!("dR {radial_clearance}: {:.4} %", 100.0 * error);
        error / (radial_clearance / HOLE_RADIUS)
    });
    // docs/theory.md: 0.23 dR/R2 at 42 deg and ratio 2. 3 % for the next order at dR/R2 = 2 %.
    for error in errors {
        assert!((error / 0.232 - 1.0).abs() < 0.03, "{errors:?}");
    }
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
    let strain = JointDesign { idealization: Idealization::PlaneStrain, ..dissimilar };
    let plate = Part { shape: &block::SHAPE, parameters: [2.0, 1.7, 2.4], support: 0, material: aluminium };
    let in_block = JointDesign { plate, ..joint(&half_disc::SHAPE, 0.0, 2.0, 0.2) };
    for (name, joint, accuracy) in [
        ("dissimilar", dissimilar, ACCURACY),
        ("plane strain", strain, ACCURACY),
        // The block's corners, where its held edge ends, slow the convergence.
        ("block", in_block, 1e-3),
    ] {
        for indentation in [0.02, 0.2] {
            let engine = Solver::new(accuracy).solve(joint, Load::Indentation(indentation));
            let angle = engine.contact_half_angle.unwrap();
            let plain = meshed(&joint, indentation, angle, Pairing::CommonAngle);
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
        let engine = Solver::new(2.5e-3).solve(joint, Load::Indentation(indentation));
        let angle = engine.contact_half_angle.unwrap();
        let plain = meshed(&joint, indentation, angle, Pairing::CommonAngle);
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
