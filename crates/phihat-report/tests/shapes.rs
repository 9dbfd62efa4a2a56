//! Wrong if a record of an odd shape (empty, one sample, one or many joints, diverged, ragged)
//! broke the page, its data or its figures, or if a peak of the trace were missing from the page.

use phihat_report::{figures, page};
use roxmltree::Document;
use scraper::{Html, Selector};
use serde_json::Value;

use crate::support::{Fixture, fixture};

fn data(fixture: &Fixture) -> Value {
    let document = Html::parse_document(&page(&fixture.record()));
    let node = document.select(&Selector::parse("script#record").unwrap()).next().unwrap();
    serde_json::from_str(&node.text().collect::<String>()).unwrap()
}

/// Every figure is XML; the words in it.
fn words(fixture: &Fixture) -> Vec<(String, String)> {
    let text = |svg: &str| -> String {
        let document = Document::parse(svg).unwrap();
        document
            .descendants()
            .filter(|n| {
                n.is_text() && n.parent_element().is_some_and(|p| p.tag_name().name() == "text")
            })
            .filter_map(|n| n.text())
            .collect::<Vec<_>>()
            .join(" ")
    };
    figures(&fixture.record()).iter().map(|f| (f.name.clone(), text(&f.svg))).collect()
}

#[test]
fn figures_carry_titles_units_and_joints() {
    let expected = [
        ("arm", "error e of every joint"),
        ("tracking", "position [rad]"),
        ("error", "error e [mrad]"),
        ("error-steady", "error e [mrad]"),
        ("velocity-error", "ė [mrad/s]"),
        ("torque", "torque τ [N·m]"),
        ("unknown-dynamics", "φ, φ̂ [N·m]"),
        ("estimate-error", "φ − φ̂ [N·m]"),
        ("phase", "ė [mrad/s]"),
        ("torque-step", "Δτ [N·m/sample]"),
    ];
    let found = words(&fixture(3, 2_000));
    assert_eq!(found.len(), expected.len());
    for ((name, text), (stem, label)) in found.iter().zip(expected) {
        assert_eq!(name, stem);
        assert!(text.contains(label), "{name}: no {label}");
        if stem == "arm" {
            continue;
        }
        let x = if stem == "phase" { "error e [mrad]" } else { "time t [s]" };
        assert_eq!(text.matches(x).count(), 3, "{name}: {x} on every panel");
        assert!(["joint1", "joint2", "joint3"].iter().all(|j| text.contains(j)), "{name}");
    }
}

#[test]
fn a_limit_off_the_axis_is_told_in_words() {
    let mut fixture = fixture(1, 2_000);
    fixture.metrics.joints[0].tau_limit_nm = Some(870.0);
    let torque = words(&fixture).into_iter().find(|(name, _)| name == "torque").unwrap();
    assert!(torque.1.contains("off the axis: limit ±870.0"), "{}", torque.1);
}

#[test]
fn empty_and_single_sample_traces_and_many_joints_work() {
    for (joints, samples) in [(0, 0), (1, 0), (3, 0), (1, 1), (16, 1), (16, 1_500), (40, 20)] {
        let fixture = fixture(joints, samples);
        let data = data(&fixture);
        assert_eq!(data["joints"].as_array().unwrap().len(), joints);
        for chart in data["charts"].as_array().unwrap() {
            assert_eq!(chart["panels"].as_array().unwrap().len(), joints);
        }
        assert!(words(&fixture).len() >= 6, "{joints} joints, {samples} samples");
    }
}

#[test]
fn a_diverged_run_leaves_gaps_and_a_warning() {
    let mut fixture = fixture(2, 3_000);
    let joint = &mut fixture.trace.joints[1];
    for k in 1_500..3_000 {
        joint.q[k] = f64::NAN;
        joint.e[k] = f64::INFINITY;
        joint.tau_applied[k] = -1e300;
    }
    joint.phi = vec![f64::NAN; 3_000];
    let html = page(&fixture.record());
    assert!(html.contains("are not finite or beyond 1e12"), "no warning");
    let data = data(&fixture);
    let lengths = |label: &str| data["signals"][1][label][0].as_str().unwrap().len();
    assert!(lengths("e") > 0 && lengths("φ") < 1_200, "gaps take next to nothing");
    assert!(words(&fixture).iter().all(|(_, text)| !text.contains("could not")));
}

#[test]
fn a_ragged_trace_does_not_break_the_page() {
    let mut fixture = fixture(2, 500);
    fixture.trace.joints[0].phi_hat.truncate(100);
    fixture.trace.joints[1].q.clear();
    fixture.metrics.joints.truncate(1);
    fixture.metrics.settle_s = f64::NAN;
    assert_eq!(data(&fixture)["joints"].as_array().unwrap().len(), 2);
    assert!(words(&fixture).len() >= 6);
}

#[test]
fn extreme_but_finite_numbers_find_axes() {
    for value in [0.0, 1e-300, -1e-300, 1e-9, 9e11, 1e300, -1e300] {
        let mut fixture = fixture(1, 50);
        for k in 0..50 {
            fixture.trace.joints[0].e[k] = value;
            fixture.trace.joints[0].tau_applied[k] = if k % 2 == 0 { value } else { -value };
        }
        assert!(words(&fixture).iter().all(|(_, text)| !text.contains("could not")), "{value}");
    }
}

#[test]
fn every_sample_of_every_signal_stands_in_the_page_or_the_extremes_of_each_few() {
    let short = data(&fixture(1, 10_000));
    assert_eq!((&short["each"], &short["samples"]), (&1.into(), &10_000.into()));
    assert_eq!(short["times"], serde_json::json!([[0, 0, 1_000_000]]));
    let signals = short["signals"][0].as_object().unwrap();
    let shown =
        short["charts"].as_array().unwrap().iter().flat_map(|c| c["curves"].as_array().unwrap());
    assert!(shown.clone().count() > 8);
    for curve in shown {
        let parts = signals[curve["label"].as_str().unwrap()].as_array().unwrap();
        assert_eq!(parts.len(), 1);
    }
    let long = data(&fixture(1, 150_000));
    assert!(long["each"].as_u64().unwrap() > 1);
    assert_eq!(long["signals"][0]["e"].as_array().unwrap().len(), 2);
}
