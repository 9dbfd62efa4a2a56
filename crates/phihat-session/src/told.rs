//! The motion that the tube of gains is around: what the study's controller is told of it.

use phihat_design::Gains;
use phihat_design::tube::Desired;
use phihat_sim::{Motion, SimError, fed_along};
use phihat_study::Study;

/// The motion of a study as its controller is told of it, sampled once for all the gains that are tried.
pub(crate) struct Told<'s> {
    study: &'s Study,
    motion: Motion,
    bare: Desired,
}

impl<'s> Told<'s> {
    /// # Errors
    ///
    /// [`SimError`]: the arm cannot follow the reference.
    pub(crate) fn of(study: &'s Study) -> Result<Self, SimError> {
        let motion = Motion::of(study)?;
        let bare = Desired::of(study, |joint, t| motion.told(joint, t));
        Ok(Self { study, motion, bare })
    }

    /// With what the study feeds forward, which goes by the gains' `M̄`.
    ///
    /// # Errors
    ///
    /// [`SimError`]: what is fed forward is no torque of an arm.
    pub(crate) fn to(&self, gains: &Gains) -> Result<Desired, SimError> {
        let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
        let samples = self.bare.q.len() / inertia.len().max(1);
        let fed = fed_along(self.study, &self.motion, &inertia, samples)?;
        Ok(self.bare.clone().feeding(&fed))
    }
}
