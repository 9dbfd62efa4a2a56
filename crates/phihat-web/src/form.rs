//! The keys of a study that a form shows, and a study's text with one of them changed.

use serde::Serialize;
use toml_edit::{DocumentMut, Item, Table, TomlError, Value};

use crate::error::AnswerError;

/// A key of the form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct FormKey {
    /// Dotted path in the study.
    pub key: &'static str,
    /// Label for people, without the unit.
    pub label: &'static str,
    /// Unit; empty: none.
    pub unit: &'static str,
}

const fn form(key: &'static str, label: &'static str, unit: &'static str) -> FormKey {
    FormKey { key, label, unit }
}

/// The ten keys that matter most, in their order.
pub const FORM: [FormKey; 10] = [
    form("spec.error_bound_rad", "Error that I accept", "rad"),
    form("spec.settle_s", "Settled after", "s"),
    form("design.payload_max_kg", "Heaviest payload", "kg"),
    form("design.torque_step_max_nm", "Torque step per sample, at most", "N·m"),
    form("loop.rate_hz", "Control rate", "Hz"),
    form("loop.delay_samples", "Transport delay", "samples"),
    form("sensor.encoder_bits", "Encoder", "bit"),
    form("world.coulomb_extra_nm", "Dry friction that nobody counted", "N·m"),
    form("duration_s", "Duration", "s"),
    form("seed", "Seed of the noise", ""),
];

/// Values of the form in a study's text, as TOML; `None`: the study leaves the key out, or the text is no TOML.
pub(crate) fn values(text: &str) -> Vec<Option<String>> {
    let Ok(document) = text.parse::<DocumentMut>() else { return vec![None; FORM.len()] };
    let value = |key: &str| {
        let mut at = document.as_item();
        for part in key.split('.') {
            at = at.get(part)?;
        }
        at.as_value().map(|value| value.clone().decorated("", "").to_string())
    };
    FORM.iter().map(|key| value(key.key)).collect()
}

/// The text of a study with one key of the form changed; all else, comments among it, is as it was.
pub(crate) fn changed(text: &str, key: &str, value: &str) -> Result<String, AnswerError> {
    if !FORM.iter().any(|own| own.key == key) {
        return Err(AnswerError::Key(key.to_owned()));
    }
    let mut document: DocumentMut = text.parse()?;
    let (section, name) = key.rsplit_once('.').map_or((None, key), |(a, b)| (Some(a), b));
    let table = match section {
        None => document.as_table_mut(),
        Some(section) => {
            let at = document.entry(section).or_insert_with(|| Item::Table(Table::new()));
            at.as_table_mut().ok_or_else(|| AnswerError::Section(section.to_owned()))?
        }
    };
    if value.trim().is_empty() {
        table.remove(name);
        return Ok(document.to_string());
    }
    let wrong =
        |_: TomlError| AnswerError::Value { key: key.to_owned(), value: value.trim().to_owned() };
    let mut new: Value = value.trim().parse().map_err(wrong)?;
    match table.get_mut(name).and_then(Item::as_value_mut) {
        Some(old) => {
            *new.decor_mut() = old.decor().clone();
            *old = new;
        }
        None => drop(table.insert(name, Item::Value(new))),
    }
    Ok(document.to_string())
}
