//! Answers in the place of rows: against plain lists of all values, and the same to the last byte however the rows are split.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use jointsweep::internals::engine::outcome::DesignOutcome;
use jointsweep::internals::engine::sweep;
use jointsweep::internals::output::filter::{Filter, kept_rows};
use jointsweep::internals::output::reduce::exact_sum::{ExactSum, standard_deviation};
use jointsweep::internals::output::reduce::sketch::{MOST_COUNTS, Sketch};
use jointsweep::internals::output::reduce::{MOST_POINTS, Reductions};
use jointsweep::internals::output::report::answers;
use jointsweep::internals::output::row_value::{Formula, Row};
use jointsweep::internals::output::sink::Sink;
use jointsweep::internals::output::table::Table;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::expression::Expression;

use crate::JOINT;
use crate::common::outcomes::outcomes;
use crate::common::random::Random;

/// What a config with this behind asks for.
fn reductions(asked: &str) -> Reductions {
    let study = Study::from_text(Path::new("c.toml"), format!("{JOINT}{asked}")).unwrap();
    Reductions::of(&study).unwrap()
}

/// The filter of the same config.
fn filter(asked: &str) -> Option<Filter> {
    Filter::of(&Study::from_text(Path::new("c.toml"), format!("{JOINT}{asked}")).unwrap())
}

fn add(reductions: &mut Reductions, filter: &Option<Filter>, outcomes: &[DesignOutcome]) {
    reductions.add(outcomes, &kept_rows(filter.as_ref(), outcomes));
}

/// All outcomes at once.
fn reduced(asked: &str, outcomes: &[DesignOutcome]) -> Reductions {
    let mut reductions = reductions(asked);
    add(&mut reductions, &filter(asked), outcomes);
    reductions
}

fn json(reductions: &Reductions) -> String {
    serde_json::to_string(reductions).unwrap()
}

/// A file as records, each by the names of its columns.
fn records(reductions: &Reductions, name: &str) -> Vec<BTreeMap<String, String>> {
    let files = reductions.files();
    let (_, text) = files.iter().find(|(file, _)| *file == name).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let header: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    let mut names = header.clone();
    names.sort();
    names.dedup();
    // `step` is no column of the table, and nothing stands there twice.
    assert_eq!(names.len(), header.len(), "{header:?}");
    let cells =
        |record: csv::StringRecord| header.iter().cloned().zip(record.iter().map(String::from)).collect();
    reader.records().map(|record| cells(record.unwrap())).collect()
}

fn number(record: &BTreeMap<String, String>, name: &str) -> f64 {
    record[name].parse().unwrap_or_else(|_| panic!("{name} in {record:?}"))
}

/// The value of an expression in each row, with the row's design and step.
fn values(outcomes: &[DesignOutcome], text: &str) -> Vec<(f64, u64, u64)> {
    let formula = Formula::of(&Expression::parse(text).unwrap());
    let mut values = Vec::new();
    for one in outcomes {
        for (step, outcome) in one.steps.iter().enumerate() {
            let row = Row { case: &one.case, step, outcome, backend: one.backend };
            values.push((formula.value(&row), one.case.index, step as u64));
        }
    }
    values
}

const ALL: &str = r#"[select]
keep = "force > 3 N and status != 'large displacement'"
[reduce]
statistics = ["force", "peak_pressure", "hole_radius - thickness"]
quantiles = [0, 0.1, 0.5, 1]
best = [{ by = "peak_pressure", count = 20 }, { by = "energy", order = "smallest", count = 3 }]
pareto = { largest = "tangent_stiffness", smallest = ["peak_pressure", "hole_radius"] }
histogram = [
    { of = "peak_pressure" },
    { of = "force", spacing = "log", bins = 7 },
    { of = "hole_radius - thickness", from = "-1 mm", to = "100 mm" },
]
"#;

