//! A first-order low-pass on the torque command.

use crate::gains::Path;
use crate::sampled::sampled_coefficients;
use crate::{Gain, GainError, JointGains, Real};

impl<R: Real> JointGains<R> {
    /// These gains with a first-order low-pass on the torque command, before the limits; `None`: without one.
    ///
    /// # Law
    ///
    /// With the torque `τ` that the law without it commands at sample `k`, before limits,
    ///
    /// ```text
    /// τ_f,k = α r_{k−1} + (1 − α) τ_k,    α = e^{−2πfT}
    /// ```
    ///
    /// `r_{k−1}` is the torque of the sample before as the limits let it through, so that a limit that acts winds
    /// nothing up; the first sample starts from 0, or from the torque of [`Self::resume`]. The observer is fed with the
    /// torque that acted, and so counts the filter as it counts a drive's lag. A low-pass that is a client's own, with
    /// `α = 1/(1 + 2πf_cT)` as libfranka's, is this one with `f = ln(1 + 2πf_cT)/(2πT)`.
    ///
    /// A [`Supervisor`](crate::Supervisor) stops without it.
    ///
    /// # Errors
    ///
    /// [`GainError::NotPositive`]: a bandwidth \[Hz\] that is not positive and finite.
    ///
    /// # Example
    ///
    /// ```
    /// use phihat::{Form, JointDesign, JointGains, JointState, Measurement, Reference};
    ///
    /// let design = JointDesign {
    ///     inertia: 0.8, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
    /// };
    /// let gains = JointGains::new(&design)?.with_torque_filter(Some(100.0))?;
    ///
    /// // 2 mrad above the reference: of 0.64 N·m some 47 % come at once.
    /// let measurement = Measurement { q: 0.002, dq: 0.0, tau_applied: 0.0 };
    /// let command = gains.update(&mut JointState::new(), &measurement, &Reference::default());
    /// let share = 1.0 - (-core::f64::consts::TAU * 0.1).exp();
    /// assert!((command.tau + 0.64 * share).abs() < 1e-12);
    /// # Ok::<(), phihat::GainError>(())
    /// ```
    pub fn with_torque_filter(self, bandwidth_hz: Option<f64>) -> Result<Self, GainError> {
        let Some(bandwidth) = bandwidth_hz else {
            let path = Path::of(self.form);
            return Ok(Self { path, torque_share: R::from_f64(1.0), ..self });
        };
        let period = self.period.to_f64();
        let rate = core::f64::consts::TAU * Gain::TorqueFilter.positive(bandwidth)?;
        let [alpha, ..] = sampled_coefficients(&[rate], period);
        Ok(Self { path: Path::Filtered, torque_share: R::from_f64(alpha * period), ..self })
    }

    /// Torque command behind the low-pass, after a torque as the limits let it through \[N·m\].
    pub(crate) fn low_passed(&self, torque: R, before: R) -> R {
        before + self.torque_share * (torque - before)
    }
}

#[cfg(test)]
mod tests {
    //! The low-pass alone and behind limits. Wrong if a step were answered by another course than `1 − αᵏ`, if a limit
    //! wound it up, or if a law without it gave another bit than before.

    use crate::{
        Form, GainError, JointDesign, JointGains, JointState, Limits, Measurement, Reference,
    };

    const T: f64 = 1e-3;

    fn gains(form: Form) -> JointGains<f64> {
        let design = JointDesign { inertia: 0.5, kp: 400.0, kd: 40.0, a: &[70.0], period: T, form };
        JointGains::new(&design).unwrap()
    }

    /// 1 mrad off, and what acted is what the estimate expects: the law commands −0.2 N·m at every sample.
    fn still(tau_applied: f64) -> Measurement<f64> {
        Measurement { q: 1e-3, dq: 0.0, tau_applied }
    }

    #[test]
    fn a_step_is_answered_by_its_closed_form() {
        for hz in [1.0, 40.0, 300.0] {
            let law = gains(Form::Observer).with_torque_filter(Some(hz)).unwrap();
            let alpha = (-core::f64::consts::TAU * hz * T).exp();
            let mut state = JointState::new();
            for k in 1..200 {
                let tau = law.update(&mut state, &still(0.0), &Reference::default()).tau;
                let wanted = -0.2 * (1.0 - alpha.powi(k));
                assert!((tau - wanted).abs() < 1e-14, "{hz} {k}: {tau} {wanted}");
            }
        }
    }

    #[test]
    fn a_limit_winds_nothing_up() {
        let limits = Limits::new(Some(0.1), None, T).unwrap();
        let law = gains(Form::Observer).with_limits(limits);
        let law = law.with_torque_filter(Some(20.0)).unwrap();
        let mut state = JointState::new();
        for _ in 0..500 {
            law.update(&mut state, &still(0.0), &Reference::default());
        }
        assert!((state.tau() + 0.1).abs() < 1e-15);
        // The torque turns at the next sample, from the limit and not from what was beyond it.
        let back = Measurement { q: -1e-3, ..still(0.0) };
        let tau = law.update(&mut state, &back, &Reference::default()).tau;
        let share = 1.0 - (-core::f64::consts::TAU * 20.0 * T).exp();
        assert!((tau - (-0.1 + share * 0.3)).abs() < 1e-14, "{tau}");
    }

    #[test]
    fn without_one_every_bit_is_as_before() {
        for form in [Form::Observer, Form::Literal] {
            let law = gains(form);
            let off = law.with_torque_filter(Some(50.0)).unwrap().with_torque_filter(None).unwrap();
            assert_eq!(law, off);
        }
    }

    #[test]
    fn a_resumed_torque_is_commanded() {
        for form in [Form::Observer, Form::Literal] {
            let law = gains(form).with_torque_filter(Some(30.0)).unwrap();
            let (mut state, reference) = (JointState::new(), Reference::default());
            assert!(law.resume(&mut state, &still(2.0), &reference, 2.0));
            let tau = law.update(&mut state, &still(2.0), &reference).tau;
            assert!((tau - 2.0).abs() < 5e-3, "{form:?} {tau}");
        }
    }

    #[test]
    fn no_bandwidth_is_refused() {
        for hz in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let why = gains(Form::Observer).with_torque_filter(Some(hz));
            assert!(matches!(why, Err(GainError::NotPositive { .. })), "{hz}");
        }
    }
}
