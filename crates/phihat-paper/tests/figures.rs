//! Figures of a reproduction show its data. Wrong if a point, a bound or a cell were not where the axes say it is,
//! a unit of an equal panel not as long on both, or a key or label missing.
#![allow(clippy::float_cmp, reason = "in a test a panic is the report")]

use phihat_paper::{Reproduction, Section, reproduction_figures};
use phihat_report::kit::draw::FigureSize;
use phihat_report::kit::figure::{Bound, Content, Figure, Panel, Series};
use roxmltree::{Document, Node};

use crate::support::{axis, reproduction};

fn drawn(figure: Figure) -> String {
    let section = Section {
        id: "s".into(),
        title: String::new(),
        text: vec![],
        statements: vec![],
        tables: vec![],
        figures: vec![figure],
    };
    let whole = Reproduction { sections: vec![section], ..reproduction() };
    reproduction_figures(&whole).remove(0).svg
}

fn figure(panels: Vec<Panel>) -> Figure {
    Figure { id: "known".into(), title: "Known".into(), caption: String::new(), panels }
}

fn series(points: Vec<[f64; 2]>, marks: bool) -> Series {
    Series { marks, ..Series::curve("curve", points) }
}

fn number(node: &Node<'_, '_>, key: &str) -> f64 {
    node.attribute(key).unwrap().parse().unwrap()
}

/// Points of every curve of a colour: `M x,y x,y …`.
fn curves(document: &Document<'_>, colour: &str) -> Vec<Vec<(f64, f64)>> {
    let of = |n: &Node<'_, '_>| n.has_tag_name("path") && n.attribute("stroke") == Some(colour);
    let pair = |p: &str| p.split_once(',').map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap()));
    let points = |stroke: &str| stroke.split(' ').filter_map(pair).collect();
    let paths = document.descendants().filter(of).filter_map(|n| n.attribute("d"));
    paths.flat_map(|path| path.split('M').map(points).collect::<Vec<_>>()).collect()
}

/// Middles of every mark of a colour, those of the key first, and its outline.
fn marks(document: &Document<'_>, colour: &str) -> Vec<((f64, f64), String)> {
    let found = document
        .descendants()
        .filter(|n| n.has_tag_name("path") && n.attribute("fill") == Some(colour));
    let mark = |mark: &str| {
        let (at, outline) = mark.split_once('m').unwrap();
        let (x, y) = at.split_once(' ').unwrap();
        ((x.parse().unwrap(), y.parse().unwrap()), outline.to_owned())
    };
    found
        .flat_map(|n| n.attribute("d").unwrap().split('M').skip(1).map(mark).collect::<Vec<_>>())
        .collect()
}

/// Values and positions of the ticks of an axis; the anchor identifies the axis.
fn ticks(document: &Document<'_>, anchor: &str, key: &str) -> Vec<(f64, f64)> {
    let found = document.descendants().filter(|n| n.has_tag_name("text"));
    // Letters beside a tick stand a little lower than it.
    let lower = if key == "y" { 0.36 * FigureSize::PAPER.text } else { 0.0 };
    found
        .filter(|n| {
            n.attribute("text-anchor") == Some(anchor) && n.attribute("transform").is_none()
        })
        .filter_map(|n| Some((n.text()?.trim().parse().ok()?, number(&n, key) - lower)))
        .collect()
}

/// From a value to a pixel, by two ticks.
fn ruler(ticks: &[(f64, f64)], log: bool) -> impl Fn(f64) -> f64 {
    let to = move |v: f64| if log { v.log10() } else { v };
    let (a, b) = (ticks[0], *ticks.last().unwrap());
    let slope = (b.1 - a.1) / (to(b.0) - to(a.0));
    move |v| a.1 + slope * (to(v) - to(a.0))
}

const BLUE: &str = "#0072B2";

fn panel(log: bool, equal: bool, content: Content) -> Panel {
    let title = String::new();
    Panel {
        title,
        x: axis("x [s]", log, None),
        y: axis("y [m]", log, None),
        equal,
        content,
        ..Panel::default()
    }
}

fn lines(series: Vec<Series>, bounds: Vec<Bound>) -> Content {
    Content::Lines { series, bounds }
}

