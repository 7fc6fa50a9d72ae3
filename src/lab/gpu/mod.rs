//! A GPU measured: what it can do at most, what each kernel takes and has to do, and the files of these figures.

pub mod budget;
pub mod measured_sweep;
pub mod host_cost;
pub mod speed;
pub mod roofline;
pub mod work;
pub mod measure;
pub mod figures;
pub mod benchmark;
