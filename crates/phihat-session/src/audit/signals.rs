//! Assumptions that are read off the signals: torque, messages, encoder, limits.

use core::f64::consts::TAU;

use phihat_certificate::extremes::Extremes as _;
use phihat_design::{FOURTH_VARIANCE, fourth_differences};

use super::Audited;
use super::row::{Assumption, AuditRow, largest_beyond};

/// Longest delay that is looked for \[samples\].
const DELAY_MOST: usize = 12;

/// Share of a joint's torque that the record may be off by: figures of a robot are rounded.
const ROUNDED: f64 = 2e-3;

/// A delay is told where the next best explains the torque by so many times less.
const CLEARER: f64 = 2.0;

/// Share of samples up to which torques that stay are lost commands.
const LOST_MOST: f64 = 0.5;

/// Quanta by which a reference has to move in a sample for a position that stays to be a lost sample.
const MOVES: f64 = 3.0;

/// Factor on the noise that a quantum makes: a rounding error is not white.
const NOISE: f64 = 2.0;

/// Noise below which nothing is said \[rad\].
const SILENT: f64 = 1e-8;

/// Torque of one joint as one delay explains it.
struct Explained {
    delay: usize,
    /// Residual of every sample \[N·m\].
    residual: Vec<f64>,
    /// Torque by the delay \[N·m\].
    predicted: Vec<f64>,
}

impl Explained {
    /// Factor on the predicted torque that fits best.
    fn gain(&self) -> f64 {
        let product =
            |a: &[f64]| -> f64 { a.iter().zip(&self.predicted).map(|(a, p)| a * p).sum() };
        1.0 + product(&self.residual) / product(&self.predicted).max(f64::MIN_POSITIVE)
    }

    /// Median size of the residual beside that factor: lost commands do not count.
    fn middle(&self) -> f64 {
        let more = self.gain() - 1.0;
        let pairs = self.residual.iter().zip(&self.predicted);
        let mut sizes: Vec<f64> = pairs.map(|(r, p)| (r - more * p).abs()).collect();
        sizes.sort_by(f64::total_cmp);
        sizes.get(sizes.len() / 2).copied().unwrap_or(0.0)
    }
}

