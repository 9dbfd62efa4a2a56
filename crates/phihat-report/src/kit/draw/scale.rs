//! Axes: from a value to a place of the picture, and the ticks.

use core::ops::Range;

use super::look::FigureSize;
use crate::kit::figure::{Axis, AxisTicks};
use crate::kit::number::{stated, tick};

/// Fewer ticks than this say too little.
const TICKS: usize = 3;

/// Ticks of a logarithmic axis are looked for from 10^−307 on.
const DECADES: i32 = 307;

/// A tick: its coordinate, its label, and whether it has a line across the panel.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AxisTick {
    pub at: f64,
    pub label: String,
    pub line: bool,
}

/// An axis; coordinates are values, or their decimal logarithms where it is logarithmic.
#[derive(Debug, Clone)]
pub(super) struct Scale {
    range: Range<f64>,
    log: bool,
    /// Places of both ends in the picture.
    from: f64,
    to: f64,
    pub ticks: Vec<AxisTick>,
}

impl Scale {
    /// With the ends that are stated, else those of `values`, on both sides longer by a share of itself.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, wider: f64) -> Self {
        let to = |value: f64| coordinate(value, axis.log);
        let stated = axis
            .range
            .map(|ends| ends.map(to))
            .filter(|[low, high]| low.is_finite() && high.is_finite() && low < high);
        let range = match (stated, &axis.ticks) {
            (Some([low, high]), _) => low..high,
            (None, AxisTicks::Multiples(step)) => {
                let range = extent(values.map(to), 0.0);
                let (low, high) = ((range.start / step).floor(), (range.end / step).ceil());
                low * step..high.max(low + 1.0) * step
            }
            (None, _) => {
                let range = extent(values.map(to), wider);
                // Ends of one decade say more than those of a single value.
                let little = if axis.log { (0.05 - range.end + range.start).max(0.0) } else { 0.0 };
                range.start - little..range.end + little
            }
        };
        Self { range, log: axis.log, from: 0.0, to: 1.0, ticks: Vec::new() }
    }

    /// The same between two places, with at most so many ticks.
    pub(super) fn placed(mut self, axis: &Axis, (from, to): (f64, f64), most: usize) -> Self {
        (self.from, self.to) = (from, to);
        let length = self.length();
        let line = |at: f64| {
            let value = if self.log { libm::exp10(at) } else { at };
            AxisTick { at, label: label(value, length, self.log), line: true }
        };
        self.ticks = match &axis.ticks {
            AxisTicks::Names(names) => names
                .iter()
                .map(|(value, name)| (self.coordinate(*value), name))
                .map(|(at, name)| AxisTick { at, label: name.clone(), line: false })
                .filter(|tick| self.holds(tick.at))
                .collect(),
            AxisTicks::Multiples(step) if *step > 0.0 && length / step < 60.0 => {
                let every =
                    [1.0, 2.0, 4.0, 8.0].into_iter().find(|k| length / (k * step) <= most as f64);
                multiples(&self.range, every.unwrap_or(1.0) * step).map(line).collect()
            }
            _ if self.log => self.decades(most).into_iter().map(line).collect(),
            _ => {
                let coarse = round_step(length, most);
                let few = multiples(&self.range, coarse).count() < 2;
                let step = if few { round_step(length, 2 * most) } else { coarse };
                multiples(&self.range, step).map(line).collect()
            }
        };
        self
    }

    /// Coordinate of a value; not finite where the axis has none for it.
    pub(super) fn coordinate(&self, value: f64) -> f64 {
        coordinate(value, self.log)
    }

    /// Place of a coordinate in the picture.
    pub(super) fn px(&self, coordinate: f64) -> f64 {
        self.from + (coordinate - self.range.start) / self.length() * (self.to - self.from)
    }

    /// Place of a value in the picture; not finite where the axis has none for it.
    pub(super) fn at(&self, value: f64) -> f64 {
        self.px(self.coordinate(value))
    }

    /// Place of the nearest value that lies on the axis.
    pub(super) fn clamped(&self, value: f64) -> f64 {
        let value = self.coordinate(value);
        // A logarithm that is none is below all.
        let value = if value.is_nan() { self.range.start } else { value };
        self.px(value.clamp(self.range.start, self.range.end))
    }

    /// Returns true if a coordinate lies on the axis.
    pub(super) fn holds(&self, coordinate: f64) -> bool {
        (self.range.start..=self.range.end).contains(&coordinate)
    }

    /// From the lowest to the highest coordinate.
    pub(super) fn length(&self) -> f64 {
        self.range.end - self.range.start
    }

    /// Returns true if coordinates are logarithms.
    pub(super) fn is_log(&self) -> bool {
        self.log
    }

    /// Width of the longest label of a tick.
    pub(super) fn widest(&self, look: &FigureSize) -> f64 {
        let letters = self.ticks.iter().map(|tick| tick.label.chars().count()).max();
        look.wide(letters.unwrap_or(1))
    }

    /// Decades; in a shorter range 1, 2 and 5 of them, then whole numbers, then tenths: the coarsest of which there
    /// are enough. Of too many decades every so many.
    fn decades(&self, most: usize) -> Vec<f64> {
        let (low, high) = (self.range.start - 1e-9, self.range.end + 1e-9);
        let among = |digits: &[f64]| -> Vec<f64> {
            let powers =
                (-DECADES..=DECADES).filter(|p| (low - 1.0..=high).contains(&f64::from(*p)));
            let all =
                powers.flat_map(|p| digits.iter().map(move |d| f64::from(p) + libm::log10(*d)));
            all.filter(|at| (low..=high).contains(at)).collect()
        };
        let tenths: Vec<f64> = (10..100).map(|k| f64::from(k) / 10.0).collect();
        let whole: Vec<f64> = (1..10).map(f64::from).collect();
        let choices = [vec![1.0], vec![1.0, 2.0, 5.0], whole, tenths];
        let mut found = among(&choices[0]);
        for digits in &choices[1..] {
            if found.len() >= TICKS {
                break;
            }
            let finer = among(digits);
            if finer.len() > most.max(TICKS) && found.len() >= 2 {
                break;
            }
            found = finer;
        }
        if found.len() < 2 {
            let ends = libm::exp10(self.range.start)..libm::exp10(self.range.end);
            let step = round_step(ends.end - ends.start, most);
            return multiples(&ends, step).map(libm::log10).collect();
        }
        let every = found.len().div_ceil(most.max(2));
        found.into_iter().step_by(every.max(1)).collect()
    }
}

