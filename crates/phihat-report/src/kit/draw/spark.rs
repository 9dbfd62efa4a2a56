//! A curve of the size of a line of text.

use core::fmt::Write as _;

use maud::{Markup, html};

use super::look::px;
use crate::kit::text::line;

/// Size in its own units.
const WIDE: f64 = 240.0;
const HIGH: f64 = 48.0;

/// Slices that are drawn at most.
const SLICES: usize = 120;

/// The band between the least and the largest of equal slices of time, with a line at zero.
pub fn sparkline(label: &str, slices: &[[f64; 2]]) -> Markup {
    let band = thinned(slices);
    let finite = || band.iter().flatten().copied().filter(|value| value.is_finite());
    let (low, high) = finite().fold((0.0_f64, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    let y = |value: f64| {
        let share = if high > low { (high - value) / (high - low) } else { 0.5 };
        2.0 + (HIGH - 4.0) * share
    };
    html! {
        svg.spark role="img" aria-label=(line(label)) viewBox=(format!("0 0 {WIDE} {HIGH}")) {
            path.s-bound d=(format!("M0 {}H{WIDE}", px(y(0.0)))) {}
            path.s0 d=(path(&band, y)) {}
        }
    }
}

/// At most [`SLICES`], each the hull of those that it stands for.
fn thinned(slices: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let size = slices.len().div_ceil(SLICES).max(1);
    let hull = |group: &[[f64; 2]]| {
        let fold = |of: fn(f64, f64) -> f64, place: usize| {
            group.iter().map(|slice| slice[place]).reduce(of).unwrap_or(f64::NAN)
        };
        [fold(f64::min, 0), fold(f64::max, 1)]
    };
    slices.chunks(size).map(hull).collect()
}

/// A stroke from the lowest to the highest of every slice, and on to the next; slices that are not finite are gaps.
fn path(band: &[[f64; 2]], y: impl Fn(f64) -> f64) -> String {
    let step = WIDE / band.len().max(1) as f64;
    let mut d = String::new();
    let mut begun = false;
    for (k, [low, high]) in band.iter().enumerate() {
        if !(low.is_finite() && high.is_finite()) {
            begun = false;
            continue;
        }
        let x = (k as f64 + 0.5) * step;
        let letter = if begun { 'L' } else { 'M' };
        // Writing to a string cannot fail.
        let _ = write!(d, "{letter}{x:.0} {}V{}", px(y(*low)), px(y(*high)));
        begun = true;
    }
    d
}
