//! Shares of its gravity and friction that a robot leaves to the law: a lightweight arm's interface compensates
//! most of both.

use phihat_study::Study;

/// Shares that are left, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SharesLeft {
    pub(super) gravity: f64,
    pub(super) friction: f64,
}

impl SharesLeft {
    /// The study on such a robot: what is compensated is not there.
    pub(super) fn of(self, study: &Study) -> Study {
        let mut study = study.clone();
        study.world.gravity.iter_mut().for_each(|g| *g *= self.gravity);
        for joint in &mut study.robot.joints {
            let friction = &mut joint.friction;
            friction.viscous *= self.friction;
            friction.coulomb *= self.friction;
            if let Some(sigmoid) = &mut friction.sigmoid {
                sigmoid.amplitude_nm *= self.friction;
            }
        }
        let extra = study.world.extra_coulomb.iter_mut().chain(&mut study.world.extra_viscous);
        extra.for_each(|torque| *torque *= self.friction);
        study
    }

    /// `0 % of the gravity, 5 % of the friction`.
    pub(super) fn words(self) -> String {
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        format!(
            "{} of the gravity, {} of the friction",
            percent(self.gravity),
            percent(self.friction)
        )
    }
}
