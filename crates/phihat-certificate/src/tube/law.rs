//! The sampled law of one joint with its sensor and delays, and the same as a linear map.

use core::f64::consts::TAU;
use phihat::{Form, TorqueSource, VelocitySource};

use phihat_study::Study;

use super::dense::{exponential, product};
use crate::JointRecord;
use crate::check::sight::Sight;

/// One joint's loop from the reading to the torque that is sent to the drive.
///
/// State: `y` last reading, `v` filtered velocity, [`v` at the law, late messages], memory of the estimator
/// (from positions: `ê`, `ė̂`, `φ̂`, all per unit of inertia, [`x`, `δ` of each section that filters the
/// innovation], and the torques sent without their feed-forward), commands from the newest to the one that
/// acts, [the gap of a drive's torque at the start of the interval].
///
/// # Law of a drive
///
/// ```text
/// τ(t) = told + gap e^{−ωt},   mean = told + gap (1 − e^{−ωT})/(ωT),   gap ← gap e^{−ωT} + told_before − told
/// ```
#[derive(Debug, Clone)]
pub(super) struct Loop {
    period: f64,
    law: JointRecord,
    alpha: Vec<f64>,
    on_integrals: Vec<f64>,
    on_error: [f64; 2],
    literal: bool,
    pub(super) measured: bool,
    filter: f64,
    late: usize,
    delay: usize,
    begin: Begin,
    drive: Option<Drive>,
    sight: Option<Sight>,
    pub(super) size: usize,
}

/// Source of the first command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Begin {
    /// The law's.
    AtOnce,
    /// None: the law is first asked at the second sample.
    OneLater,
    /// The torque that held the arm before.
    Held,
}

/// A drive's first-order lag.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drive {
    /// `ω` \[rad/s\].
    pub(super) rate: f64,
    /// `e^{−ωT}`.
    left: f64,
    /// Share of the gap in the torque that the estimator is told.
    told: f64,
}

/// Reference of the joint at a sample.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Wanted {
    pub(super) q: f64,
    pub(super) dq: f64,
    /// Acceleration that is fed forward.
    pub(super) ddq: f64,
    /// The same of the torque that acted in the interval before, where the law asks: [`Loop::fed_before`].
    pub(super) acted: f64,
    /// The torque to take over at the first sample, where that is done.
    pub(super) held: f64,
}

impl Loop {
    pub(super) fn new(
        study: &Study,
        joint: usize,
        law: &JointRecord,
        filter_hz: Option<f64>,
    ) -> Self {
        let period = study.control.period_ns as f64 * 1e-9;
        let a = &law.a;
        let m = a.len();
        let at = |i: usize| a.get(i).copied().unwrap_or(0.0);
        let factor = |i: usize| {
            let two = if i >= 2 { at(i - 2) * law.kd_per_s } else { 0.0 };
            let three = if i >= 3 { at(i - 3) } else { 0.0 };
            (if i >= 1 { at(i - 1) * law.kp_per_s2 } else { 0.0 }) + two + three
        };
        let late = study.sensor.delay_samples as usize;
        let delay = study.control.delay_samples as usize;
        let drive = study.world.drive_bandwidth_hz.as_ref().map(|hz| {
            let rate = TAU * hz[joint];
            let lost = -libm::expm1(-rate * period);
            let applied = study.sensor.torque == TorqueSource::Applied;
            let told = if applied { lost / (rate * period) } else { 0.0 };
            Drive { rate, left: libm::exp(-rate * period), told }
        });
        let interface = &study.interface;
        let ways = if late > 0 { 1 + 3 * late } else { 0 };
        let sight = Sight::of(law, period);
        let held = sight.as_ref().map_or(m, |sight| sight.length() + sight.sent());
        Self {
            period,
            alpha: if m > 0 { sampled(a, period) } else { Vec::new() },
            on_integrals: (0..m).map(|j| factor(m - j)).collect(),
            on_error: [factor(m + 1), factor(m + 2)],
            literal: study.control.form == Form::Literal,
            // A law from positions takes the first velocity, where nothing is off yet.
            measured: sight.is_none() && study.sensor.velocity == VelocitySource::Measured,
            filter: filter_hz.map_or(1.0, |f| -libm::expm1(-TAU * f * period)),
            late,
            delay,
            begin: match &study.world.held {
                Some(_) => Begin::Held,
                None if interface.kept && interface.profile.first_torque_max.is_some() => {
                    Begin::OneLater
                }
                None => Begin::AtOnce,
            },
            size: 2 + ways + held + delay.max(1) + 1 + usize::from(drive.is_some()),
            drive,
            sight,
            law: law.clone(),
        }
    }

