//! The law of one joint per unit of `M̄`, whatever its form, from the core's linear system: sample by sample for
//! several runs at once, and its transfer functions.

use phihat::{GainError, LinearLaw};
use phihat_certificate::JointRecord;

use super::model::LoopModel;
use super::polynomial::SampledPolynomial;
use crate::lanes::Lane;

/// Most main states of a law: see [`LinearLaw::main`].
const MAIN: usize = 5;

/// Most states behind them.
const BEHIND: usize = phihat::LINEAR_STATES_MAX - MAIN;

/// Places of the inputs of [`LinearLaw`]; a law depends on `q` and `q_d` by `e` alone, which stands at the first.
const E: usize = 0;
const DQ: usize = 1;
const ACTED: usize = 2;
const DQ_DESIRED: usize = 4;
const DDQ_DESIRED: usize = 5;

/// Law of one joint per unit of `M̄`.
#[derive(Debug, Clone)]
pub(crate) struct Law {
    /// The non-zero entries of the main states, where they lie in an order that a shorter loop is written for.
    pattern: Pattern,
    bands: Bands,
    linear: LinearLaw<f64>,
    /// `F_ξ + ℓ N_ξ` of the main states.
    change: [[f64; MAIN]; MAIN],
    /// `G_u + ℓ N_u` of the main states: of `e`, of the torque that acted, of `q̇`.
    driven: [[f64; 3]; MAIN],
    /// `F_ξ` of the states behind them, and `ℓ`.
    change_behind: [[f64; BEHIND]; BEHIND],
    correction_behind: [f64; BEHIND],
    /// `F_ξ` of the second state of each pair behind them, where these are pairs: [`step_pair`].
    pairs: Option<[[f64; 2]; BEHIND / 2]>,
    /// Number of leading states that are in the torque.
    outputs: usize,
    uses_velocity: bool,
    /// True if `e` or `q̇` is in the torque of the same sample by itself.
    direct: bool,
    register: Option<usize>,
}

/// Non-zero entries of the main states' matrices. A pattern is read from the numbers; one that none of these has is run
/// with whole matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pattern {
    /// `ν` is `e` less the first state one sample on; each state is driven by the next one, the first by the third too,
    /// and the first two by the torque that acted.
    Predicting,
    /// `ν` by the first state, the register, the torque that acted and `q̇`; each state is driven by the next one and
    /// `ν`. The register is the last one.
    Driven,
    Whole,
}

/// The numbers of a pattern, side by side.
#[derive(Debug, Clone, Copy, Default)]
struct Bands {
    /// `F_ξ` of the next state in each state, and of the third in the first.
    next: [f64; MAIN],
    third: f64,
    /// `G_u` of the torque that acted in the first two.
    acted: [f64; 2],
    /// `ℓ`.
    correction: [f64; MAIN],
    /// `N` of the first state, the register, the torque that acted and `q̇`.
    innovation: [f64; 4],
}

impl Bands {
    fn of(linear: &LinearLaw<f64>) -> Self {
        let last = linear.main.saturating_sub(1);
        let own = |list: &[f64]| core::array::from_fn(|i| list[i]);
        Self {
            next: core::array::from_fn(|i| if i < last { linear.change[i][i + 1] } else { 0.0 }),
            third: linear.change[0][2],
            acted: [linear.driven[0][ACTED], linear.driven[1][ACTED]],
            correction: own(&linear.correction),
            innovation: [
                linear.innovation[0],
                linear.innovation[last],
                linear.innovation_input[ACTED],
                linear.innovation_input[DQ],
            ],
        }
    }

    /// A sample of [`Pattern::Predicting`].
    #[expect(clippy::inline_always, reason = "the states stay in registers")]
    #[inline(always)]
    fn predict<const W: usize, const M: usize>(
        &self,
        states: &mut [Lane<W>],
        [error, acted, _]: &[Lane<W>; 3],
    ) -> Lane<W> {
        let Some(states) = states.first_chunk_mut::<M>() else { return Lane::ZERO };
        let mut x = *states;
        for i in 0..M - 1 {
            let next = x[i + 1];
            x[i].add_scaled(self.next[i], &next);
            if i == 0 {
                let third = x[2];
                x[0].add_scaled(self.third, &third);
            }
            if i < 2 {
                x[i].add_scaled(self.acted[i], acted);
            }
        }
        let innovation = error.minus(&x[0]);
        for i in 0..M {
            x[i].add_scaled(self.correction[i], &innovation);
        }
        *states = x;
        innovation
    }

