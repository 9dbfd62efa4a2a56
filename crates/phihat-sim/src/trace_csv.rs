//! The trace as CSV: one row per sample and joint, units in the header.

use std::io::{Read, Write};

use phihat_study::Study;

use crate::recorder::Recorder;
use crate::trace::{COLUMNS, JointTrace, Supervision, Trace};
use crate::trace_file::{
    BLOCK, FLAGS, OptionalColumns, Place, RowTurn, SHARE, SUPERVISION, TraceError, seconds, signals,
};

/// A trace that is written as CSV as it comes.
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
            csv.write_record(header(OptionalColumns::of(trace)))?;
            self.begun = true;
        }
        let mut number = String::new();
        for k in 0..trace.len() {
            let time = seconds(trace.t_ns[k]);
            for joint in &trace.joints {
                csv.write_field(&time)?;
                csv.write_field(&joint.name)?;
                let mut write = |csv: &mut csv::Writer<W>, value: f64| {
                    use std::fmt::Write as _;
                    number.clear();
                    // Infallible: a String takes everything.
                    let _ = write!(number, "{value:?}");
                    csv.write_field(&number)
                };
                for column in &COLUMNS {
                    write(csv, (column.get)(joint)[k])?;
                }
                csv.write_field(flag(joint.saturated[k]))?;
                csv.write_field(flag(joint.rate_limited[k]))?;
                if let Some(supervision) = &trace.supervision {
                    supervision.write(csv, k)?;
                }
                if let Some(share) = joint.error_share.get(k) {
                    write(csv, *share)?;
                }
                csv.write_record(None::<&[u8]>)?;
            }
        }
        Ok(())
    }

    /// Writes what is still held back, and goes on.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn flush(&mut self) -> Result<(), TraceError> {
        self.csv.flush().map_err(TraceError::from)
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
    /// `mode,events,fault,brake` where there is a supervisor, and `error_share` where there is a certified bound.
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

    /// Reads the trace of a study's arm that [`Self::write_csv`] wrote: its joints, in their order, at its
    /// period, one sample at least.
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
        let OptionalColumns { supervised, bounded } = check_header(csv.headers()?)?;
        let (mut trace, mut turn) = (Self::of(study, supervised), RowTurn::of(study));
        let share = bounded.then_some(share_place(supervised));
        let mut record = csv::StringRecord::new();
        while csv.read_record(&mut record)? {
            if turn.next == 0 && trace.len() >= block {
                each(&mut trace);
                trace.clear();
            }
            let place = Place::Line(record.position().map_or(0, csv::Position::line));
            let row = CsvRow { place, record: &record };
            let t_ns = row.time()?;
            let joint = turn.row(place, row.text(1), t_ns)?;
            if joint == 0 {
                trace.t_ns.push(t_ns);
            }
            row.append(&mut trace.joints[joint], share)?;
            if joint == 0
                && let Some(supervision) = trace.supervision.as_mut()
            {
                let words = [4, 5, 6].map(|i| row.text(COLUMNS.len() + i));
                let brake = row.flag(COLUMNS.len() + 7, SUPERVISION[3])?;
                supervision.append(place, words, brake)?;
            }
        }
        turn.ended(Place::Line(csv.position().line()))?;
        each(&mut trace);
        Ok(())
    }
}

fn header(optional: OptionalColumns) -> impl Iterator<Item = &'static str> {
    ["t_s", "joint"].into_iter().chain(signals(optional))
}

/// Place of the share of a bound.
fn share_place(supervised: bool) -> usize {
    COLUMNS.len() + 4 + if supervised { SUPERVISION.len() } else { 0 }
}

/// Checks the header; returns which of the columns that not every trace has are there.
fn check_header(found: &csv::StringRecord) -> Result<OptionalColumns, TraceError> {
    let supervised = found.get(COLUMNS.len() + 4) == Some(SUPERVISION[0]);
    let bounded = found.get(share_place(supervised)) == Some(SHARE);
    let optional = OptionalColumns { supervised, bounded };
    for (column, expected) in header(optional).enumerate() {
        let name = found.get(column).unwrap_or("");
        if name != expected {
            return Err(TraceError::Header {
                column: column + 1,
                found: name.to_owned(),
                expected,
            });
        }
    }
    Ok(optional)
}

impl Supervision {
    fn write(&self, csv: &mut csv::Writer<impl Write>, k: usize) -> Result<(), TraceError> {
        let (mode, events, fault) = self.words(k);
        csv.write_field(mode)?;
        csv.write_field(events)?;
        csv.write_field(fault)?;
        csv.write_field(flag(self.brake[k]))?;
        Ok(())
    }
}

fn flag(value: bool) -> &'static str {
    if value { "1" } else { "0" }
}

struct CsvRow<'a> {
    place: Place,
    record: &'a csv::StringRecord,
}

impl CsvRow<'_> {
    fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or("")
    }

    fn wrong(&self, column: &'static str, value: &str, expected: &'static str) -> TraceError {
        TraceError::Field { place: self.place, column, value: value.to_owned(), expected }
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

    fn append(&self, joint: &mut JointTrace, share: Option<usize>) -> Result<(), TraceError> {
        for (i, column) in COLUMNS.iter().enumerate() {
            (column.get_mut)(joint).push(self.number(i + 2, column.name)?);
        }
        if let Some(share) = share {
            joint.error_share.push(self.number(share, SHARE)?);
        }
        joint.saturated.push(self.flag(COLUMNS.len() + 2, FLAGS[0])?);
        joint.rate_limited.push(self.flag(COLUMNS.len() + 3, FLAGS[1])?);
        Ok(())
    }

    fn number(&self, column: usize, name: &'static str) -> Result<f64, TraceError> {
        let text = self.text(column);
        text.parse().map_err(|_| self.wrong(name, text, "a number is expected"))
    }

    fn flag(&self, column: usize, name: &'static str) -> Result<bool, TraceError> {
        match self.text(column) {
            "0" => Ok(false),
            "1" => Ok(true),
            other => Err(self.wrong(name, other, "0 or 1 is expected")),
        }
    }
}
