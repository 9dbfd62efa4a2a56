//! Rows of outputs, propagated backwards through the sampled loop.
//!
//! With `λ` the derivative of an output by the state, `θ` the time to go within a sample:
//!
//! ```text
//! dλ_ε/dθ = −Kᵀ λ_P,    dλ_P/dθ = M⁻¹ (λ_ε − Sᵀ λ_P)                                             (AJ1)
//! output = Σ ∫ λ_P·u dt − ∫ λ_P'·x dt + Σ λ_y n + λᵀ z(anchor)                                   (AJ2)
//! ```
//!
//! `u`: torques, `x`: momentum that is off, `n`: encoder. Over a sample `∫|λ_P| ≤ T (|a| + |b|)/2 + T δ` and
//! `∫|λ_P'| ≤ |a − b| + 4 δ`, `a, b` the ends, `δ` the most that `λ_P` is from its chord. What is read of the velocity
//! at a sample, `ε' = M⁻¹ (P − x)`, makes `λ_P` jump: `x` weighs the jump too.

use phihat_model::{Lanes, Scalar as _};

use super::frame::Frame;
use super::lanes::{WIDE, add_products, combine, eight, gather, put};
use super::law::LinearLoop;

/// Sizes of the boxes of one sample.
#[derive(Debug, Clone, Default)]
pub(super) struct Boxes {
    pub(super) u: Vec<f64>,
    pub(super) x: Vec<f64>,
    /// Momentum of the hand that is off, `v, w`, and wrench on it.
    pub(super) mu: Vec<f64>,
    pub(super) wrench: Vec<f64>,
}

impl Boxes {
    pub(super) fn none(n: usize, hand: usize) -> Self {
        Self { u: vec![0.0; n], x: vec![0.0; n], mu: vec![0.0; hand], wrench: vec![0.0; hand] }
    }

    /// The larger of both.
    pub(super) fn cover(&mut self, other: &Self) {
        let pairs = [
            (&mut self.u, &other.u),
            (&mut self.x, &other.x),
            (&mut self.mu, &other.mu),
            (&mut self.wrench, &other.wrench),
        ];
        for (mine, theirs) in pairs {
            mine.iter_mut().zip(theirs).for_each(|(a, b)| *a = a.max(*b));
        }
    }

    /// The sum of both.
    pub(super) fn plus(&self, more: &Self) -> Self {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        Self {
            u: sum(&self.u, &more.u),
            x: sum(&self.x, &more.x),
            mu: sum(&self.mu, &more.mu),
            wrench: sum(&self.wrench, &more.wrench),
        }
    }

    /// Factors of the largest weight and of the largest change of weight, for `δ`.
    fn bends(&self, frame: &Frame, period: f64) -> (f64, f64) {
        let n = self.u.len();
        let (mut by_size, mut by_step) = (0.0, 0.0);
        for i in 0..n {
            let (mut u, mut x) = (self.u[i], self.x[i]);
            for (c, (mu, wrench)) in self.mu.iter().zip(&self.wrench).enumerate() {
                let turn = frame.hand[c * n + i].abs();
                x += turn * mu;
                u += turn * wrench;
            }
            let both = 1.35 * (period * u + 4.0 * x);
            by_size += frame.bend[i].0 * both;
            by_step += frame.bend[i].1 * both;
        }
        (by_size, by_step)
    }
}

/// `J` at start and end of a sample, with a payload.
type Hands<'a> = Option<(&'a [f64], &'a [f64])>;

/// The loop, as the rows see it.
pub(super) struct AdjointRows<'a> {
    pub(super) n: usize,
    pub(super) period: f64,
    /// The loop of every joint.
    pub(super) joints: &'a [LinearLoop],
    /// True if velocity at a sample is read, by a sensor or by the robot.
    pub(super) reads_rate: bool,
    /// Half an encoder step \[rad\] per joint.
    pub(super) half_step: &'a [f64],
}

/// Weights of one sample, by row.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    pub(super) sample: usize,
    u: Vec<f64>,
    x: Vec<f64>,
    mu: Vec<f64>,
    wrench: Vec<f64>,
    most: Vec<f64>,
    step: Vec<f64>,
}

impl Weights {
    fn new(n: usize, hand: usize, rows: usize) -> Self {
        let of = |k: usize| vec![0.0; k * rows];
        Self {
            sample: 0,
            u: of(n),
            x: of(n),
            mu: of(hand),
            wrench: of(hand),
            most: of(1),
            step: of(1),
        }
    }

    /// Adds the effect of torques in this sample to every row, for so many outputs one after the other: at most `u`, by
    /// joint and, next to each other, by output.
    pub(super) fn add_torques(&self, (u, outputs): (&[f64], usize), sums: &mut [f64]) {
        add_products((u, outputs), (&self.u, self.most.len()), sums);
    }

