//! One joint, one sample: the law.

use crate::estimate::Estimate;
use crate::gains::{AsLiteral, AsObserver, Built, Filtered, FromPositions, Path};
use crate::joint::SampleInterval;
use crate::{Command, Form, JointGains, JointState, Measurement, ORDER_MAX, Real, Reference};

impl<R: Real> JointGains<R> {
    /// Computes the torque of one joint for one sample.
    ///
    /// # Law
    ///
    /// Observer form: (8), `φ̂^{(m)} = −Σ a_i (φ̂ − φ)^{(i)}`, in the coordinates `φ̂_j` = estimate of the
    /// j-th derivative of `φ`, with the sampled coefficients `α` in place of `a`:
    ///
    /// ```text
    /// ν    = T (τ_applied − φ̂_0) − M̄ (q̇ − q̇ of the last sample)           innovation: T (φ − φ̂)
    /// φ̂_j ← φ̂_j + T φ̂_{j+1} + α_{m−1−j} ν,    j = 0 … m−1,    φ̂_m = 0       as (T4)
    /// τ    = M̄ (q̈_d − K_d ė − K_p e) + φ̂_0                                    as (T1)
    /// ```
    ///
    /// Literal form: `φ̂ = −M̄ Σ_{i=1}^{m+2} (a_{i−1}K_p + a_{i−2}K_d + a_{i−3}) x_i`, with the ladder
    /// `x = (∫…∫e, …, ∫e, e, ė)` summed by backward differences (9), (10), (16).
    ///
    /// The first call starts with zero system information: all memory is zero.
    ///
    /// # Real time
    ///
    /// No heap, no panic, no loop that depends on data. A measurement or reference that is not finite, or
    /// beyond ±2³² (4.3e9), changes nothing: the last torque is held and `status.refused` is set.
    pub fn update(
        &self,
        state: &mut JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
    ) -> Command<R> {
        if measurement.doubt() + reference.doubt() == R::ZERO {
            self.answer(state, measurement, reference)
        } else {
            state.hold()
        }
    }

    /// [`Self::update`] for a sample already known to be one.
    pub(crate) fn answer(
        &self,
        state: &mut JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
    ) -> Command<R> {
        match self.path {
            Path::Observer => self.answer_as::<AsObserver>(state, measurement, reference),
            Path::Literal => self.answer_apart::<AsLiteral>(state, measurement, reference),
            Path::Positions => self.answer_as::<FromPositions>(state, measurement, reference),
            Path::Filtered => self.answer_filtered(state, measurement, reference),
        }
    }

    /// With a low-pass on the torque command, out of the way of the laws without one.
    #[cold]
    #[inline(never)]
    fn answer_filtered(
        &self,
        state: &mut JointState<R>,
        m: &Measurement<R>,
        reference: &Reference<R>,
    ) -> Command<R> {
        match self.form {
            Form::Observer => self.answer_as::<Filtered<AsObserver>>(state, m, reference),
            Form::Literal => self.answer_as::<Filtered<AsLiteral>>(state, m, reference),
            Form::Positions => self.answer_as::<Filtered<FromPositions>>(state, m, reference),
        }
    }

    /// As [`Self::answer_as`], out of the way of the law that most run.
    #[cold]
    #[inline(never)]
    fn answer_apart<S: Built>(
        &self,
        state: &mut JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
    ) -> Command<R> {
        self.answer_as::<S>(state, measurement, reference)
    }

    #[allow(clippy::inline_always, reason = "a call each would cost a tenth of the law")]
    #[inline(always)]
    fn answer_as<S: Built>(
        &self,
        state: &mut JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
    ) -> Command<R> {
        let next = self.estimate::<S>(state, measurement, reference, &self.nominal());
        let mut demand = self.demand::<S>(&next, measurement, reference);
        if S::FILTERED {
            demand = self.low_passed(demand, state.tau);
        }
        if !next.fits(demand) {
            return state.hold();
        }
        let limited = self.limits.apply(demand, state.tau);
        state.phi_hat = next.phi_hat;
        state.tau = limited.tau;
        Self::remember::<S>(state, &next, measurement);
        limited.command(next.phi_hat)
    }

    /// Makes `state` such that these gains would have commanded `tau` at this sample: to start from a
    /// torque that already holds the arm, or to change gains or order without a torque jump.
    ///
    /// `φ̂` takes up the difference: in the observer form directly, in the literal form through the
    /// highest integral. What a lower order does not have is dropped, what a higher order adds starts
    /// at zero. A `tau` beyond the largest torque counts as that. Arguments that are not finite, or beyond
    /// ±2³², change nothing and answer `false`.
    pub fn resume(
        &self,
        state: &mut JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
        tau: R,
    ) -> bool {
        if measurement.doubt() + reference.doubt() + R::doubt([tau]) != R::ZERO {
            return false;
        }
        // A refused sample is answered with the torque from here: never one that may not be commanded.
        let tau = tau.saturate(self.limits.torque());
        let wanted = tau - self.outer_loop(measurement, reference);
        let mut next = *state;
        for entry in next.memory.iter_mut().skip(self.order) {
            *entry = R::ZERO;
        }
        let mut phi_hat = wanted;
        match self.form {
            Form::Observer => next.memory[0] = wanted,
            Form::Literal => self.preset_integral(&mut next, measurement, reference, wanted),
            Form::Positions => {
                phi_hat = self.preset_seen(&mut next, measurement, reference, tau);
            }
        }
        next.dq = measurement.dq;
        next.phi_hat = phi_hat;
        next.tau = tau;
        next.started = true;
        let stored = Estimate::of(next.memory, next.carry, phi_hat, tau - phi_hat);
        if !stored.fits(wanted + next.memory[0]) {
            return false;
        }
        *state = next;
        true
    }

