//! The bound for a class of motions: found, derived a second time, refused where it is forged, and attacked.

use std::path::Path;
use std::sync::OnceLock;

use phihat_attack::{ClassRuns, class_run, hostile_run};
use phihat_certificate::{
    Certificate, ClassAgain, ClassBound, ClassPair, JointOfClass, Verdict, Verified,
};
use phihat_design::{ClassRefusal, Gains, Outcome, class_bound};
use phihat_session::designed;
use phihat_study::{ReferenceRequest, Study};
use serde_json::{Value, json};

/// Three joints in a plane, under gravity, with a payload of up to 0.2 kg.
const TEXT: &str = r#"
    duration_s = 3.0
    [robot]
    name = "planar3r"
    [spec]
    settle_s = 1.0
    error_bound_rad = 2e-3
    [design]
    payload_max_kg = 0.2
    window_margin = 1.1
    [loop]
    delay_samples = 1
    form = "positions"
    [sensor]
    encoder_bits = 19
    [world]
    coulomb_extra_nm = 0.05
    [start]
    torque_nm = "balance"
    [reference]
    kind = "any"
    center = "ready"
    box_rad = 0.4
    speed_max_rad_s = 0.4
    acceleration_max_rad_s2 = 1.0
    jerk_max_rad_s3 = 10.0
"#;

/// The same of an arm under supervision whose robot holds its own gravity: the payload is out of balance at the start.
fn supervised() -> Study {
    let text = TEXT
        .replace("[start]\n    torque_nm = \"balance\"", "[supervisor]\n    error_stop_rad = 0.2")
        .replace("payload_max_kg = 0.2", "payload_max_kg = 0.05")
        .replace("[spec]", "[profile]\n    name = \"ideal\"\n    adds_gravity = true\n    [spec]");
    Study::from_text(&text, "any.toml", "".as_ref()).unwrap()
}

/// Gains for the class of the arm under supervision, searched for once.
fn supervised_gains() -> &'static Gains {
    static GAINS: OnceLock<Gains> = OnceLock::new();
    GAINS.get_or_init(|| match designed(&supervised(), Path::new("any.toml")).unwrap() {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("{no}"),
    })
}

/// The arm in balance with signals that are none too good: noise of a quantum, cogging, stiction, samples taken early,
/// and a command lost now and then.
fn imperfect() -> Study {
    let text = TEXT
        .replace("encoder_bits = 19", SENSOR)
        .replace("[start]", &format!("{WORLD}\n    [start]"))
        .replace("error_bound_rad = 2e-3", "error_bound_rad = 5e-3")
        .replace("payload_max_kg = 0.2", "payload_max_kg = 0.05\n    torque_step_max_nm = 1.0")
        .replace("speed_max_rad_s = 0.4", "speed_max_rad_s = 0.2")
        .replace("_s2 = 1.0", "_s2 = 0.5")
        .replace("_s3 = 10.0", "_s3 = 5.0");
    Study::from_text(&text, "any.toml", "".as_ref()).unwrap()
}

const SENSOR: &str = r#"encoder_bits = 22
    position_noise_max_lsb = 1.0
    sample_jitter_s = 1e-5
    sample_stamps = "nominal"
    torque = "demanded""#;

const WORLD: &str = "[world.drive]
    cogging_nm = 0.03
    [world.stiction]
    breakaway_ratio = 1.5
    stiffness_nm_rad = 2e3
    damping_nm_s_rad = 0.02
    [world.network]
    commands_lost_max = 1
    commands_lost_every_s = 0.2";

/// Gains for the class with these signals, searched for once.
fn imperfect_gains() -> &'static Gains {
    static GAINS: OnceLock<Gains> = OnceLock::new();
    GAINS.get_or_init(|| match designed(&imperfect(), Path::new("any.toml")).unwrap() {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("{no}"),
    })
}

/// Seed of what a check draws, where it does not come from the file.
const SEED: u64 = 7;

