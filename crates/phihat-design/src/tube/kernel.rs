//! Sums over impulse responses of the linear time-varying loop, by lag, and what is left beyond them.

use phihat_certificate::extremes::{Extremes as _, larger};

use super::deviation::Deviation;
use super::linear::StepInterval;
use super::scene::Scene;
use crate::lanes::{Lane, WIDE, add_product, add_size, add_size_of_line};

/// Below this part of what counts as forgotten, a loop is not looked at any more.
const QUIET: f64 = 0.03;

/// Data from which kernels are computed.
pub(super) struct InputCourse<'a> {
    pub(super) scene: &'a Scene<'a>,
    pub(super) intervals: &'a [StepInterval],
    /// `6 × n` per sample where a payload is carried: the twist of the middle of its box, in the frame's axes.
    pub(super) jacobians: &'a [Vec<f64>],
    /// Samples per bin.
    pub(super) bin: usize,
}

/// Places of the inputs in a kernel: torque, momentum (`x`), position reading, payload's momentum, velocity
/// reading.
#[derive(Debug, Clone, Copy)]
pub(super) struct KernelInputs {
    pub(super) n: usize,
    pub(super) twist: usize,
    pub(super) speed: usize,
}

impl KernelInputs {
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

    /// First place of the inputs of a kind.
    fn first(self, kind: InputKind) -> usize {
        match kind {
            InputKind::TorqueAtEnd | InputKind::TorqueAtStart => self.torque(),
            InputKind::Momentum => self.momentum(),
            InputKind::Position => self.reading(),
            InputKind::Payload => self.payload(),
            InputKind::Velocity => self.velocity(),
        }
    }

    /// Packs of runs, kind after kind.
    fn places(self) -> Vec<KernelInput> {
        let n = self.n;
        [
            (InputKind::TorqueAtEnd, n),
            (InputKind::TorqueAtStart, n),
            (InputKind::Momentum, n),
            (InputKind::Position, n),
            (InputKind::Payload, self.twist),
            (InputKind::Velocity, self.speed),
        ]
        .into_iter()
        .flat_map(|(kind, count)| {
            let firsts = (0..count).step_by(WIDE);
            firsts.map(move |first| KernelInput { kind, first, width: WIDE.min(count - first) })
        })
        .collect()
    }

    /// Outputs: `ε`, `w`, twist of the payload, command, its change.
    pub(super) fn rows(self) -> usize {
        4 * self.n + self.twist
    }
    pub(super) fn command_row(self) -> usize {
        2 * self.n + self.twist
    }
}

/// Kind of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum InputKind {
    /// A pulse of torque as late as it can be in an interval.
    TorqueAtEnd,
    /// One as early as it can be.
    TorqueAtStart,
    /// A kick of position by `M⁻¹`.
    Momentum,
    /// An error of one reading of position.
    Position,
    /// A kick of position by `M⁻¹ Jᵀ`.
    Payload,
    /// An error of one reading of velocity.
    Velocity,
}

impl InputKind {
    /// Unit of the input over the unit that is launched: boxes on torque and momentum hold over a sample.
    fn per(self, period: f64) -> f64 {
        match self {
            Self::TorqueAtEnd | Self::TorqueAtStart | Self::Momentum | Self::Payload => period,
            Self::Position | Self::Velocity => 1.0,
        }
    }
}

/// Inputs of one kind that are stepped together.
#[derive(Debug, Clone, Copy)]
struct KernelInput {
    kind: InputKind,
    first: usize,
    width: usize,
}

/// Sums of one launch.
#[derive(Debug)]
pub(super) struct Kernel {
    pub(super) lags: usize,
    /// `[lag][row][input]`: at least `Σ |response|` over the samples of a lag.
    sums: Vec<f32>,
    inputs: usize,
    rows: usize,
    /// `[state][input]`: sizes of the remainder of an input where the sums end, by the numbers of
    /// [`Deviation::come_apart`].
    pub(super) left: Vec<f64>,
    /// Sample at which they end.
    pub(super) end: usize,
}

