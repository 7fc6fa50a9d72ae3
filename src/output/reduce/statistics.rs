//! statistics.csv: count, extremes, mean, standard deviation and quantiles of a quantity.

use serde::{Deserialize, Serialize};

use super::exact_sum::{ExactSum, standard_deviation};
use super::line::Line;
use super::sketch::Sketch;
use super::{Reduction, RowNumbers};
use crate::engine::question::TRUSTED;
use crate::engine::question::counted::{CountedQuantity, CountedSum};
use crate::study::expression::Expression;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    of: Expression,
    quantiles: Vec<f64>,
    count: u64,
    /// Rows where it has no value, or none that is finite.
    without_value: u64,
    least: Option<Extreme>,
    greatest: Option<Extreme>,
    sum: ExactSum,
    squares: ExactSum,
    /// Only where quantiles are asked for.
    sketch: Option<Sketch>,
    /// How well numbers are known that a device has counted, relative; 0 without them.
    #[serde(default, skip_serializing_if = "is_zero")]
    rounding: f64,
}

fn is_zero(rounding: &f64) -> bool {
    *rounding == 0.0
}

/// A value and the row that has it, the first one of those that do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    pub value: f64,
    pub design: u64,
    pub step: u64,
}

impl Extreme {
    /// The better one of two: `better` says whether the first value is; of equal ones the first row.
    fn of(one: Option<Extreme>, other: Option<Extreme>, better: fn(f64, f64) -> bool) -> Option<Extreme> {
        let (Some(a), Some(b)) = (one, other) else { return one.or(other) };
        let a_first = (a.design, a.step) <= (b.design, b.step);
        let takes_a = better(a.value, b.value) || a.value == b.value && a_first;
        Some(if takes_a { a } else { b })
    }
}

impl Statistics {
    pub fn new(of: &Expression, quantiles: &[f64]) -> Statistics {
        Statistics {
            of: of.clone(),
            quantiles: quantiles.to_vec(),
            count: 0,
            without_value: 0,
            least: None,
            greatest: None,
            sum: ExactSum::default(),
            squares: ExactSum::default(),
            sketch: (!quantiles.is_empty()).then(Sketch::default),
            rounding: 0.0,
        }
    }

    /// What a device has counted, but for the extremes.
    pub fn add_counted(&mut self, counted: &CountedQuantity) {
        for CountedSum { is_negative, count, sum, squares, exponent } in &counted.sums {
            self.count += count;
            self.sum.add_whole(*is_negative, u128::from(*sum), *exponent);
            self.squares.add_whole(false, *squares, 2 * exponent);
            self.rounding = TRUSTED;
        }
        if let Some(sketch) = &mut self.sketch {
            counted.sketch.iter().for_each(|(value, times)| sketch.add_times(*value, *times));
        }
    }

    /// The root of the mean of the squares.
    fn root_mean_square(&self) -> f64 {
        self.squares.mean(self.count.max(1)).sqrt()
    }

    pub fn of(&self) -> &Expression {
        &self.of
    }

    fn extremes(&mut self, least: Option<Extreme>, greatest: Option<Extreme>) {
        self.least = Extreme::of(self.least, least, |a, b| a < b);
        self.greatest = Extreme::of(self.greatest, greatest, |a, b| a > b);
    }

    pub fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum.mean(self.count))
    }

    /// Of a sample: over the count less 1.
    pub fn standard_deviation(&self) -> Option<f64> {
        (self.count > 1).then(|| standard_deviation(&self.sum, &self.squares, self.count))
    }

    /// The value of rank ceil(share count) in ascending order, to the sketch's error.
    pub fn quantile(&self, share: f64) -> Option<f64> {
        let (least, greatest) = (self.least?.value, self.greatest?.value);
        let rank = ((share * self.count as f64).ceil() as u64).max(1).min(self.count);
        match rank {
            1 => Some(least),
            rank if rank == self.count => Some(greatest),
            rank => Some(self.sketch.as_ref()?.at_rank(rank)?.max(least).min(greatest)),
        }
    }
}

