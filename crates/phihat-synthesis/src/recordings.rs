//! Recorded traces on which a study bases its design.

use std::path::{Path, PathBuf};

use phihat_sim::Trace;

use crate::error::SynthesisError;

/// A trace and its file.
#[derive(Debug, Clone)]
pub struct Recording {
    /// File of the trace; its name stands in the certificate.
    pub file: PathBuf,
    /// The trace.
    pub trace: Trace,
}

/// Recorded traces on which a study bases its design: none for most studies. The caller reads them.
#[derive(Debug, Clone, Default)]
pub struct Recordings {
    /// Source of the arm's inertia, where `design.inertia_from` names a trace.
    pub inertia: Option<Recording>,
    /// Source of φ, where `design.phi_from` names a trace.
    pub phi: Option<Recording>,
}

/// The recording, or the error that the study's file was not read.
pub(crate) fn required<'a>(
    recording: Option<&'a Recording>,
    file: &Path,
) -> Result<&'a Recording, SynthesisError> {
    recording.ok_or_else(|| SynthesisError::Recording(file.to_owned()))
}
