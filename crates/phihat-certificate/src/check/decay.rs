//! Decay of a loop: the norm of its state contracts, and bounds all later outputs.

use super::sample::{LINE, Loop, Outside, Signals};
use crate::Refutation;
use crate::extremes::Extremes as _;
use crate::refutation::refuse;
use phihat::{StateEntry, VelocitySource};

/// Steps after which a loop counts as not decaying.
const LONGEST: usize = 1 << 21;

/// Relative size of the remainder at which a sum is cut off.
const LEFT: f64 = 1e-17;

/// The signals that a loop carries from sample to sample, in the order of [`crate::SampledVarying`], each in a unit of
/// its own.
#[derive(Debug, Clone)]
pub(crate) struct SignalLayout(Vec<(Slot, f64)>);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Slot {
    Position,
    Velocity,
    Law(usize),
    LastPosition,
    LastVelocity,
    Mean,
    End,
    Line(usize),
}

impl SignalLayout {
    pub(crate) fn of(of: &Loop) -> Self {
        let w = of.kp.sqrt();
        let power = |k: i8| {
            let base = if k < 0 { w.recip() } else { w };
            (0..k.unsigned_abs()).fold(1.0, |power, _| power * base)
        };
        let law = |of_them: &dyn Fn(StateEntry) -> Option<f64>| -> Vec<(Slot, f64)> {
            let all = of.law.entries.iter().enumerate();
            all.filter_map(|(at, entry)| Some((Slot::Law(at), of_them(*entry)?))).collect()
        };
        let mut slots = vec![(Slot::Position, 1.0), (Slot::Velocity, w)];
        slots.extend(law(&|entry| match entry {
            StateEntry::Estimate { power: k } => Some(power(k)),
            StateEntry::Filter => Some(1.0),
            _ => None,
        }));
        let uses_velocity = of.law.uses_velocity();
        if uses_velocity && of.model.velocity == VelocitySource::Differenced {
            slots.push((Slot::LastPosition, 1.0));
        }
        slots.extend(law(&|entry| (entry == StateEntry::Velocity).then_some(w)));
        let remembered = of.law.register().is_some();
        if uses_velocity && of.model.velocity_filter_hz.is_some() && !remembered {
            slots.push((Slot::LastVelocity, w));
        }
        if of.law.uses_torque() {
            slots.push((Slot::Mean, w * w));
        }
        if of.drives() {
            slots.push((Slot::End, w * w));
        }
        slots.extend((0..of.late.min(LINE)).map(|i| (Slot::Line(i), w * w)));
        slots.extend(law(&|entry| (entry == StateEntry::Torque).then_some(w * w)));
        Self(slots)
    }

    /// Number of signals.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// One unit of one signal.
    fn unit(&self, index: usize) -> Signals {
        let mut x = Signals::REST;
        if let Some((slot, unit)) = self.0.get(index) {
            *place(&mut x, *slot) = *unit;
        }
        x
    }

    /// Every signal in its unit.
    fn read(&self, x: &Signals) -> Vec<f64> {
        let mut x = *x;
        self.0.iter().map(|(slot, unit)| *place(&mut x, *slot) / unit).collect()
    }

    fn size(&self, x: &Signals) -> f64 {
        let mut x = *x;
        self.0.iter().map(|(slot, unit)| (*place(&mut x, *slot) / unit).abs()).largest()
    }

    /// The state that one sample under a constant outside leaves as it is.
    pub(crate) fn fixed_point(&self, of: &Loop, outside: &Outside) -> Signals {
        let n = self.len();
        let pushed = self.read(&of.step(&Signals::REST, outside).0);
        // (1 − A) x = b, by elimination with pivots.
        let mut rows: Vec<Vec<f64>> = self
            .matrix(of)
            .into_iter()
            .enumerate()
            .map(|(i, row)| {
                let unit = |j: usize| f64::from(u8::from(i == j));
                let left = row.into_iter().enumerate().map(|(j, a)| unit(j) - a);
                left.chain([pushed[i]]).collect()
            })
            .collect();
        for column in 0..n {
            let size = |i: &usize| rows[*i][column].abs();
            let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(column);
            rows.swap(column, pivot);
            let own = rows[column].clone();
            for row in rows.iter_mut().skip(column + 1) {
                let factor = row[column] / own[column];
                for (entry, value) in row.iter_mut().zip(&own) {
                    *entry -= factor * value;
                }
            }
        }
        let mut solution = vec![0.0; n];
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| rows[i][j] * solution[j]).sum();
            solution[i] = (rows[i][n] - known) / rows[i][i];
        }
        let mut x = Signals::REST;
        for ((slot, unit), value) in self.0.iter().zip(solution) {
            *place(&mut x, *slot) = unit * value;
        }
        x
    }

    /// `A` in these units, row by row: what one sample makes of the signals.
    pub(crate) fn matrix(&self, of: &Loop) -> Vec<Vec<f64>> {
        let columns: Vec<Vec<f64>> = (0..self.len())
            .map(|j| self.read(&of.step(&self.unit(j), &Outside::default()).0))
            .collect();
        (0..self.len()).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
    }
}

