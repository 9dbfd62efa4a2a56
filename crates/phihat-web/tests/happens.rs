//! Fails if what is said to happen in a run does not, or if a PID beside it is not another law in the same world.

use serde_json::{Value, json};

use crate::support::{ask, text};

fn happens(more: &Value) -> String {
    let mut task = json!({ "task": "happens", "study": text("studies/first.toml"), "joint": "joint2",
        "push_nm": 0.0, "payload_kg": 0.0, "friction": 1.0, "from_s": 2.0 });
    task.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    ask(&task)["study"].as_str().unwrap().to_owned()
}

fn largest(run: &Value, joint: usize, from_s: f64, to_s: f64) -> f64 {
    let (t, e) = (&run["t"], &run["joints"][joint]["e"]);
    let inside = |k: &usize| (from_s..to_s).contains(&t[*k].as_f64().unwrap());
    let all = (0..t.as_array().unwrap().len()).filter(inside);
    all.map(|k| e[k].as_f64().unwrap().abs()).fold(0.0, f64::max)
}

#[test]
fn a_push_acts_when_and_where_it_is_said_to() {
    let [plain, pushed] = [json!({}), json!({ "push_nm": 5.0 })].map(|more| {
        let run = ask(&json!({ "task": "run", "study": happens(&more) }));
        assert!(run["samples"].is_u64(), "{run}");
        run
    });
    assert_eq!(happens(&json!({})), text("studies/first.toml"));
    assert_eq!(largest(&plain, 1, 0.0, 1.99).to_bits(), largest(&pushed, 1, 0.0, 1.99).to_bits());
    assert!(largest(&pushed, 1, 2.0, 2.5) > 2.0 * largest(&plain, 1, 2.0, 2.5));
}

#[test]
fn a_stop_brings_the_arm_to_rest_and_keeps_it_there() {
    let study = happens(&json!({ "stop_s": 3.0 }));
    let run = ask(&json!({ "task": "run", "study": study }));
    assert!(run["samples"].is_u64(), "{run}");
    let (t, joints) = (run["t"].as_array().unwrap(), run["joints"].as_array().unwrap());
    let travel = |from_s: f64, to_s: f64, joint: &Value| {
        let inside = |k: &usize| (from_s..to_s).contains(&t[*k].as_f64().unwrap());
        let q = (0..t.len()).filter(inside).map(|k| joint["q"][k].as_f64().unwrap());
        let (low, high) = q.fold((f64::MAX, f64::MIN), |(low, high), q| (low.min(q), high.max(q)));
        high - low
    };
    for joint in joints {
        assert!(travel(1.0, 3.0, joint) > 0.05, "{}", joint["name"]);
        assert!(travel(4.5, 6.0, joint) < 0.01, "{}", joint["name"]);
    }
    // Requests that come later than a stop are not made.
    let restarted =
        ask(&json!({ "task": "happens", "study": text("studies/estop_restart.toml"), "joint": "",
        "push_nm": 0.0, "payload_kg": 0.0, "friction": 1.0, "from_s": 0.0, "stop_s": 3.5 }));
    let study = restarted["study"].as_str().unwrap();
    assert!(
        !study.contains("4.5") && study.contains("t_s = 3.0") && study.contains("t_s = 3.5"),
        "{study}"
    );
}

#[test]
fn a_pid_runs_beside_in_the_same_world() {
    let study = text("studies/first.toml");
    let designed = ask(&json!({ "task": "design", "study": study }));
    let texts = |task: &str| json!({ "task": task, "study": study, "gains": designed["gains"] });
    let [run, beside] = ["run", "beside"].map(|task| ask(&texts(task)));
    assert_eq!(beside["diverged"], json!(false), "{beside}");
    for (own, other) in
        run["joints"].as_array().unwrap().iter().zip(beside["joints"].as_array().unwrap())
    {
        assert_eq!(own["name"], other["name"]);
        assert_eq!(own["e"].as_array().unwrap().len(), other["e"].as_array().unwrap().len());
        let [own, other] = [own, other].map(|joint| joint["measured_rad"].as_f64().unwrap());
        assert!(own > 0.0 && other > 0.0 && own.to_bits() != other.to_bits());
    }
    assert!(ask(&json!({ "task": "beside", "study": study }))["error"].is_string());
}
