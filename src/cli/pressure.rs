//! `jointsweep pressure`: the contact pressure along the arc, of chosen designs of a config.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use jointsweep::internals::output::number::rounded_cell;
use jointsweep::internals::output::whole_file;
use jointsweep::{Error, Joint, MethodChoice, Status};

use super::arguments::SettingArgs;
use super::explain::nth;
use super::{Ending, print, say};

#[derive(Args)]
pub struct PressureArgs {
    /// The sweep, a TOML file
    config: PathBuf,
    #[command(flatten)]
    settings: SettingArgs,
    /// A design, by its number in the table; may be repeated [default: the only one]
    #[arg(long, value_name = "N")]
    design: Vec<u64>,
    /// Points from the load line to where contact ends
    #[arg(long, value_name = "N", default_value = "61", value_parser = clap::value_parser!(u16).range(2..=10_000))]
    points: u16,
    /// The file [default: the terminal]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite the file
    #[arg(long)]
    force: bool,
}

const HEADER: &str = "design,step,indentation_mm,force_n,angle_deg,pressure_mpa\n";

pub fn pressure(args: &PressureArgs) -> Result<Ending, Error> {
    let study = args.settings.load(&args.config)?;
    if let Some(path) = args.out.as_ref().filter(|path| !args.force && path.exists()) {
        return Err(Error::FileTaken { path: path.clone() });
    }
    if study.solve.method == MethodChoice::ClosedForm {
        let problem = "closed-form: has no pressure of the joint; take auto, series or fe".into();
        return Err(Error::Joint { quantity: "solve.method".into(), problem });
    }
    let designs = match &args.design[..] {
        [] if study.design_count() == 1 => &[0],
        [] => {
            let problem = format!("one of the {} designs is needed, by its number", study.design_count());
            return Err(Error::Joint { quantity: "--design".into(), problem });
        }
        designs => designs,
    };
    let (mut text, mut ending) = (HEADER.to_string(), Ending::Complete);
    for &design in designs {
        let Some(case) = nth(&study, design)? else {
            return Err(Error::NoSuchDesign { design, count: study.design_count() });
        };
        let curve = Joint::try_from(case.joint)?.curve(study.solve)?;
        let answers = curve.answers(&case.steps)?;
        for (step, (load, answer)) in case.steps.iter().zip(answers).enumerate() {
            if answer.status != Status::OK {
                say(&format!("design {design}, step {step} ({load}): {}", answer.status));
            }
            let Some(response) = answer.response else {
                ending = Ending::SomeDesignsFailed;
                continue;
            };
            for (angle, pressure) in curve.pressure(*load, usize::from(args.points))? {
                let numbers = [response.indentation, response.force, angle.to_degrees(), pressure];
                let _ = writeln!(text, "{design},{step},{}", numbers.map(rounded_cell).join(","));
            }
        }
    }
    match &args.out {
        Some(path) => whole_file::write_whole(path, text.as_bytes())?,
        None => print(&text)?,
    }
    Ok(ending)
}
