//! What all charts have in common: sheet, axes with ticks and names, title.

use std::fmt::Write as _;

use super::axis::Axis;
use super::style::style_sheet;
use super::text::{escaped, width};

/// Width of every chart, px; pages scale it.
pub const WIDTH: f64 = 480.0;
/// Height of the plot itself.
const PLOT: f64 = 250.0;
const RIGHT: f64 = 14.0;
const LINE: f64 = 19.0;

/// An SVG text that grows: axes are drawn, the rest is appended.
pub struct Frame {
    pub svg: String,
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
    /// Where the next line of the legend goes.
    pub y: f64,
    title: String,
}

impl Frame {
    /// With room on the left for labels this wide, and above for `headlines` lines.
    pub fn new(title: &str, labels_width: f64, headlines: usize, alone: bool) -> Frame {
        let top = 10.0 + LINE * (headlines + usize::from(alone)) as f64;
        let mut frame = Frame {
            svg: String::new(),
            left: 35.0 + labels_width,
            right: WIDTH - RIGHT,
            top,
            bottom: top + PLOT,
            y: 0.0,
            title: title.into(),
        };
        if alone {
            let text = format!("<tspan font-weight=\"600\">{}</tspan>", escaped(title));
            _ = writeln!(frame.svg, "<text class=\"ink\" x=\"{:.0}\" y=\"17\">{text}</text>", 8.0);
        }
        frame
    }

    pub fn x(&self, axis: &Axis, value: f64) -> Option<f64> {
        axis.share(value).map(|share| self.left + share * (self.right - self.left))
    }

    pub fn y_of(&self, axis: &Axis, value: f64) -> Option<f64> {
        axis.share(value).map(|share| self.bottom - share * (self.bottom - self.top))
    }

    /// Grid, ticks, labels and names of both axes.
    pub fn axes(&mut self, x: &Axis, y: &Axis) {
        let mut grid = String::new();
        for value in x.minor_ticks() {
            if let Some(at) = self.x(x, value) {
                _ = write!(grid, "M{at:.1} {:.1}V{:.1}", self.top, self.bottom);
            }
        }
        for value in y.minor_ticks() {
            if let Some(at) = self.y_of(y, value) {
                _ = write!(grid, "M{:.1} {at:.1}H{:.1}", self.left, self.right);
            }
        }
        if !grid.is_empty() {
            _ = writeln!(self.svg, "<path class=\"grid\" stroke-opacity=\"0.55\" d=\"{grid}\"/>");
            grid.clear();
        }
        let mut labels = String::new();
        for (value, label) in x.ticks(7, self.right - self.left, true) {
            let Some(at) = self.x(x, value) else { continue };
            _ = write!(grid, "M{at:.1} {:.1}V{:.1}", self.top, self.bottom);
            // The last label stays on the sheet.
            let at = at.min(WIDTH - 2.0 - 0.5 * width(&label));
            _ = writeln!(
                labels,
                "<text class=\"ink\" text-anchor=\"middle\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
                self.bottom + 18.0,
                escaped(&label)
            );
        }
        for (value, label) in y.ticks(6, self.bottom - self.top, false) {
            let Some(at) = self.y_of(y, value) else { continue };
            _ = write!(grid, "M{:.1} {at:.1}H{:.1}", self.left, self.right);
            _ = writeln!(
                labels,
                "<text class=\"ink\" text-anchor=\"end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                self.left - 7.0,
                at + 4.5,
                escaped(&label)
            );
        }
        _ = writeln!(self.svg, "<path class=\"grid\" d=\"{grid}\"/>");
        self.svg += &labels;
        self.border();
        self.names(&x.name, &y.name);
    }

    /// The lines of the two axes.
    pub fn border(&mut self) {
        _ = writeln!(
            self.svg,
            "<path class=\"axis\" fill=\"none\" d=\"M{:.1} {:.1}V{:.1}H{:.1}\"/>",
            self.left, self.top, self.bottom, self.right
        );
    }

    /// Names of the axes; the legend comes below.
    pub fn names(&mut self, x: &str, y: &str) {
        let middle = 0.5 * (self.left + self.right);
        _ = writeln!(
            self.svg,
            "<text class=\"ink\" text-anchor=\"middle\" x=\"{middle:.1}\" y=\"{:.1}\">{}</text>",
            self.bottom + 38.0,
            escaped(x)
        );
        let middle = 0.5 * (self.top + self.bottom);
        _ = writeln!(
            self.svg,
            "<text class=\"ink\" text-anchor=\"middle\" transform=\"translate(14 {middle:.1}) rotate(-90)\">{}</text>",
            escaped(y)
        );
        self.y = self.bottom + 48.0;
    }

    /// Entries side by side, as many as go on a line: what draws the swatch, given its place, and the words.
    pub fn legend(&mut self, entries: &[Entry]) {
        if entries.is_empty() {
            return;
        }
        let mut x = self.left.min(40.0);
        let first = x;
        self.y += 0.6 * LINE;
        for (name, swatch) in entries {
            let wide = 36.0 + width(name);
            if x > first && x + wide > WIDTH - 4.0 {
                (x, self.y) = (first, self.y + LINE);
            }
            self.svg += &swatch(x, self.y - 4.5);
            _ = writeln!(
                self.svg,
                "<text class=\"ink\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                x + 30.0,
                self.y,
                escaped(name)
            );
            x += wide + 16.0;
        }
        self.y += 0.4 * LINE;
    }

    /// The whole picture; `alone` with its own style and paper.
    pub fn finish(self, alone: bool) -> String {
        let height = (self.y + 6.0).ceil();
        let title = escaped(&self.title);
        let (name, paper) = if alone {
            let style = style_sheet();
            (
                format!(" xmlns=\"{}\" width=\"{}\" height=\"{}\"", NAMESPACE, WIDTH * 1.25, height * 1.25),
                format!("<style>\n{style}</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n"),
            )
        } else {
            (String::new(), String::new())
        };
        format!(
            "<svg class=\"chart\"{name} viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{title}\">\n{paper}{}</svg>\n",
            self.svg
        )
    }
}

const NAMESPACE: &str = "http://www.w3.org/2000/svg";

/// A name in a legend, and what draws its swatch at a place.
pub type Entry<'a> = (String, Box<dyn Fn(f64, f64) -> String + 'a>);

/// The widest label of an axis that stands upright, px.
pub fn labels_width(axis: &Axis) -> f64 {
    axis.ticks(6, PLOT, false).iter().map(|tick| width(&tick.1)).fold(0.0, f64::max)
}
