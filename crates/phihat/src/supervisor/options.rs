//! What a user sets, with defaults; checked once, turned into rules for the running scalar.

use core::fmt;

use super::arrivals::ArrivalRules;
use super::memory::JointMemory;
use super::range::RangeRules;
use crate::joint::Interval;
use crate::{Form, GainError, JointGains, JointRange, MotionLimits, Real, Shaper};

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
    /// How long a change of reference or of gains is blended over \[s\].
    pub blend_s: f64,
    /// Damping in [`Mode::Armed`](crate::Mode::Armed) and [`Mode::SafeStop`](crate::Mode::SafeStop), as a share of `K_d`.
    pub stop_damping: f64,
    /// After this time in a stop the brakes are asked for even if the arm still moves \[s\].
    pub stop_s: f64,
    /// When to change between start gains and running gains; used where a joint has start gains.
    pub schedule: Schedule,
}

/// When the running gains replace the start gains, and when they give way again.
///
/// The mismatch `φ − φ̂`, averaged over some 50 samples, must stay below `settled` (root mean square) in every
/// joint for `dwell_s`: then the running gains take over, in all joints at once. Beyond `disturbed` in any joint for as
/// long the start gains come back. A change never steps the torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Schedule {
    /// \[N·m\]
    pub settled: f64,
    /// \[N·m\]; infinite: never back.
    pub disturbed: f64,
    /// \[s\]
    pub dwell_s: f64,
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
            schedule: Schedule { settled: 1.0, disturbed: f64::INFINITY, dwell_s: 0.1 },
        }
    }
}

/// Options of one joint; the default is the law with finite, fresh samples and torque limits only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointOptions<R> {
    /// Largest plausible |q̇| \[rad/s\]; it bounds the step in position as well.
    pub velocity_max: Option<f64>,
    /// Where the joint may be.
    pub range: Option<JointRange>,
    /// Largest |e| while the law runs \[rad\]; beyond it the arm stops.
    pub error_max: Option<f64>,
    /// A position that stands still while the joint should have moved this far is frozen \[rad\]: some
    /// quanta of the encoder.
    pub frozen_travel: Option<f64>,
    /// Limits that every reference is shaped to.
    pub motion: Option<MotionLimits>,
    /// Inside this |e| \[rad\], with the reference at rest, the estimate is held: no hunting under stiction, at
    /// the price of this much error.
    pub dead_zone: Option<f64>,
    /// Bound on the error at start-up.
    pub funnel: Option<Funnel>,
    /// Root mean square of the demand's second difference that counts as oscillation \[N·m\]. A tenth of the
    /// torque limit is far above certified noise.
    pub oscillation: Option<f64>,
    /// Torque variation \[N·m, root mean square\] that is enough to judge, during the first quarter of a second,
    /// whether the joint accelerates the way the torque pushes.
    pub first_motion: Option<f64>,
    /// Gains for the start, of lower order or slower; see [`Schedule`].
    pub start: Option<JointGains<R>>,
}

/// A bound `|e| < ψ(t)` for the start, before the estimator takes over.
///
/// # Law
///
/// ```text
/// ψ(t) = final + (initial − final) e^{−t/decay}
/// τ = M̄ (q̈_d − g K_d ė − g² K_p e),    g = 1/(1 − (e/ψ)²),  at most (K_d + a_{m−1})/K_d
/// ```
///
/// The bound on `g` keeps the derivative gain that of the full law, which the inertia window allows; so the
/// funnel holds while `|φ| < M̄ g² K_p ψ` and the torque limit suffices, and leaving it is an event. The
/// estimator listens meanwhile. 0.1 s after ψ has come close to its final value, the torque is blended over to
/// the law, which takes the rest of the error away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Funnel {
    /// ψ at the start \[rad\].
    pub initial: f64,
    /// ψ at the end \[rad\].
    pub r#final: f64,
    /// \[s\]
    pub decay_s: f64,
}

/// Why options are refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum OptionError {
    /// An option is out of its range.
    Value {
        /// Which.
        option: &'static str,
        /// Its value.
        value: f64,
        /// What would be valid.
        valid: &'static str,
        /// Of which joint; arm-wide options say 0.
        joint: usize,
    },
    /// A joint's gains are for another sample period.
    Period {
        /// Which joint.
        joint: usize,
    },
    /// Start gains need the observer form: integrals of the error do not survive a change of order.
    Form {
        /// Which joint.
        joint: usize,
    },
    /// A limit of the reference governor.
    Motion {
        /// Which joint.
        joint: usize,
        /// What is wrong with it.
        error: GainError,
    },
}

impl fmt::Display for OptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { option, value, valid, joint } => {
                write!(f, "joint {joint}: {option} is {value}; it must be {valid}")
            }
            Self::Period { joint } => {
                write!(f, "joint {joint}: its gains are for another sample period than the options")
            }
            Self::Form { joint } => {
                write!(f, "joint {joint}: start gains need the observer form, in both sets")
            }
            Self::Motion { joint, error } => write!(f, "joint {joint}: {error}"),
        }
    }
}

