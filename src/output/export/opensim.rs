//! `opensim`: a PiecewiseLinearFunction of OpenSim's XML, m and N. OpenSim's API, class PiecewiseLinearFunction:
//! lists `x` and `y`, straight lines between, and beyond the ends the slope of the last one. Its slopes are wrong
//! between points that are less than 1e-7 apart (TINY_NUMBER of its source), here 1e-4 mm: it needs a longer first
//! step.

use super::numbers::plain;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "opensim",
    suffix: "_opensim.xml",
    about: "a PiecewiseLinearFunction for OpenSim",
    length: 1e-3,
    least_step: 1e-4,
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let (x, y): (Vec<String>, Vec<String>) =
        sheet.pairs().into_iter().map(|(x, y)| (plain(x), plain(y))).unzip();
    let text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!--\n{}-->\n<OpenSimDocument Version=\"40500\">\n  \
         <PiecewiseLinearFunction name=\"{}\">\n    <x>{}</x>\n    <y>{}</y>\n  </PiecewiseLinearFunction>\n\
         </OpenSimDocument>\n",
        sheet.head("  "),
        sheet.name,
        x.join(" "),
        y.join(" ")
    );
    vec![("", text)]
}
