//! What a law from positions does at one inertia, by its responses: quick and a few per mille low, for a search.

use crate::JointRecord;
use crate::sampled::positions::Positions;
use crate::sampled::{Drive, LoopModel, LoopParts};

/// Samples after which a response counts as not dying.
const LONGEST: u32 = 30_000;

/// A response has died when error and velocity each stay below this share of their own largest value …
const DEAD: f64 = 2e-4;

/// … for so many samples.
const QUIET: u32 = 48;

/// A response that is this much larger than it began grows.
const GROWN: f64 = 1e4;

/// Peak-to-peak gains at one inertia ratio, per unit of `M̄`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Response {
    /// From `φ/M̄` to `e` and `ė`.
    pub(super) jump: [f64; 2],
    /// From `φ̇/M̄`.
    pub(super) ramp: [f64; 2],
    /// From the encoder's error.
    pub(super) reading: [f64; 2],
    /// From kicks in position, one per sample.
    pub(super) kick: [f64; 2],
    /// From the encoder's error to the change of torque per sample, over `M̄`.
    pub(super) change: f64,
}

/// One joint's loop, ready to be played.
pub(super) struct Played<'a> {
    law: &'a Positions,
    late: usize,
    drive: Option<Drive>,
    period: f64,
    mu: f64,
}

/// All that the loop remembers: at most 5 states of the observer, 4 torques sent, 8 + 8 on their way.
#[derive(Clone)]
struct State {
    q: f64,
    v: f64,
    held: [[f64; 1]; 5],
    sent: [[f64; 1]; 4],
    line: [f64; 16],
    mean: f64,
    end: f64,
}

const REST: State = State {
    q: 0.0,
    v: 0.0,
    held: [[0.0]; 5],
    sent: [[0.0]; 4],
    line: [0.0; 16],
    mean: 0.0,
    end: 0.0,
};

impl<'a> Played<'a> {
    pub(super) fn new(law: &'a Positions, model: &LoopModel, mu: f64) -> Self {
        let late = model.late() as usize;
        Self { law, late, drive: model.drive(), period: model.period_s, mu }
    }

    /// One sample: the torque commanded, by a reading that is off.
    fn step(&self, x: &mut State, reading: f64) -> f64 {
        let (n, t) = (self.law.length(), self.period);
        self.law.see(&mut x.held[..n], &[x.mean], &[x.q + reading]);
        let [u] = self.law.answer(&x.held[..n], &x.sent);
        x.sent.copy_within(..3, 1);
        x.sent[0] = [u];
        let told = if self.late == 0 { u } else { x.line[0] };
        if self.late > 0 {
            x.line.copy_within(1..self.late, 0);
            x.line[self.late - 1] = u;
        }
        let (mut mean, mut double) = (told, 0.5 * t * t * told);
        if let Some(drive) = &self.drive {
            let gap = x.end - told;
            mean += drive.mean * gap;
            double += drive.double * gap;
            x.end = told + (1.0 - drive.lost) * gap;
        }
        x.mean = mean;
        x.q += t * x.v + double / self.mu;
        x.v += t * mean / self.mu;
        u
    }

    /// Plays from a state until it has died; `None` where it does not.
    fn play(&self, mut x: State, first: f64, mut show: impl FnMut(f64, f64, f64)) -> Option<()> {
        let (mut largest, mut quiet) = ([0.0_f64; 2], 0);
        let begun = x.q.abs().max(x.v.abs() * self.period).max(first.abs());
        let mut reading = first;
        for _ in 0..LONGEST {
            let (q, v) = (x.q, x.v);
            let u = self.step(&mut x, reading);
            reading = 0.0;
            show(q, v, u);
            let sizes = [q.abs(), v.abs()];
            largest = core::array::from_fn(|i| largest[i].max(sizes[i]));
            let grows = largest[0].is_nan() || largest[0] > GROWN * begun;
            if grows {
                return None;
            }
            let still = (0..2).all(|i| sizes[i] <= DEAD * largest[i]);
            // A reading moves nothing before its torque has acted.
            let waits = largest[0] <= 0.0;
            quiet = if still && !waits { quiet + 1 } else { 0 };
            if quiet > QUIET {
                return Some(());
            }
        }
        None
    }

