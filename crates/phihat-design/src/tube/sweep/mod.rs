//! One pass along the motion: bounds that one evaluation of the causal sums finds again, smaller.

mod dry;
mod guess;
mod inputs;
mod outputs;
mod stretch;

use phihat_certificate::extremes::larger;

pub(super) use outputs::Bin;

use super::along::Along;
use super::group::BinGroup;
use super::kernel::Kernel;
use super::refusal::TubeRefusal;
use crate::lanes::{Lane, WIDE, add_product};
use dry::{DryInputs, DryRuns};
use guess::Guess;
use inputs::inputs_of;
use outputs::SweepOutputs;
use stretch::SweepStretch;

/// Rounds in one bin before it is given up.
const ROUNDS: u32 = 80;

/// Factor by which a hypothesis is widened when it does not hold.
const WIDER: f64 = 1.01;

/// For what is left out of the sums: curvature of responses within a sample, rounding.
const SLACK: f64 = 1.01;

/// Bound from which on nothing will close \[rad\].
const LOST: f64 = 1.0;

/// The state of a sweep.
pub(super) struct TubeSweep<'a> {
    along: &'a Along<'a>,
    /// Largest error of a reading \[rad\].
    misread: &'a [f64],
    /// Outputs of bins to come, from inputs so far: `[bin][row]`.
    ahead: Vec<Vec<f64>>,
    /// Inputs of the bin before.
    before: Vec<f64>,
    /// Sizes of the state that arrives at each segment's start from kernels that end there, and of all that is there.
    arriving: Vec<Vec<f64>>,
    tail: Vec<Vec<f64>>,
    friction: DryInputs,
    first_reading: &'a Kernel,
    /// Boxes of the present group's bins, which bins after the group have not heard of.
    untold: Vec<Vec<f64>>,
    pub(super) bin_results: Vec<Bin>,
}

impl<'a> TubeSweep<'a> {
    pub(super) fn new(along: &'a Along<'a>, misread: &'a [f64], first_reading: &'a Kernel) -> Self {
        let inputs = along.course.inputs();
        let none = vec![vec![0.0; along.course.states()]; along.segments.len() + 1];
        let mut arriving = none.clone();
        if let Some(segment) = along.segments.iter().position(|s| s.from == first_reading.end) {
            let mut boxes = vec![0.0; inputs.count()];
            boxes[inputs.reading()..][..misread.len()].copy_from_slice(misread);
            arriving[segment] = first_reading.left_of(&boxes).collect();
        }
        Self {
            along,
            misread,
            ahead: vec![vec![0.0; inputs.rows()]; along.bins],
            before: vec![0.0; inputs.count()],
            arriving,
            tail: none,
            friction: DryInputs::new(along.course.scene),
            first_reading,
            untold: Vec::new(),
            bin_results: Vec::with_capacity(along.bins),
        }
    }

    /// Goes through the bins of a group.
    pub(super) fn group(&mut self, group: &BinGroup) -> Result<(), TubeRefusal> {
        let (first, end) = group.bins;
        for b in first..end {
            self.bin((b, end), group)?;
        }
        self.tell_later_groups((first, end), &group.kernel);
        Ok(())
    }

    /// Goes through one bin of a group that ends before bin `end`.
    fn bin(&mut self, (b, end): (usize, usize), group: &BinGroup) -> Result<(), TubeRefusal> {
        let at = SweepStretch::new(self.along, group, b);
        let tail = self.tails(b);
        let mut guess = self.first_guess(&at);
        let mut rounds = 0;
        let (bin, inputs, runs) = loop {
            let inputs = inputs_of(&at, self.misread, &guess);
            let runs = self.friction.over(&at, &guess);
            let (bin, found) = self.outputs(&at, &inputs, &tail, &runs);
            let inside = guess.hold(&found);
            rounds += 1;
            if inside {
                // One more evaluation, of the smaller bounds: whatever stays in `found` gives no larger inputs.
                break (bin, inputs, runs);
            }
            let lost = found.e.iter().any(|e| e.is_nan() || *e > LOST);
            if rounds > ROUNDS || lost {
                let worst =
                    (0..at.n).max_by(|i, j| found.e[*i].total_cmp(&found.e[*j])).unwrap_or(0);
                let scene = self.along.course.scene;
                let joint = scene.names[worst].clone();
                let t = at.from as f64 * scene.period;
                return Err(TubeRefusal::Open { joint, t });
            }
            guess.widen(&found, if rounds > 20 { 1.05 } else { WIDER });
        };
        self.scatter((b, end), group, &inputs);
        self.friction.go_on(runs);
        self.before = inputs;
        self.bin_results.push(bin);
        Ok(())
    }

