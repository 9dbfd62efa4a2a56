//! Small words for putting a [`Section`](crate::record::Section) together.

use super::record::{Origin, PaperNumber, Section, Statement, Table, Verdict};
use phihat_report::kit::figure::{Axis, Bound, Figure, Panel, Series};

/// Most points of a curve: more than a figure can show.
const POINTS: usize = 600;

/// A number; one that is not finite is none.
pub(crate) fn number(
    name: &str,
    unit: &str,
    value: impl Into<Option<f64>>,
    tolerance: f64,
) -> PaperNumber {
    let value = value.into().filter(|value: &f64| value.is_finite());
    PaperNumber { name: name.to_owned(), unit: unit.to_owned(), value, tolerance }
}

/// Owned words.
pub(crate) fn words<S: AsRef<str>>(words: &[S]) -> Vec<String> {
    words.iter().map(|word| word.as_ref().to_owned()).collect()
}

/// A linear axis over its data.
pub(crate) fn axis(label: &str) -> Axis {
    Axis::new(label)
}

/// A linear axis with stated ends.
pub(crate) fn axis_over(label: &str, from: f64, to: f64) -> Axis {
    Axis::new(label).over(from, to)
}

/// A logarithmic axis over its data.
pub(crate) fn log_axis(label: &str) -> Axis {
    Axis::log(label)
}

/// A curve, thinned evenly to what a figure can show; the last point stays.
pub(crate) fn curve(label: &str, points: impl IntoIterator<Item = [f64; 2]>) -> Series {
    let all: Vec<[f64; 2]> = points.into_iter().collect();
    let stride = all.len().div_ceil(POINTS).max(1);
    let mut points: Vec<[f64; 2]> = all.iter().copied().step_by(stride).collect();
    if let Some(last) = all.last().filter(|last| points.last() != Some(*last)) {
        points.push(*last);
    }
    Series::curve(label, points)
}

/// A curve in the plane, thinned evenly along its way: what is quick keeps its shape. The ends stay.
pub(crate) fn way(label: &str, points: impl IntoIterator<Item = [f64; 2]>) -> Series {
    let all: Vec<[f64; 2]> = points.into_iter().collect();
    let pairs = || all.iter().zip(all.iter().skip(1));
    let steps = || pairs().map(|([x, y], [u, v])| (u - x).hypot(v - y));
    let apart = steps().sum::<f64>() / POINTS as f64;
    let mut points: Vec<[f64; 2]> = all.first().copied().into_iter().collect();
    let mut since = 0.0;
    for (step, point) in steps().zip(all.iter().skip(1)) {
        since += step;
        if since >= apart {
            points.push(*point);
            since = 0.0;
        }
    }
    if let Some(last) = all.last().filter(|last| points.last() != Some(*last)) {
        points.push(*last);
    }
    Series::curve(label, points)
}

/// Marked points.
pub(crate) fn marks(label: &str, points: Vec<[f64; 2]>) -> Series {
    Series::marks(label, points)
}

/// A bound on both sides of zero.
pub(crate) fn bound(label: &str, value: f64) -> Bound {
    Bound { both: true, ..Bound::at(label, value) }
}

/// A panel of curves.
pub(crate) fn lines(
    title: &str,
    (x, y): (Axis, Axis),
    series: Vec<Series>,
    bounds: Vec<Bound>,
) -> Panel {
    Panel::lines(title, (x, y), series, bounds)
}

/// A number of three digits in the unit that suits it, `—` for none.
pub(crate) fn three(value: Option<f64>) -> String {
    let Some(value) = value.filter(|value| value.is_finite()) else { return "none".to_owned() };
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e5).contains(&size) {
        format!("{value:.2e}")
    } else if size < 1.0 {
        let digits = if size < 1e-2 {
            5
        } else if size < 1e-1 {
            4
        } else {
            3
        };
        format!("{value:.digits$}")
    } else if size < 10.0 {
        format!("{value:.2}")
    } else if size < 100.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    }
}

/// A statement of the paper, `[id, place, claim, paper]`, with what came of it; see [`rests_on`].
pub(crate) fn statement(
    [id, place, claim, paper]: [&str; 4],
    verdict: Verdict,
    (ours, why): (String, String),
    numbers: Vec<PaperNumber>,
) -> Statement {
    Statement {
        id: id.to_owned(),
        place: place.to_owned(),
        origin: Origin::Paper,
        claim: claim.to_owned(),
        paper: paper.to_owned(),
        ours,
        verdict,
        reading: String::new(),
        varied: String::new(),
        turns: String::new(),
        covers: Vec::new(),
        why,
        numbers,
        assumptions: Vec::new(),
        studies: Vec::new(),
    }
}

/// An empty section.
pub(crate) fn section(id: &str, title: &str, text: &[&str]) -> Section {
    Section {
        id: id.to_owned(),
        title: title.to_owned(),
        text: words(text),
        statements: Vec::new(),
        tables: Vec::new(),
        figures: Vec::new(),
    }
}

/// Every statement of a section rests on these assumptions and studies.
pub(crate) fn rests_on(section: &mut Section, assumptions: &[&str], studies: &[String]) {
    for statement in &mut section.statements {
        statement.assumptions = words(assumptions);
        studies.clone_into(&mut statement.studies);
    }
}

/// A table.
pub(crate) fn table(id: &str, title: &str, columns: &[&str], rows: Vec<Vec<String>>) -> Table {
    Table { id: id.to_owned(), title: title.to_owned(), columns: words(columns), rows }
}

/// A figure.
pub(crate) fn figure(id: &str, title: &str, caption: &str, panels: Vec<Panel>) -> Figure {
    Figure { id: id.to_owned(), title: title.to_owned(), caption: caption.to_owned(), panels }
}

#[cfg(test)]
mod tests {
    use super::way;

    /// A quick approach of five samples in a thousand is drawn with more than the two or three corners that even
    /// thinning leaves.
    #[test]
    fn what_is_quick_keeps_its_shape() {
        let quick = (0..40).map(|k| [1.0 - f64::from(k) / 40.0, 0.0]);
        let slow = (0..6000).map(|k| (f64::from(k) / 6000.0).sin_cos()).map(|(y, x)| [1.0 - x, y]);
        let drawn = way("", quick.chain(slow)).points;
        assert!(drawn.iter().filter(|[_, y]| *y <= 0.0).count() >= 40, "{}", drawn.len());
        assert!(drawn.len() <= super::POINTS + 2, "{}", drawn.len());
        assert_eq!(drawn.last().map(|[x, _]| x.is_finite()), Some(true));
    }
}
