//! Standing of the bound on the error at the head of a page: its word, the bound, the measurement, the scope.

use maud::{Markup, html};
use phihat_design::{Certificate, Tube, Verdict};
use phihat_sim::{JointMetrics, Metrics};

use crate::bound_words::UNTOUCHED;
use crate::bullet::{BulletLevels, bullet};
use crate::class::ClassRun;
use crate::kit::number::{number, percent, stated};
use crate::kit::text::{coded, line};
use crate::kit::{MILLI, unit_of};
use crate::promise::no_promise;
use crate::record::Record;
use crate::scope::{assumptions, left_out};
use crate::tube::TubeRun;

/// Word of a page for the bound on the error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum StandingWord {
    /// The run left a bound that no such run leaves.
    Broken,
    /// As `phihat verify` says it.
    Checked(Verdict),
}

impl StandingWord {
    fn words(self) -> &'static str {
        match self {
            Self::Broken => "BROKEN",
            Self::Checked(verdict) => verdict.words(),
        }
    }

    /// Class of the box.
    fn class(self) -> &'static str {
        match self {
            Self::Broken => "standing broken",
            Self::Checked(Verdict::NotProved) => "standing unproved",
            Self::Checked(_) => "standing proved",
        }
    }
}

/// Bound, measurement and specification of one joint \[rad\].
#[derive(Debug, Clone, Copy)]
struct JointStanding<'a> {
    joint: &'a JointMetrics,
    levels: BulletLevels,
}

/// The bound of a run with its word.
#[derive(Debug)]
struct RunStanding<'a> {
    word: StandingWord,
    joints: Vec<JointStanding<'a>>,
    /// Reasons why the word is not a better one.
    why: Vec<String>,
}

impl<'a> RunStanding<'a> {
    fn of(record: &Record<'a>) -> Self {
        let certificate = record.gains.and_then(|gains| gains.certificate.as_ref());
        let class = ClassRun::of(record).filter(|_| certificate.is_some_and(|c| c.tube.is_none()));
        let checked = record.run.bound.as_ref();
        let mut why = Vec::new();
        let broken = record.tube.is_some_and(|run| run.broken().is_some())
            || class.as_ref().is_some_and(ClassRun::broken);
        let word = if broken {
            why.extend(record.tube.map(TubeRun::sentence));
            why.extend(class.as_ref().map(ClassRun::sentence));
            StandingWord::Broken
        } else if let Some(checked) = checked {
            let limited = class.as_ref().filter(|_| limited(record.metrics));
            let void = limited.map(|_| "a limit acted, and the bound is no promise for this run");
            let unproved = Some(&*checked.words).filter(|_| checked.verdict == Verdict::NotProved);
            why.extend(unproved.or(void).map(str::to_owned));
            StandingWord::Checked(void.map_or(checked.verdict, |_| Verdict::NotProved))
        } else {
            why.push(unchecked(record, class.as_ref()));
            StandingWord::Checked(Verdict::NotProved)
        };
        let touched = record.run.contact.iter().flat_map(|contact| &contact.events).next();
        why.extend(touched.map(|event| {
            let (t, joint) = (stated(event.t_s), line(&event.joint));
            format!("something touched the arm at t = {t} s ({joint}): from then on the bound is no promise")
        }));
        let bound = |joint: usize| match checked {
            Some(checked) => checked.error_bound_rad.get(joint).copied(),
            None => certificate?.error_bound(joint).map(|bound| bound.error_bound_rad),
        };
        let measured = |joint: &JointMetrics| match class {
            Some(_) => joint.error_peak_rad,
            None => joint.error_steady_max_rad,
        };
        let joints = record.metrics.joints.iter().enumerate().map(|(i, joint)| {
            let (measured, proved) = (measured(joint), bound(i));
            let levels = BulletLevels { measured, proved, stated: joint.error_bound_rad };
            JointStanding { joint, levels }
        });
        Self { word, joints: joints.collect(), why }
    }

