//! `python`: one module without dependencies: `force` and `stiffness`, cubic Hermite between the points.

use super::hermite_text::{array, clearance_nodes, damping, rows};
use super::numbers::plain;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "python",
    suffix: ".py",
    reserved: "False None True and as assert async await break class continue def del elif else except finally \
               for from global if import in is lambda nonlocal not or pass raise return try while with yield",
    about: "one Python module without dependencies: force and stiffness",
    write,
    ..Format::HERMITE
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    vec![("", module(sheet))]
}

/// The module; `exudyn` adds to it.
pub fn module(sheet: &Sheet) -> String {
    let table = &sheet.table;
    let mut text = sheet.head("# ");
    text += "from bisect import bisect_right\n";
    if sheet.is_family() && table.over_logarithm() {
        text += "from math import log\n";
    }
    text += "\n# mm, N and N/mm.\n";
    text += &format!("INDENTATIONS = {}\n", array(&table.indentations, "[", "]"));
    text += &format!("FORCES = {}\n", rows(&table.forces, "[", "]"));
    text += &format!("STIFFNESSES = {}\n", rows(&table.stiffnesses, "[", "]"));
    text += ROW;
    if sheet.is_family() {
        let clearances = &table.clearances;
        text += &FAMILY
            .replace("@nodes@", &array(&clearance_nodes(sheet), "[", "]"))
            .replace("@own@", &array(clearances, "[", "]"))
            .replace("@variable@", if table.over_logarithm() { "log(clearance)" } else { "clearance" })
            .replace("@above@", sheet.gap_in_words())
            .replace("@width@", &clearances.len().min(4).to_string());
    } else {
        text += &ONE.replace("@clearance@", &plain(table.clearances[0]));
    }
    if let Some(factor) = damping(sheet) {
        let (more, pass) = match sheet.is_family() {
            true => (", radial_clearance_mm", ", radial_clearance_mm"),
            false => ("", ""),
        };
        text += &DAMPED.replace("@factor@", &factor).replace("@more@", more).replace("@pass@", pass);
    }
    text
}

const ROW: &str = "

def _row(forces, stiffnesses, x):
    \"\"\"Force and its slope for one clearance; zero at and below zero, straight on beyond the last point.\"\"\"
    if x != x:
        return x, x
    if x <= 0.0:
        return 0.0, 0.0
    if x >= INDENTATIONS[-1]:
        return forces[-1] + stiffnesses[-1] * (x - INDENTATIONS[-1]), stiffnesses[-1]
    i = bisect_right(INDENTATIONS, x) - 1
    width = INDENTATIONS[i + 1] - INDENTATIONS[i]
    s = (x - INDENTATIONS[i]) / width
    left, right = stiffnesses[i], stiffnesses[i + 1]
    secant = (forces[i + 1] - forces[i]) / width
    square, cube = 3.0 * secant - 2.0 * left - right, left + right - 2.0 * secant
    force = forces[i] + width * s * (left + s * (square + s * cube))
    return force, left + s * (2.0 * square + 3.0 * s * cube)
";

const ONE: &str = "
RADIAL_CLEARANCE_MM = @clearance@


def force(indentation_mm):
    \"\"\"N; the indentation is the pin's displacement from the hole's centre less the radial clearance.\"\"\"
    return _row(FORCES[0], STIFFNESSES[0], indentation_mm)[0]


def stiffness(indentation_mm):
    \"\"\"dF/d(indentation), N/mm.\"\"\"
    return _row(FORCES[0], STIFFNESSES[0], indentation_mm)[1]
";

const FAMILY: &str = "
RADIAL_CLEARANCES_MM = @own@
_NODES = @nodes@


def _at(x, clearance):
    \"\"\"Between clearances the polynomial through the nearest ones; outside their range the last one counts.\"\"\"
    clearance = min(max(clearance, RADIAL_CLEARANCES_MM[0]), RADIAL_CLEARANCES_MM[-1])
    place = @variable@
    first = min(max(bisect_right(_NODES, place) - @width@ // 2, 0), len(_NODES) - @width@)
    near = range(first, first + @width@)
    force = slope = 0.0
    for i in near:
        weight = 1.0
        for j in near:
            if j != i:
                weight *= (place - _NODES[j]) / (_NODES[i] - _NODES[j])
        own = _row(FORCES[i], STIFFNESSES[i], x)
        force += weight * own[0]
        slope += weight * own[1]
    return force, slope


def force(indentation_mm, radial_clearance_mm):
    \"\"\"N; the indentation is the pin's displacement from the hole's centre less the radial clearance@above@.\"\"\"
    return _at(indentation_mm, radial_clearance_mm)[0]


def stiffness(indentation_mm, radial_clearance_mm):
    \"\"\"dF/d(indentation), N/mm.\"\"\"
    return _at(indentation_mm, radial_clearance_mm)[1]
";

const DAMPED: &str = "

def force_damped(indentation_mm, speed_mm_per_s@more@):
    \"\"\"N, with damping; the speed of indentation in mm/s. Never a pull.\"\"\"
    return max(0.0, 1.0 + @factor@ * speed_mm_per_s) * force(indentation_mm@pass@)
";
