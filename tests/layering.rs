//! The house rules that the compiler does not check.
//!
//! Data runs one way: a wing uses only wings above it in `internals.rs`, and inside a wing a module uses only those
//! listed before it in its `mod.rs`. Children may use what their `mod.rs` itself defines. The last wing, lab,
//! measures the program itself, and so nothing else in the library uses it. Only the engine and what measures it have threads,
//! only study, output and lab touch files, and nothing in the library prints. Test modules are free.

use std::collections::BTreeMap;
use std::path::Path;

/// Source texts by path: `src/lib.rs` and everything its `mod` lines lead to.
type Sources = BTreeMap<String, String>;

/// Beginnings of paths and names of macros that a wing must not use, and what they are.
const FORBIDDEN: [(&str, &str, &[&str]); 11] = [
    ("src/mechanics/", "threads", THREADS),
    ("src/study/", "threads", THREADS),
    ("src/output/", "threads", THREADS),
    ("src/mechanics/", "files", FILES),
    ("src/engine/", "files", FILES),
    ("src/lab/tradeoff/", "files", FILES),
    ("src/calibrate/", "files", FILES),
    ("src/sensitivity/", "files", FILES),
    ("src/sensitivity/", "threads", THREADS),
    ("src/mechanics/", "environment", &["std::env", "std::process", "std::net"]),
    (
        "src/",
        "printing",
        &["print!", "println!", "eprint!", "eprintln!", "dbg!", "std::io::stdout", "std::io::stderr"],
    ),
];
const THREADS: &[&str] = &["std::thread", "std::sync::mpsc", "rayon"];
const FILES: &[&str] = &["std::fs"];
/// Only asks.
const HARMLESS: &[&str] = &["std::thread::panicking"];

#[test]
fn every_module_uses_only_what_comes_before_it() {
    let mut sources = Sources::new();
    read(Path::new(env!("CARGO_MANIFEST_DIR")), Path::new("src"), &mut sources);
    // The wings are listed in a file of their own, and stand at the crate's root all the same.
    let wings = sources.remove("src/internals.rs").unwrap();
    let root = sources.get_mut("src/lib.rs").unwrap();
    assert!(root.contains("pub mod internals;"));
    *root = root.replace("pub mod internals;", &wings);
    let offences = offences(&sources);
    assert!(offences.is_empty(), "\n{}\n", offences.join("\n"));
    // The library has more than a hundred files, which use others by more than a thousand paths.
    let is_own = |(_, path): &(usize, Vec<String>)| path[0] == "crate" || path[0] == "super";
    let paths =
        |text: &String| used_paths(&without_comments(text)).iter().filter(|path| is_own(path)).count();
    let counts = [sources.len(), sources.values().map(paths).sum()];
    println!("{} files, {} paths to others", counts[0], counts[1]);
    assert!(counts[0] > 100 && counts[1] > 1000, "{counts:?}");
}

/// Reads every source under `dir` except the binary's.
fn read(root: &Path, dir: &Path, sources: &mut Sources) {
    for entry in std::fs::read_dir(root.join(dir)).unwrap() {
        let path = dir.join(entry.unwrap().file_name());
        let name = path.to_str().unwrap().replace('\\', "/");
        if root.join(&path).is_dir() {
            read(root, &path, sources);
        } else if name.ends_with(".rs") {
            sources.insert(name, std::fs::read_to_string(root.join(&path)).unwrap());
        }
    }
    sources.retain(|name, _| name != "src/main.rs" && name != "src/cli.rs" && !name.starts_with("src/cli/"));
}

