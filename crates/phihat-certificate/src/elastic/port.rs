//! Connection of an arm's links at one joint: rotor, spring, drive and law as one scalar.
//!
//! Everything is in units of the joint's link inertia `S`, in which the range of the links is measured.

use phihat_kernel::{JointLoop, Polynomial};

use super::disc::{Disc, LOST};
use super::document::{ElasticJoint, EncoderSide};
use crate::check::complex::Complex;
use crate::check::response::on_circle;
use crate::extremes::{larger, smaller};

/// Rotor `B`, compliance `s = 1/k` and damping `c` in units of `S`, each by its ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Springs {
    pub(super) rotor: (f64, f64),
    pub(super) compliance: (f64, f64),
    pub(super) damping: (f64, f64),
}

fn half((low, high): (f64, f64)) -> f64 {
    0.5 * (high - low)
}

fn middle((low, high): (f64, f64)) -> f64 {
    0.5 * (low + high)
}

impl Springs {
    /// Those of a joint, per unit of inertia.
    fn of(joint: &ElasticJoint, unit: f64) -> Self {
        let per = |(low, high): (f64, f64)| (low / unit, high / unit);
        Self {
            rotor: per(joint.rotor_kg_m2),
            compliance: (unit / joint.stiffest(), unit / joint.stiffness_nm_rad.0),
            damping: per(joint.damping_nm_s_rad),
        }
    }

    /// The middle of every interval.
    pub(super) fn centre(&self) -> Self {
        let point = |ends| (middle(ends), middle(ends));
        Self {
            rotor: point(self.rotor),
            compliance: point(self.compliance),
            damping: point(self.damping),
        }
    }

    /// Two halves of the interval that `weights` (of rotor, compliance, damping) say matters most.
    fn halves(&self, weights: [f64; 3]) -> [Self; 2] {
        let cut = |(low, high): (f64, f64)| {
            let at = middle((low, high));
            [(low, at), (at, high)]
        };
        let [rotor, compliance, damping] = weights;
        if compliance >= rotor && compliance >= damping {
            cut(self.compliance).map(|compliance| Self { compliance, ..*self })
        } else if damping >= rotor {
            cut(self.damping).map(|damping| Self { damping, ..*self })
        } else {
            cut(self.rotor).map(|rotor| Self { rotor, ..*self })
        }
    }
}

/// `G = ω²s/(1 + jωcs)`.
fn bend(omega: f64, s: f64, c: f64) -> Complex {
    Complex::new(omega * omega * s, 0.0).over(Complex::new(1.0, omega * c * s))
}

/// One joint in its loop.
#[derive(Debug)]
pub(super) struct Port {
    /// `N` per unit of `S` and `Δ`, in `w = z − 1`, rounded coefficient by coefficient.
    back: Vec<f64>,
    open: Vec<f64>,
    period: f64,
    side: EncoderSide,
    /// Torques that are wrong by any such share of themselves.
    wrong: Disc,
    pub(super) springs: Springs,
}

/// Frequencies of a cell \[rad/sample\], and the joint's loop over them.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpringBand {
    /// `ω` over the cell \[rad/s\].
    omega: (f64, f64),
    open: Disc,
    back: Disc,
}

/// A circle through `−low` and `−high`, by `κ`: outside, for `Y = 1/L″`, is
/// `F = 1 + (a + b) Re Y + ab |Y|² − κ Im Y > 0`, or `|Y + p − jq| > r`, `p = (a + b)/2ab`, `q = κ/2ab`,
/// `r² = p² + q² − 1/ab`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Circle {
    at: Complex,
    radius: f64,
    sum: f64,
    product: f64,
    kappa: f64,
}

impl Circle {
    pub(super) fn new((a, b): (f64, f64), kappa: f64) -> Self {
        let (p, q) = (0.5 * (a + b) / (a * b), 0.5 * kappa / (a * b));
        // p² − 1/ab = ((b − a)/2ab)².
        let apart = 0.5 * (b - a) / (a * b);
        let radius = libm::hypot(apart, q) * (1.0 + LOST);
        Self { at: Complex::new(p, -q), radius, sum: a + b, product: a * b, kappa }
    }

