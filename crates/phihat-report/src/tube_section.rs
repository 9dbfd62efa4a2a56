//! The tube on the page: what was promised and what was measured, joint by joint.

use maud::{Markup, html};
use phihat_design::Tube;
use phihat_sim::Metrics;

use crate::kit::number::{number, stated};
use crate::kit::text::line;
use crate::kit::{MILLI, own_unit};
use crate::record::Record;
use crate::tube::TubeRun;

/// The tube's part of the certificate's section.
pub(crate) fn tube(record: &Record<'_>) -> Markup {
    let certificate = record.gains.and_then(|gains| gains.certificate.as_ref());
    let Some(certificate) = certificate else { return html! {} };
    html! {
        @if let Some(why) = &certificate.tube_refused {
            p { strong { "No tube: " } (line(why)) }
        }
        @if let (Some(tube), Some(run)) = (&certificate.tube, record.tube) {
            p {
                "The tube: no run of this study, from its start, leaves it, for any payload of " (mass(tube)) " at "
                (line(&tube.payload.frame)) " and any dry friction between the levels below. Here " (run.sentence()) "."
            }
            (beside(tube, run, record.metrics))
        }
    }
}

fn mass(tube: &Tube) -> String {
    let (low, high) = tube.payload.mass_kg;
    format!("{} … {} kg", stated(low), stated(high))
}

/// Promised and measured, joint by joint.
fn beside(tube: &Tube, run: &TubeRun, metrics: &Metrics) -> Markup {
    let slides = |name: &str| metrics.joints.iter().any(|own| own.slides && own.name == name);
    let friction = |joint: usize| {
        let (low, high) = (tube.coulomb_nm.0.get(joint), tube.coulomb_nm.1.get(joint));
        low.zip(high).map_or("–".to_owned(), |(l, h)| format!("{} … {}", stated(*l), stated(*h)))
    };
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: tube and measurements" {
            table {
                caption { span { "Tube and measurement, largest from " (stated(run.kept.settle_s)) " s on" } }
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "|e| tube " span.unit { "[mrad]" } }
                    th scope="col" { "|e| measured " span.unit { "[mrad]" } }
                    th scope="col" { "tube / measured" }
                    th scope="col" { "|ė| tube " span.unit { "[mrad/s]" } }
                    th scope="col" { "|ė| measured " span.unit { "[mrad/s]" } }
                    th scope="col" { "least distance from its edge, from t = 0 " span.unit { "[mrad]" } }
                    th scope="col" { "dry friction " span.unit { "[N·m]" } }
                } }
                tbody { @for (i, joint) in run.kept.joints.iter().enumerate() { tr {
                    @let slides = slides(&joint.name);
                    @let (way, speed) = (own_unit("mrad", slides), own_unit("mrad/s", slides));
                    th scope="row" { (line(&joint.name)) }
                    td { (number(joint.error_bound_rad * MILLI)) (way) }
                    td { (number(joint.error_peak_rad * MILLI)) (way) }
                    td { (number(joint.error_bound_rad / joint.error_peak_rad)) }
                    td { (number(joint.velocity_error_bound_rad_s * MILLI)) (speed) }
                    td { (number(joint.velocity_error_peak_rad_s * MILLI)) (speed) }
                    td.outside[joint.room_rad < 0.0] { (number(joint.room_rad * MILLI)) (way) }
                    td { (friction(i)) (own_unit("N·m", slides)) }
                } } }
            }
        }
    }
}
