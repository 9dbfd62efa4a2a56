//! Claims about a rival before a run: the bound it states, its condition, its certificate.

use phihat_rivals::{Condition, DeclaredArm, Entry, Tick, Tuning};
use phihat_sim::Demand;
use phihat_study::Study;

use crate::arm_case::ArmCase;
use crate::mark::Mark;
use crate::proposed_claims::position_bound;
use crate::row::ConditionRecord;

/// Declared data of an arm in a study before its run, `demand` along its reference.
fn declared(arm: &ArmCase, study: &Study, demand: &Demand) -> DeclaredArm {
    let along: Vec<_> =
        arm.units.iter().enumerate().map(|(i, unit)| demand.phi(i, *unit)).collect();
    DeclaredArm {
        inertia_min: arm.eigenvalues[0],
        inertia_max: arm.eigenvalues[1],
        ratio: arm.ratio,
        delay_samples: study.control.delay_samples,
        phi_rate: along.iter().map(|phi| phi.rate).collect(),
        phi_jump: along.iter().map(|phi| phi.jump).collect(),
        phi_max: along.iter().map(|phi| phi.size).collect(),
        // Without a nominal inertia φ is the torque itself.
        demand_max: (0..along.len()).map(|i| demand.phi(i, 0.0).size).collect(),
    }
}

/// Largest |e| \[rad\] per joint that is promised before the run; `None` where nothing is, or a drive saturates.
///
/// The law of this project: the sampled loop's peak gains over the arm's range of inertia. Others: what they
/// state themselves.
pub(crate) fn bound(
    arm: &ArmCase,
    entry: &Entry,
    values: &[f64],
    study: &Study,
) -> Option<Vec<f64>> {
    let demand = Demand::along(study).ok()?;
    let facts = declared(arm, study, &demand);
    if saturates(&facts, study) {
        return None;
    }
    if let Some(law) = arm.proposed(entry, values) {
        return law.bound(study, &demand);
    }
    if entry.needs.preview {
        let law = (entry.card.id, values);
        return position_bound(law, (&arm.units, arm.ratio), study, &demand);
    }
    let period = study.control.period_ns as f64 * 1e-9;
    let tuning = Tuning::new(values, &arm.units, period).ok()?;
    let stated = entry.bound(&tuning, &facts)?;
    let usable = stated.len() == arm.joints() && stated.iter().all(|b| b.is_finite());
    usable.then_some(stated)
}

/// Returns true if the declared load needs more torque than the drives have: then no law's bound is
/// requested.
fn saturates(arm: &DeclaredArm, study: &Study) -> bool {
    let limits = study.control.torque_max.as_deref().unwrap_or_default();
    arm.phi_max.iter().zip(limits).any(|(phi, limit)| phi > limit)
}

/// The rival's own stability condition for an arm, in the world it was tuned in.
pub(crate) fn condition(
    arm: &ArmCase,
    entry: &Entry,
    values: &[f64],
    study: &Study,
) -> Option<ConditionRecord> {
    let mut facts = declared(arm, study, &Demand::along(study).ok()?);
    let period = study.control.period_ns as f64 * 1e-9;
    let condition = match arm.proposed(entry, values) {
        Some(law) => {
            let (entry, values) = law.as_tuned()?;
            facts.ratio = law.ratio;
            entry.condition(&Tuning::new(&values, &law.inertia, period).ok()?, &facts)?
        }
        None => entry.condition(&Tuning::new(values, &arm.units, period).ok()?, &facts)?,
    };
    Some(ConditionRecord {
        text: condition.text.to_owned(),
        holds: condition.holds,
        margin: Some(condition.margin).filter(|margin| margin.is_finite()),
    })
}

/// Laws without a row in the paper's table whose authors claim optimality.
const CLAIMED: [&str; 2] = ["park-chung", "chen-lee-feng"];

/// Mark of the certificate of optimality for these gains, and why.
///
/// The law of this project, under whatever name: `Q ≻ 0`, `S ≻ 0` and the Riccati equation, computed again from the
/// gains; or, weaker, some `Q ⪰ 0` that need not be diagonal. Others whose authors claim optimality: the condition
/// that their proof puts on the gains, for the continuous loop like ours. All others claim none.
pub(crate) fn optimal(arm: &ArmCase, entry: &Entry, values: &[f64]) -> (Mark, String) {
    if let Some(law) = arm.proposed(entry, values) {
        return law.optimal();
    }
    let ticked = entry.card.printed.is_some_and(|ticks| ticks.optimal == Tick::Yes);
    if !ticked && !CLAIMED.contains(&entry.card.id) {
        return (Mark::No, "no certificate is claimed".to_owned());
    }
    let period = arm.study.control.period_ns as f64 * 1e-9;
    let tuning = Tuning::new(values, &arm.units, period).ok();
    match tuning.and_then(|tuning| entry.optimality(&tuning)) {
        None => (
            Mark::No,
            "claimed; no condition of the proof is known here that gains could be held against"
                .to_owned(),
        ),
        Some(Condition { text, holds, margin }) => {
            let (mark, holds) =
                if holds { (Mark::Yes, "holds") } else { (Mark::No, "does not hold") };
            let by =
                if margin.is_finite() { format!(" (ratio {margin:.3})") } else { String::new() };
            (mark, format!("the proof's condition {text} {holds}{by}"))
        }
    }
}
