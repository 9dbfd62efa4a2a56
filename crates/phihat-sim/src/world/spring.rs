//! Springs in the joints: end stops and elastic transmissions.

use phihat_study::{Flexibility, Study};

/// A stop at each end of a joint's travel; it only ever pushes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EndStop {
    low: f64,
    high: f64,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
}

impl EndStop {
    /// One per joint, where the study has them.
    pub(super) fn all(study: &Study) -> Option<Vec<Self>> {
        let asked = study.world.end_stops.as_ref()?;
        let stop = |(i, joint): (usize, &phihat_model::Joint)| {
            let (low, high) = joint.position.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            Self { low, high, stiffness: asked.stiffness[i], damping: asked.damping[i] }
        };
        Some(study.robot.joints.iter().enumerate().map(stop).collect())
    }

    /// Torque on the joint: `−k x − d v` at a depth `x` beyond the limit, never pulling.
    pub(super) fn torque(&self, q: f64, dq: f64) -> f64 {
        if q > self.high {
            (-self.stiffness * (q - self.high) - self.damping * dq).min(0.0)
        } else if q < self.low {
            (-self.stiffness * (q - self.low) - self.damping * dq).max(0.0)
        } else {
            0.0
        }
    }
}

/// The spring between a joint's rotor and its link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transmission {
    /// Rotor inertia \[kg·m²\].
    pub(super) rotor: f64,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    /// Half of the play.
    play: f64,
}

impl Transmission {
    pub(super) fn all(study: &Study, asked: &Flexibility) -> Vec<Self> {
        let spring = |(i, joint): (usize, &phihat_model::Joint)| Self {
            rotor: joint.armature,
            stiffness: asked.stiffness[i],
            damping: asked.damping[i],
            play: 0.5 * asked.backlash[i],
        };
        study.robot.joints.iter().enumerate().map(spring).collect()
    }

    /// Torque on the link, for a rotor that is ahead by `twist` and faster by `rate`: nothing inside the
    /// play, and flanks that push but do not pull.
    pub(super) fn torque(&self, twist: f64, rate: f64) -> f64 {
        if self.play <= 0.0 {
            return self.stiffness * twist + self.damping * rate;
        }
        if twist > self.play {
            (self.stiffness * (twist - self.play) + self.damping * rate).max(0.0)
        } else if twist < -self.play {
            (self.stiffness * (twist + self.play) + self.damping * rate).min(0.0)
        } else {
            0.0
        }
    }

    /// Twist at which the spring gives a torque \[N·m\] at rest.
    pub(super) fn twist(&self, torque: f64) -> f64 {
        torque / self.stiffness + self.play.copysign(torque)
    }
}

#[cfg(test)]
mod tests {
    use super::{EndStop, Transmission};

    /// Wrong if a flank or a stop could pull, or play did not separate the flanks.
    #[test]
    fn flanks_and_stops_push_only() {
        let spring = Transmission { rotor: 0.1, stiffness: 100.0, damping: 2.0, play: 0.01 };
        for twist in [-0.01, -0.005, 0.0, 0.0099] {
            assert!(spring.torque(twist, 5.0).abs() <= 0.0);
        }
        assert!((spring.torque(0.03, 0.0) - 2.0).abs() < 1e-12);
        assert!((spring.torque(-0.03, 0.0) + 2.0).abs() < 1e-12);
        assert!(spring.torque(0.02, -10.0).abs() <= 0.0);
        assert!((spring.torque(spring.twist(1.7), 0.0) - 1.7).abs() < 1e-12);
        let stop = EndStop { low: -1.0, high: 1.0, stiffness: 50.0, damping: 3.0 };
        assert!(stop.torque(0.99, 9.0).abs() <= 0.0 && stop.torque(1.1, -9.0).abs() <= 0.0);
        assert!((stop.torque(1.1, 1.0) + 8.0).abs() < 1e-12);
        assert!((stop.torque(-1.1, -1.0) - 8.0).abs() < 1e-12);
    }
}
