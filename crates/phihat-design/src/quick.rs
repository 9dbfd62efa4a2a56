//! Estimates of the sampled gains, cheap enough for a search; the certificate proves the real ones.

use nalgebra::{DMatrix, DVector, RowDVector};

use crate::JointRecord;
use crate::sampled::LoopParts;
use crate::sampled::{LoopModel, StateMatrix, left_by_acceleration};

/// Samples after which a response is cut off, should it not have died before.
const LONGEST: usize = 40_000;

/// A response has died when `e` and `ė` each stay below this share of their own largest value …
const DEAD: f64 = 1e-4;

/// … for so many samples.
const QUIET: usize = 64;

/// Peak-to-peak gains at one inertia ratio, in units of `M̄`; a few per mille low.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Quick {
    /// From `φ/M̄` to `∫e`, `e`, `ė`.
    pub(crate) jump: [f64; 3],
    /// From `φ̇/M̄` to the same; `None`: grows without bound.
    pub(crate) ramp: [Option<f64>; 3],
    /// From the encoder's error to `e`, `ė`.
    pub(crate) reading: [f64; 2],
    /// From the reference's acceleration to `e`, `ė`.
    pub(crate) moved: [f64; 2],
    /// From the encoder's error to the change of torque per sample, over `M̄`.
    pub(crate) change: f64,
}

impl Quick {
    /// `None` when a response does not die.
    pub(crate) fn at(law: &JointRecord, model: &LoopModel, mu: f64) -> Option<Self> {
        let matrix = StateMatrix::new(law, model, mu);
        let (unit, period) = (matrix.unit(), model.period_s);
        let (mut jump, mut ramp, mut sums) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        let mut integral = 0.0;
        walk(&matrix, matrix.disturbance(), |x| {
            integral += period * x[0];
            for (i, value) in [integral, x[0], unit * x[1]].into_iter().enumerate() {
                jump[i] += value.abs();
                sums[i] += value;
                ramp[i] += sums[i].abs() * period;
            }
        })?;
        let encoder = matrix.encoder();
        let mut last = encoder.direct;
        let (mut change, mut reading) = (last.abs(), [0.0; 2]);
        walk(&matrix, &encoder.drives, |x| {
            reading[0] += x[0].abs();
            reading[1] += (unit * x[1]).abs();
            let torque = row(&encoder.state, x);
            change += (torque - last).abs();
            last = torque;
        })?;
        let mut moved = [0.0; 2];
        walk(&matrix, &left_by_acceleration(&matrix)?, |x| {
            moved[0] += x[0].abs();
            moved[1] += (unit * x[1]).abs();
        })?;
        let lasting = model.servo_type(law.order()) >= 2;
        let ramp = [lasting.then_some(ramp[0]), Some(ramp[1]), Some(ramp[2])];
        Some(Self { jump, ramp, reading, moved, change })
    }

    /// The larger of each.
    pub(crate) fn worse(self, other: Self) -> Self {
        let larger = |a: [f64; 3], b: [f64; 3]| core::array::from_fn(|i| a[i].max(b[i]));
        let both = |i: usize| self.ramp[i].zip(other.ramp[i]).map(|(a, b)| a.max(b));
        Self {
            jump: larger(self.jump, other.jump),
            ramp: core::array::from_fn(both),
            reading: core::array::from_fn(|i| self.reading[i].max(other.reading[i])),
            moved: core::array::from_fn(|i| self.moved[i].max(other.moved[i])),
            change: self.change.max(other.change),
        }
    }
}

/// A row on a state.
fn row(row: &RowDVector<f64>, x: &[f64]) -> f64 {
    let mut terms = row.iter().zip(x).map(|(own, at)| own * at);
    let first = terms.next().unwrap_or(0.0);
    terms.fold(first, |sum, term| sum + term)
}

/// Shows `b, Ab, A²b, …` until it has died; `None` when it does not.
///
/// Most of a search's time is spent here, so that loops of the usual sizes have a product compiled for
/// theirs; its sums are in the order of the general one, and the bits the same.
fn walk(matrix: &StateMatrix, b: &DVector<f64>, visit: impl FnMut(&[f64])) -> Option<()> {
    let a = matrix.matrix();
    match b.len() {
        4 => fixed::<4>(a, b, visit),
        5 => fixed::<5>(a, b, visit),
        6 => fixed::<6>(a, b, visit),
        7 => fixed::<7>(a, b, visit),
        8 => fixed::<8>(a, b, visit),
        9 => fixed::<9>(a, b, visit),
        10 => fixed::<10>(a, b, visit),
        11 => fixed::<11>(a, b, visit),
        12 => fixed::<12>(a, b, visit),
        _ => general(a, b, visit),
    }
}

fn general(a: &DMatrix<f64>, b: &DVector<f64>, mut visit: impl FnMut(&[f64])) -> Option<()> {
    let (mut x, mut next, mut life) = (b.clone(), b.clone(), Life::default());
    for _ in 0..LONGEST {
        visit(x.as_slice());
        if life.ended(x[0], x[1]) {
            return Some(());
        }
        next.gemv(1.0, a, &x, 0.0);
        core::mem::swap(&mut x, &mut next);
    }
    None
}

