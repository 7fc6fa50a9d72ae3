//! What a reader of a row must know: remarks on an answer, or why there is none. Text only at the table.

use std::collections::BTreeMap;
use std::fmt;

use crate::engine::refusal::Refusal;
use crate::mechanics::contact::load::NoState;
use crate::mechanics::laws::LawError;

/// Something that an answer is to be read with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remark {
    /// The clearance is so large that the outlines to second order say little.
    ClearanceBeyondModel,
    /// Finite displacement changes the force by more than is asked, and by more than 1 %.
    LargeDisplacement,
    PressureNotPositive,
    AccuracyNotMet,
    /// The law knows nothing of the plate's size and support.
    PlateNotModelled,
    /// The overlap of a press fit alone is more than a yield stress that was given.
    YieldsAtRest,
    /// The load is too small to close the gap: the bodies do not press each other, and the force is 0.
    NoContact,
}

impl Remark {
    /// In the order they are told.
    pub const ALL: [Remark; 7] = [
        Remark::ClearanceBeyondModel,
        Remark::LargeDisplacement,
        Remark::PressureNotPositive,
        Remark::AccuracyNotMet,
        Remark::PlateNotModelled,
        Remark::YieldsAtRest,
        Remark::NoContact,
    ];

    pub fn text(self) -> &'static str {
        match self {
            Remark::ClearanceBeyondModel => "clearance beyond the model",
            Remark::LargeDisplacement => "large displacement",
            Remark::PressureNotPositive => "pressure not positive everywhere",
            Remark::AccuracyNotMet => "accuracy not met",
            Remark::PlateNotModelled => "plate extent not modelled",
            Remark::YieldsAtRest => "yields at rest",
            Remark::NoContact => "no contact",
        }
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// Known beforehand: nothing was solved.
    Refused(Refusal),
    /// With the largest half angle that the scene allows, rad.
    NoState(NoState, f64),
    /// A mesh far too coarse for its body may answer with a pull.
    NotAPush,
    Law(LawError),
    /// A column.
    NotFinite(&'static str),
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Failure::Refused(refusal) => refusal.fmt(out),
            Failure::NoState(NoState::ContactTooWide, limit) => {
                write!(out, "contact wider than {:.0} deg", limit.to_degrees())
            }
            Failure::NoState(NoState::ContactTooNarrow, _) => {
                out.write_str("the load is so small that its contact is too narrow to be solved")
            }
            Failure::NoState(NoState::BrokenCompliance, _) => out.write_str(
                "compliance not positive definite, mostly of a wall too thin or too incompressible for its mesh",
            ),
            Failure::NoState(NoState::ClearanceTooWide, _) => out.write_str("clearance beyond the model"),
            Failure::NotAPush => {
                out.write_str("the bodies do not push each other, the mesh is too coarse for them")
            }
            Failure::Law(error) => error.fmt(out),
            Failure::NotFinite(column) => write!(out, "{column} is not a finite number"),
        }
    }
}

/// What has become of a load step. Failures are rare and large: elsewhere, so that the many answers are small.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    Answered(Remarks),
    Failed(Box<Failure>),
}

/// Those of `Remark::ALL` that apply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Remarks(u8);

impl Remarks {
    pub fn of(all: &[(bool, Remark)]) -> Remarks {
        Remarks(all.iter().filter(|(applies, _)| *applies).map(|(_, remark)| 1 << *remark as u8).sum())
    }

    pub fn has(self, remark: Remark) -> bool {
        self.0 & (1 << remark as u8) != 0
    }
}

impl Status {
    pub const OK: Status = Status::Answered(Remarks(0));

    /// Whether there is an answer with this remark.
    pub fn has(&self, remark: Remark) -> bool {
        matches!(self, Status::Answered(remarks) if remarks.has(remark))
    }

    pub fn is_failed(&self) -> bool {
        matches!(self, Status::Failed(_))
    }
}