    /// A sample of [`Pattern::Driven`]; `M` counts all states but the register.
    #[expect(clippy::inline_always, reason = "the states stay in registers")]
    #[inline(always)]
    fn drive<const W: usize, const M: usize>(
        &self,
        states: &mut [Lane<W>],
        [_, acted, velocity]: &[Lane<W>; 3],
    ) -> Lane<W> {
        let Some((states, [register, ..])) = states.split_first_chunk_mut::<M>() else {
            return Lane::ZERO;
        };
        let mut x = *states;
        let [by_first, by_register, by_acted, by_velocity] = self.innovation;
        let mut innovation = acted.affine(by_acted, 0.0);
        innovation.add_scaled(by_first, &x[0]);
        innovation.add_scaled(by_velocity, velocity);
        innovation.add_scaled(by_register, register);
        for i in 0..M - 1 {
            let next = x[i + 1];
            x[i].add_scaled(self.next[i], &next);
        }
        for i in 0..M {
            x[i].add_scaled(self.correction[i], &innovation);
        }
        *states = x;
        *register = *velocity;
        innovation
    }
}

/// Transfer functions of a law over a common denominator, in `w = z − 1`.
#[derive(Debug, Clone)]
pub(crate) struct Transfer {
    /// `A_o`.
    pub(crate) whole: SampledPolynomial,
    /// `A_o` times what `e` does to the torque.
    pub(crate) error: SampledPolynomial,
    /// `A_o` times what `q̇` does; `None`: nothing.
    pub(crate) velocity: Option<SampledPolynomial>,
    /// `A_o/z` times what the torque that acted until this sample does.
    pub(crate) acted: SampledPolynomial,
}

impl Law {
    /// The law of gains in a loop.
    ///
    /// # Errors
    ///
    /// Those of the core, where it does not run them.
    pub(crate) fn of(record: &JointRecord, model: &LoopModel) -> Result<Self, GainError> {
        let unit = JointRecord { inertia_kg_m2: 1.0, ..record.clone() };
        Ok(Self::from_linear(&unit.core_gains_in(model)?.linear()))
    }

    /// The law of gains that the core runs; else one whose torque is no number, so that no claim about it holds.
    pub(crate) fn or_none(record: &JointRecord, model: &LoopModel) -> Self {
        Self::of(record, model).unwrap_or_else(|_| {
            let mut linear = LinearLaw::default();
            linear.direct = [f64::NAN; phihat::LINEAR_INPUTS];
            Self::from_linear(&linear)
        })
    }

    fn from_linear(linear: &LinearLaw<f64>) -> Self {
        let main = linear.main;
        let mut law = Self {
            change: [[0.0; MAIN]; MAIN],
            driven: [[0.0; 3]; MAIN],
            change_behind: [[0.0; BEHIND]; BEHIND],
            correction_behind: [0.0; BEHIND],
            pattern: Pattern::of(linear),
            bands: Bands::of(linear),
            pairs: pairs(linear),
            outputs: linear.output.iter().rposition(|x| *x != 0.0).map_or(0, |last| last + 1),
            uses_velocity: false,
            direct: linear.direct[E] != 0.0 || linear.direct[DQ] != 0.0,
            register: (0..main).find(|r| is_register(linear, *r)),
            linear: *linear,
        };
        for i in 0..main {
            let gain = law.linear.correction[i];
            for j in 0..main {
                law.change[i][j] = law.linear.change[i][j] + gain * law.linear.innovation[j];
            }
            law.driven[i] = [E, ACTED, DQ].map(|input| law.column(input, i));
        }
        for i in main..law.linear.states {
            law.correction_behind[i - main] = law.linear.correction[i];
            let row = &law.linear.change[i][main..law.linear.states];
            law.change_behind[i - main][..row.len()].copy_from_slice(row);
        }
        let on_velocity = law.driven.iter().any(|row| row[2] != 0.0);
        law.uses_velocity = on_velocity || law.linear.direct[DQ] != 0.0;
        law
    }

