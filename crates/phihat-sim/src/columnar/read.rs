//! A Parquet file, read some rows at a time.

use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError as Package;
use parquet::file::metadata::{ColumnChunkMetaData, RowGroupMetaData};
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::values::{ValueKind, Values};
use super::{MAGIC, ParquetError, Reason, guarded};

/// A Parquet file that is read some rows at a time, column by column. Whatever its bytes are, reading ends
/// with rows or an error.
#[expect(missing_debug_implementations, reason = "the package's reader has none")]
pub struct ParquetTable {
    file: Box<dyn FileReader>,
    columns: Vec<Arc<ColumnDescriptor>>,
    rows: u64,
}

impl ParquetTable {
    /// Reads what the file says of itself.
    ///
    /// # Errors
    ///
    /// [`ParquetError`]: it is none, or not whole.
    pub fn open(source: impl ChunkReader + 'static) -> Result<Self, ParquetError> {
        let source = Inside(source);
        let opened = guarded(|| {
            if !begins_as_parquet(&source)? {
                return Err(Package::General("it does not begin with PAR1".to_owned()));
            }
            SerializedFileReader::new(source)
        });
        let file: Box<dyn FileReader> =
            Box::new(opened.map_err(|Reason(why)| ParquetError::NotWhole(why))?);
        let columns = file.metadata().file_metadata().schema_descr().columns().to_vec();
        let mut rows = 0_u64;
        for group in file.metadata().row_groups() {
            let more = u64::try_from(group.num_rows()).ok().filter(|_| are_placed(group));
            let all = more.and_then(|more| rows.checked_add(more));
            let told = || ParquetError::NotWhole("its directory is damaged".to_owned());
            rows = all.ok_or_else(told)?;
        }
        Ok(Self { file, columns, rows })
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The columns' names, and what they hold; `None`: what is not read.
    pub fn columns(&self) -> impl Iterator<Item = (&str, Option<ValueKind>)> {
        self.columns.iter().map(|column| (column.name(), kind(column)))
    }

    /// Index of the flat column of this name.
    pub fn place(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name() == name && is_flat(column))
    }

    /// Hands over these columns, so many rows at most at once, with the number of the first of them, from 0.
    ///
    /// # Errors
    ///
    /// [`ParquetError`]: a column is in a form that is not read, or broken; and whatever `each` says.
    pub fn read<E: From<ParquetError>>(
        &self,
        columns: &[usize],
        most: usize,
        mut each: impl FnMut(u64, &[Values]) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut values = Vec::new();
        for column in columns {
            values.push(Values::new(self.kind(*column)?));
        }
        let mut first = 0;
        for group in 0..self.file.num_row_groups() {
            let rows = self.file.metadata().row_group(group).num_rows();
            let mut left = usize::try_from(rows).unwrap_or(usize::MAX);
            let mut open = Vec::new();
            for column in columns {
                open.push(self.chunk(group, *column)?);
            }
            while left > 0 {
                let count = left.min(most.max(1));
                for ((chunk, values), column) in open.iter_mut().zip(&mut values).zip(columns) {
                    values.clear();
                    let taken = guarded(|| take(chunk, count, values));
                    taken.map_err(|Reason(reason)| self.broken(*column, reason))?;
                }
                each(first, &values)?;
                first += count as u64;
                left -= count;
            }
        }
        Ok(())
    }

    fn kind(&self, column: usize) -> Result<ValueKind, ParquetError> {
        let Some(described) = self.columns.get(column) else {
            return Err(ParquetError::NotWhole("it has fewer columns".to_owned()));
        };
        kind(described).ok_or_else(|| {
            self.broken(column, "holds neither numbers nor flags nor texts".to_owned())
        })
    }

    /// A column of a row group, before its first value.
    fn chunk(&self, group: usize, column: usize) -> Result<ColumnReader, ParquetError> {
        let opened = guarded(|| {
            let group = self.file.get_row_group(group)?;
            let packed = group.metadata().column(column).compression();
            if !matches!(packed, Compression::UNCOMPRESSED | Compression::SNAPPY) {
                // A level, which some have, is in brackets.
                let packed = packed.to_string();
                let packed = packed.split('(').next().unwrap_or_default();
                let reason = format!("is compressed by {packed}; SNAPPY or none is read");
                return Err(Package::General(reason));
            }
            group.get_column_reader(column)
        });
        opened.map_err(|Reason(reason)| self.broken(column, reason))
    }

    fn broken(&self, column: usize, reason: String) -> ParquetError {
        let column = self.columns.get(column).map_or("", |column| column.name()).to_owned();
        ParquetError::Column { column, reason }
    }
}

