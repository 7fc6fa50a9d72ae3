//! `csv`: one axis, values and derivative; with several clearances a column more in front. `#` begins a comment.

use super::interpolation::Interpolation;
use super::numbers::plain;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "csv",
    suffix: "_table.csv",
    about: "indentation, force and stiffness in columns",
    two_dimensional: true,
    rules: &[Interpolation::Linear, Interpolation::Hermite],
    beyond: "the reader's own; the last slope is in the last row",
    write,
    ..Format::LINEAR
};

/// The header is the first line, so that every reader finds it; the head is beside, where no reader trips over it.
fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let table = &sheet.table;
    let mut text = String::from(if sheet.is_family() { "radial_clearance_mm," } else { "" });
    text += "indentation_mm,force_n,tangent_stiffness_n_per_mm\n";
    let gap = -sheet.end();
    for (i, clearance) in table.clearances.iter().enumerate() {
        let front = if sheet.is_family() { format!("{},", plain(*clearance)) } else { String::new() };
        let mut row = |x: f64, force: f64, stiffness: f64| {
            text += &format!("{front}{},{},{}\n", plain(x), plain(force), plain(stiffness));
        };
        row(gap, 0.0, 0.0);
        for (j, x) in table.indentations.iter().enumerate() {
            row(*x, table.forces[i][j], table.stiffnesses[i][j]);
        }
    }
    vec![("", text), ("_about.txt", sheet.head(""))]
}
