//! Laws fitted to random joints of every kind: how well they fit, and whether what they say of it is true.

use std::collections::BTreeMap;

use crate::common::law_joints::{joints, of_every_kind};
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::law_fit::{add_laws, law_case, laws_of, working_range};
use jointsweep::internals::engine::outcome::DesignLaws;
use jointsweep::internals::mechanics::laws::calibrated::{
    CALIBRATED_LAWS, Sample, Samples, Sizes, explicit, fitted_laws,
};
use jointsweep::internals::study::design::{DesignCase, JointDesign, Load};
use jointsweep::{MethodChoice, Options};

#[test]
fn laws_fit_as_well_as_they_say() {
    let cases = of_every_kind();
    assert_eq!(cases.len(), 1000);
    let mut ladder = Ladder::new(Options { accuracy: 0.01, method: MethodChoice::Auto });
    let outcomes = ladder.solve(&cases);
    let law_cases: Vec<DesignCase> = outcomes
        .iter()
        .map(|outcome| law_case(&outcome.case, working_range(&outcome.steps).unwrap()))
        .collect();
    let answers = ladder.answers(&law_cases);
    let fitted: Vec<_> = law_cases
        .iter()
        .zip(&answers)
        .zip(&outcomes)
        .map(|((case, answer), outcome)| laws_of(case, answer, working_range(&outcome.steps).unwrap()))
        .collect();
    // At 200 loads that no law has seen.
    let unseen: Vec<DesignCase> = law_cases
        .iter()
        .map(|case| {
            let [Load::Indentation(low), Load::Indentation(high)] =
                [case.steps[0], case.steps[case.steps.len() - 2]]
            else {
                panic!()
            };
            let place = |i: usize| (i as f64 + 0.5) / 200.0;
            let steps = (0..200).map(|i| Load::Indentation(low * (high / low).powf(place(i)))).collect();
            DesignCase { steps, ..case.clone() }
        })
        .collect();
    let truth = ladder.answers(&unseen);
    let mut of_laws: BTreeMap<&str, Vec<(f64, f64, f64)>> = BTreeMap::new();
    let mut untrue = 0.0_f64;
    let mut taken: BTreeMap<&str, usize> = BTreeMap::new();
    let mut good = 0;
    for (laws, truth) in fitted.iter().zip(&truth) {
        for law in &laws.laws {
            let (mut worst, mut worst_slope, mut seen) = (0.0_f64, 0.0_f64, 0);
            for response in truth.steps.iter().filter_map(|step| step.response) {
                let delta = response.indentation;
                if delta < law.range.0 || delta > law.range.1 {
                    continue;
                }
                seen += 1;
                worst = worst.max((law.force(delta) / response.force - 1.0).abs());
                worst_slope =
                    worst_slope.max((law.tangent_stiffness(delta) / response.tangent_stiffness - 1.0).abs());
            }
            assert!(seen > 10, "{} {seen} {:?}", law.law.name, law.range);
            untrue = untrue.max(worst / law.force_misfit[0].max(1e-4));
            of_laws.entry(law.law.name).or_default().push((worst, worst_slope, law.force_misfit[0]));
        }
        let (place, _) = laws.recommended.unwrap();
        *taken.entry(laws.laws[place].law.name).or_default() += 1;
        let explicit = laws.laws.iter().find(|law| law.law.name == "explicit");
        good += usize::from(explicit.is_some_and(|law| law.force_misfit[0] <= 0.01));
    }
    assert_eq!(of_laws.len(), CALIBRATED_LAWS.len());
    for (name, mut all) in of_laws {
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |share: f64| all[((share * all.len() as f64) as usize).min(all.len() - 1)].0 * 100.0;
        let mut slopes: Vec<f64> = all.iter().map(|law| law.1).collect();
        slopes.sort_by(f64::total_cmp);
        println!(
            "{name:14} {:5} worst misfit %: median {:.3} 90th {:.3} 99th {:.3} worst {:.3}; tangent {:.3} {:.3}; said/true least {:.2}",
            all.len(),
            at(0.5),
            at(0.9),
            at(0.99),
            at(1.0),
            100.0 * slopes[slopes.len() / 2],
            100.0 * slopes[slopes.len() * 9 / 10],
            all.iter().map(|law| law.2 / law.0.max(1e-5)).fold(f64::INFINITY, f64::min)
        );
    }
    println!("taken {taken:?}, explicit good {good}, worst true over said {untrue:.3}");
    assert!(good >= 990, "{good}");
    assert!(untrue <= 1.1, "{untrue}");
}

