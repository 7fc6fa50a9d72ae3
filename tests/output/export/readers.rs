//! Readers of the formats, each from its target's documentation, and the rules by which the targets go between
//! points.

type Pairs = Vec<(f64, f64)>;
type Family = Vec<(f64, Pairs)>;

fn number(text: &str) -> f64 {
    text.trim().parse().unwrap_or_else(|_| panic!("`{text}` is not a number"))
}

fn all_numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty()).map(number).collect()
}

fn zipped(x: &[f64], y: &[f64]) -> Pairs {
    assert_eq!(x.len(), y.len());
    x.iter().copied().zip(y.iter().copied()).collect()
}

/// RFC 4180, a header in the first line.
pub fn csv(text: &str) -> Pairs {
    let mut reader = ::csv::Reader::from_reader(text.as_bytes());
    assert_eq!(reader.headers().unwrap(), vec!["indentation_mm", "force_n", "tangent_stiffness_n_per_mm"]);
    let pair = |row: ::csv::StringRecord| {
        assert!(number(&row[2]) >= 0.0);
        (number(&row[0]), number(&row[1]))
    };
    reader.records().map(|row| pair(row.unwrap())).collect()
}

pub fn csv_family(text: &str) -> Family {
    let mut reader = ::csv::Reader::from_reader(text.as_bytes());
    assert_eq!(&reader.headers().unwrap()[0], "radial_clearance_mm");
    let mut family: Family = Vec::new();
    for row in reader.records() {
        let row: Vec<f64> = row.unwrap().iter().map(number).collect();
        match family.last_mut().filter(|(clearance, _)| *clearance == row[0]) {
            Some((_, pairs)) => pairs.push((row[1], row[2])),
            None => family.push((row[0], vec![(row[1], row[2])])),
        }
    }
    family
}

/// Adams Solver, statement SPLINE (adams_solver/com_spline): arguments after commas, a line that begins with one
/// goes on, `!` begins a comment. Returns the values of X and of each Y.
fn spline(text: &str) -> (Vec<f64>, Vec<Vec<f64>>) {
    let lines = text.lines().filter(|line| !line.starts_with('!'));
    let mut statement = String::new();
    for line in lines {
        assert!(statement.is_empty() || line.starts_with(','), "{line}: no continuation");
        statement += line;
    }
    let arguments = statement.strip_prefix("SPLINE/1").unwrap();
    assert!(arguments.ends_with(", LINEAR_EXTRAPOLATE"));
    let (mut x, mut ys) = (Vec::new(), Vec::<Vec<f64>>::new());
    let mut is_x = true;
    for argument in arguments.split(',').map(str::trim).filter(|word| !word.is_empty()) {
        let value = match argument.split_once('=') {
            Some((key, value)) => {
                is_x = key.trim() == "X";
                if !is_x {
                    assert_eq!(key.trim(), "Y");
                    ys.push(Vec::new());
                }
                value
            }
            None if argument == "LINEAR_EXTRAPOLATE" => continue,
            None => argument,
        };
        let values = if is_x { &mut x } else { ys.last_mut().unwrap() };
        values.push(number(value));
    }
    (x, ys)
}

pub fn adams_solver(text: &str) -> Pairs {
    let (x, ys) = spline(text);
    assert_eq!(ys.len(), 1);
    assert!(text.contains("FUNCTION = -MAX(0, AKISPL(DM(10201, 10101) - 0.02, 0, 1))"));
    zipped(&x, &ys[0])
}

pub fn adams_family(text: &str) -> Family {
    let (x, ys) = spline(text);
    ys.iter().map(|y| (y[0], zipped(&x, &y[1..]))).collect()
}

/// Adams View, `data_element create spline`: parameters of one command, lines that go on end with `&`, `!` begins
/// a comment.
fn view(text: &str) -> [Vec<f64>; 3] {
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with('!')).collect();
    let (last, others) = lines.split_last().unwrap();
    assert!(!last.contains('&') && others.iter().all(|line| line.ends_with('&')));
    let command = lines.join(" ").replace('&', " ");
    let mut words = command.strip_prefix("data_element create spline").unwrap().to_string();
    for key in ["spline_name", "linear_extrapolate", "x", "y", "z"] {
        words = words.replace(&format!(" {key} ="), &format!("\n{key}="));
    }
    let values = |key: &str| {
        let line = words.lines().find_map(|line| line.strip_prefix(&format!("{key}=")));
        line.map_or(Vec::new(), all_numbers)
    };
    assert!(words.contains("\nspline_name= .model.") && words.contains("\nlinear_extrapolate= yes"));
    [values("x"), values("y"), values("z")]
}

