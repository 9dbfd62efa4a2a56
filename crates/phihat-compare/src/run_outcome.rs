//! The result of one run, as data: how it ended, its figures, its trace in few numbers.

use serde::{Deserialize, Serialize};

/// Outcome of a run, from good to bad.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunOutcome {
    /// It followed its reference.
    Followed,
    /// It ran to its end, but an error of some joint came to half of that joint's motion: it did not follow.
    Lost {
        /// The joint.
        joint: String,
    },
    /// The arm's state left every plausible range.
    Diverged {
        /// When \[s\].
        t: f64,
        /// The joint.
        joint: String,
    },
    /// The rival gave a torque that is no number.
    NotFinite {
        /// When first \[s\].
        t: f64,
        /// The joint.
        joint: String,
    },
    /// It could not be built or run; why.
    Refused(String),
    /// The program panicked: a fault of this program.
    Panicked(String),
}

impl RunOutcome {
    /// Returns true if the run followed its reference.
    pub fn followed(&self) -> bool {
        *self == Self::Followed
    }

    /// From 0, good, to 5, bad.
    pub fn badness(&self) -> u8 {
        match self {
            Self::Followed => 0,
            Self::Lost { .. } => 1,
            Self::Diverged { .. } => 2,
            Self::NotFinite { .. } => 3,
            Self::Refused(_) => 4,
            Self::Panicked(_) => 5,
        }
    }
}

/// Figures of a run after `settle_s`; of the worst joint where they are per joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Root mean square of `e` \[rad\].
    pub error_rms_rad: f64,
    /// Largest |e| \[rad\].
    #[serde(alias = "error_max_rad")]
    pub error_peak_rad: f64,
    /// Largest |e| over the specification's: up to 1 it is kept.
    pub error_over_spec: f64,
    /// Root mean square of the applied torque over the joint's limit.
    pub effort: f64,
    /// Mean |τ_k − τ_{k−1}| of the commanded torque \[N·m\].
    pub chatter_nm: f64,
    /// That chatter over the same rival's in the exact world with the same gains and seed.
    pub chatter_over_exact: Option<f64>,
    /// Mean |τ_k − 2τ_{k−1} + τ_{k−2}|/√3 over the joint's torque limit: what white noise of the torque
    /// has as mean step, without what the motion asks for.
    pub noise: f64,
    /// Root mean square of the applied torque above 50 Hz, over the joint's torque limit; `None` where the
    /// samples do not reach that frequency, and in older documents.
    #[serde(default)]
    pub noise_above_50_hz: Option<f64>,
    /// Share of samples in which a joint's torque met its limit.
    pub saturated: f64,
    /// From the end of the last push until every |e| stays inside the larger of its specification and twice what
    /// it was before the push \[s\]; `None`: no push, or it did not come back.
    pub recovery_s: Option<f64>,
    /// The bound stated before the run, of the joint whose measured error comes closest to it \[rad\].
    #[serde(alias = "bound_rad")]
    pub error_bound_rad: Option<f64>,
    /// The smallest bound/measured over the joints: below 1 the bound was broken.
    pub bound_over_measured: Option<f64>,
}

/// A trace in few numbers: smallest and largest in equal slices of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sketch {
    /// The joint: the one with the largest error.
    pub joint: String,
    /// End of the last slice \[s\]; the first begins at 0.
    pub end_s: f64,
    /// `e` \[rad\], `[smallest, largest]` per slice.
    pub e_rad: Vec<[f32; 2]>,
    /// Commanded torque \[N·m\], likewise.
    pub tau_nm: Vec<[f32; 2]>,
}
