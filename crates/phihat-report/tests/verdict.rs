//! Wrong if a figure of the record were missing, in a wrong unit or beside a wrong bound, or if
//! the verdict were kinder than the figures.

use phihat_sim::Metrics;
use scraper::{Html, Selector};

use crate::support::{Fixture, fixture};

fn texts(html: &str, selector: &str) -> Vec<String> {
    let document = Html::parse_document(html);
    let found = Selector::parse(selector).unwrap();
    let joined = |node: scraper::ElementRef<'_>| {
        node.text().collect::<Vec<_>>().join(" ").split_whitespace().collect::<Vec<_>>().join(" ")
    };
    document.select(&found).map(joined).collect()
}

fn verdict_of(fixture: &Fixture) -> String {
    texts(&phihat_report::page(&fixture.record()), ".verdict").join("|")
}

/// A joint with a different number in every field.
fn numbered() -> Fixture {
    let mut fixture = fixture(1, 2_000);
    let joint = &mut fixture.metrics.joints[0];
    joint.error_rms_rad = 0.001_1;
    joint.error_peak_rad = 0.022;
    joint.error_steady_max_rad = 0.003_3;
    joint.error_bound_rad = Some(0.004_4);
    joint.error_integral_steady_max_rad_s = 0.000_55;
    joint.error_integral_bound_rad_s = Some(0.000_66);
    joint.velocity_error_steady_max_rad_s = 0.077;
    joint.velocity_error_bound_rad_s = Some(0.088);
    joint.tau_max_nm = 9.9;
    joint.tau_limit_nm = Some(12.5);
    joint.tau_step_max_nm = 0.13;
    joint.tau_step_limit_nm = Some(0.26);
    joint.saturated_samples = 14;
    joint.rate_limited_samples = 150;
    joint.limited_steady_share = 0.035;
    joint.phi_max_nm = 16.25;
    joint.phi_error_steady_max_nm = 0.175;
    fixture.metrics.within_spec = true;
    fixture
}

#[test]
fn every_metric_stands_in_the_table_in_its_unit() {
    let html = phihat_report::page(&numbered().record());
    let (cells, heads) = (texts(&html, ".scroll tbody tr"), texts(&html, ".scroll thead tr"));
    assert_eq!(
        cells[0],
        "joint1 3.300 bound 4.4: within, 75 % 0.5500 bound 0.66: within, 83 % \
         77.00 bound 88: within, 88 % 1.100 22.00"
    );
    assert_eq!(
        cells[1],
        "joint1 9.900 limit 12.5: 79 % used 0.1300 limit 0.26: 50 % used \
         14 0.70 % of the run 150 7.5 % of the run 3.5 16.25 0.1750"
    );
    assert_eq!(heads[0].matches("[mrad]").count(), 3);
    assert!(heads[0].contains("[mrad·s]") && heads[0].contains("[mrad/s]"));
    assert_eq!(heads[1].matches("[N·m]").count(), 3);
    assert_eq!(heads[1].matches("[samples]").count(), 2);
    assert_eq!(texts(&html, ".scroll tbody tr")[2], "joint1 0.5 100 14 2 400 40");
}

#[test]
fn a_run_within_its_bounds_names_the_nearest_one() {
    assert_eq!(
        verdict_of(&numbered()),
        "Within spec. Nearest to a bound: |ė| of joint1 uses 88 % of its bound."
    );
}

#[test]
fn a_broken_bound_is_named_with_its_excess_whatever_the_record_claims() {
    let mut fixture = fixture(7, 2_000);
    fixture.metrics.joints[2].error_steady_max_rad = 0.002_4;
    fixture.metrics.joints[4].velocity_error_steady_max_rad_s = 0.875;
    fixture.metrics.within_spec = true;
    let verdict = verdict_of(&fixture);
    assert!(verdict.starts_with("Outside spec on 2 of 7 joints:"), "{verdict}");
    assert!(verdict.contains("joint3: |e| 2.400 mrad, bound 2 (20 % over)"), "{verdict}");
    assert!(
        verdict.contains("joint5: |ė| 875.0 mrad/s, bound 250 (3.5 times the bound)"),
        "{verdict}"
    );
    let outside = texts(&phihat_report::page(&fixture.record()), "td.outside");
    assert_eq!(outside.len(), 2);
    assert!(outside.iter().all(|cell| cell.contains("OUTSIDE")), "{outside:?}");
}

#[test]
fn limits_that_acted_are_told_on_top_though_the_spec_holds() {
    let mut fixture = fixture(7, 2_000);
    for joint in &mut fixture.metrics.joints {
        joint.error_steady_max_rad = 1e-3;
        joint.velocity_error_steady_max_rad_s = 0.1;
    }
    fixture.metrics.within_spec = true;
    assert!(verdict_of(&fixture).starts_with("Within spec on all 7 joints. Nearest"));
    fixture.metrics.joints[1].rate_limited_steady_samples = 300;
    assert_eq!(
        verdict_of(&fixture),
        "Within spec on all 7 joints, but the torque-rate limit acted in 30 % of the samples of joint2 (4.3 % of \
         all) after t = 1 s: no certificate speaks of that. Nearest to a bound: |e| of joint1 uses 50 % of its bound."
    );
    fixture.metrics.joints[0].saturated_steady_samples = 1;
    let both = verdict_of(&fixture);
    assert!(
        both.contains("but the torque limit acted in 0.10 % of the samples of joint1"),
        "{both}"
    );
    assert!(both.contains(", and the torque-rate limit acted in 30 % of"), "{both}");
    // Every joint, the worst three by name.
    fixture.metrics.joints.iter_mut().for_each(|joint| joint.rate_limited_steady_samples += 1);
    let all = verdict_of(&fixture);
    assert!(
        all.contains("30 % of the samples of joint2") && all.contains("4 more joints"),
        "{all}"
    );
}

#[test]
fn what_is_not_a_number_is_outside() {
    let mut fixture = fixture(2, 2_000);
    fixture.metrics.joints[1].error_steady_max_rad = f64::NAN;
    assert!(verdict_of(&fixture).contains("joint2: |e| not finite, bound 2 (over)"));
}

#[test]
fn no_verdict_without_bounds_or_samples() {
    let mut fixture = fixture(2, 2_000);
    for joint in &mut fixture.metrics.joints {
        joint.error_bound_rad = None;
        joint.velocity_error_bound_rad_s = None;
    }
    assert!(verdict_of(&fixture).starts_with("No verdict. The study states no bound"));
    fixture.metrics = Metrics { samples: 0, joints: vec![], within_spec: true, ..fixture.metrics };
    assert!(verdict_of(&fixture).starts_with("No verdict. Nothing was recorded"));
}

#[test]
fn a_record_that_contradicts_itself_is_not_within() {
    let mut fixture = numbered();
    fixture.metrics.within_spec = false;
    assert!(verdict_of(&fixture).starts_with("Outside spec, says the record"));
}

#[test]
fn gains_of_another_study_are_warned_of() {
    let mut fixture = fixture(1, 100);
    fixture.gains.study_sha256 = "f".repeat(64);
    let warnings = texts(&phihat_report::page(&fixture.record()), ".warnings li");
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("another study text"));
}
