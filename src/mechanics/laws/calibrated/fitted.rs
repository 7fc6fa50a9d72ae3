//! Laws fitted to one joint, how well they fit, and which one to take.

use super::samples::FEWEST;
use super::{CALIBRATED_LAWS, CalibratedLaw, Sample, Samples, Sizes};

/// A law with its constants for one joint. Indentations in mm, forces in N.
#[derive(Clone, Debug)]
pub struct FittedLaw {
    pub law: &'static CalibratedLaw,
    /// Dimensionless, in the order of `law.constants`.
    pub constants: Vec<f64>,
    pub sizes: Sizes,
    /// Indentations that it was fitted over, mm.
    pub range: (f64, f64),
    /// Relative misfits over the range, worst and mean: at states that were fitted and at as many between them that were not.
    pub force_misfit: [f64; 2],
    pub stiffness_misfit: [f64; 2],
}

impl FittedLaw {
    /// N; nothing below zero.
    pub fn force(&self, indentation: f64) -> f64 {
        if indentation <= 0.0 {
            return 0.0;
        }
        let Sizes { radial_clearance, stiffness } = self.sizes;
        stiffness
            * radial_clearance
            * (self.law.value)(&self.constants, indentation / radial_clearance, f64::NAN)[0]
    }

    /// dF/d delta, N/mm; nothing below zero.
    pub fn tangent_stiffness(&self, indentation: f64) -> f64 {
        if indentation <= 0.0 {
            return 0.0;
        }
        let Sizes { radial_clearance, stiffness } = self.sizes;
        stiffness * (self.law.value)(&self.constants, indentation / radial_clearance, f64::NAN)[1]
    }

    /// As a person pastes it: F in N, d in mm.
    pub fn formula(&self) -> String {
        (self.law.formula)(&self.constants, &self.sizes)
    }

    /// Whether it was fitted over all states there are.
    fn is_of_whole_range(&self, samples: &Samples) -> bool {
        let (low, high) = samples.range();
        let clearance = self.sizes.radial_clearance;
        self.range.0 <= low * clearance * (1.0 + 1e-6) && self.range.1 >= high * clearance * (1.0 - 1e-6)
    }
}

/// Every law that fits; one that has no value somewhere in its range, falls with the indentation, or is off by the force itself, is
/// left out.
pub fn fitted_laws(samples: &Samples) -> Vec<FittedLaw> {
    CALIBRATED_LAWS.into_iter().filter_map(|law| fitted(law, samples)).collect()
}

fn fitted(law: &'static CalibratedLaw, samples: &Samples) -> Option<FittedLaw> {
    let points = samples.between((law.range)(samples));
    if points.len() < FEWEST.min(5) {
        return None;
    }
    let last = points.len() - 1;
    let is_fitted = |place: &usize| place.is_multiple_of(2) || *place == last;
    let own: Vec<Sample> = (0..points.len()).filter(is_fitted).map(|place| points[place]).collect();
    let constants = (law.fit)(&own)?;
    let mut force_misfit = Misfit::default();
    let mut stiffness_misfit = Misfit::default();
    // A law is off by nearly as much at the next state.
    let (mut before, mut off) = (0.0, 1.0);
    for Sample { x, y, exponent } in points {
        let [found, slope] = (law.value)(&constants, *x, off * y);
        if !(found.is_finite() && slope > 0.0 && found > before) {
            return None;
        }
        (before, off) = (found, found / y);
        force_misfit.add(off - 1.0);
        stiffness_misfit.add(slope * x / (exponent * y) - 1.0);
    }
    if force_misfit.worst > WORST {
        return None;
    }
    let sizes = samples.sizes;
    let clearance = sizes.radial_clearance;
    Some(FittedLaw {
        law,
        constants,
        sizes,
        range: (points[0].x * clearance, points[last].x * clearance),
        force_misfit: force_misfit.worst_and_mean(),
        stiffness_misfit: stiffness_misfit.worst_and_mean(),
    })
}

/// Relative misfits met so far.
#[derive(Default)]
struct Misfit {
    worst: f64,
    sum: f64,
    count: usize,
}

impl Misfit {
    fn add(&mut self, misfit: f64) {
        self.worst = self.worst.max(misfit.abs());
        self.sum += misfit.abs();
        self.count += 1;
    }

    fn worst_and_mean(&self) -> [f64; 2] {
        [BETWEEN * self.worst, self.sum / self.count as f64]
    }
}

/// Between the states that are looked at a misfit may be this much greater: states are a tenth of a decade apart, the waves of a
/// misfit half a decade and more (`tests/mechanics/calibrated_laws.rs`).
const BETWEEN: f64 = 1.05;

/// Half or twice the force is no law.
const WORST: f64 = 1.0;

/// A law is good enough from this worst misfit of the force on.
pub const GOOD: f64 = 0.01;

/// The place of the law to take, and why: the first that is good over the whole range, else the best of those over the whole range.
pub fn recommended(laws: &[FittedLaw], samples: &Samples) -> Option<(usize, &'static str)> {
    let whole = || laws.iter().enumerate().filter(|(_, law)| law.is_of_whole_range(samples));
    if let Some((place, _)) = whole().find(|(_, law)| law.force_misfit[0] <= GOOD) {
        return Some((place, "first of the list within 1 % of the force over the whole range"));
    }
    let best = whole().min_by(|(_, a), (_, b)| a.force_misfit[0].total_cmp(&b.force_misfit[0]));
    best.map(|(place, _)| (place, "least worst misfit over the whole range; none is within 1 %"))
}
