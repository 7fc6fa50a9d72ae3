pub mod outcome;
pub mod bodies;
pub mod plan;
pub mod backend;
pub mod sweep;
