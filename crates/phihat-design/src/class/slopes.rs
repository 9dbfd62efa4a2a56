//! Inertia, its derivatives and the gradient of gravity at a posture.

use nalgebra::DMatrix;
use phihat_model::{Model, Workspace};

/// Step of central differences \[rad, m\]: rounding and cut are both below 1e-8 of the size.
const STEP: f64 = 1e-4;

/// An arm with one payload, and the arm whose torque of gravity the robot adds by itself, if it does.
pub(super) struct Posed<'a> {
    model: &'a Model,
    room: Workspace<f64>,
    added: Option<(&'a Model, Workspace<f64>)>,
    rest: Vec<f64>,
    torque: Vec<f64>,
}

impl<'a> Posed<'a> {
    pub(super) fn of(model: &'a Model, added: Option<&'a Model>, n: usize) -> Self {
        let added = added.map(|bare| (bare, Workspace::new(bare)));
        let room = Workspace::new(model);
        Self { model, room, added, rest: vec![0.0; n], torque: vec![0.0; n] }
    }

    /// Torque of gravity that the law has to hold \[N·m\].
    pub(super) fn gravity(&mut self, q: &[f64], out: &mut [f64]) {
        self.model.bias(&mut self.room, q, &self.rest, out);
        if let Some((bare, room)) = &mut self.added {
            bare.bias(room, q, &self.rest, &mut self.torque);
            for (out, added) in out.iter_mut().zip(&self.torque) {
                *out -= added;
            }
        }
    }
}

impl Posed<'_> {
    /// `∂g/∂q` of that torque \[N·m/rad\], row by row.
    pub(super) fn gravity_slopes(&mut self, q: &[f64]) -> Vec<f64> {
        let n = q.len();
        let (mut slopes, mut at) = (vec![0.0; n * n], q.to_vec());
        let (mut up, mut down) = (vec![0.0; n], vec![0.0; n]);
        for c in 0..n {
            at[c] = q[c] + STEP;
            self.gravity(&at, &mut up);
            at[c] = q[c] - STEP;
            self.gravity(&at, &mut down);
            at[c] = q[c];
            for i in 0..n {
                slopes[i * n + c] = (up[i] - down[i]) / (2.0 * STEP);
            }
        }
        slopes
    }
}

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
    pub(super) fn at(arm: &mut Posed<'_>, q: &[f64]) -> Self {
        Self::with(arm, q, STEP)
    }

    fn with(arm: &mut Posed<'_>, q: &[f64], step: f64) -> Self {
        let n = q.len();
        let mut mass = vec![0.0; n * n];
        arm.model.mass_matrix(&mut arm.room, q, &mut mass);
        let (mut dm, mut gravity) = (Vec::with_capacity(n), vec![0.0; n * n]);
        let mut at = q.to_vec();
        let (mut more, mut less) = (vec![0.0; n * n], vec![0.0; n * n]);
        let (mut up, mut down) = (vec![0.0; n], vec![0.0; n]);
        for c in 0..n {
            at[c] = q[c] + step;
            arm.model.mass_matrix(&mut arm.room, &at, &mut more);
            arm.gravity(&at, &mut up);
            at[c] = q[c] - step;
            arm.model.mass_matrix(&mut arm.room, &at, &mut less);
            arm.gravity(&at, &mut down);
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
    pub(super) fn at(arm: &mut Posed<'_>, q: &[f64]) -> Self {
        let n = q.len();
        let mut at = q.to_vec();
        let mut bends = Self { ddm: Vec::new(), coriolis: Vec::new(), gravity: Vec::new() };
        let over = |a: &[f64], b: &[f64]| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * WIDE_STEP)).collect()
        };
        for b in 0..n {
            at[b] = q[b] + WIDE_STEP;
            let more = Slopes::with(arm, &at, WIDE_STEP);
            at[b] = q[b] - WIDE_STEP;
            let less = Slopes::with(arm, &at, WIDE_STEP);
            at[b] = q[b];
            bends.ddm.push((0..n).map(|c| over(&more.dm[c], &less.dm[c])).collect());
            let both = |c: usize| over(&more.coriolis(c), &less.coriolis(c));
            bends.coriolis.push((0..n).map(both).collect());
            bends.gravity.push(over(&more.gravity, &less.gravity));
        }
        bends
    }
}
