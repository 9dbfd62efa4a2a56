//! The pictures of a sweep: the distribution of a figure, and the error against what varied.

use maud::{Markup, html};
use phihat_report::kit::number::tick;
use phihat_report::kit::text::line;

/// Size of a picture, and its margins: left, top, right, bottom.
const SIZE: [f64; 2] = [560.0, 320.0];
const MARGIN: [f64; 4] = [64.0, 14.0, 16.0, 48.0];

/// Bars of a histogram.
const BARS: usize = 40;

/// A linear axis over the finite values of some data.
#[derive(Debug, Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>, (from, to): (f64, f64)) -> Self {
        let range = phihat_report::kit::sheet::extent(values, 0.03);
        Self { low: range.start, high: range.end, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (self.to - self.from) * (value - self.low) / (self.high - self.low)
    }

    /// Round numbers along it, about five.
    fn ticks(&self) -> Vec<f64> {
        let length = self.high - self.low;
        let raw = length / 5.0;
        let power = libm::exp10(raw.log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
        let step = steps.into_iter().find(|step| *step >= raw).unwrap_or(raw);
        let first = (self.low / step).ceil();
        let all = (0..12_u32).map(|k| (first + f64::from(k)) * step);
        all.take_while(|x| *x <= self.high).collect()
    }
}

fn horizontal(values: impl Iterator<Item = f64>) -> Axis {
    Axis::over(values, (MARGIN[0], SIZE[0] - MARGIN[2]))
}

fn vertical(values: impl Iterator<Item = f64>) -> Axis {
    Axis::over(values, (SIZE[1] - MARGIN[3], MARGIN[1]))
}

/// A number of pixels, short.
fn px(x: f64) -> String {
    format!("{x:.1}")
}

fn frame(x: &Axis, y: &Axis, (below, beside): (&str, &str)) -> Markup {
    let (left, bottom) = (MARGIN[0], SIZE[1] - MARGIN[3]);
    html! {
        @for t in x.ticks() {
            line.grid x1=(px(x.at(t))) x2=(px(x.at(t))) y1=(px(MARGIN[1])) y2=(px(bottom)) {}
            text x=(px(x.at(t))) y=(px(bottom + 18.0)) text-anchor="middle" { (tick(t, x.high - x.low)) }
        }
        @for t in y.ticks() {
            line.grid x1=(px(left)) x2=(px(SIZE[0] - MARGIN[2])) y1=(px(y.at(t))) y2=(px(y.at(t))) {}
            text x=(px(left - 6.0)) y=(px(y.at(t) + 4.0)) text-anchor="end" { (tick(t, y.high - y.low)) }
        }
        line.axis x1=(px(left)) x2=(px(SIZE[0] - MARGIN[2])) y1=(px(bottom)) y2=(px(bottom)) {}
        line.axis x1=(px(left)) x2=(px(left)) y1=(px(MARGIN[1])) y2=(px(bottom)) {}
        text x=(px(0.5 * (left + SIZE[0]))) y=(px(SIZE[1] - 8.0)) text-anchor="middle" { (line(below)) }
        text transform=(format!("translate(14 {}) rotate(-90)", px(0.5 * bottom))) text-anchor="middle" { (line(beside)) }
    }
}

fn picture(label: &str, inside: &Markup) -> Markup {
    let view = format!("0 0 {} {}", SIZE[0], SIZE[1]);
    html! { svg viewBox=(view) role="img" aria-label=(line(label)) { (inside) } }
}

