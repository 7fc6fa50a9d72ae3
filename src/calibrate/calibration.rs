//! A joint fitted to measured points: values, how sure they are, and what must be known of them.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

use crate::calibrate::least_squares::{Minimum, NoMinimum, minimum};
use crate::calibrate::model::{Fit, Setup};
use crate::calibrate::unknown::Unknown;
use crate::engine::status::{Status, StatusCounts};
use crate::error::Error;
use crate::joint::{Joint, Options};
use crate::study::measured::MeasuredPoint;

/// Share of measurements whose interval holds the true value.
pub const CONFIDENCE: f64 = 0.95;

/// Two unknowns whose errors are correlated beyond this cannot be told apart: knowing one of them would make the other's interval
/// seven times narrower.
const MOST_CORRELATION: f64 = 0.99;
/// The same for one unknown among several: variance over that with the others known, 1/(1 - 0.99^2).
const MOST_INFLATION: f64 = 50.25;
/// Points farther from the curve than their sigma allows: chance of less than one in a thousand.
const LEAST_CHANCE: f64 = 1e-3;
/// Without measured scatter a curve of this relative error is asked at least.
const LEAST_ACCURACY: f64 = 1e-3;

/// One unknown, found.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    pub unknown: Unknown,
    pub start: f64,
    pub value: f64,
    /// `None` where there are no more points than unknowns and no sigma, or where the points do not decide.
    pub standard_error: Option<f64>,
    pub interval: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug)]
pub struct FittedPoint {
    pub measured: MeasuredPoint,
    /// N, of the fitted curve.
    pub force: f64,
}

impl FittedPoint {
    /// N.
    pub fn residual(&self) -> f64 {
        self.measured.force - self.force
    }
}

#[derive(Clone, Debug)]
pub struct Calibration {
    pub fitted: Vec<Fitted>,
    /// Between the errors of the unknowns, in their order; `None` where the points do not decide.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// Of the normalised Jacobian: 1 where the unknowns do not disturb each other.
    pub condition: f64,
    pub points: Vec<FittedPoint>,
    /// Standard deviation of the residuals, N; `None` without spare points.
    pub residual_deviation: Option<f64>,
    /// Sum of (residual/sigma)^2 over points less unknowns, where sigma is given.
    pub reduced_chi_square: Option<f64>,
    /// The fitted curve, mm and N, from the first to the last measured indentation.
    pub line: Vec<(f64, f64)>,
    pub iterations: usize,
    /// Sentences for who reads the values.
    pub warnings: Vec<String>,
}

/// Points of the drawn curve.
const LINE: usize = 60;