impl Kernel {
    /// Remainder of boxes on the inputs, number by number, per sample that they hold.
    pub(super) fn left_of<'a>(&'a self, boxes: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let size = move |left: &[f64]| left.iter().zip(boxes).map(|(left, u)| left * u).sum();
        self.left.chunks_exact(self.inputs).map(size)
    }

    /// All rows of a lag.
    pub(super) fn of_lag(&self, lag: usize) -> &[f32] {
        let size = self.rows * self.inputs;
        &self.sums[lag * size..(lag + 1) * size]
    }

    pub(super) fn lag(&self, lag: usize, row: usize) -> &[f32] {
        let at = (lag * self.rows + row) * self.inputs;
        &self.sums[at..at + self.inputs]
    }
}

impl<'a> InputCourse<'a> {
    /// The interval from sample `t`; beyond the run, the last one goes on.
    pub(super) fn interval(&self, t: usize) -> &'a StepInterval {
        &self.intervals[t.min(self.intervals.len() - 1)]
    }

    /// The payload's Jacobian at a sample; empty where there is none.
    pub(super) fn jacobian(&self, t: usize) -> &'a [f64] {
        self.jacobians.get(t.min(self.jacobians.len().saturating_sub(1))).map_or(&[], Vec::as_slice)
    }

    /// Number of states of a run.
    pub(super) fn states(&self) -> usize {
        2 * self.scene.n + self.scene.law.states()
    }

    pub(super) fn inputs(&self) -> KernelInputs {
        let n = self.scene.n;
        let twist = if self.jacobians.is_empty() { 0 } else { 6 };
        KernelInputs { n, twist, speed: if self.scene.measured_velocity { n } else { 0 } }
    }

    /// The runs just after interval `s`, whose inputs were 1.
    fn launched(&self, s: usize) -> Packs {
        let (scene, n) = (self.scene, self.scene.n);
        let interval = self.interval(s);
        let jacobian = self.jacobian(s);
        let places = self.inputs().places();
        let start = |row: usize, j: usize| -> f64 {
            let step = &interval.step[row * 2 * n + n..(row + 1) * 2 * n];
            (0..n).map(|k| step[k] * interval.inverse[k * n + j]).sum()
        };
        let mut runs = Vec::with_capacity(places.len());
        for place in &places {
            let column = |i: usize, unit: bool| -> Lane<WIDE> {
                Lane::of(|c| f64::from(u8::from(unit && place.first + c == i)))
            };
            let mut run = Deviation::<WIDE>::new(scene);
            run.step_misread(scene, (s, interval), |i| {
                [
                    column(i, place.kind == InputKind::Position),
                    column(i, place.kind == InputKind::Velocity),
                ]
            });
            for c in 0..place.width {
                let j = place.first + c;
                for i in 0..n {
                    match place.kind {
                        InputKind::TorqueAtEnd => {
                            run.state[n + i][c] += interval.inverse[i * n + j];
                        }
                        InputKind::TorqueAtStart => {
                            run.state[i][c] += start(i, j);
                            run.state[n + i][c] += start(n + i, j);
                        }
                        InputKind::Momentum => run.state[i][c] += interval.inverse[i * n + j],
                        InputKind::Payload => {
                            let twist = &jacobian[j * n..(j + 1) * n];
                            let inverse = &interval.inverse[i * n..(i + 1) * n];
                            run.state[i][c] +=
                                inverse.iter().zip(twist).map(|(m, t)| m * t).sum::<f64>();
                        }
                        InputKind::Position | InputKind::Velocity => {}
                    }
                }
            }
            runs.push(run);
        }
        Packs { runs, places }
    }

    /// The sums of a launch at sample `s`, up to sample `end`.
    pub(super) fn kernel(&self, s: usize, end: usize) -> Kernel {
        let mut kernel = self.none(s, end);
        self.launch((s, end), &mut kernel.left, |t, sums, packs| {
            if t > s && ((t - s).is_multiple_of(self.bin) || t == end) {
                sums.drain(packs, &mut kernel.sums);
            }
        });
        kernel
    }

    /// Largest single response in a bin, in place of sums, its end counted to both neighbours: of inputs that
    /// act at sample 0 alone, up to sample `end`.
    pub(super) fn at_start(&self, end: usize) -> Kernel {
        let mut kernel = self.none(0, end);
        let size = kernel.rows * kernel.inputs;
        kernel.sums.resize(kernel.lags * size, 0.0);
        let mut own: Vec<f32> = Vec::with_capacity(size);
        self.launch((0, end), &mut kernel.left, |t, sums, packs| {
            own.clear();
            sums.drain(packs, &mut own);
            let (bin, edge) = (t / self.bin, t.is_multiple_of(self.bin));
            let last = bin.min(kernel.lags - 1);
            for of_bin in bin.saturating_sub(usize::from(edge))..=last {
                let most = kernel.sums[of_bin * size..][..size].iter_mut();
                most.zip(&own).for_each(|(most, own)| *most = most.max(*own));
            }
        });
        kernel
    }

    fn none(&self, s: usize, end: usize) -> Kernel {
        let inputs = self.inputs();
        let (rows, count) = (inputs.rows(), inputs.count());
        let lags = (end - s).div_ceil(self.bin);
        let sums = Vec::with_capacity(lags * rows * count);
        Kernel { lags, sums, inputs: count, rows, left: vec![0.0; self.states() * count], end }
    }

    /// Takes a launch at sample `s` to sample `end`, and tells of every sample; what is left goes to `left`.
    fn launch(
        &self,
        (s, end): (usize, usize),
        left: &mut [f64],
        mut each: impl FnMut(usize, &mut PackSums, &Packs),
    ) {
        let mut packs = self.launched(s);
        let mut sums = PackSums::new(self, &packs);
        sums.add_commands(&packs);
        each(s, &mut sums, &packs);
        for t in s + 1..=end {
            sums.add_states(&packs, self.jacobian(t));
            if t < end {
                for run in &mut packs.runs {
                    run.step_free(self.scene, (t, self.interval(t)));
                }
                sums.add_commands(&packs);
            }
            each(t, &mut sums, &packs);
        }
        if end < self.intervals.len() {
            self.left(&mut packs, left);
        }
    }

    /// Sizes of what is left of every input.
    fn left(&self, packs: &mut Packs, left: &mut [f64]) {
        let inputs = self.inputs();
        for (run, place) in packs.runs.iter_mut().zip(&packs.places) {
            let at = inputs.first(place.kind) + place.first;
            let unit = place.kind.per(self.scene.period);
            run.come_apart(self.scene);
            run.each(self.scene, |i, state| {
                let own = &mut left[i * inputs.count() + at..][..place.width];
                for (left, state) in own.iter_mut().zip(state.iter()) {
                    *left = larger(*left, unit * state.abs());
                }
            });
        }
    }

    /// Memory of the loop \[samples\], down to a share of each state's peak: from a launch in the middle of
    /// the run, until a small part of that share is left.
    pub(super) fn pilot(&self, share: f64) -> usize {
        let total = self.intervals.len();
        let s = (total / 4).min(total.saturating_sub(2));
        let mut packs = self.launched(s);
        let length = self.states();
        let mut peak = vec![0.0_f64; length];
        let mut sizes: Vec<Vec<f64>> = Vec::new();
        let size = |now: &[f64], peak: &[f64]| {
            now.iter().zip(peak).map(|(now, peak)| share_of(*now, *peak)).largest()
        };
        for t in s + 1..total {
            let mut now = vec![0.0_f64; length];
            for run in &mut packs.runs {
                run.each(self.scene, |i, state| {
                    for value in state.iter() {
                        now[i] = larger(now[i], value.abs());
                    }
                });
                run.step_free(self.scene, (t, self.interval(t)));
            }
            for (peak, now) in peak.iter_mut().zip(&now) {
                *peak = larger(*peak, *now);
            }
            let quiet = size(&now, &peak) < QUIET * share;
            sizes.push(now);
            if quiet {
                break;
            }
        }
        let last = sizes.iter().rposition(|now| size(now, &peak) > share);
        last.map_or(1, |last| last + 2)
    }

    /// Response to every number of a state from sample `from` until `to`, each of size 1 there: the largest
    /// value of every row in each block of samples, `[block][row][state]`, and the remainder,
    /// `[state][state]`.
    pub(super) fn segment(
        &self,
        (from, to): (usize, usize),
        block: usize,
    ) -> (Vec<Vec<f64>>, Vec<f64>) {
        let (rows, length) = (self.inputs().rows(), self.states());
        let mut blocks = vec![vec![0.0_f64; rows * length]; (to - from).div_ceil(block)];
        let mut left = vec![0.0_f64; length * length];
        for first in (0..length).step_by(WIDE) {
            let mut run = Deviation::<WIDE>::new(self.scene);
            run.each(self.scene, |i, state| {
                if (first..first + WIDE).contains(&i) {
                    state[i - first] = 1.0;
                }
            });
            run.come_together(self.scene);
            let width = WIDE.min(length - first);
            self.follow(&mut run, (from, to), |t, row, values| {
                let own =
                    &mut blocks[(t.min(to - 1) - from) / block][row * length + first..][..width];
                for (most, value) in own.iter_mut().zip(values.iter()) {
                    *most = larger(*most, value.abs());
                }
            });
            run.come_apart(self.scene);
            run.each(self.scene, |i, state| {
                for (left, state) in
                    left[i * length + first..][..width].iter_mut().zip(state.iter())
                {
                    *left = state.abs();
                }
            });
        }
        (blocks, left)
    }

    /// Takes runs that nothing pushes from a sample to another, and tells of every row of the outputs.
    fn follow(
        &self,
        run: &mut Deviation<WIDE>,
        (from, to): (usize, usize),
        mut tell: impl FnMut(usize, usize, &Lane<WIDE>),
    ) {
        let inputs = self.inputs();
        let n = inputs.n;
        let mut before: Vec<Lane<WIDE>> =
            (0..n).map(|i| run.control.sent_last(&self.scene.law, i)).collect();
        for t in from..=to {
            for i in 0..2 * n {
                tell(t, i, &run.state[i]);
            }
            let mut twist = [Lane::ZERO; 6];
            add_product(&mut twist[..inputs.twist], self.jacobian(t), &run.state[n..]);
            for (c, value) in twist[..inputs.twist].iter().enumerate() {
                tell(t, 2 * n + c, value);
            }
            if t == to {
                break;
            }
            run.step_free(self.scene, (t, self.interval(t)));
            let at = inputs.command_row();
            for (i, before) in before.iter_mut().enumerate() {
                let command = run.control.command[i];
                tell(t, at + i, &command);
                tell(t, at + n + i, &Lane::of(|c| command[c] - before[c]));
                *before = command;
            }
        }
    }
}

