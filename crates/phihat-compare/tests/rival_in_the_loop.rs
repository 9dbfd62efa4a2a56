//! A rival behind the simulator's seam is the same controller.
#![allow(clippy::unwrap_used, reason = "tests: a panic is the report")]

use std::path::Path;

use phihat::{Form, JointDesign, JointGains};
use phihat_compare::{Adapter, supply};
use phihat_rivals::{Tuning, rival};
use phihat_sim::Simulation;
use phihat_study::Study;

/// Saturation, delay, friction, gravity and an encoder are in it: the proposed law as a rival must then still
/// be the core's, bit for bit.
#[test]
fn the_proposed_law_as_a_rival_is_the_core() {
    let text = "duration_s = 3.0\n[robot]\nname = \"panda\"\n[spec]\nsettle_s = 1.0\n\
        [gains]\norder = 2\nbandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 60.0\ninertia_kg_m2 = 0.4\n\
        [loop]\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\n\
        [reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 1.0\n\
        [[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.4\n";
    let study = Study::from_text(text, "rival.toml", Path::new(".")).unwrap();
    let inertia = [0.4; 7];
    let a = &[3600.0, 120.0][..];
    let (kp, kd, period, form) = (400.0, 40.0, 1e-3, Form::Observer);
    let gains = inertia
        .map(|inertia| JointGains::new(&JointDesign { inertia, kp, kd, a, period, form }).unwrap());
    let core = Simulation::new(&study, &gains).unwrap().run(|_| ()).trace;
    let entry = rival("proposed-2").unwrap();
    let tuning = Tuning::new(&[20.0, 1.0, 60.0, 1.0], &inertia, period).unwrap();
    let built = entry.build(&tuning, &supply(&study, &inertia, 1.0).unwrap()).unwrap();
    let driven = Simulation::driven(&study, Adapter::new(built, 7), &inertia).unwrap();
    let own = driven.run(|_| ()).trace;
    for (core, own) in core.joints.iter().zip(&own.joints) {
        assert_eq!(core.e, own.e, "{}", core.name);
        assert_eq!(core.tau_command, own.tau_command);
    }
    assert_eq!(supply(&study, &inertia, 0.8).unwrap().task_period, Some(2.5));
}
