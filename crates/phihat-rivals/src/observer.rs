//! An observer of position by its poles: what one radian off its expectation corrects.

/// A pole of the observer, or two, in continuous time \[rad/s\].
#[derive(Debug, Clone, Copy)]
pub(crate) enum ObserverPoles {
    /// `s = −w`
    Real(f64),
    /// `s² + 2ζws + w²`: `[w, ζ]`
    Pair([f64; 2]),
}

impl ObserverPoles {
    /// Coefficients of the factor with the sampled poles `e^{sT}`, in `δ = z − 1`, from `δ⁰`, without the leading 1.
    fn sampled(self, period: f64) -> Vec<f64> {
        match self {
            Self::Real(w) => vec![-(-w * period).exp_m1()],
            Self::Pair([w, zeta]) if zeta >= 1.0 => {
                let apart = (zeta * zeta - 1.0).sqrt();
                let [a, b] =
                    [zeta - apart, zeta + apart].map(|times| -(-w * times * period).exp_m1());
                vec![a * b, a + b]
            }
            Self::Pair([w, zeta]) => {
                let size = (-zeta * w * period).exp();
                let turn = w * period * (1.0 - zeta * zeta).sqrt();
                let (re, im) = (1.0 - size * turn.cos(), size * turn.sin());
                vec![re * re + im * im, 2.0 * re]
            }
        }
    }
}

/// `ℓ` of the law from positions: with it the errors of `ê, ė̂, φ̂/M̄, φ̂'/M̄, …` die out with these poles,
/// sampled every `period` \[s\]. As many entries as poles; in `1, 1/s, 1/s², …`.
///
/// # Method
///
/// In units of `T` the observer's `F` is `1 + N`, `N` nilpotent. With `p(δ) = Σ c_j δ^j` the wanted polynomial,
///
/// ```text
/// det(z − F + ℓ C F) = δ^n (1 + C F (δ − N)⁻¹ ℓ)   ⟹   C F N^j ℓ = c_{n−1−j},   j = 0 … n − 1
/// ```
///
/// and the first `j` entries of `C F N^j` are zero: solved from the last row upwards.
pub(crate) fn correction(poles: &[ObserverPoles], period: f64) -> Vec<f64> {
    let mut wanted = vec![1.0];
    for pole in poles {
        let mut factor = pole.sampled(period);
        factor.push(1.0);
        let mut product = vec![0.0; wanted.len() + factor.len() - 1];
        for (i, a) in wanted.iter().enumerate() {
            for (j, b) in factor.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        wanted = product;
    }
    let n = wanted.len() - 1;
    let mut rows = vec![seen(n)];
    while rows.len() < n {
        let next = shifted(&rows[rows.len() - 1]);
        rows.push(next);
    }
    let mut l = vec![0.0; n];
    for (j, row) in rows.iter().enumerate().rev() {
        let known: f64 = (j + 1..n).map(|i| row[i] * l[i]).sum();
        l[j] = (wanted[n - 1 - j] - known) / row[j];
    }
    let mut unit = 1.0;
    for entry in &mut l {
        *entry /= unit;
        unit *= period;
    }
    l
}

/// `C F`: the position a sample on; `φ̂` is the mean over the sample.
fn seen(n: usize) -> Vec<f64> {
    let mut row = vec![1.0, 1.0, -0.5];
    row.resize(n, 0.0);
    row
}

/// `row · N`: `e` takes up `ė − φ/2`, `ė` takes up `−φ`, and each derivative of `φ` the next.
fn shifted(row: &[f64]) -> Vec<f64> {
    let at = |i: usize| row.get(i).copied().unwrap_or(0.0);
    let entry = |i: usize| match i {
        0 => 0.0,
        1 => at(0),
        2 => -0.5 * at(0) - at(1),
        _ => at(i - 1),
    };
    (0..row.len()).map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::{ObserverPoles, correction};
    use nalgebra::DMatrix;

    /// `(1 − ℓC)F` has the sampled poles: by eigenvalues of the matrix itself, in seconds.
    #[test]
    fn the_error_of_the_estimate_has_the_poles_that_were_asked_for() {
        let t = 1e-3_f64;
        for poles in [
            vec![ObserverPoles::Real(150.0), ObserverPoles::Pair([850.0, 0.27])],
            vec![ObserverPoles::Real(40.0), ObserverPoles::Pair([300.0, 1.8])],
            vec![
                ObserverPoles::Real(150.0),
                ObserverPoles::Pair([850.0, 0.4]),
                ObserverPoles::Real(12.0),
            ],
        ] {
            let mut wanted: Vec<f64> = Vec::new();
            for pole in &poles {
                match *pole {
                    ObserverPoles::Real(w) => wanted.push((-w * t).exp()),
                    // The product of a pair's poles is enough: each is it over the other.
                    ObserverPoles::Pair([w, zeta]) if zeta < 1.0 => {
                        wanted.extend([(-zeta * w * t).exp(); 2]);
                    }
                    ObserverPoles::Pair([w, zeta]) => {
                        let apart = (zeta * zeta - 1.0).sqrt();
                        let pair = [zeta - apart, zeta + apart].map(|x| (-w * x * t).exp());
                        wanted.extend(pair);
                    }
                }
            }
            let n = wanted.len();
            let mut f = DMatrix::<f64>::identity(n, n);
            (f[(0, 1)], f[(0, 2)], f[(1, 2)]) = (t, -0.5 * t * t, -t);
            for i in 3..n {
                f[(i - 1, i)] = t;
            }
            let l = correction(&poles, t);
            let mut map = f.clone();
            for i in 0..n {
                for j in 0..n {
                    map[(i, j)] -= l[i] * f[(0, j)];
                }
            }
            let mut found: Vec<f64> = map.complex_eigenvalues().iter().map(|z| z.norm()).collect();
            found.sort_by(f64::total_cmp);
            wanted.sort_by(f64::total_cmp);
            for (found, wanted) in found.iter().zip(&wanted) {
                assert!((found - wanted).abs() < 1e-7, "{found} for {wanted}");
            }
        }
    }

    /// Three equal poles: the closed form of the literature.
    #[test]
    fn a_triple_pole_is_the_closed_form() {
        let (w, t) = (150.0_f64, 1e-3);
        let l = correction(&[ObserverPoles::Real(w), ObserverPoles::Pair([w, 1.0])], t);
        let beta = (-w * t).exp();
        let rest = 1.0 - beta;
        let closed =
            [1.0 - beta.powi(3), 1.5 / t * rest * rest * (1.0 + beta), -rest.powi(3) / (t * t)];
        for (found, closed) in l.iter().zip(closed) {
            assert!((found / closed - 1.0).abs() < 1e-9, "{found} for {closed}");
        }
    }
}
