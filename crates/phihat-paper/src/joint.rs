//! One joint under the paper's law, exactly: the linear loop and the signal that drives it, by matrix exponentials.
//!
//! Nothing here knows the sampled controller or the claims about it: it is what they are compared with.

use phihat_design::claims::UnitLaw;
use phihat_design::claims::matrix::{RationalMatrix, apply, dot, exponential, norm_inf, product};

/// Form of the estimator, one of the paper's two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PaperForm {
    /// (8) as a differential equation for `φ̂`; state `(e, ė, φ̂, …)`, `m + 2` long.
    Estimator,
    /// (16), feedback of `x = (∫…∫e, …, ∫e, e, ė)`.
    Ladder,
}

/// The unknown dynamics `φ` as a function of time.
#[derive(Debug, Clone)]
pub(crate) enum PhiCourse {
    /// Solution of `ẇ = F w`, `φ = Σ w` over the marked entries.
    Generated { f: RationalMatrix, sum: Vec<f64>, start: Vec<f64> },
    /// Values at the steps, joined by straight lines; the last one stays.
    Joined(Vec<f64>),
}

impl PhiCourse {
    /// `Σ_k c_k t^k/k!`.
    pub(crate) fn polynomial(coefficients: &[f64]) -> Self {
        let n = coefficients.len();
        let mut f = zeros(n, n);
        for i in 1..n {
            f[i - 1][i] = 1.0;
        }
        let mut sum = vec![0.0; n];
        sum[0] = 1.0;
        Self::Generated { f, sum, start: coefficients.to_vec() }
    }

    /// `Σ amplitude sin(ω t + phase)`; `ω = 0` with a phase of π/2 is a constant.
    pub(crate) fn sines(terms: &[(f64, f64, f64)]) -> Self {
        let n = 2 * terms.len();
        let (mut f, mut sum, mut start) = (zeros(n, n), vec![0.0; n], vec![0.0; n]);
        for (k, (amplitude, omega, phase)) in terms.iter().enumerate() {
            f[2 * k][2 * k + 1] = *omega;
            f[2 * k + 1][2 * k] = -omega;
            sum[2 * k] = 1.0;
            start[2 * k] = amplitude * phase.sin();
            start[2 * k + 1] = amplitude * phase.cos();
        }
        Self::Generated { f, sum, start }
    }
}

/// One instant.
#[derive(Debug, Clone)]
pub(crate) struct Instant {
    /// Time \[s\].
    pub(crate) t: f64,
    /// `e` \[rad\].
    pub(crate) e: f64,
    /// `ė` \[rad/s\].
    pub(crate) de: f64,
    /// `φ` \[N·m\] at `M̄ = 1`.
    pub(crate) phi: f64,
    /// `φ̂`.
    pub(crate) phi_hat: f64,
    /// The state of the form.
    pub(crate) x: Vec<f64>,
}

/// `ẋ = A x + b φ`, and the row that gives `φ̂`.
pub(crate) fn system(law: &UnitLaw, form: PaperForm) -> (RationalMatrix, Vec<f64>, Vec<f64>) {
    let (m, n) = (law.order(), law.order() + 2);
    let mut b = vec![0.0; n];
    if form == PaperForm::Ladder {
        b[n - 1] = -1.0;
        return (law.closed_loop(), b, law.k().iter().map(|k| -k).collect());
    }
    let (mut a, mut row) = (zeros(n, n), vec![0.0; n]);
    a[0][1] = 1.0;
    (a[1][0], a[1][1], a[1][2], b[1]) = (-law.kp, -law.kd, 1.0, -1.0);
    for j in 0..m {
        // dφ̂_j/dt = φ̂_{j+1} + a_{m−1−j} (φ − φ̂_0)
        let gain = law.a[m - 1 - j];
        a[2 + j][2] -= gain;
        b[2 + j] = gain;
        if j + 1 < m {
            a[2 + j][3 + j] += 1.0;
        }
    }
    row[2] = 1.0;
    (a, b, row)
}

