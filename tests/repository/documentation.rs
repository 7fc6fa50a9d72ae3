//! docs/config.md and docs/table.md say what the program does: they are made from the code, and the code's list of keys is held
//! to what its reader takes and refuses.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use jointsweep::internals::engine::status::Remark;
use jointsweep::internals::output::schema;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::keys::{self, ConfigKey, RANGE, config_keys};
use jointsweep::internals::study::units::Dimension;

/// Of one design, with a value for all that is needed and nothing else.
const BASE: &str = r#"
[joint]
idealization = "plane-strain"
hole_radius = "12 mm"
radial_clearance = "0.03 mm"
thickness = "7 mm"
[joint.pin]
model = "rigid-core"
youngs_modulus = "200 GPa"
poissons_ratio = 0.25
[joint.plate]
model = "block"
half_width_ratio = 2
depth_ratio = 2
height_ratio = 2
youngs_modulus = "90 GPa"
poissons_ratio = 0.2
[load]
indentation = "0.01 mm"
"#;

type Table = toml::Table;

fn study(table: &Table) -> Result<Study, String> {
    // Where the example's list of designs is.
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs/base.toml");
    Study::from_text(&path, table.to_string()).map_err(|error| error.to_string())
}

/// The table of a dotted key, made where it is missing; the first one of a list of tables.
fn table_of<'a>(document: &'a mut Table, dotted: &str) -> &'a mut Table {
    dotted.split('.').filter(|part| !part.is_empty()).fold(document, |table, part| {
        match table.entry(part).or_insert_with(|| Table::new().into()) {
            toml::Value::Array(tables) => tables[0].as_table_mut().unwrap(),
            table => table.as_table_mut().unwrap(),
        }
    })
}

fn value(text: &str) -> toml::Value {
    toml::from_str::<Table>(&format!("x = {text}")).unwrap()["x"].clone()
}

/// The base with what makes room for a key: the model it is of, the load or the clearance that it takes the place of.
fn base_for(key: &ConfigKey) -> Table {
    let mut base: Table = toml::from_str(BASE).unwrap();
    let name = key.name.as_str();
    if name == "outer_radius_ratio" || key.table == "joint.plate.layers" {
        let plate = table_of(&mut base, "joint.plate");
        *plate =
            toml::from_str("model = 'annulus'\nyoungs_modulus = '90 GPa'\npoissons_ratio = 0.2").unwrap();
    }
    let is_of_inner = key.table.starts_with("joint.pin.inner");
    if is_of_inner || name == "bore_radius_ratio" {
        let tube =
            "model = 'tube'\nbore_radius_ratio = 0.5\nyoungs_modulus = '200 GPa'\npoissons_ratio = 0.25";
        *table_of(&mut base, "joint.pin") = toml::from_str(tube).unwrap();
    }
    if is_of_inner {
        *table_of(&mut base, "joint.pin.inner") =
            toml::from_str("youngs_modulus = '90 GPa'\npoissons_ratio = 0.2").unwrap();
    }
    if let Some(part) = key.table.strip_suffix(".layers") {
        if part == "joint.plate" {
            table_of(&mut base, part).insert("outer_radius_ratio".into(), 3.into());
        }
        let layers = "[{ thickness = '2 mm', youngs_modulus = '5 GPa', poissons_ratio = 0.3 }]";
        table_of(&mut base, part).insert("layers".into(), value(layers));
    }
    match (key.table.as_str(), name) {
        (table, "thickness_ratio") => _ = table_of(&mut base, table).remove("thickness"),
        ("joint", "diametral_clearance" | "fit") => {
            table_of(&mut base, "joint").remove("radial_clearance");
            *table_of(&mut base, "load") = [("offset".to_string(), value("'0.01 mm'"))].into_iter().collect();
        }
        // A press fit has no indentation.
        ("joint", "radial_clearance") => {
            *table_of(&mut base, "load") = [("offset".to_string(), value("'0.01 mm'"))].into_iter().collect();
        }
        ("load", "force" | "offset") => _ = table_of(&mut base, "load").remove("indentation"),
        ("designs", _) => base.clear(),
        ("sampling", _) => {
            table_of(&mut base, "joint").insert("thickness".into(), value("{ from = '1 mm', to = '2 mm' }"));
            table_of(&mut base, "sampling").extend([
                ("method".to_string(), value("'latin-hypercube'")),
                ("count".to_string(), value("3")),
            ]);
        }
        ("reduce", "quantiles") => {
            table_of(&mut base, "reduce").insert("statistics".into(), value("'force'"));
        }
        ("reduce.best", _) => _ = table_of(&mut base, "reduce.best").insert("by".into(), value("'force'")),
        ("reduce.pareto", name) => {
            let other = if name == "largest" { "smallest" } else { "largest" };
            let of = if name == "largest" { "'force'" } else { "'energy'" };
            table_of(&mut base, "reduce.pareto").insert(other.into(), value(of));
        }
        ("reduce.histogram", _) => {
            let histogram = "of = 'contact_half_angle / (1 deg) * (1 MPa)'\nfrom = '0.5 MPa'\nto = '9 MPa'";
            *table_of(&mut base, "reduce.histogram") = toml::from_str(histogram).unwrap();
        }
        (RANGE, _) => {
            table_of(&mut base, "load")
                .insert("indentation".into(), value("{ from = '0.01 mm', to = '0.02 mm', count = 3 }"));
        }
        _ => {}
    }
    base
}

