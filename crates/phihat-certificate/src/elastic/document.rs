//! The clause of elastic joints as data.

use phihat_model::Rotor;
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use crate::ArmInertia;

/// Side of a joint's spring on which its position is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EncoderSide {
    /// The rotor, `θ`.
    Motor,
    /// The link, `q`.
    Link,
}

impl EncoderSide {
    /// Side that a study states.
    pub fn of(study: &Study) -> Self {
        if study.sensor.at_motor { Self::Motor } else { Self::Link }
    }

    /// The opposite side.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Motor => Self::Link,
            Self::Link => Self::Motor,
        }
    }

    /// Name in a sentence: "motor" or "link".
    pub fn word(self) -> &'static str {
        match self {
            Self::Motor => "motor",
            Self::Link => "link",
        }
    }
}

/// Rotor, spring and damper of one joint, each by an interval that holds it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElasticJoint {
    /// Rotor inertia `B` behind the gear \[kg·m², kg\].
    pub rotor_kg_m2: (f64, f64),
    /// Stiffness `k` \[N·m/rad, N/m\]; no upper end: up to a rigid joint.
    pub stiffness_nm_rad: (f64, Option<f64>),
    /// Damping `c` of the spring \[N·m·s/rad, N·s/m\].
    pub damping_nm_s_rad: (f64, f64),
}

impl ElasticJoint {
    /// Every joint of a study's arm; `None` where its springs are not stated.
    pub fn of(study: &Study) -> Option<Vec<Self>> {
        let springs = study.springs.stated()?;
        let joints = study.robot.joints.iter().zip(springs);
        let joint = |(joint, spring): (&phihat_model::Joint, &phihat_model::JointSpring)| Self {
            rotor_kg_m2: (joint.armature_at(Rotor::Least), joint.armature_at(Rotor::Most)),
            stiffness_nm_rad: (spring.stiffness.0, Some(spring.stiffness.1)),
            damping_nm_s_rad: spring.damping,
        };
        Some(joints.map(joint).collect())
    }

    /// Largest stiffness \[N·m/rad, N/m\]; infinite: up to a rigid joint.
    pub fn stiffest(&self) -> f64 {
        self.stiffness_nm_rad.1.unwrap_or(f64::INFINITY)
    }
}

/// The arm's loop is stable at every frozen posture with every spring between its rotors and links.
///
/// # Claim
///
/// `B θ̈ + c(θ̇ − q̇) + k(θ − q) = τ`, `M_l q̈ = c(θ̇ − q̇) + k(θ − q)` per joint, with constant rotor inertia `B`,
/// stiffness `k` and damping `c` anywhere in each joint's own intervals, and any constant link inertia `M_l` between
/// `low·S` and `high·S`, `S` the diagonal matrix of `links.nominal_kg_m2`: the sampled law, with its delay and drive,
/// is stable, also where each joint's torque is multiplied by any `1/(1 + δ_i)`, `δ_i` stable with `|δ_i| ≤ modulus`.
///
/// # Proof
///
/// Theorem C of docs/theory/elastic.md: with `L_i` the joint's loop per unit of acceleration of what its encoder
/// reads, and `G = ω²/(k + jωc)`, the links are connected at each joint to one scalar
///
/// ```text
/// motor:  1/L″ = 1/(B + L) − G           link:  1/L″ = (1 − GB)/(B + L) as (EL1)
/// ```
///
/// and `det(M_l + diag L″) = 0` has no root on the frequency axis if at every frequency one circle through `−low` and
/// `−high` has all `L″` outside, as in [`crate::FrozenArm`].
///
/// # Evidence
///
/// None is needed: [`Self::verify`] covers frequencies and springs by cells.
///
/// # Not claimed
///
/// Frequencies of the springs' motion above half the sample rate, which the samples fold back (assumption A-EL3);
/// postures that move; backlash; any bound on the error of an arm that bends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElasticJoints {
    /// Side of the springs on which positions are read.
    pub encoder: EncoderSide,
    /// Share by which the torques of all joints may be wrong together; the modulus margin where one joint is alone.
    pub modulus: f64,
    /// Smallest eigenvalue of the links' inertia, in units of `S`, that the claim holds for.
    pub low: f64,
    /// Largest eigenvalue of the links' inertia, in units of `S`, that the claim holds for.
    pub high: f64,
    /// Range of the inertia of the links alone, rotors left out, in units of a diagonal `S` that any is right for.
    pub links: ArmInertia,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<ElasticJoint>,
}
