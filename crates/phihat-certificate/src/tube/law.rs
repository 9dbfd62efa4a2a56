//! The sampled law of one joint with its sensor and delays, and the same as a linear map.

use core::f64::consts::TAU;
use phihat::{JointGains, JointState, Measurement, Reference, TorqueSource, VelocitySource};

use phihat_study::Study;

use super::scope::ScopeRefusal;
use crate::check::law::LawMatrices;
use crate::{JointRecord, LoopModel};

/// One joint's loop from the reading to the torque that is sent to the drive.
///
/// State: `y` last reading, `v` filtered velocity, [late messages], the law's as the core has it, commands from newest
/// to the one that acts, [the gap of a drive's torque at the start of the interval].
///
/// # Law of a drive
///
/// ```text
/// τ(t) = told + gap e^{−ωt},   mean = told + gap (1 − e^{−ωT})/(ωT),   gap ← gap e^{−ωT} + told_before − told
/// ```
#[derive(Debug, Clone)]
pub(super) struct LawLoop {
    period: f64,
    law: JointGains<f64>,
    matrices: LawMatrices,
    pub(super) measured: bool,
    filter: f64,
    late: usize,
    delay: usize,
    begin: LawBegin,
    drive: Option<LagOfDrive>,
    pub(super) size: usize,
}

/// Source of the first command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LawBegin {
    /// The law's.
    AtOnce,
    /// None: the law is first asked at the second sample.
    OneLater,
    /// The torque that held the arm before.
    Held,
}

/// A drive's first-order lag.
#[derive(Debug, Clone, Copy)]
pub(super) struct LagOfDrive {
    /// `ω` \[rad/s\].
    pub(super) rate: f64,
    /// `e^{−ωT}`.
    left: f64,
    /// Share of the gap in the torque that the estimator is told.
    told: f64,
}

/// Reference of the joint at a sample.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct JointReference {
    pub(super) q: f64,
    pub(super) dq: f64,
    /// Acceleration that is fed forward.
    pub(super) ddq: f64,
    /// The torque to take over at the first sample, where that is done.
    pub(super) held: f64,
}

impl LawLoop {
    /// # Errors
    ///
    /// [`ScopeRefusal`]: the core does not run these gains.
    pub(super) fn new(
        study: &Study,
        joint: usize,
        record: &JointRecord,
        filter_hz: Option<f64>,
    ) -> Result<Self, ScopeRefusal> {
        let period = study.control.period_ns as f64 * 1e-9;
        let refused =
            || ScopeRefusal::NotCounted { what: "gains that the core refuses".to_owned() };
        let law =
            record.core_gains_in(&LoopModel::from_study(study, joint)).map_err(|_| refused())?;
        let matrices = LawMatrices::of(&law).ok_or_else(refused)?;
        let late = study.sensor.delay_samples as usize;
        let delay = study.control.delay_samples as usize;
        let drive = study.world.drive_bandwidth_hz.as_ref().map(|hz| {
            let rate = TAU * hz[joint];
            let lost = -libm::expm1(-rate * period);
            let applied = study.sensor.torque == TorqueSource::Applied;
            let told = if applied { lost / (rate * period) } else { 0.0 };
            LagOfDrive { rate, left: libm::exp(-rate * period), told }
        });
        let interface = &study.interface;
        let measured = study.sensor.velocity == VelocitySource::Measured;
        Ok(Self {
            period,
            law,
            // A law that does not use the velocity takes the first one, where nothing is off yet.
            measured: measured && matrices.uses_velocity(),
            filter: filter_hz.map_or(1.0, |f| -libm::expm1(-TAU * f * period)),
            late,
            delay,
            begin: match &study.world.held {
                Some(_) => LawBegin::Held,
                None if interface.kept && interface.profile.first_torque_max.is_some() => {
                    LawBegin::OneLater
                }
                None => LawBegin::AtOnce,
            },
            size: 2 + 3 * late + matrices.len() + delay.max(1) + 1 + usize::from(drive.is_some()),
            drive,
            matrices,
        })
    }

    /// At which sample the law is first asked.
    pub(super) fn begins(&self) -> usize {
        usize::from(self.begin == LawBegin::OneLater)
    }

    /// Its state where a torque was commanded for long.
    pub(super) fn after(&self, held: f64) -> Vec<f64> {
        let mut s = vec![0.0; self.size];
        s[self.newest()..=self.acting().max(self.newest() + 1)].fill(held);
        s
    }

    fn entries(&self) -> usize {
        2 + 3 * self.late
    }

    /// Place of the newest command.
    pub(super) fn newest(&self) -> usize {
        self.entries() + self.matrices.len()
    }

    /// Place of the torque that acts until the next sample.
    pub(super) fn acting(&self) -> usize {
        self.newest() + self.delay
    }

    /// Place of what the drive's torque is off, where there is a drive.
    pub(super) fn gap(&self) -> Option<usize> {
        self.drive.map(|_| self.size - 1)
    }

    pub(super) fn drive_rate(&self) -> Option<f64> {
        self.drive.map(|drive| drive.rate)
    }

