//! Bonded layers against the radial equations of elasticity, integrated step by step: no fields of Michell's, no matrices of layers.
//!
//! With u_r = U cos(n phi), u_phi = V sin(n phi) and the stresses S cos(n phi) and T sin(n phi), E and nu those of plane stress,
//!
//! ```text
//!   U' = S (1 - nu^2)/E - nu (U + n V)/r             V' = 2 (1 + nu) T/E + (V + n U)/r
//!   S' = -(S - H)/r - n T/r                          T' = (n H - 2 T)/r,       H = E (U + n V)/r + nu S.
//! ```

use crate::common::random::Random;
use crate::common::stepped_ring::{Beyond, Ring};
use crate::series::far_mode;
use jointsweep::internals::mechanics::body::lining::{Interface, Lining};
use jointsweep::internals::mechanics::compliance::concentric_body::ConcentricBody;
use jointsweep::internals::mechanics::compliance::series::Infinite;
use jointsweep::internals::mechanics::material::Idealization;

/// U, V, S, T.
type State = [f64; 4];

/// Steps through each layer: Runge and Kutta's rule of fourth order leaves 1e-11.
const STEPS: usize = 3000;

fn slope(n: f64, modulus: f64, ratio: f64, r: f64, [u, v, s, t]: State) -> State {
    let hoop = modulus * (u + n * v) / r + ratio * s;
    [
        s * (1.0 - ratio * ratio) / modulus - ratio * (u + n * v) / r,
        2.0 * (1.0 + ratio) * t / modulus + (v + n * u) / r,
        -(s - hoop) / r - n * t / r,
        (n * hoop - 2.0 * t) / r,
    ]
}

fn through(n: f64, modulus: f64, ratio: f64, [from, to]: [f64; 2], mut state: State) -> State {
    let step = (to - from) / STEPS as f64;
    let moved =
        |state: State, slope: State, by: f64| -> State { std::array::from_fn(|i| state[i] + by * slope[i]) };
    for i in 0..STEPS {
        let r = from + i as f64 * step;
        let slope = |r: f64, state: State| slope(n, modulus, ratio, r, state);
        let first = slope(r, state);
        let second = slope(r + 0.5 * step, moved(state, first, 0.5 * step));
        let third = slope(r + 0.5 * step, moved(state, second, 0.5 * step));
        let fourth = slope(r + step, moved(state, third, step));
        state = std::array::from_fn(|k| {
            state[k] + step / 6.0 * (first[k] + 2.0 * second[k] + 2.0 * third[k] + fourth[k])
        });
    }
    state
}

/// Displacements normal to the ring, away from the contact, and along it under a pressure of mode n.
fn integrated(body: &ConcentricBody, n: usize) -> [f64; 2] {
    let plane = |modulus: f64, ratio: f64| match body.idealization {
        Idealization::PlaneStress => (modulus, ratio),
        Idealization::PlaneStrain => (modulus / (1.0 - ratio * ratio), ratio / (1.0 - ratio)),
    };
    let interfaces = body.lining.list();
    let mut radii = vec![1.0];
    radii.extend(interfaces.iter().map(|interface| interface.radius_ratio));
    radii.push(body.fixed_radius_ratio);
    let mut materials = vec![plane(1.0, body.poissons_ratio)];
    materials
        .extend(interfaces.iter().map(|interface| plane(interface.modulus_ratio, interface.poissons_ratio)));
    // From the held circle, under either stress there.
    let from_held = |stress: [f64; 2]| {
        let mut state = [0.0, 0.0, stress[0], stress[1]];
        for (layer, &(modulus, ratio)) in materials.iter().enumerate().rev() {
            state = through(n as f64, modulus, ratio, [radii[layer + 1], radii[layer]], state);
        }
        state
    };
    let [one, other] = [from_held([1.0, 0.0]), from_held([0.0, 1.0])];
    // Mixed so that the ring has S = -1 and T = 0. Without waves there is no T.
    let [a, b] = if n == 0 {
        [-1.0 / one[2], 0.0]
    } else {
        let determinant = one[2] * other[3] - other[2] * one[3];
        [-other[3] / determinant, one[3] / determinant]
    };
    let [radial, along] = [0, 1].map(|i| a * one[i] + b * other[i]);
    [if body.fixed_radius_ratio > 1.0 { radial } else { -radial }, along]
}

/// The same by `series`.
fn by_modes(body: &ConcentricBody, n: usize) -> [f64; 2] {
    let [normal, along] = body.boundary_modes();
    let Infinite { even, odd, bed } = body.infinite();
    let (m, is_plate) = (n as f64, body.fixed_radius_ratio > 1.0);
    let far = match n {
        0 => return [2.0 * normal[0] + bed, 0.0],
        1 => [even, 0.0],
        _ => {
            [even * m + odd, if is_plate { f64::NAN } else { even + odd * m }].map(|far| far / (m * m - 1.0))
        }
    };
    [normal[n] + far[0] + bed, along[n] + far[1]]
}

