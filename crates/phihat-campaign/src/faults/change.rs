//! From a fault of the table to the study of a run.

use toml::{Table, Value};

use super::catalogue::{Effect, Fault, Lasts, On, Size};

/// What a run is about: drawn from its name alone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Draw {
    /// When the fault begins \[s\]: in the middle between two samples.
    pub(crate) onset: f64,
    /// The joint, if it is about one.
    pub(crate) joint: usize,
    /// +1 or −1.
    pub(crate) sign: f64,
}

/// What a severity is measured with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Units {
    /// Sample period \[s\].
    pub(crate) period: f64,
    /// The drawn joint's torque limit \[N·m\].
    pub(crate) torque: f64,
    /// The heaviest payload of the design \[kg\].
    pub(crate) payload: f64,
}

/// Puts a severity of a fault into a study.
pub(crate) fn change(
    study: &mut Table,
    (fault, severity): (&Fault, usize),
    draw: &Draw,
    units: Units,
    joint: &str,
) {
    let level = fault.levels[severity];
    match fault.effect {
        Effect::Key { path, size } => {
            if let Some(value) = value(size, level, draw.sign, units) {
                set(study, path, value);
            }
        }
        Effect::Entry { kind, size, lasts, on } => {
            let mut entry = Table::new();
            entry.insert("kind".into(), kind.into());
            let (start, duration) = match lasts {
                Lasts::Before => (0.0, Some(draw.onset)),
                Lasts::Rest => (draw.onset, None),
                Lasts::Seconds(s) => (draw.onset, Some(s.max(units.period))),
                Lasts::Level => (draw.onset, Some(level.max(units.period))),
            };
            entry.insert("start_s".into(), start.into());
            entry.extend(duration.map(|s| ("duration_s".to_owned(), s.into())));
            if on == On::Joint {
                entry.insert("joint".into(), joint.into());
            }
            entry.extend(value(size, level, draw.sign, units).map(|v| ("size".to_owned(), v)));
            let faults = study.entry("fault").or_insert_with(|| Value::Array(Vec::new()));
            if let Value::Array(faults) = faults {
                faults.push(Value::Table(entry));
            }
        }
    }
}

fn value(size: Size, level: f64, sign: f64, units: Units) -> Option<Value> {
    let number = match size {
        Size::None => return None,
        Size::Fixed(value) => value,
        Size::Level | Size::Whole => level,
        Size::Signed => level * sign,
        Size::Torque => level * units.torque,
        Size::TorqueSigned => level * units.torque * sign,
        Size::Payload => level * units.payload,
        Size::Periods => level * units.period,
    };
    #[allow(clippy::cast_possible_truncation, reason = "small whole numbers of the table")]
    let whole = number as i64;
    Some(if size == Size::Whole { whole.into() } else { number.into() })
}

/// Sets a key, making the sections it stands in.
pub(crate) fn set(table: &mut Table, path: &[&str], value: Value) {
    let Some((key, above)) = path.split_last() else { return };
    let mut at = table;
    for section in above {
        let entry = at.entry((*section).to_owned()).or_insert_with(|| Value::Table(Table::new()));
        match entry {
            Value::Table(inner) => at = inner,
            _ => return,
        }
    }
    at.insert((*key).to_owned(), value);
}