impl Audited<'_> {
    /// A joint's torque by the commands so many samples before, through the drive that the study states.
    fn explained(&self, i: usize, delay: usize) -> Explained {
        let joint = &self.trace.joints[i];
        let lag = self.study.world.drive_bandwidth_hz.as_ref().and_then(|all| all.get(i));
        let decay = lag.map(|hz| TAU * hz * self.period);
        let begin = self.tracked.start + DELAY_MOST.max(delay);
        let command = |k: usize| joint.tau_command.get(k.wrapping_sub(delay)).copied();
        let mut state = command(begin).unwrap_or(0.0);
        let (mut residual, mut predicted) = (Vec::new(), Vec::new());
        for k in begin..self.tracked.end {
            let Some(wanted) = command(k) else { break };
            let acted = match decay {
                None => wanted,
                Some(rate) => {
                    let left = libm::exp(-rate);
                    let mean = wanted + (state - wanted) * (1.0 - left) / rate;
                    state = wanted + (state - wanted) * left;
                    mean
                }
            };
            predicted.push(acted);
            residual.push(joint.tau_applied[k] - acted);
        }
        Explained { delay, residual, predicted }
    }

    /// Delay, torque that acts, and lost commands.
    pub(super) fn torque_rows(&self) -> Vec<AuditRow> {
        let assumed = self.study.control.delay_samples as usize;
        let mut rows = Vec::new();
        let mut lost = 0.0_f64;
        for (i, name) in self.names() {
            let all: Vec<Explained> = (0..=DELAY_MOST).map(|d| self.explained(i, d)).collect();
            let mut order: Vec<&Explained> = all.iter().collect();
            order.sort_by(|a, b| a.middle().total_cmp(&b.middle()));
            let [best, second, ..] = order.as_slice() else { continue };
            let range = best.predicted.iter().map(|x| x.abs()).largest();
            let tolerance = ROUNDED * range + 1e-9;
            if second.middle() < CLEARER * best.middle() + 1e-12 || range <= 0.0 {
                let why = "its torque changes too little from sample to sample";
                rows.push(AuditRow::not_told(Assumption::Delay, why).on(name));
                rows.push(AuditRow::not_told(Assumption::TorqueEcho, why).on(name));
                continue;
            }
            let first = self.time(self.tracked.start + DELAY_MOST);
            let (d, own) = (best.delay as f64, assumed as f64);
            let time = (best.delay != assumed).then_some(first);
            rows.push(
                AuditRow::at_most(Assumption::Delay, (d, own, "samples"), time)
                    .on(name)
                    .with_change(|| format!("[loop]\ndelay_samples = {}", best.delay)),
            );
            let begin = self.tracked.start + DELAY_MOST;
            let tau = &self.trace.joints[i].tau_applied;
            let stays = |k: usize| (tau[k] - tau[k - 1]).abs() <= 1e-12;
            let off = |n: &usize| best.residual[*n].abs() > tolerance;
            let gone: Vec<usize> =
                (0..best.residual.len()).filter(|n| off(n) && stays(begin + n)).collect();
            let share = gone.len() as f64 / best.residual.len().max(1) as f64;
            let is_lost = share < LOST_MOST;
            lost = lost.max(if is_lost { share } else { 0.0 });
            let values = best.residual.iter().enumerate().map(|(n, r)| {
                let skip = is_lost && gone.binary_search(&n).is_ok();
                (self.time(begin + n), if skip { 0.0 } else { *r })
            });
            let (most, time) = largest_beyond(values, tolerance);
            let gain = best.gain();
            rows.push(
                AuditRow::at_most(Assumption::TorqueEcho, (most, tolerance, "N·m"), time)
                    .on(name)
                    .with_change(|| format!("[world.drive]\ngain = {gain:.4}")),
            );
        }
        let share = self.study.world.network.command.share;
        let beyond = (lost > share + 1e-9).then(|| self.time(self.tracked.start));
        rows.push(
            AuditRow::at_most(Assumption::Losses, (lost, share, "of the commands"), beyond)
                .with_change(|| format!("[world.network]\ncommand_loss = {lost:.3}")),
        );
        rows
    }

    /// Lost samples, and equal times between samples.
    pub(super) fn sample_rows(&self) -> Vec<AuditRow> {
        let trace = self.trace;
        let quantum: Vec<f64> = (0..trace.joints.len()).map(|i| self.quantum(i)).collect();
        let (mut moved, mut lost, mut first) = (0_u64, 0_u64, None);
        for k in self.tracked.start + 1..self.tracked.end {
            let mut joints = trace.joints.iter().zip(&quantum);
            let moves = joints.any(|(joint, quantum)| {
                (joint.dq_desired[k] * self.period).abs() > MOVES * quantum
                    && (joint.dq_measured[k] * self.period).abs() > quantum.min(f64::MAX) * 0.5
            });
            if !moves {
                continue;
            }
            moved += 1;
            if self.is_lost(k, &quantum) {
                lost += 1;
                first.get_or_insert(self.time(k));
            }
        }
        let assumed = self.study.world.network.sample.share;
        let losses = if moved < 100 {
            AuditRow::not_told(
                Assumption::Losses,
                "it moves by less than the encoder's quantum in a sample",
            )
        } else {
            let share = lost as f64 / moved as f64;
            let time = first.filter(|_| share > assumed + 1e-9);
            AuditRow::at_most(Assumption::Losses, (share, assumed, "of the samples"), time)
                .with_change(|| format!("[world.network]\nsample_loss = {share:.3}"))
        };
        let off = |k: usize| {
            let step = (trace.t_ns[k] - trace.t_ns[k - 1]) as f64;
            (self.time(k), (step - trace.period_ns as f64) * 1e-9)
        };
        let range = self.tracked.start + 1..self.tracked.end;
        let (most, time) = largest_beyond(range.map(off), 0.05 * self.period);
        let jitter = if most > 0.0 {
            AuditRow::at_most(Assumption::Jitter, (most, 0.05 * self.period, "s"), time)
                .with_change(|| format!("[sensor]\njitter_s = {most:.2e}"))
        } else {
            AuditRow::not_told(Assumption::Jitter, "its times are counted, not measured")
        };
        vec![losses, jitter]
    }

    /// Returns true if no position changed in a sample, and the next that changes makes up for it; an arm that
    /// turns or sticks goes on from where it stood.
    fn is_lost(&self, k: usize, quantum: &[f64]) -> bool {
        let joints = &self.trace.joints;
        let stays = |k: usize| {
            joints.iter().all(|one| one.q_measured[k].to_bits() == one.q_measured[k - 1].to_bits())
        };
        let next = (k + 1..self.tracked.end).find(|next| !stays(*next));
        let jumps = |next: usize| {
            let off = |q: &[f64]| (q[next] - q[k - 1]).abs();
            joints.iter().zip(quantum).any(|(one, quantum)| off(&one.q_measured) > MOVES * quantum)
        };
        stays(k) && next.is_some_and(jumps)
    }

    /// Quantum of a joint's encoder by the study \[rad\]; 0: exact.
    fn quantum(&self, i: usize) -> f64 {
        let bits = self.study.sensor.encoder_bits.as_ref().and_then(|bits| bits.get(i));
        bits.map_or(0.0, |bits| TAU / 2.0_f64.powi(bits.cast_signed()))
    }

    /// Quantum and noise of every encoder.
    pub(super) fn encoder_rows(&self) -> Vec<AuditRow> {
        let mut rows = Vec::new();
        for (i, name) in self.names() {
            let part = self.tracked.clone();
            let q = self.trace.joints[i].q_measured.get(part).unwrap_or_default();
            let quantum = self.quantum(i);
            rows.push(quantum_row(q, quantum).on(name));
            let stated = self.study.sensor.position_noise.get(i).copied().unwrap_or(0.0);
            rows.push(self.noise_row(q, (quantum, stated), i).on(name));
        }
        rows
    }

    fn noise_row(&self, q: &[f64], (quantum, stated): (f64, f64), i: usize) -> AuditRow {
        // The median leaves out lost samples.
        let mut sizes: Vec<f64> = fourth_differences(q).map(f64::abs).collect();
        if sizes.len() < 100 {
            return AuditRow::not_told(Assumption::Noise, "the record is too short");
        }
        let middle = sizes.len() / 2;
        let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
        let found = *median / (0.6745 * FOURTH_VARIANCE.sqrt());
        let assumed = NOISE * (quantum * quantum / 12.0 + stated * stated).sqrt() + SILENT;
        let time = (found > assumed).then(|| self.time(self.tracked.start));
        let more = (found * found - quantum * quantum / 12.0).max(0.0).sqrt();
        let change = || format!("[sensor]\nposition_noise_rad = {more:.2e}  # joint {}", i + 1);
        AuditRow::at_most(Assumption::Noise, (found, assumed, "rad rms"), time).with_change(change)
    }

    /// Limits that acted.
    pub(super) fn limit_rows(&self) -> Vec<AuditRow> {
        let row = |(i, name): (usize, &str)| {
            let joint = &self.trace.joints[i];
            let acted = |k: &usize| joint.saturated[*k] || joint.rate_limited[*k];
            let count = self.tracked.clone().filter(acted).count() as f64;
            let first = self.tracked.clone().find(acted).map(|k| self.time(k));
            let most = self.tracked.clone().map(|k| joint.tau_command[k].abs()).largest();
            let change =
                || format!("[loop]\ntorque_max_nm = {:.2}  # joint {}", 1.05 * most, i + 1);
            AuditRow::at_most(Assumption::Limits, (count, 0.0, "samples"), first)
                .on(name)
                .with_change(change)
        };
        self.names().map(row).collect()
    }
}

