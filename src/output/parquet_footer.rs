//! How a Parquet file is made of portions that know nothing of each other.
//!
//! Each portion is a small Parquet file of its own with one row group, and its length (eight bytes, little-endian) behind it. What the
//! whole file ends with is one footer for the row groups of all portions, made by walking from portion to portion from the end. The
//! portions' own footers stay between the row groups, where readers do not look.

use std::fs::File;
use std::io::{Error, Read, Seek, SeekFrom};

use parquet::errors::ParquetError;
use parquet::file::metadata::{
    ColumnChunkMetaData, FileMetaData, KeyValue, ParquetMetaData, ParquetMetaDataOptions,
    ParquetMetaDataReader, ParquetMetaDataWriter, RowGroupMetaData,
};
use parquet::schema::types::SchemaDescPtr;

/// What every Parquet file begins with and ends with.
pub const MAGIC: &[u8; 4] = b"PAR1";

/// Bytes of the length behind a portion.
const LENGTH: u64 = 8;

/// Bytes behind a portion's description: the length of the description, and `MAGIC`.
const TAIL: u64 = 8;

/// A portion of the file from a Parquet file of its own.
pub fn portion(mut file: Vec<u8>) -> Vec<u8> {
    let length = file.len() as u64;
    file.extend_from_slice(&length.to_le_bytes());
    file
}

/// What a file with only `MAGIC` and portions ends with; nothing where it has its end.
pub fn end(file: &mut File, schema: &SchemaDescPtr, about: Vec<KeyValue>) -> std::io::Result<Vec<u8>> {
    let length = file.seek(SeekFrom::End(0))?;
    let start = MAGIC.len() as u64;
    if length > start && read_at::<4>(file, length - start)? == *MAGIC {
        return Ok(Vec::new());
    }
    let options = ParquetMetaDataOptions::new().with_schema(schema.clone());
    let mut row_groups = Vec::new();
    let mut end = length;
    while end > start {
        let broken = || Error::other("its row groups do not follow each other");
        let before = |place: u64, bytes: u64| place.checked_sub(bytes).filter(|place| *place >= start);
        let behind = before(end, LENGTH).ok_or_else(broken)?;
        let first = before(behind, u64::from_le_bytes(read_at(file, behind)?)).ok_or_else(broken)?;
        let tail = before(behind, TAIL).filter(|tail| *tail > first).ok_or_else(broken)?;
        let [a, b, c, d, ..] = read_at::<{ TAIL as usize }>(file, tail)?;
        let description = u64::from(u32::from_le_bytes([a, b, c, d]));
        let place = before(tail, description).filter(|place| *place > first).ok_or_else(broken)?;
        file.seek(SeekFrom::Start(place))?;
        let mut bytes = vec![0; description as usize];
        file.read_exact(&mut bytes)?;
        let own = ParquetMetaDataReader::decode_metadata_with_options(&bytes, Some(&options))
            .map_err(Error::other)?;
        for row_group in own.row_groups().iter().rev() {
            row_groups.push(moved(row_group.clone(), first).map_err(Error::other)?);
        }
        end = first;
    }
    row_groups.reverse();
    footer(row_groups, schema, about).map_err(Error::other)
}

fn read_at<const COUNT: usize>(file: &mut File, place: u64) -> std::io::Result<[u8; COUNT]> {
    let mut bytes = [0; COUNT];
    file.seek(SeekFrom::Start(place))?;
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// A row group whose portion begins at `start` of the file.
fn moved(row_group: RowGroupMetaData, start: u64) -> Result<RowGroupMetaData, ParquetError> {
    let shift = start as i64;
    let chunk = |chunk: &ColumnChunkMetaData| {
        let (data, dictionary) = (chunk.data_page_offset(), chunk.dictionary_page_offset());
        let moved = chunk.clone().into_builder().set_data_page_offset(data + shift);
        moved.set_dictionary_page_offset(dictionary.map(|place| place + shift)).build()
    };
    let chunks: Result<Vec<_>, _> = row_group.columns().iter().map(chunk).collect();
    let place = row_group.file_offset().unwrap_or(0) + shift;
    row_group.into_builder().set_column_metadata(chunks?).set_file_offset(place).build()
}

/// The end of a Parquet file.
pub fn footer(
    row_groups: Vec<RowGroupMetaData>,
    schema: &SchemaDescPtr,
    about: Vec<KeyValue>,
) -> Result<Vec<u8>, ParquetError> {
    let number = |(row_group, place): (RowGroupMetaData, usize)| match i16::try_from(place) {
        Ok(place) => row_group.into_builder().set_ordinal(place.into()).build(),
        // The format numbers no more.
        Err(_) => Ok(row_group),
    };
    let numbered: Result<Vec<_>, _> = row_groups.into_iter().zip(0..).map(number).collect();
    let numbered = numbered?;
    let rows = numbered.iter().map(RowGroupMetaData::num_rows).sum();
    let made_by = concat!("jointsweep ", env!("CARGO_PKG_VERSION"));
    let file = FileMetaData::new(1, rows, Some(made_by.into()), Some(about), schema.clone(), None);
    let mut bytes = Vec::new();
    ParquetMetaDataWriter::new(&mut bytes, &ParquetMetaData::new(file, numbered)).finish()?;
    Ok(bytes)
}
