//! Changes that would help, each tried out before it is reported.

use phihat::{Form, VelocitySource};
use phihat_certificate::extremes::Extremes as _;
use phihat_design::budget::TriedChange;
use phihat_design::{Gains, Outcome};
use phihat_study::{
    AHEAD_MAX, DesignMethod, FeedForward, InertiaSource, Known, ReferenceRequest, Study,
};

use super::slower::slower;
use crate::arm::arm;
use crate::digits;
use crate::judged::shares;
use crate::recordings::Recordings;
use crate::synthesize::{Advice, SynthesisOptions, synthesize};

/// Factors on the motion's times, the least first.
const SLOWER: [f64; 3] = [1.5, 2.0, 4.0];

/// Shares of the heaviest payload, the largest first.
const LIGHTER: [f64; 2] = [0.5, 0.0];

/// Bits that an encoder may have more, and the most that there are.
const FINER: [u32; 2] = [1, 3];
const BITS_MAX: u32 = 32;

/// Multiples of the rate, and the highest rate \[Hz\].
const FASTER: [u64; 2] = [2, 4];
const HIGHEST_HZ: f64 = 20_000.0;

/// Factors on the allowed step of torque.
const LOUDER: [f64; 2] = [2.0, 5.0];

/// Share of the unknown dry friction that remains after a measurement; share of the added dry friction that
/// remains after a reduction.
const KNOWN: [f64; 2] = [0.5, 0.1];
const LESS: [f64; 2] = [0.5, 0.0];

/// Rotor inertia of joints whose description states none, over what the joint moves at the least.
const ROTORS: [f64; 3] = [0.1, 0.3, 1.0];

/// The interface of drives that one has built oneself: rate, encoder and rotor are one's own there.
const OWN_DRIVES: &str = "ideal";

/// One change, in words and as a study.
struct Rung {
    change: String,
    key: &'static str,
    value: String,
    study: Study,
}

/// The changes of one kind, the smallest first: the smallest that helps is told.
type Ladder = Vec<Rung>;

/// Changes that a user of this robot can make, tried out; those that help first.
pub(super) fn tried(
    study: &Study,
    recordings: &Recordings,
    step: &mut dyn FnMut(&str),
) -> Vec<TriedChange> {
    let mut all = Vec::new();
    for ladder in ladders(study, recordings) {
        let Some(last) = ladder.last() else { continue };
        step(&format!("trying: {}", last.change));
        // What the largest change does not mend the smaller ones do not.
        let Some(most) = shares_of(&last.study, recordings) else {
            all.push(told(last, None));
            continue;
        };
        let mut best = (last, most);
        for rung in &ladder[..ladder.len() - 1] {
            step(&format!("trying: {}", rung.change));
            if let Some(share) = shares_of(&rung.study, recordings) {
                best = (rung, share);
                break;
            }
        }
        all.push(told(best.0, Some(best.1)));
    }
    all.sort_by_key(|change| !change.helps);
    all
}

fn told(rung: &Rung, share: Option<f64>) -> TriedChange {
    TriedChange {
        change: rung.change.clone(),
        key: rung.key.to_owned(),
        value: rung.value.clone(),
        helps: share.is_some(),
        error_share: share,
    }
}

/// Share of the allowed error that the gains for a changed study use; `None`: no gains satisfy every clause.
fn shares_of(study: &Study, recordings: &Recordings) -> Option<f64> {
    let known = arm(study, recordings).ok()?;
    let options = SynthesisOptions { advice: Advice::Clauses, beyond_drives: true };
    let outcome = synthesize(study, &known, recordings, options).ok()?;
    let Outcome::Designed(gains) = outcome else { return None };
    let gains: &Gains = &gains;
    let certificate = gains.certificate.as_ref()?;
    if certificate.refused().is_some() || !certificate.unproved.is_empty() {
        return None;
    }
    let bounds = || {
        let allowed = study.spec.error_bound.iter().flatten();
        let bound = |i: usize| match &certificate.class {
            Some(class) => class.error_bound_rad.get(i).copied(),
            None => Some(certificate.own_bounds(i)?.error_bound_rad),
        };
        allowed.enumerate().filter_map(|(i, most)| Some(bound(i)? / most)).largest()
    };
    let by_tube = certificate
        .tube
        .as_ref()
        .map(|tube| shares(study, tube, &mut Vec::new()).into_iter().largest());
    Some(by_tube.unwrap_or_else(bounds))
}

fn ladders(study: &Study, recordings: &Recordings) -> Vec<Ladder> {
    let mut all = vec![motion(study), payload(study), form(study), filter(study), noise(study)];
    all.push(rate(study));
    all.extend([friction_known(study), friction_fed(study)]);
    if study.interface.profile.name == OWN_DRIVES {
        all.extend([delay(study), encoder(study), less_friction(study), rotors(study, recordings)]);
    }
    all
}

