//! Runs choices on one thread, times them and compares them with the oracle.

use std::time::{Duration, Instant};

use crate::error::Error;
use crate::study::design::DesignCase;
use crate::tradeoff::choice::Choice;
use crate::tradeoff::errors::Errors;
use crate::tradeoff::front::front;
use crate::tradeoff::oracle::Oracle;

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

/// Further runs of a choice begin within this time.
const PATIENCE: Duration = Duration::from_secs(5);

impl Measured {
    /// Time per design and the force error that 95 % of the steps keep to, where nearly all steps have an answer.
    pub fn point(&self) -> Option<(f64, f64)> {
        let is_candidate = self.errors.unanswered_share() <= MOST_UNANSWERED;
        self.errors.force.filter(|_| is_candidate).map(|force| (self.time_per_design, force.p95))
    }
}

/// Every choice up to `runs` times, one after the other, `notify` told of each as it is done.
pub fn measure(
    cases: &[DesignCase],
    choices: &[Choice],
    runs: usize,
    notify: &mut (dyn FnMut(&Measured) + Send),
) -> Result<Tradeoff, Error> {
    // What the library of bodies spreads over threads stays on this one.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .map_err(|error| Error::Threads { threads: 1, problem: error.to_string() })?;
    pool.install(|| {
        let oracle = Oracle::new(cases);
        let mut rows = Vec::new();
        for choice in choices {
            let measured = measure_choice(cases, choice, runs, &oracle);
            notify(&measured);
            rows.push(measured);
        }
        let points: Vec<_> = rows.iter().map(Measured::point).collect();
        for (row, on_front) in rows.iter_mut().zip(front(&points)) {
            row.on_front = on_front;
        }
        Ok(Tradeoff { designs: cases.len(), by_series: oracle.by_series, by_mesh: oracle.by_mesh, rows })
    })
}

fn measure_choice(cases: &[DesignCase], choice: &Choice, runs: usize, oracle: &Oracle) -> Measured {
    let started = Instant::now();
    let (mut own, mut shared) = (Vec::new(), Vec::new());
    let mut errors = Errors::default();
    while own.len() < runs.max(1) && (own.is_empty() || started.elapsed() < PATIENCE) {
        let solution = (choice.solve)(cases);
        own.push(solution.own.as_secs_f64());
        shared.push(solution.shared.as_secs_f64());
        if own.len() == 1 {
            errors = Errors::new(&solution.states, &oracle.states);
        }
    }
    Measured {
        family: choice.family,
        choice: choice.name.clone(),
        parameter: choice.parameter,
        runs: own.len(),
        time_per_design: median(&mut own) / cases.len().max(1) as f64,
        shared: median(&mut shared),
        errors,
        on_front: false,
    }
}

/// Of an even count the lower of the two middle ones; 0 without values.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}