    /// Lower bound of `F` over all points within `spread` of a segment: `F(y + d) ≥ F(y) − |d| |∇F(y)|`, and `F` is
    /// convex.
    fn least(&self, [from, to]: [Complex; 2], spread: f64) -> f64 {
        let square = |y: Complex| y.re * y.re + y.im * y.im;
        let slope = |y: Complex| {
            let re = 2.0 * self.product * y.re + self.sum;
            Complex::new(re, 2.0 * self.product * y.im - self.kappa)
        };
        let (along, first) = (to - from, slope(from));
        let (rise, bow) = (along.re * first.re + along.im * first.im, self.product * square(along));
        let t = -0.5 * rise / bow;
        let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
        let start = 1.0 + self.sum * from.re + self.product * square(from) - self.kappa * from.im;
        let most = from.size() + to.size() + spread;
        let sizes = 1.0 + (self.sum + self.kappa.abs() + self.product * most) * most;
        let steepest = larger(first.size(), slope(to).size());
        // Where the segment is too short for its quotient, its ends differ by less than the rounding.
        let lowest = smaller(start + t * (rise + t * bow), start + rise + bow);
        smaller(lowest, start) - spread * steepest * (1.0 + LOST) - 1e-12 * sizes
    }
}

/// `f + κg > 0` says on which side of the circle a point is.
#[derive(Debug, Clone, Copy)]
pub(super) struct CircleSides {
    pub(super) f: f64,
    pub(super) g: f64,
}

impl Port {
    /// A joint with its law in its loop, and its `M̄`, per unit of inertia `S`.
    pub(super) fn new(
        (law, period, inertia): (&JointLoop, f64, f64),
        (joint, unit): (&ElasticJoint, f64),
        (side, modulus): (EncoderSide, f64),
    ) -> Self {
        let rounded = |p: &Polynomial| -> Vec<f64> {
            p.about_one().coefficients().iter().map(phihat_kernel::Number::near).collect()
        };
        let springs = Springs::of(joint, unit);
        let (mut back, open) = (rounded(&law.back), rounded(&law.open));
        for coefficient in &mut back {
            *coefficient *= inertia / unit;
        }
        // 1/(1 + δ) with |δ| ≤ m is within m/(1 − m) of 1, and so is 1 + δ.
        let wrong = modulus / (1.0 - modulus) * (1.0 + LOST);
        let wrong = Disc::new(Complex::new(1.0, 0.0), wrong);
        Self { back, open, period, side, wrong, springs }
    }

    /// Degree of the rigid loop's characteristic polynomial.
    pub(super) fn degree(&self) -> usize {
        self.open.len().max(self.back.len()).saturating_sub(1)
    }

    /// The loop over the frequencies from `from` to `to` \[rad/sample\].
    pub(super) fn band(&self, from: f64, to: f64) -> SpringBand {
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        // No point of an arc is farther from its middle than the arc is long.
        let reach = if half > 0.0 { half * (1.0 + 1e-12) + 1e-300 } else { 0.0 };
        let w = Disc::new(on_circle(centre), reach);
        let per = |theta: f64| theta / self.period;
        SpringBand {
            omega: (per(from) * (1.0 - LOST), per(to) * (1.0 + LOST)),
            open: w.polynomial(&self.open),
            back: w.polynomial(&self.back),
        }
    }

    /// `G = ω²s/(1 + jωcs)`; `None` where the denominator is not kept from 0.
    fn compliance(springs: &Springs, omega: (f64, f64)) -> Option<Disc> {
        let Springs { compliance: s, damping: c, .. } = *springs;
        let lost = (omega.0 * s.0 * c.0, omega.1 * s.1 * c.1);
        let turned = Disc::between(lost) * Disc::new(Complex::new(0.0, 1.0), 0.0);
        let bent = Disc::between((omega.0 * omega.0 * s.0, omega.1 * omega.1 * s.1));
        Some(bent * (Disc::real(1.0) + turned).inverse()?)
    }