/// An encoder whose positions are all multiples of a coarser step is a coarser one.
fn quantum_row(q: &[f64], quantum: f64) -> AuditRow {
    if quantum <= 0.0 {
        return AuditRow::not_told(Assumption::Encoder, "the study states no encoder");
    }
    let Some(first) = q.first() else {
        return AuditRow::not_told(Assumption::Encoder, "there is no sample");
    };
    let steps: Vec<f64> = q.iter().map(|x| (x - first) / quantum).collect();
    let whole = |scale: f64| {
        let off = |x: &&f64| ((*x / scale) - (*x / scale).round()).abs() > 1e-3;
        steps.iter().filter(off).count()
    };
    if whole(1.0) > 0 {
        // A finer encoder, or noise behind it.
        let least =
            q.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|x| *x > 1e-12).least();
        if least <= quantum {
            return AuditRow::at_most(Assumption::Encoder, (least, quantum, "rad"), None);
        }
        return AuditRow::not_told(Assumption::Encoder, "its positions are on no grid");
    }
    let mut levels: Vec<i64> = steps.iter().map(|x| level(*x)).collect();
    levels.sort_unstable();
    levels.dedup();
    if levels.len() < 40 {
        return AuditRow::not_told(Assumption::Encoder, "it moves by too few quanta");
    }
    let mut coarser = 1.0;
    while whole(2.0 * coarser) == 0 && coarser < 1e6 {
        coarser *= 2.0;
    }
    let found = coarser * quantum;
    let time = (coarser > 1.0).then_some(0.0);
    AuditRow::at_most(Assumption::Encoder, (found, quantum, "rad"), time)
        .with_change(|| format!("[sensor]\nencoder_bits = {:.0}", libm::log2(TAU / found)))
}

#[expect(clippy::cast_possible_truncation, reason = "positions are less than 2^53 quanta")]
fn level(steps: f64) -> i64 {
    steps.round() as i64
}
