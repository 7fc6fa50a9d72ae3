//! Expressions over the columns of a row: what is refused and how it is shown, units, and the value of each in random rows.

use std::path::Path;

use jointsweep::internals::engine::outcome::{BackendKind, DesignOutcome, Method, StepOutcome};
use jointsweep::internals::engine::status::{Failure, Remark, Status};
use jointsweep::internals::output::filter::Filter;
use jointsweep::internals::output::row_value::{Formula, Row};
use jointsweep::internals::output::sink::Sink;
use jointsweep::internals::output::table::Table;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::expression::Expression;

use crate::JOINT;
use crate::common::outcomes::outcomes;

fn rows(outcomes: &[DesignOutcome]) -> impl Iterator<Item = Row<'_>> {
    outcomes.iter().flat_map(|one| {
        let backend = one.backend;
        (0..).zip(&one.steps).map(move |(step, outcome)| Row { case: &one.case, step, outcome, backend })
    })
}

/// What is said of a mistake, and the piece of the expression that is marked.
fn refusal(text: &str) -> (String, String) {
    let said = Expression::parse(text).expect_err(text);
    let lines: Vec<&str> = said.lines().collect();
    let [problem, shown, mark] = lines[..] else { panic!("{text}: {said}") };
    let columns = |line: &str, sign: char| line.chars().take_while(|c| *c != sign).count();
    let start = columns(mark, '^');
    let length = mark.chars().count() - start;
    assert!(mark.chars().skip(start).all(|c| c == '^') && length > 0, "{said}");
    (problem.to_string(), shown.chars().skip(start).take(length).collect())
}

