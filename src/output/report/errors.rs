//! How large the estimated errors are, against what was asked.

use super::Report;
use super::html::{charts, figure, paragraph, section as html_section};
use super::tallies::Distribution;
use crate::output::chart::text::{percent, plural};
use crate::output::chart::{Axis, LineChart, Marking, Series};

pub fn section(report: &Report) -> String {
    let scan = &report.scan;
    let mut text = String::new();
    let mut figures = Vec::new();
    let asked = report.asked.solve.accuracy;
    let limit = format!("asked: {}", percent(asked, 3));
    if let Some((greatest, design)) = scan.force_error.extremes.greatest {
        let above = scan.force_error.above;
        text += &paragraph(&format!(
            "force_error is the estimated relative error of a row's force. Its greatest is {}, in design {design}; {} of {} {} \
             above the {} that was asked.",
            percent(greatest, 3),
            plural(above, "row", "rows"),
            scan.force_error.count,
            if above == 1 { "is" } else { "are" },
            percent(asked, 3),
        ));
        figures.push(histogram("force_error", &scan.force_error, &limit, 0));
    }
    if let Some((greatest, design)) = scan.linearity_error.extremes.greatest {
        let limit = scan.linearity_error.limit;
        let above = scan.linearity_error.above;
        text += &paragraph(&format!(
            "linearity_error is what laws of finite displacement may differ by, which no mesh mends. Its greatest is {}, in \
             design {design}; {} of {} {} above {}, from where a row says \u{201c}large displacement\u{201d}.",
            percent(greatest, 3),
            plural(above, "row", "rows"),
            scan.linearity_error.count,
            if above == 1 { "is" } else { "are" },
            percent(limit, 3),
        ));
        figures.push(histogram(
            "linearity_error",
            &scan.linearity_error,
            &format!("remark from {}", percent(limit, 3)),
            1,
        ));
    }
    if figures.is_empty() {
        return String::new();
    }
    html_section("Errors", &(text + &charts(&figures)))
}

fn histogram(name: &str, errors: &Distribution, limit: &str, colour: usize) -> String {
    let bins = errors.bins();
    let share = |count: u64| 100.0 * count as f64 / errors.count.max(1) as f64;
    let points: Vec<(f64, f64)> = bins.iter().map(|&(low, count)| (100.0 * low, share(count))).collect();
    let xs = points.iter().map(|point| point.0).chain([100.0 * errors.limit]);
    let x = Axis::log(&format!("{name}, %"), xs);
    let y = Axis::from_zero("share of the rows, %", points.iter().map(|point| point.1));
    let chart = LineChart {
        title: name.into(),
        x,
        y,
        series: vec![Series::new("", colour, Marking::Bars, points)],
        limits: vec![(100.0 * errors.limit, limit.into())],
    };
    figure(name, "", &chart.svg())
}
