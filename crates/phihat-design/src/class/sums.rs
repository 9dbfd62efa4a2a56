//! Sums over the impulse responses of the loop frozen at one posture.

use phihat_certificate::Refutation;
use phihat_certificate::extremes::larger;

use super::imperfect::LossSpan;
use super::refusal::ClassRefusal;
use super::scene::ClassScene;
use super::slopes::Slopes;
use crate::coupled::linear::{LEFT, Linear, Lines, OUTPUTS, SumHorizon};

/// Outputs: `e`, `ė`, change of the commanded torque per sample, `ë` without the force itself.
pub(super) const E: usize = 0;
pub(super) const V: usize = 1;
pub(super) const STEP: usize = 2;
pub(super) const FREE: usize = 3;
pub(super) const KINDS: usize = 4;

/// Place of each output in [`Lines`].
const PLACE: [usize; KINDS] = [0, 1, 3, 2];

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

/// The posture's matrices side by side: row `l` of `[c][j]`.
struct MovingSums {
    /// `∂_c M`, `2 ∂_c M − D_c`, `∂_c M − D_c`.
    blocks: [Vec<f64>; 3],
    gravity: Vec<f64>,
    mass: Vec<f64>,
    inverse: Vec<f64>,
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
        Self { blocks, gravity: slopes.gravity.clone(), mass: slopes.mass.clone(), inverse }
    }
}

