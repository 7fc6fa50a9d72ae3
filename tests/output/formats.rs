//! The kinds of file that a table may be: all hold the same rows, whatever the threads and however often the run was stopped; tables
//! with fewer columns are read again where that is possible.

use std::fs::File;
use std::io::{Read, Seek, Write};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::SystemTime;

use crate::common::workdir::Workdir;
use jointsweep::internals::engine::sweep::{self, Digest, SweepOptions};
use jointsweep::internals::output::folder::{
    Permissions, ResultFolder, TABLE, TABLE_PARQUET, TABLE_ZST, Verdict,
};
use jointsweep::internals::output::manifest::Conditions;
use jointsweep::internals::output::parquet_table::ParquetTable;
use jointsweep::internals::output::recorder::Recorder;
use jointsweep::internals::output::report;
use jointsweep::internals::output::results::{Results, TableRow};
use jointsweep::internals::output::sink::Sink;
use jointsweep::internals::output::sinks::{Rows, Sinks};
use jointsweep::internals::output::table_sink::{portion, table_sink};
use jointsweep::internals::study::columns::Quantity;
use jointsweep::internals::study::config::Study;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

/// Forty designs of a thousand steps: more than two portions.
const CONFIG: &str = r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = { from = "0.03 mm", to = "0.1 mm", count = 10 }
thickness = ["5 mm", "7 mm"]
[joint.pin]
model = "rigid-midplane"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = 3.0
youngs_modulus = ["70 GPa", "71.123456789 GPa"]
poissons_ratio = 0.33
[load]
force = { from = "0.1 N", to = "100 kN", count = 1000, spacing = "log" }
"#;

/// Behind `[output]`: a law that knows neither energies nor loads as large as these.
const CLOSED: &str = "\n[solve]\nmethod = \"closed-form\"\n";

const FORMATS: [(&str, &str); 3] = [("csv", TABLE), ("csv.zst", TABLE_ZST), ("parquet", TABLE_PARQUET)];

const ALL: [Quantity; 3] = [Quantity::Indentation, Quantity::Force, Quantity::Status];

/// A study with something in `[output]`.
fn study(work: &Workdir, output: &str) -> Study {
    study_of(work, CONFIG, output)
}

fn study_of(work: &Workdir, config: &str, output: &str) -> Study {
    work.write("study.toml", &format!("{config}[output]\nlaws = false\n{output}"));
    Study::load(&work.path("study.toml")).unwrap()
}

fn recorder(work: &Workdir, study: &Study, folder: &str) -> Recorder {
    let claim = ResultFolder::of_run(Some(&work.path(folder)), study).claim("of a test").unwrap();
    Recorder::new(
        claim,
        study,
        &Conditions { gpu: None, threads: 1, started: SystemTime::now(), anew: false },
    )
    .unwrap()
}

/// The portions of a sweep.
fn portions(study: &Study, threads: usize) -> Vec<Rows> {
    let sinks = Sinks::of(study);
    let digest = Digest { designs: sinks.portion(), make: &|solved| sinks.rows(solved) };
    let mut all = Vec::new();
    let options = SweepOptions { threads, ..Default::default() };
    sweep::run_digested(study, &options, &digest, &mut |rows| {
        all.push(rows);
        Ok(ControlFlow::Continue(()))
    })
    .unwrap();
    all
}

/// The finished table of a run.
fn table(work: &Workdir, study: &Study, folder: &str, portions: &[Rows]) -> Vec<u8> {
    let mut recorder = recorder(work, study, folder);
    portions.iter().for_each(|rows| recorder.write(rows).unwrap());
    recorder.finish(&Default::default()).unwrap();
    std::fs::read(ResultFolder::of_run(Some(&work.path(folder)), study).table(study)).unwrap()
}

/// The cells of a Parquet file as a reader of its own sees them, with the names of its columns.
fn parquet_cells(path: PathBuf) -> (Vec<String>, Vec<Vec<Field>>) {
    let reader = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let columns = reader.metadata().file_metadata().schema_descr().columns();
    let names = columns.iter().map(|column| column.name().to_string()).collect();
    let rows = reader.get_row_iter(None).unwrap();
    (
        names,
        rows.map(|row| row.unwrap().into_columns().into_iter().map(|(_, field)| field).collect()).collect(),
    )
}

