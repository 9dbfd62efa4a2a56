//! Options, checked once, in the running scalar.

use super::arrivals::ArrivalRules;
use super::funnel::FunnelRules;
use super::option_error::{positive, value};
use super::range::RangeRules;
use super::stopping::StopRules;
use crate::joint::SampleInterval;
use crate::{BoxedShaper, JointGains, JointOptions, OptionError, Options, Real, Shaper};

/// Averaging time of the mean `φ̂` that a shaken arm holds, and of the mean mismatch of a schedule \[s\]:
/// long against the noise of a differentiated velocity, short against the 0.1 s for which a schedule waits. A
/// mean is at most as short as one sample.
const AVERAGING_S: f64 = 0.05;

/// Least age of the `φ̂` that a stop may hold, at most twice as long \[s\]: it is from before the cause of
/// the stop, since a push moves an arm off its reference within a tenth of this time.
const BEFORE_S: f64 = 0.25;

/// Time after the start of the law in which a joint is watched for a wrong sign, a dead drive or a closed
/// brake \[s\]: the torque has to vary in that time; later it may be constant and shows nothing.
const FIRST_MOTION_S: f64 = 0.25;

/// Longest sample period \[ns\]: one second, so that no count of samples overflows.
const PERIOD_MAX_NS: u64 = 1_000_000_000;

/// Relative difference of two sample periods that are the same one: more than rounding in `f32` makes, less than any
/// two rates differ.
const PERIOD_TOLERANCE: f64 = 1e-6;

/// Samples whose loss is stored: a word of 64 bits.
const HISTORY: u32 = u64::BITS;

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
    /// Share of a sample in a mean over [`AVERAGING_S`].
    pub(crate) average: R,
    pub(crate) first_motion_samples: u32,
    pub(crate) clock_max: u32,
    pub(crate) saturation_samples: u32,
    /// Samples from the request for the brakes until they are closed; `None`: there are none.
    pub(crate) brake_samples: Option<u32>,
    /// Samples between two stored values of `φ̂`.
    pub(crate) block: u32,
}

/// [`JointOptions`] and the gains, checked, in the running scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointRules<R> {
    /// Start gains, running gains; twice the same where there are no start gains.
    pub(crate) gains: [JointGains<R>; 2],
    /// True if there are start gains.
    pub(crate) scheduled: bool,
    pub(crate) velocity_max: R,
    pub(crate) range: Option<RangeRules<R>>,
    pub(crate) error_stop: R,
    /// One over the bound on the measured error; 0 without one.
    pub(crate) bound_inverse: R,
    pub(crate) frozen_travel: Option<R>,
    pub(crate) shaper: Option<Shaper<R>>,
    /// The same with a box.
    pub(crate) boxed: Option<BoxedShaper<R>>,
    pub(crate) stop: StopRules<R>,
    /// Largest deviation of a measured torque from the commanded one \[N·m\].
    pub(crate) torque_slack: R,
    /// Distance in which the shaper stops, at its velocity limit, per velocity: `v/2A + A/2J`.
    pub(crate) stopping: [R; 2],
    pub(crate) dead_zone: R,
    pub(crate) funnel: Option<FunnelRules<R>>,
    /// Mean squares.
    pub(crate) oscillation: Option<R>,
    pub(crate) first_motion: Option<R>,
}

impl<R: Real> ArmRules<R> {
    pub(crate) fn nominal(&self) -> SampleInterval<R> {
        SampleInterval { step: self.period, parts: 1, share: R::from_f64(1.0) }
    }

    /// Checks arm-wide options.
    ///
    /// # Errors
    ///
    /// [`OptionError::Value`].
    pub fn new(options: &Options) -> Result<Self, OptionError> {
        let period = options.period_ns as f64 * 1e-9;
        positive(period, "period", 0)?;
        value(options.period_ns <= PERIOD_MAX_NS, "period", period, "at most one second", 0)?;
        positive(options.rest_velocity, "rest velocity", 0)?;
        positive(options.start_mismatch_max, "start mismatch", 0)?;
        positive(options.blend_s, "blend time", 0)?;
        positive(options.stop_s, "stop time", 0)?;
        options.saturation_s.map_or(Ok(()), |s| positive(s, "saturation time", 0))?;
        options.brake_s.map_or(Ok(()), |s| positive(s, "brakes' closing time", 0))?;
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
            lost_max: options.lost_max.min(HISTORY),
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
            average: R::from_f64((period / AVERAGING_S).min(1.0)),
            first_motion_samples: samples(FIRST_MOTION_S),
            clock_max: options.clock_max.min(HISTORY),
            saturation_samples: options.saturation_s.map_or(u32::MAX, samples),
            brake_samples: options.brake_s.map(samples),
            block: samples(BEFORE_S),
        })
    }
}

