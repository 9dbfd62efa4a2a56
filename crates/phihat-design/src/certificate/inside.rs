//! Check that an arm's inertia lies inside a window.

use crate::ArmInertia;
use crate::claims::Refutation;
use crate::claims::law::holds;
use crate::sampled::InertiaWindow;

/// Checks that an arm's range, widened by the margin, lies inside a window.
pub(crate) fn inside(
    window: &InertiaWindow,
    arm: &ArmInertia,
    margin: f64,
) -> Result<(), Refutation> {
    let (low, high) = (arm.low / margin, arm.high * margin);
    let claim = "inertia window";
    let lower = format!("window.low ≤ arm.low/{margin}");
    holds(claim, &lower, window.low, low, window.low <= low)?;
    let upper = format!("{margin}·arm.high ≤ window.high");
    holds(claim, &upper, high, window.high, high <= window.high)
}
