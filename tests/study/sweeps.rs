//! Sweeps: which designs there are, in which order.

use std::fs;
use std::path::Path;

use jointsweep::internals::study::config::{Asked, MethodChoice, Study};
use jointsweep::internals::study::design::{DesignCase, Load};

use crate::{BASE, CLEARANCE, Folder, IDEALIZATION, RADIUS, all, row, sampled, with};

#[test]
fn shipped_configs_load() {
    let configs = Path::new(env!("CARGO_MANIFEST_DIR")).join("configs");
    let mut loaded: Vec<&str> = Vec::new();
    for (name, designs, steps) in [
        ("bush", 24, 240),
        ("coating", 6, 72),
        ("designs-example", 5, 5),
        ("hypercube", 100_000, 1_000_000),
        ("hypercube-block", 100_000, 1_000_000),
        ("lined-block", 12, 120),
        ("liu2007", 14, 140),
        ("liu2007-plates", 70, 700),
        ("press-fit", 4, 164),
        ("press-fit-lug", 6, 198),
        ("quickstart", 10, 100),
        ("random", 10_000, 100_000),
        ("requirements", 10_000, 10_000),
        ("thin-liners", 200, 2000),
        ("thin-walls", 32, 96),
    ] {
        loaded.push(name);
        let path = configs.join(format!("{name}.toml"));
        let study = Study::load(&path).unwrap();
        assert_eq!((study.design_count(), study.step_count()), (designs, steps), "{name}");
        let last = study.cases().unwrap().last().unwrap().unwrap();
        assert_eq!((last.index, last.steps.len() as u64), (designs - 1, steps / designs), "{name}");
        assert_eq!(study.source_text(), fs::read_to_string(&path).unwrap());
        assert_eq!(study.name(), name);
        assert_eq!(study.designs_file().is_some(), name == "designs-example");
    }
    let files = fs::read_dir(&configs).unwrap().map(|entry| entry.unwrap().path());
    let mut shipped: Vec<String> = files
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_string())
        .collect();
    shipped.sort();
    assert_eq!(shipped, loaded);
    let study = Study::load(&configs.join("liu2007.toml")).unwrap();
    assert_eq!(study.title(), "Liu, Zhang & Yang (2007)");
    assert_eq!((study.solve.accuracy, study.solve.method), (0.001, MethodChoice::Auto));
    let last = &all(&study)[13];
    assert_eq!(last.joint.radial_clearance, 0.1);
    let expected: Vec<Load> = (1..=10).map(|step| Load::Indentation(step as f64 / 50.0)).collect();
    assert_eq!(last.steps, expected.into());
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

/// Designs are the same to the bit, whether one walks to them, which draws many at a time, or skips to each; wherever one begins to walk.
#[test]
fn designs_do_not_depend_on_the_way_to_them() {
    let folder = Folder::new("ways");
    let counted = [
        (RADIUS, r#"hole_radius = { from = "1 mm", to = "1 m", count = 37, spacing = "log" }"#),
        (CLEARANCE, r#"radial_clearance = { from = "1 um", to = "0.1 mm", count = 37 }"#),
        (r#"thickness        = "1 mm""#, r#"thickness = ["7 mm"]"#),
    ];
    let drawn = [
        (IDEALIZATION, r#"idealization = ["plane-stress", "plane-strain"]"#),
        (RADIUS, r#"hole_radius = { from = "1 mm", to = "1 m", spacing = "log" }"#),
        (CLEARANCE, r#"radial_clearance = { from = "1 um", to = "0.1 mm" }"#),
    ];
    for (sampling, lines, count) in [
        ("method = \"grid\"", counted, 37 * 37),
        ("method = \"zip\"", counted, 37),
        ("method = \"latin-hypercube\"\ncount = 101\nseed = 5", drawn, 101),
        ("method = \"sobol\"\ncount = 101\nseed = 5", drawn, 101),
    ] {
        let study = folder.study(&sampled(sampling, &lines));
        let walked = all(&study);
        assert!(walked.iter().map(|case| case.index).eq(0..count), "{sampling}");
        for start in (0..count).step_by(7) {
            let mut cases = study.cases().unwrap();
            let first = cases.nth(start as usize).unwrap().unwrap();
            assert_eq!((first.index, row(&first)), (start, row(&walked[start as usize])), "{sampling}");
            for (found, expected) in cases.by_ref().zip(&walked[start as usize + 1..]).take(40) {
                let found = found.unwrap();
                assert_eq!((found.index, row(&found)), (expected.index, row(expected)), "{sampling}");
            }
        }
        let every_third = study.cases_at((0..count).step_by(3)).unwrap();
        assert!(every_third.map(|case| row(&case.unwrap())).eq(walked.iter().step_by(3).map(row)));
        assert!(study.cases().unwrap().nth(count as usize).is_none());
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

/// What one value gives all pins or all plates have in common, whoever reads the config; lists, ranges, layers and files of designs have nothing
/// in common.
#[test]
fn what_one_value_gives_is_in_common() {
    let folder = Folder::new("common");
    let given = |config: &str| {
        let common = folder.study(config).in_common();
        assert_eq!(Asked::from_text(Path::new("config.toml"), config).unwrap().in_common, common, "{config}");
        [common.pins, common.plates].map(|own| (own.poissons_ratio, own.outline))
    };
    let with = |from: &str, to: &str| {
        assert!(BASE.contains(from));
        given(&BASE.replacen(from, to, 1))
    };
    let pin = "poissons_ratio = 0.3\n[joint.plate]";
    assert_eq!(given(BASE), [(true, true); 2]);
    for several in ["[0.3, 0.31]", "{ from = 0.1, to = 0.3, count = 2 }"] {
        let drawn = format!("poissons_ratio = {several}\n[joint.plate]");
        assert_eq!(with(pin, &drawn), [(false, true), (true, true)], "{several}");
    }
    let widths = "outer_radius_ratio = [2.0, 3.0]";
    assert_eq!(with("outer_radius_ratio = 2.0", widths), [(true, true), (true, false)]);
    let layer = "[[joint.plate.layers]]\nthickness = \"1 mm\"\nyoungs_modulus = \"1 GPa\"\npoissons_ratio = 0.3\n[load]";
    assert_eq!(with("[load]", layer), [(true, true), (false, true)]);
    let drawn =
        BASE.replacen("= 2.0", "= { from = 2, to = 3 }", 1) + "[sampling]\nmethod = \"sobol\"\ncount = 5\n";
    assert_eq!(given(&drawn), [(true, true), (true, false)]);
    let other = folder.study(&drawn).for_sensitivity(8, 1, None).unwrap().in_common();
    assert_eq!(other, folder.study(&drawn).in_common());

    folder.write("designs.csv", fs::read_to_string("configs/designs-example.csv").unwrap());
    assert_eq!(given("[designs]\nfile = \"designs.csv\"\n"), [(false, false); 2]);
}
