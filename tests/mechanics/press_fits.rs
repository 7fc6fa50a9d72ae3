//! Press fits against Lame's and the first mode of rings that expand nothing (tests/common/stepped_ring.rs), against pressure piece by
//! piece on panels (tests/common/nodal_ring.rs), and against themselves: energy, force and stiffness as derivatives of each other.
//!
//! Hole radius and thickness are 1 mm.

use std::f64::consts::PI;

use crate::common::nodal_ring::nodal_state;
use crate::common::random::Random;
use crate::common::ring_design::{ring_design, rings};
use crate::common::stepped_ring::Ring;
use jointsweep::internals::engine::joint_curve::JointCurve;
use jointsweep::internals::engine::outcome::Response;
use jointsweep::internals::engine::spaces::SpaceKey;
use jointsweep::internals::mechanics::compliance::arc::ContactArc;
use jointsweep::internals::mechanics::compliance::concentric_body::ConcentricBody;
use jointsweep::internals::mechanics::compliance::pressure_space::{PressureSpace, Tilt};
use jointsweep::internals::mechanics::contact::edge::EdgeStates;
use jointsweep::internals::mechanics::contact::outlines::Outlines;
use jointsweep::internals::mechanics::element::quadrature::gauss_legendre;
use jointsweep::internals::mechanics::material::Idealization;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{JointDesign, Load};

/// Compliances of both together to a pressure that is uniform and to cos(phi).
fn modes(rings: &[Ring; 2]) -> [f64; 2] {
    [0, 1].map(|n| rings.iter().map(|ring| ring.mode(n)).sum())
}

/// By exact modes, as good as they come.
fn curve(joint: &JointDesign) -> JointCurve {
    JointCurve::after(None, joint, SolveOptions { accuracy: 1e-7, method: MethodChoice::Series }).unwrap()
}

fn at(curve: &JointCurve, load: Load) -> Response {
    let step = curve.answers(&[load]).remove(0);
    step.response.unwrap_or_else(|| panic!("{load}: {}", step.status))
}

const OVERLAP: f64 = 1e-3;

/// Closed all around: p = |dR|/lambda_0 + e cos(phi)/lambda_1, F = pi e/lambda_1, up to e = |dR| lambda_1/lambda_0.
#[test]
fn closed_press_fits_are_those_of_two_modes() {
    let mut random = Random::new(300);
    for _ in 0..20 {
        let rings = rings(&mut random);
        let [uniform, first] = modes(&rings);
        let curve = curve(&ring_design(&rings, -OVERLAP));
        let opening = OVERLAP * first / uniform;
        assert!((curve.opening().unwrap() / opening - 1.0).abs() < 1e-7, "{rings:?}");
        for share in [0.0, 1e-6, 0.5, 0.9999] {
            let offset = share * opening;
            let (fit, force) = (OVERLAP / uniform, PI * offset / first);
            let by_force = at(&curve, Load::Force(force));
            for found in [at(&curve, Load::Offset(offset)), by_force] {
                let expected = [
                    (found.force, force),
                    (found.offset, offset),
                    (found.indentation, offset + OVERLAP),
                    (found.tangent_stiffness, PI / first),
                    (found.peak_pressure.unwrap(), fit + offset / first),
                    (found.contact_half_angle.unwrap(), PI),
                    (found.energy.unwrap(), PI * OVERLAP * fit + 0.5 * force * offset),
                ];
                for (found, expected) in expected {
                    assert!((found - expected).abs() <= 3e-8 * expected, "{share}: {found} for {expected}");
                }
            }
            // Of equal pressures at rest that at the load line.
            assert_eq!(at(&curve, Load::Offset(offset)).peak_pressure_angle, Some(0.0));
            let pressure = curve.pressure(Load::Offset(offset), 9);
            assert_eq!(pressure.len(), 9);
            for (angle, pressure) in pressure {
                let expected = fit + offset * angle.cos() / first;
                assert!((pressure - expected).abs() < 3e-8 * fit, "{angle} rad: {pressure} for {expected}");
            }
        }
        let beyond = at(&curve, Load::Offset(1.0001 * opening));
        assert!(beyond.contact_half_angle.unwrap() < PI);
    }
}

/// A steel pin in aluminium of twice its radius: what another program found (lambda_1/lambda_0 and the force that opens it, per mm of
/// overlap and of thickness).
#[test]
fn steel_in_aluminium() {
    let ring = |fixed_radius_ratio, youngs_modulus, poissons_ratio| Ring {
        fixed_radius_ratio,
        youngs_modulus,
        poissons_ratio,
        idealization: Idealization::PlaneStress,
        beyond: &[],
    };
    let curve = curve(&ring_design(&[ring(0.2, 210e3, 0.3), ring(2.0, 70e3, 0.33)], -OVERLAP));
    let closed = at(&curve, Load::Offset(1e-9));
    let opening = 248.2e3 * OVERLAP / closed.tangent_stiffness;
    assert!((opening / OVERLAP - 1.2263).abs() < 1e-3, "{}", opening / OVERLAP);
    let angle = |offset| at(&curve, Load::Offset(offset)).contact_half_angle.unwrap();
    assert!(angle(1.2262 * OVERLAP) == PI && angle(1.2266 * OVERLAP) < PI);
}

