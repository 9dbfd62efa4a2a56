//! Runs that try to leave the bound for a class of motions.

use phihat_certificate::ClassBound;
use phihat_design::Gains;
use phihat_session::Dice;
use phihat_study::{Payload, ReferenceRequest, Study};
use serde::Serialize;

use crate::run::{NoRun, run};

/// Result of runs against a class bound.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ClassRuns {
    /// Runs that were made.
    pub runs: u64,
    /// Runs that left a bound of error, velocity error, torque step or torque.
    pub outside: u64,
    /// Largest `|e|` of each joint over its bound.
    pub errors: Vec<f64>,
    /// Largest `|ė|` of each joint over its bound.
    pub velocities: Vec<f64>,
    /// Largest change of torque per sample of each joint over its bound.
    pub steps: Vec<f64>,
    /// Largest commanded torque of each joint over its bound.
    pub torques: Vec<f64>,
    /// Seeds of the runs that left a bound.
    pub broken: Vec<u64>,
}

impl ClassRuns {
    /// The least of bound over measured, over joints: errors, velocity errors, torque steps, torques.
    pub fn least(&self) -> [f64; 4] {
        [&self.errors, &self.velocities, &self.steps, &self.torques]
            .map(|list| 1.0 / list.iter().copied().fold(f64::MIN_POSITIVE, f64::max))
    }

    /// Both together.
    pub fn and(&mut self, other: &Self) {
        let lists = [
            (&mut self.errors, &other.errors),
            (&mut self.velocities, &other.velocities),
            (&mut self.steps, &other.steps),
            (&mut self.torques, &other.torques),
        ];
        for (own, other) in lists {
            own.resize(other.len().max(own.len()), 0.0);
            for (own, other) in own.iter_mut().zip(other) {
                *own = own.max(*other);
            }
        }
        self.runs += other.runs;
        self.outside += other.outside;
        self.broken.extend(&other.broken);
    }

    /// One run with its judgement: outside where it was lost, or a share is beyond 1 or is no number.
    pub(crate) fn judged(mut self, lost: bool, seed: u64) -> Self {
        let lists = [&self.errors, &self.velocities, &self.steps, &self.torques];
        let beyond = |share: &f64| share.is_nan() || *share > 1.0;
        if lost || lists.iter().any(|list| list.iter().any(beyond)) {
            self.outside = 1;
            self.broken.push(seed);
        }
        self
    }
}

/// Runs one motion of a study's class, drawn with payload, friction and encoder phases by a seed, and holds it against
/// the bound.
///
/// # Errors
///
/// [`NoRun`]: the gains are none of this study, or it cannot be simulated.
pub fn class_run(
    study: &Study,
    gains: &Gains,
    bound: &ClassBound,
    seed: u64,
) -> Result<ClassRuns, NoRun> {
    let mut dice = Dice::new(seed, 45);
    let mut own = varied(study, seed, &mut dice);
    phihat_sim::derive_substeps(&mut own);
    let fed = study.feedforward.is_some();
    let phase: Vec<f64> = bound.error_bound_rad.iter().map(|_| dice.between(-0.5, 0.5)).collect();
    // What is fed forward is added by the study's own loop, which has no displaced encoders.
    let outcome = run(&own, gains, if fed { &[] } else { &phase })?;
    let lost = outcome.divergence.is_some() || outcome.abort.is_some();
    let trace = &outcome.trace;
    // After a row of lost commands the drives see the changes of all of them.
    let changes = 1.0 + f64::from(bound.signals.as_ref().map_or(0, |own| own.commands_lost));
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let mut found = ClassRuns { runs: 1, ..ClassRuns::default() };
    for (i, joint) in trace.joints.iter().enumerate() {
        let (error, velocity) = (largest(&joint.e), largest(&joint.de));
        found.errors.push(error / bound.error_bound_rad[i]);
        found.velocities.push(velocity / bound.velocity_error_bound_rad_s[i]);
        let step = outcome.told_step_max.get(i).copied().unwrap_or(0.0);
        found.steps.push(step / (changes * bound.torque_step_nm[i]));
        let torque = outcome.told_max.get(i).copied().unwrap_or(0.0);
        found.torques.push(torque / bound.torque_nm[i]);
    }
    Ok(found.judged(lost, seed))
}

/// The study with another motion of its class, payload and dry friction.
pub(crate) fn varied(study: &Study, seed: u64, dice: &mut Dice) -> Study {
    let mut own = study.clone();
    if let ReferenceRequest::Any { seed: drawn, .. } = &mut own.reference {
        *drawn = seed;
    }
    own.world.payload = payload(study, dice);
    // Dry friction at either end of its interval, or between.
    for (i, level) in own.world.extra_coulomb.iter_mut().enumerate() {
        let most = study.design.coulomb.1[i];
        *level = match dice.below(4) {
            0 => study.design.coulomb.0[i].min(most),
            1 => dice.between(0.0, most),
            _ => most,
        };
    }
    own
}

/// A payload of the set: an end, or anything between; at a corner of the box of centres, or inside.
fn payload(study: &Study, dice: &mut Dice) -> Option<Payload> {
    let set = &study.design.payload;
    let mass = match dice.below(3) {
        0 => set.mass.0,
        1 => set.mass.1,
        _ => dice.between(set.mass.0, set.mass.1),
    };
    if mass <= 0.0 {
        return None;
    }
    let corner = dice.chance(0.5);
    let com = set.com.map(
        |(low, high)| {
            if corner { dice.pick(&[low, high]) } else { dice.between(low, high) }
        },
    );
    let most = mass * set.gyration * set.gyration;
    let inertia = [most, 0.0, 0.0, most, 0.0, most];
    let frame = set.frame.clone();
    Some(Payload { frame, mass, com, inertia, start: 0.0, end: f64::INFINITY })
}
