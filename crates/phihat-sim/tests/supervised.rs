//! Studies with a `[supervisor]`. Wrong if the supervisor costs accuracy where nothing happens, if a fault does
//! not show in the trace and stop the arm, or if an arm starts again by itself.

use crate::support::{rod_study, run};
use phihat::{Events, Fault, Mode};
use phihat_sim::{SimulationOutcome, Supervision, Trace};
use phihat_study::Study;

const MOTION: &str = "[loop]\ntorque_rate_max_nm_s = 900.0\n[reference]\nkind = \"sines\"\ncenter_rad = 0.2\n\
                      fade_in_s = 1.0\n[[reference.sine]]\namplitude_rad = 0.3\nfrequency_hz = 0.5\n";

fn outcome(duration: f64, supervisor: &str, rest: &str) -> SimulationOutcome {
    run(&study(duration, supervisor, rest))
}

fn study(duration: f64, supervisor: &str, rest: &str) -> Study {
    let table = if supervisor.is_empty() { String::new() } else { format!("{supervisor}\n") };
    rod_study(&format!("duration_s = {duration}\nseed = 3"), &format!("{MOTION}{table}{rest}"))
}

fn supervision(outcome: &SimulationOutcome) -> &Supervision {
    outcome.trace.supervision.as_ref().unwrap()
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, e| e.abs().max(most))
}

#[test]
fn without_a_fault_it_tracks_as_the_bare_law_does() {
    let bare = outcome(4.0, "", "");
    let supervised =
        outcome(4.0, "[supervisor]\nerror_stop_rad = 0.2\nfrozen_travel_rad = 1e-3", "");
    assert!(bare.trace.supervision.is_none());
    let s = supervision(&supervised);
    assert_eq!(s.mode[..3], [Mode::Armed, Mode::Holding, Mode::Tracking]);
    assert!(s.mode[2..].iter().all(|m| *m == Mode::Tracking));
    assert!(s.fault.iter().all(Option::is_none));
    let (a, b) =
        (peak(&bare.trace.joints[0].e[2000..]), peak(&supervised.trace.joints[0].e[2000..]));
    assert!((a - b).abs() < 0.02 * a, "{a} {b}");
}

#[test]
fn a_fault_stops_the_arm_and_shows_in_the_trace() {
    let fault = "[[fault]]\nkind = \"sensor_nan\"\nstart_s = 2.0\nduration_s = 0.02\n";
    let stopped = outcome(4.0, "[supervisor]", fault);
    let s = supervision(&stopped);
    assert!(s.events[2000].contains(Events::NOT_FINITE | Events::MISSED));
    let at = s.mode.iter().position(|m| *m == Mode::SafeStop).unwrap();
    assert_eq!((at, s.fault[at]), (2004, Some(Fault::BadSample)), "the fifth bad sample");
    assert!(s.mode[at..].iter().all(|m| *m == Mode::SafeStop), "latched");
    let joint = &stopped.trace.joints[0];
    assert!(joint.q.iter().all(|q| q.is_finite()) && peak(&joint.dq[3500..]) < 0.05);
    // One bad sample is bridged.
    let fault = fault.replace("0.02", "0.001");
    let bridged = outcome(4.0, "[supervisor]", &fault);
    assert_eq!(supervision(&bridged).mode.last(), Some(&Mode::Tracking));
    assert!(peak(&bridged.trace.joints[0].e[2500..]) < 2e-3);
}

