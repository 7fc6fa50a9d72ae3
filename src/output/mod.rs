mod number;
pub mod table;