/// Panels converge with the square of their width: from two widths, what is left at none.
#[test]
fn open_press_fits_are_those_of_panels() {
    let mut random = Random::new(301);
    let (mut compared, mut worst, mut range) = (0, 0.0_f64, [PI, 0.0_f64]);
    for _ in 0..12 {
        let rings = rings(&mut random);
        let [uniform, first] = modes(&rings);
        let curve = curve(&ring_design(&rings, -OVERLAP));
        let offset = OVERLAP * first / uniform * random.log(1.0005, 10.0);
        let found = at(&curve, Load::Offset(offset));
        let [coarse, fine] = [240, 480].map(|panels| nodal_state(rings, -OVERLAP, offset, PI, panels));
        let expected = fine.force + (fine.force - coarse.force) / 3.0;
        let error = (found.force / expected - 1.0).abs();
        let half_angle = found.contact_half_angle.unwrap();
        println!("{:.1} deg: {error:.1e}", half_angle.to_degrees());
        assert!(error < 1e-5, "{half_angle}: {} for {expected}", found.force);
        // To the panel.
        assert!((half_angle - fine.half_angle).abs() < 1.5 * PI / 480.0, "{half_angle}: {fine:?}");
        let by_force = at(&curve, Load::Force(found.force));
        assert!((by_force.offset / offset - 1.0).abs() < 1e-9, "{}", by_force.offset);
        (compared, worst) = (compared + 1, worst.max(error));
        range = [range[0].min(half_angle), range[1].max(half_angle)];
    }
    println!("force off by {worst:.1e} at half angles of {range:?} rad");
    assert!(compared == 12 && range[0] < 1.9 && range[1] > 2.4, "{range:?}");
}

/// As many joints of each side of zero: a press fit, a neat fit and a clearance of a billionth.
#[test]
fn press_fits_go_over_into_neat_fits() {
    let mut random = Random::new(302);
    for _ in 0..10 {
        let rings = rings(&mut random);
        let answers = [-1e-9, 0.0, 1e-9].map(|clearance| {
            let found = at(&curve(&ring_design(&rings, clearance)), Load::Offset(0.01));
            [
                found.force,
                found.tangent_stiffness,
                found.contact_half_angle.unwrap(),
                found.peak_pressure.unwrap(),
                found.energy.unwrap(),
            ]
        });
        // Half angle and peak pressure are what few trial pressures leave most of.
        let limits = [1e-6, 1e-6, 3e-6, 3e-6, 1e-6];
        for (((below, neat), above), limit) in
            answers[0].into_iter().zip(answers[1]).zip(answers[2]).zip(limits)
        {
            for other in [below, above] {
                assert!((other / neat - 1.0).abs() < limit, "{other} beside {neat}: {rings:?}");
            }
        }
    }
}

/// From deep within the closed contact to far beyond its opening: the force is what the stiffness adds up to, the energy what the force
/// does.
#[test]
fn stiffness_and_force_are_derivatives_across_the_opening() {
    let mut random = Random::new(303);
    let rule = gauss_legendre(20);
    for _ in 0..8 {
        let rings = rings(&mut random);
        let [uniform, first] = modes(&rings);
        let curve = curve(&ring_design(&rings, -OVERLAP));
        let opening = OVERLAP * first / uniform;
        let ends = [0.2, 1.0, 1.02, 1.3, 3.0].map(|share| at(&curve, Load::Offset(share * opening)));
        for (from, to) in ends.iter().zip(&ends[1..]) {
            let mut sums = [0.0; 2];
            for (x, weight) in &rule {
                // Dense at the beginning, where the opening is: the gap is like a root.
                let place = 0.5 * (1.0 + x);
                let length = to.offset - from.offset;
                let state = at(&curve, Load::Offset(from.offset + length * place * place));
                let step = weight * length * place;
                sums[0] += step * state.tangent_stiffness;
                sums[1] += step * state.force;
            }
            let changes = [to.force - from.force, to.energy.unwrap() - from.energy.unwrap()];
            for (sum, change) in sums.into_iter().zip(changes) {
                assert!(
                    (sum / change - 1.0).abs() < 1e-6,
                    "{} to {}: {sum} {change}",
                    from.offset,
                    to.offset
                );
            }
        }
    }
}

