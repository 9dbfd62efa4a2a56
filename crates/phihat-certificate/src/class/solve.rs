//! The least solution of (CM5) over the postures that were played: error, velocity error, torque step, torque.

use super::bends::ClassBends;
use super::maxima::Maxima;
use super::setting::{CLAIM, ClassSetting, SAME};
use super::sums::{
    ACTS, AGED, BEGUN, E, EDGE, IMPULSE, JUMP_BENT, KINDS, LASTING, LOST, LOST_BEFORE, PlayedSums,
    RAMP, READING, SLOPE, SLOPE_AGED, SLOPE_BENT, STEP, SquareBlock, TORQUE, V,
};
use crate::Refutation;
use crate::extremes::{Extremes as _, larger, smaller};
use crate::refutation::refuse;

/// Iterations of the fixed point.
const ROUNDS: usize = 2000;

/// Factor on every step of the iteration, so that its end satisfies (CM5) strictly.
const STRICT: f64 = 1.001;

/// Error beyond which the iteration is given up \[rad\].
const GIVEN_UP: f64 = 2.0;

/// The sums at a posture with its matrices.
pub(super) struct PlayedPosture {
    pub(super) sums: PlayedSums,
    /// `|M^{-1}|`.
    pub(super) inverse: SquareBlock,
}

/// Bounds per joint.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    pub(super) error: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    pub(super) step: Vec<f64>,
    pub(super) torque: Vec<f64>,
}

/// All that bounds depend on.
pub(super) struct BoundProblem<'a> {
    pub(super) setting: &'a ClassSetting<'a>,
    pub(super) maxima: &'a Maxima,
    pub(super) bends: &'a ClassBends,
    /// Torque by which the start may be out of balance \[N·m\], and for how long before the law acts \[s\].
    pub(super) start: (Vec<f64>, f64),
}

/// Matrices of one posture on errors and on velocity errors, and its answer to what depends on neither.
struct PostureMaps {
    error: [SquareBlock; KINDS],
    velocity: [SquareBlock; KINDS],
    fixed: [Vec<f64>; KINDS],
}

/// Bounds on error, velocity error, and the deviation of the torque that acts from a command that is lost.
#[derive(Clone, Copy)]
struct AtBounds<'a> {
    error: &'a [f64],
    velocity: &'a [f64],
    deviation: &'a [f64],
}

/// Inputs of a joint that depend on them: force of any course, cogging and its rate, `|N_e| V`, error of a reading,
/// deviation from a command that is lost.
struct BoundInputs {
    torque: f64,
    cogging: (f64, f64),
    shift: f64,
    reading: f64,
    deviation: f64,
}

/// `row i of m · x`.
fn along(m: &[f64], i: usize, x: &[f64]) -> f64 {
    let n = x.len();
    m[i * n..(i + 1) * n].iter().zip(x).map(|(m, x)| m * x).sum()
}

/// `out += a b`.
fn add_product(out: &mut [f64], (a, b): (&[f64], &[f64]), n: usize) {
    for (out, row) in out.chunks_exact_mut(n).zip(a.chunks_exact(n)) {
        for (factor, line) in row.iter().zip(b.chunks_exact(n)) {
            out.iter_mut().zip(line).for_each(|(out, entry)| *out += factor * entry);
        }
    }
}

/// `Σ_c y_c (list_c x)_i`.
fn bilinear(list: &[SquareBlock], i: usize, (y, x): (&[f64], &[f64])) -> f64 {
    list.iter().zip(y).map(|(m, y)| y * along(m, i, x)).sum()
}

