//! The paper that static figures are drawn on: its size, its letters, its axes.

use std::ops::Range;

use plotters::prelude::*;
use thiserror::Error;

/// One figure, drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// File stem: `tracking`, `error`, …
    pub name: String,
    /// Title.
    pub title: String,
    /// The figure, made for 16 cm of width.
    pub svg: String,
}

/// Pixels per centimetre on paper: the backend draws on whole pixels, so they are small.
const PIXELS_PER_CM: u32 = 160;
/// Width of every figure \[px\].
pub const WIDTH: u32 = 16 * PIXELS_PER_CM;
/// Height of the part that holds title and legend \[px\].
pub const HEADER: u32 = 110;
/// Height of text: 7.5 points on paper, after the backend's own scale.
pub const TEXT: u32 = 52;
/// Height of a title, on the same scale.
pub const TITLE: u32 = 62;

/// Drawing area.
pub type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

/// A figure that cannot be drawn: its space is too small, or its text cannot be written.
#[derive(Debug, Error)]
#[error(transparent)]
pub struct DrawError(#[from] DrawingAreaErrorKind<std::io::Error>);

/// Names the figure for those who do not see it, and gives it its size on paper.
pub fn accessible(svg: &str, title: &str, (width, height): (u32, u32)) -> String {
    let centimetres = |pixels: u32| f64::from(pixels) / f64::from(PIXELS_PER_CM);
    let drawn = format!(r#"<svg width="{width}" height="{height}""#);
    let (w, h) = (centimetres(width), centimetres(height));
    let shown = format!(r#"<svg role="img" aria-label="{title}" width="{w}cm" height="{h}cm""#);
    svg.replacen(&drawn, &shown, 1)
}

/// The finite extent of `values`, widened by `margin` of itself on both sides; it holds any data: none, one value, or a
/// diverged run.
pub fn extent(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let finite = values.filter(|v| v.is_finite());
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

/// Ticks of a logarithmic axis: 1, 2, 5 where it is short, else whole decades, at most some eight.
pub fn log_ticks(range: &Range<f64>) -> Vec<f64> {
    let whole = |value: f64| format!("{value:.0}").parse::<i32>().unwrap_or(0);
    let (first, last) = (whole(range.start.log10().floor()), whole(range.end.log10().ceil()));
    let short = range.end.log10() - range.start.log10() < 2.5;
    let (digits, step): (&[f64], i32) =
        if short { (&[1.0, 2.0, 5.0], 1) } else { (&[1.0], (last - first + 7) / 8) };
    let powers = (first..=last).filter(|power| power.rem_euclid(step) == 0);
    let ticks = powers.flat_map(|power| digits.iter().map(move |d| d * 10.0_f64.powi(power)));
    ticks.filter(|tick| range.contains(tick)).collect()
}
