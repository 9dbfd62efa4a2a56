//! The law of one joint between limits, as one sampled linear system.

use crate::delay::PENDING_MAX;
use crate::gains::Path;
use crate::innovation::SECTIONS_MAX;
use crate::position_design::STATES;
use crate::position_gains::Correction;
use crate::{Form, JointGains, Real};

/// States of a law at most: five of an observer, two of each section of its filter.
pub const LINEAR_STATES_MAX: usize = STATES + 2 * SECTIONS_MAX;

/// Inputs of a law at a sample: `q, q̇, τ_applied, q_d, q̇_d, q̈_d`.
pub const LINEAR_INPUTS: usize = 6;

/// Torques of the last samples that a law uses at most.
pub const LINEAR_SENT_MAX: usize = PENDING_MAX;

/// Places of the inputs.
const Q: usize = 0;
const DQ: usize = 1;
const ACTED: usize = 2;
const Q_DESIRED: usize = 3;
const DQ_DESIRED: usize = 4;
const DDQ_DESIRED: usize = 5;

/// A number per state.
type States<R> = [R; LINEAR_STATES_MAX];

/// A number per input.
type Inputs<R> = [R; LINEAR_INPUTS];

/// The law of one joint between limits, over one nominal period, as one sampled linear system.
///
/// # Law
///
/// With the inputs `u = (q, q̇, a, q_d, q̇_d, q̈_d)`, the state `ξ` and the torques `r` of the last samples:
///
/// ```text
/// a_k = τ_applied,k − f_{k−1−d}                   f_k = M̄ q̈_d,k where the law subtracts its feed-forward, else 0
/// ν   = N_ξ ξ + N_u u                              innovation
/// ξ⁺  = ξ + F_ξ ξ + G_u u + ℓ ν
/// τ_k = C_ξ ξ⁺ + D_u u + Σ_{j ≥ 1} C_r,j r_{k−j} + C_f f_{k−1}   torque command [N·m]
/// r_k = τ_k − f_k
/// ```
///
/// At the first sample `ξ⁺ = G_0 u` in the rows of `G_0` that are not zero, and `ξ⁺ = ξ` in the others. Every
/// form of the law is such a system; which form it was is not in it. The numbers are those of
/// [`JointGains::update`], as a test finds by running that with a unit of each input and of each state.
///
/// # Not claimed
///
/// Limits, and intervals that are not one period, are outside of it.
///
/// # Example
///
/// ```
/// use phihat::{Form, JointDesign, JointGains};
///
/// let design = JointDesign {
///     inertia: 0.8, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
/// };
/// let law = JointGains::<f64>::new(&design)?.linear();
///
/// // φ̂, its derivative, and the velocity of the sample before.
/// assert_eq!(law.states, 3);
/// // A radian of error costs M̄ K_p.
/// assert_eq!(law.direct[0], -0.8 * 400.0);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct LinearLaw<R> {
    /// Number of states in use.
    pub states: usize,
    /// Number of leading states that depend on no state behind them; those behind are driven by `ν` alone.
    pub main: usize,
    /// Unit of each state: rad/s^k, of torques and their derivatives after division by `M̄`.
    pub powers: [i8; LINEAR_STATES_MAX],
    /// `N_ξ`.
    pub innovation: States<R>,
    /// `N_u`.
    pub innovation_input: Inputs<R>,
    /// `F_ξ`, a row per state.
    pub change: [States<R>; LINEAR_STATES_MAX],
    /// `G_u`, a row per state.
    pub driven: [Inputs<R>; LINEAR_STATES_MAX],
    /// `ℓ`.
    pub correction: States<R>,
    /// `G_0`, a row per state.
    pub start: [Inputs<R>; LINEAR_STATES_MAX],
    /// `C_ξ`.
    pub output: States<R>,
    /// `D_u`.
    pub direct: Inputs<R>,
    /// Number of torques of the last samples in use.
    pub sent: usize,
    /// `C_r`, the newest first.
    pub output_sent: [R; LINEAR_SENT_MAX],
    /// `C_f`: what a low-pass on the torque command lets through of the feed-forward of the sample before.
    pub output_forward: R,
    /// `d`, where the law subtracts its feed-forward from the torque that acted \[samples\].
    pub feed_forward: Option<usize>,
    /// State that [`JointGains::resume`] sets so that the torque command is a given one.
    pub resumed: usize,
}

