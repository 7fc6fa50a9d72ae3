//! `tradeoff.svg`: every choice as a point, time per design against error of the force, with the Pareto front as a line.

use std::f64::consts::PI;
use std::fmt::Display;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::error::Error;
use crate::lab::tradeoff::families::{FAMILIES, planner};
use crate::lab::tradeoff::measure::{LEAST_ERROR, MOST_UNANSWERED, Measured};

const SIZE: (u32, u32) = (1280, 820);
/// Width of the legend at the right.
const LEGEND: i32 = 400;
const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 40, 40);
const FRONT: RGBColor = RGBColor(30, 30, 30);

/// Errors above this are of no interest.
const MOST_ERROR: f64 = 7.0;

/// Colours that are told apart by most eyes, in the order of `FAMILIES`; alike families have alike colours and differ in
/// their marks.
const COLOURS: [RGBColor; 16] = [
    RGBColor(120, 120, 120), // closed forms
    RGBColor(0, 0, 0),       // series
    RGBColor(200, 30, 30),   // moving edge, Q8
    RGBColor(240, 130, 40),  // ... Q4
    RGBColor(150, 20, 60),   // ... by trial pressures
    RGBColor(20, 80, 170),   // node contact, Q8
    RGBColor(90, 160, 230),  // ... Q4
    RGBColor(20, 140, 140),  // penalty
    RGBColor(60, 190, 160),  // augmented Lagrangian
    RGBColor(70, 110, 20),   // sparse Cholesky
    RGBColor(110, 50, 150),  // PCG
    RGBColor(190, 150, 220),
    RGBColor(150, 90, 200),
    RGBColor(80, 30, 110),
    RGBColor(190, 150, 0), // GPU
    RGBColor(0, 150, 40),  // the planner
];

/// One point of the plot.
struct Point<'a> {
    family: usize,
    at: (f64, f64),
    row: &'a Measured,
}

/// The whole picture.
pub fn svg(title: &str, rows: &[Measured]) -> Result<String, Error> {
    let mut text = String::new();
    // Drawing into a text fails only where the picture makes no sense.
    draw(title, rows, &mut text).map_err(|error| Error::Plot { problem: error.to_string() })?;
    Ok(text)
}

type Drawn = Result<(), Box<dyn std::error::Error>>;

fn draw(title: &str, rows: &[Measured], text: &mut String) -> Drawn {
    let points = points(rows);
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (plot, legend) = root.split_horizontally(SIZE.0 as i32 - LEGEND);
    let times = decades(points.iter().map(|point| point.at.0), 1e-6..1.0);
    let errors = decades(points.iter().map(|point| point.at.1), 1e-4..1.0);
    let mut chart = ChartBuilder::on(&plot)
        .caption(format!("What a choice costs and is worth: {title}"), (FONT, 21).into_font().color(&INK))
        .margin(14)
        .x_label_area_size(52)
        .y_label_area_size(72)
        .build_cartesian_2d(times.log_scale(), errors.log_scale())?;
    chart
        .configure_mesh()
        .x_desc("time per design, one thread, us (shared preparation left out)")
        .y_desc("error of the force that 95 % of the steps keep to, %")
        .x_label_formatter(&|seconds| decade_label(1e6 * seconds))
        .y_label_formatter(&|error| decade_label(100.0 * error))
        .label_style((FONT, 15).into_font().color(&INK))
        .axis_desc_style((FONT, 16).into_font().color(&INK))
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(228, 228, 228))
        .draw()?;

    // Points of a family in the order of its parameter.
    for (family, colour) in COLOURS.iter().enumerate() {
        let own: Vec<(f64, f64)> =
            points.iter().filter(|point| point.family == family).map(|point| point.at).collect();
        if !FAMILIES[family].parameter.is_empty() {
            chart.draw_series(LineSeries::new(own, colour.mix(0.45).stroke_width(1)))?;
        }
    }
    let mut front: Vec<&Point> = points.iter().filter(|point| point.row.on_front).collect();
    front.sort_by(|a, b| a.at.0.total_cmp(&b.at.0));
    let corners = front.iter().map(|point| point.at);
    chart.draw_series(LineSeries::new(corners, FRONT.mix(0.8).stroke_width(3)))?;
    let placed = |at: &(f64, f64)| chart.backend_coord(at);
    for point in &points {
        let hollow = point.row.point().is_none();
        mark(&root, placed(&point.at), point.family, hollow)?;
    }
    let marks: Vec<(i32, i32)> = points.iter().map(|point| placed(&point.at)).collect();
    label(&root, &front, &front.iter().map(|point| placed(&point.at)).collect::<Vec<_>>(), &marks)?;
    key(&legend, &points)?;
    root.present()?;
    Ok(())
}

