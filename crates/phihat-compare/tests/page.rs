//! Wrong if a row, a cell or a loss of the proposed law could be missing from the page of a comparison, or if a name
//! could be more than a name.

use base64::Engine as _;
use phihat_compare::{Comparison, GainsKind, RunOutcome, comparison_page, losses};
use scraper::{ElementRef, Html, Selector};
use sha2::{Digest, Sha256};

use crate::support::{IDS, WORLDS, comparison, troubled};

const COMMAND: &str = "phihat compare studies/table1.toml";

fn parsed(comparison: &Comparison) -> Html {
    Html::parse_document(&comparison_page(comparison, COMMAND))
}

fn select<'a>(document: &'a Html, selector: &str) -> Vec<ElementRef<'a>> {
    document.select(&Selector::parse(selector).unwrap()).collect()
}

fn text(element: ElementRef<'_>) -> String {
    element.text().collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The text below a heading of "When to pick another row".
fn paragraph(document: &Html) -> String {
    let lists = select(document, "ul.losses, p.no-losses");
    lists.into_iter().map(text).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_rival_and_every_cell_is_on_the_page() {
    let all = troubled();
    let document = parsed(&all);
    let page = text(document.root_element());
    for rival in &all.rivals {
        assert_eq!(select(&document, &format!("#rival-{}", rival.id)).len(), 1);
        assert!(page.contains(&rival.source) && page.contains(&rival.caveat));
    }
    for row in &all.rows {
        let part = format!("#row-{}-{}", row.arm, row.rival);
        assert_eq!(select(&document, &part).len(), 1, "{part}");
        let lines = select(&document, &format!("{part} tbody tr"));
        assert_eq!(lines.len(), row.cells.len(), "{part}");
        for cell in &row.cells {
            let command = format!("{COMMAND} --trace {}", cell.runs[0].name);
            assert!(page.contains(&command), "{command}");
        }
    }
    let sketched = all.rows.iter().flat_map(|row| &row.cells).filter(|c| c.sketch.is_some());
    assert_eq!(select(&document, "td.sketch svg").len(), 2 * sketched.count());
    for told in [
        "the reference has no period",
        "diverged at 1.25 s: elbow",
        "not a number at 0.5 s: elbow",
        "program fault: index out of range",
        "did not follow: elbow",
        "broken",
    ] {
        assert!(page.contains(told), "{told}");
    }
    let tables = select(&document, "table.map");
    assert_eq!(tables.len(), all.arms.len());
    for table in tables {
        let cells = table.select(&Selector::parse("tbody td").unwrap()).count();
        assert_eq!(cells, IDS.len() * WORLDS.len());
    }
}

#[test]
fn links_lead_somewhere_and_ids_are_unique() {
    let document = parsed(&troubled());
    let ids: Vec<_> =
        select(&document, "[id]").iter().filter_map(|e| e.value().attr("id")).collect();
    let mut unique = ids.clone();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(unique.len(), ids.len());
    for link in select(&document, "a[href]") {
        let href = link.value().attr("href").unwrap();
        assert!(href.strip_prefix('#').is_some_and(|id| ids.contains(&id)), "{href}");
    }
}

#[test]
fn sort_keys_are_numbers_and_the_best_of_a_column_is_marked_whoever_has_it() {
    let document = parsed(&comparison([3.0, 0.2, 8.0, 1.0]));
    let keys = select(&document, "[data-v]");
    assert!(keys.len() > 100);
    for cell in keys {
        let key = cell.value().attr("data-v").unwrap();
        assert!(key.parse::<f64>().is_ok_and(f64::is_finite), "{key}");
    }
    // In every table of figures the first column of error is best for the law with 0.2 mrad.
    for table in select(&document, ".wide table.sortable") {
        let rows: Vec<_> = table.select(&Selector::parse("tbody tr").unwrap()).collect();
        for (k, row) in rows.iter().enumerate() {
            let cells: Vec<_> = row.select(&Selector::parse("td").unwrap()).collect();
            assert_eq!(text(cells[3]).starts_with('★'), k == 1, "{}", text(cells[3]));
        }
    }
    // Twice the error in the second world, which is the one that gains are tuned in.
    let main = select(&document, ".wide table.sortable")[0];
    let shown =
        text(main.select(&Selector::parse("tbody tr td:nth-of-type(4)").unwrap()).next().unwrap());
    assert_eq!(shown, "6");
}

#[test]
fn losses_are_told_when_the_data_have_them_and_only_then() {
    let better = comparison([3.0, 0.2, 8.0, 1.0]);
    let told = paragraph(&parsed(&better));
    assert!(told.contains("rms error"), "{told}");
    assert!(told.contains("Computed torque (needs q, dq, model)"), "{told}");
    assert!(told.contains("0.2000 mrad against 1.000 mrad, 5 times"), "{told}");
    assert!(told.contains("better in 4 of 4 cases"), "{told}");
    assert!(told.contains("No row without a model of the arm is better"), "{told}");
    let found = losses(&better);
    let columns: Vec<_> = found.iter().map(|loss| loss.column).collect();
    assert_eq!(columns, ["rms error", "largest error", "effort", "chatter"]);
    assert!(found.iter().all(|loss| loss.ours == "proposed-1" && loss.most.by == IDS[1]));
    assert!((found[0].most.factor() - 5.0).abs() < 1e-9);

    let best = comparison([3.0, 2.0, 8.0, 1.0]);
    assert!(losses(&best).is_empty());
    assert_eq!(paragraph(&parsed(&best)), "In these runs no other row is better in any column.");
    // Within 2 % is equal.
    assert!(losses(&comparison([3.0, 0.99, 8.0, 1.0])).is_empty());
}

#[test]
fn a_row_whose_arm_did_not_follow_beats_nobody_and_loses_to_those_that_did() {
    let lost = RunOutcome::Lost { joint: "elbow".to_owned() };
    let mut still = comparison([3.0, 0.2, 8.0, 1.0]);
    let cells = |all: &mut Comparison, rival: &str| {
        let rows = all.rows.iter_mut().filter(|row| row.rival == rival);
        for cell in rows.flat_map(|row| &mut row.cells).filter(|c| c.gains == GainsKind::Tuned) {
            cell.outcome = lost.clone();
        }
    };
    cells(&mut still, IDS[1]);
    assert!(losses(&still).is_empty(), "{:?}", losses(&still));
    assert!(
        comparison_page(&still, COMMAND)
            .contains("Not drawn, because the arm did not follow: Computed torque")
    );

    let mut ours = comparison([3.0, 2.0, 8.0, 1.0]);
    cells(&mut ours, "proposed-1");
    let found = losses(&ours);
    let worlds = found.iter().find(|loss| loss.column == "worlds followed").unwrap();
    assert_eq!((worlds.most.theirs, worlds.most.mine), (2.0, Some(0.0)));
    let error = found.iter().find(|loss| loss.column == "rms error").unwrap();
    assert_eq!((error.cases, error.most.mine), (4, None));
    assert!(paragraph(&parsed(&ours)).contains("its arm did not follow"));
}

#[test]
fn a_broken_bound_is_never_the_best() {
    let mut all = comparison([3.0, 2.0, 8.0, 1.0]);
    for (row, ratio) in all.rows.iter_mut().zip([0.5, 2.0, 5.0, 3.0].into_iter().cycle()) {
        for figures in row.cells.iter_mut().filter_map(|cell| cell.worst.as_mut()) {
            figures.bound_over_measured = Some(ratio);
        }
    }
    let found = losses(&all);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].column, found[0].most.by.as_str()), ("bound / measured", IDS[1]));
}

