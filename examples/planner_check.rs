//! Measures what the planner's choices cost beside the cheapest that would have done: random designs, a third each of
//! concentric bodies, half discs in annuli and discs in blocks, through all choices that a sweep could be given, and
//! through the planner at 10 %, 1 % and 0.1 %. For each design the cheapest sufficient choice is known only afterwards,
//! from the oracle.
//!
//! ```text
//! cargo run --release --example planner_check -- 1000 3 results/planner    # designs, runs of each choice, folder
//! ```
//!
//! Prints a table and writes `planner.csv` (each accuracy and kind), `choices.csv` (each choice and kind) and
//! `manifest.json`. A choice's time for a design is the mean over all designs of the kind, run as one batch on one thread;
//! what a sweep shares, however many its designs, is beside it.

#[path = "../tests/common/draws.rs"]
mod draws;
#[path = "../tests/common/random.rs"]
mod random;

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant, SystemTime};

use draws::{concentric, disc_in_block, draw, half_disc_in_annulus};
use jointsweep::internals::engine::body_request::Fidelity;
use jointsweep::internals::engine::ladder::Ladder;
use jointsweep::internals::engine::status::Remark;
use jointsweep::internals::lab::tradeoff::answer::States;
use jointsweep::internals::lab::tradeoff::choice::{Choice, Family, Scope, Solution};
use jointsweep::internals::lab::tradeoff::errors::force_error;
use jointsweep::internals::lab::tradeoff::families::{closed_form, planner, series};
use jointsweep::internals::lab::tradeoff::joints::Terms;
use jointsweep::internals::lab::tradeoff::oracle::Oracle;
use jointsweep::internals::mechanics::body::Body;
use jointsweep::internals::mechanics::compliance::arc::{FEW_TERMS, TERM_CHOICES};
use jointsweep::internals::mechanics::grading::LEVEL_COUNT;
use jointsweep::internals::output::host::{Host, utc};
use jointsweep::internals::output::manifest;
use jointsweep::internals::study::config::{MethodChoice, SolveOptions};
use jointsweep::internals::study::design::{DesignCase, Part};
use random::Random;

const ACCURACIES: [f64; 3] = [0.1, 1e-2, 1e-3];

/// A choice that has taken longer is not run again.
const PATIENCE: Duration = Duration::from_secs(5);

/// Of the designs of a kind that a choice must be enough for, to be enough for the kind.
const ENOUGH: f64 = 0.99;

/// How choices with as many trial pressures as a sweep takes are named.
const BY_DEPTH: &str = "terms by depth";

type Shapes = fn(&mut Random) -> (Part, Part);

const KINDS: [(&str, u64, Shapes); 3] = [
    ("concentric", 101, concentric),
    ("half disc in annulus", 102, half_disc_in_annulus),
    ("disc in block", 103, disc_in_block),
];

static MESH: Family = Family { name: "mesh", about: "all bodies on meshes", parameter: "mesh level" };
static EXACT_AND_MESH: Family = Family {
    name: "exact-and-mesh",
    about: "exact modes where a body has them, else meshes",
    parameter: "mesh level",
};
static SERIES: Family = Family { name: "series", about: "exact modes", parameter: "trial pressures" };

/// What one choice takes and is worth on the designs of one kind.
struct Measured {
    family: &'static str,
    name: String,
    /// s a design.
    own: f64,
    shared: f64,
    runs: usize,
    /// Of each design; infinite without an answer.
    errors: Vec<f64>,
}

/// Designs of one kind that the oracle has an answer to, and all choices on them.
struct Kind {
    name: &'static str,
    designs: usize,
    choices: Vec<Measured>,
    /// One for each of `ACCURACIES`.
    planner: Vec<Planned>,
}

struct Planned {
    measured: Measured,
    /// `force_error` of each design.
    estimates: Vec<f64>,
    /// Whether its row says that the accuracy is met.
    claimed: Vec<bool>,
}

