//! That the claims about one joint hold, cover the arm's whole range of inertia, and leave none out without a reason.

use crate::check::agree::agrees;
use crate::check::plausible::at_most;
use crate::refutation::refuse;
use crate::{ArmInertia, Certificate, JointCertificate, JointRecord, Phi, Refutation, UnitLaw};

const CLAIM: &str = "certificate";

/// Inertia ratios at which figures are computed over the arm's range, logarithmically even, both ends among them.
pub const RATIOS: u32 = 9;

/// Two ways to compute the same number of a document.
const SAME: f64 = 1e-9;

impl JointCertificate {
    /// Checks the claims; those that do not depend on the nominal inertia only where they are not `told` already.
    pub(super) fn verify(
        &self,
        record: &JointRecord,
        whole: &Certificate,
        told: bool,
    ) -> Result<(), Refutation> {
        if let Some(phi) = &self.phi {
            phi.plausible()?;
        }
        if !self.refused.is_empty() {
            // What is said about the range rests on what is refused.
            let rests = [
                self.margins.is_some(),
                self.sampled.is_some(),
                self.reading.is_some(),
                self.reference.is_some(),
                self.noise.is_some(),
                self.step.is_some(),
                self.bounds.is_some(),
            ];
            let bare = rests.iter().all(|there| !there);
            Refutation::unless(CLAIM, "no claim rests on a refused one", 1.0, 0.0, bare)?;
        }
        self.covers(record, whole)?;
        if !told {
            self.verify_loop(record)?;
        }
        if !self.refused.is_empty() {
            return Ok(());
        }
        if let Some(noise) = &self.noise {
            noise.verify(record, &self.model)?;
        }
        if let Some(step) = &self.step {
            step.verify(record, &self.model, self.limits)?;
        }
        self.verify_bounds(record, whole)
    }

    /// Returns true if all that does not depend on the nominal inertia is the same. It is then already proved
    /// where the law is the same too.
    pub(super) fn tells_the_same(&self, other: &Self) -> bool {
        self.model == other.model
            && self.window == other.window
            && self.varying == other.varying
            && self.sampled_varying == other.sampled_varying
            && self.continuous == other.continuous
            && self.margins == other.margins
            && self.sampled == other.sampled
            && self.reading == other.reading
            && self.reference == other.reference
    }

    /// Continuous law and sampled loop, at whatever nominal inertia.
    fn verify_loop(&self, record: &JointRecord) -> Result<(), Refutation> {
        let positions = record.observer.is_some();
        let told = self.continuous.is_some() != positions;
        let what = "claims about continuous time are there, but for a law from positions";
        Refutation::unless(CLAIM, what, 0.0, 1.0, told)?;
        if let Some(continuous) = &self.continuous {
            continuous.verify(&UnitLaw::from(record))?;
        }
        if let Some(varying) = &self.varying {
            Refutation::unless(CLAIM, "the law has a continuous form", 0.0, 1.0, !positions)?;
            varying.verify(record)?;
        }
        if let Some(varying) = &self.sampled_varying {
            varying.verify(record, &self.model)?;
        }
        if let Some(window) = &self.window {
            window.verify(record, &self.model)?;
        }
        if let Some(margins) = &self.margins {
            margins.verify(record, &self.model)?;
        }
        if let Some(sampled) = &self.sampled {
            sampled.verify(record, &self.model)?;
        }
        if let Some(reading) = &self.reading {
            reading.verify(record, &self.model)?;
        }
        if let Some(reference) = &self.reference {
            reference.verify(record, &self.model)?;
        }
        Ok(())
    }

    /// That the claims are about the arm's whole range of inertia, and none is missing without a reason.
    fn covers(&self, record: &JointRecord, whole: &Certificate) -> Result<(), Refutation> {
        if !self.refused.is_empty() {
            return Ok(());
        }
        let arm = &whole.arm;
        let (Some(window), Some(margins), Some(sampled), Some(step)) =
            (&self.window, &self.margins, &self.sampled, &self.step)
        else {
            return Err(refuse(
                CLAIM,
                "a claim that is missing is refused with its reason",
                0.0,
                1.0,
            ));
        };
        let (low, high) = (arm.low / whole.window_margin, arm.high * whole.window_margin);
        let lower = format!("window.low ≤ arm.low/{}", whole.window_margin);
        at_most("inertia window", &lower, window.low, low)?;
        let upper = format!("{}·arm.high ≤ window.high", whole.window_margin);
        at_most("inertia window", &upper, high, window.high)?;
        agrees("margins", "low is arm.low", (margins.low, arm.low), SAME)?;
        agrees("margins", "high is arm.high", (margins.high, arm.high), SAME)?;
        tried("sampled peak gains", &sampled.mu, arm)?;
        let told = self.reference.is_some() || !record.fed_in_time(&self.model);
        Refutation::unless("reference error", "it is told, or there is none", 0.0, 1.0, told)?;
        if let Some(reference) = &self.reference {
            tried("reference error", &reference.mu, arm)?;
            let fed = reference.feed_forward;
            Refutation::unless("reference error", "M̄q̈_d is fed forward", 0.0, 1.0, fed)?;
        }
        tried("largest step", &step.mu, arm)?;
        let together = self.reading.is_some() == self.noise.is_some();
        Refutation::unless(
            CLAIM,
            "reading error and torque noise go together",
            0.0,
            0.0,
            together,
        )?;
        if let (Some(reading), Some(noise)) = (&self.reading, &self.noise) {
            tried("reading error", &reading.mu, arm)?;
            tried("torque noise", &noise.mu, arm)?;
        }
        Ok(())
    }
}

/// Figures are found at the ratios that the range itself gives: no document chooses where it is looked at.
fn tried(claim: &str, mu: &[f64], arm: &ArmInertia) -> Result<(), Refutation> {
    let (own, wanted) = (mu.len() as f64, f64::from(RATIOS));
    let all = mu.len() == RATIOS as usize;
    Refutation::unless(claim, "as many ratios as are tried", own, wanted, all)?;
    for (k, mu) in (0..RATIOS).zip(mu) {
        let share = f64::from(k) / f64::from(RATIOS - 1);
        let even = arm.low * libm::pow(arm.high / arm.low, share);
        agrees(claim, "ratios are even over the arm's range", (*mu, even), SAME)?;
    }
    Ok(())
}

impl Phi {
    /// Bounds are sizes.
    fn plausible(&self) -> Result<(), Refutation> {
        let motion = self.motion.map(|m| [m.velocity_rad_s, m.acceleration_rad_s2, m.jerk_rad_s3]);
        let all = [self.rate_nm_s, self.jump_nm].into_iter().chain(self.size_nm);
        for value in all.chain(motion.into_iter().flatten()) {
            at_most("phi", "0 ≤ bound", 0.0, value)?;
            at_most("phi", "bound < ∞", value, f64::MAX)?;
        }
        let told = !self.source.trim().is_empty();
        Refutation::unless("phi", "the bounds say where they come from", 0.0, 0.0, told)
    }
}
