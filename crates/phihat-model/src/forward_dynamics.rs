//! Joint accelerations from torques.

use crate::{Model, Scalar, Workspace};

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
    /// [ M + J_r | τ − bias ]                                                          (1)
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
        self.place(ws, q);
        self.sweep_out(ws, dq, |_| S::splat(0.0));
        match n {
            0..=3 => self.eliminate::<S, 4>(ws, tau, ddq),
            4..=7 => self.eliminate::<S, 8>(ws, tau, ddq),
            8..=15 => self.eliminate::<S, 16>(ws, tau, ddq),
            _ => self.eliminate::<S, 20>(ws, tau, ddq),
        }
    }

    #[inline(always)]
    fn eliminate<S: Scalar, const L: usize>(
        &self,
        ws: &mut Workspace<S>,
        tau: &[S],
        ddq: &mut [S],
    ) {
        let n = self.joint_count();
        let zero = S::splat(0.0);
        let mut rows = [[zero; L]; L];
        self.sweep_in::<S, L>(ws, Some(n), |joint, end, row| {
            for k in 0..L {
                rows[joint][k] = if k < end { row[k] } else { zero };
            }
            rows[joint][joint] += S::splat(self.armature()[joint]);
            rows[joint][n] = tau[joint] - row[n];
        });
        for k in 0..n {
            let (above, below) = rows.split_at_mut(k + 1);
            let pivot = &mut above[k];
            let inverse = S::splat(1.0) / pivot[k];
            for (offset, row) in below[..n - k - 1].iter_mut().enumerate() {
                let factor = pivot[k + 1 + offset] * inverse;
                for j in 0..L {
                    row[j] -= factor * pivot[j];
                }
            }
            pivot[k] = inverse;
        }
        for k in (0..n).rev() {
            let mut left = rows[k][n];
            for j in k + 1..n {
                left -= rows[k][j] * ddq[j];
            }
            ddq[k] = left * rows[k][k];
        }
    }
}
