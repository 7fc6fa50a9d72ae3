//! Expressions as functions of a kernel. What of them is made of inputs alone the processor calculates, in f64, and gives the device
//! as numbers: a comparison of inputs is exact however close they are. All else is text, one line an operation.

use std::ops::Range;

use crate::engine::outcome::Method;
use crate::engine::status::Remark;
use crate::study::columns::Quantity;
use crate::study::design::{DesignCase, Load};
use crate::study::expression::program::{NumberColumn, Operation, WordColumn, WordTest, told};

/// What the processor gives the device in the place of expressions of inputs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Givens {
    /// One number a design, and one a load of it.
    pub of_design: Vec<Vec<Operation>>,
    pub of_row: Vec<Vec<Operation>>,
}

/// What all loads of a study are given as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AskedLoad(Option<Quantity>);

impl AskedLoad {
    /// Nothing where loads differ in kind, or are not known.
    pub fn of(loads: &[Load]) -> AskedLoad {
        let kind = |load: &Load| match load {
            Load::Indentation(_) => Quantity::Indentation,
            Load::Offset(_) => Quantity::Offset,
            Load::Force(_) => Quantity::Force,
        };
        let first = loads.first().map(kind);
        AskedLoad(first.filter(|first| loads.iter().all(|load| kind(load) == *first)))
    }
}

/// How often a part of an expression must be calculated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Scope {
    Once,
    Design,
    Row,
}

/// A part of an expression.
enum Part {
    /// Of inputs alone: its operations.
    Given(Range<usize>, Scope),
    /// By its name in the text.
    Made(String),
}

/// Adds the text of a function of rows to what others need; `None` where the device does not know what it takes.
pub fn function(
    name: &str,
    operations: &[Operation],
    asked: AskedLoad,
    givens: &mut Givens,
) -> Option<String> {
    let mut lines = String::new();
    let mut stack: Vec<Part> = Vec::new();
    for (place, operation) in operations.iter().enumerate() {
        let part = match operation.takes() {
            0 => leaf(operation, place, asked)?,
            count => {
                let taken = stack.split_off(stack.len() - count);
                joined(operation, place, taken, operations, givens, &mut lines)?
            }
        };
        stack.push(part);
    }
    let value = text(stack.pop()?, operations, givens)?;
    Some(format!("fn {name}(row: Row) -> vec2<f32> {{\n{lines}    return {value};\n}}\n"))
}

/// A column, a number or a word.
fn leaf(operation: &Operation, place: usize, asked: AskedLoad) -> Option<Part> {
    let given = |scope| Some(Part::Given(place..place + 1, scope));
    let made = |text: &str| Some(Part::Made(text.to_string()));
    match *operation {
        Operation::Number(_) => given(Scope::Once),
        Operation::Column(NumberColumn::Design | NumberColumn::Input(_)) => given(Scope::Design),
        Operation::Column(NumberColumn::Step) => given(Scope::Row),
        Operation::Column(NumberColumn::Result(quantity)) if asked.0 == Some(quantity) => given(Scope::Row),
        Operation::Column(NumberColumn::Result(quantity)) => match quantity {
            Quantity::Indentation => made("row.indentation"),
            Quantity::Offset => made("row.offset"),
            Quantity::Force => made("row.force"),
            Quantity::TangentStiffness => made("row.tangent_stiffness"),
            Quantity::ContactHalfAngle => made("row.half_angle"),
            Quantity::PeakPressure => made("row.peak_pressure"),
            Quantity::Energy => made("row.energy"),
            Quantity::ForceError => made("row.force_error"),
            Quantity::LinearityError => made("row.linearity_error"),
            Quantity::PeakPressureAngle | Quantity::Method | Quantity::Backend | Quantity::Status => None,
        },
        Operation::WordIs(WordTest { column: WordColumn::Result(quantity), word, equal }) => match quantity {
            // Of the rows that are counted on a device.
            Quantity::Method if word == Method::Fe.name() => {
                made(&format!("told_by((asked[ON_MESHES] > 0.0) == {equal})"))
            }
            Quantity::Method if word == Method::Interpolated.name() => {
                made(&format!("told_by((asked[ON_MESHES] > 0.0) != {equal})"))
            }
            Quantity::Method => made(&sure(!equal)),
            Quantity::Status if word == "ok" => made(&format!("told_by(row.is_large != {equal})")),
            Quantity::Status if word == Remark::LargeDisplacement.text() => {
                made(&format!("told_by(row.is_large == {equal})"))
            }
            Quantity::Status => made(&sure(!equal)),
            // The processor may solve a row again that the device has found.
            _ => None,
        },
        Operation::WordIs(_) => given(Scope::Design),
        _ => None,
    }
}

fn sure(holds: bool) -> String {
    format!("told_by({holds})")
}

