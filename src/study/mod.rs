pub mod units;
pub mod design;
pub mod columns;
mod source;
mod values;
mod sampling;
mod recipe;
mod designs_file;
pub mod config;
