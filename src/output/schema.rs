//! The columns that a table has, and the value that each of them has in a row. Its name, its unit and what it means stand in `study::columns`.

use std::borrow::Cow;

use serde_json::{Map, Value};

use crate::engine::outcome::{BackendKind, Response, StepOutcome};
use crate::study::columns::{self, Cell, Column, Extras, Quantity, joint_columns};
use crate::study::config::Study;
use crate::study::design::Load;
use crate::study::layers::LayerCounts;

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

/// Indentation, offset and force: one of them is asked, the others found.
#[derive(Clone, Copy, Debug)]
pub struct LoadColumn {
    pub asked: fn(Load) -> Option<f64>,
    pub found: fn(&Response) -> f64,
}

/// Where the cells of a quantity come from.
pub fn kind(quantity: Quantity) -> Kind {
    match quantity {
        Quantity::Indentation => Kind::Load(LoadColumn {
            asked: |load| match load {
                Load::Indentation(value) => Some(value),
                Load::Offset(_) | Load::Force(_) => None,
            },
            found: |response| response.indentation,
        }),
        Quantity::Offset => Kind::Load(LoadColumn {
            asked: |load| match load {
                Load::Offset(value) => Some(value),
                Load::Indentation(_) | Load::Force(_) => None,
            },
            found: |response| response.offset,
        }),
        Quantity::Force => Kind::Load(LoadColumn {
            asked: |load| match load {
                Load::Indentation(_) | Load::Offset(_) => None,
                Load::Force(value) => Some(value),
            },
            found: |response| response.force,
        }),
        Quantity::TangentStiffness => Kind::Result(|response| Some(response.tangent_stiffness)),
        Quantity::ContactHalfAngle => {
            Kind::Result(|response| response.contact_half_angle.map(f64::to_degrees))
        }
        Quantity::PeakPressure => Kind::Result(|response| response.peak_pressure),
        Quantity::PeakPressureAngle => {
            Kind::Result(|response| response.peak_pressure_angle.map(f64::to_degrees))
        }
        Quantity::Energy => Kind::Result(|response| response.energy),
        Quantity::ForceError => Kind::Result(|response| Some(response.force_error)),
        Quantity::LinearityError => Kind::Result(|response| response.linearity_error),
        Quantity::Method => Kind::Word(|step, _| step.response.map_or("", |response| response.method.name())),
        Quantity::Backend => Kind::Word(|step, backend| step.response.map_or("", |_| backend.name())),
        Quantity::Status => Kind::Status,
    }
}