    /// Sample `k`: reading `y`, true velocity `dq`. The law's state is the core's where there is one, else its entries
    /// among `s`, of a small change.
    pub(super) fn sample(
        &self,
        k: usize,
        (s, core): (&mut [f64], Option<&mut JointState<f64>>),
        (y, dq): (f64, f64),
        wanted: JointReference,
    ) {
        let (entries, newest, acting) = (self.entries(), self.newest(), self.acting());
        let first = k == 0;
        let told = s[acting];
        let gap = self.gap().map_or(0.0, |at| s[at]);
        let raw = if self.measured { dq } else { (y - s[0]) / self.period };
        let filtered = if first { dq } else { s[1] + self.filter * (raw - s[1]) };
        (s[0], s[1]) = (y, filtered);
        let acted = told + self.drive.map_or(0.0, |drive| drive.told * gap);
        let mut message = [y, filtered, acted];
        if self.late > 0 {
            let fresh = message;
            if first {
                s[2..entries].chunks_exact_mut(3).for_each(|old| old.copy_from_slice(&fresh));
            }
            message.copy_from_slice(&s[2..5]);
            s.copy_within(5..entries, 2);
            s[entries - 3..entries].copy_from_slice(&fresh);
        }
        let begins = self.begins();
        let command = if k < begins {
            0.0
        } else {
            self.law(k == begins, (&mut s[entries..newest], core), message, wanted)
        };
        // Behind the newest commands only the torque that acts, and the drive's gap.
        s.copy_within(newest..acting.max(newest + 1), newest + 1);
        s[newest] = command;
        if let (Some(drive), Some(at)) = (self.drive, self.gap()) {
            s[at] = gap * drive.left + told - s[acting];
        }
    }

    /// The law on what it got: position, velocity and the torque that acted.
    fn law(
        &self,
        first: bool,
        (entries, core): (&mut [f64], Option<&mut JointState<f64>>),
        [q, dq, tau_applied]: [f64; 3],
        wanted: JointReference,
    ) -> f64 {
        let m = Measurement { q, dq, tau_applied };
        let reference = Reference { q: wanted.q, dq: wanted.dq, ddq: wanted.ddq };
        match core {
            Some(state) => self.answer(first, state, (&m, &reference), wanted.held),
            None if first => {
                let mut state = JointState::new();
                let torque = self.answer(true, &mut state, (&m, &reference), wanted.held);
                let all = state.entries();
                for (entry, at) in entries.iter_mut().zip(&self.matrices.places) {
                    *entry = all[*at];
                }
                torque
            }
            None => self.matrices.step(entries, &[q, dq, tau_applied, wanted.ddq]),
        }
    }

    /// The core's torque; no number where it refuses the sample.
    fn answer(
        &self,
        first: bool,
        state: &mut JointState<f64>,
        (m, reference): (&Measurement<f64>, &Reference<f64>),
        held: f64,
    ) -> f64 {
        if first && self.begin == LawBegin::Held {
            return if self.law.resume(state, m, reference, held) { held } else { f64::NAN };
        }
        let command = self.law.update(state, m, reference);
        if command.status.refused { f64::NAN } else { command.tau }
    }

    /// Sample `k` without a reference, as `state ← A state + b y + c q̇`.
    fn linear(&self, k: usize) -> LinearCheckedLaw {
        let column = |at: usize| {
            let mut s = vec![0.0; self.size];
            let mut input = (0.0, 0.0);
            match at.checked_sub(self.size) {
                None => s[at] = 1.0,
                Some(0) => input.0 = 1.0,
                Some(_) => input.1 = 1.0,
            }
            self.sample(k, (&mut s, None), input, JointReference::default());
            s
        };
        let mut linear = LinearCheckedLaw { entries: Vec::new(), ends: Vec::new() };
        for j in 0..self.size + 2 {
            let all = column(j).into_iter().enumerate();
            linear.entries.extend(all.filter(|(_, value)| value.abs() > 0.0));
            linear.ends.push(linear.entries.len());
        }
        linear
    }

    pub(super) fn linear_loop(&self) -> LinearLoop {
        LinearLoop {
            samples: [self.linear(0), self.linear(1), self.linear(2)],
            size: self.size,
            acting: self.acting(),
            gap: self.gap(),
        }
    }
}

/// One joint's loop as linear samples.
#[derive(Debug, Clone)]
pub(super) struct LinearLoop {
    /// The first, the second, and every other.
    samples: [LinearCheckedLaw; 3],
    pub(super) size: usize,
    /// Place of the torque that acts until the next sample.
    pub(super) acting: usize,
    pub(super) gap: Option<usize>,
}

impl LinearLoop {
    pub(super) fn at(&self, sample: usize) -> &LinearCheckedLaw {
        &self.samples[sample.min(2)]
    }
}

/// A linear sample of one joint, column by column: of the state, of the reading, of the velocity.
#[derive(Debug, Clone)]
pub(super) struct LinearCheckedLaw {
    /// Row and value.
    entries: Vec<(usize, f64)>,
    ends: Vec<usize>,
}

impl LinearCheckedLaw {
    pub(super) fn columns(&self) -> impl Iterator<Item = &[(usize, f64)]> {
        let start = |at: usize| if at == 0 { 0 } else { self.ends[at - 1] };
        (0..self.ends.len()).map(move |at| &self.entries[start(at)..self.ends[at]])
    }

    pub(super) fn sample(&self, s: &mut [f64], (y, dq): (f64, f64)) {
        let mut next = vec![0.0; s.len()];
        for (column, x) in self.columns().zip(s.iter().chain([&y, &dq])) {
            for (row, value) in column {
                next[*row] += value * x;
            }
        }
        s.copy_from_slice(&next);
    }
}