    /// `G_u + ℓ N_u` of an input on a state.
    fn column(&self, input: usize, state: usize) -> f64 {
        self.linear.driven[state][input]
            + self.linear.correction[state] * self.linear.innovation_input[input]
    }

    /// Number of states.
    pub(crate) fn length(&self) -> usize {
        self.linear.states
    }

    /// Number of torques of the last samples that it uses.
    pub(crate) fn sent(&self) -> usize {
        self.linear.sent
    }

    /// Samples until a feed-forward is subtracted from the torque that acted, where it is.
    pub(crate) fn feed_forward(&self) -> Option<usize> {
        self.linear.feed_forward
    }

    /// Units of the states: rad/s^k.
    pub(crate) fn powers(&self) -> &[i8] {
        &self.linear.powers[..self.linear.states]
    }

    /// True if the measured velocity is in its torque.
    pub(crate) fn uses_velocity(&self) -> bool {
        self.uses_velocity
    }

    /// True if the torque that acted is in its torque.
    pub(crate) fn uses_torque(&self) -> bool {
        self.driven.iter().any(|row| row[1] != 0.0)
    }

    /// Number of states before the one that is the velocity of the sample before; where there is none, of all.
    pub(crate) fn before_register(&self) -> usize {
        self.register.unwrap_or(self.linear.states)
    }

    /// State that is the velocity of the sample before.
    pub(crate) fn register(&self) -> Option<usize> {
        self.register
    }

    /// States one sample on, from `e`, the torque that acted, less its feed-forward, and `q̇`.
    #[expect(clippy::inline_always, reason = "a call each would cost a quarter of a sample")]
    #[inline(always)]
    pub(crate) fn step<const W: usize>(&self, states: &mut [Lane<W>], inputs: &[Lane<W>; 3]) {
        let (main, behind) = states.split_at_mut(self.linear.main);
        // Of a length that is known when compiled, all of it stays in registers.
        let innovation = match (self.pattern, main.len()) {
            (Pattern::Predicting, 3) => self.bands.predict::<W, 3>(main, inputs),
            (Pattern::Predicting, 4) => self.bands.predict::<W, 4>(main, inputs),
            (Pattern::Predicting, _) => self.bands.predict::<W, MAIN>(main, inputs),
            (Pattern::Driven, 2) => self.bands.drive::<W, 1>(main, inputs),
            (Pattern::Driven, 3) => self.bands.drive::<W, 2>(main, inputs),
            (Pattern::Driven, 4) => self.bands.drive::<W, 3>(main, inputs),
            (Pattern::Driven, _) => self.bands.drive::<W, { MAIN - 1 }>(main, inputs),
            (Pattern::Whole, _) => self.step_whole_of_any(main, inputs),
        };
        match &self.pairs {
            _ if behind.is_empty() => {}
            Some(pairs) => {
                for (pair, factors) in behind.chunks_exact_mut(2).zip(pairs) {
                    step_pair(pair, factors, &innovation);
                }
            }
            None => self.step_behind(behind, &innovation),
        }
    }

    /// The main states of any pattern, and `ν`.
    #[inline(never)]
    fn step_whole_of_any<const W: usize>(
        &self,
        main: &mut [Lane<W>],
        inputs: &[Lane<W>; 3],
    ) -> Lane<W> {
        let innovation = self.innovation(main, inputs);
        match main.len() {
            1 => self.step_whole::<W, 1>(main, inputs),
            2 => self.step_whole::<W, 2>(main, inputs),
            3 => self.step_whole::<W, 3>(main, inputs),
            4 => self.step_whole::<W, 4>(main, inputs),
            _ => self.step_whole::<W, MAIN>(main, inputs),
        }
        innovation
    }

    /// The main states, by whole matrices.
    #[inline]
    fn step_whole<const W: usize, const M: usize>(
        &self,
        states: &mut [Lane<W>],
        inputs: &[Lane<W>; 3],
    ) {
        let Some(states) = states.first_chunk_mut::<M>() else { return };
        let before = *states;
        let [error, acted, velocity] = inputs;
        for i in 0..M {
            let mut sum = before[i];
            for j in 0..M {
                sum.add_scaled(self.change[i][j], &before[j]);
            }
            for (factor, input) in self.driven[i].iter().zip([error, acted, velocity]) {
                sum.add_scaled(*factor, input);
            }
            states[i] = sum;
        }
    }

