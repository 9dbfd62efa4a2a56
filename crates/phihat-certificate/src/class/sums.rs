//! Sums over kicks, misreadings and starts that are played at one posture, with what comes after the last sample.

use super::dynamics::Dynamics;
use super::forget::{RecentSizes, TailDecay};
use crate::coupled::played::{OUTPUTS, PlayedRuns};
use crate::extremes::{Extremes as _, larger};
use crate::refutation::refuse;
use crate::{JointRecord, LoopModel, Matrix, Refutation};

/// Longest run \[samples\].
const LONGEST: usize = 1 << 16;

/// Size of a state, over the largest it had, at which a run has come to rest.
const RESTED: f64 = 1e-10;

/// Largest share of the answer to an impulse, summed, that a torque which goes on may leave by rounding.
const FADED: f64 = 1e-6;

/// Outputs: `e`, `ė`, change of the commanded torque, torque that acts, `ë` without the force itself.
pub(super) const E: usize = 0;
pub(super) const V: usize = 1;
pub(super) const STEP: usize = 2;
pub(super) const ACTS: usize = 3;
const FREE: usize = 4;
pub(super) const KINDS: usize = 5;

/// Output of a played run that each is, and by how much its sizes grow as it sees two samples.
const SEEN: [(usize, f64); KINDS] = [(0, 1.0), (1, 1.0), (3, 2.0), (4, 1.0), (2, 1.0)];

/// Sums by size: `∫|g|`, `∫ age |g|`, `T Σ|γ|`, `Σ age T|γ|`, `Σ ½ age² T|γ|`, `Σ age |δ|`, `Σ ½ age² |δ|`, `∫|G|`,
/// `Σ|n|`.
pub(super) const TORQUE: usize = 0;
pub(super) const AGED: usize = 1;
pub(super) const SLOPE: usize = 2;
pub(super) const SLOPE_AGED: usize = 3;
pub(super) const SLOPE_BENT: usize = 4;
pub(super) const JUMP_AGED: usize = 5;
pub(super) const JUMP_BENT: usize = 6;
pub(super) const RAMP: usize = 7;
pub(super) const READING: usize = 8;
/// The largest: `|G|`, `|g|`, answer to a start beyond what later readings add, `age |γ|`.
pub(super) const LASTING: usize = 9;
pub(super) const IMPULSE: usize = 10;
pub(super) const BEGUN: usize = 11;
pub(super) const EDGE: usize = 12;
/// Rows of lost commands, per deviation of what is lost: all of them, and those before one that begins now; 0 without
/// any.
pub(super) const LOST: usize = 13;
pub(super) const LOST_BEFORE: usize = 14;
const SIZES: usize = 15;

/// A square matrix, row by row.
pub(super) type SquareBlock = Vec<f64>;

/// The sums at a posture; rows: the joint that answers; columns: the joint that is pushed, misread or displaced.
pub(super) struct PlayedSums {
    pub(super) n: usize,
    pub(super) sizes: [[SquareBlock; SIZES]; KINDS],
    /// `∫|g K_g|`.
    pub(super) gravity: [SquareBlock; KINDS],
    /// Twice integrated of `e`, once integrated of the others, per unit of each joint's speed.
    pub(super) moving: [Vec<SquareBlock>; KINDS],
    /// Of the command, where rows are lost: its largest size up to `k + 1` samples after a deviation, and the sum of
    /// its changes over `k + 2` samples after a misreading.
    pub(super) commands: [Vec<SquareBlock>; 2],
}

/// The posture's matrices side by side: row `l` of `[c][j]`.
struct WeightBlocks {
    /// `∂_c M`, `2 ∂_c M − D_c`, `∂_c M − D_c`.
    slopes: SquareBlock,
    twice: SquareBlock,
    once: SquareBlock,
    gravity: SquareBlock,
    inverse: SquareBlock,
    identity: SquareBlock,
}

impl WeightBlocks {
    fn of(dynamics: &Dynamics, inverse: &Matrix) -> Self {
        let n = dynamics.n;
        let side = |of: &dyn Fn(usize) -> Matrix| -> SquareBlock {
            let all: Vec<Matrix> = (0..n).map(of).collect();
            let row = |l: usize| all.iter().flat_map(move |m| m[l].iter().copied());
            (0..n).flat_map(row).collect()
        };
        Self {
            slopes: side(&|c| dynamics.slopes[c].clone()),
            twice: side(&|c| dynamics.less(c, 2.0)),
            once: side(&|c| dynamics.less(c, 1.0)),
            gravity: dynamics.gravity.iter().flatten().copied().collect(),
            inverse: inverse.iter().flatten().copied().collect(),
            identity: (0..n * n).map(|k| if k / n == k % n { 1.0 } else { 0.0 }).collect(),
        }
    }
}

