//! `motionsolve`: a Reference_Spline of Altair MotionSolve's XML. Its documentation, "Reference: Spline" and
//! AKISPL: pairs of x and y in the element's text, `num_xy_pair` of them, Akima's method, `linear_extrap`.

use super::interpolation::Interpolation;
use super::numbers::plain;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "motionsolve",
    suffix: ".xml",
    about: "a Reference_Spline for MotionSolve",
    rules: &[Interpolation::Akima, Interpolation::Linear],
    beyond: "straight on (linear_extrap)",
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let pairs = sheet.pairs();
    let clearance = plain(sheet.table.clearances[0]);
    let mut text = format!("<!--\n{}", sheet.head("  "));
    text += "  Akima's method: val_expression = \"AKISPL(DM(10101,10201)-CLEARANCE,0,1)\",\n";
    text += "  straight lines: val_expression = \"LINSPL(DM(10101,10201)-CLEARANCE,0,1)\",\n";
    text += "  between the markers of the centres of pin and hole.\n-->\n";
    text = text.replace("CLEARANCE", &clearance);
    text += &format!(
        "<Reference_Spline\n     id            = \"1\"\n     label         = \"{}\"\n     num_xy_pair   = \"{}\"\n     \
         linear_extrap = \"TRUE\">\n",
        sheet.name,
        pairs.len()
    );
    for (x, y) in pairs {
        text += &format!("          {} {}\n", plain(x), plain(y));
    }
    text += "</Reference_Spline>\n";
    vec![("", text)]
}
