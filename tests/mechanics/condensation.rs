//! The fast path against the general one: bodies side by side in vector lanes, eliminated down to the ring in a band,
//! against assembly, sparse Cholesky and the whole compliance of the ring, body by body.

use std::collections::HashSet;

use crate::common::greatest::{difference, greatest};
use crate::common::rings::{MeshedBody, body};
use crate::series::far_mode;
use jointsweep::internals::mechanics::body::{Body, Side};
use jointsweep::internals::mechanics::compliance::arc::{ContactArc, packed_count};
use jointsweep::internals::mechanics::compliance::concentric_body::ConcentricBody;
use jointsweep::internals::mechanics::compliance::lane_condensation::CondensationPlan;
use jointsweep::internals::mechanics::compliance::near_field::{
    Common, InCommon, LoadedRing, NearField, NearFieldClass, PoissonRange,
};
use jointsweep::internals::mechanics::compliance::pressure_space::{PressureSpace, Tilt};
use jointsweep::internals::mechanics::compliance::ring_modes::{Push, RingModes};
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
        for near_field in NearFieldClass::around(body, class, &InCommon::default()).0 {
            assert_eq!(near_field.mesh().ring() == ring, !near_field.half_ring);
        }
    }
    assert_eq!(rings.len(), bodies.len() - 1);
}

/// The works on a body do not depend on what fills the other lanes, in plane stress or in plane strain, nor on how many bodies there are.
#[test]
fn company_does_not_matter() {
    type Ratios = fn(f64) -> Vec<f64>;
    let shapes: [(&str, usize, Ratios); 5] = [
        ("annulus", 1, |i| vec![2.8 + 0.02 * i]),
        ("rigid-core", 1, |i| vec![0.3 - 0.001 * i]),
        ("rigid-midplane", 1, |_| vec![]),
        // Each line of each has a depth of its own.
        ("block", 1, |i| vec![2.0 + 0.002 * i, 3.0, 1.6]),
        // Too large for lanes in some registers.
        ("annulus", 4, |i| vec![1.1 - 0.0001 * i]),
    ];
    for (name, level, ratios) in shapes {
        let one = |i: usize| {
            let idealization = Idealization::ALL[i % 3 % 2];
            body(name, &ratios(i as f64), idealization, 0.1 + 0.03 * i as f64)
        };
        let bodies: Vec<Body> = (0..11).map(one).collect();
        let class = GradingClass::of(&bodies[0], ElementKind::Quad8, level);
        assert!(
            bodies.iter().all(|body| GradingClass::of(body, ElementKind::Quad8, level) == class),
            "{name}"
        );
        let plan = plan(&bodies[0], &class);
        let together = plan.condense(&bodies);
        assert_eq!(together.len(), bodies.len());
        for (body, works) in bodies.iter().zip(&together) {
            assert_eq!(plan.condense(std::slice::from_ref(body))[0], *works, "{name}");
        }
    }
}

/// In single precision works are those of double precision but for its rounding; each body comes to the same bits in any company, and one that
/// would lose too many digits to those of double precision.
#[test]
fn single_precision_rounds_works_and_keeps_what_it_cannot() {
    let (mut rounded, mut kept) = (0, 0);
    for (name, ratios, most) in [
        ("annulus", &[2.5][..], 5e-5),
        ("annulus", &[1.03][..], 3e-4),
        ("annulus", &[40.0][..], 1e-4),
        ("rigid-core", &[0.3][..], 2e-5),
        ("rigid-core", &[0.01][..], 1e-4),
        ("rigid-midplane", &[][..], 6e-5),
    ] {
        for level in 0..2 {
            let own = |place: usize| {
                let ratio = -0.999 + 1.4989 * place as f64 / 20.0;
                body(name, ratios, [Idealization::PlaneStress, Idealization::PlaneStrain][place % 2], ratio)
            };
            let bodies: Vec<Body> = (0..21).map(own).collect();
            let class = GradingClass::of(&bodies[0], ElementKind::Quad8, level);
            let plan = plan(&bodies[0], &class);
            let (together, expected) = (plan.condense_in_singles(&bodies), plan.condense(&bodies));
            let mut worst = 0.0_f64;
            for (body, (together, expected)) in bodies.iter().zip(together.iter().zip(&expected)) {
                let alone = plan.condense_in_singles(std::slice::from_ref(body));
                assert_eq!(alone[0], *together, "{body:?}");
                let all = greatest(expected.iter().copied());
                let difference =
                    greatest(together.iter().zip(expected).map(|(one, other)| one - other)) / all;
                worst = worst.max(difference);
                if together == expected { kept += 1 } else { rounded += 1 }
            }
            println!("{name} {ratios:?} on level {level}: {worst:.1e}");
            // Twice what is seen; forces feel a tenth of it.
            assert!(worst < most, "{name} {ratios:?} on level {level}: {worst:e}");
        }
    }
    println!("{rounded} rounded, {kept} kept");
    assert!(rounded > 200 && kept > 0, "{rounded} and {kept}");
}

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