    /// The joint whose bound, or measurement where it has none, is nearest to what the study accepts.
    fn weakest(&self) -> Option<&JointStanding<'a>> {
        let share = |one: &&JointStanding<'_>| {
            let value = one.levels.proved.unwrap_or(one.levels.measured);
            one.levels.stated.map_or(value, |stated| value / stated)
        };
        self.joints.iter().max_by(|a, b| share(a).total_cmp(&share(b)))
    }

    /// Name of the joint with the largest measured error, where all turn or all slide.
    fn farthest(&self) -> Option<&'a str> {
        let slides = self.joints.first()?.joint.slides;
        let alike =
            self.joints.len() > 1 && self.joints.iter().all(|one| one.joint.slides == slides);
        let most =
            self.joints.iter().max_by(|a, b| a.levels.measured.total_cmp(&b.levels.measured))?;
        alike.then_some(most.joint.name.as_str())
    }

    /// Largest value of the joints that turn, and of those that slide, in words: `0.454 mrad and 0.2 mm`.
    fn largest(&self, of: fn(&BulletLevels) -> Option<f64>) -> Option<String> {
        let kinds = [false, true].map(|slides| {
            let own = self.joints.iter().filter(|one| one.joint.slides == slides);
            let values: Option<Vec<f64>> = own.map(|one| of(&one.levels)).collect();
            let most = values?.into_iter().reduce(f64::max)?;
            // As many digits as a stated value has, or four.
            let [short, long] = [stated(MILLI * most), number(MILLI * most)];
            let value = if short.len() < long.len() { short } else { long };
            Some(format!("{value}\u{a0}{}", unit_of("mrad", slides)))
        });
        let words: Vec<String> = kinds.into_iter().flatten().collect();
        (!words.is_empty()).then(|| words.join(" and "))
    }
}

/// Reason why a bound that was not checked again is not proved.
fn unchecked(record: &Record<'_>, class: Option<&ClassRun<'_>>) -> String {
    let Some(gains) = record.gains else {
        return "another controller ran, of which nothing is claimed".to_owned();
    };
    let Some(certificate) = &gains.certificate else {
        return "these gains carry no certificate: the figures are measurements".to_owned();
    };
    if let Some(why) = certificate.refused() {
        return format!("these gains do not arm: {why}");
    }
    if let Some(why) = certificate.without_bound() {
        return format!("no bound on the error, {why}");
    }
    if let Some(why) = certificate.class_refused.as_ref().filter(|_| certificate.tube.is_none()) {
        return format!("no bound for every motion of the class: {why}");
    }
    let void = class.and_then(|run| run.no_promise().map(str::to_owned));
    let stopped = class.is_none() || record.metrics.stopped.is_some();
    void.or_else(|| no_promise(gains, &record.run.study_sha256, stopped)).map_or_else(
        || {
            "claimed, derived once; `phihat run --verify`, or `phihat verify` with the study, derives it a second time"
                .to_owned()
        },
        |why| format!("the bound is no promise for this run: {why}"),
    )
}

/// The box at the head of the page.
pub(crate) fn standing(record: &Record<'_>) -> Markup {
    if record.metrics.joints.is_empty() {
        return html! {};
    }
    let standing = RunStanding::of(record);
    let certificate = record.gains.and_then(|gains| gains.certificate.as_ref());
    let bound = standing.largest(|levels| levels.proved);
    let claimed = standing.word == StandingWord::Checked(Verdict::NotProved);
    html! { section class=(standing.word.class()) id="standing" aria-labelledby="standing-word" {
        h2.word id="standing-word" {
            (standing.word.words())
            @if let Some(bound) = &bound {
                " " span.figure { @if claimed { "claimed " } "|e| ≤ " (bound) }
                @if record.run.contact.is_some() { " " span.while { (UNTOUCHED) } }
            }
        }
        @for why in &standing.why { p.why { (coded(&sentence(why))) } }
        div.standing-parts {
            (facts(record, &standing))
            (weakest(&standing))
        }
        @if let Some(certificate) = certificate { (folded(certificate, &standing)) }
    } }
}

