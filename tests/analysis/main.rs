//! What is made of many answers: joints fitted to points, inputs ranked by what they do, choices compared.

#[path = "../common"]
mod common {
    pub mod random;
    #[allow(dead_code, reason = "no blocks are drawn here")]
    pub mod draws;
    #[allow(dead_code, reason = "no run is interrupted here")]
    pub mod workdir;
}
mod calibrate;
mod sensitivity;
mod tradeoff;
