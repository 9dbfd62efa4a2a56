//! One pass along the motion: bounds that one evaluation of the causal sums finds again, smaller.

use phihat_certificate::extremes::{Extremes as _, larger, smaller};

use super::TubeRefusal;
use super::basis::Slice;
use super::deviation::Deviation;
use super::kernel::{Course, Inputs, Kernel};
use super::lanes::WIDE;
use super::linear::Interval;
use super::nominal::Nominal;
use super::scene::dry;
use super::tensors::{Tensors, contracted, times, times_abs, transposed_abs};

/// Rounds in one bin before it is given up.
const ROUNDS: u32 = 80;

/// What a hypothesis is widened by when it does not hold.
const WIDER: f64 = 1.01;

/// For what is left out of the sums: curvature of responses within a sample, rounding.
const SLACK: f64 = 1.01;

/// Where a bound has grown so far, nothing will close \[rad\].
const LOST: f64 = 1.0;

/// Everything that a sweep reads.
pub(super) struct Along<'a> {
    pub(super) course: &'a Course<'a>,
    pub(super) nominal: &'a Nominal,
    pub(super) slice: Option<&'a Slice>,
    /// Shapes of the payload's parameters, per sample `ε, w` and per interval the command, one column each.
    pub(super) shapes: &'a [Option<Shape>],
    pub(super) bins: usize,
    /// Scaled state at the first sample of each segment from inputs before.
    pub(super) segments: &'a [Segment],
}

/// One linear run, recorded.
#[derive(Debug, Clone)]
pub(super) struct Shape {
    /// `n` per sample.
    pub(super) e: Vec<f64>,
    pub(super) v: Vec<f64>,
    /// `n` per interval.
    pub(super) command: Vec<f64>,
}

/// What a state left over at a segment's start does in it.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) from: usize,
    pub(super) rows: Vec<f64>,
    pub(super) left: f64,
}

/// What one group of bins shares.
pub(super) struct Group {
    pub(super) kernel: Kernel,
    pub(super) tensors: Tensors,
    /// How far `M`, `D`, `K` differ from those of the kernel's launch, entry by entry; and `J`, `6 × n`.
    pub(super) moved: [Vec<f64>; 3],
    pub(super) moved_rate: Vec<f64>,
    pub(super) moved_jacobian: Vec<f64>,
    /// `|J̇|`.
    pub(super) jacobian_rate: Vec<f64>,
}

/// Bounds in one bin.
#[derive(Debug, Clone, Default)]
pub(super) struct Bin {
    /// Deviation of position and velocity from the nominal run, `(low, high)` per sample and joint.
    pub(super) e: Vec<(f64, f64)>,
    pub(super) v: Vec<(f64, f64)>,
    /// Deviation of command and of its change per sample, likewise; without the bin's last end.
    pub(super) command: Vec<(f64, f64)>,
    pub(super) change: Vec<(f64, f64)>,
}

/// A guess of everything in a bin that inputs depend on.
#[derive(Debug, Clone)]
struct Guess {
    /// `ε̇` at the bin's samples, ends included.
    v: Vec<(f64, f64)>,
    /// `|ε|` per joint.
    e: Vec<f64>,
    /// Part of `|ε|`, `|ε̇|` that comes from sums.
    summed: [Vec<f64>; 2],
    twist: Vec<f64>,
}

/// The state of a sweep.
pub(super) struct Sweep<'a> {
    along: &'a Along<'a>,
    inputs: Inputs,
    n: usize,
    /// Outputs of bins to come, from inputs so far: `[bin][row]`.
    ahead: Vec<Vec<f64>>,
    /// Inputs of the bin before.
    before: Vec<f64>,
    /// Sizes of scaled state that arrive at each segment's start.
    arriving: Vec<f64>,
    frictions: Vec<Deviation<WIDE>>,
    /// Joints whose dry friction has an interval with width, in the order of columns.
    levels: Vec<usize>,
    last_commands: Vec<Vec<f64>>,
    tail: Vec<f64>,
    first_reading: Kernel,
    pub(super) bin_results: Vec<Bin>,
}

