//! Linear runs of dry friction along the motion.

use super::guess::Guess;
use super::stretch::SweepStretch;
use crate::lanes::{Lane, WIDE};
use crate::tube::deviation::Deviation;
use crate::tube::scene::{Scene, dry};

/// Runs of dry friction so far: a column for the middle, then one per level that is not known.
pub(super) struct DryInputs {
    n: usize,
    /// Joints whose dry friction has an interval with width, in the order of columns.
    levels: Vec<usize>,
    /// Half widths of these intervals \[N·m\].
    half: Vec<f64>,
    runs: Vec<Deviation<WIDE>>,
    /// Commands of the sample before, per column.
    last: Vec<Vec<f64>>,
}

/// The same over a bin. `[sample][column][joint]`.
pub(super) struct DryRuns {
    runs: Vec<Deviation<WIDE>>,
    last: Vec<Vec<f64>>,
    pub(super) e: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) command: Vec<f64>,
    pub(super) change: Vec<f64>,
}

impl DryInputs {
    pub(super) fn new(scene: &Scene<'_>) -> Self {
        let wide = |i: &usize| scene.friction[*i].level.1 > scene.friction[*i].level.0;
        let levels: Vec<usize> = (0..scene.n).filter(wide).collect();
        let half = |i: &usize| 0.5 * (scene.friction[*i].level.1 - scene.friction[*i].level.0);
        let columns = 1 + levels.len();
        Self {
            n: scene.n,
            half: levels.iter().map(half).collect(),
            runs: vec![Deviation::new(scene); columns.div_ceil(WIDE)],
            last: vec![vec![0.0; scene.n]; columns],
            levels,
        }
    }

    fn columns(&self) -> usize {
        1 + self.levels.len()
    }

    /// The runs over a bin, if the guess holds.
    pub(super) fn over(&self, at: &SweepStretch<'_>, guess: &Guess) -> DryRuns {
        let scene = at.along.course.scene;
        let (columns, n) = (self.columns(), self.n);
        let length = at.to - at.from;
        let mut out = DryRuns {
            runs: self.runs.clone(),
            last: self.last.clone(),
            e: Vec::with_capacity((length + 1) * columns * n),
            v: Vec::with_capacity((length + 1) * columns * n),
            command: Vec::with_capacity(length * columns * n),
            change: Vec::with_capacity(length * columns * n),
        };
        let idle = scene.friction.iter().all(|f| f.level.1 <= 0.0 && f.added.is_none());
        out.keep_states(columns, n);
        for k in at.from..at.to {
            if idle {
                out.command.extend(core::iter::repeat_n(0.0, columns * n));
                out.change.extend(core::iter::repeat_n(0.0, columns * n));
            } else {
                let torque = self.torque(at, guess, k);
                let interval = &at.along.course.intervals[k];
                for (pack, run) in out.runs.iter_mut().enumerate() {
                    run.step(scene, (k, interval), |i| torque[pack * n + i]);
                }
                out.keep_commands(columns, n);
            }
            out.keep_states(columns, n);
        }
        out
    }

    /// Torque that drives the runs over interval `k`, `[pack][joint]`: the middle of the interval's sign
    /// against that of the nominal run, and the sign itself per level.
    fn torque(&self, at: &SweepStretch<'_>, guess: &Guess, k: usize) -> Vec<Lane<WIDE>> {
        let (n, nominal) = (self.n, at.along.nominal);
        let mut torque = vec![Lane::ZERO; self.runs.len() * n];
        for (i, friction) in at.along.course.scene.friction.iter().enumerate() {
            let (a, b) = at.velocity(guess, k, i);
            let row = k * n + i;
            let middle = 0.5 * (dry(a) + dry(b));
            let level = 0.5 * (friction.level.0 + friction.level.1);
            let mut centre = -level * (middle - nominal.sign[row]);
            if let Some(added) = &friction.added {
                centre += added.level() * (middle - nominal.sign_at[row]);
            }
            torque[i][0] = centre;
            if let Some(level) = self.levels.iter().position(|joint| *joint == i) {
                let column = 1 + level;
                torque[column / WIDE * n + i][column % WIDE] = -middle;
            }
        }
        torque
    }

    /// Goes on from the end of these runs.
    pub(super) fn go_on(&mut self, from: DryRuns) {
        self.runs = from.runs;
        self.last = from.last;
    }

    /// Ends of one signal of joint `i` in a row of a bin, over all levels.
    pub(super) fn ends(&self, values: &[f64], row: usize, i: usize) -> (f64, f64) {
        let n = self.n;
        let base = row * self.columns() * n + i;
        let wide = self.half.iter().enumerate();
        let spread: f64 = wide.map(|(c, half)| half * values[base + (1 + c) * n].abs()).sum();
        (values[base] - spread, values[base] + spread)
    }

    /// Size of what is linear in a row's velocities, column after column, added to a size.
    pub(super) fn enlarge(
        &self,
        size: &mut f64,
        velocities: &[f64],
        row: usize,
        of: impl Fn(&[f64]) -> f64,
    ) {
        let (columns, n) = (self.columns(), self.n);
        let row = &velocities[row * columns * n..(row + 1) * columns * n];
        let factors = core::iter::once(&1.0).chain(&self.half);
        for (v, factor) in row.chunks_exact(n).zip(factors) {
            *size += factor * of(v).abs();
        }
    }
}

impl DryRuns {
    fn keep_states(&mut self, columns: usize, n: usize) {
        for column in 0..columns {
            let run = &self.runs[column / WIDE];
            for i in 0..n {
                self.e.push(run.state[i][column % WIDE]);
                self.v.push(run.state[n + i][column % WIDE]);
            }
        }
    }

    fn keep_commands(&mut self, columns: usize, n: usize) {
        for column in 0..columns {
            let run = &self.runs[column / WIDE];
            for i in 0..n {
                let command = run.control.command[i][column % WIDE];
                self.change.push(command - self.last[column][i]);
                self.last[column][i] = command;
                self.command.push(command);
            }
        }
    }
}
