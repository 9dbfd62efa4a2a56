//! Sums over the responses of all joints that answer, side by side, sample by sample.

use super::joint_sums::{ACTING, E, FREE, JointSums, KINDS, RowSums, STEP, V, withstood};
use super::moving_sums::MovingSums;
use super::rows::LossSums;
use super::starts::StartSizes;
use crate::coupled::abreast::{NONE, SampleResponses, WideKinds};
use crate::lanes::{Lane, Wide, add_size};

/// A list over the joints on which an input acts, or over pairs of joints, for each output.
type WideAnswers = [Vec<Wide>; KINDS];

/// Sums of up to [`WIDE`] joints that answer, up to the last sample.
pub(super) struct WideSums<'a> {
    moving: &'a MovingSums,
    /// First of these joints.
    first: usize,
    /// `M^{-1}`, and the identity, rows of these joints, by column.
    inverse: Vec<Wide>,
    identity: Vec<Wide>,
    period: f64,
    /// Samples after which products are bounded by products of sizes.
    long: usize,
    /// Node of the kernels, from 0; `None`: the input's own sample.
    node: Option<usize>,
    last: Vec<WideKinds>,
    /// `g'` of the interval before, of `e`.
    last_slope: Vec<Wide>,
    slopes: Vec<WideKinds>,
    jumps: Vec<Wide>,
    /// Step responses.
    whole: WideAnswers,
    torque: WideAnswers,
    ramp: WideAnswers,
    reading: WideAnswers,
    lasting: WideAnswers,
    impulse: WideAnswers,
    begun: StartSizes,
    rows: Option<LossSums>,
    start_moves: [Vec<Wide>; 2],
    slope: WideAnswers,
    aged: WideAnswers,
    bent: WideAnswers,
    turned: Vec<Wide>,
    gravity: WideAnswers,
    twice: Vec<Wide>,
    once: WideAnswers,
    late_age: WideAnswers,
    late_slope: Vec<Wide>,
    late_torque: WideAnswers,
    chords: [Vec<Wide>; 2],
}

impl<'a> WideSums<'a> {
    /// No sample yet, of joints from `first` on.
    pub(super) fn new(
        moving: &'a MovingSums,
        first: usize,
        (period, long): (f64, usize),
        rows: Option<LossSums>,
    ) -> Self {
        let n = moving.joints();
        let none = |count: usize| vec![Wide::ZERO; count];
        let each = || -> WideAnswers { core::array::from_fn(|_| none(n)) };
        let row = |j: usize| {
            Lane::of(|c| moving.inverse.get((first + c) * n + j).copied().unwrap_or(0.0))
        };
        Self {
            moving,
            first,
            inverse: (0..n).map(row).collect(),
            identity: (0..n).map(|j| Lane::of(|c| withstood(ACTING, first + c == j))).collect(),
            period,
            long,
            node: None,
            last: vec![NONE; n],
            last_slope: none(n),
            slopes: vec![NONE; n],
            jumps: none(n),
            whole: each(),
            torque: each(),
            ramp: each(),
            reading: each(),
            lasting: each(),
            impulse: each(),
            begun: StartSizes::new(n),
            rows,
            start_moves: [none(n), none(n)],
            slope: each(),
            aged: each(),
            bent: each(),
            turned: none(n),
            gravity: each(),
            twice: none(n * n),
            once: core::array::from_fn(|_| none(n * n)),
            late_age: each(),
            late_slope: none(n),
            late_torque: each(),
            chords: [none(n), none(n)],
        }
    }

    /// One more sample of all responses.
    pub(super) fn take(&mut self, shown: &SampleResponses) {
        match self.node {
            None => self.node = Some(0),
            Some(k) => {
                self.kernels(k, &shown.kick);
                if k > 0 {
                    self.interval(k - 1, &shown.kick);
                }
                self.last.copy_from_slice(&shown.kick);
                self.node = Some(k + 1);
            }
        }
        for (j, reading) in shown.reading.iter().enumerate() {
            for (sum, reading) in self.reading.iter_mut().zip(reading) {
                add_size(&mut sum[j], reading);
            }
        }
        self.begun.read(shown);
        if let Some(rows) = &mut self.rows {
            rows.take(shown);
        }
    }

    /// One more node `g(kT)` of the kernels, which are straight between nodes.
    fn kernels(&mut self, k: usize, now: &[WideKinds]) {
        let t = self.period;
        // Trapezes: the first node is the end of one interval only.
        let weight = if k == 0 { 0.5 * t } else { t };
        let age = k as f64 + 2.0;
        let early = k < self.long;
        for o in 0..KINDS {
            for (j, now) in now.iter().enumerate() {
                let size = now[o].size();
                let part = size.affine(weight, 0.0);
                self.torque[o][j].add_scaled(1.0, &part);
                let aged = Lane::of(|c| part[c] * age * t);
                self.aged[o][j].add_scaled(1.0, &aged);
                if k > 0 {
                    let both = Lane::of(|c| now[o][c] + self.last[j][o][c]);
                    self.whole[o][j].add_scaled(0.5 * t, &both);
                }
                // What is left of a torque that goes on moves the arm.
                let mut net = self.whole[o][j];
                if o == FREE {
                    net.add_scaled(1.0, &self.inverse[j]);
                } else if o == ACTING {
                    net.add_scaled(1.0, &self.identity[j]);
                }
                let net = net.size();
                self.ramp[o][j].add_scaled(weight, &net);
                self.lasting[o][j] = self.lasting[o][j].larger(&net);
                self.impulse[o][j] = self.impulse[o][j].larger(&size);
                if !early || o >= ACTING {
                    self.late_torque[o][j].add_scaled(1.0, &part);
                }
                if o == E {
                    self.start_moves[1][j] = self.start_moves[1][j].larger(&size);
                }
            }
        }
        if early {
            for o in [E, V, STEP] {
                self.moving.gravity_columns.add_sizes(&mut self.gravity[o], weight, |l| now[l][o]);
            }
            for o in [V, STEP] {
                self.moving.blocks[2].add_sizes(&mut self.once[o], weight, |l| now[l][o]);
            }
        }
    }

