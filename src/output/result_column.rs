//! The columns of `table.csv` that hold a number found for each load step, by the names people give them.

use std::borrow::Cow;

use crate::engine::outcome::Response;
use crate::error::{Error, shortened, suggest};
use crate::output::schema::{Kind, LoadColumn, table_columns};
use crate::study::columns;
use crate::study::design::Load;

/// A column with a number in each row that has an answer.
#[derive(Clone, Debug)]
pub struct ResultColumn {
    pub name: Cow<'static, str>,
    pub unit: &'static str,
    number: Number,
}

#[derive(Clone, Copy, Debug)]
enum Number {
    /// Indentation and force.
    Load(LoadColumn),
    Result(fn(&Response) -> Option<f64>),
}

impl ResultColumn {
    /// In the order of the table.
    pub fn all() -> Vec<ResultColumn> {
        let numbers = table_columns().into_iter().filter_map(|column| {
            let number = match column.kind {
                Kind::Load(load) => Number::Load(load),
                Kind::Result(value) => Number::Result(value),
                _ => return None,
            };
            Some(ResultColumn { name: column.name, unit: column.unit, number })
        });
        numbers.collect()
    }

    /// By its name, with or without its unit: `force_n`, `force`.
    pub fn named(name: &str) -> Result<ResultColumn, Error> {
        let mut all = ResultColumn::all();
        let place = all.iter().position(|column| column.name == name || column.plain_name() == name);
        place.map(|place| all.swap_remove(place)).ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|column| &*column.name).collect();
            let problem = format!("`{}`: no column of results; {}", shortened(name), suggest(name, &names));
            Error::Asked { problem }
        })
    }

    /// What answers a load: the force to an indentation, the indentation to a force.
    pub fn answering(load: Load) -> Result<ResultColumn, Error> {
        ResultColumn::named(match load {
            Load::Indentation(_) => columns::FORCE,
            Load::Force(_) => columns::INDENTATION,
        })
    }

    /// Without the unit behind it.
    fn plain_name(&self) -> &str {
        let unit = format!("_{}", self.unit.to_lowercase().replace('/', "_per_"));
        self.name.strip_suffix(&unit).unwrap_or(&self.name)
    }

    /// Whether a load of this kind is what the column says: then it holds what was asked.
    pub fn is_asked_by(&self, load: Load) -> bool {
        matches!(self.number, Number::Load(column) if (column.asked)(load).is_some())
    }

    /// `None` where the method does not say.
    pub fn value(&self, response: &Response) -> Option<f64> {
        match self.number {
            Number::Load(column) => Some((column.found)(response)),
            Number::Result(value) => value(response),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_known_with_and_without_their_unit() {
        let mut tried = 0;
        for (plain, name) in [
            ("indentation", "indentation_mm"),
            ("force", "force_n"),
            ("tangent_stiffness", "tangent_stiffness_n_per_mm"),
            ("contact_half_angle", "contact_half_angle_deg"),
            ("peak_pressure", "peak_pressure_mpa"),
            ("energy", "energy_mj"),
            ("force_error", "force_error"),
            ("linearity_error", "linearity_error"),
        ] {
            assert_eq!(ResultColumn::named(plain).unwrap().name, name);
            assert_eq!(ResultColumn::named(name).unwrap().name, name);
            tried += 1;
        }
        assert_eq!(ResultColumn::all().len(), tried);
        let said = ResultColumn::named("peek_pressure").unwrap_err().to_string();
        assert!(
            said.starts_with("`peek_pressure`: no column of results; did you mean `peak_pressure_mpa`?"),
            "{said}"
        );
        assert!(ResultColumn::named("thickness_mm").is_err() && ResultColumn::named("status").is_err());
    }

    #[test]
    fn what_is_prescribed_is_known() {
        let (force, indentation) = (Load::Force(1.0), Load::Indentation(1.0));
        let column = ResultColumn::answering(force).unwrap();
        assert_eq!(column.name, "indentation_mm");
        assert!(column.is_asked_by(indentation) && !column.is_asked_by(force));
        assert!(ResultColumn::answering(indentation).unwrap().is_asked_by(force));
    }
}