fn points(rows: &[Measured]) -> Vec<Point<'_>> {
    rows.iter().filter_map(Point::new).collect()
}

impl<'a> Point<'a> {
    /// `None` where there is no time or no error to show.
    fn new(row: &'a Measured) -> Option<Point<'a>> {
        let family = FAMILIES.iter().position(|family| family.name == row.family)?;
        let (time, error) = (row.time_per_design, row.errors.force?.p95);
        let shown = time > 0.0 && time.is_finite() && error.is_finite();
        shown.then(|| Point { family, at: (time, error.clamp(LEAST_ERROR, MOST_ERROR)), row })
    }
}

/// Whole decades around all values, or around `least` where there are none.
fn decades(values: impl Iterator<Item = f64>, least: std::ops::Range<f64>) -> std::ops::Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let (low, high) = if low < high { (low, high) } else { (least.start, least.end) };
    // A little room, so that no point lies on an edge.
    10f64.powf((low * 0.8).log10().floor())..10f64.powf((high * 1.25).log10().ceil())
}

/// A power of ten as a person writes it.
fn decade_label(value: f64) -> String {
    let value: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    if (0.0099..5e3).contains(&value) { format!("{value}") } else { format!("{value:e}") }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// A point's mark at a pixel; hollow where too many steps have no answer.
fn mark(area: &Area, (x, y): (i32, i32), family: usize, hollow: bool) -> Drawn {
    let colour = COLOURS[family % COLOURS.len()];
    let style = if hollow { colour.stroke_width(2) } else { colour.filled() };
    let size = 5;
    if FAMILIES[family % FAMILIES.len()].name == planner::FAMILY.name {
        return star(area, (x, y), colour, hollow);
    }
    match family % 4 {
        0 => area.draw(&Circle::new((x, y), size, style))?,
        1 => {
            area.draw(&Rectangle::new([(x - size + 1, y - size + 1), (x + size - 1, y + size - 1)], style))?
        }
        2 => area.draw(&TriangleMarker::new((x, y), size + 2, style))?,
        _ => {
            let corners = [(x, y - size - 1), (x + size + 1, y), (x, y + size + 1), (x - size - 1, y)];
            if hollow {
                let around: Vec<(i32, i32)> = corners.iter().chain(&corners[..1]).copied().collect();
                area.draw(&PathElement::new(around, style))?;
            } else {
                area.draw(&Polygon::new(corners.to_vec(), style))?;
            }
        }
    }
    Ok(())
}

/// The mark of what a sweep does by itself: larger than all others, on white.
fn star(area: &Area, (x, y): (i32, i32), colour: RGBColor, hollow: bool) -> Drawn {
    let tips = |size: f64| -> Vec<(i32, i32)> {
        let tip = |number: i32| {
            let radius = size * if number % 2 == 0 { 1.0 } else { 0.45 };
            let (sin, cos) = (f64::from(number) * PI / 5.0).sin_cos();
            (x + (radius * sin).round() as i32, y - (radius * cos).round() as i32)
        };
        // The first again at the end, where the outline closes.
        (0..=10).map(tip).collect()
    };
    area.draw(&Polygon::new(tips(15.0), WHITE.filled()))?;
    if hollow {
        area.draw(&PathElement::new(tips(11.0), colour.stroke_width(2)))?;
    } else {
        area.draw(&Polygon::new(tips(11.0), colour.filled()))?;
    }
    Ok(())
}

/// Height of a label's line, and what a letter is wide, px.
const LINE: i32 = 15;
const LETTER: f64 = 5.9;

/// A box in pixels: left, top, right, bottom.
type Box4 = [i32; 4];

fn overlap(a: &Box4, b: &Box4) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// Names of the choices on the front, each where it hides the least.
fn label(area: &Area, front: &[&Point], places: &[(i32, i32)], marks: &[(i32, i32)]) -> Drawn {
    let mut taken: Vec<Box4> = Vec::new();
    let (width, height) = (SIZE.0 as i32 - LEGEND, SIZE.1 as i32);
    for (point, &(x, y)) in front.iter().zip(places) {
        let text = format!("{}: {}", FAMILIES[point.family].name, point.row.choice);
        let wide = (text.chars().count() as f64 * LETTER) as i32;
        let candidates = (1..=7).flat_map(|ring| {
            let (dx, dy) = (9, 6 + (LINE + 1) * (ring - 1));
            [
                (x + dx, y - dy - LINE),
                (x + dx, y + dy),
                (x - dx - wide, y + dy),
                (x - dx - wide, y - dy - LINE),
            ]
        });
        let cost = |&(left, top): &(i32, i32)| {
            let own = [left, top, left + wide, top + LINE];
            let outside = own[0] < 90 || own[2] > width - 8 || own[1] < 40 || own[3] > height - 80;
            let hidden = marks.iter().filter(|(x, y)| overlap(&own, &[x - 6, y - 6, x + 6, y + 6])).count();
            let written = taken.iter().filter(|other| overlap(&own, other)).count();
            let away = (top + LINE / 2 - y).abs() / LINE;
            1000 * i32::from(outside) + 100 * written as i32 + 12 * hidden as i32 + 3 * away
        };
        let Some((left, top)) = candidates.min_by_key(cost) else { continue };
        taken.push([left, top, left + wide, top + LINE]);
        // It ends or begins at its point, whatever its letters are wide; a thread leads to one that had to go far.
        let (near, side) = if left > x { (left, HPos::Left) } else { (left + wide, HPos::Right) };
        let middle = top + LINE / 2;
        if (middle - y).abs() > 3 * LINE / 2 {
            area.draw(&PathElement::new(vec![(x, y), (near, middle)], INK.mix(0.4).stroke_width(1)))?;
        }
        let style = (FONT, 13).into_font().color(&INK).pos(Pos::new(side, VPos::Top));
        area.draw(&Text::new(text, (near, top), style))?;
    }
    Ok(())
}

/// The families that have points, and what else is drawn.
fn key(area: &Area, points: &[Point]) -> Drawn {
    let mut y = 60;
    let mut line = |text: &dyn Display, draw: &dyn Fn(i32) -> Drawn| -> Drawn {
        draw(y)?;
        area.draw(&Text::new(text.to_string(), (44, y - 7), (FONT, 15).into_font().color(&INK)))?;
        y += 27;
        Ok(())
    };
    line(&"Pareto front: nothing else is faster and nearer", &|y| {
        area.draw(&PathElement::new(vec![(10, y), (36, y)], FRONT.mix(0.8).stroke_width(3)))?;
        Ok(())
    })?;
    for (family, about) in FAMILIES.iter().enumerate() {
        let own = || points.iter().filter(|point| point.family == family);
        if own().next().is_none() {
            continue;
        }
        let colour = COLOURS[family % COLOURS.len()];
        let hollow = own().all(|point| point.row.point().is_none());
        line(&about.about, &|y| {
            if !about.parameter.is_empty() {
                area.draw(&PathElement::new(vec![(10, y), (36, y)], colour.mix(0.45).stroke_width(1)))?;
            }
            mark(area, (23, y), family, hollow)
        })?;
    }
    let [least, most] = [LEAST_ERROR, MOST_ERROR].map(|error| decade_label(100.0 * error));
    line(&format!("errors below {least} % and above {most} % stand there"), &|_| Ok(()))?;
    line(&format!("hollow: more than {:.0} % of the steps without answer", 100.0 * MOST_UNANSWERED), &|y| {
        area.draw(&Circle::new((23, y), 5, INK.stroke_width(2)))?;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::tradeoff::errors::{Errors, Quantiles};

    fn row(family: &'static str, time: f64, error: f64, on_front: bool) -> Measured {
        let force = Some(Quantiles { median: error, p95: error, max: error });
        Measured {
            family,
            choice: "<a & b>".into(),
            parameter: None,
            runs: 1,
            time_per_design: time,
            least_time_per_design: time,
            shared: 0.0,
            errors: Errors { force, steps: 1, ..Errors::default() },
            on_front,
        }
    }

    /// Whatever the numbers, there is a picture; names are text and no markup.
    #[test]
    fn there_is_a_picture_of_anything() {
        for rows in [
            vec![],
            vec![row("series", 1e-5, 0.0, true)],
            vec![row("series", 0.0, 1.0, false), row("penalty", f64::NAN, 1e-3, false)],
            vec![row("series", 1e-300, f64::INFINITY, false), row("penalty", 1e3, 1e30, true)],
        ] {
            let picture = svg("a <b> & c", &rows).unwrap();
            assert!(picture.trim_end().ends_with("</svg>"));
            assert!(!picture.contains("<b>") && !picture.contains("<a "));
        }
    }

    #[test]
    fn every_family_has_a_colour_of_its_own() {
        assert_eq!(COLOURS.len(), FAMILIES.len());
        for (index, colour) in COLOURS.iter().enumerate() {
            assert!(!COLOURS[..index].contains(colour), "{index}");
        }
    }

    #[test]
    fn axes_are_whole_decades_around_the_points() {
        assert_eq!(decades([2e-3, 0.5].into_iter(), 1.0..2.0), 1e-3..1.0);
        assert_eq!(decades([1e-3, 1.0].into_iter(), 1.0..2.0), 1e-4..10.0);
        let labels =
            [1e-7, 1e-3, 0.01, 0.1, 1.0, 1000.0, 1e5].map(|value| decade_label(value * (1.0 + 1e-15)));
        assert_eq!(labels, ["1e-7", "1e-3", "0.01", "0.1", "1", "1000", "1e5"]);
    }
}
