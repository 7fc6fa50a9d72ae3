//! `jointsweep stresses`: stresses at the contact, at each interface and where a body is held, of chosen designs of a config.

use std::fmt::Write as _;

use clap::Args;
use jointsweep::internals::output::number::rounded_cell;
use jointsweep::internals::study::columns::side_name;
use jointsweep::internals::study::design::Limits;
use jointsweep::internals::study::units::{Dimension, parse_quantity};
use jointsweep::{Error, Joint, Side, Status};

use super::chosen_designs::ChosenDesigns;
use super::{Ending, say};

#[derive(Args)]
pub struct StressesArgs {
    #[command(flatten)]
    chosen: ChosenDesigns,
    /// Points from the load line to the far side, of each circle
    #[arg(long, value_name = "N", default_value = "91", value_parser = clap::value_parser!(u16).range(3..=10_000))]
    points: u16,
    /// Stresses below the contact, too, where they are often greatest: at this depth, such as "0.1 mm"; may be repeated
    #[arg(long, value_name = "LENGTH", value_parser = depth)]
    depth: Vec<f64>,
}

/// mm.
fn depth(text: &str) -> Result<f64, String> {
    let depth = parse_quantity(text, Dimension::Length)?;
    Limits::POSITIVE.refuse(depth).map(|()| depth)
}

/// Each material of a part has two circles, that towards the contact first. Layers are counted from the contact; 0 is the part's own material.
const HEADER: &str = "design,step,part,layer,radius_mm,angle_deg,radial_stress_mpa,hoop_stress_mpa,shear_stress_mpa,von_mises_mpa,\
                      yield_share\n";

/// Where von Mises' stress is nearest to a yield stress.
struct Nearest {
    share: f64,
    place: String,
}

pub fn stresses(args: &StressesArgs) -> Result<Ending, Error> {
    args.chosen.write(HEADER, "stresses", |text, case, options| {
        let (design, mut all) = (case.index, true);
        let curve = Joint::try_from(case.joint)?.curve(options)?;
        let joint = curve.joint();
        let mut known = Vec::new();
        for side in [Side::Pin, Side::Plate] {
            match joint.has_stresses(side) {
                Ok(()) => known.push(side),
                Err(problem) => say(&format!("design {design}, {problem}")),
            }
        }
        for (step, (load, answer)) in case.steps.iter().zip(curve.answers(&case.steps)?).enumerate() {
            if answer.status != Status::OK {
                say(&format!("design {design}, step {step} ({load}): {}", answer.status));
            }
            if answer.response.is_none() {
                all = false;
                continue;
            }
            let mut nearest: Option<Nearest> = None;
            for &side in &known {
                let circles = match curve.stresses(side, *load, usize::from(args.points), &args.depth) {
                    Ok(circles) => circles,
                    Err(problem) => {
                        say(&format!("design {design}, step {step} ({load}): {problem}"));
                        all = false;
                        continue;
                    }
                };
                for circle in circles {
                    let yield_stress = joint.design().part(side).yield_stress(circle.layer);
                    let (name, layer, radius) = (side_name(side), circle.layer, rounded_cell(circle.radius));
                    for point in circle.points {
                        let angle = rounded_cell(point.angle.to_degrees());
                        let share = yield_stress.map(|most| point.von_mises / most);
                        if let Some(share) =
                            share.filter(|own| nearest.as_ref().is_none_or(|best| *own > best.share))
                        {
                            let of = if layer == 0 { String::new() } else { format!(" layer {layer}") };
                            nearest = Some(Nearest {
                                share,
                                place: format!("{name}{of} at {radius} mm, {angle} deg"),
                            });
                        }
                        let stresses = [point.radial, point.hoop, point.shear, point.von_mises]
                            .map(rounded_cell)
                            .join(",");
                        let share = share.map_or(String::new(), rounded_cell);
                        let _ = writeln!(
                            text,
                            "{design},{step},{name},{layer},{radius},{angle},{stresses},{share}"
                        );
                    }
                }
            }
            if let Some(Nearest { share, place }) = nearest {
                let share = rounded_cell((share * 1e3).round() / 1e3);
                say(&format!(
                    "design {design}, step {step} ({load}): up to {share} of the yield stress, {place}"
                ));
            }
        }
        Ok(all && !known.is_empty())
    })
}
