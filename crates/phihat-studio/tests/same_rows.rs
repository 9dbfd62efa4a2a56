//! A studio's run against `phihat run`. Wrong if its rows were another run's in a single bit, or if a saved run
//! were not repeated.

use phihat_session::{RunOptions, TraceKind};
use phihat_sim::{Row, Trace};
use phihat_studio::{AlongsideLaw, Begin, Live, StudioOptions};
use serde_json::json;

use crate::support::{document, folder, place, serve, status, wait_for};

fn begin(study: &std::path::Path) -> Begin {
    let options = RunOptions { study: study.to_owned(), ..RunOptions::default() };
    let (study, gains) = options.open().unwrap().0.into_parts();
    Begin { study, gains }
}

/// The trace of `phihat run`.
fn trace(study: &std::path::Path) -> Trace {
    let options = RunOptions { study: study.to_owned(), ..RunOptions::default() };
    options.open().unwrap().0.run(|_| ()).1
}

fn is_sample(rows: &[Row], trace: &Trace, k: usize) {
    for (row, joint) in rows.iter().zip(&trace.joints) {
        let here = [
            row.acted.q,
            row.acted.dq,
            row.acted.tau,
            row.command.tau,
            row.command.phi_hat,
            row.measurement.q,
        ];
        let there = [
            joint.q[k],
            joint.dq[k],
            joint.tau_applied[k],
            joint.tau_command[k],
            joint.phi_hat[k],
            joint.q_measured[k],
        ];
        assert_eq!(here.map(f64::to_bits), there.map(f64::to_bits), "{} at sample {k}", joint.name);
    }
}

#[test]
fn an_undisturbed_run_is_that_of_phihat_run_bit_for_bit() {
    let study = folder("same-rows").join("arm.toml");
    let whole = trace(&study);
    let mut live = Live::new(&begin(&study)).unwrap();
    for k in 0..whole.len() {
        let (t_ns, rows) = live.step().unwrap();
        assert_eq!(t_ns, whole.t_ns[k]);
        is_sample(rows, &whole, k);
    }
    // It goes on where the study's run ends.
    assert!(live.is_undisturbed() && live.step().is_some());
}

#[test]
fn a_run_that_met_faults_is_repeated_by_the_study_that_is_saved() {
    let folder = folder("repeated");
    let study = folder.join("arm.toml");
    let mut live = Live::new(&begin(&study)).unwrap();
    let mut rows = Vec::new();
    for k in 0..900 {
        let meets: &[(&str, Option<usize>, Option<f64>)] = match k {
            100 => &[("push", Some(1), Some(3.25)), ("sensor_noise", None, Some(1e-5))],
            140 => &[("push", Some(1), Some(-2.0))],
            205 => &[
                ("push", Some(1), None),
                ("payload", None, Some(0.7)),
                ("sample_loss", None, Some(0.2)),
            ],
            400 => &[("drive_gain", Some(0), Some(0.8)), ("sample_loss", None, None)],
            610 => &[
                ("payload", None, None),
                ("drive_gain", Some(0), None),
                ("push", Some(2), Some(0.5)),
            ],
            _ => &[],
        };
        for (word, joint, size) in meets {
            live.meet_named(word, *joint, *size).unwrap();
        }
        rows.push(live.step().unwrap().1.to_vec());
    }
    let (sections, substeps) = live.sections();
    assert_eq!(substeps, None);
    let again = folder.join("again.toml");
    std::fs::write(&again, format!("{}{sections}", crate::support::STUDY)).unwrap();
    let whole = trace(&again);
    for (k, rows) in rows.iter().enumerate() {
        is_sample(rows, &whole, k);
    }
}

#[test]
fn gains_are_changed_without_a_step_in_the_torque() {
    let study = folder("bumpless").join("arm.toml");
    let mut live = Live::new(&begin(&study)).unwrap();
    let mut before = [0.0; 3];
    for _ in 0..150 {
        let rows = live.step().unwrap().1;
        before.iter_mut().zip(rows).for_each(|(tau, row)| *tau = row.command.tau);
    }
    let mut other = begin(&study);
    for joint in &mut other.gains.joints {
        joint.kp_per_s2 *= 1.44;
        joint.kd_per_s *= 1.2;
    }
    assert!(live.take_gains(&other).unwrap());
    let rows = live.step().unwrap().1;
    for (tau, row) in before.iter().zip(rows) {
        assert!((tau - row.command.tau).abs() < 1e-9, "{tau} then {}", row.command.tau);
    }
}

