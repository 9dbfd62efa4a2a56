//! The page: verdict, figures per joint, plots, and everything needed to doubt them.

use crate::bound_words::stop_in_words;
use crate::certificate::certificate;
use crate::figure::run_figures;
use crate::kind::DRAWABLE_MAX;
use crate::kit::number::{number, stated};
use crate::kit::text::line;
use crate::kit::{MILLI, document};
use crate::payload::payload;
use crate::policy::{PAGE_SCRIPT, PLOT_SCRIPT, content_policy, style};
use crate::record::Record;
use crate::scope::not_claimed;
use crate::standing::{every_joint, standing};
use crate::supervision::supervision;
use crate::verdict::{SpecVerdict, verdict};
use crate::{sections, stage, table};
use maud::{Markup, PreEscaped, html};

/// The self-contained page of a record.
///
/// # Example
///
/// ```
/// # use phihat_report::{Drawing, Record, RunInfo};
/// # use phihat_sim::{Metrics, Simulation};
/// # use phihat_study::Study;
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_bound_rad = 2e-3
/// #     [gains]
/// #     order = 1
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// # let gains = phihat_design::requested_gains(&study).ok_or("no gains")?;
/// # let names = study.robot.joint_names();
/// # let law = gains.joint_gains(&names, study.control.period_ns, Default::default())?;
/// # let trace = Simulation::new(&study, &law)?.run(|_| ()).trace;
/// # let metrics = Metrics::of(&trace, &study);
/// # let origin = RunInfo {
/// #     study: study.name.clone(), title: study.title.clone(), study_sha256: study.sha256.clone(),
/// #     seed: study.seed, robot: study.robot.name.clone(),
/// #     robot_description: study.robot.description.clone(),
/// #     robot_provenance: study.robot.provenance.clone(), phihat_version: String::new(),
/// #     toolchain: String::new(), form: "observer".to_owned(), rate_hz: 1000.0, delay_samples: 0,
/// #     world: Vec::new(), command: String::new(), warnings: Vec::new(), bound: None, contact: None,
/// # };
/// // A study, its gains, and what a run of them left: trace, metrics, and where it came from.
/// let drawing = Drawing::of(&trace, study.spec.settle);
/// let record = Record {
///     run: &origin,
///     study_text: &study.text,
///     gains: Some(&gains),
///     drawing: &drawing,
///     metrics: &metrics,
///     tube: None,
/// };
/// let html = phihat_report::page(&record);
/// assert!(html.starts_with("<!DOCTYPE html>"));
/// assert!(!html.contains("src=\"http")); // nothing is loaded
/// assert!(phihat_report::figures(&record).iter().any(|figure| figure.svg.starts_with("<svg")));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn page(record: &Record<'_>) -> String {
    let body = html! {
        main.run {
            (heading(record))
            (standing(record))
            div.measured-verdict {
                @if let Some(stopped) = stop_in_words(record.metrics, record.run) { p.verdict.outside { strong {
                    (stopped) } "." } }
                (verdict_box(&verdict(record.metrics, record.tube)))
            }
            (warnings(record))
            (contents(record))
            (stage::stage(record))
            (plots(record))
            h2 id="figures" { "Every joint" }
            (every_joint(record))
            (tip(record))
            (table::tracking(record.metrics))
            details.tables {
                summary { "torque and estimate of every joint, against the limits in force" }
                (table::torque_table(record.metrics, record.run.knows_phi()))
            }
            (supervision(&record.drawing.course))
            (certificate(record))
            @if let Some(gains) = record.gains { (sections::gains(gains)) }
            (sections::world(record))
            (sections::study(record))
            (sections::origin(record))
            (not_claimed(record))
        }
        script type="application/json" id="record" { (PreEscaped(payload(record))) }
        script { (PreEscaped(PLOT_SCRIPT)) }
        script { (PreEscaped(PAGE_SCRIPT)) }
    };
    document(&line(&record.run.study), &content_policy(), &style(), &body)
}

fn heading(record: &Record<'_>) -> Markup {
    let run = record.run;
    let joints = record.metrics.joints.len();
    html! {
        header {
            h1 { (line(&run.title)) }
            p.byline {
                "study " strong { (line(&run.study)) } " · " (line(&run.robot)) ", " (joints)
                @if joints == 1 { " joint" } @else { " joints" }
                " · " @if record.gains.is_some() { (line(&run.form)) " form" } @else { "another \
                    controller" } " at " (stated(run.rate_hz)) " Hz · seed " (run.seed)
                @if let Some(driven) = run.driven() { " · driven: " (line(driven)) } @else { " · simulated" }
            }
        }
    }
}

/// Links to the sections.
fn contents(record: &Record<'_>) -> Markup {
    let certified = record.gains.is_some_and(|gains| gains.certificate.is_some());
    let drawn = record.drawing.arm.is_some();
    let sections = [
        (drawn, "arm", "the arm"),
        (true, "plots", "plots"),
        (true, "figures", "every joint"),
        (certified, "certificate", "certificate"),
        (record.gains.is_some(), "gains", "gains"),
        (true, "world", "loop and world"),
        (true, "origin", "make it again"),
        (true, "limits", "what is not claimed"),
    ];
    html! { nav.contents aria-label="contents" {
        @for (_, id, words) in sections.into_iter().filter(|(there, ..)| *there) { a href=(format!("#{id}")) { (words)
            } }
    } }
}

