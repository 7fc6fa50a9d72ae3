//! What an expression is after it was checked: operations for a stack of numbers, in the order in which they are done.

use crate::mechanics::body::Side;
use crate::study::columns::{Cell, Column, Quantity};
use crate::study::design::{DesignCase, JointDesign};

/// One step of the calculation. A condition is 1 where it holds, 0 where it does not, and NaN where a value that would decide it
/// is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Operation {
    Number(f64),
    Column(NumberColumn),
    WordIs(WordTest),
    Negate,
    Not,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
    And,
    Or,
    Absolute,
    SquareRoot,
    Logarithm,
    Logarithm10,
    Exponential,
    Smaller,
    Larger,
}

/// A column of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberColumn {
    Design,
    /// The load step's number in its design, from 0.
    Step,
    Input(Column),
    Result(Quantity),
}

/// A column of words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WordColumn {
    Idealization,
    Model(Side),
    Support(Side),
    Result(Quantity),
}

/// Whether a column has a word, or (`equal` false) another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordTest {
    pub column: WordColumn,
    pub word: &'static str,
    pub equal: bool,
}

/// Numbers that may wait on the stack at once.
pub const DEEPEST: usize = 64;

impl Operation {
    /// How many numbers it takes from the stack; it puts one back.
    pub fn takes(&self) -> usize {
        use Operation::*;
        match self {
            Number(_) | Column(_) | WordIs(_) => 0,
            Negate | Not | Absolute | SquareRoot | Logarithm | Logarithm10 | Exponential => 1,
            _ => 2,
        }
    }

    /// Of one that takes one number; NaN of others.
    pub fn of_one(self, a: f64) -> f64 {
        match self {
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

    /// Of one that takes two; NaN of others.
    pub fn of_two(self, a: f64, b: f64) -> f64 {
        // What one side decides needs no value on the other.
        match self {
            Operation::And if a == 0.0 || b == 0.0 => return 0.0,
            Operation::Or if a == 1.0 || b == 1.0 => return 1.0,
            _ => {}
        }
        // All else is unknown without both: x^0, a smaller value, a comparison, too.
        if a.is_nan() || b.is_nan() {
            return f64::NAN;
        }
        match self {
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
}

/// A condition as a number.
pub fn told(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

impl NumberColumn {
    /// Of a row's inputs; NaN where the joint's shapes do not use the column, and of results.
    pub fn of_inputs(self, case: &DesignCase, step: usize) -> f64 {
        match self {
            NumberColumn::Design => case.index as f64,
            NumberColumn::Step => step as f64,
            NumberColumn::Input(column) => match column.cell(&case.joint) {
                Cell::Number(number) => number,
                _ => f64::NAN,
            },
            NumberColumn::Result(_) => f64::NAN,
        }
    }
}

impl WordTest {
    /// Whether an input has the word; `None` where the joint's shapes do not use the column, and of results.
    pub fn of_inputs(&self, joint: &JointDesign) -> Option<bool> {
        let column = match self.column {
            WordColumn::Idealization => Column::Idealization,
            WordColumn::Model(side) => Column::Model(side),
            WordColumn::Support(side) => Column::Support(side),
            WordColumn::Result(_) => return None,
        };
        match column.cell(joint) {
            Cell::Word(word) => Some(word == self.word),
            _ => None,
        }
    }
}

/// The most numbers that wait on the stack at once.
pub fn depth(operations: &[Operation]) -> usize {
    let (mut now, mut most) = (0_usize, 0);
    for operation in operations {
        now = now + 1 - operation.takes();
        most = most.max(now);
    }
    most
}