fn place(x: &mut Signals, slot: Slot) -> &mut f64 {
    match slot {
        Slot::Position => &mut x.q,
        Slot::Velocity => &mut x.v,
        Slot::Law(at) => &mut x.law[at],
        Slot::LastPosition => &mut x.position,
        Slot::LastVelocity => &mut x.velocity,
        Slot::Mean => &mut x.mean,
        Slot::End => &mut x.end,
        Slot::Line(i) => &mut x.line[i],
    }
}

/// Outputs of the loop at one sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct SampleOutputs {
    /// `e` \[rad\].
    pub(crate) e: f64,
    /// `ė` \[rad/s\].
    pub(crate) de: f64,
    /// Torque commanded \[rad/s²\].
    pub(crate) u: f64,
}

impl SampleOutputs {
    fn each(self) -> [f64; 3] {
        [self.e, self.de, self.u]
    }
}

/// That a loop forgets, by trial on every signal.
///
/// # Claim
///
/// `‖A^K‖_∞ = ρ < ½`, `A^K` built column by column from signals. For a state of size `s` at some sample and
/// every output `y`, all later ones included:
///
/// ```text
/// Σ |y_j| ≤ s G_0/(1−ρ),   Σ (j+1)|y_j| ≤ s (G_1/(1−ρ) + K G_0 ρ/(1−ρ)²), …
/// G_p = Σ_{j<K} C(j+p, p) Σ_columns |y_j|
/// ```
#[derive(Debug, Clone)]
pub(crate) struct Decay {
    layout: SignalLayout,
    block: f64,
    rho: f64,
    /// `G_0 … G_3` of each output.
    sums: [[f64; 4]; 3],
}

impl Decay {
    /// # Errors
    ///
    /// [`Refutation`]: nothing contracts.
    pub(crate) fn of(claim: &str, of: &Loop) -> Result<Self, Refutation> {
        let layout = SignalLayout::of(of);
        let mut columns: Vec<Signals> = (0..layout.len()).map(|j| layout.unit(j)).collect();
        let mut sums = [[0.0; 4]; 3];
        for j in 0..LONGEST / layout.len() {
            let mut at = [0.0; 3];
            for column in &mut columns {
                let (next, u) = of.step(column, &Outside::default());
                let seen = SampleOutputs { e: column.q, de: column.v, u };
                for (total, value) in at.iter_mut().zip(seen.each()) {
                    *total += value.abs();
                }
                *column = next;
            }
            let n = j as f64;
            let weights = [
                1.0,
                n + 1.0,
                (n + 1.0) * (n + 2.0) / 2.0,
                (n + 1.0) * (n + 2.0) * (n + 3.0) / 6.0,
            ];
            for (sums, value) in sums.iter_mut().zip(at) {
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    *sum += weight * value;
                }
            }
            if j % 16 == 15 {
                let rho = norm(&layout, &columns);
                if !rho.is_finite() {
                    break;
                }
                if rho < 0.5 {
                    return Ok(Self { layout, block: n + 1.0, rho, sums });
                }
            }
        }
        Err(refuse(claim, "A^k → 0 (stable loop), μ", of.mu, 1.0))
    }

    /// Bounds of `Σ_j C(j+p, p)|y_j|`, `p = 0 … 3`, over all outputs from a state on.
    fn rest(&self, size: f64) -> [[f64; 4]; 3] {
        let (k, rho, left) = (self.block, self.rho, 1.0 - self.rho);
        // Σ_b ρ^b C(bK + j + p, p) ≤ Σ_b ρ^b (1 + bK)^p C(j+p, p).
        let mut blocks = [0.0; 4];
        let mut share = 1.0;
        for b in 0..400 {
            let step = 1.0 + f64::from(b) * k;
            let mut power = share;
            for total in &mut blocks {
                *total += power;
                power *= step;
            }
            share *= rho;
        }
        blocks[0] = blocks[0].max(1.0 / left);
        self.sums.map(|sums| core::array::from_fn(|p| size * blocks[p] * sums[p]))
    }

    /// Runs a loop from a state until hardly anything is left to come.
    pub(crate) fn run(&self, of: &Loop, from: &Signals) -> FreeMotion {
        let mut x = *from;
        let mut run = FreeMotion { seen: Vec::new(), rest: [[0.0; 4]; 3] };
        let mut largest = [0.0_f64; 3];
        for j in 0..LONGEST {
            let (next, u) = of.step(&x, &Outside::default());
            let seen = SampleOutputs { e: x.q, de: x.v, u };
            for (most, value) in largest.iter_mut().zip(seen.each()) {
                *most = most.max(value.abs());
            }
            run.seen.push(seen);
            x = next;
            if j % 64 == 63 {
                let size = self.layout.size(&x);
                let done = (0..3).all(|i| self.sums[i][0] * size <= LEFT * largest[i]);
                if done || !size.is_finite() {
                    break;
                }
            }
        }
        run.rest = self.rest(self.layout.size(&x));
        run
    }
}

