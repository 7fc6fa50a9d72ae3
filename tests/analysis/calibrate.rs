//! Joints fitted to points that were made from a known joint: the known values come back, with intervals that hold them as
//! often as they say.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use crate::common::random::Random;
use jointsweep::internals::calibrate::calibration::{Calibration, calibrate};
use jointsweep::internals::calibrate::unknown::Unknown;
use jointsweep::internals::study::measured::MeasuredPoint;
use jointsweep::{Dimensions, Error, Idealization, Joint, Load, Material, MethodChoice, Options, Part};

const OPTIONS: Options = Options { accuracy: 1e-3, method: MethodChoice::Auto };

/// What is true of a measurement. mm, N, MPa.
#[derive(Clone, Copy)]
struct Truth {
    plate: &'static str,
    plate_youngs_modulus: f64,
    pin_youngs_modulus: f64,
    radial_clearance: f64,
    support_compliance: f64,
    zero_offset: f64,
}

/// An aluminium plate on a steel pin; the config knows neither modulus nor clearance well.
const TRUE: Truth = Truth {
    plate: "annulus",
    plate_youngs_modulus: 71_300.0,
    pin_youngs_modulus: 208_000.0,
    radial_clearance: 0.0431,
    support_compliance: 0.0,
    zero_offset: 0.0,
};
const CONFIG: Truth =
    Truth { plate_youngs_modulus: 110_000.0, pin_youngs_modulus: 150_000.0, radial_clearance: 0.08, ..TRUE };

impl Truth {
    fn of(&self, unknown: Unknown) -> f64 {
        match unknown {
            Unknown::PlateYoungsModulus => self.plate_youngs_modulus,
            Unknown::PinYoungsModulus => self.pin_youngs_modulus,
            Unknown::RadialClearance => self.radial_clearance,
            Unknown::SupportCompliance => self.support_compliance,
            Unknown::ZeroOffset => self.zero_offset,
        }
    }

    fn joint(&self) -> Joint {
        let ratios: &[(&str, f64)] = match self.plate {
            "annulus" => &[("outer_radius_ratio", 3.0)],
            _ => &[("half_width_ratio", 3.0), ("depth_ratio", 3.0), ("height_ratio", 2.0)],
        };
        let material = |youngs_modulus| Material { youngs_modulus, poissons_ratio: 0.3 };
        let pin = Part::new("rigid-core", &[], None, material(self.pin_youngs_modulus)).unwrap();
        let plate = Part::new(self.plate, ratios, None, material(self.plate_youngs_modulus)).unwrap();
        let sizes = Dimensions { hole_radius: 10.0, radial_clearance: self.radial_clearance, thickness: 8.0 };
        Joint::new(sizes, Idealization::PlaneStress, pin, plate).unwrap()
    }

    /// What is measured without scatter while the pin goes down evenly between two depths: from the pin's descent on, never by
    /// solving for it.
    fn points(&self, from: f64, to: f64, count: usize) -> Vec<MeasuredPoint> {
        let curve = self.joint().curve(OPTIONS).unwrap();
        let descent = |i: usize| from + (to - from) * i as f64 / (count - 1) as f64;
        (0..count)
            .map(|i| {
                let force = curve.at(Load::Indentation(descent(i))).unwrap().force;
                let indentation = descent(i) + self.support_compliance * force + self.zero_offset;
                MeasuredPoint { indentation, force, sigma: None }
            })
            .collect()
    }
}

/// Of mean 0 and variance 1, by Box and Muller.
fn normal(random: &mut Random) -> f64 {
    (-2.0 * (1.0 - random.unit()).ln()).sqrt() * (TAU * random.unit()).cos()
}

fn fit(config: &Truth, unknowns: &[Unknown], points: &[MeasuredPoint]) -> Calibration {
    calibrate(&config.joint(), OPTIONS, unknowns, points).unwrap()
}

