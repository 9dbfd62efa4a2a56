//! No edit of a gains file passes its check and claims more, or speaks of something else. Edits of
//! a real document that mean something.
//! Wrong if an edit below passed although it says more than the file did, or if the file itself were refused.

use std::path::Path;

use phihat_certificate::{Gains, Refutation};
use phihat_design::{Arm, Outcome, design};
use phihat_sim::Demand;
use phihat_study::{InertiaSource, Study};
use phihat_synthesis::phi_along;
use serde_json::{Value, json};

fn study() -> Study {
    let text = "duration_s = 4.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 2.0\nerror_bound_rad = 2e-3\n\
         [design]\npayload_max_kg = 0.3\norders = [1]\n[loop]\ndelay_samples = 1\n[sensor]\nencoder_bits = 18\n\
         velocity = \"differenced\"\nvelocity_filter_hz = 100.0\n[world]\ncoulomb_extra_nm = 0.1\n\
         substeps = 4\npayload = { mass_kg = 0.3 }\n[reference]\nkind = \"sines\"\n\
         center_rad = [0.3, 0.8, 0.4]\nfade_in_s = 1.0\n[[reference.sine]]\namplitude_rad = 0.2\n\
         frequency_hz = 0.2\nphase_rad = 0.7\n";
    Study::from_text(text, "arm.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

fn gains(study: &Study) -> Gains {
    let demand = Demand::along(study).unwrap();
    let phi = |joint, inertia| phi_along(&demand, joint, inertia);
    match design(study, &Arm::of(study).unwrap(), &phi).unwrap() {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("{no:?}"),
    }
}

/// Reads and checks a document as a user would.
fn check(document: &Value) -> Result<(), String> {
    let gains = Gains::from_json(&document.to_string()).map_err(|e| e.to_string())?;
    let certificate = gains.certificate.as_ref().ok_or("no certificate")?;
    certificate.verified(&gains).map(|_| ()).map_err(|e: Refutation| e.to_string())
}

/// An edit with a meaning.
type Forge = (&'static str, fn(&mut Value));

#[test]
#[allow(clippy::too_many_lines, reason = "a list of cases")]
fn no_edit_that_means_something_passes() {
    let coupled: Value = serde_json::to_value(gains(&study())).unwrap();
    let mut alone = study();
    let (low, high) = (vec![0.3, 0.15, 0.1], vec![0.6, 0.3, 0.2]);
    alone.design.inertia = InertiaSource::Typed { low, high };
    let alone: Value = serde_json::to_value(gains(&alone)).unwrap();
    let cases: [Forge; 31] = [
        ("another rate", |d| d["rate_hz"] = json!(100.0)),
        ("another period", |d| each(d, |j| j["model"]["period_s"] = json!(0.01))),
        ("another delay", |d| each(d, |j| j["model"]["delay_samples"] = json!(0))),
        ("later samples", |d| each(d, |j| j["model"]["sample_delay_samples"] = json!(2))),
        ("another filter", |d| each(d, |j| j["model"]["velocity_filter_hz"] = json!(20.0))),
        ("another velocity", |d| each(d, |j| j["model"]["velocity"] = json!("measured"))),
        ("another form", |d| each(d, |j| j["model"]["form"] = json!("literal"))),
        ("a drive", |d| each(d, |j| j["model"]["drive_bandwidth_hz"] = json!(15.0))),
        ("a drive on one joint", |d| {
            d["certificate"]["joints"][1]["model"]["drive_bandwidth_hz"] = json!(500.0);
        }),
        ("lighter", |d| scale(d, "inertia_kg_m2", 0.05)),
        ("heavier", |d| scale(d, "inertia_kg_m2", 20.0)),
        ("another K_p", |d| scale(d, "kp_per_s2", 1.2)),
        ("another K_d", |d| scale(d, "kd_per_s", 0.8)),
        ("another estimator", |d| {
            for joint in d["joints"].as_array_mut().unwrap() {
                let a = joint["a"][0].as_f64().unwrap();
                joint["a"][0] = json!(1.3 * a);
            }
        }),
        ("a higher order", |d| {
            for joint in d["joints"].as_array_mut().unwrap() {
                joint["a"].as_array_mut().unwrap().push(json!(60.0));
            }
        }),
        ("no joints", |d| {
            d["joints"] = json!([]);
            d["certificate"]["joints"] = json!([]);
            d["certificate"]["arm"]["nominal_kg_m2"] = json!([]);
        }),
        ("a joint less", |d| drop(d["joints"].as_array_mut().unwrap().pop())),
        ("a joint's claims less", |d| {
            drop(d["certificate"]["joints"].as_array_mut().unwrap().pop());
        }),
        ("a joint twice", |d| {
            for list in [&mut d["joints"], &mut Value::Null] {
                if let Some(list) = list.as_array_mut() {
                    let first = list[0].clone();
                    list.push(first);
                }
            }
            let claims = d["certificate"]["joints"].as_array_mut().unwrap();
            let first = claims[0].clone();
            claims.push(first);
            let nominal = d["certificate"]["arm"]["nominal_kg_m2"].as_array_mut().unwrap();
            let first = nominal[0].clone();
            nominal.push(first);
        }),
        ("another name", |d| d["joints"][0]["name"] = json!("elbow")),
        ("joints swapped", |d| d["joints"].as_array_mut().unwrap().swap(0, 1)),
        ("a wider arm", |d| d["certificate"]["arm"]["high"] = json!(1e3)),
        ("a narrower arm", |d| {
            let high = d["certificate"]["arm"]["high"].as_f64().unwrap();
            d["certificate"]["arm"]["high"] = json!(0.7 * high);
        }),
        ("ends swapped", |d| {
            let arm = d["certificate"]["arm"].clone();
            d["certificate"]["arm"]["low"] = arm["high"].clone();
            d["certificate"]["arm"]["high"] = arm["low"].clone();
        }),
        ("another M̄ of the arm", |d| d["certificate"]["arm"]["nominal_kg_m2"][0] = json!(9.0)),
        ("a margin below 1", |d| d["certificate"]["window_margin"] = json!(0.5)),
        ("fewer ratios", |d| {
            each(d, |j| drop(j["sampled"]["mu"].as_array_mut().unwrap().remove(4)));
        }),
        ("one ratio", |d| each(d, |j| j["noise"]["mu"] = json!([1.0]))),
        ("no reading error", |d| each(d, |j| j["reading"] = Value::Null)),
        ("no margins", |d| each(d, |j| j["margins"] = Value::Null)),
        ("version 1", |d| d["version"] = json!(1)),
    ];
    for (what, forge) in cases {
        // A nominal inertia that is smaller everywhere is on trust, but for the bounds of joints that have their own.
        let document = if what == "lighter" { &alone } else { &coupled };
        let mut forged = document.clone();
        forge(&mut forged);
        assert_ne!(&forged, document, "{what}: the edit changes nothing");
        let why = check(&forged).err();
        println!("{what}: {}", why.clone().unwrap_or_default());
        assert!(why.is_some(), "{what} passes");
    }
}

fn each(document: &mut Value, forge: impl Fn(&mut Value)) {
    document["certificate"]["joints"].as_array_mut().unwrap().iter_mut().for_each(forge);
}

fn scale(document: &mut Value, key: &str, factor: f64) {
    for joint in document["joints"].as_array_mut().unwrap() {
        let own = joint[key].as_f64().unwrap();
        joint[key] = json!(own * factor);
    }
    if key == "inertia_kg_m2" {
        for m in document["certificate"]["arm"]["nominal_kg_m2"].as_array_mut().unwrap() {
            *m = json!(m.as_f64().unwrap() * factor);
        }
    }
}
