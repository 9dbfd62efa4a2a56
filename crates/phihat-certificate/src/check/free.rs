//! The continuous loop let go after an impulse of φ: areas under what it does, and that it dies out.

use crate::refutation::refuse;
use crate::{Law, Matrix, PeakGain, Refutation};

/// Steps after which a loop counts as not decaying.
const LONGEST: usize = 4_000_000;

/// What rounding may have done to an area, relative.
const ROUNDING: f64 = 1e-9;

/// Halvings of a step in which a signal may change its sign.
const HALVINGS: usize = 14;

/// The loop `D(s)A_o(s) + (μ−1)s^{m+2}` in its own time `t' = σt`, `σ^n = K_p a_0/μ`.
///
/// `z^{(n)} + κ_{n−1}z^{(n−1)} + … + κ_0 z = δ(t')`; the ladder is `x_i(t) = −(1/μ)σ^{i−n+1} z_i(σt)`.
#[derive(Debug, Clone)]
pub(crate) struct Free {
    pub(crate) sigma: f64,
    mu: f64,
    kappa: Vec<f64>,
    /// Step of `t'`, and `e^{At'}` over it, over half of it, …
    step: f64,
    powers: Vec<Matrix>,
    /// `‖A‖_∞`.
    size: f64,
    /// `‖e^{AH}‖_∞ = ρ < ½`, and `∫_0^H ‖e^{At'}‖_∞` from above.
    rho: f64,
    norm: f64,
}

impl Free {
    /// # Errors
    ///
    /// [`Refutation`]: the law makes no sense at `μ`, or its loop does not decay.
    pub(crate) fn new(claim: &str, law: &Law, mu: f64) -> Result<Self, Refutation> {
        const STABLE: &str = "D A_o + (μ−1)s^{m+2} is Hurwitz";
        law.check(claim)?;
        Refutation::unless(claim, "μ > 0", mu, 0.0, mu > 0.0 && mu.is_finite())?;
        let mut a_o = law.a.clone();
        a_o.push(1.0);
        let p = super::polynomial::product(&a_o, &[law.kp, law.kd, 1.0]);
        let n = p.len() - 1;
        let positive = p.iter().all(|c| *c > 0.0);
        Refutation::unless(claim, STABLE, mu, 0.0, positive)?;
        let sigma = (p[0] / mu).powf(1.0 / n as f64);
        let kappa: Vec<f64> =
            (0..n).map(|i| p[i] / mu / (i..n).fold(1.0, |power, _| power * sigma)).collect();
        let size = kappa.iter().sum::<f64>().max(1.0);
        let step = (0.08 / size).min(0.003);
        let powers =
            (0..=HALVINGS).map(|k| exponential(&kappa, step / (1_u32 << k) as f64)).collect();
        let mut free = Self { sigma, mu, kappa, step, powers, size, rho: 1.0, norm: 0.0 };
        let (mut e, mut norm) = (identity(n), 0.0);
        for k in 1..=LONGEST / (n * n) {
            norm += rows(&e) * step * (size * step).exp();
            e = product(&free.powers[0], &e);
            if k % 16 == 0 {
                let left = rows(&e);
                if left < 0.5 {
                    (free.rho, free.norm) = (left, norm);
                    return Ok(free);
                }
                if !left.is_finite() || left > 1e60 {
                    break;
                }
            }
        }
        Err(refuse(claim, STABLE, mu, 0.0))
    }

    /// Size of the ladder, `m + 2`.
    pub(crate) fn len(&self) -> usize {
        self.kappa.len()
    }

    /// `x_i` over `z_i`, without its sign.
    pub(crate) fn unit(&self, i: usize) -> f64 {
        let below = (i + 1..self.len()).fold(1.0, |power, _| power * self.sigma);
        1.0 / (self.mu * below)
    }

    /// Row of `ë`, but for its impulse: `−(1/μ) σ z_{n−1}'`, without its sign.
    pub(crate) fn acceleration(&self) -> Vec<f64> {
        self.kappa.iter().map(|k| -k * self.sigma / self.mu).collect()
    }

