//! Comparison of a fresh reproduction with a stored one, for CI.

use serde::Deserialize;
use serde_json::{Number, Value};
use thiserror::Error;

use crate::record::{self, FORMAT, Reproduction, Statement};

/// Reason why a text is no `reproduction.json` of this program.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum KeptError {
    /// No JSON object.
    #[error("{NO_REPRODUCTION}; found no JSON object: {0}")]
    NoObject(serde_json::Error),
    /// A JSON object that is laid out otherwise.
    #[error("{NO_REPRODUCTION}; {0}")]
    Unreadable(serde_json::Error),
    /// A document whose format is no number.
    #[error("{NO_REPRODUCTION}; found a document of format {0}")]
    NoFormatNumber(Value),
    /// A document that states no format.
    #[error("{NO_REPRODUCTION}; found a document without `format`")]
    NoFormat,
    /// A reproduction, perhaps, of another [`FORMAT`].
    #[error("a document of format {0}; this program reads reproductions of format {FORMAT}")]
    OtherFormat(Number),
}

const NO_REPRODUCTION: &str =
    "no reproduction: expected a reproduction.json that `phihat reproduce` wrote";

/// Part of a `reproduction.json` that is compared: statements, their verdicts and numbers.
#[derive(Debug, Clone, Deserialize)]
pub struct Kept {
    quick: bool,
    sections: Vec<KeptSection>,
}

#[derive(Debug, Clone, Deserialize)]
struct KeptSection {
    statements: Vec<Statement>,
}

impl Kept {
    /// Reads a `reproduction.json`.
    ///
    /// # Errors
    ///
    /// The text is no reproduction, or of another [`FORMAT`].
    pub fn from_json(text: &str) -> Result<Self, KeptError> {
        let found: DocumentHead = serde_json::from_str(text).map_err(KeptError::NoObject)?;
        match found.format {
            Some(Value::Number(format)) if format.as_u64() == Some(FORMAT.into()) => {
                serde_json::from_str(text).map_err(KeptError::Unreadable)
            }
            Some(Value::Number(format)) => Err(KeptError::OtherFormat(format)),
            Some(other) => Err(KeptError::NoFormatNumber(other)),
            None => Err(KeptError::NoFormat),
        }
    }

    /// One line per statement, verdict or number on which a fresh reproduction differs: a number by more than
    /// its kept tolerance, relative to the larger of both.
    ///
    /// Of a part, only that part is compared. Statements are the same in a quick reproduction; numbers that it
    /// leaves out are not missed.
    pub fn disagreements(&self, fresh: &Reproduction) -> Vec<String> {
        let same_extent = self.quick == fresh.quick;
        let kept = || self.sections.iter().flat_map(|section| &section.statements);
        let now = || fresh.sections.iter().flat_map(|section| &section.statements);
        let mut lines = Vec::new();
        for old in kept() {
            match now().find(|new| new.id == old.id) {
                Some(new) => compare(old, new, same_extent, &mut lines),
                None if fresh.only.is_some() => {}
                None => lines.push(format!("{}: no longer a statement", old.id)),
            }
        }
        let unknown = now().filter(|new| !kept().any(|old| old.id == new.id));
        lines.extend(unknown.map(|new| format!("{}: a new statement", new.id)));
        lines
    }
}

/// As much as tells a reproduction from other documents.
#[derive(Deserialize)]
struct DocumentHead {
    format: Option<Value>,
}

fn compare(old: &Statement, new: &Statement, same_extent: bool, lines: &mut Vec<String>) {
    let id = &old.id;
    if old.verdict != new.verdict {
        lines.push(format!(
            "{id}: was \"{}\", is \"{}\"",
            old.verdict.words(),
            new.verdict.words()
        ));
    }
    for number in &old.numbers {
        match new.numbers.iter().find(|other| other.name == number.name) {
            Some(other) if agree(number, other) => {}
            Some(other) => {
                let show = |n: &record::PaperNumber| {
                    n.value.map_or("none".to_owned(), |v| format!("{v:?}"))
                };
                lines.push(format!(
                    "{id}: {} was {}, is {} {} (agrees within {})",
                    number.name,
                    show(number),
                    show(other),
                    number.unit,
                    number.tolerance
                ));
            }
            None if same_extent => lines.push(format!("{id}: {} is missing", number.name)),
            None => {}
        }
    }
}

fn agree(old: &record::PaperNumber, new: &record::PaperNumber) -> bool {
    match (old.value, new.value) {
        (Some(a), Some(b)) => (a - b).abs() <= old.tolerance * a.abs().max(b.abs()),
        (None, None) => true,
        _ => false,
    }
}