/// What was compared of two tables.
#[derive(Default)]
struct Compared {
    exact: usize,
    rounded: usize,
    empty: usize,
}

/// Compares a Parquet file with the CSV of the same rows, so many.
fn compare(work: &Workdir, count: usize, csv: &str, parquet: &str) -> Compared {
    let csv = work.table(csv);
    let (names, rows) = parquet_cells(work.path(parquet));
    assert_eq!(names, csv.names.iter().collect::<Vec<_>>());
    assert_eq!((rows.len(), csv.records.len()), (count, count));
    let mut compared = Compared::default();
    for (row, record) in rows.iter().zip(&csv.records) {
        for ((field, cell), name) in row.iter().zip(record).zip(&names) {
            match field {
                Field::Null => {
                    assert_eq!(cell, "", "{name}");
                    compared.empty += 1;
                }
                Field::Str(word) => assert_eq!(word, cell),
                Field::Long(number) => assert_eq!(number.to_string(), cell),
                // Inputs and the load stand in the text with all digits, results with nine.
                Field::Double(number) if cell.parse() == Ok(*number) => compared.exact += 1,
                Field::Double(number) => {
                    let nine: f64 = format!("{number:.8e}").parse().unwrap();
                    assert_eq!(cell.parse(), Ok(nine), "{name}");
                    compared.rounded += 1;
                }
                other => panic!("{name}: {other:?}"),
            }
        }
    }
    compared
}

#[test]
fn every_format_holds_the_same_rows_whatever_the_threads() {
    let work = Workdir::new("formats_rows");
    for (method, more) in [("auto", ""), ("closed", CLOSED)] {
        for (format, name) in FORMATS {
            let study = study(&work, &format!("format = \"{format}\"{more}"));
            let run = |threads: usize| {
                table(&work, &study, &format!("{method}-{threads}"), &portions(&study, threads));
                std::fs::read(work.path(&format!("{method}-{threads}/{name}"))).unwrap()
            };
            // In one crew, and in four.
            assert!(run(1) == run(2) && run(1) == run(9), "{format}: the bytes hang on the threads");
            std::fs::rename(work.path(&format!("{method}-1")), work.path(&format!("{method}-{format}")))
                .unwrap();
        }
        let text = work.read(&format!("{method}-csv/table.csv"));
        let file = File::open(work.path(&format!("{method}-csv.zst/table.csv.zst"))).unwrap();
        let mut plain = String::new();
        zstd::Decoder::new(file).unwrap().read_to_string(&mut plain).unwrap();
        assert!(plain == text, "the compressed text is another one");
    }
    let [auto, closed] = ["auto", "closed"].map(|method| {
        compare(&work, 40_000, &format!("{method}-csv/table.csv"), &format!("{method}-parquet/table.parquet"))
    });
    assert!(auto.exact > 300_000 && auto.rounded > 100_000, "{} {}", auto.exact, auto.rounded);
    let failed = work.table("closed-csv/table.csv").column("status").join("\n").matches("failed: ").count();
    assert!(
        failed > 1000 && closed.empty > auto.empty + 10 * failed,
        "{failed} failed, {} empty",
        closed.empty
    );
}

