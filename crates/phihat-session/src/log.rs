//! A run's log for ROS tools and viewers, where this build writes one.

use std::path::Path;

use phihat_design::Gains;
#[cfg(feature = "mcap")]
use phihat_sim::McapTrace;
use phihat_sim::Trace;
use phihat_study::Study;

use crate::disk::DiskError;
#[cfg(feature = "mcap")]
use crate::disk::{Piece, Whole};
use crate::error::SessionError;

/// True if this build writes logs as MCAP: its feature `mcap`.
pub const LOGS: bool = cfg!(feature = "mcap");

/// A log on its way to the disk. It stands alone: it may be in another folder than the record.
#[cfg(feature = "mcap")]
pub(crate) struct LogFile {
    whole: Whole,
    file: McapTrace<Piece>,
    prepared: std::path::PathBuf,
    path: std::path::PathBuf,
}

/// There is none in this build.
#[cfg(not(feature = "mcap"))]
pub(crate) enum LogFile {}

impl LogFile {
    /// Checks that a log can be written there, before anything runs.
    pub(crate) fn offered(path: &Path) -> Result<(), SessionError> {
        if LOGS {
            return crate::files::check_writable([&path.to_owned()]);
        }
        let why = "this build of phihat writes no MCAP: build phihat-cli without `--no-default-features`; the trace of \
            the record has the same signals";
        Err(SessionError::at(path, why))
    }
}

#[cfg(feature = "mcap")]
impl LogFile {
    pub(crate) fn begin(path: &Path, study: &Study, gains: &Gains) -> Result<Self, SessionError> {
        let mut whole = Whole::default();
        let piece = whole.begin(path)?;
        let prepared = piece.prepared_at().to_owned();
        let told = |why| SessionError::from(DiskError::untouched(path, why));
        let mut file = McapTrace::new(piece).map_err(told)?;
        let gains = gains.to_json()?;
        file.attach("gains.json", "application/json", gains.as_bytes()).map_err(told)?;
        file.attach("study.toml", "application/toml", study.text.as_bytes()).map_err(told)?;
        Ok(Self { whole, file, prepared, path: path.to_owned() })
    }

    pub(crate) fn prepared_at(&self) -> &Path {
        &self.prepared
    }

    pub(crate) fn block(&mut self, trace: &Trace) -> Result<(), DiskError> {
        self.file.block(trace).map_err(|why| DiskError::untouched(&self.path, why))
    }

    pub(crate) fn end(self) -> Result<(), DiskError> {
        let Self { mut whole, file, path, .. } = self;
        let piece = file.finish().map_err(|why| DiskError::untouched(&path, why))?;
        whole.end(piece)?;
        whole.commit()
    }
}

#[cfg(not(feature = "mcap"))]
impl LogFile {
    pub(crate) fn begin(path: &Path, _: &Study, _: &Gains) -> Result<Self, SessionError> {
        Self::offered(path)?;
        Err(SessionError::at(path, "no log can be written"))
    }

    pub(crate) fn prepared_at(&self) -> &Path {
        match *self {}
    }

    #[expect(clippy::needless_pass_by_ref_mut, reason = "as where logs are written")]
    pub(crate) fn block(&mut self, _: &Trace) -> Result<(), DiskError> {
        match *self {}
    }

    pub(crate) fn end(self) -> Result<(), DiskError> {
        match self {}
    }
}
