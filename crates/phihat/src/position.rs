//! One joint, one sample: the law whose observer sees the position alone.

use crate::delay::PENDING_MAX;
use crate::estimate::Estimate;
use crate::gains::Path;
use crate::innovation::{Filtered, InnovationFilter};
use crate::joint::SampleInterval;
use crate::position_design::STATES;
use crate::position_gains::{Correction, Expected, PositionGains, Step, entry, push, weighed};
use crate::{
    Form, GainError, JointGains, JointState, Limits, Measurement, ORDER_MAX, PositionDesign, Real,
    Reference,
};

impl<R: Real> JointGains<R> {
    /// Checks the design of a law from positions and prepares it.
    ///
    /// # Law
    ///
    /// At sample `k`, with the torque `τ_k` acting from `k + d` to `k + d + 1`, and `M̄ ë = τ − ff − φ`
    /// between samples:
    ///
    /// ```text
    /// z    = ê, ė̂, φ̂, …  of the last sample, carried on by the torque that acted, τ_applied − ff_{k−1−d}
    /// z   ← z + ℓ (q_k − q_d,k − ê)                  (and + λ (q̇ − q̇_d − ė̂), where a velocity is good)
    /// z⁺   = z carried on through the d torques that are on their way, and φ̂⁺ by T (1/g − 1) more
    /// ff_k = M̄ q̈_d                                   q̈_d: the mean over the interval in which τ_k acts
    /// r    = τ_{k−1} − ff_{k−1}                       as the limits let it through
    /// τ_k  = ff_k + r + g (φ̂⁺ − M̄ (K_d ė̂⁺ + K_p ê⁺) − r)
    /// ```
    ///
    /// A constant `φ` leaves no error; from `m = 2` on, neither does a ramp. `g < 1` weighs the torque's
    /// change, as a penalty on its rate would. `r` holds what limits let through, so nothing winds up, and a
    /// law that takes over begins from the torque that acts.
    ///
    /// # Errors
    ///
    /// [`GainError`], naming the gain: not finite, not positive, an observer that is not stable, an order
    /// outside 1 … 3, a share outside 0 … 1, a delay beyond 4 samples, or gains with which torques would
    /// overflow.
    pub fn from_positions(design: &PositionDesign<'_>) -> Result<Self, GainError> {
        design.check()?;
        let weights = |of: &[f64; STATES]| {
            let [e, de, phi, d1, d2] = of.map(R::from_f64);
            Correction { e, de, phi: [phi, d1, d2] }
        };
        let correction = |of: &[f64]| {
            let at = |i: usize| of.get(i).copied().unwrap_or(0.0);
            let phi = |i: usize| design.inertia * at(i);
            weights(&[at(0), at(1), phi(2), phi(3), phi(4)])
        };
        let (seen, coming) = design.weights();
        let gains = Self {
            form: Form::Positions,
            path: Path::Positions,
            torque_share: R::from_f64(1.0),
            position: PositionGains {
                on_position: correction(design.correction),
                on_velocity: correction(design.velocity_correction),
                step: Step::new(design.period, design.inertia),
                seen: weights(&seen),
                coming: coming.map(R::from_f64),
                share: R::from_f64(design.share),
                delay: u8::try_from(design.delay).unwrap_or(0),
                hears_velocity: design.velocity_correction.iter().any(|gain| *gain != 0.0),
                filter: InnovationFilter::default(),
            },
            order: design.correction.len().saturating_sub(2),
            period: R::from_f64(design.period),
            inertia: R::from_f64(design.inertia),
            inertia_inverse: R::from_f64(1.0 / design.inertia),
            kp: R::from_f64(design.kp),
            kd: R::from_f64(design.kd),
            alpha: [R::from_f64(design.estimator_rate()), R::ZERO, R::ZERO, R::ZERO],
            on_integrals: [R::ZERO; ORDER_MAX],
            on_error: [R::ZERO; 2],
            limits: Limits::none(),
        };
        if gains.hold_samples_in() { Ok(gains) } else { Err(GainError::Overflow) }
    }

    /// Returns true if a measured velocity has a part in the law's state.
    pub(crate) fn hears_velocity(&self) -> bool {
        self.form != Form::Positions || self.position.hears_velocity
    }

