//! The pictures of a sweep: the distribution of a figure, and the error against what varied.

use phihat_report::kit::draw::extent;
use phihat_report::kit::figure::{Axis, Band, Bound, Figure, Fill, Ink, Panel, Series};

/// Bars of a histogram.
const BARS: usize = 40;

/// Height of the highest bar, as a share of the axis.
const HIGHEST: f64 = 0.9;

/// A figure's distribution: the share of runs at or below a value, over a histogram. `curve` is evenly spaced
/// quantiles.
pub(super) fn distribution(
    (name, unit): (&str, &str),
    curve: &[(f64, f64)],
    bound: Option<f64>,
) -> Figure {
    let finite: Vec<[f64; 2]> =
        curve.iter().filter(|(v, _)| v.is_finite()).map(|(v, p)| [*v, *p]).collect();
    let values = || finite.iter().map(|[value, _]| *value);
    let x = extent(values().chain(bound), 0.03);
    let width = (x.end - x.start) / BARS as f64;
    let edge = |place: usize| x.start + place as f64 * width;
    let mut counts = [0_u32; BARS];
    for value in values().skip(1) {
        let place = (0..BARS).find(|place| value < edge(*place + 1)).unwrap_or(BARS - 1);
        counts[place] += 1;
    }
    let most = f64::from(counts.iter().copied().max().unwrap_or(1).max(1));
    let bars = counts.iter().enumerate().filter(|(_, count)| **count > 0);
    let bars =
        bars.map(|(k, n)| [edge(k), edge(k + 1), 0.0, HIGHEST * f64::from(*n) / most]).collect();
    let bars = Band { label: "runs".to_owned(), steps: bars, fill: Fill::Bars };
    let below = if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") };
    let axes = (Axis::new(below).over(x.start, x.end), Axis::new("share of runs").over(0.0, 1.0));
    let bound = bound.map(|bound| Bound { upright: true, ..Bound::at("bound", bound) });
    let series = vec![Series::curve("at or below", finite)];
    let panel = Panel::lines("", axes, series, bound.into_iter().collect());
    let panels = vec![Panel { bands: vec![bars], ..panel }];
    Figure { title: format!("Distribution: {name}"), panels, ..Figure::default() }
}

/// A run in a picture: what varied, its error, and its verdict.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrawnRun {
    pub(super) value: f64,
    /// Infinite where the run did not come to its end.
    pub(super) error: f64,
    /// True if it kept its bounds.
    pub(super) within: bool,
}

/// Errors against what varied; runs that did not come to their end stand at the upper edge.
pub(super) fn scatter(
    runs: &[DrawnRun],
    (below, left): (&str, &str),
    bound: Option<f64>,
) -> Figure {
    let y = extent(runs.iter().map(|run| run.error).chain(bound).chain([0.0]), 0.05);
    let marks = |label: &str, ink: Ink, which: &dyn Fn(&DrawnRun) -> bool| {
        let chosen = runs.iter().filter(|run| which(run));
        let points = chosen.map(|run| [run.value, run.error.min(y.end)]).collect();
        Series::marks(label, points).in_ink(ink)
    };
    let whole = |run: &DrawnRun| run.error.is_finite();
    let all = [
        marks("kept its bounds", Ink::Curve(0), &|run| whole(run) && run.within),
        marks("broke a bound", Ink::Curve(1), &|run| whole(run) && !run.within),
        marks("did not come to its end", Ink::Curve(4), &|run| run.error == f64::INFINITY),
    ];
    let series = all.into_iter().filter(|series| !series.points.is_empty()).collect();
    let bound = bound.map(|bound| Bound { in_view: true, ..Bound::at("bound", bound) });
    let axes = (Axis::new(below), Axis::new(left).over(y.start, y.end));
    let panels = vec![Panel::lines("", axes, series, bound.into_iter().collect())];
    Figure { title: format!("{left} against {below}"), panels, ..Figure::default() }
}

#[cfg(test)]
mod tests {
    use phihat_report::kit::figure::{Content, Figure, Series};

    use super::{DrawnRun, HIGHEST, distribution, scatter};

    fn series(figure: &Figure) -> &[Series] {
        match &figure.panels[0].content {
            Content::Lines { series, .. } => series,
            Content::Map { .. } => &[],
        }
    }

    #[test]
    fn bars_count_every_run_and_the_highest_is_the_mode() {
        let curve: Vec<_> = (0..=20).map(|k| (f64::from(k * k), f64::from(k) / 20.0)).collect();
        let figure = distribution(("e", "rad"), &curve, Some(300.0));
        let bars = &figure.panels[0].bands[0].steps;
        let highs = || bars.iter().map(|step| step[3]);
        assert!((highs().fold(0.0, f64::max) - HIGHEST).abs() < 1e-12);
        // 20 runs besides the least; 1, 4 and 9 share the highest bar.
        let all: f64 = highs().sum::<f64>() * 3.0 / HIGHEST;
        assert!((all - 20.0).abs() < 1e-9 && (bars[0][3] - HIGHEST).abs() < 1e-12, "{bars:?}");
        assert_eq!(series(&figure)[0].points.len(), 21);
    }

    #[test]
    fn every_run_has_its_mark_and_one_without_an_end_is_at_the_edge() {
        let run = |value: f64, error: f64| DrawnRun { value, error, within: error < 2.0 };
        let runs = [run(0.0, 1.0), run(1.0, 3.0), run(2.0, f64::INFINITY), run(3.0, f64::NAN)];
        let figure = scatter(&runs, ("mass", "e"), Some(2.0));
        let [kept, broke, ended] = series(&figure) else { unreachable!("{figure:?}") };
        assert_eq!(kept.points, [[0.0, 1.0]]);
        assert_eq!(broke.points, [[1.0, 3.0]]);
        assert_eq!(Some(ended.points[0][1]), figure.panels[0].y.range.map(|range| range[1]));
    }
}