/// The joint that most tests of this file fit: a disc in a ring, at the states that laws are told by.
fn one() -> (DesignCase, DesignLaws) {
    let pin = "model = \"rigid-core\"\ncore_radius_ratio = 0.2";
    let plate = "model = \"annulus\"\nouter_radius_ratio = 3";
    let outcome = Ladder::new(Options { accuracy: 1e-3, method: MethodChoice::Auto })
        .solve(&joints(pin, plate, 1))
        .remove(0);
    let case = law_case(&outcome.case, working_range(&outcome.steps).unwrap());
    let answer = Ladder::new(Options { accuracy: 1e-3, method: MethodChoice::Auto })
        .answers(std::slice::from_ref(&case))
        .remove(0);
    let laws = laws_of(&case, &answer, working_range(&outcome.steps).unwrap());
    (case, laws)
}

/// Slopes by differences, and the text that a person pastes, read by another program's parser.
#[test]
fn slopes_and_formulas_are_those_of_the_force() {
    let (_, laws) = one();
    let mut read = 0;
    for law in &laws.laws {
        let name = law.law.name;
        for share in [0.0, 0.3, 0.7, 1.0] {
            let delta = law.range.0 * (law.range.1 / law.range.0).powf(share);
            let (force, step) = (law.force(delta), 1e-5 * delta);
            let slope = (law.force(delta + step) - law.force(delta - step)) / (2.0 * step);
            assert!((slope / law.tangent_stiffness(delta) - 1.0).abs() < 1e-6, "{name} {delta}");
            let formula = law.formula();
            // F = ..., d = ... of F and f, d and F of b, or a list of points.
            if let Some(of_force) = formula.strip_prefix("F = ") {
                let found = evaluated(of_force, &[("d", delta)]);
                assert!((found / force - 1.0).abs() < 1e-5, "{formula}: {found} {force}");
                read += 1;
            } else if name == "persson" {
                let (of_indentation, of_force) = formula[4..].split_once(", F = ").unwrap();
                let (mut low, mut high) = (1e-6, 0.9135);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if evaluated(of_force, &[("b", middle)]) < force { low = middle } else { high = middle }
                }
                let found = evaluated(of_indentation, &[("b", low), ("F", force)]);
                assert!((found / delta - 1.0).abs() < 1e-5, "{formula}: {found} {delta}");
                read += 1;
            } else if name != "spline" {
                let (of_indentation, of_f) =
                    formula[4..].split_once(", f = ").unwrap_or((&formula[4..], "1"));
                let f = evaluated(of_f, &[("F", force), ("d", delta)]);
                let found = evaluated(of_indentation, &[("F", force), ("f", f)]);
                assert!((found / delta - 1.0).abs() < 1e-5, "{formula}: {found} {delta}");
                read += 1;
            }
        }
        assert_eq!((law.force(0.0), law.force(-1.0), law.tangent_stiffness(-1.0)), (0.0, 0.0, 0.0));
    }
    assert_eq!((laws.laws.len(), read), (CALIBRATED_LAWS.len(), 4 * (CALIBRATED_LAWS.len() - 1)));
}

/// Variables are taken in the order of the alphabet.
fn evaluated(formula: &str, values: &[(&str, f64)]) -> f64 {
    let expression = exmex::parse::<f64>(formula).unwrap();
    let value = |name: &String| values.iter().find(|(own, _)| own == name).unwrap().1;
    let values: Vec<f64> = exmex::Express::var_names(&expression).iter().map(value).collect();
    exmex::Express::eval(&expression, &values).unwrap()
}

