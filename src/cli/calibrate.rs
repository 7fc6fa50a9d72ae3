//! `jointsweep calibrate`: what is not known of a joint, from measured forces.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use clap::Args;
use jointsweep::internals::calibrate::calibration::{Calibration, Fitted, calibrate as fit};
use jointsweep::internals::calibrate::unknown::Unknown;
use jointsweep::internals::output::calibration::CalibrationManifest;
use jointsweep::internals::output::folder::{CALIBRATION, Permissions, ResultFolder, Verdict};
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::measured::Measured;
use jointsweep::{Error, Joint};

use super::arguments::SettingArgs;
use super::report::aligned;
use super::{Ending, print, say};

#[derive(Args)]
pub struct CalibrateArgs {
    /// The joint as far as it is known, a TOML file of one design; what is fitted starts from its values
    config: PathBuf,
    /// The measured points, a CSV file with the columns indentation_mm, force_n and, if known, sigma_n
    #[arg(long, value_name = "FILE")]
    measured: PathBuf,
    /// What to fit, with commas between: plate_youngs_modulus, pin_youngs_modulus, radial_clearance, support_compliance,
    /// zero_offset
    #[arg(long, value_name = "NAME", value_delimiter = ',', required = true)]
    fit: Vec<String>,
    /// Folder of the result [default: out/<config's name>/calibration]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingArgs,
    /// Overwrite a result that is there
    #[arg(long)]
    force: bool,
    /// Print nothing but errors
    #[arg(long)]
    quiet: bool,
}

pub fn calibrate(args: &CalibrateArgs) -> Result<Ending, Error> {
    let started = SystemTime::now();
    let unknowns = Unknown::list(&args.fit)?;
    let study = args.settings.load(&args.config)?;
    let joint = only_joint(&study)?;
    let measured = Measured::load(&args.measured)?;
    let dir = args.out.clone().unwrap_or_else(|| Path::new("out").join(study.name()).join("calibration"));
    let folder = ResultFolder::new(&CALIBRATION, dir.clone());
    folder.refuse_overwriting(&measured.path)?;
    let permissions = Permissions { force: args.force, again: args.force };
    // Other points, or other unknowns: only the config is known to be the same.
    if let Verdict::Done(origin) = folder.check(&study, permissions)? {
        return Err(Error::FolderTaken { dir, occupant: format!("a calibration of {}", origin.inputs.path) });
    }
    let calibration = fit(&joint, study.solve, &unknowns, &measured.points).map_err(|error| match error {
        Error::Calibration { problem } => {
            Error::Calibration { problem: format!("{}: {problem}", measured.path.display()) }
        }
        other => other,
    })?;
    let claim = folder.claim(&format!("of {}", args.config.display()))?;
    CalibrationManifest::new(&study, &measured, started).save(&claim, &calibration)?;
    for warning in &calibration.warnings {
        say(&format!("warning: {warning}"));
    }
    if !args.quiet {
        print(&summary(&calibration, &dir))?;
        if let Some(command) = next(args, &study, &calibration) {
            print(&format!("next:\n  {command}\n"))?;
        }
    }
    Ok(Ending::Complete)
}

fn only_joint(study: &Study) -> Result<Joint, Error> {
    let count = study.design_count();
    match (count, study.cases()?.next()) {
        (1, Some(case)) => Joint::try_from(case?.joint),
        _ => {
            let problem = format!(
                "{}: a calibration is of one design, this config has {count}: give each quantity one value",
                study.path().display()
            );
            Err(Error::Calibration { problem })
        }
    }
}

fn summary(calibration: &Calibration, dir: &Path) -> String {
    let mut lines = vec![["", "value", "low 95 %", "high 95 %", "unit"].map(String::from)];
    for Fitted { unknown, value, interval, .. } in &calibration.fitted {
        let [low, high] = interval.map_or(["?".into(), "?".into()], |ends| ends.map(digits));
        lines.push([unknown.name().into(), digits(*value), low, high, unknown.unit().into()]);
    }
    let mut text = aligned(&lines);
    for (place, one) in calibration.fitted.iter().enumerate() {
        for (other, correlation) in calibration.fitted[..place].iter().zip(&calibration.correlation[place]) {
            if let Some(correlation) = correlation {
                let (one, other) = (one.unknown.name(), other.unknown.name());
                _ = writeln!(text, "correlation of {other} and {one}: {correlation:.3}");
            }
        }
    }
    let points = calibration.points.len();
    match calibration.residual_deviation {
        Some(deviation) => {
            _ = writeln!(text, "{points} points, residuals of {} N (standard deviation)", digits(deviation))
        }
        None => _ = writeln!(text, "{points} points"),
    }
    if let Some(chi_square) = calibration.reduced_chi_square {
        _ = writeln!(text, "reduced chi-square: {chi_square:.2}");
    }
    text += "written:\n";
    for name in ["calibration.csv", "residuals.csv", "residuals.svg", "manifest.json"] {
        _ = writeln!(text, "  {}", dir.join(name).display());
    }
    text
}

/// The command that runs the config with the fitted values; `None` where they are no part of it.
fn next(args: &CalibrateArgs, study: &Study, calibration: &Calibration) -> Option<String> {
    if study.designs_file().is_some() {
        return None;
    }
    let mut settings = args.settings.set.clone();
    for Fitted { unknown, value, .. } in &calibration.fitted {
        let (Some(key), unit) = (unknown.key(), unknown.unit()) else { continue };
        let setting = |key: &str, value: f64| format!("{key}={} {unit}", digits(value));
        settings.push(setting(key, *value));
        // A config that says the diametral clearance refuses the radial one.
        if *unknown == Unknown::RadialClearance && load(&args.config, &settings).is_err() {
            settings.pop();
            settings.push(setting("joint.diametral_clearance", 2.0 * value));
        }
    }
    if settings.len() == args.settings.set.len() {
        return None;
    }
    let quoted: String =
        settings.iter().map(|setting| format!(" --set \"{}\"", setting.replace('"', "\\\""))).collect();
    Some(format!("jointsweep run {}{quoted}", args.config.display()))
}

fn load(config: &Path, settings: &[String]) -> Result<Study, Error> {
    SettingArgs { set: settings.to_vec() }.load(config)
}

/// Six digits.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded != 0.0 && (rounded.abs() < 1e-4 || rounded.abs() >= 1e7) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}