    /// A little more than at the end of the bin before.
    fn first_guess(&self, at: &SweepStretch<'_>) -> Guess {
        let n = at.n;
        let rows = &self.ahead[at.b];
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
        let twist = (0..at.inputs.twist).map(|c| own(2 * n + c)).collect();
        Guess {
            v: (at.from..=at.to).flat_map(|_| v.clone()).collect(),
            e,
            summed: [(0..n).map(own).collect(), (0..n).map(|i| own(n + i)).collect()],
            twist,
        }
    }

    /// Bounds that follow in a bin, and the guess that they would be.
    fn outputs(
        &self,
        at: &SweepStretch<'_>,
        inputs: &[f64],
        tail: &[f64],
        runs: &DryRuns,
    ) -> (Bin, Guess) {
        let boxes = &self.boxes(inputs);
        let summed = &self.summed(at, boxes, tail);
        SweepOutputs { at, boxes, summed, friction: &self.friction, runs }.bounds()
    }

    /// The larger box of each input, of this bin and the one before.
    fn boxes(&self, inputs: &[f64]) -> Vec<f64> {
        inputs.iter().zip(&self.before).map(|(now, before)| larger(*now, *before)).collect()
    }

    /// Sums over all inputs so far, per row of the outputs.
    fn summed(&self, at: &SweepStretch<'_>, boxes: &[f64], tail: &[f64]) -> Vec<f64> {
        let mut summed = vec![0.0; at.inputs.rows()];
        for (row, sum) in summed.iter_mut().enumerate() {
            let own = at.group.kernel.lag(0, row);
            *sum = SLACK * (self.ahead[at.b][row] + dot(own, boxes) + tail[row]);
            if at.b < self.first_reading.lags {
                let first = &self.first_reading.lag(at.b, row)[at.inputs.reading()..];
                *sum += dot(&first[..self.misread.len()], self.misread);
            }
        }
        summed
    }

    /// Puts what a bin's inputs do into the later bins of its group, and what is left of it in the end into the tails.
    fn scatter(&mut self, (b, end): (usize, usize), group: &BinGroup, inputs: &[f64]) {
        let boxes = self.boxes(inputs);
        let kernel = &group.kernel;
        for lag in 1..kernel.lags.min(end - b) {
            for (row, slot) in self.ahead[b + lag].iter_mut().enumerate() {
                *slot += dot(kernel.lag(lag, row), &boxes);
            }
        }
        if let Some(segment) = self.along.segments.iter().position(|s| s.from == kernel.end) {
            let bin = self.along.course.bin as f64;
            let arriving = self.arriving[segment].iter_mut();
            arriving.zip(kernel.left_of(&boxes)).for_each(|(sum, size)| *sum += bin * size);
        }
        self.untold.push(boxes);
    }