fn norm(layout: &SignalLayout, columns: &[Signals]) -> f64 {
    let mut rows = vec![0.0_f64; layout.len()];
    for column in columns {
        for (row, value) in rows.iter_mut().zip(layout.read(column)) {
            *row += value.abs();
        }
    }
    let most = rows.into_iter().largest();
    if most.is_nan() { f64::INFINITY } else { most }
}

/// A loop's free motion, and bounds on all that comes after.
#[derive(Debug, Clone)]
pub(crate) struct FreeMotion {
    pub(crate) seen: Vec<SampleOutputs>,
    /// `Σ_j C(j+p, p)|y_j|` of what was cut, for `e`, `ė`, `u`.
    pub(crate) rest: [[f64; 4]; 3],
}

/// Output of the loop, by its index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Output {
    Error = 0,
    Velocity = 1,
    Torque = 2,
}

impl FreeMotion {
    pub(crate) fn of(&self, output: Output) -> impl DoubleEndedIterator<Item = f64> {
        self.seen.iter().map(move |seen| seen.each()[output as usize])
    }

    pub(crate) fn left(&self, output: Output) -> [f64; 4] {
        self.rest[output as usize]
    }

    /// `Σ |y_k|`.
    pub(crate) fn sum(&self, output: Output) -> f64 {
        self.of(output).map(f64::abs).sum::<f64>() + self.left(output)[0]
    }

    /// `Σ_k |Σ…Σ y|`, `times` times summed over all that is still to come: for an output whose `times` lowest moments
    /// vanish this is what has come so far.
    pub(crate) fn summed(&self, output: Output, times: usize) -> f64 {
        let mut values: Vec<f64> = self.of(output).collect();
        for _ in 0..times {
            let mut later = 0.0;
            for value in values.iter_mut().rev() {
                let own = *value;
                *value = later;
                later += own;
            }
        }
        // Of what was cut, `y_{N+j}` counts `C(N+j, p) = Σ_a C(N, p−a) C(j, a)` times.
        let count = values.len() as f64;
        let mut choose = 1.0;
        let mut cut = 0.0;
        for back in 0..=times {
            cut += choose * self.left(output).get(times - back).copied().unwrap_or(f64::INFINITY);
            choose *= (count - back as f64) / (back as f64 + 1.0);
        }
        values.iter().map(|value| value.abs()).sum::<f64>() + cut
    }
}

#[cfg(test)]
mod tests {
    use super::{Decay, FreeMotion, Loop, Output, Outside, SampleOutputs, SignalLayout};
    use crate::extremes::Extremes as _;
    use crate::{JointRecord, LoopModel};
    use phihat::{Form, TorqueSource, VelocitySource};

    fn loops() -> Vec<Loop> {
        let record = JointRecord {
            name: String::new(),
            inertia_kg_m2: 1.0,
            kp_per_s2: 400.0,
            kd_per_s: 40.0,
            a: vec![900.0, 60.0],
            observer: None,
        };
        let model = |form, velocity, drive_bandwidth_hz| LoopModel {
            period_s: 2e-3,
            delay_samples: 1,
            sample_delay_samples: 1,
            torque: TorqueSource::Applied,
            velocity,
            velocity_filter_hz: Some(90.0),
            torque_filter_hz: None,
            form,
            drive_bandwidth_hz,
        };
        [
            model(Form::Observer, VelocitySource::Differenced, Some(150.0)),
            model(Form::Literal, VelocitySource::Measured, None),
        ]
        .map(|model| Loop::new(&record, &model, 1.3))
        .to_vec()
    }

    /// `C(j + p, p)`.
    fn choose(j: usize, p: usize) -> f64 {
        (1..=p).map(|i| (j + i) as f64 / i as f64).product()
    }

