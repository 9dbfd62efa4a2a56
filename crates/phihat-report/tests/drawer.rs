//! The one drawer of figures. Wrong if a band, an upright bound, a spread or a marker were not where the ticks say it
//! is, a label lay on a mark, a text were too small to read, or a figure had no title and description.
#![allow(clippy::float_cmp, reason = "in a test a panic is the report")]

use phihat_report::kit::draw::{FigureSize, svg};
use phihat_report::kit::figure::{
    Axis, AxisTicks, Band, Bound, Content, Figure, Fill, Ink, Marker, Panel, Series,
};
use roxmltree::{Document, Node};

fn drawn(panel: Panel, look: &FigureSize) -> String {
    let figure = Figure {
        id: "known".into(),
        title: "A <known> figure".into(),
        panels: vec![panel],
        ..Figure::default()
    };
    svg(&figure, look).into_string()
}

fn number(node: &Node<'_, '_>, key: &str) -> f64 {
    node.attribute(key).unwrap().parse().unwrap()
}

/// Numbers of a path, whatever its letters.
fn numbers(path: &str) -> Vec<f64> {
    let split = |c: char| c.is_ascii_alphabetic() || c == ' ' || c == ',';
    path.split(split).filter(|part| !part.is_empty()).map(|part| part.parse().unwrap()).collect()
}

/// From a value to a place, by the first and the last tick of an axis: `middle` is the horizontal one.
fn ruler<'a>(document: &Document<'a>, anchor: &str, key: &str) -> impl Fn(f64) -> f64 + use<'a> {
    let ticks = document.descendants().filter(|n| n.attribute("class") == Some("tick"));
    let ticks: Vec<(f64, f64)> = ticks
        .filter(|n| n.attribute("text-anchor") == Some(anchor))
        .map(|n| (n.text().unwrap().parse().unwrap(), number(&n, key)))
        .collect();
    let (a, b) = (ticks[0], *ticks.last().unwrap());
    move |value| a.1 + (b.1 - a.1) * (value - a.0) / (b.0 - a.0)
}

/// Paths of a class.
fn paths(document: &Document<'_>, class: &str) -> Vec<Vec<f64>> {
    let of = document.descendants().filter(|n| n.attribute("class") == Some(class));
    of.filter_map(|n| n.attribute("d")).map(numbers).collect()
}

fn near(found: &[f64], exact: &[f64]) -> bool {
    found.len() == exact.len() && found.iter().zip(exact).all(|(a, b)| (a - b).abs() <= 0.11)
}

fn axes() -> (Axis, Axis) {
    (Axis::new("t [s]").over(0.0, 10.0), Axis::new("e [mrad]").over(-2.0, 2.0))
}

#[test]
fn bands_bounds_and_spreads_are_where_the_ticks_say() {
    let series =
        Series { spread: vec![[-1.0, 1.5]], ..Series::marks("measured", vec![[3.0, 0.5]]) };
    let bounds = vec![
        Bound { upright: true, ..Bound::at("edge", 7.0) },
        Bound { both: true, from: Some(4.0), ..Bound::at("bound", 1.0) },
    ];
    let steps = vec![[2.0, 4.0, -0.5, 0.5], [4.0, 12.0, -9.0, 0.25]];
    let bands = vec![Band { label: "tube".into(), steps, fill: Fill::Tube }];
    let panel = Panel { bands, ..Panel::lines("", axes(), vec![series], bounds) };
    let text = drawn(panel, &FigureSize::WIDE);
    let document = Document::parse(&text).unwrap();
    let (x, y) = (ruler(&document, "middle", "x"), ruler(&document, "end", "y"));
    // Letters stand a little lower than their tick.
    let down = 0.36 * FigureSize::WIDE.text;
    let y = |value: f64| y(value) - down;
    let rectangle =
        |[left, right, low, high]: [f64; 4]| [x(left), y(high), x(right), y(low), x(left)];
    // What leaves the axes ends at them.
    let exact = [rectangle([2.0, 4.0, -0.5, 0.5]), rectangle([4.0, 10.0, -2.0, 0.25])].concat();
    assert!(near(&paths(&document, "f2")[0], &exact), "{:?} {exact:?}", paths(&document, "f2"));
    let bounds = paths(&document, "s-bound");
    // The key has two of them; one bound is upright, the other on both sides of zero.
    assert_eq!(bounds.len(), 4);
    assert!(near(&bounds[2], &[x(7.0), y(-2.0), y(2.0)]), "{bounds:?}");
    let both = [x(4.0), y(1.0), x(10.0), x(4.0), y(-1.0), x(10.0)];
    assert!(near(&bounds[3], &both), "{bounds:?} {both:?}");
    assert!(near(&paths(&document, "s0")[0], &[x(3.0), y(-1.0), y(1.5)]));
}

