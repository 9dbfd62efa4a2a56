//! A record of a real arm: a table of positions and torques.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use phihat_design::RecordedJoint;
use phihat_sim::{
    BLOCK, ChunkReader, ParquetError, ParquetTable, Place, TraceError, ValueKind, Values,
    is_parquet,
};

use crate::error::SessionError;
use crate::files;
use crate::origin::trace_at;

/// A step between samples may differ by this share from the middle one.
const JITTER: f64 = 0.2;

/// The columns: what each may be called.
const COLUMNS: [&[&str]; 4] =
    [&["t_s"], &["joint"], &["q_rad", "q_measured_rad"], &["tau_nm", "tau_applied_nm"]];

/// Positions and torques of every joint at equal times.
pub(super) struct IdentifyRecording {
    pub(super) period_ns: u64,
    pub(super) joints: Vec<RecordedJoint>,
}

/// Reads a record from `from` \[s\] after its first sample on: one row per sample and joint, columns by name
/// in any order, others left alone; a table as CSV or Parquet, or the folder of a run.
///
/// # Errors
///
/// [`SessionError::File`], with line or row, column, value and what would be valid.
pub(super) fn read(path: &Path, from: f64) -> Result<IdentifyRecording, SessionError> {
    let path = &trace_at(path);
    let refuse = |why: String| SessionError::at(path, why);
    let file = files::open(path)?;
    let mut rows = RecordedRows { from, first: None, times: Vec::new(), joints: Vec::new() };
    let parquet = is_parquet(&file).map_err(TraceError::from);
    let read = parquet.and_then(|parquet| {
        if parquet {
            return of_parquet(file, &mut rows);
        }
        of_csv(file.get_read(0).map_err(io::Error::other)?, &mut rows)
    });
    read.map_err(|e| refuse(e.to_string()))?;
    let RecordedRows { times, joints, .. } = rows;
    let Some(joint) = joints.iter().find(|joint| joint.q.len() != times.len()) else {
        let period_ns = period(path, &times)?;
        return Ok(IdentifyRecording { period_ns, joints });
    };
    let (name, found, expected) = (&joint.name, joint.q.len(), times.len());
    let most = &joints[0].name;
    let rows = format!("joint {name} has {found} rows and joint {most} has {expected}");
    Err(refuse(format!("{rows}: each sample needs a row of every joint")))
}

/// Rows that were read so far.
struct RecordedRows {
    from: f64,
    first: Option<f64>,
    times: Vec<f64>,
    joints: Vec<RecordedJoint>,
}

impl RecordedRows {
    fn add(&mut self, name: &str, [t, q, tau]: [f64; 3]) {
        let begun = *self.first.get_or_insert(t);
        if t - begun < self.from {
            return;
        }
        let joints = &mut self.joints;
        let at = joints.iter().position(|joint| joint.name == name).unwrap_or(joints.len());
        if at == joints.len() {
            let name = name.to_owned();
            joints.push(RecordedJoint { name, q: Vec::new(), tau: Vec::new() });
        }
        if at == 0 {
            self.times.push(t);
        }
        self.joints[at].q.push(q);
        self.joints[at].tau.push(tau);
    }
}

/// The columns, for messages.
fn needed() -> String {
    COLUMNS.map(|names| names.join(" or ")).join(", ")
}

fn finite(
    place: Place,
    column: usize,
    value: Option<f64>,
    found: impl FnOnce() -> String,
) -> Result<f64, TraceError> {
    value.filter(|x| x.is_finite()).ok_or_else(|| TraceError::Field {
        place,
        column: COLUMNS[column][0],
        value: found(),
        expected: "it must be a finite number",
    })
}

