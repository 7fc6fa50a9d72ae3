//! What a format has at hand: the table, what its head says, and the words for the outside.

use crate::output::export::impact::Impact;
use crate::output::export::interpolation::Interpolation;
use crate::output::export::numbers::{plain, rounded};
use crate::output::export::source::{Fits, Reference, Source};
use crate::output::export::table::{Between, Quality, Table};
use crate::output::host::Program;
use crate::output::origin::Origin;
use crate::study::columns::{Cell, Column, joint_columns};

/// A form for another program: one file of `output/export`, listed in `FORMATS`.
pub struct Format {
    /// On the command line.
    pub name: &'static str,
    /// What follows the table's name in the file's.
    pub suffix: &'static str,
    pub about: &'static str,
    /// Words of its language, with blanks between them: no table may be called so.
    pub reserved: &'static str,
    /// Whether it holds a table over clearance and indentation.
    pub two_dimensional: bool,
    /// How its reader goes between points; the table is good for all of them.
    pub rules: &'static [Interpolation],
    pub between: Between,
    /// Whether it has a place for damping.
    pub damping: bool,
    /// Lengths over mm: 1e-3 for formats in m.
    pub length: f64,
    /// Points closer than this are too close for its reader, mm; 0 where none are.
    pub least_step: f64,
    /// What its reader does beyond the last point.
    pub beyond: &'static str,
    /// The texts of its files: what follows the table's name, and the text. The first is the main one.
    pub write: fn(&Sheet) -> Vec<(&'static str, String)>,
}

impl Format {
    /// For one clearance, in mm, with straight lines between points and beyond the last one: formats say where they differ.
    pub const LINEAR: Format = Format {
        name: "",
        suffix: "",
        about: "",
        reserved: "",
        two_dimensional: false,
        rules: &[Interpolation::Linear],
        between: Between::Linear,
        damping: false,
        length: 1.0,
        least_step: 0.0,
        beyond: "straight on with the last slope",
        write: |_| Vec::new(),
    };

    /// For functions of its own: cubics over indentation and clearance, and damping.
    pub const HERMITE: Format = Format {
        two_dimensional: true,
        rules: &[Interpolation::Hermite],
        between: Between::Cubic,
        damping: true,
        ..Format::LINEAR
    };
}

/// Everything a file is made of.
pub struct Sheet {
    /// An identifier.
    pub name: String,
    pub table: Table,
    pub impact: Option<Impact>,
    /// Of the head, at most `WIDEST` characters each, without marks of a comment.
    pub head: Vec<String>,
    /// Lengths over mm.
    pub length: f64,
}

/// Characters of a line of the head: with a mark of a comment it fits 80 columns.
const WIDEST: usize = 74;

impl Sheet {
    /// The head, with a mark in front of each line.
    pub fn head(&self, mark: &str) -> String {
        self.head.iter().map(|line| format!("{mark}{line}").trim_end().to_string() + "\n").collect()
    }

    /// Indentations with two rows of the gap, in the format's unit.
    pub fn with_gap(&self) -> Vec<f64> {
        let end = self.table.indentations[self.table.indentations.len() - 1];
        let all = [-end, -0.5 * end].into_iter().chain(self.table.indentations.iter().copied());
        all.map(|x| rounded(x * self.length, 12)).collect()
    }

    /// Forces of a clearance with those of the gap.
    pub fn forces_with_gap(&self, clearance: usize) -> Vec<f64> {
        [0.0, 0.0].into_iter().chain(self.table.forces[clearance].iter().copied()).collect()
    }

    /// Pairs of a table for one clearance, with the gap.
    pub fn pairs(&self) -> Vec<(f64, f64)> {
        self.with_gap().into_iter().zip(self.forces_with_gap(0)).collect()
    }

    /// Pairs of a table for one clearance, a line each: the force, a comma, the indentation.
    pub fn lines_of_force_first(&self) -> String {
        self.pairs().into_iter().map(|(x, y)| format!("{}, {}\n", plain(y), plain(x))).collect()
    }

    /// Whether some of its clearances are below zero, which are of press fits: their force begins where the distance does. One alone has a
    /// clearance of 0 here.
    pub fn goes_below_zero(&self) -> bool {
        self.table.clearances[0] < 0.0
    }