impl<'a> Sweep<'a> {
    pub(super) fn new(along: &'a Along<'a>, first_reading: Kernel) -> Self {
        let scene = along.course.scene;
        let inputs = along.course.inputs();
        let levels: Vec<usize> = (0..scene.n)
            .filter(|i| scene.friction[*i].level.1 > scene.friction[*i].level.0)
            .collect();
        let packs = (1 + levels.len()).div_ceil(WIDE);
        Self {
            along,
            inputs,
            n: scene.n,
            ahead: vec![vec![0.0; inputs.rows()]; along.bins],
            before: vec![0.0; inputs.count()],
            arriving: vec![0.0; along.segments.len() + 1],
            frictions: vec![Deviation::new(scene); packs],
            last_commands: vec![vec![0.0; scene.n]; 1 + levels.len()],
            levels,
            tail: vec![0.0; along.segments.len() + 1],
            first_reading,
            bin_results: Vec::with_capacity(along.bins),
        }
    }

    /// Goes through one bin.
    pub(super) fn bin(&mut self, b: usize, group: &Group) -> Result<(), TubeRefusal> {
        let along = self.along;
        let scene = along.course.scene;
        let n = self.n;
        let (from, to) = self.range(b);
        let tail = self.tails(b);
        let mut guess = self.first_guess(b, to - from);
        let mut rounds = 0;
        let (bin, inputs, runs, commands) = loop {
            let inputs = self.inputs_of(b, &guess, group);
            let shapes = self.frictions_over(b, &guess);
            let (bin, found) = self.outputs(b, group, &inputs, &tail, &shapes);
            let inside = guess.hold(&found);
            rounds += 1;
            if inside {
                // One more evaluation, of the smaller bounds: whatever stays in `found` gives no larger inputs.
                break (bin, inputs, shapes.runs, shapes.last);
            }
            let lost = found.e.iter().any(|e| e.is_nan() || *e > LOST);
            if rounds > ROUNDS || lost {
                let worst = (0..n).max_by(|i, j| found.e[*i].total_cmp(&found.e[*j])).unwrap_or(0);
                let joint = scene.names[worst].clone();
                let t = from as f64 * scene.period;
                return Err(TubeRefusal::Open { joint, t });
            }
            guess.widen(&found, if rounds > 20 { 1.05 } else { WIDER });
        };
        self.scatter(b, group, &inputs);
        self.frictions = runs;
        self.last_commands = commands;
        self.before = inputs;
        self.bin_results.push(bin);
        Ok(())
    }

    /// First and last sample of a bin; the last one is the first of the next.
    fn range(&self, b: usize) -> (usize, usize) {
        let bin = self.along.course.bin;
        (b * bin, ((b + 1) * bin).min(self.along.course.intervals.len()))
    }

    fn first_guess(&self, b: usize, length: usize) -> Guess {
        let n = self.n;
        let rows = &self.ahead[b];
        let own = |i: usize| rows[i].abs() * 1.05 + 1e-9;
        let last = self.bin_results.last();
        let (mut e, mut v) = (vec![0.0; n], vec![(0.0, 0.0); n]);
        for i in 0..n {
            let before = last.map_or((0.0, 0.0), |bin| bin.v[bin.v.len() - n + i]);
            v[i] = (before.0 - 1e-7, before.1 + 1e-7);
            let before = last.map_or(0.0, |bin| {
                let at = bin.e[bin.e.len() - n + i];
                larger(at.1, -at.0)
            });
            e[i] = larger(before, own(i));
        }
        let twist = (0..self.inputs.twist).map(|c| own(2 * n + c)).collect();
        Guess {
            v: (0..=length).flat_map(|_| v.clone()).collect(),
            e,
            summed: [(0..n).map(own).collect(), (0..n).map(|i| own(n + i)).collect()],
            twist,
        }
    }