/// Runs of one value and packed ones, values that come back, loads that differ from design to design, cells that are empty in some.
#[test]
fn few_rows_a_design_are_the_same_in_parquet() {
    let work = Workdir::new("formats_few");
    let check = |config: &str, count: usize| {
        for format in ["csv", "parquet"] {
            let study = study_of(&work, config, &format!("format = \"{format}\""));
            table(&work, &study, format, &portions(&study, 1));
        }
        let compared = compare(&work, count, "csv/table.csv", "parquet/table.parquet");
        ["csv", "parquet"].iter().for_each(|folder| std::fs::remove_dir_all(work.path(folder)).unwrap());
        compared
    };
    for steps in [2, 7, 8, 9, 20] {
        let config = CONFIG.replace("count = 1000", &format!("count = {steps}"));
        assert!(check(&config, 40 * steps).exact > 300 * steps, "{steps} loads");
    }
    let (kept, _) = CONFIG.split_once("[load]").unwrap();
    assert!(check(&format!("{kept}[load]\nforce = \"5 kN\"\n"), 40).exact > 300);
    // Empty inputs, values that come back, and either kind of load.
    let example = include_str!("../../configs/designs-example.csv");
    let mut list = format!("{}\n", example.lines().next().unwrap());
    for design in 0..60 {
        let core = ["0.1", ""][design / 3 % 2];
        let load = [format!("0.0{},", 1 + design % 2), format!(",{}", 1000 + design % 5)];
        let (radius, load) = (2 + design % 3, &load[design / 20 % 2]);
        list += &format!("20,0.05,10,plane-stress,rigid-core,{core},210000,0.3,annulus,{radius},,,,,");
        list += &format!("{},0.33,{load}\n", 70_000 + design / 30);
    }
    work.write("list.csv", &list);
    let listed = check("title = \"a list\"\n[designs]\nfile = \"list.csv\"\n", 60);
    assert!(listed.exact > 400 && listed.empty >= 240, "{} {}", listed.exact, listed.empty);
}

/// Of each column its unit and meaning, and one description of all row groups: what the format itself promises of a file.
#[test]
fn a_parquet_file_describes_itself() {
    let work = Workdir::new("formats_described");
    let study = study(&work, "format = \"parquet\"\ninputs = \"varying\"");
    let all = portions(&study, 1);
    table(&work, &study, "result", &all);
    let reader = SerializedFileReader::new(File::open(work.path("result/table.parquet")).unwrap()).unwrap();
    let metadata = reader.metadata();
    assert_eq!(metadata.num_row_groups(), all.len());
    assert!(all.len() > 2, "{} portions", all.len());
    assert_eq!(metadata.file_metadata().num_rows(), 40_000);
    // Of each chunk its extremes and how many cells are empty.
    let names: Vec<String> = (metadata.file_metadata().schema_descr().columns().iter())
        .map(|column| column.name().to_string())
        .collect();
    let (_, rows) = parquet_cells(work.path("result/table.parquet"));
    let mut rows = rows.into_iter();
    let mut compared = 0;
    for row_group in metadata.row_groups() {
        let own: Vec<Vec<Field>> = rows.by_ref().take(row_group.num_rows() as usize).collect();
        for (place, name) in names.iter().enumerate() {
            let told = row_group.column(place).statistics().unwrap();
            let cells = || own.iter().map(|row| &row[place]);
            let empty = cells().filter(|cell| matches!(cell, Field::Null)).count();
            assert_eq!(told.null_count_opt(), Some(empty as u64), "{name}");
            let bytes = |cell: &Field| match cell {
                Field::Double(number) => number.to_le_bytes().to_vec(),
                Field::Long(number) => number.to_le_bytes().to_vec(),
                Field::Str(word) => word.as_bytes().to_vec(),
                other => panic!("{name}: {other:?}"),
            };
            let filled = || cells().filter(|cell| !matches!(cell, Field::Null));
            let order = |a: &&Field, b: &&Field| match (a, b) {
                (Field::Double(a), Field::Double(b)) => a.total_cmp(b),
                (Field::Long(a), Field::Long(b)) => a.cmp(b),
                (a, b) => bytes(a).cmp(&bytes(b)),
            };
            let least = filled().min_by(order).map(bytes);
            let greatest = filled().max_by(order).map(bytes);
            assert_eq!(told.min_bytes_opt(), least.as_deref(), "{name}");
            assert_eq!(told.max_bytes_opt(), greatest.as_deref(), "{name}");
            compared += usize::from(least.is_some());
        }
    }
    assert!(compared > 20, "{compared} chunks");
    let about = metadata.file_metadata().key_value_metadata().unwrap();
    let json = |key: &str| -> serde_json::Value {
        let value = about.iter().find(|entry| entry.key == key).unwrap().value.clone();
        serde_json::from_str(&value.unwrap()).unwrap()
    };
    assert_eq!(json("columns")["force_n"]["unit"], "N");
    assert_eq!(json("columns")["force_n"]["meaning"], "of the whole joint, both halves");
    assert_eq!(json("constants"), work.json("result/manifest.json")["constants"]);
    assert_eq!(json("constants")["hole_radius_mm"], 10.0);
}

