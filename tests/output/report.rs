//! `jointsweep report`: a page that is well-formed, needs nothing else, stays small, and says what the table says.

use std::collections::BTreeMap;

use crate::common::workdir::Workdir;
use roxmltree::{Document, Node, ParsingOptions};

/// Some designs fail under the largest indentation, others are remarked on.
const SWEEP: &str = r#"
title = "Pins & <holes> of \"A\""
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = ["0.005 mm", "0.1 mm", "0.4 mm"]
thickness = "5 mm"
[joint.pin]
model = "rigid-midplane"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = [1.02, 2, 4]
youngs_modulus = "3 GPa"
poissons_ratio = 0.4
[load]
indentation = ["0.01 mm", "0.1 mm", "1 mm", "9 mm"]
[solve]
accuracy = "0.5 %"
"#;

/// One joint with an evenly spaced load, so that its axes are linear.
const ONE: &str = r#"
title = "One joint"
[joint]
idealization = "plane-strain"
hole_radius = "10 mm"
radial_clearance = "0.05 mm"
thickness = "8 mm"
[joint.pin]
model = "rigid-core"
core_radius_ratio = 0.2
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = 3
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
[load]
indentation = ["0.01 mm", "0.02 mm", "0.03 mm", "0.05 mm"]
"#;

/// With the result of a config in `out`, however it has ended.
fn with_result(name: &str, config: &str) -> Workdir {
    let work = Workdir::new(name);
    work.write("sweep.toml", config);
    let ended = work.run(&["run", "sweep.toml", "--out", "out", "--quiet"]);
    assert!(matches!(ended.code, Some(0 | 2)), "{}", ended.stderr);
    work
}

fn parse(page: &str) -> Document<'_> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(page, options).unwrap_or_else(|error| panic!("not well-formed: {error}"))
}

fn text(node: Node) -> String {
    node.descendants().filter_map(|node| node.text().filter(|_| node.is_text())).collect()
}

fn all<'a>(document: &'a Document, name: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    document.descendants().filter(move |node| node.has_tag_name(name))
}

fn section<'a>(document: &'a Document, title: &str) -> Node<'a, 'a> {
    let heading = all(document, "h2").find(|heading| text(*heading) == title);
    heading.unwrap_or_else(|| panic!("no section {title}")).parent().unwrap()
}

/// Cells of the first table of a section, its head first.
fn table(section: Node) -> Vec<Vec<String>> {
    let table = section.descendants().find(|node| node.has_tag_name("table")).unwrap();
    let rows = table.descendants().filter(|node| node.has_tag_name("tr"));
    rows.map(|row| row.children().filter(Node::is_element).map(text).collect()).collect()
}

/// What is left after "1.516·10⁷" has become a number again.
fn number(cell: &str) -> f64 {
    let plain: String = cell
        .chars()
        .filter_map(|character| match character {
            '\u{b7}' => Some('e'),
            '\u{207b}' => Some('-'),
            '\u{b9}' => Some('1'),
            '\u{b2}' => Some('2'),
            '\u{b3}' => Some('3'),
            '\u{2070}'..='\u{2079}' => char::from_digit(character as u32 - 0x2070, 10),
            other => Some(other),
        })
        .collect();
    plain.replace("e10", "e").parse().unwrap_or_else(|_| panic!("no number: {cell}"))
}

/// To the four digits that pages have.
fn assert_near(found: &str, expected: f64, what: &str) {
    let found = number(found);
    assert!(
        (found - expected).abs() <= 6e-4 * expected.abs(),
        "{what}: {found} on the page, {expected} in the table"
    );
}

/// Nothing on the page is fetched from anywhere, and nothing on it runs.
#[track_caller]
fn assert_self_contained(document: &Document) {
    let mut elements = 0;
    for node in document.descendants().filter(Node::is_element) {
        elements += 1;
        let name = node.tag_name().name();
        let is_active =
            ["script", "link", "img", "image", "iframe", "object", "embed", "use", "base"].contains(&name);
        assert!(!is_active, "{name}");
        for attribute in node.attributes() {
            let name = attribute.name();
            let reaches_out =
                ["src", "href", "srcset", "data", "action"].contains(&name) || name.starts_with("on");
            assert!(!reaches_out, "{name}");
            assert!(!attribute.value().contains("url("), "{}", attribute.value());
        }
        if name == "style" {
            let style = text(node);
            assert!(!["url(", "@import", "http"].iter().any(|bad| style.contains(bad)), "{style}");
        }
    }
    assert!(elements > 100, "{elements}");
}

