//! Error budget by tubes: the same gains, one cause at a time, all else being ideal.

use phihat_design::Gains;
use phihat_design::budget::{BudgetPart, Cause, JointBudget};
use phihat_design::tube::{PARTS, tube_in_parts};
use phihat_model::JointKind;
use phihat_sim::SimError;
use phihat_study::{Held, Study};

use crate::commanded::Commanded;
use crate::judged::without_rate_limits;

/// The parts of each joint's error after settling; `None`: these gains have no tube.
///
/// The total is that of the whole tube. A part alone is what its cause adds to the tube of the motion alone:
/// rigid-body dynamics and smooth friction, the payload in the middle of its interval, no dry friction, an
/// exact encoder, no pushes, a start on the reference that is held. Coupling is what is left of the total.
/// Delay and start are reported as the difference of the whole tube without them.
///
/// # Errors
///
/// [`SimError`]: the arm cannot follow the reference.
pub(super) fn parts(study: &Study, gains: &Gains) -> Result<Option<Vec<JointBudget>>, SimError> {
    let mut all = without_rate_limits(study);
    if gains.complete(&mut all).is_err() {
        return Ok(None);
    }
    let certificate = gains.certificate.as_ref();
    let settle =
        certificate.and_then(|c| c.settle.as_ref()).map_or(study.spec.settle, |s| s.settle_s);
    let slices = certificate.and_then(|c| c.tube.as_ref()).map_or(PARTS, |tube| tube.slices);
    let errors = |study: &Study| -> Result<Option<Vec<f64>>, SimError> {
        let desired = Commanded::of(study)?.desired(gains)?;
        let found = tube_in_parts(study, gains, (&desired, slices)).ok();
        let found = found.map(|tube| tube.steady_from(settle));
        Ok(found.map(|tube| tube.joints.iter().map(|joint| joint.error_bound_rad).collect()))
    };
    let Some(total) = errors(&all)? else { return Ok(None) };
    let bare = bare(&all);
    let Some(motion) = errors(&bare)? else { return Ok(None) };
    let mut added = Vec::new();
    for (cause, with) in alone(&all, &bare) {
        let Some(with) = errors(&with)? else { continue };
        added.push((cause, false, differences(&with, &motion)));
    }
    for (cause, without) in within(&all) {
        let Some(without) = errors(&without)? else { continue };
        added.push((cause, true, differences(&total, &without)));
    }
    let joint = |i: usize| {
        let mut parts =
            vec![BudgetPart { cause: Cause::Motion, error_rad: motion[i], within: false }];
        // A law that is made for a delay may be the worse one without it: then nothing is known of its cost.
        let known = added.iter().filter(|(_, within, errors)| !*within || errors[i] > 0.0);
        parts.extend(known.map(|(cause, within, errors)| BudgetPart {
            cause: *cause,
            error_rad: errors[i],
            within: *within,
        }));
        let sum: f64 = parts.iter().filter(|p| !p.within).map(|p| p.error_rad).sum();
        let rest = total[i] - sum;
        parts.push(BudgetPart { cause: Cause::Coupling, error_rad: rest, within: false });
        JointBudget {
            name: study.robot.joints[i].name.clone(),
            prismatic: study.robot.joints[i].kind == JointKind::Prismatic,
            error_bound_rad: study.spec.error_bound.as_ref().map(|allowed| allowed[i]),
            total_rad: Some(total[i]),
            parts,
        }
    };
    Ok(Some((0..total.len()).map(joint).collect()))
}

fn differences(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The motion alone.
fn bare(all: &Study) -> Study {
    let mut bare = held(all);
    let n = bare.robot.joints.len();
    bare.design.coulomb = (vec![0.0; n], vec![0.0; n]);
    bare.sensor.encoder_bits = None;
    bare.world.pushes = Vec::new();
    let set = &mut bare.design.payload;
    let middle = 0.5 * (set.mass.0 + set.mass.1);
    set.mass = (middle, middle);
    set.com = set.com.map(|(low, high)| [0.5 * (low + high); 2].into());
    set.gyration = 0.0;
    bare
}

/// On the reference, and held there until the law takes over.
fn held(study: &Study) -> Study {
    let mut held = study.clone();
    held.world.start = None;
    held.world.held = Some(Held::ByGravity);
    held
}

/// The motion with one cause each, where the study has it.
fn alone(all: &Study, bare: &Study) -> Vec<(Cause, Study)> {
    let with = |change: &dyn Fn(&mut Study)| {
        let mut with = bare.clone();
        change(&mut with);
        with
    };
    let mut causes = Vec::new();
    if all.design.coulomb.1.iter().any(|level| *level > 0.0) {
        let friction = with(&|own| own.design.coulomb = all.design.coulomb.clone());
        causes.push((Cause::Friction, friction));
    }
    if all.design.payload.mass.1 > 0.0 && all.design.payload != bare.design.payload {
        let payload = with(&|own| own.design.payload = all.design.payload.clone());
        causes.push((Cause::Payload, payload));
    }
    if !all.world.pushes.is_empty() {
        let pushed = with(&|own| own.world.pushes.clone_from(&all.world.pushes));
        causes.push((Cause::Pushes, pushed));
    }
    if all.sensor.encoder_bits.is_some() {
        let read = with(&|own| own.sensor.encoder_bits.clone_from(&all.sensor.encoder_bits));
        causes.push((Cause::Encoder, read));
    }
    causes
}

/// The whole without what acts through all of it, where the study has it.
fn within(all: &Study) -> Vec<(Cause, Study)> {
    let mut without = Vec::new();
    if all.control.delay_samples + all.sensor.delay_samples > 0 {
        let mut prompt = all.clone();
        prompt.control.delay_samples = 0;
        prompt.sensor.delay_samples = 0;
        without.push((Cause::Delay, prompt));
    }
    let begun = held(all);
    if begun.world != all.world {
        without.push((Cause::Start, begun));
    }
    without
}
