//! Check that a tube is of one arm, one loop and one run; that no run leaves it is not shown here.

use crate::check::agree::agrees;
use crate::check::plausible::at_most;
use crate::{Certificate, JointCertificate, Refutation, Tube, TubeJoint};

const CLAIM: &str = "tube";

/// Two ways to compute the same number of a document.
const SAME: f64 = 1e-9;

/// Four digits, rounded up.
const ROUNDING: f64 = 1.0 + 2e-3;

impl Certificate {
    /// The tube fits the rest of the document: joints, length, limits, quantum; its summaries are those of its bins.
    ///
    /// # Errors
    ///
    /// The first [`Refutation`].
    pub(super) fn tube_fits(&self) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        let both = self.tube.is_some() && self.tube_refused.is_some();
        yes(CLAIM, "a tube, or the reason why there is none", 1.0, 0.0, !both)?;
        let Some(tube) = &self.tube else { return Ok(()) };
        let whole = self.refused().is_none();
        yes(CLAIM, "no claim rests on a refused one", 1.0, 0.0, whole)?;
        let count = tube.joints.len();
        let all = count == self.joints.len()
            && tube.quantum_rad.len() == count
            && tube.coulomb_nm.0.len() == count
            && tube.coulomb_nm.1.len() == count;
        yes(CLAIM, "one entry per joint", count as f64, self.joints.len() as f64, all)?;
        let lasting = tube.bin_s > 0.0 && tube.bin_s.is_finite() && tube.slices > 0;
        yes(CLAIM, "0 < bin < ∞, at least one slice", tube.bin_s, 0.0, lasting)?;
        agrees(CLAIM, "length of the run", (tube.duration_s, self.duration_s), SAME)?;
        at_most(CLAIM, "0 ≤ settling time", 0.0, tube.settle_s)?;
        at_most(CLAIM, "settling time ≤ length of the run", tube.settle_s, tube.duration_s)?;
        if let Some(settle) = self.settle {
            agrees(CLAIM, "one settling time", (tube.settle_s + 1.0, settle.settle_s + 1.0), SAME)?;
        }
        yes(CLAIM, "no limit can act", 0.0, 1.0, tube.limits_silent)?;
        self.payload(tube)?;
        for (i, (own, joint)) in tube.joints.iter().zip(&self.joints).enumerate() {
            let named = |why: Refutation| why.on(&joint.name);
            let same = own.name == joint.name;
            yes(CLAIM, "joint names agree", 0.0, 0.0, same).map_err(named)?;
            own.whole(tube, joint.model.period_s).map_err(named)?;
            let level = (tube.coulomb_nm.0[i], tube.coulomb_nm.1[i]);
            at_most(CLAIM, "0 ≤ dry friction", 0.0, level.0).map_err(named)?;
            at_most(CLAIM, "low ≤ high level of dry friction", level.0, level.1).map_err(named)?;
            at_most(CLAIM, "dry friction < ∞", level.1, f64::MAX).map_err(named)?;
            reads(tube.quantum_rad[i], joint).map_err(named)?;
            within(own, joint).map_err(named)?;
        }
        tube.tip.as_ref().map_or(Ok(()), |tip| tip.fits(tube))
    }

    fn payload(&self, tube: &Tube) -> Result<(), Refutation> {
        let set = &tube.payload;
        at_most(CLAIM, "0 ≤ lightest payload", 0.0, set.mass_kg.0)?;
        at_most(CLAIM, "lightest ≤ heaviest payload", set.mass_kg.0, set.mass_kg.1)?;
        at_most(CLAIM, "heaviest payload < ∞", set.mass_kg.1, f64::MAX)?;
        at_most(CLAIM, "0 ≤ radius of gyration", 0.0, set.gyration_m)?;
        at_most(CLAIM, "radius of gyration < ∞", set.gyration_m, f64::MAX)?;
        for (low, high) in set.com_m {
            at_most(CLAIM, "ends of the centre of mass's box are in order", low, high)?;
            at_most(CLAIM, "|centre of mass| < ∞", low.abs().max(high.abs()), f64::MAX)?;
        }
        let Some(searched) = &self.arm.searched else { return Ok(()) };
        let same = searched.frame == set.frame;
        Refutation::unless(CLAIM, "payload's frame is that of the range", 0.0, 0.0, same)
    }
}