#[test]
fn mistakes_are_told_with_their_place() {
    #[rustfmt::skip]
    let cases = [
        // Pieces.
        ("force = 5 N", "=", "write `==`"),
        ("force > 1 N && energy > 1 mJ", "&&", "write `and`"),
        ("force > 1 N || energy > 1 mJ", "||", "write `or`"),
        ("force ** 2 > 1", "**", "write `^`"),
        ("!(force > 1 N)", "!", "write `not`"),
        ("force <> 1 N", "<>", "write `!=`"),
        ("force > 5 N; 3", ";", "`;` has no meaning here"),
        ("method == 'fe", "'", "the quote is not closed"),
        ("force > 1e999 N", "1e999", "the number is too large"),
        ("hole_radius > 1e308 m", "1e308", "the number is too large"),
        ("peak_pressure < 400 Mpa", "Mpa", "`Mpa` is not a unit; did you mean `MPa`?"),
        ("force < 3 newton", "newton", "`newton` is not a unit; "),
        // Names.
        ("peak_presure < 4 MPa", "peak_presure", "there is no column `peak_presure`; did you mean `peak_pressure`?"),
        ("sqr(force) < 4 N", "sqr(force)", "there is no function `sqr`; the functions are `abs`, `sqrt`, `log`"),
        ("sqrt < 4", "sqrt", "write sqrt(...)"),
        // How they go together.
        ("", "", "a number, a column or a `(` is needed here"),
        ("force >", "", "a number, a column or a `(` is needed here"),
        ("force > * 3", "*", "a number, a column or a `(` is needed here"),
        ("force 3", "3", "an operator is needed before this"),
        ("2 force", "force", "`force` is not a unit"),
        ("(force > 1 N", "(", "this `(` is not closed"),
        ("max(force, 1 N", "(", "this `(` is not closed"),
        ("(force force)", "force", "an operator, or the `)`"),
        ("force > 1 N)", ")", "there is no `(` for this `)`"),
        ("not force", "force", "this is a force (N), where a condition is needed"),
        ("force and energy > 1 mJ", "force", "this is a force (N), where a condition is needed"),
        ("1 N < force < 2 N", "1 N < force", "this is a condition, where a number is needed; join conditions by `and`"),
        ("(force > 1 N) + 1", "(force > 1 N)", "this is a condition, where a number is needed"),
        ("sqrt(force, 1 N)", "sqrt(force, 1 N)", "sqrt is of one value, not of 2"),
        ("min(force)", "min(force)", "min is of two values or more, not of 1"),
        // Units.
        ("hole_radius + force", "hole_radius + force", "a length (mm) and a force (N) cannot be added"),
        ("hole_radius - 5 deg", "hole_radius - 5 deg", "a length (mm) and an angle (deg) cannot be subtracted"),
        ("energy > 2 MPa", "energy > 2 MPa", "an energy (mJ) and a stress (MPa) cannot be compared"),
        ("peak_pressure < 400", "400", "the unit is missing: a stress (MPa) is meant, like `400 MPa`"),
        ("0 < tangent_stiffness", "0", "the unit is missing: a stiffness (N/mm) is meant, like `0 N/mm`"),
        ("force * force > 4", "4", "the unit is missing: a value in N^2 is meant, like `4 N^2`"),
        ("hole_radius * thickness > 30", "30", "the unit is missing: a value in mm^2 is meant, like `30 mm^2`"),
        ("force^2 / thickness > 2", "2", "the unit is missing: a value in N^2/mm is meant, like `2 N^2 / (1 mm)`"),
        ("2 mm^thickness > 1", "^", "the power of a unit is a number, like `mm^2`; put the value in brackets"),
        ("2 N/mm^(2) > 1 MPa", "^", "the power of a unit is a number, like `mm^2`"),
        ("2 mm^1000 > 1", "^", "the power of a unit is a number"),
        ("force_error < hole_radius", "force_error < hole_radius", "a number without a unit and a length (mm)"),
        ("max(force, energy) > 1 N", "force, energy", "a force (N) and an energy (mJ) cannot be compared"),
        ("exp(force)", "force", "exp is of a number without a unit, this is a force (N); divide it by a value, like `/ (1 N)`"),
        ("2 ^ force", "force", "an exponent has no unit; this is a force (N)"),
        ("force ^ force_error", "force_error", "the base is a force (N), so the exponent must be a number without"),
        ("force ^ 1e9", "1e9", "exponents of values with a unit go from -100 to 100"),
        // Words.
        ("plate_model == 'blok'", "'blok'", "the column never holds `blok`; did you mean `block`?"),
        ("'okay' != status", "'okay'", "the column never holds `okay`; did you mean `ok`?"),
        ("plate_model == block", "block", "there is no column `block`"),
        ("plate_model == 3", "3", "a word in quotes is needed here: 'annulus', 'block'"),
        ("force == method", "force", "a word in quotes is needed here: 'closed-form'"),
        ("method < 'fe'", "method < 'fe'", "words are compared by `==` and `!=` alone"),
        ("force == 'fe'", "'fe'", "this is a word in quotes, where a number is needed"),
        ("method", "method", "this is a column of words, where a number or a condition is needed"),
        ("-method == 'fe'", "method", "this is a column of words, where a number is needed"),
    ];
    for (text, marked, problem) in cases {
        let (said, shown) = refusal(text);
        assert!(said.starts_with(problem), "{text}: {said}");
        assert_eq!(shown, marked, "{text}: {said}");
    }
}

/// Columns of eight layers a part would hide all others: those of one are listed, and any is found by what is near.
#[test]
fn columns_of_one_layer_stand_for_those_of_all() {
    let (said, _) = refusal("abc > 3");
    assert!(said.contains("`pin_layer1_thickness`") && said.contains("`force`, "), "{said}");
    assert!(said.ends_with("`status`; of `layer2` to `layer8` as of `layer1`"), "{said}");
    assert_eq!(said.matches("_layer").count(), 6, "{said}");
    let (said, _) = refusal("pin_layer3_thicknes > 3 mm");
    let near =
        "there is no column `pin_layer3_thicknes`; did you mean `pin_layer3_thickness`? Allowed: `design`, ";
    assert!(said.starts_with(near), "{said}");
}

