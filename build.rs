//! Tells the program which commit it is of, and the tests whether this machine has a Vulkan driver, so that those that need
//! one show as ignored where there is none, never as passed.

use std::path::Path;
use std::process::Command;

/// Where the Vulkan loader looks for drivers.
const DRIVER_FOLDERS: [&str; 4] = [
    "/usr/share/vulkan/icd.d",
    "/etc/vulkan/icd.d",
    "/usr/local/share/vulkan/icd.d",
    "/usr/local/etc/vulkan/icd.d",
];
const VARIABLES: [&str; 3] = ["JOINTSWEEP_REQUIRE_GPU", "VK_DRIVER_FILES", "VK_ICD_FILENAMES"];

/// Who sets this says what the commit is; else git does.
const COMMIT: &str = "JOINTSWEEP_COMMIT";

/// What a build depends on: where one of these is changed, the program is no longer that of its commit.
const SOURCES: [&str; 5] = ["src", "shaders", "configs", "Cargo.toml", "Cargo.lock"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    look_for_drivers();
    look_for_programs();
    println!("cargo::rerun-if-env-changed={COMMIT}");
    let version = env!("CARGO_PKG_VERSION");
    match std::env::var(COMMIT).ok().filter(|commit| !commit.is_empty()).or_else(commit) {
        Some(commit) => {
            println!("cargo::rustc-env={COMMIT}={commit}");
            println!("cargo::rustc-env=JOINTSWEEP_VERSION={version} ({commit})");
        }
        None => println!("cargo::rustc-env=JOINTSWEEP_VERSION={version}"),
    }
}

fn look_for_drivers() {
    println!("cargo::rustc-check-cfg=cfg(vulkan_driver)");
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

/// Programs that tests of exported tables need: without them the tests show as ignored. One that is installed later is found by the next clean
/// build: PATH is not watched, because it changes often, and the library would be compiled anew each time.
fn look_for_programs() {
    for (program, name) in [("cc", "c_compiler"), ("python3", "python3")] {
        println!("cargo::rustc-check-cfg=cfg({name})");
        if Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success()) {
            println!("cargo::rustc-cfg={name}");
        }
    }
}

/// The commit of the source, with `-dirty` where it was changed since; `None` where there is no history.
fn commit() -> Option<String> {
    // A package unpacked inside somebody else's repository is not of its commits.
    if !Path::new(".git").exists() {
        return None;
    }
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changes = git(&[&["status", "--porcelain", "--"], &SOURCES[..]].concat())?;
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"])?;
    for path in SOURCES.into_iter().chain([log.as_str()]).filter(|path| Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
    Some(if changes.is_empty() { commit } else { format!("{commit}-dirty") })
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
}
