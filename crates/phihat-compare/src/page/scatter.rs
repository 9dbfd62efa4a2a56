//! Error against torque noise, chatter, and effort where laws differ in it, logarithmic: a labelled mark per law.

use crate::{ArmRecord, Comparison, Figures, GainsKind, Row};
use maud::{Markup, html};
use phihat_rivals::Needs;

use super::axis::{Axis, axes};
use super::labels::{Place, places};
use super::losses::is_proposed;
use super::names::{main_world, title};
use phihat_report::kit::MILLI;
use phihat_report::kit::anchor;
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::text::line;

/// Size of the figure, and its margins: left, top, right, bottom.
const SIZE: [f64; 2] = [960.0, 640.0];
const MARGIN: [f64; 4] = [70.0, 16.0, 16.0, 56.0];
/// Width of a character of a label, generously.
const CHARACTER: f64 = 6.9;

/// Efforts within this part of the middle one count as the same, and this share of laws makes a figure of them idle.
const SAME_EFFORT: (f64, f64) = (0.05, 0.8);

/// A law's place in the figure.
struct Point {
    id: String,
    name: String,
    kind: Kind,
    error: f64,
    price: f64,
}

/// Knowledge that a law has of the arm, shown by shape and colour of its mark.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Free,
    Partial,
    Model,
}

const KINDS: [(Kind, &str, &str); 3] = [
    (Kind::Free, "k0", "no model of the arm"),
    (
        Kind::Partial,
        "k1",
        "a part of one: gravity, regressor, tip position, or a design for the arm",
    ),
    (Kind::Model, "k2", "the whole model"),
];

fn kind(needs: &Needs) -> Kind {
    if needs.model {
        Kind::Model
    } else if needs.model_free() && !needs.designed {
        Kind::Free
    } else {
        Kind::Partial
    }
}

/// Quantity against which the error is drawn.
struct Against {
    title: &'static str,
    axis: &'static str,
    unit: &'static str,
    of: fn(&Figures) -> f64,
}

const NOISE: Against = Against {
    title: "Error against torque noise",
    axis: "torque noise [% of the joint's limit]",
    unit: "% of the torque limit",
    of: |figures| 100.0 * figures.noise,
};

const CHATTER: Against = Against {
    title: "Error against chatter",
    axis: "mean change of torque per sample [N·m]",
    unit: "N·m per sample",
    of: |figures| figures.chatter_nm,
};

const EFFORT: Against = Against {
    title: "Error against effort",
    axis: "rms torque [% of the joint's limit]",
    unit: "% of the torque limit",
    of: |figures| 100.0 * figures.effort,
};

/// The picture that the page opens with, and who is best in it.
pub(super) fn noise(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let Some(world) = main_world(comparison) else { return html! {} };
    html! {
        (plot(comparison, arm, world, &NOISE))
        (named_best(comparison, arm, world))
    }
}

/// The least errors of the picture among laws within the cap on noise: of all, without a model, and of the
/// proposed ones.
fn named_best(comparison: &Comparison, arm: &ArmRecord, world: &str) -> Markup {
    let cap = 100.0 * comparison.fairness.noise_cap;
    let place = |row| point(comparison, row, world, NOISE.of);
    let mut points: Vec<_> = comparison.rows_of(&arm.name).filter_map(place).collect();
    points.retain(|point| point.price <= cap);
    points.sort_by(|a, b| a.error.total_cmp(&b.error));
    let least = |which: fn(&Point) -> bool| points.iter().find(|point| which(point));
    let told = |point: &Point| {
        let (error, noise) = (number(point.error), number(point.price));
        format!("{}, {error} mrad at {noise} %", point.name)
    };
    html! { @if let Some(best) = points.first() { p.best-named {
        "Least error within the cap on noise (" (stated(cap)) " %): " strong { (told(best)) }
        @if best.kind != Kind::Free && let Some(free) = least(|point| point.kind == Kind::Free) {
            "; without a model: " strong { (told(free)) }
        }
        @if !is_proposed(&best.id) && let Some(own) = least(|point| is_proposed(&point.id)) {
            "; of the proposed laws: " strong { (told(own)) }
        }
        "."
    } } }
}

/// The error against what it costs, each a figure.
pub(super) fn plots(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let Some(world) = main_world(comparison) else { return html! {} };
    html! {
        (plot(comparison, arm, world, &CHATTER))
        @match same_effort(comparison, arm, world) {
            Some(words) => p { (words) },
            None => (plot(comparison, arm, world, &EFFORT)),
        }
    }
}

/// Why effort is not drawn, where the motion decides it and not the law.
fn same_effort(comparison: &Comparison, arm: &ArmRecord, world: &str) -> Option<String> {
    let place = |row| point(comparison, row, world, EFFORT.of);
    let mut points: Vec<_> = comparison.rows_of(&arm.name).filter_map(place).collect();
    points.sort_by(|a, b| a.price.total_cmp(&b.price));
    let middle = points.get(points.len() / 2)?.price;
    let (same, others): (Vec<_>, Vec<_>) =
        points.iter().partition(|point| (point.price - middle).abs() <= SAME_EFFORT.0 * middle);
    if points.len() < 3 || (same.len() as f64) < SAME_EFFORT.1 * points.len() as f64 {
        return None;
    }
    let percent = |value: f64| stated((10.0 * value).round() / 10.0);
    let (least, most) = (same.first()?.price, same.last()?.price);
    let others: Vec<_> =
        others.iter().map(|point| format!("{} {} %", point.id, percent(point.price))).collect();
    let rest = if others.is_empty() {
        String::new()
    } else {
        format!("; the others: {}", others.join(", "))
    };
    Some(format!(
        "Effort is not drawn: the motion asks for nearly the same torque whatever the law. {} of {} laws take {} to {} % of \
         the limit (rms, worst joint){rest}.",
        same.len(),
        points.len(),
        percent(least),
        percent(most),
    ))
}

