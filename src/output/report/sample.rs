//! The designs of a table that are kept whole: all where they are few, else an even sample.

use crate::output::report::tallies::Value;
use crate::study::design::JointDesign;

/// The most designs and rows that are kept.
const MOST_DESIGNS: usize = 20_000;
const MOST_ROWS: usize = 200_000;
/// The most rows of one design that are kept, evenly taken.
const MOST_STEPS: usize = 128;

/// Results of a row that has an answer; NaN where its method does not say.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    pub stiffness: f64,
    pub half_angle: f64,
    pub peak_pressure: f64,
    pub force_error: f64,
    pub linearity_error: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The pin's way, mm, as `Scan::travel` has it; NaN where it is not known: in rows without an answer, what was not asked.
    pub way: f64,
    pub force: f64,
    pub answer: Option<Answer>,
}

#[derive(Clone, Debug)]
pub struct SampledDesign {
    pub number: u64,
    pub joint: JointDesign,
    /// In the order of `Scan::inputs`.
    pub inputs: Vec<Value>,
    pub rows: Vec<Row>,
    /// Every so many rows are kept, and the last one.
    stride: usize,
    seen: usize,
    /// Rows without an answer, and why the first of them has none.
    pub failed: u64,
    pub failure: Option<String>,
}

impl SampledDesign {
    pub fn new(number: u64, joint: JointDesign, inputs: Vec<Value>) -> SampledDesign {
        SampledDesign {
            number,
            joint,
            inputs,
            rows: Vec::new(),
            stride: 1,
            seen: 0,
            failed: 0,
            failure: None,
        }
    }

    /// Keeps every `stride`-th row, and in any case the last one.
    pub fn add(&mut self, row: Row, status: Option<&str>) {
        if row.answer.is_none() {
            self.failed += 1;
            self.failure = self.failure.take().or_else(|| status.map(str::to_string));
        }
        if self.seen > 0 && !(self.seen - 1).is_multiple_of(self.stride) {
            // The last row so far was only kept as the last.
            self.rows.pop();
        }
        self.rows.push(row);
        self.seen += 1;
        if self.rows.len() > MOST_STEPS && (self.seen - 1).is_multiple_of(self.stride) {
            let mut place = 0;
            self.rows.retain(|_| {
                place += 1;
                place % 2 == 1
            });
            self.stride *= 2;
        }
    }

    /// The last row with an answer.
    pub fn last(&self) -> Option<(Row, Answer)> {
        self.rows.iter().rev().find_map(|row| row.answer.map(|answer| (*row, answer)))
    }
}

/// A fixed order of designs that has nothing to do with their order in the sweep (the finalizer of splitmix64): those
/// below a threshold are an even sample of any grid.
fn shuffled(design: u64) -> u64 {
    let mut bits = design.wrapping_add(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// An even sample of designs.
pub struct Sample {
    /// In their order.
    pub designs: Vec<SampledDesign>,
    /// Designs up to here in the fixed order are in it.
    threshold: u64,
    rows: usize,
}

impl Default for Sample {
    fn default() -> Sample {
        Sample { designs: Vec::new(), threshold: u64::MAX, rows: 0 }
    }
}

impl Sample {
    pub fn has_place_for(&self, design: u64) -> bool {
        shuffled(design) <= self.threshold
    }

    /// Adds a design that has a place, and thins the sample out where it has grown too large.
    pub fn add(&mut self, design: SampledDesign) {
        self.rows += design.rows.len();
        self.designs.push(design);
        while self.designs.len() > MOST_DESIGNS || self.rows > MOST_ROWS {
            self.threshold /= 2;
            let limit = self.threshold;
            self.designs.retain(|design| shuffled(design.number) <= limit);
            self.rows = self.designs.iter().map(|design| design.rows.len()).sum();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::material::{Idealization, Material};
    use crate::study::design::Part;

    #[test]
    fn few_rows_are_kept_of_many_and_the_last_is_among_them() {
        let steel = Material { youngs_modulus: 2e5, poissons_ratio: 0.3 };
        let joint = JointDesign {
            idealization: Idealization::PlaneStress,
            hole_radius: 10.0,
            radial_clearance: 0.1,
            thickness: 1.0,
            pin: Part::new("rigid-core", &[("core_radius_ratio", 0.2)], None, steel).unwrap(),
            plate: Part::new("annulus", &[("outer_radius_ratio", 2.0)], None, steel).unwrap(),
        };
        for count in [1, 2, 127, 128, 129, 130, 257, 1000, 100_000] {
            let mut design = SampledDesign::new(0, joint.clone(), Vec::new());
            for step in 0..count {
                design.add(Row { way: f64::from(step), force: 0.0, answer: None }, None);
            }
            let kept: Vec<f64> = design.rows.iter().map(|row| row.way).collect();
            assert!(
                kept.len() <= MOST_STEPS + 1 && kept.len() as i32 >= count.min(60),
                "{count}: {}",
                kept.len()
            );
            assert_eq!((kept[0], kept[kept.len() - 1]), (0.0, f64::from(count - 1)), "{count}");
            assert!(kept.windows(2).all(|pair| pair[0] < pair[1]), "{count}: {kept:?}");
            let gaps: Vec<f64> = kept.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let even = gaps.iter().rev().skip(1).all(|gap| *gap == gaps[0]);
            assert!(even, "{count}: {gaps:?}");
        }
    }
}