impl WeightBlocks {
    /// Effect of a torque that goes on by itself: to `ë` what it does at once, and of the torque that acts what
    /// opposes it in the end; entry `at` of a square.
    fn at_once(&self, o: usize, at: usize) -> f64 {
        match o {
            FREE => self.inverse[at],
            ACTS => self.identity[at],
            _ => 0.0,
        }
    }
}

/// `row · block`.
fn product(row: &[f64], block: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for (factor, line) in row.iter().zip(block.chunks_exact(out.len())) {
        out.iter_mut().zip(line).for_each(|(out, entry)| *out += factor * entry);
    }
}

/// `out += weight |row|`.
fn add_sizes(out: &mut [f64], weight: f64, row: &[f64]) {
    out.iter_mut().zip(row).for_each(|(out, x)| *out += weight * x.abs());
}

/// `out += weight ∫_0^1 |a + (b − a) x| dx`.
fn add_straight(out: &mut [f64], weight: f64, (a, b): (&[f64], &[f64])) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out += weight * straight(*a, *b);
    }
}

/// `∫_0^1 |a + (b − a) x| dx`.
fn straight(a: f64, b: f64) -> f64 {
    if a * b >= 0.0 {
        return 0.5 * (a + b).abs();
    }
    0.5 * (a * a + b * b) / (a - b).abs()
}

/// Answers of one sample: `[output]`, square: after a kick, a misreading, a displaced arm, a law that began off, a
/// command other than the law's.
struct Answers {
    kick: [SquareBlock; KINDS],
    read: [SquareBlock; KINDS],
    arm: [SquareBlock; KINDS],
    law: [SquareBlock; KINDS],
    lost: [SquareBlock; KINDS],
}

impl Answers {
    fn new(n: usize) -> Self {
        let each = || core::array::from_fn(|_| vec![0.0; n * n]);
        Self { kick: each(), read: each(), arm: each(), law: each(), lost: each() }
    }
}

/// Kernels at the sample before.
struct Before {
    node: [SquareBlock; KINDS],
    slope: [SquareBlock; KINDS],
    whole: [SquareBlock; KINDS],
    /// `g K_g` and `g (∂_c M − D_c)`, row by row.
    gravity: [SquareBlock; KINDS],
    once: [Vec<SquareBlock>; KINDS],
}

impl Before {
    fn new(n: usize) -> Self {
        let each = || core::array::from_fn(|_| vec![0.0; n * n]);
        Self {
            node: each(),
            slope: each(),
            whole: each(),
            gravity: each(),
            once: core::array::from_fn(|_| vec![vec![0.0; n * n]; n]),
        }
    }
}

impl PlayedSums {
    fn empty(n: usize) -> Self {
        Self {
            n,
            sizes: core::array::from_fn(|_| core::array::from_fn(|_| vec![0.0; n * n])),
            gravity: core::array::from_fn(|_| vec![0.0; n * n]),
            moving: core::array::from_fn(|_| vec![vec![0.0; n * n]; n]),
            commands: [Vec::new(), Vec::new()],
        }
    }

