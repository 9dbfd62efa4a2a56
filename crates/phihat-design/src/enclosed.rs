//! Intervals of each joint's inertia that explain every sample of a record, or the reason why it tells none.

use nalgebra::DVector;
use phihat_certificate::extremes::{Extremes as _, hull, larger, smaller};

use crate::bounded::{BoundedCoefficient, UNEXPLAINED, basis, bounded, orthogonal};
use crate::smoothed::{FOURTH_VARIANCE, RecordedJoint, Smoothed, fourth_differences, near_turns};
use crate::trace::{EstimateError, InertiaEstimate, JointSignals};
use crate::undetermined::{ROWS_LEAST, Undetermined};

/// Widths of the boxes that are tried, as multiples of the shortest.
const WIDTHS: [f64; 3] = [1.0, 2.0, 4.0];

/// Rows of a fit, evenly spread: neighbours say the same.
const ROWS: usize = 1500;

/// Factor on the root mean square of the noise on an acceleration: what an encoder rounds away is not white.
const NOISE: f64 = 3.0;

/// Largest share of noise in the part of an acceleration that nothing else explains.
const NOISE_SHARE: f64 = 0.15;

/// Ratio of the ends beyond which an interval is no answer.
const WIDEST: f64 = 2.5;

/// A joint that moves by fewer quanta of its encoder, or by less \[rad\], stands still.
const STILL: (f64, f64) = (8.0, 1e-4);

/// Share of an acceleration below which the part that position does not explain is that of one sine.
const ONE_SINE: f64 = 0.1;

/// Speeds over which the two decaying parts of friction fall \[rad/s\].
const STRIBECK: [f64; 2] = [0.03, 0.15];

/// Encloses every joint's inertia, at the postures of a record.
///
/// # Method
///
/// Least squares over the record, filtered by boxes of one, two and four times `width` \[s\] ([`Smoothed`]),
///
/// ```text
/// τ_i = Σ_j M_ij q̈_j + Σ_j G_j (q_j − q̄_j) + d q̇_i + c sign(q̇_i) + τ_0 + r_i                         (R1)
/// ```
///
/// and again with the squares of `q_j − q̄_j`, `(q_j − q̄_j) q̈_i`, `q̇_i |q̇_i|` and two parts of friction that decay
/// with speed. A QR factorisation with pivots drops the columns that are combinations of others. With `u` the part of
/// `q̈_i` that is orthogonal to all other columns,
///
/// ```text
/// |M_ii − M̂_ii| ≤ 1.5 max|r_i| ‖u‖₁/‖u‖₂²                                                            (R3)
/// M_ii within [low/(1 + ρ), high/(1 − ρ)],   ρ = 3 σ √N/‖u‖₂                                         (R4)
/// ```
///
/// (R3) is the largest error of a torque that no sample exceeds. (R4) bounds the change of an estimate by noise of
/// root mean square `σ` on `q̈_i`, from the encoder's quantum and the fourth differences of the positions. The
/// interval contains those of both fits, at the width at which it is narrowest. It is refused where `ρ` is above
/// 0.15, as on one sine, or its ends are a factor of 2.5 apart.
///
/// # Not claimed
///
/// No proof: a torque that is neither in the model nor in the residual, because it looks like `q̈_i` alone, moves the
/// interval. Postures that the record does not visit are not in it.
///
/// # Errors
///
/// [`EstimateError::Length`]: the joints differ in length, or the record is shorter than the filter. Of a joint:
/// [`Undetermined`].
pub fn enclose_inertia(
    joints: &[RecordedJoint],
    period_ns: u64,
    width: f64,
) -> Result<Vec<Result<InertiaEstimate, Undetermined>>, EstimateError> {
    let record = RecordAtWidths::new(joints, period_ns, width)?;
    Ok((0..joints.len()).map(|of| record.enclosed(of)).collect())
}

/// Encloses one joint's inertia as [`enclose_inertia`] does, for a record in which the others are held.
///
/// # Errors
///
/// [`EstimateError`]: the joints differ in length, the record is shorter than the filter, there is no joint `of`, or
/// the record does not determine its inertia.
pub fn enclose_inertia_of(
    joints: &[RecordedJoint],
    of: usize,
    period_ns: u64,
    width: f64,
) -> Result<InertiaEstimate, EstimateError> {
    let Some(joint) = joints.get(of) else {
        let expected = joints.len();
        return Err(EstimateError::Length { joint: format!("joint {of}"), found: 0, expected });
    };
    let enclosed = RecordAtWidths::new(joints, period_ns, width)?.enclosed(of);
    enclosed.map_err(|why| EstimateError::Undetermined { joint: joint.name.clone(), why })
}

