//! Gains of a law from positions with a filter on the innovation.

use crate::innovation::{InnovationFilter, InnovationSection, SECTIONS_MAX};
use crate::{Form, Gain, GainError, JointGains, Real};

impl<R: Real> JointGains<R> {
    /// These gains, from positions, with a filter on the innovation: one or two sections of second order, side by side.
    ///
    /// # Law
    ///
    /// With the innovation `ν_k = q_k − q_d,k − ê` that corrects the observer, per section
    ///
    /// ```text
    /// x  ← x + δ,   δ ← δ + ν_k − c_0 x − c_1 δ            both from what was before
    /// τ wanted = φ̂⁺ − M̄ (K_d ė̂⁺ + K_p ê⁺) + M̄ Σ (b_0 x + b_1 δ)
    /// ```
    ///
    /// so that `δ = Q_δ(z) ν` with `Q_δ = z w/(w² + c_1 w + c_0)` and `x = Q_δ ν/w`, `w = z − 1`. The
    /// innovation is the error of the observer's prediction from the torque that acted: a limit that acts
    /// winds nothing up, and a constant `φ` leaves no error whatever the filter. Where the inertia is `M̄`
    /// and torques act as commanded, the innovation does not depend on the torque, so that the loop is stable
    /// with every filter that is.
    ///
    /// # Errors
    ///
    /// [`GainError`]: gains of another form, no section or more than two, a number that is not finite, a
    /// section that is not stable, or gains with which torques would overflow.
    ///
    /// # References
    ///
    /// Youla, Jabr, Bongiorno (1976): every law that stabilises `M̄` can be written so.
    pub fn with_innovation_filter(self, sections: &[InnovationSection]) -> Result<Self, GainError> {
        if self.form != Form::Positions {
            return Err(GainError::Form);
        }
        if sections.is_empty() || sections.len() > SECTIONS_MAX {
            return Err(GainError::Sections { count: sections.len() });
        }
        let mut filter = InnovationFilter { acts: true, ..InnovationFilter::default() };
        let places = filter.rates.iter_mut().zip(&mut filter.weights);
        for (index, (section, (rates, weights))) in sections.iter().zip(places).enumerate() {
            for value in section.rates.iter().chain(&section.weights) {
                Gain::Section(index).finite(*value)?;
            }
            if !section.settles() {
                return Err(GainError::UnstableSection { index });
            }
            *rates = section.rates.map(R::from_f64);
            *weights = section.weights.map(|weight| self.inertia * R::from_f64(weight));
        }
        let mut gains = self;
        gains.position.filter = filter;
        if gains.hold_samples_in() { Ok(gains) } else { Err(GainError::Overflow) }
    }
}

#[cfg(test)]
mod tests {
    use crate::innovation::{Filtered, InnovationFilter};
    use crate::{
        Form, GainError, InnovationSection, JointDesign, JointGains, JointState, Limits,
        Measurement, PositionDesign, Reference,
    };

    const T: f64 = 1e-3;

