//! Sums over impulse responses of the linear time-varying loop, by lag, and what is left beyond them.

use super::deviation::Deviation;
use super::lanes::{Lane, WIDE};
use super::linear::Interval;
use super::scene::Scene;
use crate::sampled::mean_of_line;

/// What kernels are computed from.
pub(super) struct Course<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) intervals: &'a [Interval],
    /// `6 × n` per sample where a payload is carried: the twist of the middle of its box, in the frame's axes.
    pub(super) jacobians: &'a [Vec<f64>],
    /// Samples per bin.
    pub(super) bin: usize,
}

/// Where inputs stand in a kernel: torque, momentum (`x`), position reading, payload's momentum, velocity reading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inputs {
    pub(super) n: usize,
    pub(super) twist: usize,
    pub(super) speed: usize,
}

impl Inputs {
    #[allow(clippy::unused_self, reason = "a place like the others")]
    pub(super) fn torque(self) -> usize {
        0
    }
    pub(super) fn momentum(self) -> usize {
        self.n
    }
    pub(super) fn reading(self) -> usize {
        2 * self.n
    }
    pub(super) fn payload(self) -> usize {
        3 * self.n
    }
    pub(super) fn velocity(self) -> usize {
        3 * self.n + self.twist
    }
    pub(super) fn count(self) -> usize {
        3 * self.n + self.twist + self.speed
    }

    /// Outputs: `ε`, `w`, twist of the payload, command, its change.
    pub(super) fn rows(self) -> usize {
        4 * self.n + self.twist
    }
    pub(super) fn command_row(self) -> usize {
        2 * self.n + self.twist
    }
}

/// Sums of one launch.
#[derive(Debug)]
pub(super) struct Kernel {
    pub(super) lags: usize,
    /// `[lag][row][input]`: at least `Σ |response|` over the samples of a lag.
    sums: Vec<f32>,
    inputs: usize,
    rows: usize,
    /// Per input: size of the state where the sums end, in the scale of [`Scale`].
    pub(super) left: Vec<f64>,
    /// Sample at which they end.
    pub(super) end: usize,
}

impl Kernel {
    pub(super) fn lag(&self, lag: usize, row: usize) -> &[f32] {
        let at = (lag * self.rows + row) * self.inputs;
        &self.sums[at..at + self.inputs]
    }
}

/// A unit for each state of the loop, so that their sizes compare; 0 for one that nothing moves.
pub(super) type Scale = Vec<f64>;