#[test]
fn f15_a_stop_and_a_restart_as_requests_over_time() {
    let request =
        |t: f64, mode: &str| format!("[[supervisor.request]]\nt_s = {t}\nmode = \"{mode}\"\n");
    let steps = [
        (0.0, "arm"),
        (0.01, "hold"),
        (0.02, "track"),
        (2.3, "stop"),
        (3.5, "track"),
        (4.0, "arm"),
        (4.01, "hold"),
        (4.02, "track"),
    ];
    let requests: String = steps.iter().map(|(t, mode)| request(*t, mode)).collect();
    let table = format!("[supervisor]\nstart_mismatch_max_rad = 0.2\n{requests}");
    let outcome = outcome(7.0, &table, "");
    let s = supervision(&outcome);
    let joint = &outcome.trace.joints[0];
    assert!(s.mode[2300..4000].iter().all(|m| *m == Mode::SafeStop));
    assert!(s.events[3600].contains(Events::REFUSED), "to track without arming is refused");
    assert_eq!(s.mode.last(), Some(&Mode::Tracking));
    assert!(peak(&joint.dq[4000..4500]) <= 0.8, "{}", peak(&joint.dq[4000..4500]));
    assert!(peak(&joint.e[5500..]) < 2e-3, "it tracks again: {}", peak(&joint.e[5500..]));
    let steps = joint.tau_command.windows(2).map(|w| (w[1] - w[0]).abs());
    assert!(steps.fold(0.0, f64::max) <= 0.9 + 1e-9, "the rate limit holds throughout");
}

#[test]
fn a_supervised_trace_survives_its_file() {
    let fault = "[[fault]]\nkind = \"sensor_freeze\"\nstart_s = 2.0\nduration_s = 0.05\n";
    let table = "[supervisor]\nfrozen_travel_rad = 1e-3";
    let trace = outcome(2.5, table, fault).trace;
    let study = study(2.5, table, fault);
    assert!(trace.supervision.as_ref().unwrap().fault.contains(&Some(Fault::Frozen)));
    let mut file = Vec::new();
    trace.write_csv(&mut file).unwrap();
    assert_eq!(Trace::read_csv(file.as_slice(), &study).unwrap(), trace);
    let text = String::from_utf8(file).unwrap();
    assert!(text.lines().next().unwrap().ends_with(",mode,events,fault,brake"));
    let bad = text.replacen(",tracking,", ",trackink,", 1);
    let why = Trace::read_csv(bad.as_bytes(), &study).unwrap_err().to_string();
    assert!(why.contains("mode") && why.contains("trackink"), "{why}");
}

/// The printed form starts at first order, and with less gain, as the observer form does. Without the keys: as ever.
#[test]
fn the_printed_form_has_start_gains_too() {
    let literal = |supervisor: &str| {
        let motion = MOTION.replace("[loop]", "[loop]\nform = \"literal\"");
        let table = format!("{motion}[supervisor]\n{supervisor}\n");
        run(&rod_study("duration_s = 4.0\nseed = 3", &table))
    };
    let plain = literal("");
    assert!(!supervision(&plain).events.iter().any(|e| e.contains(Events::RAISED)));
    for keys in [
        "start_first_order = true",
        "start_estimator_factor = 0.3",
        "start_first_order = true\nstart_estimator_factor = 0.5",
    ] {
        let outcome = literal(keys);
        let s = supervision(&outcome);
        let at: Vec<usize> =
            (0..s.events.len()).filter(|k| s.events[*k].contains(Events::RAISED)).collect();
        assert_eq!(at.len(), 1, "{keys}: raised once");
        assert!(at[0] > 100 && at[0] < 3000, "{keys}: {at:?}");
        assert!(s.fault.iter().all(Option::is_none), "{keys}");
        let tau = &outcome.trace.joints[0].tau_command;
        // No step: without a hand-over it would be of the size of φ̂. The rate of the torque may change.
        let here = (at[0]..at[0] + 3).map(|k| (tau[k + 1] - tau[k]).abs()).fold(0.0, f64::max);
        let phi_hat = outcome.trace.joints[0].phi_hat[at[0]].abs();
        assert!(phi_hat > 5.0 && here < 0.03 * phi_hat, "{keys}: {here} of {phi_hat}");
        // Once raised it is the law without a start.
        let end = 3500;
        let (a, b) =
            (peak(&outcome.trace.joints[0].e[end..]), peak(&plain.trace.joints[0].e[end..]));
        assert!((a - b).abs() < 0.05 * b, "{keys}: {a} {b}");
    }
}