/// Words of a chart that lie upon each other, as boxes of 13 px text that is taken to be narrow.
fn overlaps(svg: Node) -> Vec<String> {
    let mut boxes: Vec<(String, [f64; 4])> = Vec::new();
    for node in svg.descendants().filter(|node| node.has_tag_name("text") && node.attribute("x").is_some()) {
        let at = |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
        let words = text(node);
        let wide = 6.2 * words.chars().count() as f64;
        let left = match node.attribute("text-anchor") {
            Some("middle") => at("x") - 0.5 * wide,
            Some("end") => at("x") - wide,
            _ => at("x"),
        };
        boxes.push((words, [left, at("y") - 10.0, left + wide, at("y") + 2.0]));
    }
    let mut found = Vec::new();
    for (place, (words, a)) in boxes.iter().enumerate() {
        for (others, b) in &boxes[..place] {
            if a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3] {
                found.push(format!("`{words}` on `{others}`"));
            }
        }
        if a[0] < -1.0 || a[2] > 481.0 {
            found.push(format!("`{words}` off the sheet"));
        }
    }
    found
}

#[test]
fn a_page_is_well_formed_needs_nothing_and_its_words_do_not_touch() {
    let mut charts = 0;
    for (name, config) in [("page", SWEEP), ("page-one", ONE)] {
        let work = with_result(name, config);
        let said = work.run(&["report", "out"]).expect(0);
        assert_eq!(said.stdout.trim().replace('\\', "/"), "out/report.html");
        let page = work.read("out/report.html");
        let document = parse(&page);
        assert_self_contained(&document);
        for svg in all(&document, "svg") {
            charts += 1;
            let found = overlaps(svg);
            assert!(found.is_empty(), "{:?}: {found:?}", svg.attribute("aria-label"));
            let drawn = svg.descendants().any(|node| ["path", "rect"].contains(&node.tag_name().name()));
            assert!(drawn, "{:?}", svg.attribute("aria-label"));
        }
    }
    assert!(charts >= 16, "{charts}");
}

#[test]
fn titles_are_words_and_no_markup() {
    let work = with_result("title", SWEEP);
    work.run(&["report", "out", "--quiet"]).expect(0);
    let page = work.read("out/report.html");
    assert!(!page.contains("<holes>"));
    let document = parse(&page);
    let title = "Pins & <holes> of \"A\"";
    assert_eq!(text(all(&document, "h1").next().unwrap()), title);
    assert_eq!(text(all(&document, "title").next().unwrap()), title);
    // The config is there word for word.
    assert!(all(&document, "pre").any(|pre| text(pre) == SWEEP));
}

