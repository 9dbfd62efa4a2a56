//! Available knowledge of an arm and its task before a run.

use core::fmt::Debug;
use std::sync::Arc;

use phihat::InnovationSection;
use phihat_model::Model;

use crate::error::RivalRefusal;

/// Everything that could be handed to a rival. What it declares decides what it gets.
#[derive(Debug, Clone)]
pub struct Supply {
    /// `M̄` \[kg·m²\] per joint.
    pub inertia: Vec<f64>,
    /// The nominal model: not the plant, unless somebody wants to see that case.
    pub model: Model,
    /// Nominal viscous friction \[N·m·s/rad\] per joint.
    pub viscous: Vec<f64>,
    /// Identified dry friction \[N·m\] per joint.
    pub dry: Vec<f64>,
    /// Torque limits \[N·m\] per joint.
    pub torque_max: Option<Vec<f64>>,
    /// Limits on the change of torque \[N·m/s\] per joint.
    pub torque_rate_max: Option<Vec<f64>>,
    /// Samples from a torque's command to its acting.
    pub delay_samples: u32,
    /// The period of the task \[s\].
    pub task_period: Option<f64>,
    /// The frame at the arm's tip.
    pub tip: String,
    /// The task as a closed path.
    pub orbit: Option<Arc<dyn TaskCurve>>,
    /// The gains that this project's design gives for the arm's specification; or why there are none.
    pub designed: Result<Vec<DesignedJoint>, RivalRefusal>,
    /// The same for laws from positions.
    pub designed_positions: Result<Vec<DesignedPosition>, RivalRefusal>,
    /// The same where they filter their innovation.
    pub designed_filters: Result<Vec<DesignedPosition>, RivalRefusal>,
}

impl Supply {
    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.model.joint_count()
    }
}

/// The law of one joint, as it was designed.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignedJoint {
    /// Nominal inertia `M̄` \[kg·m²\].
    pub inertia: f64,
    /// `K_p` \[1/s²\].
    pub kp: f64,
    /// `K_d` \[1/s\].
    pub kd: f64,
    /// Estimator coefficients `a_0 … a_{m−1}`, `a_i` in \[1/s^(m−i)\].
    pub a: Vec<f64>,
}

/// The law from positions of one joint, as it was designed.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignedPosition {
    /// Nominal inertia `M̄` \[kg·m²\].
    pub inertia: f64,
    /// `K_p` \[1/s²\].
    pub kp: f64,
    /// `K_d` \[1/s\].
    pub kd: f64,
    /// `ℓ` of [`PositionDesign`](phihat::PositionDesign).
    pub correction: Vec<f64>,
    /// `g`: share of the way to the wanted torque that is gone in one sample.
    pub share: f64,
    /// Sections of the filter on its innovation; empty: none.
    pub innovation_filter: Vec<InnovationSection>,
}

/// A closed path `q = Φ(θ)` in joint space, with the task's own speed: `θ` runs at 1 s/s.
pub trait TaskCurve: Debug + Send + Sync {
    /// `Φ`, `dΦ/dθ`, `d²Φ/dθ²` at `θ` \[s\], any number: \[rad\], \[rad/s\], \[rad/s²\].
    fn at(&self, theta: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]);
    /// Time of one turn \[s\].
    fn period(&self) -> f64;
}