pub fn adams_view(text: &str) -> Pairs {
    let [x, y, z] = view(text);
    assert!(z.is_empty());
    zipped(&x, &y)
}

pub fn adams_view_family(text: &str) -> Family {
    let [x, y, z] = view(text);
    assert_eq!(y.len(), x.len() * z.len());
    z.iter().zip(y.chunks(x.len())).map(|(z, y)| (*z, zipped(&x, y))).collect()
}

/// Modelica Standard Library, Modelica.Blocks.Tables: `#1`, comments with `#`, `double name(rows, columns)`, the
/// rows.
fn matrix(text: &str) -> Vec<Vec<f64>> {
    assert_eq!(text.lines().next(), Some("#1"));
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let sizes = lines.next().unwrap().strip_prefix("double joint(").unwrap().strip_suffix(')').unwrap();
    let sizes = all_numbers(sizes);
    let rows: Vec<Vec<f64>> = lines.map(all_numbers).collect();
    assert_eq!(rows.len() as f64, sizes[0]);
    assert!(rows.iter().all(|row| row.len() as f64 == sizes[1]));
    rows
}

pub fn combi_table(text: &str) -> Pairs {
    matrix(text).iter().map(|row| (row[0], row[1])).collect()
}

pub fn combi_table_family(text: &str) -> Family {
    let rows = matrix(text);
    let column = |j: usize| rows[1..].iter().map(|row| (row[0], row[j])).collect();
    (1..rows[0].len()).map(|j| (rows[0][j], column(j))).collect()
}

/// OpenSim's XML: lists of doubles with spaces between.
pub fn opensim(text: &str) -> Pairs {
    let list = |key: &str| {
        let rest = text.split(&format!("<{key}>")).nth(1).unwrap();
        all_numbers(rest.split(&format!("</{key}>")).next().unwrap())
    };
    check_comment(text);
    assert!(text.contains("<PiecewiseLinearFunction name=\"joint\">"));
    zipped(&list("x"), &list("y"))
}

/// XML 1.0, section 2.5: no `--` inside a comment.
fn check_comment(text: &str) {
    let comment = text.split("<!--").nth(1).unwrap().split("-->").next().unwrap();
    assert!(!comment.contains("--") && !comment.ends_with('-'));
}

/// MATLAB: `name = [numbers ...`, `...` goes on in the next line, `;` begins a row, `'` transposes, `%` a comment.
fn matlab_values(text: &str, name: &str) -> Vec<Vec<f64>> {
    let code = text.lines().map(|line| line.split('%').next().unwrap()).collect::<Vec<_>>().join("\n");
    let rest = code.split(&format!("{name} = ")).nth(1).unwrap_or_else(|| panic!("no {name}"));
    let value = rest.split(";\n").next().unwrap().split("; \n").next().unwrap().replace("...\n", " ");
    let value = value.trim().trim_end_matches(';').trim_end_matches('\'').replace(['[', ']'], " ");
    value.split(';').map(all_numbers).collect()
}

pub fn matlab(text: &str) -> Pairs {
    let [x, y] = ["joint_indentation", "joint_force"].map(|name| matlab_values(text, name));
    zipped(&x[0], &y[0])
}

pub fn matlab_family(text: &str) -> Family {
    let [x, c, y] =
        ["joint_indentation", "joint_radial_clearance", "joint_force"].map(|name| matlab_values(text, name));
    assert_eq!(c[0].len(), y.len());
    c[0].iter().zip(&y).map(|(c, y)| (*c, zipped(&x[0], y))).collect()
}

