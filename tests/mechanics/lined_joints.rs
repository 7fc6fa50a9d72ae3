//! Joints with layers against references that expand nothing and know no fields of layers (tests/common/true_outlines.rs, stepped_ring.rs).

use crate::common::length::count;
use crate::common::random::Random;
use crate::common::ring_design::ring_design;
use crate::common::stepped_ring::{Beyond, Ring};
use crate::common::true_outlines::{TrueState, true_state};
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::Response;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, Load};

struct Lined {
    pin: Ring,
    plate: Ring,
    clearance: f64,
    half_angle: f64,
    state: TrueState,
}

/// A ring with one to three layers of 0.03 or 0.05 to 0.2, the thinner ones at the contact.
fn ring(random: &mut Random, outward: bool, idealization: Idealization) -> Ring {
    let mut radius_ratio = 1.0;
    let count = 1 + (random.unit() * 3.0) as usize;
    let beyond: Vec<Beyond> = (0..count)
        .map(|layer| {
            let thickness = random.log(if layer == 0 { 0.03 } else { 0.05 }, 0.2);
            radius_ratio *= if outward { 1.0 + thickness } else { 1.0 - thickness };
            Beyond {
                radius_ratio,
                youngs_modulus: 1e5 * random.log(0.03, 30.0),
                poissons_ratio: random.linear(0.0, 0.45),
            }
        })
        .collect();
    let wall = random.linear(0.2, 1.0);
    Ring {
        fixed_radius_ratio: if outward {
            radius_ratio * (1.0 + wall)
        } else {
            radius_ratio * (1.0 - 0.8 * wall)
        },
        youngs_modulus: 1e5 * random.log(0.03, 30.0),
        poissons_ratio: random.linear(0.0, 0.45),
        idealization,
        beyond: beyond.leak(),
    }
}

/// A joint of lined parts; `None` where its indentation is not within 0.05 to 3 clearances.
fn draw(random: &mut Random, clearance: f64) -> Option<Lined> {
    let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
    let pin = ring(random, false, idealization);
    let plate = ring(random, true, idealization);
    let half_angle = random.linear(8.0, 80.0).to_radians();
    let state = true_state([pin, plate], clearance, half_angle);
    let share = state.indentation / clearance;
    (0.05..3.0).contains(&share).then_some(Lined { pin, plate, clearance, half_angle, state })
}

fn joint(lined: &Lined) -> DesignCase {
    let joint = ring_design(&[lined.pin, lined.plate], lined.clearance);
    DesignCase { index: 0, joint, steps: vec![Load::Indentation(lined.state.indentation)].into() }
}

fn solved(lined: &Lined, method: MethodChoice, accuracy: f64) -> Response {
    let options = SolveOptions { accuracy, method };
    let outcome = Ladder::new(options).solve(&[joint(lined)]).remove(0);
    outcome.steps[0].response.unwrap_or_else(|| panic!("{}", outcome.steps[0].status))
}

/// Clearance ratios with what force and half angle, deg, are held to: as bare joints.
const LIMITS: [(f64, f64, f64); 3] = [(1e-6, 3e-8, 0.002), (0.01, 1e-5, 0.003), (0.05, 3e-4, 0.03)];

#[test]
fn lined_joints_are_those_of_the_true_outlines() {
    let mut random = Random::new(180);
    let (mut compared, mut bounded) = (0, 0);
    for (clearance, of_force, of_angle) in LIMITS {
        let mut worst = [0.0_f64; 2];
        for lined in (0..count(12, 24)).filter_map(|_| draw(&mut random, clearance)) {
            let found = solved(&lined, MethodChoice::Series, 1e-7);
            let off = (found.force / lined.state.force - 1.0).abs();
            let angle = (found.contact_half_angle.unwrap() - lined.half_angle).to_degrees().abs();
            assert!(
                off < of_force && angle < of_angle,
                "{clearance}: {off:e}, {angle} deg, {:?}",
                joint(&lined)
            );
            worst = [worst[0].max(off), worst[1].max(angle)];
            let loose = solved(&lined, MethodChoice::Auto, 1e-3);
            let true_error = (loose.force / lined.state.force - 1.0).abs();
            assert!(true_error < 1e-3, "{clearance}: {true_error:e}");
            compared += 1;
            bounded += usize::from(loose.force_error >= true_error);
        }
        println!("dR/R2 {clearance}: force off by {:.1e}, half angle by {:.4} deg", worst[0], worst[1]);
    }
    println!("{bounded} of {compared} bounded by force_error");
    assert!(compared > count(15, 30) as usize && 100 * bounded >= 95 * compared, "{bounded} of {compared}");
}