fn changed(study: &Study, change: impl FnOnce(&mut Study)) -> Study {
    let mut own = study.clone();
    change(&mut own);
    own
}

fn motion(study: &Study) -> Ladder {
    let rung = |factor: &f64| Rung {
        change: format!("the motion {factor} times slower"),
        key: "reference",
        value: match study.reference {
            ReferenceRequest::Any { .. } => {
                format!("speeds / {factor}, accelerations / {factor}², jerks / {factor}³")
            }
            _ => format!("all times × {factor}, frequencies / {factor}"),
        },
        study: slower(study, *factor),
    };
    SLOWER.iter().map(rung).collect()
}

fn payload(study: &Study) -> Ladder {
    let heaviest = study.design.payload.mass.1;
    if heaviest <= 0.0 {
        return Vec::new();
    }
    let rung = |share: &f64| {
        let most = share * heaviest;
        let lighter = |own: &mut Study| {
            let set = &mut own.design.payload;
            set.mass = (set.mass.0.min(most), most);
            if let Some(payload) = own.world.payload.as_mut().filter(|p| p.mass > most) {
                let part = most / payload.mass;
                payload.mass = most;
                payload.inertia.iter_mut().for_each(|entry| *entry *= part);
            }
            if most <= 0.0 {
                own.world.payload = None;
            }
        };
        Rung {
            change: format!("at most {most} kg of payload in place of {heaviest} kg"),
            key: "design.payload_max_kg",
            value: most.to_string(),
            study: changed(study, lighter),
        }
    };
    LIGHTER.iter().map(rung).collect()
}

fn form(study: &Study) -> Ladder {
    let control = &study.control;
    let fits = control.delay_samples <= AHEAD_MAX
        && study.design.inertia == InertiaSource::Robot
        && study.design.method == DesignMethod::Ours;
    if control.form == Form::Positions || control.form_designed || !fits {
        return Vec::new();
    }
    vec![Rung {
        change: "a law from positions".to_owned(),
        key: "loop.form",
        value: "\"positions\"".to_owned(),
        study: changed(study, |own| own.control.takes(Form::Positions)),
    }]
}

fn filter(study: &Study) -> Ladder {
    let sensor = &study.sensor;
    let fed =
        study.control.form != Form::Positions && sensor.velocity == VelocitySource::Differenced;
    if !fed || sensor.velocity_filter_designed {
        return Vec::new();
    }
    let free = |own: &mut Study| {
        own.sensor.velocity_filter_hz = None;
        own.sensor.velocity_filter_designed = true;
    };
    vec![Rung {
        change: "a velocity filter that the design chooses".to_owned(),
        key: "sensor.velocity_filter_hz",
        value: "\"design\"".to_owned(),
        study: changed(study, free),
    }]
}

fn noise(study: &Study) -> Ladder {
    let Some(most) = &study.design.torque_step_max else { return Vec::new() };
    let rung = |factor: &f64| {
        let louder: Vec<f64> = most.iter().map(|most| most * factor).collect();
        Rung {
            change: format!("{factor} times the torque noise"),
            key: "design.torque_step_max_nm",
            value: format!("{louder:?}"),
            study: changed(study, |own| own.design.torque_step_max = Some(louder)),
        }
    };
    LOUDER.iter().map(rung).collect()
}

/// No faster than the robot's interface takes commands.
fn rate(study: &Study) -> Ladder {
    let most = study.interface.profile.rate_max.unwrap_or(HIGHEST_HZ).min(HIGHEST_HZ);
    let period = study.control.period_ns;
    let rung = |multiple: &u64| {
        let hz = 1e9 / (period / multiple) as f64;
        (hz <= most && period.is_multiple_of(*multiple)).then(|| Rung {
            change: format!("{multiple} times the rate"),
            key: "loop.rate_hz",
            value: format!("{hz:?}"),
            study: changed(study, |own| own.control.period_ns = period / multiple),
        })
    };
    FASTER.iter().filter_map(rung).collect()
}

fn delay(study: &Study) -> Ladder {
    if study.control.delay_samples == 0 {
        return Vec::new();
    }
    vec![Rung {
        change: "no delay".to_owned(),
        key: "loop.delay_samples",
        value: "0".to_owned(),
        study: changed(study, |own| own.control.delay_samples = 0),
    }]
}

fn encoder(study: &Study) -> Ladder {
    let Some(bits) = &study.sensor.encoder_bits else { return Vec::new() };
    let rung = |more: &u32| {
        let finer: Vec<u32> = bits.iter().map(|bits| (bits + more).min(BITS_MAX)).collect();
        Rung {
            change: format!("encoders of {more} bit more"),
            key: "sensor.encoder_bits",
            value: format!("{finer:?}"),
            study: changed(study, |own| own.sensor.encoder_bits = Some(finer)),
        }
    };
    FINER.iter().map(rung).collect()
}

