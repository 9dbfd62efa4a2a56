//! The paper's own recipe for gains: minimum values from the largest errors allowed (section V).

use nalgebra::{DMatrix, DVector};
use thiserror::Error;

use crate::claims::law::{Refutation, UnitLaw, agrees, holds};
use crate::claims::matrix::dot;
use crate::claims::times::estimator;
use crate::claims::weights::q_diagonal;

const CLAIM: &str = "minimum gains";

/// Number of points around the first one at which Newton's method starts.
const STARTS: usize = 400;

/// Distance in the logarithms of the gains below which two roots are one.
const SAME_ROOT: f64 = 1e-6;

/// Least singular value of the Jacobian (relative residuals by logarithms of gains) at a root.
const LEAST_SLOPE: f64 = 1e-6;

/// Limits on the errors, and size of the unknown dynamics.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorLimits {
    /// `φ_max` at unit inertia \[rad/s²\].
    pub phi_max: f64,
    /// Largest `(∫…∫e, …, ∫e, e, ė)`: `m + 2` positive numbers.
    pub x_max: Vec<f64>,
}

/// Treatment of `xᵀSBBᵀSx`, which the paper ignores in its columns (A) and includes in (B).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feedback {
    /// `½ Q x > SB φ_max`.
    Ignored,
    /// `½ (Q + (2a_{m−1} − K̃) SBBᵀS) x > SB φ_max`, with the least `a_{m−1} = K̃` (γ → ∞).
    Included,
}

/// The gains at which every row of (44) is an equality.
#[derive(Debug, Clone, PartialEq)]
pub struct MinimalGains {
    /// `K̃` \[1/s\].
    pub k_tilde: f64,
    /// `K_p` \[1/s²\].
    pub kp: f64,
    /// `K_d` \[1/s\].
    pub kd: f64,
    /// `b_0 … b_{m−2}`.
    pub b: Vec<f64>,
    /// Row that produced each value, in the order above.
    pub from: Vec<String>,
}

/// Why there are no minimum gains.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PaperError {
    /// A limit is not a positive number.
    #[error("limit {index} is {value}; it must be positive")]
    Limit {
        /// Index of the limit: 0 is `φ_max`, then the states.
        index: usize,
        /// Value of the limit.
        value: f64,
    },
    /// Order out of range.
    #[error("{states} limits given; an estimator of order 1 to 4 has 3 to 6")]
    Order {
        /// Number of limits.
        states: usize,
    },
    /// No gains keep every limit by (40).
    #[error("no K̃ up to 1e9 1/s keeps every limit by (40), whatever K_p, K_d and b_i")]
    NoneBy40,
    /// Newton's iteration did not end at positive gains.
    #[error("Newton's method stops at a relative residual of {residual:.1e}")]
    NoSolution {
        /// Largest relative residual of a row.
        residual: f64,
    },
}

impl ErrorLimits {
    pub(crate) fn check(&self) -> Result<usize, PaperError> {
        let states = self.x_max.len();
        if !(3..=6).contains(&states) {
            return Err(PaperError::Order { states });
        }
        let all = [self.phi_max].into_iter().chain(self.x_max.iter().copied());
        match all.enumerate().find(|(_, v)| !(v.is_finite() && *v > 0.0)) {
            Some((index, value)) => Err(PaperError::Limit { index, value }),
            None => Ok(states - 2),
        }
    }
}

impl MinimalGains {
    /// (44) solved for m = 1, with the sign of `c` that solves it.
    ///
    /// ```text
    /// K̃ = 2φ_max/ė_max,   K_p = 2φ_max/(K̃ ∫e_max),   K_d = c + √(c² + 2K_p),   c = φ_max/(K̃ e_max)
    /// ```
    ///
    /// # Errors
    ///
    /// [`PaperError`], for limits that are not three positive numbers.
    pub fn first_order(limits: &ErrorLimits) -> Result<Self, PaperError> {
        limits.check()?;
        let [integral, e, de] = limits.x_max[..] else {
            return Err(PaperError::Order { states: limits.x_max.len() });
        };
        let phi = limits.phi_max;
        let k_tilde = 2.0 * phi / de;
        let kp = 2.0 * phi / (k_tilde * integral);
        let c = phi / (k_tilde * e);
        let kd = c + (c * c + 2.0 * kp).sqrt();
        let from = ["row 3, ė: K̃", "row 1, ∫e: K_p", "row 2, e: K_d"].map(str::to_owned).to_vec();
        Ok(Self { k_tilde, kp, kd, b: Vec::new(), from })
    }

