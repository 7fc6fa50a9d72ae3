//! What is handed over: tables, answers, reports and files for simulators.

#[path = "../common"]
mod common {
    pub mod random;
    #[allow(dead_code, reason = "half discs are not drawn here")]
    pub mod draws;
    pub mod outcomes;
    #[allow(dead_code, reason = "no run is interrupted here")]
    pub mod workdir;
}
mod select;
mod reduce;
mod formats;
mod recorder;
mod report;
mod export;
