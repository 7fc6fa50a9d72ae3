//! What rows say of themselves: counts by status, with a design to look at.

use super::Report;
use super::html::{Cell, paragraph, section as html_section, table};
use crate::output::chart::text::{number, plural};

/// The most statuses that are listed.
const MOST: usize = 30;

pub fn section(report: &Report) -> String {
    let scan = &report.scan;
    let failed = scan.rows - scan.answered;
    let text = match (failed, scan.remarked) {
        (0, 0) => format!("All {} are ok.", plural(scan.rows, "row", "rows")),
        (0, _) => "Every row has an answer. Remarks are to be read with it; they do not void it.".to_string(),
        _ => format!(
            "{} of {} have no answer. Such a row keeps its inputs and says why; nothing is put in its place.",
            plural(failed, "row", "rows"),
            scan.rows
        ),
    };
    let mut all: Vec<_> = scan.statuses.iter().collect();
    all.sort_by(|a, b| b.1.rows.cmp(&a.1.rows).then(a.0.cmp(b.0)));
    let rows: Vec<Vec<Cell>> = all
        .iter()
        .take(MOST)
        .map(|(status, share)| {
            let part = 100.0 * share.rows as f64 / scan.rows as f64;
            vec![
                Cell::Words(crate::error::shortened_to(status, 160)),
                Cell::Number(share.rows.to_string()),
                Cell::Number(format!("{} %", number(part, 3))),
                Cell::Number(share.designs.to_string()),
                Cell::Number(share.example.to_string()),
            ]
        })
        .collect();
    let mut html = paragraph(&text) + &table(&["status", "rows", "share", "designs", "example"], &rows);
    if all.len() > MOST {
        html += &paragraph(&format!("And {} more statuses; the table has them.", all.len() - MOST));
    }
    let methods: Vec<String> =
        scan.methods.iter().map(|(method, rows)| format!("{rows} by {method}")).collect();
    if !methods.is_empty() {
        html += &paragraph(&format!("Answered: {}.", methods.join(", ")));
    }
    html_section("Status", &html)
}
