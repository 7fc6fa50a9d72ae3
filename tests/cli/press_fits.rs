//! A sweep from press fits to clearances through the verbs that a user has.

use crate::common::ring_joint::ring_joint;
use crate::common::workdir::Workdir;

/// A press fit and a clearance, loaded by offsets; with a result in out/fits.
fn work(name: &str) -> Workdir {
    let work = Workdir::new(name);
    let offsets = "[\"0 mm\", \"0.01 mm\", \"0.02 mm\", \"0.05 mm\"]";
    let config = ring_joint("[\"-0.01 mm\", \"0.01 mm\"]", offsets).replace("indentation", "offset");
    work.write("fits.toml", &config);
    work.run(&["run", "fits.toml"]).expect(0);
    work
}

fn numbers(work: &Workdir, table: &str, column: &str) -> Vec<f64> {
    work.table(table).column(column).iter().map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn tables_and_reports_are_over_the_offset() {
    let work = work("press-fit-report");
    let of = |column| numbers(&work, "out/fits/table.csv", column);
    assert_eq!(of("offset_mm"), [0.0, 0.01, 0.02, 0.05, 0.0, 0.01, 0.02, 0.05]);
    assert_eq!(of("indentation_mm"), [0.01, 0.02, 0.03, 0.06, 0.0, 0.0, 0.01, 0.04]);
    let angles = of("contact_half_angle_deg");
    assert!(angles[0] == 180.0 && angles[3] < 180.0 && angles[4] == 0.0 && angles[7] > 0.0, "{angles:?}");
    work.run(&["report", "out/fits"]).expect(0);
    let page = work.read("out/fits/report.html");
    for said in [
        "A pin in a hole, with clearance or in a press fit, is loaded across",
        "at offsets of",
        "Force against offset",
        "last offset, mm",
    ] {
        assert!(page.contains(said), "{said}");
    }
    assert!(!page.contains("against indentation") && !page.contains("has no curve of its own"));
}

/// Laws of the joint with clearance; the press fit says why not, whether a run or the verb fits them.
#[test]
fn laws_are_of_clearances_and_exports_of_both() {
    let work = work("press-fit-laws");
    for _ in 0..2 {
        let laws = work.table("out/fits/laws.csv");
        let rows: Vec<(&str, &str)> = laws.column("design").into_iter().zip(laws.column("law")).collect();
        assert_eq!(rows.iter().filter(|(design, _)| *design == "0").collect::<Vec<_>>(), [&("0", "none")]);
        assert!(rows.iter().filter(|(design, law)| *design == "1" && *law != "none").count() > 3, "{rows:?}");
        let why = "laws are of the indentation of joints with clearance";
        assert!(work.read("out/fits/laws.csv").contains(why));
        work.run(&["laws", "out/fits", "--force"]).expect(0);
    }
    let export = |design| {
        work.run(&["export", "out/fits", "--to", "csv", "--design", design, "--allow-warned", "--force"])
    };
    export("1").expect(0);
    // Over its offset.
    export("0").expect(0);
    work.write("points.csv", "indentation_mm,force_n\n0.01,100\n0.02,300\n");
    let one = ["--set", "joint.radial_clearance=-0.01 mm", "--set", "load.offset=0.02 mm"];
    let calibrate = ["calibrate", "fits.toml", "--measured", "points.csv", "--fit", "plate_youngs_modulus"];
    let said = work.run(&[&calibrate[..], &one].concat()).expect(1).stderr;
    assert!(said.contains("a press fit has no indentation"), "{said}");
}

#[test]
fn materials_and_pressures_are_those_of_chosen_designs() {
    let work = work("press-fit-materials");
    work.run(&["materials", "fits.toml", "--design", "0", "--design", "1", "--out", "shares.csv"]).expect(0);
    let of = |column| numbers(&work, "shares.csv", column);
    // Pin and plate of four steps, and of two that press.
    assert_eq!(of("design"), [vec![0.0; 8], vec![1.0; 4]].concat());
    for pair in of("energy_share").chunks(2) {
        assert!((pair[0] + pair[1] - 1.0).abs() < 1e-5 && pair[0] > 0.0 && pair[1] > pair[0], "{pair:?}");
    }
    let shares = work.table("shares.csv");
    let of_force = shares.column("force_share");
    // No force at rest.
    assert!(of_force[..2].iter().all(|cell| cell.is_empty()) && !of_force[2].is_empty(), "{of_force:?}");
    work.run(&["pressure", "fits.toml", "--design", "0", "--points", "3", "--out", "pressure.csv"]).expect(0);
    let (angles, pressures) =
        (numbers(&work, "pressure.csv", "angle_deg"), numbers(&work, "pressure.csv", "pressure_mpa"));
    assert_eq!((angles.len(), angles[2]), (12, 180.0));
    // At rest the same all around.
    assert!((pressures[2] / pressures[0] - 1.0).abs() < 1e-9 && pressures[0] > 0.0, "{pressures:?}");
    let said = work.run(&["materials", "fits.toml", "--design", "0", "--set", "solve.method=closed-form"]);
    assert!(said.expect(1).stderr.contains("solve.method: closed-form: has no strain energy of the joint"));
}

/// Open rows are answers: they are named, and disturb neither exit code, laws, statistics, reports nor exports.
#[test]
fn rows_without_contact_say_so() {
    let work = Workdir::new("no-contact");
    let config = |offsets| ring_joint("[\"0.01 mm\"]", offsets).replace("indentation", "offset");
    let open = config("[\"0 mm\", \"0.01 mm\", \"0.012 mm\", \"0.015 mm\"]");
    work.write("open.toml", &format!("{open}\n[select]\nkeep = \"status != 'no contact'\"\n"));
    let told = work.run(&["run", "open.toml"]).expect(0).stdout;
    for line in [
        "\n2 of 4 rows are ok\n",
        "\nanswered with a remark: 2 rows\n",
        "  no contact\n",
        "\nkept: 2 of 4 rows",
    ] {
        assert!(told.contains(line), "{line:?} not in {told}");
    }
    work.write("open.toml", &open);
    work.run(&["run", "open.toml", "--force"]).expect(0);
    let table = work.table("out/open/table.csv");
    assert_eq!(table.column("status"), ["no contact", "no contact", "ok", "ok"]);
    work.run(&["report", "out/open"]).expect(0);
    assert!(work.read("out/open/report.html").contains("no contact"));
    work.run(&["export", "out/open", "--to", "csv"]).expect(0);
    work.write("closed.toml", &config("[\"0.012 mm\", \"0.015 mm\"]"));
    work.run(&["run", "closed.toml"]).expect(0);
    let laws = |name: &str| work.read(&format!("out/{name}/laws.csv"));
    assert!(laws("open") == laws("closed") && laws("open").lines().count() > 4);
}
