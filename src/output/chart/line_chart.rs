//! Curves, points, bars and limits over two axes.

use std::fmt::Write as _;

use super::axis::Axis;
use super::frame::{Entry, Frame, labels_width};
use super::style::COLOURS;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marking {
    Line,
    Dashed,
    Dotted,
    Points,
    /// From the x axis up, between a point and the next; the last one only ends the one before.
    Bars,
}

#[derive(Clone, Debug)]
pub struct Series {
    /// In the legend; empty for none.
    pub name: String,
    /// A colour of the style, from 0.
    pub colour: usize,
    pub marking: Marking,
    pub points: Vec<(f64, f64)>,
}

impl Series {
    pub fn new(name: impl Into<String>, colour: usize, marking: Marking, points: Vec<(f64, f64)>) -> Series {
        Series { name: name.into(), colour, marking, points }
    }
}

#[derive(Clone, Debug)]
pub struct LineChart {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
    /// Upright lines, with words above them.
    pub limits: Vec<(f64, String)>,
}

impl LineChart {
    /// For a page that has the style.
    pub fn svg(&self) -> String {
        self.draw(false)
    }

    /// A file by itself, its title above.
    pub fn alone(&self) -> String {
        self.draw(true)
    }

    fn draw(&self, alone: bool) -> String {
        let mut frame = Frame::new(&self.title, labels_width(&self.y), self.limits.len(), alone);
        frame.axes(&self.x, &self.y);
        for series in &self.series {
            let class = series.colour % COLOURS + 1;
            match series.marking {
                Marking::Points => self.points(&mut frame, &series.points, class),
                Marking::Bars => self.bars(&mut frame, &series.points, class),
                Marking::Line => self.line(&mut frame, &series.points, &format!("line s{class}")),
                Marking::Dashed => self.line(&mut frame, &series.points, &format!("line dashed s{class}")),
                Marking::Dotted => self.line(&mut frame, &series.points, &format!("line dotted s{class}")),
            }
        }
        self.draw_limits(&mut frame);
        let named = self.series.iter().filter(|series| !series.name.is_empty());
        let entries: Vec<Entry> = named.map(swatch).collect();
        frame.legend(&entries);
        frame.finish(alone)
    }

    /// A line, cut where it leaves the plot.
    fn line(&self, frame: &mut Frame, points: &[(f64, f64)], class: &str) {
        let placed = points.iter().map(|&(x, y)| {
            let at = self.x.share(x).zip(self.y.share(y));
            // Far outside is as good as infinitely far, and keeps the numbers short.
            at.map(|(x, y)| (x.clamp(-20.0, 20.0), y.clamp(-20.0, 20.0)))
        });
        let placed: Vec<Option<(f64, f64)>> = placed.collect();
        let mut path = String::new();
        let mut pen = None;
        for pair in placed.windows(2) {
            let Some((from, to)) = pair[0].zip(pair[1]).and_then(|(a, b)| clipped(a, b)) else {
                pen = None;
                continue;
            };
            let at = |(x, y): (f64, f64)| {
                let (w, h) = (frame.right - frame.left, frame.bottom - frame.top);
                format!("{:.1} {:.1}", frame.left + x * w, frame.bottom - y * h)
            };
            if pen != Some(from) {
                _ = write!(path, "M{}", at(from));
            }
            _ = write!(path, "L{}", at(to));
            pen = Some(to);
        }
        if !path.is_empty() {
            _ = writeln!(frame.svg, "<path class=\"{class}\" d=\"{path}\"/>");
        }
    }

    fn points(&self, frame: &mut Frame, points: &[(f64, f64)], class: usize) {
        let inside = |share: f64| (-0.01..=1.01).contains(&share);
        for &(x, y) in points {
            let shares = self.x.share(x).zip(self.y.share(y));
            if !shares.is_some_and(|(x, y)| inside(x) && inside(y)) {
                continue;
            }
            if let (Some(x), Some(y)) = (frame.x(&self.x, x), frame.y_of(&self.y, y)) {
                _ = writeln!(
                    frame.svg,
                    "<circle class=\"dot s{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>"
                );
            }
        }
    }

    fn bars(&self, frame: &mut Frame, points: &[(f64, f64)], class: usize) {
        let mut path = String::new();
        for pair in points.windows(2) {
            let (Some(from), Some(to)) = (frame.x(&self.x, pair[0].0), frame.x(&self.x, pair[1].0)) else {
                continue;
            };
            let Some(height) = frame.y_of(&self.y, pair[0].1).filter(|_| pair[0].1 > 0.0) else { continue };
            _ = write!(
                path,
                "M{:.1} {:.1}V{height:.1}H{:.1}V{:.1}Z",
                from + 0.5,
                frame.bottom,
                to - 0.5,
                frame.bottom
            );
        }
        _ = writeln!(frame.svg, "<path class=\"bar f{class}\" d=\"{path}\"/>");
    }