/// The columns of `laws.csv`: name, unit, meaning.
pub fn law_columns() -> [(&'static str, &'static str, &'static str); 20] {
    [
        ("design", "-", "number of the design, as in `table.csv`"),
        ("law", "-", "name of the law; `none` where the joint has no curve"),
        (
            "constant_1",
            "-",
            "constants of the law, dimensionless, in the order of docs/laws.md; empty for a spline",
        ),
        ("constant_2", "-", "second constant"),
        ("constant_3", "-", "third constant"),
        ("constant_4", "-", "fourth constant"),
        ("effective_stiffness_n_per_mm", "N/mm", "E* t: with the clearance it brings the law to N and mm"),
        ("radial_clearance_mm", "mm", "dR; 1 for a neat fit, whose law is linear"),
        ("range_from_mm", "mm", "indentations that the law was fitted over"),
        ("range_to_mm", "mm", "end of this range"),
        ("worst_force_misfit", "-", "of the force over the range, relative, at loads fitted and not fitted"),
        ("mean_force_misfit", "-", "mean of it"),
        ("worst_stiffness_misfit", "-", "of the tangent stiffness"),
        ("mean_stiffness_misfit", "-", "mean of it"),
        ("small_load_constant", "-", "C of small loads, delta = F/(pi E* t) [ln(E* t dR/F) + C]"),
        ("large_load_stiffness_n_per_mm", "N/mm", "slope that the force has under ever larger loads"),
        ("formula", "-", "to paste: F in N, d = indentation in mm"),
        ("outside_range", "-", "what the law does outside its range"),
        ("reference", "-", "what the indentation is relative to: `support`, where the plate is held"),
        ("recommended", "-", "`yes` and why, for one law of each design"),
    ]
}

/// The columns that the table of a study has.
pub fn columns_of(study: &Study) -> Vec<TableColumn> {
    let constants = study.constants();
    table_columns(study.extras())
        .into_iter()
        .filter(|column| study.output.has(&column.name, &constants))
        .collect()
}

/// The inputs that are the same in all designs of a study and not in its table.
pub fn constants_of(study: &Study) -> Vec<(Column, Cell)> {
    let mut constants = study.constants();
    let all = constants.clone();
    constants.retain(|(column, _)| !study.output.has(&column.name(), &all));
    constants
}

/// The inputs that vary from design to design, and are not in the table all the same.
pub fn left_out(study: &Study) -> Vec<String> {
    let constants = study.constants();
    let is_constant = |name: &String| constants.iter().any(|(column, _)| column.name() == *name);
    let inputs = joint_columns(study.extras().layers).into_iter().map(|column| column.name());
    inputs.filter(|name| !study.output.has(name, &constants) && !is_constant(name)).collect()
}

/// Those of `constants_of` as JSON: numbers, words, and null where the joint's shapes do not use the column.
pub fn constants_as_json(study: &Study) -> Map<String, Value> {
    let value = |cell| match cell {
        Cell::Number(number) => number.into(),
        Cell::Word(word) => word.into(),
        Cell::Empty => Value::Null,
    };
    constants_of(study).into_iter().map(|(column, cell)| (column.name(), value(cell))).collect()
}

/// The name of the first column that would hold a NaN or an infinity.
pub fn non_finite(columns: &[TableColumn], response: &Response) -> Option<&'static str> {
    let value = |column: &TableColumn| match column.kind {
        Kind::Load(own) => Some((own.found)(response)),
        Kind::Result(value) => value(response),
        _ => None,
    };
    let culprit = columns.iter().find(|column| value(column).is_some_and(|value| !value.is_finite()))?;
    // The names of results are constants.
    match culprit.name {
        Cow::Borrowed(name) => Some(name),
        Cow::Owned(_) => None,
    }
}

/// The columns that hold what comes of a load step.
pub fn result_columns() -> Vec<TableColumn> {
    let is_result = |column: &TableColumn| !matches!(column.kind, Kind::Design | Kind::Input(_));
    table_columns(Extras::MOST).into_iter().filter(is_result).collect()
}

/// All columns of sweeps with these, in their order.
pub fn table_columns(extras: Extras) -> Vec<TableColumn> {
    let design = TableColumn {
        name: columns::DESIGN.into(),
        unit: "-",
        about: "number of the design, from 0".into(),
        kind: Kind::Design,
    };
    let inputs = joint_columns(extras.layers).into_iter().map(|column| TableColumn {
        name: column.name().into(),
        unit: column.unit(),
        about: column.about(),
        kind: Kind::Input(column),
    });
    let results = Quantity::of_tables(extras).map(|quantity| TableColumn {
        name: quantity.name().into(),
        unit: quantity.unit(),
        about: quantity.about().into(),
        kind: kind(quantity),
    });
    std::iter::once(design).chain(inputs).chain(results).collect()
}

/// The columns of `table.csv` as a table in Markdown.
pub fn documentation() -> String {
    let columns =
        table_columns(Extras { layers: LayerCounts { pin: 1, plate: 1 }, offset: true, peak_angle: true });
    markdown(columns.iter().map(|column| (&*column.name, column.unit, &*column.about)))
}

/// Those of `laws.csv`.
pub fn law_documentation() -> String {
    markdown(law_columns().into_iter())
}

fn markdown<'a>(columns: impl Iterator<Item = (&'a str, &'a str, &'a str)>) -> String {
    let mut text = String::from("| column | unit | meaning |\n|---|---|---|\n");
    for (name, unit, about) in columns {
        text += &format!("| `{name}` | {unit} | {about} |\n");
    }
    text
}
