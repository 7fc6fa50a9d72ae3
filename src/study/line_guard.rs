//! Refuses text that is no list of short cells before a CSV reader takes it in: a line that never ends, a quote that is
//! never closed.

use std::io::{Error, ErrorKind, Read};

/// A row of a list has some hundred bytes; more than this is no list of designs.
const LONGEST_LINE: usize = 1 << 16;

/// A reader that fails, by an `InvalidData` that says why, at the first line that is too long or leaves a quote open. No
/// cell of a list has a line break in it.
#[derive(Debug)]
pub struct LineGuard<R> {
    inner: R,
    /// From 1.
    line: u64,
    length: usize,
    in_quotes: bool,
}

impl<R> LineGuard<R> {
    pub fn new(inner: R) -> LineGuard<R> {
        LineGuard { inner, line: 1, length: 0, in_quotes: false }
    }

    pub fn inner(&self) -> &R {
        &self.inner
    }

    /// The line that is being read; where reading failed, the one that is to blame.
    pub fn line(&self) -> u64 {
        self.line
    }

    fn check(&mut self, bytes: &[u8]) -> Result<(), &'static str> {
        let open = "a quote is opened and not closed before the end of the line";
        for byte in bytes {
            match byte {
                b'\n' if self.in_quotes => return Err(open),
                b'\n' => (self.line, self.length) = (self.line + 1, 0),
                _ => {
                    self.in_quotes ^= *byte == b'"';
                    self.length += 1;
                    if self.length > LONGEST_LINE {
                        return Err("the line is longer than 65536 bytes: this is no list of designs");
                    }
                }
            }
        }
        // At the end of the file.
        if bytes.is_empty() && self.in_quotes { Err(open) } else { Ok(()) }
    }
}

impl<R: Read> Read for LineGuard<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.inner.read(buffer)?;
        match self.check(&buffer[..count]) {
            Ok(()) => Ok(count),
            Err(problem) => Err(Error::new(ErrorKind::InvalidData, problem)),
        }
    }
}
