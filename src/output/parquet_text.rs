//! A `table.parquet` read as the text of a `table.csv` with all digits: one reader of rows serves every kind of table.

use std::fs::File;
use std::io::{Error, Read};
use std::path::Path;

use parquet::basic::Type as Physical;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};

use crate::output::number::push_exact;
use crate::output::table::push_text;

/// Rows made text at a time.
const ROWS: usize = 1024;

/// The text of such a file, as it is read.
pub struct ParquetText {
    file: SerializedFileReader<File>,
    next_row_group: usize,
    columns: Vec<Box<dyn Cells>>,
    /// Rows of the row group that are not read.
    left: usize,
    text: Vec<u8>,
    /// Of the text, what was handed over.
    read: usize,
}

/// The text of such a file.
pub fn open_text(path: &Path) -> std::io::Result<Box<dyn Read + Send>> {
    let file = SerializedFileReader::new(File::open(path)?).map_err(Error::other)?;
    let schema = file.metadata().file_metadata().schema_descr();
    let names: Vec<&str> = schema.columns().iter().map(|column| column.name()).collect();
    let text = format!("{}\n", names.join(",")).into();
    Ok(Box::new(ParquetText { file, next_row_group: 0, columns: Vec::new(), left: 0, text, read: 0 }))
}

impl ParquetText {
    /// Makes the next text; none at the end.
    fn advance(&mut self) -> Result<(), ParquetError> {
        self.text.clear();
        self.read = 0;
        while self.left == 0 {
            if self.next_row_group == self.file.num_row_groups() {
                return Ok(());
            }
            let row_group = self.file.get_row_group(self.next_row_group)?;
            let open = |place: usize| cells(row_group.get_column_reader(place)?);
            self.columns = (0..row_group.num_columns()).map(open).collect::<Result<_, _>>()?;
            self.left = usize::try_from(row_group.metadata().num_rows()).unwrap_or(0);
            self.next_row_group += 1;
        }
        let rows = self.left.min(ROWS);
        self.columns.iter_mut().try_for_each(|column| column.read(rows))?;
        for row in 0..rows {
            for column in &mut self.columns {
                column.push(row, &mut self.text);
                self.text.push(b',');
            }
            self.text.pop();
            self.text.push(b'\n');
        }
        self.left -= rows;
        Ok(())
    }
}

impl Read for ParquetText {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.read == self.text.len() {
            self.advance().map_err(Error::other)?;
        }
        let count = buffer.len().min(self.text.len() - self.read);
        buffer[..count].copy_from_slice(&self.text[self.read..self.read + count]);
        self.read += count;
        Ok(count)
    }
}

/// A column of a row group.
trait Cells: Send {
    /// Reads the cells of the next rows.
    fn read(&mut self, rows: usize) -> Result<(), ParquetError>;

    /// Appends the text of the cell of one of these rows, each once and in their order.
    fn push(&mut self, row: usize, text: &mut Vec<u8>);
}

fn cells(reader: ColumnReader) -> Result<Box<dyn Cells>, ParquetError> {
    Ok(match reader {
        ColumnReader::Int64ColumnReader(reader) => {
            Box::new(Typed::<Int64Type>::new(reader, |number, text| text.extend(number.to_string().bytes())))
        }
        ColumnReader::DoubleColumnReader(reader) => {
            // A number that is none is refused as text, with its row.
            Box::new(Typed::<DoubleType>::new(reader, |number, text| match number.is_finite() {
                true => push_exact(text, *number),
                false => text.extend(number.to_string().bytes()),
            }))
        }
        ColumnReader::ByteArrayColumnReader(reader) => {
            Box::new(Typed::<ByteArrayType>::new(reader, |word, text| {
                push_text(text, &String::from_utf8_lossy(word.data()))
            }))
        }
        _ => {
            let kinds =
                [Physical::INT64, Physical::DOUBLE, Physical::BYTE_ARRAY].map(|kind| kind.to_string());
            return Err(ParquetError::General(format!("a column is none of {}", kinds.join(", "))));
        }
    })
}

struct Typed<T: DataType> {
    reader: ColumnReaderImpl<T>,
    push: fn(&T::T, &mut Vec<u8>),
    values: Vec<T::T>,
    /// Of each row, whether it has a value (1); empty where all have.
    levels: Vec<i16>,
    next: usize,
}

impl<T: DataType> Typed<T> {
    fn new(reader: ColumnReaderImpl<T>, push: fn(&T::T, &mut Vec<u8>)) -> Typed<T> {
        Typed { reader, push, values: Vec::new(), levels: Vec::new(), next: 0 }
    }
}

impl<T: DataType> Cells for Typed<T> {
    fn read(&mut self, rows: usize) -> Result<(), ParquetError> {
        self.values.clear();
        self.levels.clear();
        self.next = 0;
        let (found, ..) = self.reader.read_records(rows, Some(&mut self.levels), None, &mut self.values)?;
        if found != rows {
            return Err(ParquetError::EOF("a column ends before the others".into()));
        }
        Ok(())
    }

    fn push(&mut self, row: usize, text: &mut Vec<u8>) {
        if self.levels.get(row).is_some_and(|level| *level == 0) {
            return;
        }
        if let Some(value) = self.values.get(self.next) {
            (self.push)(value, text);
        }
        self.next += 1;
    }
}
