//! Random admissible gains, and a plain simulation of the loop.
#![allow(dead_code, unreachable_pub, reason = "each test file uses its own part of this")]

use phihat_design::claims::{UnitLaw, polynomial};

/// SplitMix64: the seed is the whole state.
pub struct Random(pub u64);

impl Random {
    /// Uniform in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        low + (high - low) * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A law whose outer loop and estimator are well damped, and the pairs `(ω, ζ)` or single poles it is made of.
pub fn random_law(random: &mut Random, order: usize) -> UnitLaw {
    let omega = random.between(5.0, 40.0);
    let zeta = random.between(0.75, 1.5);
    let mut a = vec![1.0];
    while a.len() <= order {
        let pole = omega * random.between(1.5, 6.0);
        if a.len() < order && random.between(0.0, 1.0) < 0.5 {
            let damping = random.between(0.85, 1.4);
            a = polynomial::product(&a, &[pole * pole, 2.0 * damping * pole, 1.0]);
        } else {
            a = polynomial::product(&a, &[pole, 1.0]);
        }
    }
    a.pop();
    UnitLaw { kp: omega * omega, kd: 2.0 * zeta * omega, a }
}

/// The gains that the paper's experiments run: `K_p` 400, `K_d` 40.
pub fn law(a: &[f64]) -> UnitLaw {
    UnitLaw { kp: 400.0, kd: 40.0, a: a.to_vec() }
}

/// The ladder `x` at `μ`, driven by φ: `μ x_{n−1}' = −Σ k_i x_i − φ`, classical Runge–Kutta.
pub struct Loop {
    den: Vec<f64>,
    pub x: Vec<f64>,
}

impl Loop {
    pub fn new(law: &UnitLaw, mu: f64) -> Self {
        let den = law.denominator(mu);
        let x = vec![0.0; den.len() - 1];
        Self { den, x }
    }

    fn rate(&self, x: &[f64], phi: f64) -> Vec<f64> {
        let n = x.len();
        let pull: f64 = self.den.iter().zip(x).map(|(k, x)| k * x).sum();
        let mut rate: Vec<f64> = x[1..].to_vec();
        rate.push((-pull - phi) / self.den[n]);
        rate
    }

    pub fn step(&mut self, phi: f64, dt: f64) {
        let add = |k: &[f64], f: f64| -> Vec<f64> {
            self.x.iter().zip(k).map(|(x, k)| x + f * k).collect()
        };
        let k1 = self.rate(&self.x, phi);
        let k2 = self.rate(&add(&k1, 0.5 * dt), phi);
        let k3 = self.rate(&add(&k2, 0.5 * dt), phi);
        let k4 = self.rate(&add(&k3, dt), phi);
        for i in 0..self.x.len() {
            self.x[i] += dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
}