    /// Plays an impulse on every joint, a misreading of every encoder, a displaced joint, and a law that began with
    /// its reading off.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: the loop does not forget, or its law has no integrator.
    pub(super) fn at(
        loops: &[(&JointRecord, &LoopModel)],
        (dynamics, inverse): (&Dynamics, &Matrix),
        (period, rows): (f64, Option<LostSpacing>),
    ) -> Result<Self, Refutation> {
        let n = loops.len();
        let decay = TailDecay::of(loops, inverse)?;
        let sets = if rows.is_some() { 5 } else { 4 };
        let mut played = PlayedRuns::new(loops, inverse, sets * n);
        for j in 0..n {
            played.kick(j, j, 0.0);
            played.misread(n + j, j);
            played.displace(2 * n + j, j);
            played.begin(3 * n + j, j);
            if rows.is_some() {
                played.give_other(4 * n + j, j);
            }
        }
        let blocks = WeightBlocks::of(dynamics, inverse);
        let mut own = Self::empty(n);
        let (mut now, mut before) = (Answers::new(n), Before::new(n));
        let mut commands = vec![vec![0.0; sets * n]; n];
        let mut recent = RecentSizes::new(sets * n, decay.block);
        // Answers to another command, and changes of the command after a misreading, sample by sample.
        let mut others: Vec<[SquareBlock; KINDS]> = Vec::new();
        let mut misread: Vec<SquareBlock> = Vec::new();
        let (mut most, mut rested) = (0.0, false);
        for sample in 0..LONGEST {
            if rested {
                recent.take(&played);
            }
            played.step(|i, run, outputs: &[f64; OUTPUTS]| {
                let change = outputs[3] - core::mem::replace(&mut commands[i][run], outputs[3]);
                let values = [outputs[0], outputs[1], change, outputs[4], outputs[2]];
                let (set, at) = (run / n, i * n + run % n);
                let into = match set {
                    0 => &mut now.kick,
                    1 => &mut now.read,
                    2 => &mut now.arm,
                    3 => &mut now.law,
                    _ => &mut now.lost,
                };
                for (into, value) in into.iter_mut().zip(values) {
                    into[at] = value;
                }
            });
            own.take(sample, (&now, &mut before), &blocks, period);
            if rows.is_some() {
                others.push(now.lost.clone());
                misread.push(now.read[STEP].clone());
            }
            if (sample + 1) % decay.block == 0 {
                if rested {
                    if let Some(rows) = rows {
                        own.lose((&others, rows), (&decay, &recent), sample + 1);
                        own.grow((&others, &misread), rows, (&decay, &recent));
                    }
                    own.finish((&decay, &recent, sample + 1), (&before, &blocks), period)?;
                    return Ok(own);
                }
                // One more block, whose sizes bound what comes after it.
                let size = (0..sets * n).map(|run| played.size(run)).largest();
                most = larger(most, size);
                rested = size < RESTED * most;
            }
        }
        Err(refuse("class of motions", "a kick is forgotten after 2^16 samples", 1.0, 0.0))
    }

    /// One sample: a node of the kernels, which are straight between nodes, and the interval that it ends.
    fn take(
        &mut self,
        sample: usize,
        (now, before): (&Answers, &mut Before),
        blocks: &WeightBlocks,
        t: f64,
    ) {
        let (n, nn) = (self.n, self.n * self.n);
        let mut slope = vec![0.0; nn];
        for o in 0..KINDS {
            let sizes = &mut self.sizes[o];
            for at in 0..nn {
                sizes[READING][at] += now.read[o][at].abs();
                let begun = now.arm[o][at].abs() + now.law[o][at].abs() + sizes[READING][at];
                sizes[BEGUN][at] = larger(sizes[BEGUN][at], begun);
                sizes[IMPULSE][at] = larger(sizes[IMPULSE][at], now.kick[o][at].abs());
            }
            if sample > 0 {
                for ((slope, b), a) in slope.iter_mut().zip(&now.kick[o]).zip(&before.node[o]) {
                    *slope = (b - a) / t;
                }
                self.interval((o, sample - 1), (&now.kick[o], &slope), before, (blocks, t));
            }
            if o < ACTS {
                self.products(o, sample, (&now.kick[o], &slope), before, (blocks, t));
            }
            before.slope[o].copy_from_slice(&slope);
            before.node[o].copy_from_slice(&now.kick[o]);
            debug_assert_eq!(now.kick[o].len(), n * n);
        }
    }

    /// Sums by size over the interval that is `m` samples old at its young end.
    fn interval(
        &mut self,
        (o, m): (usize, usize),
        (node, slope): (&[f64], &[f64]),
        before: &mut Before,
        (blocks, t): (&WeightBlocks, f64),
    ) {
        let sizes = &mut self.sizes[o];
        // What acts is that of the last sample, up to a sample later.
        let held = if o == ACTS { t } else { 0.0 };
        let age = m as f64 * t + held;
        // Between two samples every age is up to a sample more, and each interval shares two slopes.
        let bent = if o == E { age + 0.5 * t } else { age + t };
        for at in 0..node.len() {
            let (a, b, size) = (before.node[o][at], node[at], slope[at].abs());
            let torque = t * straight(a, b);
            sizes[TORQUE][at] += torque;
            sizes[AGED][at] += (age + 1.5 * t) * torque;
            sizes[SLOPE][at] += t * size;
            sizes[SLOPE_AGED][at] += (age + t) * t * size;
            sizes[SLOPE_BENT][at] += 0.5 * (age + t) * (age + t) * t * size;
            let jump = if m == 0 && o == E { 0.0 } else { slope[at] - before.slope[o][at] };
            sizes[JUMP_AGED][at] += (age + t) * jump.abs();
            sizes[JUMP_BENT][at] += 0.5 * bent * bent * jump.abs();
            sizes[EDGE][at] = larger(sizes[EDGE][at], (age + 2.0 * t) * size);
            // A torque that goes on: off its chord by T²/12 times the slope in the mean, by T²/8 times it at most.
            let free = blocks.at_once(o, at);
            let last = before.whole[o][at] + free;
            let next = last + 0.5 * t * (a + b);
            before.whole[o][at] = next - free;
            sizes[RAMP][at] += t * straight(last, next) + t * t * t / 12.0 * size;
            let lasting = larger(last.abs(), next.abs()) + t * t / 8.0 * size;
            sizes[LASTING][at] = larger(sizes[LASTING][at], lasting);
            if m == 0 {
                sizes[RAMP][at] += held * free;
            }
        }
    }