#[test]
fn exact_points_give_the_values_they_were_made_from() {
    use Unknown::*;
    let mounted = Truth { support_compliance: 2e-7, zero_offset: 0.004, ..TRUE };
    let cases: [(Truth, Truth, &[Unknown]); 6] = [
        (TRUE, Truth { plate_youngs_modulus: 200e3, ..TRUE }, &[PlateYoungsModulus]),
        (TRUE, Truth { pin_youngs_modulus: 70e3, ..TRUE }, &[PinYoungsModulus]),
        (TRUE, Truth { radial_clearance: 0.3, ..TRUE }, &[RadialClearance]),
        (TRUE, Truth { pin_youngs_modulus: 208e3, ..CONFIG }, &[PlateYoungsModulus, RadialClearance]),
        (mounted, TRUE, &[SupportCompliance, ZeroOffset]),
        (
            Truth { zero_offset: 0.004, ..TRUE },
            Truth { pin_youngs_modulus: 208e3, ..CONFIG },
            &[ZeroOffset, RadialClearance, PlateYoungsModulus],
        ),
    ];
    let mut compared = 0;
    for plate in ["annulus", "block"] {
        for (truth, config, unknowns) in cases {
            let truth = Truth { plate, ..truth };
            let points = truth.points(0.0005, 0.2, 40);
            let calibration = fit(&Truth { plate, ..config }, unknowns, &points);
            for fitted in &calibration.fitted {
                let expected = truth.of(fitted.unknown);
                let off = (fitted.value / expected - 1.0).abs();
                println!("{plate} {:?} {} {expected} {off:e}", fitted.unknown, fitted.value);
                assert!(off < 1e-6, "{plate} {unknowns:?} {fitted:?} {expected}");
                compared += 1;
            }
            let greatest = points.iter().map(|point| point.force).fold(0.0, f64::max);
            assert!(calibration.points.iter().all(|point| point.residual().abs() < 1e-6 * greatest));
        }
    }
    assert_eq!(compared, 2 * 10);
}

