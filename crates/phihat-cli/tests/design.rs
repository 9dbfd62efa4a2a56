//! From a specification to gains, checked again by `verify`, run by `simulate`; or a "no" with exit code 1.

use std::fs;
use std::path::Path;

use crate::support::{folder, json, phihat, swing};

const PLANAR: &str = r#"duration_s = 3.0
[robot]
name = "planar3r"
[spec]
settle_s = 1.5
error_bound_rad = 4e-3
[design]
payload_max_kg = 0.5
[loop]
delay_samples = 1
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 100.0
[world]
payload = { mass_kg = 0.3 }
[reference]
kind = "sines"
center = "ready"
[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = 0.3
"#;

#[test]
fn designed_gains_are_verified_keep_their_bound_in_the_loop_and_are_refused_once_forged() {
    let folder = folder("design");
    fs::write(folder.join("planar.toml"), PLANAR).unwrap();
    designed_and_forged(&folder, "planar.toml", (4e-3, "joint3"));
}

/// `cargo xtask test --all` only.
#[test]
fn the_pandas_gains_are_verified_keep_their_bound_in_the_loop_and_are_refused_once_forged() {
    designed_and_forged(
        &folder("design-panda"),
        "studies/panda_design.toml",
        (1e-3, "panda_joint7"),
    );
}

/// Designs, verifies and runs a study; then forges the claim of its last joint to be twice as good.
fn designed_and_forged(folder: &Path, study: &str, (spec, last): (f64, &str)) {
    let answer = json(folder, &["design", study, "--json"]);
    assert_eq!(answer["outcome"], "designed");
    let file = answer["file"].as_str().unwrap();
    let name = Path::new(study).file_stem().unwrap().to_str().unwrap();
    assert_eq!(file, format!("out/{name}/gains.json"));
    let verified = json(folder, &["verify", file, "--json"]);
    assert_eq!(verified["holds"], true);
    let run = ["simulate", study, "--gains", file, "--json"];
    let metrics = json(folder, &run)["metrics"].clone();
    let tube = &answer["gains"]["certificate"]["tube"];
    let claims = tube["joints"].as_array().unwrap();
    for (joint, claim) in metrics["joints"].as_array().unwrap().iter().zip(claims) {
        let bound = claim["error_bound_rad"].as_f64().unwrap();
        let measured = joint["error_steady_max_rad"].as_f64().unwrap();
        assert!(measured <= bound && bound <= spec, "{}: {measured} {bound}", joint["name"]);
    }
    // Half of it is refused, with the inequality.
    let mut forged = answer["gains"].clone();
    let bound = &mut forged["certificate"]["tube"]["joints"][claims.len() - 1]["error_bound_rad"];
    *bound = (0.5 * bound.as_f64().unwrap()).into();
    fs::write(folder.join("forged.json"), forged.to_string()).unwrap();
    let refused = phihat(folder, &["verify", "forged.json"]);
    assert_eq!(refused.code, 1);
    assert!(refused.out.contains(&format!("REFUSED: {last}: tube")), "{}", refused.out);
}

#[test]
fn a_study_without_gains_is_designed_on_the_way() {
    let folder = folder("design-run");
    fs::write(folder.join("swing.toml"), swing(1.5)).unwrap();
    let answer = phihat(&folder, &["run", "swing.toml"]);
    assert_eq!(answer.code, 0, "{}", answer.err);
    let gains = fs::read_to_string(folder.join("out/swing/gains.json")).unwrap();
    assert!(gains.contains("certificate"));
}

#[test]
fn what_cannot_be_had_is_told_with_what_can() {
    let folder = folder("infeasible");
    // Beyond half an encoder step, and below what these laws reach.
    let strict = swing(1.5).replace("error_bound_rad = 4e-3", "error_bound_rad = 1.25e-5");
    assert!(strict != swing(1.5));
    fs::write(folder.join("strict.toml"), strict).unwrap();
    let answer = phihat(&folder, &["design", "strict.toml"]);
    assert_eq!(answer.code, 1, "{}", answer.err);
    assert!(
        answer.out.contains("NO GAINS") && answer.out.contains("is possible"),
        "{}",
        answer.out
    );
    assert!(answer.out.contains("rad/s"), "how fast a law may be: {}", answer.out);
    assert!(folder.join("out/strict/budget.html").is_file());
    assert!(!folder.join("out/strict/gains.json").exists());
    let answer = phihat(&folder, &["verify", "studies/first.toml"]);
    assert_eq!(answer.code, 2);
    assert!(answer.err.contains("studies/first.toml"), "{}", answer.err);
}

#[test]
fn the_form_is_left_to_the_design_and_what_is_said_to_be_possible_is() {
    let folder = folder("form-left");
    let plain =
        swing(1.5).replace("form = \"observer\"\n", "").replace("settling_time_s = 0.2\n", "");
    assert!(!plain.contains("form") && !plain.contains("settling"));
    let asked = |name: &str, text: &str| {
        fs::write(folder.join(name), text).unwrap();
        phihat(&folder, &["design", name, "--json"])
    };
    let document = |out: &str| serde_json::from_str::<serde_json::Value>(out).unwrap();
    let left = asked("left.toml", &plain);
    assert_eq!(left.code, 0, "{}", left.err);
    let left = document(&left.out)["gains"]["joints"].clone();
    let said = asked("said.toml", &plain.replace("[loop]\n", "[loop]\nform = \"design\"\n"));
    assert_eq!(document(&said.out)["gains"]["joints"], left);
    let error = |bound: f64| {
        plain.replace("error_bound_rad = 4e-3", &format!("error_bound_rad = {bound:e}"))
    };
    let none = asked("none.toml", &error(1e-6));
    assert_eq!(none.code, 1, "{}{}", none.out, none.err);
    let clause = document(&none.out)["reason"]["clauses"][0].clone();
    assert_eq!(clause["key"], "spec.error_bound_rad", "{clause}");
    let possible = clause["possible"].as_f64().unwrap();
    assert!(possible < 4e-4, "{clause}");
    let kept = asked("kept.toml", &error(1.02 * possible));
    assert_eq!(kept.code, 0, "{}{}", kept.out, kept.err);
    assert!(document(&kept.out)["gains"]["certificate"].get("unproved").is_none(), "{}", kept.out);
}

#[test]
fn the_papers_recipe_says_what_holds_and_does_not_arm() {
    let folder = folder("paper");
    let study = "studies/paper_recipe.toml";
    let answer = json(&folder, &["design", study, "--json"]);
    assert_eq!(answer["outcome"], "designed");
    let file = answer["file"].as_str().unwrap();
    // (44), corrected, by hand: K̃ = 2φ/ė, K_p = 2φ/(K̃ ∫e), c = φ/(K̃ e), K_d = c + √(c² + 2K_p); a settling time of
    // 0.3 s of a critically damped pair asks for ω = 5.834/0.3.
    let joint = &answer["gains"]["joints"][0];
    let gain = |key: &str| joint[key].as_f64().unwrap();
    let (e, integral, de) = (0.02, 0.005, 0.2);
    let kp: f64 = de / integral;
    let c = de / (2.0 * e);
    let (least, w) = (c + (c * c + 2.0 * kp).sqrt(), 5.834 / 0.3);
    assert!((gain("kp_per_s2") / kp.max(w * w) - 1.0).abs() < 1e-3, "{joint}");
    assert!((gain("kd_per_s") / least.max(2.0 * w) - 1.0).abs() < 1e-3, "{joint}");
    assert_eq!(joint["inertia_kg_m2"], 1.0);
    let a = joint["a"][0].as_f64().unwrap();
    assert!(a >= 4.0 * gain("kp_per_s2").sqrt() * 0.999, "{joint}");
    let claims = &answer["gains"]["certificate"]["joints"][0];
    assert!(claims["refused"][0]["inequality"].as_str().unwrap().contains("window.low"));
    assert!(claims["bounds"].is_null() && !claims["continuous"]["iss"].is_null());
    let verified = phihat(&folder, &["verify", file]);
    assert_eq!(verified.code, 1);
    assert!(verified.out.contains("REFUSED: joint1: inertia window"), "{}", verified.out);
    let run = phihat(&folder, &["simulate", study, "--gains", file]);
    assert_eq!(run.code, 2);
    assert!(run.err.contains("not armed"), "{}", run.err);
    // Our method on the same study: it arms.
    let ours = json(&folder, &["design", study, "--method", "ours", "--json"]);
    assert_eq!(ours["outcome"], "designed", "{ours:#}");
    assert_eq!(json(&folder, &["verify", ours["file"].as_str().unwrap(), "--json"])["holds"], true);
}

/// A small arm's study with its `[design]` lines.
fn planar(design: &str) -> String {
    format!(
        "duration_s = 8.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 3.0\nerror_bound_rad = 1.5e-2\n[design]\n\
         {design}\n[loop]\nform = \"observer\"\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\nvelocity = \
         \"differenced\"\nvelocity_filter_hz = 100.0\n[world]\nsubsteps = 4\ncoulomb_extra_nm = \
         0.05\n[reference]\nkind = \"sines\"\ncenter_rad = [0.3, 0.8, 0.4]\nfade_in_s = \
         1.0\n[[reference.sine]]\namplitude_rad = 0.3\nfrequency_hz = [0.5, 0.7, \
         0.9]\n[[reference.sine]]\namplitude_rad = 0.05\nfrequency_hz = [2.1, 2.9, 3.7]\n"
    )
}

#[test]
fn knowledge_from_a_simulation_and_from_a_trace_is_named_in_the_certificate() {
    let folder = folder("knowledge");
    fs::write(folder.join("simulated.toml"), planar("phi_from = \"simulation\"")).unwrap();
    let answer = json(&folder, &["design", "simulated.toml", "--json"]);
    assert_eq!(answer["outcome"], "designed", "{answer:#}");
    // What the search reckoned with is no claim: the arm has a model, and the tube is of it.
    let certificate = &answer["gains"]["certificate"];
    assert!(certificate["joints"][0]["phi"].is_null(), "{certificate}");
    assert!(certificate["tube"].is_object(), "{}", certificate["unproved"]);
    // A record that tells the inertia of all joints: of a motion on which they couple less.
    let calm = planar("").replace("amplitude_rad = 0.3", "amplitude_rad = 0.08");
    let calm = calm.replace("amplitude_rad = 0.05", "amplitude_rad = 0.04");
    let calm = calm.replace("error_bound_rad = 1.5e-2", "error_bound_rad = 5e-2");
    fs::write(folder.join("recorded.toml"), calm).unwrap();
    let run = phihat(&folder, &["simulate", "recorded.toml"]);
    assert_eq!(run.code, 0, "{}{}", run.out, run.err);
    let lines = "phi_from = \"trace\"\ninertia_from = \"trace\"\ntrace = \"out/recorded\"";
    fs::write(folder.join("traced.toml"), planar(lines)).unwrap();
    let answer = json(&folder, &["design", "traced.toml", "--json"]);
    // The same of either kind, but for the study's and the trace's names.
    assert_eq!(phihat(&folder, &["simulate", "recorded.toml", "--out", "text", "--csv"]).code, 0);
    let text = lines.replace("out/recorded", "text/trace.csv");
    fs::write(folder.join("traced.toml"), planar(&text)).unwrap();
    let again = json(&folder, &["design", "traced.toml", "--json"]);
    assert_eq!(again["gains"]["joints"], answer["gains"]["joints"]);
    let source = |answer: &serde_json::Value| {
        answer["gains"]["certificate"]["joints"][2]["phi"]["source"].as_str().unwrap().to_owned()
    };
    assert_eq!(source(&again).replace("trace.csv", "trace.parquet"), source(&answer));
    assert_eq!(answer["outcome"], "designed", "{answer:#}");
    let certificate = &answer["gains"]["certificate"];
    assert_eq!(certificate["arm"]["basis"], "trace");
    assert!(certificate["arm"]["source"].as_str().unwrap().contains("not a proof"));
    assert_eq!(certificate["joints"][2]["phi"]["basis"], "trace");
    let missing = planar("phi_from = \"trace\"\ntrace = \"nowhere.csv\"");
    fs::write(folder.join("missing.toml"), missing).unwrap();
    let answer = phihat(&folder, &["design", "missing.toml"]);
    assert_eq!(answer.code, 2);
    assert!(answer.err.contains("nowhere.csv: cannot be read"), "{}", answer.err);
}

#[test]
fn what_is_typed_must_hold_what_the_robots_own_model_says() {
    let folder = folder("typed");
    let study = |design: &str| {
        format!(
            "duration_s = 3.0\n[robot]\nname = \"planar3r\"\nlocked = {{ joint3 = 0.5 }}\n[spec]\nerror_bound_rad = \
             0.1\n[design]\n{design}\n[sensor]\nencoder_bits = 18\n[world]\ncoulomb_extra_nm = 0.1\n[reference]\n\
             kind = \"sines\"\ncenter_rad = 0.3\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.3\n\
             phase_rad = 0.0\n"
        )
    };
    let refusal = |design: &str| {
        fs::write(folder.join("typed.toml"), study(design)).unwrap();
        let answer = phihat(&folder, &["design", "typed.toml"]);
        (answer.code, format!("{}{}", answer.out, answer.err))
    };
    let inertia =
        |low: f64, high: f64| format!("inertia_low_kg_m2 = {low}\ninertia_high_kg_m2 = {high}");
    let (code, text) = refusal(&inertia(0.5, 5.0));
    assert_eq!(code, 2, "{text}");
    for word in
        ["design.inertia_low_kg_m2 of joint joint1: 0.5 kg·m² is typed", "kg·m² (the smallest"]
    {
        assert!(text.contains(word), "{word}: {text}");
    }
    let (code, text) = refusal(&inertia(0.01, 0.3));
    assert_eq!(code, 2, "{text}");
    assert!(
        text.contains("design.inertia_high_kg_m2 of joint joint1: 0.3 kg·m² is typed"),
        "{text}"
    );
    // Each joint's own range holds, the coupled arm's does not.
    let (code, text) = refusal(&inertia(0.01, 0.85));
    assert_eq!(code, 2, "{text}");
    assert!(
        text.contains("largest eigenvalue, with its payloads, measured in the typed high ends"),
        "{text}"
    );
    let (code, text) = refusal(&inertia(0.05, 3.0));
    assert_eq!(code, 0, "{text}");
    let phi =
        |rate: f64, jump: f64| format!("phi_rate_max_nm_s = {rate}\nphi_jump_max_nm = {jump}");
    let (code, text) = refusal(&phi(100.0, 0.05));
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("design.phi_jump_max_nm of joint joint1: 0.05 N·m is typed"), "{text}");
    let (code, text) = refusal(&phi(0.5, 1.0));
    assert_eq!(code, 2, "{text}");
    assert!(
        text.contains("design.phi_rate_max_nm_s of joint joint1: 0.5 N·m/s is typed"),
        "{text}"
    );
    let (code, text) = refusal(&phi(60.0, 1.0));
    assert_eq!(code, 0, "{text}");
}

