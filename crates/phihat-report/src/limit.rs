//! Comparison of the laws with the limit of any linear law.

use crate::kit::number::number;
use crate::kit::text::line;
use crate::kit::{MILLI, own_unit};
use maud::{Markup, html};
use phihat_design::Gains;

/// A table of the joints, or nothing where nobody asked.
pub(crate) fn limit(gains: &Gains) -> Markup {
    let list = &gains.limit;
    let Some(first) = list.first() else { return html! {} };
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: laws beside the limit of linear laws" {
            table {
                caption { span { "Each law beside the limit of linear laws, one joint alone; estimates, not claims" } }
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "|Δτ| from the encoder " span.unit { "[N·m]" } }
                    th scope="col" { "limit at M̄ " span.unit { "[mrad]" } }
                    th scope="col" { "law at M̄ " span.unit { "[mrad]" } }
                    th scope="col" { "law / limit" }
                    th scope="col" { "law over the range " span.unit { "[mrad]" } }
                    th scope="col" { "price of the range" }
                    th scope="col" { "limit at the lightest " span.unit { "[mrad]" } }
                } }
                tbody { @for one in list {
                    @let slides = gains.slides(&one.name);
                    @let way = own_unit("mrad", slides);
                    tr {
                    th scope="row" { (line(&one.name)) }
                    td { (number(one.torque_noise_nm)) (own_unit("N·m", slides)) }
                    td { (number(one.limit_rad.0 * MILLI)) (way) }
                    td { (number(one.own_rad * MILLI)) (way) }
                    td { (number(one.times_limit())) }
                    td { (number(one.range_rad * MILLI)) (way) }
                    td { (number(one.price_of_range())) }
                    td { (number(one.limit_lightest_rad.0 * MILLI)) (way) }
                } } }
            }
        }
        p {
            "Limit: no linear law from the same encoder, with no more torque noise, has a smaller bound on |e| at that \
                one "
            "inertia, were it known; at the lightest of the range, none has for the whole range. Price: the law's \
                bound over "
            "the range, over the limit at M̄. φ: " (line(&first.phi_source)) ". " code { "phihat verify" } " does not \
                check "
            "these figures, and the tube's error, of the coupled arm, is another."
        }
    }
}
