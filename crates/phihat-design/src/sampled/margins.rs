//! Stability margins of the sampled loop, worst over a range of inertia.

use core::f64::consts::TAU;
use phihat_certificate::extremes::Extremes as _;

use nalgebra::Complex;
pub use phihat_certificate::Margins;
use serde::{Deserialize, Serialize};

use super::exclusion::{Exclusion, from_segment};
use super::model::LoopModel;
use super::open_loop::OpenLoop;
use super::refutation::{at_most, plausible, plausible_loop};
use super::window::{InertiaWindow, angles};
use crate::JointRecord;
use crate::claims::Refutation;
use crate::portable;
use crate::prelude::*;

const CLAIM: &str = "margins";

/// Margins are claimed this much inside of where they were found, so that they can be proved.
const INSIDE: f64 = 1.0 - 1e-4;

/// Longest delay that is claimed \[samples\].
const FARTHEST: f64 = 1000.0;

/// A proved modulus margin over a range of inertia: `|1 + L(e^{jθ})/μ| > distance`, and stable.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModulusMargin {
    /// Smallest inertia ratio.
    pub low: f64,
    /// Largest inertia ratio.
    pub high: f64,
    /// The distance from −1.
    pub distance: f64,
}

impl ModulusMargin {
    /// Proves the claim.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the frequency at which the proof fails.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        plausible(CLAIM, gains)?;
        plausible_loop(CLAIM, model)?;
        let open = OpenLoop::new(gains, model);
        let Self { low, high, distance } = *self;
        Exclusion { open: &open, low, high, radius: 1.0, distance }.prove("modulus margin")
    }
}

/// Finding [`Margins`].
pub trait FindMargins: Sized {
    /// Computes the margins over `[low, high]`.
    ///
    /// # Method
    ///
    /// At each frequency the worst `μ` is known in closed form: the modulus is the distance of zero from the
    /// segment `Δ + N/μ`, and `|L/μ| = 1` for `μ = |L|`.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is not stable over the range.
    fn find(gains: &JointRecord, model: &LoopModel, range: (f64, f64)) -> Result<Self, Refutation>;

    /// Computes the margins at one inertia ratio.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the loop is not stable there.
    fn at(gains: &JointRecord, model: &LoopModel, mu: f64) -> Result<Self, Refutation>;
}

impl FindMargins for Margins {
    fn find(
        gains: &JointRecord,
        model: &LoopModel,
        (low, high): (f64, f64),
    ) -> Result<Self, Refutation> {
        let window = InertiaWindow::find(gains, model)?;
        at_most(CLAIM, "window.low ≤ low", window.low, low)?;
        at_most(CLAIM, "high ≤ window.high", high, window.high)?;
        let open = OpenLoop::new(gains, model);
        let search = MarginSearch { open: &open, low, high };
        let (phase, delay) = search.phase_and_delay(&angles());
        Ok(Self {
            low,
            high,
            gain_up: low / window.low,
            gain_down: window.high / high,
            phase_deg: phase.to_degrees().min(180.0) * INSIDE,
            delay_s: (delay * INSIDE).min(FARTHEST) * model.period_s,
            modulus: search.modulus(&angles()) * INSIDE,
        })
    }

    fn at(gains: &JointRecord, model: &LoopModel, mu: f64) -> Result<Self, Refutation> {
        Self::find(gains, model, (mu, mu))
    }
}

/// Smallest `|1 + L/μ|` over a range of inertia.
pub(crate) fn least_modulus(open: &OpenLoop, (low, high): (f64, f64)) -> f64 {
    MarginSearch { open, low, high }.modulus(&angles())
}

struct MarginSearch<'a> {
    open: &'a OpenLoop,
    low: f64,
    high: f64,
}

