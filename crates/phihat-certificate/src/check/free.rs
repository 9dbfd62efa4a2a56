//! The continuous loop let go after an impulse of φ: areas under what it does, and that it dies out.

use crate::extremes::Extremes as _;
use crate::refutation::refuse;
use crate::{PeakGain, Refutation, UnitLaw};

/// Longest ladder.
const MOST: usize = phihat::ORDER_MAX + 2;

/// A small matrix in the corner of a fixed one: no heap in the long loops.
type SquareOfFree = [[f64; MOST]; MOST];

/// A state of the ladder.
type Z = [f64; MOST];

/// Steps after which a loop counts as not decaying.
const LONGEST: usize = 4_000_000;

/// Relative error of an area by rounding, at most.
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
    powers: Vec<SquareOfFree>,
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
    pub(crate) fn new(claim: &str, law: &UnitLaw, mu: f64) -> Result<Self, Refutation> {
        const STABLE: &str = "D A_o + (μ−1)s^{m+2} is Hurwitz";
        law.check(claim)?;
        Refutation::unless(claim, "μ > 0", mu, 0.0, mu > 0.0 && mu.is_finite())?;
        let mut a_o = law.a.clone();
        a_o.push(1.0);
        let p = super::polynomial::product(&a_o, &[law.kp, law.kd, 1.0]);
        let n = p.len() - 1;
        let positive = p.iter().all(|c| *c > 0.0);
        Refutation::unless(claim, STABLE, mu, 0.0, positive)?;
        let sigma = libm::pow(p[0] / mu, 1.0 / n as f64);
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
            norm += rows(&e, n) * step * libm::exp(size * step);
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
        let grown = libm::exp(self.size * self.step);
        let mut areas: Vec<BoundedArea> = rows
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
                BoundedArea {
                    c: c.clone(),
                    integral,
                    slopes,
                    rest,
                    weight,
                    low: 0.0,
                    high: 0.0,
                    from,
                }
            })
            .collect();
        let tail =
            |area: &BoundedArea, z: &[f64]| area.weight * most(z) * self.norm / (1.0 - self.rho);
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
        let close = |mut area: BoundedArea| {
            area.close(dot(&area.integral, &z));
            let high = area.high * (1.0 + ROUNDING) + tail(&area, &z);
            let lower = area.low * (1.0 - ROUNDING) / self.sigma;
            PeakGain { lower, upper: high / self.sigma }
        };
        areas.into_iter().map(close).collect()
    }

    /// One step, or a half of one.
    fn over(&self, area: &mut BoundedArea, (start, end): (&Z, &Z), halvings: usize) {
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
    /// `f = ‖E‖` has `f'' ≥ −‖E''‖`: middles of steps less `h³/24 sup‖E''‖` from below, chords and
    /// `h³/12 sup‖E''‖` from above; entry by entry `|E(t+τ)| ≤ e^{|A|τ}|E(t)|`.
    pub(crate) fn norm_in_ladder_units(&self) -> PeakGain {
        let n = self.len();
        let a = companion(&self.kappa);
        let mut units = [0.0; MOST];
        for (i, unit) in units.iter_mut().enumerate().take(n) {
            *unit = self.unit(i);
        }
        let size = |e: &SquareOfFree| {
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
        let bounded = |e: &SquareOfFree| size(&product(&growth, &absolute(e)));
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
struct BoundedArea {
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

impl BoundedArea {
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

fn companion(kappa: &[f64]) -> SquareOfFree {
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
fn series(x: &SquareOfFree, h: f64) -> SquareOfFree {
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

const UNIT: SquareOfFree = {
    let mut unit = [[0.0; MOST]; MOST];
    let mut i = 0;
    while i < MOST {
        unit[i][i] = 1.0;
        i += 1;
    }
    unit
};

fn product(x: &SquareOfFree, y: &SquareOfFree) -> SquareOfFree {
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

fn absolute(x: &SquareOfFree) -> SquareOfFree {
    x.map(|row| row.map(f64::abs))
}

fn apply(x: &SquareOfFree, z: &[f64; MOST]) -> [f64; MOST] {
    x.map(|row| dot(&row, z))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn most(z: &[f64]) -> f64 {
    z.iter().map(|value| value.abs()).largest()
}

/// `‖X‖_∞` of its first `n` rows and columns.
fn rows(x: &SquareOfFree, n: usize) -> f64 {
    let sums = x.iter().take(n).map(|row| row.iter().take(n).map(|v| v.abs()).sum::<f64>());
    let most = sums.largest();
    if most.is_nan() { f64::INFINITY } else { most }
}

#[cfg(test)]
mod tests {
    use super::{Free, MOST, Z, apply, dot};
    use crate::{Refutation, UnitLaw};

    fn laws() -> [UnitLaw; 3] {
        [
            UnitLaw { kp: 400.0, kd: 20.0, a: vec![60.0] },
            UnitLaw { kp: 100.0, kd: 30.0, a: vec![6400.0, 130.0] },
            UnitLaw { kp: 90.0, kd: 25.0, a: vec![27e3, 2700.0, 90.0] },
        ]
    }

    /// The loop's own derivative: `z_i' = z_{i+1}`, the last from the characteristic polynomial.
    fn slope(free: &Free, z: &Z) -> Z {
        let n = free.len();
        let mut out = [0.0; MOST];
        out[..n - 1].copy_from_slice(&z[1..n]);
        out[n - 1] = -dot(&free.kappa, &z[..n]);
        out
    }

    /// Runge and Kutta's step.
    fn stepped(free: &Free, z: &Z, h: f64) -> Z {
        let add = |k: &Z, share: f64| core::array::from_fn(|i| z[i] + share * h * k[i]);
        let k1 = slope(free, z);
        let k2 = slope(free, &add(&k1, 0.5));
        let k3 = slope(free, &add(&k2, 0.5));
        let k4 = slope(free, &add(&k3, 1.0));
        core::array::from_fn(|i| z[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    #[test]
    fn areas_are_those_of_the_loop_let_go() -> Result<(), Refutation> {
        for law in laws() {
            for mu in [0.9, 1.3] {
                let free = Free::new("", &law, mu)?;
                let n = free.len();
                // σ^n = K_p a_0/μ.
                let sigma = (law.kp * law.a[0] / mu).powf(1.0 / n as f64);
                assert!((free.sigma - sigma).abs() < 1e-12 * sigma && n == law.order() + 2);
                let rows: Vec<Vec<f64>> = (0..4_u8)
                    .map(|turn| {
                        let entry = |i: usize| (1.7 * f64::from(turn) + 2.3 * i as f64).sin();
                        (0..n).map(entry).collect()
                    })
                    .collect();
                let mut z = [0.0; MOST];
                z[n - 1] = 1.0;
                let (h, mut sums) = (5e-4, [0.0; 4]);
                for _ in 0..400_000 {
                    let next = stepped(&free, &z, h);
                    for (sum, c) in sums.iter_mut().zip(&rows) {
                        let (a, b) = (dot(c, &z[..n]), dot(c, &next[..n]));
                        *sum += h * super::super::integral::of_line(a, b);
                    }
                    z = next;
                    if z.iter().all(|value| value.abs() < 1e-14) {
                        break;
                    }
                }
                for (gain, sum) in free.areas(&rows).iter().zip(sums) {
                    let own = sum / sigma;
                    assert!((gain.lower - own).abs() < 2e-6 * own, "{gain:?} {own} {law:?}");
                    assert!((gain.upper - own).abs() < 2e-6 * own, "{gain:?} {own} {law:?}");
                    let room = (gain.upper - gain.lower) / gain.upper;
                    assert!((1e-9..1e-7).contains(&room), "{room}");
                }
            }
        }
        Ok(())
    }

    #[test]
    fn steps_and_their_halves_are_the_loop_s() -> Result<(), Refutation> {
        for law in laws() {
            let free = Free::new("", &law, 1.0)?;
            let n = free.len();
            let mut z = [0.0; MOST];
            for (i, value) in z.iter_mut().enumerate().take(n) {
                *value = 0.3 + (i as f64).sin();
            }
            for (k, power) in free.powers.iter().enumerate().take(4) {
                let h = free.step / f64::from(1_u32 << k);
                let (own, want) = (apply(power, &z), stepped(&free, &z, h));
                assert!((0..n).all(|i| (own[i] - want[i]).abs() < 1e-9), "{k} {law:?}");
            }
            // ∫cᵀz is dᵀz, so dᵀ z' = cᵀz.
            let c: Vec<f64> = (0..n).map(|i| 1.0 - 0.4 * i as f64).collect();
            let (d, there) = (free.integral(&c), slope(&free, &z));
            assert!((dot(&d, &there[..n]) - dot(&c, &z[..n])).abs() < 1e-12);
            assert!((dot(&free.times_a(&c), &z[..n]) - dot(&c, &there[..n])).abs() < 1e-12);
            // The part of ë that is no impulse, and what a unit of each signal is.
            let scale = (0..n).map(|i| (i + 1..n).fold(free.unit(i), |unit, _| unit * free.sigma));
            assert!(scale.into_iter().all(|own| (own - 1.0).abs() < 1e-12));
        }
        Ok(())
    }

    #[test]
    fn a_loop_that_does_not_decay_has_no_areas() {
        // m = 1: (a + K_d)(K_p + aK_d) > μ a K_p, by Routh.
        let law = UnitLaw { kp: 400.0, kd: 20.0, a: vec![60.0] };
        let most = 80.0 * (400.0 + 1200.0) / (60.0 * 400.0);
        assert!(
            Free::new("", &law, 0.99 * most).is_ok() && Free::new("", &law, 1.01 * most).is_err()
        );
        for mu in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Free::new("", &law, mu).is_err(), "{mu}");
        }
    }

    #[test]
    fn the_norm_s_integral_is_a_sum_of_many_steps() -> Result<(), Refutation> {
        let law = &laws()[0];
        let free = Free::new("", law, 1.0)?;
        let n = free.len();
        // Columns of e^{At}, each signal in its own unit.
        let mut columns: Vec<Z> =
            (0..n).map(|j| core::array::from_fn(|i| f64::from(u8::from(i == j)))).collect();
        let size = |columns: &[Z]| {
            let mut sum = 0.0;
            for (j, column) in columns.iter().enumerate() {
                for (i, value) in column.iter().enumerate().take(n) {
                    sum += (value * free.unit(i) / free.unit(j)).powi(2);
                }
            }
            f64::sqrt(sum)
        };
        let (h, mut sum) = (2e-3, 0.0);
        let mut before = size(&columns);
        for _ in 0..200_000 {
            for column in &mut columns {
                *column = stepped(&free, column, h);
            }
            let after = size(&columns);
            sum += 0.5 * h * (before + after);
            before = after;
            if before < 1e-9 {
                break;
            }
        }
        let own = free.norm_in_ladder_units();
        let want = sum / free.sigma;
        assert!((own.lower - want).abs() < 1e-3 * want && (own.upper - want).abs() < 1e-3 * want);
        assert!(own.lower < own.upper);
        Ok(())
    }
}
