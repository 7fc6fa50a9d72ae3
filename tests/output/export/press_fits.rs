//! Tables of press fits: over the offset, as those of a joint without clearance.

use super::readers::{self, akima, linear};
use super::{ERROR, curve, numbers, run_in, solved};
use crate::common::workdir::Workdir;
use jointsweep::{Curve, Load};

/// Largest offset of the config, mm.
const END: f64 = 0.0291;

/// Closed at the smaller two offsets, open at the largest.
const OVERLAP: f64 = 0.01;

fn fit(name: &str) -> (Workdir, Curve) {
    let work = solved(name, "\"0.02 mm\"", "3");
    let config =
        work.read("sweep.toml").replace("\"0.02 mm\"", "\"-0.01 mm\"").replace("indentation", "offset");
    work.write("fit.toml", &config.replace("[\"0.0004 mm\"", "[\"0 mm\", \"0.0004 mm\""));
    work.run(&["run", "fit.toml", "--quiet"]).expect(0);
    let curve = curve(-OVERLAP);
    assert_eq!(curve.at(Load::Offset(0.004)).unwrap().contact_half_angle, Some(std::f64::consts::PI));
    assert!(curve.at(Load::Offset(END)).unwrap().contact_half_angle.unwrap() < 2.8);
    (work, curve)
}

/// Spread evenly and by decades.
fn places() -> Vec<f64> {
    let even = (1..200).map(|i| END * f64::from(i) / 200.0);
    even.chain((0..50).map(|i| END * 10_f64.powf(-0.1 * f64::from(i)))).collect()
}

#[test]
fn tables_of_press_fits_follow_their_curves_over_the_offset() {
    let (work, curve) = fit("export-fit");
    type Read = fn(&str) -> Vec<(f64, f64)>;
    type Rule = fn(&[(f64, f64)], f64) -> f64;
    let cases: [(&str, &str, Read, Rule); 3] = [
        ("csv", "t.csv", readers::csv, linear),
        ("recurdyn", "t.csv", readers::two_columns, akima),
        ("calculix", "t.inp", readers::calculix, linear),
    ];
    for (format, file, read, rule) in cases {
        work.run(&["export", "out/fit", "--to", format, "--out", file, "--force"]).expect(0);
        let text = work.read(file);
        let pairs = read(&text);
        assert!(
            pairs.len() > 5 && (pairs[pairs.len() - 1].0 / END - 1.0).abs() < 1e-8,
            "{format}: {pairs:?}"
        );
        for offset in places() {
            let truth = curve.at(Load::Offset(offset)).unwrap().force;
            let found = rule(&pairs, offset);
            assert!((found / truth - 1.0).abs() < ERROR, "{format}, {offset} mm: {found} N for {truth} N");
        }
        assert!(pairs.len() < 40, "{format}: {} points", pairs.len());
        let about = if file.ends_with("csv") { work.read("t_about.txt") } else { text };
        let joined = about.replace(['\n', '!', '*', '$', '#', '%'], " ");
        let joined = joined.split_whitespace().collect::<Vec<_>>().join(" ");
        for said in [
            "Pin pressed into a hole: force against offset",
            "radial_clearance -0.01 mm",
            "here the radial clearance is 0",
            "from where pin and hole are concentric",
        ] {
            assert!(joined.contains(said), "{format} does not say {said}: {joined}");
        }
        assert!(
            !joined.contains("after first touch") && !joined.contains("in the gap"),
            "{format}: {joined}"
        );
    }
}

/// The module's distance is the offset: its clearance is 0. The first row of the result is at rest.
#[test]
#[cfg_attr(not(python3), ignore = "no python3 here")]
fn modules_of_press_fits_have_no_clearance() {
    let (work, curve) = fit("export-fit-python");
    for reference in ["support", "ring-mean"] {
        let to =
            ["export", "out/fit", "--to", "exudyn", "--reference", reference, "--out", "fit.py", "--force"];
        work.run(&to).expect(0);
        work.write("main.py", "import fit\nprint(fit.RADIAL_CLEARANCE_MM, fit.force(0.02), fit.stiffness(0.02), fit.force(0.002))\n");
        let found = numbers(&run_in(&work, "python3", &["-B", "main.py"])).remove(0);
        let truth = [0.02, 0.002].map(|offset| curve.at(Load::Offset(offset)).unwrap());
        assert_eq!(found[0], 0.0);
        if reference == "support" {
            assert!((found[1] / truth[0].force - 1.0).abs() < ERROR, "{found:?}");
            assert!((found[2] / truth[0].tangent_stiffness - 1.0).abs() < 3.0 * ERROR, "{found:?}");
            assert!((found[3] / truth[1].force - 1.0).abs() < ERROR, "{found:?}");
        } else {
            // Less yields: the rings' own motion is taken out.
            assert!(found[1] > 1.02 * truth[0].force && found[3] > 1.02 * truth[1].force, "{found:?}");
        }
    }
}

#[test]
fn what_press_fits_have_no_table_for_is_refused() {
    let (work, _) = fit("export-fit-refused");
    let said = work
        .run(&["export", "out/fit", "--to", "c", "--restitution", "0.8", "--speed", "100 mm/s"])
        .expect(1)
        .stderr;
    assert!(said.contains("restitution: a press fit is never out of contact"), "{said}");
    let both = work.read("fit.toml").replace("\"-0.01 mm\"", "[\"-0.01 mm\", \"0.02 mm\"]");
    work.write("both.toml", &both);
    work.run(&["run", "both.toml", "--quiet"]).expect(0);
    let over = ["export", "out/both", "--to", "c", "--over", "radial_clearance", "--out", "both.h"];
    let said = work.run(&over).expect(1).stderr;
    assert!(
        said.contains("over radial_clearance: design 0 is a press fit, whose table is over the offset"),
        "{said}"
    );
    assert!(!work.path("both.h").exists());
    work.run(&["export", "out/both", "--to", "c", "--design", "0"]).expect(0);
    work.run(&["export", "out/both", "--to", "c", "--design", "1", "--force"]).expect(0);
    // Nothing of an offset above 0.
    work.write(
        "rest.toml",
        &work.read("fit.toml").replace("[\"0 mm\", \"0.0004 mm\", \"0.004 mm\", \"0.0291 mm\"]", "\"0 mm\""),
    );
    work.run(&["run", "rest.toml", "--quiet"]).expect(0);
    let said = work.run(&["export", "out/rest", "--to", "c"]).expect(1).stderr;
    assert!(said.contains("no row has an answer at an offset above 0"), "{said}");
}
