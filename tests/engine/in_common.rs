//! Near fields of sweeps whose bodies have something in common.

use std::ops::ControlFlow;
use std::path::Path;

use crate::common::greatest::greatest;
use jointsweep::internals::engine::cost;
use jointsweep::internals::engine::joint_curve::JointCurve;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::StepOutcome;
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::mechanics::compliance::near_field::InCommon;
use jointsweep::internals::study::config::{SolveOptions, Study};
use jointsweep::internals::study::design::DesignCase;

const WIDTHS: &str = "{ from = 1.5, to = 3.0 }";

/// Blocks, whose clearances vary; the Poisson's ratio and the half width ratio of their plates as they are given.
fn study(plate_ratio: &str, half_width_ratio: &str, accuracy: &str) -> Study {
    let text = format!(
        r#"
[joint]
idealization = "plane-strain"
hole_radius = "10 mm"
radial_clearance = {{ from = "0.01 mm", to = "0.1 mm" }}
thickness = "8 mm"
[joint.pin]
model = "rigid-midplane"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "block"
half_width_ratio = {half_width_ratio}
depth_ratio = 2.0
height_ratio = 1.6
support = "base"
youngs_modulus = "70 GPa"
poissons_ratio = {plate_ratio}
[load]
indentation = ["0.01 mm", "0.1 mm"]
[solve]
accuracy = "{accuracy}"
interpolation = "off"
[sampling]
method = "sobol"
count = 40
[output]
laws = false
"#
    );
    Study::from_text(Path::new("shared.toml"), text).unwrap()
}

fn forces<'a>(steps: impl Iterator<Item = &'a StepOutcome>) -> Vec<f64> {
    steps.map(|step| step.response.expect("an answer").force).collect()
}

fn solved(ladder: &mut Ladder, cases: &[DesignCase]) -> Vec<f64> {
    forces(ladder.solve(cases).iter().flat_map(|outcome| &outcome.steps))
}

/// Sweeps use them, by the config alone: whichever designs are solved together, each comes to the same bits. What nodes of Poisson's ratio and steps
/// of the layers' growth leave of the forces is gone with them.
#[test]
fn sweeps_make_near_fields_for_what_they_have_in_common() {
    let drawn = "{ from = 0.2, to = 0.4 }";
    for (ratio, widths, accuracy) in
        [("0.33", WIDTHS, "1 %"), ("0.33", WIDTHS, "0.3 %"), (drawn, "2.2", "1 %"), ("0.33", "2.2", "1 %")]
    {
        let study = study(ratio, widths, accuracy);
        let cases: Vec<DesignCase> = study.cases().unwrap().map(Result::unwrap).collect();
        let mut swept = Vec::new();
        sweep::run(&study, &SweepOptions { threads: 2, ..Default::default() }, &mut |outcome| {
            swept.extend(forces(outcome.steps.iter()));
            Ok(ControlFlow::Continue(()))
        })
        .unwrap();
        let shared = || Ladder::new(study.solve).sharing(study.in_common());
        let apart: Vec<f64> = cases.chunks(7).flat_map(|cases| solved(&mut shared(), cases)).collect();
        assert_eq!(swept, apart);
        let by_nodes = solved(&mut Ladder::new(study.solve), &cases);
        let off = greatest(swept.iter().zip(&by_nodes).map(|(own, by_nodes)| own / by_nodes - 1.0));
        println!("{ratio}, {widths}, {accuracy}: nodes and steps leave {off:.1e} of the force");
        assert!(off > 1e-9 && off < 1e-5, "{ratio}, {widths}, {accuracy}: {off:e}");
    }
}

/// A joint by itself has them, too, and goes on having them as its ratio changes: its force is smooth.
#[test]
fn curves_of_joints_have_near_fields_of_their_own() {
    let study = study("0.33", WIDTHS, "1 %");
    let case = study.cases().unwrap().next().unwrap().unwrap();
    let options = SolveOptions { accuracy: 0.01, ..study.solve };
    let force = |ratio: f64| {
        let mut joint = case.joint.clone();
        joint.plate.material.poissons_ratio = ratio;
        let curve = JointCurve::after(None, &case.joint, options).unwrap().of_other(&joint);
        forces(curve.answers(&case.steps).iter())[1]
    };
    let [low, own, high] = [0.3299, 0.33, 0.3301].map(force);
    let alone = solved(&mut Ladder::new(options).sharing(InCommon::ALL), std::slice::from_ref(&case))[1];
    assert_eq!(own, alone);
    let by_nodes = solved(&mut Ladder::new(options), std::slice::from_ref(&case))[1];
    assert_ne!(own, by_nodes);
    let bend = (low - 2.0 * own + high).abs() / own;
    println!("between ratios the force bends by {bend:.1e}");
    assert!(bend < 1e-7, "{bend:e}");
}

/// A forecast knows that one near field costs less than those of all nodes: with two ratios there are twice as many bodies, and more than twice the
/// cost.
#[test]
fn what_is_in_common_is_forecast_to_cost_less() {
    let [shared, two] = ["0.33", "{ from = 0.33, to = 0.330001, count = 2 }"].map(|ratio| {
        let text = std::fs::read_to_string("configs/thin-walls.toml").unwrap();
        let given = "poissons_ratio   = 0.33";
        assert!(text.contains(given));
        let text = text.replace(given, &format!("poissons_ratio = {ratio}"));
        let time = cost::estimate(&Study::from_text(Path::new("thin.toml"), text).unwrap()).unwrap().time;
        time.in_lanes + time.others
    });
    assert!(shared < 0.45 * two, "{shared} of {two}");
}