    /// Returns true if `L″` is outside the circle over a band, for all springs of a box.
    fn outside(&self, band: &SpringBand, springs: &Springs, circle: &Circle) -> bool {
        // A wrong torque is in N, or by its inverse in Δ: where one of them is small, so is its effect.
        let torque = SpringBand { back: band.back * self.wrong, ..*band };
        let rest = SpringBand { open: band.open * self.wrong, ..*band };
        [torque, rest].iter().any(|band| {
            self.off_chord(band, springs, circle).unwrap_or(false)
                || self.off_disc(band, springs, circle)
        })
    }

    /// By one disc for all `G` of the box.
    fn off_disc(&self, band: &SpringBand, springs: &Springs, circle: &Circle) -> bool {
        let Some(g) = Self::compliance(springs, band.omega) else { return false };
        let at = Disc::new(circle.at, 0.0);
        let rotor = Disc::between(springs.rotor);
        let bent = at + g.times(-1.0);
        let on_back = match self.side {
            EncoderSide::Motor => bent,
            EncoderSide::Link => at,
        };
        // N″ = BΔ + N;  D″ + (p − jq)N″ = Δ(1 + B(p − jq − G)) + N(p − jq − G, at the link p − jq).
        let inside = rotor * band.open + band.back;
        let away = band.open * (Disc::real(1.0) + rotor * bent) + band.back * on_back;
        away.least() > circle.radius * inside.most()
    }

    /// By the arc of all `G` of the box, with `Y = Q − G` or `Q(1 − BG)`, `Q = Δ/(BΔ + N)`. Over a range of compliance
    /// `G` stays within `ω³c(Δs)²/4` of its chord. `None`: `BΔ + N` may be 0.
    fn off_chord(&self, band: &SpringBand, springs: &Springs, circle: &Circle) -> Option<bool> {
        let Springs { rotor, compliance: s, damping: c } = *springs;
        let top = Disc::between(rotor) * band.open + band.back;
        let q = band.open * top.inverse()?;
        let (omega, most) = (middle(band.omega), band.omega.1);
        let bends = [s.0, s.1].map(|s| bend(omega, s, middle(c)));
        let (width, lost) = (s.1 - s.0, most * most * most);
        let bowed = 0.25 * lost * c.1 * width * width;
        let turned = half(band.omega) * most * s.1 * (2.0 + most * c.1 * s.1);
        let damped = half(c) * lost * s.1 * s.1;
        let strayed = (bowed + turned + damped) * (1.0 + LOST) + LOST * bends[1].size();
        let (ends, spread) = match self.side {
            EncoderSide::Motor => (bends.map(|g| q.centre - g), q.radius + strayed),
            EncoderSide::Link => {
                let b = middle(rotor);
                let passed = bends.map(|g| Complex::new(1.0, 0.0) - g.times(b));
                let shares = larger(passed[0].size(), passed[1].size());
                let moved = b * strayed + half(rotor) * most * most * s.1;
                (passed.map(|share| q.centre * share), q.radius * shares + q.most() * moved)
            }
        };
        Some(circle.least(ends, spread * (1.0 + LOST)) > 0.0)
    }

    /// Returns true if `L″` is outside the circle over a band for all springs: boxes are halved, `most` at most.
    pub(super) fn clear(&self, band: &SpringBand, circle: &Circle, most: u32) -> (bool, u32) {
        let mut boxes = vec![self.springs];
        let mut tried = 0;
        while let Some(springs) = boxes.pop() {
            tried += 1;
            if self.outside(band, &springs, circle) {
                continue;
            }
            // A failure at one point of the box is one of the band's width, or of the circle.
            if tried > most || !self.outside(band, &springs.centre(), circle) {
                return (false, tried);
            }
            boxes.extend(springs.halves(self.weights(band, &springs)));
        }
        (true, tried)
    }

