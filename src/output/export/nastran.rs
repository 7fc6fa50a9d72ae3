//! `nastran`: bulk data for Nastran and OptiStruct: NLRGAP with the table of force over penetration, and PBUSHT
//! with the table of force over displacement. mm and N.
//!
//! Quick Reference Guide, NLRGAP: SID, GA, GB, PLANE, TABK, TABG, TABU, RADIUS; a negative TABK names a TABLED1 of
//! force over penetration, TABG one of the clearance over time. TABLED1: straight lines, beyond the ends the last
//! two points.

use super::numbers::fitted;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "nastran",
    suffix: ".bdf",
    about: "NLRGAP with TABLED1, and PBUSHT, for Nastran and OptiStruct",
    beyond: "straight on through the last two points",
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let pairs = sheet.pairs();
    let clearance = sheet.table.clearances[0];
    let mut text = sheet.head("$ ");
    text += "$ NLRGAP: grids 101 (hole) and 102 (pin); select it by NONLINEAR = 1. Direct transient only.\n";
    text += "$ Tables: 1 force over penetration, 2 radial clearance over time.\n";
    text += &format!("{:<8}", "NLRGAP");
    for field in ["1", "101", "102", "XY", "-1", "2", "0", "0.0"] {
        text += &format!("{field:>8}");
    }
    text += "\n";
    text += &table(1, &pairs);
    text += &table(2, &[(0.0, clearance), (1.0, clearance)]);
    text +=
        "$ Or along a CBUSH's x axis, positive pressed in, from first touch on: force over displacement.\n";
    let stiffness = fitted(sheet.table.stiffnesses[0][sheet.table.indentations.len() - 1], 16);
    text += &format!("{:<8}{:>16}{:>16}{:>16}\n*\n", "PBUSH*", 10, "K", stiffness);
    text += &format!("{:<8}{:>8}{:>8}{:>8}\n", "PBUSHT", 10, "KN", 1);
    vec![("", text)]
}

/// In fields of sixteen columns.
fn table(id: u32, pairs: &[(f64, f64)]) -> String {
    let mut text = format!("{:<8}{id:>16}{:>16}{:>16}\n*\n", "TABLED1*", "LINEAR", "LINEAR");
    let numbers = pairs.iter().flat_map(|(x, y)| [fitted(*x, 16), fitted(*y, 16)]);
    // No field before ENDT may be blank.
    let fields: Vec<String> = numbers.chain(["ENDT".to_string()]).collect();
    for line in fields.chunks(4) {
        text += &format!("{:<8}", "*");
        text.extend(line.iter().map(|field| format!("{field:>16}")));
        text += "\n";
    }
    text
}