    /// Adds the effect of the boxes of this sample to every row, but for that of their torques along straight weights.
    pub(super) fn add_rest(&self, boxes: &Boxes, frame: &Frame, period: f64, sums: &mut [f64]) {
        let pairs = [(&self.x, &boxes.x), (&self.mu, &boxes.mu), (&self.wrench, &boxes.wrench)];
        for (weights, sizes) in pairs {
            add_sizes(weights, sizes, sums);
        }
        let (by_size, by_step) = boxes.bends(frame, period);
        for ((sum, most), step) in sums.iter_mut().zip(&self.most).zip(&self.step) {
            *sum += by_size * most + by_step * step;
        }
    }
}

/// Rows on their way back: `λ[state][row]`, as many rows as fill whole lanes.
#[derive(Debug, Clone)]
pub(super) struct Back {
    pub(super) rows: usize,
    pub(super) lambda: Vec<f64>,
    next: Vec<f64>,
    /// Rows at the plant's states and torques; rows at the readings of position and velocity; jumps of `λ_P`.
    made: Vec<f64>,
    read: Vec<f64>,
    jump: Vec<f64>,
    weights: Weights,
    pub(super) noise: Vec<f64>,
}

impl Back {
    /// `states` × `rows`, all zero.
    pub(super) fn new(n: usize, hand: usize, states: usize, rows: usize) -> Self {
        let rows = rows.next_multiple_of(WIDE);
        Self {
            rows,
            lambda: vec![0.0; states * rows],
            next: vec![0.0; states * rows],
            made: vec![0.0; 4 * n * rows],
            read: vec![0.0; 2 * rows],
            jump: vec![0.0; n * rows],
            weights: Weights::new(n, hand, rows),
            noise: vec![0.0; rows],
        }
    }
}

