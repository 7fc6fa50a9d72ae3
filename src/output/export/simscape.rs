//! `simscape`: a script with the vectors of a lookup table (PS Lookup Table, 1-D and 2-D Lookup Table, interp1,
//! interp2), m and N.

use super::numbers::{plain, rounded};
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "simscape",
    suffix: ".m",
    reserved: "break case catch classdef continue else elseif end for function global if otherwise parfor \
               persistent return spmd switch try while",
    about: "a MATLAB script with breakpoints and table for Simscape's and Simulink's lookup tables",
    two_dimensional: true,
    length: 1e-3,
    beyond: "the block's own: choose Linear",
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let (name, table) = (&sheet.name, &sheet.table);
    let mut text = sheet.head("% ");
    text += &format!("{name}_indentation = {}; % m\n", vector(&sheet.with_gap()));
    let clearances: Vec<f64> =
        table.clearances.iter().map(|clearance| rounded(clearance * 1e-3, 12)).collect();
    text += &format!("{name}_radial_clearance = {}; % m\n", vector(&clearances));
    let matrix = |row: &dyn Fn(usize) -> Vec<f64>| {
        let rows: Vec<String> = (0..clearances.len()).map(|i| vector(&row(i))).collect();
        format!("[{}]'", rows.join("; ...\n"))
    };
    let unit = if sheet.is_family() {
        "a row for each indentation, a column for each clearance"
    } else {
        "a column"
    };
    text += &format!("{name}_force = {}; % N, {unit}\n", matrix(&|i| sheet.forces_with_gap(i)));
    let stiffness = |i: usize| -> Vec<f64> {
        let own = table.stiffnesses[i].iter().map(|value| value * 1e3);
        [0.0, 0.0].into_iter().chain(own).collect()
    };
    text += &format!("{name}_stiffness = {}; % N/m\n", matrix(&stiffness));
    vec![("", text)]
}

/// A row, some numbers a line.
fn vector(values: &[f64]) -> String {
    let line = |line: &[f64]| line.iter().map(|value| plain(*value)).collect::<Vec<_>>().join(" ");
    format!("[{}]", values.chunks(6).map(line).collect::<Vec<_>>().join(" ...\n  "))
}
