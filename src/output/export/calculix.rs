//! `calculix`: a nonlinear spring of CalculiX between two nodes, mm and N. CalculiX CrunchiX manual, *SPRING: the
//! two degrees of freedom for SPRING2, then force and elongation a line, elongation ascending; the force is
//! constant outside.

use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "calculix",
    suffix: "_calculix.inp",
    about: "*SPRING, NONLINEAR for CalculiX",
    beyond: "none: the last force, flat, and singular",
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let mut text = sheet.head("** ");
    text +=
        "** Elements of type SPRINGA: elongation is the indentation, first touch at the nodes' distance.\n";
    text += &format!("*SPRING, ELSET={}, NONLINEAR\n\n", sheet.name);
    text += &sheet.lines_of_force_first();
    vec![("", text)]
}
