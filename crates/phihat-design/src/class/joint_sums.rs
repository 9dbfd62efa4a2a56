//! Sums over the impulse responses of one joint that answers, at one posture.

use phihat_certificate::extremes::larger;

use super::refusal::ClassRefusal;
use super::slopes::Slopes;
use crate::coupled::linear::LEFT;

/// Outputs: `e`, `ė`, change of the commanded torque per sample, commanded torque that acts, `ë` without the force
/// itself.
pub(super) const E: usize = 0;
pub(super) const V: usize = 1;
pub(super) const STEP: usize = 2;
pub(super) const ACTING: usize = 3;
pub(super) const FREE: usize = 4;
pub(super) use crate::coupled::abreast::KINDS;

/// Largest share of a sum over time that its tail may be: rounding of the step response.
const FADED: f64 = 1e-5;

/// Matrices with one row per joint that answers; row by row, for each output.
pub(super) type AnswerMatrices = [Vec<f64>; KINDS];

/// Answers of the command by which a row of losses grows, row by row of the matrices.
#[derive(Debug, Clone, Default)]
pub(super) struct RowSums {
    /// Change of the command from sample to sample by the rows before the one that begins.
    pub(super) earlier: Vec<f64>,
    /// Largest size of the command so many samples after a deviation, from 1 on.
    pub(super) levels: Vec<Vec<f64>>,
    /// Change of the command over so many samples, from 2 on, by errors of readings.
    pub(super) spans: Vec<Vec<f64>>,
}

impl RowSums {
    /// Adds the row of a joint.
    pub(super) fn extend(&mut self, row: Self) {
        self.earlier.extend(row.earlier);
        for (all, row) in [(&mut self.levels, row.levels), (&mut self.spans, row.spans)] {
            all.resize(row.len(), Vec::new());
            all.iter_mut().zip(row).for_each(|(all, row)| all.extend(row));
        }
    }
}

/// Sums of one joint that answers.
pub(super) struct JointSums {
    pub(super) n: usize,
    /// The joint.
    pub(super) joint: usize,
    pub(super) period: f64,
    /// Step responses.
    pub(super) whole: AnswerMatrices,
    pub(super) torque: AnswerMatrices,
    pub(super) ramp: AnswerMatrices,
    pub(super) reading: AnswerMatrices,
    pub(super) lasting: AnswerMatrices,
    pub(super) impulse: AnswerMatrices,
    pub(super) start: AnswerMatrices,
    pub(super) lost: AnswerMatrices,
    pub(super) rows: RowSums,
    pub(super) start_moves: [Vec<f64>; 2],
    pub(super) slope: AnswerMatrices,
    pub(super) aged: AnswerMatrices,
    pub(super) bent: AnswerMatrices,
    pub(super) turned: Vec<f64>,
    pub(super) gravity: AnswerMatrices,
    pub(super) twice: Vec<f64>,
    pub(super) once: [Vec<f64>; KINDS],
    /// Sizes for what is left to bound by sizes: of `e` `Σ age|δ|`, of others `Σ age T|g'|`; of `e` `T Σ|g'|`; `∫|g|`.
    pub(super) late_age: AnswerMatrices,
    pub(super) late_slope: Vec<f64>,
    pub(super) late_torque: AnswerMatrices,
    /// `Σ (2 age + T) T|α|` and `T Σ|α|`, `α` the `ë` of `g'`: what lies between samples.
    pub(super) chords: [Vec<f64>; 2],
}

/// Part of a torque that goes on which the torque that acts opposes in the end; of no other output.
pub(super) fn withstood(output: usize, own_joint: bool) -> f64 {
    if output == ACTING && own_joint { 1.0 } else { 0.0 }
}

/// Remainder of the sums of one joint that answers, of torque and reading, per joint on which they act.
pub(super) type JointTails = [Vec<[f64; KINDS]>; 2];

