//! Checking coupled gains by a second method: the loop played at the postures that the document keeps.

use core::f64::consts::TAU;

use super::document::{CoupledGains, FrozenPosture};
use super::played::{OUTPUTS, PlayedRuns};
use crate::extremes::Extremes as _;
use crate::parallel::shared;
use crate::{JointRecord, LoopModel, Matrix, Refutation};

const CLAIM: &str = "coupled gains";

/// Samples after which a run is looked at.
const BLOCK: usize = 64;

/// Longest run \[samples\].
const LONGEST: usize = 1 << 21;

/// Largest part of a gain that a check may leave out, as a share of `√(Γ_ii Γ_jj)`.
const CUT: f64 = 1e-5;

/// The largest entry of a row is one that a witness reaches, to this share.
const REACHED: f64 = 0.97;

/// `[output][i][j]` from torque, then from the encoder.
type GainSums = [[Matrix; OUTPUTS]; 2];

impl CoupledGains {
    /// Plays every witness posture: no entry may be smaller than the played one, and the largest of each row
    /// must be reached.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the matrix and the entry.
    pub fn verify(&self, loops: &[(&JointRecord, &LoopModel)]) -> Result<(), Refutation> {
        let n = loops.len();
        self.shape(n)?;
        let mut reached = vec![vec![0.0_f64; n]; self.matrices().len()];
        let all = shared(self.witnesses.len(), |at| played(loops, &self.witnesses[at]));
        for (witness, found) in self.witnesses.iter().zip(all) {
            let found = found.map_err(|why| why.on(&witness.source))?;
            for (kind, ((name, claimed), found)) in self.matrices().iter().zip(&found).enumerate() {
                for i in 0..n {
                    for j in 0..n {
                        let inequality = format!("Γ[{}][{}] ({name}) ≤ claimed", i + 1, j + 1);
                        at_most(&inequality, found[i][j], claimed[i][j])
                            .map_err(|why| why.on(&witness.source))?;
                    }
                    reached[kind][i] = reached[kind][i].max(largest(&found[i]));
                }
            }
        }
        for ((name, claimed), reached) in self.matrices().iter().zip(&reached) {
            for i in 0..n {
                let inequality = format!("the largest of row {} ({name}) is reached", i + 1);
                at_most(&inequality, REACHED * largest(&claimed[i]), reached[i])?;
            }
        }
        Ok(())
    }

    /// Square matrices of the arm's size, finite numbers, at least one witness.
    fn shape(&self, n: usize) -> Result<(), Refutation> {
        at_most("1 ≤ joints", 1.0, n as f64)?;
        at_most("1 ≤ witnesses", 1.0, self.witnesses.len() as f64)?;
        at_most("witnesses ≤ postures", self.witnesses.len() as f64, f64::from(self.postures))?;
        for witness in &self.witnesses {
            let sized = witness.q_rad.len() == n && witness.q_rad.iter().all(|q| q.is_finite());
            let told = sized && !witness.source.trim().is_empty();
            let inequality = "a witness is a posture of the arm, and says where it comes from";
            at_most(inequality, if told { 0.0 } else { 1.0 }, 0.0)?;
        }
        for (name, matrix) in self.matrices() {
            let square = matrix.len() == n && matrix.iter().all(|row| row.len() == n);
            let inequality = format!("{name} is a matrix with one row and column per joint");
            at_most(&inequality, if square { 0.0 } else { 1.0 }, 0.0)?;
            for entry in matrix.iter().flatten() {
                let fine = entry.is_finite() && *entry >= 0.0;
                at_most(&format!("0 ≤ {name} < ∞"), if fine { 0.0 } else { 1.0 }, 0.0)?;
            }
        }
        Ok(())
    }
}

