//! Small deviations from the nominal run: derivatives of the dynamics and the step from sample to sample.

use nalgebra::DMatrix;
use phihat_model::{Lanes, Model, Scalar as _, Workspace};

use super::nominal::NominalRun;
use super::scene::Scene;
use crate::square::{StateSquare, product};

/// Steps of the differences in position and velocity.
const STEP: f64 = 1e-5;

/// Derivatives of inverse dynamics at one state: `M`, by velocity, by position.
#[derive(Debug, Clone)]
pub(super) struct Derivatives {
    pub(super) m: StateSquare,
    pub(super) d: StateSquare,
    pub(super) k: StateSquare,
}

/// Differences of a model's inverse dynamics.
pub(super) struct Differences<'a> {
    pub(super) model: &'a Model,
    workspace: Workspace<f64>,
    abreast: Workspace<Lanes>,
    state: [Vec<Lanes>; 3],
    torque: Vec<Lanes>,
}

impl<'a> Differences<'a> {
    pub(super) fn new(model: &'a Model) -> Self {
        let zero = vec![Lanes::default(); model.joint_count()];
        Self {
            model,
            workspace: Workspace::new(model),
            abreast: Workspace::new(model),
            state: [zero.clone(), zero.clone(), zero.clone()],
            torque: zero,
        }
    }

    pub(super) fn torque(&mut self, (q, v, a): (&[f64], &[f64], &[f64]), tau: &mut [f64]) {
        self.model.inverse_dynamics(&mut self.workspace, q, v, a, tau);
    }

    pub(super) fn at(&mut self, (q, v, a): (&[f64], &[f64], &[f64])) -> Derivatives {
        let n = q.len();
        let mut out = Derivatives { m: vec![0.0; n * n], d: vec![0.0; n * n], k: vec![0.0; n * n] };
        self.model.mass_matrix(&mut self.workspace, q, &mut out.m);
        // By every position, then by every velocity: a lane each way, as many pairs as fit side by side.
        let pairs: Vec<(usize, usize)> =
            (0..2).flat_map(|by| (0..n).map(move |j| (by, j))).collect();
        for pairs in pairs.chunks(Lanes::COUNT / 2) {
            for (lanes, base) in self.state.iter_mut().zip([q, v, a]) {
                for (lane, base) in lanes.iter_mut().zip(base) {
                    *lane = Lanes::splat(*base);
                }
            }
            for (lane, (by, j)) in pairs.iter().enumerate() {
                let mut moved = <[f64; Lanes::COUNT]>::from(self.state[*by][*j]);
                moved[2 * lane] += STEP;
                moved[2 * lane + 1] -= STEP;
                self.state[*by][*j] = Lanes::from(moved);
            }
            let [q, v, a] = &self.state;
            self.model.inverse_dynamics(&mut self.abreast, q, v, a, &mut self.torque);
            for (lane, (by, j)) in pairs.iter().enumerate() {
                let matrix = if *by == 0 { &mut out.k } else { &mut out.d };
                for (i, torque) in self.torque.iter().enumerate() {
                    let torque = <[f64; Lanes::COUNT]>::from(*torque);
                    let [plus, minus] = [torque[2 * lane], torque[2 * lane + 1]];
                    matrix[i * n + j] = (plus - minus) / (2.0 * STEP);
                }
            }
        }
        out
    }
}

/// Linear loop over one sample: the derivatives in its middle and the exact step of the linear plant.
#[derive(Debug)]
pub(super) struct StepInterval {
    /// `M⁻¹`.
    pub(super) inverse: StateSquare,
    pub(super) derivatives: Derivatives,
    /// `[ε; w]` one sample on, `2n × 2n`.
    pub(super) step: Vec<f64>,
    /// From held torque to `[ε; w]`, `2n × n`.
    pub(super) held: Vec<f64>,
    /// Torque that the robot adds per `ε` and per `ε̇` at the sample; empty where it adds none.
    pub(super) added: Vec<f64>,
}