/// Rows in parts of any size, joined in any order and any pairs, some of them after a rest as text.
#[test]
fn parts_join_to_the_same_bytes_in_any_order() {
    let outcomes = outcomes(1, 2000);
    let whole = reduced(ALL, &outcomes);
    let filter = filter(ALL);
    let [rows, kept] = [None, filter.as_ref()].map(|filter| kept_rows(filter, &outcomes).len());
    assert!(rows > 3000 && kept > 1000 && kept < rows, "{kept} of {rows}");
    let mut random = Random::new(5);
    for _ in 0..12 {
        let count = 1 + (random.unit() * 9.0) as usize;
        let mut parts: Vec<Reductions> = (0..count).map(|_| reductions(ALL)).collect();
        let mut order: Vec<&DesignOutcome> = outcomes.iter().collect();
        for last in (1..order.len()).rev() {
            order.swap(last, (random.unit() * (last + 1) as f64) as usize);
        }
        for outcome in order {
            let part = &mut parts[(random.unit() * count as f64) as usize];
            add(part, &filter, std::slice::from_ref(outcome));
        }
        while parts.len() > 1 {
            let mut one = parts.swap_remove((random.unit() * parts.len() as f64) as usize);
            if random.unit() < 0.5 {
                one = serde_json::from_str(&json(&one)).unwrap();
            }
            let place = (random.unit() * parts.len() as f64) as usize;
            parts[place].merge(&one).unwrap();
        }
        assert_eq!(json(&parts[0]), json(&whole));
        assert_eq!(parts[0].files(), whole.files());
    }
    let names: Vec<&str> = whole.files().iter().map(|(name, _)| *name).collect();
    assert_eq!(names, ["statistics.csv", "best.csv", "pareto.csv", "histogram.csv"]);
}

#[test]
fn what_was_written_reads_back_to_the_bit_and_goes_on() {
    let outcomes = outcomes(2, 600);
    let (first, rest) = outcomes.split_at(333);
    let mut gone_on: Reductions = serde_json::from_str(&json(&reduced(ALL, first))).unwrap();
    assert_eq!(json(&gone_on), json(&reduced(ALL, first)));
    add(&mut gone_on, &filter(ALL), rest);
    assert_eq!(json(&gone_on), json(&reduced(ALL, &outcomes)));
    assert_eq!(gone_on.files(), reduced(ALL, &outcomes).files());
}

#[test]
fn what_is_no_state_is_refused() {
    let text = json(&reduced(ALL, &outcomes(3, 200)));
    for (old, new) in [
        ("\"digits\":10", "\"digits\":11"),
        ("\"digits\":10", "\"digits\":9"),
        ("\"of\":\"force\"", "\"of\":\"fork\""),
        ("\"count\":", "\"count\":-"),
        ("\"known\":[", "\"known\":[1,"),
        ("\"first\":", "\"first\":9999"),
    ] {
        assert!(text.contains(old), "{old}");
        let changed = text.replacen(old, new, 1);
        assert!(serde_json::from_str::<Reductions>(&changed).is_err(), "{new}");
    }
    let mut one = reductions(ALL);
    for other in [
        ALL.replace("count = 20", "count = 21"),
        ALL.replace("0.1,", "0.2,"),
        ALL.replace("bins = 7", "bins = 8"),
    ] {
        let said = one.merge(&reductions(&other)).unwrap_err().to_string();
        assert!(said.contains("different questions"), "{said}");
    }
}

/// Numbers k 2^-30 whose sums and squares are whole numbers that 128 bits hold.
#[test]
fn sums_are_exact() {
    let mut random = Random::new(9);
    let grain = 2_f64.powi(-30);
    for (offset, width) in [(0.0, 1e3), (0.0, 1e-6), (1e6, 1e-6), (-3e6, 10.0), (1e3, 0.0)] {
        let wholes: Vec<i128> =
            (0..1001).map(|_| ((offset + random.linear(-width, width)) / grain).round() as i128).collect();
        let (mut sum, mut squares) = (ExactSum::default(), ExactSum::default());
        for whole in &wholes {
            sum.add(*whole as f64 * grain);
            squares.add_square(*whole as f64 * grain);
        }
        let count = wholes.len() as i128;
        let total: i128 = wholes.iter().sum();
        let total_of_squares: i128 = wholes.iter().map(|whole| whole * whole).sum();
        let mean = total as f64 / count as f64 * grain;
        assert!((sum.mean(1001) - mean).abs() <= 1e-15 * mean.abs(), "{offset}");
        let spread = (count * total_of_squares - total * total) as f64;
        let expected = (spread / (count * (count - 1)) as f64).sqrt() * grain;
        let found = standard_deviation(&sum, &squares, 1001);
        assert!((found - expected).abs() <= 1e-15 * expected, "{offset} {width}: {found} {expected}");
    }
}

