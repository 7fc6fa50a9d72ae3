//! histogram.csv: how many rows have a value in each bin.

use serde::{Deserialize, Serialize};

use super::line::Line;
use super::sketch::Sketch;
use super::{Reduction, RowNumbers};
use crate::engine::question::counted::CountedQuantity;
use crate::study::expression::Expression;
use crate::study::reduce::{self as asked, Spacing};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    /// From 1, of all histograms of a config.
    number: u64,
    asked: asked::Histogram,
    /// Rows where it has no value, or none that is finite.
    without_value: u64,
    /// Rows before the first bin and behind the last.
    below: u64,
    above: u64,
    bins: Bins,
}

/// What is known of the bins before the last row has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Bins {
    Known(Vec<u64>),
    /// The bins go from the smallest to the largest value there is: a fine count is put into them at the end.
    Late {
        sketch: Sketch,
        range: Option<(f64, f64)>,
    },
}

impl Histogram {
    pub fn new(number: u64, asked: &asked::Histogram) -> Histogram {
        let bins = match asked.range {
            Some(_) => Bins::Known(vec![0; asked.bins]),
            None => Bins::Late { sketch: Sketch::default(), range: None },
        };
        Histogram { number, asked: asked.clone(), without_value: 0, below: 0, above: 0, bins }
    }

    /// Bins with their counts, the first one's beginning first.
    fn counted(&self) -> (Vec<f64>, Vec<u64>) {
        match &self.bins {
            Bins::Known(counts) => {
                let (from, to) = self.asked.range.unwrap_or((0.0, 1.0));
                ((0..=counts.len()).map(|place| self.asked.edge(place, from, to)).collect(), counts.clone())
            }
            Bins::Late { range: None, .. } => (Vec::new(), Vec::new()),
            Bins::Late { sketch, range: Some((from, to)) } => {
                if from == to {
                    return (vec![*from, *to], vec![sketch.values().map(|(_, count)| count).sum()]);
                }
                let mut counts = vec![0; self.asked.bins];
                for (value, count) in sketch.values() {
                    counts[self.bin(value.max(*from).min(*to), *from, *to)] += count;
                }
                ((0..=counts.len()).map(|place| self.asked.edge(place, *from, *to)).collect(), counts)
            }
        }
    }

    /// The bin of a value in [from, to]; a value at an edge belongs to the bin that begins there.
    fn bin(&self, value: f64, from: f64, to: f64) -> usize {
        let share = match self.asked.spacing {
            Spacing::Linear => (value / 2.0 - from / 2.0) / (to / 2.0 - from / 2.0),
            Spacing::Log => (value.ln() - from.ln()) / (to.ln() - from.ln()),
        };
        let last = self.asked.bins - 1;
        let mut place = ((share * self.asked.bins as f64) as usize).min(last);
        // Rounding may have led over an edge.
        while place > 0 && value < self.asked.edge(place, from, to) {
            place -= 1;
        }
        while place < last && value >= self.asked.edge(place + 1, from, to) {
            place += 1;
        }
        place
    }

    fn count(&mut self, value: f64) {
        // Not -0.
        let value = value + 0.0;
        if !value.is_finite() {
            self.without_value += 1;
            return;
        }
        match (self.asked.range, &mut self.bins) {
            (Some((from, _)), _) if value < from => self.below += 1,
            (Some((_, to)), _) if value > to => self.above += 1,
            (None, _) if self.asked.spacing == Spacing::Log && value <= 0.0 => self.below += 1,
            (_, Bins::Late { sketch, range }) => {
                sketch.add(value);
                *range = joined(*range, Some((value, value)));
            }
            (range, Bins::Known(_)) => {
                let (from, to) = range.unwrap_or((value, value));
                let bin = self.bin(value, from, to);
                if let Bins::Known(counts) = &mut self.bins {
                    counts[bin] += 1;
                }
            }
        }
    }

    pub fn of(&self) -> &Expression {
        &self.asked.of
    }

    /// Whether the config says what its bins go from and to.
    pub fn has_range(&self) -> bool {
        self.asked.range.is_some()
    }

