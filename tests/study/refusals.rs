//! Bad configs: refused by line, key and value; and garbage of any kind.

use std::fs;

use jointsweep::internals::study::config::Study;

use crate::{CLEARANCE, Folder, RADIUS, sampled, with};

#[test]
fn bad_configs_are_refused_by_line_and_key() {
    let folder = Folder::new("bad");
    // `old` becomes `new` in the base config.
    #[rustfmt::skip]
    let edits = [
        // Keys.
        // The first in the file is named, not the first in the alphabet.
        ("title = \"Test\"", "zitle = 1\nabc = 2", ":1: zitle: unknown key; did you mean `title`?"),
        ("thickness ", "thicknes ", ":6: joint.thicknes: unknown key; did you mean `thickness`?"),
        ("[solve]", "[slove]", ":18: slove: unknown key; did you mean `solve`?"),
        ("[solve]\n", "[solve]\nmesh = 3\n", ":19: solve.mesh: unknown key; allowed: `accuracy`"),
        ("hole_radius ", "# ", ":2: joint: the key `hole_radius` is missing"),
        ("radial_clearance ", "# ", ":2: joint: the key `radial_clearance` (or `diametral_clearance`, or `fit`) is missing"),
        ("[joint]\n", "[joint]\ndiametral_clearance = '1 mm'\n", ":3: joint.diametral_clearance: `radial_clearance` is"),
        ("outer_radius_ratio ", "# ", ":11: joint.plate: the key `outer_radius_ratio` is missing"),
        ("[load]\n", "[load]\nforce = '1 N'\n", ":17: load.force: `indentation` is given, too"),
        ("indentation ", "# ", ":16: load: one of `indentation`, `offset` and `force` is needed"),
        ("[load]", "[designs]\nfile = 'x.csv'\n[load]", ":2: joint: has no place beside [designs]"),
        // What the table has.
        ("[load]", "[output]\ncolumns = ['abc']\n[load]", ":17: output.columns: `'abc'`: not a column; allowed: `design`, `hole_radius_mm`, "),
        ("[load]", "[output]\ncolumns = ['abc']\n[load]", "`status`; of `layer2` to `layer8` as of `layer1`"),
        ("[load]", "[output]\ncolumns = ['design', 'force']\n[load]", ":17: output.columns: `'force'`: not a column; did you mean `force_n`?"),
        ("[load]", "[output]\ncolumns = [\n  'design',\n  'force_n',\n  'design',\n]\n[load]", ":20: output.columns: `'design'`: the column is named twice"),
        ("[load]", "[output]\ncolumns = 'design'\n[load]", ":17: output.columns: `'design'`: a list of the table's columns is needed here, not a string"),
        ("[load]", "[output]\ncolumns = []\n[load]", ":17: output.columns: the list is empty"),
        ("[load]", "[output]\ncolumns = [3]\n[load]", ":17: output.columns: `3`: a string is needed here, not a whole number"),
        ("[load]", "[output]\ninputs = 'varying'\ncolumns = ['thickness_mm']\n[load]", ":18: output.columns: no column is left"),
        ("[load]", "[output]\ninputs = 'some'\n[load]", ":17: output.inputs: `'some'`: not known; allowed: `all`, `varying`"),
        ("[load]", "[output]\nformat = 'csv.zs'\n[load]", ":17: output.format: `'csv.zs'`: not known; did you mean `csv.zst`?"),
        // Words.
        ("plane-stress", "plane-stres", ":3: joint.idealization: `\"plane-stres\"`: not known; did you mean"),
        ("annulus", "rigid-core", ":12: joint.plate.model: `\"rigid-core\"`: not known; allowed: `annulus`, `block`"),
        ("rigid-core", "rigid-midplane\"\ncore_radius_ratio = 0.2 #", ":9: joint.pin.core_radius_ratio: model `rigid-mid"),
        ("rigid-core\"", "rigid-core\"\nsupport = 'base'", ":9: joint.pin.support: unknown key"),
        ("annulus\"", "annulus\"\nsupport = 'base'", ":13: joint.plate.support: model `annulus` does not have this key"),
        // Units and types.
        ("\"100 mm\"", "100", ":4: joint.hole_radius: `100`: the unit is missing; write it like \"100 mm\""),
        ("\"100 mm\"", "\"100\"", ":4: joint.hole_radius: `\"100\"`: the unit is missing"),
        ("100 mm", "100 MPa", ":4: joint.hole_radius: `\"100 MPa\"`: `MPa` is a unit of stress, a length is needed"),
        ("\"100 mm\"", "true", "`true`: a string with a number and a unit is needed here, not true or false"),
        ("\"0.1 mm\", \"0.2 mm\"", "\"0.1 mm\", 7", ":17: load.indentation: `7`: the unit is missing"),
        ("= 2.0", "= '2'", ":13: joint.plate.outer_radius_ratio: `'2'`: a plain number is needed here, not a string"),
        ("\"1 %\"", "\"1\"", ":19: solve.accuracy: `\"1\"`: a fraction is written like \"1 %\""),
        // Values.
        ("100 mm", "0 mm", ":4: joint.hole_radius: `\"0 mm\"`: must be above 0"),
        ("\"100 mm\"", "[\"1 mm\",\n\"-1 mm\"]", ":5: joint.hole_radius: `\"-1 mm\"`: must be above 0"),
        ("100 mm", "nan mm", ":4: joint.hole_radius: `\"nan mm\"`: the number is not finite"),
        ("\"100 mm\"", "[]", ":4: joint.hole_radius: the list is empty"),
        ("\"1 mm\"", "'0 mm'", ":6: joint.thickness: `'0 mm'`: must be above 0"),
        ("= 2.0", "= 1", ":13: joint.plate.outer_radius_ratio: `1`: must be above 1"),
        ("= 2.0", "= inf", ":13: joint.plate.outer_radius_ratio: `inf`: the number is not finite"),
        ("rigid-core\"", "rigid-core\"\ncore_radius_ratio = 1.0", "`1.0`: must be above 0 and below 1"),
        ("poissons_ratio = 0.3", "poissons_ratio = [0.3, 0.5]", "`0.5`: must be above -1 and below 0.5"),
        ("poissons_ratio     = 0.3", "poissons_ratio = nan", ":15: joint.plate.poissons_ratio: `nan`: the number is not"),
        ("youngs_modulus = \"200 GPa\"", "youngs_modulus = \"-1 GPa\"", "`\"-1 GPa\"`: must be above 0"),
        ("[\"0.1 mm\", \"0.2 mm\"]", "'-1 um'", ":17: load.indentation: `'-1 um'`: must be 0 or more"),
        ("\"1 %\"", "0", ":19: solve.accuracy: `0`: must be above 0 and below 1 (100 %)"),
        ("1 %", "100 %", ":19: solve.accuracy: `\"100 %\"`: must be above 0 and below 1"),
        ("\"0.1 mm\"\n", "\"100 mm\"\n", ":5: joint.radial_clearance: a radial clearance of 100 mm meets a hole radius of \
                                         100 mm (line 4)"),
        ("radial_clearance = \"0.1 mm\"", "diametral_clearance = ['1 mm', '20 cm']", ":5: joint.diametral_clearance: among \
                                         the combinations of this sweep, a radial clearance of 100 mm meets"),
        // Ranges.
        ("\"100 mm\"", "{ from = '1 mm', to = '2 mm' }", ":4: joint.hole_radius: this range needs a `count`"),
        ("\"100 mm\"", "{ from = '2 mm', to = '1 mm', count = 2 }", "`'1 mm'`: must be above `from`, which is '2 mm'"),
        ("\"100 mm\"", "{ from = '1 mm', to = '2 mm', count = 0 }", ":4: joint.hole_radius.count: `0`: must be a whole"),
        ("\"100 mm\"", "{ from = '1 mm', to = '2 mm', cont = 2 }", ":4: joint.hole_radius.cont: unknown key; did you mean"),
        ("[\"0.1 mm\", \"0.2 mm\"]", "{ from = '0 mm', to = '2 mm', count = 3, spacing = 'log' }", "must be above 0 for spac"),
        ("[\"0.1 mm\", \"0.2 mm\"]", "{ from = '0 mm', to = '2 mm', count = 1000000 }", "at most 100000 are allowed"),
        // Sampling.
        ("[load]", "[sampling]\nmethod = 'sobol'\n[load]", ":16: sampling: the key `count` is missing"),
        ("[load]", "[sampling]\nmethod = 'sobol'\ncount = 0\n[load]", ":18: sampling.count: `0`: must be a whole number"),
        ("[load]", "[sampling]\nmethod = 'sobol'\ncount = 8\n[load]", ":2: joint: nothing for the sobol sampler to vary"),
        ("[load]", "[sampling]\nmethod = 'sobl'\n[load]", "did you mean `sobol`?"),
        ("[load]", "[sampling]\nmethod = 'sobol'\ncount = 8\nseed = -1\n[load]", ":19: sampling.seed: `-1`: must be"),
        ("[load]", "[sampling]\ncount = 9\n[load]", ":17: sampling.count: grid has no count"),
        // Text.
        ("[load]", "[load", ":16: not valid TOML"),
        ("[load]", "[joint.pin]", ":16: not valid TOML: duplicate key"),
    ];
    for (old, new, expected) in edits {
        let refusal = folder.refusal(with(old, new));
        assert!(
            refusal.starts_with("config.toml:") && refusal.contains(expected),
            "{refusal}\nnot {expected}"
        );
    }
    // What is missing is missing at the end.
    assert!(
        folder
            .refusal("title = 'x'\n# that is all\n\n")
            .starts_with("config.toml:2: the table [joint] is missing")
    );
    assert!(folder.refusal("").starts_with("config.toml:1: the table [joint] is missing"));
    let deep = format!("title = {}1{}", "[".repeat(10_000), "]".repeat(10_000));
    assert_eq!(folder.refusal(deep), "config.toml:1: not valid TOML: lists or tables are nested too deep");
    let long = folder.refusal(format!("{} = 1", "x".repeat(1_000_000)));
    assert!(long.contains("xxx...: unknown key") && long.len() < 300, "{long}");
    assert!(folder.refusal("#".repeat(20_000_000)).contains("this is no config: it has more than 16 MB"));
    assert_eq!(folder.refusal(b"title = ''\n# \xff\n"), "config.toml:2: this is not UTF-8 text");
    let refusal = Study::load(&folder.0.join("none.toml")).unwrap_err().to_string();
    assert!(refusal.starts_with("cannot read") && refusal.contains("none.toml"), "{refusal}");
}

