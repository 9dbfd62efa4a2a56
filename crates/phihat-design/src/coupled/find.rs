//! Finding coupled gains: the largest of every entry over frozen postures.

use nalgebra::DMatrix;
use phihat_certificate::{CoupledGains, FrozenPosture, JointRecord, LoopModel, Matrix, Refutation};

use super::at_posture::{PostureLoops, inverse, sums};
use super::linear::{OUTPUTS, ResponseSums};
use phihat_certificate::parallel::{parallel, threads};

/// Number of matrices: from torque to `e, ė, ë, Δτ`, from the encoder to `e, ė, Δτ`.
const KINDS: usize = 7;

/// Addition to every entry, as a share of `√(Γ_ii Γ_jj)`: a check by another method must not fail by rounding
/// or by what it cuts.
const MARGIN: f64 = 2e-5;

/// The seven matrices at one posture.
pub(super) type Kinds = [DMatrix<f64>; KINDS];

/// Finding [`CoupledGains`].
pub trait FindCoupledGains: Sized {
    /// Finds coupled gains: the largest of every entry over some postures.
    ///
    /// Those postures that made the largest entry of a row are kept as witnesses.
    /// `source` says in words which postures they are.
    ///
    /// # Errors
    ///
    /// [`Refutation`] where the arm's loop is not stable at one of them.
    fn find(
        loops: &[(&JointRecord, &LoopModel)],
        postures: &[FrozenPosture],
        source: String,
    ) -> Result<Self, Refutation>;
}

impl FindCoupledGains for CoupledGains {
    fn find(
        loops: &PostureLoops<'_>,
        postures: &[FrozenPosture],
        source: String,
    ) -> Result<Self, Refutation> {
        let n = loops.len();
        let mut largest: Kinds = core::array::from_fn(|_| DMatrix::zeros(n, n));
        let mut rows = vec![[(0.0_f64, 0_usize); KINDS]; n];
        let all: Vec<usize> = (0..postures.len()).collect();
        let found = parallel(&all, threads(), |at| {
            at_posture(loops, &matrix(&postures[at].mass_matrix_kg_m2, n))
        });
        for (at, here) in found.into_iter().enumerate() {
            let here = here?;
            for (kind, (most, here)) in largest.iter_mut().zip(&here).enumerate() {
                for i in 0..n {
                    let row = here.row(i).max();
                    if row > rows[i][kind].0 {
                        rows[i][kind] = (row, at);
                    }
                }
                most.zip_apply(here, |most, here| *most = most.max(here));
            }
        }
        let mut kept: Vec<usize> = rows.iter().flatten().map(|(_, at)| *at).collect();
        kept.sort_unstable();
        kept.dedup();
        let [error, velocity, acceleration, step, reading, reading_velocity, reading_step] =
            largest.map(|kind| written(&kind));
        Ok(Self {
            source,
            postures: u32::try_from(postures.len()).unwrap_or(u32::MAX),
            error_rad_per_nm: error,
            velocity_rad_s_per_nm: velocity,
            acceleration_rad_s2_per_nm: acceleration,
            torque_step_nm_per_nm: step,
            encoder_error_rad_per_rad: reading,
            encoder_velocity_per_s: reading_velocity,
            encoder_torque_step_nm_per_rad: reading_step,
            witnesses: kept.iter().filter_map(|at| postures.get(*at)).cloned().collect(),
        })
    }
}

/// The seven matrices for an inertia matrix, at all times: what may be more between the samples is in them.
///
/// # Method
///
/// Between two samples a position differs from the chord by at most `T²/8` times its second derivative, and
/// the sums are linear in that: `‖e‖ ≤ ‖e at samples‖ + T²/8 ‖M^{-1} τ‖`. A velocity is linear there while
/// the torque is held. Behind drives the torque goes from one value to the next, all the same way where the
/// drives are the same, else off the straight one by at most [`off_chord`] of its change; the velocity is off
/// its chord by that over the drive's bandwidth.
pub(super) fn at_posture(
    loops: &PostureLoops<'_>,
    mass: &DMatrix<f64>,
) -> Result<Kinds, Refutation> {
    let n = loops.len();
    let sums = sums(loops, mass)?;
    let inverse = inverse(mass)?;
    let models: Vec<&LoopModel> = loops.iter().map(|(_, model)| *model).collect();
    let period = models.first().map_or(0.0, |model| model.period_s);
    let of = |input: usize, output: usize| {
        DMatrix::from_fn(n, n, |i, j| -> f64 {
            let sums: &ResponseSums = &sums[i][j];
            debug_assert!(output < OUTPUTS);
            sums[input][output]
        })
    };
    let through = |share: &dyn Fn(&LoopModel) -> f64, change: &DMatrix<f64>| {
        DMatrix::from_fn(n, n, |i, k| inverse[(i, k)].abs() * share(models[k])) * change
    };
    let alike = models.windows(2).all(|m| m[0].drive_bandwidth_hz == m[1].drive_bandwidth_hz);
    let off = |model: &LoopModel| if alike { 0.0 } else { off_chord(model) };
    let driven = |model: &LoopModel| {
        model.drive_bandwidth_hz.map_or(0.0, |hz| off_chord(model) / (core::f64::consts::TAU * hz))
    };
    let chord = |input: usize| {
        let change = of(input, 4);
        let acceleration = of(input, 2) + through(&off, &change);
        let error = of(input, 0) + &acceleration * (period * period / 8.0);
        (error, of(input, 1) + through(&driven, &change), acceleration)
    };
    let (error, velocity, held) = chord(0);
    let (reading, reading_velocity, _) = chord(1);
    let acceleration = inverse.abs() + held;
    Ok([error, velocity, acceleration, of(0, 3), reading, reading_velocity, of(1, 3)])
}

/// Largest deviation of a drive's response from 0 to 1 over one interval from the straight line:
/// `max_λ w(λ) − λ`, `w = (1 − e^{−xλ})/(1 − e^{−x})`, `x = ωT`.
fn off_chord(model: &LoopModel) -> f64 {
    model.drive_bandwidth_hz.map_or(0.0, |hz| {
        let x = core::f64::consts::TAU * hz * model.period_s;
        let lost = -libm::expm1(-x);
        let at = -libm::log(lost / x) / x;
        (1.0 - lost / x) / lost - at
    })
}

/// A matrix from its rows; missing entries are not a number, which nothing accepts.
pub(super) fn matrix(rows: &Matrix, n: usize) -> DMatrix<f64> {
    let entry = |i: usize, j: usize| rows.get(i).and_then(|row| row.get(j)).copied();
    DMatrix::from_fn(n, n, |i, j| entry(i, j).unwrap_or(f64::NAN))
}

/// Rows with the margin on top, rounded up to five digits.
fn written(kind: &DMatrix<f64>) -> Matrix {
    let n = kind.nrows();
    let entry = |i: usize, j: usize| {
        let margin = MARGIN * (kind[(i, i)] * kind[(j, j)]).sqrt();
        let value = (kind[(i, j)] + margin) * (1.0 + 6e-5);
        format!("{value:.4e}").parse().unwrap_or(f64::INFINITY)
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}
