//! Study that runs, or record that is played.

use std::path::PathBuf;

use phihat_design::Gains;
use phihat_report::DrawnArm;
use phihat_study::Study;

use crate::begin::Begin;

/// The study that is open.
#[derive(Debug, Clone)]
pub(crate) struct Open {
    pub(crate) study: Box<Study>,
    /// Its arm, as it is drawn: made once, since shapes are read for it.
    pub(crate) arm: Box<DrawnArm>,
    /// `None`: another controller's record is played.
    pub(crate) gains: Option<Gains>,
    pub(crate) warnings: Vec<String>,
    /// Path of its text, whether it exists or not.
    pub(crate) path: PathBuf,
    /// Of a record that is played.
    pub(crate) played: Option<RecordAbout>,
}

/// Description of a record for a page, before it is played.
#[derive(Debug, Clone)]
pub(crate) struct RecordAbout {
    /// Its length \[s\].
    pub(crate) length: f64,
    /// Times and desired positions to draw a path from.
    pub(crate) path: (Vec<f64>, Vec<Vec<f64>>),
}

impl Open {
    /// Study and gains of a run; `None`: a record is played.
    pub(crate) fn begin(&self) -> Option<Begin> {
        let gains = self.gains.clone().filter(|_| self.played.is_none())?;
        Some(Begin { study: self.study.clone(), gains })
    }
}
