//! The head of the page: who is best at one cap, and where ours stand.

use maud::{Markup, html};
use phihat_campaign::statistics::{Placebo, Spread, Standing};
use phihat_report::kit::MILLI;
use phihat_report::kit::number::{number, stated};

use super::picture::name;
use super::record::{AtCap, ChosenGains, Fronts, LawRecord};
use super::tier::{LoopKnowledge, Tier};

/// A law, and the spread of its errors \[rad\].
type LawAndError<'a> = (&'a LawRecord, Spread);

/// One sentence per tier at the cap of the details, and the band.
pub(super) fn verdict(fronts: &Fronts) -> Markup {
    let cap = main_cap(fronts);
    let place = fronts.extent.caps.iter().position(|other| other.total_cmp(&cap).is_eq());
    let band = place.and_then(|place| fronts.placebo.get(place).copied());
    html! {
        div.verdict {
            p { strong { "At a cap of " (stated(100.0 * cap)) " % of the torque limit on noise" } }
            ul.verdicts { @for tier in Tier::ALL { (sentence(fronts, tier, cap)) } }
            (chance(band))
        }
    }
}

fn sentence(fronts: &Fronts, tier: Tier, cap: f64) -> Markup {
    let laws = || fronts.laws.iter().filter(|law| law.tier == tier && law.again.is_none());
    let mut known: Vec<LawAndError<'_>> =
        laws().filter_map(|law| Some((law, found(fronts, &law.id, cap)?.1))).collect();
    known.sort_by(|a, b| a.1.median.total_cmp(&b.1.median));
    let Some((first, least)) = known.first().copied() else { return html! {} };
    let (better, worse, alike) = counts(fronts, tier, cap);
    let designed = laws().filter(|law| law.ours && law.designed);
    html! { li {
        strong { (tier.words()) } ": least median error " strong { (name(first)) } (handed(first)) ", "
        (number(MILLI * least.median)) " mrad"
        @if let Some(&(other, error)) = known.iter().find(|(law, _)| law.ours != first.ours) {
            "; of " (if other.ours { "ours" } else { "the others" }) " " (name(other)) (handed(other)) ", "
            (number(MILLI * error.median)) " mrad"
            @if is_alike(fronts, [first, other], cap) { ": no difference" }
        }
        @if let Some(place) = last_of_ours(&known) {
            ". " strong { "Of ours " (name(place)) " is the last of " (known.len()) }
        }
        @if better + worse + alike > 0 {
            ". Against the best of ours that knows no more, of the arm, of the delay and of the reference ahead, "
            (better) " of the others are better, " (worse) " worse, " (alike) " no difference"
        }
        "."
        @for law in designed { " " (by_design(law, &known)) }
    } }
}

/// Knowledge of the loop's time, where a law has some.
fn handed(law: &LawRecord) -> Markup {
    html! { @if law.timing != LoopKnowledge::default() { " (handed " (law.timing.words()) ")" } }
}

/// Returns true if one of two laws was compared with the other, with no difference.
fn is_alike(fronts: &Fronts, [one, other]: [&LawRecord; 2], cap: f64) -> bool {
    let pair = |law: &str, ours: &str| {
        (law == one.id && ours == other.id) || (law == other.id && ours == one.id)
    };
    fronts.versus.iter().any(|versus| {
        versus.cap.total_cmp(&cap).is_eq()
            && pair(&versus.law, &versus.ours)
            && versus.standing == Standing::Alike
    })
}

/// Place of gains that were designed and not tuned, whether they win or lose.
fn by_design(law: &LawRecord, known: &[LawAndError<'_>]) -> Markup {
    let place = known.iter().position(|(other, _)| other.id == law.id);
    let least = known.first().map_or(f64::NAN, |(_, error)| error.median);
    html! { @match place.and_then(|place| Some((place, known.get(place)?.1.median))) {
        Some((place, error)) => {
            strong { "By design, not tuned: " (name(law)) } ", " (number(MILLI * error)) " mrad, place " (place + 1)
            " of " (known.len()) ", " (number(error / least)) " times the least."
        }
        None => { strong { "By design, not tuned: " (name(law)) } ", no gains that keep every constraint." }
    } }
}

/// The worst of several laws, best first, where it is one of ours.
fn last_of_ours<'a>(known: &[LawAndError<'a>]) -> Option<&'a LawRecord> {
    known.last().map(|(law, _)| *law).filter(|law| law.ours && known.len() > 1)
}

fn chance(band: Option<Placebo>) -> Markup {
    html! { p { @match band.filter(|band| band.pairs > 0) {
        Some(band) => { "One law under two names, tuned and measured as two (" (band.pairs) " pairs): ratios of errors \
            from "
            (number(1.0 / band.factor)) " to " (number(band.factor)) " are no difference." }
        None => { "No law was compared with itself: nothing says how far apart chance puts two laws, and 10 % stands \
            for it." }
    } } }
}

/// Numbers of laws of a tier that are better, worse, and no different.
fn counts(fronts: &Fronts, tier: Tier, cap: f64) -> (usize, usize, usize) {
    let of = |standing: Standing| {
        let those = fronts.versus.iter().filter(|one| one.tier == tier);
        those.filter(|one| one.cap.total_cmp(&cap).is_eq() && one.standing == standing).count()
    };
    (of(Standing::Better), of(Standing::Worse), of(Standing::Alike))
}

/// The cap of the details: where most laws have gains; of equal ones the least.
pub(super) fn main_cap(fronts: &Fronts) -> f64 {
    let laws = |cap: f64| points(fronts, cap).filter(|point| point.chosen.is_some()).count();
    let mut caps = fronts.extent.caps.clone();
    caps.sort_by_key(|cap| std::cmp::Reverse(laws(*cap)));
    caps.first().copied().unwrap_or(0.0)
}

pub(super) fn points(fronts: &Fronts, cap: f64) -> impl Iterator<Item = &AtCap> {
    fronts.points.iter().filter(move |point| point.cap.total_cmp(&cap).is_eq())
}

/// The chosen gains of a law at a cap, where they follow.
pub(super) fn found<'a>(
    fronts: &'a Fronts,
    law: &str,
    cap: f64,
) -> Option<(&'a ChosenGains, Spread, Spread)> {
    let point = points(fronts, cap).find(|point| point.law == law)?;
    let chosen = point.chosen.as_ref()?;
    Some((chosen, chosen.error_rad?, chosen.noise?))
}