#[test]
fn printed_ticks_stand_beside_the_measured_ones() {
    let document = parsed(&comparison([3.0, 2.0, 8.0, 1.0]));
    let ticks = select(&document, "table.ticks");
    assert_eq!(ticks.len(), 2);
    let disagree = ticks[0].select(&Selector::parse("td.disagrees").unwrap()).count();
    // Printed yes, no, partly, yes; measured yes, yes, no, yes: two of four, on the three printed rows.
    assert_eq!(disagree, 6);
    assert!(text(ticks[0]).contains("printed ✗ no: DISAGREES"));
    assert!(text(document.root_element()).contains("6 of 12 printed marks agree"));
}

#[test]
fn marks_lie_where_their_figures_are() {
    let mut all = comparison([1.0, 10.0, 100.0, 0.1]);
    for row in &mut all.rows {
        for figures in row.cells.iter_mut().filter_map(|cell| cell.worst.as_mut()) {
            figures.noise = figures.error_rms_rad.sqrt();
        }
    }
    let page = comparison_page(&all, COMMAND);
    let document = Html::parse_document(&page);
    let plot = select(&document, "figure.plot > svg")[0];
    // A mark's path begins at its middle, `M x y`, and goes on relative to it.
    let place = |path: &str| -> [f64; 2] {
        let at = path.trim_start_matches('M').split('m').next().unwrap();
        at.split(' ').map(|n| n.parse().unwrap()).collect::<Vec<_>>().try_into().unwrap()
    };
    let marks = Selector::parse("g.mark > a > path").unwrap();
    let at: Vec<_> =
        plot.select(&marks).map(|path| place(path.value().attr("d").unwrap())).collect();
    assert_eq!(at.len(), IDS.len());
    // Decades of error are equal steps up, and the noise is their root: all on one straight line.
    let step = at[1][1] - at[0][1];
    assert!(step < -50.0, "{at:?}");
    for (low, high) in [(1, 2), (3, 0)] {
        assert!((at[high][1] - at[low][1] - step).abs() < 0.21, "{at:?}");
        assert!((at[high][0] - at[low][0] - (at[1][0] - at[0][0])).abs() < 0.21, "{at:?}");
    }
    let svg = plot.html();
    roxmltree::Document::parse(&svg).unwrap();
}

