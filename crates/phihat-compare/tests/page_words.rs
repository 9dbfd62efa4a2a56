//! Wrong if the page of a comparison said more than was measured: of worlds, of gains, of what was not found
//! or counted.

use phihat_compare::{Comparison, comparison_page, losses};
use scraper::{ElementRef, Html, Selector};

use crate::support::{IDS, WORLDS, comparison};

fn parsed(comparison: &Comparison) -> Html {
    Html::parse_document(&comparison_page(comparison, "phihat compare studies/table1.toml"))
}

fn select<'a>(document: &'a Html, selector: &str) -> Vec<ElementRef<'a>> {
    document.select(&Selector::parse(selector).unwrap()).collect()
}

fn text(element: ElementRef<'_>) -> String {
    element.text().collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn effort_is_drawn_where_laws_differ_in_it_and_its_equality_is_told_elsewhere() {
    let mut all = comparison([3.0, 2.0, 8.0, 1.0]);
    let plots = |all: &Comparison| {
        let found: Vec<_> = select(&parsed(all), "figure.plot").into_iter().map(text).collect();
        (found.iter().filter(|t| t.contains("Error against effort")).count(), found.len())
    };
    // Two arms, each with noise, chatter and effort.
    assert_eq!(plots(&all), (2, 6));
    for figures in all.rows.iter_mut().flat_map(|r| &mut r.cells).filter_map(|c| c.worst.as_mut()) {
        figures.effort = 0.18;
    }
    assert_eq!(plots(&all), (0, 4));
    let page = text(parsed(&all).root_element());
    assert!(page.contains("4 of 4 laws take 18 to 18 % of the limit"), "{page}");
}

#[test]
fn the_world_with_a_push_does_not_hide_who_keeps_the_specification() {
    let mut all = comparison([0.1, 0.2, 8.0, 0.3]);
    let told = |all: &Comparison| text(select(&parsed(all), "div.verdict li")[0]);
    assert!(told(&all).contains("3 keep the specification in all of them."), "{}", told(&all));
    all.worlds[1].name = "saturation".to_owned();
    for cell in all.rows.iter_mut().flat_map(|r| &mut r.cells).filter(|c| c.world == WORLDS[1]) {
        cell.world = "saturation".to_owned();
        if let Some(figures) = &mut cell.worst {
            figures.error_over_spec = 30.0;
        }
    }
    let told = told(&all);
    assert!(told.contains("3 keep the specification in the 1 worlds without a push"), "{told}");
    assert!(told.contains("pushed with more than its torque limit, 0 keep it."), "{told}");
}

#[test]
fn the_exact_world_says_that_models_are_not() {
    let page = text(parsed(&comparison([3.0, 2.0, 8.0, 1.0])).root_element());
    assert!(page.contains("links 20 % too light, here as everywhere"), "{page}");
    assert!(page.contains("multiplied by U, one nominal inertia per joint"));
    let document = parsed(&comparison([3.0, 2.0, 8.0, 1.0]));
    for card in select(&document, "section.rival") {
        assert!(text(card).contains("a gain on torque is times U"), "{}", text(card));
    }
}

#[test]
fn designed_gains_are_called_so_once_and_are_compared_by_nothing_that_was_not_found_or_counted() {
    let mut all = comparison([3.0, 2.0, 8.0, 1.0]);
    all.rivals[3].needs.designed = true;
    all.rivals[3].scalars.clear();
    for row in all.rows.iter_mut().filter(|row| row.rival == IDS[3]) {
        let tuning = row.tuning.as_mut().unwrap();
        (tuning.default, tuning.tuned, tuning.runs_to_spec) = (vec![], vec![], Some(1));
        row.columns.as_mut().unwrap().scalars = 0;
        row.cost.as_mut().unwrap().instructions = None;
    }
    assert!(losses(&all).is_empty(), "{:?}", losses(&all));
    let document = parsed(&all);
    let part = format!("#row-{}-{}", all.arms[0].name, IDS[3]);
    let lines: Vec<_> =
        select(&document, &format!("{part} tbody th")).into_iter().map(text).collect();
    assert_eq!(lines, ["exact designed", "delay designed"]);
    let costs = select(&document, "table.costs tbody tr").into_iter().map(text).collect::<Vec<_>>();
    // Draws, runs, scalars and instructions.
    assert_eq!(costs[3].matches('–').count(), 4, "{costs:?}");
    let card = text(select(&document, &format!("#rival-{}", IDS[3]))[0]);
    assert!(card.contains("`phihat design STUDY`") && card.contains("its design wants"), "{card}");
    // A tuning that never kept the specification is worse than one that did.
    let mut never = comparison([3.0, 2.0, 8.0, 1.0]);
    for row in never.rows.iter_mut().filter(|row| row.rival == IDS[3]) {
        row.tuning.as_mut().unwrap().runs_to_spec = None;
    }
    assert_eq!(losses(&never).iter().map(|l| l.column).collect::<Vec<_>>(), ["runs to spec"]);
    assert!(text(parsed(&never).root_element()).contains("no run of this row's own tuning did"));
}

#[test]
fn gains_outside_their_own_condition_are_said_to_be() {
    let mut all = comparison([3.0, 2.0, 8.0, 1.0]);
    let marked = |all: &_| text(parsed(all).root_element()).matches("outside its own").count();
    assert_eq!(marked(&all), 0);
    let row = &mut all.rows[1];
    row.columns.as_mut().unwrap().condition.as_mut().unwrap().holds = false;
    // In both worlds, once each.
    assert_eq!(marked(&all), 2);
}
