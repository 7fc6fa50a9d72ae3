//! Press fits and loads by offset: how they are read, listed and refused.

use jointsweep::Load;
use jointsweep::internals::study::output_options::column_names;

use crate::{CLEARANCE, Folder, RADIUS, STEPS, all, sampled, with, written};

const OFFSETS: &str = r#"offset = ["0 mm", "0.2 mm"]"#;

/// A press fit and a clearance, loaded by offsets.
fn fits() -> String {
    with(CLEARANCE, r#"radial_clearance = ["-0.1 mm", "0.1 mm"]"#).replace(STEPS, OFFSETS)
}

#[test]
fn clearances_below_zero_are_press_fits() {
    let folder = Folder::new("press-fits");
    let study = folder.study(&fits());
    let designs = all(&study);
    assert_eq!(designs.iter().map(|case| case.joint.is_press_fit()).collect::<Vec<_>>(), [true, false]);
    assert_eq!(designs[0].steps, [Load::Offset(0.0), Load::Offset(0.2)].into());
    let diametral = fits().replace("radial_clearance", "diametral_clearance");
    assert_eq!(all(&folder.study(&diametral))[0].joint.radial_clearance, -0.05);
}

/// By name, of a hole of 20 mm: 20 to 62 um in diameter, and 1 to 35 um of overlap.
#[test]
fn fits_of_the_standard_are_ranges_of_clearances() {
    let folder = Folder::new("fits-by-name");
    let named =
        |fit: &str| with(CLEARANCE, &format!("fit = \"{fit}\"")).replace(RADIUS, "hole_radius = \"10 mm\"");
    let clearances = |config: &str| -> Vec<f64> {
        all(&folder.study(config)).iter().map(|case| case.joint.radial_clearance).collect()
    };
    assert_eq!(clearances(&named("H7/f7")), [0.01, 0.0205, 0.031]);
    assert_eq!(clearances(&named("H7/p6").replace(STEPS, OFFSETS)), [-0.0175, -0.009, -0.0005]);
    let sobol = "method = \"sobol\"\ncount = 8";
    let drawn =
        clearances(&sampled(sobol, &[(CLEARANCE, "fit = \"H7/f7\""), (RADIUS, "hole_radius = \"10 mm\"")]));
    assert!(
        drawn.len() == 8 && drawn.iter().all(|clearance| (0.01..=0.031).contains(clearance)),
        "{drawn:?}"
    );
    assert!(
        drawn.iter().any(|clearance| *clearance < 0.02) && drawn.iter().any(|clearance| *clearance > 0.022)
    );
    for (config, problem) in [
        (named("H7/q6"), "`\"H7/q6\"`: not a fit that is known; holes H5 to H11"),
        (
            named("H7/f7").replace("\"10 mm\"", "\"260 mm\""),
            "up to a diameter of 500 mm, and the hole has 520 mm",
        ),
        (
            named("H7/f7").replace("\"10 mm\"", "[\"10 mm\", \"20 mm\"]"),
            "`hole_radius` sweeps: give the clearances",
        ),
        (
            named("H7/f7").replace("fit =", "radial_clearance = \"1 mm\"\nfit ="),
            "`radial_clearance` is given, too",
        ),
    ] {
        let said = folder.refusal(config);
        assert!(said.contains("joint.fit") && said.contains(problem), "{said}");
    }
}

#[test]
fn tables_have_offsets_where_there_are_some() {
    let folder = Folder::new("press-fit-columns");
    let by_offset = with(STEPS, OFFSETS);
    let pressed = fits().replace(OFFSETS, r#"force = "1 kN""#);
    for (config, expected) in
        [(with("Test", "Bare"), false), (by_offset, true), (pressed, true), (fits(), true)]
    {
        let names = column_names(folder.study(&config).extras());
        let place = names.iter().position(|name| name == "offset_mm");
        let after = names.iter().position(|name| name == "indentation_mm").unwrap() + 1;
        assert_eq!(place, expected.then_some(after), "{config}");
    }
    let config = format!("{BARE_OUTPUT}\n{}", with("Test", "Bare"));
    let said = folder.refusal(config);
    assert!(said.contains("`offset_mm`: the designs of this config are neither press fits"), "{said}");
}

const BARE_OUTPUT: &str = "output.columns = [\"design\", \"offset_mm\"]";

#[test]
fn a_list_has_press_fits_and_offsets() {
    let folder = Folder::new("press-fit-list");
    let text = written(&all(&folder.study(&fits())), ",", "100");
    let list = "[designs]\nfile = \"designs.csv\"\n";
    folder.write("designs.csv", &text);
    let study = folder.study(list);
    assert_eq!(all(&study)[0].joint.radial_clearance, -0.1);
    assert!(study.extras().offset && all(&study)[0].steps == [Load::Force(100.0)].into());
    folder.write("designs.csv", text.replace("force_n", "offset_mm"));
    assert_eq!(all(&folder.study(list))[1].steps, [Load::Offset(100.0)].into());
    let with_both = text.replace("force_n", "force_n,offset_mm").replace(",100", ",100,5");
    for (broken, problem) in [
        (
            text.replace("force_n", "indentation_mm"),
            ":2: indentation_mm: a press fit has no indentation; give `offset_mm` or `force_n`",
        ),
        (with_both, ":2: force_n: `offset_mm` is given, too; a row has only one load"),
        (text.replace(",100", ","), ":2: indentation_mm: the row needs this, `offset_mm` or `force_n`"),
        (
            text.replace(",-0.1,", ",-100,"),
            ":2: radial_clearance_mm: `-100`: the overlap of a press fit must be below the hole radius, 100 mm",
        ),
        (
            text.replace("force_n", "offset_mm").replace(",100\n", ",-1\n"),
            ":2: offset_mm: `-1`: must be 0 or more",
        ),
    ] {
        assert_ne!(broken, text);
        folder.write("designs.csv", broken);
        let said = folder.refusal(list);
        assert!(said.contains(problem), "{said}");
    }
}

#[test]
fn bad_press_fits_are_refused_by_line_and_key() {
    let folder = Folder::new("press-fit-bad");
    let wide = |clearance: &str| fits().replace(r#"["-0.1 mm", "0.1 mm"]"#, clearance);
    let zip = sampled(
        "method = \"zip\"",
        &[
            (RADIUS, r#"hole_radius = ["1 mm", "2 mm"]"#),
            (CLEARANCE, r#"radial_clearance = ["-0.5 mm", "-2 mm"]"#),
            (STEPS, OFFSETS),
        ],
    );
    for (config, problem) in [
        (
            fits().replace(OFFSETS, STEPS),
            "load.indentation: press fits (a radial clearance below zero) have no indentation; give `offset` or `force`",
        ),
        (fits().replace(OFFSETS, ""), "load: one of `indentation`, `offset` and `force` is needed"),
        (
            fits().replace(OFFSETS, &format!("{OFFSETS}\nforce = \"1 N\"")),
            "load.force: `offset` is given, too; only one kind of load is allowed",
        ),
        (fits().replace("\"0 mm\"", "\"-1 mm\""), "load.offset: `\"-1 mm\"`: must be 0 or more"),
        (
            wide(r#"["-100 mm", "1 mm"]"#),
            "a radial clearance of -100 mm meets a hole radius of 100 mm (line 4); the overlap of a press fit must be below the \
             hole radius",
        ),
        (zip, "a radial clearance of -2 mm meets a hole radius of 2 mm"),
    ] {
        let said = folder.refusal(config);
        assert!(said.contains(problem), "{said}");
    }
    assert_eq!(all(&folder.study(&wide("\"-99 mm\""))).len(), 1);
}
