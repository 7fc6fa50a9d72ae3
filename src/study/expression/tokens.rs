//! The text of an expression in pieces: numbers with their units, names, words in quotes, signs.

use std::ops::Range;

use winnow::ascii::{digit1, multispace0};
use winnow::combinator::{alt, delimited, opt};
use winnow::error::EmptyError;
use winnow::prelude::*;
use winnow::stream::{LocatingSlice, Location};
use winnow::token::{any, one_of, take_till, take_while};

use crate::error::{shortened, suggest};
use crate::study::expression::Complaint;
use crate::study::expression::unit::Unit;
use crate::study::units;

#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    Number {
        value: f64,
        unit: Unit,
    },
    /// A column, a function, or one of `and`, `or`, `not`.
    Name(String),
    /// In quotes.
    Word(String),
    Sign(&'static str),
}

/// A piece with its place in the text, in bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Token {
    pub piece: Piece,
    pub place: Range<usize>,
}

impl Token {
    pub fn is(&self, text: &str) -> bool {
        match &self.piece {
            Piece::Name(name) => name == text,
            Piece::Sign(sign) => *sign == text,
            _ => false,
        }
    }

    /// Whether it ends a value, so that a minus behind it subtracts.
    fn ends_a_value(&self) -> bool {
        match &self.piece {
            Piece::Name(name) => !KEYWORDS.contains(&name.as_str()),
            Piece::Sign(sign) => *sign == ")",
            _ => true,
        }
    }
}

pub const KEYWORDS: [&str; 3] = ["and", "or", "not"];

/// Longer ones first.
const SIGNS: [&str; 14] = ["<=", ">=", "==", "!=", "<", ">", "+", "-", "*", "/", "^", "(", ")", ","];

/// What people write from habit, and what it is here.
const HABITS: [(&str, &str); 6] =
    [("&&", "and"), ("||", "or"), ("**", "^"), ("=", "=="), ("!", "not"), ("<>", "!=")];

/// Brackets in brackets, and signs that wait for what is behind them (`not`, a minus, `^`), at most.
const DEEPEST: usize = 50;

type Input<'a> = LocatingSlice<&'a str>;

/// All pieces of the text.
pub fn tokens(text: &str) -> Result<Vec<Token>, Complaint> {
    let mut input = Input::new(text);
    let mut tokens: Vec<Token> = Vec::new();
    let (mut open, mut waiting) = (0_usize, 0);
    blanks(&mut input);
    while !input.is_empty() {
        let token = next(&mut input, text)?;
        let is_value = tokens.last().is_some_and(Token::ends_a_value);
        open = if token.is("(") { open + 1 } else { open.saturating_sub(usize::from(token.is(")"))) };
        waiting += usize::from(token.is("^") || token.is("not") || (token.is("-") && !is_value));
        if open > DEEPEST || waiting > DEEPEST {
            let problem =
                format!("more than {DEEPEST} brackets, signs, `not` or `^` wait for each other here");
            return Err(Complaint::new(token.place, problem));
        }
        tokens.push(token);
        blanks(&mut input);
    }
    Ok(tokens)
}

fn blanks(input: &mut Input) {
    let skipped: Result<&str, EmptyError> = multispace0.parse_next(input);
    debug_assert!(skipped.is_ok(), "no blanks are blanks, too");
}

fn next(input: &mut Input, text: &str) -> Result<Token, Complaint> {
    let start = input.current_token_start();
    for (habit, meant) in HABITS {
        // `==`, `!=` and `<=` begin or end alike.
        let is_sign = SIGNS.iter().any(|sign| sign.len() >= habit.len() && input.starts_with(sign));
        let is_longer = habit.len() == 2 && input.starts_with(habit);
        if input.starts_with(habit) && (is_longer || !is_sign) {
            return Err(Complaint::new(start..start + habit.len(), format!("write `{meant}`")));
        }
    }
    if let Some(digits) = take(input, number) {
        let (value, unit) = quantity(input, digits, start)?;
        return Ok(Token { piece: Piece::Number { value, unit }, place: start..text_end(input, text) });
    }
    let piece = if let Some(name) = take(input, name) {
        Piece::Name(name.to_string())
    } else if let Some(word) = take(input, quoted) {
        Piece::Word(word.to_string())
    } else if let Some(mut sign) = SIGNS.into_iter().find(|sign| input.starts_with(sign)) {
        let _: Result<&str, EmptyError> = sign.parse_next(input);
        Piece::Sign(sign)
    } else {
        let odd: Result<char, EmptyError> = any.parse_next(input);
        let odd = odd.unwrap_or_default();
        let problem = match odd {
            '\'' | '"' => "the quote is not closed".to_string(),
            '&' => "write `and`".to_string(),
            '|' => "write `or`".to_string(),
            _ => format!("`{odd}` has no meaning here"),
        };
        return Err(Complaint::new(start..start + odd.len_utf8(), problem));
    };
    Ok(Token { piece, place: start..text_end(input, text) })
}

fn text_end(input: &Input, text: &str) -> usize {
    text.len() - input.len()
}

