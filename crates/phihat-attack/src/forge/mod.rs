//! Forgeries: edits of a gains file, each taken through the check that `phihat verify` makes.

mod edits;
mod rule;
mod truth;

use std::fmt;
use std::path::Path;

use phihat_certificate::Gains;
use phihat_session::{Checked, SessionError, tube_reference, verify};
use phihat_study::Study;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::Dice;
use edits::{Leaves, edited};
use rule::more;
use truth::varies_stably;

/// End of an edited file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForgeryFate {
    /// It cannot be read.
    Unread,
    /// It is read as the file that it was.
    Same,
    /// The check of the file alone refuses it.
    Refused,
    /// The check with the study refuses it.
    RefusedByStudy,
    /// It passes, alone and with the study, and says no more than the file did.
    NoMore,
    /// It is another law, of which its own claims hold, alone and with the study.
    OtherLaw,
    /// It passes the file's own check and the quick part of that with the study; the second derivation was not run.
    NotDerived,
    /// It passes and says more than the file did.
    Passed,
}

/// Result of one edit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ForgeryRecord {
    /// The edit in words, after the place of the leaf.
    pub edit: String,
    /// End of the edited file.
    pub fate: ForgeryFate,
    /// Statement that it makes more, or reason of its refusal.
    pub words: String,
}

/// A gains file with its study, and what the check says of both as they are.
#[derive(Debug)]
pub struct Forger {
    document: Value,
    gains: Gains,
    study: Study,
    alone: Value,
    studied: Value,
    leaves: Leaves,
    /// Seed of the edits.
    pub seed: u64,
    /// One of so many edits that only a second derivation can refuse is derived again; at least 1.
    pub derive_every: u64,
}

impl Forger {
    /// A forger of a gains file.
    ///
    /// # Errors
    ///
    /// [`ForgeError`]: the file itself does not pass, so that no edit of it can be judged.
    pub fn new(text: &str, study: Study, seed: u64, derive_every: u64) -> Result<Self, ForgeError> {
        let document: Value =
            serde_json::from_str(text).map_err(|why| ForgeError::Unusable(why.to_string()))?;
        let gains = Gains::from_json(text).map_err(|why| ForgeError::Unusable(why.to_string()))?;
        let of = |study| match checked(&gains, study)? {
            CheckEnded::Printed(said) => Ok(said),
            CheckEnded::Refused(why) => Err(ForgeError::Refused(why)),
        };
        let (alone, studied) = (of(None)?, of(Some(&study))?);
        let leaves = Leaves::of(&document);
        let derive_every = derive_every.max(1);
        Ok(Self { document, gains, study, alone, studied, leaves, seed, derive_every })
    }

    /// Number of the file's leaves, and of their kinds: places that differ in nothing but an index.
    pub fn leaves(&self) -> (usize, usize) {
        self.leaves.counts()
    }

    /// Tries the edit of a number.
    pub fn forge(&self, index: u64) -> ForgeryRecord {
        let mut dice = Dice::new(self.seed, index);
        let path = self.leaves.at(index, &mut dice);
        let (what, text) = edited(&self.document, path, &mut dice);
        let edit = format!("{path}: {what}");
        let (fate, words) = match self.judged(path, &text, index) {
            Ok(judged) => judged,
            Err(why) => (ForgeryFate::Refused, why.to_string()),
        };
        ForgeryRecord { edit, fate, words }
    }

    fn judged(
        &self,
        path: &str,
        text: &str,
        index: u64,
    ) -> Result<(ForgeryFate, String), ForgeError> {
        let gains = match Gains::from_json(text) {
            Ok(gains) => gains,
            Err(why) => return Ok((ForgeryFate::Unread, why.to_string())),
        };
        if gains == self.gains {
            return Ok((ForgeryFate::Same, String::new()));
        }
        let alone = match checked(&gains, None)? {
            CheckEnded::Printed(said) => said,
            CheckEnded::Refused(why) => return Ok((ForgeryFate::Refused, why)),
        };
        let holds = |own: &Value| varies_stably(&gains, own);
        let more_alone = more(&self.alone, &alone, &holds);
        if let Some(why) = self.quick(&gains) {
            // Of a file alone, a better verdict is a forgery whatever a study would say.
            let ranked = more_alone.filter(|more| more.headline);
            return Ok(match ranked {
                Some(more) => (ForgeryFate::Passed, format!("alone: {}", more.words)),
                None => (ForgeryFate::RefusedByStudy, why),
            });
        }
        if more_alone.is_none() && !index.is_multiple_of(self.derive_every) {
            return Ok((ForgeryFate::NotDerived, String::new()));
        }
        let studied = match checked(&gains, Some(&self.study))? {
            CheckEnded::Printed(said) => said,
            CheckEnded::Refused(why) => return Ok((ForgeryFate::RefusedByStudy, why)),
        };
        let found = more_alone.or_else(|| more(&self.studied, &studied, &holds));
        let other = path.starts_with("/joints/");
        Ok(match found {
            Some(more) if other && !more.headline => (ForgeryFate::OtherLaw, more.words),
            Some(more) => (ForgeryFate::Passed, more.words),
            None => (ForgeryFate::NoMore, String::new()),
        })
    }

