//! A study, its files and its gains looked at, without running or designing anything: all that is wrong, at once.

use std::fmt;
use std::path::Path;

use phihat_design::{DesignError, Gains, requested_gains};
use phihat_model::NamedTexts;
use phihat_sim::Demand;
use phihat_study::{DesignMethod, RenamedKey, Study, StudyError};
use serde::Serialize;

use crate::design;
use crate::error::SessionError;
use crate::files::{read_gains, write};
use crate::session::Session;

/// One thing that is wrong: where, what, and what would be valid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Mistake {
    /// The file meant: the study, or one that it names.
    pub file: String,
    /// Line, from 1; `None`: the whole file.
    pub line: Option<usize>,
    /// Column, from 1, in characters.
    pub column: Option<usize>,
    /// Dotted path of the key.
    pub key: Option<String>,
    /// Description of the mistake.
    pub message: String,
    /// Valid values or the remedy.
    pub help: Option<String>,
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        for place in self.line.iter().chain(&self.column) {
            write!(f, ":{place}")?;
        }
        f.write_str(": ")?;
        self.key.iter().try_for_each(|key| write!(f, "{key}: "))?;
        f.write_str(&self.message)?;
        self.help.iter().try_for_each(|help| write!(f, "; {help}"))
    }
}

impl From<&StudyError> for Mistake {
    fn from(error: &StudyError) -> Self {
        let placed = |place: usize| (error.line() > 0).then_some(place);
        Self {
            file: error.file().to_owned(),
            line: placed(error.line()),
            column: placed(error.column()),
            key: Some(error.key().to_owned()).filter(|key| !key.is_empty()),
            message: error.message().to_owned(),
            help: error.help().map(str::to_owned),
        }
    }
}

impl Mistake {
    /// Converts an error of a study into a mistake.
    fn of(why: &SessionError, study: &Path) -> Self {
        let (file, text) = match why {
            SessionError::Study(error) => return error.as_ref().into(),
            SessionError::File { path, why } => (path.as_path(), why.to_string()),
            SessionError::NotArmed { path, why, words: None } => {
                (path.as_path(), format!("not armed: {why}"))
            }
            SessionError::NotArmed { path, why, words: Some(words) } => {
                (path.as_path(), format!("not armed: {}: {words}", why.claim))
            }
            other => (study, other.to_string()),
        };
        Self {
            file: file.display().to_string(),
            line: None,
            column: None,
            key: None,
            message: text.lines().map(str::trim).collect::<Vec<_>>().join(" "),
            help: None,
        }
    }
}

/// Result of a check.
#[derive(Debug)]
pub struct StudyCheck {
    /// The study; `None` where its file has errors.
    pub study: Option<Box<Study>>,
    /// All mistakes.
    pub errors: Vec<Mistake>,
    /// Warnings about values that are read in a way that the user should know.
    pub warnings: Vec<String>,
}

/// Looks at a study, at the files that it names (arm, reference, trace), and at its gains: those of a file,
/// or those that it states, as they would be run. Gains that are left to the design are not designed.
pub fn check(path: &Path, gains: Option<&Path>) -> StudyCheck {
    let read = gains.map(|file| read_gains(file).map(|gains| (gains, file))).transpose();
    let (gains, mut errors) = match read {
        Ok(gains) => (gains, Vec::new()),
        Err(why) => (None, vec![Mistake::of(&why, path)]),
    };
    match Study::check(path) {
        Ok(study) => looked(Box::new(study), path, gains, errors),
        Err(found) => {
            errors.splice(..0, found.iter().map(Mistake::from));
            StudyCheck { study: None, errors, warnings: Vec::new() }
        }
    }
}

/// As [`check`], of a text that would stand at this path, with its files from wherever they are.
pub fn check_text(text: &str, path: &Path, files: &NamedTexts) -> StudyCheck {
    let base = path.parent().unwrap_or(Path::new(""));
    match Study::check_texts(text, &path.display().to_string(), (base, files)) {
        Ok(study) => looked(Box::new(study), path, None, Vec::new()),
        Err(found) => {
            let errors = found.iter().map(Mistake::from).collect();
            StudyCheck { study: None, errors, warnings: Vec::new() }
        }
    }
}

/// Gives keys of earlier versions the names of now in a study's file, which is not touched where there are none.
fn rewrite(path: &Path) -> Result<Vec<RenamedKey>, SessionError> {
    let study = Study::read(path)?;
    if study.renamed.is_empty() {
        return Ok(Vec::new());
    }
    let why =
        "has a key of an earlier version at several places (as `key.joint1`): rename it there";
    let text = study.rewritten().ok_or_else(|| SessionError::at(path, why))?;
    write(path, &text)?;
    Ok(study.renamed)
}

/// As [`check`], of the study's file written anew: keys of earlier versions have the names of now, and all else is as
/// it was. Returns the keys that were renamed too.
pub fn check_rewritten(path: &Path, gains: Option<&Path>) -> (Vec<RenamedKey>, StudyCheck) {
    let renamed = rewrite(path);
    let mut looked = check(path, gains);
    match renamed {
        Ok(keys) => (keys, looked),
        Err(why) => {
            // What is wrong with the study itself is among the errors.
            if looked.errors.is_empty() {
                looked.errors.push(Mistake::of(&why, path));
            }
            (Vec::new(), looked)
        }
    }
}

/// Checks a study that could be read.
fn looked(
    study: Box<Study>,
    path: &Path,
    gains: Option<(Gains, &Path)>,
    mut errors: Vec<Mistake>,
) -> StudyCheck {
    let mut warnings = study.warnings();
    let unfit = if gains.is_some() || requested_gains(&study).is_some() {
        match Session::new(study.clone(), path, gains, false) {
            Ok(session) => {
                warnings = session.warnings().to_vec();
                None
            }
            Err(why) => Some(why),
        }
    } else {
        designable(&study, path).err()
    };
    errors.extend(unfit.map(|why| Mistake::of(&why, path)));
    StudyCheck { study: Some(study), errors, warnings }
}

/// Checks that a design could begin: its data of the arm, of the reference and of φ.
fn designable(study: &Study, path: &Path) -> Result<(), SessionError> {
    if study.spec.error_bound.is_none() && study.design.method == DesignMethod::Ours {
        return Err(SessionError::at(path, DesignError::NoSpec));
    }
    design::arm(study, path)?;
    Demand::along(study).map_err(|e| SessionError::at(path, e))?;
    design::trace_of_phi(study)
}