#[test]
fn every_number_is_the_tables() {
    let work = with_result("numbers", SWEEP);
    work.run(&["report", "out", "--design", "4", "--design", "0", "--design", "8"]).expect(0);
    let rows = work.table("out/table.csv");
    let page = work.read("out/report.html");
    let document = parse(&page);
    let values = |name: &str| -> Vec<f64> {
        rows.column(name).iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
    };
    let (designs, statuses) = (values("design"), rows.column("status"));
    let answered = statuses.iter().filter(|status| !status.starts_with("failed")).count();
    assert!(answered < statuses.len() && answered > 20, "the sweep has failures: {answered}");

    // The figures below the title.
    let facts: BTreeMap<String, String> =
        all(&document, "dt").map(|name| (text(name), text(name.next_sibling_element().unwrap()))).collect();
    assert_eq!(facts["designs"], "9");
    assert_eq!(facts["rows with an answer"], format!("{answered} of {}", statuses.len()));
    for (fact, column, unit) in [
        ("force", "force_n", "N"),
        ("tangent stiffness", "tangent_stiffness_n_per_mm", "N/mm"),
        ("peak pressure", "peak_pressure_mpa", "Pa"),
    ] {
        let own: Vec<f64> = values(column).into_iter().filter(|value| value.is_finite()).collect();
        let ends =
            [own.iter().copied().fold(f64::INFINITY, f64::min), own.iter().copied().fold(0.0, f64::max)];
        let (from, to) = facts[fact].split_once(" to ").unwrap();
        let last = to.split_once(' ').unwrap();
        let first = from.split_once(' ').unwrap_or((from, last.1));
        for ((value, own_unit), expected) in [first, last].into_iter().zip(ends) {
            let prefix = own_unit.strip_suffix(unit).unwrap_or_else(|| panic!("{own_unit}"));
            let of_prefix: f64 = match (prefix, unit) {
                ("k", _) | ("G", "Pa") => 1e3,
                ("M", "Pa") | ("", _) => 1.0,
                ("M", _) => 1e6,
                other => panic!("{other:?}"),
            };
            assert_near(value, expected / of_prefix, fact);
        }
    }
    let greatest = values("force_error").into_iter().fold(0.0, f64::max);
    let told = facts["largest force_error"].strip_suffix(" %").unwrap().to_string();
    assert!((number(&told) / (100.0 * greatest) - 1.0).abs() < 6e-3, "{told}");

    // What is said in words.
    let finite =
        |name: &str| values(name).into_iter().filter(|value| value.is_finite()).collect::<Vec<f64>>();
    let words = text(all(&document, "header").next().unwrap());
    let remarked = statuses.iter().filter(|status| **status != "ok" && !status.starts_with("failed")).count();
    for expected in [
        "9 designs with 4 load steps each, at indentations of 0.01 to 9 mm".to_string(),
        "radial clearance (3 values from 0.005 to 0.4 mm)".into(),
        "hole radius 10 mm".into(),
        "accuracy of 0.5 % of the force".into(),
        format!("{} rows have no answer, {remarked} rows have a remark", statuses.len() - answered),
    ] {
        assert!(words.contains(&expected), "`{expected}` is not in `{words}`");
    }
    let words = text(section(&document, "Errors"));
    for (name, limit) in [("force_error", 0.005), ("linearity_error", 0.01)] {
        let own = finite(name);
        let above = own.iter().filter(|error| **error > limit).count();
        let plural = if above == 1 { ("row", "is") } else { ("rows", "are") };
        let expected = format!("{above} {} of {} {} above", plural.0, own.len(), plural.1);
        assert!(words.contains(&expected), "`{expected}` is not in `{words}`");
    }

    // The chosen designs, in the order of their numbers.
    let key = table(section(&document, "Curves"));
    assert_eq!(key[0][1..], ["0", "4", "8"]);
    let line =
        |name: &str| key.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{name}: {key:?}"));
    let mut compared = 0;
    for (place, design) in [0.0, 4.0, 8.0].into_iter().enumerate() {
        let last =
            (0..designs.len()).rfind(|&row| designs[row] == design && values("force_error")[row].is_finite());
        let last = last.unwrap();
        for (name, column) in [
            ("radial clearance, mm", "radial_clearance_mm"),
            ("outer radius ratio", "outer_radius_ratio"),
            ("last indentation, mm", "indentation_mm"),
            ("force there, N", "force_n"),
            ("tangent stiffness there, N/mm", "tangent_stiffness_n_per_mm"),
        ] {
            assert_near(&line(name)[place + 1], values(column)[last], name);
            compared += 1;
        }
    }
    assert_eq!(compared, 15);

    // Laws, by their own table.
    let laws = work.table("out/laws.csv");
    let of_laws = table(section(&document, "Laws"));
    assert_eq!(of_laws[0][1..], ["design 0", "design 4", "design 8"]);
    let mut compared = 0;
    for (row, ((design, name), misfit)) in laws
        .column("design")
        .into_iter()
        .zip(laws.column("law"))
        .zip(laws.column("worst_force_misfit"))
        .enumerate()
        .filter(|(_, ((design, _), _))| ["0", "4", "8"].contains(design))
    {
        let place = ["0", "4", "8"].iter().position(|own| *own == design).unwrap() + 1;
        let told = &of_laws.iter().find(|row| row[0] == name).unwrap_or_else(|| panic!("{name}"))[place];
        let recommended = laws.column("recommended")[row].starts_with("yes");
        assert_eq!(told.starts_with('\u{2713}'), recommended, "{design} {name}: {told}");
        let told = number(told.trim_start_matches(['\u{2713}', ' ']).strip_suffix(" %").unwrap());
        let expected = 100.0 * misfit.parse::<f64>().unwrap();
        // Two digits.
        assert!(
            (told - expected).abs() <= 0.051 * expected,
            "{design} {name}: {told} told, {expected} in laws.csv"
        );
        compared += 1;
    }
    assert!(compared >= 20, "{compared}");

    // Statuses.
    let mut expected: BTreeMap<&str, (usize, f64)> = BTreeMap::new();
    for (status, design) in statuses.iter().zip(&designs) {
        expected.entry(status).or_insert((0, *design)).0 += 1;
    }
    let told = table(section(&document, "Status"));
    assert_eq!(told.len() - 1, expected.len());
    for row in &told[1..] {
        let (count, example) = expected[row[0].as_str()];
        assert_eq!(
            (row[1].as_str(), row[4].as_str()),
            (&*count.to_string(), &*example.to_string()),
            "{row:?}"
        );
    }
}

