//! One joint, one sample: the law.

use crate::{Form, JointGains, ORDER_MAX, Real};

/// What the joint's sensors say at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measurement<R> {
    /// Position `q` \[rad\].
    pub q: R,
    /// Velocity `q̇` \[rad/s\].
    pub dq: R,
    /// Torque that acted (mean) since the previous sample \[N·m\]: after limits, delay and drive.
    pub tau_applied: R,
}

/// What the joint shall do at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reference<R> {
    /// Desired position \[rad\].
    pub q: R,
    /// Desired velocity \[rad/s\].
    pub dq: R,
    /// Desired acceleration \[rad/s²\].
    pub ddq: R,
}

/// The answer to one sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command<R> {
    /// Torque to apply until the next sample \[N·m\]: always finite and within the limits.
    pub tau: R,
    /// Estimate of the unknown dynamics \[N·m\], already contained in `tau`.
    pub phi_hat: R,
    /// What happened.
    pub status: Status,
}

/// What happened at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Status {
    /// The torque limit acted.
    pub saturated: bool,
    /// The torque-rate limit acted.
    pub rate_limited: bool,
    /// The sample held something that is not finite: the last torque is held, the state untouched.
    pub refused: bool,
}

/// Everything a joint remembers between samples; owned by the caller.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState<R> {
    /// Observer: `φ̂_0, φ̂_1, …, φ̂_{m−1}`, estimates of `φ` and its time derivatives \[N·m/s^j\].
    /// Literal: `∫e, ∬e, …` \[rad·s^j\]. Unused entries are zero.
    pub(crate) memory: [R; ORDER_MAX],
    /// Literal: what rounding left out of the integrals, so that 1e9 samples later they still count.
    carry: [R; ORDER_MAX],
    /// Velocity at the last sample.
    dq: R,
    /// `φ̂` at the last sample.
    pub(crate) phi_hat: R,
    /// The last torque commanded.
    pub(crate) tau: R,
    started: bool,
}

/// The time between two samples, as the estimator takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval<R> {
    /// Length of one step \[s\].
    pub(crate) step: R,
    /// How many steps make the interval; 0: the interval cannot be trusted, nothing is integrated.
    pub(crate) parts: u8,
    /// `1/parts`.
    pub(crate) share: R,
}

impl<R: Real> JointState<R> {
    /// At rest, with zero knowledge of the arm and zero torque.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The last torque commanded \[N·m\].
    pub fn tau(&self) -> R {
        self.tau
    }

    /// The answer when nothing can be trusted: the last torque, the state untouched.
    pub(crate) fn hold(&self) -> Command<R> {
        let status = Status { refused: true, ..Status::default() };
        Command { tau: self.tau, phi_hat: self.phi_hat, status }
    }
}

impl<R: Real> Measurement<R> {
    pub(crate) fn is_finite(&self) -> bool {
        R::all_finite([self.q, self.dq, self.tau_applied])
    }
}

impl<R: Real> Reference<R> {
    pub(crate) fn is_finite(&self) -> bool {
        R::all_finite([self.q, self.dq, self.ddq])
    }
}

impl<R: Real> JointGains<R> {
    /// Answers one sample.
    ///
    /// # Law
    ///
    /// Observer form: (8), `φ̂^{(m)} = −Σ a_i (φ̂ − φ)^{(i)}`, in the coordinates `φ̂_j` = estimate of the
    /// j-th derivative of `φ`, with the sampled coefficients `α` in place of `a`:
    ///
    /// ```text
    /// ν    = T (τ_applied − φ̂_0) − M̄ (q̇ − q̇ of the last sample)           innovation: T (φ − φ̂)
    /// φ̂_j ← φ̂_j + T φ̂_{j+1} + α_{m−1−j} ν,    j = 0 … m−1,    φ̂_m = 0        (T4)
    /// τ    = M̄ (q̈_d − K_d ė − K_p e) + φ̂_0                                     (T1)
    /// ```
    ///
    /// Literal form: `φ̂ = −M̄ Σ_{i=1}^{m+2} (a_{i−1}K_p + a_{i−2}K_d + a_{i−3}) x_i`, with the ladder
    /// `x = (∫…∫e, …, ∫e, e, ė)` summed by backward differences (9), (10), (16).
    ///
    /// The first call starts with zero system information: all memory is zero.
    ///
    /// # Real time
    ///
    /// No heap, no panic, no loop that depends on data. A measurement or reference that is not finite
    /// changes nothing: the last torque is held and `status.refused` is set.
    pub fn update(
        &self,
        state: &mut JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
    ) -> Command<R> {
        if measurement.is_finite() && reference.is_finite() {
            self.answer(state, measurement, reference)
        } else {
            state.hold()
        }
    }