/// A record, filtered by boxes of every width.
struct RecordAtWidths<'a> {
    joints: &'a [RecordedJoint],
    period_ns: u64,
    records: Vec<Smoothed>,
    noises: Vec<PositionNoise>,
    /// True of each joint that moves.
    moves: Vec<bool>,
}

impl<'a> RecordAtWidths<'a> {
    fn new(joints: &'a [RecordedJoint], period_ns: u64, width: f64) -> Result<Self, EstimateError> {
        let expected = joints.first().map_or(0, |joint| joint.q.len());
        let mut records = Vec::new();
        for times in WIDTHS {
            // A longer filter than the record is none; the shortest has to fit.
            match Smoothed::new(joints, period_ns, times * width) {
                Some(smoothed) => records.push(smoothed),
                None if records.is_empty() => {
                    let name = joints.first().map_or_else(String::new, |joint| joint.name.clone());
                    return Err(EstimateError::Length { joint: name, found: expected, expected });
                }
                None => {}
            }
        }
        let noises: Vec<PositionNoise> =
            joints.iter().map(|joint| PositionNoise::of(&joint.q)).collect();
        let moves =
            joints.iter().zip(&noises).map(|(joint, noise)| noise.moved(&joint.q).1).collect();
        Ok(Self { joints, period_ns, records, noises, moves })
    }

    fn enclosed(&self, of: usize) -> Enclosed {
        let (moved_rad, moving) = self.noises[of].moved(&self.joints[of].q);
        if !moving {
            return Err(Undetermined::Still { moved_rad });
        }
        let found = self.records.iter().map(|record| {
            let gain = acceleration_gain(record.width_samples(), self.period_ns);
            enclosed(record, of, &self.moves, self.noises[of].rms * gain)
        });
        found.reduce(better).unwrap_or(Err(Undetermined::Short))
    }
}

/// Encloses a joint's level of dry friction \[N·m\]: the coefficient of `sign(q̇_i)` in both fits of
/// [`enclose_inertia`], with the bound (R3), 0 at least; `None`: it moves too little. Friction that changes fast with
/// speed is part of the level or not, by the fit: the interval contains both.
pub fn enclose_dry_friction(
    joints: &[RecordedJoint],
    of: usize,
    record: &Smoothed,
) -> Option<(f64, f64)> {
    let moving = |joint: &RecordedJoint| PositionNoise::of(&joint.q).moved(&joint.q).1;
    let moves: Vec<bool> = joints.iter().map(moving).collect();
    let signals = record.signals();
    let joint = signals.get(of)?;
    let rows = rows(joint.dq, record)?;
    let ends = [false, true].map(|richer| {
        let mut columns = columns(&signals, of, (&rows, &moves), richer);
        let sign = core::mem::replace(&mut columns[SIGN], pick(&rows, joint.ddq));
        let (low, high) = bounded(&columns, &sign, &pick(&rows, joint.tau)).interval();
        (larger(low, 0.0), larger(high, 0.0))
    });
    let (low, high) = hull(ends.into_iter());
    high.is_finite().then_some((low, high))
}

type Enclosed = Result<InertiaEstimate, Undetermined>;

/// The narrower interval; of two reasons the later one, whose filter is longer.
fn better(a: Enclosed, b: Enclosed) -> Enclosed {
    match (a, b) {
        (Ok(a), Ok(b)) => {
            let ratio = |of: &InertiaEstimate| of.high_kg_m2 / of.low_kg_m2;
            Ok(if ratio(&b) < ratio(&a) { b } else { a })
        }
        (Ok(one), Err(_)) | (Err(_), Ok(one)) => Ok(one),
        (Err(one), Err(Undetermined::Short)) | (Err(_), Err(one)) => Err(one),
    }
}

/// Noise on positions.
#[derive(Debug, Clone, Copy)]
struct PositionNoise {
    /// Least change of the position between two samples \[rad\]: the encoder's quantum.
    quantum: f64,
    /// Root mean square \[rad\].
    rms: f64,
}