    /// Puts what the inputs of a group's bins do into all bins after it: lag by lag, so that a kernel is read once.
    fn tell_later_groups(&mut self, (first, end): (usize, usize), kernel: &Kernel) {
        let untold = core::mem::take(&mut self.untold);
        // Input after input, bins of the group side by side.
        let (bins, rows) = (untold.len(), self.along.course.inputs().rows());
        let blocks: Vec<Vec<Lane<WIDE>>> = untold.chunks(WIDE).map(abreast).collect();
        let mut sums = vec![Lane::ZERO; rows];
        let mut own = Vec::new();
        for lag in 1..kernel.lags {
            // Bins that this lag takes beyond the group, and not beyond the run.
            let from = end.saturating_sub(first + lag).min(bins);
            let to = self.along.bins.saturating_sub(first + lag).min(bins);
            if from >= to {
                continue;
            }
            own.clear();
            own.extend(kernel.of_lag(lag).iter().map(|k| f64::from(*k)));
            for (block, boxes) in blocks.iter().enumerate() {
                let bins = (WIDE * block).max(from)..(WIDE * (block + 1)).min(to);
                if bins.is_empty() {
                    continue;
                }
                sums.fill(Lane::ZERO);
                add_product(&mut sums, &own, boxes);
                for bin in bins {
                    let later = self.ahead[first + lag + bin].iter_mut();
                    later.zip(&sums).for_each(|(later, sum)| *later += sum[bin - WIDE * block]);
                }
            }
        }
    }

    /// Largest effect in a bin of states left over from long ago.
    fn tails(&mut self, b: usize) -> Vec<f64> {
        let along = self.along;
        let rows = along.course.inputs().rows();
        let sample = b * along.course.bin;
        let mut out = vec![0.0; rows];
        let Some(now) = along.segments.iter().rposition(|s| s.from <= sample) else {
            if let Some(next) = along.segments.first().filter(|next| next.reaches(b)) {
                next.add_before(&mut out, &self.arriving[0]);
            }
            return out;
        };
        // All that arrives here and at the next segment's start is known: kernels are at least a segment long.
        if along.segments[now].from == sample {
            self.tail[now] = match now.checked_sub(1) {
                Some(before) => self.arrived((before, now)),
                None => self.arriving[now].clone(),
            };
        }
        along.segments[now].add(&mut out, b, &self.tail[now]);
        if let Some(before) = now.checked_sub(1) {
            along.segments[before].add_after(&mut out, b, &self.tail[before]);
        }
        if let Some(next) = along.segments.get(now + 1).filter(|next| next.reaches(b)) {
            next.add_before(&mut out, &self.arrived((now, now + 1)));
        }
        out
    }

    /// The state at a segment's start: what is left of that of the one before, and what arrives.
    fn arrived(&self, (before, now): (usize, usize)) -> Vec<f64> {
        let mut state = self.along.segments[before].left_of(&self.tail[before]);
        state.iter_mut().zip(&self.arriving[now]).for_each(|(state, more)| *state += more);
        state
    }
}

/// Input after input of some bins, side by side.
fn abreast(bins: &[Vec<f64>]) -> Vec<Lane<WIDE>> {
    let count = bins.first().map_or(0, Vec::len);
    let of = |u: usize| Lane::of(|c| bins.get(c).map_or(0.0, |bin| bin[u]));
    (0..count).map(of).collect()
}

/// `Σ k u`, in sums that do not wait for each other.
fn dot(k: &[f32], u: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (mut k, mut u) = (k.chunks_exact(sums.len()), u.chunks_exact(sums.len()));
    for (k, u) in (&mut k).zip(&mut u) {
        for (sum, (k, u)) in sums.iter_mut().zip(k.iter().zip(u)) {
            *sum += f64::from(*k) * u;
        }
    }
    for (sum, (k, u)) in sums.iter_mut().zip(k.remainder().iter().zip(u.remainder())) {
        *sum += f64::from(*k) * u;
    }
    sums.into_iter().sum()
}

#[cfg(test)]
mod tests {
    use super::dot;

    #[test]
    fn products_of_every_length() {
        for length in 0..=20_u8 {
            let k: Vec<f32> = (0..length).map(|i| f32::from(i) + 0.5).collect();
            let u: Vec<f64> = (0..length).map(|i| f64::from(i) - 3.0).collect();
            let all: f64 = k.iter().zip(&u).map(|(k, u)| f64::from(*k) * u).sum();
            assert!((dot(&k, &u) - all).abs() < 1e-9, "{length}");
        }
    }
}