/// The seven matrices at a posture, in the order of [`CoupledGains::matrices`].
fn played(
    loops: &[(&JointRecord, &LoopModel)],
    posture: &FrozenPosture,
) -> Result<[Matrix; 7], Refutation> {
    let n = loops.len();
    let period = loops.first().map_or(0.0, |(_, model)| model.period_s);
    let inverse = inverse(&posture.mass_matrix_kg_m2, n)?;
    let [torque, encoder] = sums(loops, &inverse, period)?;
    // Between the samples: off the chord by T²/8 times the acceleration; drives bend velocity and torque.
    let first = loops.first().and_then(|(_, model)| model.drive_bandwidth_hz);
    let alike = loops.iter().all(|(_, model)| model.drive_bandwidth_hz == first);
    let bend = |sums: &[Matrix; OUTPUTS], share: &dyn Fn(&LoopModel) -> f64, i: usize, j: usize| {
        let through = |k: usize| inverse[i][k].abs() * share(loops[k].1) * sums[4][k][j];
        (0..n).map(through).sum::<f64>()
    };
    let off = |model: &LoopModel| if alike { 0.0 } else { off_chord(model) };
    // ∫_0^λ (way − its mean) is largest where the way crosses its mean: the same place, and 1/x of the same distance.
    let driven = |model: &LoopModel| {
        model.drive_bandwidth_hz.map_or(0.0, |hz| off_chord(model) / (TAU * hz))
    };
    let each = |entry: &dyn Fn(usize, usize) -> f64| -> Matrix {
        (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
    };
    let held = |s: &[Matrix; OUTPUTS], i: usize, j: usize| s[2][i][j] + bend(s, &off, i, j);
    let error =
        |s: &[Matrix; OUTPUTS]| each(&|i, j| s[0][i][j] + period * period / 8.0 * held(s, i, j));
    let velocity = |s: &[Matrix; OUTPUTS]| each(&|i, j| s[1][i][j] + bend(s, &driven, i, j));
    let acceleration = each(&|i, j| inverse[i][j].abs() + held(&torque, i, j));
    let (error_by_torque, velocity_by_torque) = (error(&torque), velocity(&torque));
    let (error_by_encoder, velocity_by_encoder) = (error(&encoder), velocity(&encoder));
    let [_, _, _, step, _] = torque;
    let [_, _, _, encoder_step, _] = encoder;
    Ok([
        error_by_torque,
        velocity_by_torque,
        acceleration,
        step,
        error_by_encoder,
        velocity_by_encoder,
        encoder_step,
    ])
}

/// Sums of absolute responses with what is cut on top; the last two outputs as changes from sample to sample.
fn sums(
    loops: &[(&JointRecord, &LoopModel)],
    inverse: &[Vec<f64>],
    period: f64,
) -> Result<GainSums, Refutation> {
    let n = loops.len();
    let (after, left) = forgets(loops, inverse)?;
    let zero = || vec![vec![0.0; n]; n];
    let mut sums: GainSums = core::array::from_fn(|_| core::array::from_fn(|_| zero()));
    // Runs: kicks at the end of an interval, at its start, encoders.
    let mut played = PlayedRuns::new(loops, inverse, 3 * n);
    for j in 0..n {
        played.misread(2 * n + j, j);
    }
    // The encoder's error is read at a sample; torques act between the samples, and are first seen at the next one.
    let mut before = vec![vec![[0.0; OUTPUTS]; 3 * n]; n];
    let mut now = before.clone();
    for sample in 0..LONGEST {
        if sample == 1 {
            for j in 0..n {
                played.kick(j, j, 0.0);
                played.kick(n + j, j, period);
            }
        }
        let cut = (sample % BLOCK == BLOCK - 1).then(|| {
            let size = |run: usize| played.size(run) / (1.0 - left);
            let torque = |j: usize| period * size(j).max(size(n + j));
            let encoder = |j: usize| size(2 * n + j);
            let runs: [Vec<f64>; 2] = [(0..n).map(torque).collect(), (0..n).map(encoder).collect()];
            runs
        });
        played.step(|i, run, outputs| {
            now[i][run] = *outputs;
            for o in 3..OUTPUTS {
                now[i][run][o] -= before[i][run][o];
            }
            before[i][run] = *outputs;
        });
        for i in 0..n {
            for j in 0..n {
                for o in 0..OUTPUTS {
                    let (end, start) = (now[i][j][o], now[i][n + j][o]);
                    sums[0][o][i][j] += period * absolute_mean(end, start);
                    sums[1][o][i][j] += now[i][2 * n + j][o].abs();
                }
            }
        }
        // What came until now includes this sample; the bound starts at it.
        if let Some(sizes) = cut
            && add_cut(&mut sums, &after, &sizes)
        {
            return Ok(sums);
        }
    }
    Err(refuse("the loop has forgotten a kick after 2^21 samples", 1.0, 0.0))
}

/// Adds what is left, where it is small enough for all entries.
fn add_cut(sums: &mut GainSums, after: &[[f64; OUTPUTS]], sizes: &[Vec<f64>; 2]) -> bool {
    let n = after.len();
    let left = |input: usize, o: usize, i: usize, j: usize| {
        let twice = if o < 3 { 1.0 } else { 2.0 };
        twice * after[i][o] * sizes[input][j]
    };
    for input in 0..2 {
        for o in 0..OUTPUTS {
            let own = |i: usize| sums[input][o][i][i];
            let small = |i: usize, j: usize| left(input, o, i, j) <= CUT * (own(i) * own(j)).sqrt();
            if !(0..n).all(|i| (0..n).all(|j| small(i, j))) {
                return false;
            }
        }
    }
    for input in 0..2 {
        for o in 0..OUTPUTS {
            for i in 0..n {
                for j in 0..n {
                    sums[input][o][i][j] += left(input, o, i, j);
                }
            }
        }
    }
    true
}

/// Sum of each joint's absolute outputs, from any state of size 1 until the state is less than half of it,
/// and the size that is left.
fn forgets(
    loops: &[(&JointRecord, &LoopModel)],
    inverse: &[Vec<f64>],
) -> Result<(Vec<[f64; OUTPUTS]>, f64), Refutation> {
    let length = PlayedRuns::new(loops, inverse, 0).length();
    let mut played = PlayedRuns::new(loops, inverse, length);
    played.start_everywhere();
    let mut sums = vec![[0.0; OUTPUTS]; loops.len()];
    for sample in 1..=LONGEST {
        played.step(|i, _, outputs| {
            for (sum, output) in sums[i].iter_mut().zip(outputs) {
                *sum += output.abs();
            }
        });
        if sample % BLOCK == 0 {
            let left = played.norm();
            if left < 0.5 {
                return Ok((sums, left));
            }
            if !left.is_finite() || left > 1e12 {
                break;
            }
        }
    }
    Err(refuse("A^k → 0 (stable loop)", 1.0, 0.0))
}

/// `M^{-1}` by Cholesky's factors.
pub(crate) fn inverse(mass: &Matrix, n: usize) -> Result<Matrix, Refutation> {
    let square = mass.len() == n && mass.iter().all(|row| row.len() == n);
    at_most("M(q) has one row and column per joint", if square { 0.0 } else { 1.0 }, 0.0)?;
    let mut factor = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let (lower, upper) = (mass[i][j], mass[j][i]);
            let size = (mass[i][i] * mass[j][j]).abs().sqrt();
            at_most("M(q) is symmetric", (lower - upper).abs(), 1e-9 * size)?;
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = lower - known;
            if i == j {
                at_most("M(q) is positive definite", f64::MIN_POSITIVE, rest)?;
                factor[i][i] = rest.sqrt();
            } else {
                factor[i][j] = rest / factor[j][j];
            }
        }
    }
    let column = |j: usize| {
        let mut x = vec![0.0; n];
        for i in 0..n {
            let known: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
            x[i] = (if i == j { 1.0 } else { 0.0 } - known) / factor[i][i];
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|k| factor[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / factor[i][i];
        }
        x
    };
    Ok((0..n).map(column).collect())
}

