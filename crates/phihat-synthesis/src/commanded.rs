//! The motion that the tube of gains is around: as the study's controller receives it.

use phihat_design::Gains;
use phihat_design::tube::Desired;
use phihat_sim::{Motion, SimError, fed_along};
use phihat_study::Study;

/// The motion of a study as its controller receives it, sampled once for all the gains that are tried.
pub(crate) struct Commanded<'s> {
    study: &'s Study,
    motion: Motion,
    bare: Desired,
}

impl<'s> Commanded<'s> {
    /// # Errors
    ///
    /// [`SimError`]: the arm cannot follow the reference.
    pub(crate) fn of(study: &'s Study) -> Result<Self, SimError> {
        let motion = Motion::of(study)?;
        let bare = Desired::of(study, |joint, t| motion.told(joint, t));
        Ok(Self { study, motion, bare })
    }

    /// The same with the study's feed-forward, which goes by the gains' `M̄`.
    ///
    /// # Errors
    ///
    /// [`SimError`]: the feed-forward is no torque of an arm.
    pub(crate) fn desired(&self, gains: &Gains) -> Result<Desired, SimError> {
        let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
        let samples = self.bare.q.len() / inertia.len().max(1);
        let fed = fed_along(self.study, &self.motion, &inertia, samples)?;
        Ok(self.bare.clone().feeding(&fed))
    }
}
