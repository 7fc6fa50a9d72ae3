//! What is lost when runs meet, are killed, or run out of something: nothing that was finished, and of the rest whole rows.
#![cfg(unix)]

#[path = "../common"]
mod common {
    pub mod ring_joint;
    pub mod length;
    #[allow(dead_code, reason = "nothing is drawn over decades here")]
    pub mod random;
    #[allow(dead_code, reason = "tables are compared as bytes here")]
    pub mod workdir;
}
mod folders;
mod interrupts;
mod kills;
mod kinds;
mod meetings;
mod resume;
mod shards;
mod shortages;

use common::ring_joint::ring_joint;

/// Designs of ten steps by `series`: about 0.3 seconds of a quick machine for `count` = 20,000.
fn config(count: usize) -> String {
    let clearances = format!("{{ from = \"0.01 mm\", to = \"0.1 mm\", count = {count} }}");
    ring_joint(&clearances, "{ from = \"0.001 mm\", to = \"0.01 mm\", count = 10, spacing = \"log\" }")
}

/// Blocks with ligaments so thin that one takes some tenths of a second at 0.1 %, no two of them alike. Their Poisson's ratios
/// differ, so that near fields are made at all nodes.
fn slow_config() -> String {
    config(64)
        .replace(
            "model = \"annulus\"\nouter_radius_ratio = 3.0",
            "model = \"block\"\nhalf_width_ratio = 1.05\ndepth_ratio = { from = 1.06, to = 3, count = 64 }\nheight_ratio = 2",
        )
        .replace("poissons_ratio = 0.33\n[load]", "poissons_ratio = { from = 0.33, to = 0.35, count = 64 }\n[load]")
        .replace("{ from = \"0.01 mm\", to = \"0.1 mm\", count = 64 }", "\"0.02 mm\"")
        .replace("[solve]\nmethod = \"series\"", "[sampling]\nmethod = \"zip\"\n[solve]\naccuracy = \"0.1 %\"")
}
