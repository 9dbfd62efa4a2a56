//! Inputs of a rival, by its types: measurements, reference and knowledge of the arm, and nothing else.

use crate::error::RivalRefusal;
use crate::needs::Needs;
use crate::supply::Supply;

/// Everything that there is at a control sample; slices have one entry per joint.
#[derive(Debug, Clone, Copy)]
pub struct All<'a> {
    /// Measured position \[rad\].
    pub q: &'a [f64],
    /// Measured velocity \[rad/s\].
    pub dq: &'a [f64],
    /// Torque that acted (mean) since the previous sample \[N·m\].
    pub tau: &'a [f64],
    /// Torque that was last commanded, as the limits let it through \[N·m\]: 0 at the first sample. Behind a
    /// delay it has not acted yet.
    pub commanded: &'a [f64],
    /// True for joints whose last torque met a limit.
    pub clipped: &'a [bool],
    /// Desired position \[rad\].
    pub q_d: &'a [f64],
    /// Desired velocity \[rad/s\].
    pub dq_d: &'a [f64],
    /// Desired acceleration \[rad/s²\].
    pub ddq_d: &'a [f64],
    /// Mean of the desired acceleration over the interval in which the torque of this sample will act \[rad/s²\].
    pub ddq_d_acting: &'a [f64],
}

/// Measurements that a rival takes.
pub trait Sees<'a>: Sized {
    /// As data.
    const NEEDS: Needs;
    /// Takes them, and leaves the rest.
    fn of(all: &All<'a>) -> Self;
}

/// The reference and as many of its derivatives as a rival takes.
pub trait Wants<'a>: Sized {
    /// As data.
    const NEEDS: Needs;
    /// Takes them, and leaves the rest.
    fn of(all: &All<'a>) -> Self;
}

/// Knowledge of a rival before it starts. Fields are private to this crate: a rival with
/// [`Nothing`](crate::Nothing) cannot obtain a model.
pub trait Knows: Sized {
    /// As data.
    const NEEDS: Needs;
    /// Takes it, and leaves the rest.
    ///
    /// # Errors
    ///
    /// [`Refusal::NotApplicable`] when the supply does not have it.
    fn of(supply: &Supply) -> Result<Self, RivalRefusal>;
}
