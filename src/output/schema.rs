//! Every column of `table.csv`, once: its name, its unit, what it means, and its value in a row.

use std::borrow::Cow;

use crate::engine::outcome::{BackendKind, Response, StepOutcome};
use crate::study::columns::{self, Column, joint_columns};
use crate::study::design::Load;

/// A column, documented.
#[derive(Clone, Debug)]
pub struct TableColumn {
    pub name: Cow<'static, str>,
    /// "-" for ratios and words.
    pub unit: &'static str,
    pub about: String,
    pub kind: Kind,
}

/// Where a column's cells come from.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Design,
    Input(Column),
    /// The load itself, or what it is answered by: exactly as asked, or with nine digits.
    Load(LoadColumn),
    Result(fn(&Response) -> Option<f64>),
    Word(fn(&StepOutcome, BackendKind) -> &'static str),
    Status,
}

/// Indentation and force: one of them is asked, the other found.
#[derive(Clone, Copy, Debug)]
pub struct LoadColumn {
    pub asked: fn(Load) -> Option<f64>,
    pub found: fn(&Response) -> f64,
}

/// The columns after the inputs.
const RESULTS: [(&str, &str, &str, Kind); 11] = [
    (
        columns::INDENTATION,
        "mm",
        "descent of the pin's rigid part after first touch, from where the plate is held",
        Kind::Load(LoadColumn {
            asked: |load| match load {
                Load::Indentation(value) => Some(value),
                Load::Force(_) => None,
            },
            found: |response| response.indentation,
        }),
    ),
    (
        columns::FORCE,
        "N",
        "of the whole joint, both halves",
        Kind::Load(LoadColumn {
            asked: |load| match load {
                Load::Indentation(_) => None,
                Load::Force(value) => Some(value),
            },
            found: |response| response.force,
        }),
    ),
    (
        "tangent_stiffness_n_per_mm",
        "N/mm",
        "slope of the force over the indentation",
        Kind::Result(|response| Some(response.tangent_stiffness)),
    ),
    (
        "contact_half_angle_deg",
        "deg",
        "where the pressure ends, at the hole's centre, from the load line",
        Kind::Result(|response| response.contact_half_angle.map(f64::to_degrees)),
    ),
    (
        "peak_pressure_mpa",
        "MPa",
        "at the load line, per area of the hole",
        Kind::Result(|response| response.peak_pressure),
    ),
    ("energy_mj", "mJ", "strain energy of both bodies", Kind::Result(|response| response.energy)),
    (
        "force_error",
        "-",
        "estimated relative error of the force, displacements being small",
        Kind::Result(|response| Some(response.force_error)),
    ),
    (
        "linearity_error",
        "-",
        "estimated relative difference of the force from laws of finite displacement",
        Kind::Result(|response| response.linearity_error),
    ),
    (
        "method",
        "-",
        "`series`, `interpolated`, `fe` or `closed-form`; empty where there is no answer",
        Kind::Word(|step, _| step.response.map_or("", |response| response.method.name())),
    ),
    (
        "backend",
        "-",
        "what has computed: `cpu` or `gpu`; empty where there is no answer",
        Kind::Word(|step, backend| step.response.map_or("", |_| backend.name())),
    ),
    ("status", "-", "`ok`, or remarks on the answer, or `failed: ` and why", Kind::Status),
];

/// All columns, in their order.
pub fn table_columns() -> Vec<TableColumn> {
    let design = TableColumn {
        name: "design".into(),
        unit: "-",
        about: "number of the design, from 0".into(),
        kind: Kind::Design,
    };
    let inputs = joint_columns().into_iter().map(|column| TableColumn {
        name: column.name().into(),
        unit: column.unit(),
        about: column.about(),
        kind: Kind::Input(column),
    });
    let results = RESULTS.map(|(name, unit, about, kind)| TableColumn {
        name: name.into(),
        unit,
        about: about.into(),
        kind,
    });
    std::iter::once(design).chain(inputs).chain(results).collect()
}

/// As a table in Markdown.
pub fn documentation() -> String {
    let mut text = String::from("| column | unit | meaning |\n|---|---|---|\n");
    for TableColumn { name, unit, about, .. } in table_columns() {
        text += &format!("| `{name}` | {unit} | {about} |\n");
    }
    text
}
