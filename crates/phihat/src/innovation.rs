//! Innovation filter of a law from positions, alongside the observer: stable, of up to fourth order.

use crate::Real;

/// Sections of an innovation filter at most.
pub const SECTIONS_MAX: usize = 2;

/// One section, of second order, of a filter on the innovation: see
/// [`JointGains::with_innovation_filter`](crate::JointGains::with_innovation_filter).
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
    /// `b_0, b_1`: weights of the section's state and of its change per sample in the wanted torque, per `M̄`
    /// \[1/s²\].
    pub weights: [f64; 2],
}

/// The sections as they run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct InnovationFilter<R> {
    /// `c_0, c_1` of each section.
    pub(crate) rates: [[R; 2]; SECTIONS_MAX],
    /// `M̄ b_0, M̄ b_1` \[N·m/rad\].
    pub(crate) weights: [[R; 2]; SECTIONS_MAX],
    /// True if there is a filter.
    pub(crate) acts: bool,
}

/// State of a filter: of each section its state \[rad\] and the change of that per sample.
pub(crate) type Filtered<R> = [[R; 2]; SECTIONS_MAX];

impl InnovationSection {
    /// Returns true if both roots of `w² + c_1 w + c_0` satisfy `|1 + w| < 1`: Jury's conditions.
    pub(crate) fn settles(&self) -> bool {
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

    /// After so many samples, of which only the last one was measured.
    #[inline(never)]
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

    /// Contribution of the filter to the wanted torque \[N·m\].
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

    /// Returns true if a state of the other filter has the same meaning here.
    pub(crate) fn reads_as(&self, other: &Self) -> bool {
        self.acts == other.acts && self.rates == other.rates
    }
}
