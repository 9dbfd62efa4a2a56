//! The laws that are looked at: an outer loop, an observer by its poles, and how fast the torque follows.

use core::f64::consts::{PI, TAU};

use crate::sampled::placed::{Poles, correction};
use crate::{JointRecord, PositionObserver};

/// Numbers of a law of the family, all positive, by their logarithms: `K_p`, `K_d`, the observer's real pole, its pair
/// (distance and damping), the bandwidth of the torque \[Hz\]; for `m = 2` another real pole.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Family {
    /// Order `m`, 1 or 2.
    pub(super) order: usize,
    pub(super) period: f64,
    pub(super) delay: u32,
}

/// A law to begin with, at 1 kHz: in between those that fit arms whose encoders have 16 to 20 bits.
const START: [f64; 6] = [700.0, 110.0, 130.0, 850.0, 0.27, 28.0];

/// The second real pole of order 2 to begin with.
const SLOW: f64 = 12.0;

/// How the numbers grow with speed: by which power.
const POWERS: [f64; 6] = [2.0, 1.0, 1.0, 1.0, 0.0, 1.0];

/// Poles are kept below this share of half the sample rate.
const FASTEST: f64 = 0.9;

/// No number is slower than this per sample: a mode that is forgotten in a million samples is none that a certificate can
/// sum up, and no error of a joint's estimate shows it.
const SLOWEST: f64 = 5e-5;

impl Family {
    /// Count of numbers.
    pub(super) fn length(&self) -> usize {
        START.len() + self.order.saturating_sub(1)
    }

    /// A law of a speed, 1 for a loop of some 25 rad/s.
    pub(super) fn start(&self, speed: f64) -> Vec<f64> {
        let mut all: Vec<f64> =
            START.iter().zip(POWERS).map(|(x, power)| x.ln() + power * speed.ln()).collect();
        all.resize(self.length(), (SLOW * speed).ln());
        all
    }

    /// The law of these numbers for a joint; `None` where they are none.
    pub(super) fn record(&self, x: &[f64], name: &str, inertia: f64) -> Option<JointRecord> {
        let mut all = x.iter().map(|x| libm::exp(*x));
        let mut next = || all.next().filter(|x| x.is_finite() && *x > 0.0);
        let [kp, kd, w1, w2, z, hz] = [next()?, next()?, next()?, next()?, next()?, next()?];
        let most = FASTEST * PI / self.period;
        if w1 > most || w2 > most || z > 3.0 {
            return None;
        }
        let least = SLOWEST / self.period;
        if [kp / kd, w1, w2, TAU * hz].into_iter().any(|w| w < least) {
            return None;
        }
        let mut poles = vec![Poles::Real { w: w1 }, Poles::Pair { w: w2, z }];
        if self.order > 1 {
            poles.push(Poles::Real { w: next().filter(|w| (least..=most).contains(w))? });
        }
        Some(JointRecord {
            name: name.to_owned(),
            inertia_kg_m2: inertia,
            kp_per_s2: kp,
            kd_per_s: kd,
            a: Vec::new(),
            observer: Some(PositionObserver {
                correction: correction(&poles, self.period),
                share: -libm::expm1(-TAU * hz * self.period),
                delay_samples: self.delay,
                innovation_filter: Vec::new(),
            }),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::Family;

    #[test]
    fn no_law_has_a_pole_that_is_never_forgotten() {
        let family = Family { order: 2, period: 1e-3, delay: 1 };
        let start = family.start(0.6);
        assert!(family.record(&start, "", 1.0).is_some());
        // A simplex on a joint whose error hardly counts had found K_p/K_d = 0.009 1/s: its certificate was refused.
        for number in [0, 2, 3, 5, 6] {
            let mut slow = start.clone();
            slow[number] -= 12.0;
            assert!(family.record(&slow, "", 1.0).is_none(), "{number}");
        }
    }
}
