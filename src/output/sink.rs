//! A file of a result that rows are added to as designs are solved: what it is, and how it is kept whole.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::engine::outcome::DesignOutcome;
use crate::error::Error;
use crate::study::fingerprint::{Fingerprint, Fingerprinter};

/// What each outcome adds to a file. A new kind of file is one of these.
pub trait Sink: Send {
    /// The file's name in the folder of the result.
    fn file_name(&self) -> &'static str;

    /// Appends what the file begins with.
    fn push_header(&self, out: &mut Vec<u8>);

    /// Appends the rows of a design. A response that cannot be written is turned into a failed one, in `outcome`, too.
    fn push_rows(&mut self, out: &mut Vec<u8>, outcome: &mut DesignOutcome);
}

/// Rows are handed to the file in portions of about this many bytes ...
const PORTION: usize = 1 << 16;
/// ... and at least this often, for those who watch the file of a slow run.
const PATIENCE: Duration = Duration::from_secs(1);

/// A sink with its file.
pub struct SinkFile {
    sink: Box<dyn Sink>,
    path: PathBuf,
    /// Whole rows that wait for the file.
    waiting: Vec<u8>,
    /// From the first outcome on.
    file: Option<File>,
    /// Of the whole rows in the file.
    printer: Fingerprinter,
    written: Instant,
}

impl SinkFile {
    pub fn new(sink: Box<dyn Sink>, path: PathBuf) -> SinkFile {
        let (waiting, printer, written) = (Vec::new(), Fingerprinter::default(), Instant::now());
        SinkFile { sink, path, waiting, file: None, printer, written }
    }

    pub fn name(&self) -> &'static str {
        self.sink.file_name()
    }

    pub fn fingerprint(&self) -> Fingerprint {
        self.printer.fingerprint()
    }

    /// Opens the file, and leaves what is in it.
    pub fn open(&mut self) -> Result<(), Error> {
        let opened = OpenOptions::new().write(true).create(true).truncate(false).open(&self.path);
        self.file = Some(opened.map_err(|source| self.unwritable(source))?);
        Ok(())
    }

    /// Empties the file, and begins anew.
    pub fn begin(&mut self) -> Result<(), Error> {
        self.sink.push_header(&mut self.waiting);
        let emptied = self.file.as_ref().map_or(Ok(()), |file| file.set_len(0));
        emptied.map_err(|source| self.unwritable(source))
    }

    /// Adds the rows of a design.
    pub fn write(&mut self, outcome: &mut DesignOutcome) -> Result<(), Error> {
        self.sink.push_rows(&mut self.waiting, outcome);
        let overdue = self.written.elapsed() > PATIENCE;
        if self.waiting.len() >= PORTION || overdue { self.flush() } else { Ok(()) }
    }

    /// Appends all rows that wait or, when that fails, none of them: the file ends with a whole row.
    pub fn flush(&mut self) -> Result<(), Error> {
        let Some(file) = &mut self.file else { return Ok(()) };
        if let Err(source) = file.write_all(&self.waiting) {
            // Should this fail too, the first error is still the one to tell.
            let _ = file.set_len(self.printer.fingerprint().bytes);
            return Err(self.unwritable(source));
        }
        self.printer.update(&self.waiting);
        self.written = Instant::now();
        self.waiting.clear();
        Ok(())
    }

    fn unwritable(&self, source: std::io::Error) -> Error {
        Error::Io { action: "write", path: self.path.clone(), source }
    }
}
