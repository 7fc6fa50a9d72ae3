//! What is handed over: tables, answers, reports and files for simulators.

#[path = "../common"]
mod common {
    pub mod ring_joint;
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

/// Nine lines, with what is asked of the rows to stand behind them.
const JOINT: &str = r#"[joint]
idealization = "plane-strain"
hole_radius = "12 mm"
radial_clearance = "0.03 mm"
thickness = "7 mm"
pin = { model = "rigid-core", youngs_modulus = "200 GPa", poissons_ratio = 0.25 }
plate = { model = "annulus", outer_radius_ratio = 2, youngs_modulus = "90 GPa", poissons_ratio = 0.2 }
[load]
indentation = "0.01 mm"
"#;
