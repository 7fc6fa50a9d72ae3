//! `calculix`: a nonlinear spring of CalculiX between two nodes, mm and N. CalculiX CrunchiX manual, *SPRING: the
//! two degrees of freedom for SPRING2, then force and elongation a line, elongation ascending; the force is
//! constant outside.

use super::interpolation::Interpolation;
use super::numbers::plain;
use super::sheet::{Format, Sheet};
use super::table::Between;

pub static FORMAT: Format = Format {
    name: "calculix",
    suffix: "_calculix.inp",
    about: "*SPRING, NONLINEAR for CalculiX",
    two_dimensional: false,
    rules: &[Interpolation::Linear],
    between: Between::Linear,
    damping: false,
    length: 1.0,
    least_step: 0.0,
    beyond: "none: the last force, flat, and singular",
    write,
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let mut text = sheet.head("** ");
    text +=
        "** Elements of type SPRINGA: elongation is the indentation, first touch at the nodes' distance.\n";
    text += &format!("*SPRING, ELSET={}, NONLINEAR\n\n", sheet.name);
    for (x, y) in sheet.pairs() {
        text += &format!("{}, {}\n", plain(y), plain(x));
    }
    vec![("", text)]
}
