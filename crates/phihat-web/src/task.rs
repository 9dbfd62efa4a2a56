//! Tasks, as a page states them.

use std::collections::BTreeMap;
use std::path::PathBuf;

use phihat_design::Gains;
use phihat_model::NamedTexts;
use phihat_session::study_of_texts;
use phihat_study::Study;
use serde::Deserialize;

use crate::error::AnswerError;
use crate::happening::Happening;

/// Most samples of a run, those of its joints counted each: some 100 bytes each, and a module has 4 GB.
const SAMPLES_MAX: u64 = 10_000_000;

/// A task with its texts.
#[derive(Debug, Deserialize)]
#[serde(tag = "task", rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum BrowserTask {
    /// Joints and notes of a description.
    Arm {
        /// Name of the description among the files, or of a built-in arm.
        file: String,
        /// Texts by the names of their files.
        #[serde(default)]
        files: BTreeMap<String, String>,
    },
    /// A study made of an arm.
    Begin {
        /// Name of the description among the files, or of a built-in arm.
        file: String,
        /// Texts by the names of their files.
        #[serde(default)]
        files: BTreeMap<String, String>,
        /// Heaviest payload \[kg\].
        #[serde(default)]
        payload_kg: f64,
        /// Largest error \[rad, m\]; `None`: the smallest that can be promised, with a margin.
        #[serde(default)]
        error_rad: Option<f64>,
        /// True: the first error that is kept is enough.
        #[serde(default)]
        first_kept: bool,
    },
    /// Mistakes of a study, and the values of the form.
    Check(StudyTexts),
    /// One key of a study changed.
    Set {
        /// Text of the study.
        study: String,
        /// Key of the form, dotted.
        key: String,
        /// Its value as TOML; empty: the key is left out.
        value: String,
    },
    /// Gains for a study.
    Design(StudyTexts),
    /// A run of a study.
    Run(StudyTexts),
    /// The same run under a PID.
    Beside(StudyTexts),
    /// A study in whose run something happens.
    Happens(Happening),
    /// The page of a run.
    Page(StudyTexts),
    /// The figures of a run, as files.
    Figures(StudyTexts),
    /// Claims of gains, checked again.
    Verify(StudyTexts),
    /// Gains in another format.
    Export {
        /// The gains document (JSON).
        gains: String,
        /// `c-header`, `ros2` or `csv`.
        format: String,
    },
}

/// A study, the files that it names, and gains for it.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StudyTexts {
    /// Name of the study: a-z, 0-9, `_` and `-`.
    #[serde(default = "study_name")]
    pub(crate) name: String,
    /// Text of the study (TOML).
    #[serde(default)]
    pub(crate) study: String,
    /// Texts by the names of their files.
    #[serde(default)]
    pub(crate) files: BTreeMap<String, String>,
    /// The gains document (JSON), where gains are at hand.
    #[serde(default)]
    pub(crate) gains: Option<String>,
}

impl StudyTexts {
    /// Path that stands for the study in messages.
    pub(crate) fn path(&self) -> PathBuf {
        PathBuf::from(format!("{}.toml", self.name))
    }

    /// The study, of a length that a browser's memory takes.
    pub(crate) fn read(&self) -> Result<Box<Study>, AnswerError> {
        let study = study_of_texts(&self.study, &self.path(), &named(&self.files))?;
        let samples = phihat_sim::samples(study.duration, study.control.period_ns);
        let joints = study.robot.joints.len();
        if samples.saturating_mul(joints as u64) > SAMPLES_MAX {
            return Err(AnswerError::Long { samples, joints, most: SAMPLES_MAX });
        }
        Ok(study)
    }

    /// The gains; `None`: none were given.
    pub(crate) fn gains(&self) -> Result<Option<Gains>, AnswerError> {
        Ok(self.gains.as_deref().map(Gains::from_json).transpose()?)
    }
}

/// Texts in place of files of these names.
pub(crate) fn named(files: &BTreeMap<String, String>) -> NamedTexts {
    NamedTexts::alone(files.iter().map(|(name, text)| (PathBuf::from(name), text.clone())))
}

fn study_name() -> String {
    "study".to_owned()
}
