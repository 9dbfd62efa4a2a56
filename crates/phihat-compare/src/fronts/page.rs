//! The page of a comparison at equal noise.

use maud::{Markup, html};
use phihat_report::kit::figure::{Axis, Series};
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::text::line;
use phihat_report::kit::{MILLI, Page};

use super::picture::{curve, mean_ranks, name, name_of, picture};
use super::record::{AtCap, Fronts, LawRecord, Restart};
use super::tier::{LoopKnowledge, Tier};
use super::verdict::{found, main_cap, points, verdict};
use crate::protocol::hardest;
use phihat_campaign::statistics::{NOTICEABLE, Spread, Standing};

/// Script that shows one curve of a picture alone.
const ISOLATE: &str = include_str!("isolate.js");

/// The self-contained page; `command` made it.
pub fn fronts_page(fronts: &Fronts, command: &str) -> String {
    let title = format!("Fronts at equal noise: {}", line(&fronts.arm.robot));
    let extent = &fronts.extent;
    let [train, validation, test] = extent.worlds;
    let (delay, bits) = hardest();
    let main = html! {
        header {
            h1 { (title) }
            p.byline { "phihat " (line(&fronts.phihat_version)) " · " (extent.caps.len()) " cap" @if extent.caps.len()
                > 1 { "s" } " on noise · " (extent.restarts)
                @if extent.restarts == 1 { " search each · " } @else { " searches each · " }
                (extent.per_scalar) " evaluations for each scalar and one more under the loosest cap"
                @if extent.caps.len() > 1 { ", a quarter as many under every other, from the best of all before" } " · \
                    worlds: " (train) " to train, "
                (validation) " to choose, " (test) " to judge · simulated" }
            (verdict(fronts))
        }
        @for tier in Tier::ALL { @if fronts.laws.iter().any(|law| law.tier == tier) { (tier_part(fronts, tier)) } }
        (volumes(fronts))
        (held_out(fronts))
        h2 { "How" }
        p { "Noise is the rms of the applied torque above 50 Hz over the joint's limit, worst joint; the error is the \
             rms of the worst joint. A tuning keeps its cap, follows, and bears drives 1.3 times as strong and one \
             more sample of delay, in every world that it was tuned in; where it does not follow in a world, or is \
             louder there than every cap, it has not borne more either. The validation worlds choose among the \
             searches; the test worlds are looked at once. What keeps a cap keeps every looser one: gains of a \
             tighter cap that are better in the validation worlds stand for a search that ended too early under a \
             looser one. Better or worse: beyond the band of one law under two names, by more than 10 %, and with \
             p < .05 corrected (Holm) for every question of this page; else no difference. A run that did not follow \
             counts as 1 rad." }
        p { "Every law that takes the delay or a preview is handed the same: the exact delay of each drawn world, and \
             the reference at the time when a torque will act. A law is compared with ours that is handed no more of \
             either. Known dry friction is taken out of the torque that a law with a model observes, with that \
             delay, for every such law." }
        @if fronts.laws.iter().any(|law| law.designed) {
            p { "Designed gains are not tuned: their design is told the hardest loop that can be \
                drawn, " (delay) " samples of delay and encoders of "
                (bits) " bits; where the paper's law has no gains for that, the study's own loop." }
        }
        p { "Made by " code { (line(command)) } "." }
        h2 { "Not claimed" }
        p { "That a law can do no better: these are the best tunings that were found. Worlds are drawn at random from \
             ranges; what lies outside of them was not tried. All laws measure the same positions and velocities; the \
             cut-off of the filter, a factor on the nominal inertia, and whether the torque that acted or the one \
             commanded last is handed over are free for every law that uses them, and tuned with its own scalars." }
    };
    Page { title: &title, kind: "fronts", script: Some(ISOLATE) }.document(&main)
}

fn percent(share: f64) -> String {
    number(100.0 * share)
}

