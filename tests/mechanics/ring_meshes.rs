//! Ring meshes: every shape is filled exactly, the right way round, and held where it should be.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::greatest::greatest;
use crate::common::meshes::{ELEMENTS, PlaneMesh, scatter};
use crate::common::rings::{MeshedBody, body};
use jointsweep::internals::mechanics::body::Body;
use jointsweep::internals::mechanics::contact_grading::contact_grading;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::element::quadrature::gauss_legendre;
use jointsweep::internals::mechanics::grading::{GradingClass, LEVEL_COUNT};
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::mechanics::mesh::{Grading, SUPPORTED};

/// Divided as for contact, but with a first layer of at most 0.4 of the thinnest place.
fn mesh(body: &Body, element: ElementKind, least_angle: f64, q: f64) -> MeshedBody {
    let (least, greatest) = (body.shape.depth_range)(&body.parameters);
    let angles = contact_grading(element, least_angle, q, body.shape.end_angle, greatest).angles;
    let thin = contact_grading(element, least_angle.min(0.4 * q * least), q, body.shape.end_angle, greatest);
    MeshedBody::new(body, &Grading { angles, ..thin })
}

/// Area of the mesh, by the quadrature of its elements.
fn area(meshed: &MeshedBody) -> f64 {
    let (coordinates, connectivity) = (meshed.coordinates.clone(), meshed.topology.connectivity.clone());
    let element = meshed.topology.element;
    let plane = PlaneMesh { element, coordinates, connectivity, grid: Vec::new(), cells: (0, 0) };
    let mut area = 0.0;
    plane.integrate(&gauss_legendre(3), |_, _, _, weight| area += weight);
    area
}

/// Half the sector of the unit circle that the ring of sides covers, x dy - y dx over 2, by Simpson's rule.
fn sector(meshed: &MeshedBody) -> f64 {
    let at = |node: u32| meshed.coordinates[node as usize];
    let cross = |[a, b]: [f64; 2], [c, d]: [f64; 2]| 0.5 * (a * d - b * c);
    let ring = &meshed.topology.ring_nodes;
    match meshed.topology.element {
        ElementKind::Quad4 => ring.windows(2).map(|side| cross(at(side[0]), at(side[1]))).sum(),
        // Triangle of the chord, and 2/3 of chord times sagitta.
        ElementKind::Quad8 => ring
            .windows(3)
            .step_by(2)
            .map(|side| {
                let [first, middle, last] = [at(side[0]), at(side[1]), at(side[2])];
                let chord = [last[0] - first[0], last[1] - first[1]];
                let sagitta = [0, 1].map(|i| middle[i] - 0.5 * (first[i] + last[i]));
                cross(first, last) + 4.0 / 3.0 * cross(sagitta, chord)
            })
            .sum(),
    }
}

/// The ring's nodes lie on the circle, those in the middle of sides half-way; its unknowns, and no others, are the last.
fn assert_ring(meshed: &MeshedBody) {
    let topology = &meshed.topology;
    let mut unknowns: Vec<u32> = Vec::new();
    for (&node, angle) in topology.ring_nodes.iter().zip(&topology.ring_angles) {
        let [x, y] = meshed.coordinates[node as usize];
        assert!((x - angle.sin()).abs() < 1e-15 && (y + angle.cos()).abs() < 1e-15);
        unknowns.extend(&topology.unknowns[2 * node as usize..2 * node as usize + 2]);
    }
    if topology.element == ElementKind::Quad8 {
        for side in topology.ring_angles.windows(3).step_by(2) {
            assert!((side[1] - 0.5 * (side[0] + side[2])).abs() < 1e-15);
        }
    }
    unknowns.retain(|unknown| *unknown != SUPPORTED);
    unknowns.sort();
    assert!(
        unknowns.into_iter().map(|unknown| unknown as usize).eq(topology.ring_start..topology.unknown_count)
    );
}

