//! Stresses on circles around the ring, against rings that are stepped through, Hertz, plain meshes and equilibrium.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::random::Random;
use crate::common::ring_design::{ring_design, rings};
use crate::common::ring_loads::ring_displacement;
use crate::common::rings::{MeshedBody, body};
use crate::common::stepped_ring::{Beyond, Ring, exponential, scaled};
use jointsweep::internals::engine::joint_curve::JointCurve;
use jointsweep::internals::engine::joint_stresses::{CircleStresses, NoStresses};
use jointsweep::internals::mechanics::body::{Body, Side};
use jointsweep::internals::mechanics::compliance::circle_stresses::Stress;
use jointsweep::internals::mechanics::compliance::concentric_body::ConcentricBody;
use jointsweep::internals::mechanics::compliance::mesh_stresses::MeshStresses;
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::grading::{GradingClass, REFERENCE_LEVEL};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::mechanics::mesh::SUPPORTED;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{JointDesign, Load, Part};
use jointsweep::internals::study::layers::Layer;

/// By exact modes, as good as they come.
fn curve(joint: &JointDesign) -> JointCurve {
    JointCurve::after(None, joint, SolveOptions { accuracy: 1e-9, method: MethodChoice::Series }).unwrap()
}

/// The near and the far circle of each material with that material.
fn places(ring: &Ring) -> Vec<(f64, Beyond)> {
    let own = Beyond {
        radius_ratio: 1.0,
        youngs_modulus: ring.youngs_modulus,
        poissons_ratio: ring.poissons_ratio,
    };
    let materials: Vec<Beyond> = std::iter::once(own).chain(ring.beyond.iter().copied()).collect();
    let ends = materials.iter().skip(1).map(|next| next.radius_ratio).chain([ring.fixed_radius_ratio]);
    materials
        .iter()
        .zip(ends)
        .flat_map(|(layer, end)| [(layer.radius_ratio, *layer), (end, *layer)])
        .collect()
}

/// Radial, hoop and shear stress under a pressure cos(n phi) on the edge of a ring, at places of its wall: radii over the edge's, each with the material
/// there. cos and sin taken out; for few waves and walls that are not thick.
fn stepped_stresses(ring: &Ring, n: usize, places: &[(f64, Beyond)]) -> Vec<[f64; 3]> {
    let [[radial, _], [along, _]] = ring.compliance(n);
    let mut state = [-radial, -along, -1.0, 0.0];
    let mut reached = 0.0_f64;
    let mut stresses = Vec::new();
    for (radius, layer) in places {
        let far = radius.ln();
        let steps = (8.0 * (n as f64 + 2.0) * (far - reached).abs()).ceil().max(1.0);
        let step = exponential(&scaled(&ring.generator(n as f64, layer), (far - reached) / steps));
        for _ in 0..steps as usize {
            state = step.map(|row| row.iter().zip(state).map(|(a, b)| a * b).sum());
        }
        reached = far;
        let (shear, lame) = ring.lame(layer.youngs_modulus, layer.poissons_ratio);
        let [radial, along, tension, shearing] = state;
        let strain = (radial + n as f64 * along) / radius;
        // s_r = (lame + 2 mu) e_r + lame e_phi, and the same with both changed.
        let outwards = tension / radius;
        let across = (outwards - lame * strain) / (lame + 2.0 * shear);
        stresses.push([outwards, (lame + 2.0 * shear) * strain + lame * across, shearing / radius]);
    }
    stresses
}

