//! Contact node by node: against the same problem without condensation, against converged references, and when it
//! does not settle.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::greatest::{difference, greatest};
use crate::common::meshes::{ELEMENTS, order};
use crate::common::ring_loads::concentric_grading;
use crate::common::rings::{MeshedBody, body};
use faer::Mat;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use jointsweep::internals::mechanics::contact::node_contact::active_set::{
    ActiveSetOutcome, NodalContact, solve_nodal_contact,
};
use jointsweep::internals::mechanics::contact::node_contact::ring_joint::{
    RingJoint, RingsDiffer, normal_compliance,
};
use jointsweep::internals::mechanics::contact_grading::contact_grading;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::element::stiffness::Elasticity;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::mesh::SUPPORTED;

/// A meshed body with its Young's modulus, and +1 for the plate, which a contact force pushes along the normal
/// n = (sin phi, -cos phi), -1 for the pin.
struct Half {
    meshed: MeshedBody,
    modulus: f64,
    side: f64,
}

/// Contact of a joint per unit thickness, in the units of its lengths and moduli.
struct RingContact {
    angles: Vec<f64>,
    /// Of the half that is modelled: the node at the load line carries half of what it does in the whole joint.
    nodal: NodalContact,
    /// Of both halves.
    force: f64,
    contact_half_angle: f64,
}

/// Presses a pin into a plate by an indentation after first touch.
fn press(pin: &Half, plate: &Half, clearance: f64, indentation: f64) -> RingContact {
    let [pin_compliance, plate_compliance] = [pin, plate].map(|half| half.meshed.condense());
    let pin = pin.meshed.ring(&pin_compliance, pin.modulus);
    let plate = plate.meshed.ring(&plate_compliance, plate.modulus);
    let joint = RingJoint::new(pin, plate, 0.0).unwrap();
    let nodal = solve_nodal_contact(&joint.compliance, &joint.initial_gaps(clearance, indentation), 50);
    assert_eq!(nodal.outcome, ActiveSetOutcome::Settled);
    let (force, contact_half_angle) = (joint.force(&nodal.forces), joint.contact_half_angle(&nodal.active));
    RingContact { angles: joint.angles, nodal, force, contact_half_angle }
}

/// The same joint without condensation: all unknowns of both bodies and a Lagrange multiplier for every closed node,
///
/// ```text
///   [ E1 K1    0      N1^T ] [u1]   [ 0  ]        gap = g0 + n.u2 - n.u1, so N1 = -n, N2 = n;
///   [   0    E2 K2    N2^T ] [u2] = [ 0  ]        forces f = -lambda
///   [  N1     N2       0   ] [l ]   [-g0 ]
/// ```
struct Full {
    /// Of all dofs of each body.
    displacement: [Vec<f64>; 2],
    forces: Vec<f64>,
    gaps: Vec<f64>,
}

fn solve_full(halves: [&Half; 2], initial_gaps: &[f64], angles: &[f64]) -> Full {
    let starts = [0, halves[0].meshed.topology.unknown_count];
    let multipliers = starts[1] + halves[1].meshed.topology.unknown_count;
    let mut stiffness = Vec::new();
    for (half, start) in halves.into_iter().zip(starts) {
        let values = half.meshed.stiffness_values();
        let matrix = half.meshed.assembly.matrix(&values);
        for row in 0..matrix.row_count() {
            stiffness.extend(
                matrix
                    .row(row)
                    .map(|(column, value)| Triplet::new(start + row, start + column, half.modulus * value)),
            );
        }
    }
    // Signed shares of the unknowns in the gap of each node.
    let shares: Vec<Vec<(usize, f64)>> = (0..angles.len())
        .map(|i| {
            let mut shares = Vec::new();
            for (half, start) in halves.into_iter().zip(starts) {
                let node = half.meshed.topology.ring_nodes[i] as usize;
                for (component, normal) in [angles[i].sin(), -angles[i].cos()].into_iter().enumerate() {
                    let unknown = half.meshed.topology.unknowns[2 * node + component];
                    if unknown != SUPPORTED {
                        shares.push((start + unknown as usize, half.side * normal));
                    }
                }
            }
            shares
        })
        .collect();
    let mut active: Vec<usize> = (0..angles.len()).filter(|&i| initial_gaps[i] <= 0.0).collect();
    for _ in 0..50 {
        let size = multipliers + active.len();
        let mut entries = stiffness.clone();
        let mut column = Mat::zeros(size, 1);
        for (place, &i) in active.iter().enumerate() {
            column[(multipliers + place, 0)] = -initial_gaps[i];
            for &(unknown, share) in &shares[i] {
                entries.push(Triplet::new(multipliers + place, unknown, share));
                entries.push(Triplet::new(unknown, multipliers + place, share));
            }
        }
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &entries).unwrap();
        let solution = matrix.sp_lu().unwrap().solve(&column);
        let mut forces = vec![0.0; angles.len()];
        active.iter().enumerate().for_each(|(place, &i)| forces[i] = -solution[(multipliers + place, 0)]);
        let opening =
            |i: usize| shares[i].iter().map(|&(unknown, share)| share * solution[(unknown, 0)]).sum::<f64>();
        let gaps: Vec<f64> = (0..angles.len()).map(|i| initial_gaps[i] + opening(i)).collect();
        let next: Vec<usize> = (0..angles.len())
            .filter(|i| if active.contains(i) { forces[*i] > 0.0 } else { gaps[*i] < -1e-13 })
            .collect();
        if next == active {
            let displacement = [0, 1].map(|body| {
                let at = |&unknown: &u32| match unknown {
                    SUPPORTED => 0.0,
                    unknown => solution[(starts[body] + unknown as usize, 0)],
                };
                halves[body].meshed.topology.unknowns.iter().map(at).collect()
            });
            return Full { displacement, forces, gaps };
        }
        active = next;
    }
    panic!("the full problem does not settle");
}

