//! The law of this project among the rivals: which gains it runs with.

use phihat_design::claims::UnitLaw;
use phihat_design::{ArmError, Clause, DesignError, Outcome, design};
use phihat_rivals::{DesignedJoint, Entry, rival};
use phihat_sim::{Demand, SimError};
use phihat_study::{DesignMethod, Study};
use phihat_synthesis::{arm_along, phi_along};
use thiserror::Error;

/// Why there are no designed gains. A comparison records it as the refusal of the rows that need them.
#[derive(Debug, Error)]
pub(crate) enum NotDesigned {
    /// The load along the reference cannot be computed.
    #[error(transparent)]
    Load(#[from] SimError),
    /// The inertia of the arm cannot be computed.
    #[error(transparent)]
    Arm(#[from] ArmError),
    /// The design cannot begin.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// No gains keep the specification.
    #[error("{}", infeasible(.0))]
    Infeasible(Vec<Clause>),
    /// The arm has no joint.
    #[error("the arm has no joint")]
    NoJoint,
}

/// The law of this project with the gains of one row: all joints share them, at unit inertia.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ComparedLaw {
    pub(crate) law: UnitLaw,
    /// `M̄` \[kg·m²\] per joint.
    pub(crate) inertia: Vec<f64>,
    /// Eigenvalues of `M̄^{-1/2} M M̄^{-1/2}` over postures and payloads.
    pub(crate) ratio: [f64; 2],
}

impl ComparedLaw {
    /// The law of a row of this id with these values, where it is the proposed one; `ratio` is over `inertia`.
    pub(crate) fn with(id: &str, values: &[f64], inertia: &[f64], ratio: [f64; 2]) -> Option<Self> {
        let (omega, zeta, a) = match (id, values) {
            // A disturbance observer is the law of order 1, by algebra: what is proved of one holds for the other.
            ("proposed-1" | "disturbance-observer", [omega, zeta, estimator]) => {
                (omega, zeta, vec![*estimator])
            }
            ("proposed-2", [omega, zeta, estimator, damping]) => {
                (omega, zeta, vec![estimator * estimator, 2.0 * damping * estimator])
            }
            _ => return None,
        };
        let law = UnitLaw { kp: omega * omega, kd: 2.0 * zeta * omega, a };
        Some(Self { law, inertia: inertia.to_vec(), ratio })
    }

    /// Designs gains for a study's specification in its own loop, for `φ` along its reference.
    ///
    /// # Errors
    ///
    /// [`NotDesigned`]: no gains keep the specification, or the design cannot begin.
    pub(crate) fn designed(study: &Study) -> Result<Self, NotDesigned> {
        let mut study = study.clone();
        study.design.method = DesignMethod::Ours;
        // All laws have the study's filter.
        study.sensor.velocity_filter_designed = false;
        let demand = Demand::along(&study)?;
        let arm = arm_along(&study)?;
        let outcome = design(&study, &arm, &|joint, inertia| phi_along(&demand, joint, inertia));
        let gains = match outcome? {
            Outcome::Designed(gains) => gains,
            Outcome::Infeasible(why) => return Err(NotDesigned::Infeasible(why.clauses)),
        };
        let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
        let range = arm.against(inertia.clone())?;
        let first = gains.joints.first().ok_or(NotDesigned::NoJoint)?;
        Ok(Self { law: UnitLaw::from(first), inertia, ratio: [range.low, range.high] })
    }

    /// The gains of every joint.
    pub(crate) fn joints(&self) -> Vec<DesignedJoint> {
        let UnitLaw { kp, kd, a } = &self.law;
        let joint = |m: &f64| DesignedJoint { inertia: *m, kp: *kp, kd: *kd, a: a.clone() };
        self.inertia.iter().map(joint).collect()
    }

    /// The row of the list that has this law with free scalars, and their values; `None` for orders above 2.
    pub(crate) fn as_tuned(&self) -> Option<(&'static Entry, Vec<f64>)> {
        let omega = self.law.kp.sqrt();
        let mut values = vec![omega, self.law.kd / (2.0 * omega)];
        let id = match self.law.a.as_slice() {
            [a0] => {
                values.push(*a0);
                "proposed-1"
            }
            [a0, a1] => {
                values.extend([a0.sqrt(), a1 / (2.0 * a0.sqrt())]);
                "proposed-2"
            }
            _ => return None,
        };
        Some((rival(id)?, values))
    }
}

/// The clauses in the way of a design.
fn infeasible(clauses: &[Clause]) -> String {
    let clause = |clause: &Clause| {
        let joint = clause.joint.as_ref().map_or(String::new(), |joint| format!(" of {joint}"));
        let wanted = format!("{}{joint}: {:.3e} wanted", clause.key, clause.wanted);
        match clause.possible {
            Some(possible) => format!("{wanted}, {possible:.3e} possible"),
            None => wanted,
        }
    };
    let clauses: Vec<_> = clauses.iter().map(clause).collect();
    format!("no gains keep the specification ({})", clauses.join("; "))
}