/// A neat fit is linear; a joint without an answer has no law; a load beyond ten clearances widens the range.
#[test]
fn special_joints_have_their_laws() {
    let (case, _) = one();
    let mut ladder = Ladder::new(Options { accuracy: 1e-3, method: MethodChoice::Auto });
    let mut solved = |clearance: f64, loads: &[f64]| {
        let joint = JointDesign { radial_clearance: clearance, ..case.joint.clone() };
        let steps = loads.iter().map(|load| Load::Indentation(*load)).collect();
        let mut outcomes = ladder.solve(&[DesignCase { index: 0, joint, steps }]);
        add_laws(&mut ladder, &mut outcomes);
        let outcome = outcomes.remove(0);
        (outcome.steps, *outcome.laws.unwrap())
    };
    let (steps, neat) = solved(0.0, &[0.01, 0.02]);
    let [law] = &neat.laws[..] else { panic!("{}", neat.laws.len()) };
    for step in steps.iter().filter_map(|step| step.response) {
        assert!((law.force(step.indentation) / step.force - 1.0).abs() < 1e-9);
        assert!((law.tangent_stiffness(step.indentation) / step.tangent_stiffness - 1.0).abs() < 1e-9);
    }
    let (_, unloaded) = solved(0.02, &[0.0]);
    assert!(unloaded.laws.is_empty() && unloaded.missing.is_some());
    let (_, wide) = solved(0.001, &[0.1]);
    let (best, _) = wide.recommended.unwrap();
    assert!((wide.laws[best].range.1 / 0.1 - 1.0).abs() < 1e-9, "{:?}", wide.laws[best].range);
    // Its slope under ever larger loads is that of a neat fit of the same sizes.
    let large = wide.stiffness_of_large_loads.unwrap();
    assert!((large / neat.stiffness_of_large_loads.unwrap() - 1.0).abs() < 1e-3, "{large}");
}

/// A law that has no value in its range, or falls there, is never handed out.
#[test]
fn a_law_with_a_wrong_branch_is_left_out() {
    let sizes = Sizes { radial_clearance: 0.1, stiffness: 1e5 };
    let state = |x: f64, y: f64, exponent: f64| Sample { x, y, exponent };
    // A force that nearly stands still, then rises steeply: what no law of the list but the spline can do.
    let odd = (0..33).map(|i| {
        let x = 0.01 * 1000f64.powf(f64::from(i) / 32.0);
        let wave = 1.0 + 0.9 * (6.0 * x.ln()).sin();
        (x, wave)
    });
    let mut y = 1e-4;
    let mut before = 0.01;
    let states: Vec<Sample> = odd
        .map(|(x, wave)| {
            y *= (x / before).powf(1.2 * wave);
            before = x;
            state(x, y, 1.2 * wave)
        })
        .collect();
    let samples = Samples::new(sizes, states.clone().into_iter(), (0.1, 1.0)).unwrap();
    for law in fitted_laws(&samples) {
        let mut force = 0.0;
        for i in 0..=1000 {
            let delta = law.range.0 * (law.range.1 / law.range.0).powf(f64::from(i) / 1000.0);
            let next = law.force(delta);
            assert!(next > force && law.tangent_stiffness(delta) > 0.0, "{} at {delta}", law.law.name);
            force = next;
        }
    }
    // Constants that make the logarithm's argument fall below 1.
    let [value, slope] = (explicit::LAW.value)(&[-5.0, 1.0, 1.0, 1.2], 1.0, f64::NAN);
    assert!(value.is_nan() && slope.is_nan());
    // States that fall, or are too few, are none.
    let falling = states.iter().rev().copied();
    assert!(Samples::new(sizes, falling, (0.1, 1.0)).is_none());
    assert!(Samples::new(sizes, states.into_iter().take(5), (0.1, 1.0)).is_none());
}
