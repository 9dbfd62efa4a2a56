//! A joint's law as numbers, by playing the core, and its loop as the kernel's polynomials.

use phihat::{
    JointGains, JointState, Measurement, Reference, STATE_ENTRIES, TorqueSource, VelocityFilter,
    VelocitySource, VelocityState,
};
use phihat_kernel::{Joint, Law, Reported, Setting, Unproved, Velocity};

use super::drive::drive;
use crate::refutation::refuse;
use crate::{JointRecord, LoopModel, Refutation};

/// The loop of a joint, from the numbers that the core runs with.
///
/// # Errors
///
/// [`Refutation`]: the core refuses the gains, or a unit.
pub(crate) fn joint(
    claim: &str,
    record: &JointRecord,
    model: &LoopModel,
) -> Result<Joint, Refutation> {
    let law = played(claim, record, model)?;
    let hears = law.input.iter().chain([&law.direct]).any(|[_, dq, _]| dq.abs() > 0.0);
    let setting = Setting {
        period: model.period_s,
        inertia: record.inertia_kg_m2,
        late: (model.delay_samples + model.sample_delay_samples) as usize,
        velocity: if hears { velocity(claim, model)? } else { NO_VELOCITY },
        drive: drive(model),
        reported: match model.torque {
            TorqueSource::Applied => Reported::Applied,
            TorqueSource::Demanded => Reported::Commanded,
        },
    };
    Joint::new(&law, &setting).map_err(|why| refuse(claim, &format!("a loop: {why}"), 0.0, 0.0))
}

/// An inequality that is not proved, with the frequency at which it fails, or the reason.
pub(crate) fn failed(what: &str, why: Unproved) -> String {
    match why {
        Unproved::At { theta, .. } => format!("{what} at θ = {theta:.6} rad/sample"),
        why => format!("{what}: {why}"),
    }
}

/// The velocity of a law that does not hear it.
const NO_VELOCITY: Velocity = Velocity { last: 0.0, velocity: 0.0, position: 0.0, before: 0.0 };

/// Next state and torque of a sample in which all is zero but one number.
struct Answer {
    next: [f64; STATE_ENTRIES],
    tau: f64,
}

/// The law's matrices: one column for a unit in each entry of its state and in each measurement.
///
/// Entries that nothing reaches stay at zero, and those that do not reach the torque move nothing: both are left out.
fn played(claim: &str, record: &JointRecord, model: &LoopModel) -> Result<Law, Refutation> {
    let gains = record
        .core_gains(record.form_or(model.form), model.period_s)
        .map_err(|why| refuse(claim, &format!("gains that the core runs: {why}"), 0.0, 0.0))?;
    let unit = |at: usize| core::array::from_fn(|i| f64::from(u8::from(i == at)));
    let nothing = Measurement::default();
    let states: Vec<Answer> = (0..STATE_ENTRIES)
        .map(|at| answer(claim, &gains, &unit(at), &nothing))
        .collect::<Result<_, _>>()?;
    let inputs = [
        Measurement { q: 1.0, ..nothing },
        Measurement { dq: 1.0, ..nothing },
        Measurement { tau_applied: 1.0, ..nothing },
    ]
    .map(|m| answer(claim, &gains, &[0.0; STATE_ENTRIES], &m));
    let [q, dq, tau] = inputs;
    let inputs = [q?, dq?, tau?];
    let kept = kept(&states, &inputs);
    let row = |i: &usize| kept.iter().map(|j| states[*j].next[*i]).collect();
    Ok(Law {
        state: kept.iter().map(row).collect(),
        input: kept.iter().map(|i| inputs.each_ref().map(|of| of.next[*i])).collect(),
        output: kept.iter().map(|j| states[*j].tau).collect(),
        direct: inputs.each_ref().map(|of| of.tau),
    })
}

fn answer(
    claim: &str,
    gains: &JointGains<f64>,
    entries: &[f64; STATE_ENTRIES],
    measurement: &Measurement<f64>,
) -> Result<Answer, Refutation> {
    let mut state = JointState::of_entries(entries);
    let command = gains.update(&mut state, measurement, &Reference::default());
    let answered = !command.status.refused;
    Refutation::unless(claim, "the core answers a unit", 0.0, 1.0, answered)?;
    Ok(Answer { next: state.entries(), tau: command.tau })
}

/// Entries that a measurement reaches and that reach the torque, in some samples.
fn kept(states: &[Answer], inputs: &[Answer; 3]) -> Vec<usize> {
    let there = |value: f64| value.abs() > 0.0;
    let leads = |from: usize, to: usize| there(states[from].next[to]);
    let all = 0..STATE_ENTRIES;
    let reached = all.clone().filter(|i| inputs.iter().any(|of| there(of.next[*i])));
    let reached = closed(reached.collect(), leads);
    let reaching = all.filter(|i| there(states[*i].tau));
    let reaching = closed(reaching.collect(), |from, to| leads(to, from));
    (0..STATE_ENTRIES).filter(|i| reached.contains(i) && reaching.contains(i)).collect()
}

/// A set of entries with all that these lead to.
fn closed(mut set: Vec<usize>, leads: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut at = 0;
    while let Some(from) = set.get(at).copied() {
        at += 1;
        let more = (0..STATE_ENTRIES).filter(|to| leads(from, *to));
        let new: Vec<usize> = more.filter(|to| !set.contains(to)).collect();
        set.extend(new);
    }
    set
}

/// The velocity that the law gets, by playing the core's filter.
fn velocity(claim: &str, model: &LoopModel) -> Result<Velocity, Refutation> {
    let t = model.period_s;
    let filter = VelocityFilter::<f64>::new(model.velocity_filter_hz, t)
        .map_err(|why| refuse(claim, &format!("a velocity filter: {why}"), 0.0, 0.0))?;
    let of = |before: f64, last: f64, q: f64| {
        filter.estimate(&mut VelocityState::after(before, last), q, t)
    };
    let last = of(0.0, 1.0, 0.0);
    Ok(match model.velocity {
        // A position that moves by T in T moves at 1.
        VelocitySource::Measured => {
            Velocity { last, velocity: of(0.0, 0.0, t), position: 0.0, before: 0.0 }
        }
        VelocitySource::Differenced => {
            Velocity { last, velocity: 0.0, position: of(0.0, 0.0, 1.0), before: of(1.0, 0.0, 0.0) }
        }
    })
}
