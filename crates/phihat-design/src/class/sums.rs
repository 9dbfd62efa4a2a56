//! Sums over the impulse responses of the loop frozen at one posture.

use phihat_certificate::Refutation;
use phihat_certificate::extremes::larger;

use super::answers::{SparseColumns, WideSums};
use super::refusal::ClassRefusal;
use super::rows::LostRows;
use super::scene::ClassScene;
use super::slopes::Slopes;
use crate::coupled::abreast::AbreastTails;
use crate::coupled::linear::{LEFT, Linear, SumHorizon};
use crate::lanes::WIDE;

/// Outputs: `e`, `ė`, change of the commanded torque per sample, `ë` without the force itself.
pub(super) const E: usize = 0;
pub(super) const V: usize = 1;
pub(super) const STEP: usize = 2;
pub(super) const FREE: usize = 3;
pub(super) use crate::coupled::abreast::KINDS;

/// Largest share of a sum over time that its tail may be: rounding of the step response.
const FADED: f64 = 1e-5;

/// Matrices with one row per joint that answers; row by row, for each output.
pub(super) type AnswerMatrices = [Vec<f64>; KINDS];

/// The sums at one posture with one payload. Columns: the joint on which a torque acts, or whose reading errs.
#[derive(Debug, Clone)]
pub(super) struct PostureSums {
    /// Where, in words, and the index of the payload.
    pub(super) q: Vec<f64>,
    pub(super) case: usize,
    pub(super) inverse: Vec<f64>,
    pub(super) mass: Vec<f64>,
    /// Γ from a torque of any course; `e` at all times, like those that follow.
    pub(super) torque: AnswerMatrices,
    /// Γ from the rate of a torque.
    pub(super) ramp: AnswerMatrices,
    /// Γ from errors of readings.
    pub(super) reading: AnswerMatrices,
    /// Largest answer to a torque that goes on from the start, and to an impulse of torque at the start.
    pub(super) lasting: AnswerMatrices,
    pub(super) impulse: AnswerMatrices,
    /// Largest answer to a start off by an angle, law and arm, beyond what later readings can add.
    pub(super) start: AnswerMatrices,
    /// Largest `(age + T) |g'|`, and `|g|`, of `e`: the start's part in what moves.
    pub(super) start_moves: [Vec<f64>; 2],
    /// Rows of lost commands, per deviation of what is lost.
    pub(super) lost: AnswerMatrices,
    pub(super) rows: RowSums,
    /// `T Σ|g'|`.
    pub(super) slope: AnswerMatrices,
    /// `Σ age ∫|g|`.
    pub(super) aged: AnswerMatrices,
    /// `Σ ½ age² T|g'|`; of `e` `Σ ½ age² |δ|`.
    pub(super) bent: AnswerMatrices,
    /// `Σ age T|g'|` of `e`.
    pub(super) turned: Vec<f64>,
    /// `Σ ∫|g ∂g/∂q|`.
    pub(super) gravity: AnswerMatrices,
    /// Twice integrated, of `e`: entry `c` for joint `c`'s speed.
    pub(super) twice: Vec<Vec<f64>>,
    /// Once integrated, of all but `e`.
    pub(super) once: [Vec<Vec<f64>>; KINDS],
}

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
    fn extend(&mut self, row: Self) {
        self.earlier.extend(row.earlier);
        for (all, row) in [(&mut self.levels, row.levels), (&mut self.spans, row.spans)] {
            all.resize(row.len(), Vec::new());
            all.iter_mut().zip(row).for_each(|(all, row)| all.extend(row));
        }
    }
}

/// The posture's matrices, those of all joints' speeds side by side: column `c n + j`.
pub(super) struct MovingSums {
    /// `∂_c M`, `2 ∂_c M − D_c`, `∂_c M − D_c`.
    pub(super) blocks: [SparseColumns; 3],
    pub(super) gravity_columns: SparseColumns,
    pub(super) mass_columns: SparseColumns,
    /// `M^{-1}`, row by row.
    pub(super) inverse: Vec<f64>,
}

impl MovingSums {
    fn of(slopes: &Slopes, inverse: Vec<f64>) -> Self {
        let n = slopes.n;
        let mut blocks = [vec![0.0; n * n * n], vec![0.0; n * n * n], vec![0.0; n * n * n]];
        for c in 0..n {
            let coriolis = slopes.coriolis(c);
            for l in 0..n {
                for j in 0..n {
                    let (m, d) = (slopes.dm[c][l * n + j], coriolis[l * n + j]);
                    let at = (l * n + c) * n + j;
                    (blocks[0][at], blocks[1][at], blocks[2][at]) = (m, 2.0 * m - d, m - d);
                }
            }
        }
        Self {
            blocks: blocks.map(|block| SparseColumns::of(&block, n * n)),
            gravity_columns: SparseColumns::of(&slopes.gravity, n),
            mass_columns: SparseColumns::of(&slopes.mass, n),
            inverse,
        }
    }

    /// Number of joints.
    pub(super) fn joints(&self) -> usize {
        self.inverse.len().isqrt()
    }
}

