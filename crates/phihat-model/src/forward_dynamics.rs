//! Joint accelerations from torques.

use crate::columns::{LANES, unit};
use crate::{Four, Model, Scalar, Workspace};

impl Model {
    /// Gives the accelerations that `tau` causes: `q̈ = (M(q) + J_r)⁻¹ (τ − C(q, q̇) q̇ − g(q))`,
    /// with `J_r` the armature.
    ///
    /// # Method
    ///
    /// One sweep from base to tips (motion and bias wrenches), one back (composite inertias, the
    /// columns of `M` and, as one more column, the bias), then elimination of
    ///
    /// ```text
    /// [ M + J_r | bias − τ ]                                                          (1)
    /// ```
    ///
    /// in pivot order; `M ≻ 0` needs no pivoting. For the 3 to 8 joints of an arm this takes fewer
    /// operations, and more of them side by side, than the articulated-body algorithm; that one
    /// would win beyond about 10 joints.
    ///
    /// # Panics
    ///
    /// If a slice is not of length [`joint_count`](Self::joint_count).
    ///
    /// # References
    ///
    /// M. W. Walker, D. E. Orin, "Efficient dynamic computer simulation of robotic mechanisms",
    /// J. Dyn. Sys. Meas. Control 104, 1982 (method 3). R. Featherstone, *Rigid Body Dynamics
    /// Algorithms*, Springer 2008, chapter 6 and section 10.3.
    pub fn forward_dynamics<S: Scalar>(
        &self,
        ws: &mut Workspace<S>,
        q: &[S],
        dq: &[S],
        tau: &[S],
        ddq: &mut [S],
    ) {
        let n = self.joint_count();
        assert!(tau.len() == n && ddq.len() == n, "one torque and one acceleration per joint");
        ws.screws.place(self, q);
        self.sweep_out(ws, dq, |_| S::splat(0.0));
        self.sweep_in(ws, Some(n));
        let chunks = ws.columns.len();
        for (i, row) in ws.rows.chunks_exact_mut(chunks).enumerate() {
            let armature = S::Four::splat(S::splat(self.armature()[i]));
            row[i / LANES] = row[i / LANES] + unit::<S>(i) * armature;
            row[n / LANES] = row[n / LANES] - unit::<S>(n) * S::Four::splat(tau[i]);
        }
        eliminate::<S>(&mut ws.rows, chunks, ddq);
    }
}

/// Solves (1), of which the upper triangle and `bias − τ` are given, `chunks` vectors a row.
#[inline(always)]
fn eliminate<S: Scalar>(rows: &mut [S::Four], chunks: usize, ddq: &mut [S]) {
    let n = ddq.len();
    let lane = |row: &[S::Four], k: usize| row[k / LANES].lanes()[k % LANES];
    for k in 0..n {
        let (above, below) = rows.split_at_mut((k + 1) * chunks);
        let pivot = &above[k * chunks..];
        let inverse = S::splat(1.0) / lane(pivot, k);
        // Where the diagonal's inverse is kept until the end.
        ddq[k] = inverse;
        for (i, row) in below.chunks_exact_mut(chunks).enumerate() {
            let factor = S::Four::splat(lane(pivot, k + 1 + i) * inverse);
            for (row, pivot) in row.iter_mut().zip(pivot).skip(k / LANES) {
                *row = *row - factor * *pivot;
            }
        }
    }
    for (k, row) in rows.chunks_exact(chunks).enumerate().rev() {
        let mut left = lane(row, n);
        for j in k + 1..n {
            left += lane(row, j) * ddq[j];
        }
        ddq[k] = -(left * ddq[k]);
    }
}
