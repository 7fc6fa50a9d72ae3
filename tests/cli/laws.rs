//! `laws.csv`: made by `run`, left out where asked, made later by `laws`, and never left behind by a result that is gone.

use super::SMALL;
use crate::common::workdir::Workdir;

fn without_laws() -> String {
    format!("{}[output]\nlaws = false\n", *SMALL)
}

/// By a run and afterwards the same, to the byte; and the manifest vouches for them.
#[test]
fn laws_made_later_are_those_of_the_run() {
    let work = Workdir::new("laws_later");
    work.write("small.toml", &SMALL);
    work.write("none.toml", &without_laws());
    work.run(&["run", "small.toml"]).expect(0);
    work.run(&["run", "none.toml"]).expect(0);
    assert!(!work.files().contains(&"out/none/laws.csv".to_string()));
    let told = work.run(&["laws", "out/none"]).expect(0);
    assert!(told.stdout.contains("laws of 2 designs"), "{}", told.stdout);
    let laws = work.read("out/small/laws.csv");
    assert_eq!(laws, work.read("out/none/laws.csv"));
    let rows: Vec<&str> = laws.lines().collect();
    assert_eq!(rows.len(), 1 + 2 * 9);
    for design in ["0,", "1,"] {
        let recommended = |row: &&&str| row.starts_with(design) && row.contains(",yes: ");
        assert_eq!(rows.iter().filter(recommended).count(), 1);
    }
    let files = |manifest: &str| work.json(manifest)["files"].clone();
    let by_name = |files: &serde_json::Value| {
        let files = files.as_array().unwrap();
        files.iter().find(|file| file["path"] == "laws.csv").unwrap().clone()
    };
    let of_run = files("out/small/manifest.json");
    let of_laws = files("out/none/manifest.json");
    assert_eq!(of_run.as_array().unwrap().len(), 2);
    assert_eq!(of_laws.as_array().unwrap().len(), 2);
    assert_eq!(by_name(&of_run), by_name(&of_laws));
    // A result stays what it was: nothing to do.
    assert!(work.run(&["run", "none.toml"]).expect(0).stdout.contains("already complete"));
    // Laws that are there are kept.
    let kept = work.run(&["laws", "out/none"]).expect(1);
    assert!(
        kept.stderr.contains("out/none/laws.csv is there already: overwrite it with --force"),
        "{}",
        kept.stderr
    );
    work.run(&["laws", "out/none", "--force"]).expect(0);
    assert_eq!(laws, work.read("out/none/laws.csv"));
}

/// Laws of a result that another one takes the place of go with it.
#[test]
fn laws_of_an_older_result_do_not_stay() {
    let work = Workdir::new("laws_older");
    work.write("small.toml", &SMALL);
    work.run(&["run", "small.toml", "--out", "result"]).expect(0);
    assert!(work.files().contains(&"result/laws.csv".to_string()));
    work.write("none.toml", &without_laws());
    work.run(&["run", "none.toml", "--out", "result", "--force"]).expect(0);
    assert_eq!(work.files(), ["none.toml", "result/manifest.json", "result/table.csv", "small.toml"]);
}

#[test]
fn folders_without_a_finished_result_have_no_laws() {
    let work = Workdir::new("laws_refused");
    let refused = work.run(&["laws", "nowhere"]).expect(1);
    assert!(refused.stderr.contains("nowhere: there is no manifest.json: `jointsweep run` makes results"));
    work.write("closed.toml", &SMALL.replace("method = \"series\"", "method = \"closed-form\""));
    work.run(&["run", "closed.toml"]).expect(0);
    assert!(!work.files().contains(&"out/closed/laws.csv".to_string()));
    let refused = work.run(&["laws", "out/closed"]).expect(1);
    assert!(refused.stderr.contains("a closed form has no curve to fit laws to"), "{}", refused.stderr);
    work.write("wrong.toml", &format!("{}[output]\nlaws = \"yes\"\n", *SMALL));
    let refused = work.run(&["run", "wrong.toml"]).expect(1);
    assert!(refused.stderr.contains("output.laws"), "{}", refused.stderr);
    assert!(!work.files().iter().any(|file| file.contains("laws.csv")));
}

/// Whoever reads a whole table says when it is no longer what its run has written; nothing is made of it.
#[test]
fn tables_that_were_changed_are_refused() {
    let work = Workdir::new("laws_changed");
    work.write("small.toml", &SMALL);
    work.run(&["run", "small.toml"]).expect(0);
    let (table, laws) = (work.read("out/small/table.csv"), work.read("out/small/laws.csv"));
    let changed = table.replacen("\n1,", "\n2,", 1);
    assert_ne!(changed, table);
    work.write("out/small/table.csv", &changed);
    for command in [&["laws", "out/small", "--force"][..], &["report", "out/small"]] {
        let refused = work.run(command).expect(1);
        let said = "its table.csv was changed after it was written: run the config again";
        assert!(refused.stderr.contains(said), "{}", refused.stderr);
    }
    assert_eq!(work.read("out/small/laws.csv"), laws);
    assert!(!work.files().iter().any(|file| file.ends_with(".html") || file.ends_with(".tmp")));
    let taken = work.run(&["laws", "out/small"]).expect(1);
    assert!(
        taken.stderr.ends_with("laws.csv is there already: overwrite it with --force\n"),
        "{}",
        taken.stderr
    );
}
