//! The least solution of (CM5): error and velocity bounds of the class from the sums at all postures.

use phihat_certificate::extremes::{Extremes as _, larger, smaller};

use super::effect::{ClassEffect, ClassInputs};
use super::extent::{Bent, ClassPaceLimits, Rates};
use super::imperfect::{LossSpan, cogging};
use super::scene::ClassScene;
use super::sums::{ACTING, E, KINDS, PostureSums, STEP, V};
use crate::square::product;

/// Iterations at most.
const ROUNDS: u32 = 2000;

/// Relative change at which the iteration has come to rest.
const STILL: f64 = 1e-10;

/// Errors beyond which the iteration is given up \[rad\].
const LOST: f64 = 2.0;

/// Factor on the solution, which is then checked once.
pub(super) const INFLATED: f64 = 1.01;

/// Bounds for a class.
#[derive(Debug, Clone)]
pub(super) struct Closed {
    /// Bounds of which (CM5) gives smaller ones.
    pub(super) bounds: ClosedBounds,
    /// Largest change of the commanded torque per sample \[N·m\].
    pub(super) step: Vec<f64>,
    /// Largest torque \[N·m\].
    pub(super) torque: Vec<f64>,
    /// Error under the same forces if inertia and Coriolis torque stayed those of the posture.
    pub(super) frozen: Vec<f64>,
    /// Spectral radius of `max Θ`.
    pub(super) radius: f64,
    /// Indices of the postures that set the error, and the torque step, of each joint.
    pub(super) at: Vec<usize>,
    pub(super) steepest: Vec<usize>,
}

/// The class at one pace, with its maxima.
pub(super) struct Problem<'a> {
    pub(super) scene: &'a ClassScene<'a>,
    pub(super) pace: &'a ClassPaceLimits,
    pub(super) rates: &'a Rates,
    pub(super) bent: &'a Bent,
    pub(super) over: Over,
    /// Effect of which less is tried, and the share of it.
    tried: Option<(ClassEffect, f64)>,
}

/// Maxima over box and payloads, entry by entry: the part of the matrices that no posture changes.
pub(super) struct Over {
    /// `|M − its first order|`, `|2M' − D − its value|`, `|M' − D − its value|` per age² /2 or age.
    mass: Vec<f64>,
    twice: Vec<f64>,
    once: Vec<f64>,
    /// `|M'' − D'|`.
    force: Vec<f64>,
    /// Rate of gravity's gradient, and the gradient of all else.
    gravity: Vec<f64>,
    gradient: Vec<f64>,
    /// `Σ_c |∂_j D_c| v_c`, for each `j`, and `Σ_c |∂_b ∂_c M| v_c`, for each `b`.
    pub(super) coriolis: Vec<Vec<f64>>,
    pub(super) masses: Vec<Vec<f64>>,
}

impl Over {
    fn of(bent: &Bent, pace: &ClassPaceLimits) -> Self {
        let n = bent.n;
        let sum = |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            let each = |k: usize| (0..n).map(|c| of(c, k)).sum();
            (0..n * n).map(each).collect()
        };
        let pairs = |which: usize| {
            sum(&|c, k| {
                let all = (0..n).map(|b| bent.second[which][c * n + b][k] * pace.v[b]);
                pace.v[c] * all.sum::<f64>()
            })
        };
        let along =
            |which: usize, b: usize| sum(&|c, k| bent.second[which][c * n + b][k] * pace.v[c]);
        let coriolis: Vec<Vec<f64>> = (0..n).map(|j| along(3, j)).collect();
        let row =
            |m: &[f64], i: usize, x: &[f64]| -> f64 { (0..n).map(|k| m[i * n + k] * x[k]).sum() };
        let gradient = |k: usize| {
            let (i, j) = (k / n, k % n);
            row(&bent.mass[j], i, &pace.a) + 0.5 * row(&coriolis[j], i, &pace.v)
        };
        let once = pairs(2);
        let push = sum(&|c, k| bent.less[c][k] * pace.a[c]);
        Self {
            mass: pairs(0),
            twice: pairs(1),
            force: push.iter().zip(&once).map(|(a, b)| a + b).collect(),
            once,
            gravity: sum(&|c, k| bent.gravity[c][k] * pace.v[c]),
            gradient: (0..n * n).map(gradient).collect(),
            masses: (0..n).map(|b| along(0, b)).collect(),
            coriolis,
        }
    }
}

/// `out += a x`.
fn add(out: &mut [f64], a: &[f64], x: &[f64]) {
    let n = x.len();
    for (out, row) in out.iter_mut().zip(a.chunks_exact(n)) {
        *out += row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
    }
}

