//! An axis, linear or logarithmic, whose numbers on paper are linear in its coordinate.

use std::ops::Range;

use crate::record::Axis;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;

use phihat_report::kit::number::{stated, tick};
use phihat_report::kit::sheet::{extent, log_ticks};

/// Ticks of a linear axis, about.
const TICKS: usize = 5;

/// Share of its data by which an axis without stated ends is longer, where it is to be longer.
const MARGIN: f64 = 0.06;

/// Coordinates are values, or their decimal logarithms where `log`.
#[derive(Debug, Clone)]
pub(super) struct Scale {
    range: Range<f64>,
    ticks: Vec<f64>,
    log: bool,
}

impl Scale {
    /// With the ends that are stated, else those of `values`, widened where `wide`.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, wide: bool) -> Self {
        let to = |value: f64| coordinate(value, axis.log);
        let stated = axis
            .range
            .map(|ends| ends.map(to))
            .filter(|[low, high]| low.is_finite() && high.is_finite() && low < high);
        let range = match stated {
            Some([low, high]) => low..high,
            None => extent(values.map(to), if wide { MARGIN } else { 0.0 }),
        };
        Self { ticks: ticks(&range, axis.log), range, log: axis.log }
    }

    /// Returns true if coordinates are logarithms.
    pub(super) fn is_log(&self) -> bool {
        self.log
    }

    /// Coordinate of a value; not finite where the axis has none for it.
    pub(super) fn at(&self, value: f64) -> f64 {
        coordinate(value, self.log)
    }

    /// Returns true if a coordinate lies on the axis.
    pub(super) fn holds(&self, coordinate: f64) -> bool {
        (self.range.start..=self.range.end).contains(&coordinate)
    }

    /// The nearest coordinate of the axis.
    pub(super) fn held(&self, coordinate: f64) -> f64 {
        coordinate.clamp(self.range.start, self.range.end)
    }

    /// From the lowest to the highest coordinate.
    pub(super) fn length(&self) -> f64 {
        self.range.end - self.range.start
    }

    /// Label of a tick.
    pub(super) fn label(&self, coordinate: f64) -> String {
        let value = if self.log { 10.0_f64.powf(coordinate) } else { coordinate };
        let short = (1e-4..1e5).contains(&value.abs()) || value.abs() < 1e-9 * self.length();
        if short && !self.log { tick(value, self.length()) } else { power(value) }
    }
}

fn coordinate(value: f64, log: bool) -> f64 {
    match log {
        true if value > 0.0 => value.log10(),
        true => f64::NAN,
        false => value,
    }
}

fn ticks(range: &Range<f64>, log: bool) -> Vec<f64> {
    let linear = |range: Range<f64>| RangedCoordf64::from(range).key_points(TICKS);
    if !log {
        return linear(range.clone());
    }
    let values = 10.0_f64.powf(range.start)..10.0_f64.powf(range.end) * (1.0 + 1e-12);
    let whole = log_ticks(&values);
    let ticks = if whole.len() < 2 { linear(values) } else { whole };
    ticks.into_iter().map(f64::log10).filter(|tick| tick.is_finite()).collect()
}

/// A power of ten where that is shorter: `10⁻⁶`, but `0.001`.
fn power(value: f64) -> String {
    if (1e-3..1e5).contains(&value.abs()) {
        return stated(value);
    }
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let raised = exponent.chars().map(|c| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        // The others stand in a row.
        _ => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
    });
    let raised: String = raised.collect();
    match digits.parse::<f64>().map(stated).as_deref() {
        Ok("1") => format!("10{raised}"),
        Ok("-1") => format!("-10{raised}"),
        Ok(digits) => format!("{digits}·10{raised}"),
        Err(_) => text,
    }
}

impl Ranged for Scale {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }

    fn map(&self, coordinate: &f64, limit: (i32, i32)) -> i32 {
        RangedCoordf64::from(self.range.clone()).map(coordinate, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::{Axis, Scale, power};

    fn axis(log: bool, range: Option<[f64; 2]>) -> Axis {
        Axis { label: String::new(), log, range }
    }

    #[test]
    fn a_logarithmic_axis_is_linear_in_the_logarithm() {
        let scale = Scale::new(&axis(true, Some([1e-2, 1e4])), [].into_iter(), true);
        assert!((scale.at(10.0) - 1.0).abs() < 1e-12);
        assert!(scale.at(0.0).is_nan() && scale.at(-1.0).is_nan());
        assert!((scale.length() - 6.0).abs() < 1e-12);
        let labels: Vec<_> = scale.ticks.iter().map(|tick| scale.label(*tick)).collect();
        assert_eq!(labels, ["0.01", "0.1", "1", "10", "100", "1000", "10000"]);
    }

    #[test]
    fn a_short_logarithmic_axis_has_ticks_too() {
        let scale = Scale::new(&axis(true, Some([310.0, 480.0])), [].into_iter(), false);
        assert!(scale.ticks.len() >= 2, "{:?}", scale.ticks);
        assert!(scale.ticks.iter().all(|t| (310.0_f64.log10()..480.0_f64.log10()).contains(t)));
    }

    #[test]
    fn ends_that_are_none_are_those_of_the_data() {
        for range in [None, Some([3.0, 3.0]), Some([5.0, 1.0]), Some([f64::NAN, 1.0])] {
            let data = [2.0, f64::NAN, 8.0, f64::INFINITY];
            let scale = Scale::new(&axis(false, range), data.into_iter(), false);
            assert!(
                (scale.range.start - 2.0).abs() < 1e-12 && (scale.range.end - 8.0).abs() < 1e-12
            );
        }
    }

    #[test]
    fn powers_of_ten_are_raised() {
        let cases = [
            (1e-6, "10⁻⁶"),
            (2e-13, "2·10⁻¹³"),
            (1e5, "10⁵"),
            (0.02, "0.02"),
            (500.0, "500"),
            (-1e6, "-10⁶"),
            (-5e5, "-5·10⁵"),
        ];
        for (value, text) in cases {
            assert_eq!(power(value), text);
        }
    }
}
