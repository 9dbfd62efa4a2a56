//! Responses of a law from positions at one inertia: quick and a few per mille low, for a search.

use crate::JointRecord;
use crate::lanes::Lane;
use crate::sampled::{Law, LoopModel, LoopParts, SampledDrive};

/// Samples after which a response counts as not dying.
const LONGEST: u32 = 30_000;

/// A response has died when error and velocity each stay below this share of their own largest value …
const DEAD: f64 = 2e-4;

/// … for so many samples.
const QUIET: f64 = 48.0;

/// A response that is this much larger than it began grows.
const GROWN: f64 = 1e4;

/// Peak-to-peak gains at one inertia ratio, per unit of `M̄`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct LawResponse {
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
    /// From `φ/M̄` to the change of torque per sample, over `M̄`.
    pub(super) jolt: f64,
}

/// Inertia ratios at which a loop is played side by side.
const BESIDE: usize = 4;

/// First lane of each play: a push, a reading error, a kick in position; each at all of these ratios.
const PUSH: usize = 0;
const READING: usize = BESIDE;
const KICK: usize = 2 * BESIDE;
const PLAYS: usize = 3 * BESIDE;

/// One joint's loop at several inertia ratios, ready to be played.
pub(super) struct PlayedLoop<'a, const W: usize> {
    law: &'a Law,
    late: usize,
    drive: Option<SampledDrive>,
    period: f64,
    mu: [f64; W],
    per_mu: Lane<W>,
}

/// All that the loops remember: at most 5 states of the observer and 4 of a filter, 4 torques sent, 8 + 8 on their way.
#[derive(Clone)]
struct LoopState<const W: usize> {
    q: Lane<W>,
    v: Lane<W>,
    held: [Lane<W>; 9],
    sent: [Lane<W>; 4],
    line: [Lane<W>; 16],
    mean: Lane<W>,
    end: Lane<W>,
}

impl<const W: usize> LoopState<W> {
    const REST: Self = Self {
        q: Lane::ZERO,
        v: Lane::ZERO,
        held: [Lane::ZERO; 9],
        sent: [Lane::ZERO; 4],
        line: [Lane::ZERO; 16],
        mean: Lane::ZERO,
        end: Lane::ZERO,
    };
}

/// Signals of a sample: position, velocity, commanded torque; and 1 where a run has not yet died, 0 from then
/// on.
struct SampleSignals<'a, const W: usize> {
    q: &'a Lane<W>,
    v: &'a Lane<W>,
    u: &'a Lane<W>,
    alive: &'a Lane<W>,
}

impl<const W: usize> SampleSignals<'_, W> {
    /// A value of a run, 0 from its death on.
    #[inline]
    fn of(&self, c: usize, value: f64) -> f64 {
        if self.alive[c] > 0.0 { value } else { 0.0 }
    }
}

impl<'a, const W: usize> PlayedLoop<'a, W> {
    pub(super) fn new(law: &'a Law, model: &LoopModel, mu: [f64; W]) -> Self {
        let late = model.late() as usize;
        let per_mu = Lane(mu.map(f64::recip));
        Self { law, late, drive: model.drive(), period: model.period_s, mu, per_mu }
    }

    /// One sample: the torques commanded, by readings that are off.
    #[inline]
    fn step(&self, x: &mut LoopState<W>, off: &Lane<W>) -> Lane<W> {
        let (n, t, zero) = (self.law.length(), self.period, Lane::ZERO);
        let mut reading = x.q;
        reading.add_scaled(1.0, off);
        self.law.step(&mut x.held[..n], &[reading, x.mean, zero]);
        let u = self.law.torque(&x.held[..n], &x.sent[..self.law.sent()], (&reading, &zero));
        x.sent.copy_within(..3, 1);
        x.sent[0] = u;
        let told = if self.late == 0 { u } else { x.line[0] };
        if self.late > 0 {
            x.line.copy_within(1..self.late, 0);
            x.line[self.late - 1] = u;
        }
        let mut double = told.affine(0.5 * t * t, 0.0);
        x.mean = told;
        if let Some(drive) = &self.drive {
            let gap = x.end.minus(&told);
            x.mean.add_scaled(drive.mean, &gap);
            double.add_scaled(drive.double, &gap);
            x.end = told;
            x.end.add_scaled(1.0 - drive.lost, &gap);
        }
        for c in 0..W {
            x.q[c] += t * x.v[c] + double[c] * self.per_mu[c];
            x.v[c] += t * x.mean[c] * self.per_mu[c];
        }
        u
    }