/// The pressure on an open arc adds up to the force and ends at zero.
#[test]
fn pressure_on_an_open_arc_is_the_force() {
    let mut random = Random::new(304);
    for _ in 0..8 {
        let rings = rings(&mut random);
        let [uniform, first] = modes(&rings);
        let curve = curve(&ring_design(&rings, -OVERLAP));
        let load = Load::Offset(OVERLAP * first / uniform * random.log(1.05, 5.0));
        let state = at(&curve, load);
        // Evenly spaced in tau with angle = eps sin(tau).
        let points = curve.pressure(load, 2001);
        let ends = points.windows(2).map(|pair| {
            let [(a, p), (b, q)] = [pair[0], pair[1]];
            0.5 * (b - a) * (p * a.cos() + q * b.cos())
        });
        let sum = 2.0 * ends.sum::<f64>();
        assert!((sum / state.force - 1.0).abs() < 1e-5, "{sum} for {}", state.force);
        let most = points.iter().fold(0.0_f64, |most, (_, pressure)| most.max(*pressure));
        assert!((most / state.peak_pressure.unwrap() - 1.0).abs() < 1e-4);
        assert_eq!(points[points.len() - 1].1, 0.0);
        assert!((points[points.len() - 1].0 - state.contact_half_angle.unwrap()).abs() < 1e-12);
    }
}

/// Arcs that both kinds of trial pressures are for: the same states.
#[test]
fn both_maps_of_an_arc_give_the_same_state() {
    let angles = [0.4, 0.8, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2_f64];
    let bodies = [(0.3, 0.3), (2.5, 0.2)].map(|(fixed_radius_ratio, poissons_ratio)| {
        let body = ConcentricBody::bare(fixed_radius_ratio, poissons_ratio, Idealization::PlaneStrain);
        body.compliance()
    });
    let states = [ContactArc::new, |angle: f64| ContactArc::leaving((0.5 * angle).cos())].map(|arc| {
        let mut space = PressureSpace::new(24, angles.map(arc).to_vec());
        bodies.iter().for_each(|body| space.prepare(body));
        let joint = space.joint(&[(&bodies[0], 1.0), (&bodies[1], 0.4)], Tilt::NONE);
        let states = EdgeStates::new(&space, &[&joint], &Outlines::ALIKE);
        let state = |place: usize| states.reduced(place).free_edge(space.arcs[place].b, &Outlines::ALIKE);
        (0..angles.len()).map(state).collect::<Vec<_>>()
    });
    for (tangent, sine) in states[0].iter().zip(&states[1]) {
        let pairs = [
            (tangent.indentation, sine.indentation),
            (tangent.force, sine.force),
            (tangent.tangent_stiffness, sine.tangent_stiffness),
            (tangent.energy, sine.energy),
            (tangent.peak_pressure, sine.peak_pressure),
        ];
        for (tangent, sine) in pairs {
            // What 24 trial pressures leave of where wide arcs end.
            assert!((sine / tangent - 1.0).abs() < 5e-7, "{tangent} {sine}");
        }
    }
}

/// What the coarsest space of an accuracy leaves is said, and the accuracy is met; neat fits, at which curves end, are wider than the
/// narrowest arc.
#[test]
fn spaces_of_press_fits_leave_what_is_said() {
    let mut random = Random::new(305);
    let (mut compared, mut bounded) = (0, 0);
    // Of neat fits, and what closed contact is stiffer by.
    let (mut angles, mut stiffer) = ([180.0_f64, 0.0], [f64::INFINITY, 0.0_f64]);
    for accuracy in [1e-2, 1e-3, 1e-5] {
        assert!(SpaceKey::of_press_fits(accuracy).terms < 24);
        for _ in 0..15 {
            let rings = rings(&mut random);
            let joint = ring_design(&rings, -OVERLAP);
            let exact = curve(&joint);
            let loose =
                JointCurve::after(None, &joint, SolveOptions { accuracy, method: MethodChoice::Auto })
                    .unwrap();
            for ratio in [1.5, 2.0, 10.0, 1e6] {
                let load = Load::Offset(ratio * OVERLAP);
                let (exact, loose) = (at(&exact, load), at(&loose, load));
                let error = (loose.force / exact.force - 1.0).abs();
                assert!(error < accuracy && loose.force_error < accuracy, "{error:e}: {loose:?}");
                compared += 1;
                bounded += usize::from(error <= loose.force_error + exact.force_error);
            }
            let [closed, neat] = [0.0, 1e6 * OVERLAP].map(|offset| at(&exact, Load::Offset(offset)));
            let angle = neat.contact_half_angle.unwrap().to_degrees();
            let ratio = closed.tangent_stiffness / neat.tangent_stiffness;
            angles = [angles[0].min(angle), angles[1].max(angle)];
            stiffer = [stiffer[0].min(ratio), stiffer[1].max(ratio)];
        }
    }
    println!("{bounded} of {compared} bounded; neat fits {angles:?} deg, closed ones stiffer by {stiffer:?}");
    assert!(compared == 180 && 100 * bounded >= 95 * compared, "{bounded} of {compared}");
    assert!(angles[0] > 75.0 && angles[1] < 120.0 && stiffer[0] > 1.3 && stiffer[1] < 2.2);
}
