//! Sizes of the errors: peak-to-peak gains of the loop, and the paper's bound alongside.

use phihat_certificate::Iss;
pub use phihat_certificate::{PaperRadius, PeakGain, PeakGains};

use crate::claims::law::{Refutation, UnitLaw};
use crate::claims::response::Response;

/// Finding [`PeakGains`].
pub trait FindPeakGains: Sized {
    /// Computes the peak-to-peak gains of a law at inertia ratio `mu`.
    ///
    /// # Errors
    ///
    /// [`Refutation`], when the law makes no sense or the loop is not stable at `μ`.
    fn of(law: &UnitLaw, mu: f64) -> Result<Self, Refutation>;
}

impl FindPeakGains for PeakGains {
    fn of(law: &UnitLaw, mu: f64) -> Result<Self, Refutation> {
        let response = Response::new(law, mu)?;
        let (n, sigma) = (response.size(), response.sigma);
        let norm = response.integral_of_norm();
        let gain = |i: usize| {
            let mut c = vec![0.0; n];
            c[i] = response.ladder_scale(i);
            in_seconds(response.l1(&c, norm), sigma)
        };
        // D e: the part of ë that is not an impulse is the last row times z.
        let scale = 1.0 / mu;
        let mut c: Vec<f64> = response.last_row().iter().map(|k| scale * sigma * k).collect();
        c[n - 2] += scale * law.kp / sigma;
        c[n - 1] += scale * law.kd;
        let rest = in_seconds(response.l1(&c, norm), sigma);
        let estimate = PeakGain { lower: scale + rest.lower, upper: scale + rest.upper };
        Ok(Self { mu, states: (0..n).map(gain).collect(), estimate })
    }
}

/// The φ that attains a peak-to-peak gain: `±1`, with switches.
#[derive(Debug, Clone, PartialEq)]
pub struct WorstCase {
    /// When the state peaks, from rest at 0 \[s\].
    pub peak_s: f64,
    /// When φ changes sign, ascending \[s\].
    pub switches_s: Vec<f64>,
    /// Value before the first switch.
    pub first: f64,
}

impl WorstCase {
    /// The worst φ for a state of the ladder (0: the lowest integral).
    ///
    /// # Errors
    ///
    /// [`Refutation`], when the loop is not stable at `μ`.
    pub fn of(law: &UnitLaw, mu: f64, index: usize) -> Result<Self, Refutation> {
        let response = Response::new(law, mu)?;
        let peak_s = response.horizon();
        let index = index.min(response.size() - 1);
        let scale = response.ladder_scale(index);
        let (mut time, mut last, mut first) = (0.0, 0.0, 1.0);
        let mut switches_s = Vec::new();
        response.walk(|z| {
            let y: f64 = scale * z[index];
            if last * y < 0.0 {
                let crossing = time - response.step() * y / (y - last);
                switches_s.push(peak_s - crossing);
            }
            if y.abs() > 0.0 {
                (last, first) = (y, y.signum());
            }
            time += response.step();
        });
        switches_s.reverse();
        Ok(Self { peak_s, switches_s, first })
    }

    /// φ at a time.
    pub fn phi(&self, time_s: f64) -> f64 {
        let passed = self.switches_s.partition_point(|s| *s <= time_s);
        if passed % 2 == 0 { self.first } else { -self.first }
    }
}

/// Finding a [`PaperRadius`].
pub trait FindPaperRadius: Sized {
    /// Computes the radius from the evidence of input-to-state stability.
    fn of(iss: &Iss) -> Self;
}

impl FindPaperRadius for PaperRadius {
    fn of(iss: &Iss) -> Self {
        let printed = 2.0 * iss.sb_norm / iss.w_min;
        Self { printed, corrected: printed * iss.overshoot }
    }
}

fn in_seconds(gain: PeakGain, sigma: f64) -> PeakGain {
    PeakGain { lower: gain.lower / sigma, upper: gain.upper / sigma }
}