    /// Plays from states until each has died; `None` where one does not.
    fn play(
        &self,
        mut x: LoopState<W>,
        first: Lane<W>,
        mut show: impl FnMut(&SampleSignals<'_, W>),
    ) -> Option<()> {
        let (mut largest, mut quiet, mut alive) =
            ([Lane::<W>::ZERO; 2], Lane::<W>::ZERO, Lane([1.0; W]));
        let begun =
            Lane::<W>::of(|c| x.q[c].abs().max(x.v[c].abs() * self.period).max(first[c].abs()));
        let mut reading = first;
        for _ in 0..LONGEST {
            let (q, v) = (x.q, x.v);
            let u = self.step(&mut x, &reading);
            reading = Lane::ZERO;
            show(&SampleSignals { q: &q, v: &v, u: &u, alive: &alive });
            let (mut grow, mut living) = (0.0, 0.0);
            for c in 0..W {
                let sizes = [q[c].abs(), v[c].abs()];
                for (largest, size) in largest.iter_mut().zip(sizes) {
                    // A NaN stays.
                    largest[c] = if size <= largest[c] { largest[c] } else { size };
                }
                let sound = largest[0][c] <= GROWN * begun[c];
                grow += if sound { 0.0 } else { alive[c] };
                let still = sizes[0] <= DEAD * largest[0][c] && sizes[1] <= DEAD * largest[1][c];
                // A reading moves nothing before its torque has acted.
                let waits = largest[0][c] <= 0.0;
                quiet[c] = if still && !waits { quiet[c] + 1.0 } else { 0.0 };
                alive[c] = if quiet[c] > QUIET { 0.0 } else { alive[c] };
                living += alive[c];
            }
            if grow > 0.0 {
                return None;
            }
            if living <= 0.0 {
                return Some(());
            }
        }
        None
    }

    /// Returns true if the responses of all loops die out.
    pub(super) fn forget(&self) -> bool {
        let mut pushed = LoopState::REST;
        pushed.v = Lane(self.mu.map(|mu| self.period / mu));
        self.play(pushed, Lane::ZERO, |_| ()).is_some()
    }
}

impl PlayedLoop<'_, PLAYS> {
    /// The worst of the ratios; `None` where a loop does not forget.
    fn worst(&self) -> Option<LawResponse> {
        let (t, mut x, mut first) = (self.period, LoopState::REST, Lane::<PLAYS>::ZERO);
        let mut per_unit = Lane([1.0; PLAYS]);
        for c in 0..BESIDE {
            let mu = self.mu[c];
            (x.q[PUSH + c], x.v[PUSH + c]) = (-0.5 * t * t / mu, -t / mu);
            first[READING + c] = 1.0;
            (x.q[KICK + c], per_unit[KICK + c]) = (1.0, mu.recip());
        }
        let zero = Lane::<PLAYS>::ZERO;
        let (mut size, mut sum, mut ramp) = ([zero; 2], [zero; 2], [zero; 2]);
        let (mut change, mut last) = (zero, zero);
        self.play(x, first, |shown| {
            for (i, values) in [shown.q, shown.v].into_iter().enumerate() {
                for c in 0..PLAYS {
                    size[i][c] += shown.of(c, values[c].abs() * per_unit[c]);
                    sum[i][c] += shown.of(c, values[c]);
                    ramp[i][c] += shown.of(c, t * sum[i][c].abs());
                }
            }
            for c in 0..PLAYS {
                change[c] += shown.of(c, (shown.u[c] - last[c]).abs());
            }
            last = *shown.u;
        })?;
        let of = |both: &[Lane<PLAYS>; 2], c: usize| both.map(|values| values[c]);
        let each = (0..BESIDE).map(|c| LawResponse {
            jump: of(&size, PUSH + c),
            ramp: of(&ramp, PUSH + c),
            reading: of(&size, READING + c),
            kick: of(&size, KICK + c),
            change: change[READING + c],
            jolt: change[PUSH + c],
        });
        Some(each.fold(LawResponse::default(), LawResponse::worse))
    }
}

