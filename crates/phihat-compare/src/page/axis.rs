//! Logarithmic axes of a figure.

use maud::{Markup, html};
use phihat_report::kit::number::tick;

/// Ticks are looked for from 10^−30 to 10^30.
const DECADES: i32 = 30;

/// Fewer ticks than this say too little.
const TICKS: usize = 3;

/// From data to the figure.
pub(crate) struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// An axis that holds the positive `values` with some room, from one place of the figure to another.
    pub(crate) fn around(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let logs = values.filter(|v| v.is_finite() && *v > 0.0).map(f64::log10);
        let (low, high) =
            logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let room = (0.08 * (high - low)).max(0.05);
        Self { low: low - room, high: high + room, from, to }
    }

    /// Position of a value in the figure.
    pub(crate) fn at(&self, value: f64) -> f64 {
        self.from + (value.log10() - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Decades; in a shorter range 1, 2 and 5 of them, then whole numbers, then tenths: the coarsest of which there
    /// are enough.
    pub(crate) fn ticks(&self) -> Vec<f64> {
        let tenths: Vec<f64> = (10..100).map(|k| f64::from(k) / 10.0).collect();
        let whole: Vec<f64> = (1..10).map(f64::from).collect();
        let choices = [vec![1.0], vec![1.0, 2.0, 5.0], whole, tenths];
        let ticks = choices.iter().map(|digits| self.among(digits));
        let mut found = Vec::new();
        for ticks in ticks {
            found = ticks;
            if found.len() >= TICKS {
                break;
            }
        }
        found
    }

    fn among(&self, digits: &[f64]) -> Vec<f64> {
        let all = (-DECADES..=DECADES)
            .flat_map(|d| digits.iter().map(move |digit| digit * 10f64.powi(d)));
        all.filter(|v| (self.low..=self.high).contains(&v.log10())).collect()
    }
}

/// Both axes of a figure with its size and its margins (left, top, right, bottom): grid, ticks, frame and
/// labels.
pub(crate) fn axes(
    [width, height]: [f64; 2],
    [left, top, right, bottom]: [f64; 4],
    (x, y): (&Axis, &Axis),
    (below, beside): (&str, &str),
) -> Markup {
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
        text.tick.below x=(f64::midpoint(left, end)) y=(height - 8.0) { (below) }
        text.tick.below transform=(format!("translate(16 {}) rotate(-90)", f64::midpoint(top, low))) { (beside) }
    }
}

#[cfg(test)]
mod tests {
    use super::Axis;

    #[test]
    fn short_axes_have_ticks_too() {
        let ticks = |low: f64, high: f64| Axis::around([low, high].into_iter(), 0.0, 100.0).ticks();
        assert_eq!(ticks(0.02, 30.0).len(), 3);
        assert!(ticks(0.5, 3.0).len() >= 3);
        for (low, high) in [(17.9, 18.2), (0.4, 0.5), (26.0, 41.0)] {
            let found = ticks(low, high);
            assert!((3..30).contains(&found.len()), "{found:?}");
        }
    }
}
