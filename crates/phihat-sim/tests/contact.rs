//! Contact and payload from torques: wrong if a run without anything from outside shows a contact, if an interval of
//! the payload excludes the one that is carried, or if a push beyond the stated reach stays unnoticed.
//!
//! The truth is the simulator's: payload, friction and push are drawn here, and the bound on the velocity error that
//! the watch is given is held against the velocities of each run.

use std::path::Path;

use allocation_counter::measure;
use phihat::{Form, JointDesign, JointGains};
use phihat_sim::{
    ContactRecord, ContactRefusal, ContactWatch, Simulation, Trace, VelocityErrorBounds,
};
use phihat_study::{AfterContact, Study, ToolForce};

/// Bound on the velocity error \[rad/s\]; the certificate's place.
const OFF: f64 = 0.08;

/// A generator of its own: xorshift.
struct Dice(u64);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

fn study(rest: &str) -> Study {
    let text = format!(
        "duration_s = 4.0\n[robot]\nname = \"ur5\"\n[design]\npayload_max_kg = 3.0\npayload_frame = \"tool0\"\n\
         payload_com_m = [[-0.05, 0.05], [-0.05, 0.05], [0.0, 0.1]]\npayload_gyration_m = 0.05\ncoulomb_max_nm = 0.5\n\
         [sensor]\nencoder_bits = 18\n[world]\nfriction = \"robot\"\ncoulomb_extra_nm = 0.2\n\
         [start]\ntorque_nm = \"balance\"\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 1.0\n\
         [[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = [0.2, 0.25, 0.3, 0.35, 0.4, 0.45]\n{rest}"
    );
    let mut study = Study::from_text(&text, "contact.toml", Path::new(".")).unwrap();
    study.world.substeps = 8;
    study
}

fn gains(study: &Study) -> Vec<JointGains<f64>> {
    assert_eq!(study.robot.name, "ur5");
    let law = |inertia: f64| {
        let (form, a) = (Form::Observer, &[40.0][..]);
        JointGains::new(&JointDesign { inertia, kp: 144.0, kd: 24.0, a, form, period: 1e-3 })
    };
    [1.56, 2.35, 0.945, 0.349, 0.345, 0.117].map(|inertia| law(inertia).unwrap()).to_vec()
}

/// A run under watch; its velocity errors before `until` \[s\] are within the bound.
fn watched(study: &Study, until: f64) -> ContactRecord {
    let bounds = VelocityErrorBounds::constant(vec![OFF; study.robot.joints.len()], true);
    let watch = ContactWatch::new(study, bounds).unwrap();
    let simulation = Simulation::new(study, &gains(study)).unwrap().watched(Some(watch));
    let mut trace = Trace::default();
    let ended = simulation.record(&mut trace, |_| ()).unwrap();
    for joint in &trace.joints {
        let before = joint.de.iter().zip(&trace.t_ns).filter(|(_, t)| **t as f64 * 1e-9 < until);
        let most = before.map(|(de, _)| de.abs()).fold(0.0, f64::max);
        assert!(most < OFF, "{}: {most} rad/s", joint.name);
    }
    *ended.contact.unwrap()
}

/// The study with a payload and friction of its own.
fn drawn(dice: &mut Dice, mut own: Study) -> (Study, f64, [f64; 3]) {
    let mass = dice.between(0.1, 3.0);
    let com = [dice.between(-0.05, 0.05), dice.between(-0.05, 0.05), dice.between(0.0, 0.1)];
    for level in &mut own.world.extra_coulomb {
        *level = dice.between(0.0, 0.3);
    }
    let payload = own.world.payload.as_mut().unwrap();
    (payload.mass, payload.com) = (mass, com);
    (own, mass, com)
}

const LOADED: &str =
    "[world.payload]\nframe = \"tool0\"\nmass_kg = 1.0\ncom_m = [0.0, 0.0, 0.05]\n";

#[test]
fn a_run_without_contact_shows_none_and_its_payload_is_in_the_interval() {
    let mut dice = Dice(0x9E37_79B9_7F4A_7C15);
    let draws = if std::env::var_os("PHIHAT_ALL").is_some() { 300 } else { 12 };
    for _ in 0..draws {
        let (own, mass, com) = drawn(&mut dice, study(LOADED));
        let record = watched(&own, 4.0);
        assert!(record.watched_samples > 2000 && record.ended.is_none(), "{record:?}");
        assert!(record.events.is_empty(), "{record:?}");
        let [payload] = &record.payloads[..] else { panic!("{record:?}") };
        let within = |(low, high): (f64, f64), x: f64| low <= x && x <= high && high - low < 3.0;
        assert!(within(payload.mass_kg, mass), "{mass} kg: {payload:?}");
        for (interval, com) in payload.com_m.into_iter().zip(com) {
            assert!(within(interval, com), "{com} m: {payload:?}");
        }
        let (low, high) = payload.mass_kg;
        assert!(high - low < 0.6, "{payload:?}");
    }
}

