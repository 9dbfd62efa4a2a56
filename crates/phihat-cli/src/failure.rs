//! What a user reads when there is no result: one error, exit code 2; 1 where no gains keep what was asked for.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use phihat_model::input::plain;
use serde_json::json;

/// One line for people, or several where a source line is shown.
#[derive(Debug)]
pub struct Failure {
    text: String,
    code: u8,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Failure {
    /// About a file.
    pub(crate) fn at(path: &Path, why: impl fmt::Display) -> Self {
        Self::rendered(format!("error: {}: {why}", path.display()))
    }

    /// About a study, with the line it concerns.
    pub(crate) fn study(error: &phihat_study::StudyError) -> Self {
        Self::rendered(error.render())
    }

    /// Laid out already, `error:` included.
    pub(crate) fn rendered(text: impl Into<String>) -> Self {
        Self { text: plain(&text.into()), code: 2 }
    }

    /// About anything else.
    pub(crate) fn plain(why: impl fmt::Display) -> Self {
        Self::rendered(format!("error: {why}"))
    }

    /// The input is fine, and nothing keeps what it asks for.
    pub(crate) fn infeasible(self) -> Self {
        Self { code: 1, ..self }
    }

    /// Tells it, as one JSON document on standard output too where that was asked for.
    pub(crate) fn tell(&self, as_json: bool) -> ExitCode {
        if as_json {
            let text = self.text.strip_prefix("error: ").unwrap_or(&self.text);
            println!("{:#}", json!({ "error": text, "exit_code": self.code }));
        }
        eprintln!("{self}");
        ExitCode::from(self.code)
    }
}
