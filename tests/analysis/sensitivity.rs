//! Sobol' indices against functions and joints whose indices are known in closed form, their intervals against how often they
//! hold, and the whole program.

use std::f64::consts::PI;

use crate::common::random::Random;
use crate::common::workdir::Workdir;
use jointsweep::internals::sensitivity::indices::{Estimate, Indices, Moments, indices, spread};
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::sampling::{Axis, Sampler, Scheme};
use jointsweep::internals::study::values::Pick;

type Function = fn(&[f64]) -> f64;

/// Ishigami & Homma, 1990, with a = 7 and b = 0.1 over (-pi, pi)^3.
fn ishigami(unit: &[f64]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|i| PI * (2.0 * unit[i] - 1.0));
    x.sin() + 7.0 * y.sin().powi(2) + 0.1 * z.powi(4) * x.sin()
}

/// Variances: b pi^4/5 + b^2 pi^8/50 + 1/2 of x alone, a^2/8 of y, 8 b^2 pi^8/225 of x and z.
fn ishigami_indices() -> [[f64; 3]; 2] {
    let x = 0.1 * PI.powi(4) / 5.0 + 0.01 * PI.powi(8) / 50.0 + 0.5;
    let (y, xz) = (49.0 / 8.0, 0.08 * PI.powi(8) / 225.0);
    let all = x + y + xz;
    [[x / all, y / all, 0.0], [(x + xz) / all, y / all, xz / all]]
}

fn linear(unit: &[f64]) -> f64 {
    1e6 + unit[0] + 2.0 * unit[1] + 3.0 * unit[2]
}

/// The program's own design.
fn saltelli(rows: u64, seed: u64) -> impl FnMut(u64, usize, usize) -> f64 {
    let axes: Vec<Axis> =
        (0..3).map(|start| Axis { key: String::new(), line: 1, start, count: None }).collect();
    let sampler = Sampler::new(Scheme::Saltelli { rows, seed }, &axes).unwrap();
    assert_eq!(sampler.design_count(), 5 * rows);
    move |row, member, axis| match sampler.pick(5 * row + member as u64, axis) {
        Pick::Fraction(fraction) => fraction,
        Pick::Index(_) => panic!("a range is continuous"),
    }
}