/// Runs of all inputs, those of one kind side by side.
struct Packs {
    runs: Vec<Deviation<WIDE>>,
    /// Inputs in each of them.
    places: Vec<KernelInput>,
}

/// Sums over inputs' packs of every row of the outputs.
struct PackSums {
    inputs: KernelInputs,
    period: f64,
    /// `[row][pack]`; torque is summed where its end is.
    rows: Vec<Lane<WIDE>>,
    /// Commands of the sample before, `[pack][joint]`.
    before: Vec<Vec<Lane<WIDE>>>,
    /// Packs of torque at an interval's end; those at its start come next.
    torque: usize,
    /// Twist of each pack.
    twist: Vec<[Lane<WIDE>; 6]>,
}

impl PackSums {
    fn new(course: &InputCourse<'_>, packs: &Packs) -> Self {
        let inputs = course.inputs();
        let count = packs.runs.len();
        Self {
            inputs,
            period: course.scene.period,
            rows: vec![Lane::ZERO; inputs.rows() * count],
            before: vec![vec![Lane::ZERO; inputs.n]; count],
            torque: packs.places.iter().filter(|p| p.kind == InputKind::TorqueAtEnd).count(),
            twist: vec![[Lane::ZERO; 6]; count],
        }
    }

    /// Position, velocity and twist of a sample.
    fn add_states(&mut self, packs: &Packs, jacobian: &[f64]) {
        let (n, count, torque) = (self.inputs.n, packs.runs.len(), self.torque);
        for (row, sums) in self.rows.chunks_exact_mut(count).take(2 * n).enumerate() {
            add_to(sums, torque, |pack| &packs.runs[pack].state[row]);
        }
        if self.inputs.twist == 0 {
            return;
        }
        for (twist, run) in self.twist.iter_mut().zip(&packs.runs) {
            *twist = [Lane::ZERO; 6];
            add_product(twist, jacobian, &run.state[n..]);
        }
        for (c, sums) in self.rows.chunks_exact_mut(count).skip(2 * n).take(6).enumerate() {
            add_to(sums, torque, |pack| &self.twist[pack][c]);
        }
    }

