//! Stresses of concentric bodies on meshes, beside their exact modes.

use jointsweep::internals::engine::joint_curve::JointCurve;
use jointsweep::internals::engine::joint_stresses::{angles, exact, greatest_change, on_meshes};
use jointsweep::internals::mechanics::body::{Side, annulus, cored_disc};
use jointsweep::internals::mechanics::compliance::concentric_body::ConcentricBody;
use jointsweep::internals::mechanics::contact::arc_pressure::ArcPressure;
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{JointDesign, Load, Part};
use jointsweep::internals::study::layers::{Layer, Layers};

fn part(side: Side, ratio: f64, layers: &[(f64, f64)]) -> Part {
    let material = |youngs_modulus| Material { youngs_modulus, poissons_ratio: 0.3 };
    let layers = layers.iter().map(|(thickness, modulus)| Layer::new(*thickness, material(*modulus)));
    Part {
        shape: if side == Side::Pin { &cored_disc::SHAPE } else { &annulus::SHAPE },
        parameters: [ratio, 0.0, 0.0],
        support: 0,
        material: material(2e5),
        yield_stress: None,
        layers: Layers::new(layers.collect()),
    }
}

/// Concentric bodies are not their own references, so that meshes tell of them, too: within the accuracy of the exact modes on every circle,
/// bare and lined, in narrow contacts and wide ones.
#[test]
fn meshes_tell_what_exact_modes_do() {
    let accuracy = 2e-3;
    let (mut compared, mut worst) = (0, 0.0_f64);
    let linings: [&[(f64, f64)]; 4] = [&[], &[(0.1, 3e3)], &[(0.02, 4e5), (0.15, 1e4)], &[(0.08, 2e5)]];
    for (lining, idealization) in linings.into_iter().zip(Idealization::ALL.into_iter().cycle()) {
        for (of_pin, of_plate, load) in [(0.2, 2.5, 2e-4), (0.4, 1.8, 0.02), (0.1, 8.0, 0.2)] {
            let joint = JointDesign {
                idealization,
                hole_radius: 1.0,
                radial_clearance: 0.005,
                thickness: 1.0,
                pin: part(Side::Pin, of_pin, lining),
                plate: part(Side::Plate, of_plate, lining),
            };
            let options = SolveOptions { accuracy: 1e-3, method: MethodChoice::Series };
            let curve = JointCurve::after(None, &joint, options).unwrap();
            for side in [Side::Pin, Side::Plate] {
                let body = joint.body(joint.part(side));
                let of_pressure = |half_angle: f64, pressure: &ArcPressure, _: f64| {
                    let angles = angles(41, half_angle, body.shape.end_angle);
                    let concentric = ConcentricBody::of(&body).unwrap();
                    let expected = exact(&concentric, pressure, half_angle, &angles).unwrap();
                    let found = on_meshes(&body, pressure, half_angle, &angles, accuracy).unwrap();
                    greatest_change(&expected, &found)
                };
                let error = curve.with_pressure(Load::Indentation(load), of_pressure).unwrap();
                println!("{side:?} {lining:?} {of_pin} {of_plate} {load}: {error:.1e}");
                worst = worst.max(error);
                compared += 1;
            }
        }
    }
    assert!(compared == 24 && worst < accuracy, "{compared}: {worst}");
}
