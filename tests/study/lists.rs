//! Lists of designs: read back as written, refused by row and column.

use std::fs;

use crate::{Folder, STEPS, all, row, with, written};

/// A sweep written out with the shared columns and read back is the same sweep.
#[test]
fn a_list_of_designs_reads_back_what_was_written() {
    let folder = Folder::new("list");
    let plate = "model              = \"annulus\"\nouter_radius_ratio = 2.0\n";
    let block = "model = \"block\"\nhalf_width_ratio = [2, 3.7]\ndepth_ratio = 0x3\nheight_ratio = 2.5\n\
                 support = [\"outer\", \"base\"]\n";
    let original = all(&folder.study(&with(plate, block).replace(STEPS, r#"force = "1 lbf""#)));
    assert_eq!(original.len(), 4);

    let text = written(&original, " , ", "4.4482216152605");
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
    // Shorter, longer, and as long with another number.
    let longer = format!("{list}{}\n", list.lines().last().unwrap());
    for changed in [fewer.join("\n"), longer, list.replacen("10,", "11,", 1)] {
        assert_ne!(changed, list);
        folder.write("designs.csv", changed);
        let error = study.cases().unwrap().find_map(Result::err).expect("accepted").to_string();
        assert!(error.contains("has changed since it was checked"), "{error}");
    }
}

#[test]
fn bad_lists_are_refused_by_row_and_column() {
    let folder = Folder::new("bad-list");
    let list = fs::read_to_string("configs/designs-example.csv").unwrap();
    // The first `old` of the example becomes `new`.
    #[rustfmt::skip]
    let edits = [
        ("thickness_mm", "Thickness_mm", ":1: Thickness_mm: unknown column; did you mean `thickness_mm`?"),
        ("thickness_mm", "force_n", ":1: force_n: the column stands there twice"),
        ("\n20,0.05", "\n,0.05", ":2: hole_radius_mm: the cell is empty"),
        ("\n20,0.05", "\n20 mm,0.05", ":2: hole_radius_mm: `20 mm`: not a number"),
        ("\n20,0.05", "\n20,inf", ":2: radial_clearance_mm: `inf`: the number is not finite"),
        ("\n20,0.05", "\n20,20", ":2: radial_clearance_mm: `20`: must be below the hole radius, 20 mm"),
        ("\n20,0.05", "\n20,-20", ":2: radial_clearance_mm: `-20`: the overlap of a press fit must be below the hole radius, 20 mm"),
        ("70000,0.33", "70000,0.5", ":3: plate_poissons_ratio: `0.5`: must be above -1 and below 0.5"),
        ("core,,210000", "cor,,210000", ":3: pin_model: `rigid-cor`: not known; did you mean `rigid-core`?"),
        ("2.5,base", "2.5,bas", ":5: plate_support: `bas`: not known; did you mean `base`?"),
        ("annulus,2,", "annulus,2,7", ":4: half_width_ratio: `7`: model `annulus` does not use this column"),
        ("annulus,2,,,,", "annulus,2,,,,base", ":4: plate_support: `base`: model `annulus` does not use"),
        (",,5000", ",1,5000", ":3: force_n: `indentation_mm` is given, too"),
        (",,5000", ",5000", ":3: the row has 17 cells, the header has 18"),
        ("\n12.7", "\n\n\nbad", ":6: hole_radius_mm: `bad`: not a number"),
        ("\n20,0.05", "\n20,\"0.05", ":2: a quote is opened and not closed before the end of the line"),
        ("\n20,0.05", "\n20,0.05\"", ":2: a quote is opened and not closed before the end of the line"),
    ];
    let first_line = list.lines().next().unwrap();
    let column = first_line.split(',').position(|name| name == "depth_ratio").unwrap();
    let without = |column: usize| {
        let kept = |line: &str| {
            let cells = line.split(',').enumerate().filter(|cell| cell.0 != column);
            cells.map(|cell| cell.1).collect::<Vec<_>>().join(",")
        };
        list.lines().map(kept).collect::<Vec<_>>().join("\n")
    };
    let mut cases: Vec<(String, &str)> = vec![
        (without(column), ":5: depth_ratio: the column is missing; this row needs it"),
        (without(17), ":3: indentation_mm: the row needs this, `offset_mm` or `force_n`"),
        (list.replace(',', ";"), "columns are separated by commas"),
        (first_line.to_string(), ":1: there is no row below the header"),
        (String::new(), ":1: there is no row below the header"),
        ("x".repeat(100_000), ":1: the line is longer than 65536 bytes: this is no list of designs"),
        (format!("{list}{}", "1".repeat(100_000)), ":7: the line is longer than 65536 bytes"),
    ];
    for (old, new, expected) in edits {
        assert!(list.contains(old), "{old}");
        cases.push((list.replacen(old, new, 1), expected));
        // Lines are counted alike whatever ends them.
        cases.push((list.replacen(old, new, 1).replace('\n', "\r\n"), expected));
    }
    for (content, expected) in cases {
        folder.write("designs.csv", content);
        let refusal = folder.refusal("[designs]\nfile = \"designs.csv\"\n");
        assert!(
            refusal.starts_with("designs.csv:") && refusal.contains(expected),
            "{refusal}\nnot {expected}"
        );
    }
    let refusal = folder.refusal("[designs]\nfile = \"other.csv\"\n");
    let expected = "config.toml:2: designs.file: `\"other.csv\"`: there is no file";
    assert!(refusal.starts_with(expected), "{refusal}");
}