    /// [`Self::update`] for a sample already known to be finite.
    pub(crate) fn answer(
        &self,
        state: &mut JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
    ) -> Command<R> {
        // The observer form writes its few numbers in place: nothing else is copied.
        let (memory, carry, phi_hat) = match self.form {
            Form::Observer => {
                let memory = self.observe(state, measurement, self.nominal());
                (memory, state.carry, memory[0])
            }
            Form::Literal => {
                let next = self.integrate(state, measurement, reference, self.nominal());
                (next.memory, next.carry, next.phi_hat)
            }
        };
        let demand = self.outer_loop(measurement, reference) + phi_hat;
        if !demand.is_finite() {
            return state.hold();
        }
        let limited = self.limits.apply(demand, state.tau);
        state.memory = memory;
        if self.form == Form::Literal {
            state.carry = carry;
        }
        state.dq = measurement.dq;
        state.phi_hat = phi_hat;
        state.tau = limited.tau;
        state.started = true;
        let status = Status {
            saturated: limited.over_torque,
            rate_limited: limited.over_rate,
            refused: false,
        };
        Command { tau: limited.tau, phi_hat, status }
    }

    /// Makes `state` such that these gains would have commanded `tau` at this sample: to start from a
    /// torque that already holds the arm, or to change gains or order without a torque jump.
    ///
    /// `φ̂` takes up the difference: in the observer form directly, in the literal form through the
    /// highest integral. What a lower order does not have is dropped, what a higher order adds starts
    /// at zero. Arguments that are not finite change nothing and answer `false`.
    pub fn resume(
        &self,
        state: &mut JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
        tau: R,
    ) -> bool {
        let wanted = tau - self.outer_loop(measurement, reference);
        if !(measurement.is_finite() && reference.is_finite() && wanted.is_finite()) {
            return false;
        }
        let mut next = *state;
        for entry in next.memory.iter_mut().skip(self.order) {
            *entry = R::ZERO;
        }
        match self.form {
            Form::Observer => next.memory[0] = wanted,
            Form::Literal => self.preset_integral(&mut next, measurement, reference, wanted),
        }
        next.dq = measurement.dq;
        next.phi_hat = wanted;
        next.tau = tau;
        next.started = true;
        *state = next;
        true
    }

    /// One whole sample period.
    pub(crate) fn nominal(&self) -> Interval<R> {
        Interval { step: self.period, parts: 1, share: R::from_f64(1.0) }
    }

    /// The estimator over the interval that ends at this sample; the torque is left as it was.
    pub(crate) fn estimate(
        &self,
        state: &JointState<R>,
        measurement: &Measurement<R>,
        reference: &Reference<R>,
        interval: Interval<R>,
    ) -> JointState<R> {
        let mut next = match self.form {
            Form::Observer => {
                let memory = self.observe(state, measurement, interval);
                JointState { memory, phi_hat: memory[0], ..*state }
            }
            Form::Literal => self.integrate(state, measurement, reference, interval),
        };
        next.dq = measurement.dq;
        next.started = true;
        next
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
        interval: Interval<R>,
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
        interval: Interval<R>,
    ) -> JointState<R> {
        let mut next = *state;
        let e = measurement.q - reference.q;
        let de = measurement.dq - reference.dq;
        if state.started {
            for _ in 0..interval.parts {
                let mut below = e;
                let sums = next.memory.iter_mut().zip(&mut next.carry);
                for (integral, carry) in sums.take(self.order) {
                    // Kahan's sum.
                    let increment = interval.step * below - *carry;
                    let sum = *integral + increment;
                    *carry = (sum - *integral) - increment;
                    *integral = sum;
                    below = sum;
                }
            }
        }
        next.phi_hat = -(self.inertia * self.weigh(&next.memory, e, de));
        next
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
