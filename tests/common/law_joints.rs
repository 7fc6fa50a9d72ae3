//! Random joints of every kind that laws are fitted to.

use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::DesignCase;

pub const CORE: &str = "model = \"rigid-core\"\ncore_radius_ratio = { from = 0.05, to = 0.6 }";
pub const HALF: &str = "model = \"rigid-midplane\"";
pub const RING: &str = "model = \"annulus\"\nouter_radius_ratio = { from = 1.2, to = 50, spacing = \"log\" }";
pub const BLOCK: &str = "model = \"block\"\nsupport = [\"base\", \"outer\"]\nhalf_width_ratio = { from = 1.5, to = 6 }\n\
                         depth_ratio = { from = 1.5, to = 6 }\nheight_ratio = { from = 1.5, to = 6 }";

/// 500 cored discs in annuli, 250 half discs in annuli and 250 cored discs in blocks.
pub fn of_every_kind() -> Vec<DesignCase> {
    [joints(CORE, RING, 500), joints(HALF, RING, 250), joints(CORE, BLOCK, 250)].concat()
}

pub fn joints(pin: &str, plate: &str, count: usize) -> Vec<DesignCase> {
    let text = format!(
        r#"
[joint]
idealization     = ["plane-stress", "plane-strain"]
hole_radius      = {{ from = "5 mm", to = "100 mm", spacing = "log" }}
radial_clearance = {{ from = "0.005 mm", to = "0.2 mm", spacing = "log" }}
thickness        = {{ from = "1 mm", to = "50 mm" }}
[joint.pin]
{pin}
youngs_modulus = {{ from = "2 GPa", to = "210 GPa", spacing = "log" }}
poissons_ratio = {{ from = 0.1, to = 0.45 }}
[joint.plate]
{plate}
youngs_modulus = {{ from = "1 GPa", to = "210 GPa", spacing = "log" }}
poissons_ratio = {{ from = 0.1, to = 0.45 }}
[load]
indentation = {{ from = "0.001 mm", to = "0.1 mm", count = 4, spacing = "log" }}
[sampling]
method = "latin-hypercube"
count = {count}
seed = 5
"#
    );
    let study = Study::from_text(std::path::Path::new("laws.toml"), text).unwrap();
    study.cases().unwrap().map(Result::unwrap).collect()
}
