//! The law from positions, one joint, per unit of `M̄`: sample by sample, and in frequency.

use super::complex::{Disc, horner};
use crate::{FilterSection, JointRecord};

/// Parameters of a law from positions.
#[derive(Debug, Clone)]
pub(crate) struct Sight {
    period: f64,
    kp: f64,
    kd: f64,
    /// `ℓ` of `ê`, `ė̂`, `φ̂_0 …`.
    correction: Vec<f64>,
    share: f64,
    /// Samples that it predicts across.
    pub(crate) ahead: usize,
    /// Sections that filter the innovation.
    filter: Vec<FilterSection>,
    /// Weights in the wanted torque: of each observer state, and of each torque on its way, the newest first.
    weights: (Vec<f64>, Vec<f64>),
}

/// Most that a law expects.
const EXPECTED: usize = phihat::ORDER_MAX + 2;

/// Wanted torque over a common denominator: its parts from the reading and from the torque that acted.
pub(crate) struct Answer {
    /// `A_o`; with a filter `A_o P`.
    pub(crate) whole: Disc,
    pub(crate) reading: Disc,
    pub(crate) acted: Disc,
}

impl Sight {
    /// `None`: a law that is fed with velocity.
    pub(crate) fn of(record: &JointRecord, period: f64) -> Option<Self> {
        let own = record.observer.as_ref()?;
        let mut law = Self {
            period,
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            correction: own.correction.clone(),
            share: own.share,
            ahead: own.delay_samples as usize,
            filter: own.innovation_filter.clone(),
            weights: (Vec::new(), Vec::new()),
        };
        // Others are no laws that the core runs, and every claim about them is refused.
        if (3..=EXPECTED).contains(&law.expected()) {
            law.weights = law.weighed();
        }
        Some(law)
    }

    /// Weights of the torques on their way in the wanted torque, the newest first.
    pub(crate) fn coming(&self) -> &[f64] {
        &self.weights.1
    }

    /// Number of stored torques: those on their way, and the last one in any case.
    pub(crate) fn sent(&self) -> usize {
        self.ahead.max(1)
    }

    /// Length of what it expects: `ê`, `ė̂`, `φ̂_0 … φ̂_{m−1}`.
    pub(crate) fn expected(&self) -> usize {
        self.correction.len()
    }

    /// Degree of the filter: two per section.
    pub(crate) fn filtered(&self) -> usize {
        2 * self.filter.len()
    }

    /// Length of what it holds: what it expects, then `x`, `δ` of each section.
    pub(crate) fn length(&self) -> usize {
        self.expected() + self.filtered()
    }

    /// `g`.
    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    /// One sample on, under a torque.
    fn carry(&self, held: &mut [f64], torque: f64) {
        let t = self.period;
        let push = torque - held[2];
        held[0] += t * held[1] + 0.5 * t * t * push;
        held[1] += t * push;
        for i in 2..held.len() - 1 {
            held[i] += t * held[i + 1];
        }
    }

    /// Observer update: predicts over an interval with torque `acted`, and corrects by a reading of the error
    /// at its end.
    pub(crate) fn see(&self, held: &mut [f64], acted: f64, reading: f64) {
        let (expected, filtered) = held.split_at_mut(self.expected());
        self.carry(expected, acted);
        let off = reading - expected[0];
        for (value, gain) in expected.iter_mut().zip(&self.correction) {
            *value += gain * off;
        }
        for (own, section) in filtered.chunks_exact_mut(2).zip(&self.filter) {
            let ([x, change], [c0, c1]) = ([own[0], own[1]], section.rates);
            own[0] = x + change;
            own[1] = change + off - c0 * x - c1 * change;
        }
    }

    /// The torque that it asks for; `sent` are the last ones, the newest first.
    pub(crate) fn answer(&self, held: &[f64], sent: &[f64]) -> f64 {
        let mut all = [0.0; EXPECTED];
        let then = &mut all[..self.expected().min(EXPECTED)];
        then.copy_from_slice(&held[..then.len()]);
        for torque in sent.iter().take(self.ahead).rev() {
            self.carry(then, *torque);
        }
        let slope = then.get(3).copied().unwrap_or(0.0);
        let phi = then[2] + self.period * (1.0 / self.share - 1.0) * slope;
        let wanted = phi - self.kp * then[0] - self.kd * then[1] + self.beside(held);
        sent[0] + self.share * (wanted - sent[0])
    }

    /// Torque that the filter adds to the wanted torque.
    fn beside(&self, held: &[f64]) -> f64 {
        let sections = held[self.expected()..].chunks_exact(2).zip(&self.filter);
        let torque = |(own, section): (&[f64], &FilterSection)| {
            let [on_x, on_change] = section.weights_per_s2;
            on_x * own[0] + on_change * own[1]
        };
        sections.map(torque).sum()
    }

