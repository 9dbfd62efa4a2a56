//! Peak-to-peak gains of the sampled loop: how large an error a bounded `φ` can make.

use nalgebra::{DMatrix, DVector};
pub use phihat_certificate::SampledPeaks;

use super::model::LoopModel;
use super::model::LoopParts;
use super::refutation::{plausible, plausible_loop, plausible_ratios, refuse};
use super::response::{Horizon, ratios, sweep};
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::claims::Refutation;

const CLAIM: &str = "sampled peak gains";

/// Finding [`SampledPeaks`].
pub trait FindSampledPeaks: Sized {
    /// Computes the peaks at `count` inertia ratios from `low` to `high`.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable at one of them.
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        range: (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation>;

    /// Computes the peaks at one inertia ratio.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable there.
    fn at(gains: &JointRecord, model: &LoopModel, mu: f64) -> Result<Self, Refutation>;
}

impl FindSampledPeaks for SampledPeaks {
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
        count: u32,
    ) -> Result<Self, Refutation> {
        over(gains, model, ratios(low, high, count).collect())
    }

    fn at(gains: &JointRecord, model: &LoopModel, mu: f64) -> Result<Self, Refutation> {
        over(gains, model, vec![mu])
    }
}

fn over(gains: &JointRecord, model: &LoopModel, mu: Vec<f64>) -> Result<SampledPeaks, Refutation> {
    plausible(CLAIM, gains)?;
    plausible_loop(CLAIM, model)?;
    plausible_ratios(CLAIM, &mu)?;
    let none = [Some(0.0); 3];
    let mut worst = SampledPeaks { mu: Vec::new(), jump: [0.0; 3], ramp: none, bend: none };
    for mu in &mu {
        let matrix = StateMatrix::new(gains, model, *mu);
        let one = Norms::new(&matrix, model, gains.order())?;
        for i in 0..3 {
            worst.bend[i] = worst.bend[i].zip(one.bend[i]).map(|(a, b)| a.max(b));
            worst.jump[i] = worst.jump[i].max(one.jump[i]);
            worst.ramp[i] = worst.ramp[i].zip(one.ramp[i]).map(|(a, b)| a.max(b));
        }
    }
    Ok(SampledPeaks { mu, ..worst })
}

/// The norms at one inertia ratio.
struct Norms {
    jump: [f64; 3],
    ramp: [Option<f64>; 3],
    bend: [Option<f64>; 3],
}

impl Norms {
    fn new(matrix: &StateMatrix, model: &LoopModel, order: usize) -> Result<Self, Refutation> {
        let servo_type = model.servo_type(order);
        let a = matrix.matrix();
        let n = a.nrows();
        let unstable = || refuse(CLAIM, "A^k → 0 (stable loop), μ", matrix.mu(), 1.0);
        let horizon = Horizon::of(a).ok_or_else(unstable)?;
        let back = (DMatrix::identity(n, n) - a).transpose().lu();
        // c → −c (I − A)⁻¹: minus all that is still to come.
        let rest = |c: &DVector<f64>| back.solve(&-c).ok_or_else(unstable);
        let mut position = DVector::zeros(n);
        position[0] = 1.0;
        let mut velocity = DVector::zeros(n);
        velocity[1] = matrix.unit();
        let later = rest(&position)?;
        let integral = a.tr_mul(&later) * matrix.period();
        let mut ramp = [None, Some(later), Some(rest(&velocity)?)];
        if servo_type >= 2 {
            ramp[0] = Some(rest(&integral)?);
        }
        let norms = PeakSums { matrix, horizon };
        // The loop's answer to a ramp dies out where it is of a type high enough; the velocity's at the
        // samples, where the torque is held too.
        let dies = [servo_type >= 3, servo_type >= 2, model.drive_bandwidth_hz.is_none()];
        let period = matrix.period();
        let mut bend = [None; 3];
        for i in 0..3 {
            if let (true, Some(row)) = (dies[i], &ramp[i]) {
                bend[i] = Some(norms.held(&rest(&a.tr_mul(row))?, period * period));
            }
        }
        let rows = [integral, position, velocity];
        let [integral, position, velocity] = rows;
        let jump = [norms.held(&integral, 1.0), norms.jump(&position), norms.jump(&velocity)];
        let [integral, position, velocity] = ramp;
        let ramp = [
            integral.map(|later| norms.held(&later, matrix.period())),
            position.map(|later| norms.ramp(&later)),
            velocity.map(|later| norms.ramp(&later)),
        ];
        Ok(Self { jump, ramp, bend })
    }
}

