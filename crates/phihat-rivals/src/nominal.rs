//! The nominal model of an arm, whole or in part: what model-based rivals compute with.

use core::fmt;

use phihat_model::{Model, Workspace};

use crate::error::RivalRefusal;
use crate::handed::Knows;
use crate::needs::Needs;
use crate::supply::Supply;

/// Step ahead and behind along the motion for a numerical derivative \[s\].
const ASIDE: f64 = 1e-4;

/// A nominal rigid-body model with viscous friction, `M̂ q̈ + Ĉ(q, q̇) q̇ + Ĝ + F̂ q̇ = τ`.
///
/// `Ĉ` is the matrix of Christoffel symbols, so that `dM̂/dt − 2Ĉ` is skew; its product with any vector comes
/// by polarisation from `c(q, v) = Ĉ(q, v) v`:
///
/// ```text
/// Ĉ(q, v) w = ½ [c(q, v + w) − c(q, v) − c(q, w)]                                      (1)
/// ```
pub struct Nominal {
    model: Model,
    workspace: Workspace<f64>,
    viscous: Vec<f64>,
    zero: Vec<f64>,
    sum: Vec<f64>,
    at_rest: Vec<f64>,
    terms: [Vec<f64>; 3],
}

impl Nominal {
    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.viscous.len()
    }

    /// `Ĝ(q)` \[N·m\].
    pub fn gravity(&mut self, q: &[f64], out: &mut [f64]) {
        self.model.gravity_torque(&mut self.workspace, q, out);
    }

    /// `M̂(q)`, `n × n` row by row \[kg·m²\].
    pub fn mass_matrix(&mut self, q: &[f64], out: &mut [f64]) {
        self.model.mass_matrix(&mut self.workspace, q, out);
    }

    /// `M̂(q) a + Ĉ(q, v) w + Ĝ(q) + F̂ w` \[N·m\]: (1) for the second term.
    pub fn torque(&mut self, q: &[f64], v: &[f64], w: &[f64], a: &[f64], out: &mut [f64]) {
        for i in 0..v.len() {
            self.sum[i] = v[i] + w[i];
        }
        let [both, first, second] = &mut self.terms;
        self.model.bias(&mut self.workspace, q, &self.sum, both);
        self.model.bias(&mut self.workspace, q, v, first);
        self.model.bias(&mut self.workspace, q, w, second);
        self.model.gravity_torque(&mut self.workspace, q, &mut self.at_rest);
        self.model.inverse_dynamics(&mut self.workspace, q, &self.zero, a, out);
        for i in 0..v.len() {
            // Each bias holds gravity: one is left over in the difference, with a minus.
            let coriolis = 0.5 * (both[i] - first[i] - second[i] + self.at_rest[i]);
            out[i] += coriolis + self.viscous[i] * w[i];
        }
    }

    /// `M̂(q) a + Ĉ(q, v) v + Ĝ(q)` \[N·m\]: the rigid arm without friction.
    pub fn rigid(&mut self, q: &[f64], v: &[f64], a: &[f64], out: &mut [f64]) {
        self.model.inverse_dynamics(&mut self.workspace, q, v, a, out);
    }

    /// `p = M̂(q) v` \[N·m·s\].
    pub fn momentum(&mut self, q: &[f64], v: &[f64], out: &mut [f64]) {
        self.model.gravity_torque(&mut self.workspace, q, &mut self.at_rest);
        self.model.inverse_dynamics(&mut self.workspace, q, &self.zero, v, out);
        out.iter_mut().zip(&self.at_rest).for_each(|(p, gravity)| *p -= gravity);
    }

    /// `Ĉᵀ(q, v) v − Ĝ(q) − F̂ v` \[N·m\]: rate of change of the momentum without the torque.
    /// `Ĉᵀ v = dM̂/dt v − Ĉ v`, the first term by central differences of the momentum along `v` over 0.2 ms.
    pub fn momentum_change(&mut self, q: &[f64], v: &[f64], room: &mut [f64], out: &mut [f64]) {
        let n = v.len();
        let mut place = core::mem::take(&mut self.sum);
        for (side, factor) in [(ASIDE, 1.0), (-ASIDE, -1.0)] {
            for i in 0..n {
                place[i] = q[i] + side * v[i];
            }
            self.momentum(&place, v, room);
            for i in 0..n {
                let part = factor * room[i] / (2.0 * ASIDE);
                out[i] = if factor > 0.0 { part } else { out[i] + part };
            }
        }
        self.sum = place;
        self.model.bias(&mut self.workspace, q, v, room);
        for i in 0..n {
            out[i] -= room[i] + self.viscous[i] * v[i];
        }
    }

    /// `M̂(q)⁻¹ (τ − Ĉ(q, v) v − Ĝ(q) − F̂ v)` \[rad/s²\].
    pub fn acceleration(&mut self, q: &[f64], v: &[f64], tau: &[f64], out: &mut [f64]) {
        for i in 0..v.len() {
            self.sum[i] = tau[i] - self.viscous[i] * v[i];
        }
        self.model.forward_dynamics(&mut self.workspace, q, v, &self.sum, out);
    }
}

impl fmt::Debug for Nominal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Nominal").field("joints", &self.joints()).finish_non_exhaustive()
    }
}

impl Knows for Nominal {
    const NEEDS: Needs = Needs { model: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        let zero = vec![0.0; supply.joints()];
        Ok(Self {
            workspace: Workspace::new(&supply.model),
            model: supply.model.clone(),
            viscous: supply.viscous.clone(),
            sum: zero.clone(),
            at_rest: zero.clone(),
            terms: [zero.clone(), zero.clone(), zero.clone()],
            zero,
        })
    }
}

/// The nominal gravity torque and nothing else of the model.
#[derive(Debug)]
pub struct Gravity(Nominal);

impl Gravity {
    /// `Ĝ(q)` \[N·m\].
    pub fn torque(&mut self, q: &[f64], out: &mut [f64]) {
        self.0.gravity(q, out);
    }
}

impl Knows for Gravity {
    const NEEDS: Needs = Needs { gravity: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        Nominal::of(supply).map(Self)
    }
}

/// The nominal viscous friction of every joint.
#[derive(Debug, Clone)]
pub struct Viscous(Vec<f64>);

impl Viscous {
    /// `F̂` \[N·m·s/rad\], one entry per joint.
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

impl Knows for Viscous {
    const NEEDS: Needs = Needs { friction: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        Ok(Self(supply.viscous.clone()))
    }
}