fn study() -> Study {
    Study::from_text(TEXT, "any.toml", "".as_ref()).unwrap()
}

/// Gains for the class, searched for once.
fn gains() -> &'static Gains {
    static GAINS: OnceLock<Gains> = OnceLock::new();
    GAINS.get_or_init(|| match designed(&study(), Path::new("any.toml")).unwrap() {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("{no}"),
    })
}

fn certificate() -> &'static Certificate {
    gains().certificate.as_ref().unwrap()
}

fn bound() -> &'static ClassBound {
    let certificate = certificate();
    certificate.class.as_deref().unwrap_or_else(|| panic!("{:?}", certificate.class_refused))
}

#[test]
fn a_bound_is_found_for_the_class_and_derived_a_second_time() {
    let (class, certificate) = (bound(), certificate());
    assert!(certificate.unproved.is_empty(), "{:?}", certificate.unproved);
    certificate.verify(gains()).unwrap();
    let again = certificate.derive_class(gains(), &study(), SEED).unwrap().unwrap();
    let ratio = again.largest_ratio();
    println!("{:?} rad, derived over claimed {ratio}, {}", class.worst(), class.spectral_radius);
    assert!(again.confirmed() && (0.8..=1.0).contains(&ratio), "{again:?}");
    for (moving, frozen) in class.error_bound_rad.iter().zip(&class.frozen_error_bound_rad) {
        assert!(moving > frozen && moving < &(3.0 * frozen), "{moving} {frozen}");
    }
}

/// Returns true if gains whose bound is edited pass both checks.
fn passes(gains: &Gains, study: &Study, change: fn(&mut ClassBound)) -> bool {
    let mut gains = gains.clone();
    let class = gains.certificate.as_mut().and_then(|all| all.class.as_deref_mut()).unwrap();
    change(class);
    let certificate = gains.certificate.clone().unwrap();
    certificate.verify(&gains).is_ok() && certificate.derive_class(&gains, study, SEED).is_ok()
}

#[test]
fn a_forged_bound_is_refuted() {
    let forged = |change| passes(gains(), &study(), change);
    assert!(forged(|_| ()));
    for change in [
        (|class| class.error_bound_rad[0] *= 0.75) as fn(&mut ClassBound),
        |class| class.error_bound_rad[2] *= 0.75,
        |class| class.velocity_error_bound_rad_s[1] *= 0.75,
        |class| class.torque_step_nm[1] *= 0.75,
        |class| class.speed_max_rad_s[0] *= 1.5,
        |class| class.jerk_max_rad_s3[2] *= 1.5,
        |class| class.box_rad.1[1] += 0.2,
        |class| class.force_nm[1] = 0.2,
        |class| class.payload.mass_kg.1 = 1.0,
        |class| class.spectral_radius = 1.1,
        |class| class.reading_rad[0] *= 0.5,
        |class| class.witnesses.clear(),
    ] {
        assert!(!forged(change));
    }
}

#[test]
fn no_motion_of_the_class_leaves_its_bound() {
    let study = study();
    let mut found = ClassRuns::default();
    for seed in 0..16 {
        found.and(&class_run(&study, gains(), bound(), seed).unwrap());
    }
    println!("bound over measured at least {:?}", found.least());
    assert_eq!(found.outside, 0, "{found:?}");
    // A bound that is never come near to would not be attacked here.
    assert!(found.least().iter().all(|ratio| *ratio < 20.0), "{:?}", found.least());
}