/// A figure's distribution: the share of runs at or below a value, over a histogram. `curve` is evenly spaced
/// quantiles.
pub(super) fn distribution(
    label: &str,
    unit: &str,
    curve: &[(f64, f64)],
    bound: Option<f64>,
) -> Markup {
    let finite: Vec<(f64, f64)> = curve.iter().copied().filter(|(v, _)| v.is_finite()).collect();
    let values = || finite.iter().map(|(value, _)| *value);
    let x = horizontal(values().chain(bound));
    let y = Axis { low: 0.0, high: 1.0, from: SIZE[1] - MARGIN[3], to: MARGIN[1] };
    let line: Vec<String> =
        finite.iter().map(|(v, p)| format!("{},{}", px(x.at(*v)), px(y.at(*p)))).collect();
    let width = (x.high - x.low) / BARS as f64;
    let mut counts = [0_u32; BARS];
    for value in values().skip(1) {
        let ends = |place: &usize| value < x.low + (*place + 1) as f64 * width;
        let place = (0..BARS).find(ends).unwrap_or(BARS - 1);
        counts[place] += 1;
    }
    let most = f64::from(counts.iter().copied().max().unwrap_or(1).max(1));
    let bar = |(i, count): (usize, &u32)| {
        let left = x.at(x.low + i as f64 * width);
        let top = y.at(0.9 * f64::from(*count) / most);
        (px(left), px(top), px(y.at(0.0) - top))
    };
    let bars: Vec<_> = counts.iter().enumerate().filter(|(_, n)| **n > 0).map(bar).collect();
    let below = if unit.is_empty() { label.to_owned() } else { format!("{label} [{unit}]") };
    let wide = px((x.to - x.from) / BARS as f64);
    picture(
        &format!("Distribution: {label}"),
        &html! {
            (frame(&x, &y, (&below, "share of runs")))
            @for (left, top, high) in &bars { rect.bar x=(left) y=(top) width=(wide) height=(high) {} }
            @if let Some(bound) = bound {
                line.bound x1=(px(x.at(bound))) x2=(px(x.at(bound))) y1=(px(MARGIN[1])) y2=(px(y.at(0.0))) {}
            }
            polyline.curve points=(line.join(" ")) {}
        },
    )
}

/// A run in a picture: what varied, its error, and whether it kept its bounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    pub(super) value: f64,
    /// Infinite where the run did not come to its end.
    pub(super) error: f64,
    pub(super) within: bool,
}

/// Errors against what varied; runs that did not come to their end stand at the upper edge.
pub(super) fn scatter(marks: &[Mark], (below, beside): (&str, &str), bound: Option<f64>) -> Markup {
    let x = horizontal(marks.iter().map(|mark| mark.value));
    let y = vertical(marks.iter().map(|mark| mark.error).chain(bound).chain([0.0]));
    let class = |mark: &Mark| if mark.within { "run" } else { "out" };
    let crossing = |mark: &Mark| {
        let (cx, cy) = (x.at(mark.value), MARGIN[1] + 4.0);
        format!("M{} {}l8 8m0 -8l-8 8", px(cx - 4.0), px(cy - 4.0))
    };
    let (whole, ended): (Vec<&Mark>, Vec<&Mark>) =
        marks.iter().filter(|mark| !mark.error.is_nan()).partition(|mark| mark.error.is_finite());
    picture(
        &format!("{beside} against {below}"),
        &html! {
            (frame(&x, &y, (below, beside)))
            @if let Some(bound) = bound {
                line.bound x1=(px(x.from)) x2=(px(x.to)) y1=(px(y.at(bound))) y2=(px(y.at(bound))) {}
            }
            @for mark in whole {
                circle class=(class(mark)) cx=(px(x.at(mark.value))) cy=(px(y.at(mark.error))) r="2.5" {}
            }
            @for mark in ended { path.ended d=(crossing(mark)) {} }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::{Mark, distribution, scatter};

    /// A page is HTML: an element of a picture that is not closed contains all that follow it, and none of
    /// them is shown.
    #[test]
    fn every_mark_is_closed_and_there_is_one_for_each_run() {
        let curve: Vec<_> = (0..=20).map(|k| (f64::from(k * k), f64::from(k) / 20.0)).collect();
        let one = distribution("e", "rad", &curve, Some(300.0)).into_string();
        let run = |value: f64, error: f64| Mark { value, error, within: error < 2.0 };
        let marks = [run(0.0, 1.0), run(1.0, 3.0), run(2.0, f64::INFINITY), run(3.0, f64::NAN)];
        let other = scatter(&marks, ("mass", "e"), Some(2.0)).into_string();
        for picture in [&one, &other] {
            for tag in ["svg", "line", "text", "rect", "polyline", "circle", "path"] {
                let opened = picture.matches(&format!("<{tag} ")).count();
                assert_eq!(
                    opened,
                    picture.matches(&format!("</{tag}>")).count(),
                    "{tag}: {picture}"
                );
            }
        }
        assert_eq!(one.matches("<polyline ").count(), 1);
        assert!(one.matches("<rect ").count() > 5);
        assert_eq!((other.matches("<circle ").count(), other.matches("<path ").count()), (2, 1));
    }
}