    /// The interval that is `m` samples old at its young end: slope `g' = H_m M^{-1}` of the kernels.
    fn interval(&mut self, m: usize, now: &[WideKinds]) {
        let t = self.period;
        let (age, older) = (m as f64 * t, (m as f64 + 1.0) * t);
        let early = m < self.long;
        let bend = 0.5 * (older + t) * (older + t) * t;
        for (j, (now, last)) in now.iter().zip(&self.last).enumerate() {
            for o in 0..KINDS {
                let slope = Lane::of(|c| (now[o][c] - last[o][c]) / t);
                let size = slope.size();
                self.slope[o][j].add_scaled(t, &size);
                if o != E {
                    self.bent[o][j].add_scaled(bend, &size);
                    if o >= ACTING || !early {
                        // What acts is that of the sample, up to a sample later.
                        let held = if o == ACTING { t } else { 0.0 };
                        self.late_age[o][j].add_scaled((older + held) * t, &size);
                    }
                }
                if o == FREE {
                    self.chords[0][j].add_scaled(age + older + 2.0 * t, &size);
                    self.chords[1][j].add_scaled(t, &size);
                }
                self.slopes[j][o] = slope;
            }
        }
        let (slopes, masses) = (&self.slopes, &self.moving.mass_columns);
        self.begun.interval(|j, o| masses.product(j, |l| slopes[l][o]).size());
        if early {
            for o in [V, STEP] {
                let out = &mut self.once[o];
                self.moving.blocks[0].add_sizes(out, older * t, |l| slopes[l][o]);
            }
        }
        self.of_error(m, early);
    }

    /// The same of `e`, which is integrated twice: its slope, and how it jumps there.
    fn of_error(&mut self, m: usize, early: bool) {
        let t = self.period;
        let age = m as f64 * t;
        let middle = age + 0.5 * t;
        for (j, slopes) in self.slopes.iter().enumerate() {
            let slope = &slopes[E];
            let jump = if m == 0 { Wide::ZERO } else { slope.minus(&self.last_slope[j]) };
            let (size, jumped) = (slope.size(), jump.size());
            self.bent[E][j].add_scaled(0.5 * middle * middle, &jumped);
            self.turned[j].add_scaled((age + t) * t, &size);
            let moves = size.affine(age + t, 0.0);
            self.start_moves[0][j] = self.start_moves[0][j].larger(&moves);
            if !early {
                self.late_age[E][j].add_scaled(age, &jumped);
                self.late_slope[j].add_scaled(t, &size);
            }
            self.last_slope[j] = *slope;
            self.jumps[j] = jump;
        }
        if early {
            let (jumps, slopes) = (&self.jumps, &self.slopes);
            self.moving.blocks[0].add_sizes(&mut self.twice, age, |l| jumps[l]);
            self.moving.blocks[1].add_sizes(&mut self.twice, t, |l| slopes[l][E]);
        }
    }

    /// The sums of one of the joints; readings add at most `later` after the last sample.
    pub(super) fn joint(&self, c: usize, later: &[[f64; KINDS]]) -> JointSums {
        let steps: Vec<f64> = later.iter().map(|own| own[STEP]).collect();
        let n = self.moving.joints();
        let (lost, rows) = match &self.rows {
            Some(rows) => rows.joint(c, &steps),
            None => (core::array::from_fn(|_| vec![0.0; n]), RowSums::default()),
        };
        let list = |own: &[Wide]| -> Vec<f64> { own.iter().map(|own| own[c]).collect() };
        let each = |own: &WideAnswers| core::array::from_fn(|o| list(&own[o]));
        JointSums {
            n,
            joint: self.first + c,
            period: self.period,
            whole: each(&self.whole),
            torque: each(&self.torque),
            ramp: each(&self.ramp),
            reading: each(&self.reading),
            lasting: each(&self.lasting),
            impulse: each(&self.impulse),
            start: self.begun.beyond_readings(c),
            lost,
            rows,
            start_moves: [list(&self.start_moves[0]), list(&self.start_moves[1])],
            slope: each(&self.slope),
            aged: each(&self.aged),
            bent: each(&self.bent),
            turned: list(&self.turned),
            gravity: each(&self.gravity),
            twice: list(&self.twice),
            once: each(&self.once),
            late_age: each(&self.late_age),
            late_slope: list(&self.late_slope),
            late_torque: each(&self.late_torque),
            chords: [list(&self.chords[0]), list(&self.chords[1])],
        }
    }

    /// The sums over rows of lost commands, where they are counted.
    pub(super) fn rows(&mut self) -> Option<&mut LossSums> {
        self.rows.as_mut()
    }
}
