//! A law scaled in time.

use crate::portable;
use nalgebra::Complex;
use phihat_certificate::{FilterSection, Gains, JointRecord, PositionObserver};

/// Gains whose laws are `factor` times slower: `L(z^factor)` as nearly as their order allows.
///
/// # Law
///
/// `K_p/s²`, `K_d/s`, `a_i/s^{m−i}`. A law from positions: poles of its observer `z^{1/s}`, share `1 − (1 − g)^{1/s}`,
/// sections of its filter likewise, their weights by what a slow signal passes. `None`: its observer has no poles that
/// can be moved.
pub fn slower(gains: &Gains, factor: f64) -> Option<Gains> {
    let joints = gains
        .joints
        .iter()
        .map(|record| scaled(record, 1.0 / gains.rate_hz, factor))
        .collect::<Option<Vec<_>>>()?;
    let method = format!("{}; {factor} times slower", gains.method);
    Some(Gains {
        joints,
        method,
        certificate: None,
        trade_off: Vec::new(),
        limit: Vec::new(),
        coarser: Vec::new(),
        ..gains.clone()
    })
}

fn scaled(record: &JointRecord, period: f64, s: f64) -> Option<JointRecord> {
    let m = record.a.len();
    let own = |(i, a): (usize, &f64)| a / libm::pow(s, (m - i) as f64);
    let observer = match &record.observer {
        Some(observer) => Some(scaled_observer(observer, period, s)?),
        None => None,
    };
    Some(JointRecord {
        kp_per_s2: record.kp_per_s2 / (s * s),
        kd_per_s: record.kd_per_s / s,
        a: record.a.iter().enumerate().map(own).collect(),
        observer,
        ..record.clone()
    })
}

fn scaled_observer(own: &PositionObserver, period: f64, s: f64) -> Option<PositionObserver> {
    let w = characteristic(&own.correction, period);
    let slow = moved(&w, s)?;
    Some(PositionObserver {
        correction: correction(&slow, period)?,
        share: 1.0 - libm::pow(1.0 - own.share, 1.0 / s),
        innovation_filter: own
            .innovation_filter
            .iter()
            .map(|section| scaled_section(section, s))
            .collect::<Option<_>>()?,
        delay_samples: own.delay_samples,
    })
}

fn scaled_section(own: &FilterSection, s: f64) -> Option<FilterSection> {
    let [c0, c1] = own.rates;
    let slow = moved(&[c0, c1, 1.0], s)?;
    let rates = [slow[0], slow[1]];
    let [b0, b1] = own.weights_per_s2;
    // A constant innovation passes as b_0/c_0, a change of it as b_1 per sample.
    Some(FilterSection { rates, weights_per_s2: [b0 / c0 * rates[0] / (s * s), b1 / (s * s * s)] })
}

/// Polynomial in `w = z − 1` whose roots `1 + w` are those of `p`, to the power `1/s`; `p` is monic, ascending.
fn moved(p: &[f64], s: f64) -> Option<Vec<f64>> {
    let n = p.len() - 1;
    let companion = nalgebra::DMatrix::from_fn(n, n, |i, j| {
        let below = if i == j + 1 { 1.0 } else { 0.0 };
        if j + 1 == n { below - p[i] } else { below }
    });
    let roots = crate::sampled::eigenvalues::eigenvalues(companion)?;
    let mut product = vec![Complex::new(1.0, 0.0)];
    for root in &roots {
        let z = Complex::new(1.0, 0.0) + *root;
        // A pole on the negative axis has no slower real law.
        if portable::size(z) >= 1.0 || (z.re <= 0.0 && z.im.abs() <= 1e-12) {
            return None;
        }
        let slow = portable::power(z, 1.0 / s) - 1.0;
        let mut next = vec![Complex::new(0.0, 0.0); product.len() + 1];
        for (k, c) in product.iter().enumerate() {
            next[k + 1] += c;
            next[k] -= c * slow;
        }
        product = next;
    }
    Some(product.iter().map(|c| c.re).collect())
}

