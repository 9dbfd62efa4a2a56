//! Sections below the plots: gains, loop and world, study, origin, limits of the claim.

use crate::kit::number::stated;
use crate::kit::text::{line, visible};
use crate::poles::section_poles;
use crate::record::Record;
use maud::{Markup, html};
use phihat_design::{Gains, JointRecord, PositionObserver};

/// The gains that ran.
pub(crate) fn gains(gains: &Gains) -> Markup {
    let order = gains.joints.iter().map(|j| j.a.len()).max().unwrap_or(0);
    let seen = gains.joints.iter().filter_map(|j| Some((j, j.observer.as_ref()?)));
    let seen: Vec<_> = seen.collect();
    html! {
        h2 id="gains" { "Gains" }
        p { "How they were found: " (line(&gains.method)) }
        @if !seen.is_empty() { (observers(&seen)) (filters(&seen, gains.rate_hz)) } @else {
        div.scroll tabindex="0" role="region" aria-label="Table: gains per joint" {
            table {
                caption { span { "Law: τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂, estimator of order m" } }
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "M̄ " span.unit { "[kg·m²]" } }
                    th scope="col" { "K_p " span.unit { "[1/s²]" } }
                    th scope="col" { "K_d " span.unit { "[1/s]" } }
                    th scope="col" { "m" }
                    @for i in 0..order { th scope="col" { "a_" (i) " " (unit_of_coefficient(i, &gains.joints)) } }
                } }
                tbody { @for joint in &gains.joints { tr {
                    th scope="row" { (line(&joint.name)) }
                    td { (stated(joint.inertia_kg_m2)) }
                    td { (stated(joint.kp_per_s2)) }
                    td { (stated(joint.kd_per_s)) }
                    td { (joint.a.len()) }
                    @for i in 0..order { td { (joint.a.get(i).map_or("–".to_owned(), |a| stated(*a))) } }
                } } }
            }
        }
        }
    }
}

/// The unit of the `i`-th coefficient, where all joints have one order; else with the order's letter.
fn unit_of_coefficient(i: usize, joints: &[JointRecord]) -> Markup {
    let order = joints.first().map_or(0, |joint| joint.a.len());
    if joints.iter().all(|joint| joint.a.len() == order) {
        return unit_of_order(order.saturating_sub(i));
    }
    html! { span.unit { "[1/s" sup { "m" @if i > 0 { "−" (i) } } "]" } }
}

/// The unit of a gain that makes the `i`-th derivative of what an angle is off.
fn unit_of_order(i: usize) -> Markup {
    let text = match i {
        0 => return html! {},
        1 => "[1/s]".to_owned(),
        2 => "[1/s²]".to_owned(),
        3 => "[1/s³]".to_owned(),
        _ => format!("[1/s^{i}]"),
    };
    html! { span.unit { (text) } }
}

/// Laws from positions.
fn observers(joints: &[(&JointRecord, &PositionObserver)]) -> Markup {
    let states = joints.iter().map(|(_, own)| own.correction.len()).max().unwrap_or(0);
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: gains per joint" {
            table {
                caption { span { "Law from positions: the torque goes the share g of the way to M̄ (q̈_d − K_d ė̂ − \
                    K_p ê) + φ̂ in each sample; the observer is corrected by ℓ times what the position is off" } }
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "M̄ " span.unit { "[kg·m²]" } }
                    th scope="col" { "K_p " span.unit { "[1/s²]" } }
                    th scope="col" { "K_d " span.unit { "[1/s]" } }
                    th scope="col" { "g" }
                    th scope="col" { "delay " span.unit { "[samples]" } }
                    @for i in 0..states { th scope="col" { "ℓ_" (i) " " (unit_of_order(i)) } }
                } }
                tbody { @for (joint, own) in joints { tr {
                    th scope="row" { (line(&joint.name)) }
                    td { (stated(joint.inertia_kg_m2)) }
                    td { (stated(joint.kp_per_s2)) }
                    td { (stated(joint.kd_per_s)) }
                    td { (stated(own.share)) }
                    td { (own.delay_samples) }
                    @for i in 0..states { td { (own.correction.get(i).map_or("–".to_owned(), |l| stated(*l))) } }
                } } }
            }
        }
    }
}

/// Filters on what the position is off; nothing where no law has one.
fn filters(joints: &[(&JointRecord, &PositionObserver)], rate_hz: f64) -> Markup {
    if joints.iter().all(|(_, own)| own.innovation_filter.is_empty()) {
        return html! {};
    }
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: filter on the innovation per joint" {
            table {
                caption { span { "Filter on the innovation ν, what the position is off: the torque goes its share to \
                    M̄ Σ (b_0 x + b_1 δ) more, with x ← x + δ and δ ← δ + ν − c_0 x − c_1 δ per section" } }
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "poles " span.unit { "[rad/s]" } }
                    th scope="col" { "b_0 " span.unit { "[1/s²]" } }
                    th scope="col" { "b_1 " span.unit { "[1/s²]" } }
                } }
                tbody { @for (joint, own) in joints { @for own in &own.innovation_filter { tr {
                    th scope="row" { (line(&joint.name)) }
                    td { (section_poles(own, rate_hz)) }
                    @for weight in own.weights_per_s2 { td { (stated(weight)) } }
                } } } }
            }
        }
    }
}

/// The loop and what it met.
pub(crate) fn world(record: &Record<'_>) -> Markup {
    let (run, metrics) = (record.run, record.metrics);
    html! {
        h2 id="world" { "Loop and world" }
        dl {
            dt { "form of the law" } dd { (line(&run.form)) }
            dt { "loop rate" } dd { (stated(run.rate_hz)) " Hz" }
            dt { "delay, sample to acting \
                torque" } dd { (run.delay_samples) @if run.delay_samples == 1 { " sample" } @else { " samples" } }
            dt { "simulated time" } dd { (stated(metrics.duration_s)) " s, " (metrics.samples) " samples" }
            dt { "steady part" } dd { "from " (stated(metrics.settle_s)) " s on" }
            dt { "robot" } dd { (line(&run.robot)) " – " (line(&run.robot_description)) }
            dt { "source of its numbers" } dd { (visible(&run.robot_provenance)) }
            @for (label, value) in &run.world { dt { (line(label)) } dd { (visible(value)) } }
        }
    }
}

/// The study, verbatim.
pub(crate) fn study(record: &Record<'_>) -> Markup {
    html! {
        h2 id="study" { "Study" }
        details {
            summary { "the study's text, " (record.study_text.lines().count()) " lines" }
            pre tabindex="0" aria-label="the study's text" { code { (visible(record.study_text)) } }
        }
    }
}

/// Section on the origin of the run: the command and data that make it again.
pub(crate) fn origin(record: &Record<'_>) -> Markup {
    let run = record.run;
    html! {
        h2 id="origin" { "Make it again" }
        pre tabindex="0" aria-label="command" { code { (visible(&run.command)) } }
        dl {
            dt { "study" } dd { (line(&run.study)) }
            dt { "SHA-256 of its text" } dd { code.hash { (line(&run.study_sha256)) } }
            dt { "seed" } dd { (run.seed) }
            dt { "phihat" } dd { (line(&run.phihat_version)) }
            dt { "built with" } dd { (line(&run.toolchain)) }
            @if let Some(gains) = record.gains {
                dt { "gains made for" } dd { (line(&gains.study)) ", " (stated(gains.rate_hz)) " Hz" }
            }
        }
    }
}
