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
            "from where the press fit is at rest",
        ] {
            assert!(joined.contains(said), "{format} does not say {said}: {joined}");
        }
        assert!(
            !joined.contains("after first touch") && !joined.contains("in the gap"),
            "{format}: {joined}"
        );
    }
}

/// Overlaps of many digits: the indentation of a row at rest is rounded to nine of them, its offset is exact. Without the column it is told
/// from the indentation.
#[test]
fn overlaps_of_many_digits_are_exported() {
    let (work, _) = fit("export-fit-digits");
    // Nine digits of these are more than they are, by 2e-9.
    let overlaps = "[\"-0.0016666666666666667 mm\", \"-0.0026666666666666667 mm\"]";
    let config = work.read("fit.toml").replace("\"-0.01 mm\"", overlaps);
    assert!(config.contains("-0.0026666666666666667"), "{config}");
    work.write("many.toml", &config);
    work.run(&["run", "many.toml", "--quiet"]).expect(0);
    for design in ["0", "1"] {
        work.run(&["export", "out/many", "--design", design, "--to", "csv", "--out", "t.csv", "--force"])
            .expect(0);
    }
    let table = work.read("out/many/table.csv");
    let columns = table.lines().next().unwrap().split(',').filter(|name| *name != "offset_mm");
    let columns: Vec<String> = columns.map(|name| format!("{name:?}")).collect();
    work.write("few.toml", &format!("{config}\n[output]\ncolumns = [{}]\n", columns.join(", ")));
    work.run(&["run", "few.toml", "--quiet"]).expect(0);
    assert!(!work.read("out/few/table.csv").contains("offset_mm"));
    for design in ["0", "1"] {
        work.run(&["export", "out/few", "--design", design, "--to", "csv", "--out", "t.csv", "--force"])
            .expect(0);
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

/// From pressed in to loose, mm.
const CLEARANCES: [f64; 5] = [-0.008, -0.004, 0.0, 0.01, 0.02];

/// Joints that differ in their clearance only, in `out/family`.
fn family(name: &str, clearances: &[f64]) -> Workdir {
    let all: Vec<String> = clearances.iter().map(|clearance| format!("\"{clearance} mm\"")).collect();
    let work = solved(name, "\"0.02 mm\"", "3");
    let config = work.read("sweep.toml").replace("\"0.02 mm\"", &format!("[{}]", all.join(", ")));
    let (before, after) = config.split_once("indentation").unwrap();
    let rest = after.split_once('\n').unwrap().1;
    work.write("family.toml", &format!("{before}force = [\"10 N\", \"1 kN\", \"15 kN\"]\n{rest}"));
    work.run(&["run", "family.toml", "--quiet"]).expect(0);
    work
}

/// One axis through zero: of press fits the offset, of joints with clearance the indentation.
#[test]
fn a_table_over_the_clearance_goes_through_zero() {
    let pressed = [-0.008, -0.0065, -0.004];
    for (name, clearances) in [("export-through-zero", &CLEARANCES[..]), ("export-pressed", &pressed)] {
        let work = family(name, clearances);
        let out = ["--over", "radial_clearance", "--out", "t.csv"];
        work.run(&[&["export", "out/family", "--to", "csv"], &out[..]].concat()).expect(0);
        let text = work.read("t.csv");
        let rows: Vec<[f64; 3]> = text
            .lines()
            .skip(1)
            .map(|line| {
                let cells: Vec<f64> = line.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
                cells.try_into().unwrap()
            })
            .collect();
        let end = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
        for clearance in clearances {
            let pairs: Vec<(f64, f64)> =
                rows.iter().filter(|row| row[0] == *clearance).map(|row| (row[1], row[2])).collect();
            assert!(pairs.len() > 10 && pairs.len() < 160, "{clearance} mm: {} points", pairs.len());
            let curve = curve(*clearance);
            let mut is_open = false;
            for place in places().iter().map(|place| place * end / END) {
                let found = curve.at(Load::Offset(place + clearance.max(0.0))).unwrap();
                is_open |= found.contact_half_angle != Some(std::f64::consts::PI);
                let off = linear(&pairs, place) / found.force - 1.0;
                assert!(off.abs() < ERROR, "{clearance} mm at {place} mm: {off:e}");
            }
            assert!(is_open, "{clearance} mm stays closed: nothing was asked where it opens");
        }
        let about = work.read("t_about.txt").split_whitespace().collect::<Vec<_>>().join(" ");
        for said in
            ["pressed in or with clearance", "Indentation (reference: support)", "a press fit has no gap"]
        {
            assert!(about.contains(said), "the head does not say {said}: {about}");
        }
        let first = format!("radial_clearance {:?} to", clearances[0]);
        assert!(about.contains(&first) && !about.contains("in the gap force"), "{about}");
        // Nobody takes a clearance off a distance that has none.
        let cases = [
            ("adams", "t.adm", "AKISPL(DM(10201, 10101) - MAX(0, DR), DR, 1)"),
            ("exudyn", "t.py", "distance * mm_per_unit - max(radial_clearance_mm, 0.0)"),
            ("modelica", "t.mo", "force(x - max(0, radial_clearance), radial_clearance)"),
            ("c", "t.h", "less the radial clearance, where that is above 0."),
        ];
        for (format, file, said) in cases {
            work.run(&["export", "out/family", "--to", format, "--over", "radial_clearance", "--out", file])
                .expect(0);
            assert!(work.read(file).contains(said), "{format} does not say {said}");
        }
    }
}

/// Of one clearance after the other the distance between the centres, the force there, and the stiffness, by the exported module.
fn by_module(work: &Workdir, asked: &[f64]) -> Vec<Vec<f64>> {
    let out = ["--to", "exudyn", "--over", "radial_clearance", "--out", "joint.py", "--force"];
    work.run(&[&["export", "out/family"], &out[..]].concat()).expect(0);
    let main = "import joint\n\
         for clearance in ASKED:\n\
         \x20   pull = joint.make_user_function(clearance, 1.0)\n\
         \x20   distance = max(clearance, 0.0) + 0.012\n\
         \x20   found = pull(None, 0.0, 0, [0.0, distance, 0.0], [0.0] * 3, 0, 0, [0.0] * 3)\n\
         \x20   print(distance, found[1], joint.stiffness(0.012, clearance))\n";
    work.write("main.py", &main.replace("ASKED", &format!("{asked:?}")));
    numbers(&run_in(work, "python3", &["-B", "main.py"]))
}

#[test]
#[cfg_attr(not(python3), ignore = "no python3 here")]
fn a_module_goes_through_zero_clearance() {
    let work = family("export-through-zero-python", &CLEARANCES);
    for (clearance, row) in CLEARANCES.iter().zip(by_module(&work, &CLEARANCES)) {
        let truth = curve(*clearance).at(Load::Offset(row[0])).unwrap();
        let off = [row[1] / truth.force - 1.0, row[2] / truth.tangent_stiffness - 1.0];
        assert!(off[0].abs() < ERROR && off[1].abs() < 3.0 * ERROR, "{clearance} mm, {row:?}: {off:?}");
    }
}

/// Where fits open a cubic over the clearance is not good, and this is told.
#[test]
#[cfg_attr(not(python3), ignore = "no python3 here")]
fn what_is_left_between_press_fits_is_told() {
    let clearances: Vec<f64> = (-8..=-1).map(|i| 0.001 * f64::from(i)).collect();
    let work = family("export-between-fits", &clearances);
    let out = ["--to", "c", "--over", "radial_clearance", "--out", "joint.h"];
    let said = work.run(&[&["export", "out/family"], &out[..]].concat()).expect(0).stderr;
    let told = said.split_once("the force is off by up to ").expect("a warning").1;
    let told: f64 = told.split_once(" %").unwrap().0.parse().unwrap();
    assert!(told > 0.1 && told < 20.0, "{told} %");
    let asked = [-0.0075, -0.0055, -0.0035, -0.0015];
    let found = by_module(&work, &asked);
    assert_eq!(found.len(), asked.len());
    for (clearance, row) in asked.into_iter().zip(found) {
        let truth = curve(clearance).at(Load::Offset(row[0])).unwrap();
        let off = row[1] / truth.force - 1.0;
        assert!(off.abs() < 1.05e-2 * told, "{clearance} mm, {row:?}: {off:e}, told {told} %");
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
    let both = family("export-both", &CLEARANCES);
    let damped = ["--to", "c", "--over", "radial_clearance", "--restitution", "0.8", "--speed", "100 mm/s"];
    let said = both.run(&[&["export", "out/family"], &damped[..]].concat()).expect(1).stderr;
    assert!(said.contains("restitution: a press fit is never out of contact"), "{said}");
    both.run(&["export", "out/family", "--to", "c", "--design", "0"]).expect(0);
    both.run(&["export", "out/family", "--to", "c", "--design", "4", "--force"]).expect(0);
    // Nothing of an offset above 0.
    work.write(
        "rest.toml",
        &work.read("fit.toml").replace("[\"0 mm\", \"0.0004 mm\", \"0.004 mm\", \"0.0291 mm\"]", "\"0 mm\""),
    );
    work.run(&["run", "rest.toml", "--quiet"]).expect(0);
    let said = work.run(&["export", "out/rest", "--to", "c"]).expect(1).stderr;
    assert!(said.contains("no row has an answer at an offset above 0"), "{said}");
}
