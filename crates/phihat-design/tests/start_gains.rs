//! The gate looks at the gains an arm starts with. Wrong if an arm that only the running gains hold were armed to
//! start at first order.

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

/// A slower start is looked at too, in both forms: an arm above its window is not armed.
#[test]
fn an_arm_outside_the_slower_gains_window_is_not_armed() {
    for (form, a) in [
        ("observer", vec![4844.0, 139.2]),
        ("literal", vec![4844.0, 139.2]),
        ("literal", vec![69.6]),
    ] {
        let factor = 0.05_f64;
        let text = |more: &str| {
            format!(
                "duration_s = 3.0\n[robot]\nname = \"planar3r\"\n[gains]\nkp_per_s2 = 400\nkd_per_s = 40\na = {a:?}\n\
                 inertia_kg_m2 = 1.0\n[loop]\nform = \"{form}\"\n[reference]\nkind = \"hold\"\nq_rad = \
                 0.0\n[supervisor]\n{more}\n"
            )
        };
        let read = |more: &str| Study::from_text(&text(more), "arm.toml", Path::new(".")).unwrap();
        let mut start = read(&format!("start_estimator_factor = {factor}"));
        let mut plain = read("");
        let gains = requested_gains(&plain).unwrap();
        let model = LoopModel::from_study(&plain, 0);
        let running = InertiaWindow::find(&gains.joints[0], &model).unwrap();
        // Slow poles: the sampled ones are those of A_o(s), but for a part in a thousand.
        let m = i32::try_from(a.len()).unwrap();
        let slow = a.iter().zip(0..).map(|(a, i)| a * factor.powi(m - i)).collect();
        let slow = InertiaWindow::find(&JointRecord { a: slow, ..gains.joints[0].clone() }, &model)
            .unwrap();
        println!(
            "{form} m = {m}: {} … {} and {} … {}",
            running.low, running.high, slow.low, slow.high
        );
        let mut gate = |low: f64, high: f64| {
            [&mut plain, &mut start].map(|study| {
                study.design.inertia =
                    InertiaSource::Typed { low: vec![low; 3], high: vec![high; 3] };
                arm_inside_window(study, &Arm::of(study).unwrap(), &gains).is_ok()
            })
        };
        let (low, high) = (running.low.max(slow.low) * 1.02, running.high.min(slow.high) * 0.98);
        assert_eq!(gate(low, high), [true, true], "{form}");
        // Just outside of the slower gains' window, inside of the running gains', or the other way around.
        let high_only = [running.high, slow.high].map(|end| end > high * 1.1);
        let low_only = [running.low, slow.low].map(|end| end < low / 1.1);
        assert!(
            high_only[0] != high_only[1] || low_only[0] != low_only[1],
            "{form}: the windows differ"
        );
        if high_only[0] && !high_only[1] {
            assert_eq!(gate(low, slow.high * 1.02), [true, false], "{form}");
        }
        if low_only[0] && !low_only[1] {
            assert_eq!(gate(slow.low / 1.02, high), [true, false], "{form}");
        }
    }
}
