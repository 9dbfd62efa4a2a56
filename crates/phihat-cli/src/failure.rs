//! What a user reads when the input cannot be used: one error, exit code 2.

use std::fmt;
use std::path::Path;

/// One line for people, or several where a source line is shown.
#[derive(Debug)]
pub struct Failure(String);

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Failure {
    /// About a file.
    pub(crate) fn at(path: &Path, why: impl fmt::Display) -> Self {
        Self(format!("error: {}: {why}", path.display()))
    }

    /// About a study, with the line it concerns.
    pub(crate) fn study(error: &phihat_study::StudyError) -> Self {
        Self(error.render())
    }

    /// Laid out already, `error:` included.
    pub(crate) fn rendered(text: &str) -> Self {
        Self(text.to_owned())
    }

    /// About anything else.
    pub(crate) fn plain(why: impl fmt::Display) -> Self {
        Self(format!("error: {why}"))
    }
}
