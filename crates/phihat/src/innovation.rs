//! What a law from positions makes of its innovation beside the observer: a stable filter of up to fourth order.

use crate::{Form, Gain, GainError, JointGains, Real};

/// Sections of an innovation filter at most.
pub const SECTIONS_MAX: usize = 2;

/// One section, of second order, of a filter on the innovation: see [`JointGains::with_innovation_filter`].
///
/// # Example
///
/// ```
/// use phihat::{GainError, InnovationSection, JointGains, PositionDesign};
///
/// let design = PositionDesign {
///     inertia: 0.8, kp: 900.0, kd: 60.0, correction: &[0.271, 28.5, -1000.0],
///     velocity_correction: &[], share: 0.5, delay: 1, period: 1e-3,
/// };
/// let gains = JointGains::<f64>::from_positions(&design)?;
///
/// // s = −100 ± 100j rad/s, sampled at 1 kHz. What has been seen for long weighs 40 000 N·m/rad/kg·m².
/// let (decay, turn) = ((-0.1_f64).exp(), 0.1_f64.cos());
/// let [sum, product] = [2.0 * decay * turn, decay * decay];
/// let rates = [1.0 - sum + product, 2.0 - sum];
/// let section = InnovationSection { rates, weights: [40_000.0 * rates[0], 0.0] };
/// let gains = gains.with_innovation_filter(&[section])?;
///
/// // A section whose state grows is refused.
/// let grows = InnovationSection { rates: [-1e-3, 0.1], ..section };
/// let why = gains.with_innovation_filter(&[grows]);
/// assert_eq!(why, Err(GainError::UnstableSection { index: 0 }));
/// # Ok::<(), GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InnovationSection {
    /// `c_0, c_1`: per sample; in `w = z − 1` the section's poles are the roots of `w² + c_1 w + c_0`.
    pub rates: [f64; 2],
    /// `b_0, b_1`: what the section's state and its change per sample weigh in the torque that is wanted, per `M̄`
    /// \[1/s²\].
    pub weights: [f64; 2],
}

/// The sections as they run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct InnovationFilter<R> {
    /// `c_0, c_1` of each section.
    rates: [[R; 2]; SECTIONS_MAX],
    /// `M̄ b_0, M̄ b_1` \[N·m/rad\].
    weights: [[R; 2]; SECTIONS_MAX],
    /// Whether there is one.
    pub(crate) acts: bool,
}

/// What a filter remembers: of each section its state \[rad\] and the change of that per sample.
pub(crate) type Filtered<R> = [[R; 2]; SECTIONS_MAX];

impl InnovationSection {
    /// Whether both roots of `w² + c_1 w + c_0` are such that `|1 + w| < 1`: Jury's conditions.
    fn settles(&self) -> bool {
        let [c0, c1] = self.rates;
        c0 > 0.0 && c1 > c0 && 4.0 - 2.0 * c1 + c0 > 0.0
    }
}

impl<R: Real> InnovationFilter<R> {
    /// After a sample with this innovation.
    #[inline]
    pub(crate) fn after(&self, filtered: &Filtered<R>, innovation: R) -> Filtered<R> {
        let mut next = *filtered;
        for ([x, change], [c0, c1]) in next.iter_mut().zip(&self.rates) {
            let back = *c0 * *x + *c1 * *change;
            *x += *change;
            *change += innovation - back;
        }
        next
    }

    /// After so many samples, of which only the last one was seen.
    #[inline]
    pub(crate) fn through(
        &self,
        filtered: &Filtered<R>,
        innovation: R,
        samples: u8,
    ) -> Filtered<R> {
        let mut blind = *filtered;
        for _ in 1..samples {
            blind = self.after(&blind, R::ZERO);
        }
        self.after(&blind, innovation)
    }

    /// What it adds to the torque that is wanted \[N·m\].
    #[inline]
    pub(crate) fn torque(&self, filtered: &Filtered<R>) -> R {
        let [[x, dx], [y, dy]] = *filtered;
        let [[on_x, on_dx], [on_y, on_dy]] = self.weights;
        (on_x * x + on_dx * dx) + (on_y * y + on_dy * dy)
    }

    /// The largest factor on an innovation.
    pub(crate) fn largest(&self) -> R {
        let one = R::from_f64(1.0);
        self.rates.iter().zip(&self.weights).fold(R::ZERO, |most, ([c0, _], [on_x, on_dx])| {
            let held = if *c0 > R::ZERO { one / *c0 } else { R::ZERO };
            most + (on_x.abs() + on_dx.abs()) * (one + held)
        })
    }

    /// Whether what the other has filtered means the same here.
    pub(crate) fn reads_as(&self, other: &Self) -> bool {
        self.acts == other.acts && self.rates == other.rates
    }
}

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
    /// so that `δ = Q_δ(z) ν` with `Q_δ = z w/(w² + c_1 w + c_0)` and `x = Q_δ ν/w`, `w = z − 1`. The innovation is what the observer did
    /// not expect, of the torque that acted: a limit that acts winds nothing up, and a constant `φ` leaves no error whatever the filter. Where the inertia is `M̄` and torques
    /// act as told, the innovation does not depend on the torque, so that the loop is stable with every filter that is.
    ///
    /// # Errors
    ///
    /// [`GainError`]: gains of another form, no section or more than two, a number that is not finite, a section that is not
    /// stable, or gains with which torques would overflow.
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
    use super::{InnovationFilter, InnovationSection};
    use crate::{Form, GainError, JointDesign, JointGains, PositionDesign};

    const DESIGN: PositionDesign<'_> = PositionDesign {
        inertia: 0.5,
        kp: 400.0,
        kd: 40.0,
        correction: &[0.271, 28.5, -1000.0],
        velocity_correction: &[],
        share: 0.6,
        delay: 1,
        period: 1e-3,
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
}
