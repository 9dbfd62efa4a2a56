//! The promise of the first page: the Panda tracks within half a milliradian, inside its torque and
//! torque-rate limits, with a payload, friction, delay and encoders that the controller is not told about.
//! Wrong if the study were softened, or the loop were worse than that.

use crate::support::{folder, json};

#[test]
fn panda_tracks_within_half_a_milliradian() {
    let folder = folder("panda");
    let study = std::fs::read_to_string(folder.join("studies/panda.toml")).unwrap();
    for hard_part in [
        "payload_max_kg = 1.0",
        "delay_samples = 1",
        "encoder_bits = 18",
        "velocity = \"differenced\"",
        "friction = \"robot\"",
        "coulomb_extra_nm = 0.3",
        "mass_kg = 0.5",
        "error_bound_rad = 5e-4",
        "torque_rate_max_nm_s = \"robot\"",
    ] {
        assert!(study.contains(hard_part), "the study must keep: {hard_part}");
    }
    let answer = json(&folder, &["run", "studies/panda.toml", "--json"]);
    let joints = answer["metrics"]["joints"].as_array().unwrap();
    assert_eq!(joints.len(), 7);
    for joint in joints {
        let figure = |key: &str| joint[key].as_f64().unwrap_or_else(|| panic!("{key}: {joint}"));
        assert!(figure("error_steady_max_rad") <= 5e-4, "{joint}");
        assert!(figure("tau_max_nm") < figure("tau_limit_nm"), "{joint}");
        assert!(figure("tau_step_max_nm") <= 1.0 + 1e-9, "{joint}");
        assert_eq!(figure("saturated_samples").to_bits(), 0.0_f64.to_bits(), "{joint}");
        // It moves: a joint that does not move would track anything.
        assert!(figure("phi_max_nm") > 0.1, "{joint}");
    }
    assert_eq!(answer["metrics"]["within_spec"], true);
    // Said before the run, and kept by it: no limit acts from the start on.
    let tube = &answer["metrics"]["tube"];
    assert!(tube["left"].is_null() && tube["no_promise"].is_null(), "{tube:#}");
    for joint in tube["joints"].as_array().unwrap() {
        assert!(joint["error_bound_rad"].as_f64().unwrap() <= 5e-4, "{joint}");
    }
}

/// A stricter error than two slices of the payload prove, under the same proof of the change of torque: the
/// search goes on with finer ones.
#[test]
fn finer_slices_of_the_payload_prove_less_error() {
    let folder = folder("panda-rate");
    let study = std::fs::read_to_string(folder.join("studies/panda_rate.toml")).unwrap();
    for hard_part in ["torque_step_max_nm = 1.0", "payload_max_kg = 1.0", "error_bound_rad = 4e-4"]
    {
        assert!(study.contains(hard_part), "the study must keep: {hard_part}");
    }
    let answer = json(&folder, &["run", "studies/panda_rate.toml", "--json"]);
    for joint in answer["metrics"]["joints"].as_array().unwrap() {
        assert!(joint["error_steady_max_rad"].as_f64().unwrap() <= 3e-4, "{joint}");
        assert_eq!(joint["rate_limited_samples"], 0, "{joint}");
    }
    let tube = &answer["metrics"]["tube"];
    assert!(tube["left"].is_null() && tube["no_promise"].is_null(), "{tube:#}");
    let text = std::fs::read_to_string(folder.join("out/panda_rate/gains.json")).unwrap();
    let gains: serde_json::Value = serde_json::from_str(&text).unwrap();
    let tube = &gains["certificate"]["tube"];
    assert!(tube["slices"].as_u64().unwrap() > 2, "{}", tube["slices"]);
    for joint in tube["joints"].as_array().unwrap() {
        assert!(joint["error_bound_rad"].as_f64().unwrap() <= 4e-4, "{joint}");
        assert!(joint["torque_step_max_nm"].as_f64().unwrap() <= 1.0, "{joint}");
    }
}

/// Without the proof that no torque changes by more than 1 N·m per sample: less error, proved and measured,
/// and the robot's own limit does not act all the same, next to empty-handed and with all that the gains are
/// for.
#[test]
fn less_error_where_the_change_of_torque_is_not_proved() {
    let folder = folder("panda-fast");
    json(&folder, &["design", "studies/panda_fast.toml", "--out", "fast.json", "--json"]);
    let text = std::fs::read_to_string(folder.join("fast.json")).unwrap();
    let gains: serde_json::Value = serde_json::from_str(&text).unwrap();
    for joint in gains["certificate"]["tube"]["joints"].as_array().unwrap() {
        assert!(joint["error_bound_rad"].as_f64().unwrap() <= 0.36e-3, "{joint}");
    }
    let study = std::fs::read_to_string(folder.join("studies/panda_rate.toml")).unwrap();
    assert!(study.contains("torque_rate_max_nm_s = \"robot\"") && study.contains("mass_kg = 0.5"));
    for mass in ["0.001", "0.5", "1.0"] {
        let own = study.replace("mass_kg = 0.5", &format!("mass_kg = {mass}"));
        std::fs::write(folder.join("loaded.toml"), own).unwrap();
        let answer = json(&folder, &["simulate", "loaded.toml", "--gains", "fast.json", "--json"]);
        for joint in answer["metrics"]["joints"].as_array().unwrap() {
            assert!(joint["error_steady_max_rad"].as_f64().unwrap() <= 0.21e-3, "{mass}: {joint}");
            assert_eq!(joint["rate_limited_samples"], 0, "{mass}: {joint}");
            assert!(joint["tau_step_limit_nm"].as_f64().unwrap() <= 1.0 + 1e-9, "{joint}");
        }
        let tube = &answer["metrics"]["tube"];
        assert!(tube["left"].is_null() && tube["no_promise"].is_string(), "{tube:#}");
    }
}