impl<R: Real> LinearLaw<R> {
    /// A law of so many states whose torque is zero.
    fn of(states: usize) -> Self {
        Self { states, main: states, ..Self::default() }
    }
}

impl<R: Real> JointGains<R> {
    /// The law between limits as one sampled linear system, for whoever computes with it; the limits are left out.
    #[must_use]
    pub fn linear(&self) -> LinearLaw<R> {
        let law = match self.form {
            Form::Observer => self.linear_observer(),
            Form::Literal => self.linear_literal(),
            Form::Positions => self.linear_positions(),
        };
        if self.path == Path::Filtered { self.low_pass(law) } else { law }
    }

    /// A law behind the low-pass on its torque command: of the torque of the sample before a part stays.
    fn low_pass(&self, law: LinearLaw<R>) -> LinearLaw<R> {
        let share = self.torque_share;
        let stays = R::from_f64(1.0) - share;
        let mut out = LinearLaw {
            output: law.output.map(|x| share * x),
            direct: law.direct.map(|x| share * x),
            output_sent: law.output_sent.map(|x| share * x),
            sent: law.sent.max(1),
            ..law
        };
        let [newest, ..] = &mut out.output_sent;
        *newest += stays;
        if law.feed_forward.is_some() {
            out.output_forward = stays;
        }
        out
    }

    /// `D_u` of `M̄ (q̈_d − K_d ė − K_p e)` with factors `more` of `e` and `ė` in addition.
    fn outer_direct(&self, [more_e, more_de]: [R; 2]) -> Inputs<R> {
        let (on_e, on_de) = (self.inertia * (self.kp + more_e), self.inertia * (self.kd + more_de));
        [-on_e, -on_de, R::ZERO, on_e, on_de, self.inertia]
    }

    /// State: `φ̂_0 … φ̂_{m−1}`, velocity of the sample before.
    fn linear_observer(&self) -> LinearLaw<R> {
        let (m, t, one) = (self.order, self.period, R::from_f64(1.0));
        let mut law = LinearLaw::of(m + 1);
        put(&mut law.innovation, 0, -t);
        put(&mut law.innovation, m, self.inertia);
        put(&mut law.innovation_input, DQ, -self.inertia);
        put(&mut law.innovation_input, ACTED, t);
        for (j, alpha) in self.alpha.iter().enumerate().take(m) {
            put(&mut law.correction, j, *alpha);
            put(&mut law.powers, j, power(2 + j));
            if j + 1 < m {
                put_in(&mut law.change, j, j + 1, t);
            }
        }
        put(&mut law.powers, m, 1);
        put_in(&mut law.change, m, m, -one);
        put_in(&mut law.driven, m, DQ, one);
        put_in(&mut law.start, m, DQ, one);
        put(&mut law.output, 0, one);
        law.direct = self.outer_direct([R::ZERO; 2]);
        law
    }

    /// State: `∫e, ∬e, …`.
    fn linear_literal(&self) -> LinearLaw<R> {
        let m = self.order;
        let mut law = LinearLaw::of(m);
        for (i, factor) in self.on_integrals.iter().enumerate().take(m) {
            // A sum sums what the one before it has become.
            let mut step = self.period;
            for j in (0..i).rev() {
                put_in(&mut law.change, i, j, step);
                step = step * self.period;
            }
            put_in(&mut law.driven, i, Q, step);
            put_in(&mut law.driven, i, Q_DESIRED, -step);
            put(&mut law.output, i, -(self.inertia * *factor));
            put(&mut law.powers, i, -power(1 + i));
        }
        law.direct = self.outer_direct(self.on_error);
        law.resumed = m.saturating_sub(1);
        law
    }

