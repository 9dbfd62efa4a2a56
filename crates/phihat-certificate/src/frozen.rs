//! Stability of a coupled arm at every frozen posture where each joint has a law of its own.

use phihat::VelocitySource;
use phihat_kernel::{Range, Unproved, frozen};
use serde::{Deserialize, Serialize};

use crate::check::{linear, plausible};
use crate::refutation::refuse;
use crate::window::radius_of;
use crate::{JointRecord, LoopModel, Refutation};

const CLAIM: &str = "laws of their own";

/// The arm's loop is stable at every frozen posture whose inertia, in units of the gains' `M̄`, lies in `[low, high]`.
///
/// # Claim
///
/// For every constant symmetric `W` with its spectrum in `[a, b] = [low, high]`, the loop
/// `det(W + diag L_i(z)) = 0` has all its roots inside the unit circle, `L_i` joint `i`'s own loop per unit
/// of its `M̄`; inside the circle of radius `e^{−rate T}` where [`Self::decay_per_s`] states a rate: at each posture
/// the arm forgets whatever moved it at least as fast. Needed where laws differ: with one law, each eigenvalue of `W`
/// is a loop by itself.
///
/// # Proof
///
/// At a root on the circle `Wv = −diag(L) v` for some `v`. `W` is real and symmetric, so
/// `Σ|v_i|² Im L_i = 0`; its spectrum gives `Σ|v_i|² Re((L_i + a)(L_i + b)*) ≤ 0`. Both contradict
///
/// ```text
/// x Re((L_i + a)(L_i + b)*) + y Im L_i > 0   for all i, with one x ≥ 0 and one real y                       as (P2)
/// ```
///
/// at that frequency: all `L_i` lie outside one circle through `−a` and `−b`. `W_s = (1 − s)c + sW` stays in
/// the set and no root crosses; at `W = c` each joint is a loop by itself, and stable. With a rate the same holds of
/// `L_i(ρz)`, `ρ = e^{−rate T}`.
///
/// # Evidence
///
/// None is needed: [`Self::verify`] finds `y/x` over cells of the circle, in exact arithmetic
/// ([`phihat_kernel::frozen`]).
///
/// # Not claimed
///
/// Drives that differ where a measured velocity is used; postures that move; friction, gravity's gradient and
/// limits in action.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrozenArm {
    /// Smallest eigenvalue of `W`.
    pub low: f64,
    /// Largest eigenvalue of `W`.
    pub high: f64,
    /// Rate at which every mode decays at least \[1/s\]; `None`: none is claimed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decay_per_s: Option<f64>,
}

impl FrozenArm {
    /// The claim for eigenvalues in `[low, high]`, without a rate.
    pub const fn stable(low: f64, high: f64) -> Self {
        Self { low, high, decay_per_s: None }
    }

    /// Proves the claim for joints with their laws in their loops.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the frequency at which no circle is found, or the joint that is not stable by itself.
    pub fn verify(&self, loops: &[(&JointRecord, &LoopModel)]) -> Result<(), Refutation> {
        let Self { low, high, decay_per_s } = *self;
        let sensible = 0.0 < low && low <= high && high.is_finite();
        Refutation::unless(CLAIM, "0 < low ≤ high < ∞", low, high, sensible)?;
        let one_clock = loops.windows(2).all(|pair| {
            let of = |i: usize| pair[i].1.period_s;
            (of(0) - of(1)).abs() <= f64::EPSILON * of(0)
        });
        Refutation::unless(CLAIM, "all joints are sampled together", 0.0, 1.0, one_clock)?;
        for (record, model) in loops {
            plausible::gains(CLAIM, record)?;
            plausible::model(CLAIM, record, model)?;
        }
        one_drive(loops)?;
        let joints = loops.iter().map(|(record, model)| linear::joint(CLAIM, record, model));
        let mut joints = joints.collect::<Result<Vec<_>, _>>()?;
        if let (Some(rate), Some((_, model))) = (decay_per_s, loops.first()) {
            let radius = radius_of(rate, model.period_s).ok_or_else(|| {
                refuse(CLAIM, "0 ≤ rate of decay, and not too large to be told", rate, 0.0)
            })?;
            for joint in &mut joints {
                *joint = joint.within(&radius);
            }
        }
        let range =
            Range::new(low, high).map_err(|why| refuse(CLAIM, &why.to_string(), low, high))?;
        frozen(&joints, &range).map_err(|why| match why {
            Unproved::Unstable { joint } => {
                let what = "alone at the middle of the range: roots of N + cΔ are inside";
                let own = refuse(CLAIM, what, low, high);
                loops.get(joint).map_or(own.clone(), |(record, _)| own.on(&record.name))
            }
            why => {
                let what =
                    format!("one circle through −{low:.5} and −{high:.5} has every L_i outside");
                refuse(CLAIM, &linear::failed(&what, why), 0.0, 1.0)
            }
        })
    }
}

/// Behind a drive, velocity answers torque by another law than position does: where joints differ in that and one hears
/// a measured velocity, the loop is not `det(W + diag L_i)`.
fn one_drive(loops: &[(&JointRecord, &LoopModel)]) -> Result<(), Refutation> {
    let measured = loops.iter().any(|(record, model)| {
        record.observer.is_none() && model.velocity == VelocitySource::Measured
    });
    let bits = |i: usize| loops[i].1.drive_bandwidth_hz.map(f64::to_bits);
    let same = (1..loops.len()).all(|i| bits(i) == bits(0));
    let what = "with a measured velocity all joints have the same drive";
    Refutation::unless(CLAIM, what, 0.0, 1.0, same || !measured)
}
