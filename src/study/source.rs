//! A config as TOML that knows where everything stands, so that every complaint can name file, line and key.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::PathBuf;

use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toml_edit::DocumentMut;

use crate::error::{Error, shortened, suggest};
use crate::study::setting::Setting;

/// Bytes of a config at most: lists of a million values fit. Long lists of designs are files of their own.
const LARGEST: u64 = 16 << 20;

/// A config's text and where it came from.
#[derive(Debug)]
pub struct Source {
    pub path: PathBuf,
    /// With what was set beside the file.
    pub text: String,
    /// What was set: dotted keys, and the lines that each setting has changed.
    edits: Vec<Edit>,
}

/// Lines `first..first + new` of a text (from 0) that stand where the text before had `first..first + old`.
#[derive(Debug)]
struct Edit {
    /// Dotted, of what was not there before, or of the value.
    key: String,
    /// How it was given.
    place: &'static str,
    first: u64,
    old: u64,
    new: u64,
}

impl Edit {
    /// Which has made, or changed, what has a dotted key.
    fn between(setting: &Setting, key: String, before: &str, after: &str) -> Edit {
        let (before, after): (Vec<&str>, Vec<&str>) = (before.lines().collect(), after.lines().collect());
        let first = before.iter().zip(&after).take_while(|(old, new)| old == new).count();
        let tail = before[first..].iter().rev().zip(after[first..].iter().rev());
        let last = tail.take_while(|(old, new)| old == new).count();
        let lines = |text: &[&str]| (text.len() - first - last) as u64;
        Edit { key, place: setting.place, first: first as u64, old: lines(&before), new: lines(&after) }
    }

    /// The line of the text before in which `line` (from 0) of the text after stood; the nearest one for lines that are new.
    fn before(&self, line: u64) -> u64 {
        if line < self.first {
            line
        } else if line < self.first + self.new {
            line.min((self.first + self.old).saturating_sub(1).max(self.first))
        } else {
            line - self.new + self.old
        }
    }
}

impl Source {
    pub fn new(path: PathBuf, text: String) -> Source {
        Source { path, text, edits: Vec::new() }
    }

    /// Reads a file, or what a pipe has to say.
    pub fn read(path: PathBuf) -> Result<Source, Error> {
        let mut bytes = Vec::new();
        let read = File::open(&path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes));
        if let Err(source) = read {
            return Err(Error::Io { action: "read", path, source });
        }
        if bytes.len() as u64 > LARGEST {
            let problem = format!("this is no config: it has more than {} MB", LARGEST >> 20);
            return Err(Error::Input { file: path, line: None, key: String::new(), problem });
        }
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Source::new(path, text)),
            Err(error) => {
                let valid = error.utf8_error().valid_up_to();
                let line = line_of(&error.as_bytes()[..valid]);
                let problem = "this is not UTF-8 text".to_string();
                Err(Error::Input { file: path, line: Some(line), key: String::new(), problem })
            }
        }
    }

    pub fn parse(&self) -> Result<Spanned<DeTable<'_>>, Error> {
        DeTable::parse(&self.text).map_err(|error| {
            let start = error.span().map(|span| span.start);
            let problem = match error.message().replace('\n', ", ") {
                message if message.contains("recurs") => "lists or tables are nested too deep".to_string(),
                message => message,
            };
            self.error(start, "", format!("not valid TOML: {problem}"))
        })
    }

    /// Sets values, the last one of a key being the one that counts: the text is then that of a config that has them.
    pub fn set(&mut self, settings: &[Setting]) -> Result<(), Error> {
        for setting in settings {
            // First our own parser, whose complaints have a line.
            self.parse()?;
            let mut document = match self.text.parse::<DocumentMut>() {
                Ok(document) => document,
                Err(error) => {
                    let start = error.span().map(|span| span.start);
                    return Err(self.error(start, "", format!("not valid TOML: {}", error.message())));
                }
            };
            let key = setting.apply(&mut document)?;
            let text = document.to_string();
            self.edits.push(Edit::between(setting, key, &self.text, &text));
            self.text = text;
        }
        Ok(())
    }

    /// The root table of what `parse` gave.
    pub fn root<'a>(&'a self, document: &'a Spanned<DeTable<'a>>) -> Section<'a> {
        // What the root lacks is missed at the end.
        let end = self.text.trim_end().len();
        Section { source: self, key: String::new(), start: Some(end), table: document.get_ref() }
    }

    /// A complaint about the line of byte `start`, or about what was set.
    pub fn error(&self, start: Option<usize>, key: &str, problem: String) -> Error {
        let is_of = |edit: &Edit| {
            key == edit.key || key.strip_prefix(&edit.key).is_some_and(|rest| rest.starts_with('.'))
        };
        if let Some(edit) = self.edits.iter().rev().find(|edit| is_of(edit)) {
            return Error::Input { file: edit.place.into(), line: None, key: key.to_string(), problem };
        }
        let line = start.filter(|start| *start <= self.text.len()).map(|start| self.line(start));
        Error::Input { file: self.path.clone(), line, key: key.to_string(), problem }
    }

    /// The line of the file, from 1, in which byte `start` of the text stands.
    fn line(&self, start: usize) -> u64 {
        let line = line_of(&self.text.as_bytes()[..start.min(self.text.len())]) - 1;
        1 + self.edits.iter().rev().fold(line, |line, edit| edit.before(line))
    }
}

