//! Sums over the impulse responses of the loop frozen at one posture.

use phihat_certificate::Refutation;

use super::answers::WideSums;
use super::joint_sums::JointTails;
pub(super) use super::joint_sums::{ACTING, AnswerMatrices, E, JointSums, KINDS, RowSums, STEP, V};
use super::moving_sums::MovingSums;
use super::refusal::ClassRefusal;
use super::rows::LossSums;
use super::scene::ClassScene;
use super::slopes::Slopes;
use crate::coupled::abreast::AbreastTails;
use crate::coupled::linear::{Linear, SumHorizon};
use crate::lanes::WIDE;

/// The sums at one posture with one payload. Columns: the joint on which a torque acts, or whose reading errs.
#[derive(Debug, Clone)]
pub(super) struct PostureSums {
    /// Where, in words, and the index of the payload.
    pub(super) q: Vec<f64>,
    pub(super) case: usize,
    pub(super) inverse: Vec<f64>,
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
            for (c, row) in
                abreast(scene, (&linear, &horizon), first, &moving)?.into_iter().enumerate()
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

/// The sums of up to [`WIDE`] joints that answer.
fn abreast(
    scene: &ClassScene<'_>,
    (linear, horizon): (&Linear, &SumHorizon),
    first: usize,
    moving: &MovingSums,
) -> Result<Vec<JointSums>, ClassRefusal> {
    let n = scene.n;
    // One more than twice: the first change after the last node is then among the rest.
    let samples = 2 * horizon.samples + 1;
    let rows = scene.rows.map(|rows| LossSums::new(n, rows, (scene.delay, horizon.samples)));
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

/// The refutation of a posture.
fn unstable(inequality: &str) -> ClassRefusal {
    let (claim, inequality) = ("class of motions".to_owned(), inequality.to_owned());
    ClassRefusal::Unstable(Refutation { claim, inequality, left: 1.0, right: 1.0 })
}
