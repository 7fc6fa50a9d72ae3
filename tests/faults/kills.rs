//! Kills runs: after a while, or as soon as they have got so far, which does not hang on the speed of machine and program.

use std::process::{Child, Command};
use std::time::Duration;

use crate::common::workdir::{Ended, Workdir};

pub fn send(signal: &str, child: &Child) {
    // It may have ended before.
    let _ = Command::new("kill").args([signal, &child.id().to_string()]).status();
}

pub fn end(child: Child) -> Ended {
    Ended::new(child.wait_with_output().unwrap())
}

/// Kills a run after so long, and says how it ended.
pub fn killed_after(work: &Workdir, seconds: f64, arguments: &[&str]) -> Ended {
    let child = work.start(arguments);
    std::thread::sleep(Duration::from_secs_f64(seconds));
    send("-KILL", &child);
    end(child)
}

/// Kills a run into this folder once its manifest tells of more than `designs` designs, and says how it ended.
pub fn killed_beyond(work: &Workdir, designs: u64, folder: &str, arguments: &[&str]) -> Ended {
    let mut child = work.start(arguments);
    // Once it has ended and been waited for, its number may be another process's.
    while child.try_wait().unwrap().is_none() {
        if done(work, folder) > designs {
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    end(child)
}

/// Designs of the unfinished result, as its manifest says.
pub fn done(work: &Workdir, folder: &str) -> u64 {
    let path = work.path(&format!("{folder}/manifest.json.partial"));
    // It may get its own name at any moment.
    let Ok(text) = std::fs::read_to_string(path) else { return 0 };
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    manifest["counts"]["designs"].as_u64().unwrap()
}