    /// Whether the loop forgets.
    pub(super) fn forgets(&self) -> bool {
        let pushed = State { v: self.period / self.mu, ..REST };
        self.play(pushed, 0.0, |_, _, _| ()).is_some()
    }

    /// `None` where the loop does not forget.
    pub(super) fn response(&self) -> Option<Response> {
        let (t, mu) = (self.period, self.mu);
        let mut out = Response::default();
        let mut sums = [0.0; 2];
        let pushed = State { q: -0.5 * t * t / mu, v: -t / mu, ..REST };
        self.play(pushed, 0.0, |q, v, _| {
            for (i, value) in [q, v].into_iter().enumerate() {
                out.jump[i] += value.abs();
                sums[i] += value;
                out.ramp[i] += t * sums[i].abs();
            }
        })?;
        let mut last = 0.0;
        self.play(REST, 1.0, |q, v, u| {
            out.reading[0] += q.abs();
            out.reading[1] += v.abs();
            out.change += (u - last).abs();
            last = u;
        })?;
        self.play(State { q: 1.0, ..REST }, 0.0, |q, v, _| {
            out.kick[0] += q.abs() / mu;
            out.kick[1] += v.abs() / mu;
        })?;
        Some(out)
    }
}

impl Response {
    /// The larger of each.
    pub(super) fn worse(self, other: Self) -> Self {
        let larger = |a: [f64; 2], b: [f64; 2]| core::array::from_fn(|i| a[i].max(b[i]));
        Self {
            jump: larger(self.jump, other.jump),
            ramp: larger(self.ramp, other.ramp),
            reading: larger(self.reading, other.reading),
            kick: larger(self.kick, other.kick),
            change: self.change.max(other.change),
        }
    }

    /// Worst over inertia ratios.
    pub(super) fn over(record: &JointRecord, model: &LoopModel, mu: &[f64]) -> Option<Self> {
        let law = Positions::of(record, model.period_s)?;
        mu.iter().try_fold(Self::default(), |worst, mu| {
            Some(worst.worse(Played::new(&law, model, *mu).response()?))
        })
    }
}

/// Gain from kicks in position, one per sample, to `e`: the worst over inertia ratios; `None` where the loop does not forget.
pub(crate) fn worst_kick(record: &JointRecord, model: &LoopModel, mu: &[f64]) -> Option<f64> {
    Response::over(record, model, mu).map(|worst| worst.kick[0])
}

#[cfg(test)]
mod tests {
    use super::Response;
    use crate::positions::family::Family;
    use crate::quick::Quick;
    use crate::sampled::LoopModel;
    use phihat::{Form, TorqueSource, VelocitySource};

    #[test]
    fn the_same_as_by_matrices() {
        let family = |order, delay| Family { order, period: 1e-3, delay };
        for (order, delay, drive_bandwidth_hz) in
            [(1, 1, None), (2, 1, None), (1, 3, None), (2, 0, Some(200.0))]
        {
            let model = LoopModel {
                period_s: 1e-3,
                delay_samples: delay,
                sample_delay_samples: 0,
                torque: TorqueSource::Applied,
                velocity: VelocitySource::Measured,
                velocity_filter_hz: None,
                form: Form::Positions,
                drive_bandwidth_hz,
            };
            let family = family(order, delay);
            let record = family.record(&family.start(0.6), "joint", 1.0).unwrap();
            for mu in [0.5, 1.0, 2.0] {
                let own = Response::over(&record, &model, &[mu]).unwrap();
                let other = Quick::at(&record, &model, mu).unwrap();
                for (what, a, b) in [
                    ("jump", own.jump[0], other.jump[1]),
                    ("ramp", own.ramp[0], other.ramp[1].unwrap()),
                    ("reading", own.reading[0], other.reading[0]),
                    ("change", own.change, other.change),
                ] {
                    assert!((a / b - 1.0).abs() < 5e-3, "{what} {order} {delay} {mu}: {a} {b}");
                }
            }
        }
    }
}
