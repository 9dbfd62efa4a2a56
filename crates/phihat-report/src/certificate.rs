//! Proved properties of the gains, alongside the measurements of the run.

use crate::class_section::class;
use crate::coarser::coarser;
use crate::coupled::coupled;
use crate::figure::claim_figures;
use crate::kit::number::{number, stated};
use crate::kit::text::line;
use crate::kit::{MILLI, own_unit};
use crate::limit::limit;
use crate::record::Record;
use crate::scope::{assumptions, left_out};
use crate::tube_section::tube;
use maud::{Markup, PreEscaped, html};
use phihat_design::{Certificate, JointCertificate};
use phihat_sim::JointMetrics;

/// The certificate's claims, or nothing where there is none.
pub(crate) fn certificate(record: &Record<'_>) -> Markup {
    let Some(gains) = record.gains else { return html! {} };
    let Some(certificate) = &gains.certificate else { return html! {} };
    let (low, high) = (certificate.arm.low, certificate.arm.high);
    html! {
        h2 id="certificate" { "Certificate" }
        p {
            "Claims about these gains that " code { "phihat verify" } " checks again from gains.json alone. The arm's \
                inertia, "
            "in units of M̄, was found \
                between " (number(low)) " and " (number(high)) " (" (line(&certificate.arm.source))
            "); it must stay inside each joint's window by a factor of " (stated(certificate.window_margin)) "."
        }
        @if let Some(why) = certificate.refused() {
            p { strong { "These gains do not arm: " } (line(&why.to_string())) }
        }
        (story(certificate))
        h3 id="assumes" { "1 · It assumes" }
        (assumptions(certificate))
        @if !certificate.not_counted.is_empty() { (left_out(certificate)) }
        h3 id="claims" { "2 · It claims" }
        (tube(record))
        (class(record))
        @if certificate.class.is_none() && record.tube.is_none() { (bounds(certificate, &record.metrics.joints)) }
        (moving(certificate))
        h3 id="evidence" { "3 · Its evidence" }
        @for figure in claim_figures(record) {
            figure.claim id=(figure.name) { (PreEscaped(&figure.svg)) figcaption { (reading(&figure.name)) } }
        }
        (stability(certificate))
        (coupled(gains))
        (limit(gains))
        (coarser(gains))
        @if let Some(joint) = certificate.joints.first() { (weights(joint)) }
    }
}

/// The certificate in three steps: how many assumptions, what follows for the error, what shows it.
fn story(certificate: &Certificate) -> Markup {
    let assumed = certificate.assumptions().len();
    let claim = match (&certificate.tube, &certificate.class) {
        (Some(_), _) => "a tube around this motion".to_owned(),
        (None, Some(_)) => "a bound for every motion of a class".to_owned(),
        (None, None) => certificate.without_bound().map_or_else(
            || "a bound of each joint by itself".to_owned(),
            |why| format!("stability, no bound on the error: {}", line(&why)),
        ),
    };
    let joints = certificate.joints.iter().filter(|joint| joint.margins.is_some()).count();
    html! { ol.story {
        li { a href="#assumes" { "Assumed" } (assumed) " conditions; where one does not hold, nothing is claimed" }
        li { a href="#claims" { "Claimed" } (claim) }
        li { a href="#evidence" { "Shown" } "window, margins and couplings of " (joints) " joints" }
    } }
}

/// Caption that explains a figure.
fn reading(figure: &str) -> &'static str {
    match figure {
        "inertia-window" => {
            "The loop is stable for inertia inside of the window, which is closed at both ends; the arm must stay \
             inside by the margin. The arm's range is that of the eigenvalues of M̄⁻¹M(q), times each joint's M̄."
        }
        "nyquist" => {
            "The sampled loop of the joint with the smallest modulus margin, at the lightest, a middle and the \
             heaviest inertia of the arm: it stays outside of the circle around −1. A lighter arm moves along the axis \
             to the left and a heavier one to the right, until an end of the window meets −1."
        }
        "bode" => {
            "The same loop, cut where the torque meets the inertia; and what a torque φ on the joint does to its error."
        }
        "pace" => {
            "The largest bound of a joint, were speed f times, acceleration f² times and jerk f³ times those of the \
             class: the same gains, the same derivation. Informs; only the class itself is in the certificate."
        }
        _ => {
            "Other laws of the search that no other beats in both: less error costs torque noise, here the worst \
             change of torque per sample that the encoder's steps can cause. Estimates, a few per mille low; not \
             certified."
        }
    }
}