/// Sums over designs of the least own time among sufficient choices, s.
#[derive(Clone, Copy, Default)]
struct Costs {
    /// Designs that any choice is enough for.
    designs: f64,
    planner: f64,
    cheapest: f64,
    cheapest_without_laws: f64,
    /// And with as many trial pressures as a sweep takes for the half angle and the peak pressure's sake.
    cheapest_of_same_terms: f64,
    /// One choice for the whole kind, enough for `ENOUGH` of it; infinite without one.
    cheapest_of_kind: f64,
    within: f64,
    claimed: f64,
    bounded: f64,
    judged: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let started = SystemTime::now();
    let argument = |number: usize| std::env::args().nth(number);
    let count: u64 = argument(1).map_or(Ok(1000), |text| text.parse())?;
    let runs: usize = argument(2).map_or(Ok(3), |text| text.parse())?;
    let folder = argument(3);

    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut kinds = Vec::new();
    for (number, (name, seed, shapes)) in KINDS.into_iter().enumerate() {
        let count = count / 3 + u64::from((number as u64) < count % 3);
        let cases = draw(seed, count, shapes);
        let clock = Instant::now();
        let oracle = Oracle::new(&cases).states;
        eprintln!("{name}: {count} designs, oracle in {:.1} s", clock.elapsed().as_secs_f64());
        kinds.push(one_thread.install(|| measure(name, &cases, &oracle, runs)));
    }

    let mut table =
        "accuracy,kind,designs,with_a_sufficient_choice,planner_s,cheapest_s,ratio,cheapest_without_closed_forms_s,\
                     ratio_without_closed_forms,cheapest_of_same_terms_s,ratio_of_same_terms,cheapest_for_the_kind,cheapest_for_the_kind_s,\
                     ratio_to_it,share_within,share_claimed,share_bounded\n"
            .to_string();
    println!(
        "{:>8} {:22} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}",
        "accuracy",
        "kind",
        "us/design",
        "ratio",
        "no laws",
        "terms",
        "by kind",
        "within",
        "claimed",
        "bounded"
    );
    for (number, accuracy) in ACCURACIES.into_iter().enumerate() {
        let mut all = Costs::default();
        for kind in &kinds {
            let (costs, best) = kind.costs(number, accuracy);
            all.add(&costs);
            let best = best.map_or(String::new(), |best| format!("{} {}", best.family, best.name));
            costs.tell(accuracy, kind.name, &best, &mut table);
        }
        all.tell(accuracy, "all", "", &mut table);
    }
    if let Some(folder) = folder {
        save(Path::new(&folder), &table, &kinds, started, runs)?;
    }
    Ok(())
}

/// What a sweep could be given instead, the planner last.
fn choices(is_concentric: bool) -> Vec<Choice<'static>> {
    const SCOPE: Scope<'static> = Scope { gpu: None, least_angle: 0.1 };
    let mut choices = closed_form::choices(&closed_form::FAMILY, &SCOPE);
    let each_terms = || {
        let few = FEW_TERMS.into_iter().chain(TERM_CHOICES).map(Terms::Fixed);
        few.chain([Terms::ByDepth])
    };
    let words = |terms: Terms| match terms {
        Terms::Fixed(terms) => format!("{terms} terms"),
        Terms::ByDepth => BY_DEPTH.to_string(),
    };
    if is_concentric {
        choices.extend(each_terms().map(|terms| {
            SERIES.choice(words(terms), None, move |cases| series::solve(terms, Fidelity::Series, cases))
        }));
    }
    for level in 0..LEVEL_COUNT {
        // All trial pressures where they may decide, on the finest meshes as many as a sweep takes.
        for terms in each_terms().filter(|terms| level < 4 || *terms == Terms::ByDepth) {
            let mesh = Fidelity::Mesh { level };
            let name = || format!("level {level}, {}", words(terms));
            let parameter = Some(level as f64);
            // Where one body has exact modes, all on meshes is the dearer: the ladder itself is enough of it.
            if is_concentric || (terms == Terms::ByDepth && level < 4) {
                choices.push(MESH.choice(name(), parameter, move |cases| series::solve(terms, mesh, cases)));
            }
            if !is_concentric {
                let each = move |body: &Body| if body.shape.concentric { Fidelity::Series } else { mesh };
                choices.push(
                    EXACT_AND_MESH
                        .choice(name(), parameter, move |cases| series::solve_bodies(terms, each, cases)),
                );
            }
        }
    }
    choices.extend(ACCURACIES.into_iter().map(|accuracy| {
        planner::FAMILY.choice(format!("{} %", 100.0 * accuracy), Some(accuracy), move |cases| {
            planner::solve(accuracy, cases)
        })
    }));
    choices
}

