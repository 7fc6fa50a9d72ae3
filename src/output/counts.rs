//! What came of the designs of a run, counted: part by part, and added up in any order.

use std::collections::BTreeMap;

use serde::de::Deserializer;
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use crate::engine::outcome::DesignOutcome;
use crate::engine::question::counted::Counted;
use crate::engine::status::{Remark, Remarks, StatusCounts};

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Counts {
    /// What the config asks for.
    pub designs_asked: u64,
    pub rows_asked: u64,
    /// What is in the table.
    pub designs: u64,
    pub rows: u64,
    /// Of these, what `[select]` keeps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kept_rows: Option<u64>,
    /// Designs with at least one failed row.
    pub failed_designs: u64,
    pub failed_rows: u64,
    /// Bodies that are not alike, to 0.3 % beyond 260,000; one that several processes met counts for each of them.
    pub distinct_bodies: u64,
    /// The largest of a row.
    pub greatest_force_error: f64,
    pub greatest_linearity_error: f64,
    /// Of all answers, N; nothing where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forces_n: Option<[f64; 2]>,
    /// Designs that the processor solved although a GPU was asked: those it needs no mesh for, those the GPU found no
    /// answer to, and all after it was given up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub designs_on_cpu: Option<u64>,
    /// Rows by status, and of these the failed ones.
    #[serde(flatten, serialize_with = "rows_by_status", deserialize_with = "status_counts")]
    pub by_status: StatusCounts,
}

fn rows_by_status<S: Serializer>(counts: &StatusCounts, serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(2))?;
    map.serialize_entry("statuses", &counts.by_text())?;
    map.serialize_entry("failures", counts.failures())?;
    map.end()
}

fn status_counts<'de, D: Deserializer<'de>>(deserializer: D) -> Result<StatusCounts, D::Error> {
    #[derive(Default, Deserialize)]
    #[serde(default)]
    struct Saved {
        statuses: BTreeMap<String, u64>,
        failures: BTreeMap<String, u64>,
    }
    let Saved { statuses, failures } = Saved::deserialize(deserializer)?;
    Ok(StatusCounts::from_text(statuses, failures))
}

impl Counts {
    pub fn add(&mut self, outcome: &DesignOutcome) {
        let failed_before = self.failed_rows;
        for step in &outcome.steps {
            self.by_status.add(&step.status);
            let Some(response) = &step.response else {
                self.failed_rows += 1;
                continue;
            };
            self.greatest_force_error = self.greatest_force_error.max(response.force_error);
            let of_linearity = response.linearity_error.unwrap_or(0.0);
            self.greatest_linearity_error = self.greatest_linearity_error.max(of_linearity);
            let [least, greatest] = self.forces_n.unwrap_or([f64::INFINITY, 0.0]);
            self.forces_n = Some([least.min(response.force), greatest.max(response.force)]);
        }
        self.designs += 1;
        self.rows += outcome.steps.len() as u64;
        self.failed_designs += u64::from(self.failed_rows > failed_before);
    }

    /// Adds designs whose rows a device has counted.
    pub fn add_counted(&mut self, counted: &Counted) {
        let Counted {
            designs, rows, large_rows, greatest_force_error, greatest_linearity_error, forces, ..
        } = counted;
        let mut by_status = StatusCounts::default();
        by_status.add_answered(Remarks::default(), rows - large_rows);
        by_status.add_answered(Remarks::of(&[(true, Remark::LargeDisplacement)]), *large_rows);
        self.merge(&Counts {
            designs: *designs,
            rows: *rows,
            greatest_force_error: *greatest_force_error,
            greatest_linearity_error: *greatest_linearity_error,
            forces_n: *forces,
            by_status,
            ..Counts::default()
        });
    }

    /// Counts a row that failed by what was found in its place; whether its design still has failed rows is not known here.
    pub fn replace_failure(&mut self, status: &str, found: &Counts) {
        let before = (self.designs, self.rows, self.failed_designs);
        self.by_status.forget(status);
        self.failed_rows = self.failed_rows.saturating_sub(1);
        self.merge(found);
        (self.designs, self.rows, self.failed_designs) = before;
    }

    /// Adds what was counted elsewhere, of other designs of the same sweep.
    pub fn merge(&mut self, other: &Counts) {
        self.designs += other.designs;
        self.rows += other.rows;
        self.failed_designs += other.failed_designs;
        self.failed_rows += other.failed_rows;
        self.distinct_bodies += other.distinct_bodies;
        self.greatest_force_error = self.greatest_force_error.max(other.greatest_force_error);
        self.greatest_linearity_error = self.greatest_linearity_error.max(other.greatest_linearity_error);
        self.forces_n = match (self.forces_n, other.forces_n) {
            (Some([least, greatest]), Some(more)) => Some([least.min(more[0]), greatest.max(more[1])]),
            (own, more) => own.or(more),
        };
        let kept = self.kept_rows.into_iter().chain(other.kept_rows).sum();
        self.kept_rows = self.kept_rows.or(other.kept_rows).map(|_| kept);
        let on_cpu = self.designs_on_cpu.into_iter().chain(other.designs_on_cpu).sum();
        self.designs_on_cpu = self.designs_on_cpu.or(other.designs_on_cpu).map(|_| on_cpu);
        self.by_status.merge(&other.by_status);
    }
}
