//! Gains that were mistyped, or typed in another unit, do not arm an unstable loop. Wrong if the gate looked at
//! anything but the numbers that will run, or refused what it certified.

use std::path::Path;

use crate::sampled_support::{Outside, Random, Rig};
use phihat_design::sampled::LoopModel;
use phihat_design::{Arm, Gains, arm_inside_window, requested_gains};
use phihat_study::Study;

/// Loops of the studies that people start from, one joint of the arm each.
const LAWS: [(f64, f64, &[f64]); 4] = [
    (400.0, 40.0, &[68.9]),
    (400.0, 40.0, &[4844.0, 139.2]),
    (225.0, 30.0, &[2500.0, 100.0]),
    (144.0, 24.0, &[40.0]),
];

fn study((kp, kd, a): (f64, f64, &[f64])) -> (Study, Gains, Arm) {
    let text = format!(
        "duration_s = 3.0\n[robot]\nname = \"planar3r\"\nlocked = {{ joint2 = 0.5, joint3 = 0.5 }}\n[design]\n\
         inertia_low_kg_m2 = 0.4\ninertia_high_kg_m2 = 0.9\n[gains]\nkp_per_s2 = {kp}\nkd_per_s = {kd}\na = {a:?}\n\
         inertia_kg_m2 = 0.6\n[loop]\ndelay_samples = 1\n[sensor]\nvelocity = \"differenced\"\n\
         velocity_filter_hz = 200.0\n[reference]\nkind = \"hold\"\nq_rad = 0.0\n"
    );
    let study = Study::from_text(&text, "arm.toml", Path::new("")).unwrap();
    let (gains, arm) = (requested_gains(&study).unwrap(), Arm::of(&study).unwrap());
    (study, gains, arm)
}

/// Returns true if mistyped gains arm: the file is read back as anyone would have it, then checked as before
/// a run.
fn arms(study: &Study, arm: &Arm, gains: &Gains) -> bool {
    let Ok(text) = gains.to_json() else { return false };
    let Ok(gains) = Gains::from_json(&text) else { return false };
    let names = study.robot.joint_names();
    gains.joint_gains(&names, study.control.period_ns, phihat::Form::Observer).is_ok()
        && arm_inside_window(study, arm, &gains).is_ok()
}

/// Returns true if the core, with these gains, comes to rest at both ends of the arm's inertia.
fn settles(study: &Study, gains: &Gains) -> bool {
    let (record, model) = (&gains.joints[0], LoopModel::from_study(study, 0));
    // A fast loop is soon down at its rounding errors, a slow one swings for long.
    let rest = |m: f64| {
        let mut rig = Rig::new(record, &model, m / record.inertia_kg_m2);
        rig.dq = 1e-3;
        (0..4000).for_each(|_| _ = rig.step(&Outside::default()));
        rig.size() < 1e-4
    };
    let fades = |m: f64| Rig::new(record, &model, m / record.inertia_kg_m2).settles(4000);
    [0.4, 0.9].iter().all(|m| rest(*m) || fades(*m))
}

/// One of the document's numbers, by place; what is beyond the last one is the first again.
fn figure(gains: &mut Gains, place: u32) -> &mut f64 {
    let joint = &mut gains.joints[0];
    match place as usize % (3 + joint.a.len()) {
        0 => &mut joint.kp_per_s2,
        1 => &mut joint.kd_per_s,
        2 => &mut joint.inertia_kg_m2,
        i => &mut joint.a[i - 3],
    }
}

#[test]
fn f13_mistyped_gains_never_arm_an_unstable_loop() {
    let mut random = Random(13);
    let (mut armed, mut refused) = (0, 0);
    for law in LAWS {
        let (study, stated, arm) = study(law);
        assert!(arms(&study, &arm, &stated), "the stated gains are refused: {law:?}");
        for _ in 0..500 {
            let mut gains = stated.clone();
            let place = random.below(8);
            match random.below(5) {
                0 => *figure(&mut gains, place) *= 10.0,
                1 => *figure(&mut gains, place) /= 10.0,
                2 => *figure(&mut gains, place) *= -1.0,
                3 => {
                    let joint = &mut gains.joints[0];
                    std::mem::swap(&mut joint.kp_per_s2, &mut joint.kd_per_s);
                    *figure(&mut gains, place) *= random.around(0.5, 2.0);
                }
                _ => *figure(&mut gains, place) *= random.around(0.02, 50.0),
            }
            if arms(&study, &arm, &gains) {
                armed += 1;
                assert!(settles(&study, &gains), "armed, and does not settle: {:?}", gains.joints);
            } else {
                refused += 1;
            }
        }
    }
    println!("2000 mistyped documents: {refused} refused, {armed} armed, all of them stable");
    assert!(refused > 500 && armed > 100, "{refused} {armed}");
}

#[test]
fn f14_gains_in_another_unit_are_refused_or_harmless() {
    // Degrees, turns, milli, gram square centimetre, minutes.
    let degrees = 180.0 / core::f64::consts::PI;
    let factors = [degrees, 1.0 / degrees, 1e3, 1e-3, 1e7, 1e-7, core::f64::consts::TAU, 60.0];
    let (mut wrong, mut flagged) = (0, 0);
    for law in LAWS {
        let (study, stated, arm) = study(law);
        for factor in factors {
            let mut documents: Vec<Gains> = vec![];
            for place in 0..3 + law.2.len() {
                let mut gains = stated.clone();
                *figure(&mut gains, u32::try_from(place).unwrap()) *= factor;
                documents.push(gains);
            }
            // The whole outer loop at once.
            let mut gains = stated.clone();
            gains.joints[0].kp_per_s2 *= factor;
            gains.joints[0].kd_per_s *= factor;
            documents.push(gains);
            for gains in documents {
                wrong += 1;
                if arms(&study, &arm, &gains) {
                    assert!(settles(&study, &gains), "{factor}: {:?}", gains.joints);
                } else {
                    flagged += 1;
                }
            }
        }
    }
    println!("{wrong} documents in wrong units: {flagged} refused, the others stable");
    assert!(wrong >= 160 && flagged * 2 > wrong, "{flagged} of {wrong}");
}