    /// `∫_0^∞ |cᵀz| dt` in seconds, from both sides.
    ///
    /// # Method
    ///
    /// Between two zeros the area is a difference of `∫cᵀz`, which is linear in `z`: `∫z_i = z_{i−1}`. A step within
    /// which `cᵀz` may change its sign is halved until hardly anything of it is left.
    pub(crate) fn area(&self, c: &[f64]) -> PeakGain {
        let n = self.len();
        let integral = self.integral(c);
        let mut z = vec![0.0; n];
        z[n - 1] = 1.0;
        let weight: f64 = c.iter().map(|v| v.abs()).sum();
        // |(cᵀz)''| ≤ ‖cᵀA²‖₁ ‖z‖.
        let twice = self.times_a(&self.times_a(c));
        let bend: f64 = twice.iter().map(|v| v.abs()).sum::<f64>() * (self.size * self.step).exp();
        let mut area = Area { low: 0.0, high: 0.0, from: dot(&integral, &z) };
        for k in 0..LONGEST {
            let next = apply(&self.powers[0], &z);
            self.over(&mut area, (c, &integral, bend), (&z, &next), 0);
            z = next;
            if k % 32 == 31 && most(&z) * weight * self.norm < 1e-15 * area.high {
                break;
            }
        }
        area.close(dot(&integral, &z));
        let tail = weight * most(&z) * self.norm / (1.0 - self.rho);
        PeakGain {
            lower: area.low * (1.0 - ROUNDING) / self.sigma,
            upper: (area.high * (1.0 + ROUNDING) + tail) / self.sigma,
        }
    }

    /// One step, or a half of one.
    fn over(
        &self,
        area: &mut Area,
        of: (&[f64], &[f64], f64),
        (start, end): (&[f64], &[f64]),
        halvings: usize,
    ) {
        let (c, integral, bend) = of;
        let h = self.step / f64::from(1_u32 << halvings);
        let (a, b) = (dot(c, start), dot(c, end));
        let bent = h * h / 8.0 * bend * most(start);
        if a * b > 0.0 && a.abs().min(b.abs()) > bent {
            return;
        }
        if halvings < HALVINGS {
            let middle = apply(&self.powers[halvings + 1], start);
            self.over(area, of, (start, &middle), halvings + 1);
            self.over(area, of, (&middle, end), halvings + 1);
            return;
        }
        // So short that its whole size may count: |cᵀz| is at most that of both ends and the bend.
        area.close(dot(integral, start));
        area.from = dot(integral, end);
        area.low += (area.from - dot(integral, start)).abs();
        area.high += h * (a.abs().max(b.abs()) + bent);
    }

    /// `∫_0^∞ ‖e^{(A−BK)t}‖_F dt` in the units of the ladder \[s\], from both sides.
    ///
    /// # Method
    ///
    /// Middles of steps. `f = ‖E‖` has `−‖E''‖ ≤ f'' ≤ ‖E''‖ + ‖E'‖²/‖E‖`, and entry by entry
    /// `|E(t+τ)| ≤ e^{|A|τ}|E(t)|`.
    pub(crate) fn norm_in_ladder_units(&self) -> PeakGain {
        let n = self.len();
        let a = companion(&self.kappa);
        let positive: Matrix = a.iter().map(|r| r.iter().map(|v| v.abs()).collect()).collect();
        let units: Vec<f64> = (0..n).map(|i| self.unit(i)).collect();
        let size = |e: &Matrix| {
            let row = |(row, u): (&Vec<f64>, &f64)| {
                row.iter().zip(&units).map(|(v, w)| (v * u / w).powi(2)).sum::<f64>()
            };
            e.iter().zip(&units).map(row).sum::<f64>().sqrt()
        };
        let growth = series(&positive, self.step);
        let bounded = |e: &Matrix| {
            let positive: Matrix = e.iter().map(|r| r.iter().map(|v| v.abs()).collect()).collect();
            size(&product(&growth, &positive))
        };
        let h = self.step;
        let (mut start, mut low, mut high, mut left) = (identity(n), 0.0, 0.0, 1.0);
        for _ in 0..LONGEST / (n * n) {
            let first = product(&a, &start);
            let second = product(&a, &first);
            let (bend, slope) = (bounded(&second), bounded(&first));
            let middle = size(&product(&self.powers[1], &start));
            low += (h * middle - h.powi(3) / 24.0 * bend).max(0.0);
            // From the middle, the size can fall by its slope over half a step.
            let least = middle - 0.5 * h * slope;
            let steep = if least > 0.0 { slope * slope / least } else { f64::INFINITY };
            high += h * middle + h.powi(3) / 24.0 * (bend + steep);
            start = product(&self.powers[0], &start);
            left = size(&start);
            if left < 1e-8 {
                break;
            }
        }
        // ∫_0^∞ = ∫_0^H + ∫_0^∞ ‖e^{At}e^{AH}‖ ≤ ∫_0^H + ‖e^{AH}‖ ∫_0^∞.
        PeakGain {
            lower: low * (1.0 - ROUNDING) / self.sigma,
            upper: high * (1.0 + ROUNDING) / (1.0 - left) / self.sigma,
        }
    }

