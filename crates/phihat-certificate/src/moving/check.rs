//! Checking stability while moving: the joints' gains and loops, nothing else.

use phihat_kernel::{JointLoop, MovingInertia, Range, Unproved, moving};

use super::document::{Moving, Unstable};
use crate::check::complex::Complex;
use crate::check::response::{CheckedResponse, on_circle};
use crate::check::{linear, plausible};
use crate::{JointRecord, LoopModel, Refutation};

pub(super) const CLAIM: &str = "stability while moving";

/// Most taps of a multiplier.
const TAPS: usize = 4096;

impl Moving {
    /// Proves the claim for joints with their laws in their loops, from nothing else; laws and loops may differ.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the joint and the frequency at which the proof fails.
    pub fn verify(&self, loops: &[(&JointRecord, &LoopModel)]) -> Result<(), Refutation> {
        for needed in self.needed_motion_per_s.into_iter().chain(self.needed_limits_per_s) {
            let sensible = needed >= 0.0 && needed.is_finite();
            Refutation::unless(CLAIM, "0 ≤ needed rate < ∞", needed, 0.0, sensible)?;
        }
        one_clock(CLAIM, loops)?;
        for (i, (gains, model)) in loops.iter().enumerate() {
            let (delta, _) = self.step(model.period_s);
            let same = (self.delta - delta).abs() <= 1e-9 * delta;
            Refutation::unless(CLAIM, "δ = rate·T (1 + χ²/12)", self.delta, delta, same)?;
            if loops[..i].iter().any(|before| same_loop(before, (gains, model))) {
                continue;
            }
            self.stable(gains, model).map_err(|why| refused(CLAIM, why).on(&gains.name))?;
        }
        Ok(())
    }

    /// The proof alone, for one of the joints, in exact arithmetic: whoever looks for a multiplier learns at which
    /// frequency it fails.
    ///
    /// # Errors
    ///
    /// The first inequality that does not hold.
    pub fn stable(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Unstable> {
        let joint = joint(CLAIM, gains, model)?;
        self.plausible()?;
        let nonsense =
            |_| Unstable::new("0 < low ≤ high < ∞".to_owned(), 0.0, (self.low, self.high));
        let motion = MovingInertia {
            range: Range::new(self.low, self.high).map_err(nonsense)?,
            rate: self.rate_per_s,
            period: model.period_s,
            drift: self.drift,
            taps: &self.h,
        };
        let what = "|N + cΔ|² + y Im(NΔ*) > (r² + κ + λη²)(|Δ|² + |K|²/λ) + |K|²y²/4λ";
        moving(core::slice::from_ref(&joint), &motion)
            .map_err(|why| unproved(&joint, (self.low, self.high), what, why))
    }

    fn plausible(&self) -> Result<(), Unstable> {
        let Self { low, high, rate_per_s: rate, drift, .. } = *self;
        let taps = self.h.len() <= TAPS && self.h.iter().all(|h| h.is_finite());
        let all = [
            ("0 < low ≤ high < ∞", low, high, 0.0 < low && low <= high && high.is_finite()),
            ("0 ≤ rate < ∞", rate, 0.0, 0.0 <= rate && rate.is_finite()),
            ("0 < λ < ∞", drift, 0.0, 0.0 < drift && drift.is_finite()),
            ("taps are finite, and not too many", self.h.len() as f64, TAPS as f64, taps),
        ];
        let bad = all.into_iter().find(|(.., holds)| !holds);
        bad.map_or(Ok(()), |(what, left, right, _)| {
            Err(Unstable::new(what.to_owned(), 0.0, (left, right)))
        })
    }
}

/// The loop of a joint whose torque acts at once.
pub(super) fn joint(
    claim: &str,
    gains: &JointRecord,
    model: &LoopModel,
) -> Result<JointLoop, Unstable> {
    let refused = |why: Refutation| Unstable::new(why.inequality, 0.0, (why.left, why.right));
    plausible::gains(claim, gains).map_err(refused)?;
    plausible::model(claim, gains, model).map_err(refused)?;
    if let Some(hz) = model.drive_bandwidth_hz {
        let what = "the torque acts at once: a drive's lag is not in the proof";
        return Err(Unstable::new(what.to_owned(), 0.0, (hz, f64::MAX)));
    }
    linear::joint(claim, gains, model).map_err(refused)
}

/// The inequality that fails, with `|L + c|` and `r` at the frequency, between which motion has no room.
pub(super) fn unproved(
    joint: &JointLoop,
    (low, high): (f64, f64),
    what: &str,
    why: Unproved,
) -> Unstable {
    let theta = if let Unproved::At { theta, .. } = why { theta } else { 0.0 };
    let middle = Complex::new(0.5 * (low + high), 0.0);
    let left = (middle - CheckedResponse::of(joint).crossing(on_circle(theta))).size();
    Unstable::new(linear::failed(what, why), theta, (left, 0.5 * (high - low)))
}

pub(super) fn refused(claim: &str, why: Unstable) -> Refutation {
    let Unstable { inequality, left, right, .. } = why;
    Refutation { claim: claim.to_owned(), inequality, left, right }
}

/// There are joints, and all are sampled together.
pub(super) fn one_clock(
    claim: &str,
    loops: &[(&JointRecord, &LoopModel)],
) -> Result<(), Refutation> {
    let first = loops.first().map(|(_, model)| model.period_s);
    Refutation::unless(claim, "there is a joint", 0.0, 1.0, first.is_some())?;
    let first = first.unwrap_or_default();
    let other = loops.iter().find(|(_, own)| (own.period_s - first).abs() > f64::EPSILON * first);
    let own = other.map_or(first, |(_, model)| model.period_s);
    Refutation::unless(claim, "all joints are sampled together", own, first, other.is_none())
}

/// Returns true if two joints differ in name and `M̄` alone.
pub(super) fn same_loop(
    one: &(&JointRecord, &LoopModel),
    other: (&JointRecord, &LoopModel),
) -> bool {
    let named = JointRecord {
        name: other.0.name.clone(),
        inertia_kg_m2: other.0.inertia_kg_m2,
        ..one.0.clone()
    };
    one.1 == other.1 && named == *other.0
}