/// Fits `unknowns` of a joint to points, from the joint's own values.
pub fn calibrate(
    joint: &Joint,
    options: Options,
    unknowns: &[Unknown],
    points: &[MeasuredPoint],
) -> Result<Calibration, Error> {
    let refuse = |problem: String| Err(Error::Calibration { problem });
    if unknowns.is_empty() {
        return refuse("nothing to fit is named".into());
    }
    if points.len() < unknowns.len() {
        let (points, unknowns) = (points.len(), unknowns.len());
        return refuse(format!("{points} measured points are too few for {unknowns} unknowns"));
    }
    if points.iter().all(|point| point.force == 0.0) {
        return refuse("every measured force is zero: nothing was touched".into());
    }
    if joint.design().is_press_fit() {
        return refuse("a press fit has no indentation, and no points of it can be measured".into());
    }
    if unknowns.contains(&Unknown::RadialClearance) && joint.design().is_neat() {
        return refuse(
            "radial_clearance: cannot be fitted from 0; give the config a clearance to start from".into(),
        );
    }
    let start = Setup { joint: joint.design().clone(), support_compliance: 0.0, zero_offset: 0.0 };
    let options = Options { accuracy: options.accuracy.min(LEAST_ACCURACY), ..options };
    let mut fit = Fit::new(start.clone(), unknowns, options, points);
    let scaled_start = fit.scaled_start();
    let minimum = match minimum(&mut fit, &scaled_start) {
        Ok(minimum) => minimum,
        Err(NoMinimum::BadStart) => {
            let why = fit.problem.map_or(String::new(), |error| format!(": {error}"));
            return refuse(format!("the config's joint has no answer at the measured points{why}"));
        }
        Err(NoMinimum::TooFar) => {
            return refuse("the measured values are too far from those of the config's joint".into());
        }
        Err(NoMinimum::NotSettled { iterations, inflation }) => {
            let alike: Vec<&str> = unknowns
                .iter()
                .zip(inflation)
                .filter(|(_, inflation)| *inflation > MOST_INFLATION)
                .map(|(unknown, _)| unknown.name())
                .collect();
            let why = match alike.as_slice() {
                [] => "start nearer to it, or fit fewer unknowns".to_string(),
                alike => {
                    format!("{} cannot be told apart by these points, fit fewer of them", alike.join(", "))
                }
            };
            return refuse(format!("no best fit was found in {iterations} steps: {why}"));
        }
    };
    let setup = fit.setup(&minimum.unknowns);
    let curve = setup.curve_after(None, options)?;
    let indentations: Vec<f64> = points.iter().map(|point| point.indentation).collect();
    let answers = setup.answers(&curve, &indentations)?;
    let mut statuses = StatusCounts::default();
    let (mut contacts, mut model_error) = (0_u64, 0.0_f64);
    for step in answers.iter().flatten() {
        contacts += 1;
        statuses.add(&step.status);
        model_error = model_error.max(step.response.map_or(0.0, |response| response.force_error));
    }
    let force = |place: usize| {
        answers[place].as_ref().and_then(|step| step.response).map_or(0.0, |response| response.force)
    };
    let points: Vec<FittedPoint> = points
        .iter()
        .enumerate()
        .map(|(place, measured)| FittedPoint { measured: *measured, force: force(place) })
        .collect();

    let spread = Spread::new(&minimum, &points);
    let fitted = unknowns.iter().enumerate().map(|(place, unknown)| {
        let scaled = minimum.unknowns[place];
        let deviation = spread.deviation.map(|deviation| deviation * minimum.inverse[place][place].sqrt());
        let deviation = deviation.filter(|deviation| deviation.is_finite());
        let value = fit.value(*unknown, scaled);
        let at = |scaled: f64| fit.value(*unknown, scaled);
        Fitted {
            unknown: *unknown,
            start: start.get(*unknown),
            value,
            // To first order: of logarithms and of others alike.
            standard_error: deviation.map(|deviation| (at(scaled + 1e-4) - value).abs() / 1e-4 * deviation),
            interval: deviation.map(|deviation| {
                let half = spread.quantile * deviation;
                [at(scaled - half), at(scaled + half)]
            }),
        }
    });
    let fitted: Vec<Fitted> = fitted.collect();
    let correlation = correlation(&minimum);

    let mut warnings = not_told_apart(unknowns, &minimum, &correlation);
    if contacts == 0 {
        warnings.push("no point touches at the fitted values".into());
    }
    if let Some(chi_square) = spread.reduced_chi_square.filter(|_| spread.is_unlikely) {
        warnings.push(format!(
            "the points are farther from the fitted curve than their {} says (reduced chi-square {chi_square:.2}): \
             the joint of the config is not the one measured, or sigma is too small; the intervals are too narrow",
            crate::study::measured::SIGMA
        ));
    }
    if spread.deviation.is_none() {
        warnings.push(
            "there are as many unknowns as points: without further points there are no intervals".into(),
        );
    }
    if fitted.iter().any(|one| one.unknown == Unknown::SupportCompliance && one.value < 0.0) {
        warnings
            .push("support_compliance is below zero: the measured joint is stiffer than the config's".into());
    }
    for (status, count) in statuses.by_text() {
        if status != Status::OK.to_string() {
            warnings.push(format!("{count} of the points are answered with the remark `{status}`"));
        }
    }
    if model_error > options.accuracy {
        warnings.push(format!("the curve itself is known to {:.2} % only", 100.0 * model_error));
    }

    let [first, last] = [f64::min, f64::max].map(|of| indentations.iter().copied().reduce(of).unwrap_or(0.0));
    let places: Vec<f64> = (0..=LINE).map(|i| first + (last - first) * i as f64 / LINE as f64).collect();
    let forces = setup.forces(&curve, &places)?;
    Ok(Calibration {
        fitted,
        correlation,
        condition: minimum.condition,
        points,
        residual_deviation: spread.residual_deviation,
        reduced_chi_square: spread.reduced_chi_square,
        line: places.into_iter().zip(forces).collect(),
        iterations: minimum.iterations,
        warnings,
    })
}