/// Every choice up to `runs` times, in turns, so that a busy moment of the machine falls on all alike.
fn measure(name: &'static str, cases: &[DesignCase], oracle: &States, runs: usize) -> Kind {
    let choices = choices(name == "concentric");
    let judged: Vec<usize> = (0..cases.len()).filter(|case| oracle[*case][0].is_some()).collect();
    let mut times: Vec<Vec<(f64, f64)>> = vec![Vec::new(); choices.len()];
    let mut errors = Vec::new();
    for run in 0..runs {
        for (choice, times) in choices.iter().zip(&mut times) {
            if times.iter().any(|(own, _)| *own > PATIENCE.as_secs_f64()) {
                continue;
            }
            let Solution { states, shared, own } = (choice.solve)(cases);
            times.push((own.as_secs_f64(), shared.as_secs_f64()));
            if run > 0 {
                continue;
            }
            let error = |case: &usize| {
                let (found, exact) = (states[*case][0], oracle[*case][0]);
                found.zip(exact).map_or(f64::INFINITY, |(found, exact)| force_error(&found, &exact))
            };
            errors.push(judged.iter().map(error).collect::<Vec<f64>>());
        }
        eprintln!("{name}: run {} of {runs}", run + 1);
    }
    let per_design = |times: &[(f64, f64)], of: fn(&(f64, f64)) -> f64| {
        median(times.iter().map(of).collect()) / cases.len() as f64
    };
    let mut measured: Vec<Measured> = choices
        .iter()
        .zip(times)
        .zip(errors)
        .map(|((choice, times), errors)| Measured {
            family: choice.family,
            name: choice.name.clone(),
            own: per_design(&times, |time| time.0),
            shared: per_design(&times, |time| time.1),
            runs: times.len(),
            errors,
        })
        .collect();
    let planned = measured.split_off(measured.len() - ACCURACIES.len());
    let planner = planned.into_iter().zip(ACCURACIES).map(|(measured, accuracy)| {
        let outcomes = Ladder::new(SolveOptions { accuracy, method: MethodChoice::Auto }).solve(cases);
        let rows: Vec<_> = judged.iter().map(|case| &outcomes[*case].steps[0]).collect();
        let estimate = |response: Option<jointsweep::internals::engine::outcome::Response>| {
            response.map_or(f64::INFINITY, |response| response.force_error)
        };
        Planned {
            measured,
            estimates: rows.iter().map(|row| estimate(row.response)).collect(),
            claimed: rows
                .iter()
                .map(|row| row.response.is_some() && !row.status.has(Remark::AccuracyNotMet))
                .collect(),
        }
    });
    Kind { name, designs: judged.len(), choices: measured, planner: planner.collect() }
}

/// Of an even count the lower of the two middle ones.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() - 1) / 2]
}

impl Measured {
    fn share_within(&self, accuracy: f64) -> f64 {
        let within = self.errors.iter().filter(|error| **error <= accuracy).count();
        within as f64 / self.errors.len() as f64
    }
}

impl Kind {
    /// At one of `ACCURACIES`, with the one choice that is the cheapest for the whole kind.
    fn costs(&self, number: usize, accuracy: f64) -> (Costs, Option<&Measured>) {
        let Planned { measured, estimates, claimed } = &self.planner[number];
        let mut costs = Costs { judged: self.designs as f64, ..Costs::default() };
        for design in 0..self.designs {
            let least = |allowed: &dyn Fn(&Measured) -> bool| {
                self.choices
                    .iter()
                    .filter(|choice| allowed(choice))
                    .filter(|choice| choice.errors[design] <= accuracy)
                    .map(|choice| choice.own)
                    .min_by(f64::total_cmp)
            };
            let without_laws = least(&|choice| choice.family != closed_form::FAMILY.name);
            let of_same_terms = least(&|choice| choice.name.ends_with(BY_DEPTH));
            if let (Some(with), Some(without), Some(same)) = (least(&|_| true), without_laws, of_same_terms) {
                costs.designs += 1.0;
                costs.planner += measured.own;
                costs.cheapest += with;
                costs.cheapest_without_laws += without;
                costs.cheapest_of_same_terms += same;
            }
            let error = measured.errors[design];
            costs.within += f64::from(u8::from(error <= accuracy));
            costs.claimed += f64::from(u8::from(claimed[design]));
            costs.bounded += f64::from(u8::from(error <= estimates[design]));
        }
        let enough = self.choices.iter().filter(|choice| choice.share_within(accuracy) >= ENOUGH);
        let best = enough.min_by(|a, b| a.own.total_cmp(&b.own));
        costs.cheapest_of_kind = best.map_or(f64::INFINITY, |best| best.own * costs.designs);
        (costs, best)
    }
}

