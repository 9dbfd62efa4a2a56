//! Output when there is no result: one error, exit code 2; 1 where no gains satisfy the specification.

use std::any::Any;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::ExitCode;

use phihat_campaign::faults::FaultsError;
use phihat_campaign::sweep::SweepError;
use phihat_compare::{CompareError, WORLDS};
use phihat_model::input::plain;
use phihat_paper::{OwnError, ReproduceError};
use phihat_rivals::RIVALS;
use phihat_session::SessionError;
use serde_json::json;

/// The exit code of a program that panicked, as the language has it.
const PANICKED: u8 = 101;

/// Does it; that phihat itself fails is a failure as others are, told in JSON where that was asked for.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    let done = catch_unwind(AssertUnwindSafe(work));
    done.unwrap_or_else(|panic| Err(Failure::of_phihat(panic.as_ref())))
}

/// One line for people, or several where a source line is shown.
#[derive(Debug)]
pub(crate) struct Failure {
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

    /// Laid out already, `error:` included.
    pub(crate) fn rendered(text: impl Into<String>) -> Self {
        Self { text: plain(&text.into()), code: 2 }
    }

    /// About anything else.
    pub(crate) fn plain(why: impl fmt::Display) -> Self {
        Self::rendered(format!("error: {why}"))
    }

    /// A bug of phihat's own.
    fn of_phihat(panic: &(dyn Any + Send)) -> Self {
        let words = panic.downcast_ref::<&str>().copied();
        let words = words.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
        let words = words.unwrap_or("for no reason that it knows");
        let text =
            format!("error: phihat itself failed, which is a bug, please report it: {words}");
        Self { text: plain(&text), code: PANICKED }
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

impl From<SessionError> for Failure {
    fn from(why: SessionError) -> Self {
        let answered = why.is_answer();
        let failure = match &why {
            // Laid out with its line already.
            SessionError::Study(_) => Self::rendered(why.to_string()),
            _ => Self::plain(&why),
        };
        if answered { Self { code: 1, ..failure } } else { failure }
    }
}

impl From<FaultsError> for Failure {
    fn from(why: FaultsError) -> Self {
        match why {
            FaultsError::Study(_) => Self::rendered(why.to_string()),
            FaultsError::Session(why) => why.into(),
            other => Self::plain(other),
        }
    }
}

impl From<SweepError> for Failure {
    fn from(why: SweepError) -> Self {
        match why {
            SweepError::Session(why) => why.into(),
            other => Self::plain(other),
        }
    }
}

impl From<ReproduceError> for Failure {
    fn from(why: ReproduceError) -> Self {
        match why {
            ReproduceError::Session(why) => why.into(),
            other => Self::plain(other),
        }
    }
}

impl From<OwnError> for Failure {
    fn from(why: OwnError) -> Self {
        match why {
            OwnError::Session(why) => why.into(),
            other => Self::plain(other),
        }
    }
}

#[cfg(feature = "studio")]
impl From<phihat_studio::StudioError> for Failure {
    fn from(why: phihat_studio::StudioError) -> Self {
        match why {
            phihat_studio::StudioError::Session(why) => why.into(),
            other => Self::plain(other),
        }
    }
}

impl From<CompareError> for Failure {
    /// A name that there is not comes with the nearest one that there is.
    fn from(why: CompareError) -> Self {
        match why {
            CompareError::Rival(id) => Self::plain(format!(
                "there is no rival `{id}`{}; `phihat compare --list` lists them",
                hint(&id, RIVALS.iter().map(|entry| entry.card.id))
            )),
            CompareError::World(name) => {
                let worlds = || WORLDS.iter().map(|world| world.name);
                let (hint, all) = (hint(&name, worlds()), worlds().collect::<Vec<_>>());
                Self::plain(format!(
                    "there is no world `{name}`{hint}; there are {}",
                    all.join(", ")
                ))
            }
            CompareError::Study(_) => Self::rendered(why.to_string()),
            CompareError::Session(why) => why.into(),
            other => Self::plain(other),
        }
    }
}

/// The known name closest to another, if it is close.
fn hint<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let scored = known.map(|known| (strsim::jaro_winkler(name, known), known));
    let best = scored.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(score, _)| *score > 0.6);
    best.map_or_else(String::new, |(_, known)| format!(", did you mean `{known}`?"))
}

#[cfg(test)]
mod tests {
    use super::{Failure, PANICKED, guarded};

    #[test]
    fn a_panic_is_a_failure_with_a_code_of_its_own() {
        let told = |done: Result<u8, Failure>| done.map_err(|failure| (failure.code, failure.text));
        let words = "error: phihat itself failed, which is a bug, please report it: index 7 of 3";
        let bug = guarded(|| std::panic::panic_any("index 7 of 3".to_owned()));
        assert_eq!(told(bug), Err((PANICKED, words.to_owned())));
        assert_eq!(told(guarded(|| Ok(3))), Ok(3));
        let no = guarded(|| Err(Failure::plain("no")));
        assert_eq!(told(no), Err((2, "error: no".to_owned())));
    }
}
