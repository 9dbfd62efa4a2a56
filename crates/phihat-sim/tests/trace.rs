//! A trace is the same for the same study, survives its file to the last bit, and its figures are what a
//! second calculation finds. Wrong if anything hidden took part in a run, or a column were mixed up.

use crate::support::{rod_study, run};
use phihat_sim::{Metrics, Trace};

const WORLD: &str = "[spec]\nsettle_s = 0.4\nerror_bound_rad = 1e-3\n[sensor]\nencoder_bits = 16\n\
                     velocity = \"differenced\"\n[loop]\ndelay_samples = 1\ntorque_rate_max_nm_s = 900.0\n\
                     [reference]\nkind = \"sines\"\ncenter_rad = 0.2\nfade_in_s = 0.2\n[[reference.sine]]\n\
                     amplitude_rad = 0.3\nfrequency_hz = 1.5\nphase_rad = 0.4\n";

#[test]
fn same_study_same_trace() {
    let study = rod_study("duration_s = 1.0\nseed = 7", WORLD);
    assert_eq!(run(&study), run(&study));
}

#[test]
fn file_and_back_to_the_last_bit() {
    let study = rod_study("duration_s = 0.5", WORLD);
    let trace = run(&study).trace;
    let mut file = Vec::new();
    trace.write_csv(&mut file).unwrap();
    assert_eq!(Trace::read_csv(file.as_slice(), &study).unwrap(), trace);
    let text = String::from_utf8(file).unwrap();
    assert!(text.starts_with("t_s,joint,q_rad,dq_rad_s,"), "{}", &text[..60]);
    assert!(text.lines().nth(2).unwrap().starts_with("0.001,hinge,"));
}

#[test]
fn broken_files_are_refused_with_line_and_column() {
    let study = rod_study("duration_s = 0.5", WORLD);
    let trace = run(&study).trace;
    let mut file = Vec::new();
    trace.write_csv(&mut file).unwrap();
    let text = String::from_utf8(file).unwrap();
    let why = |text: &str| Trace::read_csv(text.as_bytes(), &study).unwrap_err().to_string();
    assert!(why(&text.replacen("q_rad", "q_deg", 1)).contains("column 3"));
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[4] = lines[4].replacen("hinge", "hinges", 1);
    assert!(
        why(&lines.join("\n")).contains("line 5: joint \"hinges\" is not the next one, \"hinge\"")
    );
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let fields: Vec<&str> = lines[3].split(',').collect();
    lines[3] = [&fields[..6], &["fast"], &fields[7..]].concat().join(",");
    let message = why(&lines.join("\n"));
    assert!(message.contains("line 4: dq_desired_rad_s") && message.contains("fast"), "{message}");
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines.swap(3, 5);
    assert!(why(&lines.join("\n")).contains("does not follow"));
    // Of another period, and of no sample.
    let head = text.lines().next().unwrap();
    let slower =
        text.lines().enumerate().filter(|(k, _)| k % 2 == 1 || *k == 0).map(|(_, line)| line);
    let message = why(&slower.collect::<Vec<_>>().join("\n"));
    assert!(
        message.contains("time 0.002 s does not follow 0.0 s by the study's period, 0.001 s"),
        "{message}"
    );
    assert!(why(head).contains("no sample follows"));
}

#[test]
fn figures_are_those_of_a_second_calculation() {
    let study = rod_study("duration_s = 1.0", WORLD);
    let trace = run(&study).trace;
    let metrics = Metrics::of(&trace, &study);
    let (row, joint) = (&metrics.joints[0], &trace.joints[0]);
    let steady = 400..1000;
    let worst = |x: &[f64]| steady.clone().map(|k| x[k].abs()).fold(0.0, f64::max);
    let rms = (steady.clone().map(|k| joint.e[k].powi(2)).sum::<f64>() / 600.0).sqrt();
    assert!((row.error_rms_rad - rms).abs() < 1e-15);
    assert_eq!(row.error_steady_max_rad.to_bits(), worst(&joint.e).to_bits());
    assert_eq!(row.velocity_error_steady_max_rad_s.to_bits(), worst(&joint.de).to_bits());
    assert_eq!(row.error_integral_steady_max_rad_s.to_bits(), worst(&joint.e_integral).to_bits());
    let step = (1..1000).map(|k| (joint.tau_command[k] - joint.tau_command[k - 1]).abs());
    assert_eq!(row.tau_step_max_nm.to_bits(), step.fold(0.0, f64::max).to_bits());
    assert!((row.tau_step_limit_nm.unwrap() - 0.9).abs() < 1e-12);
    assert!(row.tau_step_max_nm <= 0.9 + 1e-12, "the rate limit holds: {}", row.tau_step_max_nm);
    assert_eq!(row.rate_limited_samples, joint.rate_limited.iter().filter(|f| **f).count() as u64);
    assert!(row.rate_limited_samples > 0, "and acts in this study");
    // e = q − q_d and φ = τ − M̄q̈ at every sample (no drive lag here).
    for k in 0..1000 {
        assert!((joint.e[k] - (joint.q[k] - joint.q_desired[k])).abs() < 1e-15);
        assert!((joint.phi[k] - (joint.tau_applied[k] - 0.52 * joint.ddq[k])).abs() < 1e-12);
    }
}