/// The first part of the page names the best law, and puts none first that was too noisy.
#[test]
fn the_story_names_the_best_and_orders_all() {
    let mut all = comparison([3.0, 0.2, 8.0, 1.0]);
    let document = parsed(&all);
    let best = text(select(&document, ".best-named")[0]);
    let named = "Least error within the cap on noise (0.1 %): Computed torque, 0.4000 mrad at 0.01000 %; \
                 without a model: Proposed, m = 1, 2.000 mrad at 0.01000 %; of the proposed laws: Proposed, m = 1,";
    assert!(best.starts_with(named), "{best}");
    let users: Vec<_> = select(&document, ".users li").into_iter().map(text).collect();
    assert!(users[0].contains("do not want to tune") || users[0].contains("Proposed, m = 1"));
    assert!(users[1].ends_with("no law of this comparison is for you."), "{}", users[1]);
    assert!(users[2].contains("right: Computed torque (needs q, dq, model)"), "{}", users[2]);
    assert!(users[2].contains("Of the proposed laws, place 2 of 4"), "{}", users[2]);
    let order = |document: &Html| -> Vec<(String, String)> {
        let rows = select(document, "table.ranks")[0];
        let lines: Vec<_> = rows.select(&Selector::parse("tbody tr").unwrap()).collect();
        let cell = |line: &ElementRef<'_>, of: &str| {
            text(line.select(&Selector::parse(of).unwrap()).next().unwrap())
        };
        lines.iter().map(|line| (cell(line, "th a"), cell(line, "td"))).collect()
    };
    let names: Vec<_> = order(&document).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["Computed torque", "Proposed, m = 1", "PD", "Cascade"]);
    for cell in all.rows.iter_mut().filter(|row| row.rival == IDS[1]).flat_map(|row| &mut row.cells)
    {
        if let Some(figures) = &mut cell.worst {
            figures.noise = 2.0 * all.fairness.noise_cap;
        }
    }
    let document = parsed(&all);
    assert!(text(select(&document, ".best-named")[0]).contains(": Proposed, m = 1, 2.000 mrad"));
    let (last, mean) = order(&document).pop().unwrap();
    assert_eq!((last.as_str(), mean.as_str()), ("Computed torque", "4"));
}