/// Goal: forces and gaps of the condensed and of the full problem agree, and each body is in equilibrium.
/// Mesh: graded, q = 3; a pin half as stiff as the plate; indentation from a touch to nearly half the ring.
#[test]
fn condensed_equals_full() {
    let mut worst = [0.0f64; 3];
    for element in ELEMENTS {
        for (idealization, pin_name, ratios, end) in [
            (Idealization::PlaneStress, "rigid-midplane", vec![], FRAC_PI_2),
            (Idealization::PlaneStrain, "rigid-core", vec![0.2], PI),
        ] {
            let half = |name, ratios: &[f64], end, depth, nu, modulus, side| {
                let body = body(name, ratios, idealization, nu);
                let grading = contact_grading(element, 5f64.to_radians(), 3.0, end, depth);
                Half { meshed: MeshedBody::new(&body, &grading), modulus, side }
            };
            let pin = half(pin_name, &ratios, end, 1.0 - ratios.first().unwrap_or(&0.0), 0.2, 0.5, -1.0);
            let plate = half("annulus", &[2.0], PI, 1.0, 0.35, 1.0, 1.0);
            for indentation in [0.02, 1.0, 30.0] {
                let contact = press(&pin, &plate, 1.0, indentation);
                let gap = |angle: &f64| 1.0 - (1.0 + indentation) * angle.cos();
                let initial_gaps: Vec<f64> = contact.angles.iter().map(gap).collect();
                let full = solve_full([&pin, &plate], &initial_gaps, &contact.angles);
                let force_error = difference(&contact.nodal.forces, &full.forces);
                let gap_error = difference(&contact.nodal.gaps, &full.gaps);
                assert!(full.forces.iter().filter(|force| **force > 0.0).count() >= 2);

                // Supports along the load line push back with half the force of the joint, upwards under the plate.
                let mut balance_error: f64 = 0.0;
                for (half, displacement) in [&pin, &plate].into_iter().zip(&full.displacement) {
                    let meshed = &half.meshed;
                    let force = meshed
                        .assembly
                        .internal_force(&meshed.elasticity, &meshed.coordinates, displacement)
                        .unwrap();
                    let supports = (0..force.len() / 2).map(|node| 2 * node + 1);
                    let reaction: f64 = supports
                        .filter(|&dof| meshed.topology.unknowns[dof] == SUPPORTED)
                        .map(|dof| half.modulus * force[dof])
                        .sum();
                    let balance = half.side * reaction / (0.5 * contact.force) - 1.0;
                    balance_error = greatest([balance_error, balance]);
                }
                for (worst, error) in worst.iter_mut().zip([force_error, gap_error, balance_error]) {
                    // Rounding times the condition of K, 1e4: measured below 1e-12.
                    assert!(error < 1e-10, "{element:?} {pin_name} {indentation}: {error:e}");
                    *worst = worst.max(error);
                }
            }
        }
    }
    println!(
        "condensed against full: forces {:.0e}, gaps {:.0e}; equilibrium {:.0e}",
        worst[0], worst[1], worst[2]
    );
}