/// How far the points scatter, and what that means for an interval.
struct Spread {
    /// Of a weighted residual: 1 where sigma is given, else found from the residuals.
    deviation: Option<f64>,
    residual_deviation: Option<f64>,
    reduced_chi_square: Option<f64>,
    is_unlikely: bool,
    /// Half of a confidence interval over the standard error.
    quantile: f64,
}

impl Spread {
    fn new(minimum: &Minimum, points: &[FittedPoint]) -> Spread {
        let spare = points.len() - minimum.unknowns.len();
        let per_spare = |sum: f64| (spare > 0).then(|| sum / spare as f64);
        let weighted: f64 = minimum.residuals.iter().map(|residual| residual * residual).sum();
        let plain: f64 = points.iter().map(|point| point.residual().powi(2)).sum();
        let has_sigma = points.iter().all(|point| point.measured.sigma.is_some());
        let tail = 0.5 * (1.0 + CONFIDENCE);
        // Whether sigma is known or found from so many spare points.
        let quantile = match (has_sigma, StudentsT::new(0.0, 1.0, spare as f64)) {
            (false, Ok(student)) => student.inverse_cdf(tail),
            _ => Normal::standard().inverse_cdf(tail),
        };
        let chance = ChiSquared::new(spare as f64).map_or(1.0, |law| law.sf(weighted));
        Spread {
            deviation: if has_sigma { Some(1.0) } else { per_spare(weighted).map(f64::sqrt) },
            residual_deviation: per_spare(plain).map(f64::sqrt),
            reduced_chi_square: per_spare(weighted).filter(|_| has_sigma),
            is_unlikely: has_sigma && chance < LEAST_CHANCE,
            quantile,
        }
    }
}

fn correlation(minimum: &Minimum) -> Vec<Vec<Option<f64>>> {
    let inverse = &minimum.inverse;
    let entry = |i: usize, j: usize| {
        let correlation = inverse[i][j] / (inverse[i][i] * inverse[j][j]).sqrt();
        let is_decided = inverse[i][i].is_finite() && inverse[j][j].is_finite();
        if i == j { Some(1.0) } else { is_decided.then(|| correlation.clamp(-1.0, 1.0)) }
    };
    (0..inverse.len()).map(|i| (0..inverse.len()).map(|j| entry(i, j)).collect()).collect()
}

/// Which unknowns do nearly the same to the curve.
fn not_told_apart(unknowns: &[Unknown], minimum: &Minimum, correlation: &[Vec<Option<f64>>]) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut told = vec![false; unknowns.len()];
    for i in 0..unknowns.len() {
        for j in i + 1..unknowns.len() {
            if let Some(correlation) = correlation[i][j].filter(|value| value.abs() > MOST_CORRELATION) {
                (told[i], told[j]) = (true, true);
                warnings.push(format!(
                    "{} and {} cannot be told apart by these points: their errors are correlated by {correlation:.4}; \
                     measure over a wider range, or fit only one of them",
                    unknowns[i].name(),
                    unknowns[j].name()
                ));
            }
        }
    }
    let is_open = |place: usize| minimum.inflation[place] > MOST_INFLATION;
    let open: Vec<&str> =
        (0..unknowns.len()).filter(|place| is_open(*place)).map(|k| unknowns[k].name()).collect();
    if (0..unknowns.len()).any(|place| is_open(place) && !told[place]) {
        warnings.push(match open.as_slice() {
            [alone] => format!("the points say nothing about {alone}"),
            several => format!(
                "{} cannot be told apart by these points: fit fewer of them, or measure over a wider range",
                several.join(", ")
            ),
        });
    }
    warnings
}