/// That of one class.
fn near_field(class: NearFieldClass) -> NearField {
    let (mesh, condense) = (class.mesh(), |plan: &CondensationPlan, bodies: &[Body]| plan.condense(bodies));
    NearField::on_mesh(&mesh, &[class], &mesh.ring().loads(), condense).remove(0)
}

/// With the near field the compliance of a coarse mesh is right on arcs far smaller than its elements, where what the mesh
/// itself has of the work of a punch is off by ten times as much and more.
#[test]
fn the_near_field_removes_the_error_of_the_ring() {
    let arcs: Vec<ContactArc> = (0..16).map(|i| ContactArc::new(1.5 * 0.6_f64.powi(i))).collect();
    let mut space = PressureSpace::new(10, arcs);
    for (name, ratio) in [("annulus", 2.3), ("rigid-core", 0.4)] {
        let body = body(name, &[ratio], Idealization::PlaneStress, 0.3);
        let concentric = ConcentricBody::bare(ratio, 0.3, Idealization::PlaneStress);
        let class = GradingClass::of(&body, ElementKind::Quad8, 1);
        let modes = RingModes::of(&class);
        let condensed = plan(&body, &class).condense(std::slice::from_ref(&body)).remove(0);
        let mut corrected = condensed.clone();
        let (around, between) = NearFieldClass::around(&body, class, &InCommon::default());
        let near_fields = around.map(near_field);
        NearField::correct(near_fields.each_ref(), between, &body, &mut corrected);
        // What the whole ring has of the infinite body is left out of the mesh's own, mode by mode.
        let normal: Vec<f64> = (0..400)
            .map(|n| match n {
                0 => 0.0,
                1 => concentric.amplitude(),
                _ => far_mode(&concentric, n)[0],
            })
            .collect();
        let along = (0..400).map(|n| if n < 2 { 0.0 } else { far_mode(&concentric, n)[1] }).collect();
        let infinite = modes.works_of_modes(body.shape.side, &[[normal, along]]).remove(0);
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

/// On the bodies that stand for a class the near field leaves nothing, on those between them but what it interpolates, in either plane
/// state.
#[test]
fn the_near_field_makes_its_own_references_exact() {
    use Idealization::{PlaneStrain, PlaneStress};
    let ranges = [
        (PoissonRange::Positive, [(PlaneStrain, 0.0, 0.47), (PlaneStress, 0.0, 0.5)]),
        (PoissonRange::Auxetic, [(PlaneStress, -0.75, 0.0), (PlaneStrain, -1.0, 0.0)]),
        (PoissonRange::Incompressible, [(PlaneStrain, 0.47, 0.49), (PlaneStrain, 0.49, 0.49999)]),
        (PoissonRange::Conformal, [(PlaneStress, -0.9, -0.75), (PlaneStress, -0.999, -0.9)]),
    ];
    for (range, states) in ranges {
        for level in [0, 1, 3] {
            let (mut on_nodes, mut between) = (Vec::new(), Vec::new());
            for (name, ratio) in [
                ("annulus", 1.05),
                ("annulus", 1.3),
                ("annulus", 5.0),
                ("rigid-core", 0.7),
                ("rigid-core", 0.2),
            ] {
                let of =
                    |ratio: f64, idealization: Idealization, nu: f64| body(name, &[ratio], idealization, nu);
                let grading = GradingClass::of(&of(ratio, PlaneStrain, 0.0), ElementKind::Quad8, level);
                let side = of(ratio, PlaneStrain, 0.0).shape.side;
                // Layers that grow so are those of a body of the class.
                let class = NearFieldClass { side, half_ring: false, grading, range, growth: 1_250_000 };
                let near_field = near_field(class);
                let modes = RingModes::of(&grading);
                let plan = plan(&of(ratio, PlaneStrain, 0.0), &grading);
                let left = |concentric: &ConcentricBody| {
                    let body =
                        of(concentric.fixed_radius_ratio, concentric.idealization, concentric.poissons_ratio);
                    let mut corrected = plan.condense(std::slice::from_ref(&body)).remove(0);
                    NearField::correct([&near_field, &near_field], 0.0, &body, &mut corrected);
                    let exact = modes.works_of_modes(side, &[concentric.boundary_modes()]).remove(0);
                    let off = corrected.iter().zip(&exact).map(|(corrected, exact)| corrected - exact);
                    greatest(off) / concentric.compliance().even
                };
                let references: Vec<ConcentricBody> = class.references().collect();
                assert_eq!(class.layer_count(), grading.layer_count, "{class:?}");
                on_nodes.extend(references.iter().map(left));
                for (idealization, low, high) in states {
                    for i in 0..20 {
                        let poissons_ratio = low + (high - low) * (f64::from(i) + 0.5) / 20.0;
                        let other = ConcentricBody { idealization, poissons_ratio, ..references[0].clone() };
                        between.push(left(&other));
                    }
                }
            }
            let [on_nodes, between] = [on_nodes, between].map(greatest);
            let limit = match (range, level) {
                (PoissonRange::Positive | PoissonRange::Auxetic, 0 | 1) => 5e-5,
                (PoissonRange::Positive | PoissonRange::Auxetic, _) => 1e-6,
                _ => 3e-4,
            };
            println!("{range:?}, level {level}: {on_nodes:.0e} on nodes, {between:.1e} between");
            assert!(on_nodes < 1e-12 && between < limit, "{range:?} {level}: {on_nodes:e} {between:e}");
        }
    }
}

/// Where all bodies of a side have a ratio and an outline in common, the near field is made for these and leaves nothing, in the middle of ranges and
/// at their ends. The other side, and what is not in common, have nodes and steps.
#[test]
fn what_bodies_have_in_common_has_a_near_field_of_its_own() {
    use Idealization::{PlaneStrain, PlaneStress};
    let count = |[first, second]: [NearFieldClass; 2]| {
        [first.references().count(), if first == second { 1 } else { 2 }]
    };
    for (idealization, poissons_ratio) in [
        (PlaneStress, 0.3),
        (PlaneStress, 0.0),
        (PlaneStress, 0.5),
        (PlaneStrain, 0.4),
        (PlaneStrain, 0.499_99),
        (PlaneStress, -0.999),
        (PlaneStrain, -0.9),
    ] {
        for (name, ratio) in [("annulus", 1.35), ("annulus", 3.0), ("rigid-core", 0.4)] {
            let own = body(name, &[ratio], idealization, poissons_ratio);
            for level in [0, 3] {
                let grading = GradingClass::of(&own, ElementKind::Quad8, level);
                let around = |poissons_ratio: bool, outline: bool, swapped: bool| {
                    let (of_side, other) = (Common { poissons_ratio, outline }, Common::default());
                    let (pins, plates) = match (own.shape.side == Side::Pin) != swapped {
                        true => (of_side, other),
                        false => (other, of_side),
                    };
                    let common = InCommon { pins, plates };
                    let (classes, between) = NearFieldClass::around(&own, grading, &common);
                    let each = NearFieldClass::around_each([&own].into_iter(), grading, &common);
                    assert!(each.eq([(classes, between)]));
                    (classes, between)
                };
                let nodes = count(around(false, false, false).0)[0];
                assert!(nodes >= 6);
                assert_eq!(count(around(true, true, true).0), [nodes, 2]);
                assert_eq!(count(around(false, true, false).0), [nodes, 1]);
                assert_eq!(count(around(true, false, false).0), [1, 2]);
                let (classes, between) = around(true, true, false);
                assert_eq!(count(classes), [1, 1]);
                assert_eq!(classes[0].layer_count(), grading.layer_count);

                let near_fields = classes.map(near_field);
                let mut corrected = plan(&own, &grading).condense(std::slice::from_ref(&own)).remove(0);
                NearField::correct(near_fields.each_ref(), between, &own, &mut corrected);
                let reference = ConcentricBody::bare(ratio, poissons_ratio, idealization);
                let modes = RingModes::of(&grading);
                let exact = modes.works_of_modes(own.shape.side, &[reference.boundary_modes()]).remove(0);
                let off = corrected.iter().zip(&exact).map(|(corrected, exact)| corrected - exact);
                let off = greatest(off) / reference.compliance().even;
                println!("{name} {ratio}, {idealization:?}, {poissons_ratio}, level {level}: {off:.0e}");
                // What the unit of growths leaves.
                assert!(off < 1e-6, "{name} {ratio} {idealization:?} {poissons_ratio} {level}: {off:e}");
            }
        }
    }
}

/// Plane stress and plane strain with the same shear modulus over the bulk modulus are one body but for E', on a mesh and exactly.
#[test]
fn either_plane_state_stands_for_the_other() {
    use Idealization::{PlaneStrain, PlaneStress};
    for (name, ratio) in [("annulus", 1.7), ("rigid-core", 0.4)] {
        for (idealization, poissons_ratio, stands) in [
            (PlaneStress, 0.45, PlaneStrain),
            (PlaneStress, 0.0, PlaneStrain),
            (PlaneStrain, -0.6, PlaneStress),
        ] {
            let own = body(name, &[ratio], idealization, poissons_ratio);
            let (other, yields) = own.of_either_state();
            assert_eq!(other.idealization, stands);
            let class = GradingClass::of(&own, ElementKind::Quad8, 1);
            let plan = plan(&own, &class);
            let [meshed, others] =
                [&own, &other].map(|body| plan.condense(std::slice::from_ref(body)).remove(0));
            let scaled: Vec<f64> = others.iter().map(|work| yields * work).collect();
            let modes = |body: &Body| ConcentricBody::of(body).unwrap().boundary_modes().concat();
            let exact: Vec<f64> = modes(&other).iter().map(|mode| yields * mode).collect();
            let worst = difference(&scaled, &meshed).max(difference(&exact, &modes(&own)));
            assert!(worst < 1e-12, "{name} {idealization:?} {poissons_ratio}: {worst:e}");
            // What stands for it stands for itself.
            let (again, yields) = other.of_either_state();
            assert_eq!((&again, yields), (&other, 1.0));
        }
    }
}