/// Where a key's value stands in a config.
fn place(key: &ConfigKey) -> String {
    if key.table == RANGE { "load.indentation".into() } else { key.table.clone() }
}

/// What a complaint about an unknown key lists: what the reader itself allows there.
fn allowed(document: &Table, table: &str) -> BTreeSet<String> {
    let mut document = document.clone();
    table_of(&mut document, table).insert("qqqqqqqq".into(), 1.into());
    let said = study(&document).unwrap_err();
    let (_, listed) = said.split_once("unknown key; allowed: ").unwrap_or_else(|| panic!("{said}"));
    listed.split(", ").map(|name| name.trim_matches('`').to_string()).collect()
}

#[test]
fn the_keys_are_those_that_the_reader_allows() {
    let mut documented: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut read: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for key in config_keys() {
        documented.entry(place(&key)).or_default().insert(key.name.clone());
        // With every model that has keys of its own.
        read.entry(place(&key)).or_default().extend(allowed(&base_for(&key), &place(&key)));
    }
    // The tables themselves are keys of the tables above.
    let tables: Vec<String> =
        documented.keys().filter(|key| !key.is_empty() && *key != "load.indentation").cloned().collect();
    for table in tables {
        let (above, name) = table.rsplit_once('.').unwrap_or(("", &table));
        documented.get_mut(above).unwrap().insert(name.to_string());
    }
    assert_eq!(documented, read);
    assert!(config_keys().len() > 25);
}

#[test]
fn every_example_is_read_and_changes_something() {
    for key in config_keys() {
        let mut document = base_for(&key);
        let before = study(&document).map(|study| format!("{:?}", cases(&study)));
        if (key.table.as_str(), key.name.as_str()) == ("joint.plate", "model") {
            assert_eq!(key.example, "\"block\"");
            continue;
        }
        let example = match (key.table.as_str(), key.name.as_str()) {
            (RANGE, "from") => value("'0.001 mm'"),
            (RANGE, "to") => value("'1 mm'"),
            _ => value(&key.example),
        };
        table_of(&mut document, &place(&key)).insert(key.name.clone(), example);
        let after = study(&document).unwrap_or_else(|said| panic!("{}: {said}", key.dotted()));
        // The model of the pin is the base's own.
        if key.dotted() != "joint.pin.model" {
            assert_ne!(before, Ok(format!("{:?}", cases(&after))), "{}", key.dotted());
        }
    }
}

/// All that a config decides.
fn cases(study: &Study) -> (String, String, String, [bool; 3], Vec<String>) {
    let cases = study.cases().unwrap().take(1000).map(|case| format!("{:?}", case.unwrap()));
    (
        study.title().into(),
        format!("{:?} {:?}", study.solve, study.output),
        format!("{:?} {:?}", study.select, study.reduce),
        [study.interpolation, study.fits_laws(), study.writes_table()],
        cases.collect(),
    )
}

#[test]
fn every_default_is_what_leaving_the_key_out_means() {
    let mut count = 0;
    for key in config_keys() {
        let Some(default) = &key.default else { continue };
        let mut document = base_for(&key);
        if key.dotted() == "sampling.method" {
            document = toml::from_str(BASE).unwrap();
            table_of(&mut document, "joint").insert("thickness".into(), value("['1 mm', '2 mm']"));
            table_of(&mut document, "joint").insert("hole_radius".into(), value("['10 mm', '20 mm']"));
        }
        let without = cases(&study(&document).unwrap());
        table_of(&mut document, &place(&key)).insert(key.name.clone(), value(default));
        let with = cases(&study(&document).unwrap_or_else(|said| panic!("{}: {said}", key.dotted())));
        assert_eq!(with, without, "{}", key.dotted());
        count += 1;
    }
    assert_eq!(count, 15);
}

