//! Bounds on the difference of the payload's share of the arm from the nominal point's, in the hand's own
//! axes.
//!
//! There the moments of the payload are constants, and the Jacobian turns as `∂_k J_i = −J_k × J_i`, `k > i`:
//!
//! ```text
//! ∂_k M_ij = (∂_k J_i)ᵀ I J_j + J_iᵀ I ∂_k J_j                                                   (CA1)
//! ∂_k τ_i  = (∂_k J_i)ᵀ w + J_iᵀ ∂_k w,   w = I A + V ×* I V                                      (CA2)
//! ∂_k V = −J_k × V_k,   ∂_k A = −(J_k × A_k + (J_k × V_k) × (V − V_k))                            (CA3)
//! ```
//!
//! All of it is linear in the ten moments, so each entry's range over a slice is exact but for the balls.

use super::chain::Placed;
use super::matter::Matter;
use super::number::{Ball, Screw, TubeNumber};
use super::scope::PayloadSlice;

/// Largest entries of what a payload of the slice adds to `K`, `∂M`, and of the wrench that a twist `ν` besides
/// the hand's own `V` costs:
///
/// ```text
/// S ε' = Jᵀ (δI J̇ ε' + G ν) − J̇ᵀ δI ν,   G ν = δI (V × ν) + ν ×* δI V + V ×* δI ν                (CA4)
/// ```
pub(super) struct CarriedLoad {
    /// `|G|`, 6×6, twists and wrenches as `v, w`.
    pub(super) wrench: Vec<f64>,
    /// `J̇` along the nominal velocity, `6×n`, rows `v, w`.
    pub(super) rate: Vec<Ball>,
    pub(super) k: Vec<f64>,
    pub(super) slopes: Vec<f64>,
}

impl CarriedLoad {
    #[allow(
        clippy::too_many_lines,
        reason = "(CA1) to (CA4), one after the other, on what they share"
    )]
    pub(super) fn new<S: TubeNumber>(
        slice: &PayloadSlice,
        placed: &Placed<S>,
        v: &[S],
        a: &[S],
    ) -> Self {
        let n = v.len();
        let j = placed.hand_twists();
        let (vs, accs) = placed.motions_in_hand(v, a);
        let last = vs.len() - 1;
        let (velocity, acceleration) = (vs[last], accs[last]);
        // −∂_k J_i, and (CA3) likewise.
        let turned: Vec<Screw<S>> = (0..n * n)
            .map(|at| {
                let (k, i) = (at / n, at % n);
                if k > i && k <= last { j[k].cross(j[i]) } else { Screw::zero() }
            })
            .collect();
        let slower: Vec<_> = (0..=last).map(|k| j[k].cross(vs[k])).collect();
        let lighter: Vec<_> = (0..=last)
            .map(|k| j[k].cross(accs[k]).plus(slower[k].cross(velocity.minus(vs[k]))))
            .collect();
        let mut wrench_of = vec![[Ball::default(); 10]; 36];
        let mut stiff = vec![[Ball::default(); 10]; n * n];
        let mut slopes = vec![[Ball::default(); 10]; n * n * n];
        for c in 0..10 {
            let body: Matter<S> = unit(c);
            let momenta: Vec<_> = j.iter().map(|twist| body.times(*twist)).collect();
            let momentum = body.times(velocity);
            let wrench = body.times(acceleration).plus(velocity.cross_wrench(momentum));
            for k in 0..=last {
                for i in 0..n {
                    for l in i..n {
                        let slope = -(turned[k * n + i].power(momenta[l])
                            + turned[k * n + l].power(momenta[i]));
                        slopes[(k * n + i) * n + l][c] = slope.ball();
                        slopes[(k * n + l) * n + i][c] = slope.ball();
                    }
                }
                let change = body
                    .times(lighter[k])
                    .plus(slower[k].cross_wrench(momentum))
                    .plus(velocity.cross_wrench(body.times(slower[k])));
                for i in 0..n {
                    stiff[i * n + k][c] =
                        -(turned[k * n + i].power(wrench) + j[i].power(change)).ball();
                }
            }
            for b in 0..6 {
                let axis = |at: usize| S::exact(if at == b { 1.0 } else { 0.0 });
                let nu = Screw {
                    v: core::array::from_fn(axis),
                    w: core::array::from_fn(|i| axis(3 + i)),
                };
                let cost = body
                    .times(velocity.cross(nu))
                    .plus(nu.cross_wrench(momentum))
                    .plus(velocity.cross_wrench(body.times(nu)));
                for a in 0..3 {
                    wrench_of[a * 6 + b][c] = cost.v[a].ball();
                    wrench_of[(3 + a) * 6 + b][c] = cost.w[a].ball();
                }
            }
        }
        let mut rate = vec![Ball::default(); 6 * n];
        for i in 0..n {
            let mut sum = Screw::zero();
            for k in i + 1..n {
                sum = sum.minus(turned[k * n + i].times(v[k]));
            }
            for a in 0..3 {
                rate[a * n + i] = sum.v[a].ball();
                rate[(3 + a) * n + i] = sum.w[a].ball();
            }
        }
        let sizes = |all: &[[Ball; 10]]| all.iter().map(|x| size(slice, x)).collect();
        Self { wrench: sizes(&wrench_of), rate, k: sizes(&stiff), slopes: sizes(&slopes) }
    }
}

/// A body with one of the ten moments 1, the others 0.
fn unit<S: TubeNumber>(c: usize) -> Matter<S> {
    let one = |at: usize| S::exact(if at == c { 1.0 } else { 0.0 });
    Matter::of_moments(one(0), [one(1), one(2), one(3)], core::array::from_fn(|i| one(4 + i)))
}

/// Largest size over the slice of a sum of moments times `slopes`.
fn size(slice: &PayloadSlice, slopes: &[Ball; 10]) -> f64 {
    let (low, high) = slice.range(&slopes.map(|x| x.m));
    let most = slice.most();
    let off: f64 = slopes.iter().zip(most).map(|(x, most)| x.r * most).sum();
    low.abs().max(high.abs()) + off
}