    /// Boxes on all inputs of a bin, if the guess holds in it.
    #[allow(clippy::too_many_lines, reason = "one term of the equation after the other")]
    fn inputs_of(&self, b: usize, guess: &Guess, group: &Group) -> Vec<f64> {
        let along = self.along;
        let scene = along.course.scene;
        let (n, t) = (self.n, scene.period);
        let (from, to) = self.range(b);
        let middle = usize::midpoint(from, to);
        let interval: &Interval =
            &along.course.intervals[middle.min(along.course.intervals.len() - 1)];
        let at = &interval.derivatives;
        let Tensors { mass, stiffness, damping, coriolis, payload_damping, payload_stiffness } =
            &group.tensors;
        let e = &guess.e;
        let v: Vec<f64> = (0..n)
            .map(|i| guess.v.iter().skip(i).step_by(n).map(|v| larger(v.1, -v.0)).largest())
            .collect();
        let speed: Vec<f64> = (0..n)
            .map(|i| (from..=to).map(|k| along.nominal.dq[k * n + i].abs()).largest())
            .collect();
        let [summed_e, summed_v] = &guess.summed;
        let mut torque = vec![0.0; n];
        let mut add = |x: &[f64], factor: f64| {
            for (torque, x) in torque.iter_mut().zip(x) {
                *torque += factor * x;
            }
        };
        let mass_e = contracted(mass, e);
        let mass_v = contracted(mass, &v);
        let mass_speed = contracted(mass, &speed);
        // Momentum: posture, launch elsewhere, and change within a sample.
        let mut momentum = times(&mass_e, &v);
        for (x, more) in momentum.iter_mut().zip(times(&group.moved[0], summed_v)) {
            *x += more;
        }
        for (x, more) in momentum.iter_mut().zip(times(&mass_speed, &v)) {
            *x += 0.5 * t * more;
        }
        // Second order.
        let ends = if scene.adds_gravity { 1.0 } else { 0.5 };
        add(&times(&contracted(stiffness, e), e), ends);
        add(&times(&contracted(damping, e), &v), 1.0);
        add(&times(&contracted(coriolis, &v), &v), 0.5);
        // Launch elsewhere.
        add(&times(&group.moved[1], summed_v), 1.0);
        add(&times(&group.moved[2], summed_e), 1.0);
        add(&times(&group.moved_rate, summed_v), 1.0);
        // dΔM/dt of the posture part: ∂M·ε̇ and its change along the nominal's speed.
        add(&times(&mass_v, &v), 1.0);
        add(&times(&contracted(damping, e), &v), 1.0);
        // (D − Ṁ) M⁻¹ x.
        let turned = |x: &[f64]| {
            let y = times_abs(&interval.inverse, x);
            let mut out = times_abs(&at.d, &y);
            for (out, more) in out.iter_mut().zip(times(&mass_speed, &y)) {
                *out += more;
            }
            out
        };
        add(&turned(&momentum), 1.0);
        let mut payload = vec![0.0; self.inputs.twist];
        if let Some(slice) = along.slice {
            let spatial = slice.spatial();
            let jacobian = &along.course.jacobians[middle.min(along.course.jacobians.len() - 1)];
            for (row, out) in spatial.iter().zip(&mut payload) {
                *out = row.iter().zip(&guess.twist).map(|(m, x)| m * x).sum();
            }
            add(&times(payload_damping, &v), 1.0);
            add(&times(payload_stiffness, e), 1.0);
            // dΔM/dt of the payload: J̇ᵀ ΔI ν + Jᵀ ΔI J̇ ε̇.
            add(&transposed_abs(&group.jacobian_rate, n, &payload), 1.0);
            let late = times(&group.jacobian_rate, &v);
            let spun: Vec<f64> =
                spatial.iter().map(|row| row.iter().zip(&late).map(|(m, x)| m * x).sum()).collect();
            add(&transposed_abs(jacobian, n, &spun), 1.0);
            add(&turned(&transposed_abs(jacobian, n, &payload)), 1.0);
        }
        // Where two integrators end apart, twice: neither is exact.
        for (defect, out) in along.nominal.defect.iter().zip([&mut momentum, &mut torque]) {
            let most: Vec<f64> =
                (0..n).map(|i| (from..to).map(|k| defect[k * n + i]).largest()).collect();
            for (out, more) in out.iter_mut().zip(times_abs(&at.m, &most)) {
                *out += 2.0 * more / t;
            }
        }
        // Pushes that begin or end between steps.
        let mut pushed = vec![0.0; n];
        for edge in scene.edges.iter().filter(|edge| (from..to).contains(&edge.sample)) {
            pushed[edge.joint] += edge.torque;
        }
        for (torque, pushed) in torque.iter_mut().zip(pushed) {
            *torque += pushed;
        }
        // Friction, and its smooth part's bend.
        for i in 0..n {
            let friction = &scene.friction[i];
            let (mut most, mut spread) = (0.0_f64, 0.0_f64);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in from..to {
                let (a, b) = self.ends(guess, from, k, i);
                most = larger(most, 0.5 * (dry(b) - dry(a)));
                spread = larger(spread, along.nominal.spread[k * n + i]);
                (low, high) = (smaller(low, a), larger(high, b));
            }
            let level = 0.5 * (friction.level.0 + friction.level.1);
            let added = friction.added.map_or(0.0, |added| added.level());
            torque[i] += (friction.level.1 + added) * most + level * spread;
            torque[i] += 0.5 * friction.bend((low, high)) * v[i] * v[i];
        }
        // What the robot adds by velocity is of the true one, `w − M⁻¹ x`.
        if let Some(by_velocity) = interval.added.get(n * n..) {
            let hidden = times_abs(by_velocity, &self.direct(middle, &momentum, &payload));
            for (torque, more) in torque.iter_mut().zip(hidden) {
                *torque += more;
            }
        }
        let mut inputs = vec![0.0; self.inputs.count()];
        inputs[..n].copy_from_slice(&torque);
        inputs[self.inputs.momentum()..self.inputs.momentum() + n].copy_from_slice(&momentum);
        inputs[self.inputs.reading()..self.inputs.reading() + n].copy_from_slice(&scene.misread);
        let at = self.inputs.payload();
        inputs[at..at + self.inputs.twist].copy_from_slice(&payload);
        if self.inputs.speed > 0 {
            let at = self.inputs.velocity();
            let misread = self.direct(middle, &momentum, &payload);
            inputs[at..at + n].copy_from_slice(&misread);
        }
        inputs
    }