fn tier_part(fronts: &Fronts, tier: Tier) -> Markup {
    // Ours of lesser knowledge stand beside: knowing less is allowed.
    let shown =
        |law: &&LawRecord| law.tier == tier || (law.ours && law.tier < tier && law.again.is_none());
    let laws: Vec<&LawRecord> = fronts.laws.iter().filter(shown).collect();
    let front = |law: &&LawRecord| {
        let place = |cap: &f64| {
            let (_, error, noise) = found(fronts, &law.id, *cap)?;
            let at = [100.0 * noise.median, MILLI * error.median];
            Some((at, [MILLI * error.lower, MILLI * error.upper]))
        };
        let mut places: Vec<_> = fronts.extent.caps.iter().filter_map(place).collect();
        places.sort_by(|(a, _), (b, _)| a[0].total_cmp(&b[0]));
        let (points, spread) = places.into_iter().unzip();
        Series { spread, ..curve(law, points) }
    };
    let cap = main_cap(fronts);
    let ordered = fronts.ordered.iter().find(|o| o.tier == tier && o.cap.total_cmp(&cap).is_eq());
    html! {
        h2 { "Laws with " (tier.words()) }
        figure.plot {
            (picture(&format!("Error against noise, laws with {}", tier.words()),
                (Axis::log("noise above 50 Hz [% of the torque limit]"), Axis::log("rms error \
                    [mrad]")), laws.iter().map(front).collect()))
            figcaption { "Chosen gains in the test worlds: medians, one mark per cap; upright lines from quartile to \
                quartile. Below and to the left is less of both. The colour says what a law knows of the arm: blue \
                nothing, orange one number per joint, green a model; ours are thick, a second name is grey. Tap a \
                curve or its name to see it alone." }
        }
        (timings(&laws))
        details.behind { summary { "The figures: " (laws.len()) " laws \
            under " (fronts.extent.caps.len()) " caps" } (table(fronts, tier, &laws)) }
        @if let Some(ordered) = ordered {
            h3 { "Ranks at a cap of " (stated(100.0 * cap)) " %" }
            figure.plot {
                (mean_ranks(fronts, &ordered.laws, ordered.critical_difference))
                figcaption { "Mean rank over the test worlds, 1 is best. Laws inside the shaded stretch cannot be told \
                    from the first one by ranks (Nemenyi, 5 %; difference " (number(ordered.critical_difference)) ")." }
            }
        }
        (profiles(fronts, &laws, cap))
        (efforts(fronts, &laws, cap))
    }
}

/// Laws that are handed the delay, a preview or both, by name.
fn timings(laws: &[&LawRecord]) -> Markup {
    let of = |timing: LoopKnowledge| {
        let those = laws.iter().filter(|law| law.timing == timing && law.again.is_none());
        those.map(|law| name(law)).collect::<Vec<_>>().join(", ")
    };
    let some =
        || LoopKnowledge::ALL.into_iter().filter(|timing| *timing != LoopKnowledge::default());
    html! { p {
        @for (timing, those) in some().map(|timing| (timing, of(timing))).filter(|(_, those)| !those.is_empty()) {
            "Handed " (timing.words()) " too: " strong { (those) } ". "
        }
        @if laws.iter().any(|law| law.timing == LoopKnowledge::default()) {
            "The others are handed neither delay nor preview."
        }
    } }
}

fn table(fronts: &Fronts, tier: Tier, laws: &[&LawRecord]) -> Markup {
    html! { div.scroll tabindex="0" role="region" aria-label=(format!("Table: laws with {}", tier.words())) { table {
        thead { tr {
            @for head in ["law", "cap [%]", "noise [%]", "error [mrad]", "did not follow [%]", "above its cap \
                [%]", "errors over ours", "standing", "kept every constraint"] {
                th scope="col" { (head) }
            }
        } }
        tbody { @for law in laws { @for cap in &fronts.extent.caps { (row(fronts, tier, law, *cap)) } } }
    } } }
}

