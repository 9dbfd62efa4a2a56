//! How much the payload's share of the arm may differ from the nominal point's, in the hand's own axes.
//!
//! There the moments of the payload are constants, and the Jacobian turns as `∂_k J_i = −J_k × J_i`, `k > i`:
//!
//! ```text
//! ∂_k M_ij = (∂_k J_i)ᵀ I J_j + J_iᵀ I ∂_k J_j                                                   (L1)
//! ∂_k τ_i  = (∂_k J_i)ᵀ w + J_iᵀ ∂_k w,   w = I A + V ×* I V                                      (L2)
//! ∂_k V = −J_k × V_k,   ∂_k A = −(J_k × A_k + (J_k × V_k) × (V − V_k))                            (L3)
//! ```
//!
//! All of it is linear in the ten moments, so each entry's range over a slice is exact but for the balls.

use super::chain::Placed;
use super::matter::Matter;
use super::number::{Ball, Number, Screw};
use super::scope::PayloadSlice;

/// Largest entries of what a payload of the slice adds to `S`, `K`, `∂M`.
pub(super) struct Carried {
    pub(super) s: Vec<f64>,
    pub(super) k: Vec<f64>,
    pub(super) slopes: Vec<f64>,
}

impl Carried {
    pub(super) fn new(slice: &PayloadSlice, placed: &Placed<Ball>, v: &[Ball], a: &[Ball]) -> Self {
        let n = v.len();
        let j = placed.hand_twists();
        let (vs, accs) = placed.motions_in_hand(v, a);
        let last = vs.len() - 1;
        let (velocity, acceleration) = (vs[last], accs[last]);
        // −∂_k J_i, and (L3) likewise.
        let turned: Vec<Screw<Ball>> = (0..n * n)
            .map(|at| {
                let (k, i) = (at / n, at % n);
                if k > i && k <= last { j[k].cross(j[i]) } else { Screw::zero() }
            })
            .collect();
        let slower: Vec<_> = (0..=last).map(|k| j[k].cross(vs[k])).collect();
        let lighter: Vec<_> = (0..=last)
            .map(|k| j[k].cross(accs[k]).plus(slower[k].cross(velocity.minus(vs[k]))))
            .collect();
        let mut s = vec![[Ball::default(); 10]; n * n];
        let mut stiff = vec![[Ball::default(); 10]; n * n];
        let mut slopes = vec![[Ball::default(); 10]; n * n * n];
        for c in 0..10 {
            let body = unit(c);
            let momenta: Vec<_> = j.iter().map(|twist| body.times(*twist)).collect();
            let momentum = body.times(velocity);
            let wrench = body.times(acceleration).plus(velocity.cross_wrench(momentum));
            for k in 0..=last {
                for i in 0..n {
                    for l in i..n {
                        let slope = -(turned[k * n + i].power(momenta[l])
                            + turned[k * n + l].power(momenta[i]));
                        slopes[(k * n + i) * n + l][c] = slope;
                        slopes[(k * n + l) * n + i][c] = slope;
                    }
                }
                let change = body
                    .times(lighter[k])
                    .plus(slower[k].cross_wrench(momentum))
                    .plus(velocity.cross_wrench(body.times(slower[k])));
                for i in 0..n {
                    stiff[i * n + k][c] = -(turned[k * n + i].power(wrench) + j[i].power(change));
                }
            }
            for i in 0..n {
                for l in 0..n {
                    let mut sum = Ball::default();
                    for k in 0..n {
                        let both =
                            slopes[(l * n + i) * n + k][c] - slopes[(i * n + k) * n + l][c];
                        sum = sum + both * v[k];
                    }
                    s[i * n + l][c] = sum;
                }
            }
        }
        let sizes = |all: &[[Ball; 10]]| all.iter().map(|x| size(slice, x)).collect();
        Self { s: sizes(&s), k: sizes(&stiff), slopes: sizes(&slopes) }
    }
}

/// A body with one of the ten moments 1, the others 0.
fn unit(c: usize) -> Matter<Ball> {
    let one = |at: usize| Ball::exact(if at == c { 1.0 } else { 0.0 });
    Matter::of_moments(one(0), [one(1), one(2), one(3)], core::array::from_fn(|i| one(4 + i)))
}

/// Largest size over the slice of a sum of moments times `slopes`.
fn size(slice: &PayloadSlice, slopes: &[Ball; 10]) -> f64 {
    let (low, high) = slice.range(&slopes.map(|x| x.m));
    let most = slice.most();
    let off: f64 = slopes.iter().zip(most).map(|(x, most)| x.r * most).sum();
    low.abs().max(high.abs()) + off
}