#[test]
fn imperfect_signals_are_counted_derived_twice_and_attacked_at_their_worst() {
    let (study, gains) = (imperfect(), imperfect_gains());
    let certificate = gains.certificate.as_ref().unwrap();
    let class = certificate.class.as_deref();
    let class = class.unwrap_or_else(|| panic!("{:?}", certificate.class_refused));
    certificate.verify(gains).unwrap();
    let again = certificate.derive_class(gains, &study, SEED).unwrap().unwrap();
    println!("{:?} rad, derived over claimed {}", class.worst(), again.largest_ratio());
    assert!(again.confirmed() && again.largest_ratio() > 0.8, "{again:?}");
    // The same laws without one of the imperfections: each costs something.
    let without = |change: &dyn Fn(&mut Study)| {
        let mut study = study.clone();
        change(&mut study);
        class_bound(&study, gains).unwrap().worst().unwrap().1
    };
    let all = class.worst().unwrap().1;
    for (what, change) in [
        ("noise", &(|s: &mut Study| s.sensor.position_noise_max.fill(0.0)) as &dyn Fn(&mut Study)),
        ("cogging", &|s| s.world.drive = None),
        ("stiction", &|s| s.world.stiction = None),
        ("jitter", &|s| s.sensor.jitter = 0.0),
        ("losses", &|s| s.world.network.rows = None),
    ] {
        let less = without(change);
        println!("{what}: {:.4} mrad of {:.4}", 1e3 * (all - less), 1e3 * all);
        assert!(less < 0.9999 * all, "{what}: {less} {all}");
    }
    let mut found = ClassRuns::default();
    for seed in 0..16 {
        found.and(&class_run(&study, gains, class, seed).unwrap());
        found.and(&hostile_run(&study, gains, class, seed).unwrap());
    }
    println!("bound over measured at least {:?}", found.least());
    assert_eq!(found.outside, 0, "{found:?}");
    assert!(found.least().iter().all(|ratio| *ratio < 20.0), "{:?}", found.least());
}

#[test]
fn forged_signals_are_refuted() {
    let forged = |change| passes(imperfect_gains(), &imperfect(), change);
    assert!(forged(|_| ()));
    for change in [
        (|class| class.signals = None) as fn(&mut ClassBound),
        |class| class.signals.as_mut().unwrap().jitter_s *= 0.5,
        |class| class.signals.as_mut().unwrap().commands_lost = 2,
        |class| class.signals.as_mut().unwrap().lost_every_s *= 2.0,
        |class| class.signals.as_mut().unwrap().stiction_nm[1] *= 0.5,
        |class| class.signals.as_mut().unwrap().stiction_nm_s_rad.clear(),
        |class| class.force_nm[0] *= 0.9,
        |class| class.reading_rad[2] *= 0.9,
        |class| class.error_bound_rad[1] *= 0.75,
        |class| class.torque_step_nm[2] *= 0.75,
    ] {
        assert!(!forged(change));
    }
}

#[test]
fn signals_that_the_theorem_does_not_cover_are_refused_by_their_key() {
    let supervised = |text: &str| {
        text.replace(
            "[start]\n    torque_nm = \"balance\"",
            "[supervisor]\n    error_stop_rad = 0.2",
        )
    };
    let text = imperfect().text;
    let franka = "torque_rate_max_nm_s = 1000.0";
    for (text, key) in [
        (text.replace("torque = \"demanded\"", ""), "world.drive.cogging_nm"),
        (text.replace("cogging_nm = 0.03", "ripple = 0.01"), "world.drive"),
        (supervised(&text.replace("\"nominal\"", "\"taken\"")), "sensor.sample_jitter_s"),
        (text.replace("every_s = 0.2", "every_s = 0.001"), "commands_lost_every_s"),
        (
            text.replace(
                "[spec]",
                &format!("[profile]\n    name = \"ideal\"\n    {franka}\n    [spec]"),
            ),
            "commands_lost_max",
        ),
    ] {
        let study = Study::from_text(&text, "any.toml", "".as_ref()).unwrap();
        match class_bound(&study, imperfect_gains()) {
            Err(why @ ClassRefusal::Unsupported(_)) => {
                assert!(why.to_string().contains(key), "{key}: {why}");
            }
            other => panic!("{key}: {other:?}"),
        }
    }
}

