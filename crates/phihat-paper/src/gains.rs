//! The gains that the paper's experiments may have had, and what its tables print.

use phihat_design::claims::UnitLaw;

/// `K_p` and `K_d` of Table 2 (C).
pub(crate) const OUTER: (f64, f64) = (400.0, 40.0);

/// `φ_max` that Table 2 (A) was computed with: not printed, it follows from `K_p` and `K_d` at m = 1.
pub(crate) const PHI_MAX: f64 = 22.2;

/// A law with the printed outer loop.
pub(crate) fn law(a: &[f64]) -> UnitLaw {
    UnitLaw { kp: OUTER.0, kd: OUTER.1, a: a.to_vec() }
}

/// m = 1: `a_0 = K̃ + 1/γ²` with the printed `K̃ = 68.9` and `γ ≈ 1.2`.
pub(crate) fn first() -> UnitLaw {
    law(&[69.6])
}

/// m = 2, hypothesis H1: `a_1 = 69.6`, `a_0 = b_0 a_1` with the printed `b_0 = 69.6`.
pub(crate) fn second_h1() -> UnitLaw {
    law(&[69.6 * 69.6, 69.6])
}

/// m = 2, hypothesis H2: `a_1 = 139.2`, on the edge of A3 at the printed `b_0 = 69.6`.
pub(crate) fn second_h2() -> UnitLaw {
    law(&[69.6 * 139.2, 139.2])
}

/// m = 2, ours: the double pole at 69.6 rad/s, which has a certificate.
pub(crate) fn second_h3() -> UnitLaw {
    law(&[69.6 * 69.6, 2.0 * 69.6])
}

/// m = 2, hypothesis H4: the printed 69.6 is no `b_0` but `a_1 = K̃ + 1/γ²`, with both poles at half of it.
pub(crate) fn second_h4() -> UnitLaw {
    law(&[34.8 * 34.8, 69.6])
}

/// Names of [`all`], in their order.
pub(crate) const NAMES: &str = "m = 1, H1, H2, H3, H4";

/// m = 1 and the four hypotheses of m = 2, with their names.
pub(crate) fn all() -> [(&'static str, UnitLaw); 5] {
    [
        ("m = 1", first()),
        ("H1", second_h1()),
        ("H2", second_h2()),
        ("H3", second_h3()),
        ("H4", second_h4()),
    ]
}

/// `K̃` of Table 2 (C).
pub(crate) const K_TILDE: f64 = 68.9;

/// `K̃` of the certificate of [`second_h3`].
pub(crate) const K_TILDE_H3: f64 = 100.0;

/// Every estimator pole at `rate` \[rad/s\].
pub(crate) fn equal_rate(order: usize, rate: f64) -> UnitLaw {
    law(&phihat_design::claims::times::estimator_at(order, rate))
}
