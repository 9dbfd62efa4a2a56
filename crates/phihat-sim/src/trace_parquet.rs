//! The trace as Parquet: the rows and columns of the CSV file, typed and compressed.

use core::ops::Range;
use std::io::{self, Write};

use parquet::data_type::ByteArray;
use phihat_study::Study;

use crate::columnar::{ChunkReader, ParquetTable, TableWriter, Texts, ValueKind, Values};
use crate::recorder::Recorder;
use crate::trace::{COLUMNS, JointTrace, Supervision, Trace};
use crate::trace_file::{
    BLOCK, FLAGS, OptionalColumns, Place, RowTurn, SHARE, SUPERVISION, TraceError, signals,
};

/// Rows that are looked at together.
const ROWS: usize = 1024;

/// A trace that is written as Parquet as it comes: `t_ns, joint, q_rad, …, saturated, rate_limited`, one row
/// per sample and joint, `mode, events, fault, brake` where there is a supervisor, and `error_share` where there is a
/// certified bound. A row group has 4096 samples, in whatever blocks they come.
#[expect(missing_debug_implementations, reason = "the package's writer has none")]
pub struct ParquetTrace<W: Write + Send> {
    file: ParquetBegin<W>,
    /// Samples of a row group that is not full.
    held: Trace,
}

/// A file of which the first block says which columns it has.
enum ParquetBegin<W: Write + Send> {
    Not(Option<W>),
    Yes(TableWriter<W>),
}

impl<W: Write + Send> ParquetTrace<W> {
    /// A writer before its first block.
    pub fn new(writer: W) -> Self {
        Self { file: ParquetBegin::Not(Some(writer)), held: Trace::default() }
    }

    /// Writes the next samples.
    ///
    /// # Errors
    ///
    /// The writer's; a time is beyond 292 years.
    pub fn block(&mut self, trace: &Trace) -> io::Result<()> {
        let file = self.file.begin(trace)?;
        let mut at = 0;
        while at < trace.len() {
            let end = trace.len().min(at + BLOCK - self.held.len());
            if self.held.is_empty() && end - at == BLOCK {
                group(file, trace, at..end)?;
            } else {
                self.held.append(trace, at..end);
            }
            if self.held.len() == BLOCK {
                group(file, &self.held, 0..BLOCK)?;
                self.held.clear();
            }
            at = end;
        }
        Ok(())
    }

    /// Writes what is still held back and closes the file; the writer, back.
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn finish(mut self) -> io::Result<W> {
        let file = self.file.begin(&Trace::default())?;
        if !self.held.is_empty() {
            group(file, &self.held, 0..self.held.len())?;
        }
        match self.file {
            ParquetBegin::Yes(file) => file.finish(),
            ParquetBegin::Not(_) => Err(unfinished()),
        }
    }
}

impl<W: Write + Send> ParquetBegin<W> {
    /// The file, begun with a trace's columns where it was not.
    fn begin(&mut self, trace: &Trace) -> io::Result<&mut TableWriter<W>> {
        if let Self::Not(writer) = self {
            let writer = writer.take().ok_or_else(unfinished)?;
            let all: Vec<_> = columns(OptionalColumns::of(trace)).collect();
            *self = Self::Yes(TableWriter::begin(writer, &all)?);
        }
        match self {
            Self::Yes(file) => Ok(file),
            Self::Not(_) => Err(unfinished()),
        }
    }
}

fn unfinished() -> io::Error {
    io::Error::other("its beginning could not be written")
}

/// Writes some samples as one row group.
fn group<W: Write + Send>(
    file: &mut TableWriter<W>,
    trace: &Trace,
    samples: Range<usize>,
) -> io::Result<()> {
    let n = trace.joints.len();
    let t_ns: Result<Vec<i64>, _> =
        trace.t_ns[samples.clone()].iter().map(|t_ns| i64::try_from(*t_ns)).collect();
    let t_ns = t_ns.map_err(|_| io::Error::other("a time is beyond 292 years"))?;
    let names: Vec<ByteArray> = trace.joints.iter().map(|joint| text(&joint.name)).collect();
    file.group(|group| {
        group.integers(&spread(t_ns.into_iter(), n))?;
        group.texts(&samples.clone().flat_map(|_| names.iter().cloned()).collect::<Vec<_>>())?;
        for column in &COLUMNS {
            group.numbers(&rows(trace, &samples, column.get))?;
        }
        group.flags(&rows(trace, &samples, |joint| &joint.saturated))?;
        group.flags(&rows(trace, &samples, |joint| &joint.rate_limited))?;
        if let Some(supervision) = &trace.supervision {
            let told: Vec<_> = samples.clone().map(|k| supervision.words(k)).collect();
            group.texts(&spread(told.iter().map(|(mode, ..)| text(mode)), n))?;
            group.texts(&spread(told.iter().map(|(_, events, _)| text(events)), n))?;
            group.texts(&spread(told.iter().map(|(.., fault)| text(fault)), n))?;
            group.flags(&spread(supervision.brake[samples.clone()].iter().copied(), n))?;
        }
        if trace.is_bounded() {
            group.numbers(&rows(trace, &samples, |joint| &joint.error_share))?;
        }
        Ok(())
    })
}

fn text(text: &str) -> ByteArray {
    text.to_owned().into_bytes().into()
}

/// A value of each sample, for every joint of it.
fn spread<T: Clone>(values: impl Iterator<Item = T>, joints: usize) -> Vec<T> {
    values.flat_map(|value| std::iter::repeat_n(value, joints)).collect()
}

