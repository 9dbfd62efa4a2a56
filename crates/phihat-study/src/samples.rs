//! Reference samples from a CSV file: columns by joint name, checked row by row.

use core::f64::consts::TAU;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use phihat_model::NamedTexts;

use crate::arm::StudyArm;
use crate::entries::clip;
use crate::error::{StudyError, StudyErrorKind as Kind, TextPlace};
use crate::node::Node;
use crate::run::ReferenceRun;
use crate::study::ReferenceRequest;
use crate::suggest::nearest;

const BYTES_MAX: u64 = 256 << 20;
const LINE_MAX: u64 = 4096;
const COLUMNS_MAX: usize = 512;
const ROWS_MAX: usize = 1_000_000;

/// Samples that are joined by splines.
pub(crate) fn read(
    node: &Node<'_>,
    arm: &StudyArm,
    run: ReferenceRun<'_>,
) -> Result<ReferenceRequest, StudyError> {
    let SampledReference { t, q, unread } = rows(node, arm, run, Between::Moves)?;
    if let Some(&end) = t.last().filter(|&&end| end < run.duration - 1e-9) {
        let message = format!("the samples end at {end} s, the run at {} s", run.duration);
        return Err(node.error(Kind::Conflict, "file", message));
    }
    Ok(ReferenceRequest::Samples { t, q, unread })
}

/// The rows of the file that a section names.
pub(crate) fn rows(
    node: &Node<'_>,
    arm: &StudyArm,
    run: ReferenceRun<'_>,
    between: Between,
) -> Result<SampledReference, StudyError> {
    let name = node.word("file")?;
    let path = run.base.join(name);
    let shown = path.display().to_string();
    let joints = JointColumns { names: &arm.joints.names, locked: &arm.joints.locked };
    match opened(run.base.files, &path) {
        Ok(file) => SamplesTable::new(&shown, file, joints).read(Some(arm), between),
        Err(Unopened::TooLarge(message)) => Err(node.error(Kind::TooLarge, "file", message)),
        Err(Unopened::Unreadable(why)) => {
            let message = format!("`{}`: {why}", clip(name));
            Err(node.error(Kind::Unreadable, "file", message).with_help(run.base.beside(&path)))
        }
    }
}

/// Times \[s\], and one row of positions \[rad, m\] for each.
pub type Samples = (Vec<f64>, Vec<Vec<f64>>);

/// Reads a motion (CSV: `t_s` and every joint's name, in any order) for these joints, in their order; columns of other
/// joints are left out; nothing of an arm's limits is checked, and positions are taken as they are.
///
/// # Errors
///
/// [`StudyError`] with file, line and column: the file cannot be read, a column is missing, a cell is no finite
/// number, or the times do not begin at 0 and grow.
pub fn motion_samples(path: &Path, joints: &[String]) -> Result<Samples, StudyError> {
    let shown = path.display().to_string();
    match opened(&NamedTexts::DISK, path) {
        Ok(file) => {
            let joints = JointColumns { names: joints, locked: &[] };
            let read = SamplesTable::new(&shown, file, joints).read(None, Between::Moves)?;
            Ok((read.t, read.q))
        }
        Err(Unopened::TooLarge(why) | Unopened::Unreadable(why)) => {
            Err(StudyError::new(Kind::Unreadable, TextPlace::whole_file(&shown), "", why))
        }
    }
}

/// Why a file is not opened.
enum Unopened {
    TooLarge(String),
    Unreadable(String),
}

fn opened(files: &NamedTexts, path: &Path) -> Result<impl BufRead + use<>, Unopened> {
    let unreadable = |error: std::io::Error| Unopened::Unreadable(error.to_string());
    let (file, size) = files.open(path).map_err(unreadable)?;
    if size > BYTES_MAX {
        return Err(Unopened::TooLarge(format!("{size} bytes, at most {BYTES_MAX}")));
    }
    Ok(BufReader::new(file.take(BYTES_MAX)))
}