impl Reduction for Statistics {
    fn file_name(&self) -> &'static str {
        "statistics.csv"
    }

    fn quantities(&self) -> Vec<&Expression> {
        vec![&self.of]
    }

    fn add(&mut self, columns: &[&[f64]], rows: &[RowNumbers]) {
        for (value, (design, step)) in columns[0].iter().zip(rows) {
            // Not -0.
            let value = value + 0.0;
            if !value.is_finite() {
                self.without_value += 1;
                continue;
            }
            self.count += 1;
            let is_between = |low: Extreme, high: Extreme| value > low.value && value < high.value;
            if !self.least.zip(self.greatest).is_some_and(|(low, high)| is_between(low, high)) {
                let own = Some(Extreme { value, design: *design, step: *step });
                self.extremes(own, own);
            }
            self.sum.add(value);
            self.squares.add_square(value);
        }
        if let Some(sketch) = &mut self.sketch {
            columns[0].iter().filter(|value| value.is_finite()).for_each(|value| sketch.add(*value));
        }
    }

    fn add_extremes(&mut self, columns: &[&[f64]], rows: &[RowNumbers]) {
        let known = columns[0].iter().zip(rows).filter(|(value, _)| value.is_finite());
        for (value, (design, step)) in known {
            let own = Some(Extreme { value: value + 0.0, design: *design, step: *step });
            self.extremes(own, own);
        }
    }

    fn limits(&self) -> Vec<f64> {
        let limit = |extreme: Option<Extreme>, sign: f64| {
            extreme.map_or(f64::INFINITY, |extreme| sign * extreme.value)
        };
        vec![limit(self.least, 1.0), limit(self.greatest, -1.0)]
    }

    fn push_header(&self, _table_header: &str, out: &mut Vec<u8>) {
        out.extend_from_slice(b"of,unit,statistic,value,relative_error,design,step\n");
    }

    fn push_rows(&self, out: &mut Vec<u8>) {
        let unit = self.of.unit().text();
        for (name, count) in [("count", self.count), ("without_value", self.without_value)] {
            let mut line = Line::default();
            line.text(self.of.text()).text("-").text(name).whole(Some(count));
            line.number(Some(0.0)).whole(None).whole(None);
            line.end(out);
        }
        let mut push = |name: &str, value: Option<f64>, error: f64, from: Option<Extreme>| {
            let mut line = Line::default();
            line.text(self.of.text()).text(&unit).text(name).number(value);
            line.number(value.map(|_| error));
            line.whole(from.map(|from| from.design)).whole(from.map(|from| from.step));
            line.end(out);
        };
        push("min", self.least.map(|least| least.value), 0.0, self.least);
        push("max", self.greatest.map(|greatest| greatest.value), 0.0, self.greatest);
        // Of sums of numbers of both signs, and of differences, what rounding leaves is by the size of the numbers.
        let of_sums = |value: Option<f64>| match self.rounding {
            0.0 => 0.0,
            rounding => rounding * self.root_mean_square() / value.unwrap_or(0.0).abs(),
        };
        let (mean, deviation) = (self.mean(), self.standard_deviation());
        push("mean", mean, of_sums(mean), None);
        push("standard_deviation", deviation, of_sums(deviation), None);
        for share in &self.quantiles {
            let error = self.rounding + self.sketch.as_ref().map_or(0.0, Sketch::relative_error);
            push(&format!("quantile_{share}"), self.quantile(*share), error, None);
        }
    }
}

impl Statistics {
    pub fn merge(&mut self, other: &Statistics) {
        self.count += other.count;
        self.without_value += other.without_value;
        self.extremes(other.least, other.greatest);
        self.sum.merge(&other.sum);
        self.squares.merge(&other.squares);
        if let (Some(own), Some(theirs)) = (&mut self.sketch, &other.sketch) {
            own.merge(theirs);
        }
        self.rounding = self.rounding.max(other.rounding);
    }

    /// Whether they are of the same question.
    pub fn is_like(&self, other: &Statistics) -> bool {
        self.of == other.of && self.quantiles == other.quantiles
    }

    /// Whether it can be what a run has left.
    pub fn is_sound(&self) -> bool {
        self.sketch.is_some() != self.quantiles.is_empty()
    }
}