#[test]
fn a_page_pushes_drags_gains_checks_and_saves() {
    let place = place("works");
    assert_eq!(status(&place.get(&format!("/?key={}", place.key))), 200);
    assert_eq!(document(&place.get("/state"))["joints"].as_array().unwrap().len(), 3);
    let met = document(&place.post("/meet", r#"{"what":"push","joint":1,"size":2.0}"#));
    assert!(met["t"].as_f64().unwrap() >= 0.0, "{met}");
    let asked =
        document(&place.post("/gains", r#"{"error":1,"outer":1.1,"estimator":1,"inertia":1}"#));
    let found = wait_for("what the gains amount to", || {
        let found = document(&place.get("/proof"));
        (found["ask"] == asked["ask"]).then_some(found)
    });
    assert_eq!(found["numbers"]["armed"], true, "{found}");
    assert!((found["numbers"]["joints"][0]["kp"].as_f64().unwrap() - 484.0).abs() < 1e-9);
    let wrong = crate::support::STUDY.replace("rate_hz", "rate_khz");
    let checked = document(&place.post("/check", &json!({ "text": wrong }).to_string()));
    let error = &checked["errors"][0];
    assert!(
        error["line"].is_u64() && error["key"].as_str().unwrap().contains("rate_khz"),
        "{checked}"
    );
    let saved = place.post("/save", r#"{"name":"kept"}"#);
    assert_eq!(status(&saved), 200, "{saved}");
    let text = std::fs::read_to_string(place.folder.join("kept.toml")).unwrap();
    assert!(
        text.contains("kind = \"push\"") && place.folder.join("kept.gains.json").is_file(),
        "{text}"
    );
    trace(&place.folder.join("kept.toml"));
}

/// By the law's own formula; wrong if the other law received, or measured, anything but what phihat's does, or met
/// other faults.
#[test]
fn the_other_law_runs_on_the_same_arm_and_meets_what_comes() {
    let study = folder("beside").join("arm.toml");
    let begin = begin(&study);
    let law = AlongsideLaw::new("pd", &[15.0, 0.8]).unwrap();
    let mut live = Live::beside(&begin, &law).unwrap();
    for k in 0..400 {
        if k == 100 {
            live.meet_named("payload", None, Some(0.7)).unwrap();
        }
        for (row, joint) in live.step().unwrap().1.iter().zip(&begin.gains.joints) {
            let (m, w) = (row.measurement, row.reference);
            let force = -225.0 * (m.q - w.q) - 24.0 * (m.dq - w.dq);
            let tau = joint.inertia_kg_m2 * force;
            assert!((row.command.tau - tau).abs() < 1e-9, "{tau} not {}", row.command.tau);
        }
    }
    let mut text = crate::support::STUDY.to_owned();
    text.extend([live.sections().0]);
    assert!(text.contains("kind = \"payload\""), "{text}");
    assert!(Live::beside(&begin, &AlongsideLaw::new("super-twisting", &[]).unwrap()).is_ok());
}

#[test]
fn a_page_sets_a_law_beside_it_and_makes_measurements_late() {
    let place = place("beside-page");
    for body in [
        r#"{"law":"pd","values":[15,0.8]}"#,
        r#"{"law":"pd","values":[25,0.8]}"#,
        r#"{"law":"adrc"}"#,
        r#"{"law":null}"#,
    ] {
        let done = place.post("/beside", body);
        assert_eq!(status(&done), 200, "{body}: {done}");
    }
    for body in [
        r#"{"law":"pd","values":[15]}"#,
        r#"{"law":"pd","values":[15,1e9]}"#,
        r#"{"law":"proposed-designed"}"#,
        r#"{"law":"../pd"}"#,
    ] {
        assert_eq!(status(&place.post("/beside", body)), 422, "{body}");
    }
    assert_eq!(status(&place.post("/late", r#"{"samples":3}"#)), 200);
    assert_eq!(status(&place.post("/late", r#"{"samples":9}"#)), 422);
    assert_eq!(status(&place.post("/late", r#"{"samples":-1}"#)), 400);
    assert_eq!(status(&place.post("/seek", r#"{"t":0.1}"#)), 422);
    assert!(document(&place.get("/schema"))["properties"]["robot"].is_object());
    assert_eq!(status(&place.post("/save", r#"{"name":"late"}"#)), 200);
    let kept = place.folder.join("late.toml");
    let options = RunOptions { study: kept, ..RunOptions::default() };
    let (study, _) = options.open().unwrap().0.into_parts();
    assert_eq!(study.sensor.delay_samples, 3);
}

/// Wrong if a picture showed another position, error or torque than the trace has at its time, or if an order were
/// obeyed.
#[test]
fn what_was_recorded_is_played_and_nothing_is_done_to_it() {
    let folder = folder("recorded");
    let out = folder.join("out");
    let options = RunOptions { study: folder.join("arm.toml"), ..RunOptions::default() };
    let (done, trace) = options.open().unwrap().0.run(|_| ());
    done.write(&trace, &out, TraceKind::default()).unwrap();
    let place = serve(&folder, StudioOptions { replay: Some(out), ..StudioOptions::default() });
    let length = document(&place.get("/state"))["record_s"].as_f64().unwrap();
    assert!((length - 0.999).abs() < 1e-9, "{length}");
    assert_eq!(status(&place.post("/run", r#"{"speed":0}"#)), 200);
    for k in [700_usize, 123] {
        let t = trace.t_ns[k] as f64 * 1e-9;
        // The sample is in one picture. Whoever begins to look after it asks for it again.
        let picture = wait_for("a picture of the sample", || {
            assert_eq!(status(&place.post("/seek", &json!({ "t": t }).to_string())), 200);
            place.picture(|shown| {
                let near = shown["t"].as_f64().is_some_and(|now| (now - t).abs() < 2e-3);
                near && shown["joints"][0]["e"][0].is_number()
            })
        });
        for (shown, joint) in picture["joints"].as_array().unwrap().iter().zip(&trace.joints) {
            let told = [&shown["q"], &shown["qd"], &shown["e"][0], &shown["tau"][1], &shown["phi"]];
            let kept = [
                joint.q[k],
                joint.q_desired[k],
                joint.e[k],
                joint.tau_command[k],
                joint.phi_hat[k],
            ];
            let told = told.map(|v| v.as_f64().unwrap().to_bits());
            assert_eq!(told, kept.map(f64::to_bits), "{} at {t} s", joint.name);
        }
    }
    for (path, body) in [
        ("/meet", r#"{"what":"push","joint":1,"size":2.0}"#),
        ("/gains", r#"{"error":1,"outer":1.1,"estimator":1,"inertia":1}"#),
        ("/beside", r#"{"law":"pd"}"#),
        ("/late", r#"{"samples":1}"#),
        ("/save", r#"{"name":"kept"}"#),
        ("/open", &json!({ "text": crate::support::STUDY }).to_string()),
    ] {
        let answer = place.post(path, body);
        assert!(status(&answer) == 422 && answer.contains("only be looked at"), "{path}: {answer}");
    }
}

/// Wrong if an arm without a supervisor were stopped, if one that has one went on, or if the study that is saved had
/// none.
#[test]
fn a_stop_needs_a_supervisor_and_a_run_begins_again_with_one() {
    let place = place("stopped");
    let refused = place.post("/run", r#"{"stop":true}"#);
    assert!(status(&refused) == 422 && refused.contains("[supervisor]"), "{refused}");
    assert_eq!(status(&place.post("/run", r#"{"supervise":true}"#)), 200);
    assert_eq!(status(&place.post("/run", r#"{"supervise":true}"#)), 422);
    let mode = |name: &'static str| {
        wait_for(name, || place.picture(move |shown| shown["mode"] == name));
    };
    mode("tracking");
    assert_eq!(status(&place.post("/run", r#"{"stop":true}"#)), 200);
    mode("safe-stop");
    assert_eq!(status(&place.post("/save", r#"{"name":"held"}"#)), 200);
    let kept = std::fs::read_to_string(place.folder.join("held.toml")).unwrap();
    assert!(kept.contains("[supervisor]"), "{kept}");
}