    /// `ν`, by what the main states are before the sample.
    #[inline]
    fn innovation<const W: usize>(&self, main: &[Lane<W>], inputs: &[Lane<W>; 3]) -> Lane<W> {
        let mut sum = Lane::<W>::ZERO;
        let by_input = [E, ACTED, DQ].map(|input| self.linear.innovation_input[input]);
        let terms = self.linear.innovation.iter().zip(main).chain(by_input.iter().zip(inputs));
        for (factor, x) in terms {
            sum.add_scaled(*factor, x);
        }
        sum
    }

    /// The states behind the main ones, with whole matrices.
    fn step_behind<const W: usize>(&self, states: &mut [Lane<W>], innovation: &Lane<W>) {
        let mut before = [Lane::ZERO; BEHIND];
        before[..states.len()].copy_from_slice(states);
        for (i, state) in states.iter_mut().enumerate() {
            for (factor, x) in self.change_behind[i].iter().zip(&before) {
                state.add_scaled(*factor, x);
            }
            state.add_scaled(self.correction_behind[i], innovation);
        }
    }

    /// Torque command over `M̄` without [`Self::forward`], from the states after the sample, `e` and `q̇`; `sent`
    /// are the torques of the last samples, less their feed-forward, the newest first.
    #[inline]
    pub(crate) fn torque<const W: usize>(
        &self,
        states: &[Lane<W>],
        sent: &[Lane<W>],
        (error, velocity): (&Lane<W>, &Lane<W>),
    ) -> Lane<W> {
        let mut torque = self.indirect(states, sent);
        if self.direct {
            torque.add_scaled(self.linear.direct[E], error);
            torque.add_scaled(self.linear.direct[DQ], velocity);
        }
        torque
    }

    /// `C_ξ ξ⁺ + Σ C_r,j r_{k−j}`.
    #[inline]
    fn indirect<const W: usize>(&self, states: &[Lane<W>], sent: &[Lane<W>]) -> Lane<W> {
        let mut torque = weighed(&self.linear.output, &states[..self.outputs]);
        match sent {
            [] => {}
            [newest] => torque.add_scaled(self.linear.output_sent[0], newest),
            _ => torque.add_scaled(1.0, &weighed(&self.linear.output_sent, sent)),
        }
        torque
    }

    /// Factor of the acceleration fed forward at the sample before in its torque.
    pub(crate) fn forward_before(&self) -> f64 {
        self.linear.output_forward
    }

    /// Torque over `M̄` that the reference's velocity and acceleration add.
    pub(crate) fn forward(&self, velocity: f64, acceleration: f64) -> f64 {
        let direct = &self.linear.direct;
        direct[DQ_DESIRED] * velocity + direct[DDQ_DESIRED] * acceleration
    }

    /// States after the first sample, from `e`, `q̇` and `q̇_d`.
    pub(crate) fn begin<const W: usize>(
        &self,
        states: &mut [Lane<W>],
        (error, velocity): (&Lane<W>, &Lane<W>),
        velocity_desired: f64,
    ) {
        for (state, row) in states.iter_mut().zip(&self.linear.start) {
            if row.iter().any(|factor| *factor != 0.0) {
                let rest = row[DQ_DESIRED] * velocity_desired;
                *state = Lane::of(|c| row[E] * error[c] + row[DQ] * velocity[c] + rest);
            }
        }
    }

    /// Changes the state that takes up a difference so that the torque is higher by `more`.
    pub(crate) fn resume<const W: usize>(&self, states: &mut [Lane<W>], more: &Lane<W>) {
        let at = self.linear.resumed;
        for c in 0..W {
            states[at][c] += more[c] / self.linear.output[at];
        }
    }

    /// Torque that is wanted less the torque sent last, but for a factor.
    pub(crate) fn lag<const W: usize>(&self, states: &[Lane<W>], sent: &[Lane<W>]) -> Lane<W> {
        let torque = self.indirect(states, sent);
        Lane::of(|c| torque[c] - sent[0][c])
    }

