//! `modelica`: a package with functions of its own (.mo), and a text for the tables of the Modelica Standard
//! Library (.txt).
//!
//! Modelica Standard Library, Modelica.Blocks.Tables: the text begins with `#1`, then `double name(rows, columns)`
//! and the rows; CombiTable1Ds has indentation and force in its columns, CombiTable2Ds the indentations in its
//! first column and the clearances in its first row.

use super::interpolation::Interpolation;
use super::numbers::{plain, rounded};
use super::sheet::{Format, Sheet, listed};

pub static FORMAT: Format = Format {
    name: "modelica",
    suffix: ".mo",
    reserved: "algorithm and annotation block break class connect connector constant constrainedby der discrete \
               each else elseif elsewhen encapsulated end enumeration equation expandable extends external \
               false final flow for function if import impure in initial inner input loop model not operator or \
               outer output package parameter partial protected public pure record redeclare replaceable return \
               stream then true type when while within",
    about: "a Modelica package with functions of its own, and a text for CombiTable1Ds or CombiTable2Ds",
    two_dimensional: true,
    rules: &[Interpolation::Hermite, Interpolation::Steffen, Interpolation::Linear],
    damping: true,
    length: 1e-3,
    write,
    ..Format::LINEAR
};

fn write(sheet: &Sheet) -> Vec<(&'static str, String)> {
    let table = &sheet.table;
    let (count, clearances) = (table.indentations.len(), table.clearances.len());
    let name = &sheet.name;
    let (input, pass) = match sheet.is_family() {
        true => ("    input Real radial_clearance(unit=\"m\");\n", ", radial_clearance"),
        false => ("", ""),
    };
    let data = |values: &[Vec<f64>], factor: f64| {
        let row = |row: &Vec<f64>| vector(row, factor);
        format!("[{clearances}, {count}] = {{{}}}", values.iter().map(row).collect::<Vec<_>>().join(",\n"))
    };
    let mut constants = format!("    constant Real xs[{count}] = {};\n", vector(&table.indentations, 1e-3));
    constants += &format!("    constant Real fs{};\n", data(&table.forces, 1.0));
    constants += &format!("    constant Real ks{};\n", data(&table.stiffnesses, 1e3));
    let mut place = String::from("    row := 1;\n    share := 0;\n");
    if sheet.is_family() {
        constants += &format!("    constant Real cs[{clearances}] = {};\n", vector(&table.clearances, 1e-3));
        place = PLACE.replace("@clearances@", &clearances.to_string());
    }
    let function = |function: &str, about: &str, unit: &str, beyond: &str, value: &str| {
        FUNCTION
            .replace("@constants@", &constants)
            .replace("@place@", &place)
            .replace("@input@", input)
            .replace("@function@", function)
            .replace("@about@", about)
            .replace("@unit@", unit)
            .replace("@beyond@", beyond)
            .replace("@value@", value)
            .replace("@count@", &count.to_string())
            .replace("@turns@", if sheet.is_family() { "2" } else { "1" })
    };

    let mut text = format!("package {name} \"Force of a pin joint with clearance over its indentation\"\n");
    text += &sheet.head("  // ");
    text += &function(
        "force",
        "N, at an indentation in m",
        "N",
        "fs[c, @count@] + ks[c, @count@]*(indentation - xs[@count@])",
        "fs[c, low] + width*s*(ks[c, low] + s*(square + s*cube))",
    );
    text += &function(
        "stiffness",
        "dF/d(indentation), N/m",
        "N/m",
        "ks[c, @count@]",
        "ks[c, low] + s*(2*square + 3*s*cube)",
    );
    if let Some(impact) = sheet.impact {
        // s/mm to s/m.
        let factor = plain(impact.coefficient * 1e3);
        text += &DAMPED.replace("@input@", input).replace("@factor@", &factor).replace("@pass@", pass);
    }
    let clearance = plain(table.clearances[clearances / 2] * 1e-3);
    let gap = if sheet.goes_below_zero() { "max(0, radial_clearance)" } else { "radial_clearance" };
    text += &EXAMPLE.replace("@clearance@", &clearance).replace("@pass@", pass).replace("@gap@", gap);
    text += &format!("end {name};\n");
    vec![("", text), (".txt", combi_table(sheet))]
}