/// The values of a signal in the order of the rows.
fn rows<T: Copy>(
    trace: &Trace,
    samples: &Range<usize>,
    signal: fn(&JointTrace) -> &Vec<T>,
) -> Vec<T> {
    let columns: Vec<&[T]> = trace.joints.iter().map(|joint| signal(joint).as_slice()).collect();
    samples.clone().flat_map(|k| columns.iter().map(move |column| column[k])).collect()
}

impl<W: Write + Send> Recorder for ParquetTrace<W> {
    type Error = io::Error;

    fn room(&self, _: usize) -> usize {
        BLOCK
    }

    fn take(&mut self, block: &mut Trace) -> io::Result<()> {
        self.block(block)
    }
}

impl Trace {
    /// Writes the trace as Parquet; see [`ParquetTrace`].
    ///
    /// # Errors
    ///
    /// The writer's.
    pub fn write_parquet(&self, writer: impl Write + Send) -> io::Result<()> {
        let mut file = ParquetTrace::new(writer);
        file.block(self)?;
        file.finish().map(drop)
    }

    /// Reads the trace of a study's arm that [`Self::write_parquet`] wrote, in blocks of at most so many
    /// samples, in their order: its joints, in their order, at its period, one sample at least. The columns
    /// may stand in any order, and among others; any program may have written them.
    ///
    /// # Errors
    ///
    /// [`TraceError`], naming the row, from 1, and the column; what was handed over before is not to be used.
    pub fn read_parquet_in(
        file: impl ChunkReader + 'static,
        study: &Study,
        block: usize,
        mut each: impl FnMut(&mut Self),
    ) -> Result<(), TraceError> {
        let table = ParquetTable::open(file)?;
        let supervised = table.place(SUPERVISION[0]).is_some();
        let bounded = table.place(SHARE).is_some();
        let mut places = Vec::new();
        for (column, kind) in columns(OptionalColumns { supervised, bounded }) {
            let there = table.place(column);
            let there =
                there.filter(|at| table.columns().nth(*at).is_some_and(|c| c.1 == Some(kind)));
            places.push(there.ok_or(TraceError::Column { column, expected: kind.name() })?);
        }
        let (mut trace, mut turn) = (Self::of(study, supervised), RowTurn::of(study));
        table.read(&places, ROWS, |first, values| {
            let rows = ParquetRows::of(first, values)?;
            for row in 0..rows.t_ns.len() {
                if turn.next == 0 && trace.len() >= block {
                    each(&mut trace);
                    trace.clear();
                }
                rows.append(row, &mut turn, &mut trace)?;
            }
            Ok::<(), TraceError>(())
        })?;
        turn.ended(Place::Row(table.rows()))?;
        each(&mut trace);
        Ok(())
    }
}

/// The columns of a trace and what they hold.
fn columns(optional: OptionalColumns) -> impl Iterator<Item = (&'static str, ValueKind)> {
    let [mode, events, fault, brake] = SUPERVISION;
    let kind = move |name: &'static str| {
        let kind = if FLAGS.contains(&name) || name == brake {
            ValueKind::Flags
        } else if [mode, events, fault].contains(&name) {
            ValueKind::Texts
        } else {
            ValueKind::Numbers
        };
        (name, kind)
    };
    let first = [("t_ns", ValueKind::Integers), ("joint", ValueKind::Texts)];
    first.into_iter().chain(signals(optional).map(kind))
}

/// Some rows of the file, by column.
struct ParquetRows<'a> {
    first: u64,
    t_ns: &'a [i64],
    joint: &'a Texts,
    numbers: Vec<&'a [f64]>,
    flags: Vec<&'a [bool]>,
    words: Vec<&'a Texts>,
}

impl<'a> ParquetRows<'a> {
    fn of(first: u64, values: &'a [Values]) -> Result<Self, TraceError> {
        let [Values::Integers(t_ns), Values::Texts(joint), signals @ ..] = values else {
            return Err(TraceError::Column {
                column: "t_ns",
                expected: ValueKind::Integers.name(),
            });
        };
        let mut rows =
            Self { first, t_ns, joint, numbers: Vec::new(), flags: Vec::new(), words: Vec::new() };
        for signal in signals {
            match signal {
                Values::Numbers(values) => rows.numbers.push(values),
                Values::Flags(values) => rows.flags.push(values),
                Values::Texts(values) => rows.words.push(values),
                Values::Integers(_) => {}
            }
        }
        Ok(rows)
    }

    /// Adds a row to the trace, if it is the next one.
    fn append(&self, row: usize, turn: &mut RowTurn, trace: &mut Trace) -> Result<(), TraceError> {
        let place = Place::Row(self.first + row as u64 + 1);
        let t_ns = u64::try_from(self.t_ns[row]).map_err(|_| TraceError::Field {
            place,
            column: "t_ns",
            value: self.t_ns[row].to_string(),
            expected: "no time is negative",
        })?;
        let at = turn.row(place, self.joint.get(row), t_ns)?;
        let joint = &mut trace.joints[at];
        for (column, values) in COLUMNS.iter().zip(&self.numbers) {
            (column.get_mut)(joint).push(values[row]);
        }
        if let Some(shares) = self.numbers.get(COLUMNS.len()) {
            joint.error_share.push(shares[row]);
        }
        joint.saturated.push(self.flags[0][row]);
        joint.rate_limited.push(self.flags[1][row]);
        if at == 0 {
            trace.t_ns.push(t_ns);
            if let Some(supervision) = &mut trace.supervision {
                let words = [0, 1, 2].map(|word: usize| self.words[word].get(row));
                Supervision::append(supervision, place, words, self.flags[2][row])?;
            }
        }
        Ok(())
    }
}
