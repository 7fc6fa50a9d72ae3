//! `residuals.svg`: measured points with the fitted curve, and below it what is left between them.

use std::ops::Range;

use plotters::prelude::*;

use crate::calibrate::calibration::Calibration;
use crate::error::Error;

const SIZE: (u32, u32) = (900, 700);
/// Height of the upper picture.
const UPPER: i32 = 430;
const FONT: &str = "sans-serif";
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(228, 228, 228);
const CURVE: RGBColor = RGBColor(11, 95, 165);
const POINT: RGBColor = RGBColor(200, 30, 30);

type Drawn = Result<(), Box<dyn std::error::Error>>;

/// The whole picture.
pub fn svg(title: &str, calibration: &Calibration) -> Result<String, Error> {
    let mut text = String::new();
    draw(title, calibration, &mut text).map_err(|error| Error::Plot { problem: error.to_string() })?;
    Ok(text)
}

fn draw(title: &str, calibration: &Calibration, text: &mut String) -> Drawn {
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (above, below) = root.split_vertically(UPPER);
    let points = &calibration.points;
    let wide = range(points.iter().map(|point| point.measured.indentation));
    let forces = points.iter().flat_map(|point| [point.measured.force, point.force, 0.0]);
    let mut chart = ChartBuilder::on(&above)
        .caption(format!("Measured and fitted: {title}"), (FONT, 20).into_font().color(&INK))
        .margin(12)
        .x_label_area_size(20)
        .y_label_area_size(80)
        .build_cartesian_2d(wide.clone(), range(forces))?;
    chart
        .configure_mesh()
        .y_desc("force, N")
        .x_label_formatter(&|_| String::new())
        .label_style((FONT, 14).into_font().color(&INK))
        .axis_desc_style((FONT, 15).into_font().color(&INK))
        .light_line_style(WHITE)
        .bold_line_style(GRID)
        .draw()?;
    chart.draw_series(LineSeries::new(calibration.line.iter().copied(), CURVE.stroke_width(2)))?;
    chart.draw_series(points.iter().map(|point| {
        Circle::new((point.measured.indentation, point.measured.force), 3, POINT.stroke_width(1))
    }))?;

    let band = |measured: &crate::study::measured::MeasuredPoint| {
        measured.sigma.or(calibration.residual_deviation).map_or(0.0, |sigma| 2.0 * sigma)
    };
    let spread = points.iter().flat_map(|point| {
        let reach = band(&point.measured);
        [point.residual(), reach, -reach]
    });
    let mut chart = ChartBuilder::on(&below)
        .margin(12)
        .x_label_area_size(48)
        .y_label_area_size(80)
        .build_cartesian_2d(wide.clone(), range(spread))?;
    chart
        .configure_mesh()
        .x_desc("measured indentation, mm (bars: two standard deviations)")
        .y_desc("measured less fitted, N")
        .y_labels(7)
        .label_style((FONT, 14).into_font().color(&INK))
        .axis_desc_style((FONT, 15).into_font().color(&INK))
        .light_line_style(WHITE)
        .bold_line_style(GRID)
        .draw()?;
    chart.draw_series(LineSeries::new([(wide.start, 0.0), (wide.end, 0.0)], CURVE.stroke_width(2)))?;
    chart.draw_series(points.iter().map(|point| {
        let (x, y, reach) = (point.measured.indentation, point.residual(), band(&point.measured));
        PathElement::new(vec![(x, y - reach), (x, y + reach)], POINT.mix(0.35).stroke_width(1))
    }))?;
    chart.draw_series(
        points
            .iter()
            .map(|point| Circle::new((point.measured.indentation, point.residual()), 3, POINT.filled())),
    )?;
    root.present()?;
    Ok(())
}

/// Around all values, with a little room; never empty.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    let room = match high - low {
        room if room > 0.0 => 0.05 * room,
        _ if high.abs() > 0.0 => 0.05 * high.abs(),
        _ => 1.0,
    };
    low - room..high + room
}
