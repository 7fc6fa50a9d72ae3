//! What is on disk when a run ends in other ways than the command line can be made to end in.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, SystemTime};

use crate::common::ring_joint::ring_joint;
use crate::common::workdir::Workdir;
use jointsweep::Error;
use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::engine::sweep::{self, SweepOptions};
use jointsweep::internals::output::folder::{Permissions, ResultFolder, Verdict};
use jointsweep::internals::output::manifest::Conditions;
use jointsweep::internals::output::recorder::Recorder;
use jointsweep::internals::study::config::Study;

fn config() -> String {
    ring_joint("[\"0.1 mm\", \"0.05 mm\", \"0.03 mm\"]", "[\"0.001 mm\", \"0.002 mm\"]")
}

fn recorder(work: &Workdir, folder: &str) -> (Study, Recorder) {
    recorder_that(work, folder, false)
}

/// One that begins `anew`, or not.
fn recorder_that(work: &Workdir, folder: &str, anew: bool) -> (Study, Recorder) {
    work.write("study.toml", &config());
    let study = Study::load(&work.path("study.toml")).unwrap();
    let claim = ResultFolder::of_run(Some(&work.path(folder)), &study).claim("of a test").unwrap();
    let conditions = Conditions { gpu: None, threads: 1, started: SystemTime::now(), anew };
    let recorder = Recorder::new(claim, &study, &conditions).unwrap();
    (study, recorder)
}

fn write(recorder: &mut Recorder, outcome: DesignOutcome) {
    let rows = recorder.sinks().rows(vec![outcome].into());
    recorder.write(&rows).unwrap();
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
    recorder.fail(&Error::Asked { problem: "neither nor".into() });
    assert_eq!(work.files(), ["study.toml"]);
    assert!(!work.path("new").exists());
}

/// A result that is complete in `folder`, with its table and manifest.
fn complete(work: &Workdir, folder: &str) -> (String, String) {
    let (study, mut recorder) = recorder(work, folder);
    for outcome in outcomes(&study) {
        write(&mut recorder, outcome);
    }
    recorder.finish(&Default::default()).unwrap();
    assert_eq!(work.json(&format!("{folder}/manifest.json"))["state"], "complete");
    (work.read(&format!("{folder}/table.csv")), work.read(&format!("{folder}/manifest.json")))
}

#[test]
fn an_earlier_result_stays_until_the_new_one_is_whole() {
    let work = Workdir::new("earlier");
    let first = complete(&work, "result");
    let now = || (work.read("result/table.csv"), work.read("result/manifest.json"));

    // Before the first outcome and after it.
    let (study, second) = recorder(&work, "result");
    second.fail(&Error::Asked { problem: "neither nor".into() });
    assert_eq!(now(), first);
    assert_eq!(work.files(), ["result/laws.csv", "result/manifest.json", "result/table.csv", "study.toml"]);
    let (_, mut third) = recorder(&work, "result");
    write(&mut third, outcomes(&study).remove(0));
    drop(third);
    assert_eq!(now(), first);
    assert_eq!(work.table("result/table.csv.partial").records.len(), 2);
    let again = complete(&work, "result");
    assert_eq!(again.0, first.0);
    assert_eq!(work.files(), ["result/laws.csv", "result/manifest.json", "result/table.csv", "study.toml"]);
}

/// The same command goes on, also where it is to begin anew what was run before; what any other run has left begins anew then.
#[test]
fn what_was_begun_anew_and_interrupted_goes_on() {
    let work = Workdir::new("anew");
    let (table, _) = complete(&work, "result");
    let study = Study::load(&work.path("study.toml")).unwrap();
    let folder = ResultFolder::of_run(Some(&work.path("result")), &study);
    let verdict = |force, again| folder.check(&study, Permissions { force, again }).unwrap();
    let interrupted = |anew| {
        let (study, mut recorder) = recorder_that(&work, "result", anew);
        write(&mut recorder, outcomes(&study).remove(0));
        recorder.interrupt(None).unwrap();
    };
    interrupted(false);
    assert!(matches!(verdict(false, true), Verdict::ToDo));
    interrupted(true);
    let Verdict::Begun(begun) = verdict(false, true) else { panic!("it does not go on") };
    assert!(matches!(verdict(true, true), Verdict::ToDo));
    // The complete result is still there, and still is one.
    assert!(matches!(verdict(false, false), Verdict::Done(_)));
    let (study, mut recorder) = recorder_that(&work, "result", true);
    recorder.go_on(&begun).unwrap();
    assert_eq!(recorder.designs_left(), 1..3);
    outcomes(&study).into_iter().skip(1).for_each(|outcome| write(&mut recorder, outcome));
    recorder.finish(&Default::default()).unwrap();
    assert_eq!(work.read("result/table.csv"), table);
    assert!(!work.read("result/manifest.json").contains("begun_anew"));
    assert!(matches!(verdict(false, true), Verdict::ToDo));
}

