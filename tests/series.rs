//! `series` against itself: more trial pressures and other nodes in eps change nothing to eight digits.

#[path = "common/greatest.rs"]
mod greatest;
#[path = "common/random.rs"]
mod random;

use greatest::greatest;
use jointsweep::mechanics::compliance::NODE_COUNT;
use jointsweep::mechanics::compliance::pressure_space::PressureSpace;
use jointsweep::mechanics::compliance::series::ConcentricBody;
use jointsweep::mechanics::contact::arc_state::ArcState;
use jointsweep::mechanics::contact::loading::{DimensionlessLoad, JointCurve, NoState};
use jointsweep::mechanics::contact::pressure::JointCompliance;
use jointsweep::mechanics::material::Idealization;
use random::Random;

/// A pin and a plate with the plate's modulus over the pin's, and delta/dR.
struct Joint {
    pin: ConcentricBody,
    plate: ConcentricBody,
    modulus: f64,
    indentation: f64,
}

fn draw(random: &mut Random) -> Joint {
    let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
    let core = random.linear(0.03, 0.8);
    let ratio = random.log(1.2, 50.0);
    let mut body = |fixed_radius: f64| {
        let poissons_ratio = random.linear(0.0, 0.49);
        ConcentricBody { fixed_radius, poissons_ratio, idealization }
    };
    let (pin, plate) = (body(core), body(ratio));
    Joint { pin, plate, modulus: random.log(0.01, 100.0), indentation: random.log(0.01, 100.0) }
}

fn state(space: &PressureSpace, joint: &Joint) -> ArcState {
    let compliance = |body: &ConcentricBody| {
        let highest = body.highest_mode();
        body.compliance(space, &space.moments(highest), highest)
    };
    let (pin, plate) = (compliance(&joint.pin), compliance(&joint.plate));
    let curve = JointCurve::new(JointCompliance::new(space, (&pin, 1.0), (&plate, joint.modulus))).unwrap();
    curve.states(1.0, &[DimensionlessLoad::Indentation(joint.indentation)])[0].unwrap()
}

/// The largest relative differences of force, stiffness and peak pressure, and of the half angle.
fn largest_differences(one: &PressureSpace, other: &PressureSpace) -> [f64; 4] {
    let mut random = Random::new(9);
    let mut all = [const { Vec::new() }; 4];
    for _ in 0..60 {
        let joint = draw(&mut random);
        let (a, b) = (state(one, &joint), state(other, &joint));
        let differences = [
            a.force / b.force - 1.0,
            a.tangent_stiffness / b.tangent_stiffness - 1.0,
            a.peak_pressure() / b.peak_pressure() - 1.0,
            a.arc.half_angle / b.arc.half_angle - 1.0,
        ];
        all.iter_mut().zip(differences).for_each(|(all, difference)| all.push(difference));
    }
    all.map(greatest)
}

#[test]
fn more_trial_pressures_change_nothing() {
    let [few, some, many] = [10, 16, 24].map(|terms| PressureSpace::new(terms, 2.4));
    let differences = largest_differences(&few, &many);
    println!("10 against 24 trial pressures: {differences:?}");
    // The force is second order in what is left out; the rest is first order. Seen: 8e-13 and 3.2e-6.
    assert!(differences[0] < 1e-12 && differences[1..].iter().all(|difference| *difference < 4e-6));
    let differences = largest_differences(&some, &many);
    println!("16 against 24 trial pressures: {differences:?}");
    // Seen: 7e-15 and 4.1e-7.
    assert!(differences[0] < 1e-13 && differences[1..].iter().all(|difference| *difference < 5.5e-7));
}

#[test]
fn other_nodes_change_nothing() {
    let differences = largest_differences(&PressureSpace::new(16, 2.4), &PressureSpace::new(16, 2.1));
    println!("other nodes in eps: {differences:?}");
    // Interpolation between 32 nodes; the half angle is the most sensitive. Seen: 2.9e-9 and 2.5e-8.
    assert!(differences[0] < 4e-9 && differences[1..].iter().all(|difference| *difference < 3.3e-8));
}

/// What the fewest trial pressures leave of bodies that are not thin (|ln r| > 0.15): of contacts up to 80 deg nothing that
/// 0.1 % would miss, of the widest a ten-thousandth of the force.
#[test]
fn six_trial_pressures_are_enough_but_for_wide_contacts() {
    let [few, many] = [6, 24].map(|terms| PressureSpace::new(terms, 2.4));
    let mut random = Random::new(4);
    let mut all = [const { [const { Vec::new() }; 4] }; 2];
    for _ in 0..300 {
        let mut joint = draw(&mut random);
        joint.pin.fixed_radius = (-random.log(0.15, 3.0)).exp();
        joint.plate.fixed_radius = random.log(0.15, 3.0).exp();
        let (found, expected) = (state(&few, &joint), state(&many, &joint));
        let errors = [
            found.force / expected.force - 1.0,
            found.tangent_stiffness / expected.tangent_stiffness - 1.0,
            found.peak_pressure() / expected.peak_pressure() - 1.0,
            (found.arc.half_angle - expected.arc.half_angle).to_degrees(),
        ];
        let is_wide = expected.arc.half_angle > 80.0_f64.to_radians();
        all[usize::from(is_wide)].iter_mut().zip(errors).for_each(|(all, error)| all.push(error));
    }
    let counts = all.each_ref().map(|of_width| of_width[0].len());
    let worst = all.map(|of_width| of_width.map(greatest));
    println!("{counts:?}, force, stiffness, peak pressure, half angle in deg: {worst:?}");
    assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
    // Seen: 1.7e-7, 8.1e-5, 1.9e-4, 0.040 and 1.2e-4, 2.7e-4, 6.6e-3, 2.3.
    for (worst, limits) in worst.iter().zip([[2.2e-7, 1e-4, 2.5e-4, 0.052], [1.5e-4, 3.5e-4, 8.6e-3, 3.0]]) {
        assert!(worst.iter().zip(limits).all(|(worst, limit)| *worst < limit), "{worst:?}");
    }
}

/// A compliance that is not one, at any of the nodes in eps, makes no curve.
#[test]
fn a_broken_compliance_has_no_curve() {
    let space = PressureSpace::new(10, 2.4);
    let joint = draw(&mut Random::new(1));
    let highest = joint.pin.highest_mode().max(joint.plate.highest_mode());
    let moments = space.moments(highest);
    let [pin, plate] = [joint.pin, joint.plate].map(|body| body.compliance(&space, &moments, highest));
    let end = |pin: &_| JointCurve::new(JointCompliance::new(&space, (pin, 1.0), (&plate, 1.0))).err();
    assert_eq!(end(&pin), None);
    let entries = pin.values.len() / NODE_COUNT;
    for node in [0, NODE_COUNT - 1] {
        for value in [f64::NAN, f64::INFINITY, -1e3] {
            let mut broken = pin.clone();
            broken.values[node * entries] = value;
            assert_eq!(end(&broken), Some(NoState::BrokenCompliance), "{value} at node {node}");
        }
    }
}
