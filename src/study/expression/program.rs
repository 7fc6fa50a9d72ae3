//! What an expression is after it was checked: operations for a stack of numbers, in the order in which they are done.

use crate::mechanics::body::Side;
use crate::study::columns::{Column, Quantity};

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
