//! Looking for the postures at which pushes do most, by a measure that is quick to compute.

use nalgebra::{DMatrix, DVector};
use phihat_certificate::{FrozenPosture, JointRecord, LoopModel};

use super::at_posture::PostureLoops;
use super::find::matrix;
use super::linear::{Linear, Lines};
use super::postures::Postures;

/// Inertia ratios between which the measure is interpolated.
const RATIOS: usize = 14;

/// Postures looked at by the measure, each with every payload.
const SPREAD: u32 = 250;

/// Payloads with which the postures handed over are summed up.
const PAYLOADS: usize = 3;

/// Steps by which a posture is improved \[rad\].
const STEPS: [f64; 4] = [0.3, 0.15, 0.06, 0.02];

/// Multiplications that the sums at all postures together may take: some 0.2 s.
const WORK: f64 = 8e8;

/// Inner products of scalar responses over a grid of inertia ratios: `⟨g_μ, g_ν⟩`.
struct Measure {
    low: f64,
    high: f64,
    /// One matrix for each of [`OUTPUTS`].
    inner: Vec<DMatrix<f64>>,
    root: Vec<f64>,
    /// Multiplications that the sums at one posture take.
    work: f64,
}

/// Measured responses: from torque to `e`, `ė`, `Δτ`, from the encoder to `e`, `Δτ`; places in [`Lines`].
const OUTPUTS: [usize; 5] = [5, 6, 8, 10, 13];

/// Measure of a posture, for every pair of joints in units of `M̄`: one matrix for each of [`OUTPUTS`], and
/// `M^{-1}`.
struct PostureMeasure {
    pairs: Vec<DMatrix<f64>>,
    /// Smallest and largest eigenvalue.
    ends: (f64, f64),
}

impl Postures<'_> {
    /// Postures at which some entry of the coupled gains is large: for every pair of joints the one that does
    /// most, out of many and improved step by step; the lightest and the heaviest; and those handed over,
    /// every one of them.
    ///
    /// # Method
    ///
    /// The measure is the 2-norm of the impulse response from torque to error in place of its 1-norm, from
    /// inner products of scalar responses that are interpolated in μ. It chooses postures; it is no part of
    /// any claim.
    pub fn worst(
        &self,
        loops: &PostureLoops<'_>,
        range: (f64, f64),
        also: &[Vec<f64>],
    ) -> Vec<FrozenPosture> {
        let n = loops.len();
        let mut found: Vec<FrozenPosture> = Vec::new();
        for (k, q) in also.iter().enumerate() {
            let source = format!("posture {} of the reference", k + 1);
            found.extend(self.at(q, &source).into_iter().take(PAYLOADS));
        }
        let Some(measure) = Measure::of(loops, range) else { return found };
        let mut many = self.spread(SPREAD);
        many.extend(found.iter().cloned());
        let seen: Vec<PostureMeasure> = many.iter().map(|p| measure.see(p)).collect();
        let best = |value: &dyn Fn(&PostureMeasure) -> f64| {
            let most = (0..seen.len()).max_by(|a, b| value(&seen[*a]).total_cmp(&value(&seen[*b])));
            &many[most.unwrap_or(0)]
        };
        found.push(best(&|seen| -seen.ends.0).clone());
        found.push(best(&|seen| seen.ends.1).clone());
        let always = found.len();
        let pairs: Vec<(usize, usize)> =
            (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
        for pair in &pairs {
            let value = |seen: &PostureMeasure| seen.pairs[0][*pair];
            found.push(self.improved(best(&value), &|p| value(&measure.see(p))));
        }
        for output in 0..=OUTPUTS.len() {
            found.extend(pairs.iter().map(|pair| best(&|seen| seen.pairs[output][*pair]).clone()));
        }
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a moderate positive number"
        )]
        let most = always.max((WORK / measure.work) as usize);
        let mut distinct: Vec<FrozenPosture> = Vec::with_capacity(most);
        for posture in found {
            if distinct.len() < most && !distinct.contains(&posture) {
                distinct.push(posture);
            }
        }
        distinct
    }

    /// A posture moved joint by joint while a value grows.
    fn improved(
        &self,
        from: &FrozenPosture,
        value: &dyn Fn(&FrozenPosture) -> f64,
    ) -> FrozenPosture {
        let mut best = from.clone();
        let mut most = value(&best);
        for step in STEPS {
            for joint in 0..best.q_rad.len() {
                for step in [step, -step] {
                    let moved = self.moved(&best, joint, step);
                    let now = value(&moved);
                    if now > most {
                        (best, most) = (moved, now);
                        break;
                    }
                }
            }
        }
        best
    }
}