fn of_csv(file: impl Read, rows: &mut RecordedRows) -> Result<(), TraceError> {
    let mut csv = csv::Reader::from_reader(file);
    let header = csv.headers()?.clone();
    let place = |names: &[&str]| {
        let found = header.iter().position(|column| names.contains(&column.trim()));
        found.ok_or_else(|| {
            let reason = format!("there is no column {}; needed: {}", names.join(" or "), needed());
            TraceError::Rows { place: Place::Line(1), reason }
        })
    };
    let [t, name, q, tau] = COLUMNS.map(place);
    let places = [t?, name?, q?, tau?];
    for row in csv.records() {
        let row = row?;
        let place = Place::Line(row.position().map_or(0, csv::Position::line));
        let text = |column: usize| row.get(places[column]).unwrap_or("").trim();
        let number = |column: usize| {
            finite(place, column, text(column).parse().ok(), || text(column).to_owned())
        };
        rows.add(text(1), [number(0)?, number(2)?, number(3)?]);
    }
    Ok(())
}

/// Times in whole nanoseconds, as traces have them.
const NANOSECONDS: &str = "t_ns";

fn of_parquet(file: File, rows: &mut RecordedRows) -> Result<(), TraceError> {
    let table = ParquetTable::open(file)?;
    let kind = |at: &usize| table.columns().nth(*at).and_then(|(_, kind)| kind);
    let is_number = |at: &usize| matches!(kind(at), Some(ValueKind::Numbers | ValueKind::Integers));
    let nanoseconds = table.place(NANOSECONDS).filter(is_number);
    let place = |names: &[&str]| {
        let found = names.iter().find_map(|name| table.place(name));
        let text = names[0] == COLUMNS[1][0];
        found.filter(|at| if text { kind(at) == Some(ValueKind::Texts) } else { is_number(at) })
    };
    let lacking = |column: usize| ParquetError::Column {
        column: COLUMNS[column].join(" or "),
        reason: format!("is not there, or holds something else; needed: {}", needed()),
    };
    let places = [
        place(COLUMNS[0]).or(nanoseconds).ok_or_else(|| lacking(0))?,
        place(COLUMNS[1]).ok_or_else(|| lacking(1))?,
        place(COLUMNS[2]).ok_or_else(|| lacking(2))?,
        place(COLUMNS[3]).ok_or_else(|| lacking(3))?,
    ];
    let unit = if Some(places[0]) == nanoseconds { 1e9 } else { 1.0 };
    table.read(&places, BLOCK, |first, columns| {
        let [t, name, q, tau] = columns else { return Ok(()) };
        let Values::Texts(names) = name else { return Ok(()) };
        let number = |values: &Values, row: usize| match values {
            Values::Numbers(values) => values.get(row).copied(),
            Values::Integers(values) => values.get(row).map(|value| *value as f64),
            _ => None,
        };
        for row in 0..names.rows().len() {
            let place = Place::Row(first + row as u64 + 1);
            let number = |column: usize, values| {
                let value = number(values, row);
                finite(place, column, value, || value.map_or(String::new(), |x| x.to_string()))
            };
            let [t, q, tau] = [number(0, t)? / unit, number(2, q)?, number(3, tau)?];
            rows.add(names.get(row), [t, q, tau]);
        }
        Ok::<(), TraceError>(())
    })
}

/// Time between samples \[ns\].
fn period(path: &Path, times: &[f64]) -> Result<u64, SessionError> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let uneven = steps.clone();
    steps.sort_by(f64::total_cmp);
    let Some(middle) = steps.get(steps.len() / 2).copied().filter(|step| *step > 0.0) else {
        return Err(SessionError::at(path, "there are not two samples, one after the other"));
    };
    let off = |step: &f64| (step - middle).abs() > JITTER * middle;
    if let Some(k) = uneven.iter().position(off) {
        let (t, step) = (times[k], uneven[k]);
        let why = format!(
            "t_s = {t}: the next sample comes {step} s later, and samples are {middle} s apart"
        );
        return Err(SessionError::at(path, format!("{why}; cut the record there")));
    }
    // The whole span: single stamps are rounded.
    let span = times[times.len() - 1] - times[0];
    let period = 1e9 * span / (times.len() - 1) as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
    let period = period.round() as u64;
    Ok(period.max(1))
}