/// Step of `ê, T ė̂, T² φ̂_0, …` over one sample, less the identity; see the core's law from positions.
fn step(n: usize) -> nalgebra::DMatrix<f64> {
    let mut f = nalgebra::DMatrix::zeros(n, n);
    for i in 0..n - 1 {
        f[(i, i + 1)] = if i == 1 { -1.0 } else { 1.0 };
    }
    f[(0, 2)] = -0.5;
    f
}

/// `det(w − (F − ℓHF − 1))` with `ℓ` of what a reading corrects, ascending in `w`.
fn characteristic(correction: &[f64], period: f64) -> Vec<f64> {
    let n = correction.len();
    let own = observed(correction, period);
    let mut p = vec![0.0; n + 1];
    p[n] = 1.0;
    let mut adjugate = nalgebra::DMatrix::<f64>::identity(n, n);
    for k in (0..n).rev() {
        let next = portable::product(&own, &adjugate);
        p[k] = -next.trace() / (n - k) as f64;
        adjugate = next + nalgebra::DMatrix::identity(n, n) * p[k];
    }
    p
}

/// `(1 − ℓH)F − 1`, with `H` the first row, in units of samples.
fn observed(correction: &[f64], period: f64) -> nalgebra::DMatrix<f64> {
    let n = correction.len();
    let moves = step(n);
    let mut own = moves.clone();
    for i in 0..n {
        let gain = correction[i] * libm::pow(period, i as f64);
        for j in 0..n {
            let predicted = moves[(0, j)] + if j == 0 { 1.0 } else { 0.0 };
            own[(i, j)] -= gain * predicted;
        }
    }
    own
}

/// The corrections with which the observer has this characteristic polynomial; it is affine in them.
fn correction(wanted: &[f64], period: f64) -> Option<Vec<f64>> {
    let n = wanted.len() - 1;
    let unit = |i: usize| {
        let mut gains = vec![0.0; n];
        if i < n {
            gains[i] = libm::pow(period, -(i as f64));
        }
        characteristic(&gains, period)
    };
    let bare = unit(n);
    let columns: Vec<Vec<f64>> = (0..n).map(unit).collect();
    let slope = nalgebra::DMatrix::from_fn(n, n, |k, i| columns[i][k] - bare[k]);
    let off = nalgebra::DVector::from_fn(n, |k, _| wanted[k] - bare[k]);
    let found = slope.lu().solve(&off)?;
    Some(found.iter().enumerate().map(|(i, gain)| gain * libm::pow(period, -(i as f64))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_observer_that_is_not_slowed_is_the_same() {
        let (own, period) = (vec![0.42, 118.0, -9.1e3, -2.5e5], 1e-3);
        let again = correction(&characteristic(&own, period), period).unwrap();
        for (a, b) in own.iter().zip(&again) {
            assert!((a - b).abs() < 1e-7 * a.abs(), "{own:?} {again:?}");
        }
    }

    #[test]
    fn poles_of_a_slower_observer_are_roots_of_the_faster() {
        let (own, period, s) = (vec![0.42, 118.0, -9.1e3], 1e-3, 2.0);
        let fast = characteristic(&own, period);
        let slow = moved(&fast, s).unwrap();
        // Roots z of the slow one have z² among those of the fast one.
        let n = own.len();
        let companion = nalgebra::DMatrix::from_fn(n, n, |i, j| {
            let below = if i == j + 1 { 1.0 } else { 0.0 };
            if j + 1 == n { below - slow[i] } else { below }
        });
        for root in companion.complex_eigenvalues().iter() {
            let z = Complex::new(1.0, 0.0) + *root;
            let w = z * z - 1.0;
            let value = fast.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * w + c);
            assert!(value.norm() < 1e-9, "{value} at {z}");
        }
        assert!(correction(&slow, period).unwrap()[0] < own[0]);
    }
}
