//! The loop played forward: what a law's response makes of the other responses.

use super::programme::Programme;

/// Position and velocity after `φ`, after the encoder, and the sum of the position after `φ`.
pub(super) const STATES: usize = 5;

/// Responses of a loop, sample by sample, in the programme's units.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Responses {
    /// `e` after a unit error of the encoder.
    pub(super) read: Vec<f64>,
    /// `e` after a unit of `φ/M` for one sample.
    pub(super) jump: Vec<f64>,
    /// `T Σ e` of that: `e` after a ramp.
    pub(super) ramp: Vec<f64>,
    /// State of the loop after the last sample, velocities at [1] and [3]; a law's response has ended where
    /// it is 0.
    pub(super) end: [f64; STATES],
}

impl Responses {
    /// Plays
    ///
    /// ```text
    /// e^n_{k+1} = e^n_k + β v^n_k + β²/2 u_k,   v^n_{k+1} = v^n_k + β u_k,   u_k = ρ_{k−d}
    /// e^φ_{k+1} = e^φ_k + β v^φ_k − β²/2 w_k,   v^φ_{k+1} = v^φ_k − β w_k,   w_k = δ_k + e^n_k
    /// ```
    ///
    /// with `β = T W`: the torque that answers `φ` is `−e^n`, because `φ` moves the joint as the torque does.
    pub(super) fn of(programme: &Programme, r: &[f64]) -> Self {
        let mut state = ResponseState::default();
        let (mut read, mut jump, mut ramp) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..programme.length {
            read.push(state.read);
            jump.push(state.jump);
            ramp.push(state.ramp);
            state.step(programme, r, k, if k == 0 { 1.0 } else { 0.0 });
        }
        Self { read, jump, ramp, end: state.ends() }
    }

    /// Contribution of the law alone after each sample, without `φ`: linear in `ρ`.
    pub(super) fn added(programme: &Programme, r: &[f64]) -> Vec<[f64; STATES]> {
        let mut state = ResponseState::default();
        let each = (0..programme.length).map(|k| {
            state.step(programme, r, k, 0.0);
            state.ends()
        });
        each.collect()
    }

    /// L1 norms of the responses to `φ̇`, `φ_J` and the encoder.
    pub(super) fn sums(&self) -> [f64; 3] {
        [&self.ramp, &self.jump, &self.read].map(|signal| signal.iter().map(|x| x.abs()).sum())
    }
}

/// `Σ|ρ_k − ρ_{k−1}|`, with 0 before and after.
pub(super) fn change(r: &[f64]) -> f64 {
    let before = core::iter::once(&0.0).chain(r);
    let after = r.iter().chain([&0.0]);
    before.zip(after).map(|(before, after)| (after - before).abs()).sum()
}

#[derive(Default)]
struct ResponseState {
    read: f64,
    read_rate: f64,
    jump: f64,
    jump_rate: f64,
    ramp: f64,
}

impl ResponseState {
    fn step(&mut self, programme: &Programme, r: &[f64], k: usize, phi: f64) {
        let (a, half) = (programme.step, programme.half());
        let torque = k.checked_sub(programme.delay).and_then(|k| r.get(k)).copied().unwrap_or(0.0);
        let left = phi + self.read;
        self.read += a * self.read_rate + half * torque;
        self.read_rate += a * torque;
        self.jump += a * self.jump_rate - half * left;
        self.jump_rate -= a * left;
        self.ramp += a * self.jump;
    }

    fn ends(&self) -> [f64; STATES] {
        [self.read, self.read_rate, self.jump, self.jump_rate, self.ramp]
    }
}
