//! How fast this machine is just now, beside the one whose times forecasts are made of.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use jointsweep::Error;
use jointsweep::internals::engine::cost;
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::engine::unit_costs::Unit;
use jointsweep::internals::study::config::Study;

const CONFIG: &str = include_str!("../../configs/random.toml");
/// The designs that it has, and those that are solved.
const COUNTS: [&str; 2] = ["count  = 10000", "count  = 1000"];
/// The shortest counts: machines have other work.
const RUNS: usize = 3;

/// What the core time of a forecast is to be multiplied by, from a sweep that takes some tens of milliseconds.
pub fn pace() -> Result<f64, Error> {
    let study = Study::from_text(Path::new("pace.toml"), CONFIG.replace(COUNTS[0], COUNTS[1]))?;
    let foreseen = cost::estimate(&study)?.seconds - Unit::Process.seconds();
    let options = SweepOptions { threads: 1, ..SweepOptions::default() };
    let mut shortest = f64::INFINITY;
    for _ in 0..RUNS {
        let started = Instant::now();
        sweep::run(&study, &options, &mut |_| Ok(ControlFlow::Continue(())))?;
        shortest = shortest.min(started.elapsed().as_secs_f64());
    }
    Ok(shortest / foreseen)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_designs_of_the_config_are_solved() {
        assert!(CONFIG.contains(COUNTS[0]));
        assert!(pace().unwrap() > 0.0);
    }
}
