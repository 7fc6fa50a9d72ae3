pub mod outcome;
pub mod sweep;
