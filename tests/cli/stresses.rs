//! `jointsweep stresses`, and what a yield stress is for.

use crate::common::ring_joint::ring_joint;
use crate::common::workdir::Workdir;

use super::SMALL;
use super::commands::half_pins;

/// Two press fits, of which the first is four times as tight, with layers in the plate.
fn fits() -> String {
    let config = ring_joint("[\"-0.04 mm\", \"-0.01 mm\"]", "[\"0 mm\", \"0.01 mm\"]")
        .replace("indentation", "offset");
    let layers = "[[joint.plate.layers]]\nthickness = \"1 mm\"\nyoungs_modulus = \"100 GPa\"\npoissons_ratio = 0.3\n\
                  yield_stress = \"200 MPa\"\n[load]";
    config.replace("[load]", layers)
}

fn numbers(work: &Workdir, table: &str, column: &str) -> Vec<f64> {
    work.table(table).column(column).iter().map(|cell| cell.parse().unwrap()).collect()
}

/// The share of the yield stress that is told at rest is above 1 where rows of the table say so.
#[test]
fn press_fits_that_yield_at_rest_say_so() {
    let work = Workdir::new("stresses-yield");
    work.write("fits.toml", &fits());
    work.run(&["run", "fits.toml"]).expect(0);
    let statuses = work.table("out/fits/table.csv");
    assert_eq!(statuses.column("status"), ["yields at rest", "yields at rest", "ok", "ok"]);
    let told = work
        .run(&["stresses", "fits.toml", "--design", "0", "--design", "1", "--out", "stresses.csv"])
        .expect(0);
    assert!(told.stderr.contains("design 0, step 0 (offset 0 mm): up to 2."), "{}", told.stderr);
    assert!(told.stderr.contains("of the yield stress, plate layer 1 at 10 mm"), "{}", told.stderr);
    assert!(told.stderr.contains("design 1, step 0 (offset 0 mm): up to 0."), "{}", told.stderr);
    let table = work.table("stresses.csv");
    // A pin's two circles, a plate's four, at 91 points, of two steps and two designs.
    assert_eq!(table.column("design").len(), 6 * 91 * 2 * 2);
    let (layers, shares, von_mises) =
        (table.column("layer"), table.column("yield_share"), numbers(&work, "stresses.csv", "von_mises_mpa"));
    let mut greatest = [0.0_f64; 2];
    for (place, (layer, share)) in layers.iter().zip(&shares).enumerate() {
        assert_eq!(*layer == "1", !share.is_empty(), "line {place}");
        if *layer == "1" {
            let share: f64 = share.parse().unwrap();
            assert!((share * 200.0 / von_mises[place] - 1.0).abs() < 1e-6);
            if table.column("step")[place] == "0" {
                let greatest = &mut greatest[table.column("design")[place].parse::<usize>().unwrap()];
                *greatest = greatest.max(share);
            }
        }
    }
    assert!(
        greatest[0] > 1.0 && greatest[1] < 1.0 && (greatest[0] / greatest[1] - 4.0).abs() < 1e-6,
        "{greatest:?}"
    );
    // Just above what the looser one bears.
    let most = |share: f64| format!("yield_stress = \"{} MPa\"", 200.0 * greatest[1] * share);
    for (share, status) in [(1.001, "ok"), (0.999, "yields at rest")] {
        work.write("near.toml", &fits().replace("yield_stress = \"200 MPa\"", &most(share)));
        work.run(&["run", "near.toml", "--force"]).expect(0);
        assert_eq!(work.table("out/near/table.csv").column("status")[2], status);
    }
}

