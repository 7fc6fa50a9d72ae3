//! How the pieces of an expression belong together. What binds weakest first: `or`, `and`, `not`, comparisons, `+ -`, `* /`, a
//! minus, `^` (from the right, as in Python: 2^3^2 is 2^9).

use winnow::combinator::{Infix, Prefix, expression};
use winnow::error::{ErrMode, ParserError};
use winnow::prelude::*;
use winnow::stream::{Stream, TokenSlice};

use crate::study::expression::Complaint;
use crate::study::expression::check::{self, Kind, Part};
use crate::study::expression::names::{self, Named};
use crate::study::expression::program::Operation;
use crate::study::expression::tokens::{KEYWORDS, Piece, Token};

type Input<'a> = TokenSlice<'a, Token>;
type Failed = ErrMode<Complaint>;
type Parsed = Result<Part, Failed>;

impl<I: Stream> ParserError<I> for Complaint {
    type Inner = Complaint;

    fn from_input(_: &I) -> Complaint {
        Complaint::new(0..0, String::new())
    }

    fn into_inner(self) -> Result<Complaint, Complaint> {
        Ok(self)
    }
}

/// Not this: something else may stand here.
fn other() -> Failed {
    ErrMode::Backtrack(Complaint::new(0..0, String::new()))
}

/// The whole expression; `end` is where its text ends.
pub fn parse(tokens: &[Token], end: usize) -> Result<Part, Complaint> {
    let mut input = Input::new(tokens);
    let part = whole(&mut input).map_err(|failed| placed(failed, end))?;
    match input.first() {
        None => Ok(part),
        Some(token) if token.is(")") => {
            Err(Complaint::new(token.place.clone(), "there is no `(` for this `)`".to_string()))
        }
        Some(token) => Err(Complaint::new(
            token.place.clone(),
            "an operator is needed before this: one of + - * / ^ < <= > >= == != and or".to_string(),
        )),
    }
}

/// A complaint of the end of the text, which has no token, gets the end as its place.
fn placed(failed: Failed, end: usize) -> Complaint {
    let complaint = match failed {
        ErrMode::Cut(complaint) | ErrMode::Backtrack(complaint) => complaint,
        ErrMode::Incomplete(_) => Complaint::new(AT_END, String::new()),
    };
    if complaint.place == AT_END { Complaint { place: end..end, ..complaint } } else { complaint }
}

const AT_END: std::ops::Range<usize> = usize::MAX..usize::MAX;

fn whole(input: &mut Input) -> Parsed {
    expression(operand).prefix(prefix).infix(infix).parse_next(input)
}

fn cut(checked: Result<Part, Complaint>) -> Parsed {
    checked.map_err(ErrMode::Cut)
}

fn refuse<T>(token: Option<&Token>, problem: String) -> Result<T, Failed> {
    let place = token.map_or(AT_END, |token| token.place.clone());
    Err(ErrMode::Cut(Complaint::new(place, problem)))
}

fn operand(input: &mut Input) -> Parsed {
    let Some(token) = input.first().cloned() else { return Err(other()) };
    let place = token.place.clone();
    let (operations, kind) = match token.piece {
        Piece::Number { value, unit } => {
            (vec![Operation::Number(value)], Kind::Number { unit, constant: Some(value) })
        }
        Piece::Word(word) => (Vec::new(), Kind::Quoted(word)),
        Piece::Name(name) if KEYWORDS.contains(&name.as_str()) => return Err(other()),
        Piece::Name(name) => {
            _ = input.next_token();
            if input.first().is_some_and(|next| next.is("(")) {
                let (arguments, end) = arguments(input)?;
                return cut(check::call(&name, arguments, place.start..end));
            }
            return match names::find(&name) {
                Ok(Named::Number(column, unit)) => {
                    let kind = Kind::Number { unit, constant: None };
                    Ok(Part { operations: vec![Operation::Column(column)], kind, place })
                }
                Ok(Named::Words(column)) => {
                    Ok(Part { operations: Vec::new(), kind: Kind::Words(column), place })
                }
                Err(_) if check::FUNCTIONS.contains(&name.as_str()) => {
                    refuse(Some(&Token { piece: Piece::Sign("("), place }), format!("write {name}(...)"))
                }
                Err(problem) => cut(Err(Complaint::new(place, problem))),
            };
        }
        Piece::Sign("(") => {
            _ = input.next_token();
            let inner = whole(input)?;
            let end = closed(input, &place)?;
            return Ok(Part { place: place.start..end, ..inner });
        }
        Piece::Sign(_) => return Err(other()),
    };
    _ = input.next_token();
    Ok(Part { operations, kind, place })
}

/// Behind the `)` that closes what was opened at `open`.
fn closed(input: &mut Input, open: &std::ops::Range<usize>) -> Result<usize, Failed> {
    match input.first() {
        Some(token) if token.is(")") => {
            let end = token.place.end;
            _ = input.next_token();
            Ok(end)
        }
        None => Err(ErrMode::Cut(Complaint::new(open.clone(), "this `(` is not closed".to_string()))),
        token => refuse(token, "an operator, or the `)` for a `(` before, is needed here".to_string()),
    }
}

/// The values in brackets behind a function's name, and where the brackets end.
fn arguments(input: &mut Input) -> Result<(Vec<Part>, usize), Failed> {
    let open = input.first().map_or(0..0, |token| token.place.clone());
    _ = input.next_token();
    let mut arguments = vec![whole(input)?];
    while input.first().is_some_and(|token| token.is(",")) {
        _ = input.next_token();
        arguments.push(whole(input)?);
    }
    Ok((arguments, closed(input, &open)?))
}

fn prefix<'a>(input: &mut Input<'a>) -> Result<Prefix<Input<'a>, Part, Failed>, Failed> {
    let first = input.first();
    let prefix = match first {
        Some(token) if token.is("-") => Prefix(70, |_: &mut Input<'a>, a| cut(check::negative(a))),
        Some(token) if token.is("not") => Prefix(30, |_: &mut Input<'a>, a| cut(check::opposite(a))),
        token => return refuse(token, "a number, a column or a `(` is needed here".to_string()),
    };
    _ = input.next_token();
    Ok(prefix)
}

fn infix<'a>(input: &mut Input<'a>) -> Result<Infix<Input<'a>, Part, Failed>, Failed> {
    use Infix::{Left, Right};
    let text = match input.first().map(|token| &token.piece) {
        Some(Piece::Sign(sign)) => *sign,
        Some(Piece::Name(name)) => name.as_str(),
        _ => return Err(other()),
    };
    // The closures cannot hold anything: each operation has its own.
    macro_rules! left {
        ($power:literal, $rule:ident, $operation:ident) => {
            Left($power, |_: &mut Input<'a>, a, b| cut(check::$rule(a, b, Operation::$operation)))
        };
    }
    let infix = match text {
        "or" => left!(10, both, Or),
        "and" => left!(20, both, And),
        "<" => left!(40, comparison, Less),
        "<=" => left!(40, comparison, LessOrEqual),
        ">" => left!(40, comparison, Greater),
        ">=" => left!(40, comparison, GreaterOrEqual),
        "==" => left!(40, comparison, Equal),
        "!=" => left!(40, comparison, NotEqual),
        "+" => left!(50, sum, Add),
        "-" => left!(50, sum, Subtract),
        "*" => left!(60, product, Multiply),
        "/" => left!(60, product, Divide),
        "^" => Right(80, |_: &mut Input<'a>, a, b| cut(check::power(a, b))),
        _ => return Err(other()),
    };
    _ = input.next_token();
    Ok(infix)
}