/// Every breach of the rules, as `file:line: what`.
fn offences(sources: &Sources) -> Vec<String> {
    let cleaned: BTreeMap<&str, String> =
        sources.iter().map(|(file, text)| (file.as_str(), without_comments(text))).collect();
    let mut modules = BTreeMap::new();
    list_modules(&cleaned, "src/lib.rs", &[], &mut modules);

    let mut offences = Vec::new();
    for (&file, text) in &cleaned {
        let Some(own) = modules.iter().find(|(_, module)| module.file == file).map(|(path, _)| path) else {
            offences.push(format!("{file}:1: no `mod` line leads to this file"));
            continue;
        };
        for (line, used) in used_paths(text) {
            if let Some(target) = resolve(own, &used)
                && let Some(problem) = wrong_way(&modules, own, &target)
            {
                offences.push(format!("{file}:{line}: {} is {problem}", target.join("::")));
            }
            for (prefix, what, names) in FORBIDDEN {
                let used = used.join("::");
                let is_named = |name: &&str| used == **name || used.starts_with(&format!("{name}::"));
                let is_harmless = HARMLESS.contains(&used.as_str());
                if file.starts_with(prefix) && names.iter().any(is_named) && !is_harmless {
                    offences.push(format!("{file}:{line}: {used}: no {what} here"));
                }
            }
        }
    }
    offences
}

struct Module {
    file: String,
    /// The modules it declares, in order.
    children: Vec<String>,
}

/// Follows the `mod` lines from `file` on.
fn list_modules(
    sources: &BTreeMap<&str, String>,
    file: &str,
    path: &[String],
    modules: &mut BTreeMap<Vec<String>, Module>,
) {
    let Some(text) = sources.get(file) else { return };
    let declared = text.lines().filter_map(|line| {
        let line = line.trim().strip_suffix(';')?;
        let (visibility, name) = line.split_once("mod ").filter(|(_, name)| is_identifier(name))?;
        (visibility.is_empty() || visibility.starts_with("pub")).then(|| name.to_string())
    });
    let children: Vec<String> = declared.collect();
    let dir = file.trim_end_matches("lib.rs").trim_end_matches("mod.rs").trim_end_matches(".rs");
    let dir = dir.trim_end_matches('/');
    for child in &children {
        let path = [path, std::slice::from_ref(child)].concat();
        for candidate in [format!("{dir}/{child}.rs"), format!("{dir}/{child}/mod.rs")] {
            list_modules(sources, &candidate, &path, modules);
        }
    }
    modules.insert(path.to_vec(), Module { file: file.to_string(), children });
}

/// Why `own` must not use `target`, if so. What tells is where their paths part: the modules there are brothers.
fn wrong_way(modules: &BTreeMap<Vec<String>, Module>, own: &[String], target: &[String]) -> Option<String> {
    let shared = own.iter().zip(target).take_while(|(own, target)| own == target).count();
    let parent = modules.get(&own[..shared])?;
    let place = |path: &[String]| parent.children.iter().position(|child| Some(child) == path.get(shared));
    // An item of the parent itself has no place.
    let (mine, theirs) = (place(own), place(target)?);
    // Errors stand outside the wings: all may tell of them, and they know of nobody.
    if shared == 0 && target[0] == "error" {
        return None;
    }
    if shared == 0 && own.first().is_some_and(|own| own == "error") {
        return Some("used by the errors, which stand outside the wings".to_string());
    }
    (theirs > mine?).then(|| format!("listed after {} in {}", own[shared], parent.file))
}

/// The path from the crate's root, for a path that begins in this crate.
fn resolve(own: &[String], used: &[String]) -> Option<Vec<String>> {
    let supers = used.iter().take_while(|part| *part == "super").count();
    match used.first()?.as_str() {
        "crate" => Some(used[1..].to_vec()),
        "self" => Some([own, &used[1..]].concat()),
        "super" => Some([&own[..own.len().checked_sub(supers)?], &used[supers..]].concat()),
        _ => None,
    }
}