#[test]
fn a_push_beyond_the_reach_is_a_contact_with_its_force() {
    let mut dice = Dice(0xD134_2543_DE82_EF95);
    for axis in [0, 1, 2, 0, 1, 2] {
        let (mut own, ..) = drawn(&mut dice, study(LOADED));
        let reach = watched(&own, 4.0).reach.unwrap();
        let (frame, start, mut force) = (own.robot.tip.clone(), 2.5, [0.0; 3]);
        force[axis] = 1.05 * reach.always_n[axis].unwrap();
        own.world.forces.push(ToolForce { frame, force, start, duration: 0.4 });
        let record = watched(&own, start);
        let event = record.events.first().unwrap_or_else(|| panic!("{force:?}: {record:?}"));
        let late = event.t_s - start;
        assert!(late > 0.0 && late <= reach.within_s + 0.005, "{late} s: {event:?}");
        let found = event.force_n.unwrap();
        let off = (0..3).map(|i| (found[i] - force[i]).powi(2)).sum::<f64>().sqrt();
        assert!(off < 0.5 * force[axis], "{force:?}: {event:?}");
    }
}

#[test]
fn what_no_payload_of_the_set_explains_is_a_contact() {
    // Heavier than the set, friction above its interval, and a payload that is dropped.
    let mut heavy = study(LOADED);
    heavy.world.payload.as_mut().unwrap().mass = 4.0;
    assert!(!watched(&heavy, 0.0).events.is_empty());
    let mut rough = study(LOADED);
    rough.world.extra_coulomb.fill(2.0);
    rough.world.substeps = 80;
    assert!(!watched(&rough, 0.0).events.is_empty());
    let mut dropped = study(LOADED);
    dropped.world.payload.as_mut().unwrap().end = 2.0;
    let record = watched(&dropped, 2.0);
    assert!((record.events[0].t_s - 2.0).abs() < 0.1, "{record:?}");
    let masses: Vec<_> = record.payloads.iter().map(|payload| payload.mass_kg).collect();
    assert!(masses[0].0 > 0.7 && masses[0].1 < 1.3, "{masses:?}");
    assert!(masses[1].0 <= 0.0 && masses[1].1 < 0.3, "{masses:?}");
}

#[test]
fn what_has_no_bound_is_refused_by_name() {
    let refused = |rest: &str| {
        let study = study(rest);
        let bounds = VelocityErrorBounds::constant(vec![OFF; 6], true);
        ContactWatch::new(&study, bounds).unwrap_err()
    };
    let stiction = refused("[world.stiction]\nbreakaway_ratio = 1.5\n");
    assert_eq!(stiction, ContactRefusal::NoBound("world.stiction"));
    let few = ContactWatch::new(&study(""), VelocityErrorBounds::constant(vec![OFF; 5], true));
    assert_eq!(few.unwrap_err(), ContactRefusal::Bounds(5, 6));
}

#[test]
fn a_limit_that_the_certificate_does_not_exclude_ends_the_watch() {
    let own = study("[loop]\ntorque_max_nm = 1.0\n");
    for (silent, ends) in [(false, true), (true, false)] {
        let bounds = VelocityErrorBounds::constant(vec![OFF; 6], silent);
        let watch = ContactWatch::new(&own, bounds).unwrap();
        let simulation = Simulation::new(&own, &gains(&own)).unwrap().watched(Some(watch));
        let ended = simulation.record(&mut Trace::default(), |_| ()).unwrap();
        assert_eq!(ended.contact.unwrap().ended.is_some(), ends);
    }
}

#[test]
fn a_study_says_what_follows() {
    let own = study("[contact]\n");
    assert_eq!(own.contact.unwrap().then, AfterContact::Report);
}

#[test]
fn a_watch_does_not_allocate() {
    let mut own = study(LOADED);
    let frame = own.robot.tip.clone();
    own.world.forces.push(ToolForce { frame, force: [0.0, 60.0, 0.0], start: 1.0, duration: 0.2 });
    let bounds = VelocityErrorBounds::constant(vec![OFF; 6], true);
    let watch = ContactWatch::new(&own, bounds).unwrap();
    let simulation = Simulation::new(&own, &gains(&own)).unwrap().watched(Some(watch));
    let (mut control, mut world) = simulation.apart();
    let (mut total, mut torque) = (0, vec![0.0; 6]);
    while let Some(sensed) = world.sense() {
        let t = sensed.t_ns as f64 * 1e-9;
        total += measure(|| control.step(t, sensed.sample, sensed.runs)).count_total;
        torque.iter_mut().zip(control.commands()).for_each(|(tau, command)| *tau = command.tau);
        world.act(&torque);
    }
    assert_eq!(total, 0);
    assert!(!control.contact().unwrap().events.is_empty());
}
