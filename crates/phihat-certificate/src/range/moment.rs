//! Second moments of bodies, which energy is a sum over.

use phihat_model::Model;

use crate::extremes::larger;

/// Rotation beside translation, row by row: 3 × 4.
pub(super) type Affine = [f64; 12];

/// `∫ [r; 1][r; 1]ᵀ dm` about the origin of a link: second moment, first moment, mass.
pub(super) type MassMoment = [[f64; 4]; 4];

/// Smallest shift of a second moment, over its trace.
const SHIFT: f64 = 1e-14;

/// `D P`.
pub(super) fn action(moment: &MassMoment, d: &Affine) -> Affine {
    let mut out = [0.0; 12];
    for row in 0..3 {
        for column in 0..4 {
            let mut sum = 0.0;
            for inner in 0..4 {
                sum += d[4 * row + inner] * moment[inner][column];
            }
            out[4 * row + column] = sum;
        }
    }
    out
}

/// `tr(A Bᵀ)`.
pub(super) fn inner(a: &Affine, b: &Affine) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Sizes by which errors of the entries of a moment are measured: `√(t_i t_j)` with the trace of the second moment for
/// each of the three axes, and the mass.
pub(super) fn sizes(moment: &MassMoment) -> MassMoment {
    let trace = (0..3).map(|i| moment[i][i].abs()).sum::<f64>();
    let of = |i: usize| if i < 3 { trace } else { moment[3][3].abs() };
    core::array::from_fn(|i| core::array::from_fn(|j| (of(i) * of(j)).sqrt()))
}

/// Moments of all bodies of an arm, and the largest shift of one.
///
/// A moment has to be positive semidefinite: that of a body is, but for rounding; that of a description need not be.
/// The second moment is raised by the first of [`SHIFT`], `10 SHIFT`, … times its trace with which it is.
pub(super) fn moments(model: &Model) -> Option<(Vec<MassMoment>, f64)> {
    let mut most = 0.0;
    let mut all = Vec::new();
    for parameters in model.dynamic_parameters() {
        let moment = raw(&parameters);
        let trace = (0..3).map(|i| moment[i][i].abs()).sum::<f64>();
        let shifts = (0..20).map(|k| SHIFT * libm::pow(10.0, f64::from(k)));
        let raised = |shift: f64| {
            let mut raised = moment;
            (0..3).for_each(|i| raised[i][i] += shift * trace);
            raised
        };
        let shift = shifts.into_iter().find(|shift| is_semidefinite(&raised(*shift)))?;
        most = larger(most, shift);
        all.push(raised(shift));
    }
    Some((all, most))
}

fn raw(&[m, hx, hy, hz, xx, xy, yy, xz, yz, zz]: &[f64; 10]) -> MassMoment {
    let half = 0.5 * (xx + yy + zz);
    [
        [half - xx, -xy, -xz, hx],
        [-xy, half - yy, -yz, hy],
        [-xz, -yz, half - zz, hz],
        [hx, hy, hz, m],
    ]
}

/// `LDLᵀ` without a negative pivot, mass first.
fn is_semidefinite(moment: &MassMoment) -> bool {
    let mut left = *moment;
    for k in (0..4).rev() {
        let pivot = left[k][k];
        if pivot > 0.0 {
            for i in 0..k {
                for j in 0..k {
                    left[i][j] -= left[i][k] * left[k][j] / pivot;
                }
            }
        } else if pivot.is_nan() || pivot < 0.0 || (0..k).any(|i| left[i][k].abs() > 0.0) {
            return false;
        }
    }
    true
}