#[test]
fn sums_that_cancel_keep_what_is_left() {
    let sum_of = |values: &[f64]| {
        let mut sum = ExactSum::default();
        values.iter().for_each(|value| sum.add(*value));
        sum
    };
    for (values, expected) in [
        (&[1e308, 1.0, -1e308][..], 1.0),
        (&[1e16, 1.0, 1.0, -1e16, 0.5], 2.5),
        (&[f64::MAX, f64::MAX, -f64::MAX, -f64::MAX, 5e-324], 5e-324),
        (&[-1e100, 3e-300, 1e100, -4e-300], 3e-300 - 4e-300),
        (&[f64::MIN_POSITIVE, -5e-324], f64::MIN_POSITIVE - 5e-324),
        (&[0.1, -0.1], 0.0),
    ] {
        let sum = sum_of(values);
        assert_eq!(sum.mean(1).to_bits(), f64::to_bits(expected), "{values:?}");
        let text = serde_json::to_string(&sum).unwrap();
        assert_eq!(serde_json::from_str::<ExactSum>(&text).unwrap().mean(1), expected);
        let back: Vec<f64> = values.iter().rev().copied().collect();
        assert_eq!(serde_json::to_string(&sum_of(&back)).unwrap(), text);
    }
    // The harmonic series to a million terms: ln n + gamma + 1/(2n) - 1/(12 n^2).
    let harmonic: Vec<f64> = (1..=1_000_000).map(|term| 1.0 / f64::from(term)).collect();
    let expected = 1e6_f64.ln() + 0.577_215_664_901_532_9 + 0.5e-6 - 1e-12 / 12.0;
    assert!((sum_of(&harmonic).mean(1) - expected).abs() < 1e-14);
    // The largest numbers there are have a mean.
    assert_eq!(sum_of(&[f64::MAX; 1000]).mean(1000), f64::MAX);
}

#[test]
fn statistics_are_those_of_all_values() {
    let outcomes = outcomes(4, 1500);
    let asked = "[reduce]\nstatistics = ['peak_pressure', 'hole_radius - thickness', 'log(energy / (1 mJ))']";
    let records = records(&reduced(asked, &outcomes), "statistics.csv");
    let mut compared = 0;
    for of in ["peak_pressure", "hole_radius - thickness", "log(energy / (1 mJ))"] {
        let all = values(&outcomes, of);
        let mut known: Vec<(f64, u64, u64)> = all.iter().copied().filter(|row| row.0.is_finite()).collect();
        known.sort_by(|a, b| a.partial_cmp(b).unwrap());
        let count = known.len() as f64;
        let mean = known.iter().map(|row| row.0).sum::<f64>() / count;
        let spread = known.iter().map(|row| (row.0 - mean).powi(2)).sum::<f64>();
        let largest = known.last().unwrap().0;
        let first_largest = known.iter().find(|row| row.0 == largest).unwrap();
        for (name, expected, row) in [
            ("count", count, None),
            ("without_value", (all.len() - known.len()) as f64, None),
            ("min", known[0].0, Some(&known[0])),
            ("max", largest, Some(first_largest)),
            ("mean", mean, None),
            ("standard_deviation", (spread / (count - 1.0)).sqrt(), None),
        ] {
            let record = records.iter().find(|one| one["of"] == of && one["statistic"] == name).unwrap();
            let found = number(record, "value");
            assert!((found - expected).abs() <= 1e-8 * expected.abs(), "{of} {name}: {found} {expected}");
            assert_eq!(record["relative_error"], "0");
            let place =
                row.map_or((String::new(), String::new()), |row| (row.1.to_string(), row.2.to_string()));
            assert_eq!((record["design"].clone(), record["step"].clone()), place);
            compared += 1;
        }
    }
    assert_eq!((compared, records.len()), (18, 18));
}

