pub mod outcome;
pub mod bodies;
pub mod plan;
pub mod cost;
pub mod backend;
pub mod sweep;
