//! Bodies on the coarsest meshes are condensed in single precision: what that leaves of forces, and what it does not hang on.

use crate::common::draws::{concentric, draw, half_disc_in_annulus};
use crate::common::random::Random;
use jointsweep::internals::engine::accuracy::single_precision::OF_SINGLES;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, Part};

const COUNT: u64 = 3000;

fn solve(cases: &[DesignCase], accuracy: f64, in_double: bool) -> Vec<DesignOutcome> {
    let options = SolveOptions { accuracy, method: MethodChoice::Fe };
    let mut ladder = Ladder::new(options);
    if in_double { ladder.in_double().solve(cases) } else { ladder.solve(cases) }
}

/// A soft ring, so wide that its far boundary is hardly felt, on half a disc or a pin around a needle: elements of very different sizes.
fn soft_and_wide(random: &mut Random) -> (Part, Part) {
    let is_half = random.unit() < 0.5;
    let (mut pin, mut ring) = if is_half { half_disc_in_annulus(random) } else { concentric(random) };
    if !is_half {
        pin.parameters[0] = random.log(0.0035, 0.03);
    }
    ring.material.youngs_modulus = 1.0;
    ring.parameters[0] = random.log(50.0, 300.0);
    (pin, ring)
}

/// Wider than what meshes were measured of.
fn too_wide(random: &mut Random) -> (Part, Part) {
    let (mut pin, mut ring) = concentric(random);
    pin.parameters[0] = 1e-3;
    ring.parameters[0] = 400.0;
    (pin, ring)
}

/// Forces of random joints against double precision on the same meshes.
#[test]
fn single_precision_leaves_no_more_than_is_said() {
    let steps = |outcomes: Vec<DesignOutcome>| -> Vec<_> {
        outcomes.into_iter().map(|outcome| outcome.steps).collect()
    };
    for (name, cases) in [
        ("concentric", draw(301, COUNT, concentric)),
        ("half disc", draw(302, COUNT, half_disc_in_annulus)),
        ("soft and wide", draw(303, COUNT, soft_and_wide)),
    ] {
        let (mut differences, mut count) = (Vec::new(), 0);
        for (found, expected) in solve(&cases, 0.01, false).iter().zip(solve(&cases, 0.01, true)) {
            let [found, expected] = [found, &expected].map(|outcome| outcome.steps[0].response);
            let (Some(found), Some(expected)) = (found, expected) else { continue };
            count += 1;
            // Others are on another mesh, or on finer ones, which are in double.
            if ((found.force_error - expected.force_error) / OF_SINGLES - 1.0).abs() < 0.1 {
                differences.push((found.force / expected.force - 1.0).abs());
            }
        }
        differences.sort_by(f64::total_cmp);
        let said = differences.len();
        let [median, most] = [differences[said / 2], differences[said - 1]];
        println!("{name}: {count} forces, {said} in single precision, median {median:.1e}, worst {most:.1e}");
        assert!(count > COUNT * 9 / 10 && said as u64 > count * 8 / 10, "{name}: {said} of {count}");
        // It is single precision that is looked at.
        assert!(median > 1e-8 && most < OF_SINGLES, "{name}: {median:e}, {most:e}");
        // Finer accuracies are computed in double.
        let [single, double] = [false, true].map(|in_double| steps(solve(&cases[..300], 9e-3, in_double)));
        assert_eq!(single, double, "{name}");
    }
    // And so is what was never measured.
    let cases = draw(304, 300, too_wide);
    let [single, double] = [false, true].map(|in_double| steps(solve(&cases, 0.01, in_double)));
    assert!(single.iter().filter(|steps| steps[0].response.is_some()).count() > 200);
    assert_eq!(single, double);
}