impl PositionNoise {
    fn of(q: &[f64]) -> Self {
        let steps = q.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|x| *x > 1e-12);
        let quantum = steps.fold(f64::INFINITY, smaller);
        let quantum = if quantum.is_finite() { quantum } else { 0.0 };
        let sum: f64 = fourth_differences(q).map(|x| x.powi(2)).sum();
        let count = q.len().saturating_sub(4).max(1) as f64;
        Self {
            quantum,
            rms: larger(quantum / 12.0_f64.sqrt(), (sum / count / FOURTH_VARIANCE).sqrt()),
        }
    }

    /// From the least to the largest position \[rad\], and true if the joint moves.
    fn moved(self, q: &[f64]) -> (f64, bool) {
        let (low, high) = q.iter().copied().ends();
        let moved = high - low;
        (moved, moved > STILL.0 * self.quantum && moved > STILL.1)
    }
}

/// Root mean square of a filtered acceleration for white noise of 1 rad on the position \[1/s²\].
fn acceleration_gain(samples: usize, period_ns: u64) -> f64 {
    let mut q = vec![0.0; 8 * samples + 9];
    q[4 * samples + 4] = 1.0;
    let tau = vec![0.0; q.len()];
    let width = samples as f64 * period_ns as f64 * 1e-9;
    let one = RecordedJoint { name: String::new(), q, tau };
    let filtered = Smoothed::new(&[one], period_ns, width);
    let squares = |of: &Smoothed| -> f64 { of.signals()[0].ddq.iter().map(|x| x * x).sum() };
    filtered.as_ref().map_or(f64::INFINITY, squares).sqrt()
}

/// One joint in a record that went through one filter; `noise` on its acceleration \[rad/s²\].
fn enclosed(record: &Smoothed, of: usize, moves: &[bool], noise: f64) -> Enclosed {
    let signals = record.signals();
    let rows = rows(signals[of].dq, record).ok_or(Undetermined::Short)?;
    let advice = ExcitationAdvice::of(signals[of].dq, record.period_ns);
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for richer in [false, true] {
        let fit = Fit::of(&signals, of, (&rows, moves), richer);
        let share = NOISE * noise / fit.inertia.own_rms;
        if share.is_nan() || share > NOISE_SHARE {
            return Err(advice.noise(&fit, NOISE * noise));
        }
        let (a, b) = fit.inertia.interval();
        low = smaller(low, a / (1.0 + share));
        high = larger(high, b / (1.0 - share));
        let answers = low > 0.0 && high <= WIDEST * low;
        if !answers {
            return Err(advice.unexplained(&fit));
        }
    }
    Ok(InertiaEstimate { low_kg_m2: low, high_kg_m2: high, records: 1 })
}

/// Rows of a fit of a joint, evenly spread over the samples in which it moves one way; `None`: too few.
fn rows(dq: &[f64], record: &Smoothed) -> Option<Vec<usize>> {
    let near = near_turns(dq, record.reach() / 2);
    let good: Vec<usize> = (0..dq.len()).filter(|k| !near[*k]).collect();
    let step = (good.len() / ROWS).max(1);
    (good.len() >= ROWS_LEAST).then(|| good.into_iter().step_by(step).collect())
}

/// These rows of a signal.
fn pick(rows: &[usize], x: &[f64]) -> DVector<f64> {
    DVector::from_iterator(rows.len(), rows.iter().map(|k| x[*k]))
}

/// Result of (R1) for one joint.
struct Fit {
    /// `M̂_ii` \[kg·m²\].
    inertia: BoundedCoefficient,
    /// Root mean square of the part of `q̈_i` that neither its position nor its velocity explains, as a share of that
    /// of `q̈_i`.
    alone: f64,
}

