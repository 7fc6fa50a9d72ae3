//! The contact pressure along the arc of the chosen designs.

use super::Report;
use super::curves::readable;
use super::html::{charts, figure, paragraph, section as html_section};
use crate::output::chart::text::number;
use crate::output::chart::{Axis, LineChart, Marking, Series};

/// Pressures further apart than this are drawn over their peaks.
const RELATIVE_FROM: f64 = 8.0;

pub fn section(report: &Report) -> String {
    let with = || report.chosen.iter().filter(|one| !one.pressure.is_empty());
    let peak = |points: &[(f64, f64)]| points.iter().map(|point| point.1).fold(0.0, f64::max);
    let peaks = || with().map(|one| peak(&one.pressure));
    let Some((low, high)) = crate::output::chart::axis::range(peaks()) else { return String::new() };
    let relative = high > RELATIVE_FROM * low;
    let (unit, factor) = readable("MPa", peaks());
    let series: Vec<Series> = with()
        .map(|one| {
            let own = peak(&one.pressure);
            let scale = if relative { 1.0 / own } else { factor };
            let name = format!("design {}: {} {unit}", one.design.number, number(own * factor, 3));
            let points = one.pressure.iter().map(|&(angle, pressure)| (angle, pressure * scale)).collect();
            Series::new(name, one.place, Marking::Line, points)
        })
        .collect();
    let name = if relative { "pressure over its peak".into() } else { format!("contact pressure, {unit}") };
    let all = || series.iter().flat_map(|one| &one.points);
    let chart = LineChart {
        title: "Contact pressure along the arc".into(),
        x: Axis::from_zero("angle from the load line, deg", all().map(|point| point.0)),
        y: Axis::from_zero(&name, all().map(|point| point.1)),
        series: series.clone(),
        limits: Vec::new(),
    };
    let mut text = String::from(
        "Under the last load that has an answer, from the load line to where the contact ends; the other half is the same. \
         Pressure is per area of the hole.",
    );
    if relative {
        text +=
            " The peaks are far apart, so each curve is drawn over its own peak; the legend has the peaks.";
    } else {
        text += " The legend has the peaks.";
    }
    let figures = [figure("Contact pressure along the arc", "", &chart.svg())];
    html_section("Pressure", &(paragraph(&text) + &charts(&figures)))
}
