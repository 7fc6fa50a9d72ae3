//! `jointsweep pressure`: the contact pressure along the arc, of chosen designs of a config.

use std::fmt::Write as _;

use clap::Args;
use jointsweep::internals::output::number::rounded_cell;
use jointsweep::{Error, Joint, Status};

use super::chosen_designs::ChosenDesigns;
use super::{Ending, say};

#[derive(Args)]
pub struct PressureArgs {
    #[command(flatten)]
    chosen: ChosenDesigns,
    /// Points from the load line to where contact ends
    #[arg(long, value_name = "N", default_value = "61", value_parser = clap::value_parser!(u16).range(2..=10_000))]
    points: u16,
}

const HEADER: &str = "design,step,indentation_mm,force_n,angle_deg,pressure_mpa\n";

pub fn pressure(args: &PressureArgs) -> Result<Ending, Error> {
    args.chosen.write(HEADER, "pressure", |text, case, options| {
        let (design, mut all) = (case.index, true);
        let curve = Joint::try_from(case.joint)?.curve(options)?;
        let answers = curve.answers(&case.steps)?;
        for (step, (load, answer)) in case.steps.iter().zip(answers).enumerate() {
            if answer.status != Status::OK {
                say(&format!("design {design}, step {step} ({load}): {}", answer.status));
            }
            let Some(response) = answer.response else {
                all = false;
                continue;
            };
            for (angle, pressure) in curve.pressure(*load, usize::from(args.points))? {
                let numbers = [response.indentation, response.force, angle.to_degrees(), pressure];
                let _ = writeln!(text, "{design},{step},{}", numbers.map(rounded_cell).join(","));
            }
        }
        Ok(all)
    })
}
