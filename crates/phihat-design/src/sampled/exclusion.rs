//! The proof behind windows and margins: zero is not among the values on a circle.

use core::f64::consts::PI;

use super::model::LoopModel;
use super::open_loop::OpenLoop;
use super::polynomial::{SampledPolynomial, on_circle};
use super::refutation::{plausible, plausible_loop, refuse};
use crate::JointRecord;
use crate::claims::Refutation;
use crate::portable;

/// Cells narrower than this share of their frequency prove nothing more in double precision.
const NARROWEST: f64 = 1e-13;

/// The same near zero frequency \[rad/sample\].
const NARROWEST_AT_ZERO: f64 = 1e-18;

/// A set of sampled loops `Δ + λN`, `λ` between `1/high` and `1/low`, to be proved stable.
///
/// # Claim
///
/// For every `λ` in the interval all roots of `p_λ = Δ + λN` lie inside `|z| < ρ`, and on `|z| = ρ`
/// `|p_λ| > r |Δ|`: with `ρ = 1` the distance of the loop `L/μ` from −1 exceeds `r`.
///
/// # Method
///
/// Zero exclusion. (i) `p_λ(ρe^{jθ})` is affine in `λ`, so its values at one `θ` are a segment; between
/// the centre and the edge of a cell of half-width `h` each end moves by at most `h ρ Σ k|c_k||w|^{k−1}`.
/// If the segment's distance from zero exceeds this, no `p_λ` has a root on the arc; else the cell is
/// halved. (ii) No root crosses the circle, so all `p_λ` have as many roots inside as one of them. (iii) For
/// that one, the argument of `p(ρe^{jθ})` over the half circle must grow by `π` times the degree.
///
/// # Not claimed
///
/// Double precision with an allowance for rounding, not interval arithmetic.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Exclusion<'a> {
    pub(crate) open: &'a OpenLoop,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// `ρ`.
    pub(crate) radius: f64,
    /// `r`.
    pub(crate) distance: f64,
}

impl Exclusion<'_> {
    /// Proves it, or names what fails.
    pub(crate) fn prove(&self, claim: &str) -> Result<(), Refutation> {
        if !(0.0 < self.low && self.low <= self.high && self.high.is_finite()) {
            return Err(refuse(claim, "0 < low ≤ high", self.low, self.high));
        }
        let ends = [self.open.closed(self.high), self.open.closed(self.low)];
        let mut cells = vec![(0.0, PI)];
        let mut turned = 0.0;
        while let Some((from, to)) = cells.pop() {
            if self.excludes(&ends, from, to) {
                turned += turn(&ends[0], from, to, self.radius);
            } else if to - from < NARROWEST * to + NARROWEST_AT_ZERO {
                let inequality = format!(
                    "|Δ + N/μ| > {} |Δ| at θ = {from:.6} rad/sample, μ in [{}, {}]",
                    self.distance, self.low, self.high
                );
                let w = on_circle(from, self.radius);
                let left = from_segment(ends[0].at(w), ends[1].at(w));
                let right = self.distance * portable::size(self.open.denominator.at(w));
                return Err(refuse(claim, inequality, left, right));
            } else {
                let middle = 0.5 * (from + to);
                cells.extend([(middle, to), (from, middle)]);
            }
        }
        let wanted = PI * ends[0].degree() as f64;
        if (turned - wanted).abs() < 1e-6 {
            Ok(())
        } else {
            let inequality = "argument of Δ + N/μ over the half circle = π · degree";
            Err(refuse(claim, inequality, turned, wanted))
        }
    }

    /// (i) for one cell.
    fn excludes(&self, ends: &[SampledPolynomial; 2], from: f64, to: f64) -> bool {
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        let w = on_circle(centre, self.radius);
        let reach = portable::size(on_circle(to, self.radius))
            .max(portable::size(on_circle(from, self.radius)));
        let moves = |p: &SampledPolynomial| {
            half * self.radius * p.slope(reach) + 64.0 * f64::EPSILON * p.size(reach)
        };
        let clear = from_segment(ends[0].at(w), ends[1].at(w));
        let mut needed = moves(&ends[0]).max(moves(&ends[1]));
        if self.distance > 0.0 {
            let open = &self.open.denominator;
            needed += self.distance * (portable::size(open.at(w)) + moves(open));
        }
        clear > needed
    }
}

/// Proves the loop stable for inertia ratios in `[low, high]` with a drive that delivers `gain` times the
/// commanded torque: an observer that receives the torque that acted knows this, one that receives the torque
/// demanded does not.
pub(crate) fn stable_at_gain(
    gains: &JointRecord,
    model: &LoopModel,
    gain: f64,
    (low, high): (f64, f64),
) -> Result<(), Refutation> {
    let claim = format!("drive gain {gain}");
    plausible(&claim, gains)?;
    plausible_loop(&claim, model)?;
    let open = OpenLoop::with_drive_gain(gains, model, gain);
    Exclusion { open: &open, low, high, radius: 1.0, distance: 0.0 }.prove(&claim)
}

/// Distance of zero from the segment between two complex numbers.
pub(crate) fn from_segment(a: nalgebra::Complex<f64>, b: nalgebra::Complex<f64>) -> f64 {
    let along = b - a;
    let length = along.norm_sqr();
    let share = if length > 0.0 { -(a * along.conj()).re / length } else { 0.0 };
    portable::size(a + along * share.clamp(0.0, 1.0))
}

/// Angle by which the argument turns over a cell on which the polynomial moves less than its own size.
fn turn(p: &SampledPolynomial, from: f64, to: f64, radius: f64) -> f64 {
    let [a, centre, b] = [from, 0.5 * (from + to), to].map(|theta| p.at(on_circle(theta, radius)));
    portable::phase(centre / a) + portable::phase(b / centre)
}