#[test]
fn a_run_that_goes_on_makes_the_same_bytes() {
    let work = Workdir::new("formats_resumed");
    for (format, name) in FORMATS {
        let study = study(&work, &format!("format = \"{format}\""));
        let all = portions(&study, 1);
        let whole = table(&work, &study, "whole", &all);
        for stop in 0..=all.len() {
            let mut first = recorder(&work, &study, "cut");
            all[..stop].iter().for_each(|rows| first.write(rows).unwrap());
            first.fail(&jointsweep::Error::Asked { problem: "stopped by the test".into() });
            if stop > 0 {
                // What a kill leaves behind the last mark.
                let path = work.path(&format!("cut/{name}.partial"));
                let mut file = std::fs::OpenOptions::new().append(true).open(path).unwrap();
                file.write_all(&whole[..whole.len() / 3]).unwrap();
            }
            let folder = ResultFolder::of_run(Some(&work.path("cut")), &study);
            let mut second = recorder(&work, &study, "cut");
            match folder.check(&study, Permissions::default()).unwrap() {
                Verdict::Begun(origin) => assert_eq!(second.go_on(&origin).unwrap(), None),
                other => assert!(stop == 0, "{other:?}"),
            }
            assert_eq!(second.designs_left().start, all[..stop].iter().map(Rows::designs).sum::<u64>());
            all[stop..].iter().for_each(|rows| second.write(rows).unwrap());
            second.finish(&Default::default()).unwrap();
            assert!(
                std::fs::read(work.path(&format!("cut/{name}"))).unwrap() == whole,
                "{format}, stopped after {stop}"
            );
            std::fs::remove_dir_all(work.path("cut")).unwrap();
        }
        std::fs::remove_dir_all(work.path("whole")).unwrap();
    }
}

/// A run may fail after its table has its end, and go on with nothing left to do. A file that is none is an error.
#[test]
fn the_end_of_a_parquet_file_is_written_once() {
    let work = Workdir::new("formats_end");
    let study = study(&work, "format = \"parquet\"");
    let whole = table(&work, &study, "whole", &portions(&study, 1));
    let sink = ParquetTable::of(&study);
    let end = |bytes: &[u8]| {
        let path = work.path("file");
        std::fs::write(&path, bytes).unwrap();
        let mut file = File::options().read(true).write(true).open(path).unwrap();
        file.rewind().unwrap();
        sink.end(&mut file)
    };
    assert_eq!(end(&whole).unwrap(), Vec::<u8>::new());
    let empty = [sink.header(), end(&sink.header()).unwrap()].concat();
    std::fs::write(work.path("empty.parquet"), empty).unwrap();
    assert_eq!(parquet_cells(work.path("empty.parquet")).1.len(), 0);
    let mut refused = 0;
    for length in (5..whole.len()).step_by(whole.len() / 50) {
        refused += usize::from(end(&whole[..length]).is_err());
    }
    assert!(refused >= 49, "{refused}");
}

#[test]
fn columns_are_those_asked_for() {
    let work = Workdir::new("formats_columns");
    let header = |output: &str| {
        let study = study(&work, output);
        String::from_utf8(table_sink(&study).header()).unwrap()
    };
    let asked = "columns = [\"status\", \"force_n\", \"thickness_mm\", \"design\", \"pin_model\"]\n";
    assert_eq!(header(asked), "design,thickness_mm,pin_model,force_n,status\n");
    assert_eq!(header(&format!("{asked}inputs = \"varying\"")), "design,thickness_mm,force_n,status\n");
    let varying = "design,radial_clearance_mm,thickness_mm,plate_youngs_modulus_mpa,indentation_mm,";
    assert!(header("inputs = \"varying\"").starts_with(varying), "{}", header("inputs = \"varying\""));

    // A single column: a row without a value is still a row.
    let study = study(&work, &format!("columns = [\"energy_mj\"]{CLOSED}"));
    table(&work, &study, "one", &portions(&study, 1));
    let one = work.table("one/table.csv");
    assert_eq!(one.records.len(), 40_000);
    assert_eq!(one.column("energy_mj"), [""; 40_000]);
}