/// Joints of the columns.
#[derive(Debug, Clone, Copy)]
struct JointColumns<'a> {
    names: &'a [String],
    /// Joints that no column may have.
    locked: &'a [String],
}

/// Motion from one row to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Between {
    /// The rows are passed in their time, so that the way between them must keep the speed limits.
    Moves,
    /// A row may be anywhere.
    Jumps,
}

/// Times, one row of positions for each, and the columns that are no joint's.
pub(crate) struct SampledReference {
    pub(crate) t: Vec<f64>,
    pub(crate) q: Vec<Vec<f64>>,
    pub(crate) unread: Vec<String>,
}

/// Content of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    Time,
    Joint(usize),
    /// Of no joint of the arm, such as a gripper's: not read.
    Other,
}

/// A CSV file while it is read; knows the line it is at.
struct SamplesTable<'f, R> {
    file: &'f str,
    joints: JointColumns<'f>,
    reader: R,
    line: String,
    number: usize,
    /// Byte at which the line begins.
    start: usize,
}

impl<'f, R: BufRead> SamplesTable<'f, R> {
    fn new(file: &'f str, reader: R, joints: JointColumns<'f>) -> Self {
        Self { file, joints, reader, line: String::new(), number: 0, start: 0 }
    }

    /// All rows, checked against an arm's limits where there is one.
    fn read(
        &mut self,
        arm: Option<&StudyArm>,
        between: Between,
    ) -> Result<SampledReference, StudyError> {
        if !self.next_line()? {
            let place = TextPlace::whole_file(self.file);
            return Err(StudyError::new(Kind::Syntax, place, "", "the file is empty"));
        }
        let columns = self.header()?;
        let names = cells(&self.line);
        let others = columns.iter().zip(names).filter(|(column, _)| **column == Column::Other);
        let unread: Vec<String> = others.map(|(_, name)| clip(name)).collect();
        let (mut t, mut q) = (Vec::<f64>::new(), Vec::<Vec<f64>>::new());
        while self.next_line()? {
            if self.line.trim().is_empty() {
                continue;
            }
            let (time, mut row) = self.row(&columns, self.joints.names.len())?;
            if let (Some(before), Some(arm)) = (q.last(), arm) {
                take_the_near_way(arm, before, &mut row);
            }
            self.check_time(t.last().copied(), time)?;
            let before = t.last().copied().zip(q.last().map(Vec::as_slice));
            let before = before.filter(|_| between == Between::Moves);
            if let Some(arm) = arm {
                self.check_row(arm, &columns, before, (time, &row))?;
            }
            if t.len() == ROWS_MAX {
                let message = format!("more than {ROWS_MAX} rows");
                return Err(self.error(Kind::TooLarge, 0, message));
            }
            t.push(time);
            q.push(row);
        }
        if t.len() < 2 && between == Between::Moves {
            return Err(self.error(Kind::WrongLength, 0, "expected at least 2 rows of samples"));
        }
        if t.is_empty() {
            return Err(self.error(Kind::WrongLength, 0, "expected at least one row of samples"));
        }
        Ok(SampledReference { t, q, unread })
    }

    /// Reads the next line into `line`; `false` at the end.
    fn next_line(&mut self) -> Result<bool, StudyError> {
        self.start += if self.number == 0 { 0 } else { self.line.len() + 1 };
        let mut bytes = Vec::new();
        let read = self.reader.by_ref().take(LINE_MAX + 1).read_until(b'\n', &mut bytes);
        let count = read.map_err(|error| {
            let place = TextPlace::whole_file(self.file);
            StudyError::new(Kind::Unreadable, place, "", error.to_string())
        })?;
        if count == 0 {
            return Ok(false);
        }
        self.number += 1;
        let text = String::from_utf8(bytes);
        let is_text = text.is_ok();
        self.line = text.unwrap_or_default();
        if !is_text {
            return Err(self.error(Kind::Syntax, 0, "not UTF-8 text"));
        }
        if count as u64 > LINE_MAX {
            return Err(self.error(Kind::TooLarge, 0, format!("longer than {LINE_MAX} bytes")));
        }
        if self.line.ends_with('\n') {
            self.line.pop();
        }
        Ok(true)
    }

