//! Step 1 of the paper's recipe by (40): the least gains that satisfy its bound on the error, and whether it
//! is one.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use phihat_certificate::extremes::Extremes as _;

use crate::claims::law::UnitLaw;
use crate::claims::paper::{ErrorLimits, MinimalGains, PaperError};
use crate::claims::times::estimator_at;
use crate::claims::weights::q_diagonal;
use crate::portable;

/// Largest `K̃` that is looked at \[1/s\].
const K_TILDE_MAX: f64 = 1e9;

/// First and last step of the search along a direction, in logarithms of the gains.
const STEPS: (f64, f64) = (1.0, 1e-4);

/// One entry of `x` at gains that keep (40).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadiusRow {
    /// Largest value allowed.
    pub limit: f64,
    /// `2 (SB)_i φ_max/λ_min`: what (40) says, read per entry.
    pub by_40: f64,
    /// Largest value from rest, at the worst φ: by the area under the impulse response, see [`areas`].
    pub worst: f64,
}

impl RadiusRow {
    /// Returns true if a φ takes the entry beyond (40).
    pub fn refuted(&self) -> bool {
        self.worst > self.by_40
    }
}

/// The least gains by (40), and those with which the limits hold.
///
/// (40) is read per entry of `x`, as limits like (48) and (49) need it, with the least `a_{m−1} = K̃` (γ → ∞)
/// and under the conditions of Theorem 2, `Q ≻ 0`. As printed it bounds no entry: `V̇ < 0` outside of a ball
/// keeps no state in it.
#[derive(Debug, Clone, PartialEq)]
pub struct RadiusGains {
    /// The gains of the least `K̃` at which (40) keeps every limit.
    pub by_40: MinimalGains,
    /// The entries `(∫…∫e, …, e, ė)` at these gains.
    pub rows: Vec<RadiusRow>,
    /// The same with `K̃` raised until the worst φ keeps every limit too; often the same gains.
    pub gains: MinimalGains,
}

impl RadiusGains {
    /// Finds the least `K̃`, and `K_p`, `K_d`, `b` with it, by a search in their logarithms: for `b` all zeros of the
    /// estimator's numerator in one place. The least that was found; no other is proved not to be lower.
    ///
    /// # Errors
    ///
    /// [`PaperError`]: limits that make no sense, or none of the gains keeps (40).
    pub fn of(limits: &ErrorLimits) -> Result<Self, PaperError> {
        let m = limits.check()?;
        let (mut best, mut y) = begin(m, limits);
        let mut step = STEPS.0;
        let directions = directions(y.len());
        for _ in 0..100_000 {
            if step <= STEPS.1 {
                break;
            }
            let trial = |direction: &Vec<f64>| -> (f64, Vec<f64>) {
                let next: Vec<f64> = y.iter().zip(direction).map(|(y, d)| y + step * d).collect();
                (cost(&next, limits), next)
            };
            let least = directions.iter().map(trial).min_by(|a, b| a.0.total_cmp(&b.0));
            match least {
                Some((value, next)) if value < best => (best, y) = (value, next),
                _ => step *= 0.5,
            }
        }
        let by_40 = found(&y, limits).ok_or(PaperError::NoneBy40)?;
        let rows = rows(&by_40, limits);
        let gains = raised(&by_40, limits)?;
        Ok(Self { by_40, rows, gains })
    }
}

/// The best of a coarse grid: `K_p = ω²`, `K_d = 2ω`, zeros about `ω`.
fn begin(m: usize, limits: &ErrorLimits) -> (f64, Vec<f64>) {
    let zeros: &[f64] = if m > 1 { &[-6.0, -4.0, -2.0, 0.0, 2.0] } else { &[0.0] };
    let outer = (-10..=10_i32).map(f64::from);
    let at = |ln_omega: f64, beside: f64| {
        let mut y = vec![2.0 * ln_omega, ln_omega + libm::log(2.0)];
        if m > 1 {
            y.push(ln_omega + beside);
        }
        (cost(&y, limits), y)
    };
    let all = outer.flat_map(|w| zeros.iter().map(move |beside| at(w, *beside)));
    all.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
}

/// Every direction in which each coordinate goes up, down or stays.
fn directions(n: usize) -> Vec<Vec<f64>> {
    let mut all = vec![Vec::new()];
    for _ in 0..n {
        let longer = |d: &Vec<f64>| [-1.0, 0.0, 1.0].map(|e| [d.as_slice(), &[e]].concat());
        all = all.iter().flat_map(longer).collect();
    }
    all.retain(|d| d.iter().any(|e| *e != 0.0));
    all
}

/// `ln K̃`, infinite where nothing keeps (40).
fn cost(y: &[f64], limits: &ErrorLimits) -> f64 {
    found(y, limits).map_or(f64::INFINITY, |gains| libm::log(gains.k_tilde))
}

