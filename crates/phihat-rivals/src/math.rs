//! Functions that several laws share.

/// `sig(x)^p = |x|^p sign(x)`.
pub(crate) fn sig(x: f64, power: f64) -> f64 {
    x.abs().powf(power).copysign(x)
}

/// `BᵀP x` of the error dynamics `ë + K_d ė + K_p e = u` of a joint.
///
/// With `x = (e, ė)`, `B = (0, 1)ᵀ` and `AᵀP + PA = −diag(q_1, q_2)`
///
/// ```text
/// BᵀP x = q_1/(2 K_p) e + (q_2 + q_1/K_p)/(2 K_d) ė                                    (1)
/// ```
///
/// [`new`](Self::new) has `q_1 = 100 1/s²`, `q_2 = 1`: in an update only the product with a gain counts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Weighted {
    pub(crate) on_error: f64,
    pub(crate) on_rate: f64,
}

impl Weighted {
    pub(crate) fn new(kp: f64, kd: f64) -> Self {
        Self::with([kp, kd], [100.0, 1.0])
    }

    /// (1) for other weights `q_1, q_2`.
    pub(crate) fn with([kp, kd]: [f64; 2], [q1, q2]: [f64; 2]) -> Self {
        Self { on_error: q1 / (2.0 * kp), on_rate: (q2 + q1 / kp) / (2.0 * kd) }
    }

    pub(crate) fn of(self, e: f64, de: f64) -> f64 {
        self.on_error * e + self.on_rate * de
    }
}

/// Peak gain `∫|g| dt` of `G(s) = s^zeros / (s^n + c_{n−1} s^{n−1} + … + c_0)`, by the impulse response.
///
/// `None` where the response has not died out after `10⁶` steps: the polynomial has a root that is not well
/// inside the left half-plane. Trapezoids on fourth-order Runge-Kutta steps of 2 % of the fastest time
/// constant: a relative error below `10⁻³`, not an enclosure.
pub(crate) fn peak_gain(zeros: usize, c: &[f64]) -> Option<f64> {
    const ORDER_MAX: usize = 5;
    let n = c.len();
    if n == 0 || n > ORDER_MAX || zeros >= n {
        return None;
    }
    // |root| ≤ 2 max |c_{n−k}|^{1/k} (Fujiwara).
    let root = |k: usize| c[n - k].abs().powf(1.0 / k as f64);
    let h = 0.02 / (1..=n).map(root).fold(0.0, f64::max);
    let slope = |x: &[f64; ORDER_MAX]| {
        let mut dx = [0.0; ORDER_MAX];
        dx[..n - 1].copy_from_slice(&x[1..n]);
        dx[n - 1] = -(0..n).map(|i| c[i] * x[i]).sum::<f64>();
        dx
    };
    let along = |x: &[f64; ORDER_MAX], h: f64, dx: &[f64; ORDER_MAX]| {
        core::array::from_fn::<_, ORDER_MAX, _>(|i| x[i] + h * dx[i])
    };
    let mut x = [0.0; ORDER_MAX];
    x[n - 1] = 1.0;
    let (mut sum, mut most) = (0.0, [0.0_f64; ORDER_MAX]);
    for _ in 0..1_000_000 {
        let k1 = slope(&x);
        let k2 = slope(&along(&x, h / 2.0, &k1));
        let k3 = slope(&along(&x, h / 2.0, &k2));
        let k4 = slope(&along(&x, h, &k3));
        let next =
            core::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        sum += 0.5 * h * (x[zeros].abs() + next[zeros].abs());
        x = next;
        for i in 0..n {
            most[i] = most[i].max(x[i].abs());
        }
        if (0..n).all(|i| x[i].abs() <= 1e-9 * most[i]) {
            return Some(sum);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weight_solves_its_lyapunov_equation() {
        // V = ½ (p11 e² + 2 p12 e ė + p22 ė²): along ë = −K_p e − K_d ė, V̇ = −½ (q1 e² + q2 ė²).
        let (kp, kd) = (400.0, 40.0);
        let w = Weighted::new(kp, kd);
        let (p12, p22) = (w.on_error, w.on_rate);
        let p11 = kd * p12 + kp * p22;
        for (e, de) in [(1.0, 0.0), (0.0, 1.0), (0.3, -0.7)] {
            let rate = (p11 * e + p12 * de) * de + (p12 * e + p22 * de) * (-kp * e - kd * de);
            assert!((rate + 0.5 * (100.0 * e * e + de * de)).abs() < 1e-12);
        }
    }

    #[test]
    fn peak_gains_are_the_closed_form_ones() {
        // 1/((s+1)(s+2)): g ≥ 0, so its integral is G(0).
        assert!((peak_gain(0, &[2.0, 3.0]).unwrap() - 0.5).abs() < 1e-4);
        // s/((s+1)(s+2)): g changes sign once, where the step response peaks, at ln 2 with 1/4.
        assert!((peak_gain(1, &[2.0, 3.0]).unwrap() - 0.5).abs() < 1e-3);
        assert!(peak_gain(0, &[-1.0, 0.5]).is_none());
    }
}
