//! What is known of a rival before a run: the bound it states, its condition, its certificate.

use phihat_baselines::{Arm, Entry, Tick, Tuning};
use phihat_design::JointRecord;
use phihat_design::claims::{Attenuation, Law, Optimality};
use phihat_design::sampled::{LoopModel, ReadingError, ReferenceError, SampledPeaks, TorqueNoise};
use phihat_sim::Demand;
use phihat_study::Study;

use super::ground::Ground;
use super::record::Mark;
use super::row::ConditionRecord;

/// Inertia ratios at which the sampled loop's gains are found.
const RATIOS: u32 = 9;

/// What is declared of an arm in a study before its run.
///
/// # Errors
///
/// In words: the reference cannot be walked along.
pub(crate) fn declared(ground: &Ground, study: &Study) -> Result<Arm, String> {
    let demand = Demand::along(study).map_err(|e| e.to_string())?;
    let along: Vec<_> =
        ground.units.iter().enumerate().map(|(i, unit)| demand.phi(i, *unit)).collect();
    Ok(Arm {
        inertia_min: ground.eigenvalues[0],
        inertia_max: ground.eigenvalues[1],
        ratio: ground.ratio,
        delay_samples: study.control.delay_samples,
        phi_rate: along.iter().map(|phi| phi.rate).collect(),
        phi_jump: along.iter().map(|phi| phi.jump).collect(),
        phi_max: along.iter().map(|phi| phi.size).collect(),
        // Without a nominal inertia φ is the torque itself.
        demand_max: (0..along.len()).map(|i| demand.phi(i, 0.0).size).collect(),
    })
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
    let arm = declared(ground, study).ok()?;
    if saturates(&arm, study) {
        return None;
    }
    let Some(law) = own_law(entry, values) else {
        let period = study.control.period_ns as f64 * 1e-9;
        let tuning = Tuning::new(values, &ground.units, period).ok()?;
        let stated = entry.bound(&tuning, &arm)?;
        let usable = stated.len() == ground.joints() && stated.iter().all(|b| b.is_finite());
        return usable.then_some(stated);
    };
    own_bound(ground, &law, study, &arm)
}

/// `|e| ≤ (ramp |φ̇| + jump |φ_jump|)/M̄ + reading Δ/2 + min(acceleration |q̈_d|, jerk |q⃛_d|)`.
fn own_bound(ground: &Ground, law: &Law, study: &Study, arm: &Arm) -> Option<Vec<f64>> {
    let demand = Demand::along(study).ok()?;
    let ratio = (ground.ratio[0], ground.ratio[1]);
    let gains = record(law);
    let mut known: Vec<(LoopModel, Gains)> = Vec::new();
    let joint = |i: usize| {
        let model = LoopModel::from_study(study, i);
        let seen = known.iter().find(|(other, _)| *other == model).map(|(_, found)| *found);
        let found = match seen {
            Some(found) => found,
            None => Gains::find(&gains, &model, ratio)?,
        };
        known.push((model, found));
        let (acceleration, jerk) = demand.motion(i);
        let quantum =
            study.sensor.encoder_bits.as_ref().map_or(0.0, |b| TorqueNoise::quantum(b[i]));
        let held = found.acceleration * acceleration;
        let moved = found.jerk.map_or(held, |gain| held.min(gain * jerk));
        let load = found.ramp * arm.phi_rate[i] + found.jump * arm.phi_jump[i];
        Some(load / ground.units[i] + found.reading * 0.5 * quantum + moved)
    };
    (0..ground.joints()).map(joint).collect()
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

/// Whether what is declared asks for more torque than the drives have: then nobody's bound is worth asking for.
fn saturates(arm: &Arm, study: &Study) -> bool {
    let limits = study.control.torque_max.as_deref().unwrap_or_default();
    arm.phi_max.iter().zip(limits).any(|(phi, limit)| phi > limit)
}

/// The gains of this project's law, where the rival is it: at unit inertia.
fn own_law(entry: &Entry, values: &[f64]) -> Option<Law> {
    let (omega, zeta, a) = match (entry.card.id, values) {
        ("proposed-1", [omega, zeta, estimator]) => (omega, zeta, vec![*estimator]),
        ("proposed-2", [omega, zeta, estimator, damping]) => {
            (omega, zeta, vec![estimator * estimator, 2.0 * damping * estimator])
        }
        _ => return None,
    };
    Some(Law { kp: omega * omega, kd: 2.0 * zeta * omega, a })
}

fn record(law: &Law) -> JointRecord {
    JointRecord {
        name: String::new(),
        inertia_kg_m2: 1.0,
        kp_per_s2: law.kp,
        kd_per_s: law.kd,
        a: law.a.clone(),
    }
}

/// The rival's own stability condition for an arm, in the world it was tuned in.
pub(crate) fn condition(
    ground: &Ground,
    entry: &Entry,
    values: &[f64],
    study: &Study,
) -> Option<ConditionRecord> {
    let arm = declared(ground, study).ok()?;
    let period = study.control.period_ns as f64 * 1e-9;
    let tuning = Tuning::new(values, &ground.units, period).ok()?;
    let condition = entry.condition(&tuning, &arm)?;
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
/// The law of this project: `Q ≻ 0`, `S ≻ 0` and the Riccati equation, computed again from the gains; or, weaker,
/// some `Q ⪰ 0` that need not be diagonal. Others
/// whose authors claim optimality: the condition that their proof rests on. All others claim none.
pub(crate) fn optimal(
    entry: &Entry,
    values: &[f64],
    condition: Option<&ConditionRecord>,
) -> (Mark, String) {
    if let Some(law) = own_law(entry, values) {
        return inverse_optimal(&law);
    }
    let ticked = entry.card.printed.is_some_and(|ticks| ticks.optimal == Tick::Yes);
    match (ticked || CLAIMED.contains(&entry.card.id), condition) {
        (false, _) => (Mark::No, "no certificate is claimed".to_owned()),
        (true, None) => (
            Mark::No,
            "claimed, but without a condition that gains could be held against".to_owned(),
        ),
        (true, Some(ConditionRecord { text, holds: true, margin })) => {
            (Mark::Yes, format!("the proof's condition {text} holds{}", by(*margin)))
        }
        (true, Some(ConditionRecord { text, holds: false, margin })) => {
            (Mark::No, format!("the proof's condition {text} does not hold{}", by(*margin)))
        }
    }
}

fn by(margin: Option<f64>) -> String {
    margin.map_or(String::new(), |margin| format!(" (ratio {margin:.3})"))
}

fn inverse_optimal(law: &Law) -> (Mark, String) {
    let refuted = |e: &dyn core::fmt::Display| (Mark::No, format!("no certificate: {e}"));
    let found = match Attenuation::of(law) {
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
    match Optimality::at(law, k_tilde) {
        Ok(claim) => match claim.certified() {
            Some(sure) => {
                let gamma = sure.gamma;
                let why = format!("Q ≻ 0, S ≻ 0 and the Riccati equation verified, γ = {gamma:.3}");
                (Mark::Yes, why)
            }
            None => (Mark::No, format!("no diagonal Q ≻ 0 at K̃ = {k_tilde:.3}")),
        },
        Err(e) => refuted(&e),
    }
}