    /// The root of least `K̃` of [`MinimalGains::roots`].
    ///
    /// # Errors
    ///
    /// [`PaperError`], for limits that make no sense, or without a solution in positive gains.
    pub fn newton(limits: &ErrorLimits, feedback: Feedback) -> Result<Self, PaperError> {
        let mut roots = Self::roots(limits, feedback)?;
        Ok(roots.swap_remove(0))
    }

    /// Every row of (44) as an equality, any order: all positive gains that Newton's method in the logarithms of
    /// the gains reaches, by increasing `K̃`. At least one.
    ///
    /// It starts at `D(s)g(s) = (s + ω)^{m+1}`, `ω = ė_max/e_max`, and at 400 points spread evenly up to `e^{±6}`
    /// around it. m = 1 has one root in closed form; nothing proves that no other exists for m ≥ 2. Left out are gains
    /// that the rows hardly determine (least singular value of the Jacobian below 1e-6).
    ///
    /// # Errors
    ///
    /// [`PaperError`], for limits that make no sense, or without a solution in positive gains.
    pub fn roots(limits: &ErrorLimits, feedback: Feedback) -> Result<Vec<Self>, PaperError> {
        let m = limits.check()?;
        let center = start(limits, m);
        let (mut roots, mut nearest) = (Vec::<DVector<f64>>::new(), f64::INFINITY);
        for k in 0..=STARTS {
            let (y, residual) = root_from(&center + spread(k, m + 2), limits, feedback);
            nearest = nearest.min(residual);
            let new = roots.iter().all(|root| (root - &y).amax() > SAME_ROOT);
            let solves = || gains(&y, feedback).verify(limits, feedback).is_ok();
            if new && solves() && is_finite_root(&y, limits, feedback) {
                roots.push(y);
            }
        }
        if roots.is_empty() {
            return Err(PaperError::NoSolution { residual: nearest });
        }
        roots.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let label = |mut gains: Self| {
            if roots.len() > 1 {
                let of = format!("{}, the least K̃ of {} roots", gains.from[0], roots.len());
                gains.from.fill(of);
            }
            gains
        };
        Ok(roots.iter().map(|y| label(gains(y, feedback))).collect())
    }

    /// The law with these gains, with `a_{m−1} = K̃` (γ → ∞).
    pub fn law(&self) -> UnitLaw {
        let a = self.b.iter().chain([&1.0]).map(|b_i| b_i * self.k_tilde).collect();
        UnitLaw { kp: self.kp, kd: self.kd, a }
    }

    /// Every row of (44) is an equality to 1e-9.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the row.
    pub fn verify(&self, limits: &ErrorLimits, feedback: Feedback) -> Result<(), Refutation> {
        let states = self.b.len() + 3;
        let right = limits.x_max.len();
        holds(CLAIM, "m + 2 limits", right as f64, states as f64, right == states)?;
        for (i, (left, right)) in rows(self, limits, feedback).into_iter().enumerate() {
            agrees(CLAIM, &format!("row {} of (44)", i + 1), left, right, 1e-9)?;
        }
        Ok(())
    }
}

/// Both sides of each row: `Qx (+ (2a_{m−1} − K̃) SB BᵀSx)` and `2SB φ_max`.
fn rows(gains: &MinimalGains, limits: &ErrorLimits, feedback: Feedback) -> Vec<(f64, f64)> {
    let law = gains.law();
    let (q, x) = (q_diagonal(&law, gains.k_tilde), &limits.x_max);
    let sb: Vec<f64> = law.k().iter().map(|k_i| k_i / law.a_top()).collect();
    let pull = match feedback {
        Feedback::Ignored => 0.0,
        Feedback::Included => gains.k_tilde * dot(&sb, x),
    };
    (0..x.len()).map(|i| (q[i] * x[i] + pull * sb[i], 2.0 * sb[i] * limits.phi_max)).collect()
}

