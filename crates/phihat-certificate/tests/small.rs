//! Parts of a document against closed forms and by hand; and what makes no sense is refused.
#![allow(clippy::float_cmp, reason = "tests: small whole numbers")]

use phihat_certificate::{
    ArmBasis, Attenuation, Bounds, Gains, InertiaWindow, Interval, LeftOut, LoopModel, Matrix,
    Moving, NotCounted, PeakGain, PeakGains, Phi, PhiBasis, Proved, Quantity, ReferenceBounds,
    Refutation, TorqueNoise,
};

/// An edit, and a part of the inequality that has to stop it.
type Edit<C> = (&'static str, fn(&mut C));

fn document() -> Gains {
    Gains::from_json(include_str!("forged/two_joints.json")).unwrap()
}

#[test]
fn a_window_is_made_smaller_at_both_ends() {
    let window = InertiaWindow { low: 0.5, high: 8.0, low_hz: 50.0, high_hz: 2.0 };
    let inside = window.inside(1.2, 1.6);
    assert_eq!((inside.low, inside.high, inside.low_hz), (0.6, 5.0, 50.0));
    assert_eq!(window.ratio(), 16.0);
    assert!(window.contains(0.5, 8.0) && window.contains(1.0, 1.0));
    for (low, high) in [(0.49, 1.0), (1.0, 8.1), (3.0, 2.0), (f64::NAN, 1.0), (1.0, f64::NAN)] {
        assert!(!window.contains(low, high), "{low} {high}");
    }
}

#[test]
fn a_phi_is_bounded_by_the_smaller_of_its_parts_and_its_whole() {
    let phi = |size| Phi {
        basis: PhiBasis::Typed,
        source: "typed".into(),
        size_nm: size,
        rate_nm_s: 3.0,
        jump_nm: 2.0,
        motion: None,
    };
    // Gains 5 and 7: 7 · 3 + 5 · 2, or 5 times the size.
    assert_eq!(phi(None).bound(5.0, Some(7.0)), 31.0);
    assert_eq!(phi(Some(6.0)).bound(5.0, Some(7.0)), 30.0);
    assert_eq!(phi(Some(7.0)).bound(5.0, Some(7.0)), 31.0);
    assert_eq!(phi(Some(6.0)).bound(5.0, None), 30.0);
    assert_eq!(phi(None).bound(5.0, None), f64::INFINITY);
    let motion =
        ReferenceBounds { velocity_rad_s: 9.0, acceleration_rad_s2: 2.0, jerk_rad_s3: 5.0 };
    assert_eq!(motion.costs(3.0, None), 6.0);
    assert_eq!(motion.costs(3.0, Some(1.0)), 5.0);
    assert_eq!(motion.costs(3.0, Some(2.0)), 6.0);
}

#[test]
fn peak_gains_are_found_by_their_names() {
    // Order 2: (∬e, ∫e, e, ė).
    let gain = |x: f64| PeakGain { lower: 0.5 * x, upper: x };
    let peaks =
        PeakGains { mu: 1.0, states: [1.0, 2.0, 3.0, 4.0].map(gain).to_vec(), estimate: gain(9.0) };
    assert_eq!(peaks.error(0), Some(gain(3.0)));
    assert_eq!(peaks.error(1), Some(gain(2.0)));
    assert_eq!(peaks.error(2), Some(gain(1.0)));
    assert_eq!(peaks.error(3), None);
    assert_eq!(peaks.velocity_error(0), Some(gain(4.0)));
    assert_eq!(peaks.velocity_error(1), Some(gain(3.0)));
    assert_eq!(peaks.integral(), Some(gain(2.0)));
    assert_eq!(peaks.state(3, 0), Some(gain(4.0)));
    assert_eq!((peaks.state(4, 0), peaks.state(0, 1)), (None, None));
    // 2 per rate, 3 per jump.
    assert_eq!(peaks.error_bound(10.0, 100.0), Some(320.0));
}

#[test]
fn the_middle_of_the_levels_is_between_them() {
    let of = |diagonal| {
        let other = (None, None, None);
        Attenuation {
            diagonal,
            return_difference: other.0,
            blocking_w: other.1,
            gamma_diagonal: other.2,
            gamma_return_difference: None,
        }
        .k_tilde()
    };
    assert_eq!(of(Some(Interval { low: 4.0, high: 9.0 })), Some(6.0));
    assert_eq!(of(Some(Interval { low: 0.0, high: 9.0 })), Some(3.0));
    assert_eq!(of(None), None);
}

#[test]
fn an_encoders_quantum_is_its_share_of_a_turn() {
    assert_eq!(TorqueNoise::quantum(0), core::f64::consts::TAU);
    assert_eq!(TorqueNoise::quantum(3) * 8.0, core::f64::consts::TAU);
}

#[test]
fn the_strongest_coupling_is_off_the_diagonal() {
    let mut coupled = document().certificate.unwrap().coupled.unwrap();
    coupled.error_rad_per_nm = vec![vec![9.0, 1.0, 2.0], vec![5.0, 9.0, 3.0], vec![4.0, 0.5, 9.0]];
    assert_eq!(coupled.strongest(), Some((1, 0, 5.0)));
    coupled.error_rad_per_nm[0][2] = 6.0;
    assert_eq!(coupled.strongest(), Some((0, 2, 6.0)));
    coupled.error_rad_per_nm = vec![vec![9.0]];
    assert_eq!(coupled.strongest(), None);
    assert_eq!(coupled.matrices().len(), 7);
}

#[test]
fn an_arm_measured_in_other_units_is_the_same_arm() {
    let mut arm = document().certificate.unwrap().arm;
    let (low, high) = (arm.low, arm.high);
    let searched = arm.searched.as_mut().unwrap();
    searched.proved = Some(Proved { low: 0.5, high: 4.0, cells: 7 });
    let scaled = arm.scaled(2.0);
    assert_eq!((scaled.low, scaled.high), (low / 2.0, high / 2.0));
    assert_eq!(scaled.nominal_kg_m2[1], arm.nominal_kg_m2[1] * 2.0);
    let searched = scaled.searched.unwrap();
    assert_eq!((searched.low.eigenvalue, searched.high.eigenvalue), (low / 2.0, high / 2.0));
    assert_eq!(searched.proved, Some(Proved { low: 0.25, high: 2.0, cells: 7 }));
    searched.agrees(low / 2.0, high / 2.0).unwrap();
    assert!(searched.agrees(low / 2.0 * (1.0 + 1e-8), high / 2.0).is_err());
    assert!(searched.agrees(low / 2.0, high / 2.0 * (1.0 - 1e-8)).is_err());
    for (low_proved, high_proved, holds) in [
        (0.0, 2.0, true),
        (-1e-9, 2.0, false),
        (low / 2.0, high / 2.0, true),
        (low / 2.0 * (1.0 + 1e-8), 2.0, false),
        (0.0, high / 2.0 * (1.0 - 1e-8), false),
        (0.0, f64::INFINITY, false),
        (f64::NAN, 2.0, false),
    ] {
        let mut other = searched.clone();
        other.proved = Some(Proved { low: low_proved, high: high_proved, cells: 1 });
        let own = other.agrees(low / 2.0, high / 2.0).is_ok();
        assert_eq!(own, holds, "{low_proved} {high_proved}");
    }
}

#[test]
fn the_bound_of_a_steady_error_is_the_tubes_or_the_joints_own() {
    let mut certificate = document().certificate.unwrap();
    let bound = certificate.error_bound(1).unwrap();
    assert_eq!((bound.error_bound_rad, bound.velocity_error_bound_rad_s), (2.325e-3, 0.06874));
    assert_eq!(certificate.error_bound(2), None);
    certificate.tube = None;
    assert_eq!(certificate.error_bound(1), None);
    let why = certificate.without_bound().unwrap();
    assert!(why.contains("no tube"), "{why}");
    // Joints of a coupled arm push each other: none has a bound of its own.
    let own =
        Bounds { error_bound_rad: 3.0, velocity_error_bound_rad_s: 4.0, integral_rad_s: None };
    let refused = certificate.bound_each(vec![None, Some(own)]).unwrap_err();
    assert!(refused.inequality.contains("only a tube"), "{refused}");
    assert_eq!((certificate.error_bound(1), certificate.own_bounds(1)), (None, None));
    // Joints that are known one by one have; if they turn out to be coupled, they have none.
    certificate.arm.basis = ArmBasis::Typed;
    certificate.bound_each(vec![None]).unwrap_err();
    certificate.bound_each(vec![None, Some(own)]).unwrap();
    let mut coupled = certificate.clone();
    coupled.arm.basis = ArmBasis::Postures;
    assert_eq!((coupled.error_bound(1), coupled.own_bounds(1)), (None, None));
    let document = Gains { certificate: Some(coupled), ..document() };
    assert!(document.to_json().unwrap_err().to_string().contains("only a tube"));
    let typed = Gains { certificate: Some(certificate.clone()), ..document };
    let text = typed.to_json().unwrap();
    assert_eq!(Gains::from_json(&text).unwrap(), typed);
    let forged = text.replace("\"typed\"", "\"postures\"");
    assert!(Gains::from_json(&forged).unwrap_err().to_string().contains("only a tube"));
    let bound = certificate.error_bound(1).unwrap();
    assert_eq!((bound.error_bound_rad, bound.velocity_error_bound_rad_s), (3.0, 4.0));
    assert_eq!(certificate.refused(), None);
    let why = Refutation { claim: "c".into(), inequality: "i".into(), left: 1.0, right: 2.0 };
    certificate.joints[1].refused = vec![why.clone()];
    assert_eq!(certificate.refused(), Some(why.on("joint2")));
    assert_eq!(certificate.refused().unwrap().claim, "joint2: c");
}

#[test]
fn what_decays_has_its_rate_and_its_overshoot() {
    let mut iss =
        document().certificate.unwrap().joints[0].continuous.as_ref().unwrap().iss.clone();
    (iss.overshoot, iss.rate) = (5.0, 2.0);
    assert_eq!(iss.beta(0.0), 5.0);
    assert!((iss.beta(1.5) - 5.0 * (-3.0_f64).exp()).abs() < 1e-12);
}

#[test]
fn only_what_a_tube_counts_is_in_a_tube() {
    for (claims, counted) in [
        (LeftOut::Bounds, false),
        (LeftOut::BoundsAndStability, false),
        (LeftOut::AllButTube, true),
        (LeftOut::Assumed, true),
        (LeftOut::AllButElastic, false),
    ] {
        let one = NotCounted { key: "key".into(), value: "1".into(), claims };
        assert_eq!(one.in_tube(), counted);
    }
    // Milliradians are thousandths, newton metres are none.
    for (quantity, unit) in [
        (Quantity::Error, 1e-3),
        (Quantity::VelocityError, 1e-3),
        (Quantity::Torque, 1.0),
        (Quantity::TorqueStep, 1.0),
        (Quantity::LimitedSamples, 1.0),
    ] {
        let (symbol, name, own) = quantity.words();
        assert!(own == unit && !symbol.is_empty() && name.starts_with('m') == (unit < 1.0));
    }
}

#[test]
fn stability_while_moving_is_claimed_in_numbers_that_make_sense() {
    let gains = document();
    let claims = gains.certificate.as_ref().unwrap();
    let (record, model) = (&gains.joints[0], &claims.joints[0].model);
    let own = claims.moving.clone().unwrap();
    own.verify(&[(record, model)]).unwrap();
    // A tenth faster with the same multiplier.
    let mut faster = own.clone();
    faster.rate_per_s *= 1.1;
    faster.delta = faster.step(model.period_s).0;
    assert!(faster.verify(&[(record, model)]).is_err());
    let edits: [Edit<Moving>; 21] = [
        ("δ = rate", |m| m.delta *= 1.0 + 1e-8),
        ("δ = rate", |m| m.delta *= 1.0 - 1e-8),
        ("δ = rate", |m| m.rate_per_s *= 1.0 + 1e-8),
        ("needed rate", |m| m.needed_motion_per_s = Some(-1e-9)),
        ("needed rate", |m| m.needed_limits_per_s = Some(f64::INFINITY)),
        ("needed rate", |m| m.needed_limits_per_s = Some(f64::NAN)),
        ("0 < λ", |m| m.drift = 0.0),
        ("0 < λ", |m| m.drift = f64::INFINITY),
        ("0 < λ", |m| m.drift = f64::NAN),
        ("0 ≤ rate", |m| (m.rate_per_s, m.delta) = (-1.0, f64::NAN)),
        ("taps are finite", |m| m.h[2] = f64::NAN),
        ("taps are finite", |m| m.h = vec![0.0; 4097]),
        ("0 < low ≤ high", |m| m.high = 0.1),
        ("0 < low ≤ high", |m| m.high = f64::INFINITY),
        ("0 < low ≤ high", |m| m.low = 0.0),
        ("0 < low ≤ high", |m| m.low = -1.0),
        ("at θ", |m| m.h = Vec::new()),
        ("at θ", |m| m.h.iter_mut().for_each(|h| *h = -*h)),
        ("at θ", |m| m.drift *= 1e3),
        ("at θ", |m| m.drift *= 1e-3),
        ("alone is not stable", |m| m.high *= 20.0),
    ];
    for (gate, edit) in edits {
        let mut other = own.clone();
        edit(&mut other);
        let proof = gate != "δ = rate" && gate != "needed rate";
        let told = if proof {
            other.stable(record, model).err().map(|why| why.inequality)
        } else {
            other.verify(&[(record, model)]).err().map(|why| why.inequality)
        };
        let told = told.unwrap_or_else(|| "passes".into());
        assert!(told.contains(gate), "{gate}: {told}");
    }
    let driven = LoopModel { drive_bandwidth_hz: Some(500.0), ..*model };
    let told = own.verify(&[(record, &driven)]).unwrap_err().inequality;
    assert!(told.contains("a drive's lag"), "{told}");
    // By hand: low 1/2, high 2, 10 1/s, 1 ms: χ = 2 · 40 · 1e-3, δ = 0.01 (1 + χ²/12), η = χ/6; 2(h₁ sin θ +
    // h₂ sin 2θ).
    let mut small = own.clone();
    (small.low, small.high, small.rate_per_s, small.h) = (0.5, 2.0, 10.0, vec![0.5, 0.25]);
    let (delta, eta) = small.step(1e-3);
    assert!((delta - 0.01 * (1.0 + 0.0064 / 12.0)).abs() < 1e-16, "{delta}");
    assert!((eta - 0.08 / 6.0).abs() < 1e-16, "{eta}");
    let y = small.multiplier(0.25 * core::f64::consts::PI);
    assert!((y - (0.5_f64.sqrt() + 0.5)).abs() < 1e-15, "{y}");
}

#[test]
fn a_quadratic_form_is_one_of_the_loops_size() {
    let gains = document();
    let claims = &gains.certificate.as_ref().unwrap().joints[0];
    let (record, model) = (&gains.joints[0], &claims.model);
    let (slow, fast) = (claims.varying.clone().unwrap(), claims.sampled_varying.clone().unwrap());
    slow.verify(record).unwrap();
    fast.verify(record, model).unwrap();
    let edits: [Edit<Matrix>; 8] = [
        ("P = Pᵀ", |p| p[1][0] *= 1.0 + f64::EPSILON),
        ("P = Pᵀ", |p| p[0][0] = f64::NAN),
        ("P = Pᵀ", |p| (p[0][1], p[1][0]) = (f64::INFINITY, f64::INFINITY)),
        ("P = Pᵀ", |p| p.truncate(2)),
        ("P = Pᵀ", |p| p[1].truncate(2)),
        ("P ≻ 0", |p| p[1][1] = -1e-9),
        ("P ≻ 0", |p| p.iter_mut().flatten().for_each(|x| *x = -*x)),
        ("≻ 0 at", |p| {
            // All of one size: definite, and no loop's energy.
            let n = p.len();
            *p = (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        }),
    ];
    for (gate, edit) in edits {
        let (mut a, mut b) = (slow.clone(), fast.clone());
        edit(&mut a.p);
        edit(&mut b.p);
        for why in [a.verify(record).unwrap_err(), b.verify(record, model).unwrap_err()] {
            assert!(why.inequality.contains(gate), "{gate}: {why}");
        }
    }
    for (low, high) in [(0.0, 1.0), (-1.0, 1.0), (2.0, 1.9), (1.0, f64::INFINITY), (f64::NAN, 1.0)]
    {
        let a = phihat_certificate::VaryingWindow { low, high, ..slow.clone() };
        let b = phihat_certificate::SampledVarying { low, high, ..fast.clone() };
        assert!(a.verify(record).is_err() && b.verify(record, model).is_err(), "{low} {high}");
    }
    // The same form at another speed is another form, and none at no speed.
    for rate_per_s in [0.0, -1.0, f64::NAN] {
        assert!(
            phihat_certificate::VaryingWindow { rate_per_s, ..slow.clone() }
                .verify(record)
                .is_err()
        );
    }
    // No form holds where a joint that stands still is not stable: below its window; by Routh for the continuous law,
    // m = 1: (a + K_d)(K_p + aK_d) > μ a K_p.
    let (kp, kd, a) = (record.kp_per_s2, record.kd_per_s, record.a[0]);
    let most = (a + kd) * (kp + a * kd) / (a * kp);
    let beyond = phihat_certificate::VaryingWindow { high: most * 1.001, ..slow };
    assert!(beyond.verify(record).unwrap_err().inequality.contains("at high"));
    let window = claims.window.unwrap();
    let below = phihat_certificate::SampledVarying { low: window.low * 0.999, ..fast.clone() };
    assert!(below.verify(record, model).unwrap_err().inequality.contains("at low"));
    let above = phihat_certificate::SampledVarying { high: window.high * 1.001, ..fast };
    assert!(above.verify(record, model).unwrap_err().inequality.contains("at high"));
}
