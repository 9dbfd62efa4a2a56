//! The trace as CSV: one row per sample and joint, units in the header.

use std::io::{Read, Write};

use phihat::{Events, Fault, Mode};
use phihat_study::Study;
use thiserror::Error;

use crate::recorder::Recorder;
use crate::trace::{COLUMNS, JointTrace, Supervision, Trace};

/// Why a trace file cannot be read.
#[derive(Debug, Error)]
pub enum TraceError {
    /// The file is not CSV, or reading failed.
    #[error("{0}")]
    Csv(#[from] csv::Error),
    /// The header is not that of a trace.
    #[error("line 1: column {column} is {found:?}; a trace has {expected:?} there")]
    Header {
        /// Which column, from 1.
        column: usize,
        /// What is there.
        found: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// A field does not read.
    #[error("line {line}: {column} is {value:?}; {expected}")]
    Field {
        /// Line, from 1.
        line: u64,
        /// Column name.
        column: &'static str,
        /// What is there.
        value: String,
        /// What would be valid.
        expected: &'static str,
    },
    /// The rows do not form whole samples.
    #[error("line {line}: {reason}")]
    Rows {
        /// Line, from 1.
        line: u64,
        /// What is wrong.
        reason: String,
    },
}

/// Samples that are written or read at once where a run may be long.
pub const BLOCK: usize = 4096;

/// A trace that is written as it comes.
#[derive(Debug)]
pub struct TraceWriter<W: Write> {
    csv: csv::Writer<W>,
    begun: bool,
}

impl<W: Write> TraceWriter<W> {
    /// A writer before its first block.
    pub fn new(writer: W) -> Self {
        Self { csv: csv::Writer::from_writer(writer), begun: false }
    }

    /// Writes the next samples; the names of the columns come before the first.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn block(&mut self, trace: &Trace) -> Result<(), TraceError> {
        let csv = &mut self.csv;
        if !self.begun {
            csv.write_record(header(trace.supervision.is_some()))?;
            self.begun = true;
        }
        let mut number = String::new();
        for k in 0..trace.len() {
            let time = seconds(trace.t_ns[k]);
            for joint in &trace.joints {
                csv.write_field(&time)?;
                csv.write_field(&joint.name)?;
                for column in &COLUMNS {
                    use std::fmt::Write as _;
                    number.clear();
                    let value = (column.get)(joint)[k];
                    // Infallible: a String takes everything.
                    let _ = write!(number, "{value:?}");
                    csv.write_field(&number)?;
                }
                csv.write_field(flag(joint.saturated[k]))?;
                csv.write_field(flag(joint.rate_limited[k]))?;
                if let Some(supervision) = &trace.supervision {
                    supervision.write(csv, k)?;
                }
                csv.write_record(None::<&[u8]>)?;
            }
        }
        Ok(())
    }

    /// Writes what is still held back; the writer, back.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn finish(self) -> Result<W, TraceError> {
        self.csv.into_inner().map_err(|e| TraceError::Csv(e.into_error().into()))
    }
}

impl<W: Write> Recorder for TraceWriter<W> {
    type Error = TraceError;

    fn room(&self, _: usize) -> usize {
        BLOCK
    }

    fn take(&mut self, block: &mut Trace) -> Result<(), TraceError> {
        self.block(block)
    }
}

