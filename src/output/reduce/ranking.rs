//! best.csv: the rows with the largest or smallest values.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use super::line::Line;
use super::{Reduction, RowNumbers};
use crate::engine::question::sign;
use crate::study::expression::Expression;
use crate::study::reduce::{Best, Order};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ranking {
    asked: Best,
    /// The best first.
    places: Vec<Place>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Place {
    value: f64,
    design: u64,
    step: u64,
    /// The row of the table; empty until it is made.
    row: String,
}

impl Ranking {
    pub fn new(asked: &Best) -> Ranking {
        Ranking { asked: asked.clone(), places: Vec::new() }
    }

    /// Of equal values the first row is better.
    fn compare(order: Order, a: (f64, u64, u64), b: (f64, u64, u64)) -> Ordering {
        let by_value = match order {
            Order::Smallest => a.0.total_cmp(&b.0),
            Order::Largest => b.0.total_cmp(&a.0),
        };
        by_value.then((a.1, a.2).cmp(&(b.1, b.2)))
    }

    /// Where a row has its place; `None` beyond the last.
    fn rank(&self, key: (f64, u64, u64)) -> Option<usize> {
        let is_better = |place: &Place| {
            Ranking::compare(self.asked.order, (place.value, place.design, place.step), key) == Ordering::Less
        };
        if self.places.len() >= self.asked.count && self.places.last().is_some_and(is_better) {
            return None;
        }
        Some(self.places.partition_point(is_better))
    }

    fn insert(&mut self, rank: usize, place: Place) {
        self.places.insert(rank, place);
        self.places.truncate(self.asked.count);
    }

    pub fn merge(&mut self, other: &Ranking) {
        for place in &other.places {
            if let Some(rank) = self.rank((place.value, place.design, place.step)) {
                self.insert(rank, place.clone());
            }
        }
    }

    /// Whether they are of the same question.
    pub fn is_like(&self, other: &Ranking) -> bool {
        self.asked == other.asked
    }
}

impl Reduction for Ranking {
    fn file_name(&self) -> &'static str {
        "best.csv"
    }

    fn quantities(&self) -> Vec<&Expression> {
        vec![&self.asked.by]
    }

    fn add(&mut self, columns: &[&[f64]], rows: &[RowNumbers]) {
        for (value, (design, step)) in columns[0].iter().zip(rows) {
            // Not -0.
            let (value, design, step) = (value + 0.0, *design, *step);
            if value.is_finite()
                && let Some(rank) = self.rank((value, design, step))
            {
                self.insert(rank, Place { value, design, step, row: String::new() });
            }
        }
    }

    fn limits(&self) -> Vec<f64> {
        let last = self.places.last().filter(|_| self.places.len() >= self.asked.count);
        vec![last.map_or(f64::INFINITY, |last| sign(self.asked.order) * last.value)]
    }

    fn make_lines(&mut self, line: &dyn Fn(RowNumbers) -> String) {
        for place in self.places.iter_mut().filter(|place| place.row.is_empty()) {
            place.row = line((place.design, place.step));
        }
    }

    fn push_header(&self, table_header: &str, out: &mut Vec<u8>) {
        out.extend_from_slice(b"by,order,rank,value,unit,step,");
        out.extend_from_slice(table_header.as_bytes());
        out.push(b'\n');
    }

    fn push_rows(&self, out: &mut Vec<u8>) {
        let unit = self.asked.by.unit().text();
        for (rank, place) in (1..).zip(&self.places) {
            let mut line = Line::default();
            line.text(self.asked.by.text()).text(self.asked.order.name()).whole(Some(rank));
            line.number(Some(place.value)).text(&unit).whole(Some(place.step));
            line.end_with(&place.row, out);
        }
    }
}