/// Values at the ends of what the page allows, and just beyond them.
#[test]
fn what_is_allowed_is_taken_and_nothing_beyond_it() {
    let mut numbers = 0;
    for key in config_keys().into_iter().filter(|key| key.table != RANGE) {
        let unit = match key.unit {
            "length" => Dimension::Length.unit(),
            "stress" => Dimension::Stress.unit(),
            "force" => Dimension::Force.unit(),
            _ => "",
        };
        let tried = |number: &str| {
            let mut document = base_for(&key);
            let text = if unit.is_empty() { number.to_string() } else { format!("\"{number} {unit}\"") };
            table_of(&mut document, &place(&key)).insert(key.name.clone(), value(&text));
            study(&document)
        };
        // The ends, with whether they themselves are allowed.
        let ends: &[(&str, bool)] = match key.allowed.as_str() {
            "above 0" => &[("-1.0", false), ("0.0", false), ("1.0", true)],
            "above 1" => &[("0.5", false), ("1.0", false), ("1.01", true)],
            "above 0 and below 1" | "above 0 and below 1 (100 %)" => {
                &[("0.0", false), ("0.01", true), ("0.99", true), ("1.0", false)]
            }
            "above -1 and below 0.5" => &[("-1.0", false), ("-0.99", true), ("0.49", true), ("0.5", false)],
            "of a size below the hole radius" => {
                &[("-12.0", false), ("-11.9", true), ("0", true), ("11.9", true), ("12.0", false)]
            }
            "of a size below the hole diameter" => {
                &[("-24.0", false), ("-23.9", true), ("0", true), ("23.9", true), ("24.0", false)]
            }
            "0 or more; at most 100000 steps" => &[("-0.1", false), ("0", true)],
            "whole numbers from 1 to 1000000000" => {
                &[("0", false), ("1", true), ("1000000000", true), ("1000000001", false), ("1.5", false)]
            }
            "true or false" => &[("true", true), ("false", true), ("1", false), ("'true'", false)],
            "whole numbers from 1 to 10000" => {
                &[("0", false), ("1", true), ("10000", true), ("10001", false), ("1.5", false)]
            }
            "numbers from 0 to 1, one or a list of up to 50" => {
                &[("-0.1", false), ("0", true), ("1.0", true), ("1.1", false), ("'0.5'", false)]
            }
            "a condition" => &[("'force > 1 N'", true), ("'force'", false), ("1", false)],
            "a column, or an expression of columns" => &[
                ("'peak_pressure / 2'", true),
                ("'peak_pressure > 1 MPa'", false),
                ("'qqqq'", false),
                ("1", false),
            ],
            "columns or expressions, one or a list of up to 50" => &[
                ("'force'", true),
                ("['force', 'energy / force']", true),
                ("['force < 1 N']", false),
                ("[]", false),
            ],
            "columns or expressions, one or a list of them; two or three in all" => &[
                ("'force'", true),
                ("['force', 'energy']", true),
                ("['force', 'energy', 'thickness']", false),
                ("'force < 1 N'", false),
            ],
            fits if fits.starts_with("holes H5 to H11") => &[
                ("'H7/p6'", true),
                ("'H11/c11'", true),
                ("'H4/p6'", false),
                ("'H7/v6'", false),
                ("7", false),
            ],
            "a number with its unit" => {
                &[("'2 MPa'", true), ("'2 mm'", false), ("2", false), ("'2'", false), ("'force'", false)]
            }
            "whole numbers from 0" => &[("-1", false), ("0", true)],
            words if words.starts_with('`') => {
                let words: Vec<&str> = words.split(", ").map(|word| word.trim_matches('`')).collect();
                let mut document = base_for(&key);
                table_of(&mut document, &place(&key)).insert(key.name.clone(), "qqqqqqqq".into());
                let said = study(&document).unwrap_err();
                let listed = words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ");
                assert!(said.ends_with(&format!("allowed: {listed}")), "{}: {said}", key.dotted());
                continue;
            }
            "text" | "a file" | "a list of columns of docs/table.md" => continue,
            other => panic!("{}: nothing is tried for {other}", key.dotted()),
        };
        for (number, is_allowed) in ends {
            let outcome = tried(number);
            assert_eq!(outcome.is_ok(), *is_allowed, "{} = {number}: {outcome:?}", key.dotted());
        }
        numbers += 1;
    }
    assert!(numbers > 15, "{numbers}");
}

#[test]
fn the_pages_hold_what_the_code_says() {
    for (name, made) in
        [("config.md", keys::documentation()), ("table.md", format!("\n{}", schema::documentation()))]
    {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        let (_, below) = text.split_once("from here on. -->\n").unwrap();
        assert!(below == made, "docs/{name} is old: cargo run --example documentation");
    }
    let laws = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/laws.md")).unwrap();
    let (_, columns) = laws.split_once("<!-- columns -->\n").unwrap();
    let (columns, _) = columns.split_once("<!-- end of columns -->").unwrap();
    assert_eq!(columns, schema::law_documentation(), "docs/laws.md");
}

/// docs/table.md says of each remark what it means, in the order in which rows have them.
#[test]
fn every_remark_is_explained() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/table.md")).unwrap();
    let (_, table) = page.split_once("| `status` | what it means |\n|---|---|\n").unwrap();
    let rows =
        table.lines().take_while(|line| line.starts_with("| `")).filter_map(|line| line.split('`').nth(1));
    let wanted: Vec<&str> =
        ["ok"].into_iter().chain(Remark::ALL.map(Remark::text)).chain(["failed: ..."]).collect();
    assert_eq!(rows.collect::<Vec<_>>(), wanted);
}
