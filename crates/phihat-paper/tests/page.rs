//! The page of a reproduction. Wrong if a statement, number, study or assumption were missing, a count or a link
//! wrong, if a text could become markup, or if the page could reach for anything.

use std::collections::BTreeMap;

use base64::Engine as _;
use phihat_paper::{Origin, Reproduction, Verdict, reproduction_figures, reproduction_page};
use phihat_report::kit::figure::Content;
use scraper::{ElementRef, Html, Selector};
use sha2::{Digest, Sha256};

use crate::hostile::PAYLOADS;
use crate::support::reproduction;

fn all<'a>(document: &'a Html, selector: &str) -> Vec<ElementRef<'a>> {
    document.select(&Selector::parse(selector).unwrap()).collect()
}

/// Text that is read: without the marks that only prevent a line break.
fn text(node: &ElementRef<'_>) -> String {
    let all = node.text().collect::<Vec<_>>().join(" ").replace('\u{2060}', "");
    all.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn page(reproduction: &Reproduction) -> Html {
    Html::parse_document(&reproduction_page(reproduction))
}

#[test]
fn every_statement_is_there_with_both_values_and_its_verdict_in_words() {
    let whole = reproduction();
    let document = page(&whole);
    let words = ["✓ holds as printed", "◐ holds with a correction", "✗ refuted", "? open"];
    assert_eq!(words.len(), whole.sections.iter().map(|s| s.statements.len()).sum::<usize>());
    for (statement, word) in whole.sections.iter().flat_map(|s| &s.statements).zip(words) {
        let row = &all(&document, &format!("#claim-{}", statement.id))[0];
        let cells: Vec<_> =
            row.select(&Selector::parse("th, td").unwrap()).map(|cell| text(&cell)).collect();
        assert_eq!(cells[0], statement.place);
        assert!(cells[1].starts_with(&statement.claim) && cells[1].contains(&statement.why));
        assert_eq!(cells[2], statement.paper);
        assert_eq!(cells[3], statement.ours);
        assert_eq!(cells[4], word);
        for part in [
            "largest |e|: 1.93 mrad (agrees within 2.0 %)",
            "of the printed form: none",
            "phihat run studies/paper/m1.toml",
            "Read as the largest error after 1.5 s.",
            "Varied: the start, 0.05 to 0.18 m.",
            "Another verdict at 2 mrad.",
            "Covers (48), Fig. 7.",
            "Rests on rotor-inertia",
            &statement.id,
        ] {
            assert!(cells[1].replace('\u{a0}', " ").contains(part), "{part}: {}", cells[1]);
        }
    }
    let assumption = text(&all(&document, "#assumption-rotor-inertia")[0]);
    let it = &whole.assumptions[0];
    for part in [&it.missing, &it.assumed, &it.influence, "4 statements"] {
        assert!(assumption.contains(part), "{assumption}");
    }
}

#[test]
fn counts_are_those_of_the_verdicts() {
    let mut whole = reproduction();
    whole.sections[0].statements[1].verdict = Verdict::AsPrinted;
    let document = page(&whole);
    let counts: Vec<_> = all(&document, ".counts li").iter().map(text).collect();
    assert_eq!(
        counts,
        ["✓ 2 hold as printed", "◐ 0 hold with a correction", "✗ 1 refuted", "? 1 open"]
    );
    assert!(
        text(&all(&document, ".verdict")[0])
            .starts_with("2 of 4 statements of the paper hold as printed.")
    );
    let listed = |class: &str| all(&document, &format!(".group.{class} li")).len();
    assert_eq!(["holds", "corrected", "refuted", "open"].map(listed), [2, 0, 1, 1]);
}

/// Statements that the paper does not make, or makes twice, are on the page and in no count.
#[test]
fn findings_of_ours_are_not_counted_among_the_papers() {
    let mut whole = reproduction();
    whole.sections[0].statements[0].origin = Origin::Ours;
    let (ours, id) = (&whole.sections[0].statements[0], whole.sections[0].statements[0].id.clone());
    let document = page(&whole);
    let verdict = text(&all(&document, ".verdict")[0]);
    assert!(verdict.starts_with("0 of 3 statements of the paper hold as printed."), "{verdict}");
    assert!(verdict.ends_with("0 statements looked at once more, and 1 findings of this project."));
    let beside = all(&document, ".beside li");
    assert!(beside.len() == 1 && text(&beside[0]).contains(&ours.claim));
    let row = text(&all(&document, &format!("#claim-{id} th"))[0]);
    assert!(row.contains("a finding of this project"), "{row}");
    assert_eq!(all(&document, ".group.holds li").len(), 0);
}

/// The first lines come from the counts, and every verdict that is not of the paper's statements stays out of them.
#[test]
fn the_summary_is_made_from_the_counts() {
    let mut whole = reproduction();
    let summary = |whole: &Reproduction| text(&all(&page(whole), "#summary")[0]);
    let found = summary(&whole);
    assert!(found.starts_with(
        "Of 4 statements of the paper that were tested, 2 hold: 1 as printed, 1 with a"
    ));
    assert!(found.contains("1 is refuted as worded. 1 cannot be told"), "{found}");
    assert!(found.contains("1 of 51 equations, 1 of 14 figures, 0 of 3 tables"), "{found}");
    whole.sections[1].statements[0].origin = Origin::Ours;
    assert!(summary(&whole).contains("0 are refuted as worded."));
    assert_eq!(all(&page(&whole), "#coverage tbody tr").len(), 6);
}

#[test]
fn every_link_has_its_target_and_every_id_is_one_of_its_kind() {
    let document = page(&reproduction());
    let mut ids: BTreeMap<&str, usize> = BTreeMap::new();
    for node in all(&document, "[id]") {
        *ids.entry(node.value().attr("id").unwrap()).or_default() += 1;
    }
    assert!(ids.values().all(|count| *count == 1), "{ids:?}");
    let links = all(&document, "a");
    assert!(links.len() >= 3 + 3 + 3 + 2);
    for link in links {
        let href = link.value().attr("href").unwrap();
        assert!(ids.contains_key(href.strip_prefix('#').unwrap()), "{href}");
    }
}

#[test]
fn nothing_is_loaded_and_nothing_runs_but_its_script() {
    let html = reproduction_page(&reproduction());
    let document = Html::parse_document(&html);
    let policy = all(&document, "meta[http-equiv=Content-Security-Policy]")[0];
    let style: String = all(&document, "style")[0].text().collect();
    let scripts = all(&document, "script");
    assert_eq!(scripts.len(), 1);
    let script: String = scripts[0].text().collect();
    let hash = |text: &str| base64::prelude::BASE64_STANDARD.encode(Sha256::digest(text));
    assert_eq!(
        policy.value().attr("content").unwrap(),
        format!(
            "default-src 'none'; script-src 'sha256-{}'; style-src 'sha256-{}'; base-uri 'none'; form-action 'none'",
            hash(&script),
            hash(&style)
        )
    );
    for reach in ["fetch", "XMLHttp", "import", "eval", "innerHTML", "http"] {
        assert!(!script.contains(reach), "{reach}");
    }
    assert!(!style.contains("url(") && !style.contains("@import"));
    for node in all(&document, "*") {
        let loads = ["link", "img", "iframe", "object", "embed", "base", "image", "use"];
        assert!(!loads.contains(&node.value().name()), "{}", node.value().name());
        for (name, value) in node.value().attrs() {
            let reaches = ["src", "xlink:href", "style", "srcset", "action", "data"];
            assert!(!reaches.contains(&name) && !name.starts_with("on"), "{name}={value}");
            assert!(name == "xmlns" || !value.contains("://"), "{name}={value}");
            assert!(!value.contains("url(") || value.starts_with("url(#hatch-"), "{name}={value}");
        }
    }
    assert_eq!(html, reproduction_page(&reproduction()), "same data, same bytes");
}

#[test]
fn a_part_says_so() {
    let mut part = reproduction();
    part.only = Some("figures".into());
    part.quick = true;
    let words = text(&all(&page(&part), "main")[0]);
    assert!(words.contains("A part of it only: what was chosen by “figures”"), "{words}");
    assert!(words.contains("phihat reproduce --quick --only \"figures\""), "{words}");
    let empty = Reproduction { sections: vec![], assumptions: vec![], ..reproduction() };
    assert!(text(&all(&page(&empty), "main")[0]).contains("0 of 0 statements"));
}

/// Puts a text in every place that takes one.
fn named(name: &str) -> Reproduction {
    let mut whole = reproduction();
    let set = |field: &mut String| name.clone_into(field);
    set(&mut whole.phihat_version);
    for a in &mut whole.assumptions {
        [&mut a.missing, &mut a.assumed, &mut a.influence].into_iter().for_each(set);
    }
    for section in &mut whole.sections {
        set(&mut section.title);
        section.text.iter_mut().for_each(set);
        for s in &mut section.statements {
            [&mut s.place, &mut s.claim, &mut s.paper, &mut s.ours, &mut s.why]
                .into_iter()
                .for_each(set);
            s.numbers.iter_mut().map(|n| &mut n.unit).for_each(set);
            s.studies.iter_mut().for_each(set);
        }
        for t in &mut section.tables {
            set(&mut t.title);
            t.columns.iter_mut().chain(t.rows.iter_mut().flatten()).for_each(set);
        }
        for figure in &mut section.figures {
            [&mut figure.title, &mut figure.caption].into_iter().for_each(set);
            for panel in &mut figure.panels {
                [&mut panel.title, &mut panel.x.label, &mut panel.y.label]
                    .into_iter()
                    .for_each(set);
                match &mut panel.content {
                    Content::Lines { series, bounds } => {
                        series.iter_mut().map(|s| &mut s.label).for_each(set);
                        bounds.iter_mut().map(|b| &mut b.label).for_each(set);
                    }
                    Content::Map { classes, .. } => classes.iter_mut().for_each(set),
                }
            }
        }
    }
    whole
}

#[test]
fn no_text_becomes_markup() {
    let shape = |whole: &Reproduction| {
        let document = page(whole);
        let mut counts: BTreeMap<String, usize> = BTreeMap::new();
        for node in all(&document, "*") {
            let name = node.value().name();
            // A text takes more or fewer lines of a figure's key.
            if !["text", "polyline", "rect", "polygon"].contains(&name) {
                *counts.entry(name.to_owned()).or_default() += 1;
            }
            for (name, value) in node.value().attrs() {
                assert!(!name.starts_with("on"), "{name}={value}");
            }
        }
        counts
    };
    let harmless = shape(&named("arm"));
    for payload in PAYLOADS {
        assert_eq!(shape(&named(payload)), harmless, "{payload:?}");
        for figure in reproduction_figures(&named(payload)) {
            roxmltree::Document::parse(&figure.svg).unwrap();
            assert!(!figure.svg.contains("could not be drawn"), "{payload:?}");
        }
    }
}

#[test]
fn a_column_of_words_is_set_as_words_and_one_of_figures_is_not() {
    let mut whole = reproduction();
    let table = &mut whole.sections[1].tables[0];
    table.columns = ["place", "printed", "largest |e| [rad]"].map(str::to_owned).into();
    let rows =
        [["(32)", "2 of the terms are left out of it", "1.2e-3"], ["(39)", "a minus", "none"]];
    table.rows = rows.iter().map(|row| row.map(str::to_owned).into()).collect();
    let document = page(&whole);
    let id = format!("#table-{}", whole.sections[1].tables[0].id);
    let words = |tag: &str| -> Vec<bool> {
        let cells = all(&document, &format!("{id} {tag}"));
        cells.iter().map(|cell| cell.value().classes().any(|class| class == "text")).collect()
    };
    assert_eq!(words("tbody td"), [true, false, true, false]);
    assert_eq!(words("thead th")[1..], [true, false]);
    // A bar and what it stands around are never parted.
    assert!(reproduction_page(&whole).contains("largest |\u{2060}e| [rad]"));
}