    /// State: `ê, ė̂, φ̂_0 … φ̂_{m−1}`, then `x`, `δ` of each section of the filter.
    fn linear_positions(&self) -> LinearLaw<R> {
        let (own, m, one) = (&self.position, self.order, R::from_f64(1.0));
        let main = 2 + m;
        // A section that nobody gave has no rates.
        let given = |([c0, _], _): &(&[R; 2], &[R; 2])| *c0 > R::ZERO;
        let filter = own.filter.rates.iter().zip(&own.filter.weights).take_while(given);
        let sections = filter.clone().count();
        let mut law = LinearLaw { main, ..LinearLaw::of(main + 2 * sections) };
        self.motion(&mut law);
        let [on_phi, on_d1, on_d2] = own.seen.phi;
        let weights = [own.seen.e, own.seen.de, on_phi, on_d1, on_d2];
        for (i, weight) in weights.into_iter().enumerate().take(main) {
            put(&mut law.output, i, own.share * weight);
            put(&mut law.powers, i, power(i));
        }
        for (section, ([c0, c1], [on_x, on_change])) in filter.enumerate() {
            let (x, change) = (main + 2 * section, main + 2 * section + 1);
            put_in(&mut law.change, x, change, one);
            put_in(&mut law.change, change, x, -*c0);
            put_in(&mut law.change, change, change, -*c1);
            put(&mut law.correction, change, one);
            put(&mut law.output, x, own.share * *on_x);
            put(&mut law.output, change, own.share * *on_change);
        }
        for (out, weight) in law.output_sent.iter_mut().zip(&own.coming) {
            *out = own.share * *weight;
        }
        let [newest, ..] = &mut law.output_sent;
        *newest += one - own.share;
        let delay = usize::from(own.delay);
        law.sent = delay.max(1);
        law.feed_forward = Some(delay);
        put(&mut law.direct, DDQ_DESIRED, self.inertia);
        law.resumed = 2;
        law
    }

    /// The observer of a law from positions: the joint's motion over one period, corrected by the innovations of
    /// position and velocity.
    fn motion(&self, law: &mut LinearLaw<R>) {
        let (own, m, one) = (&self.position, self.order, R::from_f64(1.0));
        let step = &own.step;
        put_in(&mut law.change, 0, 1, step.t);
        put_in(&mut law.change, 0, 2, -step.position);
        put_in(&mut law.driven, 0, ACTED, step.position);
        put_in(&mut law.change, 1, 2, -step.velocity);
        put_in(&mut law.driven, 1, ACTED, step.velocity);
        for j in 3..2 + m {
            put_in(&mut law.change, j - 1, j, step.t);
        }
        // ν = e − ê, ν_v = ė − ė̂, both before they correct anything.
        law.innovation_input = [one, R::ZERO, -step.position, -one, R::ZERO, R::ZERO];
        law.innovation = row([-one, -step.t, step.position]);
        law.correction = row(all(&own.on_position, m));
        if own.hears_velocity {
            let (by_state, by_input) = ([R::ZERO, -one, step.velocity], -step.velocity);
            for (i, gain) in all(&own.on_velocity, m).into_iter().enumerate() {
                for (j, factor) in by_state.into_iter().enumerate() {
                    add_in(&mut law.change, i, j, gain * factor);
                }
                add_in(&mut law.driven, i, DQ, gain);
                add_in(&mut law.driven, i, DQ_DESIRED, -gain);
                add_in(&mut law.driven, i, ACTED, gain * by_input);
            }
        }
        put_in(&mut law.start, 0, Q, one);
        put_in(&mut law.start, 0, Q_DESIRED, -one);
        put_in(&mut law.start, 1, DQ, one);
        put_in(&mut law.start, 1, DQ_DESIRED, -one);
    }
}

/// Factors of an innovation on `ê`, `ė̂`, `φ̂_0 … φ̂_{m−1}`.
fn all<R: Real>(by: &Correction<R>, m: usize) -> [R; STATES] {
    let mut factors = [by.e, by.de, R::ZERO, R::ZERO, R::ZERO];
    for (into, phi) in factors.iter_mut().skip(2).zip(&by.phi).take(m) {
        *into = *phi;
    }
    factors
}

/// A row that begins with these numbers.
fn row<R: Real, const K: usize>(first: [R; K]) -> States<R> {
    let mut row = [R::ZERO; LINEAR_STATES_MAX];
    for (into, value) in row.iter_mut().zip(first) {
        *into = value;
    }
    row
}

/// An exponent of a unit.
fn power(k: usize) -> i8 {
    i8::try_from(k).unwrap_or(i8::MAX)
}

fn put<V>(list: &mut [V], at: usize, value: V) {
    if let Some(entry) = list.get_mut(at) {
        *entry = value;
    }
}

