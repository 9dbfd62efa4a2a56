//! A tube as data, and runs compared with it. Wrong if a sample outside passed, one inside did not, a sample
//! on the edge of two bins were compared with the wrong one, or the settling time began before the rest of
//! the tube is inside.
#![allow(clippy::float_cmp, reason = "tests")]

use phihat_certificate::{JointRun, Quantity, Settle, SettleFrom, Tube, TubeJoint, TubePayloadSet};
use phihat_study::Study;

/// Two joints, ten bins of 10 ms: the start-up of the first falls from 10 mrad to 1 mrad, the second is at 2 mrad.
fn tube() -> Tube {
    let errors = [10.0, 8.0, 6.0, 4.0, 3.0, 2.0, 1.0, 1.0, 1.0, 1.0].map(|e| e * 1e-3);
    let joint = |name: &str, errors: &[f64]| TubeJoint {
        name: name.to_owned(),
        error_low_rad: errors.iter().map(|e| -e).collect(),
        error_high_rad: errors.to_vec(),
        velocity_low_rad_s: vec![-0.5; errors.len()],
        velocity_high_rad_s: vec![0.5; errors.len()],
        error_bound_rad: errors[5],
        velocity_error_bound_rad_s: 0.5,
        torque_max_nm: 20.0,
        torque_step_nm: vec![2.0; errors.len()],
        torque_step_max_nm: 2.0,
        torque_step_steady_max_nm: 2.0,
    };
    Tube {
        bin_s: 0.01,
        duration_s: 0.1,
        settle_s: 0.05,
        slices: 2,
        payload: TubePayloadSet {
            frame: "tip".into(),
            mass_kg: (0.0, 1.0),
            com_m: [(0.0, 0.0); 3],
            gyration_m: 0.0,
        },
        coulomb_nm: (vec![0.0; 2], vec![0.3; 2]),
        quantum_rad: vec![0.0; 2],
        joints: vec![joint("joint1", &errors), joint("joint2", &[2e-3; 10])],
        limits_silent: true,
        tip: None,
    }
}

/// 100 samples at 1 kHz, at rest on the reference.
struct Run {
    t_ns: Vec<u64>,
    columns: [[Vec<f64>; 3]; 2],
    limited: u64,
}

fn run() -> Run {
    let still = || [vec![0.0; 100], vec![0.0; 100], vec![10.0; 100]];
    Run { t_ns: (0..100).map(|k| k * 1_000_000).collect(), columns: [still(), still()], limited: 0 }
}

fn left(run: &Run) -> Option<(String, Quantity, f64, f64, f64)> {
    let joint = |[e, de, tau]: &[Vec<f64>; 3]| (e.clone(), de.clone(), tau.clone());
    let all: Vec<_> = run.columns.iter().map(joint).collect();
    let runs: Vec<_> = all
        .iter()
        .map(|(e, de, tau)| JointRun { e, de, tau_command: tau, limited_samples: run.limited })
        .collect();
    let kept = tube().kept_by(&run.t_ns, &runs).unwrap();
    kept.left.map(|l| (l.joint, l.quantity, l.t_s, l.value, l.bound))
}

#[test]
fn a_run_inside_stays_inside_to_the_very_edge() {
    let mut run = run();
    assert_eq!(left(&run), None);
    run.columns[0][0][9] = 10e-3;
    run.columns[0][0][10] = -8e-3;
    assert_eq!(left(&run), None, "on the edge is inside");
}

#[test]
fn a_sample_that_is_missing_is_outside() {
    for column in 0..3 {
        let mut run = run();
        run.columns[1][column].truncate(60);
        let (joint, _, t_s, value, _) = left(&run).unwrap();
        assert_eq!(
            (joint.as_str(), t_s, value.is_nan()),
            ("joint2", 0.06, true),
            "column {column}"
        );
    }
}

#[test]
fn blocks_leave_a_tube_where_the_whole_run_does() {
    let mut run = run();
    // A step of the torque from one block to the next, a limit that acts, and an error that is larger later.
    run.columns[0][2][40] = 90.0;
    run.columns[0][0][90] = 7e-3;
    run.limited = 3;
    let of = |from: usize, to: usize, limited_samples| {
        run.columns.each_ref().map(|[e, de, tau]| JointRun {
            e: &e[from..to],
            de: &de[from..to],
            tau_command: &tau[from..to],
            limited_samples,
        })
    };
    let tube = tube();
    let whole = tube.kept_by(&run.t_ns, &of(0, 100, 3)).unwrap();
    assert!(whole.left.is_some());
    for block in [1, 7, 20, 40, 99] {
        let mut watch = tube.watch(2).unwrap();
        for from in (0..100).step_by(block) {
            let to = (from + block).min(100);
            let limited = if from == 0 { 3 } else { 0 };
            watch.block(&tube, &run.t_ns[from..to], &of(from, to, limited));
        }
        assert_eq!(watch.kept(&tube), whole, "blocks of {block}");
    }
}

#[test]
fn a_sample_is_held_against_its_own_bin() {
    // 0.29 s is 29 bins of 0.01 s, though 0.29/0.01 is below that in floating point.
    assert_eq!(tube().bin_of(290_000_000), 29);
    assert_eq!(tube().bin_of(30_000_000), 3);
    assert_eq!(tube().bin_of(29_999_999), 2);
    let mut run = run();
    run.columns[0][0][29] = 5e-3;
    assert_eq!(left(&run), None);
    run.columns[0][0][30] = 5e-3;
    assert_eq!(left(&run), Some(("joint1".into(), Quantity::Error, 0.03, 5e-3, 4e-3)));
}