/// `∫_0^1 |a + (b − a) x| dx`.
fn absolute_mean(a: f64, b: f64) -> f64 {
    if a * b >= 0.0 {
        return 0.5 * (a + b).abs();
    }
    // Two triangles, cut at the zero.
    let zero = a / (a - b);
    0.5 * (zero * a.abs() + (1.0 - zero) * b.abs())
}

/// `max_λ (1 − e^{−xλ})/(1 − e^{−x}) − λ`, `x = ωT`: largest distance of a drive's torque from the chord of a
/// step.
fn off_chord(model: &LoopModel) -> f64 {
    let Some(hz) = model.drive_bandwidth_hz else { return 0.0 };
    let x = TAU * hz * model.period_s;
    let whole = 1.0 - libm::exp(-x);
    let at = libm::log(x / whole) / x;
    (1.0 - libm::exp(-x * at)) / whole - at
}

fn largest(row: &[f64]) -> f64 {
    row.iter().copied().largest()
}

fn at_most(inequality: &str, left: f64, right: f64) -> Result<(), Refutation> {
    if left <= right { Ok(()) } else { Err(refuse(inequality, left, right)) }
}

fn refuse(inequality: &str, left: f64, right: f64) -> Refutation {
    Refutation { claim: CLAIM.to_owned(), inequality: inequality.to_owned(), left, right }
}