    /// Torque sent last, where the newest of `sent` is [`Self::lag`] in its place.
    pub(crate) fn sent_last<const W: usize>(
        &self,
        states: &[Lane<W>],
        sent: &[Lane<W>],
    ) -> Lane<W> {
        let weight = self.linear.output_sent[0];
        let torque = self.indirect(states, sent);
        Lane::of(|c| (torque[c] - (1.0 + weight) * sent[0][c]) / (1.0 - weight))
    }

    /// Adds a true motion, so many times, to the states that estimate it: those that the first sample sets, of a law
    /// that stores its torques.
    pub(crate) fn add_motion<const W: usize>(
        &self,
        states: &mut [Lane<W>],
        (error, velocity): (&Lane<W>, &Lane<W>),
        times: f64,
    ) {
        for (state, row) in states.iter_mut().zip(&self.linear.start) {
            for c in 0..W {
                state[c] += times * (row[E] * error[c] + row[DQ] * velocity[c]);
            }
        }
    }

    /// Weights of the torques of the last samples, with `z^d`, `d` at least their number: `z^d − Σ C_r,j z^{d−j}`.
    pub(crate) fn on_sent(&self, d: usize) -> SampledPolynomial {
        let weights = self.linear.output_sent.iter().take(self.linear.sent).enumerate();
        weights.fold(SampledPolynomial::z_power(d), |sum, (j, weight)| {
            sum.plus(&SampledPolynomial::z_power(d - 1 - j).scaled(-weight))
        })
    }

    /// The transfer functions.
    ///
    /// # Method
    ///
    /// Adjugate and determinant of `w − (F_ξ + ℓ N_ξ)` by Faddeev and LeVerrier in units of `T`, where no power of `T`
    /// is added to 1. A state that is the velocity of the sample before is an input here, `q̇/z`.
    pub(crate) fn transfer(&self, period: f64) -> Transfer {
        let linear = &self.linear;
        let rows: Vec<usize> = (0..linear.states).filter(|i| Some(*i) != self.register).collect();
        let unit = |i: usize| {
            let power = linear.powers[i];
            let base = if power < 0 { period.recip() } else { period };
            (0..power.unsigned_abs()).fold(1.0, |unit, _| unit * base)
        };
        let entry =
            |i: usize, j: usize| linear.change[i][j] + linear.correction[i] * linear.innovation[j];
        let own: Vec<Vec<f64>> = rows
            .iter()
            .map(|i| rows.iter().map(|j| entry(*i, *j) * (unit(*i) / unit(*j))).collect())
            .collect();
        let output: Vec<f64> = rows.iter().map(|i| linear.output[*i] / unit(*i)).collect();
        let column = |of: &dyn Fn(usize) -> f64| -> Vec<f64> {
            rows.iter().map(|i| of(*i) * unit(*i)).collect()
        };
        let columns = [
            column(&|i| self.column(E, i)),
            column(&|i| self.column(ACTED, i)),
            column(&|i| self.column(DQ, i)),
            column(&|i| self.register.map_or(0.0, |register| entry(i, register))),
        ];
        let (whole, [error, acted, velocity, before]) = faddeev(&own, &output, &columns);
        // z p_v + p_before, of which p_v + p_before is small.
        let velocity = velocity.raised(1).plus(&velocity.plus(&before));
        let direct = |input: usize| whole.scaled(linear.direct[input]);
        Transfer {
            error: error.times(&SampledPolynomial::z_power(1)).plus(&direct(E)),
            velocity: self.uses_velocity.then(|| velocity.plus(&direct(DQ))),
            acted,
            whole,
        }
    }
}

impl Pattern {
    fn of(linear: &LinearLaw<f64>) -> Self {
        if Self::is_predicting(linear) {
            Self::Predicting
        } else if Self::is_driven(linear) {
            Self::Driven
        } else {
            Self::Whole
        }
    }

    fn is_predicting(linear: &LinearLaw<f64>) -> bool {
        let main = linear.main;
        let follows = |i: usize, j: usize| j == i + 1 || (i == 0 && j == 2);
        (3..=MAIN).contains(&main)
            && all_zero(main, linear, follows)
            && (0..main).all(|i| {
                // ν = e − ξ_0 − F_0 ξ − G_0 u.
                let own = if i == 0 { 1.0 } else { 0.0 };
                is(linear.innovation[i], -(own + linear.change[0][i]))
                    && (0..ACTED).all(|input| is(linear.driven[i][input], 0.0))
                    && (i < 2 || is(linear.driven[i][ACTED], 0.0))
            })
            && is(linear.innovation_input[E], 1.0)
            && is(linear.innovation_input[DQ], 0.0)
            && is(linear.innovation_input[ACTED], -linear.driven[0][ACTED])
    }

