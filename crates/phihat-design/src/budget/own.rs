//! Error of a joint from each cause, by its own loop.

use phihat::Form;
use phihat_certificate::extremes::larger;
use phihat_study::Study;

use super::document::{BudgetPart, Cause, JointBudget};
use crate::positions::worst_kick;
use crate::quick::Quick;
use crate::sampled::{LoopModel, LoopParts as _, TorqueNoise};
use crate::{Gains, JointRecord, Phi};

/// Gains to the error of one joint over the arm's range of inertia, per unit of `M̄`.
struct Spent {
    jump: f64,
    ramp: Option<f64>,
    reading: f64,
    moved: (f64, Option<f64>),
}

/// The budget of joints with these gains over a range of the arm's inertia, by each joint's own `φ`.
///
/// # Law
///
/// ```text
/// |e| ≤ ramp |φ̇|/M̄ + jump |φ_jump|/M̄ + reading Δ/2 + min(acceleration |q̈_d|, jerk |q⃛_d|) + sT |q̇_d|    (1)
///       motion       friction           encoder       reference                                 delay
/// ```
///
/// `s` is the number of samples by which measurements are late. The delay of the torque is in all gains: the
/// reduction of the sum without it is reported alongside, as a part within the others. A joint whose response
/// does not die out has no parts.
///
/// # Not claimed
///
/// Joints by themselves: nothing is in here of how they push each other. Gains are estimates, a few per mille low.
pub fn by_own_loop(
    study: &Study,
    gains: &Gains,
    (low, high): (f64, f64),
    phi: &dyn Fn(usize, f64) -> Phi,
) -> Vec<JointBudget> {
    let of = |(i, record): (usize, &JointRecord)| {
        let model = LoopModel::from_study(study, i).with_choices_of(gains, study);
        let bits = study.sensor.encoder_bits.as_ref().and_then(|bits| bits.get(i));
        let quantum = bits.map_or(0.0, |bits| TorqueNoise::quantum(*bits));
        let phi = phi(i, record.inertia_kg_m2);
        let mut parts = Spent::of(record, &model, (low, high))
            .map_or_else(Vec::new, |spent| spent.parts(record, &model, &phi, quantum));
        let total = |parts: &[BudgetPart]| parts.iter().map(|part| part.error_rad).sum::<f64>();
        let total_rad = (!parts.is_empty()).then(|| total(&parts));
        if let Some(all) = total_rad
            && model.delay_samples > 0
        {
            let prompt = LoopModel { delay_samples: 0, ..model };
            if let Some(spent) = Spent::of(record, &prompt, (low, high)) {
                let error_rad = all - total(&spent.parts(record, &prompt, &phi, quantum));
                // A law that is made for a delay may be the worse one without it: then nothing is known of its cost.
                if error_rad > 0.0 {
                    parts.push(BudgetPart { cause: Cause::Delay, error_rad, within: true });
                }
            }
        }
        JointBudget {
            name: record.name.clone(),
            prismatic: study.robot.joints[i].kind == phihat_model::JointKind::Prismatic,
            error_bound_rad: study.spec.error_bound.as_ref().map(|allowed| allowed[i]),
            total_rad,
            parts,
        }
    };
    gains.joints.iter().enumerate().map(of).collect()
}

impl Spent {
    /// The worst over a range; `None` where the loop does not forget.
    fn of(record: &JointRecord, model: &LoopModel, (low, high): (f64, f64)) -> Option<Self> {
        let ratios = [low, (low * high).sqrt(), high];
        let mut all: Option<Quick> = None;
        for mu in ratios {
            let quick = Quick::at(record, model, mu)?;
            all = Some(all.map_or(quick, |worst| worst.worse(quick)));
        }
        let Quick { jump, ramp, reading, moved, .. } = all?;
        let moved = if model.form == Form::Positions {
            let t = model.period_s;
            let kick = worst_kick(record, model, &ratios)? * t * t;
            (0.25 * kick, Some(t * kick / 12.0))
        } else {
            (moved[0], None)
        };
        Some(Self { jump: jump[1], ramp: ramp[1], reading: reading[0], moved })
    }

    fn parts(
        &self,
        record: &JointRecord,
        model: &LoopModel,
        phi: &Phi,
        quantum: f64,
    ) -> Vec<BudgetPart> {
        let all = phi.bound(self.jump, self.ramp) / record.inertia_kg_m2;
        let dry = self.jump * phi.jump_nm / record.inertia_kg_m2;
        let friction = if dry < all { dry } else { all };
        let moved = phi.motion.map_or(0.0, |motion| motion.costs(self.moved.0, self.moved.1));
        let late = phi.motion.map_or(0.0, |motion| model.lead() * motion.velocity_rad_s);
        [
            (Cause::Motion, larger(all - friction, 0.0)),
            (Cause::Friction, friction),
            (Cause::Encoder, self.reading * 0.5 * quantum),
            (Cause::Reference, moved),
            (Cause::Delay, late),
        ]
        .into_iter()
        .filter(|(cause, error)| *cause != Cause::Delay || *error > 0.0)
        .map(|(cause, error_rad)| BudgetPart { cause, error_rad, within: false })
        .collect()
    }
}