impl<'a> Course<'a> {
    /// The interval from sample `t`; beyond the run, the last one goes on.
    fn interval(&self, t: usize) -> &'a Interval {
        &self.intervals[t.min(self.intervals.len() - 1)]
    }

    fn jacobian(&self, t: usize) -> &'a [f64] {
        self.jacobians.get(t.min(self.jacobians.len().saturating_sub(1))).map_or(&[], Vec::as_slice)
    }

    pub(super) fn inputs(&self) -> Inputs {
        let n = self.scene.n;
        let twist = if self.jacobians.is_empty() { 0 } else { 6 };
        Inputs { n, twist, speed: if self.scene.measured_velocity { n } else { 0 } }
    }

    /// Columns that are stepped: torque at the interval's end and at its start, kick of position, readings.
    fn columns(&self) -> usize {
        let n = self.scene.n;
        4 * n + self.inputs().speed
    }

    /// The runs just after interval `s`, whose inputs were 1.
    fn launched(&self, s: usize) -> (Vec<Deviation<WIDE>>, Vec<Vec<Lane<WIDE>>>) {
        let (scene, n) = (self.scene, self.scene.n);
        let interval = self.interval(s);
        let packs = self.columns().div_ceil(WIDE);
        let mut runs = Vec::with_capacity(packs);
        let mut commands = Vec::with_capacity(packs);
        for pack in 0..packs {
            let column = |c: usize| pack * WIDE + c;
            let mut run = Deviation::<WIDE>::new(scene);
            let reading = |kind: usize| {
                move |i: usize| -> Lane<WIDE> {
                    core::array::from_fn(|c| f64::from(u8::from(column(c) == kind * n + i)))
                }
            };
            let (position, velocity) = (reading(3), reading(4));
            let none = |_: usize| [0.0; WIDE];
            run.step(scene, (s, interval), |i| (position(i), velocity(i)), none);
            commands.push(run.control.command.clone());
            for c in 0..WIDE {
                let (kind, j) = (column(c) / n, column(c) % n);
                for i in 0..n {
                    let unit = interval.inverse[i * n + j];
                    match kind {
                        0 => run.state[n + i][c] += unit,
                        1 => {
                            for row in [i, n + i] {
                                let start = &interval.step[row * 2 * n + n..(row + 1) * 2 * n];
                                let sum: f64 =
                                    (0..n).map(|k| start[k] * interval.inverse[k * n + j]).sum();
                                run.state[row][c] += sum;
                            }
                        }
                        2 => run.state[i][c] += unit,
                        _ => {}
                    }
                }
            }
            runs.push(run);
        }
        (runs, commands)
    }

    /// The sums of a launch at sample `s`, up to sample `end`.
    pub(super) fn kernel(&self, s: usize, end: usize, scale: &Scale) -> Kernel {
        let inputs = self.inputs();
        let (rows, count) = (inputs.rows(), inputs.count());
        let lags = (end - s).div_ceil(self.bin);
        let mut kernel = Kernel {
            lags,
            sums: vec![0.0; lags * rows * count],
            inputs: count,
            rows,
            left: vec![0.0; count],
            end,
        };
        let (mut runs, commands) = self.launched(s);
        let mut rower = Rower::new(self, s);
        let mut sums = vec![0.0; rows * count];
        rower.commands(&commands);
        rower.add_commands(&mut sums);
        let mut lag = 0;
        for t in s + 1..=end {
            rower.states(&runs, self.jacobian(t));
            rower.add_states(&mut sums);
            if t < end {
                for run in &mut runs {
                    let none = |_: usize| [0.0; WIDE];
                    run.step(
                        self.scene,
                        (t, self.interval(t)),
                        |_| ([0.0; WIDE], [0.0; WIDE]),
                        none,
                    );
                }
                let commands: Vec<_> = runs.iter().map(|r| r.control.command.clone()).collect();
                rower.commands(&commands);
                rower.add_commands(&mut sums);
            }
            let r = t - s;
            if r.is_multiple_of(self.bin) || t == end {
                let at = lag * rows * count;
                for (to, from) in kernel.sums[at..at + rows * count].iter_mut().zip(&mut sums) {
                    *to = up(*from);
                    *from = 0.0;
                }
                lag += 1;
            }
        }
        if end < self.intervals.len() {
            self.left(&mut runs, scale, s, &mut kernel.left);
        }
        kernel
    }

    /// Largest scaled state of every input.
    fn left(&self, runs: &mut [Deviation<WIDE>], scale: &Scale, s: usize, left: &mut [f64]) {
        let inputs = self.inputs();
        let n = inputs.n;
        let mut sizes = vec![0.0_f64; runs.len() * WIDE];
        for (pack, run) in runs.iter_mut().enumerate() {
            run.each(|i, state| {
                for c in 0..WIDE {
                    let size = share_of(state[c].abs(), scale[i]);
                    let slot = &mut sizes[pack * WIDE + c];
                    *slot = slot.max(size);
                }
            });
        }
        let t = self.scene.period;
        for j in 0..n {
            left[inputs.torque() + j] = t * sizes[j].max(sizes[n + j]);
            left[inputs.momentum() + j] = t * sizes[2 * n + j];
            left[inputs.reading() + j] = sizes[3 * n + j];
            if inputs.speed > 0 {
                left[inputs.velocity() + j] = sizes[4 * n + j];
            }
        }
        for c in 0..inputs.twist {
            let row = &self.jacobian(s)[c * n..(c + 1) * n];
            left[inputs.payload() + c] =
                row.iter().enumerate().map(|(j, x)| x.abs() * t * sizes[2 * n + j]).sum();
        }
    }

    /// Scale of the states and how long the loop remembers \[samples\]: from a launch in the middle of the run.
    pub(super) fn pilot(&self, share: f64) -> (Scale, usize) {
        let total = self.intervals.len();
        let s = (total / 4).min(total.saturating_sub(2));
        let (mut runs, _) = self.launched(s);
        let length = runs[0].length();
        let mut history: Vec<f64> = Vec::new();
        let mut peak = vec![0.0_f64; length];
        let columns = self.columns();
        let mut sizes: Vec<Vec<f64>> = Vec::new();
        for t in s + 1..total {
            let mut now = vec![0.0_f64; length];
            for (pack, run) in runs.iter_mut().enumerate() {
                let own = columns.saturating_sub(pack * WIDE).min(WIDE);
                run.each(|i, state| {
                    for value in &state[..own] {
                        now[i] = now[i].max(value.abs());
                    }
                });
                run.step(
                    self.scene,
                    (t, self.interval(t)),
                    |_| ([0.0; WIDE], [0.0; WIDE]),
                    |_| [0.0; WIDE],
                );
            }
            for (peak, now) in peak.iter_mut().zip(&now) {
                *peak = peak.max(*now);
            }
            sizes.push(now);
        }
        let scale: Scale = peak;
        for now in &sizes {
            let size = now.iter().zip(&scale).map(|(x, s)| share_of(*x, *s));
            let size = size.fold(0.0_f64, f64::max);
            history.push(size);
        }
        let last = history.iter().rposition(|size| *size > share);
        let memory = last.map_or(1, |last| last + 2);
        (scale, memory)
    }

    /// What a state of size 1 at sample `from` does until `to`: largest value of every row, and the size left.
    pub(super) fn segment(&self, from: usize, to: usize, scale: &Scale) -> (Vec<f64>, f64) {
        let inputs = self.inputs();
        let length = scale.len();
        let packs = length.div_ceil(WIDE);
        let mut runs: Vec<Deviation<WIDE>> = Vec::with_capacity(packs);
        for pack in 0..packs {
            let mut run = Deviation::<WIDE>::new(self.scene);
            run.each(|i, state| {
                if i / WIDE == pack {
                    state[i % WIDE] = scale[i];
                }
            });
            runs.push(run);
        }
        let rows = inputs.rows();
        let n = inputs.n;
        let mut most = vec![0.0_f64; rows];
        let mut before: Vec<Vec<Lane<WIDE>>> = vec![vec![[0.0; WIDE]; n]; packs];
        for t in from..to {
            let mut now = vec![0.0_f64; rows];
            for (run, before) in runs.iter_mut().zip(&mut before) {
                for i in 0..2 * n {
                    now[i] += run.state[i].iter().map(|x| x.abs()).sum::<f64>();
                }
                for c in 0..inputs.twist {
                    let row = &self.jacobian(t)[c * n..(c + 1) * n];
                    let mut value = [0.0; WIDE];
                    super::lanes::add_row(&mut value, row, &run.state[n..]);
                    now[2 * n + c] += value.iter().map(|x| x.abs()).sum::<f64>();
                }
                run.step(
                    self.scene,
                    (t, self.interval(t)),
                    |_| ([0.0; WIDE], [0.0; WIDE]),
                    |_| [0.0; WIDE],
                );
                let at = inputs.command_row();
                for i in 0..n {
                    for c in 0..WIDE {
                        let command = run.control.command[i][c];
                        now[at + i] += command.abs();
                        let change = if t == from { 0.0 } else { before[i][c] };
                        now[at + n + i] += (command - change).abs();
                        before[i][c] = command;
                    }
                }
            }
            for (most, now) in most.iter_mut().zip(&now) {
                *most = most.max(*now);
            }
        }
        let mut left = vec![0.0_f64; length];
        for run in &mut runs {
            run.each(|i, state| {
                left[i] += share_of(state.iter().map(|x| x.abs()).sum(), scale[i]);
            });
        }
        (most, left.into_iter().fold(0.0, f64::max))
    }
}

