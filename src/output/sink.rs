//! A file of a result that rows are added to as designs are solved: what it is, and how it is kept whole.

use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::PathBuf;

use crate::engine::outcome::DesignOutcome;
use crate::error::Error;
use crate::study::fingerprint::{Fingerprint, Fingerprinter, read_pieces};

/// What outcomes add to a file. A new kind of file is one of these.
pub trait Sink: Send + Sync {
    /// The file's name in the folder of the result.
    fn file_name(&self) -> &'static str;

    /// What the file begins with.
    fn header(&self) -> Vec<u8>;

    /// The rows of some designs, made by any thread.
    fn rows(&self, outcomes: &[DesignOutcome]) -> Vec<u8>;

    /// What the file ends with, behind its rows.
    fn end(&self, _file: &mut File) -> std::io::Result<Vec<u8>> {
        Ok(Vec::new())
    }
}

/// A sink's file.
pub struct SinkFile {
    name: String,
    path: PathBuf,
    /// From the first rows on.
    file: Option<File>,
    /// Of what is in the file.
    printer: Fingerprinter,
}

impl SinkFile {
    pub fn new(name: &str, path: PathBuf) -> SinkFile {
        SinkFile { name: name.into(), path, file: None, printer: Fingerprinter::default() }
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn fingerprint(&self) -> Fingerprint {
        self.printer.fingerprint()
    }

    /// Opens the file, and leaves what is in it.
    pub fn open(&mut self) -> Result<(), Error> {
        let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&self.path);
        self.file = Some(opened.map_err(|source| self.unwritable(source))?);
        Ok(())
    }

    /// Whether the file, which is open, begins as it was when it had this fingerprint.
    pub fn is_still(&mut self, print: &Fingerprint) -> Result<bool, Error> {
        let unreadable = |source| Error::Io { action: "read", path: self.path.clone(), source };
        let Some(file) = &mut self.file else { return Ok(false) };
        file.seek(SeekFrom::Start(0)).map_err(unreadable)?;
        self.printer = read_pieces(file, print.bytes, unreadable, |_| Ok(()))?;
        Ok(self.printer.fingerprint() == *print)
    }

    /// Forgets what is in the file behind what was found to be still there.
    pub fn go_on(&mut self) -> Result<(), Error> {
        self.cut(self.printer.fingerprint().bytes)
    }

    /// Empties the file, and begins anew.
    pub fn begin(&mut self, header: &[u8]) -> Result<(), Error> {
        self.printer = Fingerprinter::default();
        self.cut(0)?;
        self.append(header)
    }

    fn cut(&mut self, bytes: u64) -> Result<(), Error> {
        let cut = |file: &mut File| {
            // File systems that expect a file emptied to be replaced (ext4) wait at its end until they have found room for all of it.
            if file.metadata()?.len() != bytes {
                file.set_len(bytes)?;
            }
            file.seek(SeekFrom::Start(bytes))
        };
        self.file.as_mut().map_or(Ok(0), cut).map_err(|source| self.unwritable(source))?;
        Ok(())
    }

    /// Appends all of the bytes or, when that fails, none of them: the file ends with a whole row.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let Some(file) = &mut self.file else { return Ok(()) };
        if let Err(source) = file.write_all(bytes) {
            // Should this fail too, the first error is still the one to tell.
            let _ = file.set_len(self.printer.fingerprint().bytes);
            return Err(self.unwritable(source));
        }
        self.printer.update(bytes);
        Ok(())
    }

    /// Writes what the file ends with.
    pub fn end(&mut self, sink: &dyn Sink) -> Result<(), Error> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let end = sink.end(file).and_then(|end| file.seek(SeekFrom::End(0)).map(|_| end));
        let end = end.map_err(|source| self.unwritable(source))?;
        self.append(&end)
    }

    /// Waits until the file is on the disk, whatever becomes of the machine.
    pub fn sync(&self) -> Result<(), Error> {
        self.file.as_ref().map_or(Ok(()), File::sync_data).map_err(|source| self.unwritable(source))
    }

    fn unwritable(&self, source: std::io::Error) -> Error {
        Error::Io { action: "write", path: self.path.clone(), source }
    }
}