/// The worst difference over all was 5e-13 of the greatest stress of the mode.
#[test]
fn modes_are_those_of_rings_that_are_stepped_through() {
    let mut random = Random::new(410);
    let (mut worst, mut compared) = (0.0_f64, 0);
    for _ in 0..20 {
        let rings = rings(&mut random);
        let joint = ring_design(&rings, 0.0);
        for (side, ring) in [Side::Pin, Side::Plate].into_iter().zip(&rings) {
            let body = ConcentricBody::of(&joint.body(joint.part(side))).unwrap();
            for n in 0..8 {
                // Stepping makes rounding grow with the waves that rise.
                let shallow = |place: &(f64, Beyond)| n as f64 * place.0.ln().abs() < 4.0;
                let all = places(ring);
                let expected =
                    stepped_stresses(ring, n, &all.iter().copied().take_while(shallow).collect::<Vec<_>>());
                let found = body.circle_stresses(n);
                assert_eq!(found.as_flattened().len(), all.len());
                let greatest =
                    expected.as_flattened().iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                for (Stress { radial, hoop, shear }, expected) in found.as_flattened().iter().zip(&expected) {
                    for (found, expected) in [*radial, *hoop, *shear].iter().zip(expected) {
                        let error = (found - expected).abs() / greatest;
                        assert!(error < 1e-10, "{side:?}, mode {n}: {found} for {expected}, {ring:?}");
                        worst = worst.max(error);
                        compared += 1;
                    }
                }
            }
        }
    }
    println!("{compared} stresses: {worst:.1e}");
    assert!(compared > 2000, "{compared}");
}

/// 2 t times the integral of (s_r cos(phi) - s_phi sin(phi)) r d(phi), from the load line to the far side.
fn resultant(circle: &CircleStresses) -> f64 {
    let value = |place: usize| {
        let point = circle.points[place];
        let (sine, cosine) = point.angle.sin_cos();
        (point.angle, (point.radial * cosine - point.shear * sine) * circle.radius)
    };
    let ends = (1..circle.points.len()).map(|place| (value(place - 1), value(place)));
    -2.0 * ends.map(|((from, a), (to, b))| 0.5 * (a + b) * (to - from)).sum::<f64>()
}

/// Every circle of both bodies carries the force, and both sides of an interface have the same radial and shear stress. Of the pin its own
/// pressure leaves out what tilts it, and a press fit's is per area of the hole, both of the order of the clearance.
#[test]
fn every_circle_carries_the_force() {
    let mut random = Random::new(411);
    let mut interfaces = 0;
    for (draw, clearance) in [0.001, 0.01, 0.0, -0.002, -0.002, 0.003].into_iter().enumerate() {
        let rings = rings(&mut random);
        let curve = curve(&ring_design(&rings, clearance));
        let load =
            if clearance < 0.0 { Load::Offset(0.001 + 0.01 * draw as f64) } else { Load::Indentation(0.004) };
        let answer = curve.answers(&[load]).pop().unwrap().response.unwrap();
        for side in [Side::Pin, Side::Plate] {
            let circles = curve.stresses(side, load, 2001, &[0.05]).unwrap();
            // A circle more changes nothing on the others.
            let bare = curve.stresses(side, load, 2001, &[]).unwrap();
            assert_eq!(circles.len(), bare.len() + 1);
            let others = circles.iter().filter(|circle| bare.iter().any(|own| own.radius == circle.radius));
            for (one, other) in others.zip(&bare) {
                assert_eq!((one.layer, one.radius), (other.layer, other.radius));
                for (one, other) in one.points.iter().zip(&other.points) {
                    let most = answer.peak_pressure.unwrap();
                    assert!(
                        (one.von_mises - other.von_mises).abs() < 1e-6 * most,
                        "{side:?} at {}",
                        circles[0].radius
                    );
                }
            }
            for circle in &circles {
                let error = (resultant(circle) / answer.force - 1.0).abs();
                let allowed = 1e-4 + if side == Side::Pin { 1.1 * clearance.abs() } else { 0.0 };
                assert!(error < allowed, "draw {draw}, {side:?} at {}: {error:.1e}", circle.radius);
            }
            for pair in circles.windows(2).filter(|pair| pair[0].radius == pair[1].radius) {
                let most = pair[0].points.iter().fold(0.0, |most: f64, point| most.max(point.radial.abs()));
                assert_eq!(
                    pair[0].layer + 1,
                    if pair[1].layer == 0 { rings_layers(&curve, side) } else { pair[1].layer }
                );
                for (one, other) in pair[0].points.iter().zip(&pair[1].points) {
                    assert!((one.radial - other.radial).abs() < 1e-12 * most);
                    assert!((one.shear - other.shear).abs() < 1e-12 * most);
                }
                interfaces += 1;
            }
        }
    }
    assert!(interfaces >= 6, "{interfaces}");
}

