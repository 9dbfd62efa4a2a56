//! What the paper does with its own arm, done with a user's: Figs. 12 and 13 for an own φ, Table 3 and Fig. 14 with own gains.
//!
//! No verdict on the paper comes out: its statements are about its own arm. What it would take more than a study to do again
//! is listed with the reason.

mod error;
mod options;
mod orders;
mod page;
mod phi;
mod table3;

pub use error::OwnError;
pub use options::{OwnAnswer, OwnOptions};
pub use page::own_page;

use std::path::Path;

use phihat::Form;
use phihat_design::{Gains, requested_gains};
use phihat_study::Study;
use serde::Serialize;

use crate::record::{Number, Section};
use phi::OwnPhi;

/// Version of the layout of [`OwnReproduction`].
pub const OWN_FORMAT: u32 = 1;

/// What of the paper was done again with a study's arm and gains.
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
    /// Where φ comes from.
    pub phi_from: String,
    /// Figs. 12 and 13, then Table 3 and Fig. 14.
    pub sections: Vec<Section>,
    /// The figures behind the tables.
    pub numbers: Vec<Number>,
    /// What of the paper is not done here, and why.
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

/// A study whose law is the paper's, with its gains.
#[derive(Debug)]
pub(crate) struct Own {
    pub(crate) study: Study,
    pub(crate) gains: Gains,
}

impl Own {
    /// Checks that there is a law of the paper to look at. The law runs bare: the paper's has no supervisor.
    pub(crate) fn new(mut study: Study, path: &Path) -> Result<Self, OwnError> {
        let at = || path.display().to_string();
        if study.control.form_designed || study.control.form == Form::Positions {
            return Err(OwnError::OtherForm(at()));
        }
        let Some(gains) = requested_gains(&study) else { return Err(OwnError::NoGains(at())) };
        study.supervisor = None;
        Ok(Self { study, gains })
    }

    /// The place of a joint.
    pub(crate) fn joint(&self, name: &str) -> Result<usize, OwnError> {
        let names = || self.study.robot.joints.iter().map(|joint| joint.name.clone());
        let found = names().position(|own| own == name);
        found.ok_or_else(|| OwnError::NoJoint {
            name: name.to_owned(),
            joints: names().collect::<Vec<_>>().join(", "),
        })
    }

    /// `a_0^{1/m}`: the rate of the estimator, were all its poles in one place \[rad/s\].
    pub(crate) fn rate(&self, joint: usize) -> f64 {
        let a = &self.gains.joints[joint].a;
        a.first().copied().unwrap_or(f64::NAN).powf(1.0 / a.len() as f64)
    }
}

/// Does it. `phi`: a file with an own φ; `joint`: whose it is, and which is shown.
///
/// # Errors
///
/// [`OwnError`]: the study has no law of the paper, there is no φ, or a run cannot begin.
pub fn own(
    study: Study,
    path: &Path,
    (phi, joint): (Option<&Path>, Option<&str>),
    progress: &dyn Fn(f64),
) -> Result<OwnReproduction, OwnError> {
    let own = Own::new(study, path)?;
    let joint = joint.map(|name| own.joint(name)).transpose()?;
    let runs = table3::Runs::of(&own)?;
    progress(0.6);
    let phi = OwnPhi::of(&own, &runs.proposed, (phi, joint))?;
    let (orders, mut numbers) = orders::orders(&own, &phi, &runs.proposed);
    progress(0.9);
    let (table, more) = table3::section(&own, &runs);
    numbers.extend(more);
    Ok(OwnReproduction {
        format: OWN_FORMAT,
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        study: own.study.name.clone(),
        study_sha256: own.study.sha256.clone(),
        joint: phi.name.clone(),
        phi_from: phi.source.clone(),
        sections: vec![orders, table],
        numbers,
        left_out: left_out(),
    })
}

fn left_out() -> Vec<LeftOutOfPaper> {
    [
        ("Theorems 1 to 5, the remarks, errata", "They are about the law, not about an arm: `phihat reproduce`. What holds of these gains: `phihat design` and `phihat verify`."),
        ("Table 1", "It compares laws by what is published of them; on an own arm `phihat compare` measures them."),
        ("Table 2", "Gains from limits on the error: `phihat design --method paper`, with `[design.paper]`."),
        ("Figs. 4 to 11", "One run of an arm along its path: `phihat run` shows path, errors, torques and φ̂ of this study."),
        ("Table 3, the column of Chung et al.", "Its gains were found by trial and error and are not printed; `phihat compare` tunes it on this study."),
    ]
    .map(|(part, why)| LeftOutOfPaper { part: part.to_owned(), why: why.to_owned() })
    .to_vec()
}
