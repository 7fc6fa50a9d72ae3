//! `abaqus`: the behaviour of a connector, mm and N. Keywords guide, *CONNECTOR ELASTICITY with COMPONENT and
//! NONLINEAR: force, relative displacement a line; EXTRAPOLATION=LINEAR; *CONNECTOR BEHAVIOR, REGULARIZE=OFF keeps
//! the points in Abaqus/Explicit.

use super::interpolation::Interpolation;
use super::numbers::plain;
use super::sheet::{Format, Sheet};
use super::table::Between;

pub static FORMAT: Format = Format {
    name: "abaqus",
    suffix: "_abaqus.inp",
    about: "*CONNECTOR ELASTICITY, NONLINEAR for Abaqus",
    two_dimensional: false,
    rules: &[Interpolation::Linear],
    between: Between::Linear,
    damping: false,
    length: 1.0,
    least_step: 0.0,
    beyond: "straight on (EXTRAPOLATION=LINEAR)",
    write,
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let mut text = sheet.head("** ");
    text += &format!("*CONNECTOR BEHAVIOR, NAME={}, EXTRAPOLATION=LINEAR, REGULARIZE=OFF\n", sheet.name);
    text += "*CONNECTOR ELASTICITY, COMPONENT=1, NONLINEAR, EXTRAPOLATION=LINEAR\n";
    for (x, y) in sheet.pairs() {
        text += &format!("{}, {}\n", plain(y), plain(x));
    }
    vec![("", text)]
}
