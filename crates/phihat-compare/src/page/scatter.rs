//! Error against torque noise, chatter, and effort where laws differ in it, logarithmic: a labelled mark per law.

use crate::{ArmRecord, Comparison, Figures, GainsKind, LawRow};
use maud::{Markup, html};
use phihat_campaign::statistics::quantile;
use phihat_rivals::Needs;

use super::losses::is_proposed;
use super::names::{main_world, title};
use phihat_report::kit::MILLI;
use phihat_report::kit::anchor;
use phihat_report::kit::draw::{FigureSize, svg};
use phihat_report::kit::figure::{Axis, Figure, Ink, Marker, Panel, Series};
use phihat_report::kit::number::{number, stated};
use phihat_report::kit::text::{line, short};

/// Efforts within this part of the middle one count as the same, and this share of laws makes a figure of them idle.
const SAME_EFFORT: (f64, f64) = (0.05, 0.8);

/// A law's place in the figure.
struct LawPoint {
    id: String,
    name: String,
    kind: ModelUse,
    error: f64,
    price: f64,
}

/// Knowledge that a law has of the arm, shown by shape and colour of its mark.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ModelUse {
    Free,
    Partial,
    Model,
}

impl ModelUse {
    const ALL: [Self; 3] = [Self::Free, Self::Partial, Self::Model];

    fn words(self) -> &'static str {
        match self {
            Self::Free => "no model of the arm",
            Self::Partial => "a part of one",
            Self::Model => "the whole model",
        }
    }

    fn ink(self) -> Ink {
        Ink::Curve(match self {
            Self::Free => 0,
            Self::Partial => 1,
            Self::Model => 2,
        })
    }
}

fn kind(needs: &Needs) -> ModelUse {
    if needs.model {
        ModelUse::Model
    } else if needs.model_free() && !needs.designed {
        ModelUse::Free
    } else {
        ModelUse::Partial
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
    let least = |which: fn(&LawPoint) -> bool| points.iter().find(|point| which(point));
    let told = |point: &LawPoint| {
        let (error, noise) = (number(point.error), number(point.price));
        format!("{}, {error} mrad at {noise} %", point.name)
    };
    html! { @if let Some(best) = points.first() { p.best-named {
        "Least error within the cap on noise (" (stated(cap)) " %): " strong { (told(best)) }
        @if best.kind != ModelUse::Free && let Some(free) = least(|point| point.kind == ModelUse::Free) {
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
    let middle = quantile(&points.iter().map(|point| point.price).collect::<Vec<_>>(), 0.5)?;
    let (same, others): (Vec<_>, Vec<_>) =
        points.iter().partition(|point| (point.price - middle).abs() <= SAME_EFFORT.0 * middle);
    if points.len() < 3 || (same.len() as f64) < SAME_EFFORT.1 * points.len() as f64 {
        return None;
    }
    let percent = |value: f64| stated((10.0 * value).round() / 10.0);
    let (least, most) = (same.first()?.price, same.last()?.price);
    let others: Vec<_> =
        others.iter().map(|point| format!("{} {} %", point.name, percent(point.price))).collect();
    let rest = if others.is_empty() {
        String::new()
    } else {
        format!("; the others: {}", others.join(", "))
    };
    Some(format!(
        "Effort is not drawn: the motion asks for nearly the same torque whatever the law. {} of {} laws take {} to {} \
         % of the limit (rms, worst joint){rest}.",
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
                (name) ", gains tuned: worst of all motions, after the settling time. Below and to the left is less of \
                    both. Named are laws that none beats in both, and in a ring the paper's law and this project's; \
                    point at a mark or tap it, and it says its name. "
                "A part of a model: gravity, regressor, tip position, or a design for the arm."
                @if !absent.is_empty() { " Not drawn, because the arm did not follow: " (absent.join(", ")) "." }
            }
        }
    }
}

/// A law whose arm followed.
fn point(
    comparison: &Comparison,
    row: &LawRow,
    world: &str,
    price: fn(&Figures) -> f64,
) -> Option<LawPoint> {
    let cell = row.cell(world, GainsKind::Tuned).filter(|cell| cell.outcome.followed())?;
    let figures = cell.worst.as_ref()?;
    let (error, price) = (MILLI * figures.error_rms_rad, price(figures));
    let drawable = |value: f64| value.is_finite() && value > 0.0;
    (drawable(error) && drawable(price)).then(|| LawPoint {
        id: line(&row.rival),
        name: title(comparison, &row.rival),
        kind: comparison.rival(&row.rival).map_or(ModelUse::Free, |rival| kind(&rival.needs)),
        error,
        price,
    })
}

/// The picture, and the same for a narrow screen: without labels, which it has no room for.
fn drawing(points: &[LawPoint], name: &str, against: &Against) -> Markup {
    // Names of ours, and of laws that none beats in both: the others say theirs when they are pointed at.
    let beaten = |point: &LawPoint| {
        points.iter().any(|other| other.error < point.error && other.price < point.price)
    };
    let labelled = |point: &LawPoint| is_proposed(&point.id) || !beaten(point);
    let label = |point: &LawPoint| short(&point.name.replace(" (this project)", ""), 34);
    let marker = |point: &LawPoint| Marker {
        at: [point.price, point.error],
        label: if labelled(point) { label(point) } else { String::new() },
        note: format!(
            "{}: {} mrad, {} {}",
            point.name,
            number(point.error),
            number(point.price),
            against.unit
        ),
        link: Some(format!("#{}", anchor("rival", &point.id))),
        ink: point.kind.ink(),
        ring: is_proposed(&point.id),
    };
    // For the key alone: every point is a marker.
    let kinds =
        ModelUse::ALL.map(|kind| Series::marks(kind.words(), Vec::new()).in_ink(kind.ink()));
    let axes = (Axis::log(against.axis), Axis::log("rms error [mrad]"));
    let panel = Panel::lines("", axes, kinds.into(), Vec::new());
    let panel = Panel { markers: points.iter().map(marker).collect(), ..panel };
    let wide = Figure { title: name.to_owned(), panels: vec![panel], ..Figure::default() };
    let mut narrow = wide.clone();
    for marker in narrow.panels.iter_mut().flat_map(|panel| &mut panel.markers) {
        marker.label.clear();
    }
    html! { (svg(&wide, &FigureSize::WIDE)) (svg(&narrow, &FigureSize::NARROW)) }
}
