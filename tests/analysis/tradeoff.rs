//! `jointsweep tradeoff` as a user runs it, and that the families of choices err in the order that theory says.

use crate::common::draws::{concentric, draw, half_disc_in_annulus};
use crate::common::workdir::Workdir;
use jointsweep::internals::lab::tradeoff::answer::States;
use jointsweep::internals::lab::tradeoff::choice::{Choice, Scope};
use jointsweep::internals::lab::tradeoff::errors::{Errors, Quantiles};
use jointsweep::internals::lab::tradeoff::families::{FAMILIES, choices, choices_of, named};
use jointsweep::internals::lab::tradeoff::joints::{least_contact_angle, not_compared};
use jointsweep::internals::lab::tradeoff::oracle::Oracle;
use jointsweep::internals::study::config::Study;
use jointsweep::internals::study::design::{DesignCase, Load};

/// Designs of both kinds of pin whose contact is neither tiny nor as wide as a half ring.
fn cases() -> Vec<DesignCase> {
    let drawn = [draw(5, 4, concentric), draw(6, 4, half_disc_in_annulus)].concat();
    let pressed = |mut case: DesignCase| {
        let clearance = case.joint.radial_clearance;
        case.steps = [0.1, 0.5, 1.5].map(|share| Load::Indentation(share * clearance)).to_vec().into();
        case
    };
    drawn.into_iter().map(pressed).collect()
}

fn of_family<'a>(family: &str, cases: &[DesignCase]) -> Vec<Choice<'a>> {
    let family = named(family).unwrap();
    choices_of(family, &Scope { gpu: None, least_angle: least_contact_angle(cases) })
}

/// Errors of every choice of a family, in the order of its parameter, where `exact` answers every step.
fn errors(family: &str, cases: &[DesignCase], exact: &States) -> Vec<Errors> {
    let of_choice = |choice: Choice| {
        let errors = Errors::new(&(choice.solve)(cases).states, exact);
        assert_eq!(errors.steps, cases.iter().map(|case| case.steps.len()).sum::<usize>());
        let Quantiles { median, p95, max } = force(&errors);
        println!(
            "{family}, {}: {median:.1e} {p95:.1e} {max:.1e}, {} unanswered",
            choice.name, errors.unanswered
        );
        errors
    };
    of_family(family, cases).into_iter().map(of_choice).collect()
}

fn force(errors: &Errors) -> Quantiles {
    errors.force.unwrap()
}

fn worst_forces(errors: &[Errors]) -> Vec<f64> {
    errors.iter().map(|errors| force(errors).max).collect()
}

/// Every choice has an answer to every step of designs like these, except closed forms beyond their range and `series`
/// where it does not apply.
#[test]
fn finer_is_nearer_and_node_contact_is_coarser() {
    let cases = cases();
    let exact = Oracle::new(&cases).states;

    let own = errors("moving-edge-q8", &cases, &exact);
    let linear = errors("moving-edge-q4", &cases, &exact);
    let nodes = errors("node-contact-q8", &cases, &exact);
    let median = |errors: &Errors| force(errors).median;
    for errors in [&own, &linear, &nodes] {
        assert!(errors.iter().all(|errors| errors.unanswered == 0));
        let [first, .., last] = &errors[..] else { panic!("several choices") };
        // From the coarsest mesh to the finest: at the least a quarter of the spacing, at first order.
        assert!(median(last) < 0.25 * median(first));
    }
    assert_eq!([own.len(), linear.len(), nodes.len()], [5, 5, 3]);
    for (own, other) in own.iter().zip(&linear) {
        // Seen: 0.15 at most.
        assert!(median(own) < 0.2 * median(other), "Q8 is the nearest on any level");
    }
    // The coarsest of a sweep's meshes beside meshes graded to the contact.
    for nodes in &nodes {
        assert!(median(&own[0]) < 0.8 * median(nodes));
    }
}

