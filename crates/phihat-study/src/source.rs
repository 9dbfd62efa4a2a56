//! The text of a study and its origin: turns a span of bytes into a place a person can find.

use std::ops::Range;

use crate::error::{StudyError, StudyErrorKind, TextPlace};
use crate::found::StudyErrors;

/// Bytes of a line kept for an error message.
const LINE_MAX: usize = 4096;

/// A text and where it came from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) text: &'a str,
    pub(crate) origin: &'a str,
    /// Errors of the text so far.
    pub(crate) found: &'a StudyErrors,
}

impl Source<'_> {
    /// The place of `span`; a span that is not inside the text means its end.
    pub(crate) fn place(&self, span: &Range<usize>) -> TextPlace {
        let start = floor_boundary(self.text, span.start);
        let end = floor_boundary(self.text, span.end).max(start);
        let (before, after) = self.text.split_at(start);
        let begin = before.rfind('\n').map_or(0, |at| at + 1);
        let finish = after.find(['\n', '\r']).map_or(self.text.len(), |at| start + at);
        let bom = |text: &str| text.trim_start_matches('\u{feff}').chars().count();
        TextPlace {
            file: self.origin.into(),
            line: before.bytes().filter(|&b| b == b'\n').count() + 1,
            column: bom(&self.text[begin..start]) + 1,
            span: start..end,
            line_text: self.text[begin..finish.min(floor_boundary(self.text, begin + LINE_MAX))]
                .trim_start_matches('\u{feff}')
                .into(),
        }
    }

    /// An error at `span`.
    pub(crate) fn error(
        &self,
        kind: StudyErrorKind,
        span: &Range<usize>,
        key: impl Into<String>,
        message: impl Into<String>,
    ) -> StudyError {
        StudyError::new(kind, self.place(span), key, message)
    }
}

/// The largest character boundary that is not beyond `at`.
fn floor_boundary(text: &str, at: usize) -> usize {
    let at = at.min(text.len());
    (0..=at).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}