impl core::error::Error for OptionError {}

/// [`Options`], checked, in the running scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmRules<R> {
    pub(crate) arrivals: ArrivalRules,
    pub(crate) hold_samples: u32,
    pub(crate) stop_samples: u32,
    pub(crate) bad_samples: u32,
    pub(crate) lost_max: u32,
    pub(crate) period: R,
    pub(crate) rest_velocity: R,
    pub(crate) start_mismatch_max: R,
    pub(crate) blend: R,
    pub(crate) blend_rate: R,
    pub(crate) stop_damping: R,
    pub(crate) stop_samples_max: u32,
    pub(crate) settled: R,
    pub(crate) disturbed: R,
    pub(crate) dwell_samples: u32,
    pub(crate) first_motion_samples: u32,
}

/// [`JointOptions`] and the gains, checked, in the running scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointRules<R> {
    pub(crate) gains: JointGains<R>,
    pub(crate) start: Option<JointGains<R>>,
    pub(crate) velocity_max: R,
    pub(crate) range: Option<RangeRules<R>>,
    pub(crate) error_max: R,
    pub(crate) frozen_travel: R,
    pub(crate) shaper: Option<Shaper<R>>,
    /// Distance in which the shaper stops, at its velocity limit, per velocity: `v/2A + A/2J`.
    pub(crate) stopping: [R; 2],
    pub(crate) dead_zone: R,
    pub(crate) funnel: Option<FunnelRules<R>>,
    pub(crate) oscillation: R,
    pub(crate) first_motion: R,
}

/// [`Funnel`] in the running scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FunnelRules<R> {
    pub(crate) excess: R,
    pub(crate) width: R,
    /// Factor of the excess width per sample.
    pub(crate) factor: R,
}

fn value(
    ok: bool,
    option: &'static str,
    value: f64,
    valid: &'static str,
    joint: usize,
) -> Result<(), OptionError> {
    if ok { Ok(()) } else { Err(OptionError::Value { option, value, valid, joint }) }
}

const POSITIVE: &str = "positive and finite";

fn positive(x: f64, option: &'static str, joint: usize) -> Result<(), OptionError> {
    value(x.is_finite() && x > 0.0, option, x, POSITIVE, joint)
}

impl<R: Real> ArmRules<R> {
    pub(crate) fn nominal(&self) -> Interval<R> {
        Interval { step: self.period, parts: 1, share: R::from_f64(1.0) }
    }

    /// Checks arm-wide options.
    ///
    /// # Errors
    ///
    /// [`OptionError::Value`].
    pub fn new(options: &Options) -> Result<Self, OptionError> {
        let period = options.period_ns as f64 * 1e-9;
        positive(period, "period", 0)?;
        value(options.period_ns <= 1_000_000_000, "period", period, "at most one second", 0)?;
        positive(options.rest_velocity, "rest velocity", 0)?;
        positive(options.start_mismatch_max, "start mismatch", 0)?;
        positive(options.blend_s, "blend time", 0)?;
        positive(options.stop_s, "stop time", 0)?;
        let damping = options.stop_damping;
        value((0.0..=1.0).contains(&damping), "stop damping", damping, "0 … 1", 0)?;
        let stop = f64::from(options.stop_samples);
        value(options.stop_samples > 0, "stop samples", stop, "at least 1", 0)?;
        value(options.bad_samples > 0, "bad samples", 0.0, "at least 1", 0)?;
        let schedule = &options.schedule;
        positive(schedule.settled, "schedule settled", 0)?;
        let above = schedule.disturbed > schedule.settled;
        value(above, "schedule disturbed", schedule.disturbed, "above settled", 0)?;
        positive(schedule.dwell_s, "schedule dwell", 0)?;
        let samples = |seconds: f64| count(seconds / period);
        Ok(Self {
            arrivals: ArrivalRules {
                period_ns: options.period_ns,
                age_max_ns: options.age_max_ns,
                window: options.sequence_window.max(1),
            },
            hold_samples: options.hold_samples.min(options.stop_samples),
            stop_samples: options.stop_samples,
            bad_samples: options.bad_samples,
            lost_max: options.lost_max.min(64),
            period: R::from_f64(period),
            rest_velocity: R::from_f64(options.rest_velocity),
            start_mismatch_max: R::from_f64(options.start_mismatch_max),
            blend: R::from_f64(options.blend_s),
            blend_rate: R::from_f64(period / options.blend_s),
            stop_damping: R::from_f64(damping),
            stop_samples_max: samples(options.stop_s),
            settled: R::from_f64(schedule.settled),
            disturbed: R::from_f64(schedule.disturbed),
            dwell_samples: samples(schedule.dwell_s),
            first_motion_samples: samples(0.25),
        })
    }
}

