//! The law from positions per unit of `M̄`, for several runs side by side, and its transfer functions.

use phihat::ORDER_MAX;
use phihat_certificate::{FilterSection, JointRecord};

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
    /// Filter on the innovation.
    sections: Vec<FilterSection>,
    /// Weights of `ê`, `ė̂`, `φ̂_0 …` in the torque wanted, once carried on through the delay, and of `x`,
    /// `δ` of each section …
    row: Vec<f64>,
    /// … and of the torques on their way, the newest first.
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
        let sections = own.innovation_filter.clone();
        row.extend(sections.iter().flat_map(|section| section.weights_per_s2));
        Some(Self {
            period,
            correction: own.correction.clone(),
            share: own.share,
            sections,
            row,
            coming,
        })
    }

    /// Number of values that it expects and filters: `ê`, `ė̂`, `φ̂_0 … φ̂_{m−1}`, then `x`, `δ` of each
    /// section.
    pub(crate) fn length(&self) -> usize {
        self.correction.len() + 2 * self.sections.len()
    }

    /// Number of torques that it stores.
    pub(crate) fn sent(&self) -> usize {
        self.coming.len().max(1)
    }

    /// Samples that it predicts across.
    pub(crate) fn ahead(&self) -> usize {
        self.coming.len()
    }

    /// Observer update over the interval that ends at this sample, in which `acted` did, and with this error
    /// read at its end.
    #[inline]
    pub(crate) fn see<const W: usize>(
        &self,
        held: &mut [Lane<W>],
        acted: &Lane<W>,
        reading: &Lane<W>,
    ) {
        let (held, filtered) = held.split_at_mut(self.correction.len());
        if !filtered.is_empty() {
            self.filter(held, filtered, (acted, reading));
        }
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

    /// The sections one sample on, by what the observer holds before it.
    #[inline]
    fn filter<const W: usize>(
        &self,
        held: &[Lane<W>],
        filtered: &mut [Lane<W>],
        (acted, reading): (&Lane<W>, &Lane<W>),
    ) {
        let t = self.period;
        let mut innovation = Lane::<W>::ZERO;
        for c in 0..W {
            let expected = held[0][c] + t * (held[1][c] + 0.5 * t * (acted[c] - held[2][c]));
            innovation[c] = reading[c] - expected;
        }
        for (own, FilterSection { rates: [c0, c1], .. }) in
            filtered.chunks_exact_mut(2).zip(&self.sections)
        {
            for c in 0..W {
                let (x, change) = (own[0][c], own[1][c]);
                own[0][c] = x + change;
                own[1][c] = change + innovation[c] - (c0 * x + c1 * change);
            }
        }
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

    /// `(A_o, z R_y, z R_a)`: `A_o` times the torque wanted is `R_y` times the error read and `R_a` times the
    /// torque that acted, in addition to what is on its way.
    ///
    /// # Method
    ///
    /// The correction times the plant of the observer, `x ← (1 − ℓC)F x + (1 − ℓC)G a + ℓ y`; adjugate and
    /// determinant of `w − ((1 − ℓC)F − 1)` by Faddeev and LeVerrier in units of `T`, where no power of `T`
    /// is added to 1. Sections of a filter are states whose `δ` the innovation corrects by itself.
    pub(crate) fn transfer(&self) -> [Polynomial; 3] {
        let (n, seen_n) = (self.length(), self.correction.len());
        // x and δ are in units of the reading.
        let power =
            |i: usize| (0..i).filter(|_| i < seen_n).fold(1.0, |power, _| power * self.period);
        let mut correction: Vec<f64> =
            self.correction.iter().enumerate().map(|(i, l)| l * power(i)).collect();
        correction.extend(self.sections.iter().flat_map(|_| [0.0, 1.0]));
        let row: Vec<f64> = (0..n).map(|i| self.row[i] / power(i)).collect();
        let step = self.step();
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

    /// `F − 1` of `ê, T ė̂, T² φ̂_0, …`, and of each section's `x, δ` without what they are told.
    fn step(&self) -> Vec<Vec<f64>> {
        let (n, seen) = (self.length(), self.correction.len());
        let mut step = vec![vec![0.0; n]; n];
        for i in 0..seen - 1 {
            step[i][i + 1] = if i == 1 { -1.0 } else { 1.0 };
        }
        step[0][2] = -0.5;
        for (x, FilterSection { rates: [c0, c1], .. }) in (seen..n).step_by(2).zip(&self.sections) {
            step[x][x + 1] = 1.0;
            (step[x + 1][x], step[x + 1][x + 1]) = (-c0, -c1);
        }
        step
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
        7 => weighed_all::<W, 7>(weights, x),
        8 => weighed_all::<W, 8>(weights, x),
        9 => weighed_all::<W, 9>(weights, x),
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

#[cfg(test)]
mod tests {
    use nalgebra::Complex;
    use phihat_certificate::{FilterSection, JointRecord, PositionObserver};

    use super::Positions;
    use crate::lanes::Lane;

    /// A law of an order that filters its innovation with so many sections.
    fn law(order: usize, sections: usize, delay: u32) -> Positions {
        let correction = [0.4, 110.0, -9e3, -3e5, -5e6];
        let filter = [([0.02, 0.3], [3000.0, -500.0]), ([0.4, 1.1], [-800.0, 9000.0])];
        let section = |(rates, weights_per_s2): &([f64; 2], [f64; 2])| FilterSection {
            rates: *rates,
            weights_per_s2: *weights_per_s2,
        };
        let record = JointRecord {
            name: String::new(),
            inertia_kg_m2: 1.0,
            kp_per_s2: 700.0,
            kd_per_s: 60.0,
            a: Vec::new(),
            observer: Some(PositionObserver {
                correction: correction[..order + 2].to_vec(),
                share: 0.3,
                delay_samples: delay,
                innovation_filter: filter[..sections].iter().map(section).collect(),
            }),
        };
        Positions::of(&record, 1e-3).unwrap()
    }

    #[test]
    fn transfer_functions_are_those_of_the_samples() {
        for (order, sections, delay) in
            [(1, 0, 1), (1, 1, 1), (1, 2, 1), (2, 2, 0), (3, 2, 3), (3, 1, 2)]
        {
            let law = law(order, sections, delay);
            let [whole, reading, acted] = law.transfer();
            for angle in [0.0, 0.01, 0.3, 2.0] {
                // Outside of the circle an impulse is summed up soon.
                let z = Complex::from_polar(1.1, angle);
                for (numerator, told) in [(&reading, [0.0, 1.0]), (&acted, [1.0, 0.0])] {
                    let mut held = vec![Lane([0.0]); law.length()];
                    let (mut sum, mut power) = (Complex::new(0.0, 0.0), Complex::new(1.0, 0.0));
                    for k in 0..600 {
                        let [a, y] = if k == 0 { told } else { [0.0; 2] };
                        law.see(&mut held, &Lane([a]), &Lane([y]));
                        let wanted = held.iter().zip(&law.row).map(|(x, w)| x[0] * w).sum::<f64>();
                        sum += power * wanted;
                        power /= z;
                    }
                    let w = z - 1.0;
                    let ratio = numerator.at(w) / whole.at(w);
                    assert!(
                        (sum - ratio).norm() < 1e-8 * ratio.norm(),
                        "{order} {sections} {angle}: {sum} {ratio}"
                    );
                }
            }
        }
    }
}