fn sentence(text: &str) -> String {
    let text = line(text);
    let mut letters = text.chars();
    let first: String = letters.next().map(|c| c.to_uppercase().collect()).unwrap_or_default();
    format!("{first}{}{}", letters.as_str(), if text.ends_with('.') { "" } else { "." })
}

/// Measured, for what, limits.
fn facts(record: &Record<'_>, standing: &RunStanding<'_>) -> Markup {
    let certificate = record.gains.and_then(|gains| gains.certificate.as_ref());
    let accepted = standing.largest(|levels| levels.stated);
    html! { dl.facts {
        @if let Some(measured) = standing.largest(|levels| Some(levels.measured)) {
            dt { "measured" }
            dd {
                (measured)
                @if let Some(joint) = standing.farthest() { ", " (line(joint)) }
                @if let Some(accepted) = accepted { " · the study accepts " (accepted) }
            }
        }
        @if let Some(certificate) = certificate {
            @let words = scope(certificate, record);
            @if !words.is_empty() {
                dt { "for" } dd { (words.join(" · ")) }
            }
        }
        dt { "limits" } dd { (limits(certificate, record.metrics)) }
    } }
}

/// Scope of the bound: motion, payload, friction, stiffness.
fn scope(certificate: &Certificate, record: &Record<'_>) -> Vec<String> {
    let mut words = Vec::new();
    if let Some(tube) = &certificate.tube {
        words.push(format!("this motion from its start, {} s", stated(tube.duration_s)));
        words.push(payload(&tube.payload));
        words.push(format!("dry friction {} N·m", friction(tube)));
    } else if let Some(run) = ClassRun::of(record) {
        words.push(format!("any motion within {}", run.limits()));
        words.push(payload(&run.class.payload));
        words.push(format!("other forces up to {} N·m", ends(&run.class.force_nm)));
    } else if certificate.without_bound().is_none() {
        words.push("each joint by itself, for the stated φ".to_owned());
    } else {
        return words;
    }
    words.push("joints that do not bend".to_owned());
    words
}

fn payload(set: &phihat_design::TubePayloadSet) -> String {
    if set.mass_kg.1 > 0.0 {
        format!("payload {}", line(&set.to_string()))
    } else {
        "no payload".to_owned()
    }
}

/// Least and largest level of dry friction of all joints.
fn friction(tube: &Tube) -> String {
    let (low, high) = &tube.coulomb_nm;
    ends(&low.iter().chain(high).copied().collect::<Vec<_>>())
}

/// `0.2`, or `0.1 … 0.3` where values differ.
fn ends(values: &[f64]) -> String {
    let least = values.iter().copied().reduce(f64::min).unwrap_or(0.0);
    let most = values.iter().copied().reduce(f64::max).unwrap_or(0.0);
    if most > least { format!("{} … {}", stated(least), stated(most)) } else { stated(most) }
}

/// Returns true if a limit of torque or torque rate acted in the run.
fn limited(metrics: &Metrics) -> bool {
    metrics.joints.iter().any(|joint| joint.saturated_samples + joint.rate_limited_samples > 0)
}

/// Limits: silent by the certificate, silent in the run.
fn limits(certificate: Option<&Certificate>, metrics: &Metrics) -> Markup {
    let acted: u64 = metrics
        .joints
        .iter()
        .map(|joint| joint.saturated_samples + joint.rate_limited_samples)
        .sum();
    let tube = certificate.and_then(|all| all.tube.as_ref());
    let silent = tube.is_some_and(|tube| tube.limits_silent);
    html! {
        @if limited(metrics) {
            strong.acted { "acted" } " on " (acted) " commands of "
            (metrics.joints.iter().filter(|joint| joint.saturated_samples + joint.rate_limited_samples > 0).count())
            " joints: no certificate speaks of those samples"
        } @else { "silent: none of torque or torque rate acted in this run" @if silent { ", and by the bound none \
            can" } }
    }
}

