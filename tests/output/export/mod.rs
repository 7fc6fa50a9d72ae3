//! Exported tables, read back by readers that are written from the targets' documentation, against the joint's own
//! curve at places that are not in the tables; and what is refused.

mod readers;
mod press_fits;
mod refusals;

use std::process::Command;
use std::time::Instant;

use crate::common::random::Random;
use crate::common::workdir::Workdir;
use jointsweep::{Curve, Dimensions, Idealization, Joint, Load, Material, Options, Part};

const CONFIG: &str = r#"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = CLEARANCES
thickness = "8 mm"
[joint.pin]
model = "rigid-core"
core_radius_ratio = 0.2
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = RATIOS
youngs_modulus = "70 GPa"
poissons_ratio = 0.33
[load]
indentation = ["0.0004 mm", "0.004 mm", "0.0291 mm"]
[solve]
accuracy = "0.1 %"
"#;

/// Largest indentation of the config, mm.
const END: f64 = 0.0291;

/// What is asked of the interpolation, unless said.
const ERROR: f64 = 1e-3;

/// A folder with a result in `out/sweep`.
fn solved(name: &str, clearances: &str, ratios: &str) -> Workdir {
    let work = Workdir::new(name);
    work.write("sweep.toml", &CONFIG.replace("CLEARANCES", clearances).replace("RATIOS", ratios));
    work.run(&["run", "sweep.toml", "--quiet"]).expect(0);
    work
}

fn curve(radial_clearance: f64) -> Curve {
    let part = |model: &str, ratio: (&str, f64), youngs_modulus: f64, poissons_ratio: f64| {
        Part::new(model, &[ratio], None, Material { youngs_modulus, poissons_ratio }).unwrap()
    };
    let joint = Joint::new(
        Dimensions { hole_radius: 10.0, radial_clearance, thickness: 8.0 },
        Idealization::PlaneStress,
        part("rigid-core", ("core_radius_ratio", 0.2), 210e3, 0.3),
        part("annulus", ("outer_radius_ratio", 3.0), 70e3, 0.33),
    );
    joint.unwrap().curve(Options { accuracy: 1e-3, ..Options::default() }).unwrap()
}

/// Indentations over five decades, and as many spread evenly.
fn places(count: usize) -> Vec<f64> {
    let mut random = Random::new(15);
    let wide = (0..count / 2).map(|_| END * random.log(1.1e-5, 1.0)).collect::<Vec<f64>>();
    let even = (0..count / 2).map(|_| END * random.linear(0.01, 1.0)).collect::<Vec<f64>>();
    [wide, even].concat()
}

/// Checks a table of one clearance as a file of a format has it, in mm and N.
fn check_table(format: &str, pairs: &[(f64, f64)]) {
    assert!(pairs.len() >= 6 && pairs.len() <= 400, "{format}: {} points", pairs.len());
    assert!(pairs.windows(2).all(|pair| pair[0].0 < pair[1].0), "{format}: not ascending");
    assert!(pairs[0].0 < 0.0 && pairs.contains(&(0.0, 0.0)), "{format}: no gap or no origin");
    assert!(pairs.iter().all(|(x, force)| (*x <= 0.0) == (*force == 0.0) && *force >= 0.0), "{format}");
    assert!(
        (pairs[pairs.len() - 1].0 / END - 1.0).abs() < 1e-8,
        "{format}: does not reach the largest indentation"
    );
    let inside =
        |low: f64, high: f64| pairs.iter().filter(|(x, _)| *x > low * END && *x <= high * END).count();
    assert!(inside(0.0, 0.5) > inside(0.5, 1.0), "{format}: not denser near zero");
}

