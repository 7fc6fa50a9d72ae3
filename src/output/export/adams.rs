//! `adams`: a SPLINE of Adams Solver (.adm), the same for Adams View (.cmd), and the text of the FUNCTION that
//! uses it in both.
//!
//! Adams Solver's documentation, statement SPLINE and function AKISPL: `SPLINE/id, X=x1, ..., Y=y1, ...`, or with
//! `Y=z1, y11, ...` for each z; continuation lines begin with a comma; Akima's method over x, straight lines over
//! z; LINEAR_EXTRAPOLATE.

use super::interpolation::Interpolation;
use super::numbers::plain;
use super::sheet::{Format, Sheet, listed};

pub static FORMAT: Format = Format {
    name: "adams",
    suffix: ".adm",
    about: "a SPLINE for Adams Solver (.adm) and View (.cmd), and the FUNCTION that uses it",
    two_dimensional: true,
    rules: &[Interpolation::Akima],
    damping: true,
    beyond: "straight on (LINEAR_EXTRAPOLATE)",
    write,
    ..Format::LINEAR
};

/// Of the SPLINE.
const ID: &str = "1";

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let table = &sheet.table;
    let x = sheet.with_gap();
    let rows: Vec<Vec<f64>> = (0..table.clearances.len()).map(|i| sheet.forces_with_gap(i)).collect();

    let mut solver = sheet.head("! ");
    solver += &usage(sheet, ID, "10101", "10201");
    solver += &format!("SPLINE/{ID}\n, X = {}\n", continued(&x, "\n, "));
    for (clearance, row) in table.clearances.iter().zip(&rows) {
        let front = if sheet.is_family() { format!("{}, ", plain(*clearance)) } else { String::new() };
        solver += &format!(", Y = {front}{}\n", continued(row, "\n, "));
    }
    solver += ", LINEAR_EXTRAPOLATE\n";

    let name = &sheet.name;
    let mut view = sheet.head("! ");
    view += &usage(sheet, &format!(".model.{name}"), ".model.hole.centre", ".model.pin.centre");
    view += "data_element create spline &\n";
    view += &format!("   spline_name = .model.{name} &\n   linear_extrapolate = yes &\n");
    view += &format!("   x = {} &\n", continued(&x, ", &\n      "));
    view += &format!("   y = {}", continued(&rows.concat(), ", &\n      "));
    if sheet.is_family() {
        view += &format!(" &\n   z = {}", continued(&table.clearances, ", &\n      "));
    }
    view += "\n";
    vec![("", solver), (".cmd", view)]
}

/// A few numbers a line.
fn continued(values: &[f64], line_break: &str) -> String {
    let lines = values.chunks(5).map(|line| listed(line, 5, "", ""));
    lines.collect::<Vec<_>>().join(line_break)
}

fn usage(sheet: &Sheet, spline: &str, hole: &str, pin: &str) -> String {
    let clearance = match sheet.is_family() {
        true if sheet.goes_below_zero() => "MAX(0, DR)".to_string(),
        true => "DR".to_string(),
        false => plain(sheet.table.clearances[0]),
    };
    let z = if sheet.is_family() { "DR" } else { "0" };
    let distance = format!("DM({pin}, {hole}) - {clearance}");
    let mut force = format!("MAX(0, AKISPL({distance}, {z}, {spline}))");
    if let Some(impact) = sheet.impact {
        force += &format!("*MAX(0, 1 + {}*VR({pin}, {hole}))", plain(impact.coefficient));
    }
    let family = if sheet.is_family() { "! DR is the radial clearance, mm.\n" } else { "" };
    format!(
        "! For a translational single-component force between the markers of the pin's and the hole's\n\
         ! centre (mm, N, s); it pulls them together:\n! FUNCTION = -{force}\n{family}"
    )
}