/// Against the values themselves in order.
#[test]
fn quantiles_are_within_their_error() {
    let outcomes = outcomes(6, 3000);
    let shares = [0.0, 0.001, 0.05, 0.25, 0.5, 0.75, 0.95, 0.999, 1.0];
    let mut compared = 0;
    for of in [
        // Lognormal, roughly, negative, around zero, of few values, constant, and zero alone.
        "exp(log(force / (1 N)) / 3 + log(energy / (1 mJ)) / 3 + log(hole_radius / (1 mm)) / 3)",
        "-tangent_stiffness",
        "hole_radius - thickness * 50",
        "peak_pressure",
        "3 + 0 * design",
        "0 * design",
        "10 ^ (3 * log10(force_error) * step)",
    ] {
        let list: Vec<String> = shares.iter().map(f64::to_string).collect();
        let asked = format!("[reduce]\nstatistics = '{of}'\nquantiles = [{}]", list.join(", "));
        let records = records(&reduced(&asked, &outcomes), "statistics.csv");
        let mut known: Vec<f64> =
            values(&outcomes, of).iter().map(|row| row.0).filter(|one| one.is_finite()).collect();
        known.sort_by(f64::total_cmp);
        for share in shares {
            let name = format!("quantile_{share}");
            let record = records.iter().find(|one| one["statistic"] == name).unwrap();
            let error = number(record, "relative_error");
            assert!(error == 0.5 / 1024.0 || (error - 0.5 / 1024.0).abs() < 1e-12, "{error}");
            let expected = known[((share * known.len() as f64).ceil() as usize).max(1) - 1];
            let found = number(record, "value");
            let allowed = error * expected.abs() * (1.0 + 1e-8) + 1e-9 * expected.abs();
            assert!((found - expected).abs() <= allowed, "{of} {share}: {found} {expected}");
            compared += 1;
        }
    }
    assert_eq!(compared, 63);
}

/// Numbers over all decades that there are, of both signs.
#[test]
fn a_sketch_stays_small_and_knows_its_error() {
    let mut random = Random::new(8);
    let draw = |random: &mut Random| {
        let size = f64::from_bits((random.unit() * f64::MAX.to_bits() as f64) as u64);
        if random.unit() < 0.5 { size } else { -size }
    };
    let mut known: Vec<f64> = (0..300_000).map(|_| draw(&mut random)).collect();
    let mut whole = Sketch::default();
    let mut parts: [Sketch; 3] = Default::default();
    let mut most = 0;
    for (place, value) in known.iter().enumerate() {
        whole.add(*value);
        parts[place % 3].add(*value);
        most = most.max(whole.count_entries());
    }
    assert!(most <= MOST_COUNTS && most > MOST_COUNTS / 4, "{most}");
    let [mut one, two, three] = parts;
    one.merge(&three);
    one.merge(&two);
    assert_eq!(one, whole);
    // Fewer digits than at the start, and an error that says so.
    let error = whole.relative_error();
    assert!(error > 0.5 / 1024.0 && error < 0.04, "{error}");
    known.sort_by(f64::total_cmp);
    for (rank, value) in known.iter().enumerate().step_by(997) {
        let found = whole.at_rank(rank as u64 + 1).unwrap();
        let tiny = value.abs() < f64::MIN_POSITIVE;
        assert!(tiny || (found - value).abs() <= error * value.abs(), "{rank}: {found} {value}");
    }
    let few: Vec<f64> = (0..100_000).map(|_| random.log(1e-3, 1e3)).collect();
    let mut fine = Sketch::default();
    few.iter().for_each(|value| fine.add(*value));
    assert!(fine.relative_error() < 0.0005 && fine.count_entries() < 21_000, "{}", fine.count_entries());
}

