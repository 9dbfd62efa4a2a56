//! Why there is nothing to reproduce on an own arm.

use phihat_session::SessionError;
use phihat_session::disk::DiskError;
use thiserror::Error;

use crate::part::PartError;

/// Why a study's arm and gains cannot be put in the place of the paper's.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OwnError {
    /// No gains.
    #[error(
        "{0}: the study states no [gains]: state K_p, K_d and a, as `phihat design` finds them"
    )]
    NoGains(String),
    /// A law that is not the paper's.
    #[error("{0}: the law is not the paper's: set loop.form to \"observer\" or \"literal\"")]
    OtherForm(String),
    /// No joint of this name.
    #[error("there is no joint `{name}`; joints: {joints}")]
    NoJoint {
        /// As it was asked for.
        name: String,
        /// Those that there are.
        joints: String,
    },
    /// The run does not get as far as φ is looked at.
    #[error(
        "no φ: the run ended after {end_s:.3} s, and φ is taken from spec.settle_s = {settle_s} s on; give one with \
            --phi FILE"
    )]
    NoPhi {
        /// End of the run \[s\].
        end_s: f64,
        /// Begin of the steady part \[s\].
        settle_s: f64,
    },
    /// A file of φ that is none.
    #[error("{file}: line {line}: {why}")]
    PhiFile {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// Error in the line, and the correct form.
        why: &'static str,
    },
    /// A run cannot begin.
    #[error(transparent)]
    Part(#[from] PartError),
    /// A file cannot be read, or results not be written.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// Results cannot be written.
    #[error(transparent)]
    Disk(#[from] DiskError),
    /// The answer cannot be written.
    #[error("{0}")]
    Answer(serde_json::Error),
}
