//! `table.parquet`: one row group a portion. Numbers are the doubles that were computed, not rounded; cells without a value are null.

use std::fs::File;
use std::io::Write;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, KeyValue, RowGroupMetaData};
use parquet::file::writer::TrackedWrite;
use parquet::schema::types::{ColumnDescPtr, SchemaDescPtr, SchemaDescriptor, Type};

use crate::engine::outcome::{BackendKind, DesignOutcome, StepOutcome};
use crate::engine::status::Status;
use crate::output::folder::TABLE_PARQUET;
use crate::output::parquet_chunk::{Cells, ChunkWriter};
use crate::output::parquet_footer::{self, MAGIC};
use crate::output::parquet_runs::Runs;
use crate::output::schema::{Kind, LoadColumn, TableColumn, columns_of, constants_as_json};
use crate::output::sink::Sink;
use crate::study::columns::{Cell, Column};
use crate::study::config::Study;
use crate::study::design::Load;

/// Writes outcomes as row groups.
pub struct ParquetTable {
    columns: Vec<TableColumn>,
    descriptor: SchemaDescPtr,
    /// The load of the first design: lists may have both kinds.
    asked: Option<Load>,
    /// Of the whole file: units and meaning of its columns, and what is the same in all rows and has none.
    about: Vec<KeyValue>,
}

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
        let descriptor = Arc::new(SchemaDescriptor::new(schema));
        let documented = columns.iter().map(|column| {
            let (unit, meaning) = (column.unit, &column.about);
            (column.name.to_string(), serde_json::json!({ "unit": unit, "meaning": meaning }))
        });
        let documented: serde_json::Map<_, _> = documented.collect();
        let json = |key: &str, map| KeyValue::new(key.into(), serde_json::Value::Object(map).to_string());
        let about = vec![json("columns", documented), json("constants", constants_as_json(study))];
        ParquetTable { columns, descriptor, asked: asked_load(study), about }
    }

    /// A Parquet file of its own.
    fn row_group(&self, outcomes: &[DesignOutcome]) -> Result<Vec<u8>, ParquetError> {
        let mut file = TrackedWrite::new(Vec::new());
        file.write_all(MAGIC)?;
        let mut writer = ChunkWriter::new(&mut file)?;
        let columns = self.columns.iter().zip(self.descriptor.columns());
        let chunk = |(column, described): (&TableColumn, &ColumnDescPtr)| {
            self.chunk(&mut writer, described.clone(), column, outcomes)
        };
        let chunks: Vec<ColumnChunkMetaData> = columns.map(chunk).collect::<Result<_, _>>()?;
        let rows = outcomes.iter().map(|outcome| outcome.steps.len() as i64).sum();
        let row_group = RowGroupMetaData::builder(self.descriptor.clone())
            .set_num_rows(rows)
            .set_total_byte_size(chunks.iter().map(ColumnChunkMetaData::uncompressed_size).sum())
            .set_column_metadata(chunks)
            .set_file_offset(MAGIC.len() as i64)
            .build()?;
        let mut file = file.into_inner()?;
        file.extend(parquet_footer::footer(vec![row_group], &self.descriptor, Vec::new())?);
        Ok(file)
    }

    fn chunk(
        &self,
        writer: &mut ChunkWriter,
        described: ColumnDescPtr,
        column: &TableColumn,
        outcomes: &[DesignOutcome],
    ) -> Result<ColumnChunkMetaData, ParquetError> {
        let is_asked = |own: LoadColumn| self.asked.is_some_and(|load| (own.asked)(load).is_some());
        match column.kind {
            Kind::Design => {
                let rows = |outcome: &DesignOutcome| {
                    std::iter::repeat_n(outcome.case.index as i64, outcome.steps.len())
                };
                let designs: Vec<i64> = outcomes.iter().flat_map(rows).collect();
                writer.write_all(described, &designs, &Runs::default(), designs.len())
            }
            Kind::Input(input) if input.is_number() => {
                writer.write(described, &numbers_of_designs(input, outcomes))
            }
            Kind::Input(input) => writer.write(described, &words_of_designs(input, outcomes)),
            Kind::Load(own) if is_asked(own) => writer.write(described, &asked_loads(own, outcomes)),
            Kind::Load(_) | Kind::Result(_) => {
                let (mut numbers, mut levels, mut rows) = (Vec::new(), Runs::default(), 0);
                each_step(outcomes, |load, step, _| {
                    let number = number(column.kind, load, step);
                    levels.push(u32::from(number.is_some()), 1);
                    numbers.extend(number);
                    rows += 1;
                });
                writer.write_all(described, &numbers, &levels, rows)
            }
            Kind::Word(_) | Kind::Status => writer.write(described, &words(column.kind, outcomes)),
        }
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

fn asked_load(study: &Study) -> Option<Load> {
    let first = study.cases().ok()?.next()?.ok()?;
    first.steps.first().copied()
}

/// Those of an input, which the rows of a design share.
fn numbers_of_designs(input: Column, outcomes: &[DesignOutcome]) -> Cells<f64> {
    let mut cells = Cells::default();
    for outcome in outcomes {
        match input.cell(&outcome.case.joint) {
            Cell::Number(number) => cells.follow(number, outcome.steps.len()),
            _ => cells.skip(outcome.steps.len()),
        }
    }
    cells
}

fn words_of_designs(input: Column, outcomes: &[DesignOutcome]) -> Cells<ByteArray> {
    let mut cells = Cells::default();
    for outcome in outcomes {
        let cell = input.cell(&outcome.case.joint);
        push_word(&mut cells, if let Cell::Word(word) = cell { word } else { "" }, outcome.steps.len());
    }
    cells
}

/// A word in so many cells; an empty one is none. Columns have a few different ones.
fn push_word(cells: &mut Cells<ByteArray>, word: &str, times: usize) {
    if word.is_empty() {
        return cells.skip(times);
    }
    match cells.entries().iter().position(|entry| entry.data() == word.as_bytes()) {
        Some(place) => cells.again(place, times),
        None => _ = cells.repeat(word.into(), times, None),
    }
}

/// Those of the load that is asked: most designs have those of the design before.
fn asked_loads(own: LoadColumn, outcomes: &[DesignOutcome]) -> Cells<f64> {
    let (mut cells, mut before, mut places) = (Cells::default(), Vec::new(), Vec::new());
    for outcome in outcomes {
        std::mem::swap(&mut before, &mut places);
        places.clear();
        for (place, (load, step)) in outcome.case.steps.iter().zip(&outcome.steps).enumerate() {
            match number(Kind::Load(own), *load, step) {
                Some(number) => places.push(cells.repeat(number, 1, before.get(place).copied())),
                None => {
                    cells.skip(1);
                    places.push(usize::MAX);
                }
            }
        }
    }
    cells
}

/// Those of words that come of load steps.
fn words(kind: Kind, outcomes: &[DesignOutcome]) -> Cells<ByteArray> {
    let mut cells = Cells::default();
    each_step(outcomes, |_, step, backend| match kind {
        Kind::Word(word) => push_word(&mut cells, word(step, backend), 1),
        _ if step.status == Status::OK => push_word(&mut cells, "ok", 1),
        _ => push_word(&mut cells, &step.status.to_string(), 1),
    });
    cells
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
