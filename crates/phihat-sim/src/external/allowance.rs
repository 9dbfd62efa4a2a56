//! Allowance for readings and for the velocity error in a torque that a window shows.

use phihat_model::{Model, Workspace};
use phihat_study::PayloadSet;

use super::body_set::larger;
use super::refusal::ContactRefusal;

/// Step of a posture by which slopes are differences \[rad\].
const STEP: f64 = 1e-4;

/// Factor for what changes between two looks at a load.
const STALE: f64 = 1.1;

/// Sensitivities of the arm's torque, each the largest over the payloads.
#[derive(Debug)]
pub(super) struct Allowance {
    loads: Vec<LoadedArm>,
    /// The load that is looked at next.
    next: usize,
    room: [Vec<f64>; 4],
}

/// One payload at the edge of the set.
#[derive(Debug)]
struct LoadedArm {
    model: Model,
    floating: Model,
    workspace: Workspace<f64>,
    /// `M` \[kg·m²\].
    mass: Vec<f64>,
    /// `Γ_ijk` with `C q̇ = Σ_jk Γ_ijk q̇_j q̇_k`, symmetric in `j, k` \[kg·m²\].
    gamma: Vec<f64>,
    /// `|∂τ_i/∂q_j|` \[N·m/rad\].
    slope: Vec<f64>,
}

/// A window, as far as what is uncertain of it depends on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct WindowErrors<'a> {
    /// Half of its length \[s\].
    pub(super) half_s: f64,
    /// Largest error of a reading, without what is the same in all \[rad\].
    pub(super) reading: &'a [f64],
    /// The whole of it \[rad\].
    pub(super) posture: &'a [f64],
    /// Velocity in the middle, and the bound on its error \[rad/s\].
    pub(super) dq: &'a [f64],
    pub(super) off: &'a [f64],
    /// Change of `M` from one end to the other, and how far its middle is off the mean of both \[kg·m²\].
    pub(super) turned: &'a [f64],
    pub(super) bent: &'a [f64],
}

impl Allowance {
    pub(super) fn of(model: &Model, payload: &PayloadSet) -> Result<Self, ContactRefusal> {
        let n = model.joint_count();
        let mut loads = vec![LoadedArm::of(model.clone())];
        if payload.mass.1 > 0.0 {
            for body in payload.heaviest() {
                let loaded = model.clone().with_payload_on(&payload.frame, &body);
                let refused = |e: phihat_model::ModelError| ContactRefusal::Payload(e.to_string());
                loads.push(LoadedArm::of(loaded.map_err(refused)?));
            }
        }
        Ok(Self { loads, next: 0, room: core::array::from_fn(|_| vec![0.0; n]) })
    }

    /// Looks at the arm's sensitivities with the next payload at a posture.
    pub(super) fn look(&mut self, q: &[f64], dq: &[f64], ddq: &[f64]) {
        let Self { loads, next, room } = self;
        loads[*next].look((q, dq, ddq), room);
        *next = (*next + 1) % loads.len();
    }

    /// Number of payloads.
    pub(super) fn loads(&self) -> usize {
        self.loads.len()
    }

    /// Largest torque of each joint that the window may show without anything beyond the model \[N·m\], by (CW4).
    pub(super) fn torque(&self, window: &WindowErrors<'_>, out: &mut [f64]) {
        out.fill(0.0);
        for load in &self.loads {
            for (i, out) in out.iter_mut().enumerate() {
                *out = larger(*out, STALE * load.torque(i, window));
            }
        }
        let n = out.len();
        let WindowErrors { half_s, reading, off, turned, bent, .. } = window;
        for (i, out) in out.iter_mut().enumerate() {
            for j in 0..n {
                let (turned, bent) = (turned[i * n + j].abs(), bent[i * n + j].abs());
                *out += 3.0 * turned * reading[j] / (half_s * half_s) + bent * off[j] / half_s;
            }
        }
    }
}

impl LoadedArm {
    fn of(model: Model) -> Self {
        let n = model.joint_count();
        let zero = |count: usize| vec![0.0; count];
        Self {
            workspace: Workspace::new(&model),
            floating: model.clone().with_gravity([0.0; 3]),
            model,
            mass: zero(n * n),
            gamma: zero(n * n * n),
            slope: zero(n * n),
        }
    }

    fn look(&mut self, (q, dq, ddq): (&[f64], &[f64], &[f64]), room: &mut [Vec<f64>; 4]) {
        let n = q.len();
        let [at, speed, before, after] = room;
        self.model.mass_matrix(&mut self.workspace, q, &mut self.mass);
        self.model.inverse_dynamics(&mut self.workspace, q, dq, ddq, before);
        at.copy_from_slice(q);
        for j in 0..n {
            at[j] = q[j] + STEP;
            self.model.inverse_dynamics(&mut self.workspace, at, dq, ddq, after);
            at[j] = q[j];
            for i in 0..n {
                self.slope[i * n + j] = (after[i] - before[i]).abs() / STEP;
            }
        }
        for j in 0..n {
            for k in 0..=j {
                speed.fill(0.0);
                (speed[j], speed[k]) = (1.0, 1.0);
                self.floating.bias(&mut self.workspace, q, speed, after);
                for i in 0..n {
                    self.gamma[(i * n + j) * n + k] = after[i];
                }
            }
        }
        for i in 0..n {
            let own = |j: usize| (i * n + j) * n + j;
            for j in 0..n {
                for k in 0..j {
                    let both = self.gamma[(i * n + j) * n + k];
                    let mixed = 0.5 * (both - self.gamma[own(j)] - self.gamma[own(k)]);
                    self.gamma[(i * n + j) * n + k] = mixed;
                    self.gamma[(i * n + k) * n + j] = mixed;
                }
            }
        }
    }

    fn torque(&self, i: usize, window: &WindowErrors<'_>) -> f64 {
        let WindowErrors { half_s, reading, posture, dq, off, .. } = window;
        let n = reading.len();
        let square = half_s * half_s;
        let mut sum = 0.0;
        for j in 0..n {
            sum += 4.0 * self.mass[i * n + j].abs() * reading[j] / square;
            sum += self.slope[i * n + j] * posture[j];
            let row = &self.gamma[(i * n + j) * n..][..n];
            let along: f64 = row.iter().zip(*dq).map(|(gamma, dq)| gamma * dq).sum();
            let beside: f64 = row.iter().zip(*off).map(|(gamma, off)| gamma.abs() * off).sum();
            sum += (2.0 * along.abs() + beside) * off[j];
        }
        sum
    }
}