    fn draw_limits(&self, frame: &mut Frame) {
        for (place, (value, name)) in self.limits.iter().enumerate() {
            let Some(at) = frame.x(&self.x, *value) else { continue };
            let y = frame.top - 7.0 - 19.0 * place as f64;
            _ = writeln!(
                frame.svg,
                "<path class=\"limit\" stroke-dasharray=\"5 3\" d=\"M{at:.1} {:.1}V{:.1}\"/>",
                y + 3.0,
                frame.bottom
            );
            let half = 0.5 * super::text::width(name);
            let middle = at.clamp(half + 2.0, super::frame::WIDTH - half - 2.0);
            _ = writeln!(
                frame.svg,
                "<text class=\"ink\" text-anchor=\"middle\" x=\"{middle:.1}\" y=\"{y:.1}\">{}</text>",
                super::text::escaped(name)
            );
        }
    }
}

fn swatch(series: &Series) -> Entry<'static> {
    let class = series.colour % COLOURS + 1;
    let marking = series.marking;
    let draw = move |x: f64, y: f64| match marking {
        Marking::Points => {
            format!("<circle class=\"dot s{class}\" cx=\"{:.1}\" cy=\"{y:.1}\" r=\"3\"/>\n", x + 12.0)
        }
        Marking::Bars => {
            format!(
                "<rect class=\"bar f{class}\" x=\"{x:.1}\" y=\"{:.1}\" width=\"24\" height=\"10\"/>\n",
                y - 5.0
            )
        }
        line => {
            let style = match line {
                Marking::Dashed => " dashed",
                Marking::Dotted => " dotted",
                _ => "",
            };
            format!("<path class=\"line{style} s{class}\" d=\"M{x:.1} {y:.1}h24\"/>\n")
        }
    };
    (series.name.clone(), Box::new(draw))
}

/// The part of a piece inside the unit square; `None` where there is none.
fn clipped(a: (f64, f64), b: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    let sides = [(a.0, b.0 - a.0), (1.0 - a.0, a.0 - b.0), (a.1, b.1 - a.1), (1.0 - a.1, a.1 - b.1)];
    for (inside, slope) in sides {
        if slope == 0.0 {
            if inside < 0.0 {
                return None;
            }
        } else if slope > 0.0 {
            from = from.max(-inside / slope);
        } else {
            to = to.min(-inside / slope);
        }
    }
    let at = |t: f64| match t {
        0.0 => a,
        1.0 => b,
        t => (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1)),
    };
    (from < to).then(|| (at(from), at(to)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_ends_where_the_plot_does() {
        assert_eq!(clipped((0.5, 0.5), (0.5, 1.5)), Some(((0.5, 0.5), (0.5, 1.0))));
        assert_eq!(clipped((-1.0, 0.5), (3.0, 0.5)), Some(((0.0, 0.5), (1.0, 0.5))));
        assert_eq!(clipped((1.5, 0.5), (1.6, 0.9)), None);
    }

    /// Whatever the numbers, there is a picture; names are text and no markup.
    #[test]
    fn there_is_a_picture_of_anything() {
        let values = [0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300];
        let points: Vec<(f64, f64)> =
            values.iter().flat_map(|x| values.iter().map(move |y| (*x, *y))).collect();
        for marking in [Marking::Line, Marking::Points, Marking::Bars] {
            for axis in [Axis::from_zero, Axis::log] as [fn(&str, std::vec::IntoIter<f64>) -> Axis; 2] {
                let chart = LineChart {
                    title: "a <b> & c".into(),
                    x: axis("x <i>", points.iter().map(|p| p.0).collect::<Vec<_>>().into_iter()),
                    y: axis("y", vec![1.0].into_iter()),
                    series: vec![Series::new("<s>", 9, marking, points.clone())],
                    limits: vec![(1.0, "<l>".into())],
                };
                for picture in [chart.svg(), chart.alone()] {
                    assert!(picture.trim_end().ends_with("</svg>"));
                    assert!(
                        !["<b>", "<i>", "<s>", "<l>", "NaN", "inf"].iter().any(|bad| picture.contains(bad)),
                        "{picture}"
                    );
                }
            }
        }
    }
}