    /// Observer update over the interval that ends at this sample, corrected by the sample, and the torque of
    /// the law.
    #[allow(clippy::inline_always, reason = "a call and a copy would cost a fifth of the law")]
    #[inline(always)]
    pub(crate) fn sight(
        &self,
        state: &JointState<R>,
        m: &Measurement<R>,
        reference: &Reference<R>,
        interval: &SampleInterval<R>,
    ) -> Estimate<R> {
        let own = &self.position;
        let (e, de) = (m.q - reference.q, m.dq - reference.dq);
        let [phi, d1, d2, _] = state.memory;
        let mut z = Expected { e, de, phi: [phi, d1, d2] };
        let mut pending = state.pending;
        let mut filtered = None;
        if state.started {
            let [e_hat, de_hat] = state.motion;
            z = Expected { e: e_hat, de: de_hat, ..z };
            if interval.parts == 1 && interval.step == self.period {
                let fed = entry(&state.feedforward, own.delay, 0);
                z = z.after(&own.step, m.tau_applied - fed);
            } else {
                (z, pending) = self.carried_on(state, z, m.tau_applied, interval);
            }
            let (on_e, on_de) = (e - z.e, de - z.de);
            z.correct(&own.on_position, on_e);
            if own.hears_velocity {
                z.correct(&own.on_velocity, on_de);
            }
            if own.filter.acts {
                filtered = Some(own.filter.through(&state.filtered, on_e, interval.parts));
            }
        }
        let [phi, d1, d2] = z.phi;
        let [on_phi, on_d1, on_d2] = own.seen.phi;
        let wanted = (own.seen.e * z.e + own.seen.de * z.de)
            + (on_phi * phi + (on_d1 * d1 + on_d2 * d2))
            + weighed(&own.coming, &pending, own.delay);
        let wanted = match &filtered {
            Some(filtered) => wanted + own.filter.torque(filtered),
            None => wanted,
        };
        let [last, ..] = pending;
        let feedforward = self.inertia * reference.ddq;
        let demand = feedforward + last + own.share * (wanted - last);
        let parts = R::from_f64(f64::from(interval.parts));
        Estimate {
            memory: [phi, d1, d2, R::ZERO],
            beside: [z.e, z.de, feedforward, parts],
            phi_hat: phi,
            outer: demand - phi,
            filtered,
        }
    }

    /// State of the observer at the end of an interval that is not one period, and the torques on their way
    /// then.
    #[cold]
    #[inline(never)]
    fn carried_on(
        &self,
        state: &JointState<R>,
        from: Expected<R>,
        tau_applied: R,
        interval: &SampleInterval<R>,
    ) -> (Expected<R>, [R; PENDING_MAX]) {
        let own = &self.position;
        let step = own.step.times(interval.step / self.period);
        let mut z = from;
        let mut pending = state.pending;
        let [last, ..] = pending;
        for part in 0..interval.parts {
            let fed = entry(&state.feedforward, own.delay, part);
            z = z.after(&step, tau_applied - fed);
            if part > 0 {
                // A torque that nobody renewed was held.
                push(&mut pending, last);
            }
        }
        (z, pending)
    }

    /// The sample counts, and `state.tau` is what it was answered with.
    pub(crate) fn remember_seen(state: &mut JointState<R>, estimate: &Estimate<R>) {
        let [e, de, feedforward, parts] = estimate.beside;
        state.motion = [e, de];
        if let Some(filtered) = estimate.filtered {
            state.filtered = filtered;
        }
        if parts > R::from_f64(1.0) {
            Self::hold_through(state, parts);
        }
        push(&mut state.pending, state.tau - feedforward);
        push(&mut state.feedforward, feedforward);
    }

    /// Through periods without a sample the last torque is held.
    #[cold]
    #[inline(never)]
    fn hold_through(state: &mut JointState<R>, parts: R) {
        let ([last, ..], [fed, ..]) = (state.pending, state.feedforward);
        let one = R::from_f64(1.0);
        let mut left = parts;
        while left > one {
            push(&mut state.pending, last);
            push(&mut state.feedforward, fed);
            left = left - one;
        }
    }

    /// Makes `next` such that this law would have commanded `tau`, held for a while already.
    pub(crate) fn preset_seen(
        &self,
        next: &mut JointState<R>,
        m: &Measurement<R>,
        reference: &Reference<R>,
        tau: R,
    ) -> R {
        let own = &self.position;
        let (e, de) = (m.q - reference.q, m.dq - reference.dq);
        let fed = self.inertia * reference.ddq;
        let torque = tau - fed;
        // The torque is its own answer where φ̂⁺ − M̄ (K_d ė̂⁺ + K_p ê⁺) is it, d samples on.
        let ahead = self.period * R::from_f64(f64::from(own.delay));
        let share = ahead * (self.kd + R::from_f64(0.5) * ahead * self.kp);
        let force = self.kp * (e + ahead * de) + self.kd * de;
        let phi = torque + self.inertia * force / (R::from_f64(1.0) + share);
        next.memory = [phi, R::ZERO, R::ZERO, R::ZERO];
        next.motion = [e, de];
        next.filtered = Filtered::default();
        next.pending = [torque; PENDING_MAX];
        next.feedforward = [fed; PENDING_MAX + 1];
        phi
    }
}

impl<R: Real> JointState<R> {
    /// From positions: from here on so much more of the torque is fed forward \[N·m\], as if it always had
    /// been. `φ̂` is that much less, and so are the torques on their way; the innovation and the torque of
    /// the law stay the same.
    pub(crate) fn feed(&mut self, more: R) {
        let [phi, ..] = &mut self.memory;
        *phi = *phi - more;
        self.phi_hat = self.phi_hat - more;
        for torque in &mut self.pending {
            *torque = *torque - more;
        }
        for fed in &mut self.feedforward {
            *fed += more;
        }
    }

