//! Common parts of the files of a trace, of either kind: columns, the order of rows, and reasons of refusal.

use core::fmt;
use std::io;

use phihat::{Events, Fault, Mode};
use phihat_study::Study;
use thiserror::Error;

use crate::columnar::{ChunkReader, ParquetError, begins_as_parquet};
use crate::trace::{COLUMNS, JointTrace, Supervision, Trace};

/// Samples that are written or read at once where a run may be long.
pub const BLOCK: usize = 4096;

/// Position in a trace file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, from 1.
    Line(u64),
    /// A row of a table, from 1.
    Row(u64),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Row(row) => write!(f, "row {row}"),
        }
    }
}

/// Why a trace file cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TraceError {
    /// Reading failed.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The file is not CSV, or reading failed.
    #[error("{0}")]
    Csv(#[from] csv::Error),
    /// The file is not whole Parquet, or of a form that is not read.
    #[error("{0}")]
    Parquet(#[from] ParquetError),
    /// The header is not that of a trace.
    #[error("line 1: column {column} is {found:?}; a trace has {expected:?} there")]
    Header {
        /// Number of the column, from 1.
        column: usize,
        /// Name in the file.
        found: String,
        /// Expected name.
        expected: &'static str,
    },
    /// A column is not there, or holds something else.
    #[error("there is no column {column} of {expected}, which a trace has")]
    Column {
        /// Its name.
        column: &'static str,
        /// Expected type of its values.
        expected: &'static str,
    },
    /// A field does not read.
    #[error("{place}: {column} is {value:?}; {expected}")]
    Field {
        /// Position in the file.
        place: Place,
        /// Column name.
        column: &'static str,
        /// Value in the file.
        value: String,
        /// Valid values.
        expected: &'static str,
    },
    /// The rows do not form whole samples.
    #[error("{place}: {reason}")]
    Rows {
        /// Position in the file.
        place: Place,
        /// Description of the error.
        reason: String,
    },
}

impl Trace {
    /// Reads the trace of a study's arm from a file of either kind, [Parquet](Self::read_parquet_in) or
    /// [CSV](Self::read_csv_in): its joints, in their order, at its period, one sample at least.
    ///
    /// # Errors
    ///
    /// [`TraceError`], naming place and column.
    pub fn read(file: impl ChunkReader + 'static, study: &Study) -> Result<Self, TraceError> {
        let mut whole = Self::default();
        Self::read_in(file, study, usize::MAX, |block| whole = std::mem::take(block))?;
        Ok(whole)
    }

    /// The same in blocks of at most so many samples, in their order.
    ///
    /// # Errors
    ///
    /// [`TraceError`], naming place and column; what was handed over before is not to be used.
    pub fn read_in(
        file: impl ChunkReader + 'static,
        study: &Study,
        block: usize,
        each: impl FnMut(&mut Self),
    ) -> Result<(), TraceError> {
        if is_parquet(&file)? {
            return Self::read_parquet_in(file, study, block, each);
        }
        Self::read_csv_in(file.get_read(0).map_err(io::Error::other)?, study, block, each)
    }

    /// A trace of a study's arm before its first sample.
    pub(crate) fn of(study: &Study, supervised: bool) -> Self {
        let joint = |joint: &phihat_model::Joint| JointTrace {
            name: joint.name.clone(),
            ..JointTrace::default()
        };
        let joints = study.robot.joints.iter().map(joint).collect();
        let supervision = supervised.then(Supervision::default);
        Self { period_ns: study.control.period_ns, t_ns: Vec::new(), joints, supervision }
    }
}

/// Returns true if a file begins as Parquet does. Afterwards the file is not at its beginning: request a new
/// reader from it to read on.
///
/// # Errors
///
/// The file's.
pub fn is_parquet(file: &impl ChunkReader) -> io::Result<bool> {
    begins_as_parquet(file).map_err(io::Error::other)
}

/// The columns of a supervised run.
pub(crate) const SUPERVISION: [&str; 4] = ["mode", "events", "fault", "brake"];

/// The columns after those of [`COLUMNS`].
pub(crate) const FLAGS: [&str; 2] = ["saturated", "rate_limited"];

/// The last column, where there is a certified bound.
pub(crate) const SHARE: &str = "error_share";

/// Columns that not every trace has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct OptionalColumns {
    /// Those of a supervisor.
    pub(crate) supervised: bool,
    /// The share of a certified bound.
    pub(crate) bounded: bool,
}

impl OptionalColumns {
    /// Of a trace with at least one sample.
    pub(crate) fn of(trace: &Trace) -> Self {
        Self { supervised: trace.supervision.is_some(), bounded: trace.is_bounded() }
    }
}

