//! `jointsweep tradeoff`: designs of a config through every choice there is.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::backend::gpu::context::{AdapterChoice, Adapters, GpuDevice};
use jointsweep::internals::engine::refusal::Refusal;
use jointsweep::internals::lab::tradeoff::choice::Scope;
use jointsweep::internals::lab::tradeoff::families::choices;
use jointsweep::internals::lab::tradeoff::joints::{least_contact_angle, not_compared};
use jointsweep::internals::lab::tradeoff::manifest::{TradeoffConditions, TradeoffManifest};
use jointsweep::internals::lab::tradeoff::measure::{Measured, measure};
use jointsweep::internals::output::folder::{Permissions, ResultFolder, TRADEOFF};
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::DesignCase;

use super::arguments::count;
use super::report::{aligned, duration};
use super::{Ending, backend, print, say};

#[derive(Args)]
pub struct TradeoffArgs {
    /// The sweep whose designs are taken, a TOML file
    config: PathBuf,
    /// Designs, evenly spaced over the sweep
    #[arg(long, value_name = "N", default_value = "100", value_parser = count::<u64>)]
    designs: u64,
    /// Folder of the result [default: out/<config's name>/tradeoff]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Measure the GPU whose name or driver holds this too, software or not [default: the best GPU, if there is one]
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Runs of each choice; fewer of those that take seconds
    #[arg(long, value_name = "N", default_value = "5", value_parser = count::<usize>)]
    runs: usize,
    /// Overwrite the result of another config
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

pub fn tradeoff(args: &TradeoffArgs) -> Result<Ending, Error> {
    let started = SystemTime::now();
    let study = Study::load(&args.config)?;
    let designs = designs(&study, args.designs)?;
    refuse_uncompared(&study, &designs)?;
    let dir = args.out.clone().unwrap_or_else(|| Path::new("out").join(study.name()).join("tradeoff"));
    let folder = ResultFolder::new(&TRADEOFF, dir);
    // Times are measured anew.
    folder.check(&study, Permissions { force: args.force, again: true })?;
    let claim = folder.claim(&format!("of {}", args.config.display()))?;
    let device = device(args.adapter.as_deref())?;
    let cases = meshable(designs)?;
    let least_angle = least_contact_angle(&cases);
    let choices = choices(&Scope { gpu: device.as_ref(), least_angle });

    let mut done = 0;
    let mut notify = |measured: &Measured| {
        done += 1;
        if !args.quiet {
            say(&format!("{done}/{} {}", choices.len(), words(measured)));
        }
    };
    let tradeoff = measure(&cases, &choices, args.runs, &mut notify)?;
    let adapter = device.as_ref().map(|device| &device.facts);
    let conditions = TradeoffConditions { runs: args.runs, adapter, least_angle, started };
    TradeoffManifest::new(&study, &conditions).save(&claim, &tradeoff)?;
    if !args.quiet {
        print(&front(&tradeoff.rows))?;
        say(&folder.dir().display().to_string());
    }
    Ok(Ending::Complete)
}

/// The GPU that is named, or a real one if there is any.
fn device(name: Option<&str>) -> Result<Option<GpuDevice>, Error> {
    backend::quiet_driver();
    let adapters = Adapters::enumerate();
    match name {
        Some(name) => match adapters.open(AdapterChoice::Named(name)) {
            Ok(device) => Ok(Some(device)),
            Err(error) => Err(Error::Adapter { problem: error.to_string() }),
        },
        None => Ok(adapters.open(AdapterChoice::Best).ok()),
    }
}

/// So many designs, evenly spaced over the sweep; all of a smaller one.
fn designs(study: &Study, count: u64) -> Result<Vec<DesignCase>, Error> {
    let total = study.design_count();
    let count = count.min(total);
    let mut cases = study.cases()?;
    let mut next = 0;
    let mut designs = Vec::new();
    for number in 0..count {
        // In u128, whatever the sweep's size.
        let wanted = (u128::from(number) * u128::from(total) / u128::from(count)) as u64;
        let skipped = usize::try_from(wanted - next).unwrap_or(usize::MAX);
        next = wanted + 1;
        designs.extend(cases.nth(skipped).transpose()?);
    }
    Ok(designs)
}

/// Designs that not every choice knows would be compared with wrong answers.
fn refuse_uncompared(study: &Study, designs: &[DesignCase]) -> Result<(), Error> {
    let is_listed = study.designs_file().is_some();
    let problem = |case: &DesignCase| Some((case.index, not_compared(&case.joint, is_listed)?));
    let Some((design, problem)) = designs.iter().find_map(problem) else { return Ok(()) };
    let path = study.path().display();
    Err(Error::Asked {
        problem: format!(
            "{path}: design {design} {problem}; tradeoff compares joints with clearance and without layers, \
             because its closed forms and its node contact know no others; `jointsweep run` and `jointsweep explain` take this config"
        ),
    })
}

/// Those that meshes carry: the others would keep every choice of a mesh busy in vain.
fn meshable(designs: Vec<DesignCase>) -> Result<Vec<DesignCase>, Error> {
    let refusal = |case: &DesignCase| {
        let joint = &case.joint;
        [&joint.pin, &joint.plate].into_iter().find_map(|part| Refusal::of_mesh(&joint.body(part)))
    };
    let count = designs.len();
    let reason = designs.iter().find_map(refusal);
    let kept: Vec<DesignCase> = designs.into_iter().filter(|case| refusal(case).is_none()).collect();
    match reason {
        Some(reason) if kept.is_empty() => Err(Error::NothingToCompare { reason: reason.to_string() }),
        Some(reason) => {
            say(&format!(
                "{} of {count} designs are left out, the first because {reason}",
                count - kept.len()
            ));
            Ok(kept)
        }
        None => Ok(kept),
    }
}

/// What a person wants to know of a choice while others are still running.
fn words(measured: &Measured) -> String {
    let Measured { family, choice, time_per_design, errors, .. } = measured;
    let time = brief(*time_per_design);
    match errors.force {
        Some(force) => {
            format!("{family}, {choice}: {time} a design, force within {:.1e} (95 % of the steps)", force.p95)
        }
        None => format!("{family}, {choice}: no answer"),
    }
}

/// A time per design as a person says it.
fn brief(seconds: f64) -> String {
    if seconds < 1e-4 { format!("{:.2} us", 1e6 * seconds) } else { duration(seconds) }
}

/// The choices that no other one beats, fastest first.
fn front(rows: &[Measured]) -> String {
    let mut on_front: Vec<&Measured> = rows.iter().filter(|row| row.on_front).collect();
    on_front.sort_by(|a, b| a.time_per_design.total_cmp(&b.time_per_design));
    let mut lines =
        vec![["family", "choice", "time/design", "shared", "force, 95 %", "worst"].map(String::from)];
    for row in on_front {
        let error = |of: fn(&jointsweep::internals::lab::tradeoff::errors::Quantiles) -> f64| {
            row.errors.force.as_ref().map_or(String::new(), |force| format!("{:.1e}", of(force)))
        };
        lines.push([
            row.family.to_string(),
            row.choice.clone(),
            brief(row.time_per_design),
            duration(row.shared),
            error(|force| force.p95),
            error(|force| force.max),
        ]);
    }
    aligned(&lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten designs of ten clearances.
    fn study() -> Study {
        let text = r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = { from = "1 mm", to = "2 mm", count = 10 }
thickness = "5 mm"
[joint.pin]
model = "rigid-midplane"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = 3
youngs_modulus = "70 GPa"
poissons_ratio = 0.3
[load]
indentation = "0.1 mm"
"#;
        Study::from_text(Path::new("ten.toml"), text.into()).unwrap()
    }

    #[test]
    fn designs_are_evenly_spaced_over_the_sweep() {
        let study = study();
        let indices =
            |count| -> Vec<u64> { designs(&study, count).unwrap().iter().map(|case| case.index).collect() };
        assert_eq!(indices(1), [0]);
        assert_eq!(indices(3), [0, 3, 6]);
        assert_eq!(indices(5), [0, 2, 4, 6, 8]);
        assert_eq!(indices(1000), (0..10).collect::<Vec<_>>());
    }

    #[test]
    fn designs_that_no_mesh_carries_are_left_out() {
        let mut designs = designs(&study(), 3).unwrap();
        designs[1].joint.plate.parameters[0] = 1.001;
        let kept = meshable(designs.clone()).unwrap();
        assert_eq!(kept.iter().map(|case| case.index).collect::<Vec<_>>(), [0, 6]);
        let error = meshable(vec![designs[1].clone()]).unwrap_err().to_string();
        assert!(error.contains("the wall of the annulus is 0.1 % of the radius"), "{error}");
    }

    #[test]
    fn times_are_said_in_a_unit_that_shows_them() {
        assert_eq!([2.5e-7, 3e-4, 0.5].map(brief), ["0.25 us", "0.3 ms", "0.50 s"]);
    }
}