    /// The torque that it wants, in frequency.
    ///
    /// # Law
    ///
    /// With the innovation `ν` and `w = z − 1`, `φ̂_j = Φ_j ν/w^{m−j}`, `Φ_{m−1} = zℓ`, `Φ_j = TΦ_{j+1} + zw^{m−1−j}ℓ`:
    ///
    /// ```text
    /// V = zw^mℓ_1 − TΦ_0,   E = TV − T²wΦ_0/2 + zw^{m+1}ℓ_0,   A_o = E + (1 − ℓ_0)w^{m+2},   B = zT²(1 + w/2)
    /// ê = (E y + (1 − ℓ_0)w^m B a)/A_o
    /// ė̂ = (Vw y + zTw^m(zℓ_0 + (1 − ℓ_0)w − Tzℓ_1/2) a)/A_o
    /// φ̂_j = Φ_j (w^{2+j} y − w^j B a)/A_o
    /// ```
    ///
    /// `ê` stands `(1 − ℓ_0)ν` below what is read, so that `(1 − ℓ_0)` is in `A_o y − A_o ê` and goes out. A section is
    /// `wx = δ`, `(w + c_1)δ + c_0x = zν`:
    ///
    /// ```text
    /// ν = (w^{m+2} y − w^m B a)/A_o,    Σ (b_0x + b_1δ) = ν Σ z(b_0 + b_1w)/(w² + c_1w + c_0) =: ν S/P
    /// ```
    ///
    /// With a filter the common denominator is `A_o P`, `P` the product of all `w² + c_1w + c_0`.
    pub(crate) fn at(&self, w: Disc) -> Answer {
        let (t, m) = (self.period, self.expected() - 2);
        let z = w + Disc::real(1.0);
        let [on_e, on_de] = [self.correction[0], self.correction[1]];
        let mut phis = [Disc::real(0.0); EXPECTED];
        for j in (0..m).rev() {
            let own = (z * w.power(m - 1 - j)).times(self.correction[2 + j]);
            phis[j] = phis[j + 1].times(t) + own;
        }
        let v = (z * w.power(m)).times(on_de) + phis[0].times(-t);
        let e = v.times(t) + (w * phis[0]).times(-0.5 * t * t) + (z * w.power(m + 1)).times(on_e);
        let rest = w.power(m).times(1.0 - on_e);
        let whole = e + rest * w * w;
        let b = (z * (w.times(0.5) + Disc::real(1.0))).times(t * t);
        let de_acted =
            (z * w.power(m)).times(t) * (z.times(on_e - 0.5 * t * on_de) + w.times(1.0 - on_e));
        let row = &self.weights.0;
        let (mut reading, mut acted) = (Disc::real(0.0), Disc::real(0.0));
        let mut add = |(y, a): (Disc, Disc), weight: f64| {
            (reading, acted) = (reading + y.times(weight), acted + a.times(weight));
        };
        add((e, rest * b), row[0]);
        add((v * w, de_acted), row[1]);
        for (j, (phi, weight)) in phis[..m].iter().zip(&row[2..]).enumerate() {
            add((*phi * w.power(2 + j), (*phi * w.power(j) * b).times(-1.0)), *weight);
        }
        if self.filter.is_empty() {
            return Answer { whole, reading, acted };
        }
        let (poles, sum) = self.filter_at(w);
        let seen = sum * w.power(m);
        Answer {
            whole: whole * poles,
            reading: reading * poles + seen * w.power(2),
            acted: acted * poles + (seen * b).times(-1.0),
        }
    }

    /// `P` and `S` of the filter.
    fn filter_at(&self, w: Disc) -> (Disc, Disc) {
        let z = w + Disc::real(1.0);
        let none = (Disc::real(1.0), Disc::real(0.0));
        self.filter.iter().fold(none, |(poles, sum), section| {
            let [c0, c1] = section.rates;
            let own = horner(&[c0, c1, 1.0], w);
            let top = z * horner(&section.weights_per_s2, w);
            (poles * own, sum * own + top * poles)
        })
    }

    /// Weights of the observer states and of the torques on their way in the wanted torque, from `answer`
    /// itself.
    fn weighed(&self) -> (Vec<f64>, Vec<f64>) {
        let n = self.length();
        // With nothing sent the answer is `g` times what is wanted.
        let of = |held: &[f64], sent: &[f64]| {
            let kept = (1.0 - self.share) * sent[0];
            (self.answer(held, sent) - kept) / self.share
        };
        let unit = |length: usize, at: usize| {
            let mut list = vec![0.0; length];
            list[at] = 1.0;
            list
        };
        let row = (0..self.expected()).map(|i| of(&unit(n, i), &vec![0.0; self.sent()])).collect();
        let coming = (0..self.ahead).map(|j| of(&vec![0.0; n], &unit(self.sent(), j))).collect();
        (row, coming)
    }
}