impl Measure {
    /// `None` where the loop is not stable, or the joints' loops differ too much for one measure.
    fn of(loops: &PostureLoops<'_>, (low, high): (f64, f64)) -> Option<Self> {
        let (record, model): &(&JointRecord, &LoopModel) = loops.first()?;
        let record = JointRecord { inertia_kg_m2: 1.0, ..(*record).clone() };
        let last = (RATIOS - 1) as f64;
        let mut samples = 0;
        let response = |k: usize| {
            let mu = low * libm::pow(high / low, k as f64 / last);
            let scalar = Linear::new(&[(&record, model)], &DMatrix::from_element(1, 1, 1.0 / mu));
            let horizon = scalar.horizon()?;
            samples = samples.max(horizon.samples);
            let mut seen: [Vec<f64>; OUTPUTS.len()] = Default::default();
            let _ = scalar.walk(0, (horizon.samples, &horizon), |_, lines: &Lines| {
                for (seen, place) in seen.iter_mut().zip(OUTPUTS) {
                    seen.push(lines[place]);
                }
            });
            Some(seen)
        };
        let all = (0..RATIOS).map(response).collect::<Option<Vec<_>>>()?;
        let n = loops.len() as f64;
        let inner = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let matrix =
            |o: usize| DMatrix::from_fn(RATIOS, RATIOS, |a, b| inner(&all[a][o], &all[b][o]));
        Some(Self {
            low,
            high,
            inner: (0..OUTPUTS.len()).map(matrix).collect(),
            work: samples as f64 * n * (8.0 * n * (n + 1.0) + 200.0),
            root: loops.iter().map(|(r, _)| r.inertia_kg_m2.sqrt()).collect(),
        })
    }

    fn see(&self, posture: &FrozenPosture) -> PostureMeasure {
        let n = self.root.len();
        let mass = matrix(&posture.mass_matrix_kg_m2, n);
        let scaled = DMatrix::from_fn(n, n, |i, j| mass[(i, j)] / (self.root[i] * self.root[j]));
        let eigen = scaled.symmetric_eigen();
        let places: Vec<(usize, f64)> =
            eigen.eigenvalues.iter().map(|mu| self.place(*mu)).collect();
        let between = |of: &DMatrix<f64>| {
            DMatrix::from_fn(n, n, |k, l| {
                let ((a, x), (b, y)) = (places[k], places[l]);
                let row = |a: usize| of[(a, b)] * (1.0 - y) + of[(a, b + 1)] * y;
                row(a) * (1.0 - x) + row(a + 1) * x
            })
        };
        let u = &eigen.eigenvectors;
        let light = |i: usize, j: usize| -> f64 {
            (0..n).map(|k| u[(i, k)] * u[(j, k)] / eigen.eigenvalues[k]).sum::<f64>().abs()
        };
        let lower = |of: &dyn Fn(usize, usize) -> f64| {
            DMatrix::from_fn(n, n, |i, j| if j <= i { of(i, j) } else { 0.0 })
        };
        let square = |of: &DMatrix<f64>| {
            lower(&|i, j| {
                let share = DVector::from_fn(n, |k, _| u[(i, k)] * u[(j, k)]);
                share.dot(&(of * &share))
            })
        };
        let mut pairs: Vec<DMatrix<f64>> =
            self.inner.iter().map(|of| square(&between(of))).collect();
        pairs.push(lower(&light));
        PostureMeasure { pairs, ends: (eigen.eigenvalues.min(), eigen.eigenvalues.max()) }
    }

    /// Between which two ratios of the grid one lies, and how far.
    fn place(&self, mu: f64) -> (usize, f64) {
        let last = (RATIOS - 1) as f64;
        let at = libm::log(mu.clamp(self.low, self.high) / self.low)
            / libm::log(self.high / self.low)
            * last;
        let below = (0..RATIOS - 1).rev().find(|k| *k as f64 <= at).unwrap_or(0);
        (below, at - below as f64)
    }
}