    /// Sums of products with the posture's matrices, of `e`, `ė` and the change of torque.
    fn products(
        &mut self,
        o: usize,
        sample: usize,
        (node, slope): (&[f64], &[f64]),
        before: &mut Before,
        (blocks, t): (&WeightBlocks, f64),
    ) {
        let n = self.n;
        let (mut gravity, mut all) = (vec![0.0; n], vec![0.0; n * n]);
        let mut jump = vec![0.0; n];
        for i in 0..n {
            let row = i * n..(i + 1) * n;
            let (node, slope) = (&node[row.clone()], &slope[row.clone()]);
            product(node, &blocks.gravity, &mut gravity);
            let last = &mut before.gravity[o][row.clone()];
            if sample > 0 {
                add_straight(&mut self.gravity[o][row.clone()], t, (last, &gravity));
            }
            last.copy_from_slice(&gravity);
            let mut into = |weight: f64, all: &[f64]| {
                for (moving, all) in self.moving[o].iter_mut().zip(all.chunks_exact(n)) {
                    add_sizes(&mut moving[row.clone()], weight, all);
                }
            };
            let m = sample.saturating_sub(1) as f64;
            if o == E {
                if sample > 1 {
                    let last = &before.slope[o][row.clone()];
                    jump.iter_mut().zip(slope.iter().zip(last)).for_each(|(j, (a, b))| *j = a - b);
                    product(&jump, &blocks.slopes, &mut all);
                    into(m * t, &all);
                }
                if sample > 0 {
                    product(slope, &blocks.twice, &mut all);
                    into(t, &all);
                }
                continue;
            }
            if sample > 0 {
                product(slope, &blocks.slopes, &mut all);
                into((m + 0.5) * t * t, &all);
            }
            product(node, &blocks.once, &mut all);
            let last = &mut before.once[o][i];
            if sample > 0 {
                for (c, moving) in self.moving[o].iter_mut().enumerate() {
                    let c = c * n..(c + 1) * n;
                    let pair = (&last[c.clone()], &all[c]);
                    add_straight(&mut moving[row.clone()], t, pair);
                }
            }
            last.copy_from_slice(&all);
        }
    }

    /// Answers to rows of lost commands, with what comes after the last sample: there each sample counts once, with a
    /// weight of at most the length of a row.
    fn lose(
        &mut self,
        (others, spacing): (&[[SquareBlock; KINDS]], LostSpacing),
        (decay, recent): (&TailDecay, &RecentSizes),
        samples: usize,
    ) {
        let n = self.n;
        for o in 0..KINDS {
            let (output, twice) = SEEN[o];
            for at in 0..n * n {
                let sizes: Vec<f64> = others.iter().map(|own| own[o][at].abs()).collect();
                let rest = twice * decay.rest((at / n, output), samples)[0];
                let later = rest * recent.sum(4 * n + at % n);
                let later = spacing.most as f64 * later;
                let [all, before] = spacing.worst(&sizes);
                self.sizes[o][LOST][at] = all + later;
                self.sizes[o][LOST_BEFORE][at] = before + later;
            }
        }
    }

