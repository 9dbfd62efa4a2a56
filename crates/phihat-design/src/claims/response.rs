//! The loop's answer to an impulse of φ, stepped by the matrix exponential, with bounds between the steps.

use phihat_certificate::PeakGain;

use crate::claims::law::{Refutation, UnitLaw, holds};
use crate::claims::matrix::{
    RationalMatrix, absolute, dot, exponential, identity, norm_frobenius, norm_inf, product,
};
use crate::claims::polynomial;

const CLAIM: &str = "response";

/// Doublings of the horizon before a loop counts as not decaying: two million steps.
const DOUBLINGS: u32 = 21;

/// Rounding of up to two million steps, relative.
const ROUNDING: f64 = 1e-8;

/// The loop `D(s)A_o(s) + (μ−1)s^{m+2}` in the coordinates of its own time `t' = σ t`.
///
/// # Method
///
/// `z^{(n)} + κ_{n−1}z^{(n−1)} + … + κ_0 z = δ(t')`, `σ^n = k_0`, so that `κ_0 = 1`. The state of the ladder
/// is `x_i(t) = −(1/μ) σ^{i−n+1} z_i(σt)`. Between two steps, entry by entry,
/// `|e^{A(t+τ)}| ≤ e^{|A|h} |e^{At}|` for `τ ≤ h`. After the horizon `H`,
/// `∫_H^∞ ‖e^{At}‖ ≤ ‖e^{AH}‖ ∫_0^H ‖e^{At}‖/(1 − ‖e^{AH}‖)`, which also proves stability.
#[derive(Debug, Clone)]
pub struct Response {
    /// Inertia ratio.
    pub mu: f64,
    /// Time scale \[1/s\].
    pub sigma: f64,
    a: RationalMatrix,
    step: f64,
    per_step: RationalMatrix,
    growth: RationalMatrix,
    steps: usize,
    at_horizon: RationalMatrix,
}

impl Response {
    /// Chooses the step and finds a horizon at which the loop has forgotten.
    ///
    /// # Errors
    ///
    /// [`Refutation`], when the law makes no sense at `μ`, or the loop does not decay.
    pub fn new(law: &UnitLaw, mu: f64) -> Result<Self, Refutation> {
        law.check(CLAIM)?;
        holds(CLAIM, "μ > 0", mu, 0.0, mu > 0.0 && mu.is_finite())?;
        let den = law.denominator(mu);
        let stable = polynomial::is_hurwitz(&den);
        holds(CLAIM, "D A_o + (μ−1)s^{m+2} is Hurwitz", mu, 0.0, stable)?;
        let n = den.len() - 1;
        let sigma = libm::pow(den[0] / mu, 1.0 / n as f64);
        let mut a = vec![vec![0.0; n]; n];
        for i in 0..n - 1 {
            a[i][i + 1] = 1.0;
        }
        let mut power = sigma.recip();
        for i in (0..n).rev() {
            a[n - 1][i] = -den[i] / mu * power;
            power /= sigma;
        }
        let step = (0.1 / norm_inf(&a)).min(0.004);
        let scaled =
            |m: &RationalMatrix| m.iter().map(|r| r.iter().map(|v| v * step).collect()).collect();
        let per_step = exponential(&scaled(&a));
        let growth = exponential(&scaled(&absolute(&a)));
        let mut found =
            Self { mu, sigma, a, step, at_horizon: per_step.clone(), per_step, growth, steps: 1 };
        for _ in 0..DOUBLINGS {
            found.at_horizon = product(&found.at_horizon, &found.at_horizon);
            found.steps *= 2;
            let left = norm_inf(&found.at_horizon);
            if left <= 1e-12 && norm_frobenius(&found.in_ladder_units(&found.at_horizon)) <= 1e-6 {
                return Ok(found);
            }
        }
        let left = norm_inf(&found.at_horizon);
        Err(holds(CLAIM, "‖e^{AH}‖ ≤ 1e-12", left, 1e-12, false).err().unwrap_or_else(never))
    }

    /// Size of the ladder, `m + 2`.
    pub fn size(&self) -> usize {
        self.a.len()
    }

    /// Time that is stepped through \[s\].
    pub fn horizon(&self) -> f64 {
        self.steps as f64 * self.step / self.sigma
    }

    /// One step \[s\].
    pub fn step(&self) -> f64 {
        self.step / self.sigma
    }

    /// `x_i = ladder_scale(i) z_i`.
    pub fn ladder_scale(&self, i: usize) -> f64 {
        let mut scale = -1.0 / self.mu;
        for _ in i + 1..self.size() {
            scale /= self.sigma;
        }
        scale
    }

    /// Last row of the state matrix in the loop's own time: `−κ`.
    pub fn last_row(&self) -> &[f64] {
        self.a.last().map_or(&[], Vec::as_slice)
    }

    /// Visits the impulse response `z` at every step, the first one at `t = 0`.
    pub fn walk(&self, mut visit: impl FnMut(&[f64])) {
        let n = self.size();
        let mut z = vec![0.0; n];
        z[n - 1] = 1.0;
        visit(&z);
        let mut next = z.clone();
        for _ in 0..self.steps {
            for (to, row) in next.iter_mut().zip(&self.per_step) {
                *to = dot(row, &z);
            }
            core::mem::swap(&mut z, &mut next);
            visit(&z);
        }
    }

    /// Step, `e^{Ah}` and `e^{|A|h}` for a step `2^doublings` times as long.
    fn coarse(&self, doublings: u32) -> (f64, RationalMatrix, RationalMatrix) {
        let first = (self.step, self.per_step.clone(), self.growth.clone());
        (0..doublings).fold(first, |(h, e, g), _| (2.0 * h, product(&e, &e), product(&g, &g)))
    }

