//! A Parquet file, written one row group at a time.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriterImpl;
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError as Package;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use super::values::ValueKind;

/// Program that wrote a file.
const WRITER: &str = concat!("phihat version ", env!("CARGO_PKG_VERSION"));

/// Physical and logical type that the format stores for a kind of column.
fn physical(kind: ValueKind) -> (Physical, Option<LogicalType>) {
    match kind {
        ValueKind::Integers => (Physical::INT64, None),
        ValueKind::Numbers => (Physical::DOUBLE, None),
        ValueKind::Flags => (Physical::BOOLEAN, None),
        ValueKind::Texts => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
    }
}

/// A file on its way: its columns are known, and row groups come one after the other.
pub(crate) struct TableWriter<W: Write + Send> {
    file: SerializedFileWriter<W>,
}

impl<W: Write + Send> TableWriter<W> {
    /// Begins a file.
    pub(crate) fn begin(out: W, columns: &[(&str, ValueKind)]) -> io::Result<Self> {
        let schema = schema(columns).map_err(io::Error::other)?;
        let properties = Arc::new(properties(columns));
        let file = SerializedFileWriter::new(out, schema, properties).map_err(io::Error::other)?;
        Ok(Self { file })
    }

    /// Writes a row group, column by column.
    pub(crate) fn group(
        &mut self,
        each: impl FnOnce(&mut GroupWriter<'_, W>) -> Result<(), Package>,
    ) -> io::Result<()> {
        let written = self.file.next_row_group().and_then(|rows| {
            let mut group = GroupWriter { rows };
            each(&mut group)?;
            group.rows.close()
        });
        written.map(drop).map_err(io::Error::other)
    }

    /// Writes the end of the file; the writer, back.
    pub(crate) fn finish(self) -> io::Result<W> {
        self.file.into_inner().map_err(io::Error::other)
    }
}

/// A row group on its way.
pub(crate) struct GroupWriter<'a, W: Write + Send> {
    rows: SerializedRowGroupWriter<'a, W>,
}

impl<W: Write + Send> GroupWriter<'_, W> {
    /// The next column: whole numbers.
    pub(crate) fn integers(&mut self, values: &[i64]) -> Result<(), Package> {
        self.column::<Int64Type>(values)
    }

    /// The next column: numbers.
    pub(crate) fn numbers(&mut self, values: &[f64]) -> Result<(), Package> {
        self.column::<DoubleType>(values)
    }

    /// The next column: flags.
    pub(crate) fn flags(&mut self, values: &[bool]) -> Result<(), Package> {
        self.column::<BoolType>(values)
    }

    /// The next column: texts.
    pub(crate) fn texts(&mut self, values: &[ByteArray]) -> Result<(), Package> {
        self.column::<ByteArrayType>(values)
    }

    fn column<T: DataType>(&mut self, values: &[T::T]) -> Result<(), Package> {
        let Some(mut column) = self.rows.next_column()? else {
            return Err(Package::General("a row group has more columns than the file".to_owned()));
        };
        let typed: &mut ColumnWriterImpl<'_, T> = column.typed::<T>();
        typed.write_batch(values, None, None)?;
        column.close()
    }
}

fn schema(columns: &[(&str, ValueKind)]) -> Result<TypePtr, Package> {
    let field = |(name, kind): &(&str, ValueKind)| {
        let (physical, logical) = physical(*kind);
        Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical)
            .build()
            .map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Ok(Arc::new(Type::group_type_builder("trace").with_fields(fields).build()?))
}

/// Numbers are encoded by `BYTE_STREAM_SPLIT`: the k-th bytes of all numbers are adjacent, and those that
/// hardly change compress well; texts are few, and in a dictionary. There are no statistics: no reader looks
/// for rows of a trace by their values.
fn properties(columns: &[(&str, ValueKind)]) -> WriterProperties {
    let mut properties = WriterProperties::builder()
        .set_created_by(WRITER.to_owned())
        .set_compression(Compression::SNAPPY)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_offset_index_disabled(true)
        .set_data_page_row_count_limit(usize::MAX)
        .set_dictionary_enabled(false);
    for (name, kind) in columns {
        let path = || (*name).into();
        properties = match kind {
            ValueKind::Integers | ValueKind::Flags => {
                properties.set_column_encoding(path(), Encoding::PLAIN)
            }
            ValueKind::Numbers => {
                properties.set_column_encoding(path(), Encoding::BYTE_STREAM_SPLIT)
            }
            ValueKind::Texts => properties.set_column_dictionary_enabled(path(), true),
        };
    }
    properties.build()
}
