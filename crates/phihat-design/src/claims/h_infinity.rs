//! The exact H-infinity norm from φ to the error.

use nalgebra::{DMatrix, Schur};
pub use phihat_certificate::NormH;

use crate::claims::law::{Refutation, UnitLaw};
use crate::claims::polynomial;
use crate::claims::response::Response;

/// Relative distance between the two sides that the search aims at.
const GAP: f64 = 1e-6;

/// Finding a [`NormH`].
pub trait FindNorm: Sized {
    /// Finds the norm by level sets: the imaginary eigenvalues of a Hamiltonian matrix are the
    /// frequencies where `|G|` equals the level (Boyd, Balakrishnan; Bruinsma, Steinbuch).
    ///
    /// # Errors
    ///
    /// [`Refutation`], when the loop is not stable at `μ`, or the result does not survive its check.
    fn of(law: &UnitLaw, mu: f64) -> Result<Self, Refutation>;
}

impl FindNorm for NormH {
    fn of(law: &UnitLaw, mu: f64) -> Result<Self, Refutation> {
        let response = Response::new(law, mu)?;
        let (m, n, sigma) = (law.order(), response.size(), response.sigma);
        let scaled: Vec<f64> = response.last_row().iter().map(|k| -k).chain([1.0]).collect();
        let squared = polynomial::magnitude_squared(&scaled);
        let size = |w: f64| (power(w, m) / polynomial::value(&squared, w)).sqrt();
        let grid = (0..400).map(|k| libm::pow(10.0, f64::from(k) / 50.0 - 4.0));
        let mut best = grid.fold(1.0, |best, w| if size(w) > size(best) { w } else { best });
        for _ in 0..30 {
            let crossings = crossings(&response, m, size(best) * (1.0 + 1e-9));
            let middles = crossings.windows(2).map(|p| (0.5 * (p[0] + p[1])).powi(2));
            let better = middles.fold(best, |b, w| if size(w) > size(b) { w } else { b });
            if size(better) <= size(best) * (1.0 + 1e-10) {
                break;
            }
            best = better;
        }
        let mut unit = 1.0 / mu;
        for _ in m..n {
            unit /= sigma;
        }
        let frequency_rad_s = sigma * best.sqrt();
        let p = polynomial::magnitude_squared(&law.denominator(mu));
        let w = frequency_rad_s * frequency_rad_s;
        let lower = (power(w, m) / polynomial::value(&p, w)).sqrt().min(unit * size(best));
        let mut found = Self { mu, lower: lower * (1.0 - 1e-12), upper: lower, frequency_rad_s };
        for doublings in 0..20 {
            found.upper = lower * (1.0 + GAP * f64::from(1 << doublings));
            if polynomial::is_non_negative(&distance(&found, &p, m)) {
                break;
            }
        }
        found.verify(law)?;
        Ok(found)
    }
}

/// `upper² |p|² − w^m`.
fn distance(claim: &NormH, p: &[f64], m: usize) -> Vec<f64> {
    let mut out: Vec<f64> = p.iter().map(|c| claim.upper * claim.upper * c).collect();
    if let Some(c) = out.get_mut(m) {
        *c -= 1.0;
    }
    out
}

fn power(w: f64, m: usize) -> f64 {
    (0..m).fold(1.0, |product, _| product * w)
}

/// Frequencies in the loop's own time where `|s^m/p|` equals `level`, ascending, with 0 before them.
fn crossings(response: &Response, m: usize, level: f64) -> Vec<f64> {
    let n = response.size();
    let mut h = DMatrix::<f64>::zeros(2 * n, 2 * n);
    for i in 0..n - 1 {
        h[(i, i + 1)] = 1.0;
        h[(n + i + 1, n + i)] = -1.0;
    }
    for (j, k) in response.last_row().iter().enumerate() {
        h[(n - 1, j)] = *k;
        h[(n + j, 2 * n - 1)] = -k;
    }
    h[(n - 1, 2 * n - 1)] = 1.0 / level;
    h[(n + m, m)] = -1.0 / level;
    let near = |l: &&nalgebra::Complex<f64>| l.im > 0.0 && l.re.abs() < 1e-4 * l.im;
    // Without a limit, the iteration can go on for ever. Without an answer the lower side stays where the
    // grid put it, and the upper one, which is proven in any case, comes out wider.
    let Some(schur) = Schur::try_new(h, f64::EPSILON, 2000) else {
        return Vec::new();
    };
    let eigenvalues = schur.complex_eigenvalues();
    let mut out: Vec<f64> = eigenvalues.iter().filter(near).map(|l| l.im).chain([0.0]).collect();
    out.sort_by(f64::total_cmp);
    out
}
