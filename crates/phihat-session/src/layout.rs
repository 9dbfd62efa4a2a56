//! The files of a record, by name.

use std::collections::BTreeMap;

use phihat_report::RunInfo;
use serde::{Deserialize, Serialize};

/// The file that is moved to its place last and removed first: the record is whole where it is.
pub(crate) const RUN: &str = "run.json";
/// The recorded signals of a run, by this name in its folder.
pub const TRACE: &str = "trace.csv";
/// What every record has beside it.
pub(crate) const FILES: [&str; 3] = ["study.toml", "metrics.json", TRACE];
/// The gains of a run, where phihat's law drove it.
pub(crate) const GAINS: &str = "gains.json";
/// The form of the law, where another controller drove the run.
pub(crate) const OUTSIDE: &str = "outside";
/// The folder of files that the study names.
pub(crate) const INPUTS: &str = "inputs";
/// What drove a run that was not simulated in one go: link, checks before the start, losses, timing.
pub(crate) const DRIVE: &str = "drive.json";
/// What a record may have.
pub(crate) const PARQUET: &str = "trace.parquet";

/// What `run.json` says.
#[derive(Serialize, Deserialize)]
pub(crate) struct Origin {
    #[serde(flatten)]
    pub(crate) run: RunInfo,
    /// The build of the program that designed the gains for this very study, where it says which it is; `None`: they were given, or
    /// nobody can tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) designed_by: Option<String>,
    /// The SHA-256 of every other file of the record, by its name.
    pub(crate) files: BTreeMap<String, String>,
}
