//! Cells of colour over two axes, with the scale of the colour below.

use std::fmt::Write as _;

use super::axis::{Axis, Spacing, range};
use super::frame::Frame;
use super::style::scale_colour;
use super::text::{escaped, number, width};

/// One axis of a map: cells side by side, evenly wide, with a label at each or at the lines between them.
#[derive(Clone, Debug)]
pub struct MapAxis {
    pub name: String,
    pub cells: usize,
    /// Places in cells from 0, with their words: the middle of the first cell is at 0.5.
    pub labels: Vec<(f64, String)>,
}

#[derive(Clone, Debug)]
pub struct Cell {
    pub column: usize,
    pub row: usize,
    /// `None` where all designs of the cell failed.
    pub value: Option<f64>,
    /// Told where a mouse rests.
    pub about: String,
}

#[derive(Clone, Debug)]
pub struct MapChart {
    pub title: String,
    pub x: MapAxis,
    pub y: MapAxis,
    /// Of the colour: name with unit.
    pub value_name: String,
    pub cells: Vec<Cell>,
}

/// A colour scale is logarithmic from this ratio of its ends on.
const LOG_FROM: f64 = 12.0;
const BAR_STEPS: usize = 48;

impl MapChart {
    pub fn svg(&self) -> String {
        self.draw(false)
    }

    pub fn alone(&self) -> String {
        self.draw(true)
    }

    fn draw(&self, alone: bool) -> String {
        let widest = self.y.labels.iter().map(|label| width(&label.1)).fold(0.0, f64::max);
        let mut frame = Frame::new(&self.title, widest, 0, alone);
        let (wide, high) = (frame.right - frame.left, frame.bottom - frame.top);
        let step = (wide / self.x.cells.max(1) as f64, high / self.y.cells.max(1) as f64);
        let colours = self.colour_axis();
        for cell in &self.cells {
            let (x, y) =
                (frame.left + step.0 * cell.column as f64, frame.bottom - step.1 * (cell.row + 1) as f64);
            let about = escaped(&cell.about);
            match cell.value.and_then(|value| colours.share(value)) {
                Some(share) => {
                    let colour = scale_colour(share);
                    _ = writeln!(
                        frame.svg,
                        "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\" \
                         fill=\"{colour}\"><title>{about}</title></rect>",
                        step.0 + 0.15,
                        step.1 + 0.15
                    );
                }
                None => {
                    let (half_x, half_y) = (0.5 * step.0, 0.5 * step.1);
                    let arm = (0.6 * half_x.min(half_y)).min(5.0);
                    _ = writeln!(
                        frame.svg,
                        "<path class=\"line s6\" d=\"M{:.1} {:.1}l{2:.1} {2:.1}m0 -{2:.1}l-{2:.1} {2:.1}\">\
                         <title>{about}</title></path>",
                        x + half_x - arm,
                        y + half_y - arm,
                        2.0 * arm
                    );
                }
            }
        }
        frame.border();
        let mut free = f64::NEG_INFINITY;
        for (place, label) in &self.x.labels {
            let at = frame.left + step.0 * place;
            let half = 0.5 * width(label);
            if at - half < free || at + half > super::frame::WIDTH {
                continue;
            }
            free = at + half + 8.0;
            _ = writeln!(
                frame.svg,
                "<text class=\"ink\" text-anchor=\"middle\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
                frame.bottom + 18.0,
                escaped(label)
            );
        }
        let mut free = f64::INFINITY;
        for (place, label) in &self.y.labels {
            let at = frame.bottom - step.1 * place;
            if at > free {
                continue;
            }
            free = at - 16.0;
            _ = writeln!(
                frame.svg,
                "<text class=\"ink\" text-anchor=\"end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                frame.left - 7.0,
                at + 4.5,
                escaped(label)
            );
        }
        frame.names(&self.x.name, &self.y.name);
        self.colour_bar(&mut frame, &colours);
        frame.finish(alone)
    }

    fn colour_axis(&self) -> Axis {
        let values = || self.cells.iter().filter_map(|cell| cell.value);
        let (low, high) = range(values()).unwrap_or((0.0, 1.0));
        let spacing = if low > 0.0 && high / low > LOG_FROM { Spacing::Log } else { Spacing::Linear };
        let high = if high > low { high } else { low + low.abs().max(1.0) };
        Axis { name: self.value_name.clone(), spacing, low, high }
    }

    fn colour_bar(&self, frame: &mut Frame, colours: &Axis) {
        let (left, right) = (frame.left, frame.right);
        let top = frame.y + 4.0;
        let step = (right - left) / BAR_STEPS as f64;
        for place in 0..BAR_STEPS {
            let colour = scale_colour(place as f64 / (BAR_STEPS - 1) as f64);
            _ = writeln!(
                frame.svg,
                "<rect x=\"{:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"11\" fill=\"{colour}\"/>",
                left + step * place as f64,
                step + 0.3
            );
        }
        // Both ends of the scale, and what is round between them and far enough from both.
        let ends = [(colours.low, number(colours.low, 3)), (colours.high, number(colours.high, 3))];
        let room = |share: f64, label: &str| {
            let at = share * (right - left);
            let clear = 0.5 * width(label) + 10.0;
            at - clear > width(&ends[0].1) && at + clear < right - left - width(&ends[1].1)
        };
        let ticks = colours.ticks(5, right - left, true).into_iter();
        let between =
            ticks.filter(|(value, label)| colours.share(*value).is_some_and(|share| room(share, label)));
        for (value, label) in between {
            let at = left + colours.share(value).unwrap_or(0.0) * (right - left);
            _ = writeln!(
                frame.svg,
                "<text class=\"ink\" text-anchor=\"middle\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
                top + 26.0,
                escaped(&label)
            );
        }
        for ((_, label), (at, anchor)) in ends.iter().zip([(left, "start"), (right, "end")]) {
            _ = writeln!(
                frame.svg,
                "<text class=\"ink\" text-anchor=\"{anchor}\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
                top + 26.0,
                escaped(label)
            );
        }
        _ = writeln!(
            frame.svg,
            "<text class=\"ink\" text-anchor=\"middle\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            0.5 * (left + right),
            top + 44.0,
            escaped(&self.value_name)
        );
        frame.y = top + 50.0;
    }
}