#[test]
fn the_best_are_the_first_of_a_sorted_list() {
    let outcomes = outcomes(10, 1200);
    let asked = "[reduce]\nbest = [{ by = 'peak_pressure', count = 40 }, { by = 'energy / force', order = 'smallest', count = 7 }]";
    let records = records(&reduced(asked, &outcomes), "best.csv");
    assert_eq!(records.len(), 47);
    let mut rows = table_rows(&outcomes);
    for (by, sign, count) in [("peak_pressure", -1.0, 40), ("energy / force", 1.0, 7)] {
        let mut all = values(&outcomes, by);
        all.retain(|row| row.0.is_finite());
        all.sort_by(|a, b| (sign * a.0, a.1, a.2).partial_cmp(&(sign * b.0, b.1, b.2)).unwrap());
        let told: Vec<_> = records.iter().filter(|record| record["by"] == by).collect();
        assert_eq!(told.len(), count);
        for (rank, (record, row)) in told.iter().zip(&all).enumerate() {
            assert_eq!(record["rank"], (rank + 1).to_string());
            assert!((number(record, "value") - row.0).abs() <= 1e-8 * row.0.abs());
            assert_eq!((number(record, "design") as u64, number(record, "step") as u64), (row.1, row.2));
            check_row(record, rows.get_mut(&(row.1, row.2)).unwrap());
        }
        // Equal values are among them: the order of rows decides.
        assert!(by != "peak_pressure" || all[..count].windows(2).any(|two| two[0].0 == two[1].0));
    }
}

/// The rows of the table by design and step.
fn table_rows(outcomes: &[DesignOutcome]) -> BTreeMap<(u64, u64), BTreeMap<String, String>> {
    let table = Table::default();
    let text = [table.header(), table.rows(outcomes)].concat();
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let header = reader.headers().unwrap().clone();
    let places =
        outcomes.iter().flat_map(|one| (0..one.steps.len() as u64).map(|step| (one.case.index, step)));
    let cells = |record: csv::StringRecord| {
        header.iter().map(String::from).zip(record.iter().map(String::from)).collect()
    };
    places.zip(reader.records().map(|record| cells(record.unwrap()))).collect()
}

fn check_row(record: &BTreeMap<String, String>, row: &mut BTreeMap<String, String>) {
    assert!(row.len() > 20);
    row.iter().for_each(|(name, cell)| assert_eq!(&record[name], cell, "{name}"));
}

#[test]
fn a_front_is_what_no_row_beats() {
    let outcomes = outcomes(12, 700);
    let mut rows = table_rows(&outcomes);
    for (asked, of) in [
        (
            "largest = 'tangent_stiffness', smallest = 'peak_pressure'",
            &[("tangent_stiffness", -1.0), ("peak_pressure", 1.0)][..],
        ),
        ("largest = ['force', 'peak_pressure']", &[("force", -1.0), ("peak_pressure", -1.0)]),
        (
            "largest = 'peak_pressure', smallest = ['hole_radius', 'step']",
            &[("peak_pressure", -1.0), ("hole_radius", 1.0), ("step", 1.0)],
        ),
        (
            "smallest = ['step', 'peak_pressure - peak_pressure']",
            &[("step", 1.0), ("peak_pressure - peak_pressure", 1.0)],
        ),
    ] {
        let records =
            records(&reduced(&format!("[reduce]\npareto = {{ {asked} }}"), &outcomes), "pareto.csv");
        let columns: Vec<Vec<(f64, u64, u64)>> = of.iter().map(|(text, _)| values(&outcomes, text)).collect();
        let scores: Vec<(Vec<f64>, (u64, u64))> = (0..columns[0].len())
            .map(|row| {
                let score = columns.iter().zip(of).map(|(column, (_, sign))| sign * column[row].0);
                (score.collect(), (columns[0][row].1, columns[0][row].2))
            })
            .filter(|(score, _): &(Vec<f64>, _)| score.iter().all(|one| one.is_finite()))
            .collect();
        let is_beaten = |own: &(Vec<f64>, (u64, u64))| {
            scores.iter().any(|other| {
                let at_most = other.0.iter().zip(&own.0).all(|(a, b)| a <= b);
                at_most && (other.0 != own.0 || other.1 < own.1)
            })
        };
        let mut front: Vec<(u64, u64)> =
            scores.iter().filter(|own| !is_beaten(own)).map(|own| own.1).collect();
        let mut told: Vec<(u64, u64)> = records
            .iter()
            .map(|record| (number(record, "design") as u64, number(record, "step") as u64))
            .collect();
        front.sort_unstable();
        told.sort_unstable();
        assert_eq!(told, front, "{asked}");
        assert!(!front.is_empty());
        for record in &records {
            check_row(
                record,
                rows.get_mut(&(number(record, "design") as u64, number(record, "step") as u64)).unwrap(),
            );
        }
    }
    let first = &reduced("[reduce]\npareto = { largest = 'force', smallest = 'peak_pressure' }", &outcomes);
    let records = records(first, "pareto.csv");
    assert!(records.iter().all(|one| number(one, "largest force") == number(one, "force_n")));
}

