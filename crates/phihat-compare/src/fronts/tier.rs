//! Knowledge that laws have of the arm: laws are compared at equal knowledge.

use phihat_rivals::Needs;
use serde::{Deserialize, Serialize};

/// Amount of knowledge of the arm that a law gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tier {
    /// Nothing but what scales the gains of all laws: one nominal inertia per joint.
    Nothing,
    /// That inertia in the law itself, friction or torque limits per joint, or gains that were designed for a
    /// range of inertia.
    PerJoint,
    /// Gravity, a regressor, the tip's kinematics or the whole model: masses wrong by up to 30 %, the same
    /// draw for all.
    Model,
}

impl Tier {
    /// All, from the least knowledge.
    pub const ALL: [Self; 3] = [Self::Nothing, Self::PerJoint, Self::Model];

    /// Of a law with these needs.
    pub fn of(needs: &Needs) -> Self {
        if !needs.model_free() || needs.orbit {
            Self::Model
        } else if needs.inertia || needs.designed || needs.friction || needs.dry || needs.limits {
            Self::PerJoint
        } else {
            Self::Nothing
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Nothing => "no knowledge of the arm",
            Self::PerJoint => "one inertia, friction or limit per joint",
            Self::Model => "a model of the arm, masses up to 30 % wrong",
        }
    }
}

/// Knowledge of the loop's time that a law gets, whatever its tier: the same for all laws, this project's or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LoopKnowledge {
    /// The exact delay of each drawn world, in samples.
    pub delay: bool,
    /// The reference at the time when the torque of a sample will act.
    pub preview: bool,
}

impl LoopKnowledge {
    /// All that laws may have, from the least.
    pub const ALL: [Self; 4] = [
        Self { delay: false, preview: false },
        Self { delay: true, preview: false },
        Self { delay: false, preview: true },
        Self { delay: true, preview: true },
    ];

    /// Of a law with these needs.
    pub fn of(needs: &Needs) -> Self {
        Self { delay: needs.delay, preview: needs.preview }
    }

    /// True if another law has all of this too.
    pub fn within(self, other: Self) -> bool {
        self.delay <= other.delay && self.preview <= other.preview
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match (self.delay, self.preview) {
            (false, false) => "neither delay nor preview",
            (true, false) => "the delay",
            (false, true) => "a preview",
            (true, true) => "delay and preview",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{LoopKnowledge, Tier};
    use crate::sure::Sure as _;
    use phihat_rivals::{RIVALS, rival};

    /// Laws of which everybody knows what they are handed.
    #[test]
    fn laws_are_among_their_equals() {
        for (id, tier) in [
            ("pd", Tier::Nothing),
            ("time-delay", Tier::PerJoint),
            ("proposed-positions-designed", Tier::PerJoint),
            ("pd-gravity", Tier::Model),
            ("computed-torque-integral", Tier::Model),
            ("slotine-li", Tier::Model),
            ("inverse-dynamics-qp", Tier::Model),
        ] {
            assert_eq!(Tier::of(&rival(id).sure().needs), tier, "{id}");
        }
        for tier in Tier::ALL {
            assert!(RIVALS.iter().any(|entry| Tier::of(&entry.needs) == tier), "{tier:?}");
        }
    }

    /// The law from positions is handed both, the programme over the limits a preview, and most laws neither.
    #[test]
    fn timing_is_what_a_law_is_handed() {
        for (id, timing) in [
            ("pd", LoopKnowledge { delay: false, preview: false }),
            ("proposed-1", LoopKnowledge { delay: false, preview: false }),
            ("inverse-dynamics-qp", LoopKnowledge { delay: true, preview: true }),
            ("proposed-positions-designed", LoopKnowledge { delay: true, preview: true }),
        ] {
            assert_eq!(LoopKnowledge::of(&rival(id).sure().needs), timing, "{id}");
        }
        let [neither, delay, preview, both] = LoopKnowledge::ALL;
        assert!(neither.within(delay) && preview.within(both) && delay.within(delay));
        assert!(!delay.within(preview) && !preview.within(delay) && !both.within(delay));
    }
}
