//! Nyquist plot of the sampled loop, with the circle of the modulus margin and the ends of the inertia window.

use core::f64::consts::TAU;

use phihat_design::sampled::bode;
use phihat_design::{Certificate, Gains};

use super::bode::tightest;
use crate::kit::draw::{FigureSize, Picture, draw};
use crate::kit::figure::{Axis, Figure, Ink, Marker, Panel, Series};
use crate::kit::number::number;
use crate::kit::text::short;

/// Lowest frequency of the curves \[Hz\], and number of their points.
const LOWEST: f64 = 0.1;
const POINTS: u32 = 900;

/// Farthest place on the left that is drawn.
const FARTHEST: f64 = 5.0;

/// Points of the circle.
const CIRCLE: u32 = 120;

/// For the joint of the Bode plots: its loop at the lightest, a middle and the heaviest inertia of the arm.
///
/// The loop of an inertia `μ M̄` is `L/μ`. It passes `−1` where `μ` is an end of the window: at the lightest inertia of
/// the arm it crosses the axis at minus the lower end over `μ`, at the heaviest at minus the upper end over `μ`.
pub(super) fn figure(gains: &Gains, certificate: &Certificate) -> Option<Picture> {
    let (record, claims) = tightest(gains, certificate)?;
    let (window, margins) = (claims.window?, claims.margins?);
    let (low, high) = (certificate.arm.low, certificate.arm.high);
    let ends = [(low, window.low, "lower"), (high, window.high, "upper")];
    let crossings = ends.map(|(mu, end, name)| Marker {
        at: [-end / mu, 0.0],
        label: format!("{name} end {}", number(end)),
        note: format!("{name} end of the window, {}, over μ = {}", number(end), number(mu)),
        ink: Ink::Plain,
        ..Marker::default()
    });
    let left = crossings.iter().map(|marker| -marker.at[0]).filter(|x| *x < FARTHEST);
    let left = 1.15 * left.fold(1.0 + margins.modulus, f64::max);
    let seen = |[x, y]: [f64; 2]| (-2.0 * left..2.0 * left).contains(&x) && y.abs() < 2.0 * left;
    let curves = [low, (low * high).sqrt(), high].map(|mu| {
        let loop_ = bode(record, &claims.model, mu, LOWEST, POINTS);
        let places = loop_.loop_gain.iter().zip(&loop_.loop_phase_rad);
        let points =
            places.map(|(size, phase)| [size * libm::cos(*phase), size * libm::sin(*phase)]);
        // Far outside a curve is a gap: it comes from infinity.
        let points = points.map(|point| if seen(point) { point } else { [f64::NAN; 2] });
        Series::curve(format!("μ = {}", number(mu)), points.collect())
    });
    let circle = (0..=CIRCLE).map(|k| TAU * f64::from(k) / f64::from(CIRCLE));
    let radius = margins.modulus;
    let circle = circle.map(|a| [radius * libm::cos(a) - 1.0, radius * libm::sin(a)]).collect();
    let circle = Series::curve(format!("modulus margin {}", number(radius)), circle);
    let critical = Marker {
        at: [-1.0, 0.0],
        label: "−1".to_owned(),
        ring: true,
        ink: Ink::Plain,
        ..Marker::default()
    };
    let series = curves.into_iter().chain([circle.in_ink(Ink::Soft)]).collect();
    let near = crossings.into_iter().filter(|marker| -marker.at[0] < FARTHEST);
    let up = 0.45 * (left + 0.4);
    let axes = (
        Axis::new("real part of L/μ").over(-left, 0.4),
        Axis::new("imaginary part of L/μ").over(-up, up),
    );
    let markers = near.chain([critical]).collect();
    let title = short(&record.name, 40);
    let panel = Panel { equal: true, markers, ..Panel::lines(title, axes, series, Vec::new()) };
    let title = "Nyquist plot: how far the loop stays from −1".to_owned();
    let figure =
        Figure { id: "nyquist".to_owned(), title, panels: vec![panel], ..Figure::default() };
    Some(draw(&figure, &FigureSize::PAPER))
}
