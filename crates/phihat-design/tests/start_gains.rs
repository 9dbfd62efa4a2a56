//! The gate looks at the gains an arm starts with. Wrong if an arm that only the running gains hold were armed to
//! start at first order.
#![allow(clippy::unwrap_used, reason = "tests: a panic is the report")]

use std::path::Path;

use phihat_design::prelude::*;
use phihat_design::sampled::{InertiaWindow, LoopModel};
use phihat_design::{Arm, JointRecord, arm_inside_window, requested_gains};
use phihat_study::{InertiaSource, Study};

#[test]
fn an_arm_below_the_start_gains_window_is_not_armed() {
    // Lightly damped, so that an estimator of first order at the same frequency asks for more derivative gain.
    let text = "duration_s = 3.0\n[robot]\nname = \"planar3r\"\n[gains]\nkp_per_s2 = 400\nkd_per_s = 40\n\
                a = [40000.0, 120.0]\ninertia_kg_m2 = [1.0, 1.0, 1.0]\n[reference]\nkind = \"hold\"\n\
                q_rad = 0.0\n[supervisor]\nstart_first_order = ";
    let read = |text: &str| Study::from_text(text, "arm.toml", Path::new(".")).unwrap();
    let mut start = read(&format!("{text}true\n"));
    let mut plain = read(&format!("{text}false\n"));
    let gains = requested_gains(&plain).unwrap();
    let model = LoopModel::from_study(&plain, 0);
    let running = InertiaWindow::find(&gains.joints[0], &model).unwrap();
    let first = JointRecord { a: vec![200.0], ..gains.joints[0].clone() };
    let first = InertiaWindow::find(&first, &model).unwrap();
    assert!(running.low * 1.1 < first.low, "{} {}", running.low, first.low);
    let mut gate = |low: f64| {
        [&mut plain, &mut start].map(|study| {
            study.design.inertia = InertiaSource::Typed { low: vec![low; 3], high: vec![2.0; 3] };
            arm_inside_window(study, &Arm::of(study).unwrap(), &gains)
        })
    };
    let [without, with] = gate((running.low * first.low).sqrt());
    assert_eq!(without, Ok(()));
    let why = with.unwrap_err().to_string();
    assert!(why.contains("start gains") && why.contains("window.low"), "{why}");
    // 10 % inside of both: armed.
    assert_eq!(gate(first.low * 1.1), [Ok(()), Ok(())]);
}