/// The least `K̃` at given `K_p`, `K_d` and zeros: `λ_min` does not fall while `K̃` rises.
fn found(y: &[f64], limits: &ErrorLimits) -> Option<MinimalGains> {
    let m = limits.x_max.len() - 2;
    let (kp, kd) = (libm::exp(y[0]), libm::exp(y[1]));
    let b = y.get(2).map_or_else(Vec::new, |beta| estimator_at(m - 1, libm::exp(*beta)));
    let at = |k_tilde: f64| MinimalGains {
        k_tilde,
        kp,
        kd,
        b: b.clone(),
        from: vec!["(40) per entry, least K̃".to_owned(); m + 2],
    };
    let keeps = |k_tilde: f64| {
        let gains = at(k_tilde);
        let law = gains.law();
        let positive = q_diagonal(&law, k_tilde).iter().all(|q| *q > 0.0);
        let bounds = positive.then(|| by_40(&law, k_tilde, limits.phi_max));
        bounds.is_some_and(|all| all.iter().zip(&limits.x_max).all(|(x, most)| x <= most))
    };
    if !(kp.is_finite() && kd.is_finite() && keeps(K_TILDE_MAX)) {
        return None;
    }
    let (mut low, mut high) = (libm::log(1e-9), libm::log(K_TILDE_MAX));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if keeps(libm::exp(middle)) { high = middle } else { low = middle }
    }
    Some(at(libm::exp(high)))
}

/// (40) per entry: `2 (SB)_i φ_max/λ_min(Q + (2a_{m−1} − K̃) SBBᵀS)`.
pub fn by_40(law: &UnitLaw, k_tilde: f64, phi_max: f64) -> Vec<f64> {
    let sb: Vec<f64> = law.k().iter().map(|k| k / law.a_top()).collect();
    let q = q_diagonal(law, k_tilde);
    let pull = 2.0 * law.a_top() - k_tilde;
    let matrix = DMatrix::from_fn(sb.len(), sb.len(), |i, j| {
        pull * sb[i] * sb[j] + if i == j { q[i] } else { 0.0 }
    });
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return vec![f64::INFINITY; sb.len()];
    }
    let least = SymmetricEigen::new(matrix).eigenvalues.iter().copied().least();
    let bound = |sb: &f64| if least > 0.0 { 2.0 * sb * phi_max / least } else { f64::INFINITY };
    sb.iter().map(bound).collect()
}

/// Steps between one time and twice that time, in [`areas`].
const PER_OCTAVE: usize = 200;

/// `∫|x_i|` after an impulse of φ at rest, for each entry of `x = (∫…∫e, …, e, ė)`: what a φ of size 1 makes at most.
///
/// By the trapezoidal rule, exact in between, with steps that grow with time: to about a part in a thousand.
/// Infinite where the loop does not settle.
pub fn areas(law: &UnitLaw) -> Vec<f64> {
    let rows = law.closed_loop();
    let n = rows.len();
    let a = DMatrix::from_fn(n, n, |i, j| rows[i][j]);
    let mut step = 1e-3 / a.norm();
    // e^{A·step}, by its series; then squared as the step doubles.
    let small = &a * step;
    let mut term = DMatrix::<f64>::identity(n, n);
    let mut flow = term.clone();
    for k in 1..8_u8 {
        term = portable::product(&term, &small) / f64::from(k);
        flow += &term;
    }
    let mut x = DVector::<f64>::zeros(n);
    x[n - 1] = -1.0;
    let mut sums = vec![0.0; n];
    for octave in 0..400_usize {
        let steps = if octave == 0 { 2 * PER_OCTAVE } else { PER_OCTAVE };
        let mut moved = false;
        for _ in 0..steps {
            let next = &flow * &x;
            for (sum, (now, next)) in sums.iter_mut().zip(x.iter().zip(next.iter())) {
                *sum += 0.5 * step * (now.abs() + next.abs());
                // What an exponential of this size would still add over all the time so far.
                moved |= next.abs() * step * PER_OCTAVE as f64 > 1e-9 * *sum;
            }
            x = next;
        }
        if !moved {
            return sums;
        }
        flow = portable::product(&flow, &flow);
        step *= 2.0;
    }
    vec![f64::INFINITY; n]
}

/// Each entry at given gains.
fn rows(gains: &MinimalGains, limits: &ErrorLimits) -> Vec<RadiusRow> {
    let law = gains.law();
    let by_40 = by_40(&law, gains.k_tilde, limits.phi_max);
    let entries = limits.x_max.iter().zip(by_40).zip(areas(&law));
    let row = |((limit, by_40), area): ((&f64, f64), f64)| RadiusRow {
        limit: *limit,
        by_40,
        worst: area * limits.phi_max,
    };
    entries.map(row).collect()
}

/// The least `K̃` from there on with which no φ exceeds a limit, everything else as it is.
fn raised(gains: &MinimalGains, limits: &ErrorLimits) -> Result<MinimalGains, PaperError> {
    let at = |k_tilde: f64| MinimalGains { k_tilde, ..gains.clone() };
    // A part in a thousand is left for the rule.
    let keeps = |k: f64| rows(&at(k), limits).iter().all(|row| 1.001 * row.worst <= row.limit);
    let (mut low, mut high) = (gains.k_tilde, gains.k_tilde);
    while !keeps(high) {
        (low, high) = (high, 2.0 * high);
        if high > K_TILDE_MAX {
            return Err(PaperError::NoneBy40);
        }
    }
    for _ in 0..60 {
        let middle = (low * high).sqrt();
        if high <= low * (1.0 + 1e-4) {
            break;
        }
        if keeps(middle) { high = middle } else { low = middle }
    }
    Ok(at(high))
}
