//! The law from positions, one joint, per unit of `M̄`, sample by sample.

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
}

/// Most that a law expects.
const EXPECTED: usize = phihat::ORDER_MAX + 2;

impl Sight {
    /// `None`: a law that is fed with velocity.
    pub(crate) fn of(record: &JointRecord, period: f64) -> Option<Self> {
        let own = record.observer.as_ref()?;
        Some(Self {
            period,
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            correction: own.correction.clone(),
            share: own.share,
            ahead: own.delay_samples as usize,
            filter: own.innovation_filter.clone(),
        })
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
}
