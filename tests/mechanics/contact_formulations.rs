//! Penalty and augmented Lagrangian contact against the exact active set, on the same condensed joint.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::greatest::difference;
use crate::common::meshes::{ELEMENTS, order};
use crate::common::rings::{MeshedBody, body};
use jointsweep::internals::mechanics::contact::node_contact::active_set::{
    ActiveSetOutcome, NodalContact, solve_nodal_contact,
};
use jointsweep::internals::mechanics::contact::node_contact::augmented_lagrangian::{
    AugmentedContact, AugmentedOutcome, AugmentedSettings, solve_augmented_lagrangian,
};
use jointsweep::internals::mechanics::contact::node_contact::penalty::{penetration, solve_penalty, springs};
use jointsweep::internals::mechanics::contact::node_contact::ring_joint::RingJoint;
use jointsweep::internals::mechanics::contact_grading::contact_grading;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::material::Idealization;

/// Of two equal bodies with E' = 1.
const EFFECTIVE_MODULUS: f64 = 0.5;
const LIMIT: usize = 50;

/// The half disc in an annulus of ratio 2, plane stress, E = 1; ring spacing h = max(5 deg/q, phi/q).
fn joint(element: ElementKind, q: f64) -> RingJoint {
    let half = |name, ratios: &[f64], end| {
        let body = body(name, ratios, Idealization::PlaneStress, 0.3);
        MeshedBody::new(&body, &contact_grading(element, 5f64.to_radians(), q, end, 1.0))
    };
    let (pin, plate) = (half("rigid-midplane", &[], FRAC_PI_2), half("annulus", &[2.0], PI));
    let compliances = [&pin, &plate].map(MeshedBody::condense);
    RingJoint::new(pin.ring(&compliances[0], 1.0), plate.ring(&compliances[1], 1.0), 0.0).unwrap()
}

fn exact(joint: &RingJoint, gaps: &[f64]) -> NodalContact {
    let contact = solve_nodal_contact(&joint.compliance, gaps, LIMIT);
    assert_eq!(contact.outcome, ActiveSetOutcome::Settled);
    contact
}

fn by_penalty(joint: &RingJoint, gaps: &[f64], factor: f64) -> NodalContact {
    solve_penalty(&joint.compliance, gaps, &springs(joint, factor, EFFECTIVE_MODULUS), LIMIT)
}

fn augmented(joint: &RingJoint, gaps: &[f64], factor: f64, tolerance: f64) -> AugmentedContact {
    let settings = AugmentedSettings { tolerance, update_limit: 2000, iteration_limit: LIMIT };
    let springs = springs(joint, factor, EFFECTIVE_MODULUS);
    solve_augmented_lagrangian(&joint.compliance, gaps, &springs, &settings)
}

/// Goal: force and penetration of a penalty fall with its first power, to the exact solution.
#[test]
fn a_penalty_is_of_first_order() {
    for element in ELEMENTS {
        let joint = joint(element, 4.0);
        for indentation in [0.3, 1.0, 5.0] {
            let gaps = joint.initial_gaps(1.0, indentation);
            let force = joint.force(&exact(&joint, &gaps).forces);
            let found = [1e1, 1e2, 1e3, 1e4, 1e5].map(|factor| {
                let contact = by_penalty(&joint, &gaps, factor);
                assert_eq!(contact.outcome, ActiveSetOutcome::Settled);
                (1.0 - joint.force(&contact.forces) / force, penetration(&contact.gaps) / indentation)
            });
            // Too soft, always.
            assert!(found.iter().all(|(error, _)| *error > 0.0));
            for pair in found[1..].windows(2) {
                // A factor of ten is log2(10) halvings.
                let by_decade = |coarse: f64, fine: f64| order(coarse, fine) / 10f64.log2();
                let slopes = [by_decade(pair[0].0, pair[1].0), by_decade(pair[0].1, pair[1].1)];
                println!("{element:?} {indentation}: error {:.1e}, slopes {slopes:.3?}", pair[1].0);
                // Measured 0.98 to 1.00 from a factor of 100 on.
                assert!(slopes.iter().all(|slope| (slope - 1.0).abs() < 0.05), "{slopes:?}");
            }
        }
    }
}