/// Of how many measurements each interval holds the true value: the plate's modulus and the zero offset, from points that scatter
/// by so much at a force, told or not.
fn held(points: usize, is_told: bool, sigma: fn(force: f64, greatest: f64) -> f64) -> [u32; 2] {
    let truth = Truth { zero_offset: 0.003, ..TRUE };
    let config = Truth { plate_youngs_modulus: 90e3, ..TRUE };
    let exact = truth.points(0.002, 0.06, points);
    let greatest = exact[points - 1].force;
    let mut held = [0, 0];
    for seed in 0..RUNS {
        let mut random = Random::new(u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let scatter = |point: &MeasuredPoint| {
            let sigma = sigma(point.force, greatest);
            let force = point.force + sigma * normal(&mut random);
            MeasuredPoint { force, sigma: is_told.then_some(sigma), ..*point }
        };
        let points: Vec<MeasuredPoint> = exact.iter().map(scatter).collect();
        let calibration = fit(&config, &[Unknown::PlateYoungsModulus, Unknown::ZeroOffset], &points);
        for (held, fitted) in held.iter_mut().zip(&calibration.fitted) {
            let [low, high] = fitted.interval.unwrap();
            assert!(low < fitted.value && fitted.value < high);
            *held += u32::from((low..=high).contains(&truth.of(fitted.unknown)));
        }
    }
    println!("{held:?} of {RUNS}");
    held
}

const RUNS: u32 = 200;
/// 95 of 100, with three standard deviations of the binomial law of 200 runs, which is 3.1.
const AS_SAID: RangeInclusive<u32> = 181..=199;

/// From three spare points, where the normal law in the place of Student's would give 171 of 200.
#[test]
fn intervals_from_few_points_hold_the_true_value_as_often_as_they_say() {
    let held = held(5, false, |_, greatest| 0.005 * greatest);
    assert!(held.iter().all(|held| AS_SAID.contains(held)), "{held:?}");
}

/// Scatter that grows with the force is what sigma is for.
#[test]
fn intervals_from_a_given_sigma_hold_the_true_value_as_often_as_they_say() {
    let held = held(12, true, |force, greatest| 0.0005 * greatest + 0.02 * force);
    assert!(held.iter().all(|held| AS_SAID.contains(held)), "{held:?}");
}

/// Over a narrow range a softer plate is as good as a softer support; over a wide one the curve's bend tells them apart.
#[test]
fn what_cannot_be_told_apart_is_said() {
    let unknowns = [Unknown::PlateYoungsModulus, Unknown::SupportCompliance];
    let truth = Truth { support_compliance: 1e-7, ..TRUE };
    let scattered = |from: f64, to: f64| -> Vec<MeasuredPoint> {
        let mut random = Random::new(1);
        let scatter = |point: MeasuredPoint| MeasuredPoint {
            force: point.force * (1.0 + 1e-3 * normal(&mut random)),
            sigma: Some(1e-3 * point.force),
            ..point
        };
        truth.points(from, to, 30).into_iter().map(scatter).collect()
    };
    let narrow = fit(&TRUE, &unknowns, &scattered(0.035, 0.04));
    let said = "plate_youngs_modulus and support_compliance cannot be told apart by these points";
    assert!(narrow.warnings.iter().any(|warning| warning.starts_with(said)), "{:?}", narrow.warnings);
    assert!(narrow.correlation[0][1].unwrap().abs() > 0.99 && narrow.condition > 10.0);
    let wide = fit(&TRUE, &unknowns, &scattered(1e-5, 0.04));
    println!("{:?} {}\n{:?} {}", narrow.correlation, narrow.condition, wide.correlation, wide.condition);
    assert!(wide.warnings.is_empty(), "{:?}", wide.warnings);
    assert!(wide.correlation[0][1].unwrap().abs() < 0.99);
    let width = |calibration: &Calibration| {
        let [low, high] = calibration.fitted[0].interval.unwrap();
        high - low
    };
    assert!(width(&narrow) > 10.0 * width(&wide));
}

/// A joint that is not the one measured: the plate of the config is far larger.
#[test]
fn points_that_no_value_fits_are_said() {
    let sigma = |point: MeasuredPoint| MeasuredPoint { sigma: Some(1e-3 * point.force), ..point };
    let truth = Truth { plate: "block", ..TRUE };
    let points: Vec<MeasuredPoint> = truth.points(0.001, 0.04, 30).into_iter().map(sigma).collect();
    let good = fit(&truth, &[Unknown::PlateYoungsModulus], &points);
    assert!(good.warnings.is_empty() && good.reduced_chi_square.unwrap() < 1e-6, "{:?}", good.warnings);
    let bad = fit(&Truth { radial_clearance: 0.3, ..truth }, &[Unknown::PlateYoungsModulus], &points);
    assert!(bad.reduced_chi_square.unwrap() > 2.0);
    assert!(
        bad.warnings[0].starts_with("the points are farther from the fitted curve"),
        "{:?}",
        bad.warnings
    );
}

/// Four that do the same where the curve is straight: there is no best fit, and it is said of whom.
#[test]
fn a_fit_that_runs_away_says_what_to_leave_out() {
    use Unknown::*;
    let unknowns = [PlateYoungsModulus, ZeroOffset, RadialClearance, PinYoungsModulus];
    let mut random = Random::new(5);
    let mut scatter = |point: MeasuredPoint| MeasuredPoint {
        force: point.force * (1.0 + 0.02 * normal(&mut random)),
        ..point
    };
    let points: Vec<MeasuredPoint> = TRUE.points(0.1, 0.105, 12).into_iter().map(&mut scatter).collect();
    let said = match calibrate(&CONFIG.joint(), OPTIONS, &unknowns, &points) {
        Ok(calibration) => calibration.warnings.join("; "),
        Err(error) => error.to_string(),
    };
    println!("{said}");
    assert!(said.contains("plate_youngs_modulus") && said.contains("cannot be told apart"), "{said}");
}

#[test]
fn as_many_points_as_unknowns_have_no_intervals() {
    let points = TRUE.points(0.01, 0.1, 2);
    let unknowns = [Unknown::PlateYoungsModulus, Unknown::RadialClearance];
    let calibration = fit(&Truth { pin_youngs_modulus: 208e3, ..CONFIG }, &unknowns, &points);
    assert!((calibration.fitted[0].value / TRUE.plate_youngs_modulus - 1.0).abs() < 1e-6);
    assert!(calibration.fitted.iter().all(|fitted| fitted.interval.is_none()));
    assert!(calibration.warnings.iter().any(|warning| warning.contains("as many unknowns as points")));
}

#[test]
fn what_cannot_be_fitted_is_refused() {
    let points = TRUE.points(0.01, 0.1, 5);
    let refused = |joint: &Truth, unknowns: &[Unknown], points: &[MeasuredPoint]| {
        let error = calibrate(&joint.joint(), OPTIONS, unknowns, points).unwrap_err();
        assert!(matches!(error, Error::Calibration { .. }));
        error.to_string()
    };
    let few = refused(&TRUE, &[Unknown::PlateYoungsModulus, Unknown::ZeroOffset], &points[..1]);
    assert_eq!(few, "1 measured points are too few for 2 unknowns");
    let untouched: Vec<MeasuredPoint> =
        points.iter().map(|point| MeasuredPoint { force: 0.0, ..*point }).collect();
    assert!(
        refused(&TRUE, &[Unknown::PlateYoungsModulus], &untouched).contains("every measured force is zero")
    );
    let neat = Truth { radial_clearance: 0.0, ..TRUE };
    assert!(refused(&neat, &[Unknown::RadialClearance], &points).starts_with("radial_clearance: "));
    let names = |names: &[&str]| {
        Unknown::list(&names.iter().map(|name| name.to_string()).collect::<Vec<_>>()).unwrap_err().to_string()
    };
    assert!(names(&["plate_modulus"]).contains("did you mean `plate_youngs_modulus`?"));
    assert_eq!(names(&["zero_offset", "zero_offset"]), "`zero_offset`: it is named twice");
}
