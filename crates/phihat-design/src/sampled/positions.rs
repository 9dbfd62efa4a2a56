//! The law from positions per unit of `M̄`, for several runs side by side, and its transfer functions.

use phihat::ORDER_MAX;
use phihat_certificate::JointRecord;

use super::polynomial::Polynomial;
use crate::lanes::Lane;

/// The law of one joint.
#[derive(Debug, Clone)]
pub(crate) struct Positions {
    period: f64,
    /// `ℓ`.
    correction: Vec<f64>,
    /// `g`.
    pub(crate) share: f64,
    /// What `ê`, `ė̂`, `φ̂_0 …` weigh in the torque wanted, once carried on through the delay …
    row: Vec<f64>,
    /// … and the torques on their way, the newest first.
    coming: Vec<f64>,
}

impl Positions {
    /// `None`: a law that is fed with velocity.
    pub(crate) fn of(record: &JointRecord, period: f64) -> Option<Self> {
        let own = record.observer.as_ref()?;
        let n = own.correction.len();
        let mut row = vec![0.0; n];
        (row[0], row[1], row[2]) = (-record.kp_per_s2, -record.kd_per_s, 1.0);
        if let Some(slope) = row.get_mut(3) {
            // What the share makes late.
            *slope = period * (1.0 / own.share - 1.0);
        }
        let mut coming = Vec::new();
        for _ in 0..own.delay_samples {
            let torque = 0.5 * period * period * row[0] + period * row[1];
            // row ← row F.
            for i in (2..n).rev() {
                let below = if i > 2 { period * row[i - 1] } else { -torque };
                row[i] += below;
            }
            row[1] += period * row[0];
            coming.push(torque);
        }
        Some(Self { period, correction: own.correction.clone(), share: own.share, row, coming })
    }

    /// How many numbers it expects: `ê`, `ė̂`, `φ̂_0 … φ̂_{m−1}`.
    pub(crate) fn length(&self) -> usize {
        self.correction.len()
    }

    /// How many torques it remembers.
    pub(crate) fn sent(&self) -> usize {
        self.coming.len().max(1)
    }

    /// Samples that it predicts across.
    pub(crate) fn ahead(&self) -> usize {
        self.coming.len()
    }

    /// The observer over the interval that ends at this sample, in which `acted` did, and with this error read at its end.
    #[inline]
    pub(crate) fn see<const W: usize>(
        &self,
        held: &mut [Lane<W>],
        acted: &Lane<W>,
        reading: &Lane<W>,
    ) {
        // Of a length that is known when compiled, all of it stays in registers.
        match held.len() {
            3 => self.see_all::<W, 3>(held, acted, reading),
            4 => self.see_all::<W, 4>(held, acted, reading),
            5 => self.see_all::<W, 5>(held, acted, reading),
            _ => self.see_all::<W, { ORDER_MAX + 2 }>(held, acted, reading),
        }
    }

    /// The same of `M` numbers.
    #[inline]
    fn see_all<const W: usize, const M: usize>(
        &self,
        held: &mut [Lane<W>],
        acted: &Lane<W>,
        reading: &Lane<W>,
    ) {
        let t = self.period;
        let (Some(held), Some(gains)) =
            (held.first_chunk_mut::<M>(), self.correction.first_chunk::<M>())
        else {
            return;
        };
        let mut all = *held;
        for c in 0..W {
            let push = acted[c] - all[2][c];
            all[0][c] += t * (all[1][c] + 0.5 * t * push);
            all[1][c] += t * push;
        }
        for i in 2..M - 1 {
            for c in 0..W {
                all[i][c] += t * all[i + 1][c];
            }
        }
        let mut innovation = Lane::<W>::ZERO;
        for c in 0..W {
            innovation[c] = reading[c] - all[0][c];
        }
        for i in 0..M {
            for c in 0..W {
                all[i][c] += gains[i] * innovation[c];
            }
        }
        *held = all;
    }

    /// The torque it asks for; `sent` are the last ones, the newest first.
    #[inline]
    pub(crate) fn answer<const W: usize>(&self, held: &[Lane<W>], sent: &[Lane<W>]) -> Lane<W> {
        let last = sent[0];
        let (own, coming) = (weighed(&self.row, held), weighed(&self.coming, sent));
        let mut asked = last;
        for c in 0..W {
            asked[c] += self.share * (own[c] + coming[c] - last[c]);
        }
        asked
    }

    /// The torque wanted, less the one sent last.
    pub(crate) fn late<const W: usize>(&self, held: &[Lane<W>], sent: &[Lane<W>]) -> Lane<W> {
        let (own, coming) = (weighed(&self.row, held), weighed(&self.coming, sent));
        Lane::of(|c| own[c] + coming[c] - sent[0][c])
    }

    /// The torque sent last, where the newest of `sent` is [`Self::late`] in place of it.
    pub(crate) fn last<const W: usize>(&self, held: &[Lane<W>], sent: &[Lane<W>]) -> Lane<W> {
        let weight = self.coming.first().copied().unwrap_or(0.0);
        let (own, coming) = (weighed(&self.row, held), weighed(&self.coming, sent));
        Lane::of(|c| (own[c] + coming[c] - (1.0 + weight) * sent[0][c]) / (1.0 - weight))
    }

