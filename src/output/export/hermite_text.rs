//! What the formats with a function of their own share: their arrays as text.

use super::numbers::plain;
use super::sheet::{Sheet, listed};

/// Values of one array between brackets, eight a line.
pub fn array(values: &[f64], open: &str, close: &str) -> String {
    format!("{open}\n{}\n{close}", listed(values, 6, "    ", ""))
}

/// Rows of one array for each clearance.
pub fn rows(values: &[Vec<f64>], open: &str, close: &str) -> String {
    let rows: Vec<String> = values.iter().map(|row| array(row, open, close)).collect();
    format!("{open}\n{}\n{close}", rows.join(",\n"))
}

/// The variable between clearances, as the sheet's table has it: their logarithm where none is zero.
pub fn clearance_nodes(sheet: &Sheet) -> Vec<f64> {
    let clearances = &sheet.table.clearances;
    if sheet.table.over_logarithm() {
        clearances.iter().map(|clearance| clearance.ln()).collect()
    } else {
        clearances.clone()
    }
}

/// Damping factor c, s/mm, as text.
pub fn damping(sheet: &Sheet) -> Option<String> {
    sheet.impact.map(|impact| plain(impact.coefficient))
}
