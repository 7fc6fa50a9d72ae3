//! What the processor gives a device of designs that it draws itself: functions of the kernel that draws, in f64.
//!
//! What they find differs from the processor's by roundings at most. Where a comparison might come out otherwise for that, its design is left
//! to the processor.

use super::formula::Givens;
use crate::mechanics::body::{Shape, Side};
use crate::mechanics::material::Idealization;
use crate::study::columns::Column;
use crate::study::draw_tables::{POISSONS_RATIO, SUPPORT, Slot, YOUNGS_MODULUS};
use crate::study::expression::program::{NumberColumn, Operation, WordColumn, WordTest};

/// The shapes of pin and plate, which all designs have in common.
pub type Shapes = [&'static Shape; 2];

/// `given_of_design` and `given_of_row`; `None` where a device does not know what it takes.
pub fn functions(givens: &Givens, shapes: Shapes) -> Option<String> {
    let mut text = String::new();
    let mut function = |name: &str, all: &[Vec<Operation>]| {
        let mut cases = String::new();
        for (number, operations) in all.iter().enumerate() {
            let (lines, value) = body(operations, shapes)?;
            cases += &format!("        case {number}u: {{\n{lines}            return {value};\n        }}\n");
        }
        text += &format!(
            "fn {name}(number: u32, load: u32) -> wide {{\n    switch number {{\n{cases}        default: {{\n            return 0.0;\n        \
             }}\n    }}\n}}\n"
        );
        Some(())
    };
    function("given_of_design", &givens.of_design)?;
    function("given_of_row", &givens.of_row)?;
    Some(text)
}

/// A part of an expression: its name in the text, whether it is the processor's number to the bit, and its value where that is a constant.
struct Part {
    name: String,
    is_exact: bool,
    constant: Option<f64>,
}

impl Part {
    fn constant(number: f64) -> Option<Part> {
        let name = format!("wide({number:?})");
        number.is_finite().then_some(Part { name, is_exact: true, constant: Some(number) })
    }
}

/// A line an operation, and the name of what they come to.
fn body(operations: &[Operation], shapes: Shapes) -> Option<(String, String)> {
    let mut lines = String::new();
    let mut stack: Vec<Part> = Vec::new();
    for (place, operation) in operations.iter().enumerate() {
        let taken = stack.split_off(stack.len().checked_sub(operation.takes())?);
        let constants: Option<Vec<f64>> = taken.iter().map(|part| part.constant).collect();
        let part = match (constants.as_deref(), operation) {
            (_, Operation::Number(number)) => Part::constant(*number)?,
            (Some([]), _) => Part { name: leaf(operation, shapes)?, is_exact: true, constant: None },
            (Some([a]), _) => Part::constant(operation.of_one(*a))?,
            (Some([a, b]), _) => Part::constant(operation.of_two(*a, *b))?,
            _ => {
                let value = made(operation, &taken)?;
                let name = format!("v{place}");
                lines += &format!("            let {name} = {value};\n");
                Part { name, is_exact: is_condition(operation), constant: None }
            }
        };
        stack.push(part);
    }
    Some((lines, stack.pop()?.name))
}

/// A column, or what it is compared with.
fn leaf(operation: &Operation, shapes: Shapes) -> Option<String> {
    let drawn = |slot: usize| format!("drawn[{slot}]");
    let of_part = |side: Side, entry: usize| {
        drawn(if side == Side::Pin { Slot::Pin as usize } else { Slot::Plate as usize } + entry)
    };
    let shape = |side: Side| shapes[usize::from(side == Side::Plate)];
    let is_at = |name: String, place: usize, equal: bool| {
        let comparison = if equal { "==" } else { "!=" };
        format!("told({name} {comparison} {:?})", place as f64)
    };
    Some(match *operation {
        Operation::Column(NumberColumn::Design) => "wide(design)".to_string(),
        Operation::Column(NumberColumn::Step) => "wide(load)".to_string(),
        // The load that is asked for.
        Operation::Column(NumberColumn::Result(_)) => "load_value(load)".to_string(),
        Operation::Column(NumberColumn::Input(column)) => match column {
            Column::HoleRadius => drawn(Slot::HoleRadius as usize),
            Column::RadialClearance => drawn(Slot::RadialClearance as usize),
            Column::Thickness => drawn(Slot::Thickness as usize),
            Column::Parameter(side, name) => {
                of_part(side, shape(side).parameters.iter().position(|own| own.name == name)?)
            }
            Column::YoungsModulus(side) => of_part(side, YOUNGS_MODULUS),
            Column::PoissonsRatio(side) => of_part(side, POISSONS_RATIO),
            _ => return None,
        },
        Operation::WordIs(WordTest { column, word, equal }) => match column {
            WordColumn::Idealization => {
                let place = Idealization::ALL.iter().position(|own| own.name() == word)?;
                is_at(drawn(Slot::Idealization as usize), place, equal)
            }
            WordColumn::Model(side) => format!("told({})", (shape(side).name == word) == equal),
            WordColumn::Support(side) => {
                let place = shape(side).supports.iter().position(|own| *own == word)?;
                is_at(of_part(side, SUPPORT), place, equal)
            }
            WordColumn::Result(_) => return None,
        },
        _ => return None,
    })
}

/// An operation on parts.
fn made(operation: &Operation, taken: &[Part]) -> Option<String> {
    let names: Vec<&str> = taken.iter().map(|part| part.name.as_str()).collect();
    let compared = |comparison: &str| {
        let [a, b] = names[..] else { return None };
        Some(match taken.iter().all(|part| part.is_exact) {
            true => format!("told({a} {comparison} {b})"),
            false => format!("told_apart({a} {comparison} {b}, {a}, {b})"),
        })
    };
    let between = |operator: &str| Some(names.join(&format!(" {operator} ")));
    match (operation, &names[..]) {
        (Operation::Negate, [a]) => Some(format!("-{a}")),
        (Operation::Not, [a]) => Some(format!("1.0 - {a}")),
        (Operation::Absolute, [a]) => Some(format!("abs({a})")),
        (Operation::Add, _) => between("+"),
        (Operation::Subtract, _) => between("-"),
        (Operation::Multiply | Operation::And, _) => between("*"),
        (Operation::Divide, _) => between("/"),
        (Operation::Power, [a, _]) => power(a, taken[1].constant?),
        (Operation::Or | Operation::Larger, _) => Some(format!("max({})", names.join(", "))),
        (Operation::Smaller, _) => Some(format!("min({})", names.join(", "))),
        (Operation::Less, _) => compared("<"),
        (Operation::LessOrEqual, _) => compared("<="),
        (Operation::Greater, _) => compared(">"),
        (Operation::GreaterOrEqual, _) => compared(">="),
        (Operation::Equal, _) => compared("=="),
        (Operation::NotEqual, _) => compared("!="),
        // In f32 alone on devices.
        _ => None,
    }
}

/// A number to a power that is whole and small.
fn power(name: &str, exponent: f64) -> Option<String> {
    const GREATEST: f64 = 8.0;
    let is_small = exponent.fract() == 0.0 && (1.0..=GREATEST).contains(&exponent);
    is_small.then(|| vec![name; exponent as usize].join(" * "))
}

/// Of an operation on numbers: whether it tells 1 or 0, which is exact where its design is not left to the processor.
fn is_condition(operation: &Operation) -> bool {
    use Operation::*;
    matches!(operation, Not | Less | LessOrEqual | Greater | GreaterOrEqual | Equal | NotEqual | And | Or)
}
