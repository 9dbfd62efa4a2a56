//! What is known of a rival before a run: the bound it states, its condition, its certificate.

use phihat_rivals::{Arm, Condition, Entry, Tick, Tuning};
use phihat_sim::Demand;
use phihat_study::Study;

use super::ground::Ground;
use super::own::Own;
use super::record::Mark;
use super::row::ConditionRecord;

/// What is declared of an arm in a study before its run, `demand` along its reference.
fn declared(ground: &Ground, study: &Study, demand: &Demand) -> Arm {
    let along: Vec<_> =
        ground.units.iter().enumerate().map(|(i, unit)| demand.phi(i, *unit)).collect();
    Arm {
        inertia_min: ground.eigenvalues[0],
        inertia_max: ground.eigenvalues[1],
        ratio: ground.ratio,
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
    ground: &Ground,
    entry: &Entry,
    values: &[f64],
    study: &Study,
) -> Option<Vec<f64>> {
    let demand = Demand::along(study).ok()?;
    let arm = declared(ground, study, &demand);
    if saturates(&arm, study) {
        return None;
    }
    if let Some(own) = Own::of(ground, entry, values) {
        return own.bound(study, &demand);
    }
    let period = study.control.period_ns as f64 * 1e-9;
    let tuning = Tuning::new(values, &ground.units, period).ok()?;
    let stated = entry.bound(&tuning, &arm)?;
    let usable = stated.len() == ground.joints() && stated.iter().all(|b| b.is_finite());
    usable.then_some(stated)
}

/// Whether what is declared asks for more torque than the drives have: then nobody's bound is worth asking for.
fn saturates(arm: &Arm, study: &Study) -> bool {
    let limits = study.control.torque_max.as_deref().unwrap_or_default();
    arm.phi_max.iter().zip(limits).any(|(phi, limit)| phi > limit)
}

/// The rival's own stability condition for an arm, in the world it was tuned in.
pub(crate) fn condition(
    ground: &Ground,
    entry: &Entry,
    values: &[f64],
    study: &Study,
) -> Option<ConditionRecord> {
    let mut arm = declared(ground, study, &Demand::along(study).ok()?);
    let period = study.control.period_ns as f64 * 1e-9;
    let condition = match Own::of(ground, entry, values) {
        Some(own) => {
            let (entry, values) = own.as_tuned()?;
            arm.ratio = own.ratio;
            entry.condition(&Tuning::new(&values, &own.inertia, period).ok()?, &arm)?
        }
        None => entry.condition(&Tuning::new(values, &ground.units, period).ok()?, &arm)?,
    };
    Some(ConditionRecord {
        text: condition.text.to_owned(),
        holds: condition.holds,
        margin: Some(condition.margin).filter(|margin| margin.is_finite()),
    })
}

/// Laws without a row in the paper's table whose authors claim optimality.
const CLAIMED: [&str; 2] = ["park-chung", "chen-lee-feng"];

/// Whether a certificate of optimality holds for these gains, and why.
///
/// The law of this project, under whatever name: `Q ≻ 0`, `S ≻ 0` and the Riccati equation, computed again from the
/// gains; or, weaker, some `Q ⪰ 0` that need not be diagonal. Others whose authors claim optimality: the condition
/// that their proof puts on the gains, for the continuous loop like ours. All others claim none.
pub(crate) fn optimal(ground: &Ground, entry: &Entry, values: &[f64]) -> (Mark, String) {
    if let Some(own) = Own::of(ground, entry, values) {
        return own.optimal();
    }
    let ticked = entry.card.printed.is_some_and(|ticks| ticks.optimal == Tick::Yes);
    if !ticked && !CLAIMED.contains(&entry.card.id) {
        return (Mark::No, "no certificate is claimed".to_owned());
    }
    let period = ground.study.control.period_ns as f64 * 1e-9;
    let tuning = Tuning::new(values, &ground.units, period).ok();
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
