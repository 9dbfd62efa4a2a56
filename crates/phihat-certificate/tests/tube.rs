//! No run in scope leaves the tube, and the tube is not much wider than the runs. Wrong if a bound on anything
//! that acts were too small, or something that acts were forgotten.

use crate::support::{Case, Draw, hold};
use phihat_certificate::Tube;
use phihat_certificate::tube::{JointBeside, TIGHTER, TubeRefusal, beside};
use phihat_study::PayloadSet;

const PLANAR: &str = "[robot]\nname = \"planar3r\"\n[gains]\nkp_per_s2 = 2637.0\nkd_per_s = 102.7\na = [51.4]\n\
                      inertia_kg_m2 = [0.545, 0.243, 0.177]\n[loop]\nrate_hz = 1000.0\ndelay_samples = 1\n\
                      [sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\nvelocity_filter_hz = 100.0\n";
const SKEW: &str = "[robot]\nfile = \"skew2.urdf\"\narmature_kg_m2 = 0.1\n[gains]\nkp_per_s2 = 400.0\nkd_per_s = 40.0\n\
                    a = [1600.0, 80.0]\ninertia_kg_m2 = [0.3, 0.15]\n[loop]\nrate_hz = 1000.0\n\
                    [sensor]\nencoder_bits = 16\nvelocity = \"differenced\"\nvelocity_filter_hz = 150.0\n";

/// Runs with the corners of what is uncertain; prints the tube over the worst of them.
fn attack(name: &str, case: &Case, tube: &Tube) {
    let n = case.laws.len();
    let mut payloads = vec![None];
    if let Some(set) = &case.payload {
        payloads.clear();
        let corner = |bits: usize| {
            core::array::from_fn(|i| if bits >> i & 1 == 0 { set.com[i].0 } else { set.com[i].1 })
        };
        for bits in 0..8 {
            payloads.push(Some((set.mass.1, corner(bits))));
        }
        let middle = |m| Some((m, set.com.map(|(a, b)| 0.5 * (a + b))));
        payloads.extend([middle(set.mass.0), middle(0.5 * (set.mass.0 + set.mass.1))]);
    }
    let mut worst = vec![0.0_f64; n];
    let mut fastest = vec![0.0_f64; n];
    for (at, payload) in payloads.into_iter().enumerate() {
        for bits in [0, (1 << n) - 1, 0b0101_0101 >> (at % 2)] {
            let level = |i: usize| {
                if bits >> i & 1 == 0 { case.coulomb.0[i] } else { case.coulomb.1[i] }
            };
            let coulomb = (0..n).map(level).collect();
            let held = hold(tube, &case.run(&Draw { payload, coulomb, ..Draw::default() }));
            assert!(held.outside < 0.0, "{name}: left by {:e}", held.outside);
            for i in 0..n {
                worst[i] = worst[i].max(held.error_peak[i]);
                fastest[i] = fastest[i].max(held.velocity_max[i]);
            }
        }
    }
    let ratios = |claimed: &dyn Fn(usize) -> f64, seen: &[f64]| -> Vec<f64> {
        (0..n).map(|i| (claimed(i) / seen[i] * 100.0).round() / 100.0).collect()
    };
    let e = ratios(&|i| tube.joints[i].error_bound_rad, &worst);
    let de = ratios(&|i| tube.joints[i].velocity_error_bound_rad_s, &fastest);
    eprintln!("{name}: tube over runs, e {e:?} ({worst:?} rad), de {de:?}, slices {}", tube.slices);
}

fn set(frame: &str, mass: (f64, f64), reach: f64) -> PayloadSet {
    let com = [(-reach, reach), (-reach, reach), (0.02, 0.02 + reach)];
    PayloadSet { frame: frame.to_owned(), mass, com, gyration: 0.0, place_stated: true }
}

