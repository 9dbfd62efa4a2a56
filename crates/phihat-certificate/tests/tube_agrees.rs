//! Two derivations of a tube that share no code, of the same studies: nearly the same tube.
//! Wrong if one of them forgot something that acts, counted it twice, or took it for much larger than it is.

use crate::support::{read, reference};
use phihat_certificate::tube::{TIGHTER, TubeInputs, TubeReference, derive};
use phihat_certificate::{FilterSection, Gains, Tube, TubeJoint};
use phihat_design::requested_gains;
use phihat_design::tube::{Desired, tube};
use phihat_sim::{Motion, Simulation, fed_along};

const PLANAR: &str = "[robot]\nname = \"planar3r\"\nlocked = { joint3 = 0.5 }\n[gains]\nkp_per_s2 = 1200.0\n\
                      kd_per_s = 70.0\na = [40.0]\ninertia_kg_m2 = [0.5, 0.25]\n[loop]\nrate_hz = 500.0\n\
                      delay_samples = 1\n";
const SINES: &str = "[reference]\nkind = \"sines\"\ncenter_rad = [0.3, 0.8]\nfade_in_s = 0.3\n[[reference.sine]]\n\
                     amplitude_rad = [0.2, 0.15]\nfrequency_hz = [1.0, 1.5]\nphase_rad = [0.7, 0.2]\n";

