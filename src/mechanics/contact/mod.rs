//! Pin against plate: unilateral, frictionless, between two condensed rings.

pub mod active_set;
