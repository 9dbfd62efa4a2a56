//! Randomness that depends on nothing but the seed, the effect, the joint and the sample.

use core::f64::consts::TAU;

/// A stream of random numbers, one for each sample, in any order.
///
/// Counter-based: what one effect draws never moves what another gets, and a run can be cut or extended
/// without changing the rest. The mixer is `SplitMix64`'s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    key: u64,
}

/// Uniform draws for the reference of a joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Draws(Noise);

impl Draws {
    pub(crate) fn of(seed: u64, joint: usize) -> Self {
        Self(Noise::new(seed, NoiseEffect::Reference, joint))
    }

    /// Uniform in `(0, 1)`.
    pub(crate) fn uniform(self, number: u64) -> f64 {
        self.0.uniform(number)
    }
}

/// Effect that a stream belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoiseEffect {
    Position,
    Velocity,
    Torque,
    Jitter,
    Gain,
    CommandLoss,
    SampleLoss,
    FaultNoise,
    FaultCommandLoss,
    FaultSampleLoss,
    Reference,
    BoundedPosition,
    CommandRows,
}

impl Noise {
    pub(super) fn new(seed: u64, effect: NoiseEffect, joint: usize) -> Self {
        let key = mix(mix(seed ^ 0x9E37_79B9_7F4A_7C15) ^ (effect as u64));
        Self { key: mix(key ^ ((joint as u64) << 32)) }
    }

    fn bits(self, sample: u64, draw: u64) -> u64 {
        mix(self.key.wrapping_add(mix((sample << 1) | draw)))
    }

    /// Uniform in `(0, 1)`.
    fn draw(self, sample: u64, draw: u64) -> f64 {
        ((self.bits(sample, draw) >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
    }

    /// Uniform in `(0, 1)`.
    pub(super) fn uniform(self, sample: u64) -> f64 {
        self.draw(sample, 0)
    }

    /// Normal with mean 0 and variance 1, by Box and Muller.
    pub(super) fn normal(self, sample: u64) -> f64 {
        let radius = (-2.0 * libm::log(self.draw(sample, 0))).sqrt();
        radius * libm::cos(TAU * self.draw(sample, 1))
    }
}

fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::{Noise, NoiseEffect};

    /// Wrong if a stream were not standard normal, or two streams or two neighbours were correlated.
    #[test]
    fn streams_are_normal_and_independent() {
        let n = 200_000_u64;
        let of = |effect, joint| {
            let noise = Noise::new(1, effect, joint);
            (0..n).map(|k| noise.normal(k)).collect::<Vec<_>>()
        };
        let one = of(NoiseEffect::Position, 0);
        let moment = |p: i32| one.iter().map(|x| x.powi(p)).sum::<f64>() / n as f64;
        // Standard errors: 1/√n = 0.0022 times √(var of x^p).
        for (power, expected, tolerance) in
            [(1, 0.0, 0.01), (2, 1.0, 0.015), (3, 0.0, 0.04), (4, 3.0, 0.1)]
        {
            assert!((moment(power) - expected).abs() < tolerance, "{power}: {}", moment(power));
        }
        let correlation =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() / n as f64;
        assert!(correlation(&one, &of(NoiseEffect::Position, 1)).abs() < 0.01);
        assert!(correlation(&one, &of(NoiseEffect::Velocity, 0)).abs() < 0.01);
        assert!(correlation(&one, &one[1..]).abs() < 0.01);
    }
}