    /// True velocity's ends in an interval, if the guess holds.
    fn ends(&self, guess: &Guess, from: usize, k: usize, i: usize) -> (f64, f64) {
        let n = self.n;
        let nominal = &self.along.nominal.dq;
        let (a, b) = (guess.v[(k - from) * n + i], guess.v[(k + 1 - from) * n + i]);
        let (v, w) = (nominal[k * n + i], nominal[(k + 1) * n + i]);
        (smaller(v + a.0, w + b.0), larger(v + a.1, w + b.1))
    }

    /// `|M⁻¹ x + M⁻¹ Jᵀ μ|`: what momentum is of a velocity at once.
    fn direct(&self, k: usize, momentum: &[f64], payload: &[f64]) -> Vec<f64> {
        let course = self.along.course;
        let n = self.n;
        let inverse = &course.intervals[k.min(course.intervals.len() - 1)].inverse;
        let mut out = times_abs(inverse, momentum);
        if !payload.is_empty() {
            let jacobian = &course.jacobians[k.min(course.jacobians.len() - 1)];
            for i in 0..n {
                for (c, mu) in payload.iter().enumerate() {
                    let row = &jacobian[c * n..(c + 1) * n];
                    let entry: f64 = (0..n).map(|j| inverse[i * n + j] * row[j]).sum();
                    out[i] += entry.abs() * mu;
                }
            }
        }
        out
    }