/// A penalty errs by its factor's inverse until the mesh errs more; an augmented Lagrangian comes to exact contact.
#[test]
fn penalty_and_augmented_lagrangian_tend_to_exact_contact() {
    let cases = cases();
    let exact_contact = &of_family("node-contact-q8", &cases)[1];
    assert_eq!(exact_contact.name, "q = 4");
    let exact = (exact_contact.solve)(&cases).states;

    let penalty = worst_forces(&errors("penalty", &cases, &exact));
    for pair in penalty.windows(2) {
        let ratio = pair[0] / pair[1];
        // First order is 10; the softest springs change who touches.
        assert!((5.0..15.0).contains(&ratio), "{penalty:?}");
    }
    // Seen: 3.6e-7.
    assert!(penalty.len() == 7 && penalty[6] < 5e-7, "{penalty:?}");

    let augmented = errors("augmented-lagrangian", &cases, &exact);
    let (forces, iterations): (Vec<f64>, Vec<f64>) =
        augmented.iter().map(|errors| (force(errors).max, errors.iterations.unwrap())).unzip();
    assert_eq!(forces.len(), 6);
    assert!(forces.windows(2).all(|pair| pair[1] < pair[0]), "{forces:?}");
    assert!(iterations.windows(2).all(|pair| pair[1] > pair[0]), "{iterations:?}");
    for (decade, error) in forces.iter().enumerate() {
        // The gap left is this share of the indentation, and the force at most as much: seen 1.0 times and less.
        assert!(*error < 1.3 * 10f64.powi(-1 - decade as i32), "{forces:?}");
    }
}

/// Goal: against the same mesh by Cholesky the variational correction squares the error of conjugate gradients; in f32
/// it ends where f32 does, refined in f64 it does not.
#[test]
fn the_correction_squares_the_error_of_conjugate_gradients() {
    let cases: Vec<DesignCase> = cases().into_iter().step_by(3).collect();
    let cholesky = &of_family("cholesky", &cases)[1];
    assert_eq!(cholesky.name, "level 2");
    let exact = (cholesky.solve)(&cases).states;
    let [corrected, plain, single, mixed] =
        ["pcg-f64", "pcg-f64-uncorrected", "pcg-f32", "pcg-mixed"].map(|family| {
            errors(family, &cases, &exact).iter().map(|errors| force(errors).p95).collect::<Vec<f64>>()
        });
    // Orders over the decades 1e-2 to 1e-5: 1 is first, 2 second.
    let order = |errors: &[f64]| (errors[1] / errors[4]).log10() / 3.0;
    println!("orders {:.2} and {:.2}", order(&corrected), order(&plain));
    assert!((order(&plain) - 1.0).abs() < 0.35, "{plain:?}");
    assert!((order(&corrected) - 2.0).abs() < 0.4, "{corrected:?}");
    assert_eq!([&corrected, &plain, &single, &mixed].map(Vec::len), [8; 4]);
    // At a residual of 0.1 both are of the order of the residual.
    assert!(corrected[1..].iter().zip(&plain[1..]).all(|(corrected, plain)| corrected < plain));
    // Rounding of f32, whatever is asked; small because the residual of the correction is in f64. Seen: 2.3e-11.
    assert!(single[7] > 100.0 * corrected[7] && single[7] < 1e-10, "{single:?}");
    assert!(mixed[7] < 0.01 * single[7], "{mixed:?}");
}

/// The lanes and sparse Cholesky are two ways to one answer.
#[test]
fn solvers_agree() {
    let cases = cases();
    let lanes = (of_family("moving-edge-q8", &cases)[0].solve)(&cases).states;
    let errors = &errors("cholesky", &cases, &lanes)[0];
    // Rounding of two eliminations: seen 1.3e-14.
    assert!(force(errors).max < 1e-12 && errors.unanswered == 0);
}

/// Under prescribed forces every choice that has an answer comes to the same joint as under the indentation it finds.
#[test]
fn forces_are_found() {
    let mut cases = cases();
    cases = vec![cases.remove(0), cases.remove(4)];
    let exact = Oracle::new(&cases).states;
    for (case, states) in cases.iter_mut().zip(&exact) {
        case.steps = states.iter().map(|state| Load::Force(state.unwrap().force)).collect();
    }
    let by_force = Oracle::new(&cases).states;
    assert_eq!([&by_force, &exact].map(|states| states.iter().flatten().count()), [6; 2]);
    for (by_force, exact) in by_force.iter().flatten().zip(exact.iter().flatten()) {
        let (by_force, exact) = (by_force.unwrap(), exact.unwrap());
        assert!((by_force.indentation / exact.indentation - 1.0).abs() < 1e-8);
        assert!((by_force.tangent_stiffness / exact.tangent_stiffness - 1.0).abs() < 1e-7);
    }
    for family in ["moving-edge-q8", "node-contact-q8", "penalty", "augmented-lagrangian"] {
        let choice = of_family(family, &cases).pop().unwrap();
        let states = (choice.solve)(&cases).states;
        let errors = Errors::new(&states, &by_force);
        println!("{family}, {}: {:.1e}", choice.name, force(&errors).max);
        // Seen: 1.5e-3, of the penalty's mesh.
        assert!((errors.steps, errors.unanswered) == (6, 0) && force(&errors).max < 2e-3, "{family}");
        for (case, states) in cases.iter().zip(&states) {
            for (load, state) in case.steps.iter().zip(states) {
                let (Load::Force(asked), Some(found)) = (load, state) else { panic!("{family}: {load:?}") };
                assert!((found.force / asked - 1.0).abs() < 1e-9, "{family}");
            }
        }
    }
}