#[test]
fn too_large_a_front_is_left_out_and_told() {
    let outcomes = outcomes(13, 40);
    let mut reductions = reductions(
        "[reduce]\npareto = { largest = 'design', smallest = 'design * 2' }\nstatistics = 'design'",
    );
    let mut outcome = outcomes[0].clone();
    for index in 0..MOST_POINTS as u64 {
        outcome.case.index = index;
        add(&mut reductions, &None, std::slice::from_ref(&outcome));
    }
    assert_eq!(records(&reductions, "pareto.csv").len(), MOST_POINTS);
    assert_eq!(reductions.remarks(), [""; 0]);
    outcome.case.index += 1;
    add(&mut reductions, &None, std::slice::from_ref(&outcome));
    assert_eq!(records(&reductions, "pareto.csv").len(), 0);
    let remarks = reductions.remarks();
    assert_eq!(remarks.len(), 1);
    assert!(remarks[0].starts_with(
        "pareto.csv is empty: more than 20000 rows are not beaten by others in design, design * 2"
    ));
    assert!(json(&reductions).len() < 10_000);
}

#[test]
fn bins_hold_what_lies_in_them() {
    let outcomes = outcomes(14, 2500);
    let mut bins = 0;
    for (of, more, known_edges) in [
        ("force", "", false),
        ("force", ", spacing = 'log', bins = 9", false),
        ("hole_radius - thickness * 50", ", bins = 13", false),
        ("hole_radius - thickness * 50", ", spacing = 'log', bins = 13", false),
        ("3 + 0 * design", "", false),
        ("force", ", from = '10 N', to = '1 kN'", true),
        ("force", ", from = '10 N', to = '1 kN', spacing = 'log'", true),
        ("peak_pressure", ", from = '10 MPa', to = '510 MPa', bins = 10", true),
    ] {
        let asked = format!("[reduce]\nhistogram = {{ of = '{of}'{more} }}");
        let records = records(&reduced(&asked, &outcomes), "histogram.csv");
        let known: Vec<f64> =
            values(&outcomes, of).iter().map(|row| row.0).filter(|one| one.is_finite()).collect();
        let total: f64 = records.iter().map(|record| number(record, "count")).sum();
        assert_eq!(total as usize, known.len(), "{asked}");
        let inner: Vec<_> =
            records.iter().filter(|one| !one["from"].is_empty() && !one["to"].is_empty()).collect();
        // Bins are of equal width, or of equal ratio.
        let (first, last) = (inner[0], inner[inner.len() - 1]);
        let size = |record: &BTreeMap<String, String>| match more.contains("log") {
            true => number(record, "to") / number(record, "from"),
            false => number(record, "to") - number(record, "from"),
        };
        assert!((size(first) / size(last) - 1.0).abs() < 1e-6 || inner.len() == 1, "{asked}");
        for (place, record) in inner.iter().enumerate() {
            // To nine digits, edges look like the values on them.
            let (from, to) = (number(record, "from"), number(record, "to"));
            let count = |slack: f64| {
                let (low, high) = (from - slack * from.abs(), to + slack * to.abs());
                known
                    .iter()
                    .filter(|&&value| {
                        value >= low && (value < high || place + 1 == inner.len() && value <= high)
                    })
                    .count()
            };
            // Without known edges values within 0.05 % of one may be counted beyond it.
            let slack = if known_edges { 1e-9 } else { 0.0005 };
            let found = number(record, "count") as usize;
            assert!((count(-slack)..=count(slack)).contains(&found), "{asked} {record:?}");
            bins += 1;
        }
        let below = known.iter().filter(|&&value| value < number(inner[0], "from") * (1.0 - 1e-9)).count();
        if known_edges {
            assert!(below > 0 || of == "peak_pressure");
        }
        let told = records.iter().find(|one| one["from"].is_empty()).map_or(0.0, |one| number(one, "count"));
        assert!(below == told as usize || !known_edges, "{asked}");
    }
    assert_eq!(bins, 20 + 9 + 13 + 13 + 1 + 20 + 20 + 10);
}

