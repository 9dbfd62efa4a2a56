//! The laws that are looked at: an outer loop, an observer by its poles, and how fast the torque follows.

use core::f64::consts::{PI, TAU};

use crate::sampled::placed::{Poles, correction};
use crate::{FilterSection, JointRecord, PositionObserver};

/// Numbers of a law of the family, positive ones by their logarithms: `K_p`, `K_d`, the observer's real pole,
/// its pair (distance and damping), the bandwidth of the torque \[Hz\]; for `m = 2` another real pole. With a
/// filter on the innovation, for each of its sections the pair of poles (distance, damping), and what of its
/// state and of the change of that the torque has, of either sign.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Family {
    /// Order `m`, 1 or 2.
    pub(super) order: usize,
    /// True if it filters the innovation.
    pub(super) filtered: bool,
    pub(super) period: f64,
    pub(super) delay: u32,
}

/// A law to begin with, at 1 kHz: in between those that fit arms whose encoders have 16 to 20 bits.
const START: [f64; 6] = [700.0, 110.0, 130.0, 850.0, 0.27, 28.0];

/// The second real pole of order 2 to begin with.
const SLOW: f64 = 12.0;

/// Poles of a filter's sections to begin with, beside the observer's real pole: distance and damping.
const SECTIONS: [(f64, f64); 2] = [(0.45, 0.8), (3.0, 0.8)];

/// The damping that a section may have.
const DAMPED: core::ops::RangeInclusive<f64> = 0.15..=3.0;

/// Powers of the speed with which the numbers grow.
const POWERS: [f64; 6] = [2.0, 1.0, 1.0, 1.0, 0.0, 1.0];

/// Poles are kept below this share of half the sample rate.
const FASTEST: f64 = 0.9;

/// No number is slower than this per sample: a mode that takes a million samples to die out is none that a
/// certificate can sum up, and no error of a joint's estimate shows it.
const SLOWEST: f64 = 5e-5;

/// A joint that was pushed aside comes back at least so fast \[1/s\]. A tube begins on the reference and does
/// not require it: a search resulted in 0.07 1/s for a light wrist, which would have been half a minute on
/// its way.
const RETURN: f64 = 1.0;

/// No section is slower than this per sample: what it holds would outgrow single precision.
const SLOWEST_SECTION: f64 = 4e-3;

impl Family {
    /// Count of numbers without those of a filter.
    fn length(&self) -> usize {
        START.len() + self.order.saturating_sub(1)
    }

    /// Returns true if the numbers are of this family, with a filter or without.
    pub(super) fn has(&self, x: &[f64]) -> bool {
        self.filtered == (x.len() > self.length())
    }

    /// The same law with a filter that does nothing yet.
    pub(super) fn with_filter(x: &[f64]) -> Vec<f64> {
        let mut all = x.to_vec();
        let own = x.get(2).copied().unwrap_or_default();
        for (distance, damping) in SECTIONS {
            all.extend([own + libm::log(distance), libm::log(damping), 0.0, 0.0]);
        }
        all
    }

    /// A law of a speed, 1 for a loop of some 25 rad/s.
    pub(super) fn start(&self, speed: f64) -> Vec<f64> {
        let mut all: Vec<f64> = START
            .iter()
            .zip(POWERS)
            .map(|(x, power)| libm::log(*x) + power * libm::log(speed))
            .collect();
        all.resize(self.length(), libm::log(SLOW * speed));
        all
    }

    /// The law of these numbers for a joint; `None` where they are none.
    pub(super) fn record(&self, x: &[f64], name: &str, inertia: f64) -> Option<JointRecord> {
        let (x, sections) = x.split_at_checked(self.length())?;
        let mut all = x.iter().map(|x| libm::exp(*x));
        let mut next = || all.next().filter(|x| x.is_finite() && *x > 0.0);
        let [kp, kd, w1, w2, z, hz] = [next()?, next()?, next()?, next()?, next()?, next()?];
        let most = FASTEST * PI / self.period;
        if w1 > most || w2 > most || z > 3.0 {
            return None;
        }
        let least = SLOWEST / self.period;
        if kp / kd < RETURN.max(least) || [w1, w2, TAU * hz].into_iter().any(|w| w < least) {
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
                // In units of what an innovation of the observer by itself does to the torque.
                innovation_filter: self.filter(sections, 3.0 * (kp + kd * w1))?,
            }),
        })
    }

    /// The sections of these numbers, with their weights in a unit; `None` where they are none.
    fn filter(&self, x: &[f64], unit: f64) -> Option<Vec<FilterSection>> {
        let (least, most) = (SLOWEST_SECTION / self.period, FASTEST * PI / self.period);
        let section = |own: &[f64]| {
            let &[w, z, held, change] = own else { return None };
            let (w, z) = (libm::exp(w), libm::exp(z));
            if !(least..=most).contains(&w) || !DAMPED.contains(&z) {
                return None;
            }
            let [c0, c1] = Poles::Pair { w, z }.rates(self.period);
            // What is held of an innovation that stays, and what of one that just came.
            let held = unit * held * c0;
            Some(FilterSection {
                rates: [c0, c1],
                weights_per_s2: [held, held + unit * change * c1],
            })
        };
        x.chunks(4).map(section).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Family;

    #[test]
    fn no_law_has_a_pole_that_is_never_forgotten() {
        let family = Family { order: 2, filtered: false, period: 1e-3, delay: 1 };
        let start = family.start(0.6);
        assert!(family.record(&start, "", 1.0).is_some());
        // A simplex on a joint whose error hardly counts had found K_p/K_d = 0.009 1/s: its certificate was refused.
        let mut aside = start.clone();
        aside[0] += (0.9 * aside[1].exp() / aside[0].exp()).ln();
        assert!(family.record(&aside, "", 1.0).is_none());
        aside[0] += (1.2_f64 / 0.9).ln();
        assert!(family.record(&aside, "", 1.0).is_some());
        for number in [0, 2, 3, 5, 6] {
            let mut slow = start.clone();
            slow[number] -= 12.0;
            assert!(family.record(&slow, "", 1.0).is_none(), "{number}");
        }
    }
}
