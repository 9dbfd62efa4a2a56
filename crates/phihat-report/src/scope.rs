//! Scope of a certificate in words: assumptions, what is left out, what the page does not claim.

use maud::{Markup, html};
use phihat_design::{Certificate, LeftOut};

use crate::kit::text::{key_in_words, line};
use crate::policy::PLOT_LICENCE;
use crate::record::Record;

/// Assumptions under which the claims hold.
pub(crate) fn assumptions(certificate: &Certificate) -> Markup {
    html! { ul.scope {
        @for one in certificate.assumptions() { li { b { (one.number) } " " (one.text) } }
    } }
}

/// Effects of the study that the claims leave out.
pub(crate) fn left_out(certificate: &Certificate) -> Markup {
    html! { ul.scope { @for one in &certificate.not_counted {
        li { b { (key_in_words(&one.key)) } ": " (line(&one.value)) " – " (where_left_out(one.claims)) }
    } } }
}

fn where_left_out(claims: LeftOut) -> &'static str {
    match claims {
        LeftOut::Bounds => "not in the bounds",
        LeftOut::BoundsAndStability => "neither in the bounds nor in the stability claims",
        LeftOut::TubeBesideValue => {
            "in range, stability and bounds; tube and coupled gains are for the simulated value"
        }
        LeftOut::AllButElastic => {
            "in the clause of elastic joints alone; bounds and tube are those of rigid joints"
        }
        LeftOut::Assumed => "assumed",
        LeftOut::AllButTube => "in the tube, where there is one; in no other claim",
    }
}

/// Section on the limits of the claim, from the certificate's own scope.
pub(crate) fn not_claimed(record: &Record<'_>) -> Markup {
    let certificate = record.gains.and_then(|gains| gains.certificate.as_ref());
    html! {
        h2 id="limits" { "What this page does not claim" }
        p {
            "This is one run of a model of a robot, where the byline does not name a robot. A real arm has dynamics, \
                delays and faults that "
            "no model here holds. "
            @match certificate {
                None => { "No certificate backs these figures: they are measurements, not bounds. " }
                Some(own) if own.tube.is_some() => {
                    "The tube is about the study's one motion from its one start, for the payloads and levels of dry \
                        friction above: another motion, start or "
                    "study has another tube. "
                }
                Some(own) if own.class.is_some() => {
                    "The bound is for motions of its class; its maxima over box and payloads are the largest that a \
                        search met. "
                }
                Some(own) if own.without_bound().is_none() => {
                    "Bounds are those of each joint by itself, for the φ that is stated: how joints push each other is \
                        in none. "
                }
                Some(_) => { "No error is bounded: what is claimed is the stability of the sampled loop in the arm's \
                    range of inertia. " }
            }
            "phihat is research software, not a safety function; whoever runs these gains on a machine needs the \
                machine's own protective "
            "stop, limits and risk assessment."
        }
        @if let Some(certificate) = certificate {
            p { "No claim holds where one of these assumptions does not:" }
            (assumptions(certificate))
            @if !certificate.not_counted.is_empty() {
                p { "The study has, and the claims leave out:" }
                (left_out(certificate))
            }
            @if !certificate.unproved.is_empty() {
                p { "Clauses of the specification that are not proved:" }
                ul.scope { @for clause in &certificate.unproved { li { (line(clause)) } } }
            }
        }
        p { "Columns name revolute joints. For a prismatic joint read m for rad, N for N·m and kg for kg·m²." }
        details.licence {
            summary { "The plots are drawn by uPlot 1.6.32 (MIT)" }
            pre tabindex="0" aria-label="licence of uPlot" { code { (PLOT_LICENCE) } }
        }
    }
}
