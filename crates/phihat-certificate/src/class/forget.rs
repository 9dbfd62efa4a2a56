//! Rest of a sum after its last sample: by how much a loop shrinks every state over a block of samples.

use crate::coupled::played::{OUTPUTS, PlayedRuns};
use crate::extremes::larger;
use crate::{JointRecord, LoopModel, Matrix, Refutation};

/// Squarings of the matrix of one sample at most.
const SQUARINGS: usize = 20;

/// Sum of a row that a power of the matrix has at most.
const SHRUNK: f64 = 0.25;

/// Decay of a loop: `‖x_{k+N}‖ ≤ ρ ‖x_k‖` for every state, in the largest norm of the states' own units.
pub(super) struct TailDecay {
    /// `N` \[samples\].
    pub(super) block: usize,
    /// `ρ`.
    ratio: f64,
    /// Largest outputs of a state of size 1: `[joint][output]`.
    outputs: Vec<[f64; OUTPUTS]>,
}

impl TailDecay {
    /// From one sample of a state with a unit in each of its places, and its powers.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: the loop does not forget.
    pub(super) fn of(
        loops: &[(&JointRecord, &LoopModel)],
        inverse: &Matrix,
    ) -> Result<Self, Refutation> {
        let size = PlayedRuns::new(loops, inverse, 0).length();
        let mut played = PlayedRuns::new(loops, inverse, size);
        played.start_everywhere();
        let mut outputs = vec![[0.0; OUTPUTS]; loops.len()];
        played.step(|i, _, own| {
            for (sum, own) in outputs[i].iter_mut().zip(own) {
                *sum += own.abs();
            }
        });
        // Row by row: what a place becomes.
        let mut power = vec![0.0; size * size];
        for from in 0..size {
            for (to, value) in played.state(from).into_iter().enumerate() {
                power[to * size + from] = value;
            }
        }
        let mut block = 1;
        for _ in 0..SQUARINGS {
            let ratio = norm(&power, size);
            if !ratio.is_finite() {
                break;
            }
            if ratio < SHRUNK {
                return Ok(Self { block, ratio, outputs });
            }
            power = squared(&power, size);
            block *= 2;
        }
        Err(Refutation {
            claim: "class of motions".to_owned(),
            inequality: "the loop forgets a kick at a posture of the class".to_owned(),
            left: 1.0,
            right: 0.0,
        })
    }

    /// `Σ |y_k| (k + 2)^p` over the samples from `last` on, for `p` = 0, 1, 2, per sum of the sizes of the state over
    /// the `N` samples before: of joint `i`'s output `o`.
    ///
    /// That block counts once more, with the ages that follow it: room for the change of an output per sample.
    pub(super) fn rest(&self, (i, o): (usize, usize), last: usize) -> [f64; 3] {
        let (k, n, r) = (last as f64 + 2.0, self.block as f64, self.ratio);
        let left = 1.0 - r;
        // Σ_j ρ^j (k + j N)^p from j = 0 on.
        let [zero, one, two] =
            [1.0 / left, r / (left * left), r * (1.0 + r) / (left * left * left)];
        let sums = [zero, k * zero + n * one, k * k * zero + 2.0 * k * n * one + n * n * two];
        sums.map(|sum| self.outputs[i][o] * sum)
    }
}

fn norm(matrix: &[f64], size: usize) -> f64 {
    let row = |row: &[f64]| row.iter().map(|x| x.abs()).sum::<f64>();
    matrix.chunks_exact(size.max(1)).map(row).fold(0.0, larger)
}

fn squared(matrix: &[f64], size: usize) -> Vec<f64> {
    let mut out = vec![0.0; size * size];
    for (out, row) in out.chunks_exact_mut(size).zip(matrix.chunks_exact(size)) {
        for (factor, from) in row.iter().zip(matrix.chunks_exact(size)) {
            if factor.abs() > 0.0 {
                out.iter_mut().zip(from).for_each(|(out, from)| *out += factor * from);
            }
        }
    }
    out
}

/// Sizes of the states of some runs over the last samples.
pub(super) struct RecentSizes {
    /// `[run][sample modulo N]`.
    sizes: Vec<Vec<f64>>,
    at: usize,
}

impl RecentSizes {
    pub(super) fn new(runs: usize, block: usize) -> Self {
        Self { sizes: vec![vec![0.0; block]; runs], at: 0 }
    }

    /// Before one more sample.
    pub(super) fn take(&mut self, played: &PlayedRuns<'_>) {
        for (run, sizes) in self.sizes.iter_mut().enumerate() {
            if let Some(size) = sizes.get_mut(self.at) {
                *size = played.size(run);
            }
        }
        self.at += 1;
        if self.sizes.first().is_some_and(|sizes| self.at >= sizes.len()) {
            self.at = 0;
        }
    }

    /// Sum over the last `N` samples.
    pub(super) fn sum(&self, run: usize) -> f64 {
        self.sizes.get(run).map_or(f64::NAN, |sizes| sizes.iter().sum())
    }
}

#[cfg(test)]
mod tests {
    use super::{TailDecay, squared};
    use crate::coupled::played::OUTPUTS;

    #[test]
    fn what_comes_after_is_at_least_a_sum_to_the_end() {
        // y_k = 3 ρ^{k/N} with steps of whole blocks: the slowest output that the bound allows.
        let (block, ratio) = (4, 0.2_f64);
        let decay = TailDecay { block, ratio, outputs: vec![[3.0; OUTPUTS]] };
        let size = |k: usize| ratio.powi(i32::try_from(k / block).unwrap_or(i32::MAX));
        let last = 12;
        let before: f64 = (last - block..last).map(size).sum();
        for (p, bound) in decay.rest((0, 0), last).into_iter().enumerate() {
            let age = |k: usize| (k as f64 + 2.0).powi(i32::try_from(p).unwrap_or(0));
            let sum: f64 = (last..400).map(|k| 3.0 * size(k) * age(k)).sum();
            // The block before counts once more.
            let most: f64 = (last - block..400).map(|k| 3.0 * size(k) * age(k + 2 * block)).sum();
            assert!(
                sum < before * bound && before * bound < 1.001 * most,
                "{p}: {sum} {bound} {most}"
            );
        }
    }

    #[test]
    fn a_matrix_is_squared() {
        let squared = squared(&[1.0, 2.0, 0.0, 3.0], 2);
        assert!(squared.iter().zip([1.0, 8.0, 0.0, 9.0]).all(|(a, b)| (a - b).abs() < 1e-15));
    }
}