    /// Refusal by what a study says without a second derivation, the same functions that the whole check calls first.
    fn quick(&self, gains: &Gains) -> Option<String> {
        let mut study = self.study.clone();
        if let Err(why) = gains.complete(&mut study) {
            return Some(why.to_string());
        }
        let certificate = gains.certificate.as_ref()?;
        let tip = || match tube_reference(gains, &study) {
            Some(reference) => certificate.tip_is_of(&study, &reference),
            None => Ok(()),
        };
        let found = certificate.derive(gains, &study).map(|_| ());
        found
            .and_then(|()| certificate.tube_is_of(&study))
            .and_then(|()| tip())
            .err()
            .map(|why| why.to_string())
    }
}

/// End of a check: its document, as `phihat verify --json` prints it, or its refusal in words.
enum CheckEnded {
    Printed(Value),
    Refused(String),
}

/// Checks gains, with their study or alone.
fn checked(gains: &Gains, study: Option<&Study>) -> Result<CheckEnded, ForgeError> {
    let subject = Checked::Documents { gains, study, seed: 0 };
    let found = verify(subject, &|_| ()).map_err(ForgeError::from)?;
    match found.claims {
        None => Ok(CheckEnded::Refused("nothing is claimed".to_owned())),
        Some(Err(why)) => Ok(CheckEnded::Refused(why.to_string())),
        Some(Ok(verified)) => {
            let said = serde_json::to_value(&verified);
            said.map(CheckEnded::Printed).map_err(|why| ForgeError::Unusable(why.to_string()))
        }
    }
}

/// Reason why a file cannot be forged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ForgeError {
    /// It, or its study, is no document of ours.
    #[error("the gains cannot be used: {0}")]
    Unusable(String),
    /// It does not pass as it is.
    #[error("the gains do not pass as they are: {0}")]
    Refused(String),
    /// The check cannot use it.
    #[error(transparent)]
    Session(#[from] SessionError),
}

/// Figures of a campaign.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ForgerySummary {
    /// Name of the file.
    pub gains: String,
    /// Leaves of the file.
    pub leaves: usize,
    /// Kinds of leaves.
    pub kinds: usize,
    /// Edits that were tried.
    pub edits: usize,
    /// Edits by their end.
    pub fates: std::collections::BTreeMap<String, usize>,
    /// Edits that pass and say more.
    pub passed: Vec<ForgeryRecord>,
    /// Edits at which the check panicked.
    pub panics: Vec<String>,
}

impl ForgerySummary {
    /// Figures of edits of a file.
    pub fn of(
        path: &Path,
        forger: &Forger,
        records: Vec<ForgeryRecord>,
        panics: Vec<String>,
    ) -> Self {
        let (leaves, kinds) = forger.leaves();
        let mut fates = std::collections::BTreeMap::new();
        for record in &records {
            let word = serde_json::to_value(record.fate);
            let word = word.ok().and_then(|word| word.as_str().map(str::to_owned));
            *fates.entry(word.unwrap_or_default()).or_insert(0) += 1;
        }
        let edits = records.len();
        let passed = records.into_iter().filter(|own| own.fate == ForgeryFate::Passed).collect();
        Self { gains: path.display().to_string(), leaves, kinds, edits, fates, passed, panics }
    }

    /// Returns true if no edit passed and said more, and none made the check panic.
    pub fn is_clean(&self) -> bool {
        self.passed.is_empty() && self.panics.is_empty()
    }
}

impl fmt::Display for ForgerySummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { gains, leaves, kinds, edits, fates, passed, panics } = self;
        write!(f, "{gains}: {edits} edits of {leaves} leaves of {kinds} kinds")?;
        for (fate, count) in fates {
            write!(f, "; {} {count}", fate.replace('_', " "))?;
        }
        for record in passed {
            write!(f, "\n  PASSES: {}: {}", record.edit, record.words)?;
        }
        for why in panics {
            write!(f, "\n  PANIC: {why}")?;
        }
        Ok(())
    }
}