/// The text with comments, string literals and test modules blanked, line for line.
fn without_comments(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let mut out = String::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if rest.starts_with("'\"'") || rest.starts_with("'\\\"'") {
            rest[1..].find('\'').map_or(rest.len(), |end| end + 2)
        } else if first == '"' {
            string_length(rest)
        } else {
            out.push(first);
            rest = &rest[first.len_utf8()..];
            continue;
        };
        out.extend(rest[..length].chars().filter(|c| *c == '\n'));
        rest = &rest[length..];
    }
    out
}

/// The length of the string literal that `text` begins with.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (index, byte) in text.bytes().enumerate().skip(1) {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return index + 1,
            _ => {}
        }
    }
    text.len()
}

/// Every path `a::b`, `a::{b, c}` or macro `a!` in the text with its line, in `use` lines and elsewhere.
fn used_paths(text: &str) -> Vec<(usize, Vec<String>)> {
    let mut paths = Vec::new();
    let mut line = 1;
    // Beginnings of the paths around, one for each open brace of a `use` tree or of code.
    let mut stems: Vec<Vec<String>> = vec![Vec::new()];
    let mut path: Vec<String> = Vec::new();
    let mut joined = false;
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let word: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        if !word.is_empty() {
            if !joined {
                flush(&mut paths, line, stems.last(), &mut path);
            }
            path.push(word.clone());
            joined = false;
            rest = &rest[word.len()..];
            if rest.starts_with('!') && !rest.starts_with("!=") {
                let name = path.last_mut().expect("a word was just pushed");
                name.push('!');
            }
            continue;
        }
        if rest.starts_with("::") {
            joined = true;
            rest = &rest[2..];
            continue;
        }
        match first {
            '{' => {
                let around = stems.last().cloned().unwrap_or_default();
                let is_tree = joined;
                if !is_tree {
                    flush(&mut paths, line, stems.last(), &mut path);
                }
                stems.push(if is_tree { [around, std::mem::take(&mut path)].concat() } else { Vec::new() });
                joined = false;
            }
            '}' => {
                flush(&mut paths, line, stems.last(), &mut path);
                stems.pop();
                joined = false;
            }
            c if c.is_whitespace() && joined => {}
            _ => {
                flush(&mut paths, line, stems.last(), &mut path);
                joined = false;
            }
        }
        line += usize::from(first == '\n');
        rest = &rest[first.len_utf8()..];
    }
    paths
}

/// Ends the path at hand.
fn flush(
    paths: &mut Vec<(usize, Vec<String>)>,
    line: usize,
    stem: Option<&Vec<String>>,
    path: &mut Vec<String>,
) {
    if !path.is_empty() {
        paths.push((line, [stem.cloned().unwrap_or_default(), std::mem::take(path)].concat()));
    }
}

