//! A search joint by joint: the certificate of its candidates survives its own check and no forged one does; it bounds
//! the error of joints that are known one by one, and of no coupled arm; what cannot be had is refused with the value
//! that can. Wrong if a coupled arm had a bound without a tube, or if "infeasible" were said of something possible.

use std::path::Path;

use phihat::Form;
use phihat_design::{Alternative, Arm, Gains, Outcome, arm_inside_window, design};
use phihat_sim::{Demand, Metrics, Simulation};
use phihat_study::{InertiaSource, Study};
use phihat_synthesis::phi_along;

/// Changes gains or certificate.
type Forge<'a> = &'a dyn Fn(&mut Gains);

/// Joint center positions and the payload each arm is asked to bear.
const ARMS: [(&str, &str, f64); 4] = [
    ("planar3r", "[0.3, 0.8, 0.4]", 0.3),
    ("panda", "[0.0, -0.5, 0.0, -2.0, 0.0, 1.6, 0.5]", 1.0),
    ("iiwa14", "[0.0, 0.5, 0.0, -1.2, 0.0, 0.8, 0.0]", 2.0),
    ("ur5", "[0.0, -1.2, 1.2, -0.8, 0.6, 0.3]", 1.0),
];

fn study(arm: &str, center: &str, payload: f64, error: f64) -> Study {
    let text = format!(
        "duration_s = 8.0\n[robot]\nname = \"{arm}\"\n[spec]\nsettle_s = 3.0\nerror_bound_rad = {error:e}\n\
         [design]\npayload_max_kg = {payload}\n[loop]\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\n\
         velocity = \"differenced\"\nvelocity_filter_hz = 100.0\n[world]\ncoulomb_extra_nm = 0.1\n\
         substeps = 4\npayload = {{ mass_kg = {payload} }}\n[reference]\nkind = \"sines\"\n\
         center_rad = {center}\nfade_in_s = 1.0\n[[reference.sine]]\namplitude_rad = 0.2\n\
         frequency_hz = 0.2\nphase_rad = 0.7\n"
    );
    Study::from_text(&text, "arm.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn designed(study: &Study) -> Outcome {
    let demand = Demand::along(study).unwrap();
    let phi = |joint, inertia| phi_along(&demand, joint, inertia);
    design(study, &Arm::of(study).unwrap(), &phi).unwrap()
}

fn gains(study: &Study) -> Gains {
    match designed(study) {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("{no:?}"),
    }
}

#[test]
fn a_candidate_is_stable_on_every_arm_and_its_error_has_no_bound() {
    for (arm, center, payload) in ARMS {
        let study = study(arm, center, payload, 1e-3);
        let gains = gains(&study);
        let certificate = gains.certificate.as_ref().unwrap();
        certificate.verify(&gains).unwrap();
        arm_inside_window(&study, &Arm::of(&study).unwrap(), &gains).unwrap();
        let names = study.robot.joint_names();
        let law = gains.joint_gains(&names, study.control.period_ns, Form::Observer).unwrap();
        let outcome = Simulation::new(&study, &law).unwrap().run(|_| ());
        assert!(outcome.divergence.is_none());
        let metrics = Metrics::of(&outcome.trace, &study);
        assert!(metrics.within_spec, "{arm}");
        for joint in 0..certificate.joints.len() {
            assert_eq!(certificate.error_bound(joint), None, "{arm}");
            assert_eq!(certificate.own_bounds(joint), None, "{arm}");
        }
        let verified = certificate.verified(&gains).unwrap();
        assert!(!verified.bounded && verified.not_proved[0].contains("no tube"), "{arm}");
    }
}

#[test]
fn what_cannot_be_had_is_refused_with_what_can() {
    let (arm, center, payload) = ARMS[1];
    let Outcome::Infeasible(no) = designed(&study(arm, center, payload, 1e-5)) else {
        panic!("ten microradians are below the encoder's own resolution")
    };
    assert!(no.stable > 0 && no.tried > no.stable / 3);
    let clause = &no.clauses[0];
    assert_eq!(clause.key, "spec.error_bound_rad");
    assert!(clause.joint.as_ref().unwrap().starts_with("panda_joint"));
    let possible = clause.possible.unwrap();
    assert!(possible > 1e-5, "{possible}");
    // The nearest possible value is possible; a tenth less is not.
    assert!(matches!(designed(&study(arm, center, payload, possible)), Outcome::Designed(_)));
    let below = designed(&study(arm, center, payload, possible * 0.9));
    assert!(matches!(below, Outcome::Infeasible(_)));
}

#[test]
fn the_torque_rate_limit_is_a_clause() {
    let (arm, center, payload) = ARMS[1];
    let mut study = study(arm, center, payload, 2e-3);
    let free = gains(&study);
    let change = |gains: &Gains| {
        let joints = &gains.certificate.as_ref().unwrap().joints;
        joints.iter().map(|j| j.noise.as_ref().unwrap().change_max_nm).fold(0.0, f64::max)
    };
    // A hundredth of what the free design needs cannot be had, and the clause says so.
    study.design.torque_step_max = Some(vec![change(&free) / 100.0; 7]);
    let Outcome::Infeasible(no) = designed(&study) else { panic!("too quiet to be possible") };
    let clause = no.clauses.iter().find(|c| c.key == "design.torque_step_max_nm").unwrap();
    assert!(clause.possible.unwrap() > clause.wanted);
}

#[test]
fn the_robots_own_rule_is_a_clause_and_is_kept() {
    let (arm, center, payload) = ARMS[0];
    let mut study = study(arm, center, payload, 4e-3);
    let free = gains(&study);
    let period = study.control.period_ns as f64 * 1e-9;
    let change = |gains: &Gains| {
        let joints = &gains.certificate.as_ref().unwrap().joints;
        joints.iter().map(|j| j.noise.as_ref().unwrap().change_max_nm).fold(0.0, f64::max)
    };
    // Not the study's limit but the interface's, which the controller keeps.
    assert!(study.control.torque_rate_max.is_none());
    let rule = 0.9 * change(&free) / period;
    study.interface.profile.torque_rate_max = Some(rule);
    match designed(&study) {
        Outcome::Designed(gains) => {
            let joints = &gains.certificate.as_ref().unwrap().joints;
            assert!(change(&gains) < rule * period, "{} {rule}", change(&gains));
            assert!(joints.iter().all(|joint| joint.limits.1 == Some(rule)), "in the certificate");
        }
        Outcome::Infeasible(no) => {
            assert!(no.clauses.iter().any(|c| c.key == "profile.torque_rate_max_nm_s"), "{no:?}");
        }
    }
    study.interface.profile.torque_rate_max = Some(rule / 100.0);
    let Outcome::Infeasible(no) = designed(&study) else { panic!("too quiet to be possible") };
    let clause = no.clauses.iter().find(|c| c.key == "profile.torque_rate_max_nm_s").unwrap();
    assert!(clause.wanted < clause.possible.unwrap());
    // A controller that does not keep the rule is not limited by it, and the claims say so.
    study.interface.kept = false;
    assert!(matches!(designed(&study), Outcome::Designed(_)));
    let told = phihat_design::NotCounted::of(&study);
    assert!(told.iter().any(|one| one.key == "profile.controller_keeps"), "{told:?}");
}

#[test]
fn a_design_is_the_same_every_time_and_survives_its_file() {
    let (arm, center, payload) = ARMS[0];
    let study = study(arm, center, payload, 2e-3);
    let first = gains(&study);
    assert_eq!(first, gains(&study));
    let again = Gains::from_json(&first.to_json().unwrap()).unwrap();
    again.certificate.as_ref().unwrap().verify(&again).unwrap();
}

#[test]
fn forged_certificates_are_refused_by_the_inequality() {
    let (arm, center, payload) = ARMS[0];
    let good = gains(&study(arm, center, payload, 2e-3));
    let refusal = |forge: &dyn Fn(&mut Gains)| {
        let mut forged = good.clone();
        forge(&mut forged);
        let why = forged.certificate.clone().unwrap().verify(&forged);
        why.expect_err("a forged certificate must be refused").to_string()
    };
    let cases: [(&str, Forge<'_>); 7] = [
        ("window", &|g| {
            g.certificate.as_mut().unwrap().joints[1].window.as_mut().unwrap().high *= 1.1;
        }),
        ("witness", &|g| g.certificate.as_mut().unwrap().arm.high *= 3.0),
        ("torque noise", &|g| {
            let noise = g.certificate.as_mut().unwrap().joints[2].noise.as_mut().unwrap();
            noise.change_max_nm *= 0.9;
        }),
        ("M̄", &|g| g.joints[0].inertia_kg_m2 *= 1.5),
        ("first joint", &|g| g.joints[1].kp_per_s2 *= 1.01),
        ("names", &|g| g.joints[1].name = "other".to_owned()),
        ("entry per joint", &|g| {
            g.certificate.as_mut().unwrap().joints.pop();
        }),
    ];
    for (part, forge) in cases {
        let why = refusal(forge);
        println!("{why}");
        assert!(why.contains(part), "{part}: {why}");
    }
    // Every gain changed in every joint: nothing of the old certificate may survive.
    let why = refusal(&|g| g.joints.iter_mut().for_each(|j| j.kd_per_s *= 1.5));
    println!("{why}");
}

#[test]
fn an_arm_outside_its_window_is_not_armed() {
    let (arm, center, payload) = ARMS[1];
    let study = study(arm, center, payload, 2e-3);
    let mut gains = gains(&study);
    arm_inside_window(&study, &Arm::of(&study).unwrap(), &gains).unwrap();
    // Twelve times the nominal inertia: the arm is far below the window.
    for joint in &mut gains.joints {
        joint.inertia_kg_m2 *= 12.0;
    }
    // Their certificate is about other gains; without it, it is the window that refuses them.
    let why = arm_inside_window(&study, &Arm::of(&study).unwrap(), &gains).unwrap_err().to_string();
    assert!(why.contains("the gains' M̄") && why.contains("panda_joint1"), "{why}");
    gains.certificate = None;
    let why = arm_inside_window(&study, &Arm::of(&study).unwrap(), &gains).unwrap_err().to_string();
    assert!(why.contains("window.low") && why.contains("panda_joint1"), "{why}");
}

/// A study changed as an alternative says.
fn changed(study: &Study, other: &Alternative) -> Study {
    let mut study = study.clone();
    match other.key.as_str() {
        "loop.rate_hz" => {
            study.control.period_ns = (0..9)
                .map(|k| 1_000_000_u64 >> k)
                .find(|ns| (1e9 / *ns as f64 - other.value).abs() < 1e-6)
                .unwrap();
        }
        "loop.delay_samples" => study.control.delay_samples = 0,
        "sensor.velocity_filter_hz" => study.sensor.velocity_filter_hz = Some(other.value),
        key => panic!("{key}"),
    }
    study
}

#[test]
fn every_advice_leads_to_gains() {
    let (arm, center, payload) = ARMS[0];
    let strict = study(arm, center, payload, 1e-5);
    let Outcome::Infeasible(no) = designed(&strict) else { panic!("below the encoder") };
    let possible = no.clauses[0].possible.unwrap();
    // A little beyond what is possible: faster, or without delay, it can be had.
    let beyond = study(arm, center, payload, 0.8 * possible);
    // Less torque noise than an open velocity filter allows.
    let mut noisy = study(arm, center, payload, 2e-3);
    noisy.sensor.velocity_filter_hz = Some(400.0);
    let change = |gains: &Gains| {
        let joints = &gains.certificate.as_ref().unwrap().joints;
        joints.iter().map(|j| j.noise.as_ref().unwrap().change_max_nm).fold(0.0, f64::max)
    };
    noisy.design.torque_step_max = Some(vec![0.5 * change(&gains(&noisy)); 3]);
    for (study, key) in [(&beyond, "loop.rate_hz"), (&noisy, "sensor.velocity_filter_hz")] {
        let Outcome::Infeasible(no) = designed(study) else { panic!("{key}: not infeasible") };
        println!("{:?}\n{:?}", no.clauses, no.alternatives);
        assert!(no.alternatives.iter().any(|other| other.key == key), "{key}");
        for other in &no.alternatives {
            let gains = gains(&changed(study, other));
            gains.certificate.as_ref().unwrap().verify(&gains).unwrap();
        }
    }
}

#[test]
fn the_integral_and_the_rise_time_are_kept_too() {
    let (arm, center, payload) = ARMS[0];
    let mut study = study(arm, center, payload, 2e-3);
    // Known one by one, so that each joint has a bound of its own.
    let (low, high) = (vec![0.3, 0.15, 0.1], vec![0.6, 0.3, 0.2]);
    study.design.inertia = InertiaSource::Typed { low, high };
    let bound = |gains: &Gains| {
        let certificate = gains.certificate.as_ref().unwrap();
        let own = (0..3).map(|joint| certificate.own_bounds(joint).unwrap());
        own.map(|own| own.integral_rad_s.unwrap()).fold(0.0, f64::max)
    };
    let free = gains(&study);
    let asked = 0.8 * bound(&free);
    study.spec.error_integral_bound = Some(vec![asked; 3]);
    let kept = gains(&study);
    let verified = kept.certificate.as_ref().unwrap().verified(&kept).unwrap();
    assert!(verified.bounded && verified.not_proved.is_empty());
    assert!(bound(&kept) <= asked, "{} {asked}", bound(&kept));
    // 10 % to 90 % of a critically damped pair takes 3.36/ω.
    study.spec.error_integral_bound = None;
    study.design.rise_time = Some(3.36 / 40.0);
    for joint in &gains(&study).joints {
        assert!(joint.kp_per_s2.sqrt() > 39.9, "{}", joint.kp_per_s2.sqrt());
    }
}

#[test]
fn claims_about_the_whole_law_are_checked_again() {
    let (arm, center, payload) = ARMS[0];
    let good = gains(&study(arm, center, payload, 2e-3));
    let cases: [(&str, Forge<'_>); 6] = [
        ("(40)", &|g| {
            g.certificate
                .as_mut()
                .unwrap()
                .joints
                .iter_mut()
                .for_each(|j| j.continuous.as_mut().unwrap().paper.printed *= 0.9);
        }),
        ("√cond(S)", &|g| {
            g.certificate
                .as_mut()
                .unwrap()
                .joints
                .iter_mut()
                .for_each(|j| j.continuous.as_mut().unwrap().paper.corrected *= 0.9);
        }),
        ("φ̈", &|g| {
            let sampled = g.certificate.as_mut().unwrap().joints[0].sampled.as_mut().unwrap();
            sampled.bend[2] = sampled.bend[2].map(|gain| 0.9 * gain);
        }),
        ("varying inertia, sampled", &|g| {
            let claim = g.certificate.as_mut().unwrap().joints[0].sampled_varying.as_mut().unwrap();
            claim.high *= 10.0;
        }),
        ("missing is refused", &|g| g.certificate.as_mut().unwrap().joints[0].margins = None),
        ("velocity filter", &|g| g.velocity_filter_hz = Some(50.0)),
    ];
    for (part, forge) in cases {
        let mut forged = good.clone();
        forge(&mut forged);
        let why = forged.certificate.clone().unwrap().verify(&forged).unwrap_err().to_string();
        println!("{why}");
        assert!(why.contains(part), "{part}: {why}");
    }
}