/// `out += weight · |row · block|`.
fn add_product(out: &mut [f64], scratch: &mut [f64], weight: f64, (row, block): (&[f64], &[f64])) {
    scratch.fill(0.0);
    for (value, line) in row.iter().zip(block.chunks_exact(scratch.len())) {
        for (sum, entry) in scratch.iter_mut().zip(line) {
            *sum += value * entry;
        }
    }
    for (out, sum) in out.iter_mut().zip(scratch.iter()) {
        *out += weight * sum.abs();
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
        for i in 0..n {
            let rows = scene.rows.map(|rows| (rows, scene.delay));
            let row = JointSums::of((&linear, &horizon), (i, scene.period), rows, &moving)?;
            own.push(i, row, &slopes);
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

/// Sizes of the answers since the start, sample by sample, joint by joint.
#[derive(Default)]
struct AnswerSizes {
    /// After an error of one reading; the first at its own sample.
    readings: Vec<[f64; KINDS]>,
    /// After a start of the arm off by an angle, over each interval.
    arms: Vec<[f64; KINDS]>,
    /// After a start of the law with a reading off by an angle, from the sample after it.
    laws: Vec<[f64; KINDS]>,
}

impl AnswerSizes {
    /// `max_k (|s_k| − Σ_{m>k+1} |n_m|)`: of readings that have not come yet nothing is to be seen at sample `k + 1`.
    ///
    /// What comes after the last sample is counted as [`LEFT`] of the largest answer. Times between samples see two
    /// neighbours: each answer is the largest of three.
    fn beyond_readings(&self, n: usize) -> AnswerMatrices {
        let samples = (self.arms.len() / n).min(self.laws.len() / n);
        let near = |list: &[[f64; KINDS]], k: usize, j: usize, o: usize| {
            let around = k.saturating_sub(1)..(k + 2).min(samples);
            around.map(|k| list[k * n + j][o]).fold(0.0, larger)
        };
        let beyond = |o: usize, j: usize| -> f64 {
            let of_joint = || self.readings.iter().skip(j).step_by(n).map(|sizes| sizes[o]);
            let mut left: f64 = of_joint().sum();
            let mut seen = of_joint();
            left -= seen.next().unwrap_or(0.0);
            let (mut most, mut largest) = (0.0, 0.0);
            for (k, reading) in (0..samples).zip(seen) {
                left -= reading;
                let own = near(&self.arms, k, j, o) + near(&self.laws, k, j, o);
                most = larger(most, own - larger(left, 0.0));
                largest = larger(largest, own);
            }
            larger(most, LEFT * largest)
        };
        core::array::from_fn(|o| (0..n).map(|j| beyond(o, j)).collect())
    }
}

/// Sums of one joint that answers.
struct JointSums {
    n: usize,
    period: f64,
    /// Samples after which products are bounded by products of sizes.
    long: usize,
    /// Node of the kernels, from 0.
    node: usize,
    last: AnswerMatrices,
    /// `g'` of the interval before, and its `ë`.
    last_slope: Vec<f64>,
    /// Step responses.
    whole: AnswerMatrices,
    torque: AnswerMatrices,
    ramp: AnswerMatrices,
    reading: AnswerMatrices,
    lasting: AnswerMatrices,
    impulse: AnswerMatrices,
    start: AnswerMatrices,
    lost: AnswerMatrices,
    rows: RowSums,
    begun: AnswerSizes,
    start_moves: [Vec<f64>; 2],
    slope: AnswerMatrices,
    aged: AnswerMatrices,
    bent: AnswerMatrices,
    turned: Vec<f64>,
    gravity: AnswerMatrices,
    twice: Vec<f64>,
    once: [Vec<f64>; KINDS],
    /// Sizes for what is left to bound by sizes: of `e` `Σ age|δ|`, of others `Σ age T|g'|`; `T Σ|g'|`; `∫|g|`.
    late_age: AnswerMatrices,
    late_slope: AnswerMatrices,
    late_torque: AnswerMatrices,
    /// `Σ (2 age + T) T|α|` and `T Σ|α|`, `α` the `ë` of `g'`: what lies between samples.
    chords: [Vec<f64>; 2],
    scratch: Vec<f64>,
}

impl JointSums {
    fn of(
        (linear, horizon): (&Linear, &SumHorizon),
        (i, period): (usize, f64),
        rows: Option<(LossSpan, usize)>,
        moving: &MovingSums,
    ) -> Result<Self, ClassRefusal> {
        let n = moving.mass.len().isqrt();
        let mut own = Self::empty(n, period, horizon.samples);
        // One more than twice: the first change after the last node is then among the rest.
        let samples = 2 * horizon.samples + 1;
        let mut block: Vec<Lines> = vec![[0.0; 16]; n];
        let mut first = true;
        let mut misread: Vec<f64> = Vec::new();
        let tails = linear.walk(i, (samples, horizon), |j, lines| {
            block[j] = *lines;
            if rows.is_some() {
                misread.push(lines[2 * OUTPUTS + PLACE[STEP]]);
            }
            if j + 1 == n {
                own.read(&block);
                if !core::mem::take(&mut first) {
                    own.take(i, &block, moving);
                }
            }
        });
        linear.start(i, samples, |_, outputs| {
            own.begun.laws.push(PLACE.map(|place| outputs[place].abs()));
        });
        own.start = own.begun.beyond_readings(n);
        if let Some(rows) = rows {
            (own.lost, own.rows) = lost((linear, horizon.samples), i, rows);
            let later: Vec<f64> = tails.iter().map(|tail| tail[1][PLACE[STEP]]).collect();
            own.rows.spans = (2..=rows.0.most).map(|l| changes_over(l, &misread, &later)).collect();
        }
        own.tails(i, &tails, samples)?;
        Ok(own)
    }

    fn empty(n: usize, period: f64, long: usize) -> Self {
        let each = || -> AnswerMatrices { core::array::from_fn(|_| vec![0.0; n]) };
        Self {
            n,
            period,
            long,
            node: 0,
            last: each(),
            last_slope: vec![0.0; n],
            whole: each(),
            torque: each(),
            ramp: each(),
            reading: each(),
            lasting: each(),
            impulse: each(),
            start: each(),
            lost: each(),
            rows: RowSums::default(),
            begun: AnswerSizes::default(),
            start_moves: [vec![0.0; n], vec![0.0; n]],
            slope: each(),
            aged: each(),
            bent: each(),
            turned: vec![0.0; n],
            gravity: each(),
            twice: vec![0.0; n * n],
            once: core::array::from_fn(|_| vec![0.0; n * n]),
            late_age: each(),
            late_slope: each(),
            late_torque: each(),
            chords: [vec![0.0; n], vec![0.0; n]],
            scratch: vec![0.0; n * n],
        }
    }

    fn read(&mut self, block: &[Lines]) {
        for (j, lines) in block.iter().enumerate() {
            let sizes = PLACE.map(|place| lines[2 * OUTPUTS + place].abs());
            for (sum, size) in self.reading.iter_mut().zip(sizes) {
                sum[j] += size;
            }
            self.begun.readings.push(sizes);
        }
    }

    /// One more node `g(kT)` of the kernels, which are straight between nodes.
    fn take(&mut self, i: usize, block: &[Lines], moving: &MovingSums) {
        let (n, t, k) = (self.n, self.period, self.node);
        let now: AnswerMatrices =
            core::array::from_fn(|o| block.iter().map(|lines| lines[OUTPUTS + PLACE[o]]).collect());
        let own = &moving.inverse[i * n..(i + 1) * n];
        // Trapezes: the first node is the end of one interval only.
        let half = if k == 0 { 0.5 } else { 1.0 };
        for o in 0..KINDS {
            for j in 0..n {
                let size = now[o][j].abs();
                self.torque[o][j] += half * t * size;
                self.aged[o][j] += half * t * size * (k as f64 + 2.0) * t;
                if k > 0 {
                    self.whole[o][j] += 0.5 * t * (now[o][j] + self.last[o][j]);
                }
                // What is left of a torque that goes on moves the arm.
                let net = self.whole[o][j] + if o == FREE { own[j] } else { 0.0 };
                self.ramp[o][j] += half * t * net.abs();
                self.lasting[o][j] = larger(self.lasting[o][j], net.abs());
                self.impulse[o][j] = larger(self.impulse[o][j], size);
            }
        }
        let early = k < self.long;
        for o in 0..KINDS {
            let pair = (&now[o][..], &moving.gravity[..]);
            if early && o != FREE {
                add_product(&mut self.gravity[o], &mut self.scratch[..n], half * t, pair);
            }
            if early && (o == V || o == STEP) {
                let pair = (&now[o][..], &moving.blocks[2][..]);
                add_product(&mut self.once[o], &mut self.scratch, half * t, pair);
            }
            if !early || o == FREE {
                for j in 0..n {
                    self.late_torque[o][j] += half * t * now[o][j].abs();
                }
            }
        }
        for j in 0..n {
            self.start_moves[1][j] = larger(self.start_moves[1][j], now[E][j].abs());
        }
        if k > 0 {
            self.interval(k - 1, &now, moving);
        }
        self.last = now;
        self.node += 1;
    }

    /// The interval that is `m` samples old at its young end: slope `g' = H_m M^{-1}` of the kernels.
    fn interval(&mut self, m: usize, now: &AnswerMatrices, moving: &MovingSums) {
        let (n, t) = (self.n, self.period);
        let (age, older) = (m as f64 * t, (m as f64 + 1.0) * t);
        let early = m < self.long;
        self.begun.arms.extend(core::iter::repeat_n([0.0; KINDS], n));
        for o in 0..KINDS {
            let slope: Vec<f64> =
                now[o].iter().zip(&self.last[o]).map(|(a, b)| (a - b) / t).collect();
            for j in 0..n {
                let size = slope[j].abs();
                self.slope[o][j] += t * size;
                if o != E {
                    self.bent[o][j] += 0.5 * (older + t) * (older + t) * t * size;
                }
            }
            let answer =
                |j: usize| -> f64 { (0..n).map(|l| slope[l] * moving.mass[l * n + j]).sum() };
            if o == FREE {
                for j in 0..n {
                    self.chords[0][j] += (age + older + 2.0 * t) * slope[j].abs();
                    self.chords[1][j] += t * slope[j].abs();
                    self.late_age[o][j] += older * t * slope[j].abs();
                }
            }
            for (j, arms) in self.begun.arms.iter_mut().rev().take(n).rev().enumerate() {
                arms[o] = answer(j).abs();
            }
            if o == FREE {
                continue;
            }
            if o != E {
                if early {
                    let pair = (&slope[..], &moving.blocks[0][..]);
                    add_product(&mut self.once[o], &mut self.scratch, older * t, pair);
                } else {
                    for j in 0..n {
                        self.late_age[o][j] += older * t * slope[j].abs();
                    }
                }
                continue;
            }
            self.of_error((m, early), &slope, moving);
            self.last_slope = slope;
        }
    }

    /// The same of `e`, which is integrated twice: its slope, and how it jumps there.
    fn of_error(&mut self, (m, early): (usize, bool), slope: &[f64], moving: &MovingSums) {
        let (n, t) = (self.n, self.period);
        let age = m as f64 * t;
        let jump: Vec<f64> = if m == 0 {
            vec![0.0; n]
        } else {
            slope.iter().zip(&self.last_slope).map(|(a, b)| a - b).collect()
        };
        for j in 0..n {
            let middle = age + 0.5 * t;
            self.bent[E][j] += 0.5 * middle * middle * jump[j].abs();
            self.turned[j] += (age + t) * t * slope[j].abs();
            self.start_moves[0][j] = larger(self.start_moves[0][j], (age + t) * slope[j].abs());
        }
        if early {
            let (jumps, slopes) =
                ((&jump[..], &moving.blocks[0][..]), (slope, &moving.blocks[1][..]));
            add_product(&mut self.twice, &mut self.scratch, age, jumps);
            add_product(&mut self.twice, &mut self.scratch, t, slopes);
        } else {
            for j in 0..n {
                self.late_age[E][j] += age * jump[j].abs();
                self.late_slope[E][j] += t * slope[j].abs();
            }
        }
    }

    /// Adds what comes after the last sample. With `‖A^N‖ < ε` after the horizon of `N` samples, sums from `2N` on are
    /// at most `ε` times the bound on those from `N` on.
    fn tails(
        &mut self,
        i: usize,
        tails: &[[[f64; OUTPUTS]; 2]],
        samples: usize,
    ) -> Result<(), ClassRefusal> {
        let t = self.period;
        // Ages from 2N on, in blocks of N with ε each: 3 N, and 9 N², with room for the rest of the row.
        let age = 1.6 * samples as f64 * t;
        for (j, tail) in tails.iter().enumerate() {
            for (o, place) in PLACE.into_iter().enumerate() {
                let torque = LEFT * tail[0][place];
                let slope = 2.0 * torque / t;
                self.reading[o][j] += tail[1][place];
                self.torque[o][j] += torque;
                self.late_torque[o][j] += torque;
                self.aged[o][j] += age * torque;
                self.slope[o][j] += slope;
                self.impulse[o][j] = larger(self.impulse[o][j], slope);
                self.late_age[o][j] += if o == E { age * 2.0 * slope / t } else { age * slope };
                self.late_slope[o][j] += slope;
                self.bent[o][j] += 0.5 * age * age * if o == E { 2.0 * slope / t } else { slope };
                if o == E {
                    self.turned[j] += age * slope;
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
                        + self.late_slope[E][l] * twice
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

/// Largest answers of joint `i` to rows of lost commands. Beyond twice the horizon of `N` samples the rows of each
/// block of `N` answer with at most [`LEFT`] of the largest answer, and less from block to block.
fn lost(
    (linear, horizon): (&Linear, usize),
    i: usize,
    (rows, delay): (LossSpan, usize),
) -> (AnswerMatrices, RowSums) {
    let (samples, n) = (2 * horizon, linear.joints());
    let mut answers: Vec<Vec<[f64; KINDS]>> = vec![Vec::with_capacity(samples); n];
    linear.given_other(i, samples, |j, outputs| {
        answers[j].push(PLACE.map(|place| outputs[place]));
    });
    let of = |o: usize, j: usize| {
        let largest = answers[j].iter().map(|own| own[o].abs()).fold(0.0, larger);
        let row = rows.most as f64;
        let later = 2.0 * LEFT * largest * row * (horizon as f64 / rows.apart as f64 + 1.0);
        rows.sums(|k| answers[j][k][o].abs(), (samples, delay)).map(|own| own + later)
    };
    let each = |o: usize| -> Vec<f64> { (0..n).map(|j| of(o, j)[0]).collect() };
    let level = |last: usize, j: usize| {
        let steps = answers[j].iter().take(last + 1).map(|own| own[STEP]);
        let levels = steps.scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        });
        levels.map(f64::abs).fold(0.0, larger)
    };
    let grown = RowSums {
        earlier: (0..n).map(|j| of(STEP, j)[1]).collect(),
        levels: (1..rows.most).map(|k| (0..n).map(|j| level(k, j)).collect()).collect(),
        spans: Vec::new(),
    };
    (core::array::from_fn(each), grown)
}

/// `Σ_k |x_k + … + x_(k−l+1)|` for each joint of answers that follow each other joint by joint, with what comes after
/// the last sample.
fn changes_over(l: usize, answers: &[f64], later: &[f64]) -> Vec<f64> {
    let n = later.len();
    let samples = answers.len() / n.max(1);
    let at = |k: usize, j: usize| if k < samples { answers[k * n + j] } else { 0.0 };
    let over = |k: usize, j: usize| (k.saturating_sub(l - 1)..=k).map(|k| at(k, j)).sum::<f64>();
    let sum = |j: usize| (0..samples + l).map(|k| over(k, j).abs()).sum::<f64>();
    later.iter().enumerate().map(|(j, later)| sum(j) + l as f64 * later).collect()
}

/// The refutation of a posture.
fn unstable(inequality: &str) -> ClassRefusal {
    let (claim, inequality) = ("class of motions".to_owned(), inequality.to_owned());
    ClassRefusal::Unstable(Refutation { claim, inequality, left: 1.0, right: 1.0 })
}
