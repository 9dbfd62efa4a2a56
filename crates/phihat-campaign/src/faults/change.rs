//! From a fault of the table to the study of a run.

use phihat_session::{append, set};
use toml::{Table, Value};

use super::catalogue::{AffectedPart, CatalogueFault, Effect, Lasts, Size};

/// Values drawn for a run, from its name alone.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FaultDraw {
    /// When the fault begins \[s\]: in the middle between two samples; 0 where it is there from the start.
    pub(crate) onset: f64,
    /// The joint, if it is about one.
    pub(crate) joint: usize,
    /// +1 or −1.
    pub(crate) sign: f64,
    /// Joint positions at the start of the reference \[rad\].
    pub(crate) start: Vec<f64>,
}

/// Units of the severities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JointUnits {
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
    (fault, severity): (&CatalogueFault, usize),
    draw: &FaultDraw,
    units: JointUnits,
    joint: &str,
) {
    let level = fault.levels[severity];
    match fault.effect {
        Effect::Keys(keys) => {
            for (path, size) in keys {
                if let Some(value) = value(*size, level, draw.sign, units) {
                    set(study, path, value);
                }
            }
        }
        Effect::Entry { kind, size, lasts, on } => {
            let size = value(size, level, draw.sign, units);
            let entry = entry(kind, draw, (lasts, level, units.period), size);
            let joint = (on == AffectedPart::Joint).then(|| ("joint".to_owned(), joint.into()));
            append(study, &["fault"], entry.into_iter().chain(joint).collect());
        }
        Effect::StopAndRestart => {
            let (stop, again, sample) = (draw.onset, draw.onset + level, units.period);
            let requests = [
                (0.0, "arm"),
                (sample, "hold"),
                (2.0 * sample, "track"),
                (stop, "stop"),
                (again, "arm"),
                (again + sample, "hold"),
                (again + 2.0 * sample, "track"),
            ];
            for (t, mode) in requests {
                let request = [("t_s".to_owned(), t.into()), ("mode".to_owned(), mode.into())];
                append(study, &["supervisor", "request"], request.into_iter().collect());
            }
        }
        Effect::StartBeside => {
            let beside = draw.start.iter().map(|q| Value::from(q + level * draw.sign));
            set(study, &["start", "q_rad"], beside.collect::<Vec<_>>().into());
        }
    }
}

fn entry(
    kind: &str,
    draw: &FaultDraw,
    (lasts, level, period): (Lasts, f64, f64),
    size: Option<Value>,
) -> Table {
    let (start, duration) = match lasts {
        Lasts::Before => (0.0, Some(draw.onset)),
        Lasts::Rest => (draw.onset, None),
        Lasts::Seconds(s) => (draw.onset, Some(s.max(period))),
        Lasts::Level => (draw.onset, Some(level.max(period))),
    };
    let mut entry = Table::new();
    entry.insert("kind".into(), kind.into());
    entry.insert("start_s".into(), start.into());
    entry.extend(duration.map(|s| ("duration_s".to_owned(), s.into())));
    entry.extend(size.map(|size| ("size".to_owned(), size)));
    entry
}

fn value(size: Size, level: f64, sign: f64, units: JointUnits) -> Option<Value> {
    let number = match size {
        Size::None => return None,
        Size::True => return Some(true.into()),
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