impl Costs {
    fn add(&mut self, other: &Costs) {
        self.designs += other.designs;
        self.planner += other.planner;
        self.cheapest += other.cheapest;
        self.cheapest_without_laws += other.cheapest_without_laws;
        self.cheapest_of_same_terms += other.cheapest_of_same_terms;
        self.cheapest_of_kind += other.cheapest_of_kind;
        self.within += other.within;
        self.claimed += other.claimed;
        self.bounded += other.bounded;
        self.judged += other.judged;
    }

    /// One line for a reader, and one of the table.
    fn tell(&self, accuracy: f64, kind: &str, best: &str, table: &mut String) {
        let ratios =
            [self.cheapest, self.cheapest_without_laws, self.cheapest_of_same_terms, self.cheapest_of_kind]
                .map(|cheapest| self.planner / cheapest);
        let shares = [self.within, self.claimed, self.bounded].map(|count| count / self.judged);
        print!("{:>6} % {kind:22} {:>10.1}", 100.0 * accuracy, 1e6 * self.planner / self.designs);
        ratios.iter().for_each(|ratio| print!(" {ratio:>8.2}"));
        shares.iter().for_each(|share| print!(" {:>6.1} %", 100.0 * share));
        println!("  {best}");
        *table += &format!(
            "{accuracy},{kind},{},{},{:.3e},{:.3e},{:.3},{:.3e},{:.3},{:.3e},{:.3},\"{best}\",{},{},{:.4},{:.4},{:.4}\n",
            self.judged,
            self.designs,
            self.planner,
            self.cheapest,
            ratios[0],
            self.cheapest_without_laws,
            ratios[1],
            self.cheapest_of_same_terms,
            ratios[2],
            finite(self.cheapest_of_kind),
            finite(ratios[3]),
            shares[0],
            shares[1],
            shares[2],
        );
    }
}

/// Four digits; nothing where there is no choice.
fn finite(value: f64) -> String {
    if value.is_finite() && value > 0.0 { format!("{value:.3e}") } else { String::new() }
}

fn save(
    folder: &Path,
    table: &str,
    kinds: &[Kind],
    started: SystemTime,
    runs: usize,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut choices = "kind,family,choice,runs,time_per_design_s,shared_per_design_s,force_error_p95,\
                       share_within_10_percent,share_within_1_percent,share_within_0.1_percent\n"
        .to_string();
    for kind in kinds {
        for choice in kind.choices.iter().chain(kind.planner.iter().map(|planned| &planned.measured)) {
            let Measured { family, name, own, shared, runs, errors } = choice;
            let mut sorted = errors.clone();
            sorted.sort_by(f64::total_cmp);
            let p95 = sorted.get((0.95 * sorted.len() as f64) as usize).copied().unwrap_or(f64::INFINITY);
            choices +=
                &format!("{},{family},\"{name}\",{runs},{own:.3e},{shared:.3e},{}", kind.name, finite(p95));
            for accuracy in ACCURACIES {
                choices += &format!(",{:.4}", choice.share_within(accuracy));
            }
            choices.push('\n');
        }
    }
    let designs: usize = kinds.iter().map(|kind| kind.planner[0].measured.errors.len()).sum();
    let manifest = serde_json::json!({
        "program": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "command": "cargo run --release --example planner_check",
        "arguments": std::env::args().skip(1).collect::<Vec<_>>(),
        "commit": commit(),
        "designs_with_an_oracle": designs,
        "seeds": KINDS.map(|(name, seed, _)| format!("{name}: {seed}")),
        "runs": runs,
        "threads": 1,
        "started_utc": utc(started),
        "wall_seconds": started.elapsed()?.as_secs_f64(),
        "host": Host::current(),
    });
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("planner.csv"), table)?;
    std::fs::write(folder.join("choices.csv"), choices)?;
    Ok(manifest::write(&manifest, &folder.join("manifest.json"))?)
}

/// Of the sources, where git tells it.
fn commit() -> Option<String> {
    let told = Command::new("git").args(["rev-parse", "--short", "HEAD"]).output().ok()?;
    told.status.success().then(|| String::from_utf8_lossy(&told.stdout).trim().to_string())
}