    /// `d` with `d/dt' dᵀz = cᵀz`: `∫z_i = z_{i−1}`, and `∫z_0 = −(z_{n−1} + Σ_{j≥1} κ_j z_{j−1})/κ_0`.
    fn integral(&self, c: &[f64]) -> Vec<f64> {
        let n = self.len();
        let lowest = -c[0] / self.kappa[0];
        let mut d: Vec<f64> = (1..n).map(|i| c[i] + lowest * self.kappa[i]).collect();
        d.push(lowest);
        d
    }

    fn times_a(&self, c: &[f64]) -> Vec<f64> {
        let n = self.len();
        let entry =
            |j: usize| j.checked_sub(1).map_or(0.0, |before| c[before]) - c[n - 1] * self.kappa[j];
        (0..n).map(entry).collect()
    }
}

/// Areas so far, and `∫` at the last change of sign.
struct Area {
    low: f64,
    high: f64,
    from: f64,
}

impl Area {
    /// The signal kept its sign until here.
    fn close(&mut self, at: f64) {
        let area = (at - self.from).abs();
        self.low += area;
        self.high += area;
        self.from = at;
    }
}

fn companion(kappa: &[f64]) -> Matrix {
    let n = kappa.len();
    let entry = |i: usize, j: usize| {
        if i + 1 == n { -kappa[j] } else { f64::from(u8::from(j == i + 1)) }
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// `e^{At'}` over a short step.
fn exponential(kappa: &[f64], step: f64) -> Matrix {
    series(&companion(kappa), step)
}

/// `e^{Xh}` by its series, `‖X‖h` small.
fn series(x: &Matrix, h: f64) -> Matrix {
    let n = x.len();
    let (mut sum, mut term) = (identity(n), identity(n));
    for k in 1..=14_u8 {
        term = product(&term, x);
        for (total, row) in sum.iter_mut().zip(&mut term) {
            for (to, value) in total.iter_mut().zip(row) {
                *value *= h / f64::from(k);
                *to += *value;
            }
        }
    }
    sum
}

fn identity(n: usize) -> Matrix {
    (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect()
}

fn product(x: &Matrix, y: &Matrix) -> Matrix {
    let n = y.first().map_or(0, Vec::len);
    let row =
        |row: &Vec<f64>| (0..n).map(|j| row.iter().zip(y).map(|(a, b)| a * b[j]).sum()).collect();
    x.iter().map(row).collect()
}

fn apply(x: &Matrix, z: &[f64]) -> Vec<f64> {
    x.iter().map(|row| dot(row, z)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn most(z: &[f64]) -> f64 {
    z.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// `‖X‖_∞`.
fn rows(x: &Matrix) -> f64 {
    let sums = x.iter().map(|row| row.iter().map(|v| v.abs()).sum::<f64>());
    sums.fold(0.0, |most, sum| if sum.is_nan() { f64::INFINITY } else { most.max(sum) })
}