impl Trace {
    /// Writes the trace as CSV: `t_s,joint,q_rad,…,saturated,rate_limited`, one row per sample and joint; with
    /// `mode,events,fault,brake` where there is a supervisor.
    /// Numbers are written so that they read back to the same bits.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn write_csv(&self, writer: impl Write) -> Result<(), TraceError> {
        let mut file = TraceWriter::new(writer);
        file.block(self)?;
        file.finish().map(drop)
    }

    /// Reads what [`Self::write_csv`] wrote of a study's arm: its joints, in their order, at its period, one sample at least.
    ///
    /// # Errors
    ///
    /// [`TraceError`], naming the line and the column.
    pub fn read_csv(reader: impl Read, study: &Study) -> Result<Self, TraceError> {
        let mut whole = Self::default();
        Self::read_csv_in(reader, study, usize::MAX, |block| whole = std::mem::take(block))?;
        Ok(whole)
    }

    /// Reads what [`Self::write_csv`] wrote, in blocks of at most so many samples, in their order.
    ///
    /// # Errors
    ///
    /// [`TraceError`], naming the line and the column; what was handed over before is not to be used.
    pub fn read_csv_in(
        reader: impl Read,
        study: &Study,
        block: usize,
        mut each: impl FnMut(&mut Self),
    ) -> Result<(), TraceError> {
        let mut csv = csv::Reader::from_reader(reader);
        let supervised = check_header(csv.headers()?)?;
        let period_ns = study.control.period_ns;
        let names: Vec<&str> = study.robot.joints.iter().map(|joint| joint.name.as_str()).collect();
        let joint = |name: &&str| JointTrace { name: (*name).to_owned(), ..JointTrace::default() };
        let joints = names.iter().map(joint).collect();
        let supervision = supervised.then(Supervision::default);
        let mut trace = Self { period_ns, t_ns: Vec::new(), joints, supervision };
        let mut record = csv::StringRecord::new();
        let (mut next, mut before) = (0, None);
        while csv.read_record(&mut record)? {
            if next == 0 && trace.len() >= block {
                each(&mut trace);
                trace.clear();
            }
            let line = record.position().map_or(0, csv::Position::line);
            let row = Row { line, record: &record };
            let t_ns = row.place(before, (next, &names), period_ns)?;
            if next == 0 {
                trace.t_ns.push(t_ns);
            }
            before = Some(t_ns);
            row.append(&mut trace.joints[next])?;
            if next == 0
                && let Some(supervision) = trace.supervision.as_mut()
            {
                row.supervision(supervision)?;
            }
            next = (next + 1) % names.len();
        }
        let line = csv.position().line();
        if before.is_none() {
            let reason = "no sample follows; a trace has one row per sample and joint".to_owned();
            return Err(TraceError::Rows { line, reason });
        }
        if next != 0 {
            let reason = format!("the last sample has no row for joint {}", names[next]);
            return Err(TraceError::Rows { line, reason });
        }
        each(&mut trace);
        Ok(())
    }
}

/// Names that are told, and characters of one that is none.
const SHOWN: usize = 12;
const CLIP: usize = 60;

fn listed(names: &[&str]) -> String {
    let more = if names.len() > SHOWN { ", …" } else { "" };
    format!("{}{more}", names[..names.len().min(SHOWN)].join(", "))
}

/// The columns of a supervised run.
const SUPERVISION: [&str; 4] = ["mode", "events", "fault", "brake"];

fn header(supervised: bool) -> impl Iterator<Item = &'static str> {
    ["t_s", "joint"]
        .into_iter()
        .chain(COLUMNS.iter().map(|c| c.name))
        .chain(["saturated", "rate_limited"])
        .chain(SUPERVISION.into_iter().filter(move |_| supervised))
}

/// Whether the trace is that of a supervised run.
fn check_header(found: &csv::StringRecord) -> Result<bool, TraceError> {
    let supervised = found.get(COLUMNS.len() + 4) == Some(SUPERVISION[0]);
    for (column, expected) in header(supervised).enumerate() {
        let name = found.get(column).unwrap_or("");
        if name != expected {
            return Err(TraceError::Header {
                column: column + 1,
                found: name.to_owned(),
                expected,
            });
        }
    }
    Ok(supervised)
}

impl Supervision {
    fn write(&self, csv: &mut csv::Writer<impl Write>, k: usize) -> Result<(), TraceError> {
        csv.write_field(self.mode[k].name())?;
        csv.write_field(self.events[k].names().collect::<Vec<_>>().join(" "))?;
        csv.write_field(self.fault[k].map_or("", Fault::name))?;
        csv.write_field(flag(self.brake[k]))?;
        Ok(())
    }
}

/// Nanoseconds as decimal seconds, exactly.
fn seconds(t_ns: u64) -> String {
    let text = format!("{}.{:09}", t_ns / 1_000_000_000, t_ns % 1_000_000_000);
    let trimmed = text.trim_end_matches('0');
    if trimmed.ends_with('.') { format!("{trimmed}0") } else { trimmed.to_owned() }
}

fn flag(value: bool) -> &'static str {
    if value { "1" } else { "0" }
}