/// Keeps the reference in the box that the options state.
fn boxed<R: Real>(
    joint: usize,
    options: &JointOptions<R>,
    period: f64,
) -> Result<Option<BoxedShaper<R>>, OptionError> {
    let Some((lower, upper)) = options.reference_box else { return Ok(None) };
    let Some(limits) = &options.motion else {
        let (option, valid) =
            ("box of the reference", "left out where the reference is not shaped");
        return Err(OptionError::Value { option, value: upper - lower, valid, joint });
    };
    let boxed = BoxedShaper::new(limits, (lower, upper), period);
    boxed.map(Some).map_err(|error| OptionError::Motion { joint, error })
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
        let same =
            (gains.period - R::from_f64(period)).abs() <= R::from_f64(PERIOD_TOLERANCE * period);
        if !same {
            return Err(OptionError::Period { joint });
        }
        if let Some(start) = &options.start {
            plain.fits(joint, start)?;
            if gains.form != start.form {
                return Err(OptionError::Form { joint });
            }
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
        let boxed = boxed(joint, options, period)?;
        if let Some(limits) = &options.stop {
            Shaper::<R>::new(limits, period)
                .map_err(|error| OptionError::Motion { joint, error })?;
        }
        let stopping = options
            .motion
            .map_or([0.0; 2], |m| [0.5 / m.acceleration, 0.5 * m.acceleration / m.jerk]);
        let optional = |x: Option<f64>, name: &'static str| match x {
            None => Ok(None),
            Some(x) => positive(x, name, joint).map(|()| Some(R::from_f64(x))),
        };
        let square = |x: R| x * x;
        Ok(Self {
            gains: [options.start.unwrap_or(*gains), *gains],
            scheduled: options.start.is_some(),
            velocity_max: optional(options.velocity_max, "velocity limit")?
                .unwrap_or(plain.velocity_max),
            range: options.range.as_ref().map(|range| RangeRules::new(range, gains)),
            error_stop: optional(options.error_stop, "error limit")?.unwrap_or(plain.error_stop),
            frozen_travel: optional(options.frozen_travel, "frozen travel")?,
            shaper,
            boxed,
            bound_inverse: optional(options.error_bound, "error bound")?
                .map_or(R::ZERO, |bound| R::from_f64(1.0) / bound),
            stop: StopRules::new(gains, options.stop.as_ref()),
            torque_slack: plain.torque_slack,
            stopping: stopping.map(R::from_f64),
            dead_zone: optional(options.dead_zone, "dead zone")?.unwrap_or(plain.dead_zone),
            funnel: options.funnel.map(|f| f.rules(period, joint)).transpose()?,
            oscillation: optional(options.oscillation, "oscillation")?.map(square),
            first_motion: optional(options.first_motion, "first motion")?.map(square),
        })
    }

    /// The law and its limits, nothing else.
    pub(crate) fn plain(gains: &JointGains<R>) -> Self {
        let infinite = R::from_f64(f64::INFINITY);
        Self {
            gains: [*gains; 2],
            scheduled: false,
            velocity_max: infinite,
            range: None,
            error_stop: infinite,
            frozen_travel: None,
            shaper: None,
            boxed: None,
            bound_inverse: R::ZERO,
            stop: StopRules::new(gains, None),
            torque_slack: gains.torque_slack(),
            stopping: [R::ZERO; 2],
            dead_zone: R::ZERO,
            funnel: None,
            oscillation: None,
            first_motion: None,
        }
    }

    /// The gains in force.
    pub(crate) fn in_force(&self, raised: bool) -> &JointGains<R> {
        &self.gains[usize::from(raised)]
    }

    /// The running gains: theirs are the limits.
    pub(crate) fn running(&self) -> &JointGains<R> {
        self.in_force(true)
    }

    /// Checks that gains are for the sample period of these.
    pub(crate) fn fits(&self, joint: usize, gains: &JointGains<R>) -> Result<(), OptionError> {
        let difference = (gains.period - self.running().period).abs();
        let same = difference <= R::from_f64(PERIOD_TOLERANCE) * self.running().period;
        if same { Ok(()) } else { Err(OptionError::Period { joint }) }
    }
}
