//! An axis: its name and unit, its range, and where its ticks stand.

use super::text::{number, superscript, width};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    Linear,
    Log,
}

#[derive(Clone, Debug)]
pub struct Axis {
    /// With the unit: "indentation, mm".
    pub name: String,
    pub spacing: Spacing,
    pub low: f64,
    pub high: f64,
}

impl Axis {
    /// From zero (or below it) to a little above the greatest value.
    pub fn from_zero(name: &str, values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = range(values).unwrap_or((0.0, 1.0));
        let (low, high) = (low.min(0.0), high.max(0.0));
        let high = if high > low { high + 0.04 * (high - low) } else { low + 1.0 };
        let low = if low < 0.0 { low - 0.04 * (high - low) } else { low };
        Axis { name: name.into(), spacing: Spacing::Linear, low, high }
    }

    /// Around all values, which are above zero; others are passed over.
    pub fn log(name: &str, values: impl Iterator<Item = f64>) -> Axis {
        let (low, high) = range(values.filter(|value| *value > 0.0)).unwrap_or((1.0, 10.0));
        let room = if high > low { (high / low).powf(0.03) } else { 2.0 };
        Axis { name: name.into(), spacing: Spacing::Log, low: low / room, high: high * room }
    }

    /// Where a value lies, 0 at the low end and 1 at the high one; `None` where the axis has no place for it.
    pub fn share(&self, value: f64) -> Option<f64> {
        let share = match self.spacing {
            Spacing::Linear => (value - self.low) / (self.high - self.low),
            Spacing::Log if value > 0.0 => (value / self.low).ln() / (self.high / self.low).ln(),
            Spacing::Log => return None,
        };
        share.is_finite().then_some(share)
    }

    /// Values with their labels, at most about `most`, so few that labels do not touch on `length` px; `across` where labels
    /// stand side by side.
    pub fn ticks(&self, most: usize, length: f64, across: bool) -> Vec<(f64, String)> {
        let mut most = most;
        loop {
            let ticks = self.some_ticks(most);
            let room = |pair: &[(f64, String)]| {
                let places = [self.share(pair[0].0), self.share(pair[1].0)];
                let between = length * (places[1].unwrap_or(0.0) - places[0].unwrap_or(0.0)).abs();
                between > 0.5 * (width(&pair[0].1) + width(&pair[1].1)) + 10.0
            };
            if !across || most <= 2 || ticks.windows(2).all(room) {
                return ticks;
            }
            most -= 1;
        }
    }

    fn some_ticks(&self, most: usize) -> Vec<(f64, String)> {
        let decades = match self.spacing {
            Spacing::Log => (self.high / self.low).log10(),
            Spacing::Linear => 0.0,
        };
        if self.spacing == Spacing::Linear {
            return linear_ticks(self.low, self.high, most);
        }
        let (first, last) = (self.low.log10().ceil() as i32, self.high.log10().floor() as i32);
        let whole = (last - first + 1).max(0) as usize;
        if whole >= 3 || (whole == 2 && most < 4) {
            let stride = whole.div_ceil(most).max(1) as i32;
            let from = first + (stride - first.rem_euclid(stride)) % stride;
            let exponents: Vec<i32> = (from..=last).step_by(stride as usize).collect();
            let plain = first >= -3 && last <= 4;
            return exponents
                .into_iter()
                .map(|e| {
                    let value = 10f64.powi(e);
                    (value, if plain { number(value, 1) } else { format!("10{}", superscript(e)) })
                })
                .collect();
        }
        if decades < 0.5 {
            return linear_ticks(self.low, self.high, most);
        }
        let digits: &[f64] = if most >= 6 { &[1.0, 2.0, 5.0] } else { &[1.0, 3.0] };
        let all = (first - 1..=last + 1).flat_map(|e| digits.iter().map(move |d| d * 10f64.powi(e)));
        let inside = all.filter(|value| (self.low..=self.high).contains(value));
        let ticks: Vec<(f64, String)> = inside.map(|value| (value, number(value, 2))).collect();
        if ticks.len() < 2 { linear_ticks(self.low, self.high, most) } else { ticks }
    }

    /// Lines between the labelled ones of a logarithmic axis that has few decades.
    pub fn minor_ticks(&self) -> Vec<f64> {
        if self.spacing == Spacing::Linear || (self.high / self.low).log10() > 5.0 {
            return Vec::new();
        }
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let all = (first..=last).flat_map(|e| (1..10).map(move |d| f64::from(d) * 10f64.powi(e)));
        all.filter(|value| (self.low..=self.high).contains(value)).collect()
    }
}

/// Least and greatest of the finite values.
pub fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|value| value.is_finite()).fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((low.min(value), high.max(value))),
    })
}

/// Multiples of 1, 2 or 5 times a power of ten.
fn linear_ticks(low: f64, high: f64, most: usize) -> Vec<(f64, String)> {
    let rough = (high - low) / most.max(1) as f64;
    if !(rough > 0.0 && rough.is_finite()) {
        return vec![(low, number(low, 3))];
    }
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|d| d * power).into_iter().find(|step| *step >= 0.999 * rough);
    let step = step.unwrap_or(10.0 * power);
    let first = (low / step - 1e-9).ceil();
    let count = ((high / step + 1e-9).floor() - first).max(0.0) as usize;
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let plain = high.abs().max(low.abs()) < 1e6 && decimals <= 5;
    let label = |value: f64| {
        if plain {
            format!("{:.decimals$}", if value == 0.0 { 0.0 } else { value })
        } else {
            number(value, 3)
        }
    };
    (0..=count.min(50)).map(|i| (first + i as f64) * step).map(|value| (value, label(value))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, most: usize) -> Vec<String> {
        axis.ticks(most, 400.0, true).into_iter().map(|tick| tick.1).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        let axis = Axis::from_zero("x", [0.2].into_iter());
        assert_eq!(labels(&axis, 5), ["0.00", "0.05", "0.10", "0.15", "0.20"]);
        let axis = Axis { name: "x".into(), spacing: Spacing::Log, low: 0.9, high: 1100.0 };
        assert_eq!(labels(&axis, 6), ["1", "10", "100", "1000"]);
        let axis = Axis { name: "x".into(), spacing: Spacing::Log, low: 0.9, high: 11.0 };
        assert_eq!(labels(&axis, 6), ["1", "2", "5", "10"]);
        let axis = Axis { name: "x".into(), spacing: Spacing::Log, low: 1e-7, high: 1e7 };
        assert_eq!(labels(&axis, 5).len(), 5);
    }

    /// Whatever the numbers, there is an axis and its ticks end.
    #[test]
    fn there_is_an_axis_of_anything() {
        for values in [vec![], vec![0.0], vec![1.0], vec![f64::NAN], vec![-1.0, 1e300], vec![1e-300, 1e300]] {
            for axis in [Axis::from_zero("x", values.iter().copied()), Axis::log("x", values.iter().copied())]
            {
                assert!(axis.high > axis.low, "{axis:?}");
                let ticks = axis.ticks(6, 400.0, true);
                assert!((1..60).contains(&ticks.len()), "{axis:?}: {ticks:?}");
            }
        }
    }
}