/// The worst relative deviation of a function from a curve at places.
fn worst(curve: &Curve, places: &[f64], force: impl Fn(f64) -> f64) -> f64 {
    let loads: Vec<Load> = places.iter().map(|delta| Load::Indentation(*delta)).collect();
    let truth = curve.answers(&loads).unwrap();
    assert_eq!(truth.len(), places.len());
    let off = |(step, delta): (&jointsweep::StepOutcome, &f64)| {
        let off = (force(*delta) / step.response.unwrap().force - 1.0).abs();
        if off.is_nan() { f64::INFINITY } else { off }
    };
    truth.iter().zip(places).map(off).fold(0.0, f64::max)
}

/// Every format with pairs, its reader, what its unit of length is in mm, and how its target goes between the
/// pairs.
#[test]
fn every_table_follows_the_curve_by_the_targets_own_rule() {
    use readers::{akima, linear, steffen};
    type Read = fn(&str) -> Vec<(f64, f64)>;
    type Rule = fn(&[(f64, f64)], f64) -> f64;
    let cases: [(&str, &str, Read, f64, &[Rule]); 14] = [
        ("csv", "t.csv", readers::csv, 1.0, &[linear]),
        ("adams", "t.adm", readers::adams_solver, 1.0, &[akima]),
        ("adams", "t.cmd", readers::adams_view, 1.0, &[akima]),
        ("modelica", "t.txt", readers::combi_table, 1e3, &[steffen, linear]),
        ("opensim", "t.osim", readers::opensim, 1e3, &[linear]),
        ("simscape", "t.m", readers::matlab, 1e3, &[linear]),
        ("nastran", "t.bdf", readers::nastran, 1.0, &[linear]),
        ("motionsolve", "t.xml", readers::motionsolve, 1.0, &[akima, linear]),
        ("recurdyn", "t.csv", readers::two_columns, 1.0, &[akima, linear]),
        ("chrono", "t.json", readers::chrono, 1e3, &[linear]),
        ("mbdyn", "t.mbd", readers::mbdyn, 1e3, &[linear]),
        ("calculix", "t.inp", readers::calculix, 1.0, &[linear]),
        ("abaqus", "t.inp", readers::abaqus, 1.0, &[linear]),
        ("ls-dyna", "t.k", readers::ls_dyna, 1.0, &[linear]),
    ];
    let work = solved("export-formats", "\"0.02 mm\"", "3");
    let (curve, places) = (curve(0.02), places(400));
    let hash = jointsweep::internals::study::fingerprint::Fingerprint::of(
        work.read("out/sweep/manifest.json").as_bytes(),
    )
    .hash();
    for (format, file, read, unit, rules) in cases {
        let main = match format {
            "adams" => "t.adm",
            "modelica" => "t.mo",
            _ => file,
        };
        let ended = work.run(&["export", "out/sweep", "--to", format, "--out", main, "--force"]).expect(0);
        assert!(ended.stdout.contains(main), "{format}: {}", ended.stdout);
        let text = work.read(file);
        let pairs: Vec<(f64, f64)> = read(&text).into_iter().map(|(x, force)| (x * unit, force)).collect();
        check_table(format, &pairs);
        // OpenSim's slopes are wrong between points less than 1e-7 m apart.
        let first = if format == "opensim" { 1.21e-3 } else { 0.0 };
        assert!(format != "opensim" || pairs.windows(2).all(|pair| pair[1].0 - pair[0].0 >= 1e-4));
        let places: Vec<f64> = places.iter().copied().filter(|place| *place > first).collect();
        for rule in rules {
            let worst = worst(&curve, &places, |delta| rule(&pairs, delta));
            assert!(worst < ERROR, "{format}: {worst}");
        }
        // Who reads the file alone knows what it is.
        let about = if file.ends_with("csv") { work.read("t_about.txt") } else { text.clone() };
        let joined = about.replace(['\n', '!', '*', '$', '#', '%'], " ");
        let joined = joined.split_whitespace().collect::<Vec<_>>().join(" ");
        for said in [
            hash.as_str(),
            "pin_model rigid-core",
            "reference: support",
            "force_error",
            "Extrapolation:",
            env!("CARGO_PKG_VERSION"),
        ] {
            assert!(joined.contains(said), "{format} does not say {said}: {joined}");
        }
        assert!(text.lines().all(|line| line.len() <= 128 || format == "opensim"), "{format}: a long line");
    }
}