/// Nastran, Quick Reference Guide: large fields are an eight-column name with `*`, four fields of sixteen and
/// lines that go on with `*`; NLRGAP in small fields: SID, GA, GB, PLANE, TABK, TABG, TABU, RADIUS; TABLED1: TID,
/// XAXIS, YAXIS, then from the third line on pairs, ENDT.
pub fn nastran(text: &str) -> Pairs {
    let bulk: Vec<&str> = text.lines().filter(|line| !line.starts_with('$')).collect();
    assert!(bulk.iter().all(|line| line.len() <= 72 && line.is_ascii()));
    let gap = bulk.iter().find(|line| line.starts_with("NLRGAP")).unwrap();
    let field = |place: usize| gap[8 * place..8 * (place + 1)].trim();
    assert_eq!([field(4), field(5), field(6), field(7)], ["XY", "-1", "2", "0"]);
    let table = |id: &str| -> Pairs {
        let begin =
            bulk.iter().position(|line| line.starts_with("TABLED1*") && line[8..24].trim() == id).unwrap();
        assert_eq!([bulk[begin][24..40].trim(), bulk[begin][40..56].trim()], ["LINEAR", "LINEAR"]);
        assert_eq!(bulk[begin + 1].trim(), "*");
        let mut words: Vec<String> = Vec::new();
        for line in &bulk[begin + 2..] {
            assert!(line.starts_with("*       "));
            // A line that is short has blank fields at its end, unless ENDT came before them.
            let is_last = line.trim().ends_with("ENDT");
            let line = if is_last { line.to_string() } else { format!("{line:<72}") };
            let fields: Vec<String> = line.as_bytes()[8..]
                .chunks(16)
                .map(|field| String::from_utf8_lossy(field).trim().into())
                .collect();
            words.extend(fields);
            if words.last().is_some_and(|word| word == "ENDT") {
                words.pop();
                assert!(words.iter().all(|word| word.contains('.')), "a real has a point");
                return words.chunks(2).map(|pair| (number(&pair[0]), number(&pair[1]))).collect();
            }
        }
        panic!("no ENDT");
    };
    assert_eq!(table("2"), [(0.0, 0.02), (1.0, 0.02)]);
    assert!(bulk.iter().any(|line| line.starts_with("PBUSHT        10      KN       1")));
    table("1")
}

/// MotionSolve, "Reference: Spline": `num_xy_pair` pairs in the element's text.
pub fn motionsolve(text: &str) -> Pairs {
    check_comment(text);
    let element = text.split("<Reference_Spline").nth(1).unwrap();
    let (attributes, rest) = element.split_once('>').unwrap();
    assert!(attributes.contains("linear_extrap = \"TRUE\""));
    let count = attributes.split("num_xy_pair   = \"").nth(1).unwrap().split('"').next().unwrap();
    let values = all_numbers(rest.split("</Reference_Spline>").next().unwrap());
    assert_eq!(values.len(), 2 * count.parse::<usize>().unwrap());
    values.chunks(2).map(|pair| (pair[0], pair[1])).collect()
}

/// RecurDyn and Ansys Motion, "Spline": rows of x and y, nothing else.
pub fn two_columns(text: &str) -> Pairs {
    text.lines().map(|line| line.split_once(',').map(|(x, y)| (number(x), number(y))).unwrap()).collect()
}

/// Chrono::Vehicle, "TSDA": an array of arrays of two numbers.
pub fn chrono(text: &str) -> Pairs {
    let value: serde_json::Value = serde_json::from_str(text).unwrap();
    let curve = value["Spring Curve Data"].as_array().unwrap();
    curve.iter().map(|pair| (pair[0].as_f64().unwrap(), pair[1].as_f64().unwrap())).collect()
}

/// MBDyn, input manual, "Multilinear": `scalar function: "name", multilinear, x, y, ...;`, `#` begins a comment.
pub fn mbdyn(text: &str) -> Pairs {
    let code: String = text.lines().filter(|line| !line.starts_with('#')).collect::<Vec<_>>().join(" ");
    let rest = code.strip_prefix("scalar function: \"joint\", multilinear,").unwrap();
    let values = all_numbers(rest.strip_suffix(';').unwrap());
    values.chunks(2).map(|pair| (pair[0], pair[1])).collect()
}

/// Rows of force and displacement below a keyword; `**` begins a comment.
fn force_first(text: &str, keyword: &str) -> Pairs {
    let lines: Vec<&str> = text.lines().filter(|line| !line.starts_with("**")).collect();
    let begin = lines.iter().position(|line| line.starts_with(keyword)).unwrap();
    let rows = lines[begin + 1..].iter().filter(|line| !line.trim().is_empty());
    rows.map(|line| all_numbers(line)).map(|row| (row[1], row[0])).collect()
}

/// CalculiX CrunchiX manual, *SPRING, NONLINEAR.
pub fn calculix(text: &str) -> Pairs {
    force_first(text, "*SPRING, ELSET=joint, NONLINEAR")
}

/// Abaqus keywords guide, *CONNECTOR ELASTICITY, NONLINEAR.
pub fn abaqus(text: &str) -> Pairs {
    assert!(text.contains("*CONNECTOR BEHAVIOR, NAME=joint, EXTRAPOLATION=LINEAR, REGULARIZE=OFF\n"));
    force_first(text, "*CONNECTOR ELASTICITY, COMPONENT=1, NONLINEAR, EXTRAPOLATION=LINEAR")
}

