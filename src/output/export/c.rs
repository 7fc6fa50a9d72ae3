//! `c`: one header without dependencies: force and stiffness, cubic Hermite between the points.

use super::hermite_text::{BEYOND, array, clearance_nodes, damping, rows};
use super::interpolation::Interpolation;
use super::numbers::plain;
use super::sheet::{Format, Sheet};
use super::table::Between;

pub static FORMAT: Format = Format {
    name: "c",
    suffix: ".h",
    about: "one C header without dependencies: NAME_force and NAME_stiffness",
    two_dimensional: true,
    rules: &[Interpolation::Hermite],
    between: Between::Cubic,
    damping: true,
    length: 1.0,
    beyond: BEYOND,
    write,
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let table = &sheet.table;
    let (count, clearances) = (table.indentations.len(), table.clearances.len());
    let mut text = format!("/*\n{}*/\n#ifndef NAME_GUARD_H\n#define NAME_GUARD_H\n\n", sheet.head(" * "));
    text += "/* mm, N and N/mm. */\n";
    text += &format!(
        "static const double NAME_indentations[{count}] = {};\n",
        array(&table.indentations, "{", "}")
    );
    text += &format!(
        "static const double NAME_forces[{clearances}][{count}] = {};\n",
        rows(&table.forces, "{", "}")
    );
    text += &format!(
        "static const double NAME_stiffnesses[{clearances}][{count}] = {};\n",
        rows(&table.stiffnesses, "{", "}")
    );
    text += &ROW.replace("LAST", &(count - 2).to_string());
    if sheet.is_family() {
        let nodes = array(&clearance_nodes(sheet), "{", "}");
        let variable = if table.over_logarithm() { "log(clearance)" } else { "clearance" };
        text += &FAMILY
            .replace("NODES", &nodes)
            .replace("VARIABLE", variable)
            .replace("COUNT", &clearances.to_string())
            .replace("WIDTH", &clearances.min(4).to_string())
            .replace("LEAST", &plain(table.clearances[0]))
            .replace("MOST", &plain(table.clearances[clearances - 1]));
        if table.over_logarithm() {
            text = text.replacen("#define NAME_GUARD_H\n", "#define NAME_GUARD_H\n\n#include <math.h>\n", 1);
        }
    } else {
        text += &ONE.replace("CLEARANCE", &plain(table.clearances[0]));
    }
    if let Some(factor) = damping(sheet) {
        let (more, pass) = match sheet.is_family() {
            true => (", double radial_clearance_mm", ", radial_clearance_mm"),
            false => ("", ""),
        };
        text += &DAMPED.replace("FACTOR", &factor).replace("MORE", more).replace("PASS", pass);
    }
    text += "\n#endif\n";
    vec![("", text.replace("NAME_GUARD_H", &format!("{}_H", sheet.name.to_uppercase())).replace("NAME", &sheet.name))]
}

const ROW: &str = "
/* Force of one clearance, its slope in *slope; zero at and below zero, straight on beyond the last point. */
static inline double NAME_row(int row, double x, double *slope)
{
    const double *xs = NAME_indentations, *fs = NAME_forces[row], *ks = NAME_stiffnesses[row];
    int low = 0, high = LAST + 1;
    double width, s, secant, square, cube;
    if (!(x > 0.0)) {
        *slope = 0.0;
        return 0.0;
    }
    if (x >= xs[high]) {
        *slope = ks[high];
        return fs[high] + ks[high] * (x - xs[high]);
    }
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (xs[middle] <= x) low = middle; else high = middle;
    }
    width = xs[high] - xs[low];
    s = (x - xs[low]) / width;
    secant = (fs[high] - fs[low]) / width;
    square = 3.0 * secant - 2.0 * ks[low] - ks[high];
    cube = ks[low] + ks[high] - 2.0 * secant;
    *slope = ks[low] + s * (2.0 * square + 3.0 * s * cube);
    return fs[low] + width * s * (ks[low] + s * (square + s * cube));
}
";

const ONE: &str = "
static const double NAME_radial_clearance = CLEARANCE;

/* N, at an indentation in mm: pin's displacement from the hole's centre less the radial clearance. */
static inline double NAME_force(double indentation_mm)
{
    double slope;
    return NAME_row(0, indentation_mm, &slope);
}

/* dF/d(indentation), N/mm. */
static inline double NAME_stiffness(double indentation_mm)
{
    double slope;
    NAME_row(0, indentation_mm, &slope);
    return slope;
}
";

const FAMILY: &str = "
static const double NAME_clearance_nodes[COUNT] = NODES;

/* Between clearances the polynomial through the nearest ones; outside their range the last one counts. */
static inline double NAME_at(double x, double clearance, double *slope)
{
    double place, force = 0.0;
    int first = 0, i, j;
    if (!(clearance > LEAST)) clearance = LEAST;
    if (clearance > MOST) clearance = MOST;
    place = VARIABLE;
    while (first < COUNT - WIDTH && NAME_clearance_nodes[first + WIDTH / 2] <= place) first++;
    *slope = 0.0;
    for (i = first; i < first + WIDTH; i++) {
        double weight = 1.0, own_slope, own_force = NAME_row(i, x, &own_slope);
        for (j = first; j < first + WIDTH; j++)
            if (j != i)
                weight *= (place - NAME_clearance_nodes[j]) / (NAME_clearance_nodes[i] - NAME_clearance_nodes[j]);
        force += weight * own_force;
        *slope += weight * own_slope;
    }
    return force;
}

/* N, at an indentation in mm: pin's displacement from the hole's centre less the radial clearance. */
static inline double NAME_force(double indentation_mm, double radial_clearance_mm)
{
    double slope;
    return NAME_at(indentation_mm, radial_clearance_mm, &slope);
}

/* dF/d(indentation), N/mm. */
static inline double NAME_stiffness(double indentation_mm, double radial_clearance_mm)
{
    double slope;
    NAME_at(indentation_mm, radial_clearance_mm, &slope);
    return slope;
}
";

const DAMPED: &str = "
/* With damping; the speed of indentation in mm/s. Never a pull. */
static inline double NAME_force_damped(double indentation_mm, double speed_mm_per_sMORE)
{
    double factor = 1.0 + FACTOR * speed_mm_per_s;
    return factor > 0.0 ? factor * NAME_force(indentation_mmPASS) : 0.0;
}
";
