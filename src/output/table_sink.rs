//! The table that a study asks for, and how many of its designs are written together.

use crate::engine::cost::DesignCost;
use crate::output::parquet_table::ParquetTable;
use crate::output::sink::Sink;
use crate::output::table::Table;
use crate::output::zst_table::ZstTable;
use crate::study::config::Study;
use crate::study::output_options::Format;

pub fn table_sink(study: &Study) -> Box<dyn Sink> {
    match study.output.format {
        Format::Csv => Box::new(Table::of(study)),
        Format::CsvZst => Box::new(ZstTable::of(study)),
        Format::Parquet => Box::new(ParquetTable::of(study)),
    }
}

/// Designs of a portion of plain text: few enough that those who watch the file of a slow run see it grow.
const TEXT_DESIGNS: u64 = 64;

/// Of sweeps that write no rows: answers are joined less often.
const ANSWERED_DESIGNS: u64 = 1024;

/// Rows that are compressed together, at most: more would make the file little smaller.
const ROWS: u64 = 1 << 14;

/// Of sweeps so large that the description of so many row groups would need much memory.
const MOST_ROWS: u64 = 1 << 18;

/// Portions from which on they grow.
const MANY: u64 = 1 << 12;

/// Core time that a portion may take, s: what a run that is killed loses at most, by the forecast.
const SECONDS: f64 = 10.0;

/// Designs that are forecast, in as many places of the sweep.
const FORECAST: (u64, u64) = (256, 4);

/// Designs whose rows are made together: the same for the same study, always.
pub fn portion(study: &Study) -> u64 {
    if !study.writes_table() {
        return ANSWERED_DESIGNS;
    }
    if study.output.format == Format::Csv {
        return TEXT_DESIGNS;
    }
    let rows = (study.step_count() / MANY).clamp(ROWS, MOST_ROWS);
    let by_rows = rows / study.steps_per_design().max(1);
    let by_time = (SECONDS / seconds_per_design(study)) as u64;
    // Powers of two: forecasts that differ in their last digits make the same portions.
    match by_rows.min(by_time) {
        0 => 1,
        designs => 1 << designs.ilog2(),
    }
}

/// A shard begins at a multiple of this many designs: plain text may be cut anywhere.
pub fn cut(study: &Study) -> u64 {
    let is_whole = study.writes_table() && study.output.format != Format::Csv;
    if is_whole { portion(study) } else { 1 }
}

/// The greatest of some places of the sweep; of lists only of their beginning, since they are read from there.
fn seconds_per_design(study: &Study) -> f64 {
    let (designs, places) = FORECAST;
    let count = study.design_count();
    let cost = DesignCost::of_study(study);
    let places = if study.designs_file().is_some() { 1 } else { places };
    let seconds = (0..places).map(|place| {
        let first = (place * (count / places)).min(count.saturating_sub(designs));
        let range = first..(first + designs).min(count);
        let asked = (range.end - range.start).max(1) as f64;
        // What cannot be read is told where the designs are drawn.
        cost.estimate(range).map_or(0.0, |estimate| estimate.time.seconds() / asked)
    });
    seconds.fold(f64::MIN_POSITIVE, f64::max)
}