/// What the parser takes, or nothing.
fn take<'a>(
    input: &mut Input<'a>,
    parser: fn(&mut Input<'a>) -> Result<&'a str, EmptyError>,
) -> Option<&'a str> {
    let taken: Result<Option<&str>, EmptyError> = opt(parser).parse_next(input);
    taken.unwrap_or_default()
}

fn number<'a>(input: &mut Input<'a>) -> Result<&'a str, EmptyError> {
    let digits = || take_while(0.., '0'..='9');
    let whole = (alt(((digit1, opt(('.', digits()))).take(), ('.', digit1).take())), opt(exponent));
    whole.take().parse_next(input)
}

fn exponent<'a>(input: &mut Input<'a>) -> Result<&'a str, EmptyError> {
    (one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1).take().parse_next(input)
}

fn name<'a>(input: &mut Input<'a>) -> Result<&'a str, EmptyError> {
    let first = one_of(|c: char| c.is_alphabetic() || c == '_');
    (first, take_while(0.., |c: char| c.is_alphanumeric() || c == '_')).take().parse_next(input)
}

fn quoted<'a>(input: &mut Input<'a>) -> Result<&'a str, EmptyError> {
    alt((delimited('\'', take_till(0.., '\''), '\''), delimited('"', take_till(0.., '"'), '"')))
        .parse_next(input)
}

/// Letters, maybe over letters: `N/mm`, `%`.
fn unit_name<'a>(input: &mut Input<'a>) -> Result<&'a str, EmptyError> {
    let letters = || take_while(1.., |c: char| c.is_alphabetic() || c == '_' || c == '\u{b5}');
    alt(("%".take(), (letters(), "/", letters()).take())).parse_next(input)
}

/// A unit by its name, with its power if one follows, and what one of it is in the unit of the tables; `None` where there is no such unit. The power is that of the last name
/// alone: `2 mm^2` is two square millimetres, `N/mm^2` a stress.
fn powered(input: &mut Input, name: &str) -> Result<Option<(Unit, f64)>, Complaint> {
    let known = |name: &str| units::find(name).map(|(dimension, factor)| (Unit::of(dimension), factor));
    let over = |(above, below): ((Unit, f64), (Unit, f64))| (above.0.over(below.0), above.1 / below.1);
    let parts = name.split_once('/').and_then(|(above, below)| known(above).zip(known(below)));
    let Some(whole) = known(name).or(parts.map(over)) else { return Ok(None) };
    let before = *input;
    blanks(input);
    let start = input.current_token_start();
    let is_powered: Result<Option<&str>, EmptyError> = opt("^").parse_next(input);
    if !is_powered.is_ok_and(|sign| sign.is_some()) {
        *input = before;
        return Ok(Some(whole));
    }
    blanks(input);
    let power = take(input, signed_number).and_then(|digits| digits.parse::<f64>().ok());
    let Some(power) = power.filter(|power| power.abs() <= LARGEST_POWER) else {
        let last = name.rsplit('/').next().unwrap_or(name);
        let problem = format!(
            "the power of a unit is a number, like `{last}^2`; put the value in brackets to raise it, too: `(2 {name}) ^ ...`"
        );
        return Err(Complaint::new(start..start + 1, problem));
    };
    let raised = |(unit, factor): (Unit, f64)| (unit.to_the(power), factor.powf(power));
    Ok(Some(parts.map_or_else(|| raised(whole), |(above, below)| over((above, raised(below))))))
}

/// Of units: beyond it they are nobody's.
const LARGEST_POWER: f64 = 100.0;

fn signed_number<'a>(input: &mut Input<'a>) -> Result<&'a str, EmptyError> {
    (opt('-'), number).take().parse_next(input)
}

/// The number behind which `input` stands, with the unit that may follow.
fn quantity(input: &mut Input, digits: &str, start: usize) -> Result<(f64, Unit), Complaint> {
    let place = start..start + digits.len();
    let value = digits.parse::<f64>().unwrap_or(f64::INFINITY);
    let too_large = |place| Err(Complaint::new(place, "the number is too large".to_string()));
    if !value.is_finite() {
        return too_large(place);
    }
    let before = *input;
    blanks(input);
    let unit_start = input.current_token_start();
    let with_unit = |(unit, factor): (Unit, f64)| {
        let value = units::in_table_units(value, factor);
        if value.is_finite() { Ok((value, unit)) } else { too_large(place.clone()) }
    };
    // `N/mm` first: `2 N/thickness` is a force over a column.
    let behind = *input;
    match take(input, unit_name) {
        Some("%") => return Ok((units::tidy(value / 100.0), Unit::NONE)),
        Some(unit) => match powered(input, unit)? {
            Some(found) => return with_unit(found),
            None => *input = behind,
        },
        None => {}
    }
    match take(input, name) {
        Some(word) if !KEYWORDS.contains(&word) => match powered(input, word)? {
            Some(found) => with_unit(found),
            None => {
                let problem =
                    format!("`{}` is not a unit; {}", shortened(word), suggest(word, &units::all_names()));
                Err(Complaint::new(unit_start..unit_start + word.len(), problem))
            }
        },
        _ => {
            *input = before;
            Ok((value, Unit::NONE))
        }
    }
}