fn coordinate(value: f64, log: bool) -> f64 {
    match log {
        true if value > 0.0 => libm::log10(value),
        true => f64::NAN,
        false => value,
    }
}

/// The finite extent of `values`, widened by `margin` of itself on both sides; it holds any data: none, one value, or a
/// diverged run.
pub fn extent(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let finite = values.filter(|v| v.abs() < 1e306);
    let (low, high) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    if low > high {
        return -1.0..1.0;
    }
    // An axis narrower than this could not tell its ticks apart.
    let least = (1e-6 * low.abs().max(high.abs())).max(1e-9);
    let pad = (margin * (high - low)).max(if high - low < least { least } else { 0.0 });
    low - pad..high + pad
}

/// 1, 2 or 5 times a power of ten: at most so many in a length.
fn round_step(length: f64, most: usize) -> f64 {
    let raw = length / most.max(2) as f64;
    let power = libm::exp10(libm::log10(raw).floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    steps.into_iter().find(|step| *step >= raw * (1.0 - 1e-9)).unwrap_or(raw)
}

/// Multiples of a step in a range.
fn multiples(range: &Range<f64>, step: f64) -> impl Iterator<Item = f64> + use<> {
    let first = (range.start / step - 1e-9).ceil();
    let end = range.end + 1e-9 * step;
    (0..64_u32).map(move |k| (first + f64::from(k)) * step).take_while(move |at| *at <= end)
}

/// Label of a tick.
fn label(value: f64, length: f64, log: bool) -> String {
    let short = (1e-4..1e5).contains(&value.abs()) || value.abs() < 1e-9 * length;
    if short && !log { tick(value, length) } else { power(value) }
}

/// Digits above the line.
const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];

/// A power of ten where that is shorter: `10⁻⁶`, but `0.001`.
fn power(value: f64) -> String {
    let value: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if (1e-3..1e5).contains(&value.abs()) {
        return stated(value);
    }
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let raised = |c: char| c.to_digit(10).map_or('⁻', |d| RAISED[d as usize]);
    let raised: String = exponent.chars().map(raised).collect();
    match digits.parse::<f64>().map(stated).as_deref() {
        Ok("1") => format!("10{raised}"),
        Ok("-1") => format!("-10{raised}"),
        Ok(digits) => format!("{digits}·10{raised}"),
        Err(_) => text,
    }
}

#[cfg(test)]
mod tests {
    use super::{Axis, Scale, power};

    fn scale(log: bool, range: [f64; 2], most: usize) -> Scale {
        let axis = Axis { log, range: Some(range), ..Axis::default() };
        Scale::new(&axis, [].into_iter(), 0.1).placed(&axis, (0.0, 600.0), most)
    }

    fn labels(scale: &Scale) -> Vec<&str> {
        scale.ticks.iter().map(|tick| tick.label.as_str()).collect()
    }

    #[test]
    fn a_logarithmic_axis_is_linear_in_the_logarithm() {
        let scale = scale(true, [1e-2, 1e4], 9);
        assert!((scale.at(10.0) - 300.0).abs() < 1e-9);
        assert!(scale.at(0.0).is_nan() && scale.at(-1.0).is_nan());
        assert!(scale.clamped(0.0).abs() < 1e-9 && (scale.clamped(1e9) - 600.0).abs() < 1e-9);
        assert_eq!(labels(&scale), ["0.01", "0.1", "1", "10", "100", "1000", "10000"]);
    }

    #[test]
    fn short_and_long_logarithmic_axes_have_some_ticks() {
        for (low, high) in [(17.9, 18.2), (0.4, 0.5), (26.0, 41.0), (310.0, 480.0), (0.5, 3.0)] {
            for most in [4, 9] {
                let found = scale(true, [low, high], most);
                assert!((2..=9).contains(&found.ticks.len()), "{low}: {:?}", labels(&found));
            }
        }
        assert_eq!(labels(&scale(true, [0.02, 30.0], 9)), ["0.1", "1", "10"]);
        assert_eq!(labels(&scale(true, [1e-9, 1e9], 5)).len(), 5);
    }

    #[test]
    fn linear_ticks_are_round_and_not_too_many() {
        assert_eq!(labels(&scale(false, [-0.3, 1.1], 5)), ["0", "0.5", "1"]);
        assert_eq!(labels(&scale(false, [0.0, 30.0], 6)), ["0", "5", "10", "15", "20", "25", "30"]);
        assert_eq!(labels(&scale(false, [-2e-6, 3e-6], 5)).last(), Some(&"3·10⁻⁶"));
    }

    #[test]
    fn ends_that_are_none_are_those_of_the_data() {
        for range in [None, Some([3.0, 3.0]), Some([5.0, 1.0]), Some([f64::NAN, 1.0])] {
            let axis = Axis { range, ..Axis::default() };
            let data = [2.0, f64::NAN, 8.0, f64::INFINITY];
            let scale = Scale::new(&axis, data.into_iter(), 0.0);
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