fn plus(a: &mut [f64], b: &[f64]) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b;
    }
}

/// Matrices of one posture on errors and velocities, for each output.
struct Maps {
    on_error: [Vec<f64>; KINDS],
    on_velocity: [Vec<f64>; KINDS],
}

/// Bounds on error, velocity error, and the deviation of the torque that acts from a command that is lost.
#[derive(Debug, Clone)]
pub(super) struct ClosedBounds {
    pub(super) error: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    pub(super) deviation: Vec<f64>,
}

impl ClosedBounds {
    fn lists(&mut self) -> [&mut Vec<f64>; 3] {
        [&mut self.error, &mut self.velocity, &mut self.deviation]
    }
}

impl<'a> Problem<'a> {
    pub(super) fn new(
        scene: &'a ClassScene<'a>,
        (pace, rates): (&'a ClassPaceLimits, &'a Rates),
        bent: &'a Bent,
    ) -> Self {
        Self { scene, pace, rates, bent, over: Over::of(bent, pace), tried: None }
    }

    /// The same with less of an effect.
    pub(super) fn with(&self, effect: ClassEffect, share: f64) -> Self {
        let Self { scene, pace, rates, bent, .. } = *self;
        let over = Over::of(bent, pace);
        Self { scene, pace, rates, bent, over, tried: Some((effect, share)) }
    }

    /// Share of an effect that is counted.
    pub(super) fn share(&self, effect: ClassEffect) -> f64 {
        self.tried.filter(|(own, _)| *own == effect).map_or(1.0, |(_, share)| share)
    }

    /// Rows of lost commands, where they are counted.
    fn rows(&self) -> Option<LossSpan> {
        self.scene.rows.filter(|_| self.share(ClassEffect::Losses) > 0.0)
    }

    /// Matrices of a posture at this pace.
    fn maps(&self, sums: &PostureSums) -> Maps {
        let n = self.scene.n;
        let scaled = |lists: &[Vec<f64>]| -> Vec<f64> {
            let each = |k: usize| lists.iter().zip(&self.pace.v).map(|(m, v)| m[k] * v).sum();
            (0..n * n).map(each).collect()
        };
        let on_error = |o: usize| {
            let mut all = self.stiff(sums, o);
            if o == E {
                plus(&mut all, &scaled(&sums.twice));
                plus(&mut all, &product(&sums.bent[E], &self.over.mass, n));
                plus(&mut all, &product(&sums.turned, &self.over.twice, n));
                plus(&mut all, &product(&sums.torque[E], &self.over.force, n));
            }
            all
        };
        let on_velocity = |o: usize| {
            if o == E {
                return vec![0.0; n * n];
            }
            let mut all = scaled(&sums.once[o]);
            plus(&mut all, &product(&sums.bent[o], &self.over.mass, n));
            plus(&mut all, &product(&sums.aged[o], &self.over.once, n));
            all
        };
        Maps {
            on_error: core::array::from_fn(on_error),
            on_velocity: core::array::from_fn(on_velocity),
        }
    }

    /// Stiffness of gravity and of the motion: what an error of position does where nothing moves.
    fn stiff(&self, sums: &PostureSums, o: usize) -> Vec<f64> {
        let n = self.scene.n;
        let mut all = sums.gravity[o].clone();
        plus(&mut all, &product(&sums.aged[o], &self.over.gravity, n));
        plus(&mut all, &product(&sums.torque[o], &self.over.gradient, n));
        all
    }

    /// The maps of an arm whose matrices stay those of the posture.
    fn resting(&self, sums: &PostureSums) -> Maps {
        Maps {
            on_error: core::array::from_fn(|o| self.stiff(sums, o)),
            on_velocity: core::array::from_fn(|_| vec![0.0; self.scene.n * self.scene.n]),
        }
    }

    /// Change of what is fed forward over a sample.
    fn fed(&self, i: usize) -> f64 {
        self.scene.period * self.rates.fed[i]
    }

    /// Largest deviation of what is fed forward from what the motion is: it is held over the sample, and is older than
    /// that where it comes through a supervisor.
    pub(super) fn held(&self, i: usize) -> f64 {
        self.scene.late * self.fed(i)
    }

    /// Rate of the torque of gravity that the robot adds at each sample \[N·m/s\], which is that of the sample.
    pub(super) fn moved_gravity(&self, i: usize, velocity: &[f64]) -> f64 {
        let (n, bent) = (self.scene.n, self.bent);
        (0..n).map(|j| bent.added[i * n + j] * (self.pace.v[j] + velocity[j])).sum()
    }

