//! `chrono`: the curve of a nonlinear spring in the JSON of Chrono::Vehicle, m and N. Its documentation, "TSDA":
//! pairs of displacement and force under "Spring Curve Data", between which ChFunctionInterp draws straight lines.
//! JSON has no comments: the head is a list.

use serde_json::json;

use super::interpolation::Interpolation;
use super::sheet::{Format, Sheet};
use super::table::Between;

pub static FORMAT: Format = Format {
    name: "chrono",
    suffix: ".json",
    about: "\"Spring Curve Data\" for Project Chrono",
    two_dimensional: false,
    rules: &[Interpolation::Linear],
    between: Between::Linear,
    damping: false,
    length: 1e-3,
    least_step: 0.0,
    beyond: "none: the last force, flat",
    write,
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let (name, head) = (json!(sheet.name), json!(sheet.head));
    let head = serde_json::to_string_pretty(&head).expect("a list of texts").replace('\n', "\n  ");
    // By hand, so that numbers are plain decimals.
    let pairs: Vec<String> = sheet
        .pairs()
        .into_iter()
        .map(|(x, y)| format!("    [{}, {}]", super::numbers::plain(x), super::numbers::plain(y)))
        .collect();
    let text = format!(
        "{{\n  \"Name\": {name},\n  \"Comment\": {head},\n  \"Spring Curve Data\": [\n{}\n  ]\n}}\n",
        pairs.join(",\n")
    );
    vec![("", text)]
}
