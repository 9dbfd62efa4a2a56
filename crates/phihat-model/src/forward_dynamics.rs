//! Joint accelerations from torques.

use crate::columns::LANES;
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
    /// in pivot order; `M ≻ 0` needs no pivoting. By operation counts this is below the
    /// articulated-body algorithm for the 3 to 7 joints of an arm, and several columns share one
    /// vector operation. Its cost grows with n³: beyond about 10 joints the other would win.
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
        assert!(q.len() == n && dq.len() == n, "one position and one velocity per joint");
        assert!(ws.screws.fits(self), "a workspace of this model");
        if self.written_out([q, dq, tau], ddq).is_some() {
            return;
        }
        ws.screws.place(self, q);
        self.sweep_out(ws, dq, |_| S::splat(0.0));
        self.sweep_in(ws, Some(n));
        let chunks = ws.columns.len();
        for (i, row) in ws.rows.chunks_exact_mut(chunks).enumerate() {
            let row = row.as_flattened_mut();
            row[i] += S::splat(self.armature()[i]);
            row[n] -= tau[i];
        }
        eliminate(&mut ws.rows, chunks, ddq);
    }

    /// The same by code written out for this structure, if there is any for this type.
    #[inline]
    fn written_out<S: Scalar>(&self, [q, dq, tau]: [&[S]; 3], ddq: &mut [S]) -> Option<()> {
        let kernel = self.compiled().kernel?;
        let state = [S::as_f64(q)?, S::as_f64(dq)?, S::as_f64(tau)?];
        kernel.alone(self, state, S::as_f64_mut(ddq)?).then_some(())
    }
}

/// Solves (1), of which the upper triangle and `bias − τ` are given, `chunks` vectors a row.
#[inline(always)]
fn eliminate<S: Scalar>(rows: &mut [[S; LANES]], chunks: usize, ddq: &mut [S]) {
    let n = ddq.len();
    for k in 0..n {
        let (above, below) = rows.split_at_mut((k + 1) * chunks);
        let pivot = &above[k * chunks..];
        let entries = &pivot.as_flattened()[k..n];
        let inverse = S::splat(1.0) / entries[0];
        // Where the diagonal's inverse is kept until the end.
        ddq[k] = inverse;
        for (row, entry) in below.chunks_exact_mut(chunks).zip(&entries[1..]) {
            let factor = S::Four::splat(*entry * inverse);
            for (row, pivot) in row.iter_mut().zip(pivot).skip(k / LANES) {
                *row = (S::Four::from_lanes(*row) - factor * S::Four::from_lanes(*pivot)).lanes();
            }
        }
    }
    for (k, row) in rows.chunks_exact(chunks).enumerate().rev() {
        let row = &row.as_flattened()[..=n];
        let mut left = row[n];
        for j in k + 1..n {
            left += row[j] * ddq[j];
        }
        ddq[k] = -(left * ddq[k]);
    }
}
