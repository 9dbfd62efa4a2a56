//! Errors of the tube with coarser encoders.

use crate::kit::number::number;
use crate::kit::text::{line, parted, prose};
use crate::kit::{MILLI, own_unit};
use maud::{Markup, html};
use phihat_design::Gains;

/// A table with a row per encoder, that of the study first; nothing where there is no tube or no encoder.
pub(crate) fn coarser(gains: &Gains) -> Markup {
    let tube = gains.certificate.as_ref().and_then(|certificate| certificate.tube.as_ref());
    let Some(tube) = tube.filter(|_| !gains.coarser.is_empty()) else { return html! {} };
    let errors: Vec<f64> = tube.joints.iter().map(|joint| joint.error_bound_rad).collect();
    let slides: Vec<bool> = tube.joints.iter().map(|joint| gains.slides(&joint.name)).collect();
    let steps: Vec<f64> = tube.joints.iter().map(|joint| joint.torque_step_max_nm).collect();
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: these gains behind coarser encoders" {
            table {
                caption { span { "The same gains behind coarser encoders: largest |e| after settling by the tube, in \
                    mrad" } }
                thead { tr {
                    th scope="col" { "bits" }
                    @for joint in &tube.joints { th.name scope="col" { (parted(&joint.name)) } }
                    th scope="col" { (prose("largest |Δτ|")) " " span.unit { "[N·m]" } }
                    th scope="col" { "limit of torque rate" }
                } }
                tbody {
                    (row("as declared", (&errors, &steps), &slides, true))
                    @for one in &gains.coarser {
                        @let bits = format!("−{}", one.bits_fewer);
                        @if let Some(why) = &one.refused {
                            tr {
                                th scope="row" { (bits) }
                                td.why colspan=(errors.len() + 2) { "no tube: " (line(why)) }
                            }
                        } @else {
                            (row(&bits, (&one.error_bound_rad, &one.torque_step_max_nm), &slides,
                                one.within_rate_limits))
                        }
                    }
                }
            }
        }
        p {
            "Gains are made for the encoder that the study declares. Where a limit of torque rate can act, the errors \
                are those "
            "without it, and none is proved. " code { "phihat verify" } " checks the declared encoder only."
        }
    }
}

fn row(bits: &str, (errors, steps): (&[f64], &[f64]), slides: &[bool], within: bool) -> Markup {
    let largest = steps.iter().copied().fold(0.0, f64::max);
    html! { tr {
        th scope="row" { (bits) }
        @for (error, slides) in errors.iter().zip(slides) { td { (number(error * MILLI)) (own_unit("mrad", *slides)) } }
        td { (number(largest)) }
        td.whole { @if within { "cannot act" } @else { "can act" } }
    } }
}
