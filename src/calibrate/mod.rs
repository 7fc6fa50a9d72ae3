mod least_squares;
pub mod unknown;
mod model;
pub mod calibration;
