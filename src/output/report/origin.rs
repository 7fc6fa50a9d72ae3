//! Where the result comes from: its manifest.

use super::html::{paragraph, section as html_section};
use crate::error::shortened_to;
use crate::output::chart::text::escaped;
use crate::output::folder::MANIFEST;
use crate::output::results::Results;

/// Longer ones are cut, so that a page stays small: characters.
const LONGEST: usize = 200_000;
const LONGEST_TITLE: usize = 200;

fn value(results: &Results) -> serde_json::Value {
    serde_json::from_str(&results.manifest).unwrap_or_default()
}

/// The sweep's title.
pub fn title(results: &Results) -> String {
    let title = value(results)["title"].as_str().unwrap_or_default().to_string();
    shortened_to(
        if title.trim().is_empty() { "Pin joints with clearance" } else { title.trim() },
        LONGEST_TITLE,
    )
}

pub fn section(results: &Results) -> String {
    let manifest = value(results);
    let word = |key: &str| manifest[key].as_str().map(|word| shortened_to(word, LONGEST_TITLE));
    let mut text = format!("Made by jointsweep {}", results.origin.version);
    if let Some(commit) = word("commit") {
        text += &format!(" (commit {commit})");
    }
    text += &format!(" from {}", shortened_to(&results.origin.inputs.path, LONGEST_TITLE));
    if let Some(started) = word("started_utc") {
        text += &format!(", run at {started}");
    }
    if let Some(seconds) = manifest["wall_seconds"].as_f64() {
        text += &format!(" in {} s", crate::output::chart::text::number(seconds, 3));
    }
    let kept = match results.origin.counts.kept_rows {
        Some(kept) => format!("{kept} of {} rows met the requirement. ", results.origin.counts.rows),
        None => String::new(),
    };
    let files = match results.has_table() {
        true => {
            format!("All rows {}are in {}", if kept.is_empty() { "" } else { "kept " }, results.table_name())
        }
        false => "The answers are in the files".into(),
    };
    text += &format!(
        ". {kept}{files} beside this page's {MANIFEST}; units there are mm, N, MPa, mJ and degrees."
    );
    let mut body = results.manifest.clone();
    if body.chars().count() > LONGEST {
        body = shortened_to(&body, LONGEST) + "\n(cut here: the file has it all)";
    }
    let config = shortened_to(&results.origin.inputs.text, LONGEST);
    let details = format!(
        "<details>\n<summary>Config</summary>\n<pre>{}</pre>\n</details>\n\
         <details>\n<summary>Manifest</summary>\n<pre>{}</pre>\n</details>\n",
        escaped(&config),
        escaped(&body)
    );
    html_section("Origin", &(paragraph(&text) + &details))
}