#[test]
fn a_long_expression_is_shown_around_the_mistake() {
    let text = format!(
        "{} and\nµ_x < 3 and {}",
        ["force > 1 N"; 20].join(" and "),
        ["force > 1 N"; 20].join(" or ")
    );
    let (problem, marked) = refusal(&text);
    assert!(problem.starts_with("there is no column `µ_x`"), "{problem}");
    assert_eq!(marked, "µ_x");
    assert!(Expression::parse(&text).unwrap_err().lines().skip(1).all(|line| line.chars().count() < 130));
}

/// On a stack of a quarter of a megabyte.
#[test]
fn deep_and_long_expressions_end_in_words() {
    let check = || {
        let deep = |open: &str, close: &str, count: usize| {
            format!("{}force_error{} < 1", open.repeat(count), close.repeat(count))
        };
        for (open, close) in
            [("(", ")"), ("-", ""), ("- ", ""), ("abs(", ")"), ("2^", ""), ("min(1, ", ")"), ("(1+", ")")]
        {
            assert!(Expression::parse(&deep(open, close, 40)).is_ok(), "{open}");
            for count in [200, 1000] {
                let said = Expression::parse(&deep(open, close, count)).unwrap_err();
                assert!(said.contains("wait for each other"), "{open}: {said}");
            }
        }
        let nots = format!("{}force_error < 1", "not ".repeat(60));
        assert!(Expression::parse(&nots).unwrap_err().contains("wait for each other"));
        let inner = format!("force_error {} < 1", "< not force_error".repeat(60));
        assert!(Expression::parse(&inner).unwrap_err().contains("wait for each other"));
        let pile = format!("{}1{} > 0", "(force_error + ".repeat(48), ")".repeat(48));
        assert!(Expression::parse(&pile).is_ok());
        // Long ones that are not deep.
        let many = ["design == 3"; 600].join(" or ");
        assert!(Expression::parse(&many).is_ok());
        let too_long = ["design == 3"; 1000].join(" or ");
        assert!(Expression::parse(&too_long).unwrap_err().contains("at most 10000 are allowed"));
        for odd in ["(", ")", "-", "^", "not", ",", "'", "1", "5 MPa", "e", "µ", "\u{0}", "max(", "force <"]
        {
            for count in [1, 2, 3, 500] {
                assert!(Expression::condition(&odd.repeat(count)).is_err());
            }
        }
    };
    std::thread::Builder::new().stack_size(256 << 10).spawn(check).unwrap().join().unwrap();
}

