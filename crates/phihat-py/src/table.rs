//! Traces as they are in their file, column by column.

use std::path::{Path, PathBuf};

use numpy::IntoPyArray;
use phihat_session::{SessionError, files, trace_at};
use phihat_sim::{BLOCK, ParquetError, ParquetTable, Values, is_parquet};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure;

/// The file of a trace, which may be named by the folder of its run; and whether it is Parquet.
#[pyfunction]
pub(crate) fn trace_file(py: Python<'_>, path: PathBuf) -> PyResult<(PathBuf, bool)> {
    let file = trace_at(&path);
    let opened = files::open(&file).and_then(|opened| {
        let parquet = is_parquet(&opened);
        parquet.map_err(|why| SessionError::at(&file, why))
    });
    let parquet = opened.map_err(|why| failure::session(py, &why))?;
    Ok((file, parquet))
}

/// The columns of a Parquet file by name: numbers, whole numbers and flags as arrays, texts as the different
/// ones and of each row which one it has. Columns of other kinds are left out.
#[pyfunction]
pub(crate) fn parquet_columns(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let read = py.detach(|| whole(&path)).map_err(|why| failure::session(py, &why))?;
    let columns = PyDict::new(py);
    for (name, values) in read {
        match values {
            Values::Numbers(values) => columns.set_item(name, values.into_pyarray(py))?,
            Values::Integers(values) => columns.set_item(name, values.into_pyarray(py))?,
            Values::Flags(values) => columns.set_item(name, values.into_pyarray(py))?,
            Values::Texts(texts) => {
                let (words, rows) = (texts.words().to_vec(), texts.rows().to_vec());
                columns.set_item(name, (words, rows.into_pyarray(py)))?;
            }
        }
    }
    Ok(columns)
}

fn whole(path: &Path) -> Result<Vec<(String, Values)>, SessionError> {
    let told = |why: ParquetError| SessionError::at(path, why);
    let table = ParquetTable::open(files::open(path)?).map_err(told)?;
    let named: Vec<(usize, String)> = table
        .columns()
        .enumerate()
        .filter(|(_, (_, kind))| kind.is_some())
        .map(|(at, (name, _))| (at, name.to_owned()))
        .collect();
    let places: Vec<usize> = named.iter().map(|(at, _)| *at).collect();
    let mut all: Vec<Values> = Vec::new();
    table
        .read(&places, BLOCK, |_, values| {
            if all.is_empty() {
                all = values.to_vec();
            } else {
                all.iter_mut().zip(values).for_each(|(whole, more)| whole.append(more));
            }
            Ok::<(), ParquetError>(())
        })
        .map_err(told)?;
    Ok(named.into_iter().map(|(_, name)| name).zip(all).collect())
}