/// The example of the page, run as a whole, against its rows.
#[test]
fn the_example_answers_what_its_rows_say() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/requirements.toml");
    let text = std::fs::read_to_string(&path).unwrap().replace("count  = 10000", "count  = 500");
    let study = Study::from_text(&path, text).unwrap();
    assert!(!study.writes_table());
    let (mut reductions, filter) = (Reductions::of(&study).unwrap(), Filter::of(&study));
    let mut outcomes = Vec::new();
    let options = sweep::SweepOptions::default();
    sweep::run(&study, &options, &mut |outcome| {
        add(&mut reductions, &filter, std::slice::from_ref(&outcome));
        outcomes.push(outcome);
        Ok(ControlFlow::Continue(()))
    })
    .unwrap();
    let mut best: Option<(f64, u64)> = None;
    let mut kept = 0;
    for outcome in &outcomes {
        let response = outcome.steps[0].response.unwrap();
        let joint = &outcome.case.joint;
        let is_ok = outcome.steps[0].status.to_string() == "ok";
        if response.peak_pressure.unwrap() < 60.0 && response.tangent_stiffness > 3e5 && is_ok {
            kept += 1;
            let value = response.tangent_stiffness / (joint.hole_radius * joint.thickness);
            if best.is_none_or(|best| value > best.0) {
                best = Some((value, outcome.case.index));
            }
        }
    }
    assert_eq!((outcomes.len(), kept_rows(filter.as_ref(), &outcomes).len()), (500, kept));
    assert!(kept > 20 && kept < 400, "{kept}");
    let records = records(&reductions, "best.csv");
    assert_eq!(records.len(), 5);
    assert_eq!(number(&records[0], "design") as u64, best.unwrap().1);
    assert_eq!(records[0]["unit"], "N/mm^3");
}

/// The part of `report.html` that shows the answers, from their files alone.
#[test]
fn a_page_shows_the_answers() {
    let dir = std::env::temp_dir().join(format!("jointsweep-answers-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    assert_eq!(answers::section(&dir), "");
    let reductions = reduced(ALL, &outcomes(15, 400));
    for (name, text) in reductions.files() {
        std::fs::write(dir.join(name), text).unwrap();
    }
    let section = answers::section(&dir);
    std::fs::remove_dir_all(&dir).unwrap();
    let page = roxmltree::Document::parse(&section).unwrap();
    let count = |name: &str| page.descendants().filter(|node| node.has_tag_name(name)).count();
    let svg = |node: &roxmltree::Node| node.tag_name().name() == "svg";
    // Statistics and two rankings; three histograms and a front of three quantities.
    assert_eq!((count("table"), count("figure"), page.descendants().filter(svg).count()), (3, 5, 5));
    let text: String = page.descendants().filter_map(|node| node.text()).collect();
    for record in records(&reductions, "statistics.csv") {
        assert!(text.contains(&record["of"]) && text.contains(&record["statistic"].replace('_', " ")));
    }
    assert!(text.contains("The largest values of peak_pressure, 10 of 20"));
}