/// One more than the layers of a side: its own material comes after them.
fn rings_layers(curve: &JointCurve, side: Side) -> usize {
    curve.joint().part(side).layers.list().len() + 1
}

/// Below a narrow contact in large bodies the stresses are those below a line contact (K. L. Johnson, Contact Mechanics, 4.45), a the half width and z the
/// depth; what is left falls with the width.
#[test]
fn below_a_narrow_contact_are_the_stresses_of_hertz() {
    let large = |fixed_radius_ratio| Ring {
        fixed_radius_ratio,
        youngs_modulus: 1.0,
        poissons_ratio: 0.3,
        idealization: Idealization::PlaneStrain,
        beyond: &[],
    };
    let curve = curve(&ring_design(&[large(0.2), large(5.0)], 0.01));
    let worst = |force: f64| -> f64 {
        let load = Load::Force(force);
        let answer = curve.answers(&[load]).pop().unwrap().response.unwrap();
        let (width, peak) = (answer.contact_half_angle.unwrap(), answer.peak_pressure.unwrap());
        let depths = [0.2, 0.5, 0.704, 1.0, 2.0].map(|share| share * width);
        let circles = curve.stresses(Side::Plate, load, 181, &depths).unwrap();
        assert_eq!(circles.len(), 7);
        let mut worst = 0.0_f64;
        for (circle, depth) in circles[1..6].iter().zip(depths) {
            assert!((circle.radius - 1.0 - depth).abs() < 1e-12 && circle.layer == 0);
            let root = (width * width + depth * depth).sqrt();
            let square = width * width + 2.0 * depth * depth;
            let along = -peak / width * (square / root - 2.0 * depth);
            let across = -peak * width / root;
            let below = circle.points[0];
            worst =
                worst.max(((below.radial - across) / peak).abs()).max(((below.hoop - along) / peak).abs());
        }
        // The greatest of von Mises' stress.
        let von_mises = circles[3].points[0].von_mises / peak;
        println!("{:.2} deg: {worst:.1e} of the peak pressure, von Mises {von_mises:.4}", width.to_degrees());
        assert!((von_mises - 0.558).abs() < 0.6 * width, "{von_mises}");
        worst
    };
    let (wide, narrow) = (worst(4e-7), worst(1e-7));
    assert!(wide < 0.02 && narrow < 0.6 * wide, "{wide} {narrow}");
}

/// Closed form of Lame: a thick ring that is held outside, under uniform pressure.
#[test]
fn at_rest_are_the_stresses_of_lame() {
    let ring = |fixed_radius_ratio, youngs_modulus| Ring {
        fixed_radius_ratio,
        youngs_modulus,
        poissons_ratio: 0.3,
        idealization: Idealization::PlaneStress,
        beyond: &[],
    };
    let curve = curve(&ring_design(&[ring(0.2, 3.0), ring(2.0, 1.0)], -0.001));
    let circles =
        curve.stresses(Side::Plate, Load::Offset(0.0), 5, &[0.5, 0.5, 1e-9, 1.0 - 1e-9, 2.0]).unwrap();
    // s = A -+ B/r^2, u = r [(1 - nu) A + (1 + nu) B/r^2]/E is zero at r = 2.
    let pressure = -circles[0].points[0].radial;
    let share = -0.25 * 1.3 / 0.7;
    let b = pressure / (1.0 - share);
    for (circle, radius) in circles.iter().zip([1.0, 1.5, 2.0]) {
        let (a, falling) = (share * b, b / (radius * radius));
        for point in &circle.points {
            let found = [point.radial, point.hoop, point.shear, circle.radius];
            let expected = [a - falling, a + falling, 0.0, radius];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
            }
            let von_mises = (a * a + 3.0 * falling * falling).sqrt();
            assert!((point.von_mises - von_mises).abs() < 1e-12);
        }
    }
    assert_eq!(circles.len(), 3);
    assert!((circles[0].points[4].angle - PI).abs() < 1e-15);
}

