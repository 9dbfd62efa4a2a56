//! S14. Wrong if a name, a title or a study text could add one element, attribute or script to a
//! page, or break its data or its figures.

use scraper::{Html, Selector};
use std::collections::BTreeMap;

use crate::support::fixture;
use crate::support::hostile::PAYLOADS;

/// Number of each element and of each attribute in a document, and every script and policy.
fn shape(html: &str) -> (BTreeMap<String, usize>, Vec<String>) {
    let document = Html::parse_document(html);
    let mut counts = BTreeMap::new();
    let mut scripts = vec![];
    for node in document.select(&Selector::parse("*").unwrap()) {
        *counts.entry(node.value().name().to_owned()).or_default() += 1;
        for (name, value) in node.value().attrs() {
            *counts.entry(format!("@{name}")).or_default() += 1;
            assert!(!value.contains("hit"), "an attribute carries data: {name}={value}");
        }
        let data = node.value().attr("type") == Some("application/json");
        if node.value().name() == "script" && !data {
            scripts.push(node.text().collect());
        }
    }
    (counts, scripts)
}

fn data_of(html: &str) -> serde_json::Value {
    let document = Html::parse_document(html);
    let node = document.select(&Selector::parse("script#record").unwrap()).next().unwrap();
    serde_json::from_str(&node.text().collect::<String>()).unwrap()
}

#[test]
fn s14_no_payload_changes_the_page() {
    let harmless = shape(&phihat_report::page(&fixture(2, 40).named("arm").record()));
    for payload in PAYLOADS {
        let html = phihat_report::page(&fixture(2, 40).named(payload).record());
        assert_eq!(shape(&html), harmless, "{payload:?}");
        for raw in ["<script>window", "<img", "<iframe", "<base", "<link", "<!--", "\u{2028}"] {
            assert!(!own_markup(&html).contains(raw), "{payload:?} left {raw:?}");
        }
    }
}

/// The page without the plot library's own text.
fn own_markup(html: &str) -> String {
    let (head, rest) = html.split_once("<script>").unwrap();
    let style = head.split_once("</style>").unwrap();
    let last = rest.rsplit_once("</script>").unwrap().1;
    format!("{}{last}", style.1)
}

#[test]
fn s14_every_payload_is_shown_as_text_and_as_data() {
    for payload in PAYLOADS {
        let html = phihat_report::page(&fixture(1, 40).named(payload).record());
        let data = data_of(&html);
        let name = data["joints"][0].as_str().unwrap();
        let document = Html::parse_document(&html);
        let row = Selector::parse("tbody th").unwrap();
        let shown: String = document.select(&row).next().unwrap().text().collect();
        assert_eq!(name, shown, "{payload:?}");
        let plain = payload.split_whitespace().collect::<Vec<_>>().join(" ");
        if !payload
            .chars()
            .any(|c| c.is_control() || "\u{202e}\u{feff}\u{2028}\u{2029}".contains(c))
        {
            assert_eq!(shown, plain);
        }
    }
}

#[test]
fn s14_controls_and_direction_marks_are_made_visible() {
    let html = phihat_report::page(&fixture(1, 40).named("a\u{202e}b\u{0}c\u{1b}d").record());
    assert!(html.contains("a⟨U+202E⟩b⟨U+0000⟩c⟨U+001B⟩d"));
    assert!(!html.contains('\u{202e}') && !html.contains('\u{0}') && !html.contains('\u{1b}'));
}

#[test]
fn s14_no_payload_changes_a_figure() {
    let count = |svg: &str| {
        let document = roxmltree::Document::parse(svg).unwrap();
        let attributes = document.descendants().map(|n| n.attributes().len()).sum::<usize>();
        (document.descendants().filter(roxmltree::Node::is_element).count(), attributes)
    };
    let shapes = |name: &str| -> Vec<_> {
        let fixture = fixture(2, 40).named(name);
        phihat_report::figures(&fixture.record()).iter().map(|f| count(&f.svg)).collect()
    };
    let harmless = shapes("arm");
    for payload in PAYLOADS {
        assert_eq!(shapes(payload), harmless, "{payload:?}");
    }
}
