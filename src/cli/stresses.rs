//! `jointsweep stresses`: stresses at the contact, at each interface and where a body is held, of chosen designs of a config.

use std::fmt::Write as _;

use clap::Args;
use jointsweep::internals::output::number::rounded_cell;
use jointsweep::internals::study::columns::side_name;
use jointsweep::internals::study::design::Limits;
use jointsweep::internals::study::units::{Dimension, parse_quantity};
use jointsweep::{CircleStresses, Error, Joint, Side, Status};

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
    #[arg(long, value_name = "LENGTH", value_parser = depth, allow_hyphen_values = true)]
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

pub fn stresses(args: &StressesArgs) -> Result<Ending, Error> {
    args.chosen.write(HEADER, "stresses", |text, case, options| {
        let (design, mut all) = (case.index, true);
        let curve = Joint::try_from(case.joint)?.curve(options)?;
        let joint = curve.joint();
        let mut unsaid = &args.depth[..];
        for (step, (load, answer)) in case.steps.iter().zip(curve.answers(&case.steps)?).enumerate() {
            let step_said = format!("design {design}, step {step} ({load})");
            if answer.status != Status::OK {
                say(&format!("{step_said}: {}", answer.status));
            }
            if answer.response.is_none() {
                all = false;
                continue;
            }
            let (mut circles, mut are_whole) = (Vec::new(), true);
            for side in [Side::Pin, Side::Plate] {
                match curve.stresses(side, *load, usize::from(args.points), &args.depth) {
                    Ok(own) => circles.extend(own),
                    Err(problem) => {
                        say(&format!("{step_said}: {problem}"));
                        are_whole = false;
                    }
                }
            }
            for circle in &circles {
                add_circle(text, &format!("{design},{step}"), circle, yield_stress(&joint, circle));
            }
            all &= are_whole;
            // Circles are the same under every load that presses.
            if are_whole && !circles.is_empty() {
                for depth in std::mem::take(&mut unsaid) {
                    if !circles.iter().any(|circle| is_at(&joint, circle, *depth)) {
                        let depth = rounded_cell(*depth);
                        say(&format!("design {design}: neither part is {depth} mm deep below the contact"));
                    }
                }
            }
            if let Some(nearest) = nearest_to_yield(&joint, &circles) {
                say(&format!("{step_said}: {nearest}"));
            }
        }
        Ok(all)
    })
}

/// Whether a circle is so far below the contact, mm; to rounding.
fn is_at(joint: &Joint, circle: &CircleStresses, depth: f64) -> bool {
    let contact = joint.design().contact_radius(circle.side);
    ((circle.radius - contact).abs() - depth).abs() <= ROUNDING * contact
}

fn yield_stress(joint: &Joint, circle: &CircleStresses) -> Option<f64> {
    joint.design().part(circle.side).yield_stress(circle.layer)
}

fn add_circle(text: &mut String, front: &str, circle: &CircleStresses, yield_stress: Option<f64>) {
    let (side, layer, radius) = (side_name(circle.side), circle.layer, rounded_cell(circle.radius));
    for point in &circle.points {
        let angle = rounded_cell(point.angle.to_degrees());
        let stresses = [point.radial, point.hoop, point.shear, point.von_mises].map(rounded_cell).join(",");
        let share = yield_stress.map_or(String::new(), |most| rounded_cell(point.von_mises / most));
        let _ = writeln!(text, "{front},{side},{layer},{radius},{angle},{stresses},{share}");
    }
}

/// Relative difference of stresses that are equal but for rounding.
const ROUNDING: f64 = 1e-9;

/// Where von Mises' stress is the greatest share of a yield stress, in words; `None` where none is given.
fn nearest_to_yield(joint: &Joint, circles: &[CircleStresses]) -> Option<String> {
    let shares = circles.iter().flat_map(|circle| {
        let most = yield_stress(joint, circle);
        circle.points.iter().filter_map(move |point| Some((point.von_mises / most?, circle, point.angle)))
    });
    // Points begin at the load line: of values that differ by rounding alone the one nearest to it stays.
    let is_greater = |share: f64, best: f64| share > best * (1.0 + ROUNDING);
    let (share, circle, angle) =
        shares.reduce(|best, other| if is_greater(other.0, best.0) { other } else { best })?;
    let layer = if circle.layer == 0 { String::new() } else { format!(" layer {}", circle.layer) };
    let [radius, angle] = [circle.radius, angle.to_degrees()].map(rounded_cell);
    let share = rounded_cell((share * 1e3).round() / 1e3);
    Some(format!(
        "up to {share} of the yield stress, {}{layer} at {radius} mm, {angle} deg",
        side_name(circle.side)
    ))
}