/// A contact of 0.006 deg on a coating of a millionth: waves so short are not summed.
#[test]
fn contacts_too_narrow_for_their_layer_are_refused() {
    let coated = Ring {
        fixed_radius_ratio: 3.0,
        youngs_modulus: 1.0,
        poissons_ratio: 0.3,
        idealization: Idealization::PlaneStress,
        beyond: &[Beyond { radius_ratio: 1.000_001, youngs_modulus: 1.5, poissons_ratio: 0.3 }],
    };
    let pin = Ring { fixed_radius_ratio: 0.2, beyond: &[], ..coated };
    let curve = curve(&ring_design(&[pin, coated], 0.02));
    let narrow = Load::Indentation(1e-10);
    assert!(curve.answers(&[narrow])[0].response.is_some());
    assert_eq!(curve.stresses(Side::Plate, narrow, 9, &[]).unwrap_err(), NoStresses::TooNarrow);
    assert!(curve.stresses(Side::Pin, narrow, 9, &[]).is_ok());
    assert!(curve.stresses(Side::Plate, Load::Indentation(1e-3), 9, &[]).is_ok());
}

/// Under a uniform pressure all around, which any mesh sees, the hoop stress at the holes of bare blocks is that of one fine mesh alone: of its
/// nodes on the ring, by differences.
#[test]
fn hoop_stresses_of_blocks_are_those_of_plain_meshes() {
    let mut worst = 0.0_f64;
    for (ratios, support) in [([2.0, 2.5, 1.6], 0), ([1.3, 3.0, 1.5], 1), ([6.0, 4.0, 5.0], 0)] {
        let block =
            Body { support, all_around: true, ..body("block", &ratios, Idealization::PlaneStress, 0.3) };
        let grading = GradingClass::of(&block, ElementKind::Quad8, REFERENCE_LEVEL).grading(PI);
        let meshed = MeshedBody::new(&block, &grading);
        let moved = ring_displacement(&meshed.condense(), &meshed.unit_pressure());
        let topology = &meshed.topology;
        let at = |node: u32, component: usize| match topology.unknowns[2 * node as usize + component] {
            SUPPORTED => 0.0,
            unknown => moved[unknown as usize - topology.ring_start],
        };
        let pieces: Vec<(f64, f64)> =
            (0..2000).map(|i| ((f64::from(i) + 0.5) * PI / 2000.0, PI / 2000.0)).collect();
        let meshes = MeshStresses::new(&block, 3, &pieces).unwrap();
        let reference = ConcentricBody::of(&meshes.reference).unwrap();
        let uniform = reference.circle_stresses(0)[0][0].hoop;
        let difference = &meshes.differences()[0];
        let (mut greatest, mut error) = (0.0_f64, 0.0_f64);
        for middle in (1..topology.ring_nodes.len() - 1).step_by(2) {
            let angle = topology.ring_angles[middle];
            let (before, behind) = (topology.ring_nodes[middle - 1], topology.ring_nodes[middle + 1]);
            let width = topology.ring_angles[middle + 1] - topology.ring_angles[middle - 1];
            let along = |node| angle.cos() * at(node, 0) + angle.sin() * at(node, 1);
            // Young's modulus 1, and -1 across.
            let expected = (along(behind) - along(before)) / width - 0.3;
            let found = uniform + reference.stress_on(0, difference.at(angle)).hoop;
            greatest = greatest.max(expected.abs());
            error = error.max((found - expected).abs());
        }
        println!("{ratios:?}: {:.1e} of {greatest:.3}", error / greatest);
        worst = worst.max(error / greatest);
    }
    assert!(worst < 5e-3, "{worst}");
}

