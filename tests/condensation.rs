//! The fast path against the general one: bodies side by side in vector lanes, eliminated down to the ring in a band,
//! against assembly, sparse Cholesky and the whole compliance of the ring, body by body.

mod common;

use common::greatest::{difference, greatest};
use common::rings::{MeshedBody, body};
use jointsweep::mechanics::body::Body;
use jointsweep::mechanics::compliance::NODE_COUNT;
use jointsweep::mechanics::compliance::arc::{packed, packed_count};
use jointsweep::mechanics::compliance::lane_condensation::CondensationPlan;
use jointsweep::mechanics::compliance::near_field::{NearField, NearFieldClass, PoissonRange};
use jointsweep::mechanics::compliance::pressure_space::PressureSpace;
use jointsweep::mechanics::compliance::ring_loads::{RingLoads, ring_loads};
use jointsweep::mechanics::compliance::series::ConcentricBody;
use jointsweep::mechanics::element::ElementKind;
use jointsweep::mechanics::grading::GradingClass;
use jointsweep::mechanics::material::Idealization;
use jointsweep::mechanics::mesh::SUPPORTED;

/// Galerkin matrices of the trial pressures by the general path: f^T C f at every node in eps.
fn general(body: &Body, class: &GradingClass, space: &PressureSpace) -> Vec<f64> {
    let meshed = MeshedBody::new(body, &class.grading(body.shape.end_angle));
    let compliance = meshed.condense();
    let topology = &meshed.topology;
    let terms = space.terms;
    let mut values = Vec::new();
    for loads in ring_loads(space, topology.element, &topology.ring_angles) {
        let mut force = vec![0.0; compliance.size * terms];
        for node in 0..loads.node_count {
            for component in 0..2 {
                let unknown = topology.unknowns[2 * topology.ring_nodes[node] as usize + component];
                if unknown != SUPPORTED {
                    let row = (unknown as usize - topology.ring_start) * terms;
                    let from = (node * 2 + component) * terms;
                    force[row..row + terms].copy_from_slice(&loads.values[from..from + terms]);
                }
            }
        }
        for j in 0..terms {
            for k in 0..=j {
                let mut sum = 0.0;
                for row in 0..compliance.size {
                    let line = &compliance.values[row * compliance.size..(row + 1) * compliance.size];
                    let displacement: f64 =
                        line.iter().enumerate().map(|(i, c)| c * force[i * terms + k]).sum();
                    sum += force[row * terms + j] * displacement;
                }
                values.push(sum);
            }
        }
    }
    values
}

#[test]
fn the_lanes_give_what_the_general_path_gives() {
    let space = PressureSpace::new(10, 1.5);
    for element in [ElementKind::Quad4, ElementKind::Quad8] {
        for (name, ratios) in [
            ("annulus", &[2.5][..]),
            ("rigid-core", &[0.3][..]),
            ("rigid-midplane", &[][..]),
            ("block", &[2.0, 3.0, 1.6][..]),
        ] {
            let body = body(name, ratios, Idealization::PlaneStrain, 0.4);
            let class = GradingClass::of(&body, element, 1);
            let plan = CondensationPlan::new(
                &body,
                class.grading(body.shape.end_angle),
                &space,
                &RingLoads::default(),
            );
            let fast = plan.condense(&[body]).remove(0);
            let slow = general(&body, &class, &space);
            let difference = difference(&fast.values, &slow);
            println!("{name} {element:?}: {difference:.0e}");
            // Rounding of two factorisations in different orders.
            assert!(difference < 1e-11, "{name} {element:?}: {difference:e}");
        }
    }
}