fn is_identifier(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// A small house in good order; each test below puts one thing wrong.
fn house(changes: &[(&str, &str)]) -> Vec<String> {
    let good = [
        (
            "src/lib.rs",
            "pub mod mechanics;\npub mod study;\npub mod engine;\npub mod output;\npub mod error;\npub use error::Error;\n",
        ),
        ("src/error.rs", "pub struct Error;\n"),
        ("src/mechanics/mod.rs", "pub mod material;\npub mod body;\n"),
        (
            "src/mechanics/material.rs",
            "//! println! and crate::engine in a comment, \nconst A: &str = \"std::fs\";\n",
        ),
        (
            "src/mechanics/body/mod.rs",
            "use crate::mechanics::material::Material;\npub mod disc;\npub mod block;\npub struct Body;\n",
        ),
        (
            "src/mechanics/body/disc.rs",
            "use super::{Body, disc};\n#[cfg(test)]\nmod tests {\n    use crate::output;\n}\n",
        ),
        ("src/mechanics/body/block.rs", "use super::disc::Disc;\nuse crate::Error;\n"),
        ("src/study/mod.rs", "pub mod design;\n"),
        ("src/study/design.rs", "use crate::mechanics::{body::Body, material};\nuse std::fs;\n"),
        ("src/engine/mod.rs", "pub mod sweep;\n"),
        ("src/engine/sweep.rs", "use crate::study::design;\nuse rayon::prelude::*;\n"),
        ("src/output/mod.rs", "mod table;\n"),
        ("src/output/table.rs", "use crate::engine::sweep;\nuse std::{fs, io};\n"),
    ];
    let sources = good.iter().chain(changes).map(|(file, text)| (file.to_string(), text.to_string()));
    offences(&sources.collect())
}

#[test]
fn a_house_in_order_passes() {
    assert_eq!(house(&[]), [""; 0]);
}

#[test]
fn a_wing_that_uses_a_later_wing_is_found() {
    let found = house(&[("src/study/design.rs", "use std::fs;\n\nuse crate::engine::sweep::run;\n")]);
    assert_eq!(found, ["src/study/design.rs:3: engine::sweep::run is listed after study in src/lib.rs"]);
}

#[test]
fn a_module_that_uses_a_later_brother_is_found() {
    let expected = "src/mechanics/body/disc.rs:1: mechanics::body::block::Block is listed after disc in src/mechanics/body/mod.rs";
    for text in [
        "use super::block::Block;\n",
        "use super::{block::Block, Body};\n",
        "use crate::mechanics::body::block::Block;\n",
        "use crate::{mechanics::body::block::Block};\n",
        "fn f() { let block = super::block::Block; }\n",
    ] {
        assert_eq!(house(&[("src/mechanics/body/disc.rs", text)]), [expected], "{text}");
    }
    let found = house(&[("src/mechanics/material.rs", "use super::body;\n")]);
    assert_eq!(
        found,
        ["src/mechanics/material.rs:1: mechanics::body is listed after material in src/mechanics/mod.rs"]
    );
}

#[test]
fn each_offence_of_a_long_use_has_its_line() {
    let text =
        "use crate::{\n    engine::sweep,\n    mechanics,\n    output::{\n        table,\n    },\n};\n";
    let found = house(&[("src/study/design.rs", text)]);
    assert_eq!(
        found,
        [
            "src/study/design.rs:2: engine::sweep is listed after study in src/lib.rs",
            "src/study/design.rs:5: output::table is listed after study in src/lib.rs",
        ]
    );
}

#[test]
fn errors_that_know_a_wing_are_found() {
    let found = house(&[("src/error.rs", "use crate::mechanics::body::Body;\n")]);
    assert_eq!(
        found,
        ["src/error.rs:1: mechanics::body::Body is used by the errors, which stand outside the wings"]
    );
}

#[test]
fn printing_threads_and_files_are_found_where_they_have_no_place() {
    let cases = [
        (
            "src/mechanics/material.rs",
            "fn f() {\n    println!(\"x\");\n}\n",
            ":2: println!: no printing here",
        ),
        ("src/output/table.rs", "fn f() { eprintln!(); }\n", ":1: eprintln!: no printing here"),
        ("src/mechanics/material.rs", "use std::{fs, io};\n", ":1: std::fs: no files here"),
        ("src/mechanics/material.rs", "fn f() { std::fs::read(p); }\n", ":1: std::fs::read: no files here"),
        ("src/engine/sweep.rs", "use std::fs::File;\n", ":1: std::fs::File: no files here"),
        ("src/mechanics/material.rs", "use rayon::prelude::*;\n", ":1: rayon::prelude: no threads here"),
        ("src/output/table.rs", "use std::thread;\n", ":1: std::thread: no threads here"),
        ("src/mechanics/material.rs", "use std::env;\n", ":1: std::env: no environment here"),
    ];
    for (file, text, expected) in cases {
        assert_eq!(house(&[(file, text)]), [format!("{file}{expected}")], "{text}");
    }
}

#[test]
fn a_file_that_belongs_to_no_module_is_found() {
    let found = house(&[("src/engine/forgotten.rs", "")]);
    assert_eq!(found, ["src/engine/forgotten.rs:1: no `mod` line leads to this file"]);
}
