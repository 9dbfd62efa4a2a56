//! The bound for a class of motions: found, derived a second time, refused where it is forged, and attacked.

use std::path::Path;
use std::sync::OnceLock;

use phihat_attack::{ClassRuns, class_run, supervised_run};
use phihat_certificate::{Certificate, ClassBound};
use phihat_design::{ClassRefusal, Gains, Outcome, class_bound};
use phihat_session::designed;
use phihat_study::{ReferenceRequest, Study};

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
    let again = certificate.derive_class(gains(), &study()).unwrap().unwrap();
    let ratio = again.least_ratio();
    println!(
        "{:?} mrad, claimed over derived {ratio}, radius {}",
        class.worst(),
        class.spectral_radius
    );
    // The second derivation leaves out what only adds.
    assert!((1.0..1.25).contains(&ratio), "{again:?}");
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
    certificate.verify(&gains).is_ok() && certificate.derive_class(&gains, study).is_ok()
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
fn a_class_that_is_too_fast_does_not_close() {
    let mut study = study();
    let ReferenceRequest::Any { class, .. } = &mut study.reference else { panic!("no class") };
    for list in [&mut class.speed, &mut class.acceleration, &mut class.jerk] {
        for most in list.iter_mut() {
            *most *= 30.0;
        }
    }
    match class_bound(&study, gains()) {
        Err(ClassRefusal::Open { radius }) => assert!(radius > 0.8, "{radius}"),
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
    let again = certificate.derive_class(gains, &study).unwrap().unwrap();
    println!("{:?} mrad, claimed over derived {}", class.worst(), again.least_ratio());
    assert!((1.0..1.3).contains(&again.least_ratio()), "{again:?}");
    let mut found = ClassRuns::default();
    for seed in 0..12 {
        found.and(&supervised_run(&study, gains, class, seed).unwrap());
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
