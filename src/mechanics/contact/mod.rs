//! Unilateral, frictionless contact of two rings.

pub mod pressure;
pub mod loading;