    /// Answers of the command by which a row of losses grows.
    fn grow(
        &mut self,
        (others, misread): (&[[SquareBlock; KINDS]], &[SquareBlock]),
        spacing: LostSpacing,
        (decay, recent): (&TailDecay, &RecentSizes),
    ) {
        let n = self.n;
        let mut command = vec![0.0; n * n];
        let mut largest = vec![0.0; n * n];
        for (k, own) in others.iter().enumerate().take(spacing.most) {
            command.iter_mut().zip(&own[STEP]).for_each(|(sum, change)| *sum += change);
            largest.iter_mut().zip(&command).for_each(|(most, x)| *most = larger(*most, x.abs()));
            if k > 0 {
                self.commands[0].push(largest.clone());
            }
        }
        for l in 2..=spacing.most {
            let mut over = vec![0.0; n * n];
            let mut sums = vec![0.0; n * n];
            let nothing = vec![0.0; n * n];
            for k in 0..misread.len() + l {
                let new = misread.get(k).unwrap_or(&nothing);
                let old = k.checked_sub(l).and_then(|k| misread.get(k)).unwrap_or(&nothing);
                for at in 0..n * n {
                    over[at] += new[at] - old[at];
                    sums[at] += over[at].abs();
                }
            }
            for (at, sum) in sums.iter_mut().enumerate() {
                let rest = 2.0 * decay.rest((at / n, 3), misread.len())[0];
                *sum += l as f64 * rest * recent.sum(n + at % n);
            }
            self.commands[1].push(sums);
        }
    }

    /// Adds what comes after the last sample, and what lies between the samples: there `e` is off its chord by at most
    /// `T²/8` times `ë`.
    fn finish(
        &mut self,
        (decay, recent, samples): (&TailDecay, &RecentSizes, usize),
        (before, blocks): (&Before, &WeightBlocks),
        t: f64,
    ) -> Result<(), Refutation> {
        let n = self.n;
        // Sums that are added to products by size alone: `Σ age|δ|`, `T Σ|γ|`, `Σ age T|γ|`, `∫|g|`.
        let mut late: [[SquareBlock; 4]; KINDS] =
            core::array::from_fn(|_| core::array::from_fn(|_| vec![0.0; n * n]));
        let runs: Vec<f64> = (0..4 * n).map(|run| recent.sum(run)).collect();
        for o in 0..KINDS {
            // A change per sample sees two samples; ë is the third output that is played.
            let (output, twice) = SEEN[o];
            for i in 0..n {
                let rest = decay.rest((i, output), samples).map(|rest| twice * rest);
                for j in 0..n {
                    let at = i * n + j;
                    let kick = rest.map(|rest| rest * runs[j]);
                    let torque = t * kick[0];
                    self.after(o, at, kick, t);
                    let left = before.whole[o][at] + blocks.at_once(o, at);
                    let scale = larger(self.sizes[o][TORQUE][at], self.sizes[o][TORQUE][i * n + i]);
                    let fades = left.abs() <= torque + FADED * scale;
                    Refutation::unless(
                        "class of motions",
                        "a torque that goes on leaves no error (integrator)",
                        left.abs(),
                        torque,
                        fades,
                    )?;
                    for (late, value) in late[o].iter_mut().zip([
                        4.0 * kick[1],
                        2.0 * kick[0],
                        2.0 * t * kick[1],
                        torque,
                    ]) {
                        late[at] = value;
                    }
                    let sizes = &mut self.sizes[o];
                    sizes[READING][at] += rest[0] * runs[n + j];
                    let later = rest[0] * (runs[2 * n + j] + runs[3 * n + j]);
                    let beyond = larger(sizes[BEGUN][at] - sizes[READING][at], 0.0);
                    sizes[BEGUN][at] = larger(beyond, later);
                }
            }
        }
        for o in [ACTS, FREE] {
            late[o] = [JUMP_AGED, SLOPE, SLOPE_AGED, TORQUE].map(|k| self.sizes[o][k].clone());
        }
        let [own @ .., free] = &mut self.sizes;
        let eighth = t * t / 8.0;
        for (own, free) in own[E].iter_mut().zip(free.iter()) {
            own.iter_mut().zip(free).for_each(|(own, free)| *own += eighth * free);
        }
        for (k, size) in [JUMP_AGED, SLOPE, SLOPE_AGED, TORQUE].into_iter().enumerate() {
            let pairs = late[E][k].iter_mut().zip(&free[size]);
            pairs.for_each(|(late, free)| *late += eighth * free);
        }
        self.by_size(&late, blocks);
        Ok(())
    }