    /// Age of the command that is taken to have acted until this sample \[samples\]; `None`: the law does not
    /// use it.
    pub(super) fn fed_before(&self) -> Option<usize> {
        self.sight.as_ref().map(|sight| sight.ahead + 1)
    }

    /// At which sample the law is first asked.
    pub(super) fn begins(&self) -> usize {
        usize::from(self.begin == Begin::OneLater)
    }

    /// Its state where a torque was commanded for long.
    pub(super) fn after(&self, held: f64) -> Vec<f64> {
        let mut s = vec![0.0; self.size];
        s[self.newest()..=self.acting().max(self.newest() + 1)].fill(held);
        s
    }

    /// Acceleration that was fed forward with the torque before the first sample.
    pub(super) fn fed_at_first(&self, first: f64) -> f64 {
        if self.begin == Begin::Held { first } else { 0.0 }
    }

    fn memory(&self) -> usize {
        2 + if self.late > 0 { 1 + 3 * self.late } else { 0 }
    }

    /// Place of the newest command.
    pub(super) fn newest(&self) -> usize {
        let seen = |sight: &Sight| sight.length() + sight.sent();
        self.memory() + self.sight.as_ref().map_or(self.law.a.len(), seen)
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

    /// Sample `k`: reading `y`, true velocity `dq`.
    pub(super) fn sample(&self, k: usize, s: &mut [f64], (y, dq): (f64, f64), wanted: Wanted) {
        let (memory, newest, acting) = (self.memory(), self.newest(), self.acting());
        let first = k == 0;
        let told = s[acting];
        let gap = self.gap().map_or(0.0, |at| s[at]);
        let raw = if self.measured { dq } else { (y - s[0]) / self.period };
        let mut before = s[1];
        let filtered = if first { dq } else { before + self.filter * (raw - before) };
        (s[0], s[1]) = (y, filtered);
        let mut acted = told + self.drive.map_or(0.0, |drive| drive.told * gap);
        let (mut y, mut v) = (y, filtered);
        if self.late > 0 {
            let fresh = [y, v, acted];
            let way = 3 + 3 * self.late;
            if first {
                s[3..way].chunks_exact_mut(3).for_each(|old| old.copy_from_slice(&fresh));
            }
            (y, v, acted) = (s[3], s[4], s[5]);
            s.copy_within(6..way, 3);
            s[way - 3..way].copy_from_slice(&fresh);
            before = s[2];
            s[2] = v;
        }
        let begins = self.begins();
        let command = if k < begins {
            0.0
        } else {
            self.law(k == begins, &mut s[memory..newest], (y, v), (v - before, acted), wanted)
        };
        // Behind the newest commands only the torque that acts, and the drive's gap.
        s.copy_within(newest..acting.max(newest + 1), newest + 1);
        s[newest] = command;
        if let (Some(drive), Some(at)) = (self.drive, self.gap()) {
            s[at] = gap * drive.left + told - s[acting];
        }
    }

    /// The law on what it got: position and velocity, change of velocity and the torque that acted.
    fn law(
        &self,
        first: bool,
        held: &mut [f64],
        (y, v): (f64, f64),
        (change, acted): (f64, f64),
        wanted: Wanted,
    ) -> f64 {
        let (e, de) = (y - wanted.q, v - wanted.dq);
        if first && self.begin == Begin::Held {
            self.resume(held, (e, de), wanted);
            return wanted.held;
        }
        if let Some(sight) = &self.sight {
            let (seen, sent) = held.split_at_mut(sight.length());
            let inertia = self.law.inertia_kg_m2;
            if first {
                (seen[0], seen[1]) = (e, de);
            } else {
                sight.see(seen, acted / inertia - wanted.acted, e);
            }
            let torque = sight.answer(seen, sent);
            sent.rotate_right(1);
            sent[0] = torque;
            return inertia * (wanted.ddq + torque);
        }
        let m = self.law.a.len();
        let estimate = if self.literal {
            let mut below = e;
            for entry in held.iter_mut().filter(|_| !first) {
                *entry += self.period * below;
                below = *entry;
            }
            let sum: f64 = held.iter().zip(&self.on_integrals).map(|(x, f)| x * f).sum();
            -self.law.inertia_kg_m2 * (sum + self.on_error[0] * e + self.on_error[1] * de)
        } else {
            if !first {
                let innovation = self.period * (acted - held[0]) - self.law.inertia_kg_m2 * change;
                for j in 0..m {
                    let next = if j + 1 < m { held[j + 1] } else { 0.0 };
                    held[j] += self.period * next + self.alpha[j] * innovation;
                }
            }
            held[0]
        };
        self.law.inertia_kg_m2 * (wanted.ddq - self.law.kd_per_s * de - self.law.kp_per_s2 * e)
            + estimate
    }

    /// Sets the law's state so that `wanted.held` is the command that it would have sent.
    fn resume(&self, held: &mut [f64], (e, de): (f64, f64), wanted: Wanted) {
        let (kp, kd) = (self.law.kp_per_s2, self.law.kd_per_s);
        let torque = wanted.held / self.law.inertia_kg_m2 - wanted.ddq;
        if let Some(sight) = &self.sight {
            // Predicted through the delay under `torque`, `φ̂ − K_p ê − K_d ė̂` is `torque` again; it is so
            // for one `φ̂`: with `s` on the way, `s²(torque − φ̂)/2` and `s(torque − φ̂)` are added to
            // `ê + sė̂` and `ė̂`.
            let s = self.period * sight.ahead as f64;
            let (seen, sent) = held.split_at_mut(sight.length());
            seen.fill(0.0);
            let pull = kp * (e + s * de) + kd * de;
            let weight = kp * (0.5 * s * s) + kd * s;
            (seen[0], seen[1], seen[2]) =
                (e, de, (torque * (1.0 + weight) + pull) / (1.0 + weight));
            sent.fill(torque);
            return;
        }
        held.fill(0.0);
        let phi = torque + kp * e + kd * de;
        if self.literal {
            let last = held.len() - 1;
            let shown = self.on_error[0] * e + self.on_error[1] * de;
            held[last] = -(phi + shown) / self.on_integrals[last];
        } else {
            held[0] = self.law.inertia_kg_m2 * phi;
        }
    }

    /// Sample `k` without a reference, as `state ← A state + b y + c q̇`.
    fn linear(&self, k: usize) -> Linear {
        let column = |at: usize| {
            let mut s = vec![0.0; self.size];
            let mut input = (0.0, 0.0);
            match at.checked_sub(self.size) {
                None => s[at] = 1.0,
                Some(0) => input.0 = 1.0,
                Some(_) => input.1 = 1.0,
            }
            self.sample(k, &mut s, input, Wanted::default());
            s
        };
        let mut linear = Linear { entries: Vec::new(), ends: Vec::new() };
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
    samples: [Linear; 3],
    pub(super) size: usize,
    /// Place of the torque that acts until the next sample.
    pub(super) acting: usize,
    pub(super) gap: Option<usize>,
}

impl LinearLoop {
    pub(super) fn at(&self, sample: usize) -> &Linear {
        &self.samples[sample.min(2)]
    }
}

/// A linear sample of one joint, column by column: of the state, of the reading, of the velocity.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    /// Row and value.
    entries: Vec<(usize, f64)>,
    ends: Vec<usize>,
}

impl Linear {
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

/// `α_{m−1} … α_0`: the estimator's poles `s_i` go to `(e^{s_i T} − 1)/T`, as a polynomial, here from the
/// exponential of the companion matrix and the traces of its powers (Newton's identities).
fn sampled(a: &[f64], period: f64) -> Vec<f64> {
    let m = a.len();
    let rate = a[m - 1];
    // Companion of s^m + a_{m−1} s^{m−1} + …, in time units of 1/rate.
    let mut f = vec![0.0; m * m];
    let mut power = 1.0;
    for i in 0..m {
        power *= rate;
        f[i * m] = -a[m - 1 - i] / power;
        if i + 1 < m {
            f[i * m + i + 1] = 1.0;
        }
    }
    let mut d = exponential(&f, rate * period, m);
    for i in 0..m {
        d[i * m + i] -= 1.0;
    }
    for x in &mut d {
        *x /= rate * period;
    }
    let mut traces = Vec::new();
    let mut x = d.clone();
    for _ in 0..m {
        traces.push((0..m).map(|i| x[i * m + i]).sum::<f64>());
        x = product(&x, &d, (m, m, m));
    }
    let mut c = vec![1.0];
    for k in 1..=m {
        let sum: f64 = (1..=k).map(|j| c[k - j] * traces[j - 1]).sum();
        c.push(-sum / k as f64);
    }
    let mut power = 1.0;
    let scaled = |c: &f64| {
        power *= rate;
        c * power
    };
    c[1..].iter().map(scaled).collect()
}
