//! The trace as Parquet: the rows and columns of the CSV file, typed and compressed.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{Type, TypePtr};

use crate::trace::{COLUMNS, JointTrace, Trace};

/// A trace that is written as Parquet as it comes: `t_ns, joint, q_rad, …, saturated, rate_limited`, one row per sample
/// and joint, one row group per block.
#[expect(missing_debug_implementations, reason = "the package's writer has none")]
pub struct ParquetTrace<W: Write + Send> {
    file: SerializedFileWriter<W>,
}

impl<W: Write + Send> ParquetTrace<W> {
    /// A writer before its first block.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn new(writer: W) -> Result<Self, ParquetError> {
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
        Ok(Self { file: SerializedFileWriter::new(writer, schema()?, Arc::new(properties))? })
    }

    /// Writes the next samples.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn block(&mut self, trace: &Trace) -> Result<(), ParquetError> {
        let mut rows = self.file.next_row_group()?;
        let t_ns: Vec<i64> = trace.rows(|_, k| i64::try_from(trace.t_ns[k]).unwrap_or(i64::MAX));
        column::<Int64Type, _>(&mut rows, &t_ns)?;
        let names: Vec<ByteArray> =
            trace.joints.iter().map(|j| ByteArray::from(j.name.as_str())).collect();
        let repeated: Vec<ByteArray> = (0..trace.len()).flat_map(|_| names.clone()).collect();
        column::<ByteArrayType, _>(&mut rows, &repeated)?;
        for signal in &COLUMNS {
            column::<DoubleType, _>(&mut rows, &trace.rows(|j, k| (signal.get)(j)[k]))?;
        }
        column::<BoolType, _>(&mut rows, &trace.rows(|j, k| j.saturated[k]))?;
        column::<BoolType, _>(&mut rows, &trace.rows(|j, k| j.rate_limited[k]))?;
        rows.close()?;
        Ok(())
    }

    /// Closes the file; the writer, back.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn finish(self) -> Result<W, ParquetError> {
        self.file.into_inner()
    }
}

impl Trace {
    /// Writes the trace as Parquet, in one row group; see [`ParquetTrace`].
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn write_parquet(&self, writer: impl Write + Send) -> Result<(), ParquetError> {
        let mut file = ParquetTrace::new(writer)?;
        file.block(self)?;
        file.finish().map(drop)
    }

    /// One value per row, in the order of the rows.
    fn rows<T>(&self, value: impl Fn(&JointTrace, usize) -> T) -> Vec<T> {
        let mut rows = Vec::with_capacity(self.len() * self.joints.len());
        for k in 0..self.len() {
            rows.extend(self.joints.iter().map(|joint| value(joint, k)));
        }
        rows
    }
}

fn schema() -> Result<TypePtr, ParquetError> {
    let field = |name: &str, physical: Physical, logical: Option<LogicalType>| {
        Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical)
            .build()
            .map(Arc::new)
    };
    let mut fields = vec![
        field("t_ns", Physical::INT64, None)?,
        field("joint", Physical::BYTE_ARRAY, Some(LogicalType::String))?,
    ];
    for signal in &COLUMNS {
        fields.push(field(signal.name, Physical::DOUBLE, None)?);
    }
    for flag in ["saturated", "rate_limited"] {
        fields.push(field(flag, Physical::BOOLEAN, None)?);
    }
    Ok(Arc::new(Type::group_type_builder("trace").with_fields(fields).build()?))
}

fn column<T: DataType, W: Write + Send>(
    rows: &mut SerializedRowGroupWriter<'_, W>,
    values: &[T::T],
) -> Result<(), ParquetError> {
    let Some(mut writer) = rows.next_column()? else {
        return Err(ParquetError::General("the schema has fewer columns".to_owned()));
    };
    writer.typed::<T>().write_batch(values, None, None)?;
    writer.close()
}
