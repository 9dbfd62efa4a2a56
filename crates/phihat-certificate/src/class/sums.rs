//! Sums over kicks that are played at one posture.

use super::dynamics::Dynamics;
use crate::coupled::played::{OUTPUTS, PlayedRuns};
use crate::extremes::{Extremes as _, larger};
use crate::{JointRecord, LoopModel, Matrix, Refutation};

/// Longest run \[samples\], and how often it is looked at.
const LONGEST: usize = 1 << 16;
const BLOCK: usize = 64;

/// Size of a state, over the largest it had, at which a run has come to rest.
const RESTED: f64 = 1e-9;

/// Outputs: `e`, `ė`, change of the commanded torque.
pub(super) const E: usize = 0;
pub(super) const V: usize = 1;
pub(super) const STEP: usize = 2;
pub(super) const KINDS: usize = 3;

/// One matrix for each output.
pub(super) type OutputMatrices = [Matrix; KINDS];

/// The sums at a posture; what comes after the run is left out, so none is too large.
pub(super) struct PlayedSums {
    pub(super) torque: OutputMatrices,
    pub(super) ramp: OutputMatrices,
    pub(super) reading: OutputMatrices,
    /// Largest answer to a torque that goes on from the start, and to an impulse there.
    pub(super) lasting: OutputMatrices,
    pub(super) impulse: OutputMatrices,
    /// `Σ ∫|g ∂g/∂q|`.
    pub(super) gravity: OutputMatrices,
    /// Twice integrated of `e`, once integrated of the others, per unit of each joint's speed.
    pub(super) moving: [Vec<Matrix>; KINDS],
}

/// Answers of one sample: `[output][joint that answers][joint pushed or misread]`.
#[derive(Clone)]
struct Answers {
    /// After an impulse at the sample, after one a sample before it, after a misreading.
    end: OutputMatrices,
    start: OutputMatrices,
    read: OutputMatrices,
}

fn zero(n: usize) -> Matrix {
    vec![vec![0.0; n]; n]
}

fn each(n: usize) -> OutputMatrices {
    core::array::from_fn(|_| zero(n))
}

/// `|row · m|`, entry by entry, times a weight, added.
fn add_sizes(into: &mut [f64], weight: f64, row: &[f64], m: &Matrix) {
    for (j, into) in into.iter_mut().enumerate() {
        let sum: f64 = row.iter().zip(m).map(|(x, m)| x * m[j]).sum();
        *into += weight * sum.abs();
    }
}

impl PlayedSums {
    /// Plays an impulse on every joint, one a sample earlier, and a misreading of every encoder.
    pub(super) fn at(
        loops: &[(&JointRecord, &LoopModel)],
        (dynamics, inverse): (&Dynamics, &Matrix),
        period: f64,
    ) -> Result<Self, Refutation> {
        let n = loops.len();
        let mut played = PlayedRuns::new(loops, inverse, 3 * n);
        for j in 0..n {
            played.kick(j, j, 0.0);
            played.kick(n + j, j, period);
            played.misread(2 * n + j, j);
        }
        let mut own = Self {
            torque: each(n),
            ramp: each(n),
            reading: each(n),
            lasting: each(n),
            impulse: each(n),
            gravity: each(n),
            moving: core::array::from_fn(|_| vec![zero(n); n]),
        };
        let turned: [Vec<Matrix>; 2] = [
            (0..n).map(|c| dynamics.less(c, 2.0)).collect(),
            (0..n).map(|c| dynamics.less(c, 1.0)).collect(),
        ];
        let mut whole = each(n);
        let mut before = vec![vec![0.0; 3 * n]; n];
        let mut last: Option<Answers> = None;
        let mut most = 0.0_f64;
        for sample in 0..LONGEST {
            let mut now = Answers { end: each(n), start: each(n), read: each(n) };
            played.step(|i, run, outputs: &[f64; OUTPUTS]| {
                let change = outputs[3] - core::mem::replace(&mut before[i][run], outputs[3]);
                let own = [outputs[0], outputs[1], change];
                let (set, j) = (run / n, run % n);
                for (o, value) in own.into_iter().enumerate() {
                    match set {
                        0 => now.end[o][i][j] = value,
                        1 => now.start[o][i][j] = value,
                        _ => now.read[o][i][j] = value,
                    }
                }
            });
            own.take(sample, (&now, last.as_ref()), (dynamics, &turned), period, &mut whole);
            last = Some(now);
            if sample % BLOCK == BLOCK - 1 {
                let size = (0..3 * n).map(|run| played.size(run)).largest();
                most = most.max(size);
                if size < RESTED * most {
                    return Ok(own);
                }
                if !size.is_finite() || size > 1e12 {
                    break;
                }
            }
        }
        Err(Refutation {
            claim: "class of motions".to_owned(),
            inequality: "the loop forgets a kick at a posture of the class".to_owned(),
            left: 1.0,
            right: 0.0,
        })
    }

    /// One sample: nodes of the kernels, and the interval that follows them in age.
    fn take(
        &mut self,
        sample: usize,
        (now, last): (&Answers, Option<&Answers>),
        (dynamics, turned): (&Dynamics, &[Vec<Matrix>; 2]),
        t: f64,
        whole: &mut OutputMatrices,
    ) {
        let n = dynamics.n;
        let age = sample as f64 * t;
        for o in 0..KINDS {
            for i in 0..n {
                let (end, start) = (&now.end[o][i], &now.start[o][i]);
                for j in 0..n {
                    self.reading[o][i][j] += now.read[o][i][j].abs();
                    // The kernel is straight from `end` to `start`, which is its next node.
                    self.torque[o][i][j] += t * straight(end[j], start[j]);
                    let next = whole[o][i][j] + 0.5 * t * (end[j] + start[j]);
                    self.ramp[o][i][j] += t * straight(whole[o][i][j], next);
                    whole[o][i][j] = next;
                    self.lasting[o][i][j] = larger(self.lasting[o][i][j], next.abs());
                    self.impulse[o][i][j] = larger(self.impulse[o][i][j], end[j].abs());
                }
                let middle: Vec<f64> = end.iter().zip(start).map(|(a, b)| 0.5 * (a + b)).collect();
                let slope: Vec<f64> = end.iter().zip(start).map(|(a, b)| (b - a) / t).collect();
                add_sizes(&mut self.gravity[o][i], t, &middle, &dynamics.gravity);
                let jump: Vec<f64> = match (o, last) {
                    (E, Some(last)) => {
                        let before = last.end[o][i].iter().zip(&last.start[o][i]);
                        slope.iter().zip(before).map(|(s, (a, b))| s - (b - a) / t).collect()
                    }
                    _ => vec![0.0; n],
                };
                for c in 0..n {
                    let into = &mut self.moving[o][c][i];
                    if o == E {
                        add_sizes(into, age, &jump, &dynamics.slopes[c]);
                        add_sizes(into, t, &slope, &turned[0][c]);
                    } else {
                        add_sizes(into, (age + 0.5 * t) * t, &slope, &dynamics.slopes[c]);
                        add_sizes(into, t, &middle, &turned[1][c]);
                    }
                }
            }
        }
    }
}

/// `∫_0^1 |a + (b − a) x| dx`.
fn straight(a: f64, b: f64) -> f64 {
    if a * b >= 0.0 {
        return 0.5 * (a + b).abs();
    }
    0.5 * (a * a + b * b) / (a - b).abs()
}