#[cfg(test)]
mod tests {
    use super::{absolute_mean, inverse, off_chord};
    use crate::LoopModel;
    use crate::check::tests::plain;
    use crate::extremes::Extremes as _;

    #[test]
    fn a_line_s_mean_size_is_its_area() {
        let same = |own: f64, want: f64| (own - want).abs() < 1e-15;
        assert!(same(absolute_mean(1.0, 3.0), 2.0) && same(absolute_mean(-1.0, -3.0), 2.0));
        // Triangles of 3/4 · 3/2 and 1/4 · 1/2.
        assert!(same(absolute_mean(3.0, -1.0), 1.25) && same(absolute_mean(-1.0, 3.0), 1.25));
        assert!(same(absolute_mean(0.0, -2.0), 1.0) && same(absolute_mean(0.0, 0.0), 0.0));
    }

    #[test]
    fn a_drive_is_off_its_chord_by_what_a_search_finds() {
        let model = |hz| LoopModel { drive_bandwidth_hz: hz, ..plain() };
        for hz in [5.0, 150.0, 900.0] {
            let x = core::f64::consts::TAU * hz * 1e-3;
            let way = |s: f64| (1.0 - (-x * s).exp()) / (1.0 - (-x).exp()) - s;
            let most = (0..=10_000).map(|k| way(f64::from(k) / 1e4)).largest();
            assert!((off_chord(&model(Some(hz))) - most).abs() < 1e-7, "{hz}");
        }
        assert!(off_chord(&model(None)).abs() < 1e-300);
    }

    #[test]
    fn an_inertia_is_inverted_where_it_is_one() -> Result<(), crate::Refutation> {
        let full = vec![vec![2.0, 0.7, 0.2], vec![0.7, 0.9, 0.15], vec![0.2, 0.15, 0.1]];
        let own = inverse(&full, 3)?;
        for i in 0..3 {
            for j in 0..3 {
                let entry: f64 = (0..3).map(|k| own[i][k] * full[k][j]).sum();
                let unit = f64::from(u8::from(i == j));
                assert!((entry - unit).abs() < 1e-13, "{i} {j}");
            }
        }
        let two = |m: [f64; 4]| inverse(&vec![vec![m[0], m[1]], vec![m[2], m[3]]], 2);
        assert!(two([4.0, 1.0, 1.0, 1.0]).is_ok());
        let told = |m: [f64; 4]| two(m).err().map(|why| why.inequality);
        let uneven = told([4.0, 1.0, 1.0 + 1e-8, 1.0]);
        assert_eq!(uneven.as_deref(), Some("M(q) is symmetric"));
        for edge in [1.0, -1.0] {
            assert!(two([4.0, edge * (2.0 - 1e-9), edge * (2.0 - 1e-9), 1.0]).is_ok());
            let beyond = told([4.0, edge * (2.0 + 1e-9), edge * (2.0 + 1e-9), 1.0]);
            assert_eq!(beyond.as_deref(), Some("M(q) is positive definite"));
        }
        assert!(two([-4.0, 0.0, 0.0, 1.0]).is_err() && two([4.0, 0.0, 0.0, 0.0]).is_err());
        assert!(inverse(&full, 2).is_err() && inverse(&vec![vec![1.0, 0.0]], 1).is_err());
        Ok(())
    }
}
