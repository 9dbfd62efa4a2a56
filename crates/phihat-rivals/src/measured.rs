//! Inputs of a rival at a sample: measurements it [`Sees`], and the reference it [`Wants`].

use crate::handed::{All, Sees, Wants};
use crate::needs::Needs;

/// Measured positions.
#[derive(Debug, Clone, Copy)]
pub struct MeasuredPositions<'a> {
    /// \[rad\]
    pub q: &'a [f64],
}

/// Measured positions and velocities.
#[derive(Debug, Clone, Copy)]
pub struct MeasuredMotion<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
}

/// Measured positions, and the torque that acted.
#[derive(Debug, Clone, Copy)]
pub struct PositionsAndTorque<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[N·m\], mean since the previous sample.
    pub tau: &'a [f64],
}

/// Measured positions and velocities, and the torque that acted.
#[derive(Debug, Clone, Copy)]
pub struct MotionAndTorque<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
    /// \[N·m\], mean since the previous sample.
    pub tau: &'a [f64],
}

/// Measured positions and velocities, and the torque that was last commanded.
#[derive(Debug, Clone, Copy)]
pub struct MotionAndCommand<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
    /// \[N·m\], as the limits let it through; 0 at the first sample.
    pub commanded: &'a [f64],
}

/// The desired position and velocity.
#[derive(Debug, Clone, Copy)]
pub struct Velocity<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
}

/// The desired position, velocity and acceleration.
#[derive(Debug, Clone, Copy)]
pub struct Acceleration<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
    /// \[rad/s²\]
    pub ddq: &'a [f64],
}

/// The desired position, velocity and acceleration, the last one known in advance.
#[derive(Debug, Clone, Copy)]
pub struct Preview<'a> {
    /// \[rad\]
    pub q: &'a [f64],
    /// \[rad/s\]
    pub dq: &'a [f64],
    /// Mean over the interval in which the torque of this sample will act \[rad/s²\].
    pub ddq_acting: &'a [f64],
}

/// The clock alone: a rival that follows an orbit and not a time.
#[derive(Debug, Clone, Copy)]
pub struct NoReference;

impl<'a> Sees<'a> for MeasuredPositions<'a> {
    const NEEDS: Needs = Needs::NONE;
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q }
    }
}

impl<'a> Sees<'a> for MeasuredMotion<'a> {
    const NEEDS: Needs = Needs { velocity: true, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q, dq: all.dq }
    }
}

impl<'a> Sees<'a> for PositionsAndTorque<'a> {
    const NEEDS: Needs = Needs { torque: true, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q, tau: all.tau }
    }
}

impl<'a> Sees<'a> for MotionAndTorque<'a> {
    const NEEDS: Needs = Needs { velocity: true, torque: true, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q, dq: all.dq, tau: all.tau }
    }
}

impl<'a> Sees<'a> for MotionAndCommand<'a> {
    const NEEDS: Needs = Needs { velocity: true, commanded: true, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q, dq: all.dq, commanded: all.commanded }
    }
}

impl<'a> Wants<'a> for Velocity<'a> {
    const NEEDS: Needs = Needs { derivatives: 1, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q_d, dq: all.dq_d }
    }
}

impl<'a> Wants<'a> for Acceleration<'a> {
    const NEEDS: Needs = Needs { derivatives: 2, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q_d, dq: all.dq_d, ddq: all.ddq_d }
    }
}

impl<'a> Wants<'a> for Preview<'a> {
    const NEEDS: Needs = Needs { derivatives: 2, preview: true, ..Needs::NONE };
    fn of(all: &All<'a>) -> Self {
        Self { q: all.q_d, dq: all.dq_d, ddq_acting: all.ddq_d_acting }
    }
}

impl Wants<'_> for NoReference {
    const NEEDS: Needs = Needs::NONE;
    fn of(_: &All<'_>) -> Self {
        Self
    }
}