    /// Adds what comes after the last sample to the sums by size: `Σ|g_k| (k + 2)^p` is at most `kick[p]`.
    fn after(&mut self, o: usize, at: usize, kick: [f64; 3], t: f64) {
        let [zero, one, two] = kick;
        let rest = [
            (TORQUE, t * zero),
            (AGED, t * t * one),
            // |γ| ≤ (|g_m| + |g_{m+1}|)/T, and |δ| is at most two of these.
            (SLOPE, 2.0 * zero),
            (SLOPE_AGED, 2.0 * t * one),
            (SLOPE_BENT, t * t * two),
            (JUMP_AGED, 4.0 * one),
            (JUMP_BENT, 2.0 * t * two),
            // |G_k| ≤ T Σ_{m ≥ k} |g_m|.
            (RAMP, t * t * one),
        ];
        let sizes = &mut self.sizes[o];
        for (k, value) in rest {
            sizes[k][at] += value;
        }
        for (k, value) in [(LASTING, t * zero), (IMPULSE, zero), (EDGE, 2.0 * one)] {
            sizes[k][at] = larger(sizes[k][at], value);
        }
    }

    /// Adds products by size of what was summed up by size alone.
    fn by_size(&mut self, late: &[[SquareBlock; 4]; KINDS], blocks: &WeightBlocks) {
        let n = self.n;
        for (o, [jump_aged, slope, slope_aged, torque]) in late.iter().enumerate() {
            let [first, second] = if o == E {
                [(jump_aged, &blocks.slopes), (slope, &blocks.twice)]
            } else {
                [(slope_aged, &blocks.slopes), (torque, &blocks.once)]
            };
            for i in 0..n {
                for l in 0..n {
                    let line = l * n * n..(l + 1) * n * n;
                    for (late, block) in [first, second] {
                        let lines = block[line.clone()].chunks_exact(n);
                        for (moving, line) in self.moving[o].iter_mut().zip(lines) {
                            add_sizes(&mut moving[i * n..(i + 1) * n], late[i * n + l], line);
                        }
                    }
                    let line = &blocks.gravity[l * n..(l + 1) * n];
                    add_sizes(&mut self.gravity[o][i * n..(i + 1) * n], torque[i * n + l], line);
                }
            }
        }
    }
}

/// Rows of lost commands: most in a row, and samples from the start of one to the next, at least.
#[derive(Debug, Clone, Copy)]
pub(super) struct LostSpacing {
    pub(super) most: usize,
    pub(super) apart: usize,
    /// Samples from a command to its torque.
    pub(super) delay: usize,
}

impl LostSpacing {
    /// `Σ_r max_{s ≥ r S} Σ_{l=1}^m |c_{s+1−l}|`: `s` samples have gone since the first command of the `r`-th row,
    /// backwards in time; and the same from `r = 1` on with `r S` less by the delay.
    fn worst(self, sizes: &[f64]) -> [f64; 2] {
        let row = |s: usize| -> f64 {
            let each = (1..=self.most).filter_map(|l| sizes.get((s + 1).checked_sub(l)?));
            each.sum()
        };
        let mut whole: Vec<f64> = (0..sizes.len() + self.most).map(row).collect();
        let mut most = 0.0;
        for own in whole.iter_mut().rev() {
            most = larger(most, *own);
            *own = most;
        }
        let apart = self.apart.max(1);
        let before = whole.iter().skip(apart.saturating_sub(self.delay)).step_by(apart);
        [whole.iter().step_by(apart).sum(), before.sum()]
    }
}

#[cfg(test)]
mod tests {
    use super::{LostSpacing, straight};

    #[test]
    fn rows_of_losses_add_up_as_of_a_kernel_that_halves() {
        // c_k = 2^{−k}: the worst row has its last command now, 1 + 1/2 + 1/4, and every 4 samples before a 16th of it.
        let sizes: Vec<f64> = (0..60).map(|k| 0.5_f64.powi(k)).collect();
        let [worst, before] = LostSpacing { most: 3, apart: 4, delay: 0 }.worst(&sizes);
        // From the start of the row on: 1, 3/2, 7/4 at s = 2, then half of it with each sample.
        let earlier = 1.75 / 4.0 * (16.0 / 15.0);
        assert!((worst - 1.75 - earlier).abs() < 1e-12, "{worst}");
        assert!((before - earlier).abs() < 1e-12, "{before}");
        let [one, before] = LostSpacing { most: 1, apart: 60, delay: 1 }.worst(&sizes);
        assert!((one - 1.0).abs() < 1e-15 && (before - 0.5_f64.powi(59)).abs() < 1e-24, "{one}");
    }

    #[test]
    fn a_line_s_size_is_its_area() {
        // A triangle on either side of the zero at 3/4.
        assert!(
            (straight(3.0, -1.0) - 1.25).abs() < 1e-15
                && (straight(-1.0, -3.0) - 2.0).abs() < 1e-15
        );
    }
}
