//! Distance of the linear run from the arm: second derivatives and changes by the payload, once per group.

use phihat_certificate::extremes::larger;

use super::basis::{Direction, Slice};
use super::linear::Differences;

/// Step of the second differences.
const STEP: f64 = 1e-4;

/// Second derivatives are taken along the nominal; this is for what they change across the tube.
const MARGIN: f64 = 1.25;

/// Per unit deviation; `n³`, `[i][j][k]`: entry `ij` by coordinate `k`.
#[derive(Debug, Clone)]
pub(super) struct Tensors {
    /// `|∂M_ij/∂q_k|`
    pub(super) mass: Vec<f64>,
    /// `|∂K_ij/∂q_k|`
    pub(super) stiffness: Vec<f64>,
    /// `|∂D_ij/∂q_k|`
    pub(super) damping: Vec<f64>,
    /// `|∂D_ij/∂q̇_k|`, of rigid-body dynamics
    pub(super) coriolis: Vec<f64>,
    /// Largest changes of `D` and `K` by the payload.
    pub(super) payload_damping: Vec<f64>,
    pub(super) payload_stiffness: Vec<f64>,
}

impl Tensors {
    /// Holds both.
    pub(super) fn widen(&mut self, other: &Self) {
        let Self { mass, stiffness, damping, coriolis, payload_damping, payload_stiffness } = self;
        for (own, other) in [
            (mass, &other.mass),
            (stiffness, &other.stiffness),
            (damping, &other.damping),
            (coriolis, &other.coriolis),
            (payload_damping, &other.payload_damping),
            (payload_stiffness, &other.payload_stiffness),
        ] {
            for (own, other) in own.iter_mut().zip(other) {
                *own = larger(*own, *other);
            }
        }
    }
}

/// Changes of `D` and `K` by a direction.
type TensorChange = (Vec<f64>, Vec<f64>);

/// Models to look at: the ends of a slice, and the directions in it.
pub(super) struct SliceModels<'a> {
    pub(super) ends: Vec<Differences<'a>>,
    pub(super) directions: Vec<Option<(Differences<'a>, Differences<'a>, f64)>>,
}

impl<'a> SliceModels<'a> {
    pub(super) fn new(
        ends: &'a [phihat_model::Model],
        directions: &'a [Option<Direction>],
    ) -> Self {
        let pair =
            |d: &'a Direction| (Differences::new(&d.plus), Differences::new(&d.minus), d.scale);
        Self {
            ends: ends.iter().map(Differences::new).collect(),
            directions: directions.iter().map(|d| d.as_ref().map(pair)).collect(),
        }
    }

    pub(super) fn at(&mut self, state: &[Vec<f64>; 3], slice: Option<&Slice>) -> Tensors {
        let [q, v, a] = state;
        let n = q.len();
        let cube = vec![0.0; n * n * n];
        let mut out = Tensors {
            mass: cube.clone(),
            stiffness: cube.clone(),
            damping: cube.clone(),
            coriolis: cube,
            payload_damping: vec![0.0; n * n],
            payload_stiffness: vec![0.0; n * n],
        };
        for model in &mut self.ends {
            for k in 0..n {
                let moved = |sign: f64, x: &[f64]| {
                    let mut x = x.to_vec();
                    x[k] += sign * STEP;
                    x
                };
                let (qp, qm) = (moved(1.0, q), moved(-1.0, q));
                let (plus, minus) = (model.at((&qp, v, a)), model.at((&qm, v, a)));
                let (vp, vm) = (moved(1.0, v), moved(-1.0, v));
                let (fast, slow) = (model.at((q, &vp, a)), model.at((q, &vm, a)));
                for ij in 0..n * n {
                    let at = ij * n + k;
                    for (slot, high, low) in [
                        (&mut out.mass, &plus.m, &minus.m),
                        (&mut out.stiffness, &plus.k, &minus.k),
                        (&mut out.damping, &plus.d, &minus.d),
                        (&mut out.coriolis, &fast.d, &slow.d),
                    ] {
                        let slope = (high[ij] - low[ij]).abs() / (2.0 * STEP);
                        slot[at] = larger(slot[at], MARGIN * slope);
                    }
                }
            }
        }
        if let Some(slice) = slice {
            let mut by: Vec<Option<TensorChange>> = Vec::with_capacity(10);
            for direction in &mut self.directions {
                by.push(direction.as_mut().map(|(plus, minus, scale)| {
                    let (p, m) = (plus.at((q, v, a)), minus.at((q, v, a)));
                    let change = |p: &[f64], m: &[f64]| {
                        p.iter().zip(m).map(|(p, m)| (p - m) * *scale).collect::<Vec<f64>>()
                    };
                    (change(&p.d, &m.d), change(&p.k, &m.k))
                }));
            }
            for ij in 0..n * n {
                let unit = |pick: fn(&TensorChange) -> &Vec<f64>| {
                    core::array::from_fn(|d| by[d].as_ref().map_or(0.0, |pair| pick(pair)[ij]))
                };
                out.payload_damping[ij] = slice.size(&unit(|pair| &pair.0));
                out.payload_stiffness[ij] = slice.size(&unit(|pair| &pair.1));
            }
        }
        out
    }
}
