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

#[cfg(test)]
mod tests {
    use super::Tier;
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
}
