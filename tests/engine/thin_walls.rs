//! Walls from a tenth of the radius to a millionth of it: right within `force_error` against contact solved node by node on the
//! ring's own modes (tests/common/nodal_ring.rs), with no code of the library's mechanics.

use std::ops::ControlFlow;

use crate::common::nodal_ring::{NodalState, nodal_state};
use crate::common::random::Random;
use crate::common::stepped_ring::Ring;
use crate::extremes::asked_draws;
use jointsweep::internals::engine::cost;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::Response;
use jointsweep::internals::engine::status::Status;
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::mechanics::body::{annulus, cored_disc};
use jointsweep::internals::mechanics::material::{Idealization, Material};
use jointsweep::internals::study::config::{MethodChoice, SolveOptions, Study};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load, Part};

/// dR/R2, so small that the outlines do not matter.
const CLEARANCE: f64 = 1e-6;

/// Panels of a nodal solution, and its error: twice the change from 150 to 300 panels, 1.2e-5 at most in these cases.
const PANELS: usize = 200;
const NODAL_ERROR: f64 = 2.4e-5;

#[derive(Clone, Copy, Debug)]
struct Joint {
    core: f64,
    ratio: f64,
    moduli: [f64; 2],
    poissons_ratio: f64,
    idealization: Idealization,
}

impl Joint {
    fn outcomes(&self, deltas: &[f64]) -> Vec<(String, Option<Response>)> {
        let part = |shape, ratio, youngs_modulus| Part {
            shape,
            parameters: [ratio, 0.0, 0.0],
            support: 0,
            material: Material { youngs_modulus, poissons_ratio: self.poissons_ratio },
            layers: Default::default(),
            yield_stress: None,
        };
        let joint = JointDesign {
            idealization: self.idealization,
            hole_radius: 1.0,
            radial_clearance: CLEARANCE,
            thickness: 1.0,
            pin: part(&cored_disc::SHAPE, self.core, self.moduli[0]),
            plate: part(&annulus::SHAPE, self.ratio, self.moduli[1]),
        };
        let steps = deltas.iter().map(|delta| Load::Indentation(*delta)).collect();
        let case = DesignCase { index: 0, joint, steps };
        let options = SolveOptions { accuracy: 0.01, method: MethodChoice::Auto };
        let outcome = Ladder::new(options).solve(&[case]).remove(0);
        outcome.steps.into_iter().map(|step| (step.status.to_string(), step.response)).collect()
    }

    fn solve(&self, deltas: &[f64]) -> Vec<Response> {
        let of_load = |(_, response): (String, Option<Response>)| response.expect("every load has an answer");
        self.outcomes(deltas).into_iter().map(of_load).collect()
    }

    fn nodal(&self, delta: f64, reach: f64, panels: usize) -> NodalState {
        let ring = |fixed_radius_ratio, youngs_modulus| Ring {
            fixed_radius_ratio,
            youngs_modulus,
            poissons_ratio: self.poissons_ratio,
            idealization: self.idealization,
            beyond: &[],
        };
        let bodies = [ring(self.core, self.moduli[0]), ring(self.ratio, self.moduli[1])];
        nodal_state(bodies, CLEARANCE, CLEARANCE + delta, reach, panels)
    }
}