/// Numbers are plain decimals where the format has room: some readers know no exponent.
#[test]
fn numbers_are_plain_decimals() {
    let work = solved("export-plain", "\"0.02 mm\"", "3");
    let mut numbers = 0;
    for format in jointsweep::internals::output::export::FORMATS.map(|format| format.name) {
        work.run(&["export", "out/sweep", "--to", format, "--out", "t.txt", "--force"]).expect(0);
        for word in work.read("t.txt").split(|c: char| c.is_whitespace() || ",[](){};".contains(c)) {
            if word.parse::<f64>().is_ok() && word.contains('.') {
                numbers += 1;
                assert!(!word.contains(['e', 'E']) || format == "nastran", "{format}: {word}");
            }
        }
    }
    assert!(numbers > 2000, "{numbers}");
}

/// The examples of layers have tables at the accuracy that is asked of tables: their forces and slopes belong together, and all their rows are ok.
#[test]
fn examples_of_layers_are_exported() {
    let work = Workdir::new("export-layers");
    for name in ["bush", "coating", "lined-block"] {
        let config = format!("{}/configs/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let out = format!("out/{name}");
        work.run(&["run", &config, "--out", &out, "--quiet"]).expect(0);
        work.run(&["export", &out, "--design", "0", "--to", "csv", "--out", "t.csv", "--force"]).expect(0);
        let points = readers::csv(&work.read("t.csv")).len();
        assert!(points > 5 && points < 200, "{name}: {points} points");
    }
}

fn run_in(work: &Workdir, program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).current_dir(work.path("")).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{program}: {text}{}", String::from_utf8_lossy(&output.stderr));
    text
}

/// Lines of numbers, as the programs below print them.
fn numbers(text: &str) -> Vec<Vec<f64>> {
    text.lines().map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect()).collect()
}

fn listed(places: &[f64]) -> String {
    places.iter().map(|place| format!("{place:?}")).collect::<Vec<_>>().join(", ")
}

/// Values, slopes by differences, zero at and below zero, continuous slopes, straight on beyond, against the
/// library.
fn check_function(text: &str, curve: &Curve, places: &[f64]) {
    let found = numbers(text);
    assert_eq!(found.len(), places.len() + 4);
    let (inside, outside) = found.split_at(places.len());
    let (mut of_force, mut of_slope) = (0.0_f64, 0.0_f64);
    for (row, delta) in inside.iter().zip(places) {
        let &[force, stiffness, before, after, step] = &row[..] else { panic!("{row:?}") };
        let truth = curve.at(Load::Indentation(*delta)).unwrap();
        of_force = of_force.max((force / truth.force - 1.0).abs());
        of_slope = of_slope.max((stiffness / truth.tangent_stiffness - 1.0).abs());
        let difference = (after - before) / (2.0 * step);
        // A cubic's difference of this step is off by its third derivative, 1e-6 of the slope.
        assert!((difference / stiffness - 1.0).abs() < 1e-5, "{delta}: {difference} {stiffness}");
    }
    assert!(of_force < ERROR && of_slope < 3.0 * ERROR, "{of_force} {of_slope}");
    let end = curve.at(Load::Indentation(END)).unwrap();
    assert_eq!(outside[0][..2], [0.0, 0.0], "below zero");
    assert_eq!(outside[1][..2], [0.0, 0.0], "at zero");
    // A simulation that diverges must not look like an open gap.
    assert!(outside[2][0].is_nan() && outside[2][1].is_nan(), "not a number");
    let beyond = end.force + 0.5 * END * end.tangent_stiffness;
    assert!(
        (outside[3][0] / beyond - 1.0).abs() < 1e-6
            && (outside[3][1] / end.tangent_stiffness - 1.0).abs() < 1e-6
    );
}