/// Sums of absolute integrals over one interval after the other.
struct PeakSums<'a> {
    matrix: &'a StateMatrix,
    horizon: Horizon,
}

impl PeakSums<'_> {
    /// Response of a row, by its entries of position and velocity, to impulses at the interval's start and at its end.
    fn impulses(&self, position: f64, velocity: f64) -> (f64, f64) {
        let end = -velocity / (self.matrix.unit() * self.matrix.mu());
        (end - self.matrix.period() * position / self.matrix.mu(), end)
    }

    /// `Σ_j |c A^j b|`, `b` held over the interval, times a factor.
    fn held(&self, row: &DVector<f64>, factor: f64) -> f64 {
        let held = self.matrix.disturbance();
        let mut total = 0.0;
        let a = self.matrix.matrix();
        let rows = sweep(a, row, self.horizon, |row, _| total += row.dot(held).abs());
        factor * (total + self.horizon.tail(rows, held.amax()))
    }

    /// `Σ_j ∫_0^T |c A^j b(s)| ds`.
    fn jump(&self, row: &DVector<f64>) -> f64 {
        let period = self.matrix.period();
        let mut total = 0.0;
        let rows = sweep(self.matrix.matrix(), row, self.horizon, |row, _| {
            let (start, end) = self.impulses(row[0], row[1]);
            total += period * mean_of_line(start, end);
        });
        total + self.horizon.tail(rows, period * self.largest_impulse())
    }

    /// The same for `φ̇`, from the row `r = −c (I − A)⁻¹`: the loop's answer to a step of `φ` dies out, so what
    /// came until now is minus what is to come, and `c A^j = r A^{j+1} − r A^j`.
    fn ramp(&self, row: &DVector<f64>) -> f64 {
        let period = self.matrix.period();
        let held = self.matrix.disturbance();
        let a = self.matrix.matrix();
        let mut total = 0.0;
        let rows = sweep(a, row, self.horizon, |row, next| {
            let (start, end) = self.impulses(next[0] - row[0], next[1] - row[1]);
            let late = row.dot(held);
            // Step of φ in mid-interval and at its start: integrals of the linear impulse response.
            let middle = late + period * (3.0 * end + start) / 8.0;
            let early = late + period * (end + start) / 2.0;
            total += period * mean_of_parabola(early, middle, late);
        });
        let size = held.amax() + period * self.largest_impulse();
        total + self.horizon.tail(2.0 * rows, period * size)
    }

    fn largest_impulse(&self) -> f64 {
        (1.0 / self.matrix.unit()).max(self.matrix.period()) / self.matrix.mu()
    }
}

/// Mean of `|·|` along a line from `a` to `b`.
pub(crate) fn mean_of_line(a: f64, b: f64) -> f64 {
    if a * b >= 0.0 { 0.5 * (a + b).abs() } else { (a * a + b * b) / (2.0 * (a.abs() + b.abs())) }
}

/// Mean of `|·|` along a parabola, by Simpson; at most the largest of the three where it changes sign.
pub(super) fn mean_of_parabola(a: f64, middle: f64, b: f64) -> f64 {
    if a * middle > 0.0 && middle * b > 0.0 {
        (a + 4.0 * middle + b).abs() / 6.0
    } else {
        a.abs().max(middle.abs()).max(b.abs())
    }
}
