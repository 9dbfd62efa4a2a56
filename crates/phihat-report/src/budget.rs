//! The page of an error budget.

use maud::{Markup, PreEscaped, html};
use phihat_design::budget::{Budget, BudgetBasis, Cause, JointBudget};

use crate::figure::front as front_figure;
use crate::kit::number::{number, percent, stated};
use crate::kit::text::{line, prose};
use crate::kit::{MILLI, Page};

/// The self-contained page of an error budget.
///
/// # Example
///
/// ```
/// use phihat_design::budget::Budget;
///
/// let text = r#"{"study": "swing", "study_sha256": "00", "feasible": false, "words": ["too fast for 45 Hz"],
///     "basis": null, "joints": [], "front": [], "changes": []}"#;
/// let budget: Budget = serde_json::from_str(text)?;
/// assert!(phihat_report::budget_page(&budget).contains("too fast for 45 Hz"));
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn budget_page(budget: &Budget) -> String {
    let title = format!("Error budget: {}", line(&budget.study));
    let main = html! {
        header {
            h1 { (title) }
            p.byline { "study " code { (line(&budget.study_sha256).chars().take(12).collect::<String>()) } }
        }
        (verdict(budget))
        (joints(budget))
        (changes(budget))
        (front(budget))
    };
    Page { title: &title, kind: "budget", script: None }.document(&main)
}

fn verdict(budget: &Budget) -> Markup {
    let class = if budget.feasible { "verdict within" } else { "verdict outside" };
    html! { div class=(class) {
        p { strong { @if budget.feasible { "The gains keep every clause." } @else { "No gains are known that keep \
            every clause." } } }
        @if !budget.words.is_empty() { ul { @for words in &budget.words { li { (prose(words)) } } } }
    } }
}

/// The causes that some joint has, in the order of the parts.
fn causes(joints: &[JointBudget]) -> Vec<(Cause, bool)> {
    let mut causes: Vec<(Cause, bool)> = Vec::new();
    for part in joints.iter().flat_map(|joint| &joint.parts) {
        if !causes.contains(&(part.cause, part.within)) {
            causes.push((part.cause, part.within));
        }
    }
    causes.sort_by_key(|(_, within)| *within);
    causes
}

fn joints(budget: &Budget) -> Markup {
    let Some(basis) = budget.basis else { return html! {} };
    let causes = causes(&budget.joints);
    html! {
        h2 id="joints" { "What the allowed error is spent on" }
        (spent(budget, &causes))
        details open[budget.joints.len() == 1] { summary { "the figures" }
        div.scroll tabindex="0" role="region" aria-label="Table: error budget per joint" { table {
            thead { tr {
                th scope="col" { "joint" }
                th scope="col" { "allowed" }
                th scope="col" { "all together" }
                @for (cause, within) in &causes {
                    th scope="col" { (cause.words()) @if *within { span.unit { " (within)" } } }
                }
            } }
            tbody { @for joint in &budget.joints { (row(joint, &causes)) } }
        } } }
        p { @match basis {
            BudgetBasis::Tube => {
                "Largest |e| after settling by tubes of the same gains: of the motion alone, and what each other cause \
                    adds to it when "
                "it comes alone. Coupling is what is left of the whole: joints that push each other, and causes that \
                    feed each other; "
                "less than nothing where causes are not at their worst at the same time."
            }
            BudgetBasis::OwnLoop => {
                "Worst cases of each joint's own loop, added up; how joints push each other is not in here. Estimates \
                    of the search."
            }
        } " A cause marked “within” is in the others already: so much less would be the whole without it." }
    }
}

/// Colours of the parts, in turn.
const PARTS: usize = 6;

/// Of each joint a bar of its parts, before what is allowed.
fn spent(budget: &Budget, causes: &[(Cause, bool)]) -> Markup {
    let shown = || causes.iter().filter(|(_, within)| !within).enumerate();
    html! {
        p.key.parts { @for (k, (cause, _)) in shown() { span.(format!("part-{}", k % PARTS)) { (cause.words()) } } }
        ul.bullets { @for joint in &budget.joints {
            @let unit = if joint.prismatic { "mm" } else { "mrad" };
            li {
                span.name { (line(&joint.name)) }
                (bar(joint, shown().map(|(k, (cause, _))| (k % PARTS, *cause))))
                span.values {
                    b { (joint.total_rad.map_or("–".to_owned(), |total| number(total * MILLI))) }
                    @if let Some(allowed) = joint.error_bound_rad { " of " (stated(allowed * MILLI)) }
                    " " (unit)
                }
            }
        } }
    }
}