/// State and acceleration in the middle of an interval.
pub(super) fn middle(scene: &Scene<'_>, run: &NominalRun, k: usize) -> [Vec<f64>; 3] {
    let n = scene.n;
    let (now, next) = (k * n, (k + 1) * n);
    let t = scene.period;
    let v: Vec<f64> = (0..n).map(|i| 0.5 * (run.dq[now + i] + run.dq[next + i])).collect();
    let a: Vec<f64> = (0..n).map(|i| (run.dq[next + i] - run.dq[now + i]) / t).collect();
    let q = (0..n).map(|i| 0.5 * (run.q[now + i] + run.q[next + i])).collect();
    [q, v, a]
}

impl StepInterval {
    pub(super) fn new(
        scene: &Scene<'_>,
        run: &NominalRun,
        k: usize,
        differences: &mut Differences<'_>,
        bare: &mut Differences<'_>,
    ) -> Option<Self> {
        let n = scene.n;
        let [q, v, a] = middle(scene, run, k);
        let mut derivatives = differences.at((&q, &v, &a));
        for i in 0..n {
            derivatives.d[i * n + i] += scene.friction[i].slope(v[i]);
        }
        let inverse = inverse(&derivatives.m, n)?;
        let (step, held) = discretised(&inverse, &derivatives, n, scene.period);
        let mut added = Vec::new();
        if scene.adds_gravity || scene.friction.iter().any(|f| f.added.is_some()) {
            added = vec![0.0; 2 * n * n];
            let at = k * n;
            if scene.adds_gravity {
                let rest = vec![0.0; n];
                let gravity = bare.at((&run.q[at..at + n], &rest, &rest));
                added[..n * n].copy_from_slice(&gravity.k);
            }
            for i in 0..n {
                if let Some(own) = &scene.friction[i].added {
                    added[n * n + i * n + i] = own.slope(run.dq[at + i]);
                }
            }
        }
        Some(Self { inverse, derivatives, step, held, added })
    }
}

/// Inverse of a positive definite matrix; `None` where it is not.
fn inverse(m: &[f64], n: usize) -> Option<StateSquare> {
    let inverse = DMatrix::from_row_slice(n, n, m).cholesky()?.inverse();
    Some(inverse.as_slice().to_vec())
}

/// Exact step of `ε' = w, w' = M⁻¹(τ − D w − K ε)` over a sample, by its series to the sixth order.
fn discretised(inverse: &[f64], at: &Derivatives, n: usize, t: f64) -> (Vec<f64>, Vec<f64>) {
    let negative = |m: &[f64]| product(inverse, m, n).iter().map(|x| -x).collect::<Vec<f64>>();
    let (on_e, on_w) = (negative(&at.k), negative(&at.d));
    // Columns of Tʲ/j! Aʲ, each state as (ε rows, w rows), for 2n unit states; then the integral on M⁻¹.
    let wide = 2 * n;
    let apply = |x: &[f64]| {
        let mut out = vec![0.0; wide * wide];
        for i in 0..n {
            out[i * wide..(i + 1) * wide].copy_from_slice(&x[(n + i) * wide..(n + i + 1) * wide]);
            for k in 0..n {
                let (e, w) = (on_e[i * n + k], on_w[i * n + k]);
                for c in 0..wide {
                    out[(n + i) * wide + c] += e * x[k * wide + c] + w * x[(n + k) * wide + c];
                }
            }
        }
        out
    };
    let mut term = vec![0.0; wide * wide];
    for i in 0..wide {
        term[i * wide + i] = 1.0;
    }
    let mut step = term.clone();
    let mut integral: Vec<f64> = term.iter().map(|x| x * t).collect();
    for order in 1..=6_u8 {
        let factor = t / f64::from(order);
        term = apply(&term).iter().map(|x| x * factor).collect();
        let last = t / f64::from(order + 1);
        for i in 0..wide * wide {
            step[i] += term[i];
            integral[i] += term[i] * last;
        }
    }
    let mut held = vec![0.0; wide * n];
    for i in 0..wide {
        for k in 0..n {
            let factor = integral[i * wide + n + k];
            for j in 0..n {
                held[i * n + j] += factor * inverse[k * n + j];
            }
        }
    }
    (step, held)
}
