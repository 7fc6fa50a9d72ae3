//! The columns that an expression may name, with or without the unit at the end of their names.

use crate::error::shortened;
use crate::mechanics::body::{Shape, Side};
use crate::mechanics::material::Idealization;
use crate::study::columns::{Column, DESIGN, Quantity, joint_columns, suggest_column};
use crate::study::expression::program::{NumberColumn, WordColumn};
use crate::study::expression::unit::Unit;
use crate::study::layers::LayerCounts;

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Named {
    Number(NumberColumn, Unit),
    Words(WordColumn),
}

/// The number of a load step in its design, from 0; no column of the table.
pub const STEP: &str = "step";

/// All columns of joints with so many layers: the name in the table, the name without its unit, what it is.
fn columns(layers: LayerCounts) -> Vec<(String, String, Named)> {
    let plain = |name: &str, column| (name.to_string(), name.to_string(), Named::Number(column, Unit::NONE));
    let mut all = vec![plain(DESIGN, NumberColumn::Design), plain(STEP, NumberColumn::Step)];
    for column in joint_columns(layers) {
        let named = match column {
            Column::Idealization => Named::Words(WordColumn::Idealization),
            Column::Model(side) => Named::Words(WordColumn::Model(side)),
            Column::Support(side) => Named::Words(WordColumn::Support(side)),
            _ => Named::Number(NumberColumn::Input(column), Unit::of_column(column.unit())),
        };
        all.push((column.name(), without_unit(&column.name(), column.unit()), named));
    }
    for quantity in Quantity::ALL {
        let named = match quantity.is_number() {
            true => Named::Number(NumberColumn::Result(quantity), Unit::of_column(quantity.unit())),
            false => Named::Words(WordColumn::Result(quantity)),
        };
        all.push((quantity.name().into(), without_unit(quantity.name(), quantity.unit()), named));
    }
    all
}

/// `peak_pressure` of `peak_pressure_mpa`.
fn without_unit(name: &str, unit: &str) -> String {
    let ending = format!("_{}", unit.to_lowercase().replace('/', "_per_"));
    name.strip_suffix(&ending).unwrap_or(name).to_string()
}

/// The column that is meant, or what to say of a name that is none.
pub fn find(name: &str) -> Result<Named, String> {
    let all = columns(LayerCounts::MOST);
    if let Some((_, _, named)) = all.iter().find(|(full, short, _)| full == name || short == name) {
        return Ok(*named);
    }
    let of_one = columns(LayerCounts::ONE);
    let [all, of_one] =
        [&all, &of_one].map(|columns| columns.iter().map(|(_, short, _)| short.as_str()).collect::<Vec<_>>());
    Err(format!("there is no column `{}`; {}", shortened(name), suggest_column(name, &all, &of_one)))
}

impl WordColumn {
    /// The words that the column may hold. A status holds one or more of its words.
    pub fn words(self) -> Vec<&'static str> {
        match self {
            WordColumn::Idealization => Idealization::ALL.map(Idealization::name).to_vec(),
            WordColumn::Model(side) => Shape::of_side(side).map(|shape| shape.name).collect(),
            WordColumn::Support(side) => supports(side),
            WordColumn::Result(quantity) => quantity.words().to_vec(),
        }
    }
}

fn supports(side: Side) -> Vec<&'static str> {
    Shape::of_side(side).flat_map(|shape| shape.supports.iter().copied()).collect()
}