/// Rows of the outputs at one sample, and their sums over inputs.
struct Rower<'a> {
    inputs: Inputs,
    period: f64,
    columns: usize,
    /// `[row][column]`
    values: Vec<f64>,
    /// At the launch.
    launch: &'a [f64],
    n: usize,
}

impl<'a> Rower<'a> {
    fn new(course: &Course<'a>, launch: usize) -> Self {
        let inputs = course.inputs();
        let columns = course.columns().div_ceil(WIDE) * WIDE;
        Self {
            inputs,
            period: course.scene.period,
            columns,
            values: vec![0.0; inputs.rows() * columns],
            launch: course.jacobian(launch),
            n: inputs.n,
        }
    }

    fn commands(&mut self, commands: &[Vec<Lane<WIDE>>]) {
        let at = self.inputs.command_row();
        for (pack, command) in commands.iter().enumerate() {
            for i in 0..self.n {
                for c in 0..WIDE {
                    let column = pack * WIDE + c;
                    let slot = (at + i) * self.columns + column;
                    let before = self.values[slot];
                    self.values[slot] = command[i][c];
                    self.values[(at + self.n + i) * self.columns + column] = command[i][c] - before;
                }
            }
        }
    }

    fn states(&mut self, runs: &[Deviation<WIDE>], jacobian: &[f64]) {
        let n = self.n;
        for (pack, run) in runs.iter().enumerate() {
            let at = pack * WIDE;
            for i in 0..2 * n {
                let slot = i * self.columns + at;
                self.values[slot..slot + WIDE].copy_from_slice(&run.state[i]);
            }
            for c in 0..self.inputs.twist {
                let row = &jacobian[c * n..(c + 1) * n];
                let mut value = [0.0; WIDE];
                super::lanes::add_row(&mut value, row, &run.state[n..]);
                let slot = (2 * n + c) * self.columns + at;
                self.values[slot..slot + WIDE].copy_from_slice(&value);
            }
        }
    }

