//! What tells whether a file is still the one it was: its length and a hash of its bytes.

use std::fmt;
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

use xxhash_rust::xxh3::Xxh3;

/// Length and XXH128 of some bytes, as `xxh128sum` prints it. It finds accidents, not forgeries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint {
    pub bytes: u64,
    xxh128: u128,
}

impl Fingerprint {
    pub fn of(bytes: &[u8]) -> Fingerprint {
        let mut printer = Fingerprinter::default();
        printer.update(bytes);
        printer.fingerprint()
    }

    /// Of a file as it is now.
    pub fn of_file(path: &Path) -> std::io::Result<Fingerprint> {
        let printer = read_pieces(File::open(path)?, u64::MAX, |error| error, |_| Ok(()))?;
        Ok(printer.fingerprint())
    }

    /// The hash in 32 hexadecimal digits.
    pub fn hash(&self) -> String {
        format!("{:032x}", self.xxh128)
    }

    /// The hash, its first digits first.
    pub fn bytes_of_hash(&self) -> [u8; 16] {
        self.xxh128.to_be_bytes()
    }

    /// From what `bytes` and `hash` gave.
    pub fn parse(bytes: u64, hash: &str) -> Option<Fingerprint> {
        Some(Fingerprint { bytes, xxh128: u128::from_str_radix(hash, 16).ok()? })
    }
}

/// Makes the fingerprint of bytes that come piece by piece.
#[derive(Clone, Default)]
pub struct Fingerprinter {
    bytes: u64,
    hasher: Xxh3,
}

impl fmt::Debug for Fingerprinter {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "Fingerprinter({} bytes)", self.bytes)
    }
}

impl Fingerprinter {
    pub fn update(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        self.hasher.update(bytes);
    }

    pub fn fingerprint(&self) -> Fingerprint {
        Fingerprint { bytes: self.bytes, xxh128: self.hasher.digest128() }
    }
}

/// Reads up to `most` bytes, hands them over piece by piece, and returns what has made their fingerprint.
pub fn read_pieces<E>(
    reader: impl Read,
    most: u64,
    unreadable: impl Fn(std::io::Error) -> E,
    mut take: impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<Fingerprinter, E> {
    let mut reader = BufReader::with_capacity(PIECE, reader.take(most));
    let mut printer = Fingerprinter::default();
    loop {
        let piece = match reader.fill_buf() {
            Ok([]) => return Ok(printer),
            Ok(piece) => piece,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) => return Err(unreadable(error)),
        };
        printer.update(piece);
        take(piece)?;
        let count = piece.len();
        reader.consume(count);
    }
}

/// Bytes read at a time.
const PIECE: usize = 1 << 20;

/// A reader that knows the fingerprint of what has been read.
#[derive(Debug)]
pub struct Fingerprinted<R> {
    inner: R,
    printer: Fingerprinter,
}

impl<R> Fingerprinted<R> {
    pub fn new(inner: R) -> Fingerprinted<R> {
        Fingerprinted { inner, printer: Fingerprinter::default() }
    }

    pub fn fingerprint(&self) -> Fingerprint {
        self.printer.fingerprint()
    }
}

impl<R: Read> Read for Fingerprinted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.printer.update(&buffer[..count]);
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `printf 'jointsweep' | xxh128sum`, by the reference implementation.
    #[test]
    fn the_hash_is_that_of_the_reference_implementation() {
        let print = Fingerprint::of(b"");
        assert_eq!((print.bytes, print.hash().as_str()), (0, "99aa06d3014798d86001c324468d497f"));
        let whole = Fingerprint::of(b"jointsweep");
        let mut reader = Fingerprinted::new(&b"jointsweep"[..]);
        let mut piece = [0; 3];
        while reader.read(&mut piece).unwrap() > 0 {}
        assert_eq!(reader.fingerprint(), whole);
        assert_eq!(Fingerprint::parse(10, &whole.hash()), Some(whole));
        assert_ne!(Fingerprint::of(b"jointsweeq"), whole);
    }
    /// Gives a byte at a time, and is interrupted before each.
    struct Slow<'a>(&'a [u8], bool);

    impl Read for Slow<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            self.1 = !self.1;
            if self.1 {
                return Err(ErrorKind::Interrupted.into());
            }
            let least = buffer.len().min(1);
            self.0.read(&mut buffer[..least])
        }
    }

    #[test]
    fn pieces_are_all_that_is_asked_and_no_more() {
        for (most, expected) in [(0, &b""[..]), (5, b"joint"), (10, b"jointsweep"), (u64::MAX, b"jointsweep")]
        {
            let mut taken = Vec::new();
            let take = |piece: &[u8]| {
                taken.extend_from_slice(piece);
                Ok(())
            };
            let printer = read_pieces(Slow(b"jointsweep", false), most, |error| error, take).unwrap();
            assert_eq!(printer.fingerprint(), Fingerprint::of(expected));
            assert_eq!(taken, expected);
        }
    }

    #[test]
    fn a_piece_that_is_not_taken_ends_the_reading() {
        let ended = read_pieces(&b"jointsweep"[..], 10, |_| "unreadable", |_| Err("not taken"));
        assert_eq!(ended.unwrap_err(), "not taken");
    }
}
