//! Options of a supervised arm, with defaults.

use super::funnel::Funnel;
use super::range::JointRange;
use crate::{JointGains, MotionLimits};

/// Arm-wide options. Times are counted in samples of the period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Sample period \[ns\]; that of the gains.
    pub period_ns: u64,
    /// Oldest usable sample \[ns\].
    pub age_max_ns: u64,
    /// Largest advance of the sequence number; beyond it, or behind, a sample is out of order.
    pub sequence_window: u64,
    /// Samples missed in a row for which the last torque is held; then it fades to `φ̂`.
    pub hold_samples: u32,
    /// Samples missed in a row that stop the arm.
    pub stop_samples: u32,
    /// Unbelievable samples (not finite, not plausible) in a row that stop the arm.
    pub bad_samples: u32,
    /// Samples missed of the last 64 that stop the arm.
    pub lost_max: u32,
    /// Largest |q̇| that counts as rest \[rad/s\].
    pub rest_velocity: f64,
    /// Largest distance between pose and reference at which tracking starts \[rad\].
    pub start_mismatch_max: f64,
    /// Blend time of a change of reference or of gains \[s\].
    pub blend_s: f64,
    /// Damping in [`Mode::Armed`](crate::Mode::Armed) and [`Mode::SafeStop`](crate::Mode::SafeStop), as a
    /// share of `K_d`.
    pub stop_damping: f64,
    /// Time in a stop after which the brakes are requested even if the arm still moves \[s\].
    pub stop_s: f64,
    /// Longest time of a torque at its limit without a break before the arm is stopped \[s\]; `None`: no
    /// bound.
    pub saturation_s: Option<f64>,
    /// Wrong times between samples, of the last 64, that stop the arm.
    pub clock_max: u32,
    /// Time from the request for the brakes until they hold the arm \[s\]: the law gives way then. `None`:
    /// there are no brakes, and the law holds the arm for as long as it is measured.
    pub brake_s: Option<f64>,
    /// When to change between start gains and running gains; used where a joint has start gains.
    pub schedule: Schedule,
}

impl Options {
    /// The defaults at a sample period \[ns\].
    #[must_use]
    pub fn new(period_ns: u64) -> Self {
        Self {
            period_ns,
            age_max_ns: period_ns.saturating_mul(3),
            sequence_window: 1000,
            hold_samples: 5,
            stop_samples: 20,
            bad_samples: 5,
            lost_max: 21,
            rest_velocity: 0.05,
            start_mismatch_max: 0.05,
            blend_s: 0.5,
            stop_damping: 0.5,
            stop_s: 0.5,
            saturation_s: None,
            clock_max: 32,
            brake_s: None,
            schedule: Schedule { settled: 1.0, disturbed: f64::INFINITY, dwell_s: 0.1 },
        }
    }
}

/// When the running gains replace the start gains, and when they give way again.
///
/// The mismatch `φ − φ̂`, averaged over some 50 ms, must stay below `settled` (root mean square) in every
/// joint for `dwell_s`: then the running gains take over, in all joints at once. Beyond `disturbed` in any
/// joint for as long the start gains come back. A change never steps the torque. In the literal form `φ̂` is
/// handed over, and what the lower integrals knew of its rate is not: the rate of the torque may step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// \[N·m\]
    pub settled: f64,
    /// \[N·m\]; infinite: never back.
    pub disturbed: f64,
    /// \[s\]
    pub dwell_s: f64,
}

/// Options of one joint; the default is the law with finite, fresh samples and torque limits only.
///
/// # Example
///
/// ```
/// use phihat::{JointOptions, JointRange, MotionLimits};
///
/// // What is left out is not judged and not changed.
/// let options = JointOptions::<f64> {
///     velocity_max: Some(2.5),
///     range: Some(JointRange { lower: -2.8, upper: 2.8, soft: 0.05, braking: 5.0 }),
///     error_stop: Some(0.1),
///     motion: Some(MotionLimits { velocity: 2.0, acceleration: 10.0, jerk: 500.0 }),
///     ..JointOptions::default()
/// };
/// assert!(options.funnel.is_none());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointOptions<R> {
    /// Largest |q̇| \[rad/s\]: a joint that is faster is stopped. A jump to a higher velocity, or a step in
    /// position beyond it, is not plausible.
    pub velocity_max: Option<f64>,
    /// Position limits of the joint.
    pub range: Option<JointRange>,
    /// Largest |e| while the law runs \[rad\]; beyond it the arm stops.
    pub error_stop: Option<f64>,
    /// Certified bound on the measured |e| in holding and tracking \[rad\]: the bound on |e|, and half a quantum of the
    /// encoder. An error that is beyond it in [three samples](crate::Fault::ErrorBound) in a row stops the arm;
    /// [`Report::error_share`](crate::Report) is the error as a share of it.
    pub error_bound: Option<f64>,
    /// A position that stands still while the joint should have moved this far is frozen \[rad\]: some
    /// quanta of the encoder.
    pub frozen_travel: Option<f64>,
    /// Limits that every reference is shaped to.
    pub motion: Option<MotionLimits>,
    /// Ends of the box that every reference is kept in \[rad\], as by [`BoxedShaper`](crate::BoxedShaper); only with
    /// `motion`. An arm that is not inside is not engaged.
    pub reference_box: Option<(f64, f64)>,
    /// Deceleration and jerk of a stop; `velocity` does not count. `None`: a quarter of what the torque
    /// limits give the nominal inertia, or what the outer loop gives it at an error of 0.2 rad.
    pub stop: Option<MotionLimits>,
    /// Inside this |e| \[rad\], with the reference at rest, the estimate is held: no hunting under stiction, at
    /// the price of this much error.
    pub dead_zone: Option<f64>,
    /// Bound on the error at start-up.
    pub funnel: Option<Funnel>,
    /// Root mean square of the demand's second difference that counts as oscillation \[N·m\]. White noise of
    /// the torque makes `√6` of its own: stay well above that. Behind a torque-rate limit do not take a share of
    /// the torque limit: an oscillation grows only until the rate limit acts on it, and its second difference
    /// then stays at a few times the largest change of torque per sample, however large the torque limit. Take
    /// about three times that change, 3 N·m at 1000 N·m/s and 1 kHz; without a rate limit, a tenth of the
    /// torque limit.
    pub oscillation: Option<f64>,
    /// Torque variation \[N·m, root mean square\] that is enough to judge, during the first quarter of a second,
    /// whether the joint accelerates the way the torque pushes.
    pub first_motion: Option<f64>,
    /// Gains for the start, of lower order or slower, and of the running gains' form; see [`Schedule`].
    pub start: Option<JointGains<R>>,
}