fn sines(n: usize) -> String {
    let list = |of: &dyn Fn(usize) -> f64| {
        (0..n).map(|i| format!("{:.3}", of(i))).collect::<Vec<_>>().join(", ")
    };
    let number = |i: usize| i as f64;
    format!(
        "[reference]\nkind = \"sines\"\ncenter_rad = [{}]\nfade_in_s = 0.5\n[[reference.sine]]\namplitude_rad = [{}]\n\
         frequency_hz = [{}]\nphase_rad = [{}]\n",
        list(&|i| 0.4 + 0.3 * number(i)),
        list(&|i| 0.3 - 0.05 * number(i)),
        list(&|i| 0.7 + 0.2 * number(i)),
        list(&number)
    )
}

#[test]
fn runs_of_an_uncertain_planar_arm_stay_inside() {
    let world = "[world]\nfriction = \"none\"\nsubsteps = 6\ncoulomb_extra_nm = 0.2\nviscous_extra_nm_s_rad = 0.1\n";
    let text = format!("duration_s = 2.0\n[spec]\nsettle_s = 1.0\n{PLANAR}{}{}", world, sines(3));
    let mut case = Case::new(&text);
    case.payload = Some(set("tool", (0.0, 0.5), 0.02));
    case.coulomb = (vec![0.0; 3], vec![0.2; 3]);
    let tube = case.derive().unwrap();
    assert!(tube.limits_silent);
    attack("planar3r", &case, &tube);
}

#[test]
fn runs_of_a_skew_arm_with_a_second_order_estimator_stay_inside() {
    let text = format!(
        "duration_s = 1.5\n[spec]\nsettle_s = 0.7\n{SKEW}[world]\nsubsteps = 4\nfriction = \"none\"\ncoulomb_extra_nm \
            = [0.1, 0.05]\n{}",
        sines(2)
    );
    let mut case = Case::new(&text);
    case.payload = Some(PayloadSet { gyration: 0.01, ..set("hand", (0.2, 0.4), 0.01) });
    case.coulomb = (vec![0.02; 2], vec![0.15, 0.1]);
    let tube = case.derive().unwrap();
    attack("skew2", &case, &tube);
}

#[test]
fn a_hold_from_rest_and_a_push_are_in_the_tube() {
    let text = format!(
        "duration_s = 1.2\n[spec]\nsettle_s = 0.6\n{PLANAR}[reference]\nkind = \"hold\"\nq_rad = [0.4, 1.2, 0.6]\n\
         [world]\nsubsteps = 4\n[[world.push]]\njoint = \"joint2\"\ntorque_nm = 2.0\nstart_s = 0.3\nduration_s = 0.2\n"
    );
    let case = Case::new(&text);
    let tube = case.derive().unwrap();
    attack("hold", &case, &tube);
    // Gravity pulls the arm down before the estimator knows of it: the start is part of the claim.
    let sag = tube.joints[0].error_low_rad.iter().chain(&tube.joints[0].error_high_rad);
    assert!(sag.fold(0.0_f64, |m, x| m.max(x.abs())) > 1e-3);
}

#[test]
fn a_pendulum_that_falls_is_not_certified() {
    let text = "duration_s = 1.5\n[spec]\nsettle_s = 0.5\n[robot]\nfile = \"short.urdf\"\n[gains]\n\
                kp_per_s2 = 100.0\nkd_per_s = 20.0\na = [1.0]\ninertia_kg_m2 = 0.0004\n[loop]\nrate_hz = 1000.0\n\
                [sensor]\nencoder_bits = 18\nvelocity = \"differenced\"\nvelocity_filter_hz = 150.0\n\
                [reference]\nkind = \"hold\"\nq_rad = 0.0\n";
    let refusal = Case::new(text).derive();
    assert!(
        matches!(refusal, Err(TubeRefusal::Open { .. } | TubeRefusal::NominalDiverges { .. })),
        "{refusal:?}"
    );
}