/// The partial files that a process leaves when it is killed between its renames, in every state of them.
#[test]
fn a_result_that_was_being_renamed_is_taken_for_complete() {
    let work = Workdir::new("renaming");
    let (table, manifest) = complete(&work, "result");
    let study = Study::load(&work.path("study.toml")).unwrap();
    let folder = ResultFolder::of_run(Some(&work.path("result")), &study);
    let verdict = || folder.check(&study, Permissions::default());
    let old = manifest.replace("\"bytes\": ", "\"bytes\": 9");
    let cases = [
        ("table.csv.partial", Some("old\n"), None),
        ("table.csv", None, None),
        ("table.csv.partial", Some("old\n"), Some(&old)),
        ("table.csv", None, Some(&old)),
    ];
    for (table_name, old_table, old_manifest) in cases {
        work.write("result/table.csv", old_table.unwrap_or(&table));
        work.write(&format!("result/{table_name}"), &table);
        work.write("result/manifest.json.partial", &manifest);
        match old_manifest {
            Some(old) => work.write("result/manifest.json", old),
            None => std::fs::remove_file(work.path("result/manifest.json")).unwrap(),
        }
        // Nobody is refused for it; who claims the folder ends it.
        let before = verdict();
        assert!(matches!(before, Ok(Verdict::Begun(_))), "{before:?}");
        drop(folder.claim("of a test").unwrap());
        assert!(matches!(verdict(), Ok(Verdict::Done(_))));
        assert_eq!(
            work.files(),
            ["result/laws.csv", "result/manifest.json", "result/table.csv", "study.toml"]
        );
        let found = (work.read("result/table.csv"), work.read("result/manifest.json"));
        assert_eq!(found, (table.clone(), manifest.clone()));
    }
    // Not where rows are missing.
    work.write("result/table.csv.partial", &table[..table.len() / 2]);
    work.write("result/manifest.json.partial", &manifest);
    std::fs::remove_file(work.path("result/manifest.json")).unwrap();
    std::fs::remove_file(work.path("result/table.csv")).unwrap();
    drop(folder.claim("of a test").unwrap());
    let left = ["result/laws.csv", "result/manifest.json.partial", "result/table.csv.partial", "study.toml"];
    assert_eq!(work.files(), left);
}

#[test]
fn one_run_at_a_time_has_a_folder() {
    let work = Workdir::new("claims");
    work.write("study.toml", &config());
    let study = Study::load(&work.path("study.toml")).unwrap();
    let folder = ResultFolder::of_run(Some(&work.path("result")), &study);
    let first = folder.claim("of the first").unwrap();
    assert!(first.is_locked());
    let refused = folder.claim("of the second").unwrap_err().to_string();
    let own = format!("in use by another run (of the first, process {}, since 20", std::process::id());
    assert!(refused.contains(&own), "{refused}");
    drop(first);
    assert!(!work.path("result").exists());
    drop(folder.claim("of the second").unwrap());
}

/// Many who all want the same folder at once: none has it while another does, and all get it in the end.
#[test]
fn claims_exclude_each_other() {
    let work = Workdir::new("exclusion");
    work.write("study.toml", &config());
    let study = Study::load(&work.path("study.toml")).unwrap();
    let folder = ResultFolder::of_run(Some(&work.path("result")), &study);
    let (holders, times) = (AtomicUsize::new(0), AtomicUsize::new(0));
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                while times.load(Ordering::SeqCst) < 4000 {
                    let claim = match folder.claim("of a test") {
                        Err(Error::FolderInUse { .. }) => continue,
                        claim => claim.unwrap(),
                    };
                    assert_eq!(holders.fetch_add(1, Ordering::SeqCst), 0, "two at once");
                    times.fetch_add(1, Ordering::SeqCst);
                    holders.fetch_sub(1, Ordering::SeqCst);
                    drop(claim);
                }
            });
        }
    });
    assert!(times.into_inner() >= 4000);
}

#[test]
fn a_run_that_fails_or_panics_keeps_its_rows_and_says_so() {
    let work = Workdir::new("halfway");
    for (folder, error) in
        [("failed", Some(Error::Asked { problem: "neither nor".into() })), ("panicked", None)]
    {
        let (study, mut recorder) = recorder(&work, folder);
        write(&mut recorder, outcomes(&study).remove(0));
        match &error {
            Some(error) => recorder.fail(error),
            None => {
                let panic = std::panic::AssertUnwindSafe(move || {
                    let _recorder = recorder;
                    panic!("as the test wants it");
                });
                assert!(std::panic::catch_unwind(panic).is_err());
            }
        }
        assert_eq!(work.table(&format!("{folder}/table.csv.partial")).records.len(), 2);
        let manifest = work.json(&format!("{folder}/manifest.json.partial"));
        assert_eq!(manifest["state"], "failed");
        assert_eq!(manifest["counts"]["rows"], 2);
        let expected =
            error.map_or("the program panicked, which is a fault in it".into(), |error| error.to_string());
        assert_eq!(manifest["error"].as_str(), Some(expected.as_str()));
    }
}

#[test]
fn the_rows_of_a_slow_run_can_be_watched() {
    let work = Workdir::new("slow");
    let (study, mut recorder) = recorder(&work, "result");
    let mut outcomes = outcomes(&study).into_iter();
    write(&mut recorder, outcomes.next().unwrap());
    std::thread::sleep(Duration::from_millis(1100));
    write(&mut recorder, outcomes.next().unwrap());
    assert_eq!(work.table("result/table.csv.partial").records.len(), 4);
    assert_eq!(work.json("result/manifest.json.partial")["state"], "incomplete");
}