struct Row<'a> {
    line: u64,
    record: &'a csv::StringRecord,
}

impl Row<'_> {
    fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or("")
    }

    /// Checks that a row is the next one: of this joint, at the time of its sample \[ns\], `before` being that of the row before.
    fn place(
        &self,
        before: Option<u64>,
        (joint, names): (usize, &[&str]),
        period_ns: u64,
    ) -> Result<u64, TraceError> {
        let wrong = |reason: String| Err(TraceError::Rows { line: self.line, reason });
        let (name, t_ns) = (self.text(1), self.time()?);
        if name != names[joint] {
            let (n, all) = (names.len(), listed(names));
            let name: String = name.chars().take(CLIP).collect();
            return wrong(format!(
                "joint {name:?} is not the next one, {:?}; the study's arm has {n}, in this order: {all}",
                names[joint]
            ));
        }
        let time = self.text(0);
        match (before, joint) {
            (Some(before), 0) if before.checked_add(period_ns) != Some(t_ns) => {
                let (before, period) = (seconds(before), seconds(period_ns));
                wrong(format!(
                    "time {time} s does not follow {before} s by the study's period, {period} s"
                ))
            }
            (Some(sample), 1..) if sample != t_ns => {
                let sample = seconds(sample);
                wrong(format!(
                    "time {time} s, in the sample of {sample} s: it has no row for joint {name} yet"
                ))
            }
            _ => Ok(t_ns),
        }
    }

    fn wrong(&self, column: &'static str, value: &str, expected: &'static str) -> TraceError {
        TraceError::Field { line: self.line, column, value: value.to_owned(), expected }
    }

    /// Decimal seconds to nanoseconds, without a detour through floating point.
    fn time(&self) -> Result<u64, TraceError> {
        let text = self.text(0);
        let wrong = || self.wrong("t_s", text, "seconds with at most 9 decimals are expected");
        let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
        let digits = |part: &str| part.bytes().all(|b| b.is_ascii_digit());
        if fraction.len() > 9 || !digits(fraction) || !digits(whole) {
            return Err(wrong());
        }
        let nanoseconds: u64 = format!("{fraction:0<9}").parse().map_err(|_| wrong())?;
        let seconds: u64 = whole.parse().map_err(|_| wrong())?;
        seconds
            .checked_mul(1_000_000_000)
            .and_then(|s| s.checked_add(nanoseconds))
            .ok_or_else(wrong)
    }

    fn append(&self, joint: &mut JointTrace) -> Result<(), TraceError> {
        for (i, column) in COLUMNS.iter().enumerate() {
            let text = self.text(i + 2);
            let value =
                text.parse().map_err(|_| self.wrong(column.name, text, "a number is expected"))?;
            (column.get_mut)(joint).push(value);
        }
        joint.saturated.push(self.flag(COLUMNS.len() + 2, "saturated")?);
        joint.rate_limited.push(self.flag(COLUMNS.len() + 3, "rate_limited")?);
        Ok(())
    }

    fn supervision(&self, into: &mut Supervision) -> Result<(), TraceError> {
        let [mode, events, fault] = [4, 5, 6].map(|i| self.text(COLUMNS.len() + i));
        let wrong = |name, value| self.wrong(name, value, "a word that phihat writes is expected");
        let known = Mode::ALL.into_iter().find(|m| m.name() == mode);
        into.mode.push(known.ok_or_else(|| wrong("mode", mode))?);
        let mut set = Events::NONE;
        for word in events.split(' ').filter(|word| !word.is_empty()) {
            let known = Events::ALL.iter().find(|(_, name)| *name == word);
            set |= known.ok_or_else(|| wrong("events", word))?.0;
        }
        into.events.push(set);
        let known = Fault::ALL.into_iter().find(|f| f.name() == fault);
        if known.is_none() && !fault.is_empty() {
            return Err(wrong("fault", fault));
        }
        into.fault.push(known);
        into.brake.push(self.flag(COLUMNS.len() + 7, "brake")?);
        Ok(())
    }

    fn flag(&self, column: usize, name: &'static str) -> Result<bool, TraceError> {
        match self.text(column) {
            "0" => Ok(false),
            "1" => Ok(true),
            other => Err(self.wrong(name, other, "0 or 1 is expected")),
        }
    }
}
