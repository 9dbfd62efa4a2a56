//! This project's own law among the rivals: which gains it runs with, and what is promised of them.

use phihat_design::claims::{Attenuation, Law, Optimality};
use phihat_design::prelude::*;
use phihat_design::sampled::{LoopModel, ReadingError, ReferenceError, SampledPeaks, TorqueNoise};
use phihat_design::{Clause, JointRecord, Outcome, design};
use phihat_rivals::{DesignedJoint, Entry, rival};
use phihat_sim::Demand;
use phihat_study::{DesignMethod, Study};

use super::ground::Ground;
use super::record::Mark;
use phihat_session::{arm_along, phi_along};

/// Inertia ratios at which the sampled loop's gains are found.
const RATIOS: u32 = 9;

/// The law of this project with the gains of one row: all joints share them, at unit inertia.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Own {
    law: Law,
    /// `M̄` \[kg·m²\] per joint.
    pub(crate) inertia: Vec<f64>,
    /// Eigenvalues of `M̄^{-1/2} M M̄^{-1/2}` over postures and payloads.
    pub(crate) ratio: [f64; 2],
}

impl Own {
    /// The law of a row, where it is this project's, under whatever name.
    pub(crate) fn of(ground: &Ground, entry: &Entry, values: &[f64]) -> Option<Self> {
        if entry.needs.designed {
            return ground.designed().as_ref().ok().cloned();
        }
        let (omega, zeta, a) = match (entry.card.id, values) {
            // A disturbance observer is the law of order 1, by algebra: what is proved of one holds for the other.
            ("proposed-1" | "disturbance-observer", [omega, zeta, estimator]) => {
                (omega, zeta, vec![*estimator])
            }
            ("proposed-2", [omega, zeta, estimator, damping]) => {
                (omega, zeta, vec![estimator * estimator, 2.0 * damping * estimator])
            }
            _ => return None,
        };
        let law = Law { kp: omega * omega, kd: 2.0 * zeta * omega, a };
        Some(Self { law, inertia: ground.units.clone(), ratio: ground.ratio })
    }

    /// Designs gains for a study's specification in its own loop, for `φ` along its reference.
    ///
    /// # Errors
    ///
    /// In words: no gains keep the specification, or the design cannot begin.
    pub(crate) fn designed(study: &Study) -> Result<Self, String> {
        let mut study = study.clone();
        study.design.method = DesignMethod::Ours;
        // All laws have the study's filter.
        study.sensor.velocity_filter_designed = false;
        let demand = Demand::along(&study).map_err(|e| e.to_string())?;
        let arm = arm_along(&study).map_err(|e| e.to_string())?;
        let outcome = design(&study, &arm, &|joint, inertia| phi_along(&demand, joint, inertia));
        let gains = match outcome.map_err(|e| e.to_string())? {
            Outcome::Designed(gains) => gains,
            Outcome::Infeasible(why) => return Err(infeasible(&why.clauses)),
        };
        let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
        let range = arm.against(inertia.clone()).map_err(|e| e.to_string())?;
        let first = gains.joints.first().ok_or("the arm has no joint")?;
        Ok(Self { law: Law::from(first), inertia, ratio: [range.low, range.high] })
    }

    /// The gains of every joint.
    pub(crate) fn joints(&self) -> Vec<DesignedJoint> {
        let Law { kp, kd, a } = &self.law;
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

    /// Largest |e| \[rad\] per joint that is promised before the run, over the arm's range of inertia; `None`
    /// where the sampled loop is unstable somewhere in it.
    ///
    /// ```text
    /// |e| ≤ (ramp |φ̇| + jump |φ_jump|)/M̄ + reading Δ/2 + min(acceleration |q̈_d|, jerk |q⃛_d|)
    /// ```
    pub(crate) fn bound(&self, study: &Study, demand: &Demand) -> Option<Vec<f64>> {
        let record = self.record();
        let mut known: Vec<(LoopModel, Gains)> = Vec::new();
        let joint = |i: usize| {
            let model = LoopModel::from_study(study, i);
            let seen = known.iter().find(|(other, _)| *other == model).map(|(_, found)| *found);
            let found = match seen {
                Some(found) => found,
                None => Gains::find(&record, &model, (self.ratio[0], self.ratio[1]))?,
            };
            known.push((model, found));
            let (acceleration, jerk) = demand.motion(i);
            let bits = study.sensor.encoder_bits.as_ref();
            let quantum = bits.map_or(0.0, |bits| TorqueNoise::quantum(bits[i]));
            let held = found.acceleration * acceleration;
            let moved = found.jerk.map_or(held, |gain| held.min(gain * jerk));
            let phi = demand.phi(i, self.inertia[i]);
            let load = found.ramp * phi.rate + found.jump * phi.jump;
            Some(load / self.inertia[i] + found.reading * 0.5 * quantum + moved)
        };
        (0..self.inertia.len()).map(joint).collect()
    }

    fn record(&self) -> JointRecord {
        JointRecord {
            name: String::new(),
            inertia_kg_m2: 1.0,
            kp_per_s2: self.law.kp,
            kd_per_s: self.law.kd,
            a: self.law.a.clone(),
        }
    }

    /// Whether the certificate of optimality holds, and why.
    pub(crate) fn optimal(&self) -> (Mark, String) {
        let refuted = |e: &dyn core::fmt::Display| (Mark::No, format!("no certificate: {e}"));
        let found = match Attenuation::of(&self.law) {
            Ok(found) => found,
            Err(e) => return refuted(&e),
        };
        let Some(k_tilde) = found.k_tilde() else {
            let none = "no diagonal Q ≻ 0 exists for these gains, at any K̃";
            return match found.gamma_return_difference {
                Some(gamma) => (
                    Mark::Partly,
                    format!("{none}; the return difference proves some Q ⪰ 0, γ > {gamma:.3}"),
                ),
                None => (Mark::No, format!("{none}, and none that is not diagonal")),
            };
        };
        match Optimality::at(&self.law, k_tilde) {
            Ok(claim) => match claim.certified() {
                Some(sure) => {
                    let gamma = sure.gamma;
                    let why =
                        format!("Q ≻ 0, S ≻ 0 and the Riccati equation verified, γ = {gamma:.3}");
                    (Mark::Yes, why)
                }
                None => (Mark::No, format!("no diagonal Q ≻ 0 at K̃ = {k_tilde:.3}")),
            },
            Err(e) => refuted(&e),
        }
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

/// What the error is at most per what causes it, at unit inertia.
#[derive(Debug, Clone, Copy)]
struct Gains {
    ramp: f64,
    jump: f64,
    reading: f64,
    acceleration: f64,
    jerk: Option<f64>,
}

impl Gains {
    /// `None`: unstable somewhere in the arm's range of inertia, or no finite gain from a ramp.
    fn find(record: &JointRecord, model: &LoopModel, ratio: (f64, f64)) -> Option<Self> {
        let peaks = SampledPeaks::find(record, model, ratio, RATIOS).ok()?;
        let moved = ReferenceError::find(record, model, true, ratio, RATIOS).ok()?;
        Some(Self {
            ramp: peaks.ramp[1]?,
            jump: peaks.jump[1],
            reading: ReadingError::find(record, model, ratio, RATIOS).ok()?.error,
            acceleration: moved.acceleration,
            jerk: moved.jerk,
        })
    }
}