    /// The runs of dry friction over a bin, if the guess holds.
    #[allow(clippy::too_many_lines, reason = "one interval after the other")]
    fn frictions_over(&self, b: usize, guess: &Guess) -> Frictions {
        let along = self.along;
        let scene = along.course.scene;
        let n = self.n;
        let (from, to) = self.range(b);
        let columns = 1 + self.levels.len();
        let mut out = Frictions {
            runs: self.frictions.clone(),
            last: self.last_commands.clone(),
            e: Vec::with_capacity((to - from + 1) * columns * n),
            v: Vec::with_capacity((to - from + 1) * columns * n),
            command: Vec::with_capacity((to - from) * columns * n),
            change: Vec::with_capacity((to - from) * columns * n),
        };
        let idle = scene.friction.iter().all(|f| f.level.1 <= 0.0 && f.added.is_none());
        out.keep(columns, n);
        for k in from..to {
            if idle {
                out.command.extend(core::iter::repeat_n(0.0, columns * n));
                out.change.extend(core::iter::repeat_n(0.0, columns * n));
                out.keep(columns, n);
                continue;
            }
            let mut centre = vec![0.0; n];
            let mut middle = vec![0.0; n];
            for i in 0..n {
                let friction = &scene.friction[i];
                let (a, b) = self.ends(guess, from, k, i);
                let at = k * n + i;
                middle[i] = 0.5 * (dry(a) + dry(b));
                let level = 0.5 * (friction.level.0 + friction.level.1);
                centre[i] = -level * (middle[i] - along.nominal.sign[at]);
                if let Some(added) = &friction.added {
                    centre[i] += added.level() * (middle[i] - along.nominal.sign_at[at]);
                }
            }
            let interval = &along.course.intervals[k];
            for (pack, run) in out.runs.iter_mut().enumerate() {
                let torque = |i: usize| {
                    let mut lane = [0.0; WIDE];
                    for (c, slot) in lane.iter_mut().enumerate() {
                        let column = pack * WIDE + c;
                        if column == 0 {
                            *slot = centre[i];
                        } else if self.levels.get(column - 1) == Some(&i) {
                            *slot = -middle[i];
                        }
                    }
                    lane
                };
                run.step(scene, (k, interval), torque);
            }
            for column in 0..columns {
                let run = &out.runs[column / WIDE];
                for i in 0..n {
                    let command = run.control.command[i][column % WIDE];
                    out.change.push(command - out.last[column][i]);
                    out.last[column][i] = command;
                    out.command.push(command);
                }
            }
            out.keep(columns, n);
        }
        out
    }

