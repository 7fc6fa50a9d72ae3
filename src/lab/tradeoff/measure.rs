//! Runs choices on one thread, times them and compares them with the oracle.

use std::time::{Duration, Instant};

use crate::engine::threads::pool;
use crate::error::Error;
use crate::lab::tradeoff::answer::States;
use crate::lab::tradeoff::choice::{Choice, Solution};
use crate::lab::tradeoff::errors::Errors;
use crate::lab::tradeoff::front::front;
use crate::lab::tradeoff::oracle::Oracle;
use crate::study::design::DesignCase;

/// What one choice costs and what it is worth.
#[derive(Clone, Debug)]
pub struct Measured {
    pub family: &'static str,
    pub choice: String,
    pub parameter: Option<f64>,
    /// Runs that were timed; times are their medians.
    pub runs: usize,
    /// Wall time of one thread for all designs, over their count, s.
    pub time_per_design: f64,
    /// Of the fastest run, s: what neighbours on the machine have disturbed least.
    pub least_time_per_design: f64,
    /// Wall time of one thread on what a sweep shares, s.
    pub shared: f64,
    pub errors: Errors,
    /// Whether no other choice is both faster and nearer; see `is_candidate`.
    pub on_front: bool,
}

/// The trade-off of some designs.
pub struct Tradeoff {
    pub designs: usize,
    /// Of the designs, by what the oracle rests on.
    pub by_series: usize,
    pub by_mesh: usize,
    pub rows: Vec<Measured>,
}

/// A choice that leaves a greater share of the steps without an answer has no place on the front.
pub const MOST_UNANSWERED: f64 = 0.05;

/// Force errors below this are those of the oracle as much as of the choice.
pub const LEAST_ERROR: f64 = 1e-9;

/// A choice that has taken longer is not run again.
const PATIENCE: Duration = Duration::from_secs(5);

impl Measured {
    /// Time per design and the force error that 95 % of the steps keep to, at least `LEAST_ERROR`, where nearly all steps
    /// have an answer.
    pub fn point(&self) -> Option<(f64, f64)> {
        let is_candidate = self.errors.unanswered_share() <= MOST_UNANSWERED;
        self.errors
            .force
            .filter(|_| is_candidate)
            .map(|force| (self.time_per_design, force.p95.max(LEAST_ERROR)))
    }
}

/// Every choice up to `runs` times, in turns, so that a busy moment of the machine falls on all alike; `notify` is told of
/// each after its first run.
pub fn measure(
    cases: &[DesignCase],
    choices: &[Choice],
    runs: usize,
    notify: &mut (dyn FnMut(&Measured) + Send),
) -> Result<Tradeoff, Error> {
    // What the library of bodies spreads over threads stays on this one.
    pool(1)?.install(|| {
        let oracle = Oracle::new(cases);
        let mut tallies: Vec<Tally> = choices
            .iter()
            .map(|choice| {
                let tally = Tally::first(cases, choice, &oracle);
                notify(&tally.measured(cases.len()));
                tally
            })
            .collect();
        for _ in 1..runs {
            for tally in tallies.iter_mut().filter(|tally| tally.spent < PATIENCE) {
                tally.run(cases);
            }
        }
        let mut rows: Vec<Measured> = tallies.iter().map(|tally| tally.measured(cases.len())).collect();
        let points: Vec<_> = rows.iter().map(Measured::point).collect();
        for (row, on_front) in rows.iter_mut().zip(front(&points)) {
            row.on_front = on_front;
        }
        Ok(Tradeoff { designs: cases.len(), by_series: oracle.by_series, by_mesh: oracle.by_mesh, rows })
    })
}

/// The runs of one choice so far.
struct Tally<'a> {
    choice: &'a Choice<'a>,
    /// s.
    own: Vec<f64>,
    shared: Vec<f64>,
    spent: Duration,
    errors: Errors,
}

impl<'a> Tally<'a> {
    /// With its first run, which all others repeat to the bit.
    fn first(cases: &[DesignCase], choice: &'a Choice<'a>, oracle: &Oracle) -> Tally<'a> {
        let errors = Errors::default();
        let mut tally = Tally { choice, own: Vec::new(), shared: Vec::new(), spent: Duration::ZERO, errors };
        let states = tally.run(cases);
        tally.errors = Errors::new(&states, &oracle.states);
        tally
    }

    fn run(&mut self, cases: &[DesignCase]) -> States {
        let started = Instant::now();
        let Solution { states, shared, own } = (self.choice.solve)(cases);
        self.own.push(own.as_secs_f64());
        self.shared.push(shared.as_secs_f64());
        self.spent += started.elapsed();
        states
    }

    fn measured(&self, designs: usize) -> Measured {
        Measured {
            family: self.choice.family,
            choice: self.choice.name.clone(),
            parameter: self.choice.parameter,
            runs: self.own.len(),
            time_per_design: median(&self.own) / designs.max(1) as f64,
            least_time_per_design: self.own.iter().fold(f64::INFINITY, |a, b| a.min(*b))
                / designs.max(1) as f64,
            shared: median(&self.shared),
            errors: self.errors,
            on_front: false,
        }
    }
}

/// Of an even count the lower of the two middle ones; 0 without values.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}
