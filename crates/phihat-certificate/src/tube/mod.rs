//! The tube: an envelope of error and velocity error that no run in scope leaves, derived by a method of its own.
//!
//! The finder propagates impulse responses forward; this derivation goes the other way and shares no code with
//! it: own dynamics (screws in world axes, derivatives in closed form over balls), own sampled law, own
//! nominal run (dry friction held over each sample), momentum as the state, and rows of outputs propagated
//! backwards.
//!
//! # Law
//!
//! With `ε = q − q_n` and the momentum `P = M(q, p) ε'`, for any piecewise constant `M, S, K`:
//!
//! ```text
//! ε' = M⁻¹ (P − x),   x = (M(q, p) − M) ε'                                                       (B1)
//! P' = τ̃ − S ε' − K ε − Y_n δπ − (f s(q̇) − f_n) − σ                                             (B2)
//! σ  = (S(q, v_n; p) − S) ε' + (K(·) − K) ε − ½ ∂_q(ε'ᵀ M(q, p) ε') + bend of the smooth friction
//! S(q, v)_ij = Σ_k (∂_j M_ik − ∂_i M_kj) v_k,     K = ∂_q ID(q, v_n, a_n; p)
//! ```
//!
//! (B2) is exact: inverse dynamics are quadratic in the velocity, so no second-order term is left out.

mod acting;
mod adjoint;
mod ball;
mod beside;
mod carried;
mod chain;
mod dense;
mod document;
#[cfg(test)]
mod enclosed;
mod frame;
mod inputs;
mod lanes;
mod law;
mod matter;
mod nominal;
mod number;
mod outputs;
mod round;
mod scope;
mod setting;
mod shapes;
mod shifted;
mod sweep;
#[cfg(test)]
mod tests;
mod window;

pub use beside::{CONFIRMED, JointBeside, TIGHTER, UNREAD, beside};
pub use document::derive;
pub use inputs::{TubeInputs, TubeReference};
pub use scope::ScopeRefusal as TubeRefusal;
pub(crate) use scope::counted;
