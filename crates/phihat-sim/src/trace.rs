//! The record of a run: every signal of every joint at every control sample.

/// Signals of one joint, one entry per sample; all vectors have the same length.
///
/// At sample `k` (time `t_k = k·T`): what was measured, what was wanted, what was commanded, and the
/// torque that acted over the interval `[t_k, t_{k+1})`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointTrace {
    /// Joint name, as in the robot description.
    pub name: String,
    /// True position `q` \[rad\] (m for prismatic joints, here and below).
    pub q: Vec<f64>,
    /// True velocity `q̇` \[rad/s\].
    pub dq: Vec<f64>,
    /// True acceleration `q̈` at the start of the interval \[rad/s²\].
    pub ddq: Vec<f64>,
    /// Desired position \[rad\].
    pub q_desired: Vec<f64>,
    /// Desired velocity \[rad/s\].
    pub dq_desired: Vec<f64>,
    /// Desired acceleration \[rad/s²\].
    pub ddq_desired: Vec<f64>,
    /// True position error `e = q − q_d` \[rad\].
    pub e: Vec<f64>,
    /// Its integral since the start of the run, `∫e` \[rad·s\].
    pub e_integral: Vec<f64>,
    /// True velocity error `ė` \[rad/s\].
    pub de: Vec<f64>,
    /// Measured position, after the encoder \[rad\].
    pub q_measured: Vec<f64>,
    /// Measured or differenced velocity that the controller saw \[rad/s\].
    pub dq_measured: Vec<f64>,
    /// Commanded torque, after the controller's own limits \[N·m\].
    pub tau_command: Vec<f64>,
    /// Torque that acted at the joint (delayed, driven, limited) \[N·m\].
    pub tau_applied: Vec<f64>,
    /// Lumped unknown dynamics `φ = τ_applied − M̄ q̈` \[N·m\].
    pub phi: Vec<f64>,
    /// Its estimate `φ̂`, which is *added* to the torque \[N·m\].
    pub phi_hat: Vec<f64>,
    /// Whether the torque limit acted on this command.
    pub saturated: Vec<bool>,
    /// Whether the torque-rate limit acted on this command.
    pub rate_limited: Vec<bool>,
}

/// A whole run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trace {
    /// Sample period \[ns\].
    pub period_ns: u64,
    /// Time of each sample \[ns\] since the start.
    pub t_ns: Vec<u64>,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointTrace>,
}