/// Of half pins and blocks, too; depths are circles more.
#[test]
fn stresses_are_of_all_bodies() {
    let work = Workdir::new("stresses-shapes");
    work.write("half.toml", &half_pins(&SMALL));
    work.run(&["stresses", "half.toml", "--design", "0", "--points", "5", "--out", "all.csv"]).expect(0);
    let table = work.table("all.csv");
    let parts = [["pin"; 3 * 5].as_slice(), &["plate"; 3 * 2 * 5]];
    let mut expected = parts.concat();
    expected.sort_unstable();
    let mut found = table.column("part");
    found.sort_unstable();
    assert_eq!(found, expected);
    let deep = ["--depth", "0.1 mm", "--depth", "200 um", "--depth", "5 m"];
    let all = [&["stresses", "half.toml", "--design", "0", "--points", "5", "--out", "deep.csv"][..], &deep]
        .concat();
    let told = work.run(&all).expect(0).stderr;
    let missing: Vec<&str> = told.lines().filter(|line| line.contains("neither part")).collect();
    assert_eq!(missing, ["design 0: neither part is 5000 mm deep below the contact"]);
    let radii = numbers(&work, "deep.csv", "radius_mm");
    let deep = work.table("deep.csv");
    let of = |part: &str| -> Vec<f64> {
        let own = radii.iter().zip(deep.column("part")).filter(|(_, own)| *own == part);
        own.map(|(radius, _)| *radius).step_by(5).collect()
    };
    // The last depth is outside of both. Circles of a half pin end with its depths, those of a plate where it is held.
    let (pin, plate) = (of("pin"), of("plate"));
    assert_eq!((pin.len(), plate.len()), (3 * 3, 3 * 4));
    assert_eq!(plate[..3], [10.0, 10.1, 10.2]);
    assert!((pin[0] - pin[1] - 0.1).abs() < 1e-9 && (pin[0] - pin[2] - 0.2).abs() < 1e-9, "{pin:?}");
    let block = "model = \"block\"\nhalf_width_ratio = 2.0\ndepth_ratio = 2.0\nheight_ratio = 2.0";
    let text = half_pins(&SMALL).replace("model = \"annulus\"", block);
    work.write(
        "block.toml",
        &text.lines().filter(|line| !line.starts_with("outer_radius")).collect::<Vec<_>>().join("\n"),
    );
    work.run(&["stresses", "block.toml", "--design", "0", "--points", "5", "--out", "block.csv"]).expect(0);
    // At the hole alone.
    let in_block = work.table("block.csv").column("part").iter().filter(|part| **part == "plate").count();
    assert_eq!(in_block, 3 * 5);
    let many: Vec<String> = (1..=9).map(|depth| format!("{depth} um")).collect();
    let many: Vec<&str> = many.iter().flat_map(|depth| ["--depth", depth]).collect();
    let said = work.run(&[&["stresses", "block.toml", "--design", "0"][..], &many].concat()).expect(2).stderr;
    assert!(said.contains("plate: `block`: 9 interfaces and depths; a mesh takes 8 at most"), "{said}");
    for (depth, problem) in [("0 mm", "must be above 0"), ("3", "mm"), ("3 MPa", "mm")] {
        let said = work.run(&["stresses", "half.toml", "--design", "0", "--depth", depth]).expect(1).stderr;
        assert!(said.contains("--depth") && said.contains(problem), "{said}");
    }
}

/// A press fit at rest has the same stress all around: the load line is named, not where rounding is greatest.
#[test]
fn of_equal_stresses_the_one_at_the_load_line_is_named() {
    let work = Workdir::new("stresses-uniform");
    let config = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/press-fit.toml");
    let mut designs = 0;
    for design in ["0", "1", "2", "3"] {
        let told = work.run(&["stresses", config, "--design", design, "--out", "s.csv", "--force"]).expect(0);
        let at_rest = told.stderr.lines().find(|line| line.contains("step 0 (offset 0 mm)")).unwrap();
        assert!(at_rest.ends_with("plate at 10 mm, 0 deg"), "{at_rest}");
        designs += 1;
    }
    assert_eq!(designs, 4);
}

/// Rows of press fits heed yield stresses between concentric bodies alone, and runs say so by their keys.
#[test]
fn a_yield_stress_without_effect_is_warned_of() {
    let work = Workdir::new("stresses-useless");
    let block = "model = \"block\"\nhalf_width_ratio = 2.0\ndepth_ratio = 2.0\nheight_ratio = 2.0\nyield_stress = \"90 MPa\"";
    let in_block = |text: &str| {
        let text = text.replace("model = \"annulus\"", block).replace("method = \"series\"", "");
        text.lines().filter(|line| !line.starts_with("outer_radius")).collect::<Vec<_>>().join("\n")
    };
    let of_pin = |text: &str| text.replace("[joint.plate]", "yield_stress = \"300 MPa\"\n[joint.plate]");
    let plate = "joint.plate.yield_stress, joint.plate.layers.1.yield_stress: has no effect on the status of press fits, because \
                 their stresses at rest are known between concentric bodies only, not with a block";
    let both = format!("joint.pin.yield_stress, {plate}");
    let clearance = |text: String| text.replace("[\"-0.04 mm\", \"-0.01 mm\"]", "\"0.005 mm\"");
    let cases = [
        (in_block(&fits()), vec![plate]),
        (in_block(&of_pin(&fits())), vec![&both]),
        (in_block(&clearance(of_pin(&fits()))), vec![]),
        (of_pin(&half_pins(&SMALL)), vec![]),
        (of_pin(&fits()), vec![]),
    ];
    for (text, wanted) in cases {
        work.write("useless.toml", &text);
        for command in [&["run", "useless.toml", "--dry-run"][..], &["explain", "useless.toml"]] {
            let told = work.run(command).expect(0).stderr;
            let warnings: Vec<&str> =
                told.lines().filter_map(|line| line.strip_prefix("warning: ")).collect();
            assert_eq!(warnings.len(), wanted.len(), "{told}");
            assert!(warnings.iter().zip(&wanted).all(|(own, wanted)| own.starts_with(wanted)), "{told}");
        }
    }
}

#[test]
fn a_yield_stress_is_one_value() {
    let work = Workdir::new("stresses-key");
    for (given, problem) in [
        ("[\"200 MPa\", \"300 MPa\"]", "one value; a yield stress changes no answer and does not sweep"),
        ("{ from = \"1 MPa\", to = \"2 MPa\", count = 3 }", "one value"),
        ("\"0 MPa\"", "must be above 0"),
        ("\"200 mm\"", "MPa"),
    ] {
        work.write(
            "bad.toml",
            &fits().replace("yield_stress = \"200 MPa\"", &format!("yield_stress = {given}")),
        );
        let said = work.run(&["run", "bad.toml"]).expect(1).stderr;
        assert!(said.contains("yield_stress") && said.contains(problem), "{said}");
    }
}