impl PostureSums {
    /// The sums at a posture.
    ///
    /// # Errors
    ///
    /// [`ClassRefusal`]: the loop is not stable there, or its law has no integrator.
    pub(super) fn at(scene: &ClassScene<'_>, case: usize, q: &[f64]) -> Result<Self, ClassRefusal> {
        let n = scene.n;
        let slopes = Slopes::at(&mut scene.posed(&scene.cases[case]), q);
        let inverse = slopes.inverse().ok_or_else(|| unstable("M(q) is positive definite"))?;
        let loops = scene.loops();
        let linear = Linear::new(&loops, &inverse);
        let horizon = linear.horizon().ok_or_else(|| unstable("A^k → 0 (stable loop)"))?;
        let flat: Vec<f64> = (0..n * n).map(|k| inverse[(k / n, k % n)]).collect();
        let moving = MovingSums::of(&slopes, flat.clone());
        let each = || -> AnswerMatrices { core::array::from_fn(|_| Vec::with_capacity(n * n)) };
        let per_joint = || vec![vec![0.0; n * n]; n];
        let mut own = Self {
            q: q.to_vec(),
            case,
            inverse: flat,
            mass: slopes.mass.clone(),
            torque: each(),
            ramp: each(),
            reading: each(),
            lasting: each(),
            impulse: each(),
            start: each(),
            lost: each(),
            rows: RowSums::default(),
            start_moves: [Vec::new(), Vec::new()],
            slope: each(),
            aged: each(),
            bent: each(),
            turned: Vec::new(),
            gravity: each(),
            twice: per_joint(),
            once: core::array::from_fn(|_| per_joint()),
        };
        for first in (0..n).step_by(WIDE) {
            for (c, row) in JointSums::abreast(scene, (&linear, &horizon), first, &moving)?
                .into_iter()
                .enumerate()
            {
                own.push(first + c, row, &slopes);
            }
        }
        Ok(own)
    }

    /// Adds the row of a joint.
    fn push(&mut self, i: usize, mut row: JointSums, slopes: &Slopes) {
        let n = slopes.n;
        row.finish(slopes);
        let into = |lists: &mut AnswerMatrices, rows: AnswerMatrices| {
            for (list, row) in lists.iter_mut().zip(rows) {
                list.extend(row);
            }
        };
        into(&mut self.torque, row.torque);
        into(&mut self.ramp, row.ramp);
        into(&mut self.reading, row.reading);
        into(&mut self.lasting, row.lasting);
        into(&mut self.impulse, row.impulse);
        into(&mut self.start, row.start);
        into(&mut self.lost, row.lost);
        self.rows.extend(row.rows);
        into(&mut self.slope, row.slope);
        into(&mut self.aged, row.aged);
        into(&mut self.bent, row.bent);
        into(&mut self.gravity, row.gravity);
        self.turned.extend(row.turned);
        for (list, row) in self.start_moves.iter_mut().zip(row.start_moves) {
            list.extend(row);
        }
        for c in 0..n {
            let of = |list: &[f64]| list[c * n..(c + 1) * n].to_vec();
            self.twice[c][i * n..(i + 1) * n].copy_from_slice(&of(&row.twice));
            for (once, row) in self.once.iter_mut().zip(&row.once) {
                once[c][i * n..(i + 1) * n].copy_from_slice(&of(row));
            }
        }
    }
}

/// Sums of one joint that answers.
pub(super) struct JointSums {
    pub(super) n: usize,
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

/// Remainder of the sums of one joint that answers, of torque and reading, per joint on which they act.
type JointTails = [Vec<[f64; KINDS]>; 2];

impl JointSums {
    /// The sums of up to [`WIDE`] joints that answer.
    fn abreast(
        scene: &ClassScene<'_>,
        (linear, horizon): (&Linear, &SumHorizon),
        first: usize,
        moving: &MovingSums,
    ) -> Result<Vec<Self>, ClassRefusal> {
        let n = scene.n;
        // One more than twice: the first change after the last node is then among the rest.
        let samples = 2 * horizon.samples + 1;
        let rows = scene.rows.map(|rows| LostRows::new(n, rows, (scene.delay, horizon.samples)));
        let given = rows.is_some();
        let mut all = WideSums::new(moving, first, (scene.period, horizon.samples), rows);
        let tails = linear.walk_abreast(first, (samples, horizon), given, |shown| all.take(shown));
        if let Some(rows) = all.rows() {
            rows.end();
        }
        let joint = |c: usize| {
            let list = |which: usize| -> Vec<[f64; KINDS]> {
                let of = |tail: &AbreastTails| tail[which].map(|own| own[c]);
                tails.iter().map(of).collect()
            };
            let tails: JointTails = [list(0), list(1)];
            let mut own = all.joint(c, &tails[1]);
            own.tails(first + c, &tails, samples)?;
            Ok(own)
        };
        (0..WIDE.min(n - first)).map(joint).collect()
    }

    /// Adds what comes after the last sample. With `‖A^N‖ < ε` after the horizon of `N` samples, sums from `2N` on are
    /// at most `ε` times the bound on those from `N` on.
    fn tails(
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
                let left = self.whole[o][j].abs();
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
    fn finish(&mut self, slopes: &Slopes) {
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

/// The refutation of a posture.
fn unstable(inequality: &str) -> ClassRefusal {
    let (claim, inequality) = ("class of motions".to_owned(), inequality.to_owned());
    ClassRefusal::Unstable(Refutation { claim, inequality, left: 1.0, right: 1.0 })
}