fn row(fronts: &Fronts, tier: Tier, law: &LawRecord, cap: f64) -> Markup {
    let Some(point) = points(fronts, cap).find(|point| point.law == law.id) else {
        return html! {};
    };
    let feasible = point.restarts.iter().filter(|restart| restart.feasible()).count();
    let versus = fronts
        .versus
        .iter()
        .find(|one| one.tier == tier && one.law == law.id && one.cap.total_cmp(&cap).is_eq());
    let spread = |spread: Option<Spread>, times: f64| {
        spread.map_or("–".to_owned(), |s| {
            format!(
                "{} ({} … {})",
                number(times * s.median),
                number(times * s.lower),
                number(times * s.upper)
            )
        })
    };
    let ends: Vec<String> = point
        .restarts
        .iter()
        .flat_map(|restart| &restart.at_end)
        .map(|end| {
            format!("{} at its {} end", end.scalar, if end.upper { "upper" } else { "lower" })
        })
        .collect();
    html! { tr {
        th scope="row" {
            (name(law))
            @if let Some(end) = ends.first() { span.note { (line(end)) } }
            @for note in notes(fronts, law, point) { span.note { (note) } }
        }
        td { (stated(100.0 * cap)) }
        @match &point.chosen {
            Some(chosen) => {
                td { (spread(chosen.noise, 100.0)) }
                td { (spread(chosen.error_rad, MILLI)) }
                td { (percent(chosen.failed)) }
                td { (percent(chosen.above_cap)) }
            }
            None => { td colspan="4" { (reason(point)) } }
        }
        @match versus {
            Some(one) => {
                td { (number(one.ratio.ratio)) " (" (number(one.ratio.interval[0]))
                    " … " (number(one.ratio.interval[1])) ")" }
                td { (standing(one.standing)) }
            }
            None => { td { "–" } td { @if law.ours { "ours" } @else if point.chosen.is_some() && law.again.is_none() {
                "none of ours knows as little" } @else { "–" } } }
        }
        td { (feasible) " of " (point.restarts.len()) }
    } }
}

/// Remarks on a law's result under one cap against those under its tighter ones.
fn notes(fronts: &Fronts, law: &LawRecord, point: &AtCap) -> Vec<String> {
    let restart = tuning(fronts, &law.id, point.cap);
    let from = restart.and_then(|restart| restart.from_cap);
    let own = found(fronts, &law.id, point.cap).map(|(_, error, _)| error.median);
    let tighter = fronts.extent.caps.iter().filter(|cap| **cap < point.cap);
    let least = tighter.filter_map(|cap| Some(found(fronts, &law.id, *cap)?.1.median));
    let least = least.fold(f64::INFINITY, f64::min);
    let from = from.map(|cap| format!("gains of the cap of {} %", stated(100.0 * cap)));
    let more = own.filter(|own| *own > NOTICEABLE * least);
    let more = more.map(|_| "more error than under a tighter cap: searched too little".to_owned());
    from.into_iter().chain(more).collect()
}

/// Why there are no gains.
fn reason(point: &AtCap) -> String {
    let failed = point.restarts.iter().find_map(|restart| restart.failed.as_deref());
    failed.map_or("no gains found that keep every constraint".to_owned(), line)
}

fn standing(standing: Standing) -> Markup {
    match standing {
        Standing::Better => html! { span.better { "better" } },
        Standing::Worse => html! { span.worse { "worse" } },
        Standing::Alike => html! { "no difference" },
    }
}

/// The chosen tuning of a law.
fn tuning<'a>(fronts: &'a Fronts, law: &str, cap: f64) -> Option<&'a Restart> {
    let point = points(fronts, cap).find(|point| point.law == law)?;
    let chosen = point.chosen.as_ref()?;
    point.restarts.iter().find(|restart| restart.restart == chosen.restart)
}

/// In how many worlds a law is within a factor of the best law there (E. D. Dolan, J. J. Moré, 2002).
fn profiles(fronts: &Fronts, laws: &[&LawRecord], cap: f64) -> Markup {
    let known: Vec<(&LawRecord, &Restart)> = laws
        .iter()
        .filter(|law| law.again.is_none())
        .filter_map(|law| Some((*law, tuning(fronts, &law.id, cap)?)))
        .collect();
    let error = |restart: &Restart, world: usize| {
        restart
            .test
            .get(world)
            .copied()
            .flatten()
            .map_or(f64::INFINITY, |tried| tried.error_rms_rad)
    };
    let worlds = known.first().map_or(0, |(_, restart)| restart.test.len());
    let best: Vec<f64> = (0..worlds)
        .map(|w| known.iter().map(|(_, r)| error(r, w)).fold(f64::INFINITY, f64::min))
        .collect();
    let profile = |(law, restart): &(&LawRecord, &Restart)| {
        let mut factors: Vec<f64> = (0..worlds).map(|w| error(restart, w) / best[w]).collect();
        factors.retain(|factor| factor.is_finite());
        factors.sort_by(f64::total_cmp);
        let share = |count: u32| 100.0 * f64::from(count) / worlds as f64;
        curve(law, (1..).zip(&factors).map(|(count, factor)| [*factor, share(count)]).collect())
    };
    if known.len() < 2 {
        return html! {};
    }
    html! {
        details { summary { "In how many worlds a law is near the best one" }
        figure.plot {
            (picture("Share of worlds against the factor from the best",
                (Axis::log("error over the least of any law in that world"), Axis::new("share of test worlds \
                    [%]")), known.iter().map(profile).collect()))
            figcaption { "Chosen gains at a cap of " (stated(100.0 * cap)) " %. Above and to the left is better." }
        } }
    }
}

