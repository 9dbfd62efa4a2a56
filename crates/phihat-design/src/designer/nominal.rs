//! Distribution of the nominal inertia over the joints.

use phihat_certificate::extremes::{Extremes as _, larger};

use crate::{Arm, ArmError, ArmInertia};

/// Factor of one step on one joint, and most steps.
const STEP: f64 = 1.12;
const STEPS: u32 = 100;

/// Largest ratio of the range of inertia to that with each joint's own mean.
const WIDER: f64 = 1.02;

/// Postures with the smallest and with the largest eigenvalues that are looked at on the way.
const EXTREMES: usize = 80;

/// The arm measured in nominal inertias that serve the specification.
///
/// # Method
///
/// `error[i]/M̄_i` is about the share of its bound that joint `i` uses, `noise[i] M̄_i` that of its torque
/// step. From the mean of each joint's range: the joint with the worst error gets more, or the one with the
/// worst step less, while `max error · max step` falls and the range of inertia of the whole arm, which the
/// law's window has to contain, hardly widens. On most arms the light joints of the wrist may have twice
/// their own mean.
pub(crate) fn shared_out(arm: &Arm, error: &[f64], noise: &[f64]) -> Result<ArmInertia, ArmError> {
    let own = arm.against(arm.nominal())?;
    let few = arm.extremes(&own.nominal_kg_m2, EXTREMES);
    let allowed = WIDER * own.high / own.low;
    let cost = |at: &ArmInertia| {
        let worst = |share: &dyn Fn(usize) -> f64| {
            larger(f64::MIN_POSITIVE, (0..error.len()).map(share).largest())
        };
        let middle = (at.low * at.high).sqrt();
        let of_error = libm::log(worst(&|i| error[i] / (at.nominal_kg_m2[i] * middle)));
        let noisy = noise.iter().any(|n| *n > 0.0);
        let of_noise = libm::log(worst(&|i| noise[i] * at.nominal_kg_m2[i] * middle));
        of_error + if noisy { of_noise } else { 0.0 }
    };
    let mut now = few.against(own.nominal_kg_m2.clone())?;
    let mut way = Vec::new();
    for _ in 0..STEPS {
        let nominal = &now.nominal_kg_m2;
        let most = |share: &dyn Fn(usize) -> f64| {
            (0..nominal.len()).max_by(|a, b| share(*a).total_cmp(&share(*b))).unwrap_or(0)
        };
        let moves = [
            (most(&|i| error[i] / nominal[i]), STEP),
            (most(&|i| noise[i] * nominal[i]), 1.0 / STEP),
        ];
        let mut next: Option<ArmInertia> = None;
        for (joint, factor) in moves {
            let mut changed = nominal.clone();
            changed[joint] *= factor;
            let changed = few.against(changed)?;
            let before = cost(next.as_ref().unwrap_or(&now));
            if changed.high / changed.low <= allowed && cost(&changed) < before {
                next = Some(changed);
            }
        }
        let Some(moved) = next else { break };
        way.push(moved.nominal_kg_m2.clone());
        now = moved;
    }
    // The few postures were those of the mean; all of them decide how far of the way is gone.
    let (mut best, mut gone, mut part) = (own, 0, way.len());
    while part > 0 {
        let at = (gone + part).min(way.len());
        let whole = arm.against(way[at - 1].clone())?;
        if whole.high / whole.low <= allowed * WIDER && cost(&whole) < cost(&best) {
            (best, gone) = (whole, at);
        }
        part = if gone == way.len() { 0 } else { part / 2 };
    }
    Ok(best)
}
