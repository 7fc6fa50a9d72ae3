pub mod real;
pub mod material;
pub mod body;
pub mod element;
pub mod mesh;
pub mod compliance;
pub mod contact;
pub mod laws;