/// A moderate positive number as a count, at least 1.
fn count(x: f64) -> u32 {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the cast of a float saturates; larger counts mean the same: a very long time"
    )]
    let whole = (x + 0.5) as u32;
    whole.max(1)
}

impl<R: Real> JointRules<R> {
    /// Checks one joint's options against its gains and the arm's options. `joint` is its place, for errors.
    ///
    /// # Errors
    ///
    /// [`OptionError`].
    pub fn new(
        joint: usize,
        gains: &JointGains<R>,
        options: &JointOptions<R>,
        arm: &Options,
    ) -> Result<Self, OptionError> {
        let period = arm.period_ns as f64 * 1e-9;
        let plain = Self::plain(gains);
        let same = (gains.period - R::from_f64(period)).abs() <= R::from_f64(1e-6 * period);
        if !same {
            return Err(OptionError::Period { joint });
        }
        if let Some(start) = &options.start {
            plain.fits(joint, start)?;
        }
        if let Some(start) = &options.start
            && (start.form != Form::Observer || gains.form != Form::Observer)
        {
            return Err(OptionError::Form { joint });
        }
        if let Some(range) = &options.range {
            let width = range.upper - range.lower;
            positive(width, "width of the range", joint)?;
            positive(range.braking, "braking deceleration", joint)?;
            let fits = range.soft > 0.0 && range.soft < 0.5 * width;
            value(fits, "soft zone", range.soft, "positive and less than half the range", joint)?;
        }
        let shaper = match &options.motion {
            None => None,
            Some(limits) => Some(
                Shaper::new(limits, period)
                    .map_err(|error| OptionError::Motion { joint, error })?,
            ),
        };
        let stopping = options
            .motion
            .map_or([0.0; 2], |m| [0.5 / m.acceleration, 0.5 * m.acceleration / m.jerk]);
        let infinite = f64::INFINITY;
        let optional = |x: Option<f64>, name: &'static str, none: f64| match x {
            None => Ok(R::from_f64(none)),
            Some(x) => positive(x, name, joint).map(|()| R::from_f64(x)),
        };
        let square = |x: R| x * x;
        Ok(Self {
            start: options.start,
            velocity_max: optional(options.velocity_max, "velocity limit", infinite)?,
            range: options.range.as_ref().map(RangeRules::new),
            error_max: optional(options.error_max, "error limit", infinite)?,
            frozen_travel: optional(options.frozen_travel, "frozen travel", infinite)?,
            shaper,
            stopping: stopping.map(R::from_f64),
            dead_zone: optional(options.dead_zone, "dead zone", 0.0)?,
            funnel: options.funnel.map(|f| f.rules(period, joint)).transpose()?,
            oscillation: square(optional(options.oscillation, "oscillation", infinite)?),
            first_motion: square(optional(options.first_motion, "first motion", infinite)?),
            ..plain
        })
    }

    /// The law and its limits, nothing else.
    pub(crate) fn plain(gains: &JointGains<R>) -> Self {
        let infinite = R::from_f64(f64::INFINITY);
        Self {
            gains: *gains,
            start: None,
            velocity_max: infinite,
            range: None,
            error_max: infinite,
            frozen_travel: infinite,
            shaper: None,
            stopping: [R::ZERO; 2],
            dead_zone: R::ZERO,
            funnel: None,
            oscillation: infinite,
            first_motion: infinite,
        }
    }

    /// Whether gains are for the sample period of these.
    pub(crate) fn fits(&self, joint: usize, gains: &JointGains<R>) -> Result<(), OptionError> {
        let difference = (gains.period - self.gains.period).abs();
        let same = difference <= R::from_f64(1e-6) * self.gains.period;
        if same { Ok(()) } else { Err(OptionError::Period { joint }) }
    }

    /// Puts other gains in force, without a step in torque.
    pub(crate) fn exchange(
        &mut self,
        memory: &mut JointMemory<R>,
        gains: JointGains<R>,
        raised: bool,
    ) {
        let old = *self.in_force(raised);
        self.gains = gains;
        Self::change(memory, &old, self.in_force(raised));
    }
}

impl Funnel {
    fn rules<R: Real>(&self, period: f64, joint: usize) -> Result<FunnelRules<R>, OptionError> {
        positive(self.r#final, "final funnel width", joint)?;
        positive(self.decay_s, "funnel decay", joint)?;
        let wider = self.initial.is_finite() && self.initial >= self.r#final;
        value(wider, "initial funnel width", self.initial, "at least the final one", joint)?;
        let [alpha, ..] = crate::sampled::sampled_coefficients(&[1.0 / self.decay_s], period);
        Ok(FunnelRules {
            excess: R::from_f64(self.initial - self.r#final),
            width: R::from_f64(self.r#final),
            factor: R::from_f64(1.0 - alpha * period),
        })
    }
}
