//! `abaqus`: the behaviour of a connector, mm and N. Keywords guide, *CONNECTOR ELASTICITY with COMPONENT and
//! NONLINEAR: force, relative displacement a line; EXTRAPOLATION=LINEAR; *CONNECTOR BEHAVIOR, REGULARIZE=OFF keeps
//! the points in Abaqus/Explicit.

use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "abaqus",
    suffix: "_abaqus.inp",
    about: "*CONNECTOR ELASTICITY, NONLINEAR for Abaqus",
    beyond: "straight on (EXTRAPOLATION=LINEAR)",
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let mut text = sheet.head("** ");
    text += &format!("*CONNECTOR BEHAVIOR, NAME={}, EXTRAPOLATION=LINEAR, REGULARIZE=OFF\n", sheet.name);
    text += "*CONNECTOR ELASTICITY, COMPONENT=1, NONLINEAR, EXTRAPOLATION=LINEAR\n";
    text += &sheet.lines_of_force_first();
    vec![("", text)]
}