    fn is_driven(linear: &LinearLaw<f64>) -> bool {
        let Some(last) = linear.main.checked_sub(1).filter(|last| (1..MAIN).contains(last)) else {
            return false;
        };
        is_register(linear, last)
            && all_zero(last, linear, |i, j| j == i + 1)
            && (0..last).all(|i| {
                is(linear.change[i][last], 0.0)
                    && (i == 0 || is(linear.innovation[i], 0.0))
                    && [E, DQ, ACTED].into_iter().all(|input| is(linear.driven[i][input], 0.0))
            })
            && is(linear.innovation_input[E], 0.0)
    }
}

/// Returns true if `F_ξ` of so many leading states is zero but for these entries.
fn all_zero(length: usize, linear: &LinearLaw<f64>, but: impl Fn(usize, usize) -> bool) -> bool {
    (0..length).all(|i| (0..length).all(|j| but(i, j) || is(linear.change[i][j], 0.0)))
}

/// Factors of `x` and `δ` in `δ` of pairs behind the main states, where all of them are `x ← x + δ`,
/// `δ ← δ + c_0 x + c_1 δ + ν`.
fn pairs(linear: &LinearLaw<f64>) -> Option<[[f64; 2]; BEHIND / 2]> {
    let mut pairs = [[0.0; 2]; BEHIND / 2];
    for (first, pair) in (linear.main..linear.states).step_by(2).zip(&mut pairs) {
        let second = first + 1;
        let as_pair = |j: usize| {
            let one = if j == second { 1.0 } else { 0.0 };
            is(linear.change[first][j], one)
                && (j == first || j == second || is(linear.change[second][j], 0.0))
        };
        let corrected = is(linear.correction[first], 0.0) && is(linear.correction[second], 1.0);
        if second >= linear.states || !corrected || !(linear.main..linear.states).all(as_pair) {
            return None;
        }
        *pair = [linear.change[second][first], linear.change[second][second]];
    }
    Some(pairs)
}

/// One sample of such a pair.
#[inline]
fn step_pair<const W: usize>(
    pair: &mut [Lane<W>],
    [by_x, by_change]: &[f64; 2],
    innovation: &Lane<W>,
) {
    let [x, change] = pair else { return };
    let mut next = *innovation;
    next.add_scaled(*by_x, x);
    next.add_scaled(*by_change, change);
    x.add_scaled(1.0, change);
    change.add_scaled(1.0, &next);
}

/// Returns true if two numbers are the same, but for the sign of zero.
fn is(a: f64, b: f64) -> bool {
    (a - b).abs() <= 0.0
}

/// Returns true if a state is the velocity of the sample before.
fn is_register(linear: &LinearLaw<f64>, state: usize) -> bool {
    let own = |j: usize| if j == state { -1.0 } else { 0.0 };
    let velocity = |input: usize| if input == DQ { 1.0 } else { 0.0 };
    (0..linear.states).all(|j| is(linear.change[state][j], own(j)))
        && linear.driven[state].iter().enumerate().all(|(i, x)| is(*x, velocity(i)))
        && is(linear.correction[state], 0.0)
        && is(linear.output[state], 0.0)
}

/// `det(w − A)`, and `c adj(w − A) b` of each column `b`, by Faddeev and LeVerrier.
fn faddeev<const K: usize>(
    a: &[Vec<f64>],
    c: &[f64],
    columns: &[Vec<f64>; K],
) -> (SampledPolynomial, [SampledPolynomial; K]) {
    // N_{n−1} = 1, N_{k−1} = A N_k + c_k: adj = Σ N_k w^k, row by row from the left.
    let n = a.len();
    let mut left = c.to_vec();
    let mut numerators = [(); K].map(|()| vec![0.0; n]);
    let mut whole = vec![0.0; n + 1];
    whole[n] = 1.0;
    let mut matrix = identity(n);
    for k in (0..n).rev() {
        for (numerator, column) in numerators.iter_mut().zip(columns) {
            numerator[k] = left.iter().zip(column).map(|(a, b)| a * b).sum();
        }
        let next = product(a, &matrix);
        let trace: f64 = (0..n).map(|i| next[i][i]).sum();
        whole[k] = -trace / (n - k) as f64;
        matrix = next;
        for (i, line) in matrix.iter_mut().enumerate() {
            line[i] += whole[k];
        }
        left = (0..n).map(|j| (0..n).map(|i| c[i] * matrix[i][j]).sum()).collect();
    }
    (SampledPolynomial::new(whole), numerators.map(SampledPolynomial::new))
}

