//! From a config on disk to designs: what the sweeps contain, and what each kind of bad input is told.

use std::fs;
use std::path::{Path, PathBuf};

use jointsweep::study::columns::{self, Cell, joint_columns};
use jointsweep::study::config::{MethodChoice, Study};
use jointsweep::study::design::{DesignCase, Load};

const BASE: &str = r#"title = "Test"
[joint]
idealization     = "plane-stress"
hole_radius      = "100 mm"
radial_clearance = "0.1 mm"
thickness        = "1 mm"
[joint.pin]
model          = "rigid-core"
youngs_modulus = "200 GPa"
poissons_ratio = 0.3
[joint.plate]
model              = "annulus"
outer_radius_ratio = 2.0
youngs_modulus     = "200 GPa"
poissons_ratio     = 0.3
[load]
indentation = ["0.1 mm", "0.2 mm"]
[solve]
accuracy = "1 %"
"#;

/// A folder of its own for one test, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("jointsweep-study-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        fs::write(&path, content).unwrap();
        path
    }

    fn study(&self, config: &str) -> Study {
        Study::load(&self.write("config.toml", config)).unwrap_or_else(|error| panic!("{error}\n{config}"))
    }

    /// What a config is refused with, without the folder.
    fn refusal(&self, config: impl AsRef<[u8]>) -> String {
        let path = self.write("config.toml", config.as_ref());
        let shown = String::from_utf8_lossy(config.as_ref()).into_owned();
        match Study::load(&path) {
            Ok(_) => panic!("accepted:\n{shown}"),
            Err(error) => error.to_string().replace(&format!("{}/", self.0.display()), ""),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// `BASE` with one text replaced by another.
fn with(old: &str, new: &str) -> String {
    assert_eq!(BASE.matches(old).count(), 1, "{old}");
    BASE.replace(old, new)
}

/// `BASE` with [sampling] and other values for the line of some key of [joint].
fn sampled(sampling: &str, lines: &[(&str, &str)]) -> String {
    let mut config = format!("{BASE}[sampling]\n{sampling}\n");
    for (old, new) in lines {
        assert_eq!(config.matches(old).count(), 1, "{old}");
        config = config.replace(old, new);
    }
    config
}

const RADIUS: &str = r#"hole_radius      = "100 mm""#;
const CLEARANCE: &str = r#"radial_clearance = "0.1 mm""#;
const IDEALIZATION: &str = r#"idealization     = "plane-stress""#;
const STEPS: &str = r#"indentation = ["0.1 mm", "0.2 mm"]"#;

fn all(study: &Study) -> Vec<DesignCase> {
    study.cases().unwrap().collect::<Result<_, _>>().unwrap()
}

/// A joint as the cells of its row, which compare with ==.
fn row(case: &DesignCase) -> Vec<Cell> {
    joint_columns().iter().map(|column| column.cell(&case.joint)).collect()
}

#[test]
fn shipped_configs_load() {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
    for (name, designs, steps) in [("quickstart", 10, 100), ("liu2007", 14, 140), ("designs-example", 5, 5)] {
        let path = configs.join(format!("{name}.toml"));
        let study = Study::load(&path).unwrap();
        assert_eq!((study.design_count(), study.step_count()), (designs, steps), "{name}");
        assert_eq!(all(&study).len() as u64, designs, "{name}");
        assert_eq!(study.source_text(), fs::read_to_string(&path).unwrap());
        assert_eq!(study.name(), name);
        assert_eq!(study.designs_file().is_some(), name == "designs-example");
    }
    let study = Study::load(&configs.join("liu2007.toml")).unwrap();
    assert_eq!(study.title(), "Liu, Zhang & Yang (2007)");
    assert_eq!((study.solve.accuracy, study.solve.method), (0.001, MethodChoice::Auto));
    let last = &all(&study)[13];
    assert_eq!(last.joint.radial_clearance, 0.1);
    let expected: Vec<Load> = (1..=10).map(|step| Load::Indentation(step as f64 / 50.0)).collect();
    assert_eq!(last.steps, expected);
}

#[test]
fn grid_is_every_combination_last_listed_fastest() {
    let folder = Folder::new("grid");
    let config = with(IDEALIZATION, r#"idealization = ["plane-stress", "plane-strain"]"#)
        .replace(RADIUS, r#"hole_radius = { from = "1 in", to = "3 in", count = 3 }"#)
        .replace(CLEARANCE, r#"diametral_clearance = ["0.2 mm", "200 um"]"#);
    let study = folder.study(&config);
    let found: Vec<_> = all(&study)
        .iter()
        .map(|case| (case.joint.idealization.name(), case.joint.hole_radius, case.joint.radial_clearance))
        .collect();
    assert_eq!(found.len(), 12);
    assert_eq!(found[0], ("plane-stress", 25.4, 0.1));
    assert_eq!(found[2], ("plane-stress", 50.8, 0.1));
    assert_eq!(found[11], ("plane-strain", 76.2, 0.1));
    // Skipping ahead is the same as walking.
    let skipped = study.cases().unwrap().nth(7).unwrap().unwrap();
    assert_eq!((skipped.index, row(&skipped)), (7, row(&all(&study)[7])));
}

#[test]
fn zip_pairs_lists_and_repeats_single_values() {
    let folder = Folder::new("zip");
    let lines = [
        (RADIUS, r#"hole_radius = ["10 mm", "0.05 mm", "30 mm"]"#),
        (CLEARANCE, r#"radial_clearance = { from = "0.02 mm", to = "0.06 mm", count = 3 }"#),
        (r#"thickness        = "1 mm""#, r#"thickness = ["7 mm"]"#),
    ];
    let found: Vec<_> = all(&folder.study(&sampled("method = \"zip\"", &lines)))
        .iter()
        .map(|case| (case.joint.hole_radius, case.joint.radial_clearance, case.joint.thickness))
        .collect();
    // 0.06 mm would not fit 0.05 mm, but the two never meet.
    assert_eq!(found, [(10.0, 0.02, 7.0), (0.05, 0.04, 7.0), (30.0, 0.06, 7.0)]);
}

#[test]
fn samplers_fill_their_ranges_and_repeat() {
    let folder = Folder::new("samplers");
    let lines = [
        (IDEALIZATION, r#"idealization = ["plane-stress", "plane-strain"]"#),
        (RADIUS, r#"hole_radius = { from = "1 mm", to = "1 m", spacing = "log" }"#),
        (CLEARANCE, r#"radial_clearance = { from = "1 um", to = "0.1 mm" }"#),
    ];
    for method in ["latin-hypercube", "sobol"] {
        let draw = |seed: u64| {
            all(&folder.study(&sampled(&format!("method = \"{method}\"\ncount = 64\nseed = {seed}"), &lines)))
        };
        let cases = draw(1);
        assert_eq!(cases.len(), 64);
        assert!(cases.iter().all(|case| (1.0..=1000.0).contains(&case.joint.hole_radius)));
        assert!(cases.iter().all(|case| (1e-3..=0.1).contains(&case.joint.radial_clearance)));
        // 64 points of either sampler are even: half in each half of every axis, in the logarithm where asked.
        let half = |test: &dyn Fn(&DesignCase) -> bool| cases.iter().filter(|case| test(case)).count();
        assert_eq!(half(&|case| case.joint.hole_radius < 1000f64.sqrt()), 32, "{method}");
        assert_eq!(half(&|case| case.joint.radial_clearance < 0.0505), 32, "{method}");
        assert_eq!(half(&|case| case.joint.idealization.name() == "plane-stress"), 32, "{method}");
        let rows = |cases: &[DesignCase]| cases.iter().map(row).collect::<Vec<_>>();
        assert_eq!(rows(&cases), rows(&draw(1)), "{method} does not repeat");
        assert_ne!(rows(&cases), rows(&draw(2)), "{method} ignores its seed");
    }
}

/// A sweep far longer than memory is loaded and entered at once.
#[test]
fn long_sweeps_stream() {
    let folder = Folder::new("long");
    let lines = [(RADIUS, r#"hole_radius = { from = "1 mm", to = "1 m" }"#)];
    for method in ["latin-hypercube", "sobol"] {
        let study = folder.study(&sampled(&format!("method = \"{method}\"\ncount = 1_000_000_000"), &lines));
        let last = study.cases().unwrap().nth(999_999_999).unwrap().unwrap();
        assert_eq!(last.index, 999_999_999);
        assert_eq!(study.step_count(), 2_000_000_000);
    }
}

/// A sweep written out with the shared columns and read back is the same sweep.
#[test]
fn a_list_of_designs_reads_back_what_was_written() {
    let folder = Folder::new("list");
    let plate = "model              = \"annulus\"\nouter_radius_ratio = 2.0\n";
    let block = "model = \"block\"\nhalf_width_ratio = [2, 3.7]\ndepth_ratio = 0x3\nheight_ratio = 2.5\n\
                 support = [\"outer\", \"base\"]\n";
    let original = all(&folder.study(&with(plate, block).replace(STEPS, r#"force = "1 lbf""#)));
    assert_eq!(original.len(), 4);

    let mut text: Vec<String> = joint_columns().iter().map(|column| column.name()).collect();
    text.push(columns::FORCE.to_string());
    let mut text = text.join(",");
    for case in &original {
        let cells = row(case).into_iter().map(|cell| match cell {
            Cell::Number(number) => number.to_string(),
            Cell::Word(word) => word.to_string(),
            Cell::Empty => String::new(),
        });
        text += &format!("\n{},4.4482216152605", cells.collect::<Vec<_>>().join(" , "));
    }
    // A byte-order mark and blank lines are what spreadsheets leave behind.
    folder.write("designs.csv", format!("\u{feff}{text}\n\n"));
    let read = all(&folder.study("[designs]\nfile = \"designs.csv\"\n"));
    assert_eq!(read.len(), original.len());
    for (read, original) in read.iter().zip(&original) {
        assert_eq!((read.index, row(read)), (original.index, row(original)));
        assert_eq!(read.steps, original.steps);
    }
}

/// A list that changes between the check and the run is refused, not half read.
#[test]
fn a_list_that_has_changed_is_refused() {
    let folder = Folder::new("changed");
    let list = fs::read_to_string("configs/designs-example.csv").unwrap();
    folder.write("designs.csv", &list);
    let study = folder.study("[designs]\nfile = \"designs.csv\"\n");
    let fewer: Vec<&str> = list.lines().take(4).collect();
    for changed in [fewer.join("\n"), format!("{list}{}\n", list.lines().last().unwrap())] {
        folder.write("designs.csv", changed);
        let error = study.cases().unwrap().find_map(Result::err).expect("accepted").to_string();
        assert!(error.contains("has changed since it was checked: it had 5 rows"), "{error}");
    }
}

#[test]
fn bad_configs_are_refused_by_line_and_key() {
    let folder = Folder::new("bad");
    let sobol = "method = \"sobol\"\ncount = 8";
    let from_to = (CLEARANCE, r#"radial_clearance = { from = "0.1 mm", to = "1 mm" }"#);
    let huge = r#"{ from = "1 mm", to = "2 mm", count = 1_000_000 }"#;
    let cases: Vec<(String, &str)> = vec![
        // Keys.
        (
            with("thickness ", "thicknes "),
            "config.toml:6: joint.thicknes: unknown key; did you mean `thickness`?",
        ),
        (with("[solve]", "[slove]"), "config.toml:18: slove: unknown key; did you mean `solve`?"),
        (
            with("[solve]\n", "[solve]\nmesh = 3\n"),
            "config.toml:19: solve.mesh: unknown key; allowed: `accuracy`",
        ),
        (with(RADIUS, ""), "config.toml:2: joint: the key `hole_radius` is missing"),
        (
            with("[joint]\n", "[joint]\ndiametral_clearance = \"1 mm\"\n"),
            "config.toml:3: joint.diametral_clearance:",
        ),
        (with(CLEARANCE, ""), "config.toml:2: joint: the key `radial_clearance` (or"),
        (
            with("outer_radius_ratio = 2.0", ""),
            "config.toml:11: joint.plate: the key `outer_radius_ratio` is missing",
        ),
        (
            with("[load]\n", "[load]\nforce = \"1 N\"\n"),
            "config.toml:17: load.force: `indentation` is given, too",
        ),
        (with(STEPS, ""), "config.toml:16: load: one of `indentation` and `force`"),
        ("title = \"x\"\n".to_string(), "config.toml: the table [joint] is missing"),
        (with("[load]", "[designs]\nfile = \"x.csv\"\n[load]"), "joint: has no place beside [designs]"),
        // Words.
        (
            with("plane-stress", "plane-stres"),
            "config.toml:3: joint.idealization: `\"plane-stres\"`: not known; did",
        ),
        (
            with("annulus", "rigid-core"),
            "config.toml:12: joint.plate.model: `\"rigid-core\"`: not known; allowed",
        ),
        (with("rigid-core", "rigid-midplane\"\ncore_radius_ratio = 0.2 #"), "`rigid-core` does"),
        (
            with("rigid-core\"", "rigid-core\"\nsupport = \"base\""),
            "config.toml:9: joint.pin.support: unknown key",
        ),
        (with("\"annulus\"", "\"annulus\"\nsupport = \"base\""), "model `annulus` does not have this key"),
        // Units, types, numbers.
        (
            with("\"100 mm\"", "100"),
            "config.toml:4: joint.hole_radius: `100`: the unit is missing; write it like \"100 mm\"",
        ),
        (with("\"100 mm\"", "\"100\""), "config.toml:4: joint.hole_radius: `\"100\"`: the unit is missing"),
        (with("\"100 mm\"", "\"100 MPa\""), "`MPa` is a unit of stress, a length is needed"),
        (
            with("\"100 mm\"", "true"),
            "`true`: a string with a number and a unit is needed here, not true or false",
        ),
        (with("\"100 mm\"", "\"0 mm\""), "config.toml:4: joint.hole_radius: `\"0 mm\"`: must be above 0"),
        (
            with("\"100 mm\"", "[\"1 mm\",\n\"-1 mm\"]"),
            "config.toml:5: joint.hole_radius: `\"-1 mm\"`: must be above 0",
        ),
        (with("\"100 mm\"", "\"nan mm\""), "not finite"),
        (with("\"100 mm\"", "[]"), "config.toml:4: joint.hole_radius: the list is empty"),
        (
            with("thickness        = \"1 mm\"", "thickness = \"0 mm\""),
            "joint.thickness: `\"0 mm\"`: must be above 0",
        ),
        (with("outer_radius_ratio = 2.0", "outer_radius_ratio = 1"), "`1`: must be above 1"),
        (
            with("outer_radius_ratio = 2.0", "outer_radius_ratio = \"2\""),
            "a plain number is needed here, not a string",
        ),
        (with("outer_radius_ratio = 2.0", "outer_radius_ratio = inf"), "`inf`: the number is not finite"),
        (
            with("poissons_ratio = 0.3", "poissons_ratio = [0.3, 0.5]"),
            "`0.5`: must be above -1 and below 0.5",
        ),
        (with("poissons_ratio     = 0.3", "poissons_ratio = nan"), "not finite"),
        (with("youngs_modulus = \"200 GPa\"", "youngs_modulus = \"-1 GPa\""), "must be above 0"),
        (
            with("model          = \"rigid-core\"", "model = \"rigid-core\"\ncore_radius_ratio = 1.0"),
            "above 0 and below 1",
        ),
        (
            with("[\"0.1 mm\", \"0.2 mm\"]", "\"-1 um\""),
            "config.toml:17: load.indentation: `\"-1 um\"`: must be 0 or more",
        ),
        (with("\"1 %\"", "0"), "config.toml:19: solve.accuracy: `0`: must be above 0 and below 1 (100 %)"),
        (with("\"1 %\"", "\"100 %\""), "must be above 0 and below 1"),
        (with("\"1 %\"", "\"1\""), "a fraction is written like"),
        // Fit.
        (
            with(CLEARANCE, r#"radial_clearance = "100 mm""#),
            "config.toml:5: joint.radial_clearance: a radial clearance of 100 mm meets a hole radius of 100 mm (line 4)",
        ),
        (
            with(CLEARANCE, r#"diametral_clearance = ["1 mm", "20 cm"]"#),
            "joint.diametral_clearance: among the combinations",
        ),
        (
            sampled(sobol, &[from_to, (RADIUS, r#"hole_radius = { from = "1 mm", to = "9 mm" }"#)]),
            "among the combinations",
        ),
        // Ranges and sampling.
        (
            with("\"100 mm\"", r#"{ from = "1 mm", to = "2 mm" }"#),
            "config.toml:4: joint.hole_radius: this range needs a `count`",
        ),
        (
            with("\"100 mm\"", r#"{ from = "2 mm", to = "1 mm", count = 2 }"#),
            "`\"1 mm\"`: must be above `from`, which is \"2 mm\"",
        ),
        (
            with("\"100 mm\"", r#"{ from = "1 mm", to = "2 mm", count = 0 }"#),
            "joint.hole_radius.count: `0`: must be a whole number from 2",
        ),
        (
            with("\"100 mm\"", r#"{ from = "1 mm", to = "2 mm", number = 2 }"#),
            "joint.hole_radius.number: unknown key",
        ),
        (with("\"0.1 mm\", \"0.2 mm\"]", "\"0.1 mm\", 7]"), "load.indentation: `7`: the unit is missing"),
        (
            with("[\"0.1 mm\", \"0.2 mm\"]", r#"{ from = "0 mm", to = "2 mm", count = 3, spacing = "log" }"#),
            "must be above 0 for spacing",
        ),
        (
            with("[\"0.1 mm\", \"0.2 mm\"]", r#"{ from = "0 mm", to = "2 mm", count = 1000000 }"#),
            "at most 100000 are allowed",
        ),
        (
            with("\"100 mm\"", huge).replace("\"1 mm\"\n", &format!("{huge}\n")),
            "the grid has 1000000 x 1000000 designs",
        ),
        (
            sampled(
                "method = \"zip\"",
                &[
                    (RADIUS, r#"hole_radius = ["9 mm", "8 mm"]"#),
                    (CLEARANCE, r#"radial_clearance = ["1 mm", "2 mm", "3 mm"]"#),
                ],
            ),
            "config.toml:5: joint.radial_clearance: zip needs equal counts: here 3, but 2 in `joint.hole_radius` on line 4",
        ),
        (sampled("method = \"sobol\"", &[from_to]), "config.toml:20: sampling: the key `count` is missing"),
        (
            sampled("method = \"sobol\"\ncount = 0", &[from_to]),
            "sampling.count: `0`: must be a whole number from 1",
        ),
        (sampled("method = \"sobl\"\ncount = 2", &[from_to]), "did you mean `sobol`?"),
        (sampled("count = 9", &[]), "config.toml:21: sampling.count: grid has no count"),
        (sampled(sobol, &[]), "nothing for the sobol sampler to vary"),
        (
            sampled(sobol, &[(CLEARANCE, r#"radial_clearance = { from = "1 mm", to = "2 mm", count = 3 }"#)]),
            "a range of the sobol sampler has no count",
        ),
        (sampled(&format!("{sobol}\nseed = -1"), &[from_to]), "sampling.seed: `-1`"),
        // Text.
        (with("[load]", "[load"), "config.toml:16: not valid TOML"),
        (with("[load]", "[joint.pin]"), "config.toml:16: not valid TOML: duplicate key"),
    ];
    for (config, expected) in cases {
        let refusal = folder.refusal(&config);
        assert!(
            refusal.contains(expected) && refusal.starts_with("config.toml:"),
            "{refusal}\nexpected {expected}\n"
        );
    }
    let refusal = folder.refusal(b"title = \"\"\n# \xff\n");
    assert_eq!(refusal, "config.toml:2: this is not UTF-8 text");
    let refusal = Study::load(&folder.0.join("none.toml")).unwrap_err().to_string();
    assert!(refusal.starts_with("cannot read") && refusal.contains("none.toml"), "{refusal}");
}

#[test]
fn bad_lists_are_refused_by_row_and_column() {
    let folder = Folder::new("bad-list");
    let list = fs::read_to_string("configs/designs-example.csv").unwrap();
    let edit = |old: &str, new: &str| {
        assert!(list.contains(old), "{old}");
        list.replacen(old, new, 1)
    };
    let without_last = |line: &str| line.rsplit_once(',').unwrap().0.to_string();
    for (content, expected) in [
        (
            edit("thickness_mm", "Thickness_mm"),
            "designs.csv:1: Thickness_mm: unknown column; did you mean `thickness_mm`?",
        ),
        (edit("thickness_mm", "force_n"), "designs.csv:1: force_n: the column stands there twice"),
        (list.replace(',', ";"), "columns are separated by commas"),
        (
            // The list without its last column, force_n.
            list.lines().map(without_last).collect::<Vec<_>>().join("\n"),
            "designs.csv:3: indentation_mm: the row needs either this or `force_n`",
        ),
        (
            edit("depth_ratio,", "")
                .replace(",3,4,2.5", ",3,2.5")
                .replace(",,,,,210", ",,,,210")
                .replace("2,,,,,110", "2,,,,110")
                .replace("3,,,,,70", "3,,,,70"),
            "designs.csv:5: depth_ratio: the column is missing; this row needs it",
        ),
        (edit("\n20,0.05", "\n,0.05"), "designs.csv:2: hole_radius_mm: the cell is empty"),
        (edit("\n20,0.05", "\n20 mm,0.05"), "designs.csv:2: hole_radius_mm: `20 mm`: not a number"),
        (
            edit("\n20,0.05", "\n20,inf"),
            "designs.csv:2: radial_clearance_mm: `inf`: the number is not finite",
        ),
        (
            edit("\n20,0.05", "\n20,20"),
            "designs.csv:2: radial_clearance_mm: `20`: must be below the hole radius, 20 mm",
        ),
        (edit("\n20,0.05", "\n20,-1"), "designs.csv:2: radial_clearance_mm: `-1`: must be 0 or more"),
        (
            edit("70000,0.33", "70000,0.5"),
            "designs.csv:3: plate_poissons_ratio: `0.5`: must be above -1 and below 0.5",
        ),
        (
            edit("core,,210000", "cor,,210000"),
            "designs.csv:3: pin_model: `rigid-cor`: not known; did you mean `rigid-core`?",
        ),
        (edit("2.5,base", "2.5,bas"), "designs.csv:5: plate_support: `bas`: not known; did you mean `base`?"),
        (
            edit("annulus,2,", "annulus,2,7"),
            "designs.csv:4: half_width_ratio: `7`: model `annulus` does not use this column",
        ),
        (
            edit("annulus,2,,,,", "annulus,2,,,,base"),
            "designs.csv:4: plate_support: `base`: model `annulus` does not use",
        ),
        (edit(",,5000", ",1,5000"), "designs.csv:3: force_n: `indentation_mm` is given, too"),
        (edit(",,5000", ",5000"), "designs.csv:3: the row has 17 cells, the header has 18"),
        (edit("\n12.7", "\n\n\nbad").replace('\n', "\r\n"), "designs.csv:6: hole_radius_mm: `bad`"),
        (list.lines().next().unwrap().to_string(), "designs.csv: there is no row below the header"),
        (String::new(), "designs.csv: there is no row below the header"),
    ] {
        folder.write("designs.csv", content);
        let refusal = folder.refusal("[designs]\nfile = \"designs.csv\"\n");
        assert!(
            refusal.starts_with(expected)
                || refusal.contains(&format!(" {expected}"))
                || expected.starts_with("columns") && refusal.contains(expected),
            "{refusal}\nexpected {expected}\n"
        );
    }
    let refusal = folder.refusal("[designs]\nfile = \"other.csv\"\n");
    assert!(
        refusal.starts_with("config.toml:2: designs.file: `\"other.csv\"`: there is no file"),
        "{refusal}"
    );
}

/// Whatever stands in the files, there is a study or an error, never a panic; and what is accepted can be run.
#[test]
fn garbage_is_refused_without_panic() {
    let folder = Folder::new("garbage");
    let mut state = 1u64;
    let mut random = |below: usize| {
        // Knuth's MMIX generator; its high bits are good enough to spoil a text.
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % below
    };
    let list = fs::read("configs/designs-example.csv").unwrap();
    let range = |count| (RADIUS, format!("hole_radius = {{ from = \"2 mm\", to = \"1 m\"{count} }}"));
    let (counted, open) = (range(", count = 3"), range(""));
    let bases = [
        sampled("method = \"grid\"", &[(counted.0, &counted.1)]),
        sampled("method = \"zip\"", &[(counted.0, &counted.1)]),
        sampled("method = \"latin-hypercube\"\ncount = 5", &[(open.0, &open.1)]),
        sampled("method = \"sobol\"\ncount = 5", &[(open.0, &open.1)]),
    ];
    let pieces: [&[u8]; 16] = [
        b"\"",
        b"[",
        b"]",
        b"{ from = ",
        b"}",
        b",",
        b"\n",
        b"=",
        b"nan",
        b"1e999",
        b"-",
        b"9999999999999999999",
        "\u{b5}".as_bytes(),
        b"\xff",
        b"%",
        b"[[joint]]\n",
    ];
    let mut accepted = 0;
    for round in 0..1500 {
        let as_list = round % 3 == 0;
        let mut text = if as_list { list.clone() } else { bases[round % 4].clone().into_bytes() };
        if round % 50 == 1 {
            text = (0..random(400)).map(|_| random(256) as u8).collect();
        }
        for _ in 0..1 + random(4) {
            let at = random(text.len() + 1);
            let end = (at + random(12)).min(text.len());
            let piece = pieces[random(pieces.len())];
            match random(5) {
                0 | 1 => {
                    // Another digit in the place of one: often still a valid study.
                    if let Some(digit) = text.iter_mut().skip(at).find(|byte| byte.is_ascii_digit()) {
                        *digit = b'0' + random(10) as u8;
                    }
                }
                2 => drop(text.drain(at..end)),
                3 => drop(text.splice(at..at, piece.iter().copied())),
                _ => drop(text.splice(at..end, piece.iter().copied())),
            }
        }
        let config = if as_list { b"[designs]\nfile = \"designs.csv\"".to_vec() } else { text.clone() };
        folder.write("designs.csv", &text);
        if let Ok(study) = Study::load(&folder.write("config.toml", config)) {
            accepted += 1;
            for case in study.cases().unwrap().take(100) {
                let joint = case.unwrap().joint;
                assert!(joint.radial_clearance < joint.hole_radius && joint.thickness > 0.0);
            }
        }
    }
    // If nearly all were refused, this would test the parser only.
    assert!(accepted > 30, "{accepted}");
}
