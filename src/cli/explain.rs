//! `jointsweep explain`: what the planner has chosen for a sweep, or for one design of it, and why.

use std::path::PathBuf;

use std::fmt::Write as _;

use clap::Args;
use jointsweep::Error;
use jointsweep::internals::engine::explain::{Explainer, Explanation, percent};
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::processor_pace::measured_pace;
use jointsweep::internals::engine::status::Status;
use jointsweep::internals::engine::threads::common_pool;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::DesignCase;

use super::arguments::SettingArgs;
use super::report::{about, aligned, duration};
use super::{Ending, print};

#[derive(Args)]
pub struct ExplainArgs {
    /// The sweep, a TOML file
    config: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
    /// Only this design, by its number in the table [default: all, by what is chosen for them]
    #[arg(long, value_name = "N")]
    design: Option<u64>,
}

pub fn explain(args: &ExplainArgs) -> Result<Ending, Error> {
    let study = args.settings.load_and_warn(&args.config)?;
    let explainer = Explainer::new(&study);
    let text = match args.design {
        None => overview(&study, &explainer)?,
        Some(design) => one(&study, &explainer, design)?,
    };
    print(&text)?;
    Ok(Ending::Complete)
}

fn overview(study: &Study, explainer: &Explainer) -> Result<String, Error> {
    let (shares, looked_at) = explainer.shares()?;
    let pace = measured_pace();
    let is_of_all = looked_at == study.design_count();
    let mut lines = vec![["chosen".to_string(), "designs".into(), "core time".into(), "for example".into()]];
    for (chosen, share) in shares {
        let example = format!("--design {}", share.example);
        lines.push([
            chosen,
            if is_of_all { share.designs.to_string() } else { about(share.designs) },
            format!("about {}", duration(share.time.at(pace))),
            example,
        ]);
    }
    let accuracy = 100.0 * study.solve.accuracy;
    let mut text =
        format!("{} designs at {accuracy} %, method {}\n\n", study.design_count(), study.solve.method.name());
    text += &aligned(&lines);
    if !is_of_all {
        _ = writeln!(
            text,
            "\nBy {looked_at} designs that are spread over the sweep; what is rarer may be missing."
        );
    }
    text += "\nThe time leaves out what a sweep shares: near fields, meshes, fits.\n";
    Ok(text)
}

/// `design` as in the table.
fn one(study: &Study, explainer: &Explainer, design: u64) -> Result<String, Error> {
    let Some(case) = nth(study, design)? else {
        return Err(Error::NoSuchDesign { design, count: study.design_count() });
    };
    let Explanation { chosen, why, bodies, ruled_out, error, time } = explainer.explain(&case);
    let mut text = String::new();
    let mut line = |name: &str, value: &str| _ = writeln!(text, "{name:<12}{value}");
    line("design", &format!("{design} of the {} of the sweep", study.design_count()));
    line("chosen", &chosen);
    line("because", &why);
    for body in &bodies {
        line("", body);
    }
    if error.is_finite() {
        line("error", &format!("at most about {} of the force, told before solving", percent(error)));
    }
    common_pool()?;
    if let Some(told) = solved(study, case) {
        line("solved", &told);
    }
    line("core time", &format!("about {}", duration(time.at(measured_pace()))));
    text += "\nruled out\n";
    for (what, why) in ruled_out {
        _ = writeln!(text, "  {what}: {why}");
    }
    Ok(text)
}

/// What the design's own rows say, each design being solved by itself.
fn solved(study: &Study, case: DesignCase) -> Option<String> {
    let outcome = Ladder::new(study.solve).sharing(study.in_common()).solve(&[case]).pop()?;
    let responses: Vec<_> = outcome.steps.iter().filter_map(|step| step.response).collect();
    let worst = responses.iter().map(|response| response.force_error).fold(0.0, f64::max);
    let method = responses.first()?.method.name();
    let warned = outcome.steps.iter().filter(|step| step.status != Status::OK).count();
    Some(match warned {
        0 => format!("alone, by {method}: force_error is {} at most, every row is ok", percent(worst)),
        _ => format!(
            "alone, by {method}: force_error is {} at most, {warned} of {} rows are not ok",
            percent(worst),
            outcome.steps.len()
        ),
    })
}

/// A design by its number in the table; nothing where there is none.
pub fn nth(study: &Study, design: u64) -> Result<Option<DesignCase>, Error> {
    let Ok(before) = usize::try_from(design) else { return Ok(None) };
    study.cases()?.nth(before).transpose()
}
