//! The fast path against the general one: bodies side by side in vector lanes, eliminated down to the ring in a band,
//! against assembly, sparse Cholesky and the whole compliance of the ring, body by body.

use std::collections::HashSet;

use crate::common::greatest::{difference, greatest};
use crate::common::rings::{MeshedBody, body};
use jointsweep::internals::mechanics::body::{Body, Side};
use jointsweep::internals::mechanics::compliance::arc::{ContactArc, packed_count};
use jointsweep::internals::mechanics::compliance::lane_condensation::CondensationPlan;
use jointsweep::internals::mechanics::compliance::near_field::{
    LoadedRing, NearField, NearFieldClass, PoissonRange,
};
use jointsweep::internals::mechanics::compliance::pressure_space::{PressureSpace, Tilt};
use jointsweep::internals::mechanics::compliance::ring_modes::{Push, RingModes};
use jointsweep::internals::mechanics::compliance::series::ConcentricBody;
use jointsweep::internals::mechanics::compliance::{BodyCompliance, Boundary};
use jointsweep::internals::mechanics::element::ElementKind;
use jointsweep::internals::mechanics::grading::GradingClass;
use jointsweep::internals::mechanics::material::Idealization;

fn plan(body: &Body, class: &GradingClass) -> CondensationPlan {
    CondensationPlan::new(body, class.grading(body.shape.end_angle), RingModes::of(class))
}

#[test]
fn the_lanes_give_what_the_general_path_gives() {
    for element in [ElementKind::Quad4, ElementKind::Quad8] {
        for (name, ratios) in [
            ("annulus", &[2.5][..]),
            ("annulus", &[1.03][..]),
            ("rigid-core", &[0.3][..]),
            ("rigid-midplane", &[][..]),
            ("block", &[2.0, 3.0, 1.6][..]),
        ] {
            let body = body(name, ratios, Idealization::PlaneStrain, 0.4);
            let class = GradingClass::of(&body, element, 1);
            let fast = plan(&body, &class).condense(std::slice::from_ref(&body)).remove(0);
            let meshed = MeshedBody::new(&body, &class.grading(body.shape.end_angle));
            let ring = meshed.condense();
            let works = |push: &Push| RingModes::of(&class).works_on_ring(*push, &ring, &meshed.topology);
            let slow: Vec<f64> = Push::of(body.shape.side).iter().flat_map(works).collect();
            let difference = difference(&fast, &slow);
            println!("{name} {element:?}, {} modes: {difference:.0e}", RingModes::of(&class).count);
            // Rounding of two factorisations in different orders.
            assert!(difference < 1e-11, "{name} {element:?}: {difference:e}");
        }
    }
}

/// Bodies of one class have the loads of its ring, however many layers they have.
#[test]
fn loads_of_a_ring_are_those_of_its_bodies() {
    let bodies = [
        body("annulus", &[2.8], Idealization::PlaneStress, 0.3),
        body("annulus", &[30.0], Idealization::PlaneStress, 0.3),
        body("rigid-core", &[0.3], Idealization::PlaneStrain, 0.4),
        body("rigid-midplane", &[], Idealization::PlaneStrain, 0.4),
        body("block", &[2.0, 3.0, 1.6], Idealization::PlaneStrain, 0.4),
    ];
    let mut rings = HashSet::new();
    for body in &bodies {
        let class = GradingClass::of(body, ElementKind::Quad8, 1);
        let angles = class.grading(body.shape.end_angle).ring_angles();
        let expected = RingModes::of(&class).loads(Push::of(body.shape.side), ElementKind::Quad8, &angles);
        let ring = LoadedRing::of(body.shape, &class);
        assert_eq!(ring.loads(), expected, "{}", body.shape.name);
        rings.insert(ring);
        // Half a ring is continued for its near field, and for that alone.
        for near_field in NearFieldClass::around(body, class).0 {
            assert_eq!(LoadedRing::of_near_field(&near_field) == ring, !near_field.half_ring);
        }
    }
    assert_eq!(rings.len(), bodies.len() - 1);
}

/// The works on a body do not depend on what fills the other lanes, in plane stress or in plane strain, nor on how many bodies there are.
#[test]
fn company_does_not_matter() {
    let one = |i: usize| {
        let idealization = Idealization::ALL[i % 3 % 2];
        body("annulus", &[2.8 + 0.02 * i as f64], idealization, 0.1 + 0.03 * i as f64)
    };
    let bodies: Vec<Body> = (0..11).map(one).collect();
    let class = GradingClass::of(&bodies[0], ElementKind::Quad8, 1);
    assert!(bodies.iter().all(|body| GradingClass::of(body, ElementKind::Quad8, 1) == class));
    let plan = plan(&bodies[0], &class);
    let together = plan.condense(&bodies);
    assert_eq!(together.len(), bodies.len());
    for (body, works) in bodies.iter().zip(&together) {
        assert_eq!(plan.condense(std::slice::from_ref(body))[0], *works);
    }
}