/// Returns true if a file begins as Parquet does.
pub(crate) fn begins_as_parquet(source: &impl ChunkReader) -> Result<bool, Package> {
    let long = source.len() >= MAGIC.len() as u64;
    Ok(long && source.get_bytes(0, MAGIC.len())? == MAGIC[..])
}

/// A file of which nothing is taken that is not there, whatever it says of itself.
struct Inside<R>(R);

impl<R: Length> Length for Inside<R> {
    fn len(&self) -> u64 {
        self.0.len()
    }
}

impl<R: ChunkReader> ChunkReader for Inside<R> {
    type T = R::T;

    fn get_read(&self, start: u64) -> Result<Self::T, Package> {
        self.0.get_read(start)
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, Package> {
        if start.checked_add(length as u64).is_none_or(|end| end > self.len()) {
            return Err(Package::EOF("it ends before that".to_owned()));
        }
        self.0.get_bytes(start, length)
    }
}

/// Returns true if the offsets and sizes of a row group's columns are not negative.
fn are_placed(group: &RowGroupMetaData) -> bool {
    let placed = |column: &ColumnChunkMetaData| {
        let dictionary = column.dictionary_page_offset().unwrap_or(0);
        column.data_page_offset().min(dictionary).min(column.compressed_size()) >= 0
    };
    group.columns().iter().all(placed)
}

/// Neither in a group nor a list.
fn is_flat(column: &ColumnDescriptor) -> bool {
    column.path().parts().len() == 1 && column.max_rep_level() == 0
}

fn kind(column: &ColumnDescriptor) -> Option<ValueKind> {
    match column.physical_type() {
        _ if !is_flat(column) => None,
        Physical::BOOLEAN => Some(ValueKind::Flags),
        Physical::INT32 | Physical::INT64 => Some(ValueKind::Integers),
        Physical::FLOAT | Physical::DOUBLE => Some(ValueKind::Numbers),
        Physical::BYTE_ARRAY => Some(ValueKind::Texts),
        Physical::INT96 | Physical::FIXED_LEN_BYTE_ARRAY => None,
    }
}

/// Takes the next values of a column.
fn take(from: &mut ColumnReader, count: usize, into: &mut Values) -> Result<(), Package> {
    match (from, into) {
        (ColumnReader::DoubleColumnReader(from), Values::Numbers(into)) => {
            each(from, count, |number| into.push(number.copied().unwrap_or(f64::NAN)))
        }
        (ColumnReader::FloatColumnReader(from), Values::Numbers(into)) => {
            each(from, count, |number| {
                into.push(number.map_or(f64::NAN, |number| (*number).into()));
            })
        }
        (ColumnReader::Int64ColumnReader(from), Values::Integers(into)) => {
            all(from, count, |number| into.push(*number))
        }
        (ColumnReader::Int32ColumnReader(from), Values::Integers(into)) => {
            all(from, count, |number| into.push((*number).into()))
        }
        (ColumnReader::BoolColumnReader(from), Values::Flags(into)) => {
            all(from, count, |flag| into.push(*flag))
        }
        (ColumnReader::ByteArrayColumnReader(from), Values::Texts(into)) => {
            let mut broken = None;
            each(from, count, |text| {
                let text = text.map_or(Ok(""), ByteArray::as_utf8);
                into.push(text.unwrap_or_else(|why| {
                    broken = Some(why);
                    ""
                }));
            })?;
            broken.map_or(Ok(()), Err)
        }
        _ => Err(Package::General("is not what the schema says".to_owned())),
    }
}

/// The next values of a column that has one in every row.
fn all<T: DataType>(
    from: &mut ColumnReaderImpl<T>,
    count: usize,
    mut take: impl FnMut(&T::T),
) -> Result<(), Package> {
    let mut whole = true;
    each(from, count, |value| match value {
        Some(value) => take(value),
        None => whole = false,
    })?;
    if whole { Ok(()) } else { Err(Package::General("has rows without a value".to_owned())) }
}

/// The next values of a column, `None` where there is none.
fn each<T: DataType>(
    from: &mut ColumnReaderImpl<T>,
    mut count: usize,
    mut take: impl FnMut(Option<&T::T>),
) -> Result<(), Package> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    while count > 0 {
        values.clear();
        levels.clear();
        let (rows, present, _) = from.read_records(count, Some(&mut levels), None, &mut values)?;
        if rows == 0 || rows > count {
            return Err(Package::EOF("it ends before its rows do".to_owned()));
        }
        if present == rows {
            for value in &values {
                take(Some(value));
            }
        } else {
            let mut values = values.iter();
            for level in &levels {
                take(if *level > 0 { values.next() } else { None });
            }
        }
        count -= rows;
    }
    Ok(())
}