    fn header(&self) -> Result<Vec<Column>, StudyError> {
        let cells = cells(&self.line);
        if cells.len() > COLUMNS_MAX {
            return Err(self.error(Kind::TooLarge, 0, format!("more than {COLUMNS_MAX} columns")));
        }
        if cells.len() == 1 && self.line.contains([';', '\t']) {
            let message = "expected columns separated by commas";
            return Err(self.error(Kind::Syntax, 0, message));
        }
        let mut columns: Vec<Column> = Vec::with_capacity(cells.len());
        for (i, cell) in cells.iter().enumerate() {
            let column = self.column(i, cell)?;
            if column != Column::Other && columns.contains(&column) {
                let message = format!("column `{}` appears twice", clip(cell));
                return Err(self.error(Kind::Conflict, i, message));
            }
            columns.push(column);
        }
        let names = self.joints.names;
        let missing = (0..names.len()).find(|&j| !columns.contains(&Column::Joint(j)));
        let missing = missing.map(|j| names[j].as_str());
        let Some(name) = missing.or((!columns.contains(&Column::Time)).then_some("t_s")) else {
            return Ok(columns);
        };
        // A column of no joint may be the one that is missing, by another name.
        let other = |i: &usize| columns[*i] == Column::Other;
        let others: Vec<usize> = (0..columns.len()).filter(other).collect();
        let near = nearest(name, others.iter().map(|i| cells[*i]));
        if let Some(i) = others.iter().copied().find(|i| near == Some(cells[*i])) {
            let message = format!("no joint `{}`", clip(cells[i]));
            let help = format!("did you mean `{name}`?");
            return Err(self.error(Kind::UnknownName, i, message).with_help(help));
        }
        let others: Vec<String> =
            others.iter().map(|i| format!(", `{}`", clip(cells[*i]))).collect();
        let others = match &others[..] {
            [] => String::new(),
            some => format!("; no joint's: {}", some.concat().trim_start_matches(", ")),
        };
        let first = names.join(",");
        let help = format!("the first line is `t_s,{first}`, in any order{others}");
        Err(self.error(Kind::WrongLength, 0, format!("no column `{name}`")).with_help(help))
    }

    fn column(&self, i: usize, cell: &str) -> Result<Column, StudyError> {
        if cell == "t_s" {
            return Ok(Column::Time);
        }
        if let Some(j) = self.joints.names.iter().position(|name| name == cell) {
            return Ok(Column::Joint(j));
        }
        if self.joints.locked.iter().any(|name| name == cell) {
            let message = format!("joint `{}` is locked", clip(cell));
            let help = "leave its column out, or take it out of robot.locked";
            return Err(self.error(Kind::UnknownName, i, message).with_help(help));
        }
        if cell.parse::<f64>().is_ok() {
            let message = format!("no joint `{}`", clip(cell));
            let help = "the first line names the columns";
            return Err(self.error(Kind::UnknownName, i, message).with_help(help));
        }
        Ok(Column::Other)
    }

