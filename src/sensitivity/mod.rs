mod moments;
pub mod indices;
pub mod analysis;
