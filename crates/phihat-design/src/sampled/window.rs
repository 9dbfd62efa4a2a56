//! The inertia window: for which inertias the sampled loop is stable.

use core::f64::consts::{PI, TAU};

use nalgebra::Complex;
pub use phihat_certificate::InertiaWindow;

use super::model::LoopModel;
use super::open_loop::OpenLoop;
use super::polynomial::{SampledPolynomial, on_circle};
use super::refutation::{plausible, plausible_loop, refuse};
use crate::JointRecord;
use crate::claims::Refutation;
use crate::portable;

const CLAIM: &str = "inertia window";

/// Edges are claimed this much inside of where the roots reach the unit circle.
const INSIDE: f64 = 1e-6;

/// Ratios beyond this, or its inverse, are not looked at.
const WIDEST: f64 = 1e6;

/// Lowest frequency looked at \[rad/sample\].
const LOWEST: f64 = 1e-7;

/// From one frequency to the next: this share of it …
const SHARE: f64 = 0.05;

/// … but at most this \[rad/sample\].
const EVEN: f64 = PI / 128.0;

/// Finding an [`InertiaWindow`].
///
/// # Example
///
/// ```
/// use phihat_design::JointRecord;
/// use phihat_design::prelude::*;
/// use phihat::{Form, TorqueSource, VelocitySource};
/// use phihat_design::sampled::{InertiaWindow, LoopModel};
///
/// let gains = JointRecord {
///     name: "elbow".to_owned(),
///     inertia_kg_m2: 0.8,
///     kp_per_s2: 400.0,
///     kd_per_s: 40.0,
///     a: vec![4900.0, 140.0],
///     observer: None,
/// };
/// let model = LoopModel {
///     period_s: 1e-3,
///     delay_samples: 1,
///     sample_delay_samples: 0,
///     torque: TorqueSource::Applied,
///     velocity: VelocitySource::Measured,
///     velocity_filter_hz: None,
///     torque_filter_hz: None,
///     form: Form::Observer,
///     drive_bandwidth_hz: None,
/// };
/// let window = InertiaWindow::find(&gains, &model)?;
/// window.verify(&gains, &model)?; // proved by another method
/// // Stable from a fifth of the nominal inertia to six times as much; unstable beyond, on both sides.
/// assert!(window.contains(0.2, 6.0) && !window.contains(0.1, 6.0) && !window.contains(0.2, 7.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait FindWindow: Sized {
    /// Finds the window around `μ = 1`.
    ///
    /// # Method
    ///
    /// A root on the unit circle at `e^{jθ}` means `μ = −L(e^{jθ})`, real and positive: the edges are the
    /// nearest such values below and above 1. Sign changes of `Im L` on a logarithmic grid, bisected.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is unstable at `μ = 1`.
    fn find(gains: &JointRecord, model: &LoopModel) -> Result<Self, Refutation>;
}

impl FindWindow for InertiaWindow {
    fn find(gains: &JointRecord, model: &LoopModel) -> Result<Self, Refutation> {
        plausible(CLAIM, gains)?;
        plausible_loop(CLAIM, model)?;
        let open = OpenLoop::new(gains, model);
        stable_at_one(&open)?;
        Ok(around(&open, 1.0))
    }
}

/// The nearest real-axis crossings of `−L` below and above `mu`.
pub(crate) fn around(open: &OpenLoop, mu: f64) -> InertiaWindow {
    let mut window = InertiaWindow { low: 0.0, high: WIDEST, low_hz: 0.0, high_hz: 0.0 };
    let mut below = f64::NEG_INFINITY;
    let mut last: Option<(f64, f64)> = None;
    let per_sample = TAU * open.period();
    let mut found = |theta: f64, value: f64| {
        if value > below && value <= mu {
            below = value;
            window.low = value * (1.0 + INSIDE);
            window.low_hz = theta / per_sample;
        }
        if value > mu && value < window.high {
            window.high = value * (1.0 - INSIDE);
            window.high_hz = theta / per_sample;
        }
    };
    for theta in angles() {
        let side = turned_side(open, theta);
        if let Some((before, last_side)) = last
            && last_side * side < 0.0
        {
            let crossing = bisect(open, (before, last_side), theta);
            let value = -open.at_angle(crossing).re;
            if value > 0.0 {
                found(crossing, value);
            }
        }
        last = Some((theta, side));
    }
    // θ = π is real by itclaim.
    let value = -open.at_angle(PI).re;
    if value > 0.0 {
        found(PI, value);
    }
    window.low = window.low.max(1.0 / WIDEST);
    window.high = window.high.min(WIDEST);
    window
}

/// The frequencies looked at \[rad/sample\], ascending to π: logarithmic below, even near π.
pub(crate) fn angles() -> Vec<f64> {
    let lower = |theta: &f64| (*theta > LOWEST).then(|| theta - (theta * SHARE).min(EVEN));
    let mut angles: Vec<f64> = core::iter::successors(Some(PI), lower).collect();
    angles.reverse();
    angles
}

/// Counts the turns of `Δ + N` over the half circle on the grid.
fn stable_at_one(open: &OpenLoop) -> Result<(), Refutation> {
    let closed = open.closed(1.0);
    let mut last = closed.at(Complex::new(0.0, 0.0));
    let mut turned = 0.0;
    for theta in angles() {
        let value = closed.at(on_circle(theta, 1.0));
        turned += portable::phase(value / last);
        last = value;
    }
    let wanted = PI * closed.degree() as f64;
    if (turned - wanted).abs() < 0.5 {
        Ok(())
    } else {
        let inequality = "at μ = 1: argument of Δ + N over the half circle = π · degree";
        Err(refuse(CLAIM, inequality, turned, wanted))
    }
}

/// `Im(N Δ*)`, whose sign is that of `Im L`.
fn turned_side(open: &OpenLoop, theta: f64) -> f64 {
    let w = on_circle(theta, 1.0);
    let at = |p: &SampledPolynomial| p.at(w);
    (at(&open.numerator) * at(&open.denominator).conj()).im
}

fn bisect(open: &OpenLoop, (mut low, side): (f64, f64), mut high: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if turned_side(open, middle) * side > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