/// Beds and rings on modes, thin pins and thin plates, stiff and soft, nearly incompressible and auxetic ones; contacts from
/// four times as wide as the wall is thick to a hundred times.
#[test]
fn thin_walls_are_right_within_what_is_said() {
    use Idealization::{PlaneStrain, PlaneStress};
    let (mut compared, mut errors, mut said) = (0, 0.0, 0.0);
    for (core, ratio, moduli, poissons_ratio, idealization) in [
        (0.1, 1.1, [1e3, 1.0], 0.3, PlaneStress),
        (0.1, 1.05, [1e3, 1.0], 0.3, PlaneStrain),
        (0.1, 1.01, [1e3, 1.0], 0.3, PlaneStress),
        (0.1, 1.01, [1.0, 1.0], 0.45, PlaneStrain),
        (0.1, 1.003, [100.0, 1.0], 0.49, PlaneStrain),
        (0.995, 1.003, [1.0, 1.0], 0.3, PlaneStrain),
        (0.99, 3.0, [1.0, 100.0], -0.5, PlaneStress),
    ] {
        let joint = Joint { core, ratio, moduli, poissons_ratio, idealization };
        let deltas = [1e-9, 1e-8, 1e-7, 1e-6];
        for (delta, found) in deltas.into_iter().zip(joint.solve(&deltas)) {
            let half_angle = found.contact_half_angle.expect("it is said");
            let exact = joint.nodal(delta, 1.25 * half_angle, PANELS);
            let error = (found.force / exact.force - 1.0).abs();
            let of_angle = (half_angle - exact.half_angle).abs();
            println!(
                "core {core}, ratio {ratio}, delta {delta:.0e}: force off by {error:.1e}, said {:.1e}; half angle {:.2} deg by {:.2}",
                found.force_error,
                half_angle.to_degrees(),
                of_angle.to_degrees(),
            );
            assert!(error <= found.force_error + NODAL_ERROR, "{error:e}, said {:e}", found.force_error);
            // Beds of nearly incompressible material press farther than their springs do.
            assert!(of_angle.to_degrees() < 0.5, "{half_angle} for {}", exact.half_angle);
            compared += 1;
            errors += error;
            said += found.force_error;
        }
    }
    assert_eq!(compared, 28);
    // What is said is not much too careful either.
    assert!(said < 4.0 * errors, "said {said:e} for {errors:e}");
}

/// Walls of every thinness drawn, in pin, plate or both; `JOINTSWEEP_DRAWS` draws more.
#[test]
fn walls_drawn_at_random_are_right_or_say_so() {
    // These take a thousand times as long as those of `extremes`.
    let draws = asked_draws().map_or(16, |draws| draws / 500);
    let mut random = Random::new(81);
    let (mut compared, mut warned, mut bounded) = (0, 0, 0);
    for _ in 0..draws {
        let which = (random.unit() * 3.0) as u32;
        let thin = |random: &mut Random| random.log(1e-6, 0.15);
        let core = if which == 0 { 0.2 } else { 1.0 - thin(&mut random) };
        let ratio = if which == 1 { 3.0 } else { 1.0 + thin(&mut random) };
        let joint = Joint {
            core,
            ratio,
            moduli: [1.0, random.log(1e-3, 1e3)],
            poissons_ratio: random.linear(-0.5, 0.49),
            idealization: Idealization::ALL[(random.unit() * 2.0) as usize],
        };
        let delta = CLEARANCE * random.log(0.01, 30.0);
        let (status, found) = joint.outcomes(&[delta]).remove(0);
        let found = found.expect("every wall has an answer");
        let exact = joint.nodal(delta, 1.6 * found.contact_half_angle.expect("it is said"), PANELS);
        let error = (found.force / exact.force - 1.0).abs();
        println!("{core} {ratio} {delta:.1e}: {error:.1e}, said {:.1e}, {status}", found.force_error);
        if !status.contains("accuracy") {
            compared += 1;
            assert!(error <= 0.01, "{joint:?} {delta:e}: {error:e}");
        } else {
            warned += 1;
        }
        bounded += usize::from(error <= found.force_error + NODAL_ERROR);
    }
    println!("{compared} compared, {warned} warned, {bounded} bounded");
    assert!(compared as f64 >= 0.6 * draws as f64 && bounded as f64 >= 0.95 * draws as f64);
}

/// Walls of a millionth of the radius around a rigid pin: a Winkler bed, of which all is known in closed form.
#[test]
fn the_thinnest_wall_is_a_winkler_bed() {
    let (ratio, poissons_ratio) = (1.000_001_f64, 0.3);
    let idealization = Idealization::PlaneStress;
    let joint = Joint { core: 0.999_999, ratio, moduli: [1e9, 1.0], poissons_ratio, idealization };
    let stiffness = 1.0 / ((1.0 - poissons_ratio * poissons_ratio) * ratio.ln());
    let deltas = [1e-8, 1e-7, 1e-6, 1e-5];
    for (delta, found) in deltas.into_iter().zip(joint.solve(&deltas)) {
        let offset = CLEARANCE + delta;
        let half_angle = (CLEARANCE / offset).acos();
        let (sine, cosine) = half_angle.sin_cos();
        let force = stiffness * (offset * (half_angle + sine * cosine) - 2.0 * CLEARANCE * sine);
        let energy = 0.5
            * stiffness
            * (offset * offset * (half_angle + sine * cosine) - 4.0 * offset * CLEARANCE * sine
                + 2.0 * CLEARANCE * CLEARANCE * half_angle);
        for (what, found, exact, limit) in [
            ("force", found.force, force, 1e-5),
            // Ten trial pressures for one that is none of theirs.
            ("stiffness", found.tangent_stiffness, stiffness * (half_angle + sine * cosine), 3e-3),
            ("half angle", found.contact_half_angle.unwrap(), half_angle, 5e-3),
            ("peak pressure", found.peak_pressure.unwrap(), stiffness * delta, 1e-3),
            ("energy", found.energy.unwrap(), energy, 1e-5),
        ] {
            let error = (found / exact - 1.0).abs();
            println!("{delta:.0e}: {what} off by {error:.1e}");
            assert!(error < limit, "{delta:.0e}: {what} {found:e} for {exact:e}");
        }
    }
}

