//! Keys of a study's text changed: what campaigns make their runs of.

use toml::{Table, Value};

/// Sets a key, making the sections it stands in.
pub fn set(table: &mut Table, path: &[&str], value: Value) {
    let Some((key, above)) = path.split_last() else { return };
    if let Some(at) = inner(table, above) {
        at.insert((*key).to_owned(), value);
    }
}

/// Appends to a list of sections.
pub fn append(table: &mut Table, path: &[&str], section: Table) {
    let Some((key, above)) = path.split_last() else { return };
    let Some(at) = inner(table, above) else { return };
    let list = at.entry((*key).to_owned()).or_insert_with(|| Value::Array(Vec::new()));
    if let Value::Array(list) = list {
        list.push(Value::Table(section));
    }
}

/// A section, made where it is not there.
fn inner<'a>(table: &'a mut Table, path: &[&str]) -> Option<&'a mut Table> {
    let mut at = table;
    for section in path {
        let entry = at.entry((*section).to_owned()).or_insert_with(|| Value::Table(Table::new()));
        at = entry.as_table_mut()?;
    }
    Some(at)
}
