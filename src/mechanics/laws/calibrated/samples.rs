//! The curve of a joint as laws are fitted to it.

use super::Sizes;

/// One state: x = delta/dR, y = F/(E* t dR), and their logarithmic slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub x: f64,
    pub y: f64,
    /// d ln F/d ln delta.
    pub exponent: f64,
}

impl Sample {
    /// s = delta/e.
    pub fn share(&self) -> f64 {
        self.x / (1.0 + self.x)
    }

    /// f = F/(E* t e).
    pub fn force(&self) -> f64 {
        self.y / (1.0 + self.x)
    }

    /// exp(pi s/f): what stands under the logarithm of the laws that have one.
    pub fn under_logarithm(&self) -> f64 {
        (std::f64::consts::PI * self.x / self.y).exp()
    }
}

/// States of one joint by rising load: every other one is fitted, all of them are checked.
#[derive(Clone, Debug)]
pub struct Samples {
    pub sizes: Sizes,
    points: Vec<Sample>,
    /// Indentations at work, over dR.
    pub working: (f64, f64),
}

/// Fewer states than these tell no law.
pub const FEWEST: usize = 9;

/// The range of laws, delta/dR, and more where the loads at work are beyond it.
pub const RANGE: (f64, f64) = (0.01, 10.0);

/// States that are asked for: an odd number, so that the first and the last one are fitted.
const COUNT: usize = 29;

/// The widest range, delta/dR.
const WIDEST: (f64, f64) = (1e-5, 1e5);

/// Indentations over dR, rising, that a joint is to be sampled at, for such indentations at work.
pub fn sampled_at(working: (f64, f64)) -> impl Iterator<Item = f64> {
    let low = RANGE.0.min(working.0).max(WIDEST.0).ln();
    let high = RANGE.1.max(working.1).min(WIDEST.1).ln();
    (0..COUNT).map(move |i| (low + (high - low) * i as f64 / (COUNT - 1) as f64).exp())
}

impl Samples {
    /// Of states by rising load, up to the first that is none; `None` where there are too few.
    pub fn new(sizes: Sizes, states: impl Iterator<Item = Sample>, working: (f64, f64)) -> Option<Samples> {
        let is_state = |sample: &Sample| {
            let numbers = [sample.x, sample.y, sample.exponent];
            numbers.iter().all(|number| number.is_finite() && *number > 0.0)
        };
        let points: Vec<Sample> = states.take_while(is_state).collect();
        let rises = points.windows(2).all(|pair| pair[1].x > pair[0].x && pair[1].y > pair[0].y);
        (rises && points.len() >= FEWEST).then_some(Samples { sizes, points, working })
    }

    /// Those between two x.
    pub fn between(&self, (low, high): (f64, f64)) -> &[Sample] {
        // A little more than rounding.
        let first = self.points.partition_point(|point| point.x < low * (1.0 - 1e-9));
        let end = self.points.partition_point(|point| point.x <= high * (1.0 + 1e-9));
        &self.points[first..end.max(first)]
    }

    /// The first and the last x.
    pub fn range(&self) -> (f64, f64) {
        (self.points[0].x, self.points[self.points.len() - 1].x)
    }

    /// The decade up to the greatest indentation at work, as far as there are states.
    pub fn working_decade(&self) -> (f64, f64) {
        let (low, high) = self.range();
        let high = self.working.1.clamp(low, high);
        // No narrower than a decade, unless there is no more.
        let high = high.max(10.0 * low).min(self.range().1);
        ((0.1 * high).max(low), high)
    }

    /// C of small loads, delta = F/(pi E* t) [ln(E* t dR/F) + C], as the least load has it.
    pub fn small_load_constant(&self) -> f64 {
        let Sample { x, y, .. } = self.points[0];
        std::f64::consts::PI * x / y + y.ln()
    }
}