#[test]
fn units_go_through_the_calculation() {
    for (text, unit) in [
        ("peak_pressure_mpa", "MPa"),
        ("peak_pressure", "MPa"),
        ("contact_half_angle", "deg"),
        ("tangent_stiffness / peak_pressure", "mm"),
        ("force / hole_radius / thickness", "MPa"),
        ("force * indentation", "mJ"),
        ("force / indentation", "N/mm"),
        ("sqrt(hole_radius * thickness)", "mm"),
        ("(hole_radius ^ 3) ^ (1/3)", "mm"),
        ("force ^ 2 / energy ^ 2", "1/mm^2"),
        ("force ^ 2 / energy / hole_radius ^ 2", "N/mm^3"),
        ("force / contact_half_angle / hole_radius", "N/(mm deg)"),
        ("radial_clearance / hole_radius", "-"),
        ("log10(force / (1 N))", "-"),
        ("design * step", "-"),
    ] {
        assert_eq!(Expression::quantity(text).unwrap().unit().text(), unit, "{text}");
    }
    let unit = |text: &str| Expression::quantity(text).unwrap().unit();
    for (text, column, value) in [
        ("400 MPa", "peak_pressure", 400.0),
        ("0.4GPa", "peak_pressure", 400.0),
        ("10 ksi", "peak_pressure", 68.947572931684),
        ("2e5 N/mm", "tangent_stiffness", 2e5),
        ("200 kN/mm", "tangent_stiffness", 2e5),
        ("2 N/um", "tangent_stiffness", 2e3),
        ("2 MN/m", "tangent_stiffness", 2e3),
        ("2 kN/m", "tangent_stiffness", 2.0),
        ("1 lbf/in", "tangent_stiffness", 0.175126835246476),
        ("2 kN / (1 cm)", "tangent_stiffness", 200.0),
        // Powers are those of units, not of the value before them.
        ("4 N/mm^2", "peak_pressure", 4.0),
        ("3 kN/cm ^ 2", "peak_pressure", 30.0),
        ("5 N * 2 cm^2 / 1 mm^2", "force", 1000.0),
        ("2 cm^2 * 3 N * 1 cm^-1", "energy", 60.0),
        ("(2 mm)^2 / (1 mm)", "hole_radius", 4.0),
        ("2 mm^2^0.5", "hole_radius", std::f64::consts::SQRT_2),
        ("3 J", "energy", 3e3),
        ("3 N * 2 m", "energy", 6e3),
        ("1 rad", "contact_half_angle", 57.29577951308232),
        ("0.3 in", "hole_radius", 7.62),
        ("1 %", "force_error", 0.01),
        ("-2^2 + .5e1", "force_error", 1.0),
    ] {
        let found = Expression::value(text, unit(column)).unwrap();
        assert!((found - value).abs() <= 1e-13 * value, "{text}: {found}");
    }
    // What is proposed where a unit is missing is what was meant.
    for (quantity, value) in [
        ("force^2", 7.0),
        ("hole_radius * thickness", 0.5),
        ("force^2 / thickness * 3", 30.0),
        ("1 / energy^2", 2.0),
    ] {
        let said = Expression::condition(&format!("{quantity} > {value}")).unwrap_err();
        let (_, example) = said.split_once("like `").unwrap();
        let example = example.split_once('`').unwrap().0;
        let unit = Expression::quantity(quantity).unwrap().unit();
        assert_eq!(Expression::value(example, unit).unwrap(), value, "{example}");
    }
    for (text, column, problem) in [
        ("3", "force", "the unit is missing: a force (N) is meant, like `3 N`"),
        ("3 mm", "force", "this is a length (mm), where a force (N) is needed"),
        ("force", "force", "a force (N) is needed here, without columns"),
        ("1 N / 0", "force", "a force (N) is needed here, without columns"),
    ] {
        let said = Expression::value(text, unit(column)).unwrap_err();
        assert!(said.starts_with(problem), "{text}: {said}");
    }
}

/// Against exmex, an independent reader of formulas. It knows no units: literals have those of the table.
#[test]
fn values_are_those_of_another_reader() {
    let outcomes = outcomes(7, 300);
    let (mut compared, mut known) = (0, 0);
    for (ours, theirs) in [
        ("force_n", "force"),
        ("2 * force + 3 kN", "2 * force + 3000"),
        ("tangent_stiffness / peak_pressure", "stiffness / pressure"),
        ("force - 1 N - 2 N - (3 N - 4 N)", "force - 1 - 2 - (3 - 4)"),
        ("force / 2 / 3 * 4", "force / 2 / 3 * 4"),
        ("hole_radius * thickness ^ 2 / 2", "radius * thickness ^ 2 / 2"),
        ("sqrt(hole_radius ^ 2 + thickness ^ 2) - thickness", "sqrt(radius ^ 2 + thickness ^ 2) - thickness"),
        (
            "log10(force / (1 N)) * exp(-force_error) - log(energy / (1 uJ))",
            "log10(force) * exp(-error) - ln(energy / 0.001)",
        ),
        (
            "abs(hole_radius - thickness) + max(hole_radius, thickness, 5 cm) - min(2 mm, thickness)",
            "abs(radius - thickness) + (radius max (thickness max 50)) - (2 min thickness)",
        ),
        ("force ^ (1/3) * (1 N) ^ (2/3)", "force ^ (1/3)"),
        ("-(force - 2 N) * -3", "(0 - (force - 2)) * (0 - 3)"),
        ("contact_half_angle - 0.5 rad", "angle - 28.64788975654116"),
    ] {
        let formula = Formula::of(&Expression::quantity(ours).unwrap());
        let parsed = exmex::parse::<f64>(theirs).unwrap();
        for row in rows(&outcomes) {
            let own = formula.value(&row);
            let joint = &row.case.joint;
            let response = row.outcome.response;
            let of = |value: fn(&jointsweep::Response) -> Option<f64>| {
                response.as_ref().and_then(value).unwrap_or(f64::NAN)
            };
            let value = |name: &String| match name.as_str() {
                "force" => match row.case.steps[row.step] {
                    jointsweep::Load::Force(force) => force,
                    jointsweep::Load::Indentation(_) | jointsweep::Load::Offset(_) => {
                        of(|response| Some(response.force))
                    }
                },
                "stiffness" => of(|response| Some(response.tangent_stiffness)),
                "pressure" => of(|response| response.peak_pressure),
                "energy" => of(|response| response.energy),
                "angle" => of(|response| response.contact_half_angle.map(f64::to_degrees)),
                "error" => of(|response| Some(response.force_error)),
                "radius" => joint.hole_radius,
                "thickness" => joint.thickness,
                other => panic!("{other}"),
            };
            let values: Vec<f64> = exmex::Express::var_names(&parsed).iter().map(value).collect();
            compared += 1;
            if values.iter().any(|value| value.is_nan()) {
                assert!(own.is_nan(), "{ours}");
                continue;
            }
            let expected: f64 = exmex::Express::eval(&parsed, &values).unwrap();
            let scale = values.iter().fold(expected.abs(), |most, value| most.max(value.abs()));
            assert!((own - expected).abs() <= 1e-13 * scale, "{ours}: {own} is not {expected}");
            known += 1;
        }
    }
    assert!(compared > 5000 && known > 4000 && known < compared, "{known} of {compared}");
}