/// Bounds beside measurements.
fn bounds(certificate: &Certificate, measured: &[JointMetrics]) -> Markup {
    let rows = || certificate.joints.iter().zip(measured);
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: certified bounds and measurements" {
            table {
                caption { span { "Bounds on the steady error, stated before the run, and what it measured" } }
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "|e| certified " span.unit { "[mrad]" } }
                    th scope="col" { "|e| measured " span.unit { "[mrad]" } }
                    th scope="col" { "bound / measured" }
                    th scope="col" { "|ė| certified " span.unit { "[mrad/s]" } }
                    th scope="col" { "|ė| measured " span.unit { "[mrad/s]" } }
                    th scope="col" { "holds" }
                } }
                tbody { @for (i, (claim, joint)) in rows().enumerate() { tr {
                    th scope="row" { (line(&claim.name)) }
                    @if let Some(bound) = certificate.error_bound(i) {
                        @let holds = joint.error_steady_max_rad <= bound.error_bound_rad
                            && joint.velocity_error_steady_max_rad_s <= bound.velocity_error_bound_rad_s;
                        @let way = own_unit("mrad", joint.slides);
                        @let speed = own_unit("mrad/s", joint.slides);
                        td { (number(bound.error_bound_rad * MILLI)) (way) }
                        td { (number(joint.error_steady_max_rad * MILLI)) (way) }
                        td { (number(bound.error_bound_rad / joint.error_steady_max_rad)) }
                        td { (number(bound.velocity_error_bound_rad_s * MILLI)) (speed) }
                        td { (number(joint.velocity_error_steady_max_rad_s * MILLI)) (speed) }
                        td { @if holds { "yes" } @else { "no" } }
                    } @else {
                        td colspan="6" { @if claim.phi.is_none() { "no bound: φ is not known" } @else { "no bound: see \
                            above" } }
                    }
                } } }
            }
        }
    }
}

/// Rate at which the inertia may change while the arm moves, and the rates that the motion needs.
fn moving(certificate: &Certificate) -> Markup {
    let rate = |rate: Option<f64>| rate.map_or_else(|| "–".to_owned(), number);
    html! {
        @if let Some(moving) = &certificate.moving {
            p {
                "While the arm moves, the coupled loop is stable as long as its inertia, in units of M̄, changes by at \
                    most "
                (number(moving.rate_per_s)) " per second, anywhere in its range. The reference needs "
                (rate(moving.needed_motion_per_s)) ", all joints at their speed limits "
                (rate(moving.needed_limits_per_s)) ", as far as it was searched. Coriolis and viscous torque are left \
                    out."
            }
        } @else if let Some(why) = &certificate.moving_refused {
            p { "Stability while the arm moves is not proved: " (line(&why.to_string())) }
        }
        @if let Some(rate) = certificate.frozen.as_ref().and_then(|frozen| frozen.decay_per_s) {
            p { "At every frozen posture the arm forgets what moved it at least as e^(−" (number(rate)) " t), t in s: \
                proved." }
        }
        @if let Some(any) = &certificate.any_speed {
            p { "Within μ = " (number(any.low)) " … " (number(any.high)) " the inertia may move at any speed." }
        }
    }
}

/// Window and margins.
fn stability(certificate: &Certificate) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: stability of the sampled loop" {
            table {
                caption { span { "Stability of the sampled loop, worst over the arm's range of inertia" } }
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "window of μ" }
                    th scope="col" { "gain margin " span.unit { "[÷ … ×]" } }
                    th scope="col" { "phase margin " span.unit { "[°]" } }
                    th scope="col" { "delay margin " span.unit { "[ms]" } }
                    th scope="col" { "modulus margin" }
                    th scope="col" { "|Δτ| from the encoder, bound " span.unit { "[N·m]" } }
                } }
                tbody { @for joint in &certificate.joints { tr {
                    th scope="row" { (line(&joint.name)) }
                    @match &joint.window {
                        Some(window) => td { (number(window.low)) "\u{a0}…\u{a0}" (number(window.high)) },
                        None => td { "unstable" },
                    }
                    @if let Some(margins) = &joint.margins {
                        td { (number(margins.gain_down)) "\u{a0}…\u{a0}" (number(margins.gain_up)) }
                        td { (number(margins.phase_deg)) }
                        td { (number(margins.delay_s * MILLI)) }
                        td { (number(margins.modulus)) }
                        td { (joint.noise.as_ref().map_or("–".to_owned(), |n| number(n.change_max_nm))) }
                    } @else {
                        td colspan="5" { "none over the arm's range" }
                    }
                } } }
            }
        }
    }
}

/// The game's weights of the law that the joints share.
fn weights(joint: &JointCertificate) -> Markup {
    let optimality = joint.continuous.as_ref().and_then(|law| law.optimality.as_ref());
    let certified = optimality.and_then(|o| o.certified());
    html! {
        @if let Some(c) = certified {
            details {
                summary { "H-infinity optimality: γ = " (number(c.gamma)) " at K̃ = " (number(c.k_tilde)) " 1/s; Q and \
                    S" }
                p { "Weights of the game (13), for M̄ = 1 kg·m²; the last column is the diagonal of Q." }
                table {
                    tbody { @for (row, q) in c.s.iter().zip(&c.q) { tr {
                        @for entry in row { td { (number(*entry)) } }
                        td { (number(*q)) }
                    } } }
                }
            }
        }
    }
}