/// What is wrong only in the combination of several values.
#[test]
fn bad_combinations_are_refused() {
    let folder = Folder::new("combinations");
    let sobol = "method = 'sobol'\ncount = 8";
    let lines = |radius: &'static str, clearance: &'static str| [(RADIUS, radius), (CLEARANCE, clearance)];
    #[rustfmt::skip]
    let cases = [
        (sobol, lines("hole_radius = { from = '1 mm', to = '9 mm' }", "radial_clearance = { from = '0 mm', to = '1 mm' }"),
            ":5: joint.radial_clearance: among the combinations of this sweep, a radial clearance of 1 mm meets"),
        (sobol, lines(RADIUS, "radial_clearance = { from = '1 mm', to = '2 mm', count = 3 }"),
            ":5: joint.radial_clearance.count: `3`: a range of the sobol sampler has no count"),
        ("method = 'zip'", lines("hole_radius = ['9 mm', '8 mm']", "radial_clearance = ['1 mm', '2 mm', '3 mm']"),
            ":5: joint.radial_clearance: zip needs equal counts: here 3, but 2 in `joint.hole_radius` on line 4"),
        ("method = 'zip'", lines("hole_radius = ['9 mm', '8 mm']", "radial_clearance = ['1 mm', '8 mm']"),
            ":5: joint.radial_clearance: among the combinations of this sweep, a radial clearance of 8 mm meets"),
        ("", lines("hole_radius = { from = '1 m', to = '2 m', count = 1_000_000 }",
                   "radial_clearance = { from = '1 mm', to = '2 mm', count = 1_000_000 }"),
            ":4: joint.hole_radius: the grid has 1000000 x 1000000 designs; at most 1000000000 are allowed"),
    ];
    for (sampling, lines, expected) in cases {
        let refusal = folder.refusal(sampled(sampling, &lines));
        assert!(
            refusal.starts_with("config.toml:") && refusal.contains(expected),
            "{refusal}\nnot {expected}"
        );
    }
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
    for round in 0..1000 {
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
