//! A document's parts have to fit together: each edit that makes them speak of different things is refused at
//! the gate that is there for it.
//! Wrong if one of them passed, or was only stopped by luck further on.

use std::path::Path;

use phihat::{Form, GainError};
use phihat_certificate::{
    AnySpeed, ArmBasis, Certificate, FilterSection, Gains, GainsError, JointRecord, Optimality,
    Phi, PhiBasis, PositionObserver, ReferenceBounds, Refutation,
};
use phihat_study::Study;

/// An edit, and a part of the inequality that has to stop it.
type Forgery = (&'static str, fn(&mut Gains));

fn honest() -> Gains {
    Gains::from_json(include_str!("forged/two_joints.json")).unwrap()
}

fn study() -> Study {
    let text = include_str!("forged/two_joints.toml");
    Study::from_text(text, "two_joints.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

fn claims(gains: &mut Gains) -> &mut Certificate {
    gains.certificate.as_mut().unwrap()
}

fn phi() -> Phi {
    Phi {
        basis: PhiBasis::Typed,
        source: "typed".into(),
        size_nm: Some(1.0),
        rate_nm_s: 1.0,
        jump_nm: 1.0,
        motion: Some(ReferenceBounds {
            velocity_rad_s: 1.0,
            acceleration_rad_s2: 1.0,
            jerk_rad_s3: 1.0,
        }),
    }
}

fn stopped(list: &[Forgery], check: impl Fn(&Gains) -> Result<(), Refutation>) {
    let mut passed = Vec::new();
    for (index, (gate, edit)) in list.iter().enumerate() {
        let mut gains = honest();
        edit(&mut gains);
        match check(&gains) {
            Ok(()) => passed.push(format!("{index}, {gate}: passes")),
            Err(why) if !why.to_string().contains(gate) => {
                passed.push(format!("{index}, {gate}: stopped by {why}"));
            }
            Err(_) => {}
        }
    }
    assert!(passed.is_empty(), "{passed:#?}");
}

fn verify(gains: &Gains) -> Result<(), Refutation> {
    gains.certificate.as_ref().unwrap().verify(gains)
}

#[test]
fn what_a_document_says_of_itself_fits_together() {
    let list: [Forgery; 16] = [
        ("format and version", |g| g.format.push('x')),
        ("format and version", |g| g.version += 1),
        ("loop rate", |g| g.rate_hz = 0.0),
        ("loop rate", |g| g.rate_hz = f64::INFINITY),
        ("loop rate", |g| g.rate_hz = f64::NAN),
        ("loop rate", |g| g.rate_hz = -500.0),
        ("one entry per joint", |g| g.joints.truncate(1)),
        ("one entry per joint", |g| claims(g).joints.truncate(1)),
        ("one entry per joint", |g| claims(g).arm.nominal_kg_m2.truncate(1)),
        ("one entry per joint", |g| {
            g.joints.clear();
            claims(g).joints.clear();
            claims(g).arm.nominal_kg_m2.clear();
        }),
        ("that of the first joint", |g| g.joints[1].kp_per_s2 *= 1.0 + 1e-12),
        ("that of the first joint", |g| g.joints[1].kd_per_s *= 1.0 + 1e-12),
        ("that of the first joint", |g| g.joints[1].a[0] *= 1.0 + 1e-12),
        ("joint names agree", |g| g.joints[1].name.push('x')),
        ("joint names agree", |g| {
            g.joints[1].name = " ".into();
            claims(g).joints[1].name = " ".into();
        }),
        ("no two joint names", |g| {
            g.joints[1].name = g.joints[0].name.clone();
            claims(g).joints[1].name = g.joints[0].name.clone();
        }),
    ];
    stopped(&list, verify);
}

#[test]
fn what_a_document_says_of_arm_run_and_phi_makes_sense() {
    let list: [Forgery; 29] = [
        ("0 < low ≤ high", |g| claims(g).arm.low = 0.0),
        ("0 < low ≤ high", |g| claims(g).arm.low = 4.0),
        ("0 < low ≤ high", |g| claims(g).arm.high = f64::INFINITY),
        ("low is that of its witness", |g| claims(g).arm.low *= 1.0 - 1e-8),
        ("high is that of its witness", |g| claims(g).arm.high *= 1.0 - 1e-8),
        ("where it comes from", |g| claims(g).arm.source = " ".into()),
        ("only postures have witnesses", |g| claims(g).arm.basis = ArmBasis::Typed),
        ("a posture of the arm", |g| {
            claims(g).arm.searched.as_mut().unwrap().low.q.truncate(1);
        }),
        ("a posture of the arm", |g| {
            claims(g).arm.searched.as_mut().unwrap().high.q[0] = f64::NAN;
        }),
        ("payload is a body", |g| {
            claims(g).arm.searched.as_mut().unwrap().high.mass_kg = -1e-9;
        }),
        ("payload is a body", |g| {
            claims(g).arm.searched.as_mut().unwrap().high.com_m[1] = f64::NAN;
        }),
        ("payload is a body", |g| {
            claims(g).arm.searched.as_mut().unwrap().low.inertia_kg_m2[5] = f64::INFINITY;
        }),
        ("some postures", |g| {
            let searched = claims(g).arm.searched.as_mut().unwrap();
            (searched.postures, searched.of_reference) = (0, 0);
        }),
        ("some postures", |g| {
            let searched = claims(g).arm.searched.as_mut().unwrap();
            searched.of_reference = searched.postures + 1;
        }),
        ("duration", |g| claims(g).duration_s = 0.0),
        ("duration", |g| claims(g).duration_s = f64::INFINITY),
        ("1 ≤ window margin", |g| claims(g).window_margin = 1.0 - 1e-12),
        ("window margin < ∞", |g| claims(g).window_margin = f64::INFINITY),
        ("measured in the gains' M̄", |g| claims(g).arm.nominal_kg_m2[1] *= 1.0 + 1e-8),
        ("rate times period", |g| g.rate_hz *= 1.0 + 1e-8),
        ("filter is that of the gains", |g| g.velocity_filter_hz = Some(99.0)),
        ("in the same sampled loop", |g| {
            claims(g).joints[1].model.drive_bandwidth_hz = Some(500.0);
        }),
        ("in the same sampled loop", |g| claims(g).joints[1].model.delay_samples += 1),
        ("0 ≤ bound", |g| claims(g).joints[0].phi = Some(Phi { rate_nm_s: -1e-9, ..phi() })),
        ("0 ≤ bound", |g| claims(g).joints[0].phi = Some(Phi { size_nm: Some(-1e-9), ..phi() })),
        ("bound < ∞", |g| {
            claims(g).joints[0].phi = Some(Phi { jump_nm: f64::INFINITY, ..phi() });
        }),
        ("0 ≤ bound", |g| {
            let mut own = phi();
            own.motion.as_mut().unwrap().jerk_rad_s3 = -1e-9;
            claims(g).joints[0].phi = Some(own);
        }),
        ("where they come from", |g| {
            claims(g).joints[0].phi = Some(Phi { source: " ".into(), ..phi() });
        }),
        ("0 < gain", |g| g.joints.iter_mut().for_each(|joint| joint.kd_per_s = 0.0)),
    ];
    stopped(&list, verify);
}

#[test]
fn what_is_proved_of_the_range_holds_the_range() {
    fn proved(g: &mut Gains, low: f64, high: f64) {
        let arm = &mut claims(g).arm;
        let (low, high) = (low * arm.low, high * arm.high);
        arm.searched.as_mut().unwrap().proved =
            Some(phihat_certificate::Proved { low, high, cells: 1 });
    }
    let list: [Forgery; 6] = [
        ("0 < proved.low", |g| proved(g, 0.0, 1.1)),
        ("holds the witness", |g| proved(g, -1.0, 1.1)),
        ("holds the witness", |g| proved(g, f64::NAN, 1.1)),
        ("holds the witness", |g| proved(g, 1.0 + 1e-8, 1.1)),
        ("holds the witness", |g| proved(g, 0.9, 1.0 - 1e-8)),
        ("holds the witness", |g| proved(g, 0.9, f64::INFINITY)),
    ];
    stopped(&list, verify);
    let mut gains = honest();
    proved(&mut gains, 0.9, 1.1);
    verify(&gains).unwrap();
}

#[test]
fn claims_are_about_the_arms_whole_range() {
    let list: [Forgery; 17] = [
        // Each by itself is true, and claims less than the arm needs.
        ("window.low", |g| {
            let low = claims(g).arm.low / 1.2 * (1.0 + 1e-6);
            let window = claims(g).joints[0].window.as_mut().unwrap();
            (window.low, window.low_hz) = (low, 0.0);
        }),
        ("window.high", |g| {
            let high = claims(g).arm.high * 1.2 * (1.0 - 1e-6);
            let window = claims(g).joints[0].window.as_mut().unwrap();
            (window.high, window.high_hz) = (high, 0.0);
        }),
        ("low is arm.low", |g| claims(g).joints[0].margins.as_mut().unwrap().low *= 1.0 + 1e-8),
        ("high is arm.high", |g| claims(g).joints[0].margins.as_mut().unwrap().high *= 1.0 - 1e-8),
        ("as many ratios", |g| claims(g).joints[0].sampled.as_mut().unwrap().mu.truncate(8)),
        ("as many ratios", |g| claims(g).joints[0].reference.as_mut().unwrap().mu.truncate(8)),
        ("as many ratios", |g| claims(g).joints[0].step.as_mut().unwrap().mu.truncate(8)),
        ("as many ratios", |g| claims(g).joints[0].reading.as_mut().unwrap().mu.truncate(8)),
        ("as many ratios", |g| claims(g).joints[0].noise.as_mut().unwrap().mu.truncate(8)),
        ("ratios are even", |g| claims(g).joints[0].sampled.as_mut().unwrap().mu[4] *= 1.0 + 1e-8),
        ("ratios are even", |g| claims(g).joints[0].step.as_mut().unwrap().mu[8] *= 1.0 - 1e-8),
        ("fed forward", |g| {
            claims(g).joints[0].reference.as_mut().unwrap().feed_forward = false;
        }),
        ("go together", |g| claims(g).joints[0].reading = None),
        ("go together", |g| {
            claims(g).tube = None;
            claims(g).joints[0].noise = None;
        }),
        ("refused with its reason", |g| claims(g).joints[0].window = None),
        ("refused with its reason", |g| claims(g).joints[0].margins = None),
        ("refused with its reason", |g| claims(g).joints[0].step = None),
    ];
    stopped(&list, verify);
}

#[test]
fn nothing_rests_on_a_claim_that_is_refused() {
    // The first joint has nothing left that rests on its range, but for one claim.
    fn bare(g: &mut Gains) -> &mut phihat_certificate::JointCertificate {
        let whole = claims(g);
        (whole.coupled, whole.moving, whole.tube) = (None, None, None);
        let joint = &mut whole.joints[0];
        joint.refused = vec![Refutation {
            claim: "inertia window".into(),
            inequality: "honestly refused".into(),
            left: 1.0,
            right: 0.0,
        }];
        (joint.margins, joint.sampled, joint.reading, joint.reference) = (None, None, None, None);
        (joint.noise, joint.step) = (None, None);
        joint
    }
    let list: [Forgery; 10] = [
        ("honestly refused", |g| drop(bare(g).phi.take())),
        ("no claim rests", |g| bare(g).margins = honest().certificate.unwrap().joints[0].margins),
        ("no claim rests", |g| {
            bare(g).sampled = honest().certificate.unwrap().joints[0].sampled.clone();
        }),
        ("no claim rests", |g| {
            bare(g).reading = honest().certificate.unwrap().joints[0].reading.clone();
        }),
        ("no claim rests", |g| {
            bare(g).reference = honest().certificate.unwrap().joints[0].reference.clone();
        }),
        ("no claim rests", |g| {
            bare(g).noise = honest().certificate.unwrap().joints[0].noise.clone();
        }),
        ("no claim rests", |g| bare(g).step = honest().certificate.unwrap().joints[0].step.clone()),
        ("no claim rests", |g| {
            bare(g);
            claims(g).coupled = honest().certificate.unwrap().coupled;
        }),
        ("no claim rests", |g| {
            bare(g);
            claims(g).moving = honest().certificate.unwrap().moving;
        }),
        ("no claim rests", |g| {
            bare(g);
            claims(g).any_speed = Some(AnySpeed { low: 1.0, high: 1.0 });
        }),
    ];
    stopped(&list, verify);
}

#[test]
fn a_range_for_any_speed_is_proved_for_every_joint() {
    let mut gains = honest();
    claims(&mut gains).any_speed = Some(AnySpeed { low: 1.0, high: 1.0 });
    verify(&gains).unwrap();
    let list: [Forgery; 3] = [
        ("at θ", |g| claims(g).any_speed = Some(AnySpeed { low: 0.2, high: 8.0 })),
        ("low ≤ high", |g| claims(g).any_speed = Some(AnySpeed { low: 2.0, high: 1.0 })),
        ("low ≤ high", |g| claims(g).any_speed = Some(AnySpeed { low: f64::NAN, high: 1.0 })),
    ];
    stopped(&list, verify);
}

#[test]
fn claims_of_a_second_joint_are_checked_where_they_are_others() {
    fn second(g: &mut Gains) -> &mut phihat_certificate::JointCertificate {
        claims(g).tube = None;
        &mut claims(g).joints[1]
    }
    let list: [Forgery; 12] = [
        ("inertia window", |g| second(g).window.as_mut().unwrap().low *= 0.5),
        ("varying inertia", |g| second(g).varying.as_mut().unwrap().high *= 1e3),
        ("varying inertia, sampled", |g| second(g).sampled_varying.as_mut().unwrap().high *= 1e3),
        ("attenuation", |g| {
            second(g).continuous.as_mut().unwrap().attenuation.blocking_w = Some(1.0);
        }),
        ("optimality", |g| {
            let Some(Optimality::Certified(own)) =
                &mut second(g).continuous.as_mut().unwrap().optimality
            else {
                panic!()
            };
            own.q[0] *= 2.0;
        }),
        ("input-to-state", |g| second(g).continuous.as_mut().unwrap().iss.rate *= 2.0),
        ("bound = √cond(S) (40)", |g| {
            second(g).continuous.as_mut().unwrap().paper.corrected *= 0.5;
        }),
        ("H-infinity norm", |g| second(g).continuous.as_mut().unwrap().norm.upper *= 0.5),
        ("performance", |g| second(g).continuous.as_mut().unwrap().peaks.states[0].upper *= 0.5),
        ("sampled peak gains", |g| second(g).sampled.as_mut().unwrap().jump[1] *= 0.5),
        ("reading error", |g| second(g).reading.as_mut().unwrap().error *= 0.5),
        ("reference error", |g| second(g).reference.as_mut().unwrap().acceleration *= 0.5),
    ];
    stopped(&list, verify);
}

#[test]
fn a_document_carries_a_filter_and_no_controller_runs_one_that_is_none() {
    let section = FilterSection { rates: [0.02, 0.3], weights_per_s2: [300.0, -50.0] };
    let gains = |innovation_filter: Vec<FilterSection>| {
        let joint = JointRecord {
            name: "pivot".into(),
            inertia_kg_m2: 0.5,
            kp_per_s2: 400.0,
            kd_per_s: 40.0,
            a: vec![],
            observer: Some(PositionObserver {
                correction: vec![0.271, 28.5, -1000.0],
                share: 0.6,
                delay_samples: 1,
                innovation_filter,
            }),
        };
        Gains::stated(vec![joint], 1000.0, "typed")
    };
    let runs = |filter: Vec<FilterSection>| {
        gains(filter).joint_gains(&["pivot".into()], 1_000_000, Form::Positions)
    };
    for count in 0..=2 {
        let own = gains(vec![section; count]);
        let text = own.to_json().unwrap();
        assert_eq!(Gains::from_json(&text).unwrap(), own);
        assert_eq!(text.contains("innovation_filter"), count > 0);
        assert!(runs(vec![section; count]).is_ok());
    }
    let why = |filter| match runs(filter) {
        Err(GainsError::Joint { error, .. }) => error,
        other => panic!("{other:?}"),
    };
    assert_eq!(why(vec![section; 3]), GainError::Sections { count: 3 });
    let grows = FilterSection { rates: [0.3, 0.2], ..section };
    assert_eq!(why(vec![section, grows]), GainError::UnstableSection { index: 1 });
    let endless = FilterSection { weights_per_s2: [f64::INFINITY, 0.0], ..section };
    assert!(matches!(why(vec![endless]), GainError::NotFinite { .. }));
}

#[test]
fn claims_of_one_joint_are_not_those_of_another_law() {
    // Joints that are known one by one may have laws of their own.
    fn alone(g: &mut Gains) -> &mut JointRecord {
        let whole = claims(g);
        (whole.coupled, whole.moving, whole.tube, whole.arm.searched) = (None, None, None, None);
        whole.arm.basis = ArmBasis::Typed;
        for joint in &mut whole.joints {
            (joint.noise, joint.reading) = (None, None);
            joint.step.as_mut().unwrap().step_rad = Some(0.0);
            joint.step.as_mut().unwrap().torque_per_rad_nm *= 10.0;
            joint.step.as_mut().unwrap().change_per_rad_nm *= 10.0;
        }
        &mut g.joints[1]
    }
    let mut gains = honest();
    alone(&mut gains);
    verify(&gains).unwrap();
    let list: [Forgery; 3] = [
        ("joint2: ", |g| alone(g).kp_per_s2 *= 1.3),
        ("joint2: ", |g| alone(g).kd_per_s *= 0.7),
        ("joint2: ", |g| alone(g).a[0] *= 1.3),
    ];
    stopped(&list, verify);
}

#[test]
fn stability_while_moving_is_about_the_arms_range() {
    let list: [Forgery; 2] = [
        ("its range holds the arm's", |g| {
            let low = claims(g).arm.low;
            claims(g).moving.as_mut().unwrap().low = low * (1.0 + 1e-9);
        }),
        ("its range holds the arm's", |g| {
            let high = claims(g).arm.high;
            claims(g).moving.as_mut().unwrap().high = high * (1.0 - 1e-9);
        }),
    ];
    stopped(&list, verify);
}

#[test]
fn a_tube_fits_the_document_that_carries_it() {
    fn tube(g: &mut Gains) -> &mut phihat_certificate::Tube {
        claims(g).tube.as_mut().unwrap()
    }
    let list: [Forgery; 44] = [
        ("or the reason why", |g| claims(g).tube_refused = Some("none".into())),
        ("one entry per joint", |g| tube(g).joints.truncate(1)),
        ("one entry per joint", |g| tube(g).quantum_rad.truncate(1)),
        ("one entry per joint", |g| tube(g).coulomb_nm.0.truncate(1)),
        ("one entry per joint", |g| tube(g).coulomb_nm.1.truncate(1)),
        ("0 < bin", |g| tube(g).bin_s = 0.0),
        ("0 < bin", |g| tube(g).bin_s = f64::INFINITY),
        ("0 < bin", |g| tube(g).slices = 0),
        ("length of the run", |g| tube(g).duration_s *= 1.0 + 1e-8),
        ("0 ≤ settling time", |g| tube(g).settle_s = -1e-12),
        ("settling time ≤ length", |g| tube(g).settle_s = 1.0 + 1e-12),
        ("one settling time", |g| tube(g).settle_s += 1e-8),
        ("no limit can act", |g| tube(g).limits_silent = false),
        ("0 ≤ lightest", |g| tube(g).payload.mass_kg.0 = -1e-12),
        ("lightest ≤ heaviest", |g| tube(g).payload.mass_kg.0 = 0.2 + 1e-12),
        ("heaviest payload < ∞", |g| tube(g).payload.mass_kg.1 = f64::INFINITY),
        ("0 ≤ radius", |g| tube(g).payload.gyration_m = -1e-12),
        ("radius of gyration < ∞", |g| tube(g).payload.gyration_m = f64::INFINITY),
        ("box are in order", |g| tube(g).payload.com_m[2] = (1e-12, 0.0)),
        ("|centre of mass| < ∞", |g| tube(g).payload.com_m[0].0 = f64::NEG_INFINITY),
        ("|centre of mass| < ∞", |g| tube(g).payload.com_m[0].1 = f64::INFINITY),
        ("frame is that of the range", |g| tube(g).payload.frame.push('x')),
        ("joint names agree", |g| tube(g).joints[1].name.push('x')),
        ("bins from the start", |g| tube(g).joints[0].error_low_rad.truncate(41)),
        ("bins from the start", |g| tube(g).joints[0].error_high_rad.push(0.0)),
        ("bins from the start", |g| tube(g).joints[1].velocity_low_rad_s.push(-1.0)),
        ("bins from the start", |g| tube(g).joints[1].velocity_high_rad_s.truncate(41)),
        ("bins from the start", |g| tube(g).bin_s *= 2.0),
        ("low ≤ high", |g| {
            let joint = &mut tube(g).joints[0];
            joint.error_low_rad[3] = joint.error_high_rad[3] + 1e-12;
        }),
        ("low ≤ high", |g| tube(g).joints[1].velocity_high_rad_s[3] = f64::NAN),
        ("|bound| < ∞", |g| tube(g).joints[0].error_low_rad[0] = f64::NEG_INFINITY),
        ("|bound| < ∞", |g| tube(g).joints[0].velocity_high_rad_s[0] = f64::INFINITY),
        ("largest |e|", |g| tube(g).joints[0].error_bound_rad *= 1.0 - 1e-8),
        ("largest |e|", |g| tube(g).joints[0].error_bound_rad *= 1.0 + 1e-8),
        ("largest |ė|", |g| tube(g).joints[1].velocity_error_bound_rad_s *= 1.0 - 1e-8),
        // The bin that ends after the settling time counts, on either side.
        ("largest |e|", |g| tube(g).joints[0].error_high_rad[20] = 1.0),
        ("largest |ė|", |g| tube(g).joints[0].velocity_low_rad_s[41] = -1.0),
        ("0 ≤ dry friction", |g| tube(g).coulomb_nm.0[1] = -1e-12),
        ("low ≤ high level", |g| tube(g).coulomb_nm.0[1] = 0.1 + 1e-12),
        ("dry friction < ∞", |g| tube(g).coulomb_nm.1[0] = f64::INFINITY),
        ("quantum of the encoder", |g| tube(g).quantum_rad[1] *= 1.0 + 1e-6),
        ("0 ≤ torque", |g| tube(g).joints[0].torque_max_nm = -1e-12),
        ("torque ≤ its limit", |g| tube(g).joints[0].torque_max_nm = 50.0 * 1.003),
        ("torque step ≤ its limit", |g| {
            // 500 Hz: 2 ms of so much is 0.1 % less than what the tube has.
            let most = tube(g).joints[0].torque_step_max_nm;
            claims(g).joints[0].limits.1 = Some(most / 1.003 * 500.0);
        }),
    ];
    stopped(&list, verify);
    let mut gains = honest();
    // What ends before the settling time is no part of the steady errors.
    tube(&mut gains).joints[0].error_high_rad[19] = 1.0;
    verify(&gains).unwrap();
}

#[test]
fn what_the_study_says_is_what_the_file_says() {
    let study = study();
    let list: [Forgery; 24] = [
        ("study_sha256", |g| g.study_sha256.push('x')),
        ("study is", |g| g.study.push('x')),
        ("joints is", |g| g.joints[0].name.push('x')),
        ("rate_hz", |g| g.rate_hz *= 1.0 + 1e-8),
        ("loop is", |g| claims(g).joints[1].model.delay_samples += 1),
        ("torque_max_nm", |g| claims(g).joints[0].limits.0 = Some(51.0)),
        ("torque_max_nm", |g| claims(g).joints[0].limits.0 = None),
        ("torque_rate_max_nm_s", |g| claims(g).joints[0].limits.1 = Some(1e3)),
        ("quantum is that", |g| {
            claims(g).joints[1].noise.as_mut().unwrap().quantum_rad *= 1.0 + 1e-8;
        }),
        ("quantum is that", |g| {
            claims(g).joints[1].noise.as_mut().unwrap().quantum_rad *= 1.0 - 1e-8;
        }),
        ("duration is", |g| claims(g).duration_s *= 1.0 + 1e-8),
        ("window margin is", |g| claims(g).window_margin *= 1.0 + 1e-8),
        ("from where the study says", |g| claims(g).arm.basis = ArmBasis::Typed),
        ("payload's frame", |g| claims(g).arm.searched.as_mut().unwrap().frame.push('x')),
        ("smallest eigenvalue", |g| {
            claims(g).arm.searched.as_mut().unwrap().low.eigenvalue *= 1.0 + 1e-5;
        }),
        ("smallest eigenvalue", |g| {
            claims(g).arm.searched.as_mut().unwrap().low.eigenvalue *= 1.0 - 1e-5;
        }),
        ("largest eigenvalue", |g| {
            claims(g).arm.searched.as_mut().unwrap().high.eigenvalue *= 1.0 + 1e-5;
        }),
        ("largest eigenvalue", |g| {
            claims(g).arm.searched.as_mut().unwrap().high.eigenvalue *= 1.0 - 1e-5;
        }),
        ("mass is in the study's set", |g| {
            claims(g).arm.searched.as_mut().unwrap().high.mass_kg = 0.2 + 1e-6;
        }),
        ("in the study's box", |g| {
            claims(g).arm.searched.as_mut().unwrap().high.com_m[1] = 1e-6;
        }),
        ("second moments", |g| {
            claims(g).arm.searched.as_mut().unwrap().high.inertia_kg_m2[1] = 1e-6;
        }),
        ("low M̄ at a posture", |g| claims(g).arm.low *= 1.6),
        ("high M̄ at a posture", |g| claims(g).arm.high *= 0.8),
        ("the witness's inertia", |g| {
            let coupled = claims(g).coupled.as_mut().unwrap();
            coupled.witnesses[0].mass_matrix_kg_m2[0][0] *= 1.0 + 1e-7;
        }),
    ];
    let derive =
        |gains: &Gains| gains.certificate.as_ref().unwrap().derive(gains, &study).map(|_| ());
    derive(&honest()).unwrap();
    stopped(&list, derive);
}

#[test]
fn a_wrong_eigenvalue_is_told_with_the_right_one() {
    let study = study();
    let own = honest().certificate.unwrap().arm;
    for (low, right) in [(true, own.low), (false, own.high)] {
        let mut gains = honest();
        let searched = claims(&mut gains).arm.searched.as_mut().unwrap();
        let end = if low { &mut searched.low } else { &mut searched.high };
        end.eigenvalue *= 1.01;
        let why = gains.certificate.as_ref().unwrap().derive(&gains, &study).unwrap_err();
        assert!(
            (why.left - 1.01 * right).abs() < 1e-12 && (why.right - right).abs() < 1e-9,
            "{why}"
        );
    }
}

#[test]
fn what_the_study_says_is_what_the_tube_says() {
    let study = study();
    let list: [Forgery; 8] = [
        ("payloads are", |g| claims(g).tube.as_mut().unwrap().payload.mass_kg.1 *= 0.5),
        ("levels of dry friction", |g| claims(g).tube.as_mut().unwrap().coulomb_nm.1[0] *= 0.5),
        ("levels of dry friction", |g| claims(g).tube.as_mut().unwrap().coulomb_nm.0[1] *= 2.0),
        ("quantum is", |g| claims(g).tube.as_mut().unwrap().quantum_rad[0] *= 0.5),
        ("quantum is", |g| claims(g).tube.as_mut().unwrap().quantum_rad[1] = 0.0),
        ("settling time is", |g| claims(g).tube.as_mut().unwrap().settle_s += 1e-8),
        ("settling time is", |g| claims(g).tube.as_mut().unwrap().settle_s -= 1e-8),
        ("payloads are", |g| claims(g).tube.as_mut().unwrap().payload.frame.push('x')),
    ];
    let is_of = |gains: &Gains| gains.certificate.as_ref().unwrap().tube_is_of(&study);
    is_of(&honest()).unwrap();
    stopped(&list, is_of);
}
