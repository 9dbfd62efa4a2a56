//! The continuous loop let go after an impulse of φ: areas under what it does, and that it dies out.

use crate::extremes::Extremes as _;
use crate::refutation::refuse;
use crate::{Law, PeakGain, Refutation};

/// Longest ladder.
const MOST: usize = phihat::ORDER_MAX + 2;

/// A small matrix in the corner of a fixed one: no heap in the long loops.
type Square = [[f64; MOST]; MOST];

/// A state of the ladder.
type Z = [f64; MOST];

/// Steps after which a loop counts as not decaying.
const LONGEST: usize = 4_000_000;

/// What rounding may have done to an area, relative.
const ROUNDING: f64 = 1e-9;

/// Halvings of a step in which a signal may change its sign.
const HALVINGS: usize = 12;

/// Terms of a second derivative's series.
const SLOPES: usize = 7;

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
    powers: Vec<Square>,
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
        let step = (0.25 / size).min(0.012);
        let powers = (0..=HALVINGS)
            .map(|k| series(&companion(&kappa), step / f64::from(1_u32 << k)))
            .collect();
        let mut free = Self { sigma, mu, kappa, step, powers, size, rho: 1.0, norm: 0.0 };
        let (mut e, mut norm) = (UNIT, 0.0);
        for k in 1..=LONGEST / (n * n) {
            norm += rows(&e, n) * step * (size * step).exp();
            e = product(&free.powers[0], &e);
            if k % 16 == 0 {
                let left = rows(&e, n);
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

    /// `∫_0^∞ |cᵀz| dt` in seconds of each row, from both sides.
    ///
    /// # Method
    ///
    /// Between two zeros the area is a difference of `∫cᵀz`, which is linear in `z`: `∫z_i = z_{i−1}`. A step within
    /// which `cᵀz` may change its sign is halved until hardly anything of it is left.
    pub(crate) fn areas(&self, rows: &[Vec<f64>]) -> Vec<PeakGain> {
        let n = self.len();
        let mut z = [0.0; MOST];
        z[n - 1] = 1.0;
        let grown = (self.size * self.step).exp();
        let mut areas: Vec<Area> = rows
            .iter()
            .map(|c| {
                let mut slopes = vec![self.times_a(&self.times_a(c))];
                for k in 0..SLOPES {
                    slopes.push(self.times_a(&slopes[k]));
                }
                let rest = slopes.pop().unwrap_or_default();
                let rest = rest.iter().map(|v| v.abs()).sum::<f64>() * grown;
                let integral = self.integral(c);
                let from = dot(&integral, &z);
                let weight = c.iter().map(|v| v.abs()).sum();
                Area { c: c.clone(), integral, slopes, rest, weight, low: 0.0, high: 0.0, from }
            })
            .collect();
        let tail = |area: &Area, z: &[f64]| area.weight * most(z) * self.norm / (1.0 - self.rho);
        for k in 0..LONGEST {
            let next = apply(&self.powers[0], &z);
            for area in &mut areas {
                self.over(area, (&z, &next), 0);
            }
            z = next;
            if k % 32 == 31 && areas.iter().all(|area| tail(area, &z) < 1e-13 * area.high) {
                break;
            }
        }
        let close = |mut area: Area| {
            area.close(dot(&area.integral, &z));
            let high = area.high * (1.0 + ROUNDING) + tail(&area, &z);
            let lower = area.low * (1.0 - ROUNDING) / self.sigma;
            PeakGain { lower, upper: high / self.sigma }
        };
        areas.into_iter().map(close).collect()
    }

    /// One step, or a half of one.
    fn over(&self, area: &mut Area, (start, end): (&Z, &Z), halvings: usize) {
        let h = self.step / f64::from(1_u32 << halvings);
        let (a, b) = (dot(&area.c, start), dot(&area.c, end));
        let bent = if a * b > 0.0 || halvings == HALVINGS { area.bent(start, h) } else { 0.0 };
        if a * b > 0.0 && a.abs().min(b.abs()) > bent {
            return;
        }
        if halvings < HALVINGS {
            let middle = apply(&self.powers[halvings + 1], start);
            self.over(area, (start, &middle), halvings + 1);
            self.over(area, (&middle, end), halvings + 1);
            return;
        }
        // So short that its whole size may count: |cᵀz| is at most that of both ends and the bend.
        let (before, after) = (dot(&area.integral, start), dot(&area.integral, end));
        area.close(before);
        area.low += (after - before).abs();
        area.high += h * (a.abs().max(b.abs()) + bent);
        area.from = after;
    }

    /// `∫_0^∞ ‖e^{(A−BK)t}‖_F dt` in the units of the ladder \[s\], from both sides.
    ///
    /// # Method
    ///
    /// `f = ‖E‖` has `f'' ≥ −‖E''‖`: middles of steps less `h³/24 sup‖E''‖` from below, chords and `h³/12 sup‖E''‖` from
    /// above; entry by entry `|E(t+τ)| ≤ e^{|A|τ}|E(t)|`.
    pub(crate) fn norm_in_ladder_units(&self) -> PeakGain {
        let n = self.len();
        let a = companion(&self.kappa);
        let mut units = [0.0; MOST];
        for (i, unit) in units.iter_mut().enumerate().take(n) {
            *unit = self.unit(i);
        }
        let size = |e: &Square| {
            let mut sum = 0.0;
            for (row, u) in e.iter().zip(&units).take(n) {
                for (value, w) in row.iter().zip(&units).take(n) {
                    sum += (value * u / w) * (value * u / w);
                }
            }
            f64::sqrt(sum)
        };
        let h = self.step;
        let growth = series(&absolute(&a), h);
        let bounded = |e: &Square| size(&product(&growth, &absolute(e)));
        let (mut start, mut low, mut high) = (UNIT, 0.0, 0.0);
        let mut left = size(&start);
        for _ in 0..LONGEST / (n * n) {
            let bend = bounded(&product(&a, &product(&a, &start)));
            let middle = size(&product(&self.powers[1], &start));
            start = product(&self.powers[0], &start);
            let end = size(&start);
            low += (h * middle - h.powi(3) / 24.0 * bend).max(0.0);
            high += 0.5 * h * (left + end) + h.powi(3) / 12.0 * bend;
            left = end;
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

/// A row's areas so far, and `∫` at its last change of sign.
struct Area {
    c: Vec<f64>,
    integral: Vec<f64>,
    /// Rows of the second derivative and those above, and `‖cᵀA^k‖₁` of the next one, grown over a step.
    slopes: Vec<Vec<f64>>,
    rest: f64,
    weight: f64,
    low: f64,
    high: f64,
    from: f64,
}

impl Area {
    /// `h²/8 sup |(cᵀz)''|` over a step, by Taylor's series with its rest bounded.
    fn bent(&self, start: &Z, h: f64) -> f64 {
        let mut power = 1.0;
        let mut sup = 0.0;
        for (k, row) in (1_u8..).zip(&self.slopes) {
            sup += power * dot(row, start).abs();
            power *= h / f64::from(k);
        }
        h * h / 8.0 * (sup + power * self.rest * most(start))
    }

    /// The signal kept its sign until here.
    fn close(&mut self, at: f64) {
        let area = (at - self.from).abs();
        self.low += area;
        self.high += area;
        self.from = at;
    }
}

fn companion(kappa: &[f64]) -> Square {
    let n = kappa.len();
    let mut a = [[0.0; MOST]; MOST];
    for i in 1..n {
        a[i - 1][i] = 1.0;
    }
    for (to, k) in a[n - 1].iter_mut().zip(kappa) {
        *to = -k;
    }
    a
}

/// `e^{Xh}` by its series, `‖X‖h` small.
fn series(x: &Square, h: f64) -> Square {
    let (mut sum, mut term) = (UNIT, UNIT);
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

const UNIT: Square = {
    let mut unit = [[0.0; MOST]; MOST];
    let mut i = 0;
    while i < MOST {
        unit[i][i] = 1.0;
        i += 1;
    }
    unit
};

fn product(x: &Square, y: &Square) -> Square {
    let mut out = [[0.0; MOST]; MOST];
    for (to, row) in out.iter_mut().zip(x) {
        for (factor, from) in row.iter().zip(y) {
            for (entry, value) in to.iter_mut().zip(from) {
                *entry += factor * value;
            }
        }
    }
    out
}

fn absolute(x: &Square) -> Square {
    x.map(|row| row.map(f64::abs))
}

fn apply(x: &Square, z: &[f64; MOST]) -> [f64; MOST] {
    x.map(|row| dot(&row, z))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn most(z: &[f64]) -> f64 {
    z.iter().map(|value| value.abs()).largest()
}

/// `‖X‖_∞` of its first `n` rows and columns.
fn rows(x: &Square, n: usize) -> f64 {
    let sums = x.iter().take(n).map(|row| row.iter().take(n).map(|v| v.abs()).sum::<f64>());
    let most = sums.largest();
    if most.is_nan() { f64::INFINITY } else { most }
}
