//! What is lost when runs meet, are killed, or run out of something: nothing that was finished, and of the rest whole rows.
#![cfg(unix)]

#[path = "../common"]
mod common {
    #[allow(dead_code, reason = "nothing is drawn over decades here")]
    pub mod random;
    #[allow(dead_code, reason = "tables are compared as bytes here")]
    pub mod workdir;
}
mod folders;
mod interrupts;
mod kinds;
mod meetings;
mod resume;
mod shards;
mod shortages;

/// Designs of ten steps by `series`: about half a second of a quick machine for `count` = 20,000.
fn config(count: usize) -> String {
    format!(
        r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = {{ from = "0.01 mm", to = "0.1 mm", count = {count} }}
thickness = "5 mm"
[joint.pin]
model = "rigid-core"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = 3.0
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
[load]
indentation = {{ from = "0.001 mm", to = "0.01 mm", count = 10, spacing = "log" }}
[solve]
method = "series"
"#
    )
}

/// Blocks with ligaments so thin that one takes some tenths of a second at 0.1 %, no two of them alike.
fn slow_config() -> String {
    config(64)
        .replace(
            "model = \"annulus\"\nouter_radius_ratio = 3.0",
            "model = \"block\"\nhalf_width_ratio = 1.05\ndepth_ratio = { from = 1.06, to = 3, count = 64 }\nheight_ratio = 2",
        )
        .replace("{ from = \"0.01 mm\", to = \"0.1 mm\", count = 64 }", "\"0.02 mm\"")
        .replace("method = \"series\"", "accuracy = \"0.1 %\"")
}
