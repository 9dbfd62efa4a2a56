//! Record of a reproduction on an own arm, as data.

use serde::Serialize;

use crate::record::{PaperNumber, Section};

/// Version of the layout of [`OwnReproduction`].
pub const OWN_FORMAT: u32 = 1;

/// Parts of the paper computed again with a study's arm and gains.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OwnReproduction {
    /// [`OWN_FORMAT`].
    pub format: u32,
    /// Version of this program.
    pub phihat_version: String,
    /// The study's name.
    pub study: String,
    /// SHA-256 of its text.
    pub study_sha256: String,
    /// The joint that is shown in the figures of one φ.
    pub joint: String,
    /// Source of φ, in words.
    pub phi_from: String,
    /// Figs. 12 and 13, then Table 3 and Fig. 14.
    pub sections: Vec<Section>,
    /// The figures behind the tables.
    pub numbers: Vec<PaperNumber>,
    /// Parts of the paper that are not computed here, and why.
    pub left_out: Vec<LeftOutOfPaper>,
}

/// A part of the paper that a study does not make again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LeftOutOfPaper {
    /// The part.
    pub part: String,
    /// Why not, and what does it instead.
    pub why: String,
}
