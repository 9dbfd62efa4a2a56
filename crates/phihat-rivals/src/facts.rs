//! Facts that a rival can know of an arm before it starts, short of a model, each a type.

use crate::error::RivalRefusal;
use crate::handed::Knows;
use crate::needs::Needs;
use crate::supply::{DesignedJoint, DesignedPosition, Supply};

/// No knowledge of the arm.
#[derive(Debug, Clone, Copy)]
pub struct Nothing;

impl Knows for Nothing {
    const NEEDS: Needs = Needs::NONE;
    fn of(_: &Supply) -> Result<Self, RivalRefusal> {
        Ok(Self)
    }
}

impl<A: Knows, B: Knows> Knows for (A, B) {
    const NEEDS: Needs = A::NEEDS.and(B::NEEDS);
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        Ok((A::of(supply)?, B::of(supply)?))
    }
}

/// One nominal inertia `M̄` per joint \[kg·m²\].
#[derive(Debug, Clone)]
pub struct Inertia(Vec<f64>);

impl Inertia {
    /// `M̄` \[kg·m²\], one entry per joint.
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

impl Knows for Inertia {
    const NEEDS: Needs = Needs { inertia: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        Ok(Self(supply.inertia.clone()))
    }
}

/// The most torque of each joint \[N·m\].
#[derive(Debug, Clone)]
pub struct TorqueMax(Vec<f64>);

impl TorqueMax {
    /// \[N·m\], one entry per joint.
    pub fn values(&self) -> &[f64] {
        &self.0
    }
}

impl Knows for TorqueMax {
    const NEEDS: Needs = Needs { limits: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        match &supply.torque_max {
            Some(values) => Ok(Self(values.clone())),
            None => Err(RivalRefusal::NotApplicable("the arm states no torque limits".to_owned())),
        }
    }
}

/// The limits of an arm that states them; a law that does without where there are none.
impl Knows for Option<TorqueMax> {
    const NEEDS: Needs = TorqueMax::NEEDS;
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        Ok(supply.torque_max.clone().map(TorqueMax))
    }
}

/// The period of the task \[s\].
#[derive(Debug, Clone, Copy)]
pub struct Period(f64);

impl Period {
    /// \[s\]
    pub fn seconds(&self) -> f64 {
        self.0
    }
}

impl Knows for Period {
    const NEEDS: Needs = Needs { period: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        let missing = || RivalRefusal::NotApplicable("the reference has no period".to_owned());
        supply.task_period.map(Self).ok_or_else(missing)
    }
}

/// Gains of this project's law that its own design gave for the arm's specification.
#[derive(Debug, Clone)]
pub struct Designed(Vec<DesignedJoint>);

impl Designed {
    /// One entry per joint.
    pub fn joints(&self) -> &[DesignedJoint] {
        &self.0
    }
}

impl Knows for Designed {
    const NEEDS: Needs = Needs { designed: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        supply.designed.clone().map(Self)
    }
}

/// The same for laws from positions, a law per joint.
#[derive(Debug, Clone)]
pub struct DesignedPositions(Vec<DesignedPosition>);

impl DesignedPositions {
    /// One entry per joint.
    pub fn joints(&self) -> &[DesignedPosition] {
        &self.0
    }
}

impl Knows for DesignedPositions {
    const NEEDS: Needs = Needs { designed: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        supply.designed_positions.clone().map(Self)
    }
}

/// The same for laws that filter their innovation.
#[derive(Debug, Clone)]
pub struct DesignedFilters(Vec<DesignedPosition>);

impl DesignedFilters {
    /// One entry per joint.
    pub fn joints(&self) -> &[DesignedPosition] {
        &self.0
    }
}

impl Knows for DesignedFilters {
    const NEEDS: Needs = Needs { designed: true, filter: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        supply.designed_filters.clone().map(Self)
    }
}

/// When a torque acts, and which torques do: the loop around a law.
#[derive(Debug, Clone)]
pub struct Drives {
    delay: u32,
    most: Option<Vec<f64>>,
    rate: Option<Vec<f64>>,
}

impl Drives {
    /// Samples from a torque's command to its acting.
    pub fn delay(&self) -> u32 {
        self.delay
    }

    /// Largest torque \[N·m\] and largest change of it \[N·m/s\] of a joint, where it has such limits.
    pub fn limits(&self, joint: usize) -> (Option<f64>, Option<f64>) {
        let of = |list: &Option<Vec<f64>>| list.as_ref().and_then(|list| list.get(joint)).copied();
        (of(&self.most), of(&self.rate))
    }
}

impl Knows for Drives {
    const NEEDS: Needs = Needs { delay: true, limits: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        let (most, rate) = (supply.torque_max.clone(), supply.torque_rate_max.clone());
        Ok(Self { delay: supply.delay_samples, most, rate })
    }
}