/// Goal: f = k max(0, -g) at every node, and g = g0 + C f, whatever the factor.
#[test]
fn springs_push_by_what_they_are_pressed() {
    let joint = joint(ElementKind::Quad8, 3.0);
    let gaps = joint.initial_gaps(1.0, 2.0);
    let count = gaps.len();
    for factor in [1e-2, 1.0, 1e3] {
        let springs = springs(&joint, factor, EFFECTIVE_MODULUS);
        let contact = by_penalty(&joint, &gaps, factor);
        assert_eq!(contact.outcome, ActiveSetOutcome::Settled);
        for node in 0..count {
            let pressed = (-contact.gaps[node]).max(0.0);
            assert!((springs[node] * contact.forces[node] - pressed).abs() < 1e-12, "{factor} {node}");
            let row = &joint.compliance[node * count..(node + 1) * count];
            let moved: f64 = row.iter().zip(&contact.forces).map(|(c, f)| c * f).sum();
            assert!((contact.gaps[node] - gaps[node] - moved).abs() < 1e-12);
        }
    }
}

/// Goal: an augmented Lagrangian leaves no gap above its tolerance and meets the exact force by as much; the stiffer
/// its springs the fewer its updates.
#[test]
fn an_augmented_lagrangian_meets_the_exact_force() {
    for element in ELEMENTS {
        let joint = joint(element, 4.0);
        for indentation in [0.3, 5.0] {
            let gaps = joint.initial_gaps(1.0, indentation);
            let exact = exact(&joint, &gaps);
            let force = joint.force(&exact.forces);
            let mut updates = Vec::new();
            for tolerance in [1e-1, 1e-2, 1e-4, 1e-6, 1e-9] {
                let contact = augmented(&joint, &gaps, 1.0, tolerance * indentation);
                assert_eq!(contact.outcome, AugmentedOutcome::Converged, "{tolerance}");
                assert!(contact.violation <= tolerance * indentation);
                let error = (joint.force(&contact.nodal.forces) / force - 1.0).abs();
                println!(
                    "{element:?} {indentation} {tolerance:.0e}: {error:.1e}, {} updates",
                    contact.updates
                );
                // The greatest gap is that of a node or two; the force feels the mean.
                assert!(error < 2.0 * tolerance, "{tolerance}: {error}");
                updates.push(contact.updates);
            }
            assert!(updates.is_sorted() && updates[4] > updates[1], "{updates:?}");
            let stiff = augmented(&joint, &gaps, 100.0, 1e-9 * indentation);
            assert!(stiff.updates <= updates[4] / 3, "{} {updates:?}", stiff.updates);
            assert_eq!(stiff.nodal.active, exact.active);
            assert!(difference(&stiff.nodal.forces, &exact.forces) < 1e-6);
        }
    }
}

/// Goal: k_t is the slope of the force while the active nodes stay, exact and by penalty.
#[test]
fn tangent_stiffness_is_the_slope_of_the_force() {
    let joint = joint(ElementKind::Quad8, 4.0);
    let springs = springs(&joint, 30.0, EFFECTIVE_MODULUS);
    let step = 1e-6;
    for springs in [None, Some(&springs[..])] {
        let solve = |indentation: f64| {
            let gaps = joint.initial_gaps(1.0, indentation);
            match springs {
                None => solve_nodal_contact(&joint.compliance, &gaps, LIMIT),
                Some(springs) => solve_penalty(&joint.compliance, &gaps, springs, LIMIT),
            }
        };
        let [low, middle, high] = [1.0 - step, 1.0, 1.0 + step].map(solve);
        assert!(low.active == high.active, "no node switches in this step");
        let slope = (joint.force(&high.forces) - joint.force(&low.forces)) / (2.0 * step);
        let stiffness = joint.tangent_stiffness(&middle.active, springs).unwrap();
        // Rounding over the step; F is linear while the nodes stay.
        assert!((stiffness / slope - 1.0).abs() < 1e-8, "{stiffness} {slope}");
    }
}