impl JointSums {
    /// Adds what comes after the last sample. With `‖A^N‖ < ε` after the horizon of `N` samples, sums from `2N` on are
    /// at most `ε` times the bound on those from `N` on.
    pub(super) fn tails(
        &mut self,
        i: usize,
        [torques, readings]: &JointTails,
        samples: usize,
    ) -> Result<(), ClassRefusal> {
        let t = self.period;
        // Ages from 2N on, in blocks of N with ε each: 3 N, and 9 N², with room for the rest of the row.
        let age = 1.6 * samples as f64 * t;
        for (j, (torque, reading)) in torques.iter().zip(readings).enumerate() {
            for o in 0..KINDS {
                let torque = LEFT * torque[o];
                let slope = 2.0 * torque / t;
                self.reading[o][j] += reading[o];
                self.torque[o][j] += torque;
                self.late_torque[o][j] += torque;
                self.aged[o][j] += age * torque;
                self.slope[o][j] += slope;
                self.impulse[o][j] = larger(self.impulse[o][j], slope);
                self.late_age[o][j] += if o == E { age * 2.0 * slope / t } else { age * slope };
                self.bent[o][j] += 0.5 * age * age * if o == E { 2.0 * slope / t } else { slope };
                if o == E {
                    self.turned[j] += age * slope;
                    self.late_slope[j] += slope;
                }
                if o == FREE {
                    self.chords[0][j] += 2.0 * age * slope / t;
                    self.chords[1][j] += slope;
                    continue;
                }
                // A step response that does not fade: Σ|G| does not end.
                let left = (self.whole[o][j] + withstood(o, i == j)).abs();
                let scale = self.torque[o][j].max(self.torque[o][i]);
                if left > torque + FADED * scale {
                    return Err(ClassRefusal::NoIntegrator { joint: i + 1 });
                }
                self.ramp[o][j] += age * torque;
                self.lasting[o][j] = larger(self.lasting[o][j], left + torque);
            }
        }
        Ok(())
    }

    /// Puts together what is bounded by sizes, and what lies between the samples.
    pub(super) fn finish(&mut self, slopes: &Slopes) {
        let (n, t) = (self.n, self.period);
        let eighth = t * t / 8.0;
        for o in 0..KINDS {
            for j in 0..n {
                // Within an interval a step response is off its chord by T²/12 times its curvature in the mean, and by
                // T²/8 times it at most.
                self.ramp[o][j] += t * t / 12.0 * self.slope[o][j];
                self.lasting[o][j] += t / 8.0 * self.slope[o][j];
            }
        }
        // What acts stays over a sample, in which a torque with a rate goes on.
        self.ramp[ACTING][self.joint] += t;
        for c in 0..n {
            let (dm, coriolis) = (&slopes.dm[c], slopes.coriolis(c));
            for l in 0..n {
                for j in 0..n {
                    let (m, d) = (dm[l * n + j].abs(), coriolis[l * n + j]);
                    let (twice, once) =
                        ((2.0 * dm[l * n + j] - d).abs(), (dm[l * n + j] - d).abs());
                    let at = c * n + j;
                    self.twice[at] += self.late_age[E][l] * m
                        + self.late_slope[l] * twice
                        + eighth * (self.chords[0][l] * m + self.chords[1][l] * twice);
                    for o in V..KINDS {
                        self.once[o][at] += self.late_age[o][l] * m + self.late_torque[o][l] * once;
                    }
                }
            }
        }
        for o in 0..KINDS {
            for l in 0..n {
                for j in 0..n {
                    self.gravity[o][j] += self.late_torque[o][l] * slopes.gravity[l * n + j].abs();
                }
            }
        }
        // Between two samples e differs from its chord by at most T²/8 times ë; ė is straight.
        for j in 0..n {
            self.torque[E][j] += eighth * self.torque[FREE][j];
            self.ramp[E][j] += eighth * self.ramp[FREE][j];
            self.reading[E][j] += eighth * self.reading[FREE][j];
            self.lasting[E][j] += eighth * self.lasting[FREE][j];
            self.impulse[E][j] += eighth * self.impulse[FREE][j];
            self.start[E][j] += eighth * self.start[FREE][j];
            self.lost[E][j] += eighth * self.lost[FREE][j];
            self.aged[E][j] += eighth * self.aged[FREE][j];
            self.slope[E][j] += eighth * self.slope[FREE][j];
            self.turned[j] += eighth * (self.late_age[FREE][j] + t * self.slope[FREE][j]);
            // A jump of a slope is at most the two slopes beside it.
            self.bent[E][j] += eighth * 2.0 / t * self.bent[FREE][j];
            self.start_moves[0][j] += eighth / t * self.late_age[FREE][j];
            self.start_moves[1][j] += eighth * self.impulse[FREE][j];
            self.gravity[E][j] += eighth * self.gravity[FREE][j];
        }
    }
}
