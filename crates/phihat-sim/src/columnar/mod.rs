//! What a trace needs of Parquet: flat tables of numbers, whole numbers, flags and texts.
//!
//! Written is one way: row groups of one page per column, REQUIRED, numbers split by bytes, texts as a dictionary, SNAPPY. Read is what
//! pandas, pyarrow and DuckDB write by default as well. Whatever bytes a file has, reading it ends with rows or an error, and takes memory in
//! proportion to the file, not to what it claims.

mod hybrid;
mod meta;
mod page;
mod read;
mod thrift;
mod values;
mod write;

use std::io;

use thiserror::Error;

pub use read::ParquetTable;
pub use values::{Kind, Texts, Values};
pub(crate) use write::{Stored, TableWriter};

/// How a Parquet file begins and ends.
pub(crate) const MAGIC: [u8; 4] = *b"PAR1";

/// Why a Parquet file cannot be read.
#[derive(Debug, Error)]
pub enum ParquetError {
    /// Reading failed.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The file is no Parquet file, or not whole.
    #[error("no whole Parquet file: {0}")]
    NotWhole(&'static str),
    /// Something in the file is not what belongs there.
    #[error("byte {at}: {reason}")]
    Broken {
        /// Where, from the beginning of the file or of what was read there.
        at: u64,
        /// What is wrong.
        reason: &'static str,
    },
    /// A column is in a form that is not read.
    #[error("column {column:?}: {reason}")]
    Column {
        /// Its name.
        column: String,
        /// What is wrong, and what is read.
        reason: String,
    },
}

/// What is stored, by the format's numbers.
mod physical {
    pub(super) const BOOLEAN: i64 = 0;
    pub(super) const INT32: i64 = 1;
    pub(super) const INT64: i64 = 2;
    pub(super) const FLOAT: i64 = 4;
    pub(super) const DOUBLE: i64 = 5;
    pub(super) const BYTE_ARRAY: i64 = 6;
}

/// How values are written, by the format's numbers.
mod encoding {
    pub(super) const PLAIN: i64 = 0;
    pub(super) const PLAIN_DICTIONARY: i64 = 2;
    pub(super) const RLE: i64 = 3;
    pub(super) const RLE_DICTIONARY: i64 = 8;
    pub(super) const BYTE_STREAM_SPLIT: i64 = 9;
}

/// Kinds of pages, by the format's numbers.
mod page_type {
    pub(super) const DATA: i64 = 0;
    pub(super) const DICTIONARY: i64 = 2;
    pub(super) const DATA_V2: i64 = 3;
}

const UNCOMPRESSED: i64 = 0;
const SNAPPY: i64 = 1;

/// Names of compressions, for messages.
const CODECS: [&str; 8] =
    ["UNCOMPRESSED", "SNAPPY", "GZIP", "LZO", "BROTLI", "LZ4", "ZSTD", "LZ4_RAW"];
