//! Tells the tests whether this machine has a Vulkan driver, so that those that need one show as ignored where there
//! is none, never as passed.

use std::path::Path;

/// Where the Vulkan loader looks for drivers.
const DRIVER_FOLDERS: [&str; 4] = [
    "/usr/share/vulkan/icd.d",
    "/etc/vulkan/icd.d",
    "/usr/local/share/vulkan/icd.d",
    "/usr/local/etc/vulkan/icd.d",
];
const VARIABLES: [&str; 3] = ["JOINTSWEEP_REQUIRE_GPU", "VK_DRIVER_FILES", "VK_ICD_FILENAMES"];

fn main() {
    println!("cargo::rustc-check-cfg=cfg(vulkan_driver)");
    println!("cargo::rerun-if-changed=build.rs");
    for variable in VARIABLES {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    // A folder that is not there cannot be watched; a driver installed later is found by the next clean build, or by
    // setting JOINTSWEEP_REQUIRE_GPU.
    let folders = DRIVER_FOLDERS.into_iter().filter(|folder| Path::new(folder).is_dir());
    let has_drivers = folders.inspect(|folder| println!("cargo::rerun-if-changed={folder}")).count() > 0;
    if has_drivers || VARIABLES.iter().any(|variable| std::env::var_os(variable).is_some()) {
        println!("cargo::rustc-cfg=vulkan_driver");
    }
}