fn residual(y: &DVector<f64>, limits: &ErrorLimits, feedback: Feedback) -> DVector<f64> {
    let relative = |(left, right): (f64, f64)| left / right - 1.0;
    let all = rows(&gains(y, feedback), limits, feedback).into_iter().map(relative);
    DVector::from_iterator(y.len(), all)
}

fn jacobian(y: &DVector<f64>, limits: &ErrorLimits, feedback: Feedback) -> DMatrix<f64> {
    let h = 1e-6;
    let column = |j: usize| {
        let (mut up, mut down) = (y.clone(), y.clone());
        up[j] += h;
        down[j] -= h;
        (residual(&up, limits, feedback) - residual(&down, limits, feedback)) / (2.0 * h)
    };
    DMatrix::from_columns(&(0..y.len()).map(column).collect::<Vec<_>>())
}

/// Newton's method with halved steps from `y`, and the largest relative residual where it ends.
fn root_from(mut y: DVector<f64>, limits: &ErrorLimits, feedback: Feedback) -> (DVector<f64>, f64) {
    let mut now = residual(&y, limits, feedback);
    for _ in 0..200 {
        if now.amax() < 1e-12 {
            break;
        }
        let Some(step) = jacobian(&y, limits, feedback).lu().solve(&now) else { break };
        let shares = (0..34).map(|k| 0.5_f64.powi(k));
        let mut next = shares.map(|share| &y - share * &step);
        let better = next.find_map(|next| {
            let there = residual(&next, limits, feedback);
            (there.norm() < now.norm()).then_some((next, there))
        });
        let Some(better) = better else { break };
        (y, now) = better;
    }
    let largest = now.amax();
    (y, largest)
}

/// Returns true if the rows determine every gain. Towards `K̃ → 0` and `K_p → ∞` their residual falls to zero as
/// well, and no root is there.
fn is_finite_root(y: &DVector<f64>, limits: &ErrorLimits, feedback: Feedback) -> bool {
    jacobian(y, limits, feedback).singular_values().min() > LEAST_SLOPE
}

/// Point `k` of an evenly spread sequence in `[−6, 6]^count` (Kronecker's, by roots of primes); 0 is the middle.
fn spread(k: usize, count: usize) -> DVector<f64> {
    let primes = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0];
    let along = |prime: f64| 12.0 * ((0.5 + k as f64 * prime.sqrt()).fract() - 0.5);
    DVector::from_iterator(count, primes.into_iter().take(count).map(along))
}

/// `y = ln (K̃, K_p, K_d, b_0 … b_{m−2})`.
fn start(limits: &ErrorLimits, m: usize) -> DVector<f64> {
    let x = &limits.x_max;
    let omega = x[m + 1] / x[m];
    let b = estimator(m - 1, omega * omega, 1.0);
    let k_tilde = 2.0 * limits.phi_max / x[m + 1] + 2.0 * b.last().copied().unwrap_or(0.0);
    let head = [k_tilde, omega * omega, 2.0 * omega];
    DVector::from_iterator(m + 2, head.into_iter().chain(b).map(libm::log))
}

fn gains(y: &DVector<f64>, feedback: Feedback) -> MinimalGains {
    let term = match feedback {
        Feedback::Ignored => "(44), Newton",
        Feedback::Included => "(44) with xᵀSBBᵀSx, Newton",
    };
    MinimalGains {
        k_tilde: libm::exp(y[0]),
        kp: libm::exp(y[1]),
        kd: libm::exp(y[2]),
        b: y.iter().skip(3).map(|v| libm::exp(*v)).collect(),
        from: vec![term.to_owned(); y.len()],
    }
}
