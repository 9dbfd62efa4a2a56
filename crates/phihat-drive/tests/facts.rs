//! A study is compared with the robot that it is driven on. Wrong if a study that is laxer than the robot in
//! any figure passed, or if one that states exactly the facts were refused.

use crate::support::{PLAIN, study};
use phihat_drive::{Adds, Clock, Facts, Stops, Tells};
use phihat_study::Study;

/// A robot that takes torques as a Franka does.
fn robot() -> Facts {
    Facts {
        name: "the robot".to_owned(),
        clock: Clock::Robot,
        period_ns: 1_000_000,
        width: 3,
        joints: None,
        adds: Adds { gravity: true, friction: Some(0.5) },
        stops: Stops {
            torque_rate_max_nm_s: Some(1000.0),
            first_torque_max_nm: Some(0.5),
            losses_max: Some(20),
        },
        tells: Tells { echo: true, losses: true, truth: false },
    }
}

const TRUE: &str = "adds_gravity = true\nadds_friction = 0.5\ntorque_rate_max_nm_s = 1000.0\n\
                    first_torque_max_nm = 0.5\nlosses_max = 20\n";

fn said(profile: &str, rate: &str) -> Study {
    let text = PLAIN.replace("rate_hz = 1000.0", rate);
    study(&format!("{text}[profile]\nname = \"ideal\"\n{profile}"))
}

#[test]
fn what_is_true_passes_and_what_is_stricter_too() {
    let rate = "rate_hz = 1000.0";
    assert_eq!(robot().against(&said(TRUE, rate)), []);
    let stricter =
        TRUE.replace("1000.0", "900.0").replace("= 0.5\nlosses_max = 20", "= 0.0\nlosses_max = 3");
    assert_eq!(robot().against(&said(&stricter, rate)), []);
}

#[test]
fn every_laxer_figure_is_named_with_what_would_be_valid() {
    let rate = "rate_hz = 1000.0";
    let keys = |facts: &Facts, study: &Study| -> Vec<String> {
        facts.against(study).iter().map(|wrong| wrong.key.to_owned()).collect()
    };
    for (from, to, key) in [
        ("adds_gravity = true", "adds_gravity = false", "profile.adds_gravity"),
        ("adds_friction = 0.5", "adds_friction = 0.4", "profile.adds_friction"),
        (
            "torque_rate_max_nm_s = 1000.0",
            "torque_rate_max_nm_s = 1001.0",
            "profile.torque_rate_max_nm_s",
        ),
        ("torque_rate_max_nm_s = 1000.0\n", "", "profile.torque_rate_max_nm_s"),
        ("first_torque_max_nm = 0.5", "first_torque_max_nm = 0.6", "profile.first_torque_max_nm"),
        ("losses_max = 20", "losses_max = 21", "profile.losses_max"),
        (
            "losses_max = 20",
            "losses_max = 20\ncontroller_keeps = false",
            "profile.controller_keeps",
        ),
    ] {
        let text = TRUE.replace(from, to);
        assert!(text != TRUE, "{from}");
        let found = robot().against(&said(&text, rate));
        assert_eq!(keys(&robot(), &said(&text, rate)), [key], "{to}");
        let wrong = &found[0];
        assert!(wrong.valid.contains(key.rsplit('.').next().unwrap()), "{}", wrong.valid);
    }
    assert_eq!(keys(&robot(), &said(TRUE, "rate_hz = 500.0")), ["loop.rate_hz"]);
    let wide = Facts { width: 7, ..robot() };
    assert_eq!(keys(&wide, &said(TRUE, rate)), ["robot"]);
    // A robot of which nothing of this is known is not held against it.
    let unknown =
        Facts { adds: Adds { gravity: true, friction: None }, stops: Stops::default(), ..robot() };
    let text = "adds_gravity = true\nadds_friction = 0.1\n";
    assert_eq!(unknown.against(&said(text, rate)), []);
}
