pub mod band;