    #[test]
    fn what_is_left_is_bounded_by_blocks_that_shrink() -> Result<(), crate::Refutation> {
        for of in loops() {
            let decay = Decay::of("", &of)?;
            let layout = SignalLayout::of(&of);
            let n = layout.len();
            // Every signal alone, sample by sample, for a block; and what the whole block makes of them.
            let block = (0..1_u32 << 21).take_while(|j| f64::from(*j) < decay.block).count();
            let mut sums = [[0.0; 4]; 3];
            let mut rows = vec![0.0; n];
            for column in 0..n {
                let mut x = layout.unit(column);
                for j in 0..block {
                    let (next, u) = of.step(&x, &Outside::default());
                    for (sums, y) in sums.iter_mut().zip([x.q, x.v, u]) {
                        for (p, sum) in sums.iter_mut().enumerate() {
                            *sum += choose(j, p) * y.abs();
                        }
                    }
                    x = next;
                }
                for (row, value) in rows.iter_mut().zip(layout.read(&x)) {
                    *row += value.abs();
                }
            }
            let near = |own: f64, want: f64| (own - want).abs() <= 1e-9 * want;
            let rho = rows.into_iter().largest();
            assert!(near(decay.rho, rho) && rho < 0.5 && block.is_multiple_of(16), "{rho} {block}");
            // Σ ρ^b (1 + bK)^p for p = 0, 1, 2, 3, by what is known of Σ b^p ρ^b.
            let (k, left): (f64, f64) = (decay.block, 1.0 - rho);
            let powers = [
                1.0 / left,
                rho / left.powi(2),
                rho * (1.0 + rho) / left.powi(3),
                rho * (1.0 + 4.0 * rho + rho * rho) / left.powi(4),
            ];
            let blocks = [
                powers[0],
                powers[0] + k * powers[1],
                powers[0] + 2.0 * k * powers[1] + k * k * powers[2],
                powers[0] + 3.0 * k * powers[1] + 3.0 * k * k * powers[2] + k.powi(3) * powers[3],
            ];
            let rest = decay.rest(0.7);
            for i in 0..3 {
                for p in 0..4 {
                    assert!(near(decay.sums[i][p], sums[i][p]), "{i} {p}");
                    assert!(near(rest[i][p], 0.7 * blocks[p] * sums[i][p]), "{i} {p}");
                }
            }
            // What a long run still does is less; and a run ends where hardly anything is left.
            let start = layout.unit(0);
            let run = decay.run(&of, &start);
            let whole = decay.rest(layout.size(&start));
            for (i, output) in [Output::Error, Output::Velocity, Output::Torque].iter().enumerate()
            {
                for p in 0..4 {
                    let own: f64 =
                        run.of(*output).enumerate().map(|(j, y)| choose(j, p) * y.abs()).sum();
                    assert!(own <= whole[i][p], "{i} {p}");
                }
                assert!(run.left(*output)[0] < 1e-12 * run.sum(*output));
            }
        }
        Ok(())
    }

    #[test]
    fn a_sum_of_all_that_is_to_come_counts_what_was_cut() {
        let seen = [3.0, -1.0, 2.0, -0.5].map(|e| SampleOutputs { e, de: -2.0 * e, u: 0.0 });
        let run = FreeMotion {
            seen: seen.to_vec(),
            rest: [[1.0, 10.0, 100.0, 1000.0], [2.0, 0.0, 0.0, 0.0], [0.0; 4]],
        };
        let near = |own: f64, want: f64| (own - want).abs() < 1e-9;
        assert!(near(run.sum(Output::Error), 6.5 + 1.0));
        assert!(near(run.sum(Output::Velocity), 13.0 + 2.0));
        // To come after each: 0.5, 1.5, −0.5, 0; then 1, −0.5, 0, 0. Cut: y_{N+j} counts C(N+j, p) times, N = 4.
        assert!(near(run.summed(Output::Error, 0), 6.5 + 1.0));
        assert!(near(run.summed(Output::Error, 1), 2.5 + 10.0 + 4.0));
        assert!(near(run.summed(Output::Error, 2), 1.5 + 100.0 + 4.0 * 10.0 + 6.0));
        assert!(near(run.summed(Output::Velocity, 1), 5.0 + 8.0));
        assert_eq!(run.of(Output::Velocity).next_back(), Some(1.0));
    }

    #[test]
    fn a_fixed_point_stays() {
        for of in loops() {
            let layout = SignalLayout::of(&of);
            let outside = Outside { phi: 0.7, ..Outside::default() };
            let at = layout.fixed_point(&of, &outside);
            let (next, _) = of.step(&at, &outside);
            let moved = next.minus(&at);
            assert!(layout.size(&moved) < 1e-9 * layout.size(&at));
            // φ held for ever is borne: no error is left.
            assert!(at.q.abs() < 1e-12 && at.v.abs() < 1e-12, "{at:?}");
        }
    }

    #[test]
    fn a_loop_that_grows_does_not_forget() {
        let mut of = loops().remove(0);
        of.mu = 1e-3;
        assert!(Decay::of("", &of).is_err());
    }
}