fn vector(values: &[f64], factor: f64) -> String {
    let values: Vec<f64> = values.iter().map(|value| rounded(value * factor, 12)).collect();
    format!("{{\n{}}}", listed(&values, 6, "      ", ""))
}

const FUNCTION: &str = "
  function @function@ \"@about@\"
    input Real indentation(unit=\"m\");
@input@    output Real result(unit=\"@unit@\");
  protected
@constants@    Integer low;
    Integer high;
    Integer row;
    Integer c;
    Real share;
    Real weight;
    Real width;
    Real s;
    Real secant;
    Real square;
    Real cube;
  algorithm
@place@    low := 1;
    for i in 2:@count@ - 1 loop
      if xs[i] <= indentation then
        low := i;
      end if;
    end for;
    high := low + 1;
    width := xs[high] - xs[low];
    s := (indentation - xs[low])/width;
    result := 0;
    for r in 1:@turns@ loop
      c := row + r - 1;
      weight := if r == 1 then 1 - share else share;
      if indentation >= xs[@count@] then
        result := result + weight*(@beyond@);
      elseif indentation > 0 then
        secant := (fs[c, high] - fs[c, low])/width;
        square := 3*secant - 2*ks[c, low] - ks[c, high];
        cube := ks[c, low] + ks[c, high] - 2*secant;
        result := result + weight*(@value@);
      end if;
    end for;
  end @function@;
";

/// The row below a clearance, and its share in the one above.
const PLACE: &str = "    row := 1;
    for i in 2:@clearances@ - 1 loop
      if cs[i] <= radial_clearance then
        row := i;
      end if;
    end for;
    share := max(0, min(1, (radial_clearance - cs[row])/(cs[row + 1] - cs[row])));
";

const DAMPED: &str = "
  function force_damped \"N, with damping; the speed of indentation in m/s; never a pull\"
    input Real indentation(unit=\"m\");
    input Real speed(unit=\"m/s\");
@input@    output Real result(unit=\"N\");
  algorithm
    result := max(0, 1 + @factor@*speed)*force(indentation@pass@);
  end force_damped;
";

const EXAMPLE: &str = "
  model Example \"A mass of 1 kg that swings in the joint's clearance\"
    parameter Real radial_clearance(unit=\"m\") = @clearance@;
    Real x(unit=\"m\", start=0, fixed=true) \"from the hole's centre\";
    Real v(unit=\"m/s\", start=0.01, fixed=true);
  equation
    der(x) = v;
    der(v) = force(-x - @gap@@pass@) - force(x - @gap@@pass@);
  end Example;
";

fn combi_table(sheet: &Sheet) -> String {
    let x = sheet.with_gap();
    let (name, head) = (&sheet.name, sheet.head("# "));
    let mut text = String::from("#1\n");
    text += &head;
    if sheet.is_family() {
        let rows: Vec<Vec<f64>> =
            (0..sheet.table.clearances.len()).map(|i| sheet.forces_with_gap(i)).collect();
        text += "# CombiTable2Ds(tableOnFile=true, smoothness=LinearSegments), u1 = indentation, u2 = radial clearance\n";
        text += &format!("double {name}({}, {})\n", x.len() + 1, rows.len() + 1);
        let axis: Vec<String> = sheet.table.clearances.iter().map(|c| plain(c * 1e-3)).collect();
        text += &format!("0.0 {}\n", axis.join(" "));
        for (j, x) in x.iter().enumerate() {
            let forces: Vec<String> = rows.iter().map(|row| plain(row[j])).collect();
            text += &format!("{} {}\n", plain(*x), forces.join(" "));
        }
    } else {
        text +=
            "# CombiTable1Ds(tableOnFile=true, smoothness=MonotoneContinuousDerivative2 or LinearSegments,\n";
        text += "#   extrapolation=LastTwoPoints)\n";
        text += &format!("double {name}({}, 2)\n", x.len());
        for (x, force) in sheet.pairs() {
            text += &format!("{} {}\n", plain(x), plain(force));
        }
    }
    text
}