#[test]
fn a_class_that_is_too_fast_does_not_close() {
    let mut study = study();
    let ReferenceRequest::Any { class, .. } = &mut study.reference else { panic!("no class") };
    for list in [&mut class.speed, &mut class.acceleration, &mut class.jerk] {
        for most in list.iter_mut() {
            *most *= 30.0;
        }
    }
    match class_bound(&study, gains()) {
        Err(ClassRefusal::Open { radius, .. }) => assert!(radius > 0.8, "{radius}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn no_request_and_no_target_leaves_the_bound_of_a_supervised_arm() {
    let (study, gains) = (supervised(), supervised_gains());
    let certificate = gains.certificate.as_ref().unwrap();
    let class = certificate.class.as_deref();
    let class = class.unwrap_or_else(|| panic!("{:?}", certificate.class_refused));
    assert!(
        class.is_supervised() && class.start_nm.iter().all(|torque| *torque > 0.0),
        "{class:?}"
    );
    certificate.verify(gains).unwrap();
    let again = certificate.derive_class(gains, &study, SEED).unwrap().unwrap();
    println!("{:?} rad, derived over claimed {}", class.worst(), again.largest_ratio());
    assert!(again.confirmed() && again.largest_ratio() > 0.8, "{again:?}");
    let verified = certificate.verified(gains).unwrap();
    let verdict = |found: ClassAgain| {
        let with = Verified { class: Some(found), ..verified.clone() };
        certificate.concluded(with, gains).verdict
    };
    assert_eq!(verdict(again.clone()), Verdict::DerivedTwice);
    // A limit that could act by the second derivation leaves no bound, and a clause that it does not keep is none.
    let acting = ClassAgain { limits_acting: vec!["a limit".to_owned()], ..again.clone() };
    assert_eq!(verdict(acting), Verdict::NotProved);
    assert_eq!(
        verdict(ClassAgain { unkept: vec!["a clause".to_owned()], ..again }),
        Verdict::NotProved
    );
    let mut found = ClassRuns::default();
    for seed in 0..12 {
        found.and(&hostile_run(&study, gains, class, seed).unwrap());
    }
    println!("bound over measured at least {:?}", found.least());
    assert_eq!(found.outside, 0, "{found:?}");
    assert!(found.least().iter().all(|ratio| *ratio < 20.0), "{:?}", found.least());
}

#[test]
fn a_forged_start_is_refuted_and_what_changes_the_law_is_refused() {
    let forged = |change| passes(supervised_gains(), &supervised(), change);
    assert!(forged(|_| ()));
    for change in [
        (|class| class.start_nm[0] *= 0.5) as fn(&mut ClassBound),
        |class| class.start_nm.clear(),
        |class| class.start_s *= 0.5,
        |class| class.error_bound_rad[1] *= 0.75,
        |class| class.torque_step_nm[2] *= 0.75,
    ] {
        assert!(!forged(change));
    }
    for (line, key) in [
        ("dead_zone_rad = 1e-4", "supervisor.dead_zone_rad"),
        ("funnel_initial_rad = 0.1\nfunnel_final_rad = 0.05", "supervisor.funnel_initial_rad"),
        ("soft_zone_rad = 0.1", "supervisor.soft_zone_rad"),
        ("start_first_order = true", "supervisor.start_first_order"),
        ("preset_nm = 500.0", "supervisor.preset_nm"),
    ] {
        let text = supervised().text.replace("error_stop_rad = 0.2", line);
        let text =
            text.replace("delay_samples = 1", "delay_samples = 1\ntorque_rate_max_nm_s = 1e5");
        let study = Study::from_text(&text, "any.toml", "".as_ref()).unwrap();
        match class_bound(&study, supervised_gains()) {
            Err(why @ ClassRefusal::Unsupported(_)) => {
                assert!(why.to_string().contains(key), "{why}");
            }
            other => panic!("{key}: {other:?}"),
        }
    }
}

/// Parts of the document that inform, and that no bound is about.
const INFORMS: [&str; 7] =
    ["frozen_error_bound_rad", "spectral_radius", "postures", "points", "source", "paces", "parts"];

/// Places of every leaf.
fn leaves(value: &Value, at: &str, out: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            map.iter().for_each(|(key, one)| leaves(one, &format!("{at}/{key}"), out));
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, one)| leaves(one, &format!("{at}/{i}"), out));
        }
        _ => out.push(at.to_owned()),
    }
}