#[test]
fn every_study_of_the_project_keeps_its_spec() {
    let folder = folder("all-studies");
    let mut count = 0;
    for entry in std::fs::read_dir(folder.join("studies")).unwrap() {
        let path = entry.unwrap().path();
        // The paper's recipe does not arm, and says so: see `design.rs`. Each is designed for half a minute:
        // the first above, in README and in the book, and the others are it but for a key.
        let slow = [
            "panda.toml",
            "panda_rate.toml",
            "panda_known.toml",
            "panda_fast.toml",
            "panda_contact.toml",
        ];
        let slow = slow.iter().any(|name| path.ends_with(name));
        let armed = !path.ends_with("paper_recipe.toml") && !slow;
        if armed && path.extension().is_some_and(|e| e == "toml") {
            let answer = json(&folder, &["simulate", path.to_str().unwrap(), "--json"]);
            assert_eq!(answer["metrics"]["within_spec"], true, "{}: {answer:#}", path.display());
            count += 1;
        }
    }
    assert!(count >= 6, "only {count} studies found");
}

/// The feed-forward from a Panda's description acts under a supervisor as without one, and a description that
/// is wrong makes no step at the start.
#[test]
fn what_is_known_is_fed_forward_under_a_supervisor() {
    let folder = folder("panda-known");
    let study = std::fs::read_to_string(folder.join("studies/panda_known.toml")).unwrap();
    // What holds the empty arm where the motion begins, from the arm itself.
    let held = "[0.0, -3.987818678548092, -0.6440002148692189, 22.021018777058607, 0.6338461861009121, \
        2.278164535327047, 0.0]";
    let guarded = |text: &str| {
        let supervisor = format!("[supervisor]\npreset_nm = {held}\nerror_stop_rad = 0.2\n");
        let guarded = text.replace("[start]\ntorque_nm = \"gravity\"\n", &supervisor);
        assert!(guarded != text && guarded.contains("[feedforward]"));
        guarded.replace("duration_s = 10.0", "duration_s = 6.0")
    };
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    write("guarded.toml", &guarded(&study));
    json(&folder, &["design", "guarded.toml", "--out", "guarded.json", "--json"]);
    let gains = std::fs::read_to_string(folder.join("guarded.json")).unwrap();
    let gains: serde_json::Value = serde_json::from_str(&gains).unwrap();
    assert!(gains["certificate"]["tube"].is_null(), "no tube is about a supervisor");
    let errors = |name: &str, text: &str| {
        write(name, text);
        let answer = json(&folder, &["simulate", name, "--gains", "guarded.json", "--json"]);
        let joints = answer["metrics"]["joints"].as_array().unwrap().clone();
        joints
            .iter()
            .map(|joint| joint["error_steady_max_rad"].as_f64().unwrap())
            .collect::<Vec<_>>()
    };
    let own = errors("guarded.toml", &guarded(&study));
    let alone = errors("alone.toml", &study.replace("duration_s = 10.0", "duration_s = 6.0"));
    let none = guarded(&study).replace("model = \"gravity\"", "model = \"none\"");
    let none = errors("none.toml", &none.replace("coulomb_nm = 0.15", "coulomb_nm = 0.0"));
    for (i, own) in own.iter().enumerate() {
        assert!((own / alone[i] - 1.0).abs() < 0.1, "{i}: {own} for {}", alone[i]);
    }
    assert!(own.iter().sum::<f64>() < 0.7 * none.iter().sum::<f64>(), "{own:?} {none:?}");
    // In lock-step a drive is the simulation.
    json(
        &folder,
        &["simulate", "guarded.toml", "--gains", "guarded.json", "--out", "simulated", "--json"],
    );
    let drive =
        ["drive", "guarded.toml", "--gains", "guarded.json", "--on", "sim", "--out", "driven"];
    json(&folder, &[&drive[..], &["--accept", "certificate", "--json"]].concat());
    let read = |name: &str| std::fs::read(folder.join(name).join("trace.parquet")).unwrap();
    assert!(read("simulated") == read("driven"));
}