/// A body's compliance does not depend on what fills the other lanes, nor on how many bodies there are.
#[test]
fn company_does_not_matter() {
    let space = PressureSpace::new(10, 2.4);
    let bodies: Vec<Body> = (0..11)
        .map(|i| body("annulus", &[2.8 + 0.02 * i as f64], Idealization::PlaneStress, 0.1 + 0.03 * i as f64))
        .collect();
    let class = GradingClass::of(&bodies[0], ElementKind::Quad8, 1);
    assert!(bodies.iter().all(|body| GradingClass::of(body, ElementKind::Quad8, 1) == class));
    let plan =
        CondensationPlan::new(&bodies[0], class.grading(std::f64::consts::PI), &space, &RingLoads::default());
    let together = plan.condense(&bodies);
    assert_eq!(together.len(), bodies.len());
    for (body, compliance) in bodies.iter().zip(&together) {
        assert_eq!(plan.condense(&[*body])[0].values, compliance.values);
    }
}

/// A body too thin for the mesh of its company, whose lines then cut the ring, is told by NaN where the general path
/// refuses it, be its stiffness positive definite or not; the others are not hurt.
#[test]
fn a_mesh_turned_inside_out_is_told() {
    let space = PressureSpace::new(10, 2.4);
    let block = |half_width: f64| body("block", &[half_width, 3.0, 2.0], Idealization::PlaneStress, 0.3);
    for level in 0..3 {
        let class = GradingClass::of(&block(2.0), ElementKind::Quad8, level);
        let grading = class.grading(std::f64::consts::PI);
        let plan = CondensationPlan::new(&block(2.0), grading.clone(), &space, &RingLoads::default());
        let widths: Vec<f64> = (0..60).map(|i| 1.001 + 0.01 * i as f64).collect();
        let bodies: Vec<Body> = widths.iter().map(|width| block(*width)).collect();
        let sound: Vec<bool> = bodies
            .iter()
            .map(|body| {
                let meshed = MeshedBody::new(body, &grading);
                meshed.assembly.stiffness_values::<f64>(&meshed.elasticity, &meshed.coordinates).is_ok()
            })
            .collect();
        assert!(sound.contains(&true) && sound.contains(&false));
        let condensed = plan.condense(&bodies);
        assert_eq!(condensed.len(), bodies.len());
        for ((compliance, sound), width) in condensed.iter().zip(sound).zip(widths) {
            assert_eq!(compliance.values.len(), NODE_COUNT * packed_count(10));
            assert_eq!(
                compliance.values.iter().all(|value| value.is_finite()),
                sound,
                "{width} level {level}"
            );
            assert_eq!(compliance.values.iter().any(|value| !value.is_nan()), sound, "{width} level {level}");
        }
    }
}

/// With the near field the worst error of a coarse mesh drops by a hundred: arcs far smaller than its elements are right.
#[test]
fn the_near_field_removes_the_error_of_the_ring() {
    let space = PressureSpace::new(10, 1.5);
    let entries = packed_count(10);
    for (name, ratio) in [("annulus", 2.3), ("rigid-core", 0.4)] {
        let body = body(name, &[ratio], Idealization::PlaneStress, 0.3);
        let concentric = ConcentricBody {
            fixed_radius: ratio,
            poissons_ratio: 0.3,
            idealization: Idealization::PlaneStress,
        };
        let highest = concentric.highest_mode();
        let exact = concentric.compliance(&space, &space.moments(highest), highest);
        let class = GradingClass::of(&body, ElementKind::Quad8, 1);
        let plan =
            CondensationPlan::new(&body, class.grading(body.shape.end_angle), &space, &RingLoads::default());
        let mut corrected = plan.condense(&[body]).remove(0);
        let plain = corrected.values.clone();
        let (around, between) = NearFieldClass::around(&body, class);
        let near_fields = around.map(|near_field| {
            let highest = near_field.highest_mode();
            NearField::new(&near_field, &space, &space.moments(highest), highest, &RingLoads::default())
        });
        NearField::correct(near_fields.each_ref(), between, body.poissons_ratio, &mut corrected);
        let mut worst = [0.0_f64; 2];
        for node in 0..NODE_COUNT {
            // The work of a punch-like pressure, p_0.
            let at = node * entries + packed(0, 0);
            let log = std::f64::consts::FRAC_PI_2 * exact.amplitude * space.arcs[node].b.ln();
            let whole = exact.values[at] - log;
            worst[0] = greatest([worst[0], plain[at] / whole - 1.0]);
            worst[1] = greatest([worst[1], (corrected.values[at] - exact.values[at]) / whole]);
        }
        println!("{name}: mesh alone {:.1e}, with the near field {:.1e}", worst[0], worst[1]);
        assert!(worst[1] < 0.01 * worst[0] && worst[1] < 5e-3);
    }
}