/// The world's level of dry friction \[N·m\] per joint.
fn level(study: &Study) -> Vec<f64> {
    let own = |(joint, extra): (&phihat_model::Joint, &f64)| {
        extra + if study.world.robot_friction { joint.friction.coulomb } else { 0.0 }
    };
    study.robot.joints.iter().zip(&study.world.extra_coulomb).map(own).collect()
}

/// Dry friction measured, where its highest level is above the one that the world has.
fn friction_known(study: &Study) -> Ladder {
    let (level, most) = (level(study), &study.design.coulomb.1);
    if level.iter().zip(most).all(|(level, most)| *most <= level * (1.0 + 1e-6)) {
        return Vec::new();
    }
    let rung = |share: &f64| {
        let between = level.iter().zip(most).map(|(level, most)| level + share * (most - level));
        let known: Vec<f64> = between.map(|level| digits::up(level, 4)).collect();
        Rung {
            change: "dry friction that is measured, so that its highest level is known better"
                .to_owned(),
            key: "design.coulomb_max_nm",
            value: format!("{known:?}"),
            study: changed(study, |own| own.design.coulomb.1 = known),
        }
    };
    KNOWN.iter().map(rung).collect()
}

/// The middle of its interval fed forward with the reference.
fn friction_fed(study: &Study) -> Ladder {
    let (low, high) = &study.design.coulomb;
    let middle = low.iter().zip(high).map(|(low, high)| digits::nearest(0.5 * (low + high), 3));
    let middle: Vec<f64> = middle.collect();
    let fed = study.feedforward.as_ref().is_some_and(|fed| fed.coulomb.iter().any(|c| *c > 0.0));
    let takes = study.control.form == Form::Positions;
    if fed || !takes || middle.iter().all(|level| *level <= 0.0) {
        return Vec::new();
    }
    let feed = |own: &mut Study| {
        let nothing = FeedForward { known: Known::Nothing, mass_scale: 1.0, coulomb: Vec::new() };
        own.feedforward.get_or_insert(nothing).coulomb.clone_from(&middle);
    };
    vec![Rung {
        change: "dry friction fed forward with the reference".to_owned(),
        key: "feedforward.coulomb_nm",
        value: format!("{middle:?}"),
        study: changed(study, feed),
    }]
}

/// Less of what the world adds to the description's.
fn less_friction(study: &Study) -> Ladder {
    let extra = &study.world.extra_coulomb;
    if extra.iter().all(|extra| *extra <= 0.0) {
        return Vec::new();
    }
    let (before, widest) = (level(study), &study.design.coulomb.1);
    // A highest level that is typed stays: less friction is then none that is known.
    if before.iter().zip(widest).any(|(level, most)| *most > level * (1.0 + 1e-6)) {
        return Vec::new();
    }
    let rung = |share: &f64| {
        let less: Vec<f64> = extra.iter().map(|extra| share * extra).collect();
        let with = |own: &mut Study| {
            own.world.extra_coulomb.clone_from(&less);
            own.design.coulomb.1 = level(own);
            for (low, high) in own.design.coulomb.0.iter_mut().zip(&own.design.coulomb.1) {
                *low = low.min(*high);
            }
        };
        Rung {
            change: format!("{share} of the dry friction beyond the description's"),
            key: "world.coulomb_extra_nm",
            value: format!("{less:?}"),
            study: changed(study, with),
        }
    };
    LESS.iter().map(rung).collect()
}

/// Rotors where a description states none, over the least inertia that the joint moves.
fn rotors(study: &Study, recordings: &Recordings) -> Ladder {
    let stated = |joint: &phihat_model::Joint| joint.armature > 0.0;
    if study.design.inertia != InertiaSource::Robot || study.robot.joints.iter().all(stated) {
        return Vec::new();
    }
    let Ok(known) = arm(study, recordings) else { return Vec::new() };
    let nominal = known.nominal();
    let rung = |share: &f64| {
        let with = |own: &mut Study| {
            for (joint, inertia) in own.robot.joints.iter_mut().zip(&nominal) {
                if joint.armature <= 0.0 {
                    joint.armature = digits::nearest(share * inertia, 2);
                }
            }
        };
        let study = changed(study, with);
        let armature: Vec<f64> = study.robot.joints.iter().map(|joint| joint.armature).collect();
        Rung {
            change: "rotors that the description does not state".to_owned(),
            key: "robot.armature_kg_m2",
            value: format!("{armature:?}"),
            study,
        }
    };
    ROTORS.iter().map(rung).collect()
}
