//! Linear claims of a Panda's laws in exact arithmetic. Wrong if a claim that holds by a hair were refused, or one that
//! fails by a hair proved; the edges were found with python-flint by other code.

use phihat_certificate::{
    AnySpeed, FrozenArm, InertiaWindow, JointRecord, LoopModel, Margins, Moving,
};
use serde::Deserialize;

#[derive(Deserialize)]
struct Panda {
    #[serde(rename = "provenance")]
    _provenance: String,
    joints: Vec<JointRecord>,
    model: LoopModel,
    frozen: FrozenArm,
    any_speed: AnySpeed,
    moving: Moving,
    windows: Vec<InertiaWindow>,
    margins: Vec<Margins>,
}

impl Panda {
    fn new() -> Self {
        serde_json::from_str(include_str!("exact/panda_rate.json")).unwrap()
    }

    fn loops(&self) -> Vec<(&JointRecord, &LoopModel)> {
        self.joints.iter().map(|joint| (joint, &self.model)).collect()
    }
}

#[test]
fn claims_of_the_file_hold() {
    let panda = Panda::new();
    let loops = panda.loops();
    panda.frozen.verify(&loops).unwrap();
    panda.any_speed.verify(&loops).unwrap();
    panda.moving.verify(&loops).unwrap();
    for ((joint, window), margins) in panda.joints.iter().zip(&panda.windows).zip(&panda.margins) {
        window.verify(joint, &panda.model).unwrap();
        margins.verify(joint, &panda.model).unwrap();
    }
}

#[test]
fn the_arms_window_ends_where_a_joint_s_does() {
    let panda = Panda::new();
    let loops = panda.loops();
    // Joint 6 ends at .26292 below, joint 2 at 14.336 above.
    for (low, high, holds) in [
        (0.25, 6.0, false),
        (0.2629, 14.0, false),
        (0.27, 14.0, true),
        (0.4534, 14.3, true),
        (0.4534, 14.4, false),
    ] {
        assert_eq!(FrozenArm::stable(low, high).verify(&loops).is_ok(), holds, "{low} {high}");
    }
}

#[test]
fn each_frozen_posture_forgets_as_fast_as_its_slowest_joint() {
    let panda = Panda::new();
    for joint in &panda.joints {
        let window = InertiaWindow {
            low: panda.moving.low,
            high: panda.moving.high,
            low_hz: 0.0,
            high_hz: 0.0,
        };
        window.verify_decay(joint, &panda.model, 4.51).unwrap();
        assert!(window.verify_decay(joint, &panda.model, 40.0).is_err());
        assert!(window.verify_decay(joint, &panda.model, -1.0).is_err());
        assert!(window.verify_decay(joint, &panda.model, f64::NAN).is_err());
    }
}

#[test]
fn the_coupled_arm_forgets_at_a_rate_below_that_of_its_slowest_pole() {
    // Of this arm 4.51 1/s was proved by other code, over 66 postures the slowest pole of the coupled loop has 4.82.
    let panda = Panda::new();
    let (low, high) = (panda.moving.low, panda.moving.high);
    for (rate, holds) in [(0.0, true), (4.51, true), (5.0, false), (-1.0, false), (f64::NAN, false)]
    {
        let arm = FrozenArm { low, high, decay_per_s: Some(rate) };
        assert_eq!(arm.verify(&panda.loops()).is_ok(), holds, "{rate}");
    }
    // A file without a rate is read, and one with a rate is written as it is read.
    let text = r#"{"low":0.5,"high":5.0,"decay_per_s":4.5}"#;
    let own: FrozenArm = serde_json::from_str(text).unwrap();
    assert_eq!(serde_json::to_string(&own).unwrap(), text);
    assert_eq!(
        serde_json::to_string(&FrozenArm::stable(0.5, 5.0)).unwrap(),
        r#"{"low":0.5,"high":5.0}"#
    );
}

#[test]
fn more_than_holds_is_refused() {
    let panda = Panda::new();
    let loops = panda.loops();
    let AnySpeed { low, high } = panda.any_speed;
    for (down, up) in [(0.8, 1.0), (1.0, 1.25)] {
        let wider = AnySpeed { low: low * down, high: high * up };
        assert!(wider.verify(&loops).is_err(), "{wider:?}");
    }
    let faster = |factor: f64| {
        let mut own = panda.moving.clone();
        own.rate_per_s *= factor;
        own.delta = own.step(panda.model.period_s).0;
        own
    };
    faster(1.0).verify(&loops).unwrap();
    assert!(faster(1.5).verify(&loops).is_err());
    for (k, (joint, margins)) in panda.joints.iter().zip(&panda.margins).enumerate() {
        let of = |change: &dyn Fn(&mut Margins)| {
            let mut own = *margins;
            change(&mut own);
            own.verify(joint, &panda.model).is_err()
        };
        assert!(of(&|own| own.gain_up *= 1.01) && of(&|own| own.gain_down *= 1.01), "{k}");
        assert!(of(&|own| own.modulus *= 1.001), "{k}");
        assert!(of(&|own| own.phase_deg *= 1.001), "{k}");
        assert!(of(&|own| own.delay_s *= 1.001), "{k}");
    }
}
