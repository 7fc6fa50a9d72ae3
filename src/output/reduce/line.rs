//! One line of a CSV file, cell by cell.

use crate::output::number::push_rounded;
use crate::output::table::push_text;

#[derive(Default)]
pub struct Line(Vec<u8>);

impl Line {
    pub fn text(&mut self, text: &str) -> &mut Line {
        push_text(&mut self.0, text);
        self.0.push(b',');
        self
    }

    /// With nine digits; empty for none.
    pub fn number(&mut self, value: Option<f64>) -> &mut Line {
        if let Some(value) = value.filter(|value| value.is_finite()) {
            push_rounded(&mut self.0, value);
        }
        self.0.push(b',');
        self
    }

    pub fn whole(&mut self, value: Option<u64>) -> &mut Line {
        if let Some(value) = value {
            self.0.extend_from_slice(value.to_string().as_bytes());
        }
        self.0.push(b',');
        self
    }

    /// The cells, with a line's end in the place of the last comma.
    pub fn end(&mut self, out: &mut Vec<u8>) {
        self.0.pop();
        out.append(&mut self.0);
        out.push(b'\n');
    }

    /// The cells, and behind them a line that is at hand.
    pub fn end_with(&mut self, rest: &str, out: &mut Vec<u8>) {
        out.append(&mut self.0);
        out.extend_from_slice(rest.as_bytes());
        out.push(b'\n');
    }
}
