//! The pages of a Parquet column in one row group: a dictionary and the places in it where values repeat, else the values themselves.
//!
//! Made here and not by the writer of the `parquet` crate, which looks up the value of each row: rows of a design share most of theirs,
//! so that it is enough to compare with the design before.

use parquet::basic::{Compression, Encoding, PageType, ZstdLevel};
use parquet::column::page::{CompressedPage, Page, PageWriteSpec, PageWriter};
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, PageEncodingStats};
use parquet::file::statistics::Statistics;
use parquet::file::writer::{SerializedPageWriter, TrackedWrite};
use parquet::schema::types::ColumnDescPtr;
use zstd::bulk::Compressor;

use super::parquet_runs::{Runs, bits_of, put_differences};

/// Higher levels take more time and save nothing worth it: the last digits of results are noise to a compressor.
const LEVEL: i32 = 1;

/// What a column has values of.
pub trait Value: Clone + PartialEq {
    /// How values are written where they do not repeat.
    const ENCODING: Encoding;

    /// Appends values by `ENCODING`.
    fn put(values: &[Self], bytes: &mut Vec<u8>);

    /// The least and the greatest, with the number of cells without a value.
    fn statistics(values: &[Self], empty: u64) -> Statistics;
}

/// What may stand in a dictionary.
pub trait Repeated: Value {
    /// Appends values as dictionaries have them.
    fn put_plain(values: &[Self], bytes: &mut Vec<u8>);
}

impl Value for i64 {
    const ENCODING: Encoding = Encoding::DELTA_BINARY_PACKED;

    fn put(values: &[i64], bytes: &mut Vec<u8>) {
        put_differences(values, bytes);
    }

    fn statistics(values: &[i64], empty: u64) -> Statistics {
        let (least, greatest) = (values.iter().min(), values.iter().max());
        Statistics::int64(least.copied(), greatest.copied(), None, Some(empty), false)
    }
}

impl Value for f64 {
    /// Bytes sorted by significance, which makes files of many digits a twentieth smaller.
    const ENCODING: Encoding = Encoding::BYTE_STREAM_SPLIT;

    fn put(values: &[f64], bytes: &mut Vec<u8>) {
        for byte in 0..size_of::<f64>() {
            bytes.extend(values.iter().map(|value| value.to_le_bytes()[byte]));
        }
    }

    fn statistics(values: &[f64], empty: u64) -> Statistics {
        let mut ends: Option<[f64; 2]> = None;
        for value in values.iter().filter(|value| !value.is_nan()) {
            let [least, greatest] = ends.unwrap_or([*value; 2]);
            ends = Some([least.min(*value), greatest.max(*value)]);
        }
        // Zero has either sign.
        let least = ends.map(|[least, _]| if least == 0.0 { -0.0 } else { least });
        let greatest = ends.map(|[_, greatest]| if greatest == 0.0 { 0.0 } else { greatest });
        Statistics::double(least, greatest, None, Some(empty), false)
    }
}

impl Repeated for f64 {
    fn put_plain(values: &[f64], bytes: &mut Vec<u8>) {
        values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    }
}

/// Words: a short text each.
impl Value for ByteArray {
    const ENCODING: Encoding = Encoding::PLAIN;

    fn put(values: &[ByteArray], bytes: &mut Vec<u8>) {
        ByteArray::put_plain(values, bytes);
    }

    fn statistics(values: &[ByteArray], empty: u64) -> Statistics {
        let least = values.iter().min_by_key(|value| value.data());
        let greatest = values.iter().max_by_key(|value| value.data());
        Statistics::byte_array(least.cloned(), greatest.cloned(), None, Some(empty), false)
    }
}

impl Repeated for ByteArray {
    fn put_plain(values: &[ByteArray], bytes: &mut Vec<u8>) {
        for value in values {
            bytes.extend((value.len() as u32).to_le_bytes());
            bytes.extend(value.data());
        }
    }
}

/// The cells of a column, row by row.
pub struct Cells<V> {
    /// Values that differ from those they were compared with.
    entries: Vec<V>,
    /// Of each the place of the one that followed it last.
    followers: Vec<usize>,
    /// The place of the value before.
    last: usize,
    /// Of cells that have a value, its place among these.
    places: Runs,
    /// Whether cells have one (1 or 0).
    levels: Runs,
    rows: usize,
    /// Of these, those without a value.
    empty: usize,
}

impl<V> Default for Cells<V> {
    fn default() -> Cells<V> {
        Cells {
            entries: Vec::new(),
            followers: Vec::new(),
            last: 0,
            places: Runs::default(),
            levels: Runs::default(),
            rows: 0,
            empty: 0,
        }
    }
}

impl<V: Repeated> Cells<V> {
    /// The values a dictionary would have.
    pub fn entries(&self) -> &[V] {
        &self.entries
    }

    /// So many cells without a value.
    pub fn skip(&mut self, times: usize) {
        self.levels.push(0, times);
        (self.rows, self.empty) = (self.rows + times, self.empty + times);
    }

    /// The same value in so many cells; it may be the one at a place among the entries. Gives back its place.
    pub fn repeat(&mut self, value: V, times: usize, known: Option<usize>) -> usize {
        let known = known.filter(|place| self.entries.get(*place) == Some(&value));
        let place = known.unwrap_or_else(|| {
            self.entries.push(value);
            self.followers.push(0);
            self.entries.len() - 1
        });
        self.again(place, times);
        place
    }

    /// The value at a place among the entries in so many cells.
    pub fn again(&mut self, place: usize, times: usize) {
        self.levels.push(1, times);
        self.rows += times;
        self.places.push(place as u32, times);
    }