    /// What a device has counted; of bins that are known, in each.
    pub fn add_counted(&mut self, counted: &CountedQuantity, in_bins: Option<&[u64]>) {
        match (&mut self.bins, in_bins) {
            (Bins::Known(own), Some([below, counts @ .., above])) => {
                own.iter_mut().zip(counts).for_each(|(own, count)| *own += count);
                self.below += below;
                self.above += above;
            }
            (Bins::Late { sketch, .. }, _) => {
                for (value, times) in &counted.sketch {
                    match self.asked.spacing {
                        Spacing::Log if *value <= 0.0 => self.below += times,
                        _ => sketch.add_times(*value, *times),
                    }
                }
            }
            _ => {}
        }
    }

    pub fn merge(&mut self, other: &Histogram) {
        self.without_value += other.without_value;
        self.below += other.below;
        self.above += other.above;
        match (&mut self.bins, &other.bins) {
            (Bins::Known(own), Bins::Known(theirs)) => {
                own.iter_mut().zip(theirs).for_each(|(own, theirs)| *own += theirs);
            }
            (Bins::Late { sketch, range }, Bins::Late { sketch: other_sketch, range: other_range }) => {
                sketch.merge(other_sketch);
                *range = joined(*range, *other_range);
            }
            _ => {}
        }
    }

    /// Whether they are of the same question.
    pub fn is_like(&self, other: &Histogram) -> bool {
        self.asked == other.asked && self.number == other.number
    }

    /// Whether it can be what a run has left.
    pub fn is_sound(&self) -> bool {
        self.asked.bins > 0
            && match &self.bins {
                Bins::Known(counts) => self.asked.range.is_some() && counts.len() == self.asked.bins,
                Bins::Late { .. } => self.asked.range.is_none(),
            }
    }
}

fn joined(a: Option<(f64, f64)>, b: Option<(f64, f64)>) -> Option<(f64, f64)> {
    let (Some(one), Some(other)) = (a, b) else { return a.or(b) };
    Some((one.0.min(other.0), one.1.max(other.1)))
}

impl Reduction for Histogram {
    fn file_name(&self) -> &'static str {
        "histogram.csv"
    }

    fn quantities(&self) -> Vec<&Expression> {
        vec![&self.asked.of]
    }

    fn add(&mut self, columns: &[&[f64]], _rows: &[RowNumbers]) {
        columns[0].iter().for_each(|value| self.count(*value));
    }

    fn add_extremes(&mut self, columns: &[&[f64]], _rows: &[RowNumbers]) {
        let is_log = self.asked.spacing == Spacing::Log;
        let known = columns[0].iter().filter(|value| value.is_finite() && (!is_log || **value > 0.0));
        if let Bins::Late { range, .. } = &mut self.bins {
            known.for_each(|value| *range = joined(*range, Some((*value, *value))));
        }
    }

    fn limits(&self) -> Vec<f64> {
        match self.bins {
            Bins::Known(_) => Vec::new(),
            Bins::Late { range: Some((from, to)), .. } => vec![from, -to],
            Bins::Late { range: None, .. } => vec![f64::INFINITY; 2],
        }
    }

    fn push_header(&self, _table_header: &str, out: &mut Vec<u8>) {
        out.extend_from_slice(b"histogram,of,unit,from,to,count\n");
    }

    fn push_rows(&self, out: &mut Vec<u8>) {
        let (edges, counts) = self.counted();
        let unit = self.asked.of.unit().text();
        let mut push = |from: Option<f64>, to: Option<f64>, count: u64| {
            let mut line = Line::default();
            line.whole(Some(self.number)).text(self.asked.of.text()).text(&unit);
            line.number(from).number(to).whole(Some(count));
            line.end(out);
        };
        if self.below > 0 {
            push(None, edges.first().copied(), self.below);
        }
        for (edges, count) in edges.windows(2).zip(&counts) {
            push(Some(edges[0]), Some(edges[1]), *count);
        }
        if self.above > 0 {
            push(edges.last().copied(), None, self.above);
        }
    }
}