    /// Joints whose inertia term is a force of any course, in place of one with a rate: where that costs less.
    pub(super) fn boxed(&self, sums: &PostureSums) -> Vec<bool> {
        let n = self.scene.n;
        let costs = |i: usize| {
            let (ramp, force) = (sums.ramp[E][i * n + i], sums.torque[E][i * n + i]);
            let rates = self.rates;
            ramp * rates.slow[i] + force * rates.size[i] < ramp * (rates.whole[i] + rates.jerk[i])
        };
        (0..n).map(costs).collect()
    }

    /// An output's bound in a frozen arm in which every command arrives.
    fn forced(&self, sums: &PostureSums, o: usize, inputs: &ClassInputs) -> Vec<f64> {
        let n = self.scene.n;
        let mut out = vec![0.0; n];
        add(&mut out, &sums.torque[o], &inputs.torque);
        add(&mut out, &sums.ramp[o], &inputs.ramp);
        add(&mut out, &sums.reading[o], &inputs.reading);
        add(&mut out, &sums.start[o], &inputs.reading);
        add(&mut out, &sums.lasting[o], &inputs.start);
        for (i, out) in out.iter_mut().enumerate() {
            for (j, [size, rate]) in inputs.wave.iter().enumerate() {
                let at = i * n + j;
                let (any, smooth) = (
                    sums.torque[o][at] * size,
                    sums.lasting[o][at] * size + sums.ramp[o][at] * rate,
                );
                *out += smaller(smooth, any);
            }
        }
        let impulse: Vec<f64> = inputs.start.iter().map(|b| self.scene.before * b).collect();
        add(&mut out, &sums.impulse[o], &impulse);
        add(&mut out, &sums.slope[o], &inputs.shift);
        if o == E {
            // The start's error, at the other end of the two integrations by parts.
            let over = |list: &[Vec<f64>]| {
                let mut all = vec![0.0; n];
                for (m, v) in list.iter().zip(&self.pace.v) {
                    let mut own = vec![0.0; n];
                    add(&mut own, m, &inputs.reading);
                    for (all, own) in all.iter_mut().zip(own) {
                        *all += v * own;
                    }
                }
                all
            };
            add(&mut out, &sums.start_moves[0], &over(&self.bent.mass));
            add(&mut out, &sums.start_moves[1], &over(&self.bent.less));
        }
        if o == V {
            let light: Vec<f64> = sums.inverse.iter().map(|x| x.abs()).collect();
            add(&mut out, &light, &inputs.shift);
        }
        out
    }

    /// An output's bound at one posture, from bounds on error and velocity.
    fn output(
        &self,
        (sums, maps): (&PostureSums, &Maps),
        o: usize,
        (inputs, at): (&ClassInputs, &ClosedBounds),
    ) -> Vec<f64> {
        let mut out = self.unlost((sums, maps), o, (inputs, at));
        add(&mut out, &sums.lost[o], &inputs.deviation);
        out
    }

    /// The same where every command arrives.
    fn unlost(
        &self,
        (sums, maps): (&PostureSums, &Maps),
        o: usize,
        (inputs, at): (&ClassInputs, &ClosedBounds),
    ) -> Vec<f64> {
        let mut out = self.forced(sums, o, inputs);
        add(&mut out, &maps.on_error[o], &at.error);
        add(&mut out, &maps.on_velocity[o], &at.velocity);
        out
    }

    /// Largest deviation of the torque that acts from a command that is lost, by (CM9): the changes over up to a row
    /// before which rows have gone, and the answer to what the row has lost before.
    fn deviation(
        &self,
        rows: LossSpan,
        (all, maps): (&[PostureSums], &[Maps]),
        (inputs, at): (&ClassInputs, &ClosedBounds),
    ) -> Vec<f64> {
        let n = self.scene.n;
        // At each posture: the change over one sample, and the part of it that errors of readings make.
        let single = |pair: (&PostureSums, &Maps)| {
            let mut change = self.unlost(pair, STEP, (inputs, at));
            add(&mut change, &pair.0.rows.earlier, &inputs.deviation);
            change.iter_mut().enumerate().for_each(|(i, change)| *change += self.fed(i));
            let mut read = vec![0.0; n];
            add(&mut read, &pair.0.reading[STEP], &inputs.reading);
            [change, read]
        };
        let changes: Vec<[Vec<f64>; 2]> = all.iter().zip(maps).map(single).collect();
        let mut row: Vec<Vec<f64>> = Vec::with_capacity(rows.most);
        for l in 1..=rows.most {
            let times = l as f64;
            let mut most = vec![0.0_f64; n];
            for (sums, [change, read]) in all.iter().zip(&changes) {
                let mut over = vec![0.0; n];
                match l.checked_sub(2).and_then(|k| sums.rows.spans.get(k)) {
                    Some(span) => add(&mut over, span, &inputs.reading),
                    None => over.clone_from(read),
                }
                let mut grown = vec![0.0; n];
                for (before, level) in row.iter().rev().zip(&sums.rows.levels) {
                    add(&mut grown, level, before);
                }
                for (i, most) in most.iter_mut().enumerate() {
                    let over = smaller(over[i], times * read[i]);
                    *most = larger(*most, times * (change[i] - read[i]) + over + grown[i]);
                }
            }
            row.push(most);
        }
        let largest = |i: usize| row.iter().map(|own| own[i]).largest();
        (0..n).map(largest).collect()
    }

