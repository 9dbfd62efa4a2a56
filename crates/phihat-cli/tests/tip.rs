//! The tip in millimetres, from the specification to the run. Wrong if a run took the tip further off than
//! its tube says, if the measured error were not the distance between the two tips, or if a specification in
//! millimetres were not satisfied or not reported.

use std::fs;

use crate::support::{folder, json, phihat};

/// The planar arm on a motion, with this under `[spec]`.
fn study(spec: &str) -> String {
    format!(
        "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.0\n{spec}\n[design]\norders = \
         [1]\npayload_max_kg = 0.2\n[loop]\nform = \"observer\"\ndelay_samples = 1\n[sensor]\nencoder_bits = \
         18\nvelocity = \"differenced\"\n[reference]\nkind = \"sines\"\ncenter = \"ready\"\nfade_in_s = \
         0.5\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.5\n"
    )
}

#[test]
fn a_tip_is_specified_designed_for_and_measured_in_millimetres() {
    let folder = folder("tip");
    fs::write(folder.join("arm.toml"), study("tip_error_bound_mm = 8.0")).unwrap();
    let told = json(&folder, &["design", "arm.toml", "--json"]);
    assert_eq!(told["outcome"], "designed", "{told:#}");
    let tube = &told["gains"]["certificate"]["tube"];
    let bound = tube["tip"]["error_bound_m"].as_f64().unwrap();
    assert!(bound > 1e-4 && bound <= 8e-3, "{bound}");
    let file = told["file"].as_str().unwrap();
    let verified = json(&folder, &["verify", file, "--study", "arm.toml", "--json"]);
    assert_eq!(verified["holds"], true, "{verified:#}");
    let run = json(&folder, &["run", "arm.toml", "--gains", file, "--json"]);
    let tip = &run["metrics"]["tip"];
    let measured = tip["error_steady_max_m"].as_f64().unwrap();
    assert!(measured > 1e-5 && measured <= bound, "{measured} {bound}");
    assert!((tip["error_bound_m"].as_f64().unwrap() - 8e-3).abs() < 1e-12);
    let turned = tip["angle_steady_max_rad"].as_f64().unwrap();
    assert!(turned > 0.0 && turned <= tube["tip"]["angle_max_rad"].as_f64().unwrap());
    // All axes of a planar arm are parallel: the tip turns by the sum of the joints' errors.
    let (_, trace) = phihat_session::recorded(&folder.join("out/arm")).unwrap();
    let sum = |k: usize| trace.joints.iter().map(|joint| joint.e[k]).sum::<f64>().abs();
    let most = (trace.index_at(1.0)..trace.len()).map(sum).fold(0.0, f64::max);
    assert!((turned - most).abs() < 1e-6 * most + 1e-12, "{turned} {most}");
    // For people.
    let plain = phihat(&folder, &["run", "arm.toml", "--gains", file]);
    assert_eq!(plain.code, 0, "{}", plain.err);
    assert!(plain.out.contains(" mm and ") && plain.out.contains("8 allowed"), "{}", plain.out);
    let page = fs::read_to_string(folder.join("out/arm/report.html")).unwrap();
    assert!(page.contains("The tip (") && page.contains("the study allows 8.000 mm"));
    // What is not kept is out of spec although no joint has a bound.
    fs::write(folder.join("strict.toml"), study("tip_error_bound_mm = 0.001")).unwrap();
    let strict = phihat(&folder, &["run", "strict.toml", "--gains", file]);
    assert_eq!(strict.code, 1, "{}", strict.err);
    assert!(strict.out.contains("OUT OF SPEC on the tip"), "{}", strict.out);
    // A document without a claim about the tip is read as before.
    let mut old = told["gains"].clone();
    old["certificate"]["tube"].as_object_mut().unwrap().remove("tip");
    fs::write(folder.join("old.json"), old.to_string()).unwrap();
    assert_eq!(json(&folder, &["verify", "old.json", "--json"])["holds"], true);
    // A shorter lever is refused.
    let mut forged = told["gains"].clone();
    let most = &mut forged["certificate"]["tube"]["tip"]["error_bound_m"];
    *most = serde_json::json!(0.9 * bound);
    fs::write(folder.join("forged.json"), forged.to_string()).unwrap();
    assert_eq!(phihat(&folder, &["verify", "forged.json"]).code, 1);
}