impl LawResponse {
    /// The larger of each.
    pub(super) fn worse(self, other: Self) -> Self {
        let larger = |a: [f64; 2], b: [f64; 2]| core::array::from_fn(|i| a[i].max(b[i]));
        Self {
            jump: larger(self.jump, other.jump),
            ramp: larger(self.ramp, other.ramp),
            reading: larger(self.reading, other.reading),
            kick: larger(self.kick, other.kick),
            change: self.change.max(other.change),
            jolt: self.jolt.max(other.jolt),
        }
    }

    /// Worst over inertia ratios.
    pub(super) fn over(record: &JointRecord, model: &LoopModel, mu: &[f64]) -> Option<Self> {
        Self::of(&Law::of(record, model).ok()?, model, mu)
    }

    /// The same of a law that is at hand.
    pub(super) fn of(law: &Law, model: &LoopModel, mu: &[f64]) -> Option<Self> {
        mu.chunks(BESIDE).try_fold(Self::default(), |worst, mu| {
            // The last one again where there are fewer.
            let mu = core::array::from_fn(|c| mu[(c % BESIDE).min(mu.len() - 1)]);
            Some(worst.worse(PlayedLoop::new(law, model, mu).worst()?))
        })
    }
}

/// Gain from kicks in position, one per sample, to `e`: the worst over inertia ratios; `None` where a
/// response does not die out.
pub(crate) fn worst_kick(record: &JointRecord, model: &LoopModel, mu: &[f64]) -> Option<f64> {
    LawResponse::over(record, model, mu).map(|worst| worst.kick[0])
}

#[cfg(test)]
mod tests {
    use super::LawResponse;
    use crate::positions::family::Family;
    use crate::quick::Quick;
    use crate::sampled::LoopModel;
    use phihat::{Form, TorqueSource, VelocitySource};

    #[test]
    fn the_same_as_by_matrices() {
        let family = |order, delay, filtered| Family { order, filtered, period: 1e-3, delay };
        // What sections hold of an innovation and of its change.
        let weights: [&[f64]; 3] = [&[], &[0.0, 0.3], &[-0.5, 0.3, 0.2, -0.8]];
        for (order, delay, drive_bandwidth_hz, weights) in [
            (1, 1, None, weights[0]),
            (2, 1, None, weights[0]),
            (1, 3, None, weights[0]),
            (2, 0, Some(200.0), weights[0]),
            (1, 1, None, weights[1]),
            (1, 2, None, weights[2]),
            (2, 0, Some(200.0), weights[2]),
        ] {
            let model = LoopModel {
                period_s: 1e-3,
                delay_samples: delay,
                sample_delay_samples: 0,
                torque: TorqueSource::Applied,
                velocity: VelocitySource::Measured,
                velocity_filter_hz: None,
                torque_filter_hz: None,
                form: Form::Positions,
                drive_bandwidth_hz,
            };
            let plain = family(order, delay, false);
            let start = plain.start(0.6);
            let mut x = Family::with_filter(&start);
            x.truncate(start.len() + 2 * weights.len());
            for (section, own) in x[start.len()..].chunks_exact_mut(4).zip(weights.chunks(2)) {
                section[2..].copy_from_slice(own);
            }
            let family = family(order, delay, !weights.is_empty());
            let record = family.record(&x, "joint", 1.0).unwrap();
            let sections = &record.observer.as_ref().unwrap().innovation_filter;
            assert_eq!(sections.len(), weights.len() / 2);
            for mu in [0.5, 1.0, 2.0] {
                let own = LawResponse::over(&record, &model, &[mu]).unwrap();
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