fn put_in<R, const K: usize>(rows: &mut [[R; K]], at: usize, column: usize, value: R) {
    if let Some(row) = rows.get_mut(at) {
        put(row, column, value);
    }
}

fn add_in<R: Real, const K: usize>(rows: &mut [[R; K]], at: usize, column: usize, value: R) {
    if let Some(entry) = rows.get_mut(at).and_then(|row| row.get_mut(column)) {
        *entry += value;
    }
}

#[cfg(test)]
mod tests {
    //! The matrices are those of `update`. Wrong if a unit of any input or state, or a run from the first sample on,
    //! gave another torque or another state than the code that runs on a robot.

    use super::{LINEAR_INPUTS, LINEAR_SENT_MAX, LINEAR_STATES_MAX, LinearLaw};
    use crate::delay::PENDING_MAX;
    use crate::{
        Form, InnovationSection, JointDesign, JointGains, JointState, Measurement, PositionDesign,
        Reference,
    };

    const T: f64 = 1e-3;

    /// All that a law remembers.
    #[derive(Debug, Clone, Copy)]
    struct Remembered {
        states: [f64; LINEAR_STATES_MAX],
        sent: [f64; LINEAR_SENT_MAX],
        feed_forward: [f64; PENDING_MAX + 1],
        inertia: f64,
    }

    const NOTHING: Remembered = Remembered {
        states: [0.0; LINEAR_STATES_MAX],
        sent: [0.0; LINEAR_SENT_MAX],
        feed_forward: [0.0; PENDING_MAX + 1],
        inertia: 0.4,
    };

    /// Number of states behind the main ones.
    fn behind(gains: &JointGains<f64>) -> usize {
        let law = gains.linear();
        law.states - law.main
    }

    impl Remembered {
        /// From the state that the core has.
        fn of(gains: &JointGains<f64>, state: &JointState<f64>) -> Self {
            let m = gains.order;
            let behind = behind(gains);
            let mut out = NOTHING;
            match gains.form {
                Form::Observer => {
                    out.states[..m].copy_from_slice(&state.memory[..m]);
                    out.states[m] = state.dq;
                    out.sent[0] = if gains.linear().sent > 0 { state.tau } else { 0.0 };
                }
                Form::Literal => {
                    out.states[..m].copy_from_slice(&state.memory[..m]);
                    out.sent[0] = if gains.linear().sent > 0 { state.tau } else { 0.0 };
                }
                Form::Positions => {
                    out.states[..2].copy_from_slice(&state.motion);
                    out.states[2..2 + m].copy_from_slice(&state.memory[..m]);
                    let filtered = &state.filtered.as_flattened()[..behind];
                    out.states[2 + m..][..behind].copy_from_slice(filtered);
                    out.sent = state.pending;
                    out.feed_forward = state.feedforward;
                }
            }
            out
        }

        /// The state that the core has.
        fn state(&self, gains: &JointGains<f64>) -> JointState<f64> {
            let m = gains.order;
            let behind = behind(gains);
            let mut state = JointState { started: true, ..JointState::default() };
            match gains.form {
                Form::Observer => {
                    state.memory[..m].copy_from_slice(&self.states[..m]);
                    state.dq = self.states[m];
                    state.tau = self.sent[0];
                }
                Form::Literal => {
                    state.memory[..m].copy_from_slice(&self.states[..m]);
                    state.tau = self.sent[0];
                }
                Form::Positions => {
                    state.motion.copy_from_slice(&self.states[..2]);
                    state.memory[..m].copy_from_slice(&self.states[2..2 + m]);
                    let filtered = &mut state.filtered.as_flattened_mut()[..behind];
                    filtered.copy_from_slice(&self.states[2 + m..][..behind]);
                    state.pending = self.sent;
                    state.feedforward = self.feed_forward;
                    state.tau = self.sent[0] + self.feed_forward[0];
                }
            }
            state
        }