    const DESIGN: PositionDesign<'_> = PositionDesign {
        inertia: 0.5,
        kp: 400.0,
        kd: 40.0,
        correction: &[0.271, 28.5, -1000.0],
        velocity_correction: &[],
        share: 0.6,
        delay: 1,
        period: T,
    };

    fn section(rates: [f64; 2]) -> InnovationSection {
        InnovationSection { rates, weights: [300.0, -50.0] }
    }

    #[test]
    fn a_section_is_its_difference_equation() {
        let (first, second) = (section([0.02, 0.3]), section([0.5, 1.2]));
        let gains = JointGains::<f64>::from_positions(&DESIGN).unwrap();
        let gains = gains.with_innovation_filter(&[first, second]).unwrap();
        let own: InnovationFilter<f64> = gains.position.filter;
        let told = [1.0, -0.4, 0.0, 2.5, 0.0, 0.0, -1.0];
        let mut filtered = Default::default();
        // x of z²x − (2 − c_1) z x + (1 − c_1 + c_0) x = z ν, by powers of z⁻¹.
        let mut past = [[0.0; 2]; 2];
        let mut before = 0.0;
        for innovation in told {
            let old = past;
            filtered = own.after(&filtered, innovation);
            let mut torque = 0.0;
            for (past, section) in past.iter_mut().zip([first, second]) {
                let ([c0, c1], [b0, b1]) = (section.rates, section.weights);
                let now = (2.0 - c1) * past[0] - (1.0 - c1 + c0) * past[1] + before;
                *past = [now, past[0]];
                let next = (2.0 - c1) * now - (1.0 - c1 + c0) * past[1] + innovation;
                torque += 0.5 * (b0 * now + b1 * (next - now));
            }
            before = innovation;
            assert!((own.torque(&filtered) - torque).abs() < 1e-12, "{old:?}");
        }
    }

    #[test]
    fn what_is_no_filter_is_refused() {
        let gains = JointGains::<f64>::from_positions(&DESIGN).unwrap();
        let fine = section([0.02, 0.3]);
        assert!(gains.with_innovation_filter(&[fine]).is_ok());
        let none = Err(GainError::Sections { count: 0 });
        assert_eq!(gains.with_innovation_filter(&[]), none);
        let many = Err(GainError::Sections { count: 3 });
        assert_eq!(gains.with_innovation_filter(&[fine; 3]), many);
        // On the circle, beyond −1, growing, and a pole outside with a stable product.
        for rates in [[0.0, 0.5], [0.3, 0.3], [1.0, 2.5], [0.1, 0.05]] {
            let why = gains.with_innovation_filter(&[fine, section(rates)]);
            assert_eq!(why, Err(GainError::UnstableSection { index: 1 }), "{rates:?}");
        }
        let nan = InnovationSection { weights: [f64::NAN, 0.0], ..fine };
        assert!(matches!(gains.with_innovation_filter(&[nan]), Err(GainError::NotFinite { .. })));
        let huge = InnovationSection { weights: [1e300, 0.0], ..fine };
        assert_eq!(gains.with_innovation_filter(&[huge]), Err(GainError::Overflow));
        let other = JointDesign {
            inertia: 0.5,
            kp: 400.0,
            kd: 40.0,
            a: &[70.0],
            period: 1e-3,
            form: Form::Observer,
        };
        let other = JointGains::<f64>::new(&other).unwrap();
        assert_eq!(other.with_innovation_filter(&[fine]), Err(GainError::Form));
    }

    #[test]
    fn a_limit_that_acts_leaves_no_trace_in_the_filter() {
        let sections = [section([0.02, 0.3]), section([0.5, 1.2])];
        let gains = JointGains::<f64>::from_positions(&DESIGN).unwrap();
        let free = gains.with_innovation_filter(&sections).unwrap();
        // The arm is M̄ and meets 3 N·m that come and go; one drive gives a third of what is asked.
        let run = |gains: JointGains<f64>| {
            let (mut state, mut saw) = (JointState::new(), [Filtered::default(); 400]);
            let ([mut q, mut dq], [mut acted, mut coming]) = ([0.0; 2], [0.0; 2]);
            let mut saturated = 0;
            for (k, saw) in saw.iter_mut().enumerate() {
                let m = Measurement { q, dq, tau_applied: acted };
                let command = gains.update(&mut state, &m, &Reference::default());
                saturated += u32::from(command.status.saturated);
                *saw = state.filtered;
                (acted, coming) = (coming, command.tau);
                let phi = if (100..300).contains(&k) { 3.0 } else { 0.0 };
                let ddq = (acted - phi) / DESIGN.inertia;
                q += T * (dq + 0.5 * T * ddq);
                dq += T * ddq;
            }
            (saw, saturated)
        };
        let (unlimited, none) = run(free);
        let limits = Limits::new(Some(1.0), None, T).unwrap();
        let (limited, many) = run(free.with_limits(limits));
        assert!(none == 0 && many > 100, "{none} {many}");
        let largest = unlimited.iter().flatten().flatten().fold(0.0, |most, x| x.abs().max(most));
        assert!(largest > 1e-6, "{largest}");
        for (a, b) in unlimited.iter().flatten().flatten().zip(limited.iter().flatten().flatten()) {
            assert!((a - b).abs() < 1e-9 * largest, "{a} {b}");
        }
    }
}
