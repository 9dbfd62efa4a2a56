//! Content between the axes of a panel.

use core::fmt::Write as _;

use maud::{Markup, html};

use super::ink::{self, Pen};
use super::key::dashes;
use super::labels::{self, Label};
use super::look::{FigureSize, Rect, px};
use super::map;
use super::scale::Scale;
use super::stroke::strokes;
use crate::kit::figure::{Axis, Band, Bound, Content, Marker, Panel, Series};
use crate::kit::number::number;
use crate::kit::text::short;

/// A bound farther out than this many times the data is written in words, not drawn: the curve would be a line.
const BOUND_REACH: f64 = 10.0;

/// Points of which one mark is smaller than usual.
const MANY: usize = 200;

/// Share of its data by which an axis is longer.
const WIDER: f64 = 0.06;

/// Both axes of a panel, from its data.
pub(super) fn ranges(panel: &Panel) -> (Scale, Scale) {
    let steps = || panel.bands.iter().flat_map(|band| &band.steps);
    let markers = || panel.markers.iter().map(|marker| marker.at);
    match &panel.content {
        Content::Lines { series, bounds } => {
            let points = || series.iter().flat_map(|curve| &curve.points);
            let marked = series.iter().any(|curve| curve.marks || curve.named);
            let wide = panel.equal || marked || !panel.markers.is_empty();
            let upright = bounds.iter().filter(|bound| bound.upright).flat_map(both);
            let x = points().map(|p| p[0]).chain(markers().map(|at| at[0])).chain(upright);
            let x = x.chain(steps().flat_map(|step| [step[0], step[1]]));
            let spread = series.iter().flat_map(|curve| curve.spread.iter().flatten().copied());
            let y = points().map(|p| p[1]).chain(markers().map(|at| at[1])).chain(spread);
            let y = y.chain(levels(series, bounds));
            let y = y.chain(steps().flat_map(|step| [step[2], step[3]]));
            (
                Scale::new(&panel.x, x, if wide { WIDER } else { 0.0 }),
                Scale::new(&panel.y, y, WIDER),
            )
        }
        Content::Map { x, y, .. } => {
            let scale = |axis: &Axis, places: &[f64]| {
                Scale::new(axis, map::edges(places, axis.log).into_iter(), 0.0)
            };
            (scale(&panel.x, x), scale(&panel.y, y))
        }
    }
}

/// The levels of the bounds across that are near enough to the data to be drawn.
fn levels<'a>(series: &'a [Series], bounds: &'a [Bound]) -> impl Iterator<Item = f64> + 'a {
    let values = series.iter().flat_map(|curve| &curve.points).map(|point| point[1].abs());
    let peak = values.filter(|v| v.is_finite()).fold(0.0, f64::max);
    let near = move |bound: &&Bound| {
        !bound.upright && (bound.in_view || bound.value.abs() <= BOUND_REACH * peak)
    };
    bounds.iter().filter(near).flat_map(both)
}

fn both(bound: &Bound) -> impl Iterator<Item = f64> + use<> {
    [Some(bound.value), bound.both.then_some(-bound.value)].into_iter().flatten()
}

/// Bounds that the axis does not reach, in words.
pub(super) fn off_axis(panel: &Panel, y: &Scale) -> Vec<String> {
    let Content::Lines { bounds, .. } = &panel.content else { return Vec::new() };
    let across = bounds.iter().filter(|bound| !bound.upright);
    let off = across.filter(|bound| !both(bound).any(|level| y.holds(y.coordinate(level))));
    off.map(|bound| {
        let sign = if bound.both { "±" } else { "" };
        format!("off the axis: {} {sign}{}", bound.label, number(bound.value))
    })
    .collect()
}

/// A panel's area with its axes and labels.
#[derive(Debug)]
pub(super) struct PanelArea<'a> {
    pub panel: &'a Panel,
    pub x: &'a Scale,
    pub y: &'a Scale,
    pub frame: Rect,
    pub look: &'a FigureSize,
    /// Id of the figure, for the names of its patterns.
    pub figure: &'a str,
}

