//! The one error of this crate: what is wrong, where, and what would be right.

use std::fmt;
use std::ops::Range;

/// Characters of a source line that [`StudyError::render`] shows at most.
const WINDOW: usize = 96;

/// Kind of an error; the message has the particulars.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StudyErrorKind {
    /// A file could not be opened or read.
    Unreadable,
    /// A file is larger, or has more parts, than this crate admits.
    TooLarge,
    /// The text is not TOML, or a CSV line is not a row of the table.
    Syntax,
    /// A key that no study has.
    UnknownKey,
    /// A known key with another unit in its name, or with none.
    WrongUnit,
    /// A key without which there is no study.
    MissingKey,
    /// A value of another type than the key's.
    WrongType,
    /// An array, or a table by joint name, with too few or too many entries.
    WrongLength,
    /// A number outside what is possible, NaN and infinity included.
    OutOfRange,
    /// A name (joint, frame, pose, robot, kind, …) that is not known.
    UnknownName,
    /// Two statements that cannot both hold.
    Conflict,
    /// A position, velocity or time that the arm cannot have.
    BeyondLimits,
    /// The robot's own description was refused.
    Robot,
}

/// Why a study was refused: one fact, with its place in the file.
///
/// `Display` gives one line, [`render`](Self::render) also shows the line of the file.
///
/// # Example
///
/// ```
/// let text = "duration_s = 1.0\nseeed = 2\n";
/// let error = phihat_study::Study::from_text(text, "demo.toml", "".as_ref()).unwrap_err();
/// assert_eq!(error.to_string(), "demo.toml:2:1: seeed: unknown key; did you mean `seed`?");
/// assert_eq!((error.line(), error.span()), (2, 17..22));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudyError {
    inner: Box<Inner>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Inner {
    kind: StudyErrorKind,
    place: TextPlace,
    key: String,
    message: String,
    help: Option<String>,
}

/// A place in a text file, with the line it is on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TextPlace {
    pub(crate) file: String,
    /// From 1; 0 where the whole file is meant.
    pub(crate) line: usize,
    /// From 1, in characters; 0 where the whole file is meant.
    pub(crate) column: usize,
    pub(crate) span: Range<usize>,
    pub(crate) line_text: String,
}

impl TextPlace {
    pub(crate) fn whole_file(file: &str) -> Self {
        Self { file: file.into(), line: 0, column: 0, span: 0..0, line_text: String::new() }
    }
}

impl StudyError {
    pub(crate) fn new(
        kind: StudyErrorKind,
        place: TextPlace,
        key: impl Into<String>,
        message: impl Into<String>,
    ) -> Self {
        let (key, message) = (printable(&key.into()), printable(&message.into()));
        Self { inner: Box::new(Inner { kind, place, key, message, help: None }) }
    }

    pub(crate) fn with_help(mut self, help: impl Into<String>) -> Self {
        let help = printable(&help.into());
        self.inner.help = (!help.is_empty()).then_some(help);
        self
    }

    /// Kind of the error.
    pub fn kind(&self) -> StudyErrorKind {
        self.inner.kind
    }

    /// The file meant: the study, or a file it names.
    pub fn file(&self) -> &str {
        &self.inner.place.file
    }

    /// Line, from 1; 0 where the whole file is meant.
    pub fn line(&self) -> usize {
        self.inner.place.line
    }

    /// Column, from 1, in characters; 0 where the whole file is meant.
    pub fn column(&self) -> usize {
        self.inner.place.column
    }

    /// Bytes of the file that are meant.
    pub fn span(&self) -> Range<usize> {
        self.inner.place.span.clone()
    }

    /// Dotted path of the key, as in `gains.inertia_kg_m2[2]`; empty where no key is meant.
    pub fn key(&self) -> &str {
        &self.inner.key
    }

    /// The fact, in lower case, without a full stop.
    pub fn message(&self) -> &str {
        &self.inner.message
    }

    /// Correction, if one can be suggested.
    pub fn help(&self) -> Option<&str> {
        self.inner.help.as_deref()
    }

    /// The error on several lines: the fact, the line of the file with the place marked, the help.
    ///
    /// ```text
    /// error: loop.rate_khz: unknown key: the unit here is Hz
    ///   --> studies/x.toml:12:1
    ///    |
    /// 12 | rate_khz = 1.0
    ///    | ^^^^^^^^
    ///    = help: write `rate_hz`
    /// ```
    pub fn render(&self) -> String {
        let place = &self.inner.place;
        let number = place.line.to_string();
        let margin = " ".repeat(number.len());
        let mut lines = vec![format!("error: {}", self.fact())];
        if place.line == 0 {
            lines.push(format!("{margin} --> {}", place.file));
        } else {
            let (text, start, length) = window(place);
            lines.push(format!("{margin} --> {}:{}:{}", place.file, place.line, place.column));
            lines.push(format!("{margin} |"));
            lines.push(format!("{number} | {text}"));
            lines.push(format!("{margin} | {}{}", " ".repeat(start), "^".repeat(length)));
        }
        lines.extend(self.help().map(|help| format!("{margin} = help: {help}")));
        lines.join("\n")
    }

    fn fact(&self) -> String {
        let Inner { key, message, .. } = &*self.inner;
        if key.is_empty() { message.clone() } else { format!("{key}: {message}") }
    }
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = &self.inner.place;
        f.write_str(&place.file)?;
        if place.line > 0 {
            write!(f, ":{}:{}", place.line, place.column)?;
        }
        write!(f, ": {}", self.fact())?;
        self.help().map_or(Ok(()), |help| write!(f, "; {help}"))
    }
}

impl std::error::Error for StudyError {}

/// The part of the line around the place, the column of the mark in it, and the mark's length.
fn window(place: &TextPlace) -> (String, usize, usize) {
    let characters: Vec<char> = printable(&place.line_text).chars().collect();
    let column = place.column.saturating_sub(1).min(characters.len());
    let from = if characters.len() <= WINDOW { 0 } else { column.saturating_sub(WINDOW / 3) };
    let shown: String = characters.iter().skip(from).take(WINDOW).collect();
    let start = column - from;
    let room = shown.chars().count().saturating_sub(start).max(1);
    (shown, start, (place.span.end - place.span.start).clamp(1, room))
}

/// Control characters (a terminal's escape sequences among them) replaced one for one.
fn printable(text: &str) -> String {
    text.chars()
        .map(|c| {
            if c == '\t' {
                ' '
            } else if c.is_control() {
                '\u{fffd}'
            } else {
                c
            }
        })
        .collect()
}