    /// From positions: the reference is another one from here on. `from` was in force at the last sample,
    /// `to` would have been, without acceleration. What is known of the joint, of `φ` and of the torques on
    /// their way stays.
    pub(crate) fn rebase(&mut self, from: &Reference<R>, to: &Reference<R>) {
        let [e, de] = &mut self.motion;
        *e += from.q - to.q;
        *de += from.dq - to.dq;
        for (torque, fed) in self.pending.iter_mut().zip(&mut self.feedforward) {
            *torque += *fed;
        }
        self.feedforward = [R::ZERO; PENDING_MAX + 1];
    }
}

#[cfg(test)]
mod tests {
    use crate::gains::FromPositions;
    use crate::joint::SampleInterval;
    use crate::{JointGains, JointState, Measurement, PositionDesign, Reference};

    const T: f64 = 1e-3;

    /// Nothing is corrected by what is seen but for rounding, so that only what is carried on counts.
    fn gains() -> JointGains<f64> {
        let design = PositionDesign {
            inertia: 0.5,
            kp: 400.0,
            kd: 40.0,
            correction: &[0.271, 28.5, -1000.0],
            velocity_correction: &[],
            share: 1.0,
            delay: 2,
            period: T,
        };
        JointGains::from_positions(&design).unwrap()
    }

    fn state() -> JointState<f64> {
        JointState {
            memory: [3.0, 0.0, 0.0, 0.0],
            motion: [2e-3, 0.1],
            pending: [5.0, 1.0, 1.0, 1.0],
            feedforward: [0.5, 2.5, -1.5, 0.0, 0.0],
            tau: 5.5,
            started: true,
            ..JointState::default()
        }
    }

    #[test]
    fn three_periods_at_once_are_three_periods() {
        let gains = gains();
        let reference = Reference { q: 0.0, dq: 0.0, ddq: 0.5 / 0.5 };
        // What acted in the three periods: the two torques that were on their way, then the last one, held.
        let acted = [1.0 - 1.5, 1.0 + 2.5, 5.0 + 0.5];
        let mut one_by_one = state();
        let mut last = None;
        for tau_applied in acted {
            let interval = SampleInterval { step: T, parts: 1, share: 1.0 };
            let blind = Measurement { q: 0.0, dq: 0.0, tau_applied };
            // Told where it is expected to be: no innovation.
            let at = |q: f64| {
                let m = Measurement { q, ..blind };
                gains.estimate::<FromPositions>(&one_by_one, &m, &reference, &interval)
            };
            let expected = at(0.0).beside[0] / (1.0 - 0.271);
            let estimate = at(expected);
            // Nobody hears of it: the torque stays.
            JointGains::remember::<FromPositions>(&mut one_by_one, &estimate, &blind);
            last = Some((expected, estimate));
        }
        let (expected, last) = last.unwrap();
        let interval = SampleInterval { step: T, parts: 3, share: 1.0 / 3.0 };
        let mean = acted.iter().sum::<f64>() / 3.0;
        let m = Measurement { q: expected, dq: 0.0, tau_applied: mean };
        let mut at_once = state();
        let estimate = gains.estimate::<FromPositions>(&at_once, &m, &reference, &interval);
        // When the torque changed within the three is lost with the mean: T² (5.5 + 0.5)/M̄ at most, in position.
        assert!((estimate.beside[0] - last.beside[0]).abs() < 1.2e-5);
        assert!((estimate.beside[1] - last.beside[1]).abs() < 5e-4);
        assert!((estimate.outer - last.outer).abs() < 0.05, "{} {}", estimate.outer, last.outer);
        JointGains::remember::<FromPositions>(&mut at_once, &estimate, &m);
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(same(&at_once.pending[..3], &one_by_one.pending[..3]), "{at_once:?}");
        assert!(same(&at_once.feedforward[..3], &one_by_one.feedforward[..3]), "{at_once:?}");
    }

    #[test]
    fn half_a_period_moves_a_quarter_as_far() {
        let gains = gains();
        let state = JointState { motion: [0.0, 0.0], memory: [0.0; 4], ..state() };
        let m = Measurement { q: 0.0, dq: 0.0, tau_applied: 1.0 - 1.5 };
        let moved = |step: f64| {
            let interval = SampleInterval { step, parts: 1, share: 1.0 };
            let at = gains.estimate::<FromPositions>(&state, &m, &Reference::default(), &interval);
            at.beside[0] / (1.0 - 0.271)
        };
        assert!((moved(T) - 0.5 * T * T / 0.5).abs() < 1e-15, "{}", moved(T));
        assert!((moved(0.5 * T) / moved(T) - 0.25).abs() < 1e-12);
    }
}
