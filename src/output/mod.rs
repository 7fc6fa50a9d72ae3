mod number;
pub mod table;
pub mod host;
pub mod manifest;
pub mod folder;
pub mod recorder;
pub mod benchmark;
pub mod gpu_benchmark;