/// A row with a failure, one with an answer that lacks a pressure, one with all; each condition's value in them.
#[test]
fn conditions_hold_fail_or_are_unknown() {
    let outcomes = outcomes(3, 200);
    let find = |test: fn(&Row) -> bool| rows(&outcomes).find(test).unwrap();
    let failed = find(|row| row.outcome.status == Status::Failed(Failure::NotAPush.into()));
    let partial = find(|row| row.outcome.response.is_some_and(|response| response.peak_pressure.is_none()));
    let whole = find(|row| row.outcome.response.is_some_and(|response| response.peak_pressure.is_some()));
    let (yes, no, unknown) = (Some(true), Some(false), None);
    for (text, expected) in [
        ("tangent_stiffness > 0 N/mm", [unknown, yes, yes]),
        ("not tangent_stiffness > 0 N/mm", [unknown, no, no]),
        ("peak_pressure > 0 MPa", [unknown, unknown, yes]),
        ("peak_pressure != 0 MPa", [unknown, unknown, yes]),
        ("not peak_pressure > 0 MPa", [unknown, unknown, no]),
        ("peak_pressure > 0 MPa or hole_radius > 0 mm", [yes, yes, yes]),
        ("hole_radius < 0 mm and peak_pressure > 0 MPa", [no, no, no]),
        ("hole_radius > 0 mm and peak_pressure > 0 MPa", [unknown, unknown, yes]),
        ("hole_radius < 0 mm or not peak_pressure > 0 MPa", [unknown, unknown, no]),
        ("(peak_pressure / (1 MPa)) ^ 0 == 1", [unknown, unknown, yes]),
        ("min(peak_pressure, 0 MPa) == 0 MPa", [unknown, unknown, yes]),
        ("status == 'failed'", [yes, no, no]),
        ("status != 'failed'", [no, yes, yes]),
        ("method == 'qqq' or true", [no, no, no]),
        (
            "log(0 - hole_radius / (1 mm)) > 0 or not log(0 - hole_radius / (1 mm)) > 0",
            [unknown, unknown, unknown],
        ),
        ("1 + 1 == 2 and not 1 > 2 or 1 > 2", [yes, yes, yes]),
        ("1 > 2 or 1 < 2 and 2 > 3", [no, no, no]),
        ("not 1 > 2 and 1 > 2", [no, no, no]),
        (
            "2 ^ 3 ^ 2 == 512 and -2 ^ 2 == -4 and 2 ^ -1 == 0.5 and 8 - 2 - 1 == 5 and 8 / 2 / 2 == 2",
            [yes, yes, yes],
        ),
    ] {
        let Ok(condition) = Expression::condition(text) else {
            assert!(text.contains("qqq"), "{text}");
            continue;
        };
        let formula = Formula::of(&condition);
        let filter = Filter::new(&condition);
        for (row, expected) in [failed, partial, whole].into_iter().zip(expected) {
            let value = formula.value(&row);
            let found = if value.is_nan() { None } else { Some(value == 1.0) };
            assert!(value.is_nan() || value == 0.0 || value == 1.0);
            assert_eq!(found, expected, "{text} in {:?}", row.outcome);
            assert_eq!(keeps(&filter, &row), expected == yes);
        }
    }
}

