pub mod units;
pub mod design;
pub mod columns;
mod source;
pub mod values;
pub mod sampling;
mod recipe;
pub mod designs_file;
pub mod config;