/// Goal: blocks of any proportions, divided coarsely or finely, are filled exactly, by elements of positive area, with
/// a node in each corner; their edges are held as named. 100 random blocks, from 1.1 to 50 hole radii.
#[test]
fn blocks_are_filled_and_held() {
    let ratio = |seed: u64| 1.1 * (50f64 / 1.1).powf(0.5 * (1.0 + scatter(seed)));
    let mut worst: f64 = 0.0;
    for case in 0..100 {
        let [half_width, depth, height] = [3 * case, 3 * case + 1, 3 * case + 2].map(ratio);
        let mut block = body("block", &[half_width, depth, height], Idealization::PlaneStress, 0.3);
        let (least_angle, q) = [(0.5, 2.0), (0.1, 4.0), (1.0, 3.0)][case as usize % 3];
        for element in ELEMENTS {
            for (support, outer) in [(0, false), (1, true)] {
                block.support = support;
                let meshed = mesh(&block, element, least_angle, q);
                // Refuses elements that are not positive at the points of the rule.
                meshed
                    .assembly
                    .stiffness_values::<f64>(&meshed.elasticity, &meshed.coordinates)
                    .unwrap_or_else(|error| {
                        panic!("{element:?} {half_width} {depth} {height}, {least_angle}/{q}: {error}")
                    });
                let exact = half_width * (depth + height) - sector(&meshed);
                let error = (area(&meshed) / exact - 1.0).abs();
                worst = greatest([worst, error]);
                assert!(error < 1e-12, "{element:?} {half_width} {depth} {height}: {error:e}");
                for corner in [[half_width, -depth], [half_width, height]] {
                    let near = |[x, y]: &[f64; 2]| (x - corner[0]).hypot(y - corner[1]) < 1e-12 * half_width;
                    assert_eq!(meshed.coordinates.iter().filter(|place| near(place)).count(), 1);
                }
                assert_ring(&meshed);
                for (node, &[x, y]) in meshed.coordinates.iter().enumerate() {
                    let on = |value: f64, edge: f64| (value - edge).abs() < 1e-12 * edge.abs();
                    let edge = on(x, half_width) || on(y, height);
                    let held = on(y, -depth) || (outer && edge);
                    let on_symmetry = x.abs() < 1e-12 * depth.max(height);
                    let unknowns = &meshed.topology.unknowns[2 * node..2 * node + 2];
                    assert_eq!(unknowns[0] == SUPPORTED, held || on_symmetry, "{x} {y}");
                    assert_eq!(unknowns[1] == SUPPORTED, held, "{x} {y}");
                }
            }
        }
    }
    println!("areas within {worst:.0e}");
}

/// Goal: round bodies lie between their circles, held at the far one (and the half disc at its flat face).
#[test]
fn round_bodies_are_filled_and_held() {
    for element in ELEMENTS {
        for (name, ratios, far, end) in [
            ("annulus", vec![1.02], 1.02, PI),
            ("annulus", vec![40.0], 40.0, PI),
            ("rigid-core", vec![0.1], 0.1, PI),
            ("rigid-core", vec![0.9], 0.9, PI),
            ("rigid-midplane", vec![], 0.0, FRAC_PI_2),
        ] {
            let body = body(name, &ratios, Idealization::PlaneStress, 0.3);
            let meshed = mesh(&body, element, 0.1, 4.0);
            meshed.assembly.stiffness_values::<f64>(&meshed.elasticity, &meshed.coordinates).unwrap();
            // The far circle is divided like the ring.
            let exact = f64::abs(far * far - 1.0) * sector(&meshed);
            assert!((area(&meshed) / exact - 1.0).abs() < 1e-11, "{name} {element:?}");
            // The coarsest sides span about 45 degrees.
            assert!((sector(&meshed) / (0.5 * end) - 1.0).abs() < 0.05);
            for (node, &[x, y]) in meshed.coordinates.iter().enumerate() {
                let radius = x.hypot(y);
                let held = (radius - far).abs() < 1e-12 || (end < PI && y.abs() < 1e-12);
                let unknowns = &meshed.topology.unknowns[2 * node..2 * node + 2];
                assert_eq!(unknowns[0] == SUPPORTED, held || x.abs() < 1e-12, "{name} {x} {y}");
                assert_eq!(unknowns[1] == SUPPORTED, held, "{name} {x} {y}");
            }
            assert_ring(&meshed);
        }
    }
}

/// Goal: at every level the engine's own division of any body within its range is a mesh that assembly takes.
/// Round bodies of ratio 1.001 to 1e4, blocks of 1.2 to 50; Q8.
#[test]
fn every_class_is_a_sound_mesh() {
    for case in 0..24 {
        let between =
            |place: u64, from: f64, to: f64| from * (to / from).powf(0.5 * (1.0 + scatter(3 * case + place)));
        let round = between(0, 1.001, 1e4);
        for (name, ratios) in [
            ("annulus", vec![round]),
            ("rigid-core", vec![1.0 / round]),
            ("rigid-midplane", vec![]),
            ("block", [0, 1, 2].map(|place| between(place, 1.2, 50.0)).to_vec()),
        ] {
            let body = body(name, &ratios, Idealization::PlaneStrain, 0.3);
            // The finest levels divide alike and take long.
            for level in 0..LEVEL_COUNT - 2 {
                let class = GradingClass::of(&body, ElementKind::Quad8, level);
                let meshed = MeshedBody::new(&body, &class.grading(body.shape.end_angle));
                let values = meshed.assembly.stiffness_values::<f64>(&meshed.elasticity, &meshed.coordinates);
                assert!(values.is_ok(), "{name} {ratios:?} level {level}: {:?}", values.err());
            }
        }
    }
}