impl MarginSearch<'_> {
    /// Smallest distance of `L/μ` from −1.
    fn modulus(&self, grid: &[f64]) -> f64 {
        let ends = [1.0 / self.high, 1.0 / self.low];
        let distance = |theta: f64| {
            let value = self.open.at_angle(theta);
            let [a, b] = ends.map(|lambda| value * lambda + 1.0);
            from_segment(a, b)
        };
        smallest(grid, distance)
    }

    /// Smallest turn \[rad\], and smallest lag over frequency \[samples\], that bring some `L/μ` to −1.
    fn phase_and_delay(&self, grid: &[f64]) -> (f64, f64) {
        let grid = &self.with_hidden_peaks(grid)[..];
        let phase = |value: Complex<f64>| portable::phase(-value).abs();
        let lag = |theta: f64, value: Complex<f64>| portable::phase(-value).rem_euclid(TAU) / theta;
        let inside = |value: Complex<f64>| {
            let size = portable::size(value);
            self.low <= size && size <= self.high
        };
        let among = |theta: f64, of: &dyn Fn(Complex<f64>) -> f64| {
            let value = self.open.at_angle(theta);
            if inside(value) { of(value) } else { f64::INFINITY }
        };
        let mut turn = smallest(grid, |theta| among(theta, &phase));
        let mut delay = smallest(grid, |theta| among(theta, &|value| lag(theta, value)));
        for theta in self.edges(grid) {
            let value = self.open.at_angle(theta);
            turn = turn.min(phase(value));
            delay = delay.min(lag(theta, value));
        }
        (turn, delay)
    }

    /// The grid, with the peaks and valleys of `|L|` between its points that reach across an end of the range: a narrow
    /// resonance may pass `low` or `high` twice within a cell.
    fn with_hidden_peaks(&self, grid: &[f64]) -> Vec<f64> {
        let size = |theta: f64| portable::size(self.open.at_angle(theta));
        let sizes: Vec<f64> = grid.iter().map(|theta| size(*theta)).collect();
        let mut all = grid.to_vec();
        for mu in [self.low, self.high] {
            for (i, at) in sizes.windows(3).enumerate() {
                let sign = if at[1] < mu { 1.0 } else { -1.0 };
                let peak = sign * (at[1] - at[0]) >= 0.0 && sign * (at[1] - at[2]) >= 0.0;
                let near = at[1] < HIDDEN * mu && mu < HIDDEN * at[1];
                if !(peak && near) {
                    continue;
                }
                let (mut a, mut b) = (grid[i], grid[i + 2]);
                for _ in 0..40 {
                    let third = (b - a) / 3.0;
                    let gain = sign * (size(b - third) - size(a + third));
                    if gain > 0.0 { a += third } else { b -= third }
                }
                let theta = 0.5 * (a + b);
                if sign * (size(theta) - mu) >= 0.0 {
                    all.push(theta);
                }
            }
        }
        all.sort_by(f64::total_cmp);
        all
    }

    /// Angles at which `|L|` passes through `low` or `high`.
    fn edges(&self, grid: &[f64]) -> Vec<f64> {
        let mut edges = Vec::new();
        for mu in [self.low, self.high] {
            let above = |theta: f64| portable::size(self.open.at_angle(theta)) > mu;
            for pair in grid.windows(2) {
                let (mut a, mut b) = (pair[0], pair[1]);
                if above(a) == above(b) {
                    continue;
                }
                let side = above(a);
                for _ in 0..50 {
                    let middle = 0.5 * (a + b);
                    if above(middle) == side { a = middle } else { b = middle }
                }
                edges.push(0.5 * (a + b));
            }
        }
        edges
    }
}

/// Peaks of `|L|` on the grid that are this much below an end of the range, or valleys above, are examined
/// between its points.
const HIDDEN: f64 = 2.0;

/// Valleys of the grid this much above the lowest are refined too.
const NEAR: f64 = 1.1;

/// Smallest value on the grid, refined between the neighbours of every valley that may hold it.
fn smallest(grid: &[f64], value: impl Fn(f64) -> f64) -> f64 {
    let values: Vec<f64> = grid.iter().map(|theta| value(*theta)).collect();
    let least = values.iter().copied().least();
    let at = |i: usize| values.get(i).copied().unwrap_or(f64::INFINITY);
    let mut best = least;
    for i in 0..values.len() {
        let before = i.checked_sub(1).map_or(f64::INFINITY, at);
        let valley = values[i] <= before && values[i] <= at(i + 1);
        if !valley || values[i] > NEAR * least || values[i].is_infinite() {
            continue;
        }
        let (mut a, mut b) = (grid[i.saturating_sub(1)], grid[(i + 1).min(grid.len() - 1)]);
        for _ in 0..40 {
            let third = (b - a) / 3.0;
            let (left, right) = (value(a + third), value(b - third));
            best = best.min(left).min(right);
            if left < right { b -= third } else { a += third }
        }
    }
    best
}