    /// Behind "less the radial clearance".
    pub fn gap_in_words(&self) -> &'static str {
        if self.goes_below_zero() { ", where that is above 0" } else { "" }
    }

    pub fn is_family(&self) -> bool {
        self.table.clearances.len() > 1
    }

    pub fn end(&self) -> f64 {
        self.table.indentations[self.table.indentations.len() - 1]
    }
}

/// Numbers with commas between, some a line, which begins and ends with something.
pub fn listed(values: &[f64], a_line: usize, begin: &str, end: &str) -> String {
    let lines = values.chunks(a_line).map(|chunk| {
        let numbers: Vec<String> = chunk.iter().map(|value| plain(*value)).collect();
        format!("{begin}{}", numbers.join(", "))
    });
    lines.collect::<Vec<_>>().join(&format!(",{end}\n"))
}

/// What the head of every file says.
pub fn head(
    source: &Source,
    origin: &Origin,
    manifest_hash: &str,
    format: &Format,
    table: &Table,
    quality: &Quality,
    impact: Option<&Impact>,
) -> Vec<String> {
    let percent = |value: f64| format!("{} %", rounded(100.0 * value, 2));
    let mut said: Vec<String> = Vec::new();
    let program = Program::CURRENT;
    let what = match source.fits() {
        Fits::Clearance => "Pin in a hole with clearance: force against indentation",
        Fits::Press => "Pin pressed into a hole: force against offset",
        Fits::Both => "Pin in a hole, pressed in or with clearance: force against indentation",
    };
    said.push(format!("{what}, for {}.", format.name));
    said.push(format!(
        "Made by {}; config {}, manifest.json xxh128 {manifest_hash}.",
        program.in_words(),
        origin.inputs.path
    ));
    let joint = &source.members[0].joint;
    let designs = match &source.members[..] {
        [one] => format!("design {}", one.design),
        all => format!("{} designs", all.len()),
    };
    let mut scene = format!("Scene ({designs}):");
    for column in joint_columns(joint.layer_counts()) {
        let unit = match column.unit() {
            "-" => String::new(),
            unit => format!(" {unit}"),
        };
        let name = column.name();
        let name = name.strip_suffix("_mm").or(name.strip_suffix("_mpa")).unwrap_or(&name).to_string();
        match column.cell(joint) {
            _ if column == Column::RadialClearance && source.is_family() => {
                let all = &table.clearances;
                let (first, last) = (plain(all[0]), plain(all[all.len() - 1]));
                scene += &format!(" {name} {first} to {last} mm in {} steps;", all.len());
            }
            Cell::Number(value) => scene += &format!(" {name} {value}{unit};"),
            Cell::Word(word) => scene += &format!(" {name} {word};"),
            Cell::Empty => {}
        }
    }
    scene += " two dimensions, linear elastic, frictionless; nothing but pin and plate yields.";
    said.push(scene);
    let (way, from) = match source.fits() {
        Fits::Clearance => ("Indentation", "after first touch"),
        Fits::Press => ("Offset", "from where the press fit is at rest"),
        Fits::Both => (
            "Indentation",
            "after first touch, of press fits (radial clearance below 0) from where they are at rest",
        ),
    };
    said.push(match source.reference {
        Reference::Support => format!(
            "{way} (reference: support): descent of the pin's rigid part {from}, from where the plate is held. It holds the compliance \
             of the whole plate up to its support: beside a flexible plate of a simulator use the reference ring-mean."
        ),
        Reference::RingMean => format!(
            "{way} (reference: ring-mean): of the mean motion of the pin's ring against that of the hole's {from}; the motion of both \
             rings, {} mm/N, is taken out. The simulator's bodies bring it.",
            plain(rounded(source.ring_compliance, 6))
        ),
    });
    said.push(match source.fits() {
        Fits::Clearance => {
            "Positive is pressed in; pin's displacement from the hole's centre = radial clearance + indentation.".into()
        }
        Fits::Both => {
            "Positive is pressed in; pin's displacement from the hole's centre = indentation + radial clearance, where that is above 0: a \
             press fit has no gap. Below 0, where a distance never is, stand zeros: a press fit's table along one direction needs its \
             mirror image."
                .to_string()
        }
        Fits::Press => {
            "A press fit is a law without clearance: here the radial clearance is 0, and what is called indentation is the offset, the \
             pin's displacement from where the press fit is at rest. Below 0, where a distance never is, stand zeros: a table along one direction \
             needs its mirror image."
                .to_string()
        }
    });
    let (length, unit) = if format.length == 1.0 { (1.0, "mm") } else { (format.length, "m") };
    said.push(format!("Units here: {unit} and N. The force is of the whole joint."));
    let of_linearity = match quality.linearity_error {
        Some(error) => {
            format!("; finite displacements change it by about {} at the greatest load", percent(error))
        }
        None => String::new(),
    };
    said.push(format!(
        "Errors: of the curve's force at most {} (force_error, method {}){of_linearity}.",
        percent(quality.force_error),
        quality.methods.join(", ")
    ));
    let rules: Vec<&str> = format.rules.iter().map(|rule| rule.name()).collect();
    let of_stiffness = quality
        .of_stiffness
        .map_or(String::new(), |error| format!(" (with slopes the stiffness within {})", percent(error)));
    let first = table.indentations[1];
    said.push(format!(
        "Interpolation: {}: within {} of the curve's force{of_stiffness} at {} places that are not in the table, from \
         {} {unit} on; below that within {} of the force there.",
        rules.join("; or "),
        percent(quality.of_force),
        quality.places,
        plain(first * length),
        percent(quality.of_first)
    ));
    if let Some(error) = quality.between {
        let how = match format.between {
            Between::Linear => "straight lines",
            Between::Cubic => "the cubic through four neighbours",
        };
        said.push(format!("Between clearances: {how}: within {} of the force half way.", percent(error)));
    }
    let end = table.indentations[table.indentations.len() - 1];
    let greatest: Vec<f64> = table.forces.iter().map(|forces| forces[forces.len() - 1]).collect();
    let (least, most) = (
        greatest.iter().copied().fold(f64::INFINITY, f64::min),
        greatest.iter().copied().fold(0.0, f64::max),
    );
    let reached = if greatest.len() == 1 {
        format!("{} N", plain(most))
    } else {
        format!("{} to {} N", plain(least), plain(most))
    };
    said.push(format!(
        "Range: 0 to {} {unit} ({reached}). Extrapolation: {}{}.",
        plain(end * length),
        format.beyond,
        if source.fits() == Fits::Clearance { "; in the gap force and slope are zero" } else { "" }
    ));
    if source.is_family() {
        said.push("Extrapolation over the clearance: none; stay inside its range.".into());
    }
    if let Some(impact) = impact {
        said.push(format!(
            "Damping: F (1 + c v), v the speed of indentation, c = {} s/mm ({}), for a restitution of {} at {} mm/s. \
             Integrated with this table: {} (mass {} kg).",
            plain(rounded(impact.coefficient, 6)),
            impact.law.name(),
            impact.asked.restitution,
            impact.asked.speed,
            rounded(impact.restitution, 4),
            plain(rounded(1e3 * impact.mass, 4)),
        ));
    }
    if joint.is_neat() && !source.is_family() {
        said.push("A neat fit: the force is proportional to the indentation.".into());
    }
    said.iter().flat_map(|text| wrapped(&harmless(text))).collect()
}

