//! Colours, dashes and marks: distinct without colour; a class each for a dark page.

use core::fmt::Write as _;

use super::look::{FigureSize, px};
use crate::kit::figure::{Fill, Ink};

/// Number of distinct curves.
pub(super) const CURVES: usize = 6;

/// Colours after Okabe and Ito, and the dashes of each curve.
const INKS: [(&str, &str); CURVES] = [
    ("#0072B2", ""),
    ("#D55E00", "10.5 5.3"),
    ("#009E73", "3 4.2"),
    ("#CC79A7", "15 4.5 3 4.5"),
    ("#E69F00", "21 6"),
    ("#56B4E9", "9 3.8 2.6 3.8 2.6 3.8"),
];

/// Dashes of bounds.
const BOUNDS: [&str; 3] = ["4.5 3.8", "12.8 3.8 2.3 3.8", "1.5 5.3"];

/// A pen: class in the style sheet, colour, width and dashes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pen {
    /// Class of what is stroked, and of what is filled.
    pub class: [String; 2],
    pub colour: &'static str,
    pub width: f64,
    pub dashes: &'static str,
    /// Number of its mark.
    pub shape: usize,
}

/// The pen of the curve at a place among those of its panel.
pub(super) fn pen(ink: Ink, place: usize) -> Pen {
    let curve = |index: usize, width: f64| {
        let shape = index % CURVES;
        let (colour, dashes) = INKS[shape];
        let class = [format!("s{shape}"), format!("f{shape}")];
        Pen { class, colour, width, dashes, shape }
    };
    let plain = |class: &str, colour, width| {
        let class = [format!("s{class}"), format!("f{class}")];
        Pen { class, colour, width, dashes: "", shape: 0 }
    };
    match ink {
        Ink::Next => curve(place, 1.9),
        Ink::Curve(index) => curve(index.into(), 1.9),
        Ink::Bold(index) => curve(index.into(), 2.8),
        Ink::Thin(index) => Pen { dashes: "", ..curve(index.into(), 1.2) },
        Ink::Soft => plain("-soft", "#6e7781", 1.2),
        Ink::Plain => plain("-ink", "#1b1f24", 1.9),
    }
}

/// The pen of a bound.
pub(super) fn bound(place: usize) -> Pen {
    Pen {
        class: ["s-bound".to_owned(), String::new()],
        colour: "#5A5A5A",
        width: 1.5,
        dashes: BOUNDS[place % BOUNDS.len()],
        shape: 0,
    }
}

/// Class, colour and opacity of a band.
pub(super) fn fill(fill: Fill) -> (&'static str, &'static str, &'static str) {
    match fill {
        Fill::Tube => ("f2", "#009E73", "0.25"),
        Fill::Bars => ("f0", "#0072B2", "0.35"),
        Fill::Window => ("window", "#A8D6F0", "1"),
        Fill::Inside => ("f0", "#0072B2", "1"),
        Fill::Same => ("same", "#E6E9EC", "1"),
    }
}

/// Path of a mark around a place: circle, square, triangle, diamond, cross, plus.
pub(super) fn shape(number: usize, [x, y]: [f64; 2], radius: f64) -> String {
    let r = radius;
    let arm = |turn: fn(f64, f64) -> [f64; 2]| -> Vec<[f64; 2]> {
        let (half, long) = (0.22, 1.1);
        let quarter = [(half, half), (half, long), (-half, long)];
        let turned = |times: usize| {
            let turn = move |point| (0..times).fold(point, |(x, y): (f64, f64), _| (-y, x));
            quarter.into_iter().map(turn)
        };
        (0..4).flat_map(turned).map(|(x, y)| turn(x, y)).collect()
    };
    let corners: Vec<[f64; 2]> = match number % CURVES {
        0 => {
            let (from, across, back) = (px(-r), px(2.0 * r), px(-2.0 * r));
            let r = px(r);
            return format!(
                "M{} {}m{from} 0a{r} {r} 0 1 0 {across} 0a{r} {r} 0 1 0 {back} 0z",
                px(x),
                px(y)
            );
        }
        1 => vec![[0.9, 0.9], [-0.9, 0.9], [-0.9, -0.9], [0.9, -0.9]],
        2 => vec![[0.0, -1.3], [1.2, 0.9], [-1.2, 0.9]],
        3 => vec![[0.0, -1.4], [1.1, 0.0], [0.0, 1.4], [-1.1, 0.0]],
        4 => arm(|x, y| [0.75 * (x - y), 0.75 * (x + y)]),
        _ => arm(|x, y| [1.2 * x, 1.2 * y]),
    };
    let mut path = format!("M{} {}", px(x), px(y));
    let mut before = [0.0, 0.0];
    for (place, corner) in corners.iter().enumerate() {
        let letter = if place == 0 { 'm' } else { 'l' };
        // Rounded sums, so that the outline closes where it began.
        let now = corner.map(|c| (10.0 * r * c).round() / 10.0);
        // Writing to a string cannot fail.
        let _ = write!(path, "{letter}{} {}", px(now[0] - before[0]), px(now[1] - before[1]));
        before = now;
    }
    path.push('z');
    path
}

/// Path of a mark in the key.
pub(super) fn key_shape(pen: &Pen, at: [f64; 2], look: &FigureSize) -> String {
    shape(pen.shape, at, look.mark())
}
