//! Forms of the law.

/// Form of the law, and so the meaning of a joint's state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Form {
    /// A disturbance observer fed with velocity and the torque that acted (T4): the default.
    #[default]
    Observer,
    /// The paper's (9), (10), (16): integrals of the error. For reproduction; it winds up under
    /// saturation, and starts with `φ̂(0) ≠ 0` when the error does not start at zero.
    Literal,
    /// An observer of the position and the torque that acted, see
    /// [`JointGains::from_positions`](crate::JointGains::from_positions).
    Positions,
}