/// A family has a name, choices and, where it has a parameter, one for each choice.
#[test]
fn families_are_what_they_say() {
    let scope = Scope { gpu: None, least_angle: 0.05 };
    let all = choices(&scope);
    for (index, family) in FAMILIES.iter().enumerate() {
        assert!(FAMILIES[..index].iter().all(|other| other.name != family.name));
        let own: Vec<&Choice> = all.iter().filter(|choice| choice.family == family.name).collect();
        assert_eq!(own.is_empty(), family.name == "gpu", "{}", family.name);
        let parameters = own.iter().filter(|choice| choice.parameter.is_some()).count();
        assert_eq!(parameters, if family.parameter.is_empty() { 0 } else { own.len() }, "{}", family.name);
    }
}

/// Ten designs of one shape, one of them to be left out by a stride.
const CONFIG: &str = r#"
title = "A few"
[joint]
idealization = "plane-stress"
hole_radius = "10 mm"
radial_clearance = { from = "0.02 mm", to = "0.05 mm", count = 4 }
thickness = "5 mm"
[joint.pin]
model = "rigid-core"
core_radius_ratio = 0.2
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[joint.plate]
model = "annulus"
outer_radius_ratio = 3
youngs_modulus = "70 GPa"
poissons_ratio = 0.3
[load]
indentation = { from = "0.01 mm", to = "0.05 mm", count = 3 }
"#;

/// What closed forms, node contact and the oracle do not know is refused before anything is measured or written.
#[test]
fn layers_and_press_fits_are_refused() {
    let work = Workdir::new("tradeoff-refused");
    let layer = "layers = [{ thickness = \"1 mm\", youngs_modulus = \"3 GPa\", poissons_ratio = 0.4 }]\n";
    let inner =
        "[joint.pin.inner]\ncore_radius_ratio = 0.2\nyoungs_modulus = \"3 GPa\"\npoissons_ratio = 0.35\n";
    let force = |text: String| format!("{}[load]\nforce = \"10 N\"\n", text.split("[load]").next().unwrap());
    let of_pin = |text: &str| CONFIG.replace("[joint.plate]", &format!("{text}[joint.plate]"));
    let clearance = "{ from = \"0.02 mm\", to = \"0.05 mm\", count = 4 }";
    let fits = |given| force(CONFIG.replace(clearance, given));
    let sampled = "{ from = \"-0.01 mm\", to = \"0.05 mm\" }";
    let sampling = "[sampling]\nmethod = \"latin-hypercube\"\ncount = 20\n";
    let cases = [
        (
            CONFIG.replace("[load]", &format!("{layer}[load]")),
            "design 0 has layers in its plate (joint.plate.layers)",
        ),
        (of_pin(layer), "design 0 has layers in its pin (joint.pin.layers)"),
        (
            of_pin(inner)
                .replace("\"rigid-core\"\ncore_radius_ratio = 0.2", "\"tube\"\nbore_radius_ratio = 0.5"),
            "design 0 has a tube with an inner part as its pin (joint.pin.inner)",
        ),
        (fits("\"-0.01 mm\""), "design 0 is a press fit: its radial_clearance is -0.01 mm, below 0"),
        // The last of four, which is among those that are drawn.
        (fits("[\"0.05 mm\", \"0.02 mm\", \"0 mm\", \"-0.03 mm\"]"), "design 3 is a press fit"),
        (format!("{}{sampling}", fits(sampled)), "is a press fit: its radial_clearance is -0.00"),
    ];
    for (text, problem) in &cases {
        work.write("refused.toml", text);
        let said = work.run(&["tradeoff", "refused.toml", "--designs", "20"]).expect(1).stderr;
        assert!(said.contains("refused.toml: design ") && said.contains(problem), "{said}");
        assert!(said.contains("because its closed forms and its node contact know no others"), "{said}");
        assert!(said.contains("`jointsweep run` and `jointsweep explain`"), "{said}");
    }
    assert_eq!(work.files(), ["refused.toml"]);
    // A list has columns.
    let lined = Study::from_text("lined.toml".as_ref(), cases[0].0.clone()).unwrap();
    let joint = lined.cases().unwrap().next().unwrap().unwrap().joint;
    let listed = not_compared(&joint, true);
    assert_eq!(listed.as_deref(), Some("has layers in its plate (plate_layer1_thickness_mm)"));
}