/// `Σ weight x`, run by run; of lengths that are known when compiled, without a loop.
#[inline]
fn weighed<const W: usize>(weights: &[f64], x: &[Lane<W>]) -> Lane<W> {
    match x.len() {
        0 => Lane::ZERO,
        1 => weighed_all::<W, 1>(weights, x),
        2 => weighed_all::<W, 2>(weights, x),
        3 => weighed_all::<W, 3>(weights, x),
        4 => weighed_all::<W, 4>(weights, x),
        5 => weighed_all::<W, 5>(weights, x),
        6 => weighed_all::<W, 6>(weights, x),
        7 => weighed_all::<W, 7>(weights, x),
        8 => weighed_all::<W, 8>(weights, x),
        _ => weighed_all::<W, { phihat::LINEAR_STATES_MAX }>(weights, x),
    }
}

#[inline]
fn weighed_all<const W: usize, const M: usize>(weights: &[f64], x: &[Lane<W>]) -> Lane<W> {
    let mut sum = Lane::<W>::ZERO;
    let (Some(weights), Some(x)) = (weights.first_chunk::<M>(), x.first_chunk::<M>()) else {
        return sum;
    };
    for (weight, x) in weights.iter().zip(x) {
        sum.add_scaled(*weight, x);
    }
    sum
}

fn identity(n: usize) -> Vec<Vec<f64>> {
    (0..n).map(|i| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect()).collect()
}