impl BoundProblem<'_> {
    /// Bounds on error, velocity error, torque step and torque over some postures.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: (CM5) has no solution.
    pub(super) fn solve(&self, all: &[PlayedPosture]) -> Result<Solution, Refutation> {
        let n = self.setting.n;
        let maps: Vec<PostureMaps> = all.iter().map(|own| self.maps(own)).collect();
        let open = || refuse(CLAIM, "the class closes at postures derived again", GIVEN_UP, 1.0);
        let mut own = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        let mut still = false;
        for _ in 0..ROUNDS {
            let next = self
                .next((all, &maps), &own)
                .map(|list| list.into_iter().map(|x| STRICT * x).collect::<Vec<f64>>());
            let moved = |a: &[f64], b: &[f64]| {
                a.iter()
                    .zip(b)
                    .map(|(a, b)| (a - b).abs() / larger(*a, f64::MIN_POSITIVE))
                    .largest()
            };
            // Without lost commands nothing deviates from one.
            let depends = if self.setting.rows.is_some() { 3 } else { 2 };
            let pairs = next.iter().zip(&own).take(depends);
            let change = pairs.map(|(a, b)| moved(a, b)).largest();
            own = next;
            let lost = own[0].iter().copied().largest();
            if lost.is_nan() || lost > GIVEN_UP {
                return Err(open());
            }
            if change < SAME {
                still = true;
                break;
            }
        }
        let below = |own: &[f64], most: &[f64]| own.iter().zip(most).all(|(own, most)| own < most);
        let last = self.next((all, &maps), &own);
        let needed = if self.setting.rows.is_some() { 3 } else { 2 };
        if !still || !last.iter().zip(&own).take(needed).all(|(next, own)| below(next, own)) {
            return Err(open());
        }
        let (inputs, played) = (self.all_inputs(bounds(&own)), (all, &maps[..]));
        let step = self.steps(played, (&inputs, bounds(&own)));
        let torque = self.torques(played, (&inputs, bounds(&own)));
        let [error, velocity, _] = own;
        Ok(Solution { error, velocity, step, torque })
    }

    /// Bounds on error, velocity error and deviation of what is lost from such bounds.
    fn next(
        &self,
        played: (&[PlayedPosture], &[PostureMaps]),
        own: &[Vec<f64>; 3],
    ) -> [Vec<f64>; 3] {
        let at = bounds(own);
        let inputs = self.all_inputs(at);
        let [error, velocity] = [E, V].map(|o| self.most(played, o, (&inputs, at)));
        let deviation = match self.setting.rows {
            Some(rows) => self.deviation(rows.most, played, (&inputs, at)),
            None => vec![0.0; self.setting.n],
        };
        [error, velocity, deviation]
    }

    /// Largest change of the command from one sample to the next.
    fn steps(
        &self,
        played: (&[PlayedPosture], &[PostureMaps]),
        at: (&[BoundInputs], AtBounds<'_>),
    ) -> Vec<f64> {
        let steps = self.most(played, STEP, at).into_iter().zip(&self.maxima.fed);
        steps.map(|(step, rate)| step + self.setting.period * rate).collect()
    }

    /// Largest deviation of the torque that acts from a command of a row that is lost, by (CM9).
    fn deviation(
        &self,
        most_lost: usize,
        (all, maps): (&[PlayedPosture], &[PostureMaps]),
        (inputs, at): (&[BoundInputs], AtBounds<'_>),
    ) -> Vec<f64> {
        let n = self.setting.n;
        let readings: Vec<f64> = inputs.iter().map(|input| input.reading).collect();
        let single = |pair| self.output(pair, STEP, (inputs, at), LOST_BEFORE);
        let singles: Vec<Vec<f64>> = all.iter().zip(maps).map(single).collect();
        let mut lost: Vec<Vec<f64>> = Vec::new();
        for l in 1..=most_lost {
            let mut largest = vec![0.0; n];
            for (PlayedPosture { sums, .. }, single) in all.iter().zip(&singles) {
                let sizes = &sums.sizes[STEP];
                for i in 0..n {
                    let read = along(&sizes[READING], i, &readings);
                    // The command now against the one of l samples ago: of misreadings as one answer, of the rest
                    // change by change.
                    let rest = single[i] + self.setting.period * self.maxima.fed[i] - read;
                    let over = match l.checked_sub(2).and_then(|k| sums.commands[1].get(k)) {
                        Some(over) => along(over, i, &readings),
                        None => read,
                    };
                    let mut own = l as f64 * rest + smaller(over, l as f64 * read);
                    for (k, level) in sums.commands[0].iter().enumerate().take(l - 1) {
                        own += along(level, i, &lost[l - 2 - k]);
                    }
                    largest[i] = larger(largest[i], own);
                }
            }
            lost.push(largest);
        }
        let most = |i: usize| lost.iter().map(|own| own[i]).largest();
        (0..n).map(most).collect()
    }

    /// Matrices and fixed answers of a posture.
    fn maps(&self, own: &PlayedPosture) -> PostureMaps {
        let (n, bends, sums) = (self.setting.n, self.bends, &own.sums);
        let speed = &self.setting.class.speed;
        let each = || -> [SquareBlock; KINDS] { core::array::from_fn(|_| vec![0.0; n * n]) };
        let (mut error, mut velocity) = (each(), each());
        for o in 0..KINDS {
            let sizes = &sums.sizes[o];
            let stiff = &mut error[o];
            stiff.copy_from_slice(&sums.gravity[o]);
            add_product(stiff, (&sizes[AGED], &bends.gravity_rate), n);
            add_product(stiff, (&sizes[TORQUE], &bends.gradient), n);
            let moves = if o == E { &mut error[o] } else { &mut velocity[o] };
            for (moving, speed) in sums.moving[o].iter().zip(speed) {
                moves.iter_mut().zip(moving).for_each(|(moves, own)| *moves += speed * own);
            }
            if o == E {
                add_product(moves, (&sizes[JUMP_BENT], &bends.mass), n);
                add_product(moves, (&sizes[SLOPE_AGED], &bends.twice), n);
                add_product(moves, (&sizes[TORQUE], &bends.force), n);
            } else {
                add_product(moves, (&sizes[SLOPE_BENT], &bends.mass), n);
                add_product(moves, (&sizes[AGED], &bends.once), n);
            }
        }
        let fixed = core::array::from_fn(|o| (0..n).map(|i| self.fixed(own, o, i)).collect());
        PostureMaps { error, velocity, fixed }
    }

    /// Answer of a joint to all that depends on no error: forces, rates, readings, start.
    fn fixed(&self, own: &PlayedPosture, o: usize, i: usize) -> f64 {
        let (setting, maxima, n) = (self.setting, self.maxima, self.setting.n);
        let sizes = &own.sums.sizes[o];
        let (start, before) = (&self.start.0, self.start.1);
        let mut sum = 0.0;
        for j in 0..n {
            let at = i * n + j;
            let (torque, ramp) = (sizes[TORQUE][at], sizes[RAMP][at]);
            // The part in the acceleration is a force of any course, or has a rate: each answers each joint by itself.
            let boxed = ramp * maxima.slow[j] + torque * maxima.size[j];
            let smooth = ramp * (maxima.whole[j] + maxima.jerk[j]);
            sum += if boxed < smooth { boxed } else { smooth };
            sum += ramp * setting.slope[j] * setting.class.acceleration[j];
            sum += torque * (setting.dry[j] + self.held(j) + self.added(j, &setting.class.speed));
            let start = start.get(j).copied().unwrap_or(0.0);
            sum += (sizes[LASTING][at] + before * sizes[IMPULSE][at]) * start;
        }
        sum
    }

    /// Deviation of what is fed forward, which is held over a sample and older than that through a supervisor.
    fn held(&self, j: usize) -> f64 {
        self.setting.late * self.setting.period * self.maxima.fed[j]
    }

    /// Change over a sample of the gravity that the robot adds, at these velocities.
    fn added(&self, j: usize, velocity: &[f64]) -> f64 {
        self.setting.period * along(&self.bends.added, j, velocity)
    }

    /// Inputs of a joint that depend on bounds: forces that errors are of second order in, stiction, `|N_e| V`,
    /// readings.
    fn inputs(
        &self,
        j: usize,
        AtBounds { error, velocity, deviation }: AtBounds<'_>,
    ) -> BoundInputs {
        let (bends, setting) = (self.bends, self.setting);
        let signals = &setting.signals;
        let speed = setting.class.speed[j] + velocity[j];
        let slides = signals.stiction_nm_s_rad[j] * speed - signals.stiction_nm[j];
        let torque = setting.slope[j] * velocity[j]
            + larger(0.0, slides)
            + self.added(j, velocity)
            + 0.5 * bilinear(&bends.gravity, j, (error, error))
            + bilinear(&bends.turned, j, (error, velocity))
            + 0.5 * bilinear(&bends.coriolis, j, (velocity, velocity))
            + bilinear(&bends.masses, j, (velocity, velocity))
            + bilinear(&bends.bent, j, (error, velocity));
        let of = |list: &[f64]| list.get(j).copied().unwrap_or(0.0);
        // d/dt sin(n q) = n q̇ cos(n q).
        let cogging = of(&signals.cogging_nm);
        let early = if signals.stamped { velocity[j] } else { speed };
        BoundInputs {
            torque,
            cogging: (cogging, cogging * of(&signals.cogging_per_turn) * speed),
            shift: bilinear(&bends.masses, j, (error, velocity)),
            reading: setting.reading[j] + signals.jitter_s * early,
            deviation: deviation[j],
        }
    }

    fn all_inputs(&self, at: AtBounds<'_>) -> Vec<BoundInputs> {
        (0..self.setting.n).map(|j| self.inputs(j, at)).collect()
    }

    /// An output at one posture, joint by joint, with all rows of losses or with those before one that begins now.
    fn output(
        &self,
        (own, maps): (&PlayedPosture, &PostureMaps),
        o: usize,
        (inputs, at): (&[BoundInputs], AtBounds<'_>),
        lost: usize,
    ) -> Vec<f64> {
        let n = self.setting.n;
        let sizes = &own.sums.sizes[o];
        let readings: Vec<f64> = inputs.iter().map(|input| input.reading).collect();
        let joint = |i: usize| {
            let mut sum = maps.fixed[o][i] + along(&maps.error[o], i, at.error);
            sum += along(&maps.velocity[o], i, at.velocity);
            for (j, input) in inputs.iter().enumerate() {
                let at = i * n + j;
                sum += sizes[TORQUE][at] * input.torque + sizes[SLOPE][at] * input.shift;
                sum += (sizes[READING][at] + sizes[BEGUN][at]) * input.reading;
                sum += sizes[lost][at] * input.deviation;
                let (size, rate) = input.cogging;
                let any = sizes[TORQUE][at] * size;
                let smooth = sizes[LASTING][at] * size + sizes[RAMP][at] * rate;
                sum += smaller(smooth, any);
                if o == E {
                    let moved = along(&self.bends.moved, j, &readings);
                    let begun = along(&self.bends.started, j, &readings);
                    sum += sizes[EDGE][at] * moved + sizes[IMPULSE][at] * begun;
                }
                if o == V {
                    sum += own.inverse[at] * input.shift;
                }
            }
            sum
        };
        (0..n).map(joint).collect()
    }

    /// The largest value of an output over the postures, joint by joint, from bounds on error and velocity error.
    fn most(
        &self,
        (all, maps): (&[PlayedPosture], &[PostureMaps]),
        o: usize,
        at: (&[BoundInputs], AtBounds<'_>),
    ) -> Vec<f64> {
        let mut most = vec![0.0; self.setting.n];
        for pair in all.iter().zip(maps) {
            let own = self.output(pair, o, at, LOST);
            most.iter_mut().zip(own).for_each(|(most, own)| *most = larger(*most, own));
        }
        most
    }

    /// The largest torque: of the motion and of smooth friction along it, and what the law adds to that.
    fn torques(
        &self,
        played: (&[PlayedPosture], &[PostureMaps]),
        at: (&[BoundInputs], AtBounds<'_>),
    ) -> Vec<f64> {
        let (setting, maxima) = (self.setting, self.maxima);
        let mut most = self.most(played, ACTS, at);
        for (i, most) in most.iter_mut().enumerate() {
            let start = self.start.0.get(i).copied().unwrap_or(0.0);
            // Where the part in the acceleration is a force, the law's answer to it stands in its place.
            *most += maxima.torque[i]
                + setting.slope[i] * setting.class.speed[i]
                + maxima.size[i]
                + self.held(i)
                + setting.signals.cogging_nm.get(i).copied().unwrap_or(0.0)
                + start;
        }
        most
    }
}

/// The bounds by name.
fn bounds([error, velocity, deviation]: &[Vec<f64>; 3]) -> AtBounds<'_> {
    AtBounds { error, velocity, deviation }
}
