//! Lying bars with whiskers, in groups with a name on the left, in panels one below the other.

use std::fmt::Write as _;

use super::axis::Axis;
use super::frame::{Entry, Frame};
use super::style::COLOURS;
use super::text::{escaped, width};

/// From zero to a value; a whisker from end to end over it.
#[derive(Clone, Copy, Debug)]
pub struct Bar {
    pub value: f64,
    pub whisker: [f64; 2],
}

/// Bars that stand together, one of each series.
#[derive(Clone, Debug)]
pub struct BarGroup {
    pub name: String,
    pub bars: Vec<Bar>,
}

#[derive(Clone, Debug)]
pub struct BarPanel {
    pub heading: String,
    pub groups: Vec<BarGroup>,
}

#[derive(Clone, Debug)]
pub struct BarChart {
    pub title: String,
    pub x: Axis,
    /// Names of the series, in the order of a group's bars.
    pub series: Vec<String>,
    pub panels: Vec<BarPanel>,
}

/// px.
const BAR: f64 = 9.0;
const GAP: f64 = 10.0;
const HEADING: f64 = 26.0;
/// Half of a whisker's end.
const END: f64 = 3.0;
/// Some fonts are wider than others.
const ROOM: f64 = 1.08;
/// Longer names are cut: the plot needs the room.
const WIDEST_NAME: f64 = 200.0;

impl BarChart {
    /// A file by itself, its title above.
    pub fn alone(&self) -> String {
        let groups = || self.panels.iter().flat_map(|panel| &panel.groups);
        let widest = groups().map(|group| width(&fitted(&group.name))).fold(0.0, f64::max);
        let mut frame = Frame::new(&self.title, ROOM * widest - 20.0, 0, true);
        let heights = groups().map(|group| BAR * group.bars.len() as f64 + GAP);
        frame.bottom = frame.top + heights.sum::<f64>() + HEADING * self.panels.len() as f64;
        self.axis(&mut frame);
        let mut y = frame.top;
        // The line on the left leaves out the headings, which are as wide as the sheet.
        let mut lines = format!("M{:.1} {:.1}H{:.1}", frame.left, frame.bottom, frame.right);
        for panel in &self.panels {
            _ = writeln!(
                frame.svg,
                "<text class=\"faint\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                8.0,
                y + 0.7 * HEADING,
                escaped(&panel.heading)
            );
            y += HEADING;
            let first = y;
            for group in &panel.groups {
                self.group(&mut frame, group, y);
                y += BAR * group.bars.len() as f64 + GAP;
            }
            _ = write!(lines, "M{:.1} {first:.1}V{y:.1}", frame.left);
        }
        _ = writeln!(frame.svg, "<path class=\"axis\" fill=\"none\" d=\"{lines}\"/>");
        frame.names(&self.x.name, "");
        let entries: Vec<Entry> = self.series.iter().enumerate().map(swatch).collect();
        frame.legend(&entries);
        frame.finish(true)
    }

    /// Grid and labels of the axis below.
    fn axis(&self, frame: &mut Frame) {
        let mut grid = String::new();
        for (value, label) in self.x.ticks(6, frame.right - frame.left, true) {
            let Some(at) = frame.x(&self.x, value) else { continue };
            _ = write!(grid, "M{at:.1} {:.1}V{:.1}", frame.top, frame.bottom);
            _ = writeln!(
                frame.svg,
                "<text class=\"ink\" text-anchor=\"middle\" x=\"{at:.1}\" y=\"{:.1}\">{}</text>",
                frame.bottom + 18.0,
                escaped(&label)
            );
        }
        _ = writeln!(frame.svg, "<path class=\"grid\" d=\"{grid}\"/>");
    }

    fn group(&self, frame: &mut Frame, group: &BarGroup, top: f64) {
        _ = writeln!(
            frame.svg,
            "<text class=\"ink\" text-anchor=\"end\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            frame.left - 7.0,
            top + 0.5 * BAR * group.bars.len() as f64 + 4.5,
            escaped(&fitted(&group.name))
        );
        let mut whiskers = String::new();
        for (place, bar) in group.bars.iter().enumerate() {
            let y = top + BAR * place as f64;
            let places =
                [0.0, bar.value, bar.whisker[0], bar.whisker[1]].map(|value| frame.x(&self.x, value));
            let [Some(zero), Some(end), Some(low), Some(high)] = places else { continue };
            _ = writeln!(
                frame.svg,
                "<rect class=\"bar f{}\" x=\"{:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
                place % COLOURS + 1,
                zero.min(end),
                (end - zero).abs(),
                BAR - 1.0
            );
            let middle = y + 0.5 * (BAR - 1.0);
            _ = write!(whiskers, "M{low:.1} {middle:.1}H{high:.1}");
            for at in [low, high] {
                _ = write!(whiskers, "M{at:.1} {:.1}V{:.1}", middle - END, middle + END);
            }
        }
        _ = writeln!(frame.svg, "<path class=\"limit\" fill=\"none\" d=\"{whiskers}\"/>");
    }
}

fn swatch((place, name): (usize, &String)) -> Entry<'_> {
    let class = place % COLOURS + 1;
    let draw = move |x: f64, y: f64| {
        format!(
            "<rect class=\"bar f{class}\" x=\"{x:.1}\" y=\"{:.1}\" width=\"22\" height=\"{BAR}\"/>\n",
            y - 0.5 * BAR
        )
    };
    (name.clone(), Box::new(draw))
}

/// A name as far as there is room for it.
fn fitted(name: &str) -> String {
    if width(name) <= WIDEST_NAME {
        return name.into();
    }
    let mut cut = String::new();
    for character in name.chars() {
        cut.push(character);
        if width(&cut) > WIDEST_NAME - width("...") {
            break;
        }
    }
    cut + "..."
}