#[test]
fn behind_a_coarser_encoder_the_same_gains_keep_the_error_that_was_foretold() {
    let folder = folder("coarser");
    let tight = planar("").replace("1.5e-2", "6e-3");
    fs::write(folder.join("declared.toml"), &tight).unwrap();
    let answer = json(&folder, &["design", "declared.toml", "--json"]);
    assert_eq!(answer["outcome"], "designed", "{answer:#}");
    let file = answer["file"].as_str().unwrap();
    let coarser = answer["gains"]["coarser"].as_array().unwrap();
    assert_eq!(coarser.len(), 3);
    let declared = answer["gains"]["certificate"]["tube"]["joints"].as_array().unwrap();
    let mut finer: Vec<f64> =
        declared.iter().map(|joint| joint["error_bound_rad"].as_f64().unwrap()).collect();
    for (one, bits) in coarser.iter().zip([17, 16, 15]) {
        // The world itself, with that encoder, is no part of what foretold it.
        let study = format!("behind{bits}.toml");
        let text = tight.replace("encoder_bits = 18", &format!("encoder_bits = {bits}"));
        fs::write(folder.join(&study), text).unwrap();
        let run = json(&folder, &["simulate", &study, "--gains", file, "--uncertified", "--json"]);
        let joints = run["metrics"]["joints"].as_array().unwrap();
        let foretold = one["error_bound_rad"].as_array().unwrap();
        assert_eq!(foretold.len(), joints.len(), "{one}");
        for (i, (joint, foretold)) in joints.iter().zip(foretold).enumerate() {
            let (measured, foretold) =
                (joint["error_steady_max_rad"].as_f64().unwrap(), foretold.as_f64().unwrap());
            assert!(measured <= foretold, "{bits} bits, joint {i}: {measured} > {foretold}");
            assert!(foretold > finer[i], "{bits} bits, joint {i}: {foretold} ≤ {}", finer[i]);
            finer[i] = foretold;
        }
    }
}

