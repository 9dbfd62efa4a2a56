//! That the arm's range of inertia says what it is, and that its witnesses are those of a range.

use crate::check::agree::agrees;
use crate::{ArmBasis, ArmInertia, Refutation, Searched};

/// Two ways to compute the same number of a document.
const SAME: f64 = 1e-9;

impl ArmInertia {
    pub(crate) fn plausible(&self) -> Result<(), Refutation> {
        let sensible = 0.0 < self.low && self.low <= self.high && self.high.is_finite();
        Refutation::unless("arm", "0 < low ≤ high < ∞", self.low, self.high, sensible)?;
        if let Some(searched) = &self.searched {
            searched.agrees(self.low, self.high)?;
        }
        let told = !self.source.trim().is_empty();
        Refutation::unless("arm", "the range says where it comes from", 0.0, 0.0, told)?;
        let apart = self.searched.is_none() || self.basis == ArmBasis::Postures;
        Refutation::unless("arm", "only postures have witnesses", 0.0, 0.0, apart)?;
        self.searched.as_ref().map_or(Ok(()), |searched| searched.plausible(self))
    }
}

impl Searched {
    /// That the witnesses are those of a range.
    fn plausible(&self, arm: &ArmInertia) -> Result<(), Refutation> {
        let n = arm.nominal_kg_m2.len();
        for (what, witness, end) in [("low", &self.low, arm.low), ("high", &self.high, arm.high)] {
            let name = format!("{what} is its witness's eigenvalue");
            agrees("arm", &name, (end, witness.eigenvalue), SAME)?;
            let sized = witness.q.len() == n && witness.q.iter().all(|q| q.is_finite());
            let (own, right) = (witness.q.len() as f64, n as f64);
            Refutation::unless("arm", "a witness is a posture of the arm", own, right, sized)?;
            let all = witness.com_m.iter().chain(&witness.inertia_kg_m2);
            let finite = witness.mass_kg >= 0.0
                && all.chain([&witness.mass_kg]).all(|value| value.is_finite());
            let mass = witness.mass_kg;
            Refutation::unless("arm", "a witness's payload is a body", mass, 0.0, finite)?;
        }
        let tried = f64::from(self.postures);
        let some = self.postures > 0 && self.of_reference <= self.postures;
        Refutation::unless("arm", "some postures were looked at", tried, 0.0, some)?;
        if let Some(proved) = &self.proved {
            let low = 0.0 < proved.low && proved.low <= arm.low * (1.0 + SAME);
            Refutation::unless("arm", "0 < proved.low ≤ low", proved.low, arm.low, low)?;
            let high = proved.high.is_finite() && proved.high >= arm.high * (1.0 - SAME);
            Refutation::unless("arm", "high ≤ proved.high < ∞", arm.high, proved.high, high)?;
        }
        Ok(())
    }
}