/// Error of the tip in millimetres, alongside its bound and its tube.
fn tip(record: &Record<'_>) -> Markup {
    let Some(tip) = &record.metrics.tip else { return html! {} };
    let tube =
        record.gains.and_then(|gains| gains.certificate.as_ref()).and_then(|all| all.tube.as_ref());
    let tube = tube.filter(|_| record.tube.is_some()).and_then(|tube| tube.tip.as_ref());
    let mm = |metres: f64| number(metres * MILLI);
    html! { p {
        "The tip (" (line(&tip.frame)) ") was at most " (mm(tip.error_steady_max_m)) " mm and "
        (number(tip.angle_steady_max_rad.to_degrees())) "° off in the steady part, " (mm(tip.error_peak_m)) " mm in \
            the whole run"
        @if let Some(bound) = tip.error_bound_m { "; the study allows " (mm(bound)) " mm" }
        @if let Some(tube) = tube {
            "; by its tube at most " (mm(tube.error_bound_m)) " mm and " (number(tube.angle_max_rad.to_degrees())) "°"
        }
        "."
    } }
}

fn verdict_box(verdict: &SpecVerdict) -> Markup {
    html! { @match verdict {
        SpecVerdict::NoSamples => p.verdict.unknown { strong { "No verdict." } " Nothing was recorded." },
        SpecVerdict::NothingStated => p.verdict.unknown {
            strong { "No verdict." } " The study states no bound, so there is nothing to hold."
        },
        SpecVerdict::Contradiction => p.verdict.outside {
            strong { "Outside spec," } " says the record, though every figure below is within its bound."
        },
        SpecVerdict::Within { joints: 1, closest } => p.verdict.within {
            strong { "Within spec." } " Nearest to a bound: " (closest) "."
        },
        SpecVerdict::Within { joints, closest } => p.verdict.within {
            strong { "Within spec on all " (joints) " joints." } " Nearest to a bound: " (closest) "."
        },
        SpecVerdict::Limited { joints, closest, limited } => div.verdict.limited {
            p {
                strong { "Within spec" @if *joints > 1 { " on all " (joints) " joints" } ", but " } (limited)
                "."
            }
            p { "Nearest to a bound: " (closest) "." }
        },
        SpecVerdict::Broken { sentence } => p.verdict.outside {
            strong { "Outside its tube:" } " " (sentence) "."
        },
        SpecVerdict::NotFollowed { untracked, steady } => p.verdict.outside {
            strong { "Not followed:" } " in " (untracked) " of " (steady) " samples of the steady part the supervisor \
                did not let the arm follow its motion."
        },
        SpecVerdict::Outside { joints, broken } => div.verdict.outside {
            p { strong { "Outside spec on " (broken.len()) " of " (joints)
                @if *joints == 1 { " joint:" } @else { " joints:" } } }
            ul { @for phrase in broken { li { (phrase) } } }
        },
    } }
}

/// The run's own warnings, and what the record itself gives reason to doubt.
fn warnings(record: &Record<'_>) -> Markup {
    let mut warnings: Vec<String> = record.run.warnings.iter().map(|w| line(w)).collect();
    if record.gains.is_some_and(|gains| gains.study_sha256 != record.run.study_sha256) {
        warnings.push("The gains were made from another study text: their hashes differ.".into());
    }
    let gaps = record.drawing.undrawable;
    if gaps > 0 {
        warnings.push(format!(
            "{gaps} recorded values are not finite or beyond {DRAWABLE_MAX:e}: drawn as gaps."
        ));
    }
    html! { @if !warnings.is_empty() {
        section.warnings aria-labelledby="warnings" {
            h2 id="warnings" { "Warnings" }
            ul { @for warning in &warnings { li { (warning) } } }
        }
    } }
}

fn plots(record: &Record<'_>) -> Markup {
    let crate::Drawing { samples, each, .. } = record.drawing;
    html! {
        h2 id="plots" { "Plots" }
        section.interactive hidden aria-labelledby="plots" {
            form.controls {
                label { "joint " select id="joint" {} }
                fieldset {
                    legend { "time" }
                    button type="button" data-range="start" { "start-up" }
                    button type="button" data-range="steady" { "steady" }
                    button type="button" data-range="all" aria-pressed="true" { "all" }
                }
                label { input type="checkbox" id="bounds" checked; " bounds in view" }
                label { input type="checkbox" id="limits"; " limits in view" }
                button type="button" id="csv" { "CSV of this time" }
            }
            p.hint {
                "Drag to zoom, on a touch screen sideways; double-click or double-tap to see everything again. The \
                    cursor is one instant "
                "of all plots, of the phase plane and of the arm above."
            }
            div id="strip" role="group" aria-label="error of every joint; a joint that is picked is drawn below" {}
            div id="cards" {}
        }
        section.static aria-labelledby="plots" {
            @for figure in run_figures(&record.measured()) { figure { (PreEscaped(&figure.svg)) } }
        }
        p.hint {
            "The plots hold "
            @if *each == 1 { "every one of the " (samples) " samples" }
            @else { "the least and the largest of each " (each) " of the " (samples) " samples" }
            " of each signal, to five digits of what is largest near it: at every zoom the extremes that they show are \
                those of the run. "
            "Torques and what is computed once per sample are drawn as steps. Figures and verdict come from all \
                samples."
        }
    }
}
