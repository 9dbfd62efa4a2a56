//! Inertia, its slopes, Coriolis and gravity at a posture, by means of this crate.

use phihat_model::{Model, Workspace};

use crate::Matrix;

/// Step of central differences \[rad, m\].
const STEP: f64 = 3e-4;

/// Posture's matrices: torques of inverse dynamics and their slopes.
pub(super) struct Dynamics {
    pub(super) n: usize,
    pub(super) mass: Matrix,
    /// `∂M/∂q_c`.
    pub(super) slopes: Vec<Matrix>,
    /// `∂²ID/∂q̇_c ∂q̇`, from torques: they are quadratic in the velocity.
    pub(super) coriolis: Vec<Matrix>,
    /// `∂g/∂q`.
    pub(super) gravity: Matrix,
}

impl Dynamics {
    /// Of an arm with its payload; `added` is the arm whose torque of gravity the robot adds by itself.
    pub(super) fn at(model: &Model, added: Option<&Model>, q: &[f64]) -> Self {
        let room = &mut Workspace::new(model);
        let n = q.len();
        let mut mass = |q: &[f64]| {
            let mut flat = vec![0.0; n * n];
            model.mass_matrix(room, q, &mut flat);
            flat.chunks(n.max(1)).map(<[f64]>::to_vec).collect::<Matrix>()
        };
        let own = mass(q);
        let moved = |c: usize, by: f64| -> Vec<f64> {
            (0..n).map(|i| if i == c { q[i] + by } else { q[i] }).collect()
        };
        let slopes: Vec<Matrix> = (0..n)
            .map(|c| {
                let (more, less) = (mass(&moved(c, STEP)), mass(&moved(c, -STEP)));
                let row = |(a, b): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
                    a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * STEP)).collect()
                };
                more.iter().zip(&less).map(row).collect()
            })
            .collect();
        let mut bias = |q: &[f64], dq: &[f64]| {
            let mut tau = vec![0.0; n];
            model.bias(room, q, dq, &mut tau);
            tau
        };
        let rest = vec![0.0; n];
        let still = bias(q, &rest);
        let unit = |c: usize, j: usize| -> Vec<f64> {
            (0..n).map(|i| f64::from(u8::from(i == c)) + f64::from(u8::from(i == j))).collect()
        };
        let half = |c: usize| -> Vec<f64> { unit(c, c).iter().map(|x| 0.5 * x).collect() };
        let alone: Vec<Vec<f64>> = (0..n).map(|c| bias(q, &half(c))).collect();
        let mut coriolis = vec![vec![vec![0.0; n]; n]; n];
        for c in 0..n {
            for j in 0..n {
                let both = bias(q, &unit(c, j));
                for i in 0..n {
                    coriolis[c][i][j] = both[i] - alone[c][i] - alone[j][i] + still[i];
                }
            }
        }
        let mut gravity = weights(model, q);
        for (row, less) in
            gravity.iter_mut().zip(added.into_iter().flat_map(|bare| weights(bare, q)))
        {
            row.iter_mut().zip(less).for_each(|(own, added)| *own -= added);
        }
        Self { n, mass: own, slopes, coriolis, gravity }
    }

    /// `s ∂_c M − D_c`.
    pub(super) fn less(&self, c: usize, s: f64) -> Matrix {
        let entry = |i: usize, j: usize| s * self.slopes[c][i][j] - self.coriolis[c][i][j];
        (0..self.n).map(|i| (0..self.n).map(|j| entry(i, j)).collect()).collect()
    }
}

/// `∂g/∂q` of a model.
pub(super) fn weights(model: &Model, q: &[f64]) -> Matrix {
    let n = q.len();
    let (mut room, rest) = (Workspace::new(model), vec![0.0; n]);
    let mut weight = |c: usize, by: f64| {
        let place: Vec<f64> = (0..n).map(|i| if i == c { q[i] + by } else { q[i] }).collect();
        let mut tau = vec![0.0; n];
        model.bias(&mut room, &place, &rest, &mut tau);
        tau
    };
    let mut slopes = vec![vec![0.0; n]; n];
    for c in 0..n {
        let (more, less) = (weight(c, STEP), weight(c, -STEP));
        for (row, (more, less)) in slopes.iter_mut().zip(more.iter().zip(&less)) {
            row[c] = (more - less) / (2.0 * STEP);
        }
    }
    slopes
}