impl PanelArea<'_> {
    /// Grid, contents, axes and labels.
    pub(super) fn draw(&self) -> Markup {
        let map = matches!(self.panel.content, Content::Map { .. });
        html! {
            (self.grid())
            @for band in &self.panel.bands { (self.band(band)) }
            @match &self.panel.content {
                Content::Lines { series, bounds } => {
                    @for (place, bound) in bounds.iter().enumerate() { (self.bound(bound, place)) }
                    @for (place, curve) in series.iter().enumerate() { (self.series(curve, place)) }
                    (self.labelled(series, bounds))
                }
                Content::Map { .. } => (map::draw(&self.panel.content, (self.x, self.y), (self.figure,
                    self.look.text)))
            }
            (self.axes(map))
        }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x.at(x), self.y.at(y)]
    }

    /// Returns true if a place lies between the axes, or on one, whatever was rounded.
    fn holds(&self, [x, y]: [f64; 2]) -> bool {
        let [left, top, right, bottom] = self.frame;
        let near = 1e-6;
        (left - near..=right + near).contains(&x) && (top - near..=bottom + near).contains(&y)
    }

    fn grid(&self) -> Markup {
        let [left, top, right, bottom] = self.frame;
        let upright = self.x.ticks.iter().filter(|tick| tick.line);
        let upright =
            upright.map(|tick| format!("M{} {}V{}", px(self.x.px(tick.at)), px(top), px(bottom)));
        let across = self.y.ticks.iter().filter(|tick| tick.line);
        let across =
            across.map(|tick| format!("M{} {}H{}", px(left), px(self.y.px(tick.at)), px(right)));
        let lines: String = upright.chain(across).collect();
        html! { path.grid d=(lines) fill="none" stroke="#dedede" stroke-width="0.8" {} }
    }

    fn axes(&self, closed: bool) -> Markup {
        let (text, [left, top, right, bottom]) = (self.look.text, self.frame);
        let mut lines = format!("M{} {}V{}H{}", px(left), px(top), px(bottom), px(right));
        if closed {
            let _ = write!(lines, "V{}z", px(top));
        }
        for tick in self.x.ticks.iter().filter(|tick| tick.line) {
            let _ = write!(lines, "M{} {}v4", px(self.x.px(tick.at)), px(bottom));
        }
        for tick in self.y.ticks.iter().filter(|tick| tick.line) {
            let _ = write!(lines, "M{} {}h-4", px(left), px(self.y.px(tick.at)));
        }
        let label = |axis: &Axis, length: f64| short(&axis.label, self.look.letters(1.15 * length));
        let below = label(&self.panel.x, right - left + 6.0 * text);
        let beside = label(&self.panel.y, bottom - top + 3.5 * text);
        // One that is longer than its axis goes on below, where there is room, and not into the title.
        let half = 0.25 * text * beside.chars().count() as f64;
        let turned = format!(
            "translate({} {}) rotate(-90)",
            px(left - self.y.widest(self.look) - 1.1 * text),
            px(f64::midpoint(top, bottom).max(top + half))
        );
        html! {
            path.axis d=(lines) fill="none" stroke="#1b1f24" stroke-width="0.8" {}
            @for tick in &self.x.ticks {
                text.tick x=(px(self.x.px(tick.at))) y=(px(bottom + 1.35 * text)) text-anchor="middle" {
                    (tick.label) }
            }
            @for tick in &self.y.ticks {
                text.tick x=(px(left - 0.5 * text)) y=(px(self.y.px(tick.at) + 0.36 * text)) text-anchor="end" {
                    (tick.label) }
            }
            text.axis-label x=(px(f64::midpoint(left, right))) y=(px(bottom + 2.8 * text)) text-anchor="middle" {
                (below) }
            @if !beside.is_empty() { text.axis-label transform=(turned) text-anchor="middle" { (beside) } }
        }
    }

    /// Rectangles of one colour, as one path.
    fn band(&self, band: &Band) -> Markup {
        let (class, colour, opacity) = ink::fill(band.fill);
        let step = |[from, to, low, high]: &[f64; 4]| {
            let (left, right) = (self.x.clamped(*from), self.x.clamped(*to));
            let (bottom, top) = (self.y.clamped(*low), self.y.clamped(*high));
            let drawable = [from, to, low, high].iter().all(|end| !end.is_nan()) && right > left;
            drawable.then(|| {
                format!("M{} {}H{}V{}H{}z", px(left), px(top), px(right), px(bottom), px(left))
            })
        };
        let steps: String = band.steps.iter().filter_map(step).collect();
        html! { @if !steps.is_empty() { path class=(class) d=(steps) fill=(colour) fill-opacity=(opacity) {} } }
    }

    fn bound(&self, bound: &Bound, place: usize) -> Markup {
        let [left, top, right, bottom] = self.frame;
        let pen = ink::bound(place);
        let line = |level: f64| {
            let (own, other) = if bound.upright { (self.x, self.y) } else { (self.y, self.x) };
            let at = own.coordinate(level);
            own.holds(at).then(|| {
                let at = own.px(at);
                let from = bound.from.map(|from| other.clamped(from));
                if bound.upright {
                    format!("M{} {}V{}", px(at), px(from.unwrap_or(bottom)), px(top))
                } else {
                    format!("M{} {}H{}", px(from.unwrap_or(left)), px(at), px(right))
                }
            })
        };
        let lines: String = both(bound).filter_map(line).collect();
        html! { @if !lines.is_empty() { (stroked(&pen, &lines)) } }
    }

    fn series(&self, curve: &Series, place: usize) -> Markup {
        let pen = ink::pen(curve.ink, place);
        let points = || curve.points.iter().map(|point| self.at(*point));
        let small = if curve.points.len() > MANY { 0.6 } else { 1.0 };
        let spread = curve.points.iter().zip(&curve.spread).map(|([x, _], [low, high])| {
            let ends = (self.y.clamped(*low), self.y.clamped(*high));
            format!("M{} {}V{}", px(self.x.at(*x)), px(ends.0), px(ends.1))
        });
        let spread: String = spread.collect();
        let strokes = if curve.marks { Vec::new() } else { strokes(points()) };
        let (single, lines): (Vec<_>, Vec<_>) = strokes.into_iter().partition(|s| s.len() < 2);
        let line = |line: &Vec<[f64; 2]>| {
            format!("M{}", line.iter().map(|at| place_of(*at)).collect::<Vec<_>>().join(" "))
        };
        let lines: String = lines.iter().map(line).collect();
        let dots = single.concat().into_iter();
        let dots = dots.chain(points().filter(|_| curve.marks || curve.named));
        let dots = dots.filter(|at| self.holds(*at));
        let dots: String =
            dots.map(|at| ink::shape(pen.shape, at, small * self.look.mark())).collect();
        let opacity = (small < 1.0).then_some("0.55");
        let [left, top, right, bottom] = self.frame;
        let [wide, high] = [px(right - left), px(bottom - top)];
        let drawn = html! {
            @if !spread.is_empty() { path class=(pen.class[0]) d=(spread) fill="none" stroke=(pen.colour)
                stroke-width="1" {} }
            // What leaves the axes is cut by a window of its own, which needs no name.
            @if !lines.is_empty() { svg x=(px(left)) y=(px(top)) width=(wide) height=(high)
                viewBox=(format!("{} {} {wide} {high}", px(left), px(top))) {
                path class=(pen.class[0]) d=(lines) fill="none" stroke=(pen.colour) stroke-width=(pen.width)
                    stroke-linejoin="round" stroke-dasharray=[dashes(&pen)] {}
            } }
            @if !dots.is_empty() { path class=(pen.class[1]) d=(dots) fill=(pen.colour) fill-opacity=[opacity] {} }
        };
        // A curve that is named at its end can be looked at alone.
        html! { @if curve.named { g.curve data-curve=(place) { (drawn) } } @else { (drawn) } }
    }

    /// Areas of marked points and of bounds.
    fn taken(&self, series: &[Series], bounds: &[Bound]) -> Vec<Rect> {
        let [left, top, right, bottom] = self.frame;
        let size = 1.2 * self.look.mark();
        let marked = series.iter().filter(|curve| curve.marks || curve.named);
        let points = marked.flat_map(|curve| &curve.points).map(|point| self.at(*point));
        let points = points.filter(|at| self.holds(*at));
        let points = points.map(|[x, y]| [x - size, y - size, x + size, y + size]);
        let levels =
            bounds.iter().flat_map(|bound| both(bound).map(|level| (bound.upright, level)));
        let lines = levels.map(|(upright, level)| {
            let at = if upright { self.x.at(level) } else { self.y.at(level) };
            if upright {
                [at - 1.0, top, at + 1.0, bottom]
            } else {
                [left, at - 1.0, right, at + 1.0]
            }
        });
        points.chain(lines).collect()
    }

    /// Markers, and the names of curves at their last point, none on another.
    fn labelled(&self, series: &[Series], bounds: &[Bound]) -> Markup {
        let inside = |at: &[f64; 2]| self.holds(*at);
        let named = series.iter().enumerate().filter(|(_, curve)| curve.named);
        let named: Vec<_> = named
            .filter_map(|(place, curve)| {
                let at = curve.points.iter().rev().map(|p| self.at(*p)).find(inside)?;
                Some((at, ink::pen(curve.ink, place), &curve.label, place))
            })
            .collect();
        let markers = self.panel.markers.iter().map(|marker| (self.at(marker.at), marker));
        let markers: Vec<_> = markers.filter(|(at, _)| inside(at)).collect();
        let at: Vec<_> =
            named.iter().map(|(at, ..)| *at).chain(markers.iter().map(|m| m.0)).collect();
        let texts = named.iter().map(|(_, _, label, _)| label.as_str());
        let texts: Vec<_> = texts.chain(markers.iter().map(|(_, m)| m.label.as_str())).collect();
        let labels =
            labels::places(&at, &texts, (self.frame, self.taken(series, bounds)), self.look);
        html! {
            @for (at, label) in at.iter().zip(&labels).filter(|(_, label)| label.led) { @let [u, v] =
                label.nearest(*at);
                path.leader d=(format!("M{} {}L{} {}", px(at[0]), px(at[1]), px(u), px(v))) fill="none"
                    stroke="#6e7781" stroke-width="0.6" {}
            }
            @for ((_, pen, text, place), label) in named.iter().zip(&labels) {
                g.curve data-curve=(place) { (self.text(label, text, pen.width > 2.0)) }
            }
            @for ((at, marker), label) in markers.iter().zip(&labels[named.len()..]) { (self.marker(*at, marker,
                label)) }
        }
    }

    fn marker(&self, at: [f64; 2], marker: &Marker, label: &Label) -> Markup {
        let pen = ink::pen(marker.ink, 0);
        let sign = html! {
            path class=(pen.class[1]) d=(ink::shape(pen.shape, at, 1.15 * self.look.mark())) fill=(pen.colour) {}
            @if !marker.label.is_empty() { (self.text(label, &marker.label, false)) }
        };
        html! { g.mark {
            @if !marker.note.is_empty() { title { (marker.note) } }
            @if let Some(link) = &marker.link { a href=(link)
                aria-label=[marker.label.is_empty().then_some(&marker.note)] { (sign) } } @else { (sign) }
            @if marker.ring { circle.s-ink cx=(px(at[0])) cy=(px(at[1])) r=(px(2.3 * self.look.mark()))
                fill="none" stroke="#1b1f24" stroke-width="1.6" {} }
        } }
    }

    fn text(&self, label: &Label, text: &str, bold: bool) -> Markup {
        let weight = bold.then_some("700");
        html! { text.halo x=(px(label.left)) y=(px(label.centre + 0.36 * self.look.text)) font-weight=[weight]
        paint-order="stroke" stroke="#fff" stroke-width="3" stroke-linejoin="round" { (text) } }
    }
}

fn place_of([x, y]: [f64; 2]) -> String {
    format!("{},{}", px(x), px(y))
}

fn stroked(pen: &Pen, path: &str) -> Markup {
    html! { path class=(pen.class[0]) d=(path) fill="none" stroke=(pen.colour) stroke-width=(pen.width)
    stroke-dasharray=[dashes(pen)] {} }
}
