//! A rival behind the simulator's seam is the same controller.

use std::path::Path;

use phihat::{Form, InnovationSection, JointDesign, JointGains, PositionDesign};
use phihat_compare::{Adapter, supply};
use phihat_rivals::{DesignedPosition, Entry, Tuning, rival};
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

/// The Panda with its own limits, a torque rate of 1 N·m/ms among them, and other limits that act again and again.
fn positions(limit: &str) -> Study {
    let text = format!(
        "duration_s = 2.0\n[robot]\nname = \"panda\"\n[spec]\nsettle_s = 1.0\n[design]\n\
        [loop]\ndelay_samples = 1\nform = \"positions\"\n{limit}\n[sensor]\nencoder_bits = 18\n\
        [world]\nfriction = \"robot\"\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = 1.0\n\
        [[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.4\n"
    );
    Study::from_text(&text, "positions.toml", Path::new(".")).unwrap()
}

/// Compares the row's torques with those of the simulator's own law from positions, bit for bit; returns the
/// largest error of all joints \[rad\].
fn is_the_core(
    study: &Study,
    (entry, values): (&Entry, &[f64]),
    joints: &[DesignedPosition],
) -> f64 {
    let period = 1e-3;
    let gains = joints.iter().map(|joint| {
        JointGains::from_positions(&PositionDesign {
            inertia: joint.inertia,
            kp: joint.kp,
            kd: joint.kd,
            correction: &joint.correction,
            velocity_correction: &[],
            share: joint.share,
            delay: 1,
            period,
        })
    });
    let filtered = gains.map(Result::unwrap).zip(joints).map(|(gains, joint)| {
        if joint.innovation_filter.is_empty() {
            return gains;
        }
        gains.with_innovation_filter(&joint.innovation_filter).unwrap()
    });
    let gains: Vec<_> = filtered.collect();
    let core = Simulation::new(study, &gains).unwrap().run(|_| ()).trace;
    let inertia: Vec<f64> = joints.iter().map(|joint| joint.inertia).collect();
    let mut handed = supply(study, &inertia, 1.0).unwrap();
    handed.designed_positions = Ok(joints.to_vec());
    let tuning = Tuning::new(values, &inertia, period).unwrap();
    let adapter = Adapter::new(entry.build(&tuning, &handed).unwrap(), joints.len());
    let driver = adapter.with_preview(study).unwrap();
    let own = Simulation::driven(study, driver, &inertia).unwrap().run(|_| ()).trace;
    let mut most = 0.0_f64;
    for (core, own) in core.joints.iter().zip(&own.joints) {
        assert_eq!(core.tau_command, own.tau_command, "{}", core.name);
        assert_eq!(core.e, own.e, "{}", core.name);
        most = own.e.iter().fold(most, |most, e| most.max(e.abs()));
    }
    assert_eq!(own.joints[0].e.len(), 2000);
    most
}

/// Preview, delay, encoder, and limits in action: the rows are the core's law from positions, with a law for
/// all joints and with one for each.
#[test]
fn the_law_from_positions_as_a_rival_is_the_core() {
    // A triple pole as ADRC has it, `e^{−0.15}`, and what the row's other default values come to.
    let beta = (-0.15_f64).exp();
    let rest = 1.0 - beta;
    let closed = [1.0 - beta.powi(3), 1.5 * rest * rest * (1.0 + beta) * 1e3, -rest.powi(3) * 1e6];
    let joint = |inertia: f64, kp: f64, share: f64| DesignedPosition {
        inertia,
        kp,
        kd: 2.0 * kp.sqrt(),
        correction: closed.to_vec(),
        share,
        innovation_filter: Vec::new(),
    };
    let designed = rival("proposed-positions-designed").unwrap();
    let own: Vec<_> = (0..7_u32)
        .map(|i| {
            joint(0.3 + 0.1 * f64::from(i), 300.0 + 40.0 * f64::from(i), 0.2 + 0.1 * f64::from(i))
        })
        .collect();
    for limit in ["", "torque_max_nm = [20, 40, 20, 20, 5, 5, 5]"] {
        let study = positions(limit);
        let error = is_the_core(&study, (designed, &[]), &own);
        assert!(error > 1e-5, "it moved: {error}");
    }
    // And with a filter on the innovation of every other joint, which the rival does not lose.
    let study = positions("");
    let mut filtered = own.clone();
    for joint in filtered.iter_mut().step_by(2) {
        joint.innovation_filter =
            vec![InnovationSection { rates: [0.02, 0.3], weights: [-200.0, 50.0] }];
    }
    let [plain, with] = [&own, &filtered].map(|own| is_the_core(&study, (designed, &[]), own));
    assert!((plain - with).abs() > 1e-9, "it acts: {plain} {with}");
    let first = rival("proposed-positions-1").unwrap();
    let values: Vec<f64> = first.scalars.iter().map(|scalar| scalar.default).collect();
    let study = positions("");
    let tuning = Tuning::new(&values, &[0.4; 7], 1e-3).unwrap();
    let built = first.build(&tuning, &supply(&study, &[0.4; 7], 1.0).unwrap()).unwrap();
    let driver = Adapter::new(built, 7).with_preview(&study).unwrap();
    let row = Simulation::driven(&study, driver, &[0.4; 7]).unwrap().run(|_| ()).trace;
    let share = 1.0 - (-2.0 * core::f64::consts::PI * 50.0 * 1e-3).exp();
    let same = vec![joint(0.4, 400.0, share); 7];
    let mut handed = supply(&study, &[0.4; 7], 1.0).unwrap();
    handed.designed_positions = Ok(same);
    let built = designed.build(&Tuning::new(&[], &[0.4; 7], 1e-3).unwrap(), &handed).unwrap();
    let driver = Adapter::new(built, 7).with_preview(&study).unwrap();
    let closed = Simulation::driven(&study, driver, &[0.4; 7]).unwrap().run(|_| ()).trace;
    for (row, closed) in row.joints.iter().zip(&closed.joints) {
        let apart = row.e.iter().zip(&closed.e).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-9, "{}: {apart}", row.name);
    }
    assert_eq!(built_states(first), 7 * (2 + 1 + 1 + 2));
}

/// Number of its states, behind one sample of delay.
fn built_states(entry: &Entry) -> usize {
    let study = positions("");
    let tuning = Tuning::published(entry.scalars, &[0.4; 7], 1e-3).unwrap();
    entry.build(&tuning, &supply(&study, &[0.4; 7], 1.0).unwrap()).unwrap().states()
}