fn drawn(random: &mut Random, side: usize) -> ConcentricBody {
    let idealization = Idealization::ALL[(random.unit() * 2.0) as usize];
    let layers = 1 + (random.unit() * 3.0) as usize;
    let mut radius = 1.0;
    let interfaces = (0..layers).map(|_| {
        let thickness = random.log(0.05, 0.15);
        radius *= if side == 0 { 1.0 + thickness } else { 1.0 - thickness };
        Interface {
            radius_ratio: radius,
            modulus_ratio: random.log(0.01, 100.0),
            poissons_ratio: random.linear(0.0, 0.45),
        }
    });
    let lining = Lining::new(interfaces.collect());
    let fixed_radius_ratio =
        if side == 0 { radius * random.linear(1.1, 2.0) } else { radius * random.linear(0.4, 0.9) };
    ConcentricBody {
        lining,
        ..ConcentricBody::bare(fixed_radius_ratio, random.linear(0.0, 0.45), idealization)
    }
}

#[test]
fn modes_are_those_of_the_radial_equations() {
    let mut random = Random::new(18);
    let mut compared = 0;
    let mut worst = 0.0_f64;
    for draw in 0..24 {
        let body = drawn(&mut random, draw % 2);
        for n in [0, 1, 2, 3, 5, 9, 14] {
            let (exact, found) = (integrated(&body, n), by_modes(&body, n));
            for (exact_part, found_part) in exact.into_iter().zip(found).filter(|(_, found)| !found.is_nan())
            {
                let off = (found_part - exact_part).abs() / exact[0].abs();
                assert!(off < 2e-9, "{body:?} {n}: {found:?} {exact:?}");
                worst = worst.max(off);
                compared += 1;
            }
        }
    }
    println!("{compared} amplitudes, worst {worst:e}");
    // Of plates what is along the ring is compared in modes 0 and 1.
    assert_eq!(compared, 12 * 14 + 12 * 9);
}

/// Films too thin for all modes are a bed on what lies beyond them, alone or on another layer: the modes that there are stay what they are.
#[test]
fn modes_of_films_are_those_of_rings_that_are_stepped_through() {
    let mut random = Random::new(20);
    let (mut compared, mut on_beds, mut worst) = (0, 0, 0.0_f64);
    for draw in 0..40 {
        let idealization = Idealization::ALL[draw / 2 % 2];
        let outwards = if draw % 2 == 0 { 1.0 } else { -1.0 };
        let thickness = random.log(3e-5, 2e-3);
        let mut interface = |radius_ratio: f64| Interface {
            radius_ratio,
            modulus_ratio: random.log(10.0, 1000.0),
            poissons_ratio: random.linear(0.0, 0.45),
        };
        let mut interfaces = vec![interface(1.0 + outwards * thickness)];
        if draw % 3 == 0 {
            interfaces.push(interface(1.0 + outwards * 0.1));
        }
        let poissons_ratio = random.linear(0.0, 0.49);
        let beyond = interfaces.iter().map(|one| Beyond {
            radius_ratio: one.radius_ratio,
            youngs_modulus: one.modulus_ratio,
            poissons_ratio: one.poissons_ratio,
        });
        let beyond: &[Beyond] = beyond.collect::<Vec<_>>().leak();
        let fixed_radius_ratio = if draw % 2 == 0 { 2.5 } else { 0.3 };
        let ring = Ring { fixed_radius_ratio, youngs_modulus: 1.0, poissons_ratio, idealization, beyond };
        let lining = Lining::new(interfaces);
        let body = ConcentricBody {
            lining,
            ..ConcentricBody::bare(fixed_radius_ratio, poissons_ratio, idealization)
        };
        on_beds += usize::from(body.infinite().bed > 0.0);
        for n in [0, 1, 2, 9, 60, 400, 1500] {
            let (exact, found) = (ring.mode(n), by_modes(&body, n)[0]);
            let off = (found / exact - 1.0).abs();
            assert!(off < 1e-8, "{body:?} {n}: {found} {exact}");
            worst = worst.max(off);
            compared += 1;
        }
    }
    println!("{compared} amplitudes of 40 bodies, {on_beds} with beds, worst {worst:e}");
    assert!(compared == 280 && on_beds >= 30, "{compared} {on_beds}");
}