    /// `(A_o, z R_y, z R_a)`: `A_o` times the torque wanted is `R_y` times the error read and `R_a` times the torque that
    /// acted, beside what is on its way.
    ///
    /// # Method
    ///
    /// The correction times the plant of the observer, `x ← (1 − ℓC)F x + (1 − ℓC)G a + ℓ y`; adjugate and determinant of
    /// `w − ((1 − ℓC)F − 1)` by Faddeev and LeVerrier in units of `T`, where no power of `T` stands beside 1.
    pub(crate) fn transfer(&self) -> [Polynomial; 3] {
        let n = self.length();
        let power = |i: usize| (0..i).fold(1.0, |power, _| power * self.period);
        let correction: Vec<f64> = (0..n).map(|i| self.correction[i] * power(i)).collect();
        let row: Vec<f64> = (0..n).map(|i| self.row[i] / power(i)).collect();
        // F − 1 and G, of ê, T ė̂, T² φ̂_0, …; a torque counts T².
        let mut step = vec![vec![0.0; n]; n];
        for (i, line) in step.iter_mut().enumerate() {
            if let Some(next) = line.get_mut(i + 1) {
                *next = if i == 1 { -1.0 } else { 1.0 };
            }
        }
        step[0][2] = -0.5;
        let torque = self.period * self.period;
        let pushed = [0.5 * torque, torque];
        let seen = step[0].clone();
        let mut own = step;
        let mut driven = vec![0.0; n];
        for i in 0..n {
            for j in 0..n {
                own[i][j] -= correction[i] * (seen[j] + if j == 0 { 1.0 } else { 0.0 });
            }
            driven[i] = pushed.get(i).copied().unwrap_or(0.0) - correction[i] * pushed[0];
        }
        // N_{n−1} = 1, N_{k−1} = A N_k + c_k: adj = Σ N_k w^k, row by row from the left.
        let (mut left, mut on_reading, mut on_torque) = (row.clone(), vec![0.0; n], vec![0.0; n]);
        let mut whole = vec![0.0; n + 1];
        whole[n] = 1.0;
        let mut matrix = identity(n);
        for k in (0..n).rev() {
            let dot = |x: &[f64]| -> f64 { left.iter().zip(x).map(|(a, b)| a * b).sum() };
            (on_reading[k], on_torque[k]) = (dot(&correction), dot(&driven));
            let next = product(&own, &matrix);
            let trace: f64 = (0..n).map(|i| next[i][i]).sum();
            whole[k] = -trace / (n - k) as f64;
            matrix = next;
            for (i, line) in matrix.iter_mut().enumerate() {
                line[i] += whole[k];
            }
            left = (0..n).map(|j| (0..n).map(|i| row[i] * matrix[i][j]).sum()).collect();
        }
        let z = Polynomial::z_power(1);
        let [reading, torque] = [on_reading, on_torque].map(|p| Polynomial::new(p).times(&z));
        [Polynomial::new(whole), reading, torque]
    }

    /// `z^d Σ c_j z^{−j}`, `d` at least the samples it predicts across: what the torques on their way weigh.
    pub(crate) fn on_their_way(&self, d: usize) -> Polynomial {
        let none = Polynomial::new(vec![0.0]);
        self.coming
            .iter()
            .enumerate()
            .fold(none, |sum, (j, weight)| sum.plus(&Polynomial::z_power(d - j).scaled(*weight)))
    }
}

/// `Σ weight x`, run by run; of lengths that are known when compiled, as laws have them, without a loop.
#[inline]
fn weighed<const W: usize>(weights: &[f64], x: &[Lane<W>]) -> Lane<W> {
    match weights.len() {
        0 => Lane::ZERO,
        1 => weighed_all::<W, 1>(weights, x),
        2 => weighed_all::<W, 2>(weights, x),
        3 => weighed_all::<W, 3>(weights, x),
        4 => weighed_all::<W, 4>(weights, x),
        5 => weighed_all::<W, 5>(weights, x),
        _ => weighed_all::<W, { ORDER_MAX + 2 }>(weights, x),
    }
}

#[inline]
fn weighed_all<const W: usize, const M: usize>(weights: &[f64], x: &[Lane<W>]) -> Lane<W> {
    let mut sum = Lane::<W>::ZERO;
    let (Some(weights), Some(x)) = (weights.first_chunk::<M>(), x.first_chunk::<M>()) else {
        return sum;
    };
    for i in 0..M {
        for c in 0..W {
            sum[c] += weights[i] * x[i][c];
        }
    }
    sum
}

fn identity(n: usize) -> Vec<Vec<f64>> {
    (0..n).map(|i| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect()).collect()
}

fn product(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = a.len();
    let entry = |i: usize, j: usize| (0..n).map(|k| a[i][k] * b[k][j]).sum();
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}
