//! The `[output]` of a config: which columns the table of a run has, and in what kind of file it is.

use crate::error::Error;
use crate::study::columns::{Cell, Column, DESIGN, Extras, OFFSET, Quantity, joint_columns, suggest_column};
use crate::study::layers::LayerCounts;
use crate::study::source::Section;

/// Which inputs stand in the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inputs {
    #[default]
    All,
    /// Those that are not the same in all designs; the others stand in the manifest.
    Varying,
}

impl Inputs {
    pub const ALL: [Inputs; 2] = [Inputs::All, Inputs::Varying];

    /// The name in configs.
    pub fn name(self) -> &'static str {
        match self {
            Inputs::All => "all",
            Inputs::Varying => "varying",
        }
    }
}

/// The kind of file that the table is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    #[default]
    Csv,
    CsvZst,
    Parquet,
}

impl Format {
    pub const ALL: [Format; 3] = [Format::Csv, Format::CsvZst, Format::Parquet];

    /// The name in configs.
    pub fn name(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::CsvZst => "csv.zst",
            Format::Parquet => "parquet",
        }
    }
}

/// What a config says of the files of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputOptions {
    /// Whether laws are to be fitted; `None` leaves it to the size of the sweep.
    pub laws: Option<bool>,
    /// Whether the rows themselves are written; `None` where the config does not say.
    pub table: Option<bool>,
    /// The names of the table's columns, in the table's order; `None` for all.
    columns: Option<Vec<String>>,
    pub inputs: Inputs,
    pub format: Format,
}

impl OutputOptions {
    pub const KEYS: [&str; 5] = ["laws", "table", "columns", "inputs", "format"];

    pub fn read(table: &Section) -> Result<OutputOptions, Error> {
        table.allow(&OutputOptions::KEYS)?;
        let boolean = |key: &str| table.find(key).map(|item| item.boolean()).transpose();
        let (laws, rows) = (boolean("laws")?, boolean("table")?);
        let mut options = OutputOptions { laws, table: rows, ..OutputOptions::default() };
        if let Some(item) = table.find("inputs") {
            options.inputs = Inputs::ALL[item.word(&Inputs::ALL.map(Inputs::name))?];
        }
        if let Some(item) = table.find("format") {
            options.format = Format::ALL[item.word(&Format::ALL.map(Format::name))?];
        }
        if let Some(item) = table.find("columns") {
            let names = column_names(Extras::MOST);
            let known: Vec<&str> = names.iter().map(String::as_str).collect();
            let asked = item.array()?.ok_or_else(|| item.wrong_type("a list of the table's columns"))?;
            let mut is_asked = vec![false; names.len()];
            for element in asked {
                let name = element.string()?;
                let Some(place) = known.iter().position(|own| *own == name) else {
                    let of_one = column_names(Extras { layers: LayerCounts::ONE, ..Extras::MOST });
                    let of_one: Vec<&str> = of_one.iter().map(String::as_str).collect();
                    let meant = suggest_column(name, &known, &of_one);
                    return Err(element.refuse(&format!("not a column; {meant}")));
                };
                if std::mem::replace(&mut is_asked[place], true) {
                    return Err(element.refuse("the column is named twice"));
                }
            }
            let chosen = names.into_iter().zip(is_asked).filter(|(_, is_asked)| *is_asked);
            options.columns = Some(chosen.map(|(name, _)| name).collect());
        }
        Ok(options)
    }

    /// Whether the table has a column, where these inputs are the same in all designs.
    pub fn has(&self, name: &str, constants: &[(Column, Cell)]) -> bool {
        let is_asked = self.columns.as_ref().is_none_or(|columns| columns.iter().any(|own| own == name));
        let is_constant = || constants.iter().any(|(column, _)| column.name() == name);
        is_asked && (self.inputs == Inputs::All || !is_constant())
    }

    /// Refuses a table without any column, and columns of layers or offsets that no design has; `table` is what the options were read from.
    pub fn check(&self, table: &Section, constants: &[(Column, Cell)], extras: Extras) -> Result<(), Error> {
        let names = column_names(extras);
        let missing = self.columns.iter().flatten().find(|asked| !names.contains(asked));
        match table.find("columns") {
            Some(item) if missing.is_some_and(|missing| missing == OFFSET) => {
                let problem = "the designs of this config are neither press fits nor loaded by an offset";
                Err(item.error(format!("`{OFFSET}`: {problem}")))
            }
            Some(item) if let Some(missing) = missing => {
                Err(item.error(format!("`{missing}`: no design of this config has such a layer")))
            }
            Some(item) if !names.iter().any(|name| self.has(name, constants)) => Err(item.error(
                "no column is left: these inputs are the same in all designs, and `inputs = \"varying\"` leaves them out",
            )),
            _ => Ok(()),
        }
    }
}

/// The names of all columns of the table of sweeps with these, in their order.
pub fn column_names(extras: Extras) -> Vec<String> {
    let inputs = joint_columns(extras.layers).into_iter().map(|column| column.name());
    let results = Quantity::of_tables(extras).map(|quantity| quantity.name().to_string());
    std::iter::once(DESIGN.to_string()).chain(inputs).chain(results).collect()
}
