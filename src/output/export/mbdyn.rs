//! `mbdyn`: a scalar function of MBDyn, m and N. Input manual, section "Scalar functions": `multilinear`, pairs of
//! x and y, straight lines, beyond the ends the last slope unless `do not extrapolate`; the constitutive law
//! `scalar function elastic` uses it.

use super::numbers::plain;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "mbdyn",
    suffix: ".mbd",
    about: "a multilinear scalar function for MBDyn",
    length: 1e-3,
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let pairs: Vec<String> =
        sheet.pairs().into_iter().map(|(x, y)| format!("    {}, {}", plain(x), plain(y))).collect();
    let mut text = sheet.head("# ");
    text += &format!("# constitutive law: 1, 1, scalar function elastic, \"{}\";\n", sheet.name);
    text += &format!("scalar function: \"{}\", multilinear,\n{};\n", sheet.name, pairs.join(",\n"));
    vec![("", text)]
}