/// The number, from 1, of the line that comes after `before`.
fn line_of(before: &[u8]) -> u64 {
    1 + before.iter().filter(|&&byte| byte == b'\n').count() as u64
}

/// A table with its dotted key; `start` is where its header stands, for the root where the text ends.
#[derive(Clone)]
pub struct Section<'a> {
    source: &'a Source,
    key: String,
    start: Option<usize>,
    table: &'a DeTable<'a>,
}

impl<'a> Section<'a> {
    /// A complaint about the table as a whole.
    pub fn error(&self, problem: String) -> Error {
        self.source.error(self.start, &self.key, problem)
    }

    /// Refuses every key but these.
    pub fn allow(&self, keys: &[&str]) -> Result<(), Error> {
        // The first in the file, not the first in the alphabet: people mend files from the top.
        let unknown = self.table.keys().filter(|key| !keys.contains(&key.get_ref().as_ref()));
        match unknown.min_by_key(|key| key.span().start) {
            None => Ok(()),
            Some(key) => {
                let problem = format!("unknown key; {}", suggest(key.get_ref(), keys));
                Err(self.source.error(
                    Some(key.span().start),
                    &self.dotted(&shortened(key.get_ref())),
                    problem,
                ))
            }
        }
    }

    pub fn find(&self, key: &str) -> Option<Item<'a>> {
        let (name, value) = self.table.get_key_value(key)?;
        // A table's own span is its header or, for dotted keys, nothing; its name is always somewhere.
        let span = if value.get_ref().is_table() { name.span() } else { value.span() };
        Some(Item { source: self.source, key: self.dotted(key), span, value: value.get_ref() })
    }

    pub fn need(&self, key: &str) -> Result<Item<'a>, Error> {
        self.find(key).ok_or_else(|| self.missing(key))
    }

    /// A complaint that `key` is not there.
    pub fn missing(&self, key: &str) -> Error {
        self.error(format!("the key `{key}` is missing"))
    }

    /// The table under `key`, if there is one.
    pub fn section(&self, key: &str) -> Result<Option<Section<'a>>, Error> {
        self.find(key).map(|item| item.section()).transpose()
    }

    fn dotted(&self, key: &str) -> String {
        if self.key.is_empty() { key.to_string() } else { format!("{}.{key}", self.key) }
    }
}

/// A value with its dotted key.
#[derive(Clone)]
pub struct Item<'a> {
    source: &'a Source,
    pub key: String,
    span: Range<usize>,
    value: &'a DeValue<'a>,
}

impl<'a> Item<'a> {
    /// A complaint about this value.
    pub fn error(&self, problem: impl Into<String>) -> Error {
        self.source.error(Some(self.span.start), &self.key, problem.into())
    }