/// "ok", remarks with "; " between them, or "failed: " and why.
impl fmt::Display for Status {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            &Status::OK => out.write_str("ok"),
            Status::Answered(remarks) => {
                let said = Remark::ALL.into_iter().filter(|remark| remarks.has(*remark));
                for (place, remark) in said.enumerate() {
                    write!(out, "{}{}", if place == 0 { "" } else { "; " }, remark.text())?;
                }
                Ok(())
            }
            Status::Failed(failure) => write!(out, "failed: {failure}"),
        }
    }
}

/// How often each status was met.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatusCounts {
    /// By the bits of remarks.
    answered: [u64; 1 << Remark::ALL.len()],
    failed: BTreeMap<String, u64>,
}

impl Default for StatusCounts {
    fn default() -> StatusCounts {
        StatusCounts { answered: [0; _], failed: BTreeMap::new() }
    }
}

impl StatusCounts {
    pub fn add(&mut self, status: &Status) {
        match status {
            Status::Answered(Remarks(bits)) => self.answered[usize::from(*bits)] += 1,
            Status::Failed(_) => *self.failed.entry(status.to_string()).or_default() += 1,
        }
    }

    /// Adds answers with the same remarks.
    pub fn add_answered(&mut self, Remarks(bits): Remarks, times: u64) {
        self.answered[usize::from(bits)] += times;
    }

    /// Adds what was counted elsewhere.
    pub fn merge(&mut self, other: &StatusCounts) {
        for (own, more) in self.answered.iter_mut().zip(other.answered) {
            *own += more;
        }
        for (text, count) in &other.failed {
            *self.failed.entry(text.clone()).or_default() += count;
        }
    }

    /// Counts one failure of this text less.
    pub fn forget(&mut self, failure: &str) {
        if let Some(count) = self.failed.get_mut(failure) {
            *count -= 1;
            if *count == 0 {
                self.failed.remove(failure);
            }
        }
    }

    /// From what `by_text` and `failures` gave.
    pub fn from_text(all: BTreeMap<String, u64>, failed: BTreeMap<String, u64>) -> StatusCounts {
        let text = |bits: usize| Status::Answered(Remarks(bits as u8)).to_string();
        let answered = std::array::from_fn(|bits| all.get(&text(bits)).copied().unwrap_or(0));
        StatusCounts { answered, failed }
    }

    /// By what the table says.
    pub fn by_text(&self) -> BTreeMap<String, u64> {
        let mut all = self.failed.clone();
        for (bits, count) in (0..).zip(self.answered).filter(|(_, count)| *count > 0) {
            all.insert(Status::Answered(Remarks(bits)).to_string(), count);
        }
        all
    }

    /// Those without an answer.
    pub fn failures(&self) -> &BTreeMap<String, u64> {
        &self.failed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_are_told_in_their_order_and_counted_together() {
        let both = Remarks::of(&[(true, Remark::AccuracyNotMet), (true, Remark::LargeDisplacement)]);
        let status = Status::Answered(both);
        assert_eq!(status.to_string(), "large displacement; accuracy not met");
        assert!(status.has(Remark::AccuracyNotMet) && !status.has(Remark::PressureNotPositive));
        let failed = Status::Failed(Failure::NoState(NoState::ContactTooWide, 1.54).into());
        let mut counts = StatusCounts::default();
        [Status::OK, status, failed, Status::OK].iter().for_each(|status| counts.add(status));
        let expected = [
            ("failed: contact wider than 88 deg", 1),
            ("large displacement; accuracy not met", 1),
            ("ok", 2),
        ];
        assert_eq!(counts.by_text(), expected.map(|(text, count)| (text.to_string(), count)).into());
        assert_eq!(counts.failures().len(), 1);
        let read = StatusCounts::from_text(counts.by_text(), counts.failures().clone());
        assert_eq!(read, counts);
        let mut twice = StatusCounts::default();
        [&counts, &read].iter().for_each(|more| twice.merge(more));
        assert_eq!(twice.by_text(), expected.map(|(text, count)| (text.to_string(), 2 * count)).into());
    }
}