#[test]
fn markers_say_what_they_are_and_lead_where_they_shall() {
    let marker = |k: u32| Marker {
        at: [f64::from(k), 0.1 * f64::from(k) - 1.0],
        label: format!("law-{k}"),
        note: format!("Law {k}: 3 mrad"),
        link: Some(format!("#law-{k}")),
        ink: Ink::Curve(1),
        ring: k == 4,
    };
    let panel = Panel::lines("", axes(), Vec::new(), Vec::new());
    let markers = (1..10).map(marker).collect();
    let text = drawn(Panel { markers, ..panel }, &FigureSize::WIDE);
    let document = Document::parse(&text).unwrap();
    let (x, y) = (ruler(&document, "middle", "x"), ruler(&document, "end", "y"));
    let marks: Vec<_> =
        document.descendants().filter(|n| n.attribute("class") == Some("mark")).collect();
    assert_eq!(marks.len(), 9);
    for (mark, k) in marks.iter().zip(1_u32..) {
        let of = |name: &str| mark.descendants().find(|n| n.has_tag_name(name)).unwrap();
        assert_eq!(of("title").text(), Some(&*format!("Law {k}: 3 mrad")));
        assert_eq!(of("a").attribute("href"), Some(&*format!("#law-{k}")));
        assert_eq!(of("text").text(), Some(&*format!("law-{k}")));
        let at = numbers(of("path").attribute("d").unwrap());
        let exact = [x(f64::from(k)), y(0.1 * f64::from(k) - 1.0) - 0.36 * FigureSize::WIDE.text];
        assert!(near(&at[..2], &exact), "{at:?} {exact:?}");
        assert_eq!(mark.descendants().any(|n| n.has_tag_name("circle")), k == 4);
    }
    assert_eq!(document.root_element().attribute("role"), Some("group"));
}

#[test]
fn names_stand_at_their_places_in_order() {
    let names = AxisTicks::Names(vec![(0.5, "last".into()), (1.5, "first".into())]);
    let y = Axis { ticks: names, ..Axis::default().over(0.0, 2.0) };
    let text =
        drawn(Panel { x: axes().0, y, ..Panel::default() }, &FigureSize::PAPER.of_height(150.0));
    let document = Document::parse(&text).unwrap();
    let at = |name: &str| {
        let node = document.descendants().find(|n| n.is_element() && n.text() == Some(name));
        number(&node.unwrap(), "y")
    };
    assert!(at("last") - at("first") > 20.0);
}

#[test]
fn every_figure_has_a_title_a_description_and_letters_that_can_be_read() {
    let lines = || {
        Panel::lines("one", axes(), vec![Series::curve("q", vec![[0.0, 0.0], [9.0, 1.0]])], vec![])
    };
    let map = Content::Map {
        x: vec![1.0, 2.0],
        y: vec![1.0, 2.0],
        cells: vec![vec![0, 1], vec![1, 1]],
        classes: vec!["stable".into(), "not".into()],
    };
    let map = Panel { content: map, x: Axis::new("rate [Hz]"), ..Panel::default() };
    for (panel, words) in [(lines(), "one: e [mrad] against t [s] (q)"), (map, "stable, not")] {
        for look in [FigureSize::PAPER, FigureSize::WIDE, FigureSize::NARROW, FigureSize::SMALL] {
            let text = drawn(panel.clone(), &look);
            let document = Document::parse(&text).unwrap();
            let root = document.root_element();
            let child = |name: &str| root.children().find(|n| n.has_tag_name(name)).unwrap().text();
            assert_eq!(child("title"), Some("A <known> figure"));
            assert_eq!(root.attribute("aria-label"), Some("A <known> figure"));
            assert!(child("desc").unwrap().contains(words), "{:?}", child("desc"));
            // On the narrowest screen that a page shows it on.
            let narrowest = match look.width {
                w if w < 500.0 => 350.0,
                w if w < 900.0 => 360.0,
                _ if look.titled => 608.0,
                _ => 768.0,
            };
            let sizes = document.descendants().filter(|n| n.attribute("font-size").is_some());
            for size in sizes.map(|n| number(&n, "font-size")) {
                assert!(size * narrowest / look.width >= 10.0, "{size} of {look:?}");
            }
        }
    }
}