    /// One whole sample period.
    pub(crate) fn nominal(&self) -> SampleInterval<R> {
        SampleInterval { step: self.period, parts: 1, share: R::from_f64(1.0) }
    }

    /// The estimator over the interval that ends at this sample. The state is left as it was: whether the
    /// sample counts is known only when its torque is.
    #[allow(clippy::inline_always, reason = "one copy per form of the law, each without a call")]
    #[inline(always)]
    pub(crate) fn estimate<S: Built>(
        &self,
        state: &JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
        interval: &SampleInterval<R>,
    ) -> Estimate<R> {
        match S::FORM {
            Form::Observer => {
                let memory = self.observe(state, measurement, interval);
                Estimate::of(memory, state.carry, memory[0], R::ZERO)
            }
            Form::Literal => self.integrate(state, measurement, reference, interval),
            Form::Positions => self.sight(state, measurement, reference, interval),
        }
    }

    /// Torque command before limits \[N·m\].
    pub(crate) fn demand<S: Built>(
        &self,
        estimate: &Estimate<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
    ) -> R {
        let outer = match S::FORM {
            Form::Observer | Form::Literal => self.outer_loop(measurement, reference),
            Form::Positions => estimate.outer,
        };
        outer + estimate.phi_hat
    }

    /// The sample counts, and `state.tau` answered it: its estimate is the state's from now on.
    pub(crate) fn remember<S: Built>(
        state: &mut JointState<R>,
        estimate: &Estimate<R>,
        measurement: &Measurement<R>,
    ) {
        state.memory = estimate.memory;
        match S::FORM {
            Form::Observer => {}
            Form::Literal => state.carry = estimate.beside,
            Form::Positions => Self::remember_seen(state, estimate),
        }
        state.dq = measurement.dq;
        state.started = true;
    }

    /// `M̄ (q̈_d − K_d ė − K_p e)`.
    pub(crate) fn outer_loop(&self, measurement: &Measurement<R>, reference: &Reference<R>) -> R {
        let e = measurement.q - reference.q;
        let de = measurement.dq - reference.dq;
        self.inertia * (reference.ddq - self.kd * de - self.kp * e)
    }

    /// (T4): advances the observer over the interval that ends at this sample.
    fn observe(
        &self,
        state: &JointState<R>,
        measurement: &Measurement<R>,
        interval: &SampleInterval<R>,
    ) -> [R; ORDER_MAX] {
        let mut memory = state.memory;
        if state.started {
            let momentum = self.inertia * (measurement.dq - state.dq) * interval.share;
            for _ in 0..interval.parts {
                let [phi_hat, d1, d2, d3] = memory;
                let innovation = interval.step * (measurement.tau_applied - phi_hat) - momentum;
                let derivatives = [d1, d2, d3, R::ZERO];
                for ((entry, alpha), derivative) in
                    memory.iter_mut().zip(&self.alpha).zip(derivatives)
                {
                    *entry += interval.step * derivative + *alpha * innovation;
                }
            }
        }
        memory
    }

    /// (9), (10), (16): sums the error once, twice, … m times.
    fn integrate(
        &self,
        state: &JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
        interval: &SampleInterval<R>,
    ) -> Estimate<R> {
        let (mut memory, mut carry) = (state.memory, state.carry);
        let e = measurement.q - reference.q;
        let de = measurement.dq - reference.dq;
        if state.started {
            for _ in 0..interval.parts {
                let mut below = e;
                for (integral, carry) in memory.iter_mut().zip(&mut carry).take(self.order) {
                    // Kahan's sum.
                    let increment = interval.step * below - *carry;
                    let sum = *integral + increment;
                    *carry = (sum - *integral) - increment;
                    *integral = sum;
                    below = sum;
                }
            }
        }
        let phi_hat = -(self.inertia * self.weigh(&memory, e, de));
        Estimate::of(memory, carry, phi_hat, R::ZERO)
    }

    /// `Σ_{i=1}^{m+2} (a_{i−1}K_p + a_{i−2}K_d + a_{i−3}) x_i`.
    fn weigh(&self, integrals: &[R; ORDER_MAX], e: R, de: R) -> R {
        let mut total = self.on_error[1] * de + self.on_error[0] * e;
        for (factor, integral) in self.on_integrals.iter().zip(integrals) {
            total += *factor * *integral;
        }
        total
    }

    fn preset_integral(
        &self,
        next: &mut JointState<R>,
        at: &Measurement<R>,
        reference: &Reference<R>,
        wanted: R,
    ) {
        next.carry = [R::ZERO; ORDER_MAX];
        let Some(highest) = next.memory.iter_mut().take(self.order).last() else { return };
        if *highest == R::ZERO {
            // The order rises: what the lower integrals held belongs into the new highest one, or
            // they would drive it away from a constant load.
            next.memory = [R::ZERO; ORDER_MAX];
        } else {
            *highest = R::ZERO;
        }
        let rest = self.weigh(&next.memory, at.q - reference.q, at.dq - reference.dq);
        let factors = self.on_integrals.iter().zip(&mut next.memory);
        if let Some((factor, highest)) = factors.take(self.order).last() {
            *highest = (-(wanted * self.inertia_inverse) - rest) / *factor;
        }
    }
}
