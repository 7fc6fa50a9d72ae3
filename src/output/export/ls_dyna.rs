//! `ls-dyna`: a *DEFINE_CURVE, mm and N. Keyword manual, *DEFINE_CURVE: LCID, SIDR, SFA, SFO, OFFA, OFFO, DATTYP,
//! LCINT in fields of ten columns, then pairs in fields of twenty. LS-DYNA draws a curve anew at LCINT even steps
//! (100 unless told).

use super::numbers::fitted;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format =
    Format { name: "ls-dyna", suffix: ".k", about: "*DEFINE_CURVE for LS-DYNA", write, ..Format::LINEAR };

/// Even steps: of a range that is a third gap the first one is 1/6000 of the largest indentation.
const STEPS: u32 = 10_000;

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let mut text = sheet.head("$ ");
    text +=
        &format!("$ LCINT: drawn anew at {STEPS} even steps; below some ten of them the force is coarser.\n");
    text += &format!("*DEFINE_CURVE_TITLE\n{}\n", sheet.name);
    text += "$#    lcid      sidr       sfa       sfo      offa      offo    dattyp     lcint\n";
    for field in ["1", "0", "1.0", "1.0", "0.0", "0.0", "0", &STEPS.to_string()] {
        text += &format!("{field:>10}");
    }
    text += "\n$#                a1                  o1\n";
    for (x, y) in sheet.pairs() {
        text += &format!("{:>20}{:>20}\n", fitted(x, 20), fitted(y, 20));
    }
    vec![("", text)]
}