/// Error that a search has found, against its evaluations.
fn efforts(fronts: &Fronts, laws: &[&LawRecord], cap: f64) -> Markup {
    // The cost of gains that keep their constraints is e/(1 + e), below 1.
    let error = |cost: f64| (cost < 1.0).then(|| MILLI * cost / (1.0 - cost));
    let effort = |law: &&LawRecord| {
        let restart = tuning(fronts, &law.id, cap)?;
        let history = restart.history.iter();
        let mut points: Vec<[f64; 2]> =
            history.filter_map(|(count, cost)| Some([*count as f64, error(*cost)?])).collect();
        points.push([restart.evaluations as f64, points.last()?[1]]);
        Some(curve(law, points))
    };
    let all: Vec<Series> = laws.iter().filter(|law| !law.designed).filter_map(effort).collect();
    html! { @if !all.is_empty() {
        details { summary { "What a search has found after so many evaluations" }
        figure.plot {
            (picture("Error in the training worlds against evaluations",
                (Axis::log("evaluations"), Axis::log("error in the training worlds [mrad]")), all))
            figcaption { "The chosen search of each law at a cap of " (stated(100.0 * cap)) " %, from where its gains \
                keep every constraint. A curve that still falls at its end says that more evaluations would find \
                more." }
        } }
    } }
}

fn volumes(fronts: &Fronts) -> Markup {
    let mut all: Vec<_> = fronts.volumes.iter().collect();
    all.sort_by(|a, b| b.area.total_cmp(&a.area));
    let knows = |law: &str| {
        let law = fronts.laws.iter().find(|other| other.id == law);
        law.map_or_else(String::new, |law| format!("{}; {}", law.tier.words(), law.timing.words()))
    };
    html! {
        h2 { "Whole fronts in one number" }
        p { "The area above a law's front, error and noise in natural logarithms, up to the largest cap and 1 rad. \
             Half the error at every cap is ln 2 times the stretch of noise more. Larger is better; the interval is \
             over worlds and restarts." }
        details.behind { summary { (all.len()) " laws" } div.scroll tabindex="0" role="region" aria-label="Table: \
            areas above fronts" { table {
            thead { tr { th scope="col" { "law" } th scope="col" { "knows" } th scope="col" { "area" } th scope="col" {
                "95 %" } } }
            tbody { @for one in all { tr {
                th scope="row" { (name_of(fronts, &one.law)) }
                td { (knows(&one.law)) }
                td { (number(one.area)) }
                td { (number(one.interval[0])) " … " (number(one.interval[1])) }
            } } }
        } } }
    }
}

fn held_out(fronts: &Fronts) -> Markup {
    let Some(held) = &fronts.held_out else { return html! {} };
    html! {
        h2 { "On an arm that nothing was tuned on: " (line(&held.arm.robot)) }
        p { "The same scalars, in units of that arm's nominal inertia per joint." }
        details.behind { summary { (held.points.len()) " tunings" }
            div.scroll tabindex="0" role="region" aria-label="Table: the arm that nothing was tuned on" { table {
            thead { tr { @for head in ["law", "cap [%]", "noise [%]", "error [mrad]", "did not follow \
                [%]"] { th scope="col" { (head) } } } }
            tbody { @for (law, cap, chosen) in &held.points { tr {
                th scope="row" { (name_of(fronts, law)) }
                td { (stated(100.0 * cap)) }
                td { (chosen.noise.map_or("–".to_owned(), |noise| percent(noise.median))) }
                td { (chosen.error_rad.map_or("–".to_owned(), |error| number(MILLI * error.median))) }
                td { (percent(chosen.failed)) }
            } } }
        } } }
        p { "A cap of " (stated(100.0 * held.points.first().map_or(0.0, |p| p.1))) " % and more was kept on the other \
            arm; here nothing was asked." }
    }
}