#[test]
fn torque_beyond_the_cap_is_marked_where_the_arm_followed() {
    let mut all = comparison([3.0, 2.0, 8.0, 1.0]);
    assert!(!text(parsed(&all).root_element()).contains("beyond the cap on noise"));
    for cell in &mut all.rows[0].cells {
        if let Some(figures) = &mut cell.worst {
            figures.noise = 2.0 * all.fairness.noise_cap;
        }
    }
    let document = parsed(&all);
    let noted = select(&document, ".wide td .note").into_iter().map(text);
    assert_eq!(noted.filter(|note| note == "≈ 2 times the cap on noise").count(), WORLDS.len());
    for cell in &mut all.rows[0].cells {
        if let Some(figures) = &mut cell.worst {
            figures.saturated = 0.123;
        }
    }
    let document = parsed(&all);
    let noted = select(&document, ".wide td .note").into_iter().map(text);
    assert_eq!(
        noted.filter(|note| note == "≈ 12 % of samples at a torque limit").count(),
        WORLDS.len()
    );
}

#[test]
fn hostile_names_stay_names() {
    for payload in crate::hostile::PAYLOADS {
        let mut all = troubled();
        for rival in &mut all.rivals {
            for field in [
                &mut rival.title,
                &mut rival.law,
                &mut rival.caveat,
                &mut rival.source,
                &mut rival.needs_words,
            ] {
                *field = (*payload).to_string();
            }
        }
        for row in &mut all.rows {
            row.refused = row.refused.take().map(|_| (*payload).to_string());
            for cell in &mut row.cells {
                cell.runs[0].name = (*payload).to_string();
                if let Some(sketch) = &mut cell.sketch {
                    sketch.joint = (*payload).to_string();
                }
            }
        }
        all.arms[0].robot = (*payload).to_string();
        all.worlds[0].what = (*payload).to_string();
        all.fairness.notes = vec![(*payload).to_string()];
        let document = Html::parse_document(&comparison_page(&all, payload));
        assert_eq!(select(&document, "script").len(), 1, "{payload}");
        assert_eq!(select(&document, "style").len(), 1, "{payload}");
        let strange =
            "img, iframe, object, embed, base, link, form, input, image, use, foreignObject";
        assert_eq!(select(&document, strange).len(), 0, "{payload}");
        for element in select(&document, "*") {
            for (name, value) in element.value().attrs() {
                assert!(!name.starts_with("on") && name != "style" && name != "src", "{name}");
                assert!(name != "href" || value.starts_with('#'), "{value}");
            }
        }
    }
}

#[test]
fn the_policy_names_exactly_the_page_s_script_and_style() {
    let document = parsed(&troubled());
    let hash = |selector: &str| {
        let text = select(&document, selector)[0].text().collect::<String>();
        format!("'sha256-{}'", base64::prelude::BASE64_STANDARD.encode(Sha256::digest(text)))
    };
    let meta = select(&document, "meta[http-equiv=Content-Security-Policy]")[0];
    let (script, style) = (hash("script"), hash("style"));
    let expected = format!(
        "default-src 'none'; script-src {script}; style-src {style}; \
         base-uri 'none'; form-action 'none'"
    );
    assert_eq!(meta.value().attr("content").unwrap(), expected);
    let css = select(&document, "style")[0].text().collect::<String>();
    assert!(!css.contains("url(") && !css.contains("@import"));
}

#[test]
fn forty_laws_on_two_arms_stay_below_five_megabytes() {
    let mut all = comparison([3.0, 2.0, 8.0, 1.0]);
    let worlds = 3;
    all.rows = (0..10).flat_map(|_| all.rows.clone()).collect();
    for row in &mut all.rows {
        row.cells = (0..worlds).flat_map(|_| row.cells.clone()).collect();
    }
    let size = comparison_page(&all, COMMAND).len();
    assert!(size < 5_000_000, "{size} bytes");
}