    fn row(&self, columns: &[Column], joints: usize) -> Result<(f64, Vec<f64>), StudyError> {
        let cells = cells(&self.line);
        if cells.len() != columns.len() {
            let message = format!("{} columns, the first line has {}", cells.len(), columns.len());
            return Err(self.error(Kind::WrongLength, 0, message));
        }
        let (mut t, mut q) = (0.0, vec![0.0; joints]);
        let read = cells.iter().zip(columns).enumerate();
        for (i, (cell, column)) in read.filter(|(_, (_, column))| **column != Column::Other) {
            let x: f64 = cell.parse().map_err(|_| {
                let error = format!("`{}` is not a number", clip(cell));
                self.error(Kind::WrongType, i, error).with_help("a finite number, such as 0.25")
            })?;
            if !x.is_finite() {
                let message = format!("{x} is not a finite number");
                return Err(self.error(Kind::OutOfRange, i, message));
            }
            match *column {
                Column::Time => t = x,
                Column::Joint(j) => q[j] = x,
                Column::Other => {}
            }
        }
        Ok((t, q))
    }

    fn check_time(&self, before: Option<f64>, time: f64) -> Result<(), StudyError> {
        let message = match before {
            None if time.abs() > 0.0 => format!("the first sample is at {time} s, expected 0"),
            Some(before) if time <= before => {
                format!("{time} s is not after the row before it, at {before} s")
            }
            _ => return Ok(()),
        };
        Err(self.error(Kind::OutOfRange, 0, message))
    }

    fn check_row(
        &self,
        arm: &StudyArm,
        columns: &[Column],
        before: Option<(f64, &[f64])>,
        (time, row): (f64, &[f64]),
    ) -> Result<(), StudyError> {
        for (j, &q) in row.iter().enumerate() {
            let name = &arm.joints.names[j];
            let fact = if let Some(limits) = arm.outside(j, q) {
                format!("{q} is outside its limits {limits}")
            } else {
                let Some((t, from)) = before else { continue };
                let speed = (q - from[j]).abs() / (time - t);
                let Some(limit) = arm.too_fast(j, speed) else { continue };
                let turned = arm.robot.joints[j].turns() && (q - from[j]).abs() > WHOLE_TURN;
                let turn = if turned {
                    ": a jump of a whole turn, from one side of ±π to the other"
                } else {
                    ""
                };
                format!("{speed:.4} rad/s since the row before, beyond its limit {limit}{turn}")
            };
            let column = columns.iter().position(|&column| column == Column::Joint(j));
            let message = format!("joint `{name}`: {fact}");
            return Err(self.error(Kind::BeyondLimits, column.unwrap_or_default(), message));
        }
        Ok(())
    }

    /// An error at column `i` of the line.
    fn error(&self, kind: Kind, i: usize, message: impl Into<String>) -> StudyError {
        let (mut from, mut length) = (0, self.line.trim_end().len());
        if let Some(cell) = self.line.split(',').nth(i).filter(|_| i > 0 || self.number > 1) {
            from = self.line.split(',').take(i).map(|cell| cell.len() + 1).sum();
            length = cell.trim_end().len();
        }
        let column = self.line.get(..from).map_or(1, |text| text.chars().count() + 1);
        let span = self.start + from..self.start + from + length.max(1);
        let place = TextPlace {
            file: self.file.into(),
            line: self.number,
            column,
            span,
            line_text: self.line.trim_end().into(),
        };
        StudyError::new(kind, place, "", message)
    }
}

/// Smallest jump of a reading that starts over \[rad\].
const WHOLE_TURN: f64 = 0.9 * TAU;

/// Positions of joints without ends become those nearest to the row before: a file may start over at ±π.
fn take_the_near_way(arm: &StudyArm, before: &[f64], row: &mut [f64]) {
    for ((joint, from), q) in arm.robot.joints.iter().zip(before).zip(row) {
        if joint.turns() && joint.position.is_none() {
            *q += TAU * ((from - *q) / TAU).round();
        }
    }
}

/// Cells without the blanks and quotes around them; a byte-order mark is no part of the first.
fn cells(line: &str) -> Vec<&str> {
    let line = line.trim_start_matches('\u{feff}').trim_end();
    line.split(',').map(unquote).collect()
}

fn unquote(cell: &str) -> &str {
    let cell = cell.trim();
    cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')).unwrap_or(cell)
}
