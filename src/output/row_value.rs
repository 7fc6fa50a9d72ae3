//! The value that an expression has in a row: a column's number before it is rounded for the table, or what is made of columns.

use crate::engine::outcome::{BackendKind, Response, StepOutcome};
use crate::engine::status::{Remark, Status};
use crate::output::schema::{self, Kind, LoadColumn};
use crate::study::columns::{Cell, Column, Quantity};
use crate::study::design::DesignCase;
use crate::study::expression::Expression;
use crate::study::expression::program::{DEEPEST, NumberColumn, Operation, WordColumn, WordTest};

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    pub case: &'a DesignCase,
    /// The number of its load step in the design.
    pub step: usize,
    pub outcome: &'a StepOutcome,
    pub backend: BackendKind,
}

/// An expression ready for many rows.
#[derive(Clone, Debug)]
pub struct Formula(Vec<Action>);

/// Puts a number on the stack, or does something with those that are there.
#[derive(Clone, Copy, Debug)]
enum Action {
    Number(f64),
    Design,
    Step,
    Input(Column),
    Load(LoadColumn),
    Result(fn(&Response) -> Option<f64>),
    Word(WordTest),
    Unary(Operation),
    Binary(Operation),
}

impl Formula {
    pub fn of(expression: &Expression) -> Formula {
        let action = |operation: &Operation| match *operation {
            Operation::Number(number) => Action::Number(number),
            Operation::Column(NumberColumn::Design) => Action::Design,
            Operation::Column(NumberColumn::Step) => Action::Step,
            Operation::Column(NumberColumn::Input(column)) => Action::Input(column),
            Operation::Column(NumberColumn::Result(quantity)) => match schema::kind(quantity) {
                Kind::Load(own) => Action::Load(own),
                Kind::Result(value) => Action::Result(value),
                _ => Action::Number(f64::NAN),
            },
            Operation::WordIs(test) => Action::Word(test),
            operation if operation.takes() == 1 => Action::Unary(operation),
            operation => Action::Binary(operation),
        };
        Formula(expression.operations().iter().map(action).collect())
    }

    /// NaN where a value is missing that would decide it. A condition is 1 where it holds and 0 where it does not.
    pub fn value(&self, row: &Row) -> f64 {
        let mut stack = [0.0_f64; DEEPEST];
        let mut top = 0;
        for action in &self.0 {
            let number = match *action {
                Action::Unary(operation) => {
                    stack[top - 1] = unary(operation, stack[top - 1]);
                    continue;
                }
                Action::Binary(operation) => {
                    top -= 1;
                    stack[top - 1] = binary(operation, stack[top - 1], stack[top]);
                    continue;
                }
                Action::Number(number) => number,
                Action::Design => row.case.index as f64,
                Action::Step => row.step as f64,
                Action::Input(column) => match column.cell(&row.case.joint) {
                    Cell::Number(number) => number,
                    _ => f64::NAN,
                },
                Action::Load(own) => match (own.asked)(row.case.steps[row.step]) {
                    Some(asked) => asked,
                    None => row.outcome.response.as_ref().map_or(f64::NAN, own.found),
                },
                Action::Result(value) => row.outcome.response.as_ref().and_then(value).unwrap_or(f64::NAN),
                Action::Word(test) => match has_word(row, &test) {
                    None => f64::NAN,
                    Some(has) => told(has == test.equal),
                },
            };
            stack[top] = number;
            top += 1;
        }
        stack[0]
    }
}

fn told(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

/// Whether the row has the word in this column; `None` where the column is empty.
fn has_word(row: &Row, test: &WordTest) -> Option<bool> {
    let cell = |column: Column| match column.cell(&row.case.joint) {
        Cell::Word(word) => Some(word == test.word),
        _ => None,
    };
    match test.column {
        WordColumn::Idealization => cell(Column::Idealization),
        WordColumn::Model(side) => cell(Column::Model(side)),
        WordColumn::Support(side) => cell(Column::Support(side)),
        WordColumn::Result(Quantity::Status) => Some(has_status(&row.outcome.status, test.word)),
        WordColumn::Result(quantity) => match schema::kind(quantity) {
            Kind::Word(word) => Some(word(row.outcome, row.backend)).filter(|word| !word.is_empty()),
            _ => None,
        }
        .map(|word| word == test.word),
    }
}

/// A status is `ok`, `failed` for whatever reason, or has remarks.
fn has_status(status: &Status, word: &str) -> bool {
    match word {
        "ok" => *status == Status::OK,
        "failed" => status.is_failed(),
        _ => Remark::ALL.into_iter().any(|remark| remark.text() == word && status.has(remark)),
    }
}

fn unary(operation: Operation, a: f64) -> f64 {
    match operation {
        Operation::Negate => -a,
        Operation::Not => 1.0 - a,
        Operation::Absolute => a.abs(),
        Operation::SquareRoot => a.sqrt(),
        Operation::Logarithm => a.ln(),
        Operation::Logarithm10 => a.log10(),
        Operation::Exponential => a.exp(),
        _ => f64::NAN,
    }
}

fn binary(operation: Operation, a: f64, b: f64) -> f64 {
    // What one side decides needs no value on the other.
    match operation {
        Operation::And if a == 0.0 || b == 0.0 => return 0.0,
        Operation::Or if a == 1.0 || b == 1.0 => return 1.0,
        _ => {}
    }
    // All else is unknown without both: x^0, a smaller value, a comparison, too.
    if a.is_nan() || b.is_nan() {
        return f64::NAN;
    }
    match operation {
        Operation::Add => a + b,
        Operation::Subtract => a - b,
        Operation::Multiply => a * b,
        Operation::Divide => a / b,
        Operation::Power => a.powf(b),
        Operation::Less => told(a < b),
        Operation::LessOrEqual => told(a <= b),
        Operation::Greater => told(a > b),
        Operation::GreaterOrEqual => told(a >= b),
        Operation::Equal => told(a == b),
        Operation::NotEqual => told(a != b),
        Operation::And => 1.0,
        Operation::Or => 0.0,
        Operation::Smaller => a.min(b),
        Operation::Larger => a.max(b),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::outcome::Method;

    /// Study lists the words, the engine writes them.
    #[test]
    fn words_are_those_that_are_written() {
        let methods = [Method::ClosedForm, Method::Series, Method::Interpolated, Method::Fe];
        assert_eq!(Quantity::Method.words(), methods.map(Method::name));
        assert_eq!(Quantity::Backend.words(), [BackendKind::Cpu, BackendKind::Gpu].map(BackendKind::name));
        let remarks = Remark::ALL.map(Remark::text);
        assert_eq!(Quantity::Status.words(), [&["ok", "failed"], &remarks[..]].concat());
    }
}
