//! Checking stability while moving: the joints' gains and loops, nothing else.

use super::arcs::Proof;
use super::document::{Moving, Unstable};
use crate::check::plausible;
use crate::check::returns::Returns;
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
        let some = !loops.is_empty();
        Refutation::unless(CLAIM, "there is a joint", 0.0, 1.0, some)?;
        for (i, (gains, model)) in loops.iter().enumerate() {
            let (delta, _) = self.step(model.period_s);
            let same = (self.delta - delta).abs() <= 1e-9 * delta;
            Refutation::unless(CLAIM, "δ = rate·T (1 + χ²/12)", self.delta, delta, same)?;
            let (own, first) = (model.period_s, loops[0].1.period_s);
            let one_clock = (own - first).abs() <= f64::EPSILON * first;
            Refutation::unless(CLAIM, "all joints are sampled together", own, first, one_clock)?;
            if loops[..i].iter().any(|before| same_loop(before, (gains, model))) {
                continue;
            }
            self.stable(gains, model).map_err(|why| refused(why).on(&gains.name))?;
        }
        Ok(())
    }

    /// The proof alone, for one of the joints: whoever looks for a multiplier learns at which frequency it fails.
    ///
    /// # Errors
    ///
    /// The first inequality that does not hold.
    pub fn stable(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Unstable> {
        let refused = |why: Refutation| Unstable::new(why.inequality, 0.0, (why.left, why.right));
        plausible::gains(CLAIM, gains).map_err(refused)?;
        plausible::model(CLAIM, gains, model).map_err(refused)?;
        self.plausible()?;
        if let Some(hz) = model.drive_bandwidth_hz {
            let what = "the torque acts at once: a drive's lag is not in the proof";
            return Err(Unstable::new(what.to_owned(), 0.0, (hz, f64::MAX)));
        }
        Proof::new(self, &Returns::new(gains, model), model.period_s).run()
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

fn refused(why: Unstable) -> Refutation {
    let Unstable { inequality, left, right, .. } = why;
    Refutation { claim: CLAIM.to_owned(), inequality, left, right }
}

/// Returns true if two joints differ in name and `M̄` alone.
fn same_loop(one: &(&JointRecord, &LoopModel), other: (&JointRecord, &LoopModel)) -> bool {
    let named = JointRecord {
        name: other.0.name.clone(),
        inertia_kg_m2: other.0.inertia_kg_m2,
        ..one.0.clone()
    };
    one.1 == other.1 && named == *other.0
}