/// The circles of a chart stand where the rows are: on linear axes their distances are those of the values.
#[test]
fn circles_are_the_tables_rows() {
    let work = with_result("circles", ONE);
    work.run(&["report", "out"]).expect(0);
    let rows = work.table("out/table.csv");
    let page = work.read("out/report.html");
    let document = parse(&page);
    let mut compared = 0;
    for (chart, column) in [
        ("Force against indentation", "force_n"),
        ("Tangent stiffness against indentation", "tangent_stiffness_n_per_mm"),
        ("Contact half angle against indentation", "contact_half_angle_deg"),
        ("Peak pressure against indentation", "peak_pressure_mpa"),
    ] {
        let svg = all(&document, "svg").find(|svg| svg.attribute("aria-label") == Some(chart)).unwrap();
        let circles: Vec<[f64; 2]> = svg
            .descendants()
            .filter(|node| node.has_tag_name("circle"))
            .map(|node| ["cx", "cy"].map(|name| node.attribute(name).unwrap().parse().unwrap()))
            .collect();
        assert_eq!(circles.len(), rows.records.len(), "{chart}");
        let mut by_indentation = circles.clone();
        by_indentation.sort_by(|a, b| a[0].total_cmp(&b[0]));
        for (place, name) in ["indentation_mm", column].into_iter().enumerate() {
            let values: Vec<f64> = rows.column(name).iter().map(|cell| cell.parse().unwrap()).collect();
            let scale =
                |own: &dyn Fn(usize) -> f64, at: usize| (own(at) - own(0)) / (own(values.len() - 1) - own(0));
            for at in 0..values.len() {
                let drawn = scale(&|at| by_indentation[at][place], at);
                let expected = scale(&|at| values[at], at);
                // Places have a tenth of a pixel of some hundred.
                assert!((drawn - expected).abs() < 3e-3, "{chart}, {name}: {drawn} drawn, {expected}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 32);
}

#[test]
fn a_page_of_a_hundred_thousand_designs_is_small() {
    let config =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/configs/hypercube.toml")).unwrap();
    let steps = "{ from = \"0.001 mm\", to = \"0.1 mm\", count = 10, spacing = \"log\" }";
    assert!(config.contains(steps));
    let work = with_result("large", &config.replace(steps, "[\"0.01 mm\", \"0.1 mm\"]"));
    work.run(&["report", "out"]).expect(0);
    let page = work.read("out/report.html");
    assert!(page.len() < 2_000_000, "{}", page.len());
    let document = parse(&page);
    assert_self_contained(&document);
    let facts: Vec<String> = all(&document, "dd").map(text).collect();
    assert_eq!(facts[..2], ["100000", "200000 of 200000"]);
    let sweep = text(section(&document, "The sweep"));
    assert!(sweep.contains("of the 100000 designs, evenly taken"), "{sweep}");
}

/// Whatever the strings in it, a page has an end: a huge config, and numbers of designs without end.
#[test]
fn a_page_stays_small_whatever_the_manifest_holds() {
    let comment = "# <&> \"a comment as long as a config may have\" \n".repeat(80_000);
    let work = with_result("huge", &format!("{comment}{ONE}"));
    work.run(&["report", "out"]).expect(0);
    let page = work.read("out/report.html");
    assert!(page.len() < 2_000_000, "{}", page.len());
    parse(&page);
}

#[test]
fn what_is_there_is_kept_without_force() {
    let work = with_result("kept", ONE);
    work.write("out/report.html", "mine");
    work.write("other.html", "mine, too");
    for arguments in [&["report", "out"][..], &["report", "out", "--out", "other.html"]] {
        let said = work.run(arguments).expect(1).stderr;
        assert!(said.contains(".html is there already: ") && said.contains("--force"), "{said}");
    }
    assert_eq!((work.read("out/report.html"), work.read("other.html")), ("mine".into(), "mine, too".into()));
    work.run(&["report", "out", "--force", "--quiet"]).expect(0);
    assert!(work.read("out/report.html").starts_with("<!DOCTYPE html>"));
    work.run(&["report", "out", "--out", "new.html"]).expect(0);
    assert!(work.read("new.html").starts_with("<!DOCTYPE html>"));
}

#[test]
fn errors_say_what_is_wrong_and_nothing_is_written() {
    let work = with_result("errors", ONE);
    let before = work.files();
    work.write("empty/nothing.txt", "");
    let many: Vec<String> = ["report".into(), "out".into()]
        .into_iter()
        .chain((0..8).map(|design| format!("--design={design}")))
        .collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    for (arguments, expected) in [
        (&["report", "nowhere"][..], "there is no manifest.json"),
        (&["report", "empty"], "there is no manifest.json"),
        (&["report", "out", "--design", "7"], "there is no design 7: the sweep has 1"),
        (&many, "too many"),
        (&["report", "out", "--design", "two"], "two"),
        (&["report", "out", "--out", "no/such/folder.html"], "cannot write"),
    ] {
        let said = work.run(arguments).expect(1).stderr;
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
    // A table that somebody has spoilt: the error has its line and column.
    let table = work.read("out/table.csv");
    let spoilt: Vec<String> = table
        .lines()
        .enumerate()
        .map(|(place, line)| if place == 3 { line.replacen("0.03,", "0.03x,", 1) } else { line.to_string() })
        .collect();
    work.write("out/table.csv", &spoilt.join("\n"));
    let said = work.run(&["report", "out"]).expect(1).stderr;
    assert!(said.contains("table.csv:4: indentation_mm") && said.contains("0.03x"), "{said}");
    let files: Vec<String> = work.files().into_iter().filter(|file| file != "empty/nothing.txt").collect();
    assert_eq!(files, before);
}

/// A method without a curve of the joint, and designs without any answer, still have a page.
#[test]
fn there_is_a_page_without_curves() {
    let closed = format!("{ONE}[solve]\nmethod = \"closed-form\"\n");
    // The series knows no half disc.
    let failing = ONE.replace("rigid-core\"\ncore_radius_ratio = 0.2", "rigid-midplane\"");
    let failing = format!("{failing}[solve]\nmethod = \"series\"\n");
    for (name, config, expected) in [
        ("closed", closed, "has no curve of its own: method: a closed form has no curve"),
        ("failing", failing, "has no curve of its own: failed"),
    ] {
        let work = with_result(name, &config);
        work.run(&["report", "out"]).expect(0);
        let page = work.read("out/report.html");
        let document = parse(&page);
        let curves = text(section(&document, "Curves"));
        assert!(curves.contains(expected), "{name}: {curves}");
        for bad in ["NaN", "inf"] {
            assert!(all(&document, "svg").all(|svg| !page[svg.range()].contains(bad)), "{name}: {bad}");
        }
    }
}