#[test]
fn a_motion_beyond_the_drives_is_refused_by_design_and_run_with_a_remedy() {
    let folder = folder("overload");
    // Less than it takes to hold the arm up.
    let weak = swing(1.5).replace("[loop]", "[loop]\ntorque_max_nm = 0.5");
    assert!(weak != swing(1.5));
    fs::write(folder.join("weak.toml"), &weak).unwrap();
    for verb in ["design", "run", "simulate"] {
        let answer = phihat(&folder, &[verb, "weak.toml"]);
        assert_eq!(answer.code, 2, "{verb}: {}", answer.out);
        for part in ["N·m of joint1", "at t = ", "the drive has", "help:", "loop.beyond_drives"] {
            assert!(answer.err.contains(part), "{verb}: {part}: {}", answer.err);
        }
        assert!(!folder.join("out").exists(), "{verb}");
    }
    let failure = json(&folder, &["design", "weak.toml", "--json"]);
    assert_eq!(failure["exit_code"], 2);
    let meant = weak.replace("[loop]", "[loop]\nbeyond_drives = \"allow\"");
    fs::write(folder.join("meant.toml"), meant).unwrap();
    let answer = phihat(&folder, &["design", "meant.toml"]);
    assert!(!answer.err.contains("beyond_drives"), "{}", answer.err);
}

/// The bounds of a safe stop are reported where there is a supervisor, and only there.
#[test]
fn a_design_says_what_a_stop_does() {
    let folder = folder("design-stop");
    fs::write(folder.join("plain.toml"), swing(1.5)).unwrap();
    fs::write(folder.join("watched.toml"), format!("{}[supervisor]\n", swing(1.5))).unwrap();
    let [plain, watched] = ["plain.toml", "watched.toml"].map(|study| {
        let answer = phihat(&folder, &["design", study]);
        // A supervisor leaves no tube: designed, not proved.
        assert_eq!(answer.code, if study == "plain.toml" { 0 } else { 3 }, "{}", answer.err);
        answer.out
    });
    assert!(!plain.contains("a safe stop"), "{plain}");
    assert!(
        watched.contains("a safe stop from so fast") && watched.contains("rests after"),
        "{watched}"
    );
}