#[test]
fn runs_with_measured_velocity_and_slow_drives_stay_inside() {
    let text = "duration_s = 1.5\n[spec]\nsettle_s = 0.7\n[robot]\nname = \"planar3r\"\n[gains]\nkp_per_s2 = 900.0\n\
                kd_per_s = 60.0\na = [30.0]\ninertia_kg_m2 = [0.545, 0.243, 0.177]\n[loop]\nrate_hz = 1000.0\n\
                delay_samples = 1\n[sensor]\nencoder_bits = 18\nvelocity = \"measured\"\nposition_bias_rad = 1e-5\n\
                [world]\nfriction = \"none\"\nsubsteps = 6\ncoulomb_extra_nm = 0.2\ndrive_bandwidth_hz = [80.0, 120.0, \
                200.0]\n";
    for torque in ["applied", "demanded"] {
        let text = text.replace(
            "velocity = \"measured\"",
            &format!("velocity = \"measured\"\ntorque = \"{torque}\""),
        );
        let mut case = Case::new(&format!("{text}{}", sines(3)));
        case.payload = Some(set("tool", (0.0, 0.3), 0.02));
        case.coulomb = (vec![0.05; 3], vec![0.2; 3]);
        let tube = case.derive().unwrap();
        attack(torque, &case, &tube);
    }
}

#[test]
fn runs_of_a_robot_that_adds_gravity_and_friction_stay_inside() {
    let text = format!(
        "duration_s = 1.5\n[spec]\nsettle_s = 0.7\n{PLANAR}[profile]\nname = \"robot\"\nadds_gravity = true\n\
         adds_friction = 0.6\nfirst_torque_max_nm = 100.0\n[world]\nfriction = \"robot\"\nsubsteps = 6\n{}",
        sines(3)
    );
    let mut case = Case::new(&text);
    case.payload = Some(set("tool", (0.0, 0.3), 0.02));
    let tube = case.derive().unwrap();
    attack("profile", &case, &tube);
}

#[test]
fn a_claim_beside_what_is_derived() {
    let text = format!(
        "duration_s = 0.4\n[spec]\nsettle_s = 0.2\n{PLANAR}[world]\nsubsteps = 4\n{}",
        sines(3)
    );
    let case = Case::new(&text);
    let tube = case.derive().unwrap();
    let own = beside(&tube, &tube).unwrap();
    assert!(own.iter().all(JointBeside::confirmed), "{own:?}");
    let refused = |edit: &dyn Fn(&mut Tube)| {
        let mut other = tube.clone();
        edit(&mut other);
        beside(&other, &tube).is_err()
    };
    let shift = |bins: &mut Vec<f64>, by: f64| bins.iter_mut().for_each(|x| *x += by);
    assert!(refused(&|t| shift(&mut t.joints[0].error_low_rad, 1.0)), "beyond what is derived");
    assert!(refused(&|t| t.joints[1].velocity_high_rad_s[7] = -1.0), "below what is derived");
    assert!(refused(&|t| t.joints[2].velocity_low_rad_s[3] = f64::NAN), "no number");
    assert!(refused(&|t| t.joints[1].error_bound_rad /= 1.1 * TIGHTER), "too good");
    assert!(refused(&|t| t.joints[0].torque_max_nm = 0.0), "no torque");
    assert!(refused(&|t| t.joints[0].error_low_rad.truncate(3)), "bins less");
    assert!(refused(&|t| drop(t.joints.pop())), "a joint less");
    assert!(!refused(&|t| shift(&mut t.joints[0].error_high_rad, 1e-3)), "a weaker claim");
    // An arm at rest, seen exactly: what is left is rounding, of which every derivation has its own.
    let narrow = |size: f64| {
        let mut other = tube.clone();
        for joint in &mut other.joints {
            joint.error_low_rad.fill(-size);
            joint.error_high_rad.fill(size);
            joint.error_bound_rad = size;
        }
        other
    };
    assert!(beside(&narrow(1e-15), &narrow(2e-9)).is_ok(), "rounding");
    assert!(beside(&narrow(1e-15), &narrow(2e-6)).is_err(), "more than rounding");
}
