//! A joint's law and what stands between it and the inertia, as numbers.

/// Law of one joint between limits: a sampled linear system, `x ← A x + B (q, q̇, τ)`, `τ = C x + D (q, q̇, τ)`.
///
/// Inputs are the position error \[rad\], the velocity error \[rad/s\] and the torque reported to the law \[N·m\]; the
/// output is the torque commanded \[N·m\]. The state starts at zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Law {
    /// `A`, row by row.
    pub state: Vec<Vec<f64>>,
    /// `B`, row by row.
    pub input: Vec<[f64; 3]>,
    /// `C`.
    pub output: Vec<f64>,
    /// `D`.
    pub direct: [f64; 3],
}

/// Rest of a joint's sampled loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Sample period `T` \[s\].
    pub period: f64,
    /// Nominal inertia `M̄` \[kg·m²\].
    pub inertia: f64,
    /// Samples from a measurement to the torque that it makes.
    pub late: usize,
    /// Velocity that the law gets.
    pub velocity: VelocityModel,
    /// First-order drive; `None`: torque acts at once.
    pub drive: Option<DriveModel>,
    /// Torque reported to the law.
    pub reported: Reported,
}

/// `y_k = last · y_{k−1} + velocity · q̇_k + position · q_k + before · q_{k−1}`, the velocity error that the law gets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityModel {
    /// Weight of its last value.
    pub last: f64,
    /// Weight of the joint's velocity.
    pub velocity: f64,
    /// Weight of the position as read \[1/s\].
    pub position: f64,
    /// Weight of the position as read before \[1/s\].
    pub before: f64,
}

/// Drive of first order over one sample, from its torque `τ_0` at the start to a command `u`, by `g = τ_0 − u`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveModel {
    /// Torque at the end: `u + (1 − lost) g`.
    pub lost: f64,
    /// Mean torque: `u + mean g`.
    pub mean: f64,
    /// `∫_0^T (T − t) τ dt = T²u/2 + double g` \[s²\].
    pub double: f64,
}

/// Torque reported to the law at a sample, of the interval just ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reported {
    /// The mean torque that acted.
    Applied,
    /// The command that the drive got.
    Commanded,
}