/// Both tubes of a study.
fn both(text: &str) -> (Tube, Tube) {
    let study = read(text);
    let gains = requested_gains(&study).unwrap();
    let motion = Motion::of(&study).unwrap();
    let desired = Desired::of(&study, |joint, t| motion.told(joint, t));
    let inertia: Vec<f64> = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let whole = reference(&study);
    let fed = fed_along(&study, &motion, &inertia, whole.q.len()).unwrap();
    let desired = desired.feeding(&fed);
    let first = tube(&study, &gains, &desired).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let (low, high) = &study.design.coulomb;
    let inputs = TubeInputs {
        study: &study,
        joints: &gains.joints,
        velocity_filter_hz: study.sensor.velocity_filter_hz,
        reference: &whole.feeding(&fed),
        payload: Some(&study.design.payload),
        slices: first.slices,
        coulomb: (low, high),
        bin_s: first.bin_s,
    };
    let second = derive(&inputs, &|_| ()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let settle = first.settle_s;
    (first, second.steady_from(settle))
}

/// Least and largest ratio of widths, their mean, and how far middles are apart, as a share of the width.
fn beside(first: (&[f64], &[f64]), second: (&[f64], &[f64])) -> [f64; 4] {
    let (mut least, mut most, mut sum, mut off) = (f64::INFINITY, 0.0_f64, 0.0, 0.0_f64);
    let n = first.0.len();
    for k in 0..n {
        let width = first.1[k] - first.0[k];
        let ratio = (second.1[k] - second.0[k]) / width;
        (least, most, sum) = (least.min(ratio), most.max(ratio), sum + ratio);
        let apart = 0.5 * (second.1[k] + second.0[k] - first.1[k] - first.0[k]);
        off = off.max(apart.abs() / width);
    }
    [least, most, sum / n as f64, off]
}

fn figures(first: &TubeJoint, second: &TubeJoint) -> [f64; 4] {
    [
        second.error_bound_rad / first.error_bound_rad,
        second.velocity_error_bound_rad_s / first.velocity_error_bound_rad_s,
        second.torque_max_nm / first.torque_max_nm,
        second.torque_step_max_nm / first.torque_step_max_nm,
    ]
}

/// A study, and how much of the first tube's mean width the second has, of `e` and of `ė`.
struct Case {
    name: &'static str,
    text: String,
    share: [f64; 2],
}

const DIFFERENCED: &str =
    "[sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\nvelocity_filter_hz = 100.0\n";
const MEASURED: &str = "[sensor]\nencoder_bits = 18\nvelocity = \"measured\"\n";
const HEAD: &str = "duration_s = 0.8\n[spec]\nsettle_s = 0.4\n";
const WORLD: &str = "[world]\nfriction = \"none\"\nsubsteps = 4\n";

fn payload(kg: f64) -> String {
    format!("[design]\npayload_max_kg = {kg}\n")
}

/// The same sensor with so many bits.
fn bits(count: u32) -> String {
    DIFFERENCED.replace("18", &count.to_string())
}

fn case(name: &'static str, share: [f64; 2], text: String) -> Case {
    Case { name, text, share }
}

/// Cases of what acts on the arm, one after the other.
fn payloads_and_friction() -> Vec<Case> {
    vec![
        case(
            "dry and viscous friction, a payload",
            [0.985, 1.005],
            format!(
                "{HEAD}{PLANAR}{}coulomb_min_nm = 0.05\n{DIFFERENCED}{WORLD}coulomb_extra_nm = 0.1\n\
                 viscous_extra_nm_s_rad = 0.3\npayload = {{ mass_kg = 0.2 }}\n{SINES}",
                payload(0.2)
            ),
        ),
        case(
            "a payload alone, and a fine encoder",
            [1.09, 1.56],
            format!(
                "{HEAD}{PLANAR}{}{}{WORLD}payload = {{ mass_kg = 0.4 }}\n{SINES}",
                payload(0.4),
                bits(26)
            ),
        ),
        case(
            "a coarse encoder alone",
            [0.963, 0.925],
            format!("{HEAD}{PLANAR}{}{WORLD}{SINES}", bits(15)),
        ),
        case(
            "dry friction alone, of a level that is not known",
            [0.79, 0.66],
            format!(
                "{HEAD}{PLANAR}[design]\ncoulomb_min_nm = 0.1\n{}{WORLD}coulomb_extra_nm = 0.3\n{SINES}",
                bits(26)
            ),
        ),
        case(
            "viscous friction alone",
            [0.99, 0.99],
            format!("{HEAD}{PLANAR}{}{WORLD}viscous_extra_nm_s_rad = 2.0\n{SINES}", bits(26)),
        ),
    ]
}

fn other_loops_and_worlds() -> Vec<Case> {
    let second = PLANAR.replace("[40.0]", "[900.0, 60.0]");
    vec![
        case(
            "measured velocity, drives, told what was demanded",
            [0.94, 0.87],
            format!(
                "{HEAD}{PLANAR}{MEASURED}torque = \"demanded\"\n{WORLD}coulomb_extra_nm = 0.1\n\
                 drive_bandwidth_hz = [80.0, 120.0]\n{SINES}"
            ),
        ),
        case(
            "measured velocity, drives, told what acted",
            [0.98, 0.97],
            format!("{HEAD}{PLANAR}{MEASURED}{WORLD}drive_bandwidth_hz = [80.0, 120.0]\n{SINES}"),
        ),
        case(
            "second order, no filter",
            [0.95, 0.92],
            format!(
                "{HEAD}{second}[sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\n{WORLD}\
                 coulomb_extra_nm = 0.05\n{SINES}"
            ),
        ),
        case(
            "a push, from rest",
            [0.79, 0.865],
            format!(
                "{HEAD}{PLANAR}{DIFFERENCED}[world]\nfriction = \"none\"\nsubsteps = 4\n[[world.push]]\n\
                 joint = \"joint2\"\ntorque_nm = 2.0\nstart_s = 0.2\nduration_s = 0.1\n[reference]\n\
                 kind = \"hold\"\nq_rad = [0.4, 1.2]\n"
            ),
        ),
        case(
            "a robot that adds gravity and friction, and reads with a bias",
            [0.973, 0.922],
            format!(
                "{HEAD}{PLANAR}{DIFFERENCED}position_bias_rad = 1e-4\n[profile]\nname = \"robot\"\n\
                 adds_gravity = true\nadds_friction = 0.6\nfirst_torque_max_nm = 100.0\n[world]\n\
                 friction = \"robot\"\nsubsteps = 4\n{SINES}"
            ),
        ),
        case(
            "the literal law",
            [0.968, 0.936],
            format!("{HEAD}{PLANAR}form = \"literal\"\n{DIFFERENCED}{WORLD}{SINES}"),
        ),
    ]
}

#[test]
fn both_derivations_find_nearly_the_same_tube() {
    for Case { name, text, share } in
        payloads_and_friction().into_iter().chain(other_loops_and_worlds())
    {
        let (first, second) = both(&text);
        assert_eq!(first.joints.len(), second.joints.len());
        for (a, b) in first.joints.iter().zip(&second.joints) {
            let sides = [
                beside(
                    (&a.error_low_rad, &a.error_high_rad),
                    (&b.error_low_rad, &b.error_high_rad),
                ),
                beside(
                    (&a.velocity_low_rad_s, &a.velocity_high_rad_s),
                    (&b.velocity_low_rad_s, &b.velocity_high_rad_s),
                ),
            ];
            let [e, v] = sides;
            println!("{name}: {e:.3?} {v:.3?} {:.3?}", figures(a, b));
            for ([least, most, mean, off], share) in [(e, share[0]), (v, share[1])] {
                let near = (mean - share).abs() < 0.08 * share;
                assert!(near, "{name}: {mean} of the width, not {share}");
                assert!(least > 0.1 && most < 6.0 && off < 0.18, "{name}: {least} {most} {off}");
            }
            let [error, _, torque, _] = figures(a, b);
            let push = name.starts_with("a push");
            let near = |x: f64| (0.9..1.01).contains(&x) || push && (0.5..1.01).contains(&x);
            assert!(near(error) && near(torque), "{name}: {error} {torque}");
        }
    }
}

#[test]
fn a_tube_is_as_many_times_tighter_as_its_widths_and_figures_say() {
    let own = both(&payloads_and_friction()[0].text).1;
    // All of it about its middles: widths go with the share, largest errors hardly.
    let narrowed = |share: f64| {
        let mut tube = own.clone();
        for joint in &mut tube.joints {
            for (low, high) in [
                (&mut joint.error_low_rad, &mut joint.error_high_rad),
                (&mut joint.velocity_low_rad_s, &mut joint.velocity_high_rad_s),
            ] {
                for (low, high) in low.iter_mut().zip(high) {
                    let (middle, half) = (0.5 * (*low + *high), 0.5 * (*high - *low));
                    (*low, *high) = (middle - share * half, middle + share * half);
                }
            }
        }
        phihat_certificate::tube::beside(&tube, &own)
    };
    for times in [1.0, 1.001, 1.45, 30.0] {
        for joint in narrowed(1.0 / times).unwrap() {
            assert!((joint.tighter - times).abs() < 1e-9, "{times}: {joint:?}");
            assert_eq!(joint.confirmed(), times <= 1.0);
        }
    }
    assert!(narrowed(0.99 / TIGHTER).is_err() && narrowed(1.01 / TIGHTER).is_ok());
    // And by each figure alone.
    let figures: [fn(&mut TubeJoint) -> &mut f64; 4] = [
        |j| &mut j.error_bound_rad,
        |j| &mut j.velocity_error_bound_rad_s,
        |j| &mut j.torque_max_nm,
        |j| &mut j.torque_step_max_nm,
    ];
    for of in figures {
        let mut tube = own.clone();
        *of(&mut tube.joints[1]) /= 7.0;
        let told = phihat_certificate::tube::beside(&tube, &own).unwrap();
        assert!((told[1].tighter - 7.0).abs() < 1e-9 && (told[0].tighter - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_reference_is_sampled_through_the_run_and_once_more() {
    let study = read(&payloads_and_friction()[0].text);
    // 0.8 s at 500 Hz, of a motion that tells its time.
    let own = TubeReference::of(&study, |t| vec![[t, 2.0, 3.0], [-t, -2.0, -3.0]]);
    assert_eq!([own.q.len(), own.dq.len(), own.ddq.len()], [401; 3]);
    for (k, row) in own.q.iter().enumerate() {
        let t = 2e-3 * k as f64;
        assert!((row[0] - t).abs() < 1e-12 && (row[1] + t).abs() < 1e-12, "{k}");
        assert!((own.dq[k][1] + 2.0).abs() < 1e-12 && (own.ddq[k][0] - 3.0).abs() < 1e-12);
    }
}

/// A law from positions for each joint.
const POSITIONS: &str = "[robot]\nname = \"planar3r\"\nlocked = { joint3 = 0.5 }\n[gains]\norder = 1\nbandwidth_rad_s \
                         = 40.0\nestimator_bandwidth_rad_s = 160.0\ntorque_bandwidth_hz = 120.0\ninertia_kg_m2 = [0.5, \
                         0.25]\n[loop]\nrate_hz = 1000.0\ndelay_samples = 1\nform = \"positions\"\n";

/// Largest distance of a run from a tube's middle, as a share of the tube's half width there: 1 is the edge.
fn farthest(study: &phihat_study::Study, gains: &Gains, tube: &Tube) -> f64 {
    let names: Vec<String> = gains.joints.iter().map(|joint| joint.name.clone()).collect();
    let law = gains.joint_gains(&names, study.control.period_ns, study.control.form).unwrap();
    let run = Simulation::new(study, &law).unwrap().run(|_| ());
    let mut most = 0.0_f64;
    for (own, joint) in tube.joints.iter().zip(&run.trace.joints) {
        for (t, e) in run.trace.t_ns.iter().zip(&joint.e) {
            let bin = tube.bin_of(*t).min(own.error_low_rad.len() - 1);
            let (low, high) = (own.error_low_rad[bin], own.error_high_rad[bin]);
            most = most.max((e - 0.5 * (low + high)).abs() / (0.5 * (high - low)));
        }
    }
    most
}

#[test]
fn the_tube_of_laws_that_filter_holds_their_run_and_no_other() {
    // Hardly anything is uncertain: the tube is narrow.
    let world = format!("{}{WORLD}", bits(28));
    let study = read(&format!("{HEAD}{POSITIONS}{world}[start]\ntorque_nm = \"gravity\"\n{SINES}"));
    let plain = requested_gains(&study).unwrap();
    let mut filters = plain.clone();
    let sections = [
        FilterSection { rates: [0.03, 0.3], weights_per_s2: [-15.0, 100.0] },
        FilterSection { rates: [0.4, 0.9], weights_per_s2: [60.0, -300.0] },
    ];
    for (joint, count) in filters.joints.iter_mut().zip([2, 1]) {
        joint.observer.as_mut().unwrap().innovation_filter = sections[..count].to_vec();
    }
    let motion = Motion::of(&study).unwrap();
    let inertia: Vec<f64> = plain.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let whole = reference(&study);
    let fed = fed_along(&study, &motion, &inertia, whole.q.len()).unwrap();
    let whole = whole.feeding(&fed);
    let tube_of = |gains: &Gains| {
        let none = vec![0.0; inertia.len()];
        let inputs = TubeInputs {
            study: &study,
            joints: &gains.joints,
            velocity_filter_hz: None,
            reference: &whole,
            payload: None,
            slices: 1,
            coulomb: (&none, &none),
            bin_s: study.control.period_ns as f64 * 1e-9,
        };
        derive(&inputs, &|_| ()).unwrap()
    };
    for (own, other) in [(&plain, &filters), (&filters, &plain)] {
        let tube = tube_of(own);
        let (inside, outside) = (farthest(&study, own, &tube), farthest(&study, other, &tube));
        println!("{inside:.3} {outside:.3}");
        assert!(inside < 1.0 && outside > 3.0, "{inside} {outside}");
    }
}

#[test]
fn what_is_held_and_what_is_fed_forward_stays_in_both_tubes() {
    let observer = PLANAR.replace("[loop]\n", "[loop]\nform = \"observer\"\n");
    let literal = PLANAR.replace("[loop]\n", "[loop]\nform = \"literal\"\n");
    let world =
        format!("{DIFFERENCED}{WORLD}coulomb_extra_nm = 0.05\npayload = {{ mass_kg = 0.2 }}\n");
    let held = "[start]\ntorque_nm = \"gravity\"\n";
    let fed = "[feedforward]\nmodel = \"inverse_dynamics\"\nmass_scale = 0.9\ncoulomb_nm = 0.03\n";
    let cases =
        [("observer", &*observer, ""), ("literal", &literal, ""), ("positions", POSITIONS, fed)];
    for (name, arm, fed) in cases {
        let text = format!("{HEAD}{arm}{}{world}{held}{fed}{SINES}", payload(0.3));
        let free = format!("{HEAD}{arm}{}{world}{SINES}", payload(0.3));
        let (first, second) = both(&text);
        let study = read(&text);
        let law = requested_gains(&study).unwrap();
        let names: Vec<String> = law.joints.iter().map(|joint| joint.name.clone()).collect();
        let law = law.joint_gains(&names, study.control.period_ns, study.control.form).unwrap();
        let run = Simulation::new(&study, &law).unwrap().run(|_| ());
        for (i, joint) in run.trace.joints.iter().enumerate() {
            for tube in [&first, &second] {
                let own = &tube.joints[i];
                for (t, e) in run.trace.t_ns.iter().zip(&joint.e) {
                    let bin = tube.bin_of(*t).min(own.error_low_rad.len() - 1);
                    let inside = own.error_low_rad[bin] <= *e && *e <= own.error_high_rad[bin];
                    assert!(inside, "{name}: {e} at {t} ns");
                }
            }
        }
        // It is another tube than that of an arm that is let go, and both derivations say so.
        let (let_go, again) = both(&free);
        for (a, b, without) in [(&first, &second, &let_go), (&second, &first, &again)] {
            for ((own, other), without) in a.joints.iter().zip(&b.joints).zip(&without.joints) {
                let widest =
                    |joint: &TubeJoint| joint.error_high_rad.iter().fold(0.0_f64, |m, e| m.max(*e));
                println!(
                    "{name}: {:.3e} {:.3e} {:.3e}",
                    widest(own),
                    widest(other),
                    widest(without)
                );
                assert!((0.6..1.7).contains(&(widest(own) / widest(other))), "{name}");
            }
        }
    }
}
