//! `table.parquet`: one row group a portion. Numbers are the doubles that were computed, not rounded; cells without a value are null.

use std::fs::File;
use std::sync::Arc;

use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical, ZstdLevel};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesPtr};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, SchemaDescPtr, SchemaDescriptor, Type, TypePtr};

use crate::engine::outcome::{BackendKind, DesignOutcome, StepOutcome};
use crate::engine::status::Status;
use crate::output::folder::TABLE_PARQUET;
use crate::output::parquet_footer::{self, MAGIC};
use crate::output::schema::{Kind, LoadColumn, TableColumn, columns_of, constants_as_json};
use crate::output::sink::Sink;
use crate::study::columns::{Cell, Column};
use crate::study::config::Study;
use crate::study::design::Load;

/// Writes outcomes as row groups.
pub struct ParquetTable {
    columns: Vec<TableColumn>,
    schema: TypePtr,
    descriptor: SchemaDescPtr,
    properties: WriterPropertiesPtr,
    /// Of the whole file: units and meaning of its columns, and what is the same in all rows and has none.
    about: Vec<KeyValue>,
}

/// Higher levels take more time and save nothing worth it: the last digits of results are noise to a compressor.
const LEVEL: i32 = 1;

/// What is in a column.
enum Content {
    Whole,
    Number,
    Word,
}

fn content(column: &TableColumn) -> Content {
    match column.kind {
        Kind::Design => Content::Whole,
        Kind::Load(_) | Kind::Result(_) => Content::Number,
        Kind::Input(input) if input.is_number() => Content::Number,
        Kind::Input(_) | Kind::Word(_) | Kind::Status => Content::Word,
    }
}

impl ParquetTable {
    /// As the study asks for it.
    pub fn of(study: &Study) -> ParquetTable {
        let columns = columns_of(study);
        let schema = Arc::new(schema(&columns).expect("the columns have names of their own"));
        let descriptor = Arc::new(SchemaDescriptor::new(schema.clone()));
        let documented = columns.iter().map(|column| {
            let (unit, meaning) = (column.unit, &column.about);
            (column.name.to_string(), serde_json::json!({ "unit": unit, "meaning": meaning }))
        });
        let documented: serde_json::Map<_, _> = documented.collect();
        let json = |key: &str, map| KeyValue::new(key.into(), serde_json::Value::Object(map).to_string());
        let about = vec![json("columns", documented), json("constants", constants_as_json(study))];
        let properties = Arc::new(properties(&columns, asked_load(study)));
        ParquetTable { columns, schema, descriptor, properties, about }
    }

    fn row_group(&self, outcomes: &[DesignOutcome]) -> Result<Vec<u8>, ParquetError> {
        let mut file = SerializedFileWriter::new(Vec::new(), self.schema.clone(), self.properties.clone())?;
        let mut row_group = file.next_row_group()?;
        for column in &self.columns {
            if let Some(writer) = row_group.next_column()? {
                write_column(writer, column, outcomes)?;
            }
        }
        row_group.close()?;
        file.into_inner()
    }
}

impl Sink for ParquetTable {
    fn file_name(&self) -> &'static str {
        TABLE_PARQUET
    }

    fn header(&self) -> Vec<u8> {
        MAGIC.to_vec()
    }

    fn rows(&self, outcomes: &[DesignOutcome]) -> Vec<u8> {
        if outcomes.iter().all(|outcome| outcome.steps.is_empty()) {
            return Vec::new();
        }
        parquet_footer::portion(self.row_group(outcomes).expect("a Vec takes every row group"))
    }

    fn end(&self, file: &mut File) -> std::io::Result<Vec<u8>> {
        parquet_footer::end(file, &self.descriptor, self.about.clone())
    }
}

fn schema(columns: &[TableColumn]) -> Result<Type, ParquetError> {
    let field = |column: &TableColumn| {
        let kind = match content(column) {
            Content::Whole => Physical::INT64,
            Content::Number => Physical::DOUBLE,
            Content::Word => Physical::BYTE_ARRAY,
        };
        let text = matches!(content(column), Content::Word).then_some(LogicalType::String);
        let repetition = match column.kind {
            Kind::Design | Kind::Status => Repetition::REQUIRED,
            _ => Repetition::OPTIONAL,
        };
        let field = Type::primitive_type_builder(&column.name, kind).with_logical_type(text);
        field.with_repetition(repetition).build().map(Arc::new)
    };
    let fields: Result<Vec<_>, _> = columns.iter().map(field).collect();
    Type::group_type_builder("table").with_fields(fields?).build()
}

/// The load of the first design: lists may have both kinds.
fn asked_load(study: &Study) -> Option<Load> {
    let first = study.cases().ok()?.next()?.ok()?;
    first.steps.first().copied()
}

