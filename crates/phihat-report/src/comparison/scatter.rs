//! Error against effort and against chatter, logarithmic: a labelled mark per law.

use maud::{Markup, html};
use phihat_baselines::Needs;
use phihat_campaign::compare::{ArmRecord, Comparison, Figures, GainsKind, Row};

use super::labels::heights as heights_of;
use super::{main_world, title};
use crate::number::{number, tick};
use crate::text::{line, short};
use crate::verdict::MILLI;

/// Size of the figure, and its margins: left, top, right, bottom.
const SIZE: [f64; 2] = [960.0, 640.0];
const MARGIN: [f64; 4] = [70.0, 16.0, 270.0, 56.0];

/// A law's place in the figure.
struct Point {
    name: String,
    kind: Kind,
    error: f64,
    price: f64,
}

/// What a law knows of the arm, by which marks differ in shape and colour.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Free,
    Partial,
    Model,
}

const KINDS: [(Kind, &str, &str); 3] = [
    (Kind::Free, "k0", "no model of the arm"),
    (Kind::Partial, "k1", "gravity, regressor or tip position"),
    (Kind::Model, "k2", "the whole model"),
];

fn kind(needs: &Needs) -> Kind {
    if needs.model {
        Kind::Model
    } else if needs.model_free() {
        Kind::Free
    } else {
        Kind::Partial
    }
}

/// Ticks are looked for from 10^−30 to 10^30.
const DECADES: i32 = 30;

/// A logarithmic axis from data to the figure.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// An axis that holds the positive `values` with some room, from one place of the figure to another.
    fn around(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let logs = values.filter(|v| v.is_finite() && *v > 0.0).map(f64::log10);
        let (low, high) =
            logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let room = (0.08 * (high - low)).max(0.1);
        Self { low: low - room, high: high + room, from, to }
    }

    /// Where a value lies.
    fn at(&self, value: f64) -> f64 {
        self.from + (value.log10() - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// 1, 2 and 5 of every decade; over three decades and more, 1 alone.
    fn ticks(&self) -> Vec<f64> {
        let digits: &[f64] = if self.high - self.low > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let all = (-DECADES..=DECADES)
            .flat_map(|d| digits.iter().map(move |digit| digit * 10f64.powi(d)));
        all.filter(|v| (self.low..=self.high).contains(&v.log10())).collect()
    }
}

/// What the error is drawn against.
struct Against {
    title: &'static str,
    axis: &'static str,
    unit: &'static str,
    of: fn(&Figures) -> f64,
}

const AGAINST: [Against; 2] = [
    Against {
        title: "Error against effort",
        axis: "rms torque [% of the joint's limit]",
        unit: "% of the torque limit",
        of: |figures| 100.0 * figures.effort,
    },
    Against {
        title: "Error against chatter",
        axis: "mean change of torque per sample [N·m]",
        unit: "N·m per sample",
        of: |figures| figures.chatter_nm,
    },
];

/// The error against what it costs, each a figure.
pub(super) fn plots(comparison: &Comparison, arm: &ArmRecord) -> Markup {
    let Some(world) = main_world(comparison) else { return html! {} };
    html! { @for against in &AGAINST { (plot(comparison, arm, world, against)) } }
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
                (name) ", gains tuned: worst of all motions, after the settling time. Below and to the left is less of both."
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
    let cell = row.cell(world, GainsKind::Tuned).filter(|cell| cell.fate.followed())?;
    let figures = cell.worst.as_ref()?;
    let (error, price) = (MILLI * figures.error_rms_rad, price(figures));
    let drawable = |value: f64| value.is_finite() && value > 0.0;
    (drawable(error) && drawable(price)).then(|| Point {
        name: short(&title(comparison, &row.rival), 36),
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
    let heights: Vec<_> = at.iter().map(|[_, y]| *y).collect();
    let labels = heights_of(&heights, top, height - bottom);
    let column = width - right + 14.0;
    html! {
        svg role="img" aria-label=(name) viewBox=(format!("0 0 {width} {height}")) {
            (axes(&x, &y, against.axis))
            @for ([x, y], label) in at.iter().zip(&labels) {
                path.leader d=(format!("M{x:.1} {y:.1}L{:.1} {label:.1}", column - 3.0)) {}
            }
            @for ((point, [x, y]), label) in points.iter().zip(&at).zip(&labels) {
                g class=(class(point.kind)) {
                    title { (point.name) ": " (number(point.error)) " mrad, " (number(point.price)) " " (against.unit) }
                    (mark(point.kind, *x, *y))
                    text x=(column) y=(format!("{:.1}", label + 4.0)) { (point.name) }
                }
            }
        }
        p.key.kinds { @for (kind, class, words) in KINDS {
            span { svg viewBox="0 0 16 16" aria-hidden="true" { g class=(class) { (mark(kind, 8.0, 8.0)) } } " " (words) }
        } }
    }
}

fn class(kind: Kind) -> &'static str {
    KINDS.iter().find(|(of, ..)| *of == kind).map_or("k0", |(_, class, _)| class)
}

/// A circle, a square, a triangle.
fn mark(kind: Kind, x: f64, y: f64) -> Markup {
    let d = match kind {
        Kind::Free => format!("M{:.1} {y:.1}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z", x - 5.0),
        Kind::Partial => format!("M{:.1} {:.1}h9v9h-9z", x - 4.5, y - 4.5),
        Kind::Model => format!("M{x:.1} {:.1}l6 10.4h-12z", y - 6.5),
    };
    html! { path.mark d=(d) {} }
}

fn axes(x: &Axis, y: &Axis, name: &str) -> Markup {
    let [width, height] = SIZE;
    let [left, top, right, bottom] = MARGIN;
    let (low, end) = (height - bottom, width - right);
    html! {
        @for value in x.ticks() {
            path.grid d=(format!("M{:.1} {top}V{low}", x.at(value))) {}
            text.tick.below x=(format!("{:.1}", x.at(value))) y=(low + 20.0) { (tick(value, value)) }
        }
        @for value in y.ticks() {
            path.grid d=(format!("M{left} {:.1}H{end}", y.at(value))) {}
            text.tick.beside x=(left - 8.0) y=(format!("{:.1}", y.at(value) + 5.0)) { (tick(value, value)) }
        }
        path.frame d=(format!("M{left} {top}V{low}H{end}")) {}
        text.tick.below x=(f64::midpoint(left, end)) y=(height - 8.0) { (name) }
        text.tick.below transform=(format!("translate(16 {}) rotate(-90)", f64::midpoint(top, low))) { "rms error [mrad]" }
    }
}
