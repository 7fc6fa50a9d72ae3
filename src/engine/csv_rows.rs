//! Small tables that are compiled in, as examples print them.

use serde::de::DeserializeOwned;

/// The rows of a CSV text with a header, whose columns are the fields of a row in their order.
///
/// # Panics
/// Where the text is broken; a test reads each.
pub fn rows<T: DeserializeOwned>(text: &'static str) -> impl Iterator<Item = T> {
    let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
    rows.map(|row| row.unwrap_or_else(|error| panic!("a table that is compiled in: {error}")))
}
