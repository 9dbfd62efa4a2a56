//! Inertia, its derivatives and the gradient of gravity at a posture.

use nalgebra::DMatrix;
use phihat_model::{Model, Workspace};

/// Step of central differences \[rad, m\]: rounding and cut are both below 1e-8 of the size.
const STEP: f64 = 1e-4;

/// Step of differences of differences \[rad, m\].
const WIDE_STEP: f64 = 1e-3;

/// A posture's matrices, row by row.
#[derive(Debug, Clone)]
pub(super) struct Slopes {
    pub(super) n: usize,
    /// `M` \[kg·m²\].
    pub(super) mass: Vec<f64>,
    /// `∂M/∂q_c`, one matrix for each `c`.
    pub(super) dm: Vec<Vec<f64>>,
    /// `∂g/∂q` \[N·m/rad\].
    pub(super) gravity: Vec<f64>,
}

impl Slopes {
    /// By central differences of the mass matrix and of gravity's torque.
    pub(super) fn at(model: &Model, room: &mut Workspace<f64>, q: &[f64]) -> Self {
        Self::with(model, room, q, STEP)
    }

    fn with(model: &Model, room: &mut Workspace<f64>, q: &[f64], step: f64) -> Self {
        let n = q.len();
        let mut mass = vec![0.0; n * n];
        model.mass_matrix(room, q, &mut mass);
        let (mut dm, mut gravity) = (Vec::with_capacity(n), vec![0.0; n * n]);
        let mut at = q.to_vec();
        let (mut more, mut less) = (vec![0.0; n * n], vec![0.0; n * n]);
        let (mut up, mut down, rest) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for c in 0..n {
            at[c] = q[c] + step;
            model.mass_matrix(room, &at, &mut more);
            model.bias(room, &at, &rest, &mut up);
            at[c] = q[c] - step;
            model.mass_matrix(room, &at, &mut less);
            model.bias(room, &at, &rest, &mut down);
            at[c] = q[c];
            dm.push(more.iter().zip(&less).map(|(a, b)| (a - b) / (2.0 * step)).collect());
            for i in 0..n {
                gravity[i * n + c] = (up[i] - down[i]) / (2.0 * step);
            }
        }
        Self { n, mass, dm, gravity }
    }

    /// `M^{-1}`; `None`: not positive definite.
    pub(super) fn inverse(&self) -> Option<DMatrix<f64>> {
        let mass = DMatrix::from_row_slice(self.n, self.n, &self.mass);
        Some(mass.cholesky()?.inverse())
    }

    /// `D_c = ∂²ID/∂q̇_c∂q̇` by Christoffel's symbols: `∂_c M_ij + ∂_j M_ic − ∂_i M_cj`.
    pub(super) fn coriolis(&self, c: usize) -> Vec<f64> {
        let n = self.n;
        let entry = |k: usize| {
            let (i, j) = (k / n, k % n);
            self.dm[c][k] + self.dm[j][i * n + c] - self.dm[i][c * n + j]
        };
        (0..n * n).map(entry).collect()
    }
}

/// Derivatives along one more joint of everything in [`Slopes`], but for the mass matrix itself.
#[derive(Debug, Clone)]
pub(super) struct Bends {
    /// `∂_b ∂_c M`, entry `c` of the list at `b`.
    pub(super) ddm: Vec<Vec<Vec<f64>>>,
    /// `∂_b D_c`.
    pub(super) coriolis: Vec<Vec<Vec<f64>>>,
    /// `∂_b ∂g/∂q`.
    pub(super) gravity: Vec<Vec<f64>>,
}

impl Bends {
    /// By central differences of [`Slopes`].
    pub(super) fn at(model: &Model, room: &mut Workspace<f64>, q: &[f64]) -> Self {
        let n = q.len();
        let mut at = q.to_vec();
        let mut bends = Self { ddm: Vec::new(), coriolis: Vec::new(), gravity: Vec::new() };
        let over = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * WIDE_STEP)).collect()
        };
        for b in 0..n {
            at[b] = q[b] + WIDE_STEP;
            let more = Slopes::with(model, room, &at, WIDE_STEP);
            at[b] = q[b] - WIDE_STEP;
            let less = Slopes::with(model, room, &at, WIDE_STEP);
            at[b] = q[b];
            bends.ddm.push((0..n).map(|c| over(&more.dm[c], &less.dm[c])).collect());
            let both = |c: usize| over(&more.coriolis(c), &less.coriolis(c));
            bends.coriolis.push((0..n).map(both).collect());
            bends.gravity.push(over(&more.gravity, &less.gravity));
        }
        bends
    }
}
