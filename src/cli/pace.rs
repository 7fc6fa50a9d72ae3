//! How fast this machine is just now, beside the one whose times forecasts are made of.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use jointsweep::Error;
use jointsweep::internals::engine::cost;
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::engine::unit_costs::Unit;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::setting::Setting;

const CONFIG: &str = include_str!("../../configs/random.toml");
/// Of its designs so many are solved.
const COUNT: &str = "sampling.count=1000";
/// The shortest counts: machines have other work.
const RUNS: usize = 3;

/// What the core time of a forecast is to be multiplied by, from a sweep that takes some tens of milliseconds.
pub fn pace() -> Result<f64, Error> {
    let fewer = Setting::parse(COUNT, "pace")?;
    let study = Study::from_text_with(Path::new("random.toml"), CONFIG.into(), &[fewer])?;
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
    fn a_machine_has_a_pace() {
        let pace = pace().unwrap();
        assert!(pace > 0.0 && pace.is_finite(), "{pace}");
    }
}
