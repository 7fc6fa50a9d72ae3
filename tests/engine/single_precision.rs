//! Bodies on the coarsest meshes are condensed in single precision: what that leaves of forces, and what it does not hang on.

use crate::common::draws::{concentric, draw, half_disc_in_annulus};
use jointsweep::internals::engine::accuracy::known_errors::Group;
use jointsweep::internals::engine::accuracy::single_precision::error_of_singles;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::DesignCase;

const COUNT: u64 = 3000;

fn solve(cases: &[DesignCase], accuracy: f64, in_double: bool) -> Vec<DesignOutcome> {
    let options = SolveOptions { accuracy, method: MethodChoice::Fe };
    Ladder::new(options).in_double(in_double).solve(cases)
}

/// Forces, half angles and peak pressures of random joints, against double precision on the same meshes.
#[test]
fn single_precision_leaves_no_more_than_is_said() {
    for (name, cases) in
        [("concentric", draw(301, COUNT, concentric)), ("half disc", draw(302, COUNT, half_disc_in_annulus))]
    {
        let mut worst = Vec::new();
        for (found, expected) in solve(&cases, 0.01, false).iter().zip(solve(&cases, 0.01, true)) {
            let [found, expected] = [found, &expected].map(|outcome| outcome.steps[0].response);
            let (Some(found), Some(expected)) = (found, expected) else { continue };
            let difference = found.force / expected.force - 1.0;
            assert!(expected.force_error >= error_of_singles(Group::Concentric, 0), "{name}: {expected:?}");
            worst.push(difference.abs());
        }
        worst.sort_by(f64::total_cmp);
        let [median, most] = [worst[worst.len() / 2], worst[worst.len() - 1]];
        println!("{name}: {} forces, median {median:.1e}, worst {most:.1e}", worst.len());
        assert!(worst.len() as u64 > COUNT * 9 / 10, "{name}: {}", worst.len());
        // It is single precision that is looked at.
        assert!(median > 1e-8, "{name}: {median:e}");
        assert!(most < error_of_singles(Group::Concentric, 0), "{name}: {most:e}");
    }
}
