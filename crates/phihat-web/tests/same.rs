//! Fails if a study whose arm is a text leads to other gains, another trace, another page or another check than the
//! same study on the disk, designed with threads.

use std::fs;
use std::path::Path;

use phihat_certificate::parallel::alone;
use phihat_design::{Gains, Outcome};
use phihat_session::{Session, designed, read};
use serde_json::{Value, json};

use crate::support::{ask, boxed, heard, searched_of_files, text};

#[test]
fn texts_on_one_thread_give_the_bytes_of_the_disk_and_all_threads() {
    let (study, urdf, arm) =
        (searched_of_files(), boxed(), text("crates/phihat-model/robots/planar3r.toml"));
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("arm")).unwrap();
    let path = folder.path().join("study.toml");
    fs::write(&path, &study).unwrap();
    fs::write(folder.path().join("arm/planar3r.urdf"), &urdf).unwrap();
    fs::write(folder.path().join("arm/planar3r.toml"), &arm).unwrap();
    let files = json!({ "arm/planar3r.toml": arm, "arm/planar3r.urdf": urdf });
    let task = |task: &str, gains: Option<&str>| -> Value {
        json!({ "task": task, "study": study, "files": files, "gains": gains })
    };

    let Outcome::Designed(native) = designed(&read(&path).unwrap(), &path).unwrap() else {
        panic!("the study has gains")
    };
    let native = native.to_json().unwrap();
    let (answer, events) = alone(|| heard(&task("design", None)));
    let gains = answer["gains"].as_str().unwrap();
    assert_eq!(gains, native, "{}", answer["infeasible"]);
    assert!(events.len() > 2 && events.iter().all(|event| event["step"].is_string()), "{events:?}");

    let own = Gains::from_json(&native).unwrap();
    let given = Some((own, Path::new("gains.json")));
    let session = Session::new(read(&path).unwrap(), Path::new("study.toml"), given, false);
    let (done, trace) = session.unwrap().run(|_| ());
    let (run, events) = heard(&task("run", Some(gains)));
    assert_eq!(run["samples"], json!(trace.len()), "{}", run["error"]);
    assert!(events.iter().any(|event| event["of"] == json!(trace.len())));
    let joint = &run["joints"][0];
    let largest = trace.joints[0].e.iter().map(|e| e.abs()).fold(0.0, f64::max);
    let drawn = joint["e"].as_array().unwrap().iter().filter_map(Value::as_f64);
    assert_eq!(drawn.map(f64::abs).fold(0.0, f64::max).to_bits(), largest.to_bits());
    assert_eq!(run["good"], json!(done.good()));
    assert_eq!(joint["measured_rad"], json!(done.metrics.joints[0].error_steady_max_rad));

    let page = ask(&task("page", Some(gains)));
    let native = phihat_report::page(&done.record());
    // The box of the first link is drawn from the text as from the file.
    assert!(done.study.robot.look(1000, None).shapes.len() == 1);
    assert_eq!(page["page"].as_str(), Some(&*native), "{}", page["error"]);

    let drawn = ask(&task("figures", Some(gains)));
    let native = phihat_report::figures(&done.record());
    let pair = |own: &phihat_report::Picture| json!({ "name": own.name, "title": own.title, "svg": own.svg });
    assert!(native.len() > 5);
    assert_eq!(drawn["figures"], native.iter().map(pair).collect::<Value>(), "{}", drawn["error"]);

    let found = alone(|| ask(&task("verify", Some(gains))));
    assert_eq!(found["holds"], json!(true), "{}", found["error"]);
    let threads = ask(&task("verify", Some(gains)));
    assert_eq!(found, threads);
}