        /// One sample of the matrices: the torque.
        fn step(
            &mut self,
            law: &LinearLaw<f64>,
            inputs: &[f64; LINEAR_INPUTS],
            first: bool,
        ) -> f64 {
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let fed = law.feed_forward.is_some();
            let mut u = *inputs;
            if let Some(delay) = law.feed_forward {
                u[2] -= self.feed_forward[delay];
            }
            let before = self.states;
            let innovation = dot(&law.innovation, &before) + dot(&law.innovation_input, &u);
            for i in 0..law.states {
                if !first {
                    self.states[i] += dot(&law.change[i], &before)
                        + dot(&law.driven[i], &u)
                        + law.correction[i] * innovation;
                } else if law.start[i].iter().any(|x| x.abs() > 0.0) {
                    self.states[i] = dot(&law.start[i], &u);
                }
            }
            let torque = dot(&law.output, &self.states)
                + dot(&law.direct, &u)
                + dot(&law.output_sent[..law.sent], &self.sent)
                + law.output_forward * self.feed_forward[0];
            let forward = if fed { self.inertia * u[5] } else { 0.0 };
            if fed {
                self.feed_forward.rotate_right(1);
                self.feed_forward[0] = forward;
            }
            if law.sent > 0 {
                self.sent.rotate_right(1);
                self.sent[0] = torque - forward;
                // Of a law that does not subtract its feed-forward, one is stored.
                let stored = if fed { LINEAR_SENT_MAX } else { 1 };
                self.sent[stored..].fill(0.0);
            }
            torque
        }

        fn numbers(&self) -> impl Iterator<Item = f64> {
            self.states.into_iter().chain(self.sent).chain(self.feed_forward)
        }
    }

    /// Every form, order, delay and filter, with a low-pass on the torque and without one.
    fn each(mut visit: impl FnMut(&str, &JointGains<f64>)) {
        each_form(|what, gains| {
            visit(what, gains);
            visit(what, &gains.with_torque_filter(Some(100.0)).unwrap());
        });
    }

    fn each_form(mut visit: impl FnMut(&str, &JointGains<f64>)) {
        let a: [&[f64]; 4] =
            [&[70.0], &[4900.0, 140.0], &[3.4e5, 1.5e4, 210.0], &[2.4e7, 1.4e6, 2.9e4, 280.0]];
        for a in a {
            for form in [Form::Observer, Form::Literal] {
                let design = JointDesign { inertia: 0.4, kp: 400.0, kd: 35.0, a, period: T, form };
                visit("velocity", &JointGains::new(&design).unwrap());
            }
        }
        // Sampled poles at 0.9; at 0.93, 0.94, 0.95, 0.96; at 0.9.
        let corrections: [&[f64]; 3] = [
            &[0.271, 28.5, -1000.0],
            &[0.2028, 15.77, -543.0, -8.4e3],
            &[0.40951, 85.85625, -9267.5, -4.85e5, -1e7],
        ];
        for correction in corrections {
            for delay in 0..=PENDING_MAX {
                let zero = [0.0; 5];
                let mut velocity = zero;
                velocity[..3].copy_from_slice(&[1e-4, 0.02, -0.1]);
                for velocity_correction in [&[][..], &velocity[..correction.len()]] {
                    let design = PositionDesign {
                        inertia: 0.4,
                        kp: 700.0,
                        kd: 60.0,
                        correction,
                        velocity_correction,
                        share: 0.4,
                        delay,
                        period: T,
                    };
                    let gains = JointGains::from_positions(&design).unwrap();
                    visit("positions", &gains);
                    let section = |rates| InnovationSection { rates, weights: [300.0, -50.0] };
                    let sections = [section([0.02, 0.3]), section([0.5, 1.2])];
                    for count in 1..=2 {
                        let filtered = gains.with_innovation_filter(&sections[..count]).unwrap();
                        visit("filtered", &filtered);
                    }
                }
            }
        }
    }

    fn update(gains: &JointGains<f64>, state: &mut JointState<f64>, u: &[f64; 6]) -> f64 {
        let measurement = Measurement { q: u[0], dq: u[1], tau_applied: u[2] };
        let reference = Reference { q: u[3], dq: u[4], ddq: u[5] };
        gains.update(state, &measurement, &reference).tau
    }

    fn same(a: f64, b: f64, size: f64) -> bool {
        (a - b).abs() <= 1e-12 * size
    }

