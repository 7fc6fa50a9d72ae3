//! The rules of expressions: which parts go together. Each rule takes checked parts and gives the part that they make.

use std::ops::Range;

use crate::error::{quoted, shortened, suggest};
use crate::study::expression::Complaint;
use crate::study::expression::program::{Operation, WordColumn, WordTest};
use crate::study::expression::unit::Unit;

/// A checked part of an expression with its place in the text.
#[derive(Clone, Debug)]
pub struct Part {
    pub operations: Vec<Operation>,
    pub kind: Kind,
    pub place: Range<usize>,
}

/// What a part is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// With its value, where no column is in it.
    Number {
        unit: Unit,
        constant: Option<f64>,
    },
    Condition,
    Words(WordColumn),
    Quoted(String),
}

impl Kind {
    /// In a sentence.
    pub fn said(&self) -> String {
        match self {
            Kind::Number { unit, .. } => unit.said(),
            Kind::Condition => "a condition".to_string(),
            Kind::Words(_) => "a column of words".to_string(),
            Kind::Quoted(_) => "a word in quotes".to_string(),
        }
    }
}

type Checked = Result<Part, Complaint>;

fn around(a: &Part, b: &Part) -> Range<usize> {
    a.place.start..b.place.end
}

/// The part `a operation b`.
fn joined(mut a: Part, b: Part, operation: Operation, kind: Kind) -> Part {
    let place = around(&a, &b);
    a.operations.extend(b.operations);
    a.operations.push(operation);
    Part { operations: a.operations, kind, place }
}

/// The unit and value of a part that must be a number.
fn number(part: &Part) -> Result<(Unit, Option<f64>), Complaint> {
    match &part.kind {
        Kind::Number { unit, constant } => Ok((*unit, *constant)),
        Kind::Condition => {
            let problem =
                "this is a condition, where a number is needed; join conditions by `and`: a < b and b < c";
            Err(Complaint::new(part.place.clone(), problem.to_string()))
        }
        other => {
            let problem = format!("this is {}, where a number is needed", other.said());
            Err(Complaint::new(part.place.clone(), problem))
        }
    }
}

/// Refuses parts of different units; `done` is what cannot be done with them.
fn same_unit(a: &Part, b: &Part, done: &str) -> Result<Unit, Complaint> {
    let ((unit_a, value_a), (unit_b, value_b)) = (number(a)?, number(b)?);
    if unit_a == unit_b {
        return Ok(unit_a);
    }
    let bare = match (value_a, value_b) {
        (Some(value), _) if unit_a.is_none() => Some((value, unit_b, a)),
        (_, Some(value)) if unit_b.is_none() => Some((value, unit_a, b)),
        _ => None,
    };
    if let Some((value, unit, part)) = bare {
        let problem =
            format!("the unit is missing: {} is meant, like `{}`", unit.said(), unit.example(value));
        return Err(Complaint::new(part.place.clone(), problem));
    }
    Err(Complaint::new(around(a, b), format!("{} and {} cannot be {done}", unit_a.said(), unit_b.said())))
}

pub fn sum(a: Part, b: Part, operation: Operation) -> Checked {
    let done = if operation == Operation::Add { "added" } else { "subtracted" };
    let unit = same_unit(&a, &b, done)?;
    let value = |a: f64, b: f64| if operation == Operation::Add { a + b } else { a - b };
    let constant = number(&a)?.1.zip(number(&b)?.1).map(|(a, b)| value(a, b));
    Ok(joined(a, b, operation, Kind::Number { unit, constant }))
}

pub fn product(a: Part, b: Part, operation: Operation) -> Checked {
    let ((unit_a, value_a), (unit_b, value_b)) = (number(&a)?, number(&b)?);
    let both = value_a.zip(value_b);
    let (unit, constant) = match operation {
        Operation::Multiply => (unit_a.times(unit_b), both.map(|(a, b)| a * b)),
        _ => (unit_a.over(unit_b), both.map(|(a, b)| a / b)),
    };
    Ok(joined(a, b, operation, Kind::Number { unit, constant }))
}

pub fn power(a: Part, b: Part) -> Checked {
    let ((unit_a, value_a), (unit_b, value_b)) = (number(&a)?, number(&b)?);
    if !unit_b.is_none() {
        let problem = format!("an exponent has no unit; this is {}", unit_b.said());
        return Err(Complaint::new(b.place, problem));
    }
    let unit = match value_b {
        Some(exponent) if exponent.is_finite() && exponent.abs() <= LARGEST_EXPONENT => {
            unit_a.to_the(exponent)
        }
        _ if unit_a.is_none() => Unit::NONE,
        Some(_) => {
            let problem =
                format!("exponents of values with a unit go from -{LARGEST_EXPONENT} to {LARGEST_EXPONENT}");
            return Err(Complaint::new(b.place, problem));
        }
        None => {
            let problem =
                format!("the base is {}, so the exponent must be a number without columns", unit_a.said());
            return Err(Complaint::new(b.place, problem));
        }
    };
    let constant = value_a.zip(value_b).map(|(a, b)| a.powf(b));
    Ok(joined(a, b, Operation::Power, Kind::Number { unit, constant }))
}