/// The loop from `start`, at `steps + 1` instants `dt` \[s\] apart, the first at 0.
pub(crate) fn run(
    law: &UnitLaw,
    form: PaperForm,
    start: &[f64],
    phi: &PhiCourse,
    (dt, steps): (f64, usize),
) -> Vec<Instant> {
    let (a, b, row) = system(law, form);
    let n = a.len();
    let (f, sum) = match phi {
        PhiCourse::Generated { f, sum, .. } => (f.clone(), sum.clone()),
        PhiCourse::Joined(_) => (vec![vec![0.0, 1.0], vec![0.0, 0.0]], vec![1.0, 0.0]),
    };
    let whole = beside(&a, &outer(&b, &sum), &f);
    let per_step = flow(&whole, dt);
    let at = if form == PaperForm::Ladder { n - 2 } else { 0 };
    let mut z = start.to_vec();
    z.resize(n, 0.0);
    z.extend(match phi {
        PhiCourse::Generated { start, .. } => start.clone(),
        PhiCourse::Joined(_) => vec![0.0; 2],
    });
    let mut out = Vec::with_capacity(steps + 1);
    for k in 0..=steps {
        if let PhiCourse::Joined(values) = phi {
            let value = |k: usize| values.get(k).or(values.last()).copied().unwrap_or(0.0);
            (z[n], z[n + 1]) = (value(k), (value(k + 1) - value(k)) / dt);
        }
        let (x, w) = z.split_at(n);
        let (e, de, phi_hat) = (x[at], x[at + 1], dot(&row, x));
        out.push(Instant { t: k as f64 * dt, e, de, phi: dot(&sum, w), phi_hat, x: x.to_vec() });
        z = apply(&per_step, &z);
    }
    out
}

/// `e^{At}`, in coordinates in which no entry outweighs the rest.
pub(crate) fn flow(a: &RationalMatrix, t: f64) -> RationalMatrix {
    let n = a.len();
    let mut scale = vec![1.0_f64; n];
    for _ in 0..20 {
        for i in 0..n {
            let others = || (0..n).filter(|j| *j != i);
            let row: f64 = others().map(|j| (a[i][j] * scale[j] / scale[i]).abs()).sum();
            let column: f64 = others().map(|j| (a[j][i] * scale[i] / scale[j]).abs()).sum();
            if row > 0.0 && column > 0.0 {
                scale[i] *= (row / column).sqrt();
            }
        }
    }
    let mut balanced = a.clone();
    for (i, row) in balanced.iter_mut().enumerate() {
        for (v, s) in row.iter_mut().zip(&scale) {
            *v *= s / scale[i] * t;
        }
    }
    let halvings = (0..200).find(|k| norm_inf(&balanced) * 0.5_f64.powi(*k) <= 0.5).unwrap_or(0);
    for v in balanced.iter_mut().flatten() {
        *v *= 0.5_f64.powi(halvings);
    }
    let mut e = exponential(&balanced);
    for _ in 0..halvings {
        e = product(&e, &e);
    }
    for (i, row) in e.iter_mut().enumerate() {
        for (v, s) in row.iter_mut().zip(&scale) {
            *v *= scale[i] / s;
        }
    }
    e
}

/// A matrix of zeros.
pub(crate) fn zeros(rows: usize, columns: usize) -> RationalMatrix {
    vec![vec![0.0; columns]; rows]
}

/// `u vᵀ`.
pub(crate) fn outer(u: &[f64], v: &[f64]) -> RationalMatrix {
    u.iter().map(|a| v.iter().map(|b| a * b).collect()).collect()
}

/// `[A, C; 0, F]`.
fn beside(a: &RationalMatrix, c: &RationalMatrix, f: &RationalMatrix) -> RationalMatrix {
    let top = a.iter().zip(c).map(|(a, c)| a.iter().chain(c).copied().collect());
    let low = f.iter().map(|f| vec![0.0; a.len()].into_iter().chain(f.iter().copied()).collect());
    top.chain(low).collect()
}

/// The largest of some sizes; NaN where one is.
pub(crate) fn largest(sizes: impl IntoIterator<Item = f64>) -> f64 {
    sizes.into_iter().fold(
        0.0,
        |most: f64, size| if size.abs() > most || size.is_nan() { size.abs() } else { most },
    )
}

/// Euclidean length.
pub(crate) fn length(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}
