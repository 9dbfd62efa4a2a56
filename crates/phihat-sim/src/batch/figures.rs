//! The figures of many arms as their samples come, without a record.

use phihat_model::{FileChoice, Lanes, Pose, Scalar};

use super::law::CommandLanes;
use crate::metrics::{JointMetrics, Measured, Metrics};
use crate::tip;

/// Figures so far, one arm per lane: as [`Measured`] takes them, operation by operation.
#[derive(Debug)]
pub(super) struct BatchFigures {
    joints: Vec<JointFigures>,
    tip: TipFigures,
    half_period: Lanes,
    samples: u64,
    steady_samples: u64,
}

/// Figures of one joint of every arm.
#[derive(Debug, Clone, Default)]
struct JointFigures {
    inertia: Lanes,
    /// `e` and `∫e`.
    error: Lanes,
    integral: Lanes,
    /// The command before \[N·m\].
    tau: Lanes,
    squares: Lanes,
    error_peak: Lanes,
    error_steady: Lanes,
    integral_steady: Lanes,
    velocity_steady: Lanes,
    tau_max: Lanes,
    tau_step: Lanes,
    phi_max: Lanes,
    misfit_steady: Lanes,
    counts: Counts,
}

/// Commands that met a limit.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    saturated: [u64; Lanes::COUNT],
    rate_limited: [u64; Lanes::COUNT],
    saturated_steady: [u64; Lanes::COUNT],
    rate_limited_steady: [u64; Lanes::COUNT],
    limited_steady: [u64; Lanes::COUNT],
}

/// Figures of the tip of every arm.
#[derive(Debug, Clone, Default)]
struct TipFigures {
    error_peak: Lanes,
    error_steady: Lanes,
    /// Sine of half the largest angle, and the angle.
    half: Lanes,
    angle: [f64; Lanes::COUNT],
}

/// Motion and torque of a joint of every arm over one sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct ActedLanes {
    /// True acceleration at its start, the torque then, and the mean torque.
    pub(super) ddq: Lanes,
    pub(super) start: Lanes,
    pub(super) mean: Lanes,
}

impl BatchFigures {
    /// Before the first sample: the nominal inertia of every joint, and the sample period \[s\].
    pub(super) fn new(inertia: &[Lanes], period: f64) -> Self {
        let joint = |inertia: &Lanes| JointFigures { inertia: *inertia, ..JointFigures::default() };
        Self {
            joints: inertia.iter().map(joint).collect(),
            tip: TipFigures::default(),
            half_period: Lanes::splat(0.5 * period),
            samples: 0,
            steady_samples: 0,
        }
    }

    /// A sample begins at this state, with these references; `steady`: in the steady part.
    #[inline]
    pub(super) fn begin(&mut self, steady: bool, [q, dq]: [&[Lanes]; 2], wanted: &[[Lanes; 3]]) {
        let first = self.samples == 0;
        self.samples += 1;
        self.steady_samples += u64::from(steady);
        let sides = q.iter().zip(dq).zip(wanted);
        for (own, ((q, dq), [q_d, dq_d, _])) in self.joints.iter_mut().zip(sides) {
            let (e, de) = (*q - *q_d, *dq - *dq_d);
            if !first {
                own.integral += self.half_period * (own.error + e);
            }
            own.error = e;
            own.error_peak = own.error_peak.larger(e.abs());
            if steady {
                own.error_steady = own.error_steady.larger(e.abs());
                own.velocity_steady = own.velocity_steady.larger(de.abs());
                own.integral_steady = own.integral_steady.larger(own.integral.abs());
                own.squares += e * e;
            }
        }
    }

    /// A joint's sample ends: what was asked of it, and what came of it.
    #[inline]
    pub(super) fn end(
        &mut self,
        steady: bool,
        joint: usize,
        answer: &CommandLanes,
        acted: ActedLanes,
    ) {
        let first = self.samples == 1;
        let own = &mut self.joints[joint];
        let phi = acted.start - own.inertia * acted.ddq;
        own.tau_max = own.tau_max.larger(acted.mean.abs());
        own.phi_max = own.phi_max.larger(phi.abs());
        if steady {
            own.misfit_steady = own.misfit_steady.larger((phi - answer.phi_hat).abs());
        }
        if !first {
            own.tau_step = own.tau_step.larger((answer.tau - own.tau).abs());
        }
        own.tau = answer.tau;
        let either = answer.over_torque.or(answer.over_rate);
        if either.any() {
            own.counts.limited(steady, answer);
        }
    }

    /// The tip is at `a` where `b` is wanted.
    #[inline]
    pub(super) fn tip(&mut self, steady: bool, a: &Pose<Lanes>, b: &Pose<Lanes>) {
        let (off, half) = tip::between(a, b);
        let own = &mut self.tip;
        own.error_peak = own.error_peak.larger(off);
        if steady {
            own.error_steady = own.error_steady.larger(off);
            if half.exceeds(own.half).any() {
                own.turned(half);
            }
        }
    }

    /// The figures of one arm, beside its study's bounds.
    pub(super) fn of(&self, lane: usize, study: Measured) -> Metrics {
        let counts = (self.samples, self.steady_samples);
        let one = |lanes: Lanes| <[f64; Lanes::COUNT]>::from(lanes)[lane];
        let joint = |i: usize, metrics: &mut JointMetrics| {
            let own = &self.joints[i];
            metrics.error_peak_rad = one(own.error_peak);
            metrics.error_steady_max_rad = one(own.error_steady);
            metrics.error_integral_steady_max_rad_s = one(own.integral_steady);
            metrics.velocity_error_steady_max_rad_s = one(own.velocity_steady);
            metrics.tau_max_nm = one(own.tau_max);
            metrics.tau_step_max_nm = one(own.tau_step);
            metrics.phi_max_nm = one(own.phi_max);
            metrics.phi_error_steady_max_nm = one(own.misfit_steady);
            metrics.saturated_samples = own.counts.saturated[lane];
            metrics.rate_limited_samples = own.counts.rate_limited[lane];
            metrics.saturated_steady_samples = own.counts.saturated_steady[lane];
            metrics.rate_limited_steady_samples = own.counts.rate_limited_steady[lane];
            (one(own.squares), own.counts.limited_steady[lane])
        };
        let tip = [one(self.tip.error_peak), one(self.tip.error_steady), self.tip.angle[lane]];
        study.taken(counts, joint, tip)
    }
}

impl Counts {
    /// One more, in the lanes whose command met a limit.
    #[cold]
    fn limited(&mut self, steady: bool, answer: &CommandLanes) {
        let add = |counts: &mut [u64; Lanes::COUNT], chosen: FileChoice| {
            let ones = <[f64; Lanes::COUNT]>::from(chosen.ones());
            for (count, one) in counts.iter_mut().zip(ones) {
                *count += u64::from(one > 0.0);
            }
        };
        let (torque, rate) = (answer.over_torque, answer.over_rate);
        add(&mut self.saturated, torque);
        add(&mut self.rate_limited, rate);
        if steady {
            add(&mut self.saturated_steady, torque);
            add(&mut self.rate_limited_steady, rate);
            add(&mut self.limited_steady, torque.or(rate));
        }
    }
}

impl TipFigures {
    /// Some angle is larger than all before.
    #[cold]
    fn turned(&mut self, half: Lanes) {
        let (most, halves) = (<[f64; Lanes::COUNT]>::from(self.half), <[f64; 8]>::from(half));
        for (lane, half) in halves.into_iter().enumerate() {
            if half > most[lane] {
                tip::raise_angle(&mut self.angle[lane], half);
            }
        }
        self.half = self.half.larger(half);
    }
}