#[test]
fn known_points_land_where_the_ticks_say() {
    for log in [false, true] {
        let known = vec![[1.0, 3.0], [20.0, 800.0], [70.0, 5.0], [1000.0, 100.0]];
        let bound = Bound::at("bound", 50.0);
        let svg = drawn(figure(vec![panel(
            log,
            false,
            lines(vec![series(known.clone(), false)], vec![bound]),
        )]));
        let document = Document::parse(&svg).unwrap();
        let (x, y) = (ticks(&document, "middle", "x"), ticks(&document, "end", "y"));
        assert!(x.len() >= 3 && y.len() >= 3, "{x:?} {y:?}");
        let (x, y) = (ruler(&x, log), ruler(&y, log));
        let curves = curves(&document, BLUE);
        let curve = curves.iter().find(|c| c.len() == 4).unwrap();
        for (at, [px, py]) in curve.iter().zip(known) {
            assert!(
                (at.0 - x(px)).abs() <= 0.2 && (at.1 - y(py)).abs() <= 0.2,
                "{at:?} {px} {py} {log}"
            );
        }
        let mut bounds = document.descendants().filter(|n| n.attribute("class") == Some("s-bound"));
        let level = |n: Node<'_, '_>| -> f64 {
            let path = n.attribute("d").unwrap();
            path.split([' ', 'H', 'h']).nth(1).unwrap().parse().unwrap()
        };
        assert!(bounds.any(|n| (level(n) - y(50.0)).abs() <= 0.2));
    }
}

#[test]
fn marks_are_at_their_points_and_nothing_leaves_the_panel() {
    let inside = vec![[0.0, 0.0], [2.0, 3.0], [10.0, 10.0]];
    let beyond = [&inside[..], &[[4.0, 40.0], [f64::NAN, 1.0], [-7.0, 2.0]]].concat();
    let mut known = panel(false, false, lines(vec![series(beyond, true)], vec![]));
    (known.x.range, known.y.range) = (Some([0.0, 10.0]), Some([0.0, 10.0]));
    let svg = drawn(figure(vec![known]));
    let document = Document::parse(&svg).unwrap();
    let (x, y) = (ticks(&document, "middle", "x"), ticks(&document, "end", "y"));
    let (x, y) = (ruler(&x, false), ruler(&y, false));
    let marks = marks(&document, BLUE);
    // The first one stands in the key.
    assert_eq!(marks.len(), 1 + inside.len());
    for ((at, _), [px, py]) in marks[1..].iter().zip(inside) {
        assert!((at.0 - x(px)).abs() <= 0.2 && (at.1 - y(py)).abs() <= 0.2, "{at:?}");
    }
}

#[test]
fn equal_units_are_equally_long() {
    let wide = vec![[0.0, 0.0], [4.0, 1.0], [0.0, 2.0]];
    for equal in [true, false] {
        let svg = drawn(figure(vec![panel(
            false,
            equal,
            lines(vec![series(wide.clone(), false)], vec![]),
        )]));
        let document = Document::parse(&svg).unwrap();
        let (x, y) = (ticks(&document, "middle", "x"), ticks(&document, "end", "y"));
        let unit = |at: &dyn Fn(f64) -> f64| (at(1.0) - at(0.0)).abs();
        let ratio = unit(&ruler(&x, false)) / unit(&ruler(&y, false));
        assert_eq!((ratio - 1.0).abs() < 0.01, equal, "{ratio}");
    }
}