impl TubeJoint {
    fn whole(&self, tube: &Tube, period: f64) -> Result<(), Refutation> {
        let samples = (tube.duration_s / period).round().max(1.0);
        let bins = (samples / (tube.bin_s / period).round().max(1.0)).ceil();
        let (e, v) = (
            (&self.error_low_rad, &self.error_high_rad),
            (&self.velocity_low_rad_s, &self.velocity_high_rad_s),
        );
        for list in [e.0, e.1, v.0, v.1, &self.torque_step_nm] {
            let enough = (list.len() as f64 - bins).abs() < 0.5;
            Refutation::unless(
                CLAIM,
                "bins from the start to the end of the run",
                list.len() as f64,
                bins,
                enough,
            )?;
        }
        for ((low, high), claimed, what) in [
            (e, self.error_bound_rad, "largest |e| from the settling time on"),
            (v, self.velocity_error_bound_rad_s, "largest |ė| from the settling time on"),
        ] {
            let mut most = 0.0_f64;
            for (bin, (low, high)) in low.iter().zip(high).enumerate() {
                at_most(CLAIM, "low ≤ high", *low, *high)?;
                at_most(CLAIM, "|bound| < ∞", low.abs().max(high.abs()), f64::MAX)?;
                if (bin + 1) as f64 * tube.bin_s > tube.settle_s + 1e-12 {
                    most = most.max(low.abs()).max(high.abs());
                }
            }
            agrees(CLAIM, what, (claimed + 1.0, most + 1.0), 1e-15)?;
            agrees(CLAIM, what, (claimed, most), SAME)?;
        }
        self.steps(tube)
    }

    /// Torque steps are sizes, and their summaries those of the bins.
    fn steps(&self, tube: &Tube) -> Result<(), Refutation> {
        let (mut whole, mut steady) = (0.0_f64, 0.0_f64);
        for (bin, step) in self.torque_step_nm.iter().enumerate() {
            at_most(CLAIM, "0 ≤ torque step", 0.0, *step)?;
            at_most(CLAIM, "torque step < ∞", *step, f64::MAX)?;
            whole = whole.max(*step);
            if (bin + 1) as f64 * tube.bin_s > tube.settle_s + 1e-12 {
                steady = steady.max(*step);
            }
        }
        agrees(CLAIM, "largest torque step", (self.torque_step_max_nm, whole), SAME)?;
        let what = "largest torque step from the settling time on";
        agrees(CLAIM, what, (self.torque_step_steady_max_nm, steady), SAME)
    }
}

/// One quantum in the whole document.
fn reads(quantum: f64, joint: &JointCertificate) -> Result<(), Refutation> {
    let own = joint.noise.as_ref().map_or(0.0, |noise| noise.quantum_rad);
    agrees(CLAIM, "quantum of the encoder", (quantum + 1.0, own + 1.0), 1e-12)
}

/// That no limit can act is what the largest torque and the largest step say.
fn within(own: &TubeJoint, joint: &JointCertificate) -> Result<(), Refutation> {
    at_most(CLAIM, "0 ≤ torque", 0.0, own.torque_max_nm)?;
    at_most(CLAIM, "torque < ∞", own.torque_max_nm, f64::MAX)?;
    if let Some(limit) = joint.limits.0 {
        at_most(CLAIM, "torque ≤ its limit", own.torque_max_nm, limit * ROUNDING)?;
    }
    if let Some(rate) = joint.limits.1 {
        let step = rate * joint.model.period_s;
        at_most(CLAIM, "torque step ≤ its limit", own.torque_step_max_nm, step * ROUNDING)?;
    }
    Ok(())
}
