//! The files of a record, by name.

use std::collections::BTreeMap;

use phihat_report::RunInfo;
use serde::{Deserialize, Serialize};

/// The file that is moved to its place last and removed first: the record is whole where it is.
pub(crate) const RUN: &str = "run.json";
/// Files of every record in addition to it and the trace.
pub(crate) const FILES: [&str; 2] = ["study.toml", "metrics.json"];
/// The gains of a run, where phihat's law drove it.
pub(crate) const GAINS: &str = "gains.json";
/// The form of the law, where another controller drove the run.
pub(crate) const OUTSIDE: &str = "outside";
/// The folder of files that the study names.
pub(crate) const INPUTS: &str = "inputs";
/// Drive of a run that was not simulated in one go: link, checks before the start, losses, timing.
pub(crate) const DRIVE: &str = "drive.json";

/// The folder of what is left of a drive whose process is killed; the record's own files are as they were until then.
pub(crate) const UNFINISHED: &str = "unfinished";
/// The file in it that is made last and removed first: with it there is something to make a record of.
pub(crate) const BEGUN: &str = "begun.json";

/// Kind of file of a record's trace: one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TraceKind {
    /// Typed, compressed, quick.
    #[default]
    Parquet,
    /// A text, for whoever reads nothing else.
    Csv,
}

impl TraceKind {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Parquet, Self::Csv];

    /// CSV, if that is asked for.
    pub fn csv(asked: bool) -> Self {
        if asked { Self::Csv } else { Self::Parquet }
    }

    /// The file's name in the folder of its record.
    pub fn file(self) -> &'static str {
        match self {
            Self::Parquet => "trace.parquet",
            Self::Csv => "trace.csv",
        }
    }
}

/// Content of `run.json`.
#[derive(Serialize, Deserialize)]
pub(crate) struct RunOrigin {
    #[serde(flatten)]
    pub(crate) run: RunInfo,
    /// The build of the program that designed the gains for this very study, where it is known; `None`: they
    /// were given, or it is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) designed_by: Option<String>,
    /// The SHA-256 of every other file of the record, by its name.
    pub(crate) files: BTreeMap<String, String>,
}