/// Dictionaries where values repeat: the inputs, the load that is asked, words. Results hardly do; their bytes are sorted by
/// significance, which makes files of many digits a twentieth smaller than plain ones.
fn properties(columns: &[TableColumn], asked: Option<Load>) -> WriterProperties {
    let is_asked = |own: LoadColumn| asked.is_some_and(|load| (own.asked)(load).is_some());
    let level = ZstdLevel::try_new(LEVEL).expect("a level of Zstandard");
    let mut builder = WriterProperties::builder()
        .set_created_by(concat!("jointsweep ", env!("CARGO_PKG_VERSION")).into())
        .set_compression(Compression::ZSTD(level))
        .set_offset_index_disabled(true)
        .set_statistics_enabled(parquet::file::properties::EnabledStatistics::Chunk);
    for column in columns {
        let path = ColumnPath::from(column.name.as_ref());
        builder = match column.kind {
            Kind::Design => builder
                .set_column_dictionary_enabled(path.clone(), false)
                .set_column_encoding(path, Encoding::DELTA_BINARY_PACKED),
            Kind::Load(own) if is_asked(own) => builder,
            Kind::Load(_) | Kind::Result(_) => builder
                .set_column_dictionary_enabled(path.clone(), false)
                .set_column_encoding(path, Encoding::BYTE_STREAM_SPLIT),
            _ => builder,
        };
    }
    builder.build()
}

/// The cells of a column, row by row.
fn write_column(
    mut writer: SerializedColumnWriter,
    column: &TableColumn,
    outcomes: &[DesignOutcome],
) -> Result<(), ParquetError> {
    match content(column) {
        Content::Whole => {
            let rows =
                |outcome: &DesignOutcome| std::iter::repeat_n(outcome.case.index as i64, outcome.steps.len());
            let designs: Vec<i64> = outcomes.iter().flat_map(rows).collect();
            writer.typed::<Int64Type>().write_batch(&designs, None, None)?;
        }
        Content::Number => {
            let mut numbers = Cells::of(outcomes);
            match column.kind {
                Kind::Input(input) => each_input(input, outcomes, |cell, times| {
                    numbers.repeat(if let Cell::Number(number) = cell { Some(number) } else { None }, times);
                }),
                kind => each_step(outcomes, |load, step, _| numbers.push(number(kind, load, step))),
            }
            writer.typed::<DoubleType>().write_batch(&numbers.values, Some(&numbers.levels), None)?;
        }
        Content::Word => {
            let (mut words, mut known) = (Cells::of(outcomes), Known::default());
            match column.kind {
                Kind::Input(input) => each_input(input, outcomes, |cell, times| {
                    words.repeat(known.bytes(if let Cell::Word(word) = cell { word } else { "" }), times);
                }),
                Kind::Word(word) => {
                    each_step(outcomes, |_, step, backend| words.push(known.bytes(word(step, backend))));
                }
                _ => each_step(outcomes, |_, step, _| {
                    let is_ok = step.status == Status::OK;
                    let word = if is_ok { known.bytes("ok") } else { known.bytes(&step.status.to_string()) };
                    words.push(word);
                }),
            }
            // A column that has a word in each row has no levels.
            let levels = (!matches!(column.kind, Kind::Status)).then_some(&*words.levels);
            writer.typed::<ByteArrayType>().write_batch(&words.values, levels, None)?;
        }
    }
    writer.close()
}

/// What is written of a column: its values, and of each row whether it has one (1 or 0).
struct Cells<T> {
    values: Vec<T>,
    levels: Vec<i16>,
}

impl<T: Clone> Cells<T> {
    /// With room for the rows of all outcomes.
    fn of(outcomes: &[DesignOutcome]) -> Cells<T> {
        let rows = outcomes.iter().map(|outcome| outcome.steps.len()).sum();
        Cells { values: Vec::with_capacity(rows), levels: Vec::with_capacity(rows) }
    }

    fn push(&mut self, value: Option<T>) {
        self.levels.push(i16::from(value.is_some()));
        self.values.extend(value);
    }

    /// The same in so many rows.
    fn repeat(&mut self, value: Option<T>, times: usize) {
        self.levels.extend(std::iter::repeat_n(i16::from(value.is_some()), times));
        if let Some(value) = value {
            self.values.extend(std::iter::repeat_n(value, times));
        }
    }
}

/// Words that rows share without copies.
#[derive(Default)]
struct Known {
    last: Option<(String, ByteArray)>,
}

impl Known {
    /// `None` for an empty word.
    fn bytes(&mut self, word: &str) -> Option<ByteArray> {
        if word.is_empty() {
            return None;
        }
        match &self.last {
            Some((last, bytes)) if last == word => Some(bytes.clone()),
            _ => {
                let bytes = ByteArray::from(word);
                self.last = Some((word.to_string(), bytes.clone()));
                Some(bytes)
            }
        }
    }
}

/// The cell of an input in each design, with how many rows have it.
fn each_input(input: Column, outcomes: &[DesignOutcome], mut push: impl FnMut(Cell, usize)) {
    outcomes.iter().for_each(|outcome| push(input.cell(&outcome.case.joint), outcome.steps.len()));
}

fn each_step(outcomes: &[DesignOutcome], mut push: impl FnMut(Load, &StepOutcome, BackendKind)) {
    for outcome in outcomes {
        let steps = outcome.case.steps.iter().zip(&outcome.steps);
        steps.for_each(|(load, step)| push(*load, step, outcome.backend));
    }
}

/// What comes of a load step.
fn number(kind: Kind, load: Load, step: &StepOutcome) -> Option<f64> {
    match kind {
        Kind::Load(own) => (own.asked)(load).or_else(|| step.response.as_ref().map(own.found)),
        Kind::Result(value) => step.response.as_ref().and_then(value),
        _ => None,
    }
}