/// What passes through each circle of lined blocks is the force, in narrow contacts, in wide ones and in press fits; radial and shear stress are those of both sides.
#[test]
fn every_circle_of_a_lined_block_carries_the_force() {
    let material = |youngs_modulus| Material { youngs_modulus, poissons_ratio: 0.3 };
    let ratios = [("half_width_ratio", 2.0), ("depth_ratio", 2.5), ("height_ratio", 1.8)];
    let plate = Part::new("block", &ratios, Some("base"), material(2e5)).unwrap();
    let plate =
        plate.with_layers(&[Layer::new(0.05, material(3e3)), Layer::new(0.1, material(7e4))]).unwrap();
    let pin = Part::new("rigid-core", &[("core_radius_ratio", 0.3)], None, material(2e5)).unwrap();
    let mut circles_seen = 0;
    for (radial_clearance, load) in
        [(0.01, Load::Indentation(3e-4)), (0.001, Load::Indentation(0.01)), (-0.002, Load::Offset(0.003))]
    {
        let joint = JointDesign {
            idealization: Idealization::PlaneStrain,
            hole_radius: 1.0,
            radial_clearance,
            thickness: 1.0,
            pin: pin.clone(),
            plate: plate.clone(),
        };
        let options = SolveOptions { accuracy: 2e-3, method: MethodChoice::Auto };
        let curve = JointCurve::after(None, &joint, options).unwrap();
        let force = curve.answers(&[load])[0].response.unwrap().force;
        let circles = curve.stresses(Side::Plate, load, 2001, &[0.02, 0.2]).unwrap();
        // The contact, both sides of two interfaces, and two depths.
        assert_eq!(circles.len(), 7);
        let greatest = circles[0].points.iter().fold(0.0, |most: f64, point| most.max(-point.radial));
        for circle in &circles {
            let error = (resultant(circle) / force - 1.0).abs();
            println!("{load:?}, {:.2}: {error:.1e}", circle.radius);
            assert!(error < 1e-4, "{load:?} at {}: {error}", circle.radius);
            circles_seen += 1;
        }
        for pair in circles.windows(2).filter(|pair| pair[0].radius == pair[1].radius) {
            for (one, other) in pair[0].points.iter().zip(&pair[1].points) {
                assert!((one.radial - other.radial).abs() < 1e-12 * greatest);
                assert!((one.shear - other.shear).abs() < 1e-12 * greatest);
            }
        }
    }
    assert_eq!(circles_seen, 21);
}

/// Of a half pin circles end before the corner of its held face, and lined ones have both sides of their interface.
#[test]
fn half_pins_have_stresses_up_to_their_corner() {
    let material = |youngs_modulus| Material { youngs_modulus, poissons_ratio: 0.3 };
    let pin = Part::new("rigid-midplane", &[], None, material(2e5)).unwrap();
    let pin = pin.with_layers(&[Layer::new(0.1, material(4e4))]).unwrap();
    let joint = JointDesign {
        idealization: Idealization::PlaneStress,
        hole_radius: 1.0,
        radial_clearance: 0.01,
        thickness: 1.0,
        pin,
        plate: Part::new("annulus", &[("outer_radius_ratio", 3.0)], None, material(2e5)).unwrap(),
    };
    let options = SolveOptions { accuracy: 1e-2, method: MethodChoice::Auto };
    let curve = JointCurve::after(None, &joint, options).unwrap();
    let load = Load::Indentation(0.002);
    let peak = curve.answers(&[load])[0].response.unwrap().peak_pressure.unwrap();
    let circles = curve.stresses(Side::Pin, load, 101, &[]).unwrap();
    assert_eq!(circles.iter().map(|circle| circle.layer).collect::<Vec<_>>(), [1, 1, 0]);
    for circle in &circles {
        let last = circle.points[circle.points.len() - 1].angle;
        assert!(last > 1.2 && last < FRAC_PI_2, "{last}");
    }
    assert!((circles[0].points[0].radial / -peak - 1.0).abs() < 1e-6);
    assert!(circles[1].points[0].radial / -peak > 0.3);
}
