//! The planner of today against what is recorded in `results/` of every choice: it has the errors recorded of it, keeps the
//! accuracy asked, and nothing recorded that is as good is much cheaper. What a choice costs is read, not measured here.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use jointsweep::study::config::Study;
use jointsweep::study::design::DesignCase;
use jointsweep::tradeoff::errors::Errors;
use jointsweep::tradeoff::families::planner;
use jointsweep::tradeoff::oracle::Oracle;

/// Folder of the record, config, and how far apart the designs are that were taken of it.
const RECORDS: [(&str, &str, usize); 2] =
    [("tradeoff-liu2007", "configs/liu2007.toml", 1), ("tradeoff-random", "configs/random.toml", 100)];

/// The planner's time over that of the cheapest choice that is enough, at most.
const AIM: f64 = 1.5;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A row of a record, by the names of its columns.
struct Row(HashMap<String, String>);

impl Row {
    fn word(&self, column: &str) -> &str {
        self.0.get(column).unwrap_or_else(|| panic!("no column {column}"))
    }

    /// `None` where the choice does not say.
    fn number(&self, column: &str) -> Option<f64> {
        let text = self.word(column);
        (!text.is_empty()).then(|| text.parse().unwrap_or_else(|_| panic!("{column}: {text}")))
    }

    fn keeps(&self, column: &str, limit: f64) -> bool {
        self.number(column).is_some_and(|error| error <= limit)
    }
}

fn read(path: &Path) -> Vec<Row> {
    let mut reader =
        csv::Reader::from_path(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    reader.deserialize().map(|row| Row(row.unwrap())).collect()
}

fn planned(rows: &[Row]) -> impl Iterator<Item = (f64, &Row)> {
    let planned = rows.iter().filter(|row| row.word("family") == "planner");
    planned.map(|row| (row.number("parameter").unwrap(), row))
}

#[test]
fn the_planner_has_the_errors_that_are_recorded_of_it() {
    for (folder, config, apart) in RECORDS {
        let text = std::fs::read_to_string(root().join(config)).unwrap();
        let folder = root().join("results").join(folder);
        let manifest = std::fs::read_to_string(folder.join("manifest.json")).unwrap();
        let manifest: serde_json::Value = serde_json::from_str(&manifest).unwrap();
        assert_eq!(manifest["config"]["text"], text, "{config} is not what was recorded");

        let study = Study::from_text(Path::new(config), text).unwrap();
        let cases: Vec<DesignCase> = study.cases().unwrap().step_by(apart).map(Result::unwrap).collect();
        assert_eq!(manifest["designs"], cases.len());
        let exact = Oracle::new(&cases).states;
        let rows = read(&folder.join("tradeoff.csv"));
        let mut count = 0;
        for (accuracy, row) in planned(&rows) {
            let found = Errors::new(&planner::solve(accuracy, &cases).states, &exact);
            let force = found.force.unwrap();
            assert_eq!((found.unanswered, row.number("unanswered")), (0, Some(0.0)));
            assert!(force.max <= accuracy, "{config}, {accuracy}: {force:?}");
            for (column, error) in [("force_error_p95", force.p95), ("force_error_max", force.max)] {
                let recorded = row.number(column).unwrap();
                // The rounding of the record, and of exact modes.
                let rounding = 2e-3 * recorded + 1e-9;
                assert!((error - recorded).abs() < rounding, "{config}, {accuracy}: {error} for {recorded}");
            }
            count += 1;
        }
        assert_eq!(count, 4);
    }
}

/// Enough is a choice that 95 % of the steps keep to the accuracy with, and to a degree of the half angle: 3 trial pressures are
/// as good for the force, but not for that.
#[test]
fn nothing_recorded_that_is_enough_is_much_cheaper() {
    for (folder, ..) in RECORDS {
        let rows = read(&root().join("results").join(folder).join("tradeoff.csv"));
        for (accuracy, row) in planned(&rows).filter(|(accuracy, _)| *accuracy >= 1e-3) {
            let is_enough = |other: &&Row| {
                other.word("family") != "planner"
                    && other.number("unanswered").unwrap() <= 0.05 * other.number("steps").unwrap()
                    && other.keeps("force_error_p95", accuracy)
                    && other.keeps("contact_half_angle_error_p95_deg", 1.0)
            };
            let time = |row: &Row| row.number("time_per_design_s").unwrap();
            let cheapest = rows.iter().filter(is_enough).min_by(|a, b| time(a).total_cmp(&time(b))).unwrap();
            let ratio = time(row) / time(cheapest);
            println!("{folder}, {accuracy}: {ratio:.2} of {}", cheapest.word("choice"));
            assert!(ratio <= AIM, "{folder}, {accuracy}: {ratio} of {}", cheapest.word("choice"));
        }
    }
}

/// 1,000 random designs: against the cheapest choice that is enough for 99 % of a kind.
#[test]
fn the_recorded_planner_keeps_its_promises_on_a_thousand_designs() {
    let rows = read(&root().join("results/planner/planner.csv"));
    for accuracy in [0.1, 1e-2, 1e-3] {
        let of_accuracy: Vec<&Row> =
            rows.iter().filter(|row| row.number("accuracy") == Some(accuracy)).collect();
        assert_eq!(of_accuracy.len(), 4, "three kinds and all");
        for row in of_accuracy {
            let what = format!("{}, {accuracy}", row.word("kind"));
            assert!(row.keeps("ratio_to_it", AIM), "{what}: {}", row.word("ratio_to_it"));
            assert!(row.number("share_within").unwrap() >= 0.99, "{what}");
            assert!(row.number("share_bounded").unwrap() >= 0.95, "{what}");
        }
    }
}
