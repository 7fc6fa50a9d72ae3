//! What `jointsweep sensitivity --of` asks for: a column of results, or what is made of columns.

use crate::engine::outcome::DesignOutcome;
use crate::error::{Error, shortened};
use crate::output::row_value::{Formula, Row};
use crate::output::schema::{self, Kind};
use crate::study::columns::Quantity;
use crate::study::design::Load;
use crate::study::expression::Expression;
use crate::study::expression::program::{NumberColumn, Operation};

/// A number that each answered design has.
#[derive(Clone, Debug)]
pub struct SensitivityColumn {
    /// Of a column its name in the table; otherwise the expression as it was written.
    pub name: String,
    /// "-" for none.
    pub unit: String,
    formula: Formula,
}

impl SensitivityColumn {
    /// A column with or without its unit, or an expression; in it must be a result that `load` does not prescribe.
    pub fn read(text: &str, load: Load) -> Result<SensitivityColumn, Error> {
        let expression = Expression::quantity(text)
            .map_err(|problem| Error::Asked { problem: format!("`{}`: {problem}", shortened(text)) })?;
        let result = |operation: &Operation| match operation {
            Operation::Column(NumberColumn::Result(quantity)) => Some(*quantity),
            _ => None,
        };
        let results: Vec<Quantity> = expression.operations().iter().filter_map(result).collect();
        let column = results.first().filter(|_| expression.operations().len() == 1);
        let name = column.map_or(expression.text(), |column| column.name()).to_string();
        let unit = column.map_or(expression.unit().text(), |column| column.unit().to_string());
        let problem = if results.iter().any(|quantity| !is_asked(*quantity, load)) {
            return Ok(SensitivityColumn { name, unit, formula: Formula::of(&expression) });
        } else if column.is_some() {
            "the config prescribes it, so it does not change"
        } else {
            "there is no result in it, only what the config prescribes"
        };
        Err(Error::Asked { problem: format!("`{}`: {problem}", shortened(&name)) })
    }

    /// What answers a load: the force to an indentation, the indentation to a force.
    pub fn answering(load: Load) -> Result<SensitivityColumn, Error> {
        let answer = match load {
            Load::Indentation(_) | Load::Offset(_) => Quantity::Force,
            Load::Force(_) => Quantity::Indentation,
        };
        SensitivityColumn::read(answer.name(), load)
    }

    /// At the last load step; `None` where there is no answer, or the method does not say.
    pub fn value(&self, outcome: &DesignOutcome) -> Option<f64> {
        let DesignOutcome { case, backend, steps, .. } = outcome;
        let (step, outcome) = steps.iter().enumerate().next_back()?;
        outcome.response?;
        Some(self.formula.value(&Row { case, step, outcome, backend: *backend }))
            .filter(|value| value.is_finite())
    }
}

/// Whether a load of this kind is the quantity itself.
fn is_asked(quantity: Quantity, load: Load) -> bool {
    matches!(schema::kind(quantity), Kind::Load(column) if (column.asked)(load).is_some())
}