/// Each word of each column of words, against the text that the table has in it.
#[test]
fn words_are_those_of_the_table() {
    let outcomes = outcomes(11, 300);
    let table = Table::default();
    let text = [table.header(), table.rows(&outcomes)].concat();
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let header = reader.headers().unwrap().clone();
    let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let mut held = 0;
    for (column, words) in [
        ("idealization", &["plane-stress", "plane-strain"][..]),
        ("pin_model", &["rigid-core", "rigid-midplane"]),
        ("plate_model", &["annulus", "block"]),
        ("plate_support", &["base", "outer"]),
        ("method", &["closed-form", "series", "interpolated", "fe"]),
        ("backend", &["cpu", "gpu"]),
        ("status", &["ok", "failed", Remark::AccuracyNotMet.text(), Remark::LargeDisplacement.text()]),
    ] {
        let place = header.iter().position(|name| name == column).unwrap();
        for word in words {
            let test = |sign: &str| {
                Filter::new(&Expression::condition(&format!("{column} {sign} '{word}'")).unwrap())
            };
            let (equal, unequal) = (test("=="), test("!="));
            for (row, record) in rows(&outcomes).zip(&records) {
                let cell = &record[place];
                let has = match column {
                    "status" => cell.split("; ").any(|part| part.split(':').next() == Some(word)),
                    _ => cell == *word,
                };
                assert_eq!(keeps(&equal, &row), has, "{column} {word}: {cell}");
                assert_eq!(keeps(&unequal, &row), !has && !cell.is_empty(), "{column} {word}: {cell}");
                held += usize::from(has);
            }
        }
    }
    assert_eq!(rows(&outcomes).count(), records.len());
    assert!(held > 2000, "{held}");
}

#[test]
fn design_and_step_are_numbers() {
    let outcomes = outcomes(5, 50);
    let formula = Formula::of(&Expression::quantity("10 * design + step").unwrap());
    for row in rows(&outcomes) {
        assert_eq!(formula.value(&row), 10.0 * row.case.index as f64 + row.step as f64);
    }
}

fn study(more: &str) -> Result<Study, String> {
    Study::from_text(Path::new("c.toml"), format!("{JOINT}{more}")).map_err(|error| error.to_string())
}