#[test]
fn whatever_leaves_first_is_named_with_its_bound() {
    let mut run = run();
    run.columns[1][1][70] = -0.51;
    assert_eq!(left(&run), Some(("joint2".into(), Quantity::VelocityError, 0.07, -0.51, -0.5)));
    run.columns[0][2][60] = -20.5;
    assert_eq!(left(&run), Some(("joint1".into(), Quantity::Torque, 0.06, -20.5, -20.0)));
    run.columns[1][2][40] = 12.5;
    assert_eq!(left(&run), Some(("joint2".into(), Quantity::TorqueStep, 0.04, 2.5, 2.0)));
    run.columns[1][0][3] = f64::NAN;
    let (joint, what, t, value, _) = left(&run).unwrap();
    assert_eq!((joint.as_str(), what, t), ("joint2", Quantity::Error, 0.003));
    assert!(value.is_nan());
}

#[test]
fn a_limit_that_cannot_act_and_does_breaks_the_claim() {
    let mut run = run();
    run.limited = 3;
    assert_eq!(left(&run), Some(("joint1".into(), Quantity::LimitedSamples, 0.1, 3.0, 0.0)));
}

#[test]
fn samples_beyond_the_tube_are_not_claimed() {
    let mut run = run();
    run.t_ns = (100..200).map(|k| k * 1_000_000).collect();
    run.columns[0][0] = vec![1.0; 100];
    assert_eq!(left(&run), None);
}

#[test]
fn figures_stand_beside_each_other() {
    let mut run = run();
    run.columns[0][0][20] = 5e-3;
    run.columns[0][0][80] = -0.75e-3;
    let joint = |[e, de, tau]: &[Vec<f64>; 3]| (e.clone(), de.clone(), tau.clone());
    let all: Vec<_> = run.columns.iter().map(joint).collect();
    let runs =
        all.iter().map(|(e, de, tau)| JointRun { e, de, tau_command: tau, limited_samples: 0 });
    let kept = tube().kept_by(&run.t_ns, &runs.collect::<Vec<_>>()).unwrap();
    let joint = &kept.joints[0];
    assert_eq!((joint.error_peak_rad, joint.error_bound_rad), (0.75e-3, 2e-3));
    assert!((joint.room_rad - 0.25e-3).abs() < 1e-12, "{}", joint.room_rad);
    assert!(tube().kept_by(&run.t_ns, &[]).is_none(), "other joints");
}

#[test]
fn the_steady_part_begins_where_the_rest_stays_inside() {
    let tube = tube();
    assert_eq!(tube.settled(&[4e-3, 4e-3]), Some(0.03));
    assert_eq!(tube.settled(&[20e-3, 20e-3]), Some(0.0));
    assert_eq!(tube.settled(&[1e-3, 2e-3]), Some(0.06));
    assert_eq!(tube.settled(&[4e-3, 1.9e-3]), None, "joint2 is never inside");
    assert_eq!(tube.settled(&[4e-3]), None, "a joint without a bound");
    let mut late = tube.clone();
    late.joints[0].error_high_rad[8] = 5e-3;
    assert_eq!(late.settled(&[4e-3, 4e-3]), Some(0.09), "it must stay inside");
    late.joints[0].error_low_rad[9] = f64::NAN;
    assert_eq!(late.settled(&[4e-3, 4e-3]), None, "NaN bounds nothing");
    assert_eq!(tube.own_settled(), 0.05, "2 mrad is the most of its second half");
}

#[test]
fn a_stated_settling_time_stands_and_another_comes_from_the_tube() {
    let study = |spec: &str| {
        let text = format!(
            "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[spec]\n{spec}\n[design]\n[reference]\nkind = \"hold\"\n\
             q_rad = 0.0\n"
        );
        Study::from_text(&text, "settle.toml", std::path::Path::new("")).unwrap()
    };
    let of = |spec: &str, tube: Option<&Tube>| {
        let settle = Settle::of(&study(spec), tube);
        (settle.settle_s, settle.from)
    };
    let mut three = tube();
    three.joints.push(three.joints[1].clone());
    let stated = "settle_s = 0.5\nerror_bound_rad = 4e-3";
    assert_eq!(of(stated, Some(&three)), (0.5, SettleFrom::Study));
    assert_eq!(of("error_bound_rad = 4e-3", None), (1.0, SettleFrom::Default));
    assert_eq!(of("error_bound_rad = 4e-3", Some(&three)), (0.03, SettleFrom::Tube));
    assert_eq!(of("error_bound_rad = 1e-3", Some(&three)), (0.05, SettleFrom::TubeLevel));
    assert_eq!(of("", Some(&three)), (0.05, SettleFrom::TubeLevel));
}

#[test]
fn a_tube_survives_its_file() {
    let text = serde_json::to_string(&tube()).unwrap();
    assert_eq!(serde_json::from_str::<Tube>(&text).unwrap(), tube());
    let extra = text.replacen("\"bin_s\"", "\"more\":1,\"bin_s\"", 1);
    assert!(serde_json::from_str::<Tube>(&extra).is_err(), "an unknown key is refused");
}