#[test]
#[cfg_attr(not(c_compiler), ignore = "no C compiler here")]
fn the_c_header_is_the_curve() {
    let work = solved("export-c", "\"0.02 mm\"", "3");
    work.run(&["export", "out/sweep", "--to", "c", "--out", "joint.h"]).expect(0);
    let places = places(1000);
    let all = [&places[..], &[-1.0, 0.0]].concat();
    let program = format!(
        "#include <stdio.h>\n#include <math.h>\n#include \"joint.h\"\nint main(void) {{\n\
         double xs[] = {{{}, NAN, {:?}}};\nfor (unsigned i = 0; i < sizeof xs/sizeof *xs; i++) {{\n\
         double x = xs[i], h = 1e-4*x;\nprintf(\"%.17g %.17g %.17g %.17g %.17g\\n\", joint_force(x), joint_stiffness(x), \
         joint_force(x - h), joint_force(x + h), h);\n}}\nreturn 0;\n}}\n",
        listed(&all),
        1.5 * END
    );
    work.write("main.c", &program);
    run_in(&work, "cc", &["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "main.c", "-o", "main", "-lm"]);
    let main = work.path("main").display().to_string();
    check_function(&run_in(&work, &main, &[]), &curve(0.02), &places);
}

#[test]
#[cfg_attr(not(python3), ignore = "no python3 here")]
fn the_python_module_is_the_curve() {
    let work = solved("export-python", "\"0.02 mm\"", "3");
    for (format, file) in [("python", "joint.py"), ("exudyn", "joint_exudyn.py")] {
        work.run(&["export", "out/sweep", "--to", format, "--out", file]).expect(0);
        let places = places(400);
        let all = [&places[..], &[-1.0, 0.0]].concat();
        let program = format!(
            "import {} as j\nfor x in [{}, float('nan'), {:?}]:\n    h = 1e-4*x\n    print(j.force(x), j.stiffness(x), \
             j.force(x - h), j.force(x + h), h)\n",
            file.trim_end_matches(".py"),
            listed(&all),
            1.5 * END
        );
        work.write("main.py", &program);
        check_function(&run_in(&work, "python3", &["-B", "main.py"]), &curve(0.02), &places);
    }
}

/// Where Hermite's segments meet, the stiffness jumps by nothing: read from the module's own arrays.
#[test]
#[cfg_attr(not(python3), ignore = "no python3 here")]
fn the_stiffness_does_not_jump_between_segments() {
    let work = solved("export-jumps", "\"0.02 mm\"", "3");
    work.run(&["export", "out/sweep", "--to", "python", "--out", "joint.py"]).expect(0);
    work.write(
        "main.py",
        "import joint as j\nfor x in j.INDENTATIONS[1:-1]:\n    print(j.stiffness(x*(1 - 1e-9)), j.stiffness(x*(1 + 1e-9)))\n",
    );
    let sides = numbers(&run_in(&work, "python3", &["-B", "main.py"]));
    assert!(sides.len() > 6);
    for side in sides {
        assert!((side[1] / side[0] - 1.0).abs() < 1e-6, "{side:?}");
    }
}

const CLEARANCES: &str =
    "[\"0.08 mm\", \"0.02 mm\", \"0.03 mm\", \"0.05 mm\", \"0.025 mm\", \"0.065 mm\", \"0.04 mm\"]";

/// In the modules of the family, at their own clearances and between them, both languages.
#[test]
#[cfg_attr(not(all(c_compiler, python3)), ignore = "no C compiler or no python3 here")]
fn a_family_follows_the_curves_at_and_between_its_clearances() {
    let work = solved("export-family", CLEARANCES, "3");
    let export = |format: &str, file: &str| {
        work.run(&[
            "export",
            "out/sweep",
            "--to",
            format,
            "--over",
            "radial_clearance",
            "--out",
            file,
            "--name",
            "pin",
        ])
        .expect(0)
    };
    export("c", "pin.h");
    export("python", "pin.py");
    let head = work.read("pin.py").replace("\n#", " ").split_whitespace().collect::<Vec<_>>().join(" ");
    let told = head.split("Between clearances: ").nth(1).unwrap().split("within ").nth(1).unwrap();
    let stated = 0.01 * told.split(' ').next().unwrap().parse::<f64>().unwrap();
    assert!(stated > 0.0 && stated < 2e-3, "{stated}");
    let (own, between) = ([0.02, 0.03, 0.08], [0.0224, 0.0447, 0.0721]);
    let places = places(100);
    let mut asked = Vec::new();
    for clearance in own.into_iter().chain(between) {
        asked.extend(places.iter().map(|place| (*place, clearance)));
    }
    let pairs: Vec<String> = asked.iter().map(|(x, c)| format!("{x:?}, {c:?}")).collect();
    work.write(
        "main.c",
        &format!(
            "#include <stdio.h>\n#include \"pin.h\"\nint main(void) {{\nstatic const double q[][2] = {{{{{}}}}};\n\
             for (unsigned i = 0; i < sizeof q/sizeof *q; i++)\nprintf(\"%.17g %.17g\\n\", pin_force(q[i][0], q[i][1]), \
             pin_stiffness(q[i][0], q[i][1]));\nreturn 0;\n}}\n",
            pairs.join("}, {")
        ),
    );
    work.write(
        "main.py",
        &format!(
            "import pin\nfor x, c in [({})]:\n    print(pin.force(x, c), pin.stiffness(x, c))\n",
            pairs.join("), (")
        ),
    );
    run_in(&work, "cc", &["-std=c99", "-Wall", "-Wextra", "-Werror", "main.c", "-o", "main", "-lm"]);
    let in_c = numbers(&run_in(&work, &work.path("main").display().to_string(), &[]));
    let in_python = numbers(&run_in(&work, "python3", &["-B", "main.py"]));
    assert_eq!((in_c.len(), in_python.len()), (600, 600));
    for (c, python) in in_c.iter().flatten().zip(in_python.iter().flatten()) {
        assert!((c / python - 1.0).abs() < 1e-12);
    }
    for (rows, clearance) in in_c.chunks(100).zip(own.into_iter().chain(between)) {
        let curve = curve(clearance);
        let bound = if own.contains(&clearance) { ERROR } else { ERROR + 1.2 * stated };
        for (row, place) in rows.iter().zip(&places) {
            let truth = curve.at(Load::Indentation(*place)).unwrap();
            assert!((row[0] / truth.force - 1.0).abs() < bound, "{clearance} {place}: {row:?} {truth:?}");
            assert!(
                (row[1] / truth.tangent_stiffness - 1.0).abs() < 4.0 * bound,
                "{clearance} {place}: {row:?} {truth:?}"
            );
        }
    }
}

/// Adams' families, the CSV, CombiTable2Ds and MATLAB's matrix hold the curves of all clearances.
#[test]
fn tables_over_the_clearance_hold_every_curve() {
    let work = solved("export-families", CLEARANCES, "3");
    let own = [0.02, 0.025, 0.03, 0.04, 0.05, 0.065, 0.08];
    let curves = own.map(curve);
    let places = places(60);
    type Read = fn(&str) -> Vec<(f64, Vec<(f64, f64)>)>;
    type Rule = fn(&[(f64, f64)], f64) -> f64;
    let cases: [(&str, &str, &str, Read, f64, Rule); 5] = [
        ("adams", "t.adm", "t.adm", readers::adams_family, 1.0, readers::akima),
        ("adams", "t.adm", "t.cmd", readers::adams_view_family, 1.0, readers::akima),
        ("csv", "t.csv", "t.csv", readers::csv_family, 1.0, readers::linear),
        ("modelica", "t.mo", "t.txt", readers::combi_table_family, 1e3, readers::linear),
        ("simscape", "t.m", "t.m", readers::matlab_family, 1e3, readers::linear),
    ];
    for (format, main, file, read, unit, rule) in cases {
        work.run(&[
            "export",
            "out/sweep",
            "--to",
            format,
            "--over",
            "radial_clearance",
            "--out",
            main,
            "--force",
            "--quiet",
        ])
        .expect(0);
        let family = read(&work.read(file));
        assert_eq!(family.len(), own.len(), "{format}");
        for ((clearance, pairs), (own, curve)) in family.iter().zip(own.iter().zip(&curves)) {
            assert!((clearance * unit / own - 1.0).abs() < 1e-9, "{format}");
            let pairs: Vec<(f64, f64)> = pairs.iter().map(|(x, force)| (x * unit, *force)).collect();
            check_table(format, &pairs);
            let worst = worst(curve, &places, |delta| rule(&pairs, delta));
            assert!(worst < ERROR, "{format} {own}: {worst}");
        }
    }
}

/// Twenty clearances by some forty indentations, as a whole process: the best of five, because others use this machine too.
#[test]
#[cfg_attr(debug_assertions, ignore = "measured in release builds")]
fn a_table_over_the_clearance_takes_a_fifth_of_a_second() {
    let work = solved("export-speed", "{ from = \"0.01 mm\", to = \"0.1 mm\", count = 20 }", "3");
    let arguments =
        ["export", "out/sweep", "--to", "c", "--over", "radial_clearance", "--out", "t.h", "--force"];
    let run = || {
        let started = Instant::now();
        let ended = work.run(&[&arguments[..], &["--error", "0.005 %"]].concat()).expect(0);
        let points: usize = ended.stdout.split(' ').next().unwrap().parse().unwrap();
        assert!(points >= 40 && ended.stdout.contains("each of 20 clearances"), "{}", ended.stdout);
        started.elapsed()
    };
    let best = (0..5).map(|_| run()).min().unwrap();
    assert!(best.as_secs_f64() < 0.2, "{best:?}");
}

/// A smaller error is kept, with more points; one that wants too many is refused, and it is said which can be had.
#[test]
fn the_error_asked_is_kept() {
    let work = solved("export-error", "\"0.02 mm\"", "3");
    let (curve, places) = (curve(0.02), places(400));
    let mut counts = Vec::new();
    for (error, bound) in [("1 %", 1e-2), ("0.1 %", 1e-3), ("0.0001", 1e-4)] {
        work.run(&["export", "out/sweep", "--to", "mbdyn", "--error", error, "--out", "t.mbd", "--force"])
            .expect(0);
        let pairs: Vec<(f64, f64)> =
            readers::mbdyn(&work.read("t.mbd")).iter().map(|(x, y)| (1e3 * x, *y)).collect();
        let worst = worst(&curve, &places, |delta| readers::linear(&pairs, delta));
        assert!(worst < bound, "{error}: {worst}");
        counts.push(pairs.len());
    }
    assert!(counts.windows(2).all(|pair| pair[0] < pair[1]), "{counts:?}");
    let with_error =
        |error: &str| work.run(&["export", "out/sweep", "--to", "mbdyn", "--error", error, "--out", "u.mbd"]);
    let refused = with_error("0.0005 %").expect(1).stderr;
    let (_, told) = refused.split_once("0.0005 % needs more than 400 points: ").expect(&refused);
    let larger = told.trim_end().strip_suffix(" can be had").expect(&refused);
    assert!(work.files().iter().all(|file| file != "u.mbd"));
    with_error(larger).expect(0);
}

/// Relative to the mean motion of the rings, the plate's size is nearly out of the table: beyond the local field
/// it only adds to the motion of its ring.
#[test]
fn the_ring_mean_leaves_the_local_compliance() {
    let work = solved("export-ring", "\"0.02 mm\"", "[30, 300]");
    // Of the pin's core the same: a far boundary either way.
    let cores = CONFIG.replace("CLEARANCES", "\"0.02 mm\"").replace("RATIOS", "3");
    work.write("cores.toml", &cores.replace("core_radius_ratio = 0.2", "core_radius_ratio = [0.03, 0.003]"));
    work.run(&["run", "cores.toml", "--quiet"]).expect(0);
    let table = |result: &str, design: &str, reference: &str| {
        let asked = ["export", result, "--to", "csv", "--design", design, "--reference", reference];
        work.run(&[&asked[..], &["--out", "t.csv", "--force"]].concat()).expect(0);
        readers::csv(&work.read("t.csv"))
    };
    let near = |result: &str, reference: &str| -> f64 {
        let (small, large) = (table(result, "0", reference), table(result, "1", reference));
        let end = small[small.len() - 1].0.min(large[large.len() - 1].0);
        let off = |share: f64| {
            let [small, large] = [&small, &large].map(|pairs| readers::linear(pairs, share * end));
            (small / large - 1.0).abs()
        };
        [0.001, 0.01, 0.1, 0.3, 0.6, 0.99].map(off).into_iter().fold(0.0, f64::max)
    };
    // What is left falls like the square of the ratio, about 1/900; each table is within 0.1 %.
    for (result, apart) in [("out/sweep", 0.2), ("out/cores", 0.04)] {
        let (support, ring) = (near(result, "support"), near(result, "ring-mean"));
        assert!(support > apart && ring < 4e-3, "{result}: {support} {ring}");
    }
    // Softer springs in series: the ring's part is taken out, the force at the same indentation is larger.
    let (whole, local) = (table("out/sweep", "0", "support"), table("out/sweep", "0", "ring-mean"));
    assert!(local[local.len() - 1].0 < 0.9 * whole[whole.len() - 1].0);
    assert!((local[local.len() - 1].1 / whole[whole.len() - 1].1 - 1.0).abs() < 1e-6);
}

/// Damping: c is told, and so is what an impact with the table really has.
#[test]
#[cfg_attr(not(python3), ignore = "no python3 here")]
fn damping_has_the_restitution_that_it_tells() {
    let work = solved("export-damping", "\"0.02 mm\"", "3");
    let asked = ["--restitution", "0.7", "--speed", "0.2 m/s"];
    let arguments = ["export", "out/sweep", "--to", "python", "--out", "joint.py"];
    work.run(&[&arguments[..], &asked[..]].concat()).expect(0);
    let text = work.read("joint.py").replace("\n#", " ").split_whitespace().collect::<Vec<_>>().join(" ");
    let after = |mark: &str| -> f64 {
        let rest = text.split(mark).nth(1).unwrap_or_else(|| panic!("no {mark} in {text}"));
        rest.split([' ', ')']).next().unwrap().parse().unwrap()
    };
    let (told, mass) = (after("Integrated with this table: "), after("(mass "));
    assert!((told - 0.7).abs() < 0.05, "{told}");
    // An impact of that mass, by a rule of its own: velocity Verlet with a damped force, in kg, mm and s.
    work.write(
        "main.py",
        &format!(
            "import joint\nx, v, h = 0.0, 200.0, {END}/200.0/20000\nwhile True:\n    \
             a = -1e3*joint.force_damped(x, v)/{mass}\n    w = v + 0.5*h*a\n    x += h*w\n    \
             v = w - 0.5*h*1e3*joint.force_damped(x, w)/{mass}\n    if x <= 0.0: break\nprint(-v/200.0)\n"
        ),
    );
    let real = numbers(&run_in(&work, "python3", &["-B", "main.py"]))[0][0];
    assert!((real - told).abs() < 1e-3, "{real} {told}");
    for format in ["c", "exudyn", "adams", "modelica"] {
        let arguments = ["export", "out/sweep", "--to", format, "--out", "t.txt", "--force"];
        work.run(&[&arguments[..], &asked[..]].concat()).expect(0);
        assert!(
            work.read("t.txt").contains("1") && work.read("t.txt").contains("Damping: F (1 + c v)"),
            "{format}"
        );
    }
}
