//! A study in whose run something happens: a push, a payload, other friction, a stop.

use serde::Deserialize;
use toml_edit::{ArrayOfTables, DocumentMut, Item, Table, Value};

use crate::error::AnswerError;

/// Duration of a push \[s\].
const PUSH_S: f64 = 0.5;

/// Duration of payload and friction \[s\]: longer than what is run.
const FROM_THEN_ON_S: f64 = 1000.0;

/// Requests that start a supervised arm, with their times \[s\].
const START: [(f64, &str); 3] = [(0.0, "arm"), (0.01, "hold"), (0.02, "track")];

/// A study, and what happens in its run.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Happening {
    /// Text of the study.
    study: String,
    /// Name of the joint that is pushed.
    joint: String,
    /// External torque on it for half a second \[N·m, N\]; 0: none.
    push_nm: f64,
    /// Mass that the tip picks up \[kg\]; 0: none.
    payload_kg: f64,
    /// Factor on all friction; 1: as it is.
    friction: f64,
    /// Time of all these \[s\].
    from_s: f64,
    /// Time at which the supervisor is asked to stop the arm \[s\]; `None`: never.
    #[serde(default)]
    stop_s: Option<f64>,
}

impl Happening {
    /// The study's text with a fault for each, and the request to stop.
    pub(crate) fn study_text(&self) -> Result<String, AnswerError> {
        let mut document: DocumentMut = self.study.parse()?;
        let faults = [
            ("push", self.push_nm, self.push_nm != 0.0, PUSH_S),
            ("payload", self.payload_kg, self.payload_kg != 0.0, FROM_THEN_ON_S),
            ("friction", self.friction, (self.friction - 1.0).abs() > 0.0, FROM_THEN_ON_S),
        ];
        for (kind, size, acts, duration) in faults {
            if !acts {
                continue;
            }
            let mut fault = Table::new();
            fault["kind"] = kind.into();
            if kind == "push" {
                fault["joint"] = self.joint.as_str().into();
            }
            for (key, value) in [("start_s", self.from_s), ("duration_s", duration), ("size", size)]
            {
                fault[key] = value.into();
            }
            sections(document.as_table_mut(), "fault")?.push(fault);
        }
        if let Some(stop) = self.stop_s {
            let at = document.entry("supervisor").or_insert_with(|| Item::Table(Table::new()));
            let section = || AnswerError::Section("supervisor".to_owned());
            stopped(sections(at.as_table_mut().ok_or_else(section)?, "request")?, stop);
        }
        Ok(document.to_string())
    }
}

/// Requests with a stop in place of all that come later, and a start where there is none.
fn stopped(requests: &mut ArrayOfTables, stop_s: f64) {
    let request = |t_s: f64, mode: &str| {
        let mut own = Table::new();
        own["t_s"] = t_s.into();
        own["mode"] = mode.into();
        own
    };
    if requests.is_empty() {
        for (t_s, mode) in START {
            requests.push(request(t_s, mode));
        }
    }
    let number = |value: &Value| value.as_float().or_else(|| Some(value.as_integer()? as f64));
    let time = |own: &Table| own.get("t_s").and_then(Item::as_value).and_then(number);
    requests.retain(|own| time(own).is_none_or(|t| t < stop_s));
    requests.push(request(stop_s, "stop"));
}

/// The sections of a name in a table, none where it has none.
fn sections<'a>(table: &'a mut Table, name: &str) -> Result<&'a mut ArrayOfTables, AnswerError> {
    let at = table.entry(name).or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
    at.as_array_of_tables_mut().ok_or_else(|| AnswerError::Section(name.to_owned()))
}
