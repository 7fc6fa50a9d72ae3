//! Expressions over the columns of a row, as configs have them: `peak_pressure < 400 MPa and tangent_stiffness > 2e5 N/mm`.
//! They are read and checked here, units included; rows have their values in `output`.

pub mod unit;
pub mod program;
mod names;
mod tokens;
mod check;
mod grammar;

use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use program::{DEEPEST, Operation};
use unit::Unit;

pub use names::STEP;

/// What is wrong with an expression, and where in its text (bytes).
#[derive(Clone, Debug, PartialEq)]
pub struct Complaint {
    pub place: Range<usize>,
    pub problem: String,
}

impl Complaint {
    fn new(place: Range<usize>, problem: String) -> Complaint {
        Complaint { place, problem }
    }
}

/// Bytes of an expression at most.
const LONGEST: usize = 10_000;

/// A checked expression, cheap to clone. As data it is its text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Expression {
    text: Arc<str>,
    operations: Arc<[Operation]>,
    /// `None` for a condition.
    unit: Option<Unit>,
    constant: Option<f64>,
}

impl Expression {
    /// A condition or a quantity; on failure, the expression with a mark under the place, and what is wrong.
    pub fn parse(text: &str) -> Result<Expression, String> {
        if text.len() > LONGEST {
            return Err(format!("the expression has {} bytes; at most {LONGEST} are allowed", text.len()));
        }
        read(text).map_err(|complaint| marked(text, &complaint))
    }

    /// A condition, true or false for each row.
    pub fn condition(text: &str) -> Result<Expression, String> {
        let expression = Expression::parse(text)?;
        let Some(unit) = expression.unit else { return Ok(expression) };
        let problem = format!("this is {}, where a condition is needed, like `force < 2 kN`", unit.said());
        Err(marked(text, &Complaint::new(0..text.len(), problem)))
    }

    /// A number for each row: a column, or what is made of columns.
    pub fn quantity(text: &str) -> Result<Expression, String> {
        let expression = Expression::parse(text)?;
        let problem = match expression.unit {
            None => "this is a condition, where a column or a number made of columns is needed",
            Some(_) if expression.columns() == 0 => "there is no column in this",
            Some(_) => return Ok(expression),
        };
        Err(marked(text, &Complaint::new(0..text.len(), problem.to_string())))
    }

    /// A value without columns, in the unit that the tables have for `unit`: "400 MPa".
    pub fn value(text: &str, unit: Unit) -> Result<f64, String> {
        let expression = Expression::parse(text)?;
        let problem = match (expression.unit, expression.constant) {
            (Some(own), Some(value)) if own == unit && value.is_finite() => return Ok(value),
            (Some(own), Some(_)) if own.is_none() => {
                format!(
                    "the unit is missing: {} is meant, like `{} {}`",
                    unit.said(),
                    text.trim(),
                    unit.text()
                )
            }
            (Some(own), Some(_)) if own != unit => {
                format!("this is {}, where {} is needed", own.said(), unit.said())
            }
            _ => format!("{} is needed here, without columns", unit.said()),
        };
        Err(marked(text, &Complaint::new(0..text.len(), problem)))
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Of a quantity; a condition has none.
    pub fn unit(&self) -> Unit {
        self.unit.unwrap_or(Unit::NONE)
    }

    pub fn operations(&self) -> &[Operation] {
        &self.operations
    }

    fn columns(&self) -> usize {
        let is_column =
            |operation: &&Operation| matches!(operation, Operation::Column(_) | Operation::WordIs(_));
        self.operations.iter().filter(is_column).count()
    }
}

impl From<Expression> for String {
    fn from(expression: Expression) -> String {
        expression.text.to_string()
    }
}

impl TryFrom<String> for Expression {
    type Error = String;

    fn try_from(text: String) -> Result<Expression, String> {
        Expression::parse(&text)
    }
}

fn read(text: &str) -> Result<Expression, Complaint> {
    let tokens = tokens::tokens(text)?;
    let part = grammar::parse(&tokens, text.trim_end().len())?;
    let (unit, constant) = match &part.kind {
        check::Kind::Number { unit, constant } => (Some(*unit), *constant),
        check::Kind::Condition => (None, None),
        words => {
            let problem = format!("this is {}, where a number or a condition is needed", words.said());
            return Err(Complaint::new(part.place, problem));
        }
    };
    if program::depth(&part.operations) > DEEPEST {
        let problem = format!("more than {DEEPEST} numbers wait for each other: use fewer brackets");
        return Err(Complaint::new(part.place, problem));
    }
    Ok(Expression { text: text.trim().into(), operations: part.operations.into(), unit, constant })
}

/// Characters that are shown before and behind the place of a mistake.
const SHOWN: usize = 50;

/// What is wrong, then the expression (as much of it as fits a line) with a mark under the place.
fn marked(text: &str, complaint: &Complaint) -> String {
    let start = text[..floor(text, complaint.place.start)].chars().count();
    let end = text[..floor(text, complaint.place.end)].chars().count().max(start + 1);
    let (from, to) = (start.saturating_sub(SHOWN), end.min(start + SHOWN) + SHOWN);
    let count = text.chars().count();
    let plain = |c: char| if c.is_whitespace() || c.is_control() { ' ' } else { c };
    let line: String = text.chars().skip(from).take(to - from).map(plain).collect();
    let (before, behind) = (if from > 0 { "..." } else { "" }, if count > to { "..." } else { "" });
    let blanks = " ".repeat(before.len() + start - from);
    let mark = "^".repeat(end.min(start + SHOWN) - start);
    format!("{}\n    {before}{}{behind}\n    {blanks}{mark}", complaint.problem, line.trim_end())
}

/// The nearest boundary between characters, at `place` or before it.
fn floor(text: &str, place: usize) -> usize {
    (0..=place.min(text.len())).rev().find(|place| text.is_char_boundary(*place)).unwrap_or(0)
}
