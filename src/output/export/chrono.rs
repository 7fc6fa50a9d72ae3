//! `chrono`: the curve of a nonlinear spring in the JSON of Chrono::Vehicle, m and N. Its documentation, "TSDA":
//! pairs of displacement and force under "Spring Curve Data", between which ChFunctionInterp draws straight lines.
//! JSON has no comments: the head is a list.

use serde_json::json;

use super::numbers::plain;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "chrono",
    suffix: ".json",
    about: "\"Spring Curve Data\" for Project Chrono",
    length: 1e-3,
    beyond: "none: the last force, flat",
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let (name, head) = (json!(sheet.name), json!(sheet.head));
    let head = serde_json::to_string_pretty(&head).expect("a list of texts").replace('\n', "\n  ");
    // By hand, so that numbers are plain decimals.
    let pairs: Vec<String> =
        sheet.pairs().into_iter().map(|(x, y)| format!("    [{}, {}]", plain(x), plain(y))).collect();
    let text = format!(
        "{{\n  \"Name\": {name},\n  \"Comment\": {head},\n  \"Spring Curve Data\": [\n{}\n  ]\n}}\n",
        pairs.join(",\n")
    );
    vec![("", text)]
}
