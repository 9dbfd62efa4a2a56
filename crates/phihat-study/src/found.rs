//! Errors of a study, gathered while it is read: the first error, or as many as are requested.

use std::cell::RefCell;
use std::ops::Range;

use crate::error::{StudyError, StudyErrorKind as Kind, TextPlace};

/// Largest number of errors that are reported of a study.
const ERRORS_MAX: usize = 100;

/// The errors found so far.
///
/// A reader that can go on after an error passes it to [`note`](Self::note) with `?`. Where only the first
/// error is requested, it comes back and ends the reading.
#[derive(Debug)]
pub(crate) struct StudyErrors {
    /// Errors beyond which the reading ends.
    room: usize,
    noted: RefCell<Noted>,
}

#[derive(Debug, Default)]
struct Noted {
    errors: Vec<StudyError>,
    /// Errors of the first pass; `None` while it is at work.
    first_pass: Option<usize>,
    /// Paths of keys and sections that are missing because another one is misspelt.
    misspelt: Vec<String>,
}

impl StudyErrors {
    /// Reading ends at the first error.
    pub(crate) fn first() -> Self {
        Self { room: 0, noted: RefCell::default() }
    }

    /// Reading goes on.
    pub(crate) fn all() -> Self {
        Self { room: ERRORS_MAX - 1, noted: RefCell::default() }
    }

    /// Returns true if reading goes on after an error.
    pub(crate) fn goes_on(&self) -> bool {
        self.room > 0
    }

    /// Stores an error; one that only follows from an earlier one is dropped.
    ///
    /// # Errors
    ///
    /// The error itself, where there is no room for it.
    pub(crate) fn note(&self, error: StudyError) -> Result<(), StudyError> {
        if self.follows(&error) {
            return Ok(());
        }
        let errors = &mut self.noted.borrow_mut().errors;
        if errors.len() >= self.room {
            return Err(error);
        }
        errors.push(error);
        Ok(())
    }

    /// The value, or none after its error was noted.
    pub(crate) fn keep<T>(&self, read: Result<T, StudyError>) -> Result<Option<T>, StudyError> {
        match read {
            Ok(value) => Ok(Some(value)),
            Err(error) => self.note(error).map(|()| None),
        }
    }

    /// The values that could be read, after the errors of the others were noted.
    pub(crate) fn each<T>(
        &self,
        reads: impl IntoIterator<Item = Result<T, StudyError>>,
    ) -> Result<Vec<T>, StudyError> {
        let kept = reads.into_iter().map(|read| self.keep(read));
        Ok(kept.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
    }

    /// `path` is missing because another key, which was told of, is misspelt.
    pub(crate) fn is_misspelt(&self, path: String) {
        self.noted.borrow_mut().misspelt.push(path);
    }

    /// The first pass is through: what it refused is not there for the second.
    pub(crate) fn first_pass_ends(&self) {
        let noted = &mut *self.noted.borrow_mut();
        noted.first_pass = Some(noted.errors.len());
    }

    /// Returns true if the first pass refused something inside these bytes.
    pub(crate) fn refuses(&self, span: &Range<usize>) -> bool {
        let noted = self.noted.borrow();
        let count = noted.first_pass.unwrap_or_default();
        noted.errors[..count]
            .iter()
            .map(StudyError::span)
            .any(|bad| span.start <= bad.start && bad.end <= span.end)
    }

    /// Returns true if no error was noted at `path` or inside of it.
    pub(crate) fn is_clean(&self, path: &str) -> bool {
        !self.noted.borrow().errors.iter().any(|error| inside(error.key(), path))
    }

    /// Last noted error, which ends a reading that cannot go on.
    pub(crate) fn last(&self) -> StudyError {
        self.noted.borrow().errors.last().cloned().unwrap_or_else(|| {
            let why = "cannot be read";
            StudyError::new(Kind::Syntax, TextPlace::whole_file("study"), "", why)
        })
    }

    /// All errors that were noted, and the error that ended the reading.
    pub(crate) fn into_errors(self, last: Option<StudyError>, origin: &str) -> Vec<StudyError> {
        let last = last.filter(|last| !self.follows(last));
        let mut errors = self.noted.into_inner().errors;
        errors.extend(last);
        // In the order of the file; those of other files after them.
        errors.sort_by_key(|error| (error.file() != origin, error.line()));
        errors.dedup();
        errors
    }

    fn follows(&self, error: &StudyError) -> bool {
        let (noted, key) = (self.noted.borrow(), error.key());
        let Some(count) = noted.first_pass else { return false };
        let named = !key.is_empty();
        let same = |other: &str| inside(other, key) || inside(key, other);
        let (first, all) = (&noted.errors[..count], &noted.errors);
        let beside = |other: &StudyError| parent(other.key()) == parent(key);
        named
            && (all.iter().any(|other| !other.key().is_empty() && same(other.key()))
                || noted.misspelt.iter().any(|other| same(other))
                || (error.kind() == Kind::MissingKey && first.iter().any(beside)))
    }
}

/// Returns true if `path` is `of` or inside of it.
fn inside(path: &str, of: &str) -> bool {
    let rest = path.strip_prefix(of);
    of.is_empty() || rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

fn parent(path: &str) -> &str {
    path.rfind('.').map_or("", |at| &path[..at])
}
