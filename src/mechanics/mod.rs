pub mod material;
pub mod body;
pub mod laws;