    /// The spectral radius of the largest matrices, posture by posture.
    fn radius(matrices: &[&Vec<f64>], n: usize) -> f64 {
        let mut x = vec![1.0; n];
        let mut radius = 0.0;
        for _ in 0..100 {
            let mut next = vec![0.0_f64; n];
            for matrix in matrices {
                let mut own = vec![0.0; n];
                add(&mut own, matrix, &x);
                for (next, own) in next.iter_mut().zip(own) {
                    *next = larger(*next, own);
                }
            }
            radius = next.iter().copied().largest();
            if radius <= 0.0 {
                return 0.0;
            }
            x = next.iter().map(|value| value / radius).collect();
        }
        radius
    }

    /// The least solution of (CM5) over some postures, by iteration from 0; `None`: there is none.
    /// With a factor above 1 on every step of it, a solution that keeps (CM5) strictly.
    fn least(
        &self,
        (all, maps): (&[PostureSums], &[Maps]),
        boxed: &[bool],
        factor: f64,
    ) -> Option<ClosedBounds> {
        let n = self.scene.n;
        let moved = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.max(f64::MIN_POSITIVE)).largest()
        };
        let mut own =
            ClosedBounds { error: vec![0.0; n], velocity: vec![0.0; n], deviation: vec![0.0; n] };
        for _ in 0..ROUNDS {
            let mut next = self.next((all, maps), boxed, &own).0;
            for x in next.lists().into_iter().flatten() {
                *x *= factor;
            }
            let change =
                larger(moved(&own.error, &next.error), moved(&own.velocity, &next.velocity));
            let change = larger(change, moved(&own.deviation, &next.deviation));
            own = next;
            let lost = own.error.iter().copied().largest();
            if lost.is_nan() || lost > LOST {
                return None;
            }
            if change < STILL {
                return Some(own);
            }
        }
        None
    }

    /// Bounds from bounds, and the index of the posture that sets the error of each joint. Where no command is lost,
    /// no torque deviates from a command.
    fn next(
        &self,
        summed: (&[PostureSums], &[Maps]),
        boxed: &[bool],
        at: &ClosedBounds,
    ) -> (ClosedBounds, Vec<usize>) {
        let inputs = self.inputs(boxed, at);
        let of = |o: usize| self.most(summed, o, (&inputs, at));
        let (error, places): (Vec<f64>, Vec<usize>) = of(E).into_iter().unzip();
        let velocity = of(V).into_iter().map(|(x, _)| x).collect();
        let deviation = match self.rows() {
            Some(rows) => self.deviation(rows, summed, (&inputs, at)),
            None => vec![0.0; self.scene.n],
        };
        (ClosedBounds { error, velocity, deviation }, places)
    }

    /// Largest change of the command from one sample to the next.
    fn steps(
        &self,
        summed: (&[PostureSums], &[Maps]),
        at: (&ClassInputs, &ClosedBounds),
    ) -> (Vec<f64>, Vec<usize>) {
        let steps = self.most(summed, STEP, at).into_iter().enumerate();
        steps.map(|(i, (x, place))| (x + self.fed(i), place)).unzip()
    }

    /// The largest value of an output over postures, joint by joint, and the posture's index.
    fn most(
        &self,
        (all, maps): (&[PostureSums], &[Maps]),
        o: usize,
        at: (&ClassInputs, &ClosedBounds),
    ) -> Vec<(f64, usize)> {
        let mut most = vec![(0.0_f64, 0_usize); self.scene.n];
        for (place, pair) in all.iter().zip(maps).enumerate() {
            let out = self.output(pair, o, at);
            for (most, out) in most.iter_mut().zip(out) {
                if out.is_nan() || out > most.0 {
                    *most = (out, place);
                }
            }
        }
        most
    }

    /// Solves (CM5) over some postures; the spectral radius of `max Θ` where there is no solution.
    pub(super) fn solve(&self, all: &[PostureSums]) -> Result<Closed, f64> {
        let n = self.scene.n;
        let maps: Vec<Maps> = all.iter().map(|sums| self.maps(sums)).collect();
        let radius = Self::radius(&maps.iter().map(|own| &own.on_error[E]).collect::<Vec<_>>(), n);
        let Some(first) = all.first() else { return Err(radius) };
        let boxed = self.boxed(first);
        let resting: Vec<Maps> = all.iter().map(|sums| self.resting(sums)).collect();
        let frozen = self.least((all, &resting), &boxed, 1.0).ok_or(radius)?.error;
        let summed = (all, &maps[..]);
        let mut own = self.least(summed, &boxed, 1.0).ok_or(radius)?;
        own.lists().into_iter().flatten().for_each(|x| *x *= INFLATED);
        let below = |own: &[f64], most: &[f64]| own.iter().zip(most).all(|(own, most)| own < most);
        let strict = |own: &ClosedBounds| {
            let (next, places) = self.next(summed, &boxed, own);
            let holds = below(&next.error, &own.error)
                && below(&next.velocity, &own.velocity)
                && (self.rows().is_none() || below(&next.deviation, &own.deviation));
            holds.then_some(places)
        };
        let mut places = strict(&own);
        if places.is_none() {
            // Where what is of second order in them is most of a bound, another 1 % of it is more than 1 %.
            own = self.least(summed, &boxed, INFLATED).ok_or(radius)?;
            places = strict(&own);
        }
        let inputs = self.inputs(&boxed, &own);
        let (step, steepest) = self.steps(summed, (&inputs, &own));
        Ok(Closed {
            step,
            torque: self.torques(summed, (&inputs, &own)),
            at: places.ok_or(radius)?,
            steepest,
            bounds: own,
            frozen,
            radius,
        })
    }

    /// Part of error and torque step of each joint that one effect makes, at the postures that set them.
    pub(super) fn effect(
        &self,
        effect: ClassEffect,
        all: &[PostureSums],
        (closed, boxed): (&Closed, &[bool]),
    ) -> [Vec<f64>; 2] {
        let at = &closed.bounds;
        let inputs = self.inputs_of(effect, boxed, at);
        let part = |o: usize, (i, place): (usize, &usize)| {
            let Some(sums) = all.get(*place) else { return 0.0 };
            let mut out = self.forced(sums, o, &inputs);
            add(&mut out, &sums.lost[o], &inputs.deviation);
            if effect == ClassEffect::Moving {
                let maps = self.maps(sums);
                add(&mut out, &maps.on_error[o], &at.error);
                add(&mut out, &maps.on_velocity[o], &at.velocity);
            }
            let fed = if effect == ClassEffect::Motion && o == STEP { self.fed(i) } else { 0.0 };
            out[i] + fed
        };
        let list = |o: usize, places: &[usize]| -> Vec<f64> {
            places.iter().enumerate().map(|place| part(o, place)).collect()
        };
        [list(E, &closed.at), list(STEP, &closed.steepest)]
    }

    /// The largest torque of each joint: of the motion with its smooth friction, and the answer of the torque that acts
    /// to all else. Cogging and the start's imbalance, whose answers are bounded beside what they ask for, count
    /// twice; a torque that acts in place of a lost command deviates from it.
    fn torques(
        &self,
        summed: (&[PostureSums], &[Maps]),
        at: (&ClassInputs, &ClosedBounds),
    ) -> Vec<f64> {
        let scene = self.scene;
        let mut most: Vec<f64> =
            self.most(summed, ACTING, at).into_iter().map(|(x, _)| x).collect();
        for (i, most) in most.iter_mut().enumerate() {
            let motion = self.rates.torque[i] + scene.slope[i] * self.pace.v[i];
            let cogging = cogging(&scene.signals, i, 0.0)[0];
            *most += motion + 2.0 * self.held(i) + cogging + scene.start[i] + at.0.deviation[i];
            // Where the part in the acceleration is a force, the law's answer to it stands in its place.
            *most += self.rates.size[i];
        }
        most
    }

    /// Error of each joint at one more posture, as a share of a solution.
    pub(super) fn compared(
        &self,
        closed: &Closed,
        first: &PostureSums,
        sums: &PostureSums,
    ) -> Vec<f64> {
        let maps = self.maps(sums);
        let inputs = self.inputs(&self.boxed(first), &closed.bounds);
        let own = self.output((sums, &maps), E, (&inputs, &closed.bounds));
        own.iter().zip(&closed.bounds.error).map(|(own, e)| own / e).collect()
    }
}