/// A body that is cut into layers of its own material is the bare one.
#[test]
fn layers_of_one_material_are_no_layers() {
    let mut random = Random::new(19);
    let mut compared = 0;
    for draw in 0..40 {
        let lined = drawn(&mut random, draw % 2);
        let interface = |one: &Interface| Interface {
            modulus_ratio: 1.0,
            poissons_ratio: lined.poissons_ratio,
            radius_ratio: one.radius_ratio,
        };
        let cut = Lining::new(lined.lining.list().iter().map(interface).collect());
        let cut = ConcentricBody { lining: cut, ..lined };
        let bare = ConcentricBody { lining: Lining::NONE, ..cut.clone() };
        let (cut_modes, bare_modes) = (cut.boundary_modes(), bare.boundary_modes());
        for (of_cut, of_bare) in cut_modes.iter().zip(&bare_modes) {
            for (n, (of_cut, of_bare)) in of_cut.iter().zip(of_bare).enumerate() {
                let whole = if n < 2 { bare.amplitude() } else { far_mode(&bare, n)[0] };
                assert!((of_cut - of_bare).abs() < 1e-10 * whole, "{cut:?} {n}: {of_cut} {of_bare}");
                compared += 1;
            }
        }
    }
    assert!(compared > 2000, "{compared}");
}

/// A layer of no thickness to speak of, one behind which all is rigid, and one behind which nothing is: the body beyond it, the bare
/// layer on a held circle, and the bare layer on a far softer body.
#[test]
fn limits_of_layers_are_bare_bodies() {
    for (fixed, thin, thick) in [(3.0, 1.0 + 1e-7, 1.2), (0.2, 1.0 - 1e-7, 0.8)] {
        let body =
            |fixed_radius_ratio: f64, poissons_ratio: f64, interfaces: Vec<Interface>| ConcentricBody {
                lining: Lining::new(interfaces),
                ..ConcentricBody::bare(fixed_radius_ratio, poissons_ratio, Idealization::PlaneStrain)
            };
        let steel = |radius_ratio: f64, modulus_ratio: f64| Interface {
            radius_ratio,
            modulus_ratio,
            poissons_ratio: 0.3,
        };
        for n in [0, 1, 2, 4, 7] {
            // Of modulus 1 beyond a thin film of the same stiffness, nearly incompressible.
            let film = by_first_modes(&body(fixed, 0.499, vec![steel(thin, 1.0)]), n);
            let bare = by_first_modes(&body(fixed, 0.3, vec![]), n);
            assert!((film / bare - 1.0).abs() < 1e-5, "film {n}: {film} {bare}");
            let on_rigid = by_first_modes(&body(fixed, 0.4, vec![steel(thick, 1e9)]), n);
            let held = by_first_modes(&body(thick, 0.4, vec![]), n);
            assert!((on_rigid / held - 1.0).abs() < 1e-7, "rigid {n}: {on_rigid} {held}");
            // Far softer beyond: what is beyond yields alone, the layer bends with it from mode 2 on.
            if n == 0 {
                let on_soft = by_first_modes(&body(fixed, 0.3, vec![steel(thick, 1e-9)]), n);
                assert!(on_soft.is_finite() && on_soft > bare, "soft {n}: {on_soft} {bare}");
            }
        }
    }
}

/// The normal amplitude of one mode alone.
fn by_first_modes(body: &ConcentricBody, n: usize) -> f64 {
    let normal = body.boundary_mode(n)[0];
    match n {
        0 => 2.0 * normal,
        1 => normal + body.amplitude(),
        _ => normal + far_mode(body, n)[0],
    }
}

/// Modes that are found abreast are those found one by one, of walls from thin ones to those through which nothing is felt.
#[test]
fn modes_abreast_are_those_one_by_one() {
    let mut compared = 0;
    for fixed_radius_ratio in [1.021, 1.5, 50.0, 1e12, 1e60, 0.979, 0.3, 1e-12, 1e-60_f64] {
        let interface = |share: f64, modulus_ratio: f64| Interface {
            radius_ratio: fixed_radius_ratio.powf(share),
            modulus_ratio,
            poissons_ratio: 0.2,
        };
        for lining in [Vec::new(), vec![interface(0.5, 0.1)], vec![interface(0.5, 20.0), interface(0.8, 0.5)]]
        {
            let body = ConcentricBody {
                lining: Lining::new(lining),
                ..ConcentricBody::bare(fixed_radius_ratio, 0.35, Idealization::PlaneStrain)
            };
            let [normal, along] = body.boundary_modes();
            for (n, (normal, along)) in normal.into_iter().zip(along).enumerate() {
                let expected = body.boundary_mode(n);
                // Abreast multiply and add are fused, and thin layers bring out what that rounds.
                let bound = 1e-10 * (expected[0].abs() + expected[1].abs()) + 1e-40;
                for (found, expected) in [normal, along].into_iter().zip(expected) {
                    assert!((found - expected).abs() <= bound, "{body:?}, {n}: {found} {expected}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 4000, "{compared}");
}