    /// `∫_0^H ‖e^{At'}‖_∞ dt'`, from above.
    pub fn integral_of_norm(&self) -> f64 {
        // It only enters the tail: steps 16 times as long do.
        let (h, per_step, growth) = self.coarse(4);
        let (mut e, mut total) = (identity(self.size()), 0.0);
        for _ in 0..self.steps.div_ceil(16) {
            total += norm_inf(&e);
            e = product(&per_step, &e);
        }
        total * h * norm_inf(&growth)
    }

    /// `∫_0^∞ |cᵀz| dt'`, from both sides; `norm` from [`Self::integral_of_norm`].
    ///
    /// If both ends of a step exceed `h² sup|ÿ|/8` and agree in sign, `y` has no zero between them and
    /// the integral of `|y|` is the difference of `∫y = cᵀA⁻¹z`, exactly. Elsewhere it is that of
    /// the chord, to `h³ sup|ÿ|/12`.
    pub fn l1(&self, c: &[f64], norm: f64) -> PeakGain {
        let c2 = self.row_times_a(&self.row_times_a(c));
        let c3 = self.row_times_a(&c2);
        let c4 = absolute(&vec![self.row_times_a(&c3)]);
        let rest = product(&c4, &self.growth).pop().unwrap_or_default();
        let integral_row = self.row_over_a(c);
        let (h, mut low, mut high) = (self.step, 0.0, 0.0);
        let mut last: Option<(f64, f64, f64)> = None;
        self.walk(|z| {
            let (y, area) = (dot(c, z), dot(&integral_row, z));
            if let Some((y0, area0, bend0)) = last {
                let clear = h * h / 8.0 * bend0;
                if y0 * y > 0.0 && y0.abs().min(y.abs()) > clear {
                    low += (area - area0).abs();
                    high += (area - area0).abs();
                } else {
                    let chord = h * chord_area(y0, y);
                    let error = h * h * h / 12.0 * bend0;
                    low += (chord - error).max(0.0);
                    high += chord + error;
                }
            }
            // sup |ÿ| over the coming step, by Taylor with a bounded rest.
            let rest: f64 = rest.iter().zip(z).map(|(r, z)| r * z.abs()).sum();
            let bend = dot(&c2, z).abs() + h * dot(&c3, z).abs() + 0.5 * h * h * rest;
            last = Some((y, area, bend));
        });
        let weight: f64 = c.iter().map(|v| v.abs()).sum();
        let left = norm_inf(&self.at_horizon);
        let tail = weight * left * norm / (1.0 - left);
        PeakGain { lower: low * (1.0 - ROUNDING), upper: high * (1.0 + ROUNDING) + tail }
    }

    /// `∫_0^∞ ‖e^{(A−BK)t}‖_F dt` in the units of the ladder \[s\], from both sides: an upper bound of that
    /// of the spectral norm, and `1/√n` of its lower side a lower bound.
    pub fn integral_of_ladder_norm(&self) -> PeakGain {
        let n = self.size();
        let a2 = absolute(&product(&self.a, &self.a));
        let (h, per_step, growth) = self.coarse(3);
        let bend = product(&a2, &growth);
        let mut e = identity(n);
        let (mut low, mut high) = (0.0, 0.0);
        for _ in 0..self.steps.div_ceil(8) {
            let next = product(&per_step, &e);
            let ends = [&e, &next].map(|m| norm_frobenius(&self.in_ladder_units(m)));
            let sup = norm_frobenius(&self.in_ladder_units(&product(&bend, &absolute(&e))));
            low += (0.5 * h * (ends[0] + ends[1]) - h * h * h / 6.0 * sup).max(0.0);
            high += 0.5 * h * (ends[0] + ends[1]) + h * h * h / 12.0 * sup;
            e = next;
        }
        let left = norm_frobenius(&self.in_ladder_units(&self.at_horizon));
        let lower = low * (1.0 - ROUNDING) / self.sigma;
        PeakGain { lower, upper: high * (1.0 + ROUNDING) / (1.0 - left) / self.sigma }
    }

    /// Entry `(i, j)` times `σ^{i−j}`.
    fn in_ladder_units(&self, e: &RationalMatrix) -> RationalMatrix {
        let scale: Vec<f64> = (0..self.size()).map(|i| self.ladder_scale(i)).collect();
        let row =
            |(r, si): (&Vec<f64>, &f64)| r.iter().zip(&scale).map(|(v, sj)| v * si / sj).collect();
        e.iter().zip(&scale).map(row).collect()
    }

    fn row_times_a(&self, c: &[f64]) -> Vec<f64> {
        (0..c.len()).map(|j| (0..c.len()).map(|i| c[i] * self.a[i][j]).sum()).collect()
    }

    /// `d` with `dᵀA = cᵀ`: `d_{n−1} = −c_0/κ_0`, `d_{j−1} = c_j + κ_j d_{n−1}`.
    fn row_over_a(&self, c: &[f64]) -> Vec<f64> {
        let (row, n) = (self.last_row(), c.len());
        let mut d = vec![0.0; n];
        d[n - 1] = c[0] / row[0];
        for j in 1..n {
            d[j - 1] = c[j] - row[j] * d[n - 1];
        }
        d
    }
}

/// `∫_0^1 |y_0 + (y_1 − y_0)s| ds`.
fn chord_area(y0: f64, y1: f64) -> f64 {
    let size = y0.abs() + y1.abs();
    if y0 * y1 >= 0.0 { 0.5 * size } else { 0.5 * (y0 * y0 + y1 * y1) / size }
}

fn never() -> Refutation {
    Refutation { claim: CLAIM.to_owned(), inequality: "decays".to_owned(), left: 0.0, right: 0.0 }
}