/// Bodies that nothing carries are refused beforehand: the others are solved as without them, at no more cost.
#[test]
fn bodies_beyond_what_is_supported_cost_nothing_and_change_nothing() {
    let header = "hole_radius_mm,radial_clearance_mm,thickness_mm,idealization,pin_model,core_radius_ratio,\
                  pin_youngs_modulus_mpa,pin_poissons_ratio,plate_model,outer_radius_ratio,half_width_ratio,\
                  depth_ratio,height_ratio,plate_support,plate_youngs_modulus_mpa,plate_poissons_ratio,indentation_mm";
    let row = |core: f64, plate: String| {
        format!("10,0.02,5,plane-stress,rigid-core,{core},210000,0.3,{plate},70000,0.3,0.01\n")
    };
    // Half of the designs on meshes have walls or ligaments of a thousandth to a millionth.
    let (mut mixed, mut good) = (format!("{header}\n"), format!("{header}\n"));
    for i in 0..1000 {
        let share = f64::from(i) / 1000.0;
        let thin = 1.0 + 1e-3 * 1e-3_f64.powf(share);
        let plates = [
            format!("annulus,{},,,,", 1.5 + share),
            if i % 2 == 0 { format!("annulus,{thin},,,,") } else { format!("block,,2,{thin},2,outer") },
        ];
        good += &row(0.2, plates[0].clone());
        for plate in plates {
            mixed += &row(0.2, plate);
        }
    }
    let dir = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("thin-walls");
    std::fs::create_dir_all(&dir).unwrap();
    let study = |name: &str, list: &str| {
        std::fs::write(dir.join(format!("{name}.csv")), list).unwrap();
        let config =
            format!("[designs]\nfile = \"{name}.csv\"\n[solve]\nmethod = \"fe\"\ninterpolation = \"off\"\n");
        Study::from_text(&dir.join("study.toml"), config).unwrap()
    };
    let solve = |study: &Study| {
        let mut outcomes = Vec::new();
        sweep::run(study, &SweepOptions::default(), &mut |outcome| {
            outcomes.push(outcome.steps[0].clone());
            Ok(ControlFlow::Continue(()))
        })
        .unwrap();
        outcomes
    };
    let (mixed, good) = (study("mixed", &mixed), study("good", &good));
    let (found, expected) = (solve(&mixed), solve(&good));
    assert_eq!((found.len(), expected.len()), (2000, 1000));
    for (i, expected) in expected.iter().enumerate() {
        assert_eq!(&found[2 * i], expected, "design {}", 2 * i);
        let refused = &found[2 * i + 1];
        let reason = if i % 2 == 0 {
            "failed: the wall of the annulus is "
        } else {
            "failed: the thinnest ligament of the block is "
        };
        assert!(
            refused.response.is_none() && refused.status.to_string().starts_with(reason),
            "{}",
            refused.status
        );
    }
    assert!(expected.iter().all(|step| step.status == Status::OK));
    // What they cost is known beforehand, too: the time of a design that is looked at.
    let [of_mixed, of_good] = [&mixed, &good].map(|study| cost::estimate(study).unwrap());
    assert_eq!((of_mixed.refused, of_good.refused, of_mixed.unknowns), (1000, 0, of_good.unknowns));
    let [of_mixed, of_good] = [of_mixed, of_good].map(|estimate| estimate.time.seconds());
    assert!(of_mixed - of_good < 1000.0 * 20e-6, "{of_mixed} {of_good}");
}