/// Beyond it a unit is nobody's.
const LARGEST_EXPONENT: f64 = 100.0;

pub fn negative(mut a: Part) -> Checked {
    let (unit, constant) = number(&a)?;
    a.operations.push(Operation::Negate);
    Ok(Part { kind: Kind::Number { unit, constant: constant.map(|value| -value) }, ..a })
}

pub fn opposite(mut a: Part) -> Checked {
    condition(&a)?;
    a.operations.push(Operation::Not);
    Ok(a)
}

pub fn both(a: Part, b: Part, operation: Operation) -> Checked {
    condition(&a)?;
    condition(&b)?;
    Ok(joined(a, b, operation, Kind::Condition))
}

fn condition(part: &Part) -> Result<(), Complaint> {
    if part.kind == Kind::Condition {
        return Ok(());
    }
    let problem = format!("this is {}, where a condition is needed, like `force < 2 kN`", part.kind.said());
    Err(Complaint::new(part.place.clone(), problem))
}

/// `<` and its like, of numbers; `==` and `!=` of words, too.
pub fn comparison(a: Part, b: Part, operation: Operation) -> Checked {
    let place = around(&a, &b);
    let (column, word, word_place) = match (&a.kind, &b.kind) {
        (Kind::Words(column), Kind::Quoted(word)) => (*column, word, &b.place),
        (Kind::Quoted(word), Kind::Words(column)) => (*column, word, &a.place),
        (Kind::Words(column), _) => {
            let words = quoted_words(&column.words());
            let problem = format!("a word in quotes is needed here: {words}");
            return Err(Complaint::new(b.place, problem));
        }
        (_, Kind::Words(column)) => {
            let words = quoted_words(&column.words());
            let problem = format!("a word in quotes is needed here: {words}");
            return Err(Complaint::new(a.place, problem));
        }
        _ => {
            same_unit(&a, &b, "compared")?;
            return Ok(joined(a, b, operation, Kind::Condition));
        }
    };
    if !matches!(operation, Operation::Equal | Operation::NotEqual) {
        return Err(Complaint::new(place, "words are compared by `==` and `!=` alone".to_string()));
    }
    let words = column.words();
    let Some(&word) = words.iter().find(|known| *known == word) else {
        let problem = format!("the column never holds `{}`; {}", shortened(word), suggest(word, &words));
        return Err(Complaint::new(word_place.clone(), problem));
    };
    let test = WordTest { column, word, equal: operation == Operation::Equal };
    Ok(Part { operations: vec![Operation::WordIs(test)], kind: Kind::Condition, place })
}

fn quoted_words(words: &[&str]) -> String {
    words.iter().map(|word| format!("'{word}'")).collect::<Vec<_>>().join(", ")
}

/// The functions, in the order of the page.
pub const FUNCTIONS: [&str; 7] = ["abs", "sqrt", "log", "log10", "exp", "min", "max"];

/// The function `name` of `arguments`, which stands at `place`.
pub fn call(name: &str, arguments: Vec<Part>, place: Range<usize>) -> Checked {
    let many = matches!(name, "min" | "max");
    let operation = match name {
        "abs" => Operation::Absolute,
        "sqrt" => Operation::SquareRoot,
        "log" => Operation::Logarithm,
        "log10" => Operation::Logarithm10,
        "exp" => Operation::Exponential,
        "min" => Operation::Smaller,
        "max" => Operation::Larger,
        _ => {
            let problem = format!(
                "there is no function `{}`; the functions are {}",
                shortened(name),
                quoted(&FUNCTIONS)
            );
            return Err(Complaint::new(place, problem));
        }
    };
    let wanted = if many { "two values or more" } else { "one value" };
    if if many { arguments.len() < 2 } else { arguments.len() != 1 } {
        let problem = format!("{name} is of {wanted}, not of {}", arguments.len());
        return Err(Complaint::new(place, problem));
    }
    let mut arguments = arguments.into_iter();
    let Some(mut first) = arguments.next() else {
        return Err(Complaint::new(place, format!("{name} is of {wanted}")));
    };
    let (unit, _) = number(&first)?;
    if many {
        for next in arguments {
            same_unit(&first, &next, "compared")?;
            first = joined(first, next, operation, Kind::Number { unit, constant: None });
        }
        return Ok(Part { place, ..first });
    }
    let unit = match operation {
        Operation::Absolute => unit,
        Operation::SquareRoot => unit.to_the(0.5),
        _ if unit.is_none() => unit,
        _ => {
            let problem = format!(
                "{name} is of a number without a unit, this is {}; divide it by a value, like `/ (1 {})`",
                unit.said(),
                unit.text()
            );
            return Err(Complaint::new(first.place, problem));
        }
    };
    first.operations.push(operation);
    Ok(Part { kind: Kind::Number { unit, constant: None }, place, ..first })
}
