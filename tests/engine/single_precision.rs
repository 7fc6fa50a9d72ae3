//! Bodies on the coarsest meshes are condensed in single precision: what that leaves of forces, and what it does not hang on.

use crate::common::draws::{concentric, draw, half_disc_in_annulus};
use jointsweep::internals::engine::accuracy::single_precision::OF_SINGLES;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::DesignCase;

const COUNT: u64 = 3000;

fn solve(cases: &[DesignCase], accuracy: f64, in_double: bool) -> Vec<DesignOutcome> {
    let options = SolveOptions { accuracy, method: MethodChoice::Fe };
    let mut ladder = Ladder::new(options);
    if in_double { ladder.in_double().solve(cases) } else { ladder.solve(cases) }
}

/// Forces, half angles and peak pressures of random joints, against double precision on the same meshes.
#[test]
fn single_precision_leaves_no_more_than_is_said() {
    for (name, cases) in
        [("concentric", draw(301, COUNT, concentric)), ("half disc", draw(302, COUNT, half_disc_in_annulus))]
    {
        let (mut worst, mut said) = (Vec::new(), 0);
        for (found, expected) in solve(&cases, 0.01, false).iter().zip(solve(&cases, 0.01, true)) {
            let [found, expected] = [found, &expected].map(|outcome| outcome.steps[0].response);
            let (Some(found), Some(expected)) = (found, expected) else { continue };
            let difference = found.force / expected.force - 1.0;
            let more = (found.force_error - expected.force_error) / OF_SINGLES;
            said += usize::from((more - 1.0).abs() < 0.1);
            worst.push(difference.abs());
        }
        worst.sort_by(f64::total_cmp);
        let [median, most] = [worst[worst.len() / 2], worst[worst.len() - 1]];
        println!("{name}: {} forces, median {median:.1e}, worst {most:.1e}, {said} say so", worst.len());
        assert!(worst.len() as u64 > COUNT * 9 / 10, "{name}: {}", worst.len());
        // Finer accuracies are computed in double.
        let steps = |outcomes: Vec<DesignOutcome>| -> Vec<_> {
            outcomes.into_iter().map(|outcome| outcome.steps).collect()
        };
        assert_eq!(
            steps(solve(&cases[..300], 9e-3, false)),
            steps(solve(&cases[..300], 9e-3, true)),
            "{name}"
        );
        // It is single precision that is looked at.
        assert!(median > 1e-8, "{name}: {median:e}");
        // But for joints on finer meshes, or told by those.
        assert!(said > worst.len() * 8 / 10, "{name}: {said} of {}", worst.len());
        assert!(most < OF_SINGLES, "{name}: {most:e}");
    }
}