/// Names of all columns but time and joint, in the order of the files.
pub(crate) fn signals(optional: OptionalColumns) -> impl Iterator<Item = &'static str> {
    let numbers = COLUMNS.iter().map(|column| column.name);
    let supervision = SUPERVISION.into_iter().filter(move |_| optional.supervised);
    numbers.chain(FLAGS).chain(supervision).chain(optional.bounded.then_some(SHARE))
}

/// Names that are told, and characters of one that is none.
const SHOWN: usize = 12;
const CLIP: usize = 60;

fn listed(names: &[String]) -> String {
    let more = if names.len() > SHOWN { ", …" } else { "" };
    format!("{}{more}", names[..names.len().min(SHOWN)].join(", "))
}

/// Nanoseconds as decimal seconds, exactly.
pub(crate) fn seconds(t_ns: u64) -> String {
    let text = format!("{}.{:09}", t_ns / 1_000_000_000, t_ns % 1_000_000_000);
    let trimmed = text.trim_end_matches('0');
    if trimmed.ends_with('.') { format!("{trimmed}0") } else { trimmed.to_owned() }
}

/// Rows as they come: every joint of each sample in turn, samples one period apart.
#[derive(Debug)]
pub(crate) struct RowTurn {
    names: Vec<String>,
    period_ns: u64,
    /// The joint whose row is next, and the time of the row before \[ns\].
    pub(crate) next: usize,
    before: Option<u64>,
}

impl RowTurn {
    pub(crate) fn of(study: &Study) -> Self {
        let names = study.robot.joint_names();
        Self { names, period_ns: study.control.period_ns, next: 0, before: None }
    }

    /// Checks that a row is the next one; the joint that it is of.
    pub(crate) fn row(&mut self, place: Place, name: &str, t_ns: u64) -> Result<usize, TraceError> {
        let wrong = |reason: String| Err(TraceError::Rows { place, reason });
        let joint = self.next;
        if name != self.names[joint] {
            let (n, all) = (self.names.len(), listed(&self.names));
            let name: String = name.chars().take(CLIP).collect();
            return wrong(format!(
                "joint {name:?} is not the next one, {:?}; the study's arm has {n}, in this order: {all}",
                self.names[joint]
            ));
        }
        match (self.before, joint) {
            (Some(before), 0) if before.checked_add(self.period_ns) != Some(t_ns) => {
                let (time, before) = (seconds(t_ns), seconds(before));
                let period = seconds(self.period_ns);
                wrong(format!(
                    "time {time} s does not follow {before} s by the study's period, {period} s"
                ))
            }
            (Some(sample), 1..) if sample != t_ns => {
                let (time, sample) = (seconds(t_ns), seconds(sample));
                wrong(format!(
                    "time {time} s, in the sample of {sample} s: it has no row for joint {name} yet"
                ))
            }
            _ => {
                self.before = Some(t_ns);
                self.next = (joint + 1) % self.names.len();
                Ok(joint)
            }
        }
    }

    /// Checks that the last sample is whole, and that there is one.
    pub(crate) fn ended(&self, place: Place) -> Result<(), TraceError> {
        let reason = match (self.before, self.next) {
            (None, _) => "no sample follows; a trace has one row per sample and joint".to_owned(),
            (Some(_), 0) => return Ok(()),
            (Some(_), next) => format!("the last sample has no row for joint {}", self.names[next]),
        };
        Err(TraceError::Rows { place, reason })
    }
}

impl Supervision {
    /// The words of a sample: mode, events, fault.
    pub(crate) fn words(&self, k: usize) -> (&'static str, String, &'static str) {
        let events = self.events[k].names().collect::<Vec<_>>().join(" ");
        (self.mode[k].name(), events, self.fault[k].map_or("", Fault::name))
    }

    /// Adds a sample by its words.
    pub(crate) fn append(
        &mut self,
        place: Place,
        [mode, events, fault]: [&str; 3],
        brake: bool,
    ) -> Result<(), TraceError> {
        let expected = "a word that phihat writes is expected";
        let wrong = |column, value: &str| {
            let value = value.to_owned();
            TraceError::Field { place, column, value, expected }
        };
        let known = Mode::ALL.into_iter().find(|m| m.name() == mode);
        self.mode.push(known.ok_or_else(|| wrong("mode", mode))?);
        let mut set = Events::NONE;
        for word in events.split(' ').filter(|word| !word.is_empty()) {
            let known = Events::ALL.iter().find(|(_, name)| *name == word);
            set |= known.ok_or_else(|| wrong("events", word))?.0;
        }
        self.events.push(set);
        let known = Fault::ALL.into_iter().find(|f| f.name() == fault);
        if known.is_none() && !fault.is_empty() {
            return Err(wrong("fault", fault));
        }
        self.fault.push(known);
        self.brake.push(brake);
        Ok(())
    }
}
