//! A study's designs for sensitivity, solved, and the indices of some outputs of theirs.

use std::ops::ControlFlow;

use crate::engine::outcome::DesignOutcome;
use crate::engine::status::StatusCounts;
use crate::engine::sweep::{self, SweepOptions};
use crate::error::Error;
use crate::sensitivity::indices::{Indices, Moments, indices, spread};
use crate::study::config::Study;
use crate::study::sampling::row_length;

/// A number of an outcome, at its last load step.
pub struct Output<'a> {
    /// For complaints.
    pub name: &'a str,
    pub value: &'a dyn Fn(&DesignOutcome) -> Option<f64>,
}

/// What came of one output.
#[derive(Clone, Debug)]
pub struct OutputIndices {
    /// Over all independent points, as the output.
    pub mean: f64,
    pub standard_deviation: f64,
    /// `None` where the output does not change.
    pub indices: Option<Indices>,
    /// Samples with a design that has no such number.
    pub left_out: u64,
}

#[derive(Clone, Debug)]
pub struct Analysis {
    /// In the order of the outputs.
    pub outputs: Vec<OutputIndices>,
    pub samples: u64,
    pub designs: u64,
    pub statuses: StatusCounts,
}

/// Solves `study`, which `Study::for_sensitivity` has made; `advance` is called after each design.
pub fn analyse(
    study: &Study,
    outputs: &[Output],
    options: &SweepOptions,
    advance: &mut dyn FnMut(),
) -> Result<Analysis, Error> {
    let mut receiver = Receiver::new(study, outputs);
    sweep::run(study, options, &mut |outcome| {
        receiver.receive(&outcome);
        advance();
        Ok(ControlFlow::Continue(()))
    })?;
    receiver.finish()
}

/// Takes outcomes in the order of the designs and keeps sums only.
struct Receiver<'a> {
    outputs: &'a [Output<'a>],
    row_length: usize,
    samples: u64,
    designs: u64,
    statuses: StatusCounts,
    /// Of each output, the values of the row at hand.
    rows: Vec<Vec<Option<f64>>>,
    moments: Vec<Moments>,
}

impl<'a> Receiver<'a> {
    fn new(study: &Study, outputs: &'a [Output<'a>]) -> Receiver<'a> {
        let factors = study.factors().len();
        let samples = study.design_count() / row_length(factors);
        Receiver {
            outputs,
            row_length: factors + 2,
            samples,
            designs: 0,
            statuses: StatusCounts::default(),
            rows: vec![Vec::with_capacity(factors + 2); outputs.len()],
            moments: vec![Moments::new(factors, samples); outputs.len()],
        }
    }

    fn receive(&mut self, outcome: &DesignOutcome) {
        self.designs += 1;
        let step = outcome.steps.last();
        if let Some(step) = step {
            self.statuses.add(&step.status);
        }
        for ((output, row), moments) in self.outputs.iter().zip(&mut self.rows).zip(&mut self.moments) {
            row.push((output.value)(outcome));
            if row.len() == self.row_length {
                moments.add_row(row);
                row.clear();
            }
        }
    }

    fn finish(self) -> Result<Analysis, Error> {
        let Receiver { outputs, samples, designs, statuses, moments, .. } = self;
        let outputs = outputs.iter().zip(&moments).map(|(output, moments)| {
            let left_out = moments.left_out();
            let (mean, standard_deviation) =
                spread(moments).filter(|_| 2 * left_out <= samples).ok_or_else(|| Error::Asked {
                    problem: too_few(output.name, left_out, samples, &statuses),
                })?;
            Ok(OutputIndices { mean, standard_deviation, indices: indices(moments), left_out })
        });
        Ok(Analysis { outputs: outputs.collect::<Result<_, Error>>()?, samples, designs, statuses })
    }
}

fn too_few(name: &str, left_out: u64, samples: u64, statuses: &StatusCounts) -> String {
    let most = statuses.failures().iter().max_by_key(|(_, count)| **count);
    let why = match most {
        Some((status, count)) => format!(", {count} designs with `{status}`"),
        None => String::new(),
    };
    format!(
        "{left_out} of {samples} samples have a design without {name}{why}: more than half, and what is left says nothing of \
         the ranges asked; make them narrower"
    )
}