    /// The same as the value before, or the one that followed that before, as in grids, or another one.
    pub fn follow(&mut self, value: V, times: usize) {
        let is_same = self.entries.get(self.last) == Some(&value);
        let known = if is_same { Some(self.last) } else { self.followers.get(self.last).copied() };
        let place = self.repeat(value, times, known);
        if !is_same {
            self.followers[self.last] = place;
        }
        self.last = place;
    }
}

/// Writes the chunks of a row group, one after the other.
pub struct ChunkWriter<'a> {
    file: &'a mut TrackedWrite<Vec<u8>>,
    compressor: Compressor<'static>,
    /// Of a page before it is compressed.
    bytes: Vec<u8>,
}

/// A dictionary is worth it where there are so many cells at least for each of its values.
const REPEATED: usize = 2;

impl<'a> ChunkWriter<'a> {
    pub fn new(file: &'a mut TrackedWrite<Vec<u8>>) -> Result<ChunkWriter<'a>, ParquetError> {
        Ok(ChunkWriter { file, compressor: Compressor::new(LEVEL)?, bytes: Vec::new() })
    }

    /// Cells of values that repeat.
    pub fn write<V: Repeated>(
        &mut self,
        column: ColumnDescPtr,
        cells: &Cells<V>,
    ) -> Result<ColumnChunkMetaData, ParquetError> {
        let Cells { entries, places, levels, rows, empty, .. } = cells;
        if REPEATED * entries.len() > rows - empty {
            let values: Vec<V> = places.numbers().map(|place| entries[place as usize].clone()).collect();
            return self.write_all(column, &values, levels, *rows);
        }
        self.bytes.clear();
        V::put_plain(entries, &mut self.bytes);
        let count = entries.len() as u32;
        let page = |buf: Vec<u8>| Page::DictionaryPage {
            buf: buf.into(),
            num_values: count,
            encoding: Encoding::PLAIN,
            is_sorted: false,
        };
        let dictionary = self.page(page)?;
        self.put_levels(&column, levels);
        let bits = bits_of(count.saturating_sub(1));
        self.bytes.push(bits as u8);
        places.encode(bits, &mut self.bytes);
        let data = self.data_page(*rows, Encoding::RLE_DICTIONARY)?;
        let statistics = V::statistics(entries, *empty as u64);
        chunk(column, *rows, statistics, Some(dictionary), (data, Encoding::RLE_DICTIONARY))
    }

    /// Cells whose values hardly repeat: these, and whether each of so many has one.
    pub fn write_all<V: Value>(
        &mut self,
        column: ColumnDescPtr,
        values: &[V],
        levels: &Runs,
        rows: usize,
    ) -> Result<ColumnChunkMetaData, ParquetError> {
        self.put_levels(&column, levels);
        V::put(values, &mut self.bytes);
        let data = self.data_page(rows, V::ENCODING)?;
        let statistics = V::statistics(values, (rows - values.len()) as u64);
        chunk(column, rows, statistics, None, (data, V::ENCODING))
    }

    /// Begins a data page. A column that has a value in each row has no levels.
    fn put_levels(&mut self, column: &ColumnDescPtr, levels: &Runs) {
        self.bytes.clear();
        if column.max_def_level() > 0 {
            self.bytes.extend([0; size_of::<u32>()]);
            levels.encode(1, &mut self.bytes);
            let length = (self.bytes.len() - size_of::<u32>()) as u32;
            self.bytes[..size_of::<u32>()].copy_from_slice(&length.to_le_bytes());
        }
    }

    fn data_page(&mut self, rows: usize, encoding: Encoding) -> Result<PageWriteSpec, ParquetError> {
        let num_values = u32::try_from(rows).map_err(|error| ParquetError::External(error.into()))?;
        self.page(|buf| Page::DataPage {
            buf: buf.into(),
            num_values,
            encoding,
            def_level_encoding: Encoding::RLE,
            rep_level_encoding: Encoding::RLE,
            statistics: None,
        })
    }

    /// Writes the page of what is in `bytes`.
    fn page(&mut self, page: impl FnOnce(Vec<u8>) -> Page) -> Result<PageWriteSpec, ParquetError> {
        let compressed = self.compressor.compress(&self.bytes)?;
        let page = CompressedPage::new(page(compressed), self.bytes.len());
        SerializedPageWriter::new(&mut *self.file).write_page(page)
    }
}

fn chunk(
    column: ColumnDescPtr,
    rows: usize,
    statistics: Statistics,
    dictionary: Option<PageWriteSpec>,
    (data, encoding): (PageWriteSpec, Encoding),
) -> Result<ColumnChunkMetaData, ParquetError> {
    let pages = || dictionary.iter().chain([&data]);
    let count = |page_type, encoding| PageEncodingStats { page_type, encoding, count: 1 };
    let of_dictionary = dictionary.as_ref().map(|_| count(PageType::DICTIONARY_PAGE, Encoding::PLAIN));
    let counts: Vec<PageEncodingStats> =
        of_dictionary.into_iter().chain([count(PageType::DATA_PAGE, encoding)]).collect();
    let mut encodings: Vec<Encoding> = counts.iter().map(|count| count.encoding).collect();
    encodings.push(Encoding::RLE);
    ColumnChunkMetaData::builder(column)
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(LEVEL)?))
        .set_encodings(encodings)
        .set_page_encoding_stats(counts)
        .set_num_values(rows as i64)
        .set_total_compressed_size(pages().map(|page| page.compressed_size as i64).sum())
        .set_total_uncompressed_size(pages().map(|page| page.uncompressed_size as i64).sum())
        .set_dictionary_page_offset(dictionary.as_ref().map(|page| page.offset as i64))
        .set_data_page_offset(data.offset as i64)
        .set_statistics(statistics)
        .build()
}