/// Goal: the force of converged solutions (GetFEM, CalculiX and scikit-fem agree on them within 1e-4).
/// Mesh: Q8, q = 8 from 8 degrees up; plane stress, E = 200 GPa, nu = 0.3, R2 = 100 mm, 1 mm thick.
/// Columns: outer ratio, clearance mm, indentation mm, force N, contact half-angle deg.
#[test]
fn forces_match_converged_references() {
    const REFERENCES: [(f64, f64, f64, f64, f64); 6] = [
        (3.0, 5.0, 0.2, 11417.8, 9.42),
        (3.0, 0.2, 0.02, 1418.31, 16.65),
        (3.0, 0.2, 0.1, 11266.1, 40.18),
        (3.0, 0.2, 0.2, 26919.8, 53.29),
        (2.0, 0.2, 0.1, 13776.6, 41.64),
        (10.0, 0.1, 0.1, 8212.4, 47.02),
    ];
    for (ratio, clearance, indentation, force, half_angle) in REFERENCES {
        let half = |name, ratios: &[f64], end, depth, side| {
            let body = body(name, ratios, Idealization::PlaneStress, 0.3);
            let grading = contact_grading(ElementKind::Quad8, 8f64.to_radians(), 8.0, end, depth);
            Half { meshed: MeshedBody::new(&body, &grading), modulus: 200e3, side }
        };
        let pin = match ratio {
            10.0 => half("rigid-core", &[0.1], PI, 0.9, -1.0),
            _ => half("rigid-midplane", &[], FRAC_PI_2, 1.0, -1.0),
        };
        let plate = half("annulus", &[ratio], PI, ratio - 1.0, 1.0);
        let contact = press(&pin, &plate, clearance, indentation);
        let error = contact.force / force - 1.0;
        let angle_error = contact.contact_half_angle.to_degrees() - half_angle;
        println!(
            "ratio {ratio}, dR {clearance}, delta {indentation}: force {:.1} ({:+.3} %), half-angle {:+.2} deg",
            contact.force,
            100.0 * error,
            angle_error
        );
        // Measured within 0.05 %; nodes that switch cost less than h^2 = 1/16^2.
        assert!(error.abs() < 7e-4, "{error}");
        // Nodes are spaced by 1/16 of their angle; measured within 0.3 of a spacing.
        assert!(angle_error.abs() < 0.4 * half_angle / 16.0, "{angle_error}");
    }
}

/// Goal: on a plate that is not round, both elements converge to one force.
/// Mesh: Q4 with q = 16, Q8 with q = 4 and 8; a block 2.1 wide, 1.6 deep and 5.2 high, on its base.
#[test]
fn both_elements_agree_on_a_block() {
    let force = |element, q| {
        let half = |name, ratios: &[f64], end, depth, side| {
            let body = body(name, ratios, Idealization::PlaneStrain, 0.3);
            let grading = contact_grading(element, 8f64.to_radians(), q, end, depth);
            Half { meshed: MeshedBody::new(&body, &grading), modulus: 1.0, side }
        };
        let pin = half("rigid-midplane", &[], FRAC_PI_2, 1.0, -1.0);
        press(&pin, &half("block", &[2.1, 1.6, 5.2], PI, 4.2, 1.0), 1.0, 1.0).force
    };
    let [fine, coarse, linear] =
        [(ElementKind::Quad8, 8.0), (ElementKind::Quad8, 4.0), (ElementKind::Quad4, 16.0)]
            .map(|(element, q)| force(element, q));
    println!(
        "block: force {fine:.5}, {:+.3} % with q = 4, {:+.3} % by Q4",
        100.0 * (coarse / fine - 1.0),
        100.0 * (linear / fine - 1.0)
    );
    // Measured 0.08 % and 0.05 %.
    assert!((coarse / fine - 1.0).abs() < 1e-3);
    assert!((linear / fine - 1.0).abs() < 1e-3);
}