/// The same for a state of so many entries.
fn fixed<const N: usize>(
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    mut visit: impl FnMut(&[f64]),
) -> Option<()> {
    let columns: [[f64; N]; N] = core::array::from_fn(|j| core::array::from_fn(|i| a[(i, j)]));
    let (mut x, mut life): ([f64; N], _) = (core::array::from_fn(|i| b[i]), Life::default());
    for _ in 0..LONGEST {
        visit(&x);
        if life.ended(x[0], x[1]) {
            return Some(());
        }
        let mut next: [f64; N] = core::array::from_fn(|i| columns[0][i] * x[0]);
        for (column, at) in columns.iter().zip(&x).skip(1) {
            for (entry, own) in next.iter_mut().zip(column) {
                *entry += own * at;
            }
        }
        x = next;
    }
    None
}

/// Detection of the end of a response.
#[derive(Default)]
struct Life {
    largest: [f64; 2],
    quiet: usize,
}

impl Life {
    /// Takes the next state's `e` and `ė`.
    fn ended(&mut self, e: f64, de: f64) -> bool {
        // Each by itself: a reading's kick to the torque is large and short, what it leaves of `e` small and long.
        let sizes = [e.abs(), de.abs()];
        self.largest = core::array::from_fn(|i| self.largest[i].max(sizes[i]));
        let dead = (0..2).all(|i| sizes[i] < DEAD * self.largest[i]);
        self.quiet = if dead { self.quiet + 1 } else { 0 };
        self.quiet > QUIET
    }
}

#[cfg(test)]
mod tests {
    use super::{Quick, general, row, walk};
    use crate::JointRecord;
    use crate::sampled::{LoopModel, StateMatrix};
    use nalgebra::DVector;
    use phihat::{Form, TorqueSource, VelocitySource};

    fn law(w: f64, a: Vec<f64>) -> JointRecord {
        let name = "joint".to_owned();
        let (kp_per_s2, kd_per_s) = (w * w, 2.0 * w);
        JointRecord { name, inertia_kg_m2: 1.0, kp_per_s2, kd_per_s, a, observer: None }
    }

    fn model(
        velocity: VelocitySource,
        velocity_filter_hz: Option<f64>,
        period_s: f64,
    ) -> LoopModel {
        LoopModel {
            period_s,
            delay_samples: 1,
            sample_delay_samples: 0,
            torque: TorqueSource::Applied,
            velocity,
            velocity_filter_hz,
            torque_filter_hz: None,
            form: Form::Observer,
            drive_bandwidth_hz: None,
        }
    }

    /// An encoder's error to `e`: the sum of the whole response.
    fn whole(law: &JointRecord, model: &LoopModel, mu: f64) -> f64 {
        let matrix = StateMatrix::new(law, model, mu);
        let mut x = matrix.encoder().drives.clone();
        let mut sum = 0.0;
        // The slowest loop here forgets within 0.4 s: in 40 s nothing is left.
        for _ in 0..80_000 {
            sum += x[0].abs();
            x = matrix.matrix() * &x;
        }
        assert!(x.amax() < 1e-12, "still alive");
        sum
    }

    /// Loops of every size that a study can have: the bits of the general product.
    #[test]
    fn a_product_for_one_size_has_the_bits_of_the_general_one() {
        let mut sizes = Vec::new();
        for (k, (delay, filter)) in
            [(0, None), (0, Some(80.0)), (1, None), (1, Some(80.0)), (2, None), (4, Some(80.0))]
                .into_iter()
                .enumerate()
        {
            for a in [vec![60.0], vec![1600.0, 80.0], vec![8000.0, 1200.0, 60.0]] {
                let law = law(15.0, a);
                let model = LoopModel {
                    delay_samples: delay,
                    ..model(VelocitySource::Differenced, filter, 1e-3)
                };
                let matrix = StateMatrix::new(&law, &model, 0.8 + 0.1 * k as f64);
                let b = matrix.encoder().drives.clone();
                let (mut one, mut other) = (Vec::new(), Vec::new());
                let mut torque = Vec::new();
                let ends = [
                    walk(&matrix, &b, |x| one.extend(x.iter().map(|x| x.to_bits()))),
                    general(matrix.matrix(), &b, |x| {
                        other.extend(x.iter().map(|x| x.to_bits()));
                        let whole = &matrix.encoder().state * DVector::from_column_slice(x);
                        torque
                            .push((whole[0].to_bits(), row(&matrix.encoder().state, x).to_bits()));
                    }),
                ];
                assert_eq!(ends[0], ends[1]);
                assert!(one == other && torque.iter().all(|(a, b)| a == b), "{}", b.len());
                sizes.push(b.len());
            }
        }
        sizes.sort_unstable();
        sizes.dedup();
        assert!(sizes.len() >= 4, "{sizes:?}");
    }

    #[test]
    fn what_an_encoder_does_to_the_error_is_not_cut_off() {
        let mut worst = 0.0_f64;
        for (k, w) in [4.0_f64, 10.0, 30.0].into_iter().enumerate() {
            for velocity in [VelocitySource::Measured, VelocitySource::Differenced] {
                for (velocity_filter_hz, period_s) in [(None, 1e-3), (Some(160.0), 5e-4)] {
                    let a = [vec![0.7 * w], vec![w * w, 2.0 * w]][k % 2].clone();
                    let (law, model) = (law(w, a), model(velocity, velocity_filter_hz, period_s));
                    for mu in [0.3, 1.0] {
                        let Some(quick) = Quick::at(&law, &model, mu) else { continue };
                        let whole = whole(&law, &model, mu);
                        assert!(quick.reading[0] <= whole * (1.0 + 1e-9), "more than there is");
                        worst = worst.max(whole / quick.reading[0]);
                    }
                }
            }
        }
        assert!(worst < 1.02, "{worst} times what was estimated");
    }
}