/// Parts of a joint's error side by side; the dashed line is what is allowed.
fn bar(joint: &JointBudget, causes: impl Iterator<Item = (usize, Cause)>) -> Markup {
    let size = |cause: Cause| {
        let part = joint.parts.iter().find(|part| part.cause == cause && !part.within);
        part.map_or(0.0, |part| part.error_rad).max(0.0)
    };
    let parts: Vec<(usize, f64)> = causes.map(|(k, cause)| (k, size(cause))).collect();
    let sum: f64 = parts.iter().map(|(_, size)| size).sum();
    let whole = 1.06
        * joint.error_bound_rad.map_or(sum, |allowed| if allowed > sum { allowed } else { sum });
    let at = |value: f64| format!("{:.1}", if whole > 0.0 { 1000.0 * value / whole } else { 0.0 });
    let starts = parts.iter().scan(0.0, |from, (_, size)| {
        let start = *from;
        *from += size;
        Some(start)
    });
    let placed: Vec<_> =
        parts.iter().zip(starts).map(|((k, size), start)| (*k, start, *size)).collect();
    html! { svg.bullet viewBox="0 0 1000 24" preserveAspectRatio="none" aria-hidden="true" {
        rect.ground x="0" y="0" width="1000" height="24" {}
        @for (k, start, size) in placed { rect.(format!("part-{k}")) x=(at(start)) y="4" width=(at(size))
            height="16" {} }
        @if let Some(allowed) = joint.error_bound_rad { line.limit x1=(at(allowed)) x2=(at(allowed)) y1="0" y2="24" {} }
    } }
}

fn row(joint: &JointBudget, causes: &[(Cause, bool)]) -> Markup {
    let unit = if joint.prismatic { "mm" } else { "mrad" };
    let cell = |value: Option<f64>| {
        html! {
            td { @match (value, joint.error_bound_rad) {
                (Some(value), Some(allowed)) => {
                    (number(value * MILLI)) span.note { (percent(value, allowed)) }
                }
                (Some(value), None) => { (number(value * MILLI)) }
                (None, _) => { "–" }
            } }
        }
    };
    let of = |(cause, within): (Cause, bool)| {
        let part = joint.parts.iter().find(|part| (part.cause, part.within) == (cause, within));
        part.map(|part| part.error_rad)
    };
    html! { tr {
        th scope="row" { (line(&joint.name)) " " span.unit { "[" (unit) "]" } }
        td { @match joint.error_bound_rad { Some(allowed) => { (stated(allowed * MILLI)) } None => { "–" } } }
        (cell(joint.total_rad))
        @for cause in causes { (cell(of(*cause))) }
    } }
}

fn changes(budget: &Budget) -> Markup {
    if budget.changes.is_empty() {
        return html! {};
    }
    html! {
        h2 id="changes" { "What one change would buy" }
        div.scroll tabindex="0" role="region" aria-label="Table: changes that were tried" { table {
            thead { tr {
                th scope="col" { "change" } th scope="col" { "key" } th scope="col" { "value" } th scope="col" {
                    "then" }
            } }
            tbody { @for change in &budget.changes { tr {
                th scope="row" { (line(&change.change)) }
                td { code { (line(&change.key)) } }
                td { code { (line(&change.value)) } }
                td { @match (change.helps, change.error_share) {
                    (true, Some(share)) => { "there are gains, which use " (percent(share, 1.0)) " of the allowed \
                        error" }
                    (true, None) => { "there are gains" }
                    (false, _) => { "still none" }
                } }
            } } }
        } }
        p { "Each was tried out by itself, all else being equal, as a study of its own; the smallest that helps is \
            told." }
    }
}

fn front(budget: &Budget) -> Markup {
    if budget.front.is_empty() {
        return html! {};
    }
    html! {
        h2 id="front" { "Error against torque noise" }
        @if let Some(picture) = front_figure(&budget.front, "this law") {
            figure.claim id=(picture.name) { (PreEscaped(&picture.svg)) figcaption {
                "Below the level of 1 the allowed error is kept; to the left there is less torque noise."
            } }
        }
        details { summary { (budget.front.len()) " laws as a table" }
            div.scroll tabindex="0" role="region" aria-label="Table: error against torque noise" { table {
                thead { tr {
                    th scope="col" { "torque noise " span.unit { "[N·m per sample]" } }
                    th scope="col" { "error, of the allowed one" }
                    th scope="col" { "order" }
                    th scope="col" { "bandwidth " span.unit { "[rad/s]" } }
                } }
                tbody { @for point in &budget.front { tr {
                    th scope="row" { (number(point.torque_noise_nm)) }
                    td { (percent(point.error_share, 1.0)) @if point.chosen { span.note { "the law of this budget" } } }
                    td { (point.order) }
                    td { (number(point.bandwidth_rad_s)) }
                } } }
            } }
        }
        p { "Laws that no other beats in both. Estimates of the search, joint by joint, not certified." }
    }
}
