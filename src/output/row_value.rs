//! The value that an expression has in a row: a column's number before it is rounded for the table, or what is made of columns.

use crate::engine::outcome::{BackendKind, Response, StepOutcome};
use crate::engine::status::{Remark, Status};
use crate::output::schema::{self, Kind, LoadColumn};
use crate::study::columns::Quantity;
use crate::study::design::DesignCase;
use crate::study::expression::Expression;
use crate::study::expression::program::{
    DEEPEST, NumberColumn, Operation, WordColumn, WordTest, depth, told,
};

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
pub struct Formula {
    actions: Vec<Action>,
    /// Numbers that wait on the stack at once, at most.
    depth: usize,
}

/// Most formulas need no more room than this.
const SHALLOW: usize = 8;

/// Puts a number on the stack, or does something with those that are there.
#[derive(Clone, Copy, Debug)]
enum Action {
    Number(f64),
    Input(NumberColumn),
    Load(LoadColumn),
    Result(fn(&Response) -> Option<f64>),
    /// Whether a status is such a one, or (false) another.
    Status(StatusTest, bool),
    Word(WordTest),
    Unary(Operation),
    Binary(Operation),
}

impl Formula {
    pub fn of(expression: &Expression) -> Formula {
        let action = |operation: &Operation| match *operation {
            Operation::Number(number) => Action::Number(number),
            Operation::Column(NumberColumn::Result(quantity)) => match schema::kind(quantity) {
                Kind::Load(own) => Action::Load(own),
                Kind::Result(value) => Action::Result(value),
                _ => Action::Number(f64::NAN),
            },
            Operation::Column(input) => Action::Input(input),
            Operation::WordIs(WordTest { column: WordColumn::Result(Quantity::Status), word, equal }) => {
                Action::Status(StatusTest::of(word), equal)
            }
            Operation::WordIs(test) => Action::Word(test),
            operation if operation.takes() == 1 => Action::Unary(operation),
            operation => Action::Binary(operation),
        };
        let operations = expression.operations();
        Formula { actions: operations.iter().map(action).collect(), depth: depth(operations) }
    }

    /// The same of many rows, in their order: each action is done for all of them before the next. `stack` is overwritten.
    pub fn values<'a>(&self, rows: &[Row], stack: &'a mut Vec<Vec<f64>>) -> &'a [f64] {
        if stack.len() < self.depth {
            stack.resize(self.depth, Vec::new());
        }
        let mut top = 0;
        for action in &self.actions {
            match *action {
                Action::Unary(operation) => {
                    stack[top - 1].iter_mut().for_each(|a| *a = operation.of_one(*a));
                }
                Action::Binary(operation) => {
                    top -= 1;
                    let (below, above) = stack.split_at_mut(top);
                    below[top - 1].iter_mut().zip(&above[0]).for_each(|(a, b)| *a = operation.of_two(*a, *b));
                }
                _ => {
                    stack[top].clear();
                    stack[top].extend(rows.iter().map(|row| number(action, row)));
                    top += 1;
                }
            }
        }
        &stack[0]
    }

    /// NaN where a value is missing that would decide it. A condition is 1 where it holds and 0 where it does not.
    pub fn value(&self, row: &Row) -> f64 {
        match &self.actions[..] {
            [action] => number(action, row),
            actions if self.depth <= SHALLOW => calculate::<SHALLOW>(actions, row),
            actions => calculate::<DEEPEST>(actions, row),
        }
    }
}

/// The value of a formula for which so many numbers wait at once at most.
fn calculate<const DEPTH: usize>(actions: &[Action], row: &Row) -> f64 {
    let mut stack = [0.0_f64; DEPTH];
    let mut top = 0;
    for action in actions {
        match *action {
            Action::Unary(operation) => stack[top - 1] = operation.of_one(stack[top - 1]),
            Action::Binary(operation) => {
                top -= 1;
                stack[top - 1] = operation.of_two(stack[top - 1], stack[top]);
            }
            _ => {
                stack[top] = number(action, row);
                top += 1;
            }
        }
    }
    stack[0]
}

/// The number that an action puts on the stack.
fn number(action: &Action, row: &Row) -> f64 {
    match *action {
        Action::Number(number) => number,
        Action::Input(column) => column.of_inputs(row.case, row.step),
        Action::Load(own) => match (own.asked)(row.case.steps[row.step]) {
            Some(asked) => asked,
            None => row.outcome.response.as_ref().map_or(f64::NAN, own.found),
        },
        Action::Result(value) => row.outcome.response.as_ref().and_then(value).unwrap_or(f64::NAN),
        Action::Status(test, equal) => told(test.holds(&row.outcome.status) == equal),
        Action::Word(test) => match has_word(row, &test) {
            None => f64::NAN,
            Some(has) => told(has == test.equal),
        },
        // These take numbers from the stack.
        Action::Unary(_) | Action::Binary(_) => f64::NAN,
    }
}

/// Whether the row has the word in this column; `None` where the column is empty.
fn has_word(row: &Row, test: &WordTest) -> Option<bool> {
    match test.column {
        WordColumn::Result(quantity) => match schema::kind(quantity) {
            Kind::Word(word) => Some(word(row.outcome, row.backend)).filter(|word| !word.is_empty()),
            _ => None,
        }
        .map(|word| word == test.word),
        _ => test.of_inputs(&row.case.joint),
    }
}

/// A word that a status may have.
#[derive(Clone, Copy, Debug)]
enum StatusTest {
    Ok,
    /// For whatever reason.
    Failed,
    Remark(Remark),
    /// No status has the word.
    Never,
}

impl StatusTest {
    fn of(word: &str) -> StatusTest {
        match word {
            "ok" => StatusTest::Ok,
            "failed" => StatusTest::Failed,
            _ => {
                let remark = Remark::ALL.into_iter().find(|remark| remark.text() == word);
                remark.map_or(StatusTest::Never, StatusTest::Remark)
            }
        }
    }

    fn holds(self, status: &Status) -> bool {
        match self {
            StatusTest::Ok => *status == Status::OK,
            StatusTest::Failed => status.is_failed(),
            StatusTest::Remark(remark) => status.has(remark),
            StatusTest::Never => false,
        }
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
