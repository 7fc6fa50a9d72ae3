//! `recurdyn`: two columns for the import of a spline, also that of Ansys Motion: ascending, more than three rows,
//! no header. What it is stands in a text beside it, because the import takes no comments. RecurDyn's online help,
//! AKISPL: Akima's method.

use super::interpolation::Interpolation;
use super::numbers::plain;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "recurdyn",
    suffix: "_recurdyn.csv",
    about: "two columns for a spline of RecurDyn or Ansys Motion",
    rules: &[Interpolation::Akima, Interpolation::Linear],
    beyond: "the spline's own: choose linear",
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let rows = sheet.pairs().into_iter().map(|(x, y)| format!("{},{}\n", plain(x), plain(y)));
    vec![("", rows.collect()), ("_about.txt", sheet.head(""))]
}
