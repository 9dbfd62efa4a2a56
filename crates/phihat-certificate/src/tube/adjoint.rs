//! Rows of outputs, propagated backwards through the sampled loop.
//!
//! With `λ` the derivative of an output by the state, `θ` the time to go within a sample:
//!
//! ```text
//! dλ_ε/dθ = −Kᵀ λ_P,    dλ_P/dθ = M⁻¹ (λ_ε − Sᵀ λ_P)                                             (A1)
//! output = Σ ∫ λ_P·u dt − ∫ λ_P'·x dt + Σ λ_y n + λᵀ z(anchor)                                   (A2)
//! ```
//!
//! `u`: torques, `x`: momentum that is off, `n`: encoder. Over a sample `∫|λ_P| ≤ T (|a| + |b|)/2 + T δ` and
//! `∫|λ_P'| ≤ |a − b| + 4 δ`, `a, b` the ends, `δ` the most that `λ_P` is from its chord.

use super::frame::Frame;
use super::law::Linear;

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

/// The loop, as the rows see it.
pub(super) struct Rows<'a> {
    pub(super) n: usize,
    pub(super) period: f64,
    /// Of every joint: its sample, the first one, its size, the place of the torque that acts.
    pub(super) joints: &'a [(Linear, Linear, usize, usize)],
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

    /// Adds what boxes of this sample can do to every row.
    pub(super) fn add(&self, boxes: &Boxes, frame: &Frame, period: f64, sums: &mut [f64]) {
        let rows = sums.len();
        let pairs = [
            (&self.u, &boxes.u),
            (&self.x, &boxes.x),
            (&self.mu, &boxes.mu),
            (&self.wrench, &boxes.wrench),
        ];
        for (weights, sizes) in pairs {
            for (row, size) in weights.chunks_exact(rows).zip(sizes) {
                sums.iter_mut().zip(row).for_each(|(sum, w)| *sum += w * size);
            }
        }
        let (by_size, by_step) = boxes.bends(frame, period);
        for ((sum, most), step) in sums.iter_mut().zip(&self.most).zip(&self.step) {
            *sum += by_size * most + by_step * step;
        }
    }
}

/// Rows on their way back: `λ[state][row]`.
#[derive(Debug, Clone)]
pub(super) struct Back {
    pub(super) rows: usize,
    pub(super) lambda: Vec<f64>,
    next: Vec<f64>,
    weights: Weights,
    pub(super) noise: Vec<f64>,
}

impl Back {
    /// `states` × `rows`, all zero.
    pub(super) fn new(n: usize, hand: usize, states: usize, rows: usize) -> Self {
        Self {
            rows,
            lambda: vec![0.0; states * rows],
            next: vec![0.0; states * rows],
            weights: Weights::new(n, hand, rows),
            noise: vec![0.0; rows],
        }
    }
}