    /// Bounds that follow in a bin, and the guess that they would be.
    #[allow(clippy::too_many_lines, reason = "one output after the other")]
    fn outputs(
        &self,
        b: usize,
        group: &Group,
        inputs: &[f64],
        tail: &[f64],
        shapes: &Frictions,
    ) -> (Bin, Guess) {
        let along = self.along;
        let scene = along.course.scene;
        let n = self.n;
        let (from, to) = self.range(b);
        let rows = self.inputs.rows();
        let mut summed = vec![0.0; rows];
        let boxes: Vec<f64> =
            inputs.iter().zip(&self.before).map(|(now, before)| larger(*now, *before)).collect();
        for (row, sum) in summed.iter_mut().enumerate() {
            let own = group.kernel.lag(0, row);
            let own: f64 = own.iter().zip(&boxes).map(|(k, u)| f64::from(*k) * u).sum();
            *sum = SLACK * (self.ahead[b][row] + own + tail[row]);
            if b < self.first_reading.lags {
                let first = self.first_reading.lag(b, row);
                let at = self.inputs.reading();
                let first: f64 = (0..n).map(|j| f64::from(first[at + j]) * scene.misread[j]).sum();
                *sum += first;
            }
        }
        let middle = usize::midpoint(from, to);
        let at = self.inputs.payload();
        let momentum = &boxes[self.inputs.momentum()..self.inputs.momentum() + n];
        let payload = &boxes[at..at + self.inputs.twist];
        let direct = self.direct(middle, momentum, payload);
        let wide: Vec<f64> = (0..n).map(|i| summed[n + i] + direct[i]).collect();
        let columns = 1 + self.levels.len();
        let half = |column: usize| {
            let friction = &scene.friction[self.levels[column - 1]];
            0.5 * (friction.level.1 - friction.level.0)
        };
        let hull = |unit: &dyn Fn(&Shape) -> f64| -> (f64, f64) {
            along.slice.map_or((0.0, 0.0), |slice| {
                slice.hull(&core::array::from_fn(|d| along.shapes[d].as_ref().map_or(0.0, unit)))
            })
        };
        let friction = |values: &[f64], row: usize, i: usize| {
            let base = row * columns * n + i;
            let spread: f64 = (1..columns).map(|c| half(c) * values[base + c * n].abs()).sum();
            (values[base] - spread, values[base] + spread)
        };
        let mut bin = Bin::default();
        let mut found = Guess {
            v: Vec::with_capacity((to - from + 1) * n),
            e: vec![0.0; n],
            summed: [summed[..n].to_vec(), wide.clone()],
            twist: vec![0.0; self.inputs.twist],
        };
        for k in from..=to {
            for i in 0..n {
                let at = k * n + i;
                let (a, b) = hull(&|shape| shape.e[at]);
                let (c, d) = friction(&shapes.e, k - from, i);
                let e = (a + c - summed[i], b + d + summed[i]);
                found.e[i] = larger(found.e[i], larger(e.1, -e.0));
                bin.e.push(e);
                let (a, b) = hull(&|shape| shape.v[at]);
                let (c, d) = friction(&shapes.v, k - from, i);
                let v = (a + c - wide[i], b + d + wide[i]);
                found.v.push(v);
                bin.v.push(v);
            }
            if let Some(slice) = along.slice {
                let jacobian = &along.course.jacobians[k.min(along.course.jacobians.len() - 1)];
                for c in 0..self.inputs.twist {
                    let row = &jacobian[c * n..(c + 1) * n];
                    let along_row =
                        |v: &[f64]| -> f64 { row.iter().zip(v).map(|(j, v)| j * v).sum() };
                    let unit = core::array::from_fn(|d| {
                        along.shapes[d]
                            .as_ref()
                            .map_or(0.0, |s| along_row(&s.v[k * n..(k + 1) * n]))
                    });
                    let mut size = slice.size(&unit);
                    let base = (k - from) * columns * n;
                    for column in 0..columns {
                        let v = &shapes.v[base + column * n..base + (column + 1) * n];
                        let factor = if column == 0 { 1.0 } else { half(column) };
                        size += factor * along_row(v).abs();
                    }
                    found.twist[c] = larger(found.twist[c], size);
                }
            }
            if k == to {
                continue;
            }
            let at = self.inputs.command_row();
            for i in 0..n {
                let row = k * n + i;
                let (a, b) = hull(&|shape| shape.command[row]);
                let (c, d) = friction(&shapes.command, k - from, i);
                bin.command.push((a + c - summed[at + i], b + d + summed[at + i]));
                let (a, b) = hull(&|shape| {
                    let before = if k > 0 { shape.command[row - n] } else { 0.0 };
                    shape.command[row] - before
                });
                let (c, d) = friction(&shapes.change, k - from, i);
                let own = summed[at + n + i];
                bin.change.push((a + c - own, b + d + own));
            }
        }
        if along.slice.is_some() {
            // What the sums add to the twist, the momentum's part at once included.
            let jacobian = &along.course.jacobians[middle.min(along.course.jacobians.len() - 1)];
            let lag = times(&group.moved_jacobian, &summed[n..2 * n]);
            let direct = self.twist_direct(middle, momentum, payload, jacobian);
            for c in 0..self.inputs.twist {
                found.twist[c] += summed[2 * n + c] + lag[c] + direct[c];
            }
        }
        (bin, found)
    }

    /// `|J M⁻¹ x| + |J M⁻¹ Jᵀ| μ`.
    fn twist_direct(&self, k: usize, x: &[f64], mu: &[f64], jacobian: &[f64]) -> Vec<f64> {
        let n = self.n;
        let course = self.along.course;
        let inverse = &course.intervals[k.min(course.intervals.len() - 1)].inverse;
        (0..self.inputs.twist)
            .map(|c| {
                let row = &jacobian[c * n..(c + 1) * n];
                let by: Vec<f64> =
                    (0..n).map(|j| (0..n).map(|i| row[i] * inverse[i * n + j]).sum()).collect();
                let own: f64 = by.iter().zip(x).map(|(b, x)| b.abs() * x).sum();
                let rest: f64 = (0..self.inputs.twist)
                    .map(|d| {
                        let other = &jacobian[d * n..(d + 1) * n];
                        let entry: f64 = by.iter().zip(other).map(|(b, o)| b * o).sum();
                        entry.abs() * mu[d]
                    })
                    .sum();
                own + rest
            })
            .collect()
    }