/// Rows that know nothing of each other.
fn independent(seed: u64) -> impl FnMut(u64, usize, usize) -> f64 {
    let mut random = Random::new(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let (mut at, mut points) = (u64::MAX, [0.0; 6]);
    move |row, member, axis| {
        if row != at {
            at = row;
            points.fill_with(|| random.unit());
        }
        points[if member == 1 || member == axis + 2 { axis + 3 } else { axis }]
    }
}

/// A, B, C_1, C_2, C_3 of each row.
fn values(function: Function, rows: u64, mut unit: impl FnMut(u64, usize, usize) -> f64) -> Vec<[f64; 5]> {
    let mut value = |row, member| function(&[0, 1, 2].map(|axis| unit(row, member, axis)));
    (0..rows).map(|row| [0, 1, 2, 3, 4].map(|member| value(row, member))).collect()
}

fn of(values: &[[f64; 5]]) -> Indices {
    let mut moments = Moments::new(3, values.len() as u64);
    values.iter().for_each(|row| moments.add_row(&row.map(Some)));
    indices(&moments).unwrap()
}

/// First orders, then totals.
fn estimates(indices: &Indices) -> [[Estimate; 3]; 2] {
    let factor = |i: usize| indices.factors[i];
    [[0, 1, 2].map(|i| factor(i).first_order), [0, 1, 2].map(|i| factor(i).total)]
}

fn holds(estimate: &Estimate, value: f64) -> bool {
    (estimate.low..=estimate.high).contains(&value)
}

#[test]
fn ishigami_has_its_exact_indices() {
    let exact = ishigami_indices();
    let published = [[0.3139, 0.4424, 0.0], [0.5576, 0.4424, 0.2437]];
    let found = estimates(&of(&values(ishigami, 1024, saltelli(1024, 0))));
    for order in 0..2 {
        for i in 0..3 {
            let (estimate, exact) = (found[order][i], exact[order][i]);
            println!("{order} {i} {exact:.4} {estimate:?}");
            assert!((exact - published[order][i]).abs() < 5e-5);
            // Some five times the mean error that is measured below.
            assert!(holds(&estimate, exact) && (estimate.value - exact).abs() < 0.04, "{estimate:?} {exact}");
            assert!(estimate.low < estimate.value && estimate.value < estimate.high);
        }
    }
}

/// Of `SEEDS` studies, in how many each interval holds the exact index of Ishigami's function.
fn held<P: FnMut(u64, usize, usize) -> f64>(points: impl Fn(u64) -> P) -> [u32; 6] {
    let exact = ishigami_indices();
    let mut held = [0; 6];
    for seed in 0..SEEDS {
        let found = estimates(&of(&values(ishigami, 1024, points(seed))));
        for place in 0..6 {
            let (order, i) = (place / 3, place % 3);
            held[place] += u32::from(holds(&found[order][i], exact[order][i]));
        }
    }
    println!("{held:?} of {SEEDS}");
    held
}

const SEEDS: u64 = 100;

/// The bootstrap by itself: 95 of 100, with three standard deviations of the binomial law, which are 6.5.
#[test]
fn intervals_of_independent_rows_hold_as_often_as_they_say() {
    let held = held(independent);
    assert!(held.iter().all(|held| (88..=100).contains(held)), "{held:?}");
    // Intervals that always hold are too wide.
    assert!(held.iter().sum::<u32>() < 590, "{held:?}");
}

/// Points of a Sobol sequence scatter less than independent ones, so the same intervals hold more often.
#[test]
fn intervals_of_the_design_hold_at_least_as_often_as_they_say() {
    let held = held(|seed| saltelli(1024, seed));
    assert!(held.iter().all(|held| (95..=100).contains(held)), "{held:?}");
}

/// Of the estimators of the first order the one with the least error where a factor does little, and exactly 0 where it does
/// nothing; elsewhere they are alike.
#[test]
fn the_estimator_is_as_good_as_the_others() {
    let errors = mean_errors(independent);
    assert!(errors[0] < errors[1] && errors[0] < errors[2], "{errors:?}");
    let even = mean_errors(|seed| saltelli(1024, seed));
    assert!(even[0] < 0.7 * errors[0] && even[0] < 1.2 * even[1].min(even[2]), "{even:?} {errors:?}");

    let inert = values(|unit| unit[0].exp() * (1.0 + unit[1]), 64, saltelli(64, 3));
    let found = of(&inert);
    let zero = Estimate { value: 0.0, low: 0.0, high: 0.0 };
    assert_eq!((found.factors[2].first_order, found.factors[2].total), (zero, zero));
    assert!(jansen(&inert, 2).abs() > 1e-4 && janon(&inert, 2).abs() > 1e-4);
}

/// Root mean square errors of the first orders of Ishigami's function: ours, Jansen's, Janon's.
fn mean_errors<P: FnMut(u64, usize, usize) -> f64>(points: impl Fn(u64) -> P) -> [f64; 3] {
    let exact = ishigami_indices()[0];
    let mut squares = [0.0; 3];
    for seed in 0..SEEDS {
        let values = values(ishigami, 1024, points(seed));
        let ours = estimates(&of(&values))[0].map(|estimate| estimate.value);
        let others = [jansen, janon].map(|estimator| [0, 1, 2].map(|i| estimator(&values, i)));
        for (square, found) in squares.iter_mut().zip([ours, others[0], others[1]]) {
            *square += (0..3).map(|i| (found[i] - exact[i]).powi(2)).sum::<f64>() / (3 * SEEDS) as f64;
        }
    }
    let errors = squares.map(f64::sqrt);
    println!("saltelli, jansen, janon: {errors:.4?}");
    errors
}

fn mean(values: &[[f64; 5]], of: impl Fn(&[f64; 5]) -> f64) -> f64 {
    values.iter().map(of).sum::<f64>() / values.len() as f64
}

/// Jansen, 1999: 1 - E[(B - C_i)^2]/(2 V).
fn jansen(values: &[[f64; 5]], i: usize) -> f64 {
    let middle = mean(values, |row| 0.5 * (row[0] + row[1]));
    let variance = mean(values, |row| 0.5 * ((row[0] - middle).powi(2) + (row[1] - middle).powi(2)));
    1.0 - mean(values, |row| (row[1] - row[i + 2]).powi(2)) / (2.0 * variance)
}

/// Janon et al., ESAIM: Probability and Statistics 18 (2014): the correlation of B and C_i with pooled mean and variance.
fn janon(values: &[[f64; 5]], i: usize) -> f64 {
    let middle = mean(values, |row| 0.5 * (row[1] + row[i + 2]));
    let product = mean(values, |row| row[1] * row[i + 2]);
    let square = mean(values, |row| 0.5 * (row[1].powi(2) + row[i + 2].powi(2)));
    (product - middle * middle) / (square - middle * middle)
}

/// Far from zero, where sums of squares would lose their digits.
#[test]
fn what_only_adds_up_has_equal_orders() {
    let values = values(linear, 1024, saltelli(1024, 1));
    let found = of(&values);
    for (i, share) in [1.0 / 14.0, 4.0 / 14.0, 9.0 / 14.0].into_iter().enumerate() {
        let factor = &found.factors[i];
        for estimate in [factor.first_order, factor.total] {
            assert!(holds(&estimate, share) && (estimate.value - share).abs() < 2e-3, "{i} {estimate:?}");
        }
    }
    let sum = found.sum_of_first_orders;
    assert!(holds(&sum, 1.0) && (sum.value - 1.0).abs() < 2e-3, "{sum:?}");
    let mut moments = Moments::new(3, 1024);
    values.iter().for_each(|row| moments.add_row(&row.map(Some)));
    let (mean, deviation) = spread(&moments).unwrap();
    assert!((mean - 1e6 - 3.0).abs() < 1e-3 && (deviation / (14.0f64 / 12.0).sqrt() - 1.0).abs() < 2e-3);
}

/// A pin so stiff that only the plate gives way: F = t E f(indentation).
const JOINT: &str = r#"
[joint]
idealization     = "plane-strain"
hole_radius      = "10 mm"
radial_clearance = "0.05 mm"
thickness        = THICKNESS
[joint.pin]
model          = "rigid-core"
youngs_modulus = "1e9 GPa"
poissons_ratio = 0.3
[joint.plate]
model              = "annulus"
outer_radius_ratio = 3.0
youngs_modulus     = MODULUS
poissons_ratio     = 0.3
[load]
indentation = ["0.01 mm", "0.03 mm"]
"#;

fn joint(thickness: &str, modulus: &str, more: &str) -> String {
    JOINT.replace("THICKNESS", thickness).replace("MODULUS", modulus) + more
}

/// From the means of x and x^2 and of y and y^2, the indices of x y and its deviation over its mean.
fn product_indices(x: [f64; 2], y: [f64; 2]) -> ([[f64; 2]; 2], f64) {
    let variance = |[mean, square]: [f64; 2]| square - mean * mean;
    let all = x[1] * y[1] - (x[0] * y[0]).powi(2);
    let first = [variance(x) * y[0] * y[0] / all, variance(y) * x[0] * x[0] / all];
    ([first, [1.0 - first[1], 1.0 - first[0]]], all.sqrt() / (x[0] * y[0]))
}

#[test]
fn a_joint_has_the_indices_that_follow_from_its_mechanics() {
    let work = Workdir::new("sensitivity-joint");
    let decade = 10f64.ln();
    // A counted range is continuous: uniform from 4 to 16, not its ends. A list has equal shares.
    let cases = [
        (
            "{ from = \"4 mm\", to = \"16 mm\", count = 2 }",
            "{ from = \"10 GPa\", to = \"100 GPa\", count = 3, spacing = \"log\" }",
            "",
            [10.0, 112.0],
            [90.0 / decade, 9900.0 / (2.0 * decade)],
        ),
        (
            "[\"4 mm\", \"8 mm\", \"16 mm\", \"20 mm\"]",
            "{ from = \"50 GPa\", to = \"150 GPa\" }",
            "[sampling]\nmethod = \"latin-hypercube\"\ncount = 7\n",
            [12.0, 184.0],
            [100.0, 1e4 + 1e4 / 12.0],
        ),
    ];
    let mut compared = 0;
    for (thickness, modulus, sampling, of_thickness, of_modulus) in cases {
        work.write("joint.toml", &joint(thickness, modulus, sampling));
        let run = |more: &[&str]| {
            work.run(&[&["sensitivity", "joint.toml", "--samples", "2048", "--force"], more].concat())
                .expect(0)
        };
        let told = run(&["--of", "force,peak_pressure_mpa"]).stdout;
        assert!(
            told.contains("force_n at indentation 0.03 mm: mean ") && told.contains("8192 designs"),
            "{told}"
        );
        let (exact, relative) = product_indices(of_thickness, of_modulus);
        let table = work.table("out/joint/sensitivity/sensitivity.csv");
        assert_eq!(table.column("factor"), ["thickness", "plate.youngs_modulus"].repeat(2));
        assert_eq!(table.column("column"), ["force_n", "force_n", "peak_pressure_mpa", "peak_pressure_mpa"]);
        let number = |name: &str, row: usize| table.column(name)[row].parse::<f64>().unwrap();
        for (order, name) in ["first_order", "total"].into_iter().enumerate() {
            for i in 0..2 {
                let [low, high] = ["low", "high"].map(|end| number(&format!("{name}_{end}"), i));
                let (found, exact) = (number(name, i), exact[order][i]);
                println!("{name} {i} {exact:.4} {found:.4} {low:.4} {high:.4}");
                assert!((low..=high).contains(&exact) && (found - exact).abs() < 0.01, "{name} {i}");
                compared += 1;
            }
            // The pressure knows nothing of the thickness.
            assert!(number(name, 2).abs() < 1e-9 && (number(name, 3) - 1.0).abs() < 0.01);
        }
        let manifest = work.json("out/joint/sensitivity/manifest.json");
        assert_eq!(manifest["command"], "sensitivity");
        let [mean, deviation] =
            ["mean", "standard_deviation"].map(|name| manifest["columns"][0][name].as_f64().unwrap());
        assert!((deviation / mean / relative - 1.0).abs() < 0.01, "{deviation} {mean} {relative}");

        // Another step, another seed, another value.
        let before = work.read("out/joint/sensitivity/sensitivity.csv");
        run(&["--step", "1", "--quiet"]);
        let first = work.table("out/joint/sensitivity/sensitivity.csv");
        assert_eq!(first.column("step"), ["1", "1"]);
        let shares = [&first, &table].map(|table| table.column("total")[0].parse::<f64>().unwrap());
        assert!((shares[0] - shares[1]).abs() < 1e-6, "{shares:?}");
        run(&["--of", "force,peak_pressure", "--quiet"]);
        assert_eq!(work.read("out/joint/sensitivity/sensitivity.csv"), before);
        run(&["--of", "force,peak_pressure", "--quiet", "--seed", "1"]);
        assert_ne!(work.read("out/joint/sensitivity/sensitivity.csv"), before);
        run(&["--set", "joint.plate.youngs_modulus=70 GPa", "--of", "force_n", "--of", "peak_pressure"]);
        let table = work.table("out/joint/sensitivity/sensitivity.csv");
        assert_eq!(table.column("factor"), ["thickness"; 2]);
        assert!((table.column("total")[0].parse::<f64>().unwrap() - 1.0).abs() < 0.01);
        assert_eq!(table.column("first_order_low")[1], "");
    }
    assert_eq!(compared, 8);

    // F/t knows nothing of the thickness, and has the indices that the force has at a given thickness: all is the modulus's.
    let told = work.run(&[
        "sensitivity",
        "joint.toml",
        "--of=force, force / thickness,max(peak_pressure / (1 MPa), 0)",
        "--out=expressions",
    ]);
    let told = told.expect(0).stdout;
    assert!(
        told.contains("force / thickness at indentation 0.03 mm: mean ") && told.contains(" N/mm, "),
        "{told}"
    );
    let table = work.table("expressions/sensitivity.csv");
    let [per_length, ratio] = ["force / thickness", "max(peak_pressure / (1 MPa), 0)"];
    assert_eq!(table.column("column"), ["force_n", "force_n", per_length, per_length, ratio, ratio]);
    let totals: Vec<f64> = table.column("total").iter().map(|cell| cell.parse().unwrap()).collect();
    assert!(totals[0] > 0.1, "{totals:?}");
    for expression in totals[2..].chunks(2) {
        assert!(expression[0].abs() < 1e-9 && (expression[1] - 1.0).abs() < 0.01, "{totals:?}");
    }

    let told = work.run(&[
        "sensitivity",
        "joint.toml",
        "--of=peak_pressure",
        "--set=joint.plate.youngs_modulus=70 GPa",
        "--out=constant",
    ]);
    assert!(told.expect(0).stdout.contains("it does not change"));
    let picture = work.read("constant/sensitivity.svg");
    assert!(picture.contains("does not change") && roxmltree::Document::parse(&picture).is_ok());
}

/// Blocks, whose bodies are all different and interpolated, to the last bit.
#[test]
fn results_do_not_depend_on_threads() {
    let work = Workdir::new("sensitivity-threads");
    let config = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/sensitivity/clevis.toml");
    let written = ["1", "3"].map(|threads| {
        let out = format!("out{threads}");
        let arguments =
            ["sensitivity", config, "--of", "force,peak_pressure", "--threads", threads, "--out", &out];
        work.run(&arguments).expect(0);
        ["csv", "svg"].map(|ending| work.read(&format!("{out}/sensitivity.{ending}")))
    });
    assert_eq!(written[0], written[1]);
    assert_eq!(work.table("out1/sensitivity.csv").records.len(), 12);
    let picture = roxmltree::Document::parse(&written[0][1]).unwrap();
    let bars =
        picture.descendants().filter(|node| node.attribute("class").is_some_and(|c| c.starts_with("bar f")));
    // Two of each factor and column, and two in the legend.
    assert_eq!(bars.count(), 2 * 12 + 2);
}

const BLOCK: &str = r#"
[joint]
idealization     = "plane-strain"
hole_radius      = "10 mm"
radial_clearance = "0.05 mm"
thickness        = { from = "4 mm", to = "16 mm" }
[joint.pin]
model          = "rigid-core"
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model            = "block"
half_width_ratio = RATIOS
depth_ratio      = 2.0
height_ratio     = 2.0
youngs_modulus   = "70 GPa"
poissons_ratio   = 0.3
[load]
force = ["1 kN"]
[sampling]
method = "sobol"
count = 4
"#;

/// Ligaments of 2 % are refused by meshes: a sample of two points has one more often than a design.
#[test]
fn samples_with_a_design_that_fails_are_left_out_and_counted() {
    let work = Workdir::new("sensitivity-failed");
    let text = BLOCK.replace("RATIOS", "[1.5, 1.02, 2.0, 3.0]");
    work.write("block.toml", &text);
    let told = work.run(&["sensitivity", "block.toml", "--samples", "128"]).expect(2).stdout;
    let study = Study::from_text(&work.path("block.toml"), text).unwrap();
    let study = study.for_sensitivity(128, 0, None).unwrap();
    let is_thin: Vec<bool> = study
        .cases()
        .unwrap()
        .map(|case| case.unwrap().joint.plate.parameter("half_width_ratio") == Some(1.02))
        .collect();
    assert_eq!(is_thin.len(), 4 * 128);
    let thin_rows = is_thin.chunks(4).filter(|row| row.contains(&true)).count();
    assert!((40..64).contains(&thin_rows), "{thin_rows}");
    let left_out = format!("left out: {thin_rows} samples with a design that has no indentation_mm\n");
    assert!(told.contains(&left_out), "{told}");
    let failed = is_thin.iter().filter(|thin| **thin).count();
    assert!(told.contains(&format!("{failed} designs: failed: the thinnest ligament")), "{told}");
    let manifest = work.json("out/block/sensitivity/manifest.json");
    assert_eq!(manifest["columns"][0]["samples_left_out"], thin_rows);

    work.write("block.toml", &BLOCK.replace("RATIOS", "[1.02, 3.0]"));
    let refused =
        work.run(&["sensitivity", "block.toml", "--samples", "64", "--out", "none"]).expect(1).stderr;
    assert!(refused.contains(" of 64 samples have a design without indentation_mm, "), "{refused}");
    assert!(refused.contains("more than half") && refused.contains("thinnest ligament"), "{refused}");
    assert!(!work.path("none").exists());
}

#[test]
fn what_has_no_sensitivity_is_refused() {
    let work = Workdir::new("sensitivity-refused");
    let (range, list) = ("{ from = \"4 mm\", to = \"16 mm\", count = 2 }", "[\"10 GPa\", \"100 GPa\"]");
    work.write("good.toml", &joint(range, list, ""));
    work.write("one.toml", &joint("\"4 mm\"", "\"70 GPa\"", ""));
    work.write("zip.toml", &joint(range, list, "[sampling]\nmethod = \"zip\"\n"));
    let configs = concat!(env!("CARGO_MANIFEST_DIR"), "/configs/designs-example.toml");
    let cases: [(&[&str], &str); 14] = [
        (
            &["good.toml", "--of", "peek_pressure"],
            "there is no column `peek_pressure`; did you mean `peak_pressure`?",
        ),
        (
            &["good.toml", "--of", "thickness_mm"],
            "`thickness_mm`: there is no result in it, only what the config prescribes",
        ),
        (&["good.toml", "--of", "force,force_n"], "`force_n`: it is named twice"),
        (&["good.toml", "--of", "indentation"], "`indentation_mm`: the config prescribes it"),
        (
            &["good.toml", "--of", "indentation * thickness"],
            "`indentation * thickness`: there is no result in it",
        ),
        (&["good.toml", "--of", "force > 2 N"], "this is a condition, where a column"),
        (&["good.toml", "--of", "force, force + thickness"], "a force (N) and a length (mm) cannot be added"),
        (&["good.toml", "--step", "0"], "good.toml: there is no load step 0: the config has 2"),
        (&["good.toml", "--step", "3"], "good.toml: there is no load step 3: the config has 2"),
        (&["good.toml", "--samples", "63"], "a whole number from 64 on is needed, best a power of two"),
        (&["good.toml", "--samples", "1000000000"], "too many designs; at most 1000000000 are allowed"),
        (&["one.toml"], "one.toml: nothing sweeps: give at least one quantity of [joint] a range or a list"),
        (&["zip.toml"], "zip moves `thickness`, `plate.youngs_modulus` together"),
        (&[configs], "the designs of [designs] are a fixed list"),
    ];
    for (arguments, problem) in cases {
        let refused = work.run(&[&["sensitivity"], arguments].concat()).expect(1);
        assert!(refused.stderr.contains(problem), "{arguments:?}: {}", refused.stderr);
    }
    assert!(!work.path("out").exists());

    // One axis cannot move with another.
    work.write("zip.toml", &joint(range, "\"70 GPa\"", "[sampling]\nmethod = \"zip\"\n"));
    work.run(&["sensitivity", "zip.toml", "--samples", "64", "--quiet"]).expect(0);
    let before = work.read("out/zip/sensitivity/sensitivity.csv");
    let refused = work.run(&["sensitivity", "zip.toml", "--samples", "128"]).expect(1).stderr;
    assert!(refused.contains("out/zip/sensitivity holds the sensitivities of zip.toml: "), "{refused}");
    assert_eq!(work.read("out/zip/sensitivity/sensitivity.csv"), before);
    // Nor is the result of another command overwritten.
    work.run(&["run", "zip.toml", "--quiet"]).expect(0);
    let refused = work.run(&["sensitivity", "zip.toml", "--out", "out/zip"]).expect(1).stderr;
    assert!(refused.contains("the result of `jointsweep run` for zip.toml"), "{refused}");
}
