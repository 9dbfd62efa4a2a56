//! Stability of a coupled arm at every frozen posture where each joint has a law of its own.

use phihat::VelocitySource;
use serde::{Deserialize, Serialize};

use crate::check::complex::Disc;
use crate::check::exclusion::{Family, over_arcs};
use crate::check::plausible;
use crate::check::returns::{Return, Returns};
use crate::{JointRecord, LoopModel, Refutation, refutation::refuse};

const CLAIM: &str = "laws of their own";

/// The arm's loop is stable at every frozen posture whose inertia, in units of the gains' `M̄`, lies in `[low, high]`.
///
/// # Claim
///
/// For every constant symmetric `W` with its spectrum in `[a, b] = [low, high]`, the loop
/// `det(W + diag L_i(z)) = 0` has all its roots inside the unit circle, `L_i` joint `i`'s own loop per unit
/// of its `M̄`. Needed where laws differ: with one law, each eigenvalue of `W` is a loop by itself.
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
/// the set and no root crosses; at `W = c` each joint is a loop by itself, and stable.
///
/// # Evidence
///
/// None is needed: [`Self::verify`] cuts the circle into arcs and finds `y/x` for each, by disc arithmetic.
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
}

impl FrozenArm {
    /// Proves the claim for joints with their laws in their loops.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the frequency at which no circle is found, or the joint that is not stable by itself.
    pub fn verify(&self, loops: &[(&JointRecord, &LoopModel)]) -> Result<(), Refutation> {
        let Self { low, high } = *self;
        let sensible = 0.0 < low && low <= high && high.is_finite();
        Refutation::unless(CLAIM, "0 < low ≤ high < ∞", low, high, sensible)?;
        let one_clock = loops.windows(2).all(|pair| {
            let of = |i: usize| pair[i].1.period_s;
            (of(0) - of(1)).abs() <= f64::EPSILON * of(0)
        });
        Refutation::unless(CLAIM, "all joints are sampled together", 0.0, 1.0, one_clock)?;
        let mut returns = Vec::with_capacity(loops.len());
        for (record, model) in loops {
            plausible::gains(CLAIM, record)?;
            plausible::model(CLAIM, record, model)?;
            let own = Returns::new(record, model);
            let middle = (low * high).sqrt();
            Family { returns: &own, low: middle, high: middle }
                .stable(CLAIM, (1.0, 0.0, 0))
                .map_err(|why| why.on(&record.name))?;
            returns.push(own);
        }
        one_drive(loops)?;
        let proved = over_arcs(1.0, |arc| {
            let sides = returns.iter().map(|own| Sides::of(&own.at(arc.disc), (low, high)));
            one_circle(sides)
        });
        proved.map_err(|theta| {
            let what = format!(
                "one circle through −{low:.5} and −{high:.5} has every L_i outside at θ = {theta:.6} rad/sample"
            );
            refuse(CLAIM, &what, 0.0, 1.0)
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

/// Bounds of `Re((N + aΔ)(N + bΔ)*)` and `Im(NΔ*)` over an arc.
struct Sides {
    apart_low: f64,
    turned: (f64, f64),
}

impl Sides {
    fn of(at: &Return, (low, high): (f64, f64)) -> Self {
        let conjugate = |disc: Disc| Disc::new(disc.centre.conjugate(), disc.radius);
        let sum = |end: f64| at.back + at.open.times(end);
        let apart = sum(low) * conjugate(sum(high));
        let turned = at.back * conjugate(at.open);
        let (re, im) = (apart.centre.re, turned.centre.im);
        Self { apart_low: re - apart.radius, turned: (im - turned.radius, im + turned.radius) }
    }
}

/// Returns true if one `κ = y/x` serves all joints: `f + κg > 0` over every box of `f`, `g`.
fn one_circle(sides: impl Iterator<Item = Sides>) -> bool {
    // κ ≥ 0 asks `f_low + κ g_low > 0`, κ ≤ 0 `f_low + |κ| (−g_high) > 0`.
    let mut halves = [(0.0_f64, f64::INFINITY); 2];
    for Sides { apart_low, turned } in sides {
        for (half, slope) in halves.iter_mut().zip([turned.0, -turned.1]) {
            let (least, most) = half;
            if apart_low > 0.0 {
                if slope < 0.0 {
                    *most = most.min(-apart_low / slope);
                }
            } else if slope > 0.0 && apart_low.is_finite() {
                *least = least.max(-apart_low / slope);
            } else {
                // NaN is no proof either.
                *most = -1.0;
            }
        }
    }
    halves.iter().any(|(least, most)| least * (1.0 + 1e-9) < *most && *most > 0.0)
}