/// What varies in a list of designs is found in its rows.
#[test]
fn constants_of_a_list_are_found() {
    let work = Workdir::new("formats_list");
    let names = "hole_radius_mm,radial_clearance_mm,thickness_mm,idealization,pin_model,core_radius_ratio,\
                 pin_youngs_modulus_mpa,pin_poissons_ratio,plate_model,outer_radius_ratio,plate_youngs_modulus_mpa,\
                 plate_poissons_ratio,indentation_mm";
    let row = |clearance: &str, load: &str| {
        format!("10,{clearance},5,plane-stress,rigid-core,0.2,210000,0.3,annulus,3,70000,0.33,{load}\n")
    };
    let rows = [row("0.05", "0.001"), row("0.05", "0.002"), row("0.06", "0.002")].concat();
    work.write("list.csv", &format!("{names}\n{rows}"));
    work.write("list.toml", "[designs]\nfile = \"list.csv\"\n[output]\ninputs = \"varying\"\n");
    let study = Study::load(&work.path("list.toml")).unwrap();
    table(&work, &study, "result", &portions(&study, 1));
    assert_eq!(
        &work.table("result/table.csv").names.iter().collect::<Vec<_>>()[..3],
        ["design", "radial_clearance_mm", "indentation_mm"]
    );
    let constants = &work.json("result/manifest.json")["constants"];
    assert_eq!(constants.as_object().unwrap().len(), 15);
    assert_eq!(
        (&constants["core_radius_ratio"], &constants["depth_ratio"]),
        (&0.2.into(), &serde_json::Value::Null)
    );
    assert_eq!(constants["plate_model"], "annulus");
}

/// All rows that a folder's table has for readers.
fn read(work: &Workdir, folder: &str) -> Vec<TableRow> {
    let mut rows = Results::open(&work.path(folder)).unwrap().rows(&ALL).unwrap();
    let mut all = Vec::new();
    while rows.advance().unwrap().is_some() {
        all.push(rows.row().unwrap());
    }
    all
}

#[test]
fn every_table_is_read_again() {
    let work = Workdir::new("formats_read");
    let make = |folder: &str, output: &str| {
        let study = study(&work, output);
        table(&work, &study, folder, &portions(&study, 2));
    };
    make("plain", "");
    let expected = read(&work, "plain");
    assert_eq!(expected.len(), 40_000);
    let close = |one: Option<f64>, other: Option<f64>| match (one, other) {
        (Some(one), Some(other)) => (one - other).abs() <= 1e-8 * other.abs(),
        (one, other) => one.is_none() && other.is_none(),
    };
    for (format, _) in FORMATS {
        make(format, &format!("inputs = \"varying\"\nformat = \"{format}\""));
        let found = read(&work, format);
        assert_eq!(found.len(), expected.len(), "{format}");
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(format!("{:?}", found.joint), format!("{:?}", expected.joint), "{format}");
            assert_eq!((found.design, &found.status), (expected.design, &expected.status), "{format}");
            assert!(close(found.force, expected.force) && close(found.indentation, expected.indentation));
        }
        let page = report::page(&Results::open(&work.path(format)).unwrap(), &[3]).unwrap();
        assert!(page.contains("hole_radius_mm") && page.contains("Young"), "{format}");
    }
    // Constants that were not asked for as columns are known all the same.
    make(
        "few",
        "columns = [\"design\", \"radial_clearance_mm\", \"thickness_mm\", \"plate_youngs_modulus_mpa\", \"force_n\", \"indentation_mm\", \"status\"]",
    );
    assert_eq!(format!("{:?}", read(&work, "few")[999].joint), format!("{:?}", expected[999].joint));

    make("fewer", "format = \"csv.zst\"\ncolumns = [\"design\", \"thickness_mm\", \"force_n\", \"status\"]");
    let results = Results::open(&work.path("fewer")).unwrap();
    let said = results.rows(&ALL).err().unwrap().to_string();
    let expected = "its table.csv.zst lacks the columns `radial_clearance_mm`, `plate_youngs_modulus_mpa`, `indentation_mm`: \
                    run the config with them in `columns` of [output], or without `columns`";
    assert!(said.ends_with(expected), "{said}");

    // A number that is none, with its row.
    let damaged = work.read("plain/table.csv").replacen(",ok\n", ",ok\nx", 1);
    work.write("plain/table.csv", &damaged);
    let mut rows = Results::open(&work.path("plain")).unwrap().rows(&ALL).unwrap();
    rows.advance().unwrap();
    let said = rows.advance().unwrap_err().to_string();
    assert!(said.contains("table.csv:3: design: `x0`: not a whole number"), "{said}");
}

