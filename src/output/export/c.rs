//! `c`: one header without dependencies: force and stiffness, cubic Hermite between the points.

use super::hermite_text::{array, clearance_nodes, damping, rows};
use super::numbers::plain;
use super::sheet::{Format, Sheet};

pub static FORMAT: Format = Format {
    name: "c",
    suffix: ".h",
    about: "one C header without dependencies: NAME_force and NAME_stiffness",
    write,
    ..Format::HERMITE
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let table = &sheet.table;
    let (count, clearances) = (table.indentations.len(), table.clearances.len());
    let mut text = format!("/*\n{}*/\n#ifndef @guard@\n#define @guard@\n\n", sheet.head(" * "));
    text += "/* mm, N and N/mm. */\n";
    text += &format!(
        "static const double @name@_indentations[{count}] = {};\n",
        array(&table.indentations, "{", "}")
    );
    text += &format!(
        "static const double @name@_forces[{clearances}][{count}] = {};\n",
        rows(&table.forces, "{", "}")
    );
    text += &format!(
        "static const double @name@_stiffnesses[{clearances}][{count}] = {};\n",
        rows(&table.stiffnesses, "{", "}")
    );
    text += &ROW.replace("@last@", &(count - 2).to_string());
    if sheet.is_family() {
        let nodes = array(&clearance_nodes(sheet), "{", "}");
        let variable = if table.over_logarithm() { "log(clearance)" } else { "clearance" };
        text += &FAMILY
            .replace("@nodes@", &nodes)
            .replace("@variable@", variable)
            .replace("@above@", sheet.gap_in_words())
            .replace("@count@", &clearances.to_string())
            .replace("@width@", &clearances.min(4).to_string())
            .replace("@least@", &plain(table.clearances[0]))
            .replace("@most@", &plain(table.clearances[clearances - 1]));
        if table.over_logarithm() {
            text = text.replacen("#define @guard@\n", "#define @guard@\n\n#include <math.h>\n", 1);
        }
    } else {
        text += &ONE.replace("@clearance@", &plain(table.clearances[0]));
    }
    if let Some(factor) = damping(sheet) {
        let (more, pass) = match sheet.is_family() {
            true => (", double radial_clearance_mm", ", radial_clearance_mm"),
            false => ("", ""),
        };
        text += &DAMPED.replace("@factor@", &factor).replace("@more@", more).replace("@pass@", pass);
    }
    text += "\n#endif\n";
    vec![(
        "",
        text.replace("@guard@", &format!("{}_H", sheet.name.to_uppercase())).replace("@name@", &sheet.name),
    )]
}

const ROW: &str = "
/* Force of one clearance, its slope in *slope; zero at and below zero, straight on beyond the last point. */
static inline double @name@_row(int row, double x, double *slope)
{
    const double *xs = @name@_indentations, *fs = @name@_forces[row], *ks = @name@_stiffnesses[row];
    int low = 0, high = @last@ + 1;
    double width, s, secant, square, cube;
    if (x <= 0.0) {
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
static const double @name@_radial_clearance = @clearance@;

/* N, at an indentation in mm: pin's displacement from the hole's centre less the radial clearance. */
static inline double @name@_force(double indentation_mm)
{
    double slope;
    return @name@_row(0, indentation_mm, &slope);
}

/* dF/d(indentation), N/mm. */
static inline double @name@_stiffness(double indentation_mm)
{
    double slope;
    @name@_row(0, indentation_mm, &slope);
    return slope;
}
";

const FAMILY: &str = "
static const double @name@_clearance_nodes[@count@] = @nodes@;

/* Between clearances the polynomial through the nearest ones; outside their range the last one counts. */
static inline double @name@_at(double x, double clearance, double *slope)
{
    double place, force = 0.0;
    int first = 0, i, j;
    if (!(clearance > @least@)) clearance = @least@;
    if (clearance > @most@) clearance = @most@;
    place = @variable@;
    while (first < @count@ - @width@ && @name@_clearance_nodes[first + @width@ / 2] <= place) first++;
    *slope = 0.0;
    for (i = first; i < first + @width@; i++) {
        double weight = 1.0, own_slope, own_force = @name@_row(i, x, &own_slope);
        for (j = first; j < first + @width@; j++)
            if (j != i)
                weight *= (place - @name@_clearance_nodes[j]) / (@name@_clearance_nodes[i] - @name@_clearance_nodes[j]);
        force += weight * own_force;
        *slope += weight * own_slope;
    }
    return force;
}

/* N, at an indentation in mm: pin's displacement from the hole's centre less the radial clearance@above@. */
static inline double @name@_force(double indentation_mm, double radial_clearance_mm)
{
    double slope;
    return @name@_at(indentation_mm, radial_clearance_mm, &slope);
}

/* dF/d(indentation), N/mm. */
static inline double @name@_stiffness(double indentation_mm, double radial_clearance_mm)
{
    double slope;
    @name@_at(indentation_mm, radial_clearance_mm, &slope);
    return slope;
}
";

const DAMPED: &str = "
/* With damping; the speed of indentation in mm/s. Never a pull. */
static inline double @name@_force_damped(double indentation_mm, double speed_mm_per_s@more@)
{
    double factor = 1.0 + @factor@ * speed_mm_per_s;
    return factor > 0.0 ? factor * @name@_force(indentation_mm@pass@) : 0.0;
}
";