/// Goal: lengths add up to the ring, a uniform pressure's forces give that pressure back, and both elements come to one
/// peak pressure.
#[test]
fn peak_pressure_is_that_of_the_forces() {
    let peaks = ELEMENTS.map(|element| {
        let joint = joint(element, 4.0);
        let lengths = joint.lengths();
        let end = joint.angles[joint.angles.len() - 1];
        assert!((lengths.iter().sum::<f64>() - end).abs() < 1e-13);
        let all = vec![true; lengths.len()];
        let uniform: Vec<f64> = lengths.iter().map(|length| 3.0 * length).collect();
        assert!((joint.peak_pressure(&all, &uniform).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(joint.peak_pressure(&vec![false; lengths.len()], &uniform), None);

        let gaps = joint.initial_gaps(1.0, 1.0);
        let contact = exact(&joint, &gaps);
        let peak = joint.peak_pressure(&contact.active, &contact.forces).unwrap();
        println!("{element:?}: peak {peak:.6}, force over length {:.6}", contact.forces[0] / lengths[0]);
        peak
    });
    // Measured 5e-5: q = 4.
    assert!((peaks[0] / peaks[1] - 1.0).abs() < 3e-4, "{peaks:?}");
}

/// Goal: what does not settle, or is no contact law, ends with an outcome; the widest range of penalties does settle.
#[test]
fn every_input_has_an_outcome() {
    // The cycle of tests/mechanics/active_set.rs: a penalty stiff enough keeps to it, a soft one breaks it.
    let cycling = [12.0, 10.0, -6.0, 10.0, 9.0, -6.0, -6.0, -6.0, 5.0];
    let gaps = [-1.0, -2.0, 2.0];
    let penalty = |spring: f64, limit| solve_penalty(&cycling, &gaps, &[spring; 3], limit).outcome;
    assert_eq!(penalty(1e-12, LIMIT), ActiveSetOutcome::Cycled);
    assert_eq!(penalty(1e-12, 1), ActiveSetOutcome::IterationLimit);
    assert_eq!(penalty(1e2, LIMIT), ActiveSetOutcome::Settled);
    let settings = AugmentedSettings { tolerance: 1e-6, update_limit: 20, iteration_limit: LIMIT };
    let augmented_end = |compliance: &[f64], spring: f64, settings: &AugmentedSettings| {
        solve_augmented_lagrangian(compliance, &gaps, &[spring; 3], settings).outcome
    };
    assert_eq!(augmented_end(&cycling, 1e-12, &settings), AugmentedOutcome::Inner(ActiveSetOutcome::Cycled));
    // Springs make a rigid motion stable, once; as they give way it is singular again.
    let singular = [1.0; 9];
    assert_eq!(penalty_of(&singular, 0.5), ActiveSetOutcome::Settled);
    assert_eq!(penalty_of(&singular, 0.0), ActiveSetOutcome::Singular);
    assert_eq!(penalty_of(&[f64::NAN; 9], 0.5), ActiveSetOutcome::Singular);
    for spring in [f64::NAN, f64::INFINITY, -1.0] {
        assert_eq!(penalty_of(&singular, spring), ActiveSetOutcome::Singular, "{spring}");
        let end = augmented_end(&singular, spring, &settings);
        assert_eq!(end, AugmentedOutcome::Inner(ActiveSetOutcome::Singular), "{spring}");
    }
    // Springs that pull are none, even where bodies are softer.
    let settled = [2.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 2.0];
    assert_eq!(penalty_of(&settled, 1.0), ActiveSetOutcome::Settled);
    assert_eq!(penalty_of(&settled, -1.0), ActiveSetOutcome::Singular);
    // No tolerance can be met that is none.
    for tolerance in [-1.0, f64::NAN] {
        let settings = AugmentedSettings { tolerance, ..settings };
        assert_eq!(augmented_end(&settled, 1.0, &settings), AugmentedOutcome::UpdateLimit);
    }

    let joint = joint(ElementKind::Quad8, 3.0);
    let pressed = joint.initial_gaps(1.0, 1.0);
    let exact = exact(&joint, &pressed);
    for factor in [1e-12, 1e-3, 1e12, 1e300] {
        let contact = by_penalty(&joint, &pressed, factor);
        assert_eq!(contact.outcome, ActiveSetOutcome::Settled, "{factor}");
    }
    let stiffest = by_penalty(&joint, &pressed, 1e12);
    assert!((joint.force(&stiffest.forces) / joint.force(&exact.forces) - 1.0).abs() < 1e-10);
    for factor in [0.0, -1.0, f64::NAN] {
        assert_eq!(by_penalty(&joint, &pressed, factor).outcome, ActiveSetOutcome::Singular, "{factor}");
    }
    // No contact: before first touch, with a clearance.
    let apart = joint.initial_gaps(1.0, -0.5);
    let contact = by_penalty(&joint, &apart, 10.0);
    assert_eq!((contact.outcome, joint.force(&contact.forces)), (ActiveSetOutcome::Settled, 0.0));
    let contact = augmented(&joint, &apart, 10.0, 1e-6);
    assert_eq!((contact.outcome, joint.force(&contact.nodal.forces)), (AugmentedOutcome::Converged, 0.0));
    assert_eq!(joint.tangent_stiffness(&contact.nodal.active, None), Some(0.0));
    assert_eq!(joint.contact_half_angle(&contact.nodal.active), 0.0);
}

fn penalty_of(compliance: &[f64], spring: f64) -> ActiveSetOutcome {
    solve_penalty(compliance, &[-1.0, -2.0, -1.5], &[spring; 3], LIMIT).outcome
}