#[test]
fn configs_are_refused_by_line_and_key() {
    #[rustfmt::skip]
    let cases = [
        ("[select]\nkeep = 'force < 2 MPa'", "c.toml:11: select.keep: a force (N) and a stress (MPa) cannot be compared\n    force < 2 MPa\n    ^^^^^^^^^^^^^"),
        ("[select]\nkeep = 'force'", "c.toml:11: select.keep: this is a force (N), where a condition is needed"),
        ("[select]\nkeep = true", "c.toml:11: select.keep: `true`: a condition like"),
        ("[select]", "c.toml:10: select: the key `keep` is missing"),
        ("[select]\nkep = 'force < 2 N'", "c.toml:11: select.kep: unknown key; did you mean `keep`?"),
        ("[reduce]", "c.toml:10: reduce: asks for nothing"),
        ("[reduce]\nquantiles = 0.5", "c.toml:11: reduce.quantiles: quantiles are of the columns in `statistics`"),
        ("[reduce]\nstatistics = ['force', 'forc']", "c.toml:11: reduce.statistics: there is no column `forc`; did you mean `force`?"),
        ("[reduce]\nstatistics = '3 N'", "c.toml:11: reduce.statistics: there is no column in this"),
        ("[reduce]\nstatistics = 'force > 3 N'", "c.toml:11: reduce.statistics: this is a condition, where a column"),
        ("[reduce]\nstatistics = 'force'\nquantiles = [0.5, 2]", "c.toml:12: reduce.quantiles: `2`: must be from 0"),
        ("[reduce]\nbest = { count = 5 }", "c.toml:11: reduce.best: the key `by` is missing"),
        ("[reduce]\nbest = { by = 'force', count = 0 }", "c.toml:11: reduce.best.count: `0`: must be a whole number from 1"),
        ("[reduce]\nbest = { by = 'force', order = 'biggest' }", "`'biggest'`: not known; allowed: `largest`, `smallest`"),
        ("[reduce]\npareto = { largest = 'force' }", "c.toml:11: reduce.pareto: a front is of two or three columns in `largest`"),
        ("[reduce]\nhistogram = { of = 'force', from = '1 N' }", "c.toml:11: reduce.histogram.from: `to` is missing beside it"),
        ("[reduce]\nhistogram = { of = 'force', from = '2 N', to = '1 N' }", "must be above `from`, which is '2 N'"),
        ("[reduce]\nhistogram = { of = 'force', from = '0 N', to = '1 N', spacing = 'log' }", "must be above 0 for spacing"),
        ("[reduce]\nhistogram = { of = 'force', from = 1, to = '9 N' }", "reduce.histogram.from: the unit is missing: a force (N)"),
    ];
    for (more, expected) in cases {
        let said = study(more).map(|_| ()).unwrap_err();
        assert!(said.contains(expected), "{more}\n{said}");
    }
    let long = format!("[reduce]\nstatistics = [{}]", ["'force'"; 51].join(", "));
    assert!(study(&long).map(|_| ()).unwrap_err().contains("51 entries; at most 50 are allowed"));
}

#[test]
fn configs_without_answers_ask_for_rows() {
    let plain = study("").unwrap();
    assert!(plain.writes_table() && plain.select.is_none() && plain.reduce.is_none());
    assert!(Filter::of(&plain).is_none());
    assert!(study("[select]\nkeep = 'force < 2 N'").unwrap().writes_table());
    let reduced = study("[reduce]\nstatistics = 'force'").unwrap();
    assert!(!reduced.writes_table());
    assert!(study("[reduce]\nstatistics = 'force'\n[output]\ntable = true").unwrap().writes_table());
    assert!(!study("[output]\ntable = false").unwrap().writes_table());
    let listed = study("[[reduce.best]]\nby = 'force'\n[[reduce.best]]\nby = 'energy'\ncount = 3").unwrap();
    assert_eq!(listed.reduce.unwrap().best.iter().map(|best| best.count).collect::<Vec<_>>(), [10, 3]);
}

/// Rows that cannot be are no reason to panic.
#[test]
fn a_number_that_is_none_is_unknown() {
    let outcomes = outcomes(1, 1);
    let mut response = rows(&outcomes).find_map(|row| row.outcome.response).unwrap();
    response.energy = Some(f64::NAN);
    response.method = Method::Fe;
    let outcome = StepOutcome { response: Some(response), status: Status::OK };
    let row = Row { case: &outcomes[0].case, step: 0, outcome: &outcome, backend: BackendKind::Cpu };
    assert!(Formula::of(&Expression::quantity("energy * 0").unwrap()).value(&row).is_nan());
    let condition = Expression::condition("energy > 0 mJ or energy <= 0 mJ").unwrap();
    assert!(!keeps(&Filter::new(&condition), &row));
}

fn keeps(filter: &Filter, row: &Row) -> bool {
    filter.keeps(&[*row], &mut Vec::new()).eq([true])
}