impl Fit {
    fn of(
        signals: &[JointSignals<'_>],
        of: usize,
        (rows, moves): (&[usize], &[bool]),
        richer: bool,
    ) -> Self {
        let joint = &signals[of];
        let own = pick(rows, joint.ddq);
        let columns = columns(signals, of, (rows, moves), richer);
        let inertia = bounded(&columns, &own, &pick(rows, joint.tau));
        let still = [DVector::repeat(rows.len(), 1.0), pick(rows, joint.q), pick(rows, joint.dq)];
        let alone = orthogonal(&basis(&still), &own).norm() / own.norm().max(f64::MIN_POSITIVE);
        Self { inertia, alone }
    }
}

/// Place of `sign(q̇_i)` among the columns.
const SIGN: usize = 2;

/// All columns of (R1) but `q̈_i`.
fn columns(
    signals: &[JointSignals<'_>],
    of: usize,
    (rows, moves): (&[usize], &[bool]),
    richer: bool,
) -> Vec<DVector<f64>> {
    let pick = |x: &[f64]| pick(rows, x);
    let moving: Vec<usize> = (0..signals.len()).filter(|j| moves[*j]).collect();
    let off = |j: &usize| {
        let q = pick(signals[*j].q);
        let q = q.add_scalar(-q.mean());
        let most = q.amax().max(f64::MIN_POSITIVE);
        q / most
    };
    let positions: Vec<DVector<f64>> = moving.iter().map(off).collect();
    let (dq, ddq) = (pick(signals[of].dq), pick(signals[of].ddq));
    let mut columns = vec![DVector::repeat(rows.len(), 1.0), dq.clone(), dq.map(f64::signum)];
    columns.extend(moving.iter().filter(|j| **j != of).map(|j| pick(signals[*j].ddq)));
    columns.extend(positions.iter().cloned());
    if richer {
        columns.push(dq.map(|x| x * x.abs()));
        columns.extend(STRIBECK.map(|slow| dq.map(|x| x.signum() * libm::exp(-x.abs() / slow))));
        columns.extend(positions.iter().map(|q| q.component_mul(q)));
        columns.extend(positions.iter().map(|q| q.component_mul(&ddq)));
    }
    columns
}

/// Frequency of a joint's motion, and of the sine that would tell more.
struct ExcitationAdvice {
    frequency_hz: f64,
}

impl ExcitationAdvice {
    /// From the time between the first and the last of its turns.
    fn of(dq: &[f64], period_ns: u64) -> Self {
        let pairs = dq.windows(2).enumerate();
        let turns: Vec<usize> =
            pairs.filter(|(_, pair)| pair[0] * pair[1] < 0.0).map(|(k, _)| k).collect();
        let between = match (turns.first(), turns.last()) {
            (Some(first), Some(last)) if last > first => (turns.len() - 1, last - first),
            _ => (1, dq.len().max(1)),
        };
        let seconds = between.1 as f64 * period_ns as f64 * 1e-9;
        Self { frequency_hz: larger(0.5 * between.0 as f64 / seconds, 0.05) }
    }

    /// A sine whose acceleration has this root mean square: its frequency \[Hz\], its amplitude \[rad\].
    fn sine(&self, own_rad_s2: f64) -> (f64, f64) {
        let frequency = smaller(3.3 * self.frequency_hz, 3.0);
        let rate = core::f64::consts::TAU * frequency;
        (frequency, core::f64::consts::SQRT_2 * own_rad_s2 / (rate * rate))
    }

    /// The accelerations of a joint are not above their noise \[rad/s²\].
    fn noise(&self, fit: &Fit, noise_rad_s2: f64) -> Undetermined {
        let (add_hz, add_rad) = self.sine(larger(noise_rad_s2 / (0.3 * NOISE_SHARE), 0.3));
        if fit.alone < ONE_SINE {
            return Undetermined::OneSine { frequency_hz: self.frequency_hz, add_hz, add_rad };
        }
        Undetermined::Noise { own_rad_s2: fit.inertia.own_rms, noise_rad_s2, add_hz, add_rad }
    }

    /// The torque that is left could be inertia.
    fn unexplained(&self, fit: &Fit) -> Undetermined {
        // At ± 20 % it would be useful.
        let times = larger(UNEXPLAINED * fit.inertia.half / (0.2 * fit.inertia.value.abs()), 1.5);
        let (add_hz, add_rad) = self.sine(times * fit.inertia.own_rms);
        if fit.alone < ONE_SINE {
            return Undetermined::OneSine { frequency_hz: self.frequency_hz, add_hz, add_rad };
        }
        Undetermined::Unexplained {
            unexplained_nm: fit.inertia.unexplained,
            own_rad_s2: fit.inertia.own_rms,
            times,
            add_hz,
            add_rad,
        }
    }
}