#[test]
fn a_tradeoff_writes_table_front_plot_and_manifest() {
    let work = Workdir::new("tradeoff");
    work.write("few.toml", CONFIG);
    let told = work.run(&["tradeoff", "few.toml", "--designs", "2", "--runs", "2"]).expect(0);
    assert!(told.stdout.contains("time/design"), "{}", told.stdout);
    assert!(told.stderr.contains("moving-edge-q8, level 1"), "{}", told.stderr);
    let files = ["front.csv", "manifest.json", "tradeoff.csv", "tradeoff.svg"];
    let files = files.map(|file| format!("out/few/tradeoff/{file}"));
    assert_eq!(
        work.files(),
        ["few.toml"].into_iter().chain(files.iter().map(String::as_str)).collect::<Vec<_>>()
    );

    let manifest = work.json(&files[1]);
    assert_eq!((manifest["designs"].as_u64(), manifest["designs_of_sweep"].as_u64()), (Some(2), Some(4)));
    assert_eq!(manifest["oracle"]["series"].as_u64(), Some(2));
    assert!(work.read(&files[3]).contains("A few"));

    let (table, front) = (work.table(&files[2]), work.table(&files[0]));
    let families = table.column("family");
    for family in ["closed-form", "series", "penalty", "augmented-lagrangian", "pcg-mixed"] {
        assert!(families.contains(&family), "{family}");
    }
    let on_front = table.column("on_front").into_iter().filter(|word| *word == "true").count();
    assert_eq!(front.records.len(), on_front);
    // A closed form is the fastest, `series` the nearest.
    assert!(on_front >= 2);
    let numbers =
        |name: &str| -> Vec<f64> { front.column(name).iter().map(|cell| cell.parse().unwrap()).collect() };
    let (times, errors) = (numbers("time_per_design_s"), numbers("force_error_p95"));
    assert!(times.is_sorted() && errors.windows(2).all(|pair| pair[1] < pair[0]), "{times:?} {errors:?}");
    assert!(table.column("steps").iter().all(|steps| *steps == "6"));
    let series = families.iter().position(|family| *family == "series").unwrap();
    assert!(table.column("peak_pressure_error_p95")[series].parse::<f64>().unwrap() < 0.05);
    assert_eq!(table.column("peak_pressure_error_p95")[0], "", "no closed form says it");

    // The same config again, another one, and a run that would put its manifest over this one.
    work.run(&["tradeoff", "few.toml", "--designs", "1", "--runs", "1", "--quiet"]).expect(0);
    work.write("other.toml", &CONFIG.replace("A few", "Others"));
    let taken = "out/few/tradeoff";
    for arguments in [&["tradeoff", "other.toml", "--out", taken][..], &["run", "few.toml", "--out", taken]] {
        let told = work.run(arguments).expect(1);
        assert!(told.stderr.contains("--force"), "{}", told.stderr);
    }
    let run = work.run(&["run", "few.toml", "--out", "plain"]).expect(0);
    assert!(run.stdout.contains("4 designs"), "{}", run.stdout);
    let told = work.run(&["tradeoff", "few.toml", "--out", "plain"]).expect(1);
    assert!(told.stderr.contains("jointsweep run"), "{}", told.stderr);
    let told = work.run(&["tradeoff", "few.toml", "--adapter", "no such GPU"]).expect(1);
    assert!(told.stderr.contains("no such GPU") || told.stderr.contains("Vulkan"), "{}", told.stderr);
}
