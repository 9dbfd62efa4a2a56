//! The page of specimens in the book: parts of real pages, by the one style sheet. Wrong if it were another than what
//! the pages show today; `PHIHAT_BLESS=1 cargo test -p phihat-report specimens` writes it.

use maud::{Markup, PreEscaped, html};
use phihat_design::Verdict;
use phihat_report::kit::Page;
use phihat_report::kit::shade::{Shade, shades};
use phihat_report::{RecordedBound, figures, page};
use phihat_sim::ContactRecord;
use scraper::{Html, Selector};

use crate::class::of_class;
use crate::support::Fixture;

const KEPT: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/book/src/reference/specimens.html");

/// The part of a run's page that a selector finds, with ids of its own but for the first one.
fn part(fixture: &Fixture, css: &str, place: usize) -> Markup {
    let whole = Html::parse_document(&page(&fixture.record()));
    let found = whole.select(&Selector::parse(css).unwrap()).next().unwrap().html();
    if place == 0 {
        return PreEscaped(found);
    }
    let found = found.replace("id=\"", &format!("id=\"of-{place}-"));
    PreEscaped(found.replace("labelledby=\"", &format!("labelledby=\"of-{place}-")))
}

/// A bound as it was checked, the wider by a factor.
fn checked(mut fixture: Fixture, verdict: Verdict) -> Fixture {
    let joints = fixture.metrics.joints.iter();
    let error_bound_rad = joints.map(|joint| 1.5 * joint.error_peak_rad).collect();
    fixture.run.bound = Some(RecordedBound { verdict, error_bound_rad, words: String::new() });
    fixture
}

/// A run that keeps what its study accepts.
fn plain() -> Fixture {
    let mut fixture = of_class();
    for joint in &mut fixture.metrics.joints {
        joint.error_bound_rad = Some(2.0 * joint.error_peak_rad);
    }
    fixture
}

/// A kind of standing, and a run that has it.
type Specimen = (&'static str, fn() -> Fixture);

const STANDINGS: [Specimen; 5] = [
    ("proved", || checked(plain(), Verdict::DerivedTwice)),
    ("while contacts are watched", || {
        let mut touched = checked(plain(), Verdict::DerivedTwice);
        touched.run.contact = Some(ContactRecord::default());
        touched
    }),
    ("claimed, and not proved", plain),
    ("a limit acted", || {
        let mut limited = plain();
        limited.metrics.joints[0].rate_limited_samples = 12;
        limited
    }),
    ("a run left its bound", || {
        let mut broken = plain();
        let certificate = broken.gains.certificate.as_mut().unwrap();
        certificate.class.as_deref_mut().unwrap().error_bound_rad[1] *= 0.5;
        broken
    }),
];

fn verdicts() -> Markup {
    let kinds = [
        ("within", "Within spec on all 3 joints."),
        ("limited", "Within spec, but the torque limit acted."),
        ("outside", "Outside spec on 1 of 3 joints."),
        ("unknown", "No verdict."),
    ];
    html! { @for (class, words) in kinds {
        p class={ "verdict " (class) } { strong { (words) } " A sentence beside it." }
    } }
}

fn specimens() -> String {
    let colours =
        [("measured", "measured"), ("proved", "proved"), ("limit", "accepted, or a limit")];
    let own = plain();
    let main = html! {
        header {
            h1 { "Specimens of the pages" }
            p.verdict.within { strong { "Each part of a page, once." }
                " Made by the code and the style sheet that make every page." }
        }
        h2 { "Head of a page" }
        @for (place, (words, fixture)) in STANDINGS.iter().enumerate() {
            h3 { (words) }
            (part(&fixture(), "#standing", place))
        }
        h2 { "Colours" }
        ul.bullet-key { @for (class, words) in colours { li class={ "is-" (class) } { (words) } } }
        p { span.is-thin { "caution: a margin is thin, a limit acted, nothing is proved" } " · "
            span.is-broken { "broken: a bound was left" } }
        p.key { (shades(&[
            (Shade::Step(0), "to 25 %"), (Shade::Step(1), "to 50 %"), (Shade::Step(2), "to 75 %"),
            (Shade::Step(3), "to 100 %"), (Shade::Beyond, "▲ beyond"), (Shade::Broken, "✗ missed"),
            (Shade::None, "no bar"),
        ])) }
        h2 { "Type" }
        p { "A section's title is above this text; a part's is below it." }
        h3 { "A part" }
        p { "Text of a page, at most 46 rem long, with a " a href="#type" { "link" } " and " code { "code" } "." }
        p.hint { "A note." }
        h2 { "Verdict of a specification" }
        div.measured-verdict { (verdicts()) }
        h2 { "Every joint" }
        (part(&own, "ul.bullets", 20))
        h2 { "A table" }
        (part(&own, ".scroll", 21))
        h2 { "Steps" }
        (part(&own, "ol.story", 22))
        h2 { "Buttons" }
        p { button type="button" { "button" } " " button type="button" aria-pressed="true" { "pressed" } " "
            button.stops type="button" { "stops" } }
        h2 { "Figures" }
        @for figure in figures(&own.record()).iter().filter(|own| ["nyquist", "inertia-window"].contains(&&*own.name)) {
            figure.claim { (PreEscaped(&figure.svg)) }
        }
    };
    Page { title: "Specimens", kind: "run", script: None }.document(&main)
}

#[test]
fn the_specimens_in_the_book_are_those_of_today() {
    let page = specimens();
    if std::env::var_os("PHIHAT_BLESS").is_some() {
        std::fs::write(KEPT, &page).unwrap();
    }
    let kept = std::fs::read_to_string(KEPT).unwrap_or_default();
    assert!(kept == page, "stale: PHIHAT_BLESS=1 cargo test -p phihat-report specimens");
    // Every word that a page may begin with.
    for word in ["DERIVED TWICE", "NOT PROVED", "BROKEN", "as long as nothing touches the arm"] {
        assert!(page.contains(word), "{word}");
    }
}
