//! The law from positions, one joint, per unit of `M̄`: sample by sample, and in frequency.

use super::complex::Disc;
use crate::JointRecord;

/// What the law knows of itself.
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
    /// What each thing expected weighs in the torque wanted, and each torque on its way, the newest first.
    weights: (Vec<f64>, Vec<f64>),
}

/// Most that a law expects.
const EXPECTED: usize = phihat::ORDER_MAX + 2;

/// What of the law's answer comes from where, over a common denominator: the reading, the torque that acted.
pub(crate) struct Answer {
    /// `A_o`.
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
            weights: (Vec::new(), Vec::new()),
        };
        // Others are no laws that the core runs, and every claim about them is refused.
        if (3..=EXPECTED).contains(&law.length()) {
            law.weights = law.weighed();
        }
        Some(law)
    }

    /// What torques on their way weigh in the torque wanted, the newest first.
    pub(crate) fn coming(&self) -> &[f64] {
        &self.weights.1
    }

    /// How many torques it remembers: those on their way, and the last one in any case.
    pub(crate) fn sent(&self) -> usize {
        self.ahead.max(1)
    }

    /// Length of what it expects: `ê`, `ė̂`, `φ̂_0 … φ̂_{m−1}`.
    pub(crate) fn length(&self) -> usize {
        self.correction.len()
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

    /// What it expects after an interval with a torque, and a reading of the error at its end.
    pub(crate) fn see(&self, held: &mut [f64], acted: f64, reading: f64) {
        self.carry(held, acted);
        let off = reading - held[0];
        for (value, gain) in held.iter_mut().zip(&self.correction) {
            *value += gain * off;
        }
    }

    /// The torque that it asks for; `sent` are the last ones, the newest first.
    pub(crate) fn answer(&self, held: &[f64], sent: &[f64]) -> f64 {
        let mut all = [0.0; EXPECTED];
        let then = &mut all[..held.len().min(EXPECTED)];
        then.copy_from_slice(&held[..then.len()]);
        for torque in sent.iter().take(self.ahead).rev() {
            self.carry(then, *torque);
        }
        let slope = then.get(3).copied().unwrap_or(0.0);
        let phi = then[2] + self.period * (1.0 / self.share - 1.0) * slope;
        let wanted = phi - self.kp * then[0] - self.kd * then[1];
        sent[0] + self.share * (wanted - sent[0])
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
    pub(crate) fn at(&self, w: Disc) -> Answer {
        let (t, m) = (self.period, self.length() - 2);
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
        for (j, (phi, weight)) in phis.iter().zip(&row[2..]).enumerate() {
            add((*phi * w.power(2 + j), (*phi * w.power(j) * b).times(-1.0)), *weight);
        }
        Answer { whole, reading, acted }
    }

    /// What each thing expected, and each torque on its way, weighs in the torque wanted: told by the law itself.
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
        let row = (0..n).map(|i| of(&unit(n, i), &vec![0.0; self.sent()])).collect();
        let coming = (0..self.ahead).map(|j| of(&vec![0.0; n], &unit(self.sent(), j))).collect();
        (row, coming)
    }
}