/// Layers that are the same in all designs, or some of whose numbers are, are known again from a table without their columns; layers that
/// differ and are not in the table are asked for.
#[test]
fn layers_are_read_again() {
    let work = Workdir::new("formats_layers");
    let config = CONFIG.replace("count = 1000", "count = 5")
        + "[[joint.pin.layers]]\nthickness = \"0.5 mm\"\nyoungs_modulus = \"3 GPa\"\npoissons_ratio = 0.4\n\
           [[joint.plate.layers]]\nthickness = [\"1 mm\", \"1.25 mm\"]\nyoungs_modulus = \"1.5 GPa\"\npoissons_ratio = 0.35\n\
           [[joint.plate.layers]]\nthickness = \"0.25 mm\"\nyoungs_modulus = \"2 GPa\"\npoissons_ratio = 0.3\n";
    let make = |folder: &str, output: &str| {
        let study = study_of(&work, &config, output);
        table(&work, &study, folder, &portions(&study, 2));
    };
    make("plain", "");
    let expected = read(&work, "plain");
    assert_eq!(expected.len(), 400);
    let layers = |row: &TableRow| [&row.joint.pin, &row.joint.plate].map(|part| part.layers.list().len());
    assert_eq!(layers(&expected[0]), [1, 2]);
    let varying = "\"radial_clearance_mm\", \"thickness_mm\", \"plate_youngs_modulus_mpa\"";
    let results = "\"force_n\", \"indentation_mm\", \"status\"";
    let columns = format!("columns = [\"design\", {varying}, \"plate_layer1_thickness_mm\", {results}]");
    for (format, _) in FORMATS {
        for output in ["inputs = \"varying\"", &columns] {
            make(format, &format!("{output}\nformat = \"{format}\""));
            let found = read(&work, format);
            assert_eq!(found.len(), expected.len(), "{format}: {output}");
            for (found, expected) in found.iter().zip(&expected) {
                assert_eq!(
                    format!("{:?}", found.joint),
                    format!("{:?}", expected.joint),
                    "{format}: {output}"
                );
            }
        }
    }
    make("few", &format!("columns = [\"design\", {varying}, {results}]"));
    let said = Results::open(&work.path("few")).unwrap().rows(&ALL).err().unwrap().to_string();
    let expected =
        "its table.csv lacks the column `plate_layer1_thickness_mm`: run the config with it in `columns`";
    assert!(said.contains(expected), "{said}");
}

/// The same for the same study; few rows where each takes long, and a single design at the least.
#[test]
fn portions_follow_from_the_study() {
    let work = Workdir::new("formats_portions");
    assert_eq!(portion(&study(&work, "")), 64);
    for format in ["csv.zst", "parquet"] {
        assert_eq!(portion(&study(&work, &format!("format = \"{format}\""))), 16);
    }
    let of = |config: &str| {
        work.write("other.toml", config);
        portion(&Study::load(&work.path("other.toml")).unwrap())
    };
    let parquet = format!("{CONFIG}[output]\nformat = \"parquet\"\n");
    let steps = |count: &str| parquet.replace("count = 1000", &format!("count = {count}"));
    assert_eq!([of(&steps("2")), of(&steps("10")), of(&steps("100000"))], [8192, 1024, 1]);
    let slow = steps("2").replace("70 GPa\", \"71.123456789 GPa\"]", "70 GPa\", \"71 GPa\"]").replace(
        "model = \"annulus\"\nouter_radius_ratio = 3.0",
        "model = \"block\"\nhalf_width_ratio = { from = 1.1, to = 3, count = 500 }\ndepth_ratio = 2\nheight_ratio = 2",
    ) + "[solve]\naccuracy = \"0.01 %\"\ninterpolation = \"off\"\n";
    let slow = of(&slow);
    assert!((1..8192).contains(&slow), "{slow}");
}