/// On the body that stands for a class the near field leaves nothing but what it interpolates between Poisson's ratios.
#[test]
fn the_near_field_makes_its_own_reference_exact() {
    let space = PressureSpace::new(10, 2.4);
    for (name, range, idealization) in [
        ("annulus", PoissonRange::Positive, Idealization::PlaneStress),
        ("rigid-core", PoissonRange::Negative, Idealization::PlaneStrain),
        ("annulus", PoissonRange::Compressible, Idealization::PlaneStrain),
        ("annulus", PoissonRange::Incompressible, Idealization::PlaneStrain),
        ("rigid-core", PoissonRange::Auxetic, Idealization::PlaneStress),
        ("annulus", PoissonRange::Conformal, Idealization::PlaneStress),
    ] {
        let of = |ratio: f64, nu: f64| body(name, &[ratio], idealization, nu);
        let grading =
            GradingClass::of(&of(if name == "annulus" { 1.6 } else { 0.6 }, 0.0), ElementKind::Quad8, 1);
        let side = of(2.0, 0.0).shape.side;
        // Layers that grow 1.75 times: a body of the class.
        let growth = 7;
        let class = NearFieldClass { side, half_ring: false, grading, idealization, range, growth };
        let highest = class.highest_mode();
        let moments = space.moments(highest);
        let near_field = NearField::new(&class, &space, &moments, highest, &RingLoads::default());
        let ratio = class.reference().fixed_radius;
        let plan = CondensationPlan::new(
            &of(ratio, 0.0),
            grading.grading(std::f64::consts::PI),
            &space,
            &RingLoads::default(),
        );
        let (low, high): (f64, f64) = match range {
            PoissonRange::Conformal => (1e-3_f64.ln(), 0.25_f64.ln()),
            PoissonRange::Auxetic => (-0.75, 0.0),
            PoissonRange::Negative => (-1.0, 0.0),
            PoissonRange::Positive => (0.0, 0.5),
            PoissonRange::Compressible => (0.06_f64.powf(0.25), 1.0),
            PoissonRange::Incompressible => (1e-5_f64.ln(), 0.06_f64.ln()),
        };
        // Half-way between two nodes where `i` is a whole number and a half.
        let node = |i: f64| {
            let angle: f64 = std::f64::consts::PI * (i + 0.5) / 8.0;
            let coordinate = 0.5 * (low + high) + 0.5 * (high - low) * angle.cos();
            match range {
                PoissonRange::Conformal => coordinate.exp() - 1.0,
                PoissonRange::Compressible => 0.5 * (1.0 - coordinate.powi(4)),
                PoissonRange::Incompressible => 0.5 * (1.0 - coordinate.exp()),
                _ => coordinate,
            }
        };
        let between = match range {
            PoissonRange::Conformal | PoissonRange::Incompressible => 1e-4,
            PoissonRange::Auxetic => 1e-5,
            _ => 4e-7,
        };
        // On nodes to rounding; between them to what eight nodes leave.
        for (poissons_ratio, tolerance) in [(node(0.0), 1e-12), (node(3.0), 1e-12), (node(3.5), between)] {
            let mut corrected = plan.condense(&[of(ratio, poissons_ratio)]).remove(0);
            near_field.add(1.0, poissons_ratio, &mut corrected);
            let concentric = ConcentricBody { fixed_radius: ratio, poissons_ratio, idealization };
            let exact = concentric.compliance(&space, &moments, highest);
            let difference = difference(&corrected.values, &exact.values);
            println!("{name} at {poissons_ratio}: {difference:.0e}");
            assert!(difference < tolerance, "{name} at {poissons_ratio}: {difference:e}");
        }
    }
}
