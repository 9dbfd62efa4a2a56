//! Laws and states drawn at random, the same ones every time.

use phihat_design::claims::{UnitLaw, polynomial};
use phihat_session::Dice;

/// The seed is the whole state.
#[derive(Debug)]
pub(crate) struct Draw(Dice);

impl Draw {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Dice::at(seed))
    }

    /// Uniform in `[low, high)`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }

    /// `n` numbers of either sign whose sizes spread over `decades` below 1.
    pub(crate) fn spread(&mut self, n: usize, decades: f64) -> Vec<f64> {
        let one = |draw: &mut Self| {
            draw.between(-1.0, 1.0).signum() * 10.0_f64.powf(draw.between(-decades, 0.0))
        };
        (0..n).map(|_| one(self)).collect()
    }

    /// A law whose outer loop has damping `0.4 … 1.5` and whose estimator is 1.5 to 6 times as fast, of single
    /// poles and pairs of damping `0.5 … 1.4`.
    pub(crate) fn law(&mut self, order: usize) -> UnitLaw {
        let omega = self.between(5.0, 40.0);
        let zeta = self.between(0.4, 1.5);
        let mut a = vec![1.0];
        while a.len() <= order {
            let pole = omega * self.between(1.5, 6.0);
            a = if a.len() < order && self.between(0.0, 1.0) < 0.5 {
                let damping = self.between(0.5, 1.4);
                polynomial::product(&a, &[pole * pole, 2.0 * damping * pole, 1.0])
            } else {
                polynomial::product(&a, &[pole, 1.0])
            };
        }
        a.pop();
        UnitLaw { kp: omega * omega, kd: 2.0 * zeta * omega, a }
    }
}