    /// Puts what a bin's inputs do into the bins to come, and what is left of it into the tails.
    fn scatter(&mut self, b: usize, group: &Group, inputs: &[f64]) {
        let boxes: Vec<f64> =
            inputs.iter().zip(&self.before).map(|(now, before)| larger(*now, *before)).collect();
        let kernel = &group.kernel;
        for lag in 1..kernel.lags.min(self.along.bins.saturating_sub(b)) {
            let ahead = &mut self.ahead[b + lag];
            for (row, slot) in ahead.iter_mut().enumerate() {
                let sum: f64 =
                    kernel.lag(lag, row).iter().zip(&boxes).map(|(k, u)| f64::from(*k) * u).sum();
                *slot += sum;
            }
        }
        if let Some(segment) = self.along.segments.iter().position(|s| s.from == kernel.end) {
            let size: f64 = kernel.left.iter().zip(&boxes).map(|(l, u)| l * u).sum();
            self.arriving[segment] += self.along.course.bin as f64 * size;
        }
    }

    /// What states left over from long ago may do in a bin.
    fn tails(&mut self, b: usize) -> Vec<f64> {
        let along = self.along;
        let rows = self.inputs.rows();
        let sample = b * along.course.bin;
        let Some(now) = along.segments.iter().rposition(|s| s.from <= sample) else {
            return vec![0.0; rows];
        };
        // All that arrives here and at the next segment's start is known: kernels are at least a segment long.
        if along.segments[now].from == sample {
            let before =
                if now > 0 { self.tail[now - 1] * along.segments[now - 1].left } else { 0.0 };
            self.tail[now] = before + self.arriving[now];
        }
        let here = self.tail[now];
        let mut out: Vec<f64> = along.segments[now].rows.iter().map(|row| row * here).collect();
        if let Some(next) = along.segments.get(now + 1) {
            let there = here * along.segments[now].left + self.arriving[now + 1];
            for (out, row) in out.iter_mut().zip(&next.rows) {
                *out += row * there;
            }
        }
        out
    }
}

/// Runs of dry friction over a bin: the middle, then one per level that is not known. `[sample][column][joint]`.
struct Frictions {
    runs: Vec<Deviation<WIDE>>,
    last: Vec<Vec<f64>>,
    e: Vec<f64>,
    v: Vec<f64>,
    command: Vec<f64>,
    change: Vec<f64>,
}

impl Frictions {
    fn keep(&mut self, columns: usize, n: usize) {
        for column in 0..columns {
            let run = &self.runs[column / WIDE];
            for i in 0..n {
                self.e.push(run.state[i][column % WIDE]);
                self.v.push(run.state[n + i][column % WIDE]);
            }
        }
    }
}

impl Guess {
    /// Whether what was found lies inside.
    fn hold(&self, found: &Self) -> bool {
        let below = |own: &[f64], found: &[f64]| own.iter().zip(found).all(|(a, b)| b <= a);
        self.v.iter().zip(&found.v).all(|(a, b)| a.0 <= b.0 && b.1 <= a.1)
            && below(&self.e, &found.e)
            && below(&self.summed[0], &found.summed[0])
            && below(&self.summed[1], &found.summed[1])
            && below(&self.twist, &found.twist)
    }

    /// Holds both, and a little more.
    fn widen(&mut self, found: &Self, factor: f64) {
        for (own, found) in self.v.iter_mut().zip(&found.v) {
            let slack = (factor - 1.0) * (found.1 - found.0) + 1e-9;
            if found.0 < own.0 {
                own.0 = found.0 - slack;
            }
            if found.1 > own.1 {
                own.1 = found.1 + slack;
            }
        }
        let raise = |own: &mut Vec<f64>, found: &[f64]| {
            for (own, found) in own.iter_mut().zip(found) {
                if found > own {
                    *own = factor * found + 1e-12;
                }
            }
        };
        raise(&mut self.e, &found.e);
        raise(&mut self.twist, &found.twist);
        let [a, b] = &mut self.summed;
        raise(a, &found.summed[0]);
        raise(b, &found.summed[1]);
    }
}
