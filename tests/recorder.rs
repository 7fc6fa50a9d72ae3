//! What is on disk when a run ends in other ways than the command line can be made to end in.

#[path = "common/workdir.rs"]
#[allow(dead_code, reason = "shared with the tests of the command line")]
mod workdir;

use std::ops::ControlFlow;
use std::time::{Duration, SystemTime};

use jointsweep::Error;
use jointsweep::engine::outcome::DesignOutcome;
use jointsweep::engine::sweep::{self, SweepOptions};
use jointsweep::output::folder::ResultFolder;
use jointsweep::output::manifest::Conditions;
use jointsweep::output::recorder::Recorder;
use jointsweep::study::config::Study;
use workdir::Workdir;

const CONFIG: &str = r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = ["0.1 mm", "0.05 mm", "0.03 mm"]
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
indentation = ["0.001 mm", "0.002 mm"]
[solve]
method = "series"
"#;

fn recorder(work: &Workdir, folder: &str) -> (Study, Recorder) {
    work.write("study.toml", CONFIG);
    let study = Study::load(&work.path("study.toml")).unwrap();
    let folder = ResultFolder::check(Some(&work.path(folder)), &study, false).unwrap();
    let conditions = Conditions { gpu: None, threads: 1, started: SystemTime::now() };
    let recorder = Recorder::new(folder, &study, &conditions).unwrap();
    (study, recorder)
}

fn outcomes(study: &Study) -> Vec<DesignOutcome> {
    let mut outcomes = Vec::new();
    let options = SweepOptions { threads: 1, ..Default::default() };
    let mut receive = |outcome| {
        outcomes.push(outcome);
        Ok(ControlFlow::Continue(()))
    };
    sweep::run(study, &options, &mut receive).unwrap();
    outcomes
}

#[test]
fn a_run_without_an_outcome_leaves_nothing_behind() {
    let work = Workdir::new("nothing");
    let (_, recorder) = recorder(&work, "new/folders");
    recorder.fail(&Error::ForGpuOnly { option: "--adapter" });
    assert_eq!(work.files(), ["study.toml"]);
    assert!(!work.path("new").exists());
}

#[test]
fn an_earlier_result_stays_until_the_first_outcome() {
    let work = Workdir::new("earlier");
    let (study, mut first) = recorder(&work, "result");
    for outcome in outcomes(&study) {
        first.write(outcome).unwrap();
    }
    first.finish(&Default::default()).unwrap();
    let (table, manifest) = (work.read("result/table.csv"), work.read("result/manifest.json"));

    let (_, second) = recorder(&work, "result");
    second.fail(&Error::ForGpuOnly { option: "--adapter" });
    assert_eq!((work.read("result/table.csv"), work.read("result/manifest.json")), (table, manifest));
    assert_eq!(work.files(), ["result/manifest.json", "result/table.csv", "study.toml"]);
}

#[test]
fn a_run_that_fails_or_panics_keeps_its_rows_and_says_so() {
    let work = Workdir::new("halfway");
    for (folder, error) in [("failed", Some(Error::ForGpuOnly { option: "--adapter" })), ("panicked", None)] {
        let (study, mut recorder) = recorder(&work, folder);
        recorder.write(outcomes(&study).remove(0)).unwrap();
        match &error {
            Some(error) => recorder.fail(error),
            None => drop(recorder),
        }
        assert_eq!(work.table(&format!("{folder}/table.csv")).records.len(), 2);
        let manifest = work.json(&format!("{folder}/manifest.json"));
        assert_eq!(manifest["state"], "failed");
        assert_eq!(manifest["counts"]["rows"], 2);
        assert_eq!(manifest["error"].as_str(), error.map(|error| error.to_string()).as_deref());
    }
}

#[test]
fn the_rows_of_a_slow_run_can_be_watched() {
    let work = Workdir::new("slow");
    let (study, mut recorder) = recorder(&work, "result");
    let mut outcomes = outcomes(&study).into_iter();
    recorder.write(outcomes.next().unwrap()).unwrap();
    std::thread::sleep(Duration::from_millis(1100));
    recorder.write(outcomes.next().unwrap()).unwrap();
    assert_eq!(work.table("result/table.csv").records.len(), 4);
    assert_eq!(work.json("result/manifest.json")["state"], "running");
}