/// A leaf edited in one of ten ways.
fn edited(value: &Value, way: usize) -> Value {
    let Some(x) = value.as_f64() else {
        return if way.is_multiple_of(2) { json!("panda_link0") } else { json!(null) };
    };
    match way {
        0..=5 => json!([0.5, 0.9, 0.97, 1.03, 1.5, -1.0][way] * x),
        6 => json!(0.0),
        7 => json!(x + 0.1),
        8 => json!(1e9),
        _ => json!([x]),
    }
}

/// All pairs of a derivation, joint by joint.
fn pairs(own: &JointOfClass) -> [ClassPair; 4] {
    let JointOfClass {
        error_bound_rad, velocity_error_bound_rad_s, torque_step_nm, torque_nm, ..
    } = own;
    [*error_bound_rad, *velocity_error_bound_rad_s, *torque_step_nm, *torque_nm]
}

/// Edits leaves of the class's part of a file, one in so many; the number of edits, and how many were refused.
fn forge(gains: &Gains, study: &Study, one_in: usize) -> (usize, usize) {
    let again = |gains: &Gains, seed: u64| {
        let certificate = gains.certificate.as_ref()?;
        let mut verified = certificate.verified(gains).ok()?;
        certificate.derive(gains, study).ok()?;
        verified.class = certificate.derive_class(gains, study, seed).ok()?;
        Some(certificate.concluded(verified, gains))
    };
    let honest = again(gains, SEED).unwrap();
    let least = honest.class.unwrap().joints;
    let document: Value = serde_json::from_str(&gains.to_json().unwrap()).unwrap();
    let mut list = Vec::new();
    leaves(&document["certificate"]["class"], "/certificate/class", &mut list);
    list.retain(|at| !INFORMS.iter().any(|part| at.contains(part)));
    let ways = list.iter().flat_map(|at| (0..10).map(move |way| (at, way)));
    let (mut edits, mut refused) = (0, 0);
    for (k, (at, way)) in ways.enumerate().filter(|(k, _)| k % one_in == 0) {
        let mut forged = document.clone();
        let leaf = forged.pointer_mut(at).unwrap();
        *leaf = edited(leaf, way);
        edits += 1;
        // Each file is drawn other postures.
        let found = Gains::from_json(&forged.to_string()).ok();
        let Some(found) = found.and_then(|gains| again(&gains, k as u64)) else {
            refused += 1;
            continue;
        };
        if found.verdict == Verdict::NotProved {
            refused += 1;
            continue;
        }
        let joints = found.class.as_ref().unwrap().joints.iter().zip(&least);
        for ((own, least), bound) in joints.zip(&found.error_bounds) {
            for (own, least) in pairs(own).into_iter().zip(pairs(least)) {
                // Two searches differ by what they draw.
                assert!(own.wider() >= 0.98 * least.derived, "{at} {way}: {own:?} {least:?}");
            }
            assert!(bound.error_bound_rad >= 0.98 * least.error_bound_rad.derived, "{at} {way}");
        }
    }
    (edits, refused)
}

#[test]
fn no_edit_of_a_file_is_derived_twice_with_more_than_is_so() {
    let all = std::env::var_os("PHIHAT_ALL").is_some();
    let (edits, refused) = forge(supervised_gains(), &supervised(), if all { 1 } else { 41 });
    println!("{edits} edits, {refused} refused or not proved");
    assert!(edits > 5 && refused * 2 > edits, "{edits} {refused}");
    if all {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../studies/franka_any.toml"));
        let study = Study::read(path).unwrap();
        let Outcome::Designed(gains) = designed(&study, path).unwrap() else { panic!("no gains") };
        let mut study = study;
        gains.complete(&mut study).unwrap();
        println!("{:?}", forge(&gains, &study, 23));
    }
}