impl AdjointRows<'_> {
    /// States of plant and loops together.
    pub(super) fn states(&self) -> usize {
        2 * self.n + self.joints.iter().map(|j| j.size).sum::<usize>()
    }

    /// Takes the rows through one sample; leaves its weights.
    pub(super) fn step<'b>(&self, back: &'b mut Back, frame: &Frame, sample: usize) -> &'b Weights {
        let (n, rows) = (self.n, back.rows);
        let Back { lambda, next, made, read, jump, weights, noise, .. } = back;
        weights.sample = sample;
        let (plant, loops) = lambda.split_at_mut(2 * n * rows);
        let (ahead, ahead_loops) = next.split_at_mut(2 * n * rows);
        let columns = frame.flow.len() / (2 * n);
        combine(&frame.flow, plant, rows, &mut made[..columns * rows]);
        ahead.copy_from_slice(&made[..2 * n * rows]);
        jump.fill(0.0);
        let mut done = 0;
        for (i, joint) in self.joints.iter().enumerate() {
            let own = &mut loops[done..done + joint.size * rows];
            // The torque that acts is part of the loop's state after its sample.
            add_row(own, joint.acting, &made[(2 * n + i) * rows..][..rows]);
            if let Some(gap) = joint.gap {
                add_row(own, gap, &made[(3 * n + i) * rows..][..rows]);
            }
            let linear = joint.at(sample);
            let before = &mut ahead_loops[done..done + joint.size * rows];
            gather(linear.columns(), own, rows, (before, read));
            let (position, rate) = read.split_at(rows);
            add_row(ahead, i, position);
            let half = self.half_step[i];
            noise.iter_mut().zip(position).for_each(|(sum, lambda)| *sum += half * lambda.abs());
            // The run starts where it is stated: there is no deviation of the velocity to be read first.
            if self.reads_rate && sample > 0 {
                spread(&frame.m_inverse[i * n..][..n], rate, jump);
            }
            done += joint.size * rows;
        }
        self.held(frame, &made[2 * n * rows..3 * n * rows], (ahead, jump));
        let own = sample - frame.first;
        let hands = frame.ends.get(own).zip(frame.ends.get(own + 1));
        let hands = hands.map(|(start, end)| (&start[..], &end[..]));
        self.weigh(plant, ahead, (frame, hands), weights);
        if self.reads_rate {
            self.weigh_jump(jump, hands, weights);
            ahead[n * rows..].iter_mut().zip(&*jump).for_each(|(to, jump)| *to += jump);
        }
        core::mem::swap(lambda, next);
        weights
    }

    /// Takes rows back through the torque that the robot adds over a sample, by the position and velocity
    /// there.
    fn held(&self, frame: &Frame, torque: &[f64], (ahead, jump): (&mut [f64], &mut [f64])) {
        let (n, rows) = (self.n, jump.len() / self.n);
        for (i, torque) in torque.chunks_exact(rows).enumerate() {
            if let Some(gravity) = frame.added.gravity.get(i * n..(i + 1) * n) {
                spread(gravity, torque, &mut ahead[..n * rows]);
            }
            if let Some(damping) = frame.added.damping_inverse.get(i * n..(i + 1) * n) {
                spread(damping, torque, jump);
            }
        }
    }

    fn weigh_jump(&self, jump: &[f64], hands: Hands<'_>, out: &mut Weights) {
        let rows = out.most.len();
        out.x.iter_mut().zip(jump).for_each(|(x, jump)| *x += jump.abs());
        let Some((hand, _)) = hands else { return };
        let mut sum = vec![0.0; rows];
        for (c, mu) in out.mu.chunks_exact_mut(rows).enumerate() {
            sum.fill(0.0);
            for (i, jump) in jump.chunks_exact(rows).enumerate() {
                let factor = hand[c * self.n + i];
                sum.iter_mut().zip(jump).for_each(|(sum, jump)| *sum += factor * jump);
            }
            mu.iter_mut().zip(&sum).for_each(|(mu, sum)| *mu += sum.abs());
        }
    }

    /// With (CA4), what the hand's momentum weighs is the change of `J λ_P`, `J̇` included: in between, `J` and
    /// `λ_P` both change, by their product more.
    fn weigh_hand(
        &self,
        (end, end_hand): (&[f64], &[f64]),
        (start, start_hand): (&[f64], &[f64]),
        frame: &Frame,
        out: &mut Weights,
    ) {
        let n = self.n;
        let rows = out.most.len();
        let Weights { mu, wrench, most, step, .. } = out;
        for c in 0..6 {
            let row = |hand: &'_ [f64], i: usize| hand[c * n + i];
            let turned: f64 = (0..n).map(|i| (row(end_hand, i) - row(start_hand, i)).abs()).sum();
            for at in (0..rows).step_by(WIDE) {
                let mut moved = Lanes::default();
                let (mut a_sum, mut b_sum) = (moved, moved);
                for i in 0..n {
                    let from = (n + i) * rows + at;
                    let (a, b) = (eight(end, from), eight(start, from));
                    let [here, j_end, j_start] = [&frame.hand[..], end_hand, start_hand]
                        .map(|hand| Lanes::splat(row(hand, i)));
                    moved += j_end * a - j_start * b;
                    a_sum += here * a;
                    b_sum += here * b;
                }
                // The products of changes, and twice as much for how `J` itself bends within a sample.
                let bent = eight(step, at) + Lanes::splat(0.01) * eight(most, at);
                let to = c * rows + at;
                put(moved.abs() + Lanes::splat(turned) * bent, mu, to);
                let both = a_sum.abs() + b_sum.abs();
                put(Lanes::splat(0.5 * self.period) * both, wrench, to);
            }
        }
    }

    fn weigh(
        &self,
        end: &[f64],
        start: &[f64],
        (frame, hands): (&Frame, Hands<'_>),
        out: &mut Weights,
    ) {
        let (n, period) = (self.n, self.period);
        let rows = out.most.len();
        out.most.fill(0.0);
        out.step.fill(0.0);
        for i in 0..n {
            let (a, b) = (&end[(n + i) * rows..][..rows], &start[(n + i) * rows..][..rows]);
            let (u, x) = (&mut out.u[i * rows..][..rows], &mut out.x[i * rows..][..rows]);
            let weights = u.iter_mut().zip(x).zip(a.iter().zip(b));
            let largest = out.most.iter_mut().zip(&mut out.step);
            for (((u, x), (a, b)), (most, step)) in weights.zip(largest) {
                let (size_a, size_b, change) = (a.abs(), b.abs(), b - a);
                *u = 0.5 * period * (size_a + size_b);
                *x = change.abs();
                *most = most.max(size_a).max(size_b);
                *step = step.max(change.abs());
            }
        }
        if let Some((start_hand, end_hand)) = hands {
            self.weigh_hand((end, end_hand), (start, start_hand), frame, out);
        }
    }
}

/// Adds rows of weights, each times a size.
fn add_sizes(weights: &[f64], sizes: &[f64], sums: &mut [f64]) {
    for (row, size) in weights.chunks_exact(sums.len()).zip(sizes) {
        sums.iter_mut().zip(row).for_each(|(sum, w)| *sum += w * size);
    }
}

/// Adds a row to one of many.
fn add_row(to: &mut [f64], at: usize, row: &[f64]) {
    to[at * row.len()..][..row.len()].iter_mut().zip(row).for_each(|(to, x)| *to += x);
}

/// Adds a row to many, each times its factor.
fn spread(factors: &[f64], row: &[f64], to: &mut [f64]) {
    for (factor, to) in factors.iter().zip(to.chunks_exact_mut(row.len())) {
        to.iter_mut().zip(row).for_each(|(to, x)| *to += factor * x);
    }
}