fn product(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = a.len();
    let entry = |i: usize, j: usize| (0..n).map(|k| a[i][k] * b[k][j]).sum();
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;
    use phihat::{Form, TorqueSource, VelocitySource};
    use phihat_certificate::{FilterSection, JointRecord, LoopModel, PositionObserver};

    use super::{Law, Pattern};
    use crate::lanes::Lane;

    const T: f64 = 1e-3;

    fn record(a: &[f64], observer: Option<PositionObserver>) -> JointRecord {
        JointRecord {
            name: String::new(),
            inertia_kg_m2: 0.3,
            kp_per_s2: 700.0,
            kd_per_s: 60.0,
            a: a.to_vec(),
            observer,
        }
    }

    /// A law from positions of an order that filters its innovation with so many sections.
    fn positions(order: usize, sections: usize, delay_samples: u32) -> JointRecord {
        // Sampled poles at 0.9; at 0.93, 0.94, 0.95, 0.96; at 0.9.
        let correction = [
            vec![0.271, 28.5, -1000.0],
            vec![0.2028, 15.77, -543.0, -8.4e3],
            vec![0.40951, 85.85625, -9267.5, -4.85e5, -1e7],
        ];
        let filter = [([0.02, 0.3], [3000.0, -500.0]), ([0.4, 1.1], [-800.0, 9000.0])];
        let section = |(rates, weights_per_s2): &([f64; 2], [f64; 2])| FilterSection {
            rates: *rates,
            weights_per_s2: *weights_per_s2,
        };
        let correction = correction[order - 1].clone();
        let innovation_filter = filter[..sections].iter().map(section).collect();
        let observer =
            PositionObserver { correction, share: 0.3, delay_samples, innovation_filter };
        record(&[], Some(observer))
    }

    /// Laws of every form.
    fn laws() -> Vec<Law> {
        let a: [&[f64]; 4] =
            [&[70.0], &[4900.0, 140.0], &[3.4e5, 1.5e4, 210.0], &[2.4e7, 1.4e6, 2.9e4, 280.0]];
        let mut all = Vec::new();
        let model = |form, torque_filter_hz| LoopModel {
            period_s: T,
            delay_samples: 0,
            sample_delay_samples: 0,
            torque: TorqueSource::Applied,
            velocity: VelocitySource::Measured,
            velocity_filter_hz: None,
            torque_filter_hz,
            form,
            drive_bandwidth_hz: None,
        };
        for form in [Form::Observer, Form::Literal] {
            let of = |hz| a.map(|a| Law::of(&record(a, None), &model(form, hz)).unwrap());
            all.extend([None, Some(100.0)].into_iter().flat_map(of));
        }
        for (order, sections, delay) in
            [(1, 0, 1), (1, 1, 1), (1, 2, 1), (2, 2, 0), (3, 2, 3), (3, 1, 2)]
        {
            let record = positions(order, sections, delay);
            all.push(Law::of(&record, &model(Form::Positions, None)).unwrap());
        }
        all
    }

    #[test]
    fn transfer_functions_are_those_of_the_samples() {
        for law in laws() {
            let transfer = law.transfer(T);
            let none = transfer.error.scaled(0.0);
            let velocity = transfer.velocity.clone().unwrap_or(none);
            for angle in [0.01, 0.3, 2.0] {
                // Outside of the circle an impulse is summed up soon.
                let z = Complex::from_polar(1.1, angle);
                let w = z - 1.0;
                let numerators = [transfer.error.at(w), z * transfer.acted.at(w), velocity.at(w)];
                for (input, numerator) in numerators.into_iter().enumerate() {
                    let zero = Lane([0.0]);
                    let mut states = vec![zero; law.length()];
                    let sent = vec![zero; law.sent()];
                    let (mut sum, mut power) = (Complex::new(0.0, 0.0), Complex::new(1.0, 0.0));
                    for k in 0..600 {
                        let mut u = [zero; 3];
                        u[input] = Lane([if k == 0 { 1.0 } else { 0.0 }]);
                        law.step(&mut states, &u);
                        sum += power * law.torque(&states, &sent, (&u[0], &u[2]))[0];
                        power /= z;
                    }
                    let ratio = numerator / transfer.whole.at(w);
                    let size = 1e-6 + ratio.norm();
                    assert!((sum - ratio).norm() < 1e-8 * size, "{law:?} {angle}: {sum} {ratio}");
                }
            }
        }
    }

    #[test]
    fn a_pattern_is_its_whole_matrices() {
        let patterns = laws().iter().map(|law| law.pattern).collect::<Vec<_>>();
        for pattern in [Pattern::Predicting, Pattern::Driven, Pattern::Whole] {
            assert!(patterns.contains(&pattern), "{pattern:?}");
        }
        for law in laws() {
            let whole = Law { pattern: Pattern::Whole, pairs: None, ..law.clone() };
            let mut own = vec![Lane::<2>::ZERO; law.length()];
            let mut other = own.clone();
            let mut size = vec![0.0_f64; law.length()];
            for k in 0..40 {
                let inputs = [1e-3, 5.0, 0.1].map(|unit| {
                    Lane::<2>::of(|run| unit * (((7 * k + 3 * run + 5) % 11) as f64 - 5.0))
                });
                law.step(&mut own, &inputs);
                whole.step(&mut other, &inputs);
                for ((own, other), size) in own.iter().zip(&other).zip(&mut size) {
                    *size = size.max(other[0].abs());
                    assert!((own[0] - other[0]).abs() <= 1e-12 * *size, "{law:?} {k}");
                }
            }
            assert!(size.iter().all(|size| *size > 0.0));
        }
    }

    #[test]
    fn several_runs_are_each_run() {
        for law in laws() {
            let mut wide = vec![Lane::<3>::ZERO; law.length()];
            let mut alone = [(); 3].map(|()| vec![Lane::<1>::ZERO; law.length()]);
            for k in 0..20 {
                let input = |run: usize, i: usize| ((7 * k + 3 * run + 5 * i) % 11) as f64 - 5.0;
                let inputs = |i: usize| Lane::<3>::of(|run| input(run, i));
                law.step(&mut wide, &[inputs(0), inputs(1), inputs(2)]);
                for (run, alone) in alone.iter_mut().enumerate() {
                    let one = |i: usize| Lane([input(run, i)]);
                    law.step(alone, &[one(0), one(1), one(2)]);
                    for (wide, alone) in wide.iter().zip(alone) {
                        assert_eq!(wide[run].to_bits(), alone[0].to_bits());
                    }
                }
            }
        }
    }
}
