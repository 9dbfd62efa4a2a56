//! The trusted base of phihat's certificates: claims about sampled linear loops, proved in exact arithmetic.
//!
//! Numbers are dyadic rationals: what doubles are, and what sums and products of them are. Nothing is rounded, and
//! nothing transcendental is evaluated but bounds of `e^{−x}` and `cos x`, by Taylor sums, and the angles of a delay. A
//! joint's law and its setting enter as doubles; from them polynomials `N`, `Δ` in `z` follow exactly ([`JointLoop`]),
//! products of them on the circle
//! `|z| = 1` are polynomials in `t = sin²(θ/2)`, and a claim is that such polynomials stay positive on `[0, 1]`
//! (Bernstein coefficients over cells) and that one polynomial has its roots inside the circle (Schur and Cohn).
//!
//! | claim | function |
//! |---|---|
//! | window of one joint; (P2), the arm at every frozen posture | [`frozen`] |
//! | (P3), the arm while its inertia changes at a bounded rate | [`moving`] |
//! | (P4), the same at any speed | [`any_speed`] |
//! | rate of return: any of them on `\|z\| = ρ` | [`JointLoop::within`], [`decays`] |
//! | modulus and phase margin | [`modulus`], [`phase`] |
//! | delay margin, with the platform's sines | [`delay`] |
//!
//! # Example
//!
//! ```
//! use phihat_kernel::{JointLoop, Law, Range, Reported, Setting, VelocityModel, frozen};
//!
//! // τ = −100 q − 14 q̇ at 1 kHz, without delay, on an inertia of 1 kg·m² more or less.
//! let law = Law { direct: [-100.0, -14.0, 0.0], ..Law::default() };
//! let velocity = VelocityModel { last: 0.0, velocity: 1.0, position: 0.0, before: 0.0 };
//! let setting = Setting { period: 1e-3, inertia: 1.0, late: 0, velocity, drive: None, reported: Reported::Applied };
//! let joint = JointLoop::new(&law, &setting)?;
//!
//! // (z − 1)² μ + 5e-5 (z + 1) + 0.014 (z − 1) has its roots inside for μ above 0.007, where one is at −1.
//! assert!(frozen(&[joint.clone()], &Range::new(0.00701, 1e6)?).is_ok());
//! assert!(frozen(&[joint], &Range::new(0.00699, 1e6)?).is_err());
//! # Ok::<(), phihat_kernel::Unproved>(())
//! ```
//!
//! # Not claimed
//!
//! That the numbers handed in are those of the law that runs, that the joint's motion is `M q̈ = τ − φ`, and that the
//! law's own roundings do no harm: docs/theory/exact.md of the repository lists what has to be believed.
#![forbid(unsafe_code)]

mod bernstein;
mod circle;
mod claims;
mod joint;
mod matrix;
mod multiplier;
mod number;
mod polynomial;
mod schur;
mod setting;
mod unproved;

pub use claims::{MovingInertia, Range, any_speed, decays, delay, frozen, modulus, moving, phase};
pub use joint::JointLoop;
pub use number::Number;
pub use polynomial::Polynomial;
pub use setting::{DriveModel, Law, Reported, Setting, VelocityModel};
pub use unproved::Unproved;