/// The weakest joint as a bullet chart.
fn weakest(standing: &RunStanding<'_>) -> Markup {
    let Some(one) = standing.weakest() else { return html! {} };
    let unit = unit_of("mrad", one.joint.slides);
    let value = |value: f64| format!("{}\u{a0}{unit}", number(MILLI * value));
    let BulletLevels { measured, proved, stated: accepted } = one.levels;
    html! { figure.weakest {
        figcaption {
            "weakest joint: " strong { (line(&one.joint.name)) }
            @match (proved, accepted) {
                (Some(bound), Some(accepted)) => { ", whose bound is " (percent(bound, accepted)) " of what the study \
                    accepts" }
                (None, Some(accepted)) => { ", whose error is " (percent(measured, accepted)) " of what the study \
                    accepts" }
                _ => {}
            }
        }
        (bullet(&one.levels))
        ul.bullet-key {
            li.is-measured { "measured " b { (value(measured)) } }
            @if let Some(bound) = proved { li.is-proved { (bound_word(standing.word)) " " b { (value(bound)) } } }
            @if let Some(accepted) = accepted { li.is-limit { "accepted " b { (stated(MILLI * accepted)) " " (unit) } }
                }
        }
    } }
}

fn bound_word(word: StandingWord) -> &'static str {
    match word {
        StandingWord::Broken | StandingWord::Checked(Verdict::NotProved) => "claimed",
        StandingWord::Checked(Verdict::DerivedTwice) => "derived twice",
        StandingWord::Checked(Verdict::Proved) => "proved",
    }
}

/// Assumptions, what is left out, and what would make the bound smaller, one tap away.
fn folded(certificate: &Certificate, standing: &RunStanding<'_>) -> Markup {
    let (assumed, rest) = (certificate.assumptions().len(), certificate.not_counted.len());
    html! { div.folds {
        details { summary { "if " (assumed) " assumptions hold" } (assumptions(certificate)) }
        @if rest > 0 { details { summary { (rest) " not counted" } (left_out(certificate)) } }
        @if !certificate.unproved.is_empty() {
            details open { summary { "not proved of the specification" }
                ul { @for clause in &certificate.unproved { li { (line(clause)) } } }
            }
        }
        details { summary { "what would make it better" } (better(certificate, standing)) }
    } }
}

/// Changes that make the bound smaller, as far as the certificate has them, and the command that looks for more.
fn better(certificate: &Certificate, standing: &RunStanding<'_>) -> Markup {
    let paces = certificate.class.iter().flat_map(|class| &class.paces);
    let slower = paces.filter(|pace| pace.factor < 1.0).filter_map(|pace| {
        let bound = pace.error_bound_rad?;
        Some((pace.factor, bound))
    });
    html! { ul.scope {
        @if let Some(one) = standing.weakest() {
            li { "Of all joints " (line(&one.joint.name)) " is nearest to what the study accepts: begin there." }
        }
        @for (factor, bound) in slower {
            li {
                "The same gains at " (stated(factor)) " times the speed: |e| ≤ " (number(MILLI * bound))
                "\u{a0}mrad, derived once."
            }
        }
        li {
            code { "phihat design STUDY.toml --budget" } " says what the error is spent on, cause by cause; "
            "where no gains keep the specification, also which changes would help."
        }
    } }
}

/// A bullet chart of each joint.
pub(crate) fn every_joint(record: &Record<'_>) -> Markup {
    let standing = RunStanding::of(record);
    html! {
        ul.bullets { @for one in &standing.joints {
            @let unit = unit_of("mrad", one.joint.slides);
            @let value = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| number(MILLI * v));
            @let accepted = one.levels.stated.map_or_else(|| "–".to_owned(), |v| stated(MILLI * v));
            li {
                span.name { (line(&one.joint.name)) }
                (bullet(&one.levels))
                span.values { b { (number(MILLI * one.levels.measured)) } " · " (value(one.levels.proved))
                    " · " (accepted) " " (unit) }
            }
        } }
        p.hint { "Largest error of each joint: measured (bar), its bound (green line), what the study accepts \
            (dashed)." }
    }
}