    /// Share of each interval of a box in the width of `1/L″`: of rotor, compliance, damping.
    fn weights(&self, band: &SpringBand, springs: &Springs) -> [f64; 3] {
        let square = band.omega.1 * band.omega.1;
        let Springs { rotor, compliance: s, damping: c } = *springs;
        let ratio = band.open.centre.over(band.open.centre.times(middle(rotor)) + band.back.centre);
        let by = match self.side {
            EncoderSide::Motor => 1.0,
            EncoderSide::Link => middle(rotor) * ratio.size(),
        };
        let damping = square * middle(s) * middle(s) * band.omega.1 * half(c);
        [half(rotor) * ratio.size() * ratio.size(), by * square * half(s), by * damping]
    }

    /// `f`, `g` of the circles through `−a` and `−b` in the middle of a band, for one compliance, damping and rotor.
    pub(super) fn sides(
        &self,
        band: &SpringBand,
        point: [f64; 3],
        (a, b): (f64, f64),
    ) -> CircleSides {
        let (top, bottom) = self.ratio(band, point);
        let cross = bottom * top.conjugate();
        let square = |z: Complex| z.re * z.re + z.im * z.im;
        CircleSides { f: square(top) + (a + b) * cross.re + a * b * square(bottom), g: -cross.im }
    }

    /// Numerator and denominator of `L″` in the middle of a band.
    fn ratio(&self, band: &SpringBand, [s, c, rotor]: [f64; 3]) -> (Complex, Complex) {
        let omega = middle(band.omega);
        let g = bend(omega, s, c);
        let (open, back) = (band.open.centre, band.back.centre);
        let top = open.times(rotor) + back;
        let bottom = match self.side {
            EncoderSide::Motor => open - g * top,
            EncoderSide::Link => open - g * open.times(rotor),
        };
        (top, bottom)
    }

    /// Compliance whose `L″` is deepest inside a circle at the middle of a band, for one rotor, without damping.
    pub(super) fn deepest(&self, band: &SpringBand, circle: &Circle, rotor: f64) -> f64 {
        let (open, back) = (band.open.centre, band.back.centre);
        let top = open.times(rotor) + back;
        let moved = match self.side {
            EncoderSide::Motor => top,
            EncoderSide::Link => open.times(rotor),
        };
        let omega = middle(band.omega);
        let at = (open + circle.at * top).over(moved).re / (omega * omega);
        let (low, high) = self.springs.compliance;
        if at.is_finite() { at.clamp(low, high) } else { high }
    }

    /// `Δ(B + μ − μGB) + N(1 − μG)`, at the link `… + N`: the joint alone on a link of inertia `μ`, over a band.
    pub(super) fn alone(&self, band: &SpringBand, springs: &Springs, mu: f64) -> Option<Disc> {
        let g = Self::compliance(springs, band.omega)?;
        let rotor = middle(springs.rotor);
        let on_open = Disc::real(rotor + mu) + g.times(-mu * rotor);
        let on_back = match self.side {
            EncoderSide::Motor => Disc::real(1.0) + g.times(-mu),
            EncoderSide::Link => Disc::real(1.0),
        };
        Some(band.open * on_open + band.back * on_back)
    }

    /// Angle by which `1 − Gm`, `m = μB/(μ + B)`, turns from frequency 0 to half the sample rate.
    pub(super) fn spring_turns(&self, springs: &Springs, mu: f64) -> f64 {
        let omega = core::f64::consts::PI / self.period;
        let (s, c) = (middle(springs.compliance), middle(springs.damping));
        let rotor = middle(springs.rotor);
        let reduced = mu * rotor / (mu + rotor);
        let damped = omega * c * s;
        libm::atan2(damped, 1.0 - reduced * omega * omega * s) - libm::atan2(damped, 1.0)
    }
}
