//! What the planner says of itself, and that it does what it says.

use std::path::Path;

use crate::common::greatest::greatest;
use jointsweep::internals::engine::explain::{Explainer, Explanation};
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::Method;
use jointsweep::internals::study::config::Study;

/// A study of one joint, or of 100,000 that are drawn.
fn study(pin: &str, plate: &str, solve: &str, count: Option<u64>) -> Study {
    let (pin_ratio, sampling) = match count {
        None => ("0.3", String::new()),
        Some(count) => (
            "{ from = 0.1, to = 0.4 }",
            format!("[sampling]\nmethod = \"latin-hypercube\"\ncount = {count}\nseed = 1\n"),
        ),
    };
    let text = format!(
        r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = "0.05 mm"
thickness = "8 mm"
[joint.pin]
{pin}
youngs_modulus = "210 GPa"
poissons_ratio = {pin_ratio}
[joint.plate]
{plate}
youngs_modulus = "210 GPa"
poissons_ratio = {pin_ratio}
[load]
indentation = ["0.01 mm", "0.1 mm"]
[solve]
{solve}
{sampling}
"#
    );
    Study::from_text(Path::new("explained.toml"), text).unwrap()
}

const DISC: &str = "model = \"rigid-core\"";
const HALF: &str = "model = \"rigid-midplane\"";
const RING: &str = "model = \"annulus\"\nouter_radius_ratio = 3.0";
const BLOCK: &str =
    "model = \"block\"\nhalf_width_ratio = 3.0\ndepth_ratio = 3.0\nheight_ratio = 3.0\nsupport = \"base\"";

const SLENDER: &str =
    "model = \"block\"\nhalf_width_ratio = 2.0\ndepth_ratio = 4.0\nheight_ratio = 3.0\nsupport = \"base\"";

/// The explanation of the first design, and the method of its rows, the greatest error and how many are answered.
fn explained(study: &Study) -> (Explanation, Option<(Method, f64, usize)>) {
    let case = study.cases().unwrap().next().unwrap().unwrap();
    let explanation = Explainer::new(study).explain(&case);
    let outcome = Ladder::new(study.solve).sharing(study.in_common()).solve(&[case]).remove(0);
    let responses: Vec<_> = outcome.steps.iter().filter_map(|step| step.response).collect();
    let worst = || greatest(responses.iter().map(|response| response.force_error));
    (explanation, responses.first().map(|response| (response.method, worst(), responses.len())))
}

/// What was ruled out, for a reason that holds the words.
fn is_ruled_out(explanation: &Explanation, what: &str, why: &str) -> bool {
    explanation.ruled_out.iter().any(|(one, reason)| one.contains(what) && reason.contains(why))
}

#[test]
fn each_rung_is_told_and_taken() {
    for (pin, plate, solve, chosen, method, bodies, told) in [
        (DISC, RING, "accuracy = \"1 %\"", "series", Method::Series, 2, 3.0062753968253968e-5),
        (DISC, RING, "accuracy = \"1 %\"\nmethod = \"fe\"", "mesh level 0", Method::Fe, 2, 0.01),
        (HALF, RING, "accuracy = \"1 %\"", "mesh level 0", Method::Fe, 2, 0.01),
        (HALF, RING, "accuracy = \"0.1 %\"", "mesh level 0", Method::Fe, 2, 0.001),
        (HALF, RING, "accuracy = \"0.05 %\"", "mesh level 1", Method::Fe, 2, 0.0005),
        (HALF, RING, "accuracy = \"0.003 %\"", "mesh levels 4 and 5", Method::Fe, 3, 3e-05),
        (DISC, BLOCK, "accuracy = \"10 %\"", "mesh level 0", Method::Fe, 2, 0.1),
        (DISC, BLOCK, "accuracy = \"1 %\"", "mesh level 0", Method::Fe, 2, 0.01),
        (DISC, SLENDER, "accuracy = \"1 %\"", "mesh level 0", Method::Fe, 2, 0.01),
        (DISC, SLENDER, "accuracy = \"0.1 %\"", "mesh level 2", Method::Fe, 2, 0.001),
        (DISC, RING, "method = \"closed-form\"", "closed form", Method::ClosedForm, 0, 1.0),
    ] {
        let (explanation, taken) = explained(&study(pin, plate, solve, None));
        let (taken, error, answered) = taken.unwrap();
        // The deeper load is beyond Johnson's law.
        assert_eq!(answered, if method == Method::ClosedForm { 1 } else { 2 }, "{chosen}");
        assert_eq!((explanation.chosen.as_str(), taken), (chosen, method), "{solve}");
        assert_eq!(explanation.bodies.len(), bodies, "{chosen}");
        assert_eq!(explanation.error, told, "{chosen}, {solve}");
        assert!(error <= told && explanation.time.seconds() > 0.0, "{chosen}: {error}");
    }
}

#[test]
fn what_is_ruled_out_has_its_reason() {
    let (fe, _) = explained(&study(DISC, RING, "accuracy = \"0.05 %\"\nmethod = \"fe\"", None));
    assert!(is_ruled_out(&fe, "series for the annulus", "asks for meshes"));
    assert!(is_ruled_out(&fe, "series for the rigid-core", "asks for meshes"));
    assert!(is_ruled_out(&fe, "mesh level 0 alone", "0.05 % is asked"));
    assert!(is_ruled_out(&fe, "closed form", "extent"));
    let (alone, _) = explained(&study(DISC, RING, "accuracy = \"0.1 %\"", None));
    assert!(is_ruled_out(&alone, "interpolation", "too few distinct bodies in 1 designs"));
    let (block, _) = explained(&study(DISC, SLENDER, "accuracy = \"0.1 %\"", None));
    assert!(is_ruled_out(&block, "series for the block", "no exact modes"));
    assert!(is_ruled_out(&block, "mesh level 0 alone", "0.1 % is asked"));
    assert!(!block.ruled_out.iter().any(|(what, _)| what.contains("rigid-core")));
    let (fine, _) = explained(&study(DISC, RING, "accuracy = \"0.01 %\"", None));
    assert!(is_ruled_out(&fine, "interpolation", "0.1 % at best"));
    let (refused, taken) = explained(&study(HALF, RING, "method = \"series\"", None));
    assert_eq!((refused.chosen.as_str(), taken), ("refused", None));
}

/// A large sweep is interpolated, unless that is forbidden; its designs are counted by what is chosen.
#[test]
fn a_large_sweep_is_told_by_what_is_chosen() {
    let large = study(HALF, RING, "accuracy = \"1 %\"", Some(100_000));
    let (shares, looked_at) = Explainer::new(&large).shares().unwrap();
    assert!(looked_at < 100_000 && looked_at > 40_000, "{looked_at}");
    // Of each to the nearest.
    assert!(shares.values().map(|share| share.designs).sum::<u64>().abs_diff(100_000) < 3);
    assert!(shares["interpolated"].designs > 99_000, "{shares:?}");
    let off = study(HALF, RING, "accuracy = \"1 %\"\ninterpolation = \"off\"", Some(100_000));
    let explainer = Explainer::new(&off);
    let (shares, _) = explainer.shares().unwrap();
    assert_eq!(shares["mesh level 0"].designs, 100_000);
    let case = off.cases().unwrap().next().unwrap().unwrap();
    assert!(is_ruled_out(&explainer.explain(&case), "interpolation", "off"));
}
