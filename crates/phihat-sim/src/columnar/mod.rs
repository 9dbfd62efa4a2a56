//! Parquet files of a trace, by the format's own package: flat tables of numbers, integers, flags and texts.

mod read;
mod values;
mod write;

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use parquet::errors::ParquetError as Package;
use thiserror::Error;

pub use parquet::file::reader::ChunkReader;
pub use read::ParquetTable;
pub(crate) use read::begins_as_parquet;
pub use values::{Texts, ValueKind, Values};
pub(crate) use write::TableWriter;

/// First and last bytes of a Parquet file.
const MAGIC: [u8; 4] = *b"PAR1";

/// Why a Parquet file cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ParquetError {
    /// The file is no Parquet file, or not whole.
    #[error("no whole Parquet file: {0}")]
    NotWhole(String),
    /// A column is broken, or in a form that is not read.
    #[error("column {column:?}: {reason}")]
    Column {
        /// Its name.
        column: String,
        /// Description of the error, and of what can be read.
        reason: String,
    },
}

/// Characters of what the package says that are told.
const CLIP: usize = 200;

/// Description of an error, in the package's words.
struct Reason(String);

/// Does something with bytes from a file: of some damaged ones the package panics, which is a reason as others are.
fn guarded<T>(work: impl FnOnce() -> Result<T, Package>) -> Result<T, Reason> {
    let why = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(done)) => return Ok(done),
        Ok(Err(why)) => why.to_string(),
        Err(panic) => format!("is damaged ({})", words(panic.as_ref())),
    };
    let told = why.strip_prefix("Parquet error: ").unwrap_or(&why);
    let told = told.chars().map(|c| if c.is_control() { ' ' } else { c });
    Err(Reason(told.take(CLIP).collect()))
}

/// Message of a panic.
fn words(panic: &(dyn Any + Send)) -> &str {
    let words = panic.downcast_ref::<&str>().copied();
    words.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or_default()
}