/// Without what would end or break a comment of any of the formats, in ASCII.
fn harmless(text: &str) -> String {
    let plain: String =
        text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).collect();
    plain
        .replace("*/", "* /")
        .replace("/*", "/ *")
        .replace("--", "- -")
        .replace("\"\"\"", "'''")
        .replace('\\', "/")
}

/// In lines of at most `WIDEST` characters, the later ones indented.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ').flat_map(pieces) {
        let last = lines.len() - 1;
        let line = &mut lines[last];
        if !line.trim().is_empty() && line.len() + 1 + word.len() > WIDEST {
            lines.push(format!("  {word}"));
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

/// A word longer than a line, cut; ASCII.
fn pieces(word: &str) -> impl Iterator<Item = &str> {
    (0..word.len().max(1)).step_by(WIDEST - 2).map(|at| &word[at..word.len().min(at + WIDEST - 2)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_word_of_a_path_ends_a_comment() {
        let text = harmless("a*/b--c \u{e9}\n/*\"\"\"");
        assert_eq!(text, "a* /b- -c ??/ *'''");
        let long = "x".repeat(200);
        let lines = wrapped(&format!("one {long} two"));
        assert!(lines.iter().all(|line| line.len() <= WIDEST) && lines.len() == 4, "{lines:?}");
    }
}
