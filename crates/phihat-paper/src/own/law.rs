//! A study with a law of the paper.

use std::path::Path;

use phihat::Form;
use phihat_design::{Gains, requested_gains};
use phihat_study::Study;

use super::error::OwnError;

/// A study whose law is the paper's, with its gains.
#[derive(Debug)]
pub(super) struct Own {
    pub(super) study: Study,
    pub(super) gains: Gains,
}

impl Own {
    /// Checks that there is a law of the paper to look at. The law runs bare: the paper's has no supervisor.
    pub(super) fn new(mut study: Study, path: &Path) -> Result<Self, OwnError> {
        let at = || path.display().to_string();
        if study.control.form == Form::Positions {
            return Err(OwnError::OtherForm(at()));
        }
        let Some(gains) = requested_gains(&study) else { return Err(OwnError::NoGains(at())) };
        study.supervisor = None;
        Ok(Self { study, gains })
    }

    /// The place of a joint.
    pub(super) fn joint(&self, name: &str) -> Result<usize, OwnError> {
        let names = || self.study.robot.joints.iter().map(|joint| joint.name.clone());
        let found = names().position(|own| own == name);
        found.ok_or_else(|| OwnError::NoJoint {
            name: name.to_owned(),
            joints: names().collect::<Vec<_>>().join(", "),
        })
    }

    /// `a_0^{1/m}`: the rate of the estimator, were all its poles in one place \[rad/s\].
    pub(super) fn rate(&self, joint: usize) -> f64 {
        let a = &self.gains.joints[joint].a;
        a.first().copied().unwrap_or(f64::NAN).powf(1.0 / a.len() as f64)
    }
}
