//! `tradeoff.csv`, `front.csv`, `tradeoff.svg` and their manifest: what each choice costs and what it is worth.

use std::time::SystemTime;

use serde::Serialize;

use crate::engine::backend::gpu::context::AdapterFacts;
use crate::error::Error;
use crate::lab::tradeoff::errors::{Errors, Quantiles};
use crate::lab::tradeoff::families::FAMILIES;
use crate::lab::tradeoff::measure::{Measured, Tradeoff};
use crate::lab::tradeoff::plot;
use crate::mechanics::grading::REFERENCE_LEVEL;
use crate::output::claim::Claim;
use crate::output::host::{Host, seconds_since, utc};
use crate::output::manifest_parts::FileEntry;
use crate::output::number::push_exact;
use crate::output::texts::{self, Beginning};
use crate::study::config::Study;

/// How it was measured.
#[derive(Clone, Debug, Serialize)]
pub struct TradeoffManifest {
    #[serde(flatten)]
    beginning: Beginning,
    files: Vec<FileEntry>,
    /// Measured, evenly spaced over the sweep.
    designs: u64,
    designs_of_sweep: u64,
    /// Designs by what they are compared with.
    oracle: serde_json::Map<String, serde_json::Value>,
    /// Measured runs of a choice at most.
    runs: usize,
    threads: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    adapter: Option<String>,
    /// That meshes graded to the contact are made for.
    least_contact_angle_deg: f64,
    /// Families by name: what they are, and what their parameter is.
    families: serde_json::Map<String, serde_json::Value>,
    started_utc: String,
    wall_seconds: f64,
    host: Host,
    #[serde(skip)]
    started: SystemTime,
}

/// How the choices were run, as far as the study does not say.
#[derive(Clone, Copy, Debug)]
pub struct TradeoffConditions<'a> {
    pub runs: usize,
    pub adapter: Option<&'a AdapterFacts>,
    /// rad.
    pub least_angle: f64,
    pub started: SystemTime,
}

impl TradeoffManifest {
    pub fn new(study: &Study, conditions: &TradeoffConditions) -> TradeoffManifest {
        let families = FAMILIES.iter().map(|family| {
            let words = [("about", family.about), ("parameter", family.parameter)];
            let words = words.into_iter().map(|(key, word)| (key.to_string(), word.into()));
            (family.name.to_string(), serde_json::Value::Object(words.collect()))
        });
        TradeoffManifest {
            beginning: Beginning::of(study, "tradeoff"),
            files: Vec::new(),
            designs: 0,
            designs_of_sweep: study.design_count(),
            oracle: serde_json::Map::new(),
            runs: conditions.runs,
            threads: 1,
            adapter: conditions.adapter.map(|facts| format!("{}, {}", facts.name, facts.driver)),
            least_contact_angle_deg: conditions.least_angle.to_degrees(),
            families: families.collect(),
            started_utc: utc(conditions.started),
            wall_seconds: 0.0,
            host: Host::current(),
            started: conditions.started,
        }
    }

    /// Writes everything into `folder`, the manifest last.
    pub fn save(mut self, claim: &Claim, tradeoff: &Tradeoff) -> Result<(), Error> {
        self.designs = tradeoff.designs as u64;
        self.oracle.insert("series".into(), tradeoff.by_series.into());
        self.oracle.insert(format!("fe_level_{REFERENCE_LEVEL}"), tradeoff.by_mesh.into());
        let mut front: Vec<&Measured> = tradeoff.rows.iter().filter(|row| row.on_front).collect();
        front.sort_by(|a, b| a.time_per_design.total_cmp(&b.time_per_design));
        let picture = plot::svg(&self.beginning.title, &tradeoff.rows)?;
        let files = [
            ("tradeoff.csv", table(tradeoff.rows.iter())),
            ("front.csv", table(front.into_iter())),
            ("tradeoff.svg", picture),
        ];
        self.files = texts::write(claim, files)?;
        self.wall_seconds = seconds_since(self.started);
        texts::publish(claim, &self)
    }
}

/// Errors of one quantity: the beginning of its columns' names, their unit, and where they are.
type Quantity = (&'static str, &'static str, fn(&Errors) -> Option<Quantiles>);

const QUANTITIES: [Quantity; 4] = [
    ("force_error", "", |errors| errors.force),
    ("tangent_stiffness_error", "", |errors| errors.tangent_stiffness),
    ("contact_half_angle_error", "_deg", |errors| errors.contact_half_angle),
    ("peak_pressure_error", "", |errors| errors.peak_pressure),
];

/// One row a choice; what a choice does not say is an empty cell.
fn table<'a>(rows: impl Iterator<Item = &'a Measured>) -> String {
    let mut header =
        "family,choice,parameter,runs,time_per_design_s,time_per_design_min_s,shared_s".to_string();
    for (name, unit, _) in QUANTITIES {
        for which in ["median", "p95", "max"] {
            header += &format!(",{name}_{which}{unit}");
        }
    }
    let mut text = header + ",steps,unanswered,contact_iterations_mean,on_front\n";
    for row in rows {
        let Measured { family, choice, parameter, runs, errors, on_front, .. } = row;
        let [time, least, shared] = [row.time_per_design, row.least_time_per_design, row.shared].map(short);
        let parameter = parameter.map_or(String::new(), |parameter| number(parameter, exact));
        let choice = if choice.contains(',') { format!("\"{choice}\"") } else { choice.clone() };
        text += &format!("{family},{choice},{parameter},{runs},{time},{least},{shared}");
        for (.., quantiles) in QUANTITIES {
            match quantiles(errors) {
                Some(Quantiles { median, p95, max }) => {
                    text += &format!(",{},{},{}", short(median), short(p95), short(max));
                }
                None => text += ",,,",
            }
        }
        let iterations = errors.iterations.map_or(String::new(), short);
        text += &format!(",{},{},{iterations},{on_front}\n", errors.steps, errors.unanswered);
    }
    text
}

/// Four digits; nothing for what is no number.
fn short(value: f64) -> String {
    number(value, |value| format!("{value:.3e}").parse().unwrap_or(value))
}

fn exact(value: f64) -> f64 {
    value
}

fn number(value: f64, round: impl Fn(f64) -> f64) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let mut text = Vec::new();
    push_exact(&mut text, round(value));
    String::from_utf8(text).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_a_cell_for_each_column_and_empty_ones_for_what_is_not_said() {
        let force = Some(Quantiles { median: 1.0 / 3.0, p95: 0.5, max: f64::INFINITY });
        let row = Measured {
            family: "pcg-f64",
            choice: "one, two".into(),
            parameter: Some(1e-8),
            runs: 3,
            time_per_design: 1.23456e-5,
            least_time_per_design: 1e-5,
            shared: 0.0,
            errors: Errors { force, steps: 10, unanswered: 4, iterations: Some(2.5), ..Errors::default() },
            on_front: true,
        };
        let text = table([&row].into_iter());
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let names = reader.headers().unwrap().clone();
        let record = reader.records().next().unwrap().unwrap();
        let cell = |name: &str| &record[names.iter().position(|own| own == name).unwrap()];
        assert_eq!(cell("choice"), "one, two");
        assert_eq!((cell("parameter"), cell("time_per_design_s")), ("1e-8", "0.00001235"));
        assert_eq!((cell("force_error_median"), cell("force_error_max")), ("0.3333", ""));
        assert_eq!((cell("contact_half_angle_error_p95_deg"), cell("unanswered")), ("", "4"));
        assert_eq!((cell("contact_iterations_mean"), cell("on_front")), ("2.5", "true"));
    }
}
