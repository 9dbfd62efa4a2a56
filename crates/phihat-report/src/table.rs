//! The figures per joint, each beside its bound.

use crate::kit::number::{number, percent, stated};
use crate::kit::text::{line, prose};
use crate::kit::{MILLI, own_unit};
use crate::verdict::{CLAUSES, SpecClause, excess, share};
use maud::{Markup, html};
use phihat_sim::{JointMetrics, Metrics};

/// Table of the errors against the spec, joint by joint.
pub fn tracking(metrics: &Metrics) -> Markup {
    let steady = format!("steady: from {} s on", stated(metrics.settle_s));
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: tracking per joint" {
            table {
                caption { span { "Tracking per joint, against the study's spec (" (steady) ")" } }
                thead { tr {
                    th scope="col" { "joint" }
                    @for clause in &CLAUSES {
                        (heading(&format!("largest {}, steady", clause.symbol), clause.unit))
                    }
                    (heading("RMS of e, steady", "mrad"))
                    (heading("largest |e|, whole run", "mrad"))
                } }
                tbody { @for joint in &metrics.joints { tr {
                    th scope="row" { (line(&joint.name)) }
                    @for clause in &CLAUSES { (against_spec(clause, joint)) }
                    td { (number(MILLI * joint.error_rms_rad)) (own_unit("mrad", joint.slides)) }
                    td { (number(MILLI * joint.error_peak_rad)) (own_unit("mrad", joint.slides)) }
                } } }
            }
        }
    }
}

/// Table of torque and estimate, joint by joint.
pub fn torque(metrics: &Metrics) -> Markup {
    torque_table(metrics, true)
}

/// The same; without φ where it is the difference of noisy readings, and no torque of the arm.
pub(crate) fn torque_table(metrics: &Metrics, phi: bool) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: torque per joint" {
            table {
                caption { span { "Torque and estimate per joint, against the limits in force" } }
                thead { tr {
                    th scope="col" { "joint" }
                    (heading("largest |τ| applied", "N·m"))
                    (heading("largest |Δτ| commanded", "N·m per sample"))
                    (heading("torque limit met", "samples"))
                    (heading("rate limit met", "samples"))
                    (heading("either met, steady", "% of samples"))
                    @if phi {
                        (heading("largest |φ|", "N·m"))
                        (heading("largest |φ − φ̂|, steady", "N·m"))
                    }
                } }
                tbody { @for joint in &metrics.joints { tr {
                    th scope="row" { (line(&joint.name)) }
                    (against_limit(joint.tau_max_nm, joint.tau_limit_nm, &own_unit("N·m", joint.slides)))
                    (against_limit(joint.tau_step_max_nm, joint.tau_step_limit_nm, &own_unit("N·m", joint.slides)))
                    (count(joint.saturated_samples, metrics.samples))
                    (count(joint.rate_limited_samples, metrics.samples))
                    td.limited[joint.limited_steady_share > 0.0] {
                        (stated(1e2 * joint.limited_steady_share))
                    }
                    @if phi {
                        td { (number(joint.phi_max_nm)) (own_unit("N·m", joint.slides)) }
                        td { (number(joint.phi_error_steady_max_nm)) (own_unit("N·m", joint.slides)) }
                    }
                } } }
            }
        }
    }
}

fn heading(text: &str, unit: &str) -> Markup {
    let text = prose(text).replace(" − ", "\u{a0}−\u{a0}");
    html! { th scope="col" { (text) " " span.unit { "[" (unit) "]" } } }
}

fn against_spec(clause: &SpecClause, joint: &JointMetrics) -> Markup {
    let measured = (clause.measured)(joint);
    let unit = own_unit(clause.unit, joint.slides);
    let Some(bound) = (clause.bound)(joint) else {
        return html! { td { (number(MILLI * measured)) (unit) span.note { "no bound stated" } } };
    };
    let shown = stated(MILLI * bound);
    if share(measured, bound) > 1.0 {
        return html! { td.outside {
            (number(MILLI * measured)) (unit)
            span.note { "bound " (shown) ": " strong { "OUTSIDE, " (excess(measured, bound)) } }
        } };
    }
    html! { td.within {
        (number(MILLI * measured)) (unit)
        span.note { "bound " (shown) ": within, " (percent(measured, bound)) }
    } }
}

fn against_limit(measured: f64, limit: Option<f64>, unit: &str) -> Markup {
    let Some(limit) = limit else {
        return html! { td { (number(measured)) (unit) span.note { "no limit" } } };
    };
    let beyond = !measured.is_finite() || measured > limit * (1.0 + 1e-9);
    let word = if beyond { "BEYOND" } else { "used" };
    html! { td.outside[beyond] {
        (number(measured)) (unit)
        span.note { "limit " (stated(limit)) ": " (percent(measured, limit)) " " (word) }
    } }
}

fn count(samples: u64, of: u64) -> Markup {
    let share = percent(samples as f64, of as f64);
    html! { td { (samples) @if samples > 0 { span.note { (share) " of the run" } } } }
}