/// LS-DYNA keyword manual, *DEFINE_CURVE: eight fields of ten columns, then two of twenty; `$` begins a comment.
pub fn ls_dyna(text: &str) -> Pairs {
    let mut lines = text.lines().filter(|line| !line.starts_with('$'));
    assert_eq!((lines.next(), lines.next()), (Some("*DEFINE_CURVE_TITLE"), Some("joint")));
    let card = lines.next().unwrap();
    let fields: Vec<&str> = (0..8).map(|i| card[10 * i..10 * (i + 1)].trim()).collect();
    assert_eq!(fields, ["1", "0", "1.0", "1.0", "0.0", "0.0", "0", "10000"]);
    lines.map(|line| (number(&line[..20]), number(&line[20..40]))).collect()
}

pub fn linear(pairs: &[(f64, f64)], place: f64) -> f64 {
    let after = pairs.iter().position(|(x, _)| *x > place).unwrap_or(pairs.len() - 1);
    let [(x0, y0), (x1, y1)] = [pairs[after - 1], pairs[after]];
    y0 + (y1 - y0) * (place - x0) / (x1 - x0)
}

/// A cubic between two points with slopes there, in Newton's form.
fn cubic([(x0, y0), (x1, y1)]: [(f64, f64); 2], [t0, t1]: [f64; 2], place: f64) -> f64 {
    let (h, m) = (x1 - x0, (y1 - y0) / (x1 - x0));
    let (second, third) = ((m - t0) / h, (t0 + t1 - 2.0 * m) / (h * h));
    let d = place - x0;
    y0 + d * (t0 + d * (second + (place - x1) * third))
}

/// H. Akima, J. ACM 17 (1970) 589-602, equations (1) and (9). Only inside: the places have two points on either
/// side, or the end's.
pub fn akima(pairs: &[(f64, f64)], place: f64) -> f64 {
    let n = pairs.len() as isize;
    let secant = |i: isize| -> f64 {
        let own = |i: isize| {
            let [(x0, y0), (x1, y1)] = [pairs[i as usize], pairs[i as usize + 1]];
            (y1 - y0) / (x1 - x0)
        };
        // m5 = 2 m4 - m3, and so on, beyond the ends.
        match i {
            -1 => 2.0 * own(0) - own(1),
            -2 => 3.0 * own(0) - 2.0 * own(1),
            i if i == n - 1 => 2.0 * own(n - 2) - own(n - 3),
            i if i == n => 3.0 * own(n - 2) - 2.0 * own(n - 3),
            i => own(i),
        }
    };
    let slope = |i: isize| {
        let [m1, m2, m3, m4] = [secant(i - 2), secant(i - 1), secant(i), secant(i + 1)];
        let (left, right) = ((m4 - m3).abs(), (m2 - m1).abs());
        if left + right == 0.0 { 0.5 * (m2 + m3) } else { (left * m2 + right * m3) / (left + right) }
    };
    let after = pairs.iter().position(|(x, _)| *x > place).unwrap_or(pairs.len() - 1);
    let before = after as isize - 1;
    cubic([pairs[after - 1], pairs[after]], [slope(before), slope(before + 1)], place)
}

/// M. Steffen, Astronomy and Astrophysics 239 (1990) 443-450, equation (11).
pub fn steffen(pairs: &[(f64, f64)], place: f64) -> f64 {
    let secant = |i: usize| (pairs[i + 1].1 - pairs[i].1) / (pairs[i + 1].0 - pairs[i].0);
    let slope = |i: usize| {
        if i == 0 || i + 1 == pairs.len() {
            return secant(i.min(pairs.len() - 2));
        }
        let (left, right) = (secant(i - 1), secant(i));
        if left * right <= 0.0 {
            return 0.0;
        }
        let (h0, h1) = (pairs[i].0 - pairs[i - 1].0, pairs[i + 1].0 - pairs[i].0);
        let p = (left * h1 + right * h0) / (h0 + h1);
        p.signum() * (0.5 * p.abs()).min(left.abs()).min(right.abs()) * 2.0
    };
    let after = pairs.iter().position(|(x, _)| *x > place).unwrap_or(pairs.len() - 1);
    cubic([pairs[after - 1], pairs[after]], [slope(after - 1), slope(after)], place)
}
