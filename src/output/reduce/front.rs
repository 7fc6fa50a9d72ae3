//! pareto.csv: the rows that no other row beats, being as good in all that is asked and better in some of it.

use serde::{Deserialize, Serialize, Serializer};

use super::line::Line;
use super::{Reduction, RowNumbers};
use crate::engine::question::sign;
use crate::study::expression::Expression;
use crate::study::reduce::Objective;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Front {
    objectives: Vec<Objective>,
    /// In any order: those that have beaten many others are found first.
    #[serde(serialize_with = "sorted")]
    points: Vec<Point>,
    /// Whether there were too many points to keep; there are none then.
    too_many: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Point {
    /// Values, with the other sign where large is good: small is good in all of them. 0 behind the last.
    scores: [f64; 3],
    design: u64,
    step: u64,
    /// The row of the table; empty until it is made.
    row: String,
}

/// Points of a front at most: each new row may be compared with all of them.
pub const MOST_POINTS: usize = 20_000;

impl Front {
    pub fn new(objectives: &[Objective]) -> Front {
        Front { objectives: objectives.to_vec(), points: Vec::new(), too_many: false }
    }

    /// Whether a row belongs to the front so far. Of equal rows the first one does.
    fn takes(&mut self, scores: &[f64; 3], row: (u64, u64)) -> bool {
        let beaten = self.points.iter().position(|point| {
            let equal = point.scores == *scores;
            all_at_most(&point.scores, scores) && !(equal && row < (point.design, point.step))
        });
        match beaten {
            None => true,
            Some(place) => {
                // Who beats many is found soon.
                self.points.swap(place, place / 2);
                false
            }
        }
    }

    /// Adds a point that `takes` has let in.
    fn insert(&mut self, point: Point) {
        self.points.retain(|old| !all_at_most(&point.scores, &old.scores));
        self.points.push(point);
        if self.points.len() > MOST_POINTS {
            self.give_up();
        }
    }

    fn give_up(&mut self) {
        self.too_many = true;
        self.points = Vec::new();
    }

    pub fn merge(&mut self, other: &Front) {
        if self.too_many || other.too_many {
            return self.give_up();
        }
        for point in &other.points {
            if !self.too_many && self.takes(&point.scores, (point.design, point.step)) {
                self.insert(point.clone());
            }
        }
    }

    /// Whether they are of the same question.
    pub fn is_like(&self, other: &Front) -> bool {
        self.objectives == other.objectives
    }

    /// Whether it can be what a run has left.
    pub fn is_sound(&self) -> bool {
        matches!(self.objectives.len(), 2 | 3) && self.points.len() <= MOST_POINTS
    }

    /// Scores that others must not be worse than in all that is asked, those that have beaten most before others.
    pub fn beaten_by(&self) -> impl Iterator<Item = [f64; 3]> {
        // Where there are too many nothing counts any more.
        let all = self.too_many.then_some([f64::NEG_INFINITY; 3]);
        all.into_iter().chain(self.points.iter().map(|point| point.scores))
    }

    /// What a reader must know of it.
    pub fn remark(&self) -> Option<String> {
        let names: Vec<&str> = self.objectives.iter().map(|objective| objective.of.text()).collect();
        self.too_many.then(|| {
            format!(
                "pareto.csv is empty: more than {MOST_POINTS} rows are not beaten by others in {}; keep fewer rows by [select], \
                 or ask for fewer columns",
                names.join(", ")
            )
        })
    }
}

fn all_at_most(a: &[f64; 3], b: &[f64; 3]) -> bool {
    a[0] <= b[0] && a[1] <= b[1] && a[2] <= b[2]
}

/// By the scores, then by the row.
fn in_order(points: &[Point]) -> Vec<&Point> {
    let mut points: Vec<&Point> = points.iter().collect();
    points.sort_by(|a, b| {
        let scores = a.scores.iter().zip(&b.scores).map(|(a, b)| a.total_cmp(b));
        let by_score = scores.into_iter().find(|order| order.is_ne());
        by_score.unwrap_or((a.design, a.step).cmp(&(b.design, b.step)))
    });
    points
}

fn sorted<S: Serializer>(points: &[Point], serializer: S) -> Result<S::Ok, S::Error> {
    in_order(points).serialize(serializer)
}

impl Reduction for Front {
    fn file_name(&self) -> &'static str {
        "pareto.csv"
    }

    fn quantities(&self) -> Vec<&Expression> {
        self.objectives.iter().map(|objective| &objective.of).collect()
    }

    fn add(&mut self, columns: &[&[f64]], rows: &[RowNumbers]) {
        for (place, &(design, step)) in rows.iter().enumerate() {
            let mut scores = [0.0; 3];
            for ((score, column), objective) in scores.iter_mut().zip(columns).zip(&self.objectives) {
                // Not -0.
                *score = column[place] * sign(objective.order) + 0.0;
            }
            let is_known = scores.iter().all(|score| score.is_finite());
            if !self.too_many && is_known && self.takes(&scores, (design, step)) {
                self.insert(Point { scores, design, step, row: String::new() });
            }
        }
    }

    fn make_lines(&mut self, line: &dyn Fn(RowNumbers) -> String) {
        for point in self.points.iter_mut().filter(|point| point.row.is_empty()) {
            point.row = line((point.design, point.step));
        }
    }

    fn push_header(&self, table_header: &str, out: &mut Vec<u8>) {
        let mut line = Line::default();
        for Objective { of, order } in &self.objectives {
            line.text(&format!("{} {}", order.name(), of.text()));
        }
        line.text("step");
        line.end_with(table_header, out);
    }

    fn push_rows(&self, out: &mut Vec<u8>) {
        for point in in_order(&self.points) {
            let mut line = Line::default();
            for (score, objective) in point.scores.iter().zip(&self.objectives) {
                line.number(Some(score * sign(objective.order) + 0.0));
            }
            line.whole(Some(point.step));
            line.end_with(&point.row, out);
        }
    }
}
