//! The picture that `jointsweep sensitivity` has left below the result's folder, where it was asked.

use std::path::Path;

use super::html::{paragraph, section as html_section};

/// Bytes of a picture that is shown: those of a hundred factors are far smaller.
const LARGEST: u64 = 1 << 20;

pub fn section(dir: &Path) -> String {
    let path = dir.join("sensitivity").join("sensitivity.svg");
    let is_small = path.metadata().is_ok_and(|file| file.len() <= LARGEST);
    let picture = is_small.then(|| std::fs::read_to_string(&path).ok()).flatten();
    // A picture runs nothing.
    let Some(picture) = picture.filter(|text| text.contains("<svg") && !text.contains("<script")) else {
        return String::new();
    };
    let picture = &picture[picture.find("<svg").unwrap_or_default()..];
    let told = "Share of the scatter that comes from each swept quantity: alone (first order), and with all that it does together with \
                others (total), with 95 % intervals.";
    html_section("Sensitivity", &(paragraph(told) + picture + "\n"))
}