    /// Commands of a sample and their change.
    fn add_commands(&mut self, packs: &Packs) {
        let (n, count, torque) = (self.inputs.n, packs.runs.len(), self.torque);
        let command = |pack: usize, i: usize| &packs.runs[pack].control.command[i];
        for (pack, before) in self.before.iter_mut().enumerate() {
            for (i, before) in before.iter_mut().enumerate() {
                let now = command(pack, i);
                for c in 0..WIDE {
                    before[c] = now[c] - before[c];
                }
            }
        }
        let mut rows = self.rows.chunks_exact_mut(count).skip(self.inputs.command_row());
        for (i, sums) in rows.by_ref().take(n).enumerate() {
            add_to(sums, torque, |pack| command(pack, i));
        }
        for (i, sums) in rows.enumerate() {
            add_to(sums, torque, |pack| &self.before[pack][i]);
        }
        for (pack, before) in self.before.iter_mut().enumerate() {
            before.copy_from_slice(&packs.runs[pack].control.command);
        }
    }

    /// Moves the sums of a bin to `[row][input]`.
    fn drain(&mut self, packs: &Packs, out: &mut Vec<f32>) {
        for sums in self.rows.chunks_exact_mut(packs.runs.len()) {
            let from = out.len();
            out.resize(from + self.inputs.count(), 0.0);
            for (place, sum) in packs.places.iter().zip(sums) {
                let unit = place.kind.per(self.period);
                let at = from + self.inputs.first(place.kind) + place.first;
                if place.kind != InputKind::TorqueAtStart {
                    for (out, sum) in out[at..at + place.width].iter_mut().zip(sum.iter()) {
                        *out = up(unit * sum);
                    }
                }
                *sum = Lane::ZERO;
            }
        }
    }
}

/// Adds the sizes of one row, torque's as means over an interval.
fn add_to<'a>(sums: &mut [Lane<WIDE>], torque: usize, of: impl Fn(usize) -> &'a Lane<WIDE>) {
    for (pack, sum) in sums[..torque].iter_mut().enumerate() {
        add_size_of_line(sum, of(pack), of(torque + pack));
    }
    for (pack, sum) in sums.iter_mut().enumerate().skip(2 * torque) {
        add_size(sum, of(pack));
    }
}

/// A size in a unit; nothing is 0 of any.
fn share_of(size: f64, unit: f64) -> f64 {
    if size == 0.0 { 0.0 } else { size / unit }
}

/// The next larger number in single precision.
#[allow(clippy::cast_possible_truncation, reason = "rounded up")]
fn up(x: f64) -> f32 {
    (x * (1.0 + 2.4e-7)) as f32
}