/// A body too thin for the mesh of its company, whose lines then cut the ring, is told by NaN where the general path
/// refuses it, be its stiffness positive definite or not; the others are not hurt.
#[test]
fn a_mesh_turned_inside_out_is_told() {
    let block = |half_width: f64| body("block", &[half_width, 3.0, 2.0], Idealization::PlaneStress, 0.3);
    for level in 0..3 {
        let class = GradingClass::of(&block(2.0), ElementKind::Quad8, level);
        let grading = class.grading(std::f64::consts::PI);
        let plan = plan(&block(2.0), &class);
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
        for ((works, sound), width) in condensed.iter().zip(sound).zip(widths) {
            assert_eq!(works.len(), packed_count(RingModes::of(&class).count));
            assert_eq!(works.iter().all(|value| value.is_finite()), sound, "{width} level {level}");
            assert_eq!(works.iter().any(|value| !value.is_nan()), sound, "{width} level {level}");
        }
    }
}

/// With the near field the compliance of a coarse mesh is right on arcs far smaller than its elements, where what the mesh
/// itself has of the work of a punch is off by ten times as much and more.
#[test]
fn the_near_field_removes_the_error_of_the_ring() {
    let arcs: Vec<ContactArc> = (0..16).map(|i| ContactArc::new(1.5 * 0.6_f64.powi(i))).collect();
    let mut space = PressureSpace::new(10, arcs);
    for (name, ratio) in [("annulus", 2.3), ("rigid-core", 0.4)] {
        let body = body(name, &[ratio], Idealization::PlaneStress, 0.3);
        let concentric = ConcentricBody {
            fixed_radius_ratio: ratio,
            poissons_ratio: 0.3,
            idealization: Idealization::PlaneStress,
            lining: Default::default(),
        };
        let class = GradingClass::of(&body, ElementKind::Quad8, 1);
        let modes = RingModes::of(&class);
        let condensed = plan(&body, &class).condense(std::slice::from_ref(&body)).remove(0);
        let mut corrected = condensed.clone();
        let (around, between) = NearFieldClass::around(&body, class);
        let near_fields = around.map(|class| NearField::new(&class));
        NearField::correct(near_fields.each_ref(), between, body.poissons_ratio, &mut corrected);
        // What the whole ring has of the infinite body is left out of the mesh's own, mode by mode.
        let normal: Vec<f64> = (0..400)
            .map(|n| match n {
                0 => 0.0,
                1 => concentric.amplitude(),
                _ => concentric.far_mode(n),
            })
            .collect();
        let along = (0..400).map(|n| if n < 2 { 0.0 } else { concentric.far_mode_along(n) }).collect();
        let [infinite] = modes.works_of_modes(body.shape.side, &[[normal, along]]);
        let plain = condensed.iter().zip(&infinite).map(|(mesh, infinite)| mesh - infinite).collect();
        let exact = concentric.compliance();
        space.prepare(&exact);
        let error = |works: Vec<f64>, space: &mut PressureSpace| {
            let found = BodyCompliance { boundary: Boundary::RingModes(modes, works), ..exact.clone() };
            space.prepare(&found);
            let (left, whole) = (
                space.joint(&[(&found, 1.0), (&exact, -1.0)], Tilt::NONE),
                space.joint(&[(&exact, 1.0)], Tilt::NONE),
            );
            // The work of a punch-like pressure, p_0.
            let of_arc = |(place, arc): (usize, &ContactArc)| {
                let log = std::f64::consts::FRAC_PI_2 * exact.even * arc.b.ln();
                left.values[place] / (whole.values[place] - log)
            };
            greatest(space.arcs.iter().enumerate().map(of_arc))
        };
        let (alone, corrected) = (error(plain, &mut space), error(corrected, &mut space));
        println!("{name}: mesh alone {alone:.1e}, with the near field {corrected:.1e}");
        assert!(corrected < 0.1 * alone && corrected < 5e-3);
    }
}

/// On the body that stands for a class the near field leaves nothing but what it interpolates between Poisson's ratios.
#[test]
fn the_near_field_makes_its_own_reference_exact() {
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
        let growth = 1_750_000;
        let class = NearFieldClass { side, half_ring: false, grading, idealization, range, growth };
        let near_field = NearField::new(&class);
        let ratio = class.reference().fixed_radius_ratio;
        let plan = plan(&of(ratio, 0.0), &grading);
        let modes = RingModes::of(&grading);
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
            NearField::correct([&near_field, &near_field], 0.0, poissons_ratio, &mut corrected);
            let concentric = ConcentricBody {
                fixed_radius_ratio: ratio,
                poissons_ratio,
                idealization,
                lining: Default::default(),
            };
            let side = if ratio < 1.0 { Side::Pin } else { Side::Plate };
            let [exact] = modes.works_of_modes(side, &[concentric.boundary_modes()]);
            let difference = difference(&corrected, &exact);
            println!("{name} at {poissons_ratio}: {difference:.0e}");
            assert!(difference < tolerance, "{name} at {poissons_ratio}: {difference:e}");
        }
    }
}