/// Goal: a uniform interference, pin and hole pressed together all around, gives Lame's pressure and no force.
/// Mesh: 24 and 48 equal ring elements; a pin around a core of 0.1, twice as stiff as the annulus of ratio 3.
/// Exact: p = interference/(u_pin/E1 + u_plate/E2), u as in tests/mechanics/lame.rs.
#[test]
fn interference_gives_lames_pressure() {
    const INTERFERENCE: f64 = 1e-3;
    let ring_displacement = |half: &Half, far_radius: f64| {
        let Elasticity { direct, cross, .. } = half.meshed.elasticity;
        let square = far_radius * far_radius;
        ((square - 1.0) / (direct + cross + square * (direct - cross))).abs() / half.modulus
    };
    for (element, expected_order) in [(ElementKind::Quad4, 2.0), (ElementKind::Quad8, 4.0)] {
        for idealization in Idealization::ALL {
            let errors = [2, 4].map(|fineness| {
                let half = |name, ratio, modulus, side| {
                    let body = body(name, &[ratio], idealization, 0.3);
                    let grading = concentric_grading(element, ratio, 12 * fineness, 4 * fineness);
                    Half { meshed: MeshedBody::new(&body, &grading), modulus, side }
                };
                let (pin, plate) = (half("rigid-core", 0.1, 2.0, -1.0), half("annulus", 3.0, 1.0, 1.0));
                let compliances = [&pin, &plate].map(|half| {
                    let topology = &half.meshed.topology;
                    let values = normal_compliance(&half.meshed.condense(), topology, &topology.ring_angles);
                    values.into_iter().map(|value| value / half.modulus).collect::<Vec<f64>>()
                });
                let compliance: Vec<f64> =
                    compliances[0].iter().zip(&compliances[1]).map(|(a, b)| a + b).collect();
                let count = plate.meshed.topology.ring_nodes.len();
                let contact = solve_nodal_contact(&compliance, &vec![-INTERFERENCE; count], 50);
                assert_eq!(contact.outcome, ActiveSetOutcome::Settled);
                assert!(contact.active.iter().all(|&active| active));
                let pressure = INTERFERENCE / (ring_displacement(&pin, 0.1) + ring_displacement(&plate, 3.0));
                let angles = &plate.meshed.topology.ring_angles;
                let total: f64 = contact.forces.iter().sum();
                let along_load: f64 =
                    contact.forces.iter().zip(angles).map(|(f, angle)| f * angle.cos()).sum();
                // Rounding: measured 1e-15.
                assert!(along_load.abs() < 1e-13 * total, "{along_load:e}");
                (total / (pressure * PI) - 1.0).abs()
            });
            let by_pressure = order(errors[0], errors[1]);
            println!(
                "{element:?} {idealization:?}: pressure within {:.1e}, order {by_pressure:.2}",
                errors[1]
            );
            // Measured 2.00 and 4.00; 2.5e-4 and 3.8e-8.
            assert!((by_pressure - expected_order).abs() < 0.1);
            assert!(errors[1] < if element == ElementKind::Quad4 { 5e-4 } else { 1e-7 });
        }
    }
}

/// Goal: a neat fit is linear in the indentation, and nothing happens before first touch.
#[test]
fn a_neat_fit_is_linear() {
    let half = |name, ratios: &[f64], end, side| {
        let body = body(name, ratios, Idealization::PlaneStress, 0.3);
        let grading = contact_grading(ElementKind::Quad8, 20f64.to_radians(), 3.0, end, 1.0);
        Half { meshed: MeshedBody::new(&body, &grading), modulus: 1.0, side }
    };
    let (pin, plate) = (half("rigid-midplane", &[], FRAC_PI_2, -1.0), half("annulus", &[2.0], PI, 1.0));
    let [once, twice] = [1e-3, 2e-3].map(|indentation| press(&pin, &plate, 0.0, indentation));
    assert_eq!(once.nodal.active, twice.nodal.active);
    assert!((twice.force / once.force - 2.0).abs() < 1e-12);
    let apart = press(&pin, &plate, 1e-3, 0.0);
    assert_eq!((apart.force, apart.contact_half_angle), (0.0, 0.0));
}

/// Goal: an iteration that does not settle ends with an outcome that says how.
#[test]
fn what_does_not_settle_is_reported() {
    let end = |compliance: &[f64], gaps: &[f64], limit| solve_nodal_contact(compliance, gaps, limit).outcome;
    // Positive definite, and yet the sets {0, 1}, {1, 2}, {} follow each other for ever. (Found by a random search.)
    let cycling = [12.0, 10.0, -6.0, 10.0, 9.0, -6.0, -6.0, -6.0, 5.0];
    assert_eq!(end(&cycling, &[-1.0, -2.0, 2.0], 50), ActiveSetOutcome::Cycled);
    assert_eq!(end(&cycling, &[-1.0, -2.0, 2.0], 1), ActiveSetOutcome::IterationLimit);
    assert_eq!(end(&[1.0, 2.0, 2.0, 1.0], &[-1.0, -1.0], 50), ActiveSetOutcome::Singular);
    assert_eq!(end(&[1.0, f64::NAN, f64::NAN, 1.0], &[-1.0, -1.0], 50), ActiveSetOutcome::Singular);
    assert_eq!(end(&[2.0, 1.0, 1.0, 2.0], &[-1.0, -1.0], 50), ActiveSetOutcome::Settled);
}

/// Goal: rings that do not match are refused.
#[test]
fn rings_must_share_their_angles() {
    let [coarse, fine] = [3.0, 4.0].map(|q| {
        let body = body("annulus", &[2.0], Idealization::PlaneStress, 0.3);
        MeshedBody::new(&body, &contact_grading(ElementKind::Quad4, 0.3, q, PI, 1.0))
    });
    let compliances = [coarse.condense(), fine.condense()];
    let (pin, plate) = (coarse.ring(&compliances[0], 1.0), fine.ring(&compliances[1], 1.0));
    let joint = RingJoint::new(pin, plate, 0.0);
    assert!(matches!(joint, Err(RingsDiffer { node: 1, .. })));
}
