//! Wrong if opening a page could reach for anything but the page, or if the same record could
//! give two different pages.

use base64::Engine as _;
use scraper::{Html, Selector};
use sha2::{Digest, Sha256};

use crate::support::fixture;

#[test]
fn nothing_is_loaded() {
    let html = phihat_report::page(&fixture(3, 2_000).record());
    let document = Html::parse_document(&html);
    for node in document.select(&Selector::parse("*").unwrap()) {
        let element = node.value();
        let loads = ["link", "img", "iframe", "object", "embed", "base", "image", "use"];
        assert!(!loads.contains(&element.name()), "{}", element.name());
        for (name, value) in element.attrs() {
            let reaches = ["src", "href", "xlink:href", "style", "srcset", "action", "data"];
            // A link leads to a place on the page.
            let stays = element.name() == "a" && value.starts_with('#');
            assert!(stays || !reaches.contains(&name), "{name}={value}");
            assert!(!name.starts_with("on"), "{name}={value}");
            // The namespace of SVG is a name, not an address.
            assert!(name == "xmlns" || !value.contains("://"), "{name}={value}");
        }
    }
    let styles = Selector::parse("style").unwrap();
    let css: String = document.select(&styles).flat_map(|s| s.text()).collect();
    assert!(!css.contains("url(") && !css.contains("@import"));
}

#[test]
fn the_policy_names_exactly_the_page_s_scripts_and_style() {
    let html = phihat_report::page(&fixture(1, 10).record());
    let document = Html::parse_document(&html);
    let meta = Selector::parse("meta[http-equiv=Content-Security-Policy]").unwrap();
    let policy = document.select(&meta).next().unwrap().value().attr("content").unwrap();
    let hash = |selector: &str| -> Vec<String> {
        let found = Selector::parse(selector).unwrap();
        let texts = document.select(&found).map(|n| n.text().collect::<String>());
        let digest = |text: String| base64::prelude::BASE64_STANDARD.encode(Sha256::digest(text));
        texts.map(|text| format!("'sha256-{}'", digest(text))).collect()
    };
    let scripts = hash("script:not([type])").join(" ");
    let style = hash("style").join(" ");
    let expected = format!(
        "default-src 'none'; script-src {scripts}; style-src {style}; \
         base-uri 'none'; form-action 'none'"
    );
    assert_eq!(policy, expected);
}

#[test]
fn same_record_same_bytes() {
    let (a, b) = (fixture(4, 3_000), fixture(4, 3_000));
    assert_eq!(phihat_report::page(&a.record()), phihat_report::page(&b.record()));
    assert_eq!(phihat_report::figures(&a.record()), phihat_report::figures(&b.record()));
}

#[test]
fn seven_joints_for_ten_seconds_stay_below_three_megabytes() {
    let size = phihat_report::page(&fixture(7, 10_000).record()).len();
    assert!(size < 3_000_000, "{size} bytes");
}

#[test]
fn the_plot_library_is_the_one_its_note_names() {
    let note = include_str!("../assets/README.md");
    let files = [
        (&include_bytes!("../assets/uPlot.iife.min.js")[..], "uPlot.iife.min.js"),
        (&include_bytes!("../assets/uPlot.min.css")[..], "uPlot.min.css"),
    ];
    for (bytes, name) in files {
        let line = note.lines().find(|line| line.ends_with(&format!("  {name}")));
        let hex = line.and_then(|line| line.split(' ').next()).unwrap_or_default();
        let byte = |i: usize| u8::from_str_radix(&hex[i..i + 2], 16);
        let stated: Result<Vec<u8>, _> = (0..hex.len()).step_by(2).map(byte).collect();
        assert_eq!(stated, Ok(Sha256::digest(bytes).to_vec()), "{name}");
    }
}
