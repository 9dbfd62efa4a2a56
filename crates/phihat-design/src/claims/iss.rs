//! Input-to-state stability of the closed loop, with explicit constants.

pub use phihat_certificate::Iss;
use phihat_certificate::PeakGain;

use crate::claims::law::{Refutation, UnitLaw, holds};
use crate::claims::matrix::{
    RationalMatrix, failing_pivot, identity, is_symmetric, largest_shift, norm_frobenius, product,
    sum, transpose,
};
use crate::claims::optimality::{Certified, last_column};
use crate::claims::response::Response;

const CLAIM: &str = "input-to-state stability";

/// Finding [`Iss`].
pub trait FindIss: Sized {
    /// Finds the claim with the Lyapunov function of a certificate of optimality: the paper's way.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality that cannot be met.
    fn of(law: &UnitLaw, certified: &Certified) -> Result<Self, Refutation>;

    /// Finds the claim without a certificate of optimality: with `W = I` in the loop's own time, so that any stable law
    /// has it.
    ///
    /// # Errors
    ///
    /// [`Refutation`], when the loop is not stable.
    fn of_loop(law: &UnitLaw) -> Result<Self, Refutation>;
}

impl FindIss for Iss {
    fn of(law: &UnitLaw, certified: &Certified) -> Result<Self, Refutation> {
        with(law, certified.s.clone(), Some(certified.k_tilde))
    }

    fn of_loop(law: &UnitLaw) -> Result<Self, Refutation> {
        let response = Response::new(law, 1.0)?;
        let n = response.size();
        let scale: Vec<f64> =
            (0..n).map(|i| (response.ladder_scale(i) / response.ladder_scale(0)).recip()).collect();
        let w: RationalMatrix = (0..n)
            .map(|i| (0..n).map(|j| if i == j { scale[i] * scale[i] } else { 0.0 }).collect())
            .collect();
        let s = lyapunov_solution(&law.closed_loop(), &w, &scale).unwrap_or_default();
        with(law, s, None)
    }
}

fn with(law: &UnitLaw, s: RationalMatrix, k_tilde: Option<f64>) -> Result<Iss, Refutation> {
    law.check(CLAIM)?;
    let n = law.order() + 2;
    holds(CLAIM, "S = Sᵀ", s.len() as f64, n as f64, is_symmetric(&s, n))?;
    let w = decrease(law, &s);
    let least = |x: &RationalMatrix, y: &RationalMatrix, name: &str| {
        largest_shift(x, y).ok_or_else(|| {
            let (_, pivot, bound) = failing_pivot(x).unwrap_or((0, f64::NAN, 0.0));
            Refutation {
                claim: CLAIM.to_owned(),
                inequality: name.to_owned(),
                left: pivot,
                right: bound,
            }
        })
    };
    let unit = identity(n);
    let s_min = least(&s, &unit, "S ≻ 0")?;
    let w_min = least(&w, &unit, "W ≻ 0")?;
    let rate = 0.5 * least(&w, &s, "W ≻ 0")?;
    let s_max = norm_frobenius(&s);
    let sb_norm = norm(&last_column(&s));
    let found = Iss {
        k_tilde,
        overshoot: (s_max / s_min).sqrt(),
        s,
        s_min,
        s_max,
        rate,
        w_min,
        sb_norm,
        gamma1: w_min / 4.0,
        gamma2: sb_norm * sb_norm / w_min,
        gain: gain(law)?,
    };
    found.verify(law)?;
    Ok(found)
}

/// `W = −(A−BK)ᵀS − S(A−BK)`, exactly symmetric.
pub fn decrease(law: &UnitLaw, s: &RationalMatrix) -> RationalMatrix {
    let sa = product(s, &law.closed_loop());
    let w = sum(&sa, 1.0, &transpose(&sa));
    w.iter().map(|row| row.iter().map(|v| -v).collect()).collect()
}

fn gain(law: &UnitLaw) -> Result<PeakGain, Refutation> {
    let response = Response::new(law, 1.0)?;
    let frobenius = response.integral_of_ladder_norm();
    let lower = frobenius.lower / (response.size() as f64).sqrt();
    Ok(PeakGain { lower, upper: frobenius.upper })
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Solves `AᵀS + SA = −W` in the unknowns `S_ij`, `i ≤ j`, divided by `scale_i scale_j`.
fn lyapunov_solution(
    a: &RationalMatrix,
    w: &RationalMatrix,
    scale: &[f64],
) -> Option<RationalMatrix> {
    let n = a.len();
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).collect();
    let place = |i: usize, j: usize| pairs.iter().position(|p| *p == (i.min(j), i.max(j)));
    let mut system = nalgebra::DMatrix::<f64>::zeros(pairs.len(), pairs.len());
    let mut right = nalgebra::DVector::<f64>::zeros(pairs.len());
    for (row, &(i, j)) in pairs.iter().enumerate() {
        right[row] = -w[i][j] / (scale[i] * scale[j]);
        for k in 0..n {
            system[(row, place(k, j)?)] += a[k][i] * scale[k] / scale[i];
            system[(row, place(i, k)?)] += a[k][j] * scale[k] / scale[j];
        }
    }
    let solution = system.lu().solve(&right)?;
    // The order of the factors is that of the place, so that both triangles agree to the bit.
    let entry =
        |i: usize, j: usize| Some(solution[place(i, j)?] * (scale[i.min(j)] * scale[i.max(j)]));
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}