#[test]
fn cells_of_a_map_are_where_and_what_they_are() {
    let content = Content::Map {
        x: vec![10.0, 100.0, 1000.0, 1e4],
        y: vec![1.0, 2.0, 3.0],
        cells: vec![vec![0, 0, 1, 1], vec![0, 0, 1, 1], vec![2, 2, 2, 9]],
        classes: vec!["neither".into(), "ours".into(), "both".into()],
    };
    let mut map = panel(false, false, content);
    map.x.log = true;
    let svg = drawn(figure(vec![map]));
    let document = Document::parse(&svg).unwrap();
    let (x, y) = (ticks(&document, "middle", "x"), ticks(&document, "end", "y"));
    let (x, y) = (ruler(&x, true), ruler(&y, false));
    let half = 10.0_f64.sqrt();
    // Left, right, top, bottom, in values; the class beyond the list is left white.
    let right = [
        (0, [10.0 / half, 100.0 * half, 2.5, 0.5]),
        (1, [100.0 * half, 1e4 * half, 2.5, 0.5]),
        (2, [10.0 / half, 1000.0 * half, 3.5, 2.5]),
    ];
    for (class, [left, end, top, bottom]) in right {
        let fill = format!("url(#hatch-known-{class})");
        let found: Vec<_> = document
            .descendants()
            .filter(|n| n.has_tag_name("rect") && n.attribute("fill") == Some(&fill))
            .collect();
        // One in the key.
        assert_eq!(found.len(), 2, "class {class}");
        let (at_x, at_y) = (number(&found[1], "x"), number(&found[1], "y"));
        assert!((at_x - x(left)).abs() <= 0.3, "{class}: left");
        assert!((at_x + number(&found[1], "width") - x(end)).abs() <= 0.3, "{class}: right");
        assert!((at_y - y(top)).abs() <= 0.3, "{class}: top");
        assert!((at_y + number(&found[1], "height") - y(bottom)).abs() <= 0.3, "{class}: bottom");
    }
    let words: Vec<_> = document
        .descendants()
        .filter(Node::is_text)
        .filter_map(|n| n.text())
        .map(str::trim)
        .collect();
    for (letter, class) in [("A", "neither"), ("B", "ours"), ("C", "both")] {
        assert_eq!(words.iter().filter(|w| **w == letter).count(), 2, "{letter}: key and map");
        assert!(words.contains(&class));
    }
}

#[test]
fn curves_differ_by_dashes_and_marks_by_shape() {
    let whole = reproduction();
    let svg =
        |id: &str| reproduction_figures(&whole).into_iter().find(|f| f.name == id).unwrap().svg;
    let six = svg("fig-13");
    let document = Document::parse(&six).unwrap();
    let class = |n: &Node<'_, '_>| n.attribute("class").is_some_and(|c| c.starts_with('s'));
    let mut dashes: Vec<_> = document
        .descendants()
        .filter(class)
        .map(|n| n.attribute("stroke-dasharray").unwrap_or(""))
        .collect();
    dashes.sort_unstable();
    dashes.dedup();
    assert_eq!(dashes.len(), 6 + 3, "six curves and three bounds: {dashes:?}");
    assert!(six.contains("off the axis: far 100.0"));
    let marked = svg("sweep");
    let document = Document::parse(&marked).unwrap();
    let mut shapes = Vec::new();
    for colour in ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"] {
        let of = marks(&document, colour);
        assert_eq!(of.len(), 1 + 12, "{colour}: key and points");
        shapes.push(of[0].1.clone());
    }
    shapes.sort_unstable();
    shapes.dedup();
    assert_eq!(shapes.len(), 6);
}

#[test]
fn odd_data_do_not_break_a_figure() {
    let odd = [
        lines(vec![], vec![]),
        lines(vec![series(vec![], false)], vec![]),
        lines(vec![series(vec![[f64::NAN, f64::INFINITY]; 3], false)], vec![]),
        lines(vec![series(vec![[1.0, 1e300], [2.0, -1e300]], false)], vec![]),
        lines(
            vec![series(vec![[1.0, 2.0]], false); 9],
            vec![Bound { both: true, ..Bound::at("b", f64::NAN) }; 9],
        ),
        Content::Map { x: vec![], y: vec![], cells: vec![], classes: vec![] },
        Content::Map {
            x: vec![1.0],
            y: vec![2.0],
            cells: vec![vec![0]],
            classes: vec!["one".into()],
        },
        Content::Map {
            x: vec![1.0, 2.0],
            y: vec![2.0, 3.0],
            cells: vec![vec![0]],
            classes: vec!["one".into(); 9],
        },
    ];
    for content in odd {
        for (log, equal) in [(false, false), (true, false), (false, true), (true, true)] {
            let svg = drawn(figure(vec![panel(log, equal, content.clone())]));
            Document::parse(&svg).unwrap();
            assert!(!svg.contains("could not be drawn"), "{content:?} {log} {equal}");
        }
    }
    let none = drawn(figure(vec![]));
    assert!(!none.contains("could not be drawn"));
    let many =
        vec![
            panel(false, false, lines(vec![series(vec![[0.0, 1.0], [1.0, 2.0]], false)], vec![]));
            40
        ];
    assert!(!drawn(figure(many)).contains("could not be drawn"));
}