    /// A complaint that shows the value as it is written.
    pub fn refuse(&self, problem: &str) -> Error {
        self.error(format!("`{}`: {problem}", self.written()))
    }

    /// The value as it is written in the file, shortened to one short line.
    pub fn written(&self) -> String {
        let text = self.source.text.get(self.span.clone()).unwrap_or_default();
        let line = text.lines().next().unwrap_or_default();
        let short = shortened(line);
        if line.len() == text.len() || short.len() < line.len() { short } else { format!("{short}...") }
    }

    /// Where the value stands in the file: the order in which things are listed.
    pub fn start(&self) -> usize {
        self.span.start
    }

    pub fn line(&self) -> u64 {
        self.source.line(self.span.start)
    }

    pub fn string(&self) -> Result<&'a str, Error> {
        self.value.as_str().ok_or_else(|| self.wrong_type("a string"))
    }

    pub fn boolean(&self) -> Result<bool, Error> {
        self.value.as_bool().ok_or_else(|| self.wrong_type("true or false"))
    }

    /// One of the words in `allowed`, as its position.
    pub fn word(&self, allowed: &[&str]) -> Result<usize, Error> {
        let word = self.string()?;
        let found = allowed.iter().position(|&candidate| candidate == word);
        found.ok_or_else(|| self.refuse(&format!("not known; {}", suggest(word, allowed))))
    }

    /// A plain number, finite; `None` when it is no number at all.
    pub fn number(&self) -> Result<Option<f64>, Error> {
        let number = match self.value {
            DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
                .map(|integer| integer as f64)
                .map_err(|_| self.refuse("the number is too large"))?,
            DeValue::Float(float) => float.as_str().parse().map_err(|_| self.refuse("not a number"))?,
            _ => return Ok(None),
        };
        if number.is_finite() { Ok(Some(number)) } else { Err(self.refuse("the number is not finite")) }
    }

    /// A whole number from `least` to `most`.
    pub fn whole(&self, least: u64, most: u64) -> Result<u64, Error> {
        let DeValue::Integer(integer) = self.value else {
            return Err(self.wrong_type("a whole number"));
        };
        match u64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(number) if (least..=most).contains(&number) => Ok(number),
            _ => Err(self.refuse(&format!("must be a whole number from {least} to {most}"))),
        }
    }

    /// The elements of an array that is not empty; `None` when it is no array.
    pub fn array(&self) -> Result<Option<Vec<Item<'a>>>, Error> {
        let Some(array) = self.value.as_array() else {
            return Ok(None);
        };
        if array.is_empty() {
            return Err(self.error("the list is empty"));
        }
        let element = |value: &'a Spanned<DeValue<'a>>| Item {
            source: self.source,
            key: self.key.clone(),
            span: value.span(),
            value: value.get_ref(),
        };
        Ok(Some(array.iter().map(element).collect()))
    }

    /// The tables of a list of tables, their keys numbered from 1.
    pub fn tables(&self) -> Result<Vec<Section<'a>>, Error> {
        let wrong = |item: &Item<'a>| item.wrong_type(&format!("a list of tables, [[{}]],", self.key));
        let array = self.value.as_array().ok_or_else(|| wrong(self))?;
        let section = |(place, value): (usize, &'a Spanned<DeValue<'a>>)| {
            let key = format!("{}.{}", self.key, place + 1);
            let item = Item { source: self.source, key, span: value.span(), value: value.get_ref() };
            if item.is_table() { item.section() } else { Err(wrong(&item)) }
        };
        array.iter().enumerate().map(section).collect()
    }

    pub fn is_table(&self) -> bool {
        self.value.is_table()
    }

    pub fn section(&self) -> Result<Section<'a>, Error> {
        let table = self.value.as_table().ok_or_else(|| self.wrong_type("a table"))?;
        Ok(Section { source: self.source, key: self.key.clone(), start: Some(self.span.start), table })
    }

    /// A complaint about the type: what is wanted and what was found.
    pub fn wrong_type(&self, wanted: &str) -> Error {
        self.refuse(&format!("{wanted} is needed here, not {}", kind(self.value)))
    }
}

fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "a whole number",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