impl Rows<'_> {
    /// States of plant and loops together.
    pub(super) fn states(&self) -> usize {
        2 * self.n + self.joints.iter().map(|j| j.2).sum::<usize>()
    }

    /// Takes the rows through one sample; leaves its weights.
    pub(super) fn step<'b>(
        &self,
        back: &'b mut Back,
        frame: &Frame,
        (sample, first): (usize, bool),
    ) -> &'b Weights {
        let (n, rows) = (self.n, back.rows);
        let Back { lambda, next, weights, noise, .. } = back;
        weights.sample = sample;
        let (plant, _) = lambda.split_at(2 * n * rows);
        let (ahead, ahead_loops) = next.split_at_mut(2 * n * rows);
        ahead.fill(0.0);
        for s in 0..2 * n {
            let out = &mut ahead[s * rows..(s + 1) * rows];
            for (t, from) in plant.chunks_exact(rows).enumerate() {
                let factor = frame.phi[t * 2 * n + s];
                out.iter_mut().zip(from).for_each(|(o, l)| *o += factor * l);
            }
        }
        let own = sample - frame.first;
        let hands = frame.ends.get(own).zip(frame.ends.get(own + 1));
        let hands = hands.map(|(start, end)| (&start[..], &end[..]));
        self.weigh(plant, ahead, (frame, hands), weights);
        // The torque that acts is part of the loop's state after its sample.
        let mut at = 2 * n;
        let mut done = 0;
        for (i, (linear, at_first, size, acting)) in self.joints.iter().enumerate() {
            let (plant, loops) = lambda.split_at_mut(2 * n * rows);
            let own = &mut loops[(at - 2 * n) * rows..(at - 2 * n + size) * rows];
            let acts = &mut own[acting * rows..(acting + 1) * rows];
            for (t, from) in plant.chunks_exact(rows).enumerate() {
                let factor = frame.gamma[t * n + i];
                acts.iter_mut().zip(from).for_each(|(o, l)| *o += factor * l);
            }
            let linear = if first { at_first } else { linear };
            let before = &mut ahead_loops[done..done + size * rows];
            before.fill(0.0);
            for (row, column, value) in &linear.entries {
                let out = &mut before[column * rows..(column + 1) * rows];
                let from = &own[row * rows..(row + 1) * rows];
                out.iter_mut().zip(from).for_each(|(o, l)| *o += value * l);
            }
            let mut reading = vec![0.0; rows];
            for (row, value) in linear.reading.iter().enumerate().filter(|(_, b)| b.abs() > 0.0) {
                let from = &own[row * rows..(row + 1) * rows];
                reading.iter_mut().zip(from).for_each(|(o, l)| *o += value * l);
            }
            let half = self.half_step[i];
            let position = &mut ahead[i * rows..(i + 1) * rows];
            for ((sum, lambda), reading) in noise.iter_mut().zip(position).zip(&reading) {
                *lambda += reading;
                *sum += half * reading.abs();
            }
            at += size;
            done += size * rows;
        }
        core::mem::swap(lambda, next);
        weights
    }

    /// With (L4), what the hand's momentum weighs is the change of `J λ_P`, `J̇` included: in between, `J` and
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
        for (c, (mu, wrench)) in
            mu.chunks_exact_mut(rows).zip(wrench.chunks_exact_mut(rows)).enumerate()
        {
            wrench.fill(0.0);
            let mut turned = 0.0;
            let (mut a_sum, mut b_sum) = (vec![0.0; rows], vec![0.0; rows]);
            for i in 0..n {
                let at = c * n + i;
                let (a, b) = (&end[(n + i) * rows..][..rows], &start[(n + i) * rows..][..rows]);
                let (here, j_end, j_start) = (frame.hand[at], end_hand[at], start_hand[at]);
                turned += (j_end - j_start).abs();
                for r in 0..rows {
                    mu[r] += j_end * a[r] - j_start * b[r];
                    a_sum[r] += here * a[r];
                    b_sum[r] += here * b[r];
                }
            }
            for r in 0..rows {
                // The products of changes, and twice as much for how `J` itself bends within a sample.
                mu[r] = mu[r].abs() + turned * (step[r] + 0.01 * most[r]);
                wrench[r] = 0.5 * self.period * (a_sum[r].abs() + b_sum[r].abs());
            }
        }
    }

    fn weigh(
        &self,
        end: &[f64],
        start: &[f64],
        (frame, hands): (&Frame, Option<(&[f64], &[f64])>),
        out: &mut Weights,
    ) {
        let (n, period) = (self.n, self.period);
        let rows = out.most.len();
        out.most.fill(0.0);
        out.step.fill(0.0);
        out.mu.fill(0.0);
        for i in 0..n {
            let (a, b) = (&end[(n + i) * rows..][..rows], &start[(n + i) * rows..][..rows]);
            let (u, x) = (&mut out.u[i * rows..][..rows], &mut out.x[i * rows..][..rows]);
            for r in 0..rows {
                let (size_a, size_b, change) = (a[r].abs(), b[r].abs(), b[r] - a[r]);
                u[r] = 0.5 * period * (size_a + size_b);
                x[r] = change;
                out.most[r] = out.most[r].max(size_a).max(size_b);
                out.step[r] = out.step[r].max(change.abs());
            }
        }
        if let Some((start_hand, end_hand)) = hands {
            self.weigh_hand((end, end_hand), (start, start_hand), frame, out);
        }
        out.x.iter_mut().for_each(|x| *x = x.abs());
    }
}