fn plot(comparison: &Comparison, arm: &ArmRecord, world: &str, against: &Against) -> Markup {
    let place = |row| point(comparison, row, world, against.of);
    let points: Vec<_> = comparison.rows_of(&arm.name).filter_map(place).collect();
    let rows = comparison.rows_of(&arm.name).filter(|row| row.refused.is_none());
    let absent = rows.filter(|row| place(row).is_none());
    let absent: Vec<_> = absent.map(|row| title(comparison, &row.rival)).collect();
    let name = format!("{} on {}, “{}”", against.title, line(&arm.name), line(world));
    html! {
        h3 { (against.title) }
        figure.plot {
            @if points.is_empty() { p { "No arm followed in “" (line(world)) "”." } }
            @else { (drawing(&points, &name, against)) }
            figcaption {
                (name) ", gains tuned: worst of all motions, after the settling time. Below and to the left is less of both. Labels are the ids of the cards; on a small screen, tap a mark."
                @if !absent.is_empty() { " Not drawn, because the arm did not follow: " (absent.join(", ")) "." }
            }
        }
    }
}

/// A law whose arm followed.
fn point(
    comparison: &Comparison,
    row: &Row,
    world: &str,
    price: fn(&Figures) -> f64,
) -> Option<Point> {
    let cell = row.cell(world, GainsKind::Tuned).filter(|cell| cell.outcome.followed())?;
    let figures = cell.worst.as_ref()?;
    let (error, price) = (MILLI * figures.error_rms_rad, price(figures));
    let drawable = |value: f64| value.is_finite() && value > 0.0;
    (drawable(error) && drawable(price)).then(|| Point {
        id: line(&row.rival),
        name: title(comparison, &row.rival),
        kind: comparison.rival(&row.rival).map_or(Kind::Free, |rival| kind(&rival.needs)),
        error,
        price,
    })
}

fn drawing(points: &[Point], name: &str, against: &Against) -> Markup {
    let [width, height] = SIZE;
    let [left, top, right, bottom] = MARGIN;
    let x = Axis::around(points.iter().map(|p| p.price), left, width - right);
    let y = Axis::around(points.iter().map(|p| p.error), height - bottom, top);
    let at: Vec<_> = points.iter().map(|p| [x.at(p.price), y.at(p.error)]).collect();
    let widths: Vec<_> = points.iter().map(|p| CHARACTER * p.id.chars().count() as f64).collect();
    let labels = places(&at, &widths, [left + 4.0, top, width - right, height - bottom - 4.0]);
    html! {
        svg role="group" aria-label=(name) viewBox=(format!("0 0 {width} {height}")) {
            (axes(SIZE, MARGIN, (&x, &y), (against.axis, "rms error [mrad]")))
            @for (mark, label) in at.iter().zip(&labels).filter(|(_, label)| label.led) { (leader(*mark, label)) }
            @for ((point, [x, y]), label) in points.iter().zip(&at).zip(&labels) {
                g class=(class(point.kind)) {
                    title { (point.name) ": " (number(point.error)) " mrad, " (number(point.price)) " " (against.unit) }
                    (mark(point.kind, *x, *y))
                    @if is_proposed(&point.id) { circle.ours cx=(format!("{x:.1}")) cy=(format!("{y:.1}")) r="9" {} }
                    a href=(format!("#{}", anchor("rival", &point.id))) {
                        text x=(format!("{:.1}", label.left)) y=(format!("{:.1}", label.centre + 4.0)) { (point.id) }
                    }
                }
            }
        }
        p.key.kinds { @for (kind, class, words) in KINDS {
            span { svg viewBox="0 0 16 16" aria-hidden="true" { g class=(class) { (mark(kind, 8.0, 8.0)) } } " " (words) }
        }
            span { svg viewBox="0 0 22 22" aria-hidden="true" { circle.ours cx="11" cy="11" r="9" {} } " the paper's law, and this project's" }
        }
    }
}

fn leader(mark: [f64; 2], label: &Place) -> Markup {
    let ([x, y], [u, v]) = (mark, label.nearest(mark));
    html! { path.leader d=(format!("M{x:.1} {y:.1}L{u:.1} {v:.1}")) {} }
}

fn class(kind: Kind) -> &'static str {
    KINDS.iter().find(|(of, ..)| *of == kind).map_or("k0", |(_, class, _)| class)
}

/// A circle, a square, a triangle, around its place.
fn mark(kind: Kind, x: f64, y: f64) -> Markup {
    let d = match kind {
        Kind::Free => "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z",
        Kind::Partial => "M-4.5 -4.5h9v9h-9z",
        Kind::Model => "M0 -6.5l6 10.4h-12z",
    };
    html! { path.mark transform=(format!("translate({x:.1} {y:.1})")) d=(d) {} }
}