    #[test]
    fn a_unit_of_each_input_and_state_is_what_update_makes_of_it() {
        let mut count = 0;
        each(|what, gains| {
            let law = gains.linear();
            let mut play = |from: Remembered, u: [f64; 6]| {
                let mut state = from.state(gains);
                let torque = update(gains, &mut state, &u);
                let mut own = from;
                let own_torque = own.step(&law, &u, false);
                let size = 1.0 + torque.abs();
                assert!(same(torque, own_torque, size), "{what} {u:?}: {torque} {own_torque}");
                let now = Remembered::of(gains, &state);
                for (a, b) in now.numbers().zip(own.numbers()) {
                    assert!(same(a, b, size + a.abs()), "{what} {from:?} {u:?}: {now:?} {own:?}");
                }
                count += 1;
            };
            for i in 0..LINEAR_INPUTS {
                let mut u = [0.0; LINEAR_INPUTS];
                u[i] = 1.0;
                play(NOTHING, u);
            }
            for i in 0..law.states {
                let mut from = NOTHING;
                from.states[i] = 1.0;
                play(from, [0.0; LINEAR_INPUTS]);
            }
            for i in 0..law.sent {
                let mut from = NOTHING;
                from.sent[i] = 1.0;
                play(from, [0.0; LINEAR_INPUTS]);
            }
            let Some(delay) = law.feed_forward else { return };
            for i in 0..=delay {
                let mut from = NOTHING;
                from.feed_forward[i] = 1.0;
                play(from, [0.0; LINEAR_INPUTS]);
            }
        });
        assert!(count > 1000, "{count}");
    }

    #[test]
    fn a_run_from_the_first_sample_on() {
        each(|what, gains| {
            let law = gains.linear();
            let (mut state, mut own) = (JointState::new(), NOTHING);
            let mut most = 1.0_f64;
            for k in 0..40 {
                let of = |i: usize| f64::from((k * 7 + 13 * u32::try_from(i).unwrap()) % 11) - 5.0;
                let u: [f64; 6] = core::array::from_fn(of);
                let torque = update(gains, &mut state, &u);
                let own_torque = own.step(&law, &u, k == 0);
                most = most.max(torque.abs());
                assert!(same(torque, own_torque, 1e2 * most), "{what} {k}: {torque} {own_torque}");
            }
        });
    }

    #[test]
    fn a_given_torque_is_resumed_by_one_state() {
        each(|what, gains| {
            let law = gains.linear();
            let u = [0.3, -0.2, 0.0, 0.1, 0.4, 0.6];
            let measurement = Measurement { q: u[0], dq: u[1], tau_applied: u[2] };
            let reference = Reference { q: u[3], dq: u[4], ddq: u[5] };
            let mut state = JointState::new();
            assert!(gains.resume(&mut state, &measurement, &reference, 2.0));
            let resumed = Remembered::of(gains, &state);
            // That state again, from the others: the torque is what it was for long.
            let forward = if law.feed_forward.is_some() { 0.4 * u[5] } else { 0.0 };
            let mut rest = [2.0 - forward; LINEAR_SENT_MAX];
            rest[law.sent..].fill(0.0);
            let feed_forward = [forward; PENDING_MAX + 1];
            let mut own = Remembered { sent: rest, feed_forward, ..NOTHING };
            let without = own.step(&law, &u, true);
            let number = (2.0 - without) / law.output[law.resumed];
            let other = resumed.states[law.resumed];
            assert!(same(number, other, 10.0 + 10.0 * other.abs()), "{what}: {number} {other}");
        });
    }

    #[test]
    fn states_behind_the_main_ones_are_driven_by_the_innovation_alone() {
        each(|_, gains| {
            let law = gains.linear();
            for row in &law.change[..law.main] {
                assert!(row[law.main..].iter().all(|x| x.abs() <= 0.0));
            }
            assert!(law.innovation[law.main..].iter().all(|x| x.abs() <= 0.0));
            for i in law.main..law.states {
                assert!(law.change[i][..law.main].iter().all(|x| x.abs() <= 0.0));
                assert!(law.driven[i].iter().all(|x| x.abs() <= 0.0));
            }
            // A law is one of e.
            let opposite = |row: &[f64; 6]| row[0].to_bits() == (-row[3]).to_bits();
            let rows = law.driven.iter().chain([&law.innovation_input, &law.direct]);
            assert!(rows.filter(|row| row[0].abs() > 0.0).all(opposite));
        });
    }
}