    fn add_states(&self, sums: &mut [f64]) {
        self.add(0..self.inputs.command_row(), sums);
    }

    fn add_commands(&self, sums: &mut [f64]) {
        self.add(self.inputs.command_row()..self.inputs.rows(), sums);
    }

    fn add(&self, rows: core::ops::Range<usize>, sums: &mut [f64]) {
        let (n, count, t) = (self.n, self.inputs.count(), self.period);
        let inputs = self.inputs;
        for row in rows {
            let values = &self.values[row * self.columns..(row + 1) * self.columns];
            let sums = &mut sums[row * count..(row + 1) * count];
            for j in 0..n {
                sums[inputs.torque() + j] += t * mean_of_line(values[j], values[n + j]);
                sums[inputs.momentum() + j] += t * values[2 * n + j].abs();
                sums[inputs.reading() + j] += values[3 * n + j].abs();
            }
            for c in 0..inputs.twist {
                let own = &self.launch[c * n..(c + 1) * n];
                let kick: f64 = own.iter().zip(&values[2 * n..3 * n]).map(|(a, b)| a * b).sum();
                sums[inputs.payload() + c] += t * kick.abs();
            }
            for j in 0..inputs.speed {
                sums[inputs.velocity() + j] += values[4 * n + j].abs();
            }
        }
    }
}

/// A size in a unit; nothing is 0 of any.
fn share_of(size: f64, unit: f64) -> f64 {
    if size > 0.0 { size / unit } else { 0.0 }
}

/// The next larger number in single precision.
#[allow(clippy::cast_possible_truncation, reason = "rounded up")]
fn up(x: f64) -> f32 {
    ((x * (1.0 + 2.4e-7)) as f32).max(0.0)
}