/// An operation on parts, the last of whose operations is the one before it.
fn joined(
    operation: &Operation,
    place: usize,
    taken: Vec<Part>,
    operations: &[Operation],
    givens: &mut Givens,
    lines: &mut String,
) -> Option<Part> {
    let (mut start, mut scope) = (place, Scope::Once);
    let mut are_given = true;
    for part in &taken {
        match part {
            Part::Given(range, own) => (start, scope) = (start.min(range.start), scope.max(*own)),
            Part::Made(_) => are_given = false,
        }
    }
    if are_given {
        return Some(Part::Given(start..place + 1, scope));
    }
    let mut arguments = Vec::with_capacity(taken.len());
    for part in taken {
        arguments.push(text(part, operations, givens)?);
    }
    let call = match operation {
        Operation::Greater | Operation::GreaterOrEqual => {
            arguments.reverse();
            calls(&if *operation == Operation::Greater { Operation::Less } else { Operation::LessOrEqual })?
        }
        Operation::NotEqual => {
            let call = format!("equal({})", arguments.join(", "));
            arguments = vec![call];
            "opposite"
        }
        operation => calls(operation)?,
    };
    let name = format!("v{place}");
    lines.push_str(&format!("    let {name} = {call}({});\n", arguments.join(", ")));
    Some(Part::Made(name))
}

/// Whether an expression is of inputs alone, so that the processor knows its value beforehand.
pub fn is_given(operations: &[Operation], asked: AskedLoad) -> bool {
    let is_given = |operation: &Operation| {
        operation.takes() > 0 || matches!(leaf(operation, 0, asked), Some(Part::Given(..)))
    };
    operations.iter().all(is_given)
}

/// The function of the kernel.
fn calls(operation: &Operation) -> Option<&'static str> {
    Some(match operation {
        Operation::Negate => "negate",
        Operation::Not => "opposite",
        Operation::Add => "add",
        Operation::Subtract => "subtract",
        Operation::Multiply => "multiply",
        Operation::Divide => "divide",
        Operation::Power => "power",
        Operation::Less => "less",
        Operation::LessOrEqual => "less_or_equal",
        Operation::Equal => "equal",
        Operation::And => "both",
        Operation::Or => "either",
        Operation::Absolute => "absolute",
        Operation::SquareRoot => "square_root",
        Operation::Logarithm => "logarithm",
        Operation::Logarithm10 => "logarithm10",
        Operation::Exponential => "exponential",
        Operation::Smaller => "smaller",
        Operation::Larger => "larger",
        _ => return None,
    })
}

/// Of a part as an argument.
fn text(part: Part, operations: &[Operation], givens: &mut Givens) -> Option<String> {
    let (range, scope) = match part {
        Part::Made(name) => return Some(name),
        Part::Given(range, scope) => (range, scope),
    };
    let own = &operations[range];
    let read = if is_condition(own) { "exact" } else { "given" };
    let mut placed = |is_of_row: bool| {
        let known = if is_of_row { &mut givens.of_row } else { &mut givens.of_design };
        let place = known.iter().position(|known| known == own).unwrap_or(known.len());
        if place == known.len() {
            known.push(own.to_vec());
        }
        place
    };
    match scope {
        Scope::Once => {
            let value = constant(own);
            // A radius of what f32 rounds, as `given` has it.
            let radius =
                if is_condition(own) { "0.0".to_string() } else { format!("ROUNDED * {:e}", value.abs()) };
            let is_told = value.is_finite() && value.abs() < f64::from(f32::MAX);
            is_told.then(|| format!("vec2<f32>({value:e}, {radius})"))
        }
        Scope::Design => Some(format!("{read}(row.givens_at + {}u)", placed(false))),
        Scope::Row => Some(format!("{read}(row.row_givens_at + {}u)", placed(true))),
    }
}

/// Whether it is 1 or 0.
fn is_condition(operations: &[Operation]) -> bool {
    use Operation::*;
    let last = operations.last();
    let conditions = [Not, Less, LessOrEqual, Greater, GreaterOrEqual, Equal, NotEqual, And, Or];
    last.is_some_and(|last| conditions.contains(last) || matches!(last, WordIs(_)))
}

/// The value of an expression of inputs under a load of a design, by its number; NaN where one is missing.
pub fn value(operations: &[Operation], case: &DesignCase, step: usize) -> f64 {
    calculated(operations, |operation| match operation {
        Operation::Column(NumberColumn::Result(_)) => {
            case.steps.get(step).map_or(f64::NAN, |load| load.value())
        }
        Operation::Column(input) => input.of_inputs(case, step),
        Operation::WordIs(test) => {
            test.of_inputs(&case.joint).map_or(f64::NAN, |has| told(has == test.equal))
        }
        _ => f64::NAN,
    })
}

/// Of an expression of numbers alone.
fn constant(operations: &[Operation]) -> f64 {
    calculated(operations, |_| f64::NAN)
}

fn calculated(operations: &[Operation], leaf: impl Fn(&Operation) -> f64) -> f64 {
    let mut stack: Vec<f64> = Vec::with_capacity(8);
    for operation in operations {
        let value = match (operation, operation.takes()) {
            (Operation::Number(number), _) => *number,
            (_, 0) => leaf(operation),
            (_, 1) => operation.of_one(stack.pop().unwrap_or(f64::NAN)),
            _ => {
                let above = stack.pop().unwrap_or(f64::NAN);
                operation.of_two(stack.pop().unwrap_or(f64::NAN), above)
            }
        };
        stack.push(value);
    }
    stack.pop().unwrap_or(f64::NAN)
}
