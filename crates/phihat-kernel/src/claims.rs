//! The claims, each a finite number of signs of integers.

use core::cmp::Ordering;

use num_bigint::{BigInt, Sign};

use crate::bernstein::{
    BernsteinCell, Fails, Forms, everywhere, negative, not_negative, not_positive, positive,
    times_line,
};
use crate::circle::{real, sine_squared, turned};
use crate::multiplier::{Line, Multiplier};
use crate::schur::inside;
use crate::{JointLoop, Number, Polynomial, Unproved};

/// Range of inertia, `0 < low ≤ high`: of ratios `μ`, or of the eigenvalues of `W`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Range {
    low: Number,
    high: Number,
}

impl Range {
    /// The range between two doubles.
    ///
    /// # Errors
    ///
    /// [`Unproved::NoClaim`] unless `0 < low ≤ high < ∞`.
    pub fn new(low: f64, high: f64) -> Result<Self, Unproved> {
        let (Some(low), Some(high)) = (Number::of(low), Number::of(high)) else {
            return Err(Unproved::NoClaim);
        };
        if low.is_positive() && low <= high {
            Ok(Self { low, high })
        } else {
            Err(Unproved::NoClaim)
        }
    }

    /// `c = (low + high)/2`.
    fn middle(&self) -> Number {
        (&self.low + &self.high).shifted(-1)
    }
}

/// Inertia that changes at a bounded rate, with the multiplier that shows that it may.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingInertia<'a> {
    /// Range of the eigenvalues of `W`.
    pub range: Range,
    /// Largest `‖dW/dt‖` \[1/s\].
    pub rate: f64,
    /// Sample period \[s\].
    pub period: f64,
    /// `λ`, which weighs the drift inside a sample.
    pub drift: f64,
    /// `h_1, h_2, …` of `y = 2 Σ h_j sin jθ`.
    pub taps: &'a [f64],
}

/// Proves that the loop of joints is stable for each constant symmetric `W` with its spectrum in a range (P2); of a
/// single joint, at each inertia ratio of it.
///
/// # Method
///
/// At `μ` in the middle each joint's `N + μΔ` has all roots inside the unit circle. On it, over each cell of `t` there
/// is one number `κ` with
///
/// ```text
/// Re((N_i + aΔ_i)(N_i + bΔ_i)*) + κ sin²θ Im(N_iΔ_i*)/sin θ > 0   for all joints i                      (X1)
/// ```
///
/// Bernstein coefficients are linear: `κ` exists exactly if the lower bounds that they give, all joints together, lie
/// below the upper ones.
///
/// # Errors
///
/// [`Unproved`], with the joint or the frequency.
pub fn frozen(joints: &[JointLoop], range: &Range) -> Result<(), Unproved> {
    alone(joints, range)?;
    let group = |joint: &JointLoop| {
        let [low, high] = [&range.low, &range.high].map(|mu| joint.at(mu));
        let turned = sine_squared().product(&turned(&joint.back, &joint.open));
        vec![real(&low, &high), turned]
    };
    let groups: Vec<Vec<Polynomial>> = joints.iter().map(group).collect();
    everywhere(&groups, |cell| one_multiplier(&cell.groups)).map_err(|fails| at(fails, None))
}

/// Proves (P3): the arm's loop is stable while `W` moves in its range at a bounded rate.
///
/// # Method
///
/// Of each joint, with `c`, `r` middle and half of `[a, b]`, `X = b·rate·T`, `δ = rate·T (1 + X²/12a⁴)`, `η = X/6a²`,
/// `κ = Σ|h_j| min(jδ, b − a)`, and stability at `μ = c`:
///
/// ```text
/// |N + cΔ|² + y Im(NΔ*) > (r² + κ + λη²)(|Δ|² + |K|²/λ) + |K|²y²/4λ                                      (X2)
/// ```
///
/// times `144 λa⁴`, so that nothing is divided; `y` is enclosed over each cell.
///
/// # Errors
///
/// [`Unproved`], with the joint and the frequency.
pub fn moving(joints: &[JointLoop], motion: &MovingInertia<'_>) -> Result<(), Unproved> {
    let number = |value: f64| Number::of(value).ok_or(Unproved::NoClaim);
    let (drift, rate, period) =
        (number(motion.drift)?, number(motion.rate)?, number(motion.period)?);
    let taps = motion.taps.iter().map(|h| number(*h)).collect::<Result<Vec<Number>, _>>()?;
    if !drift.is_positive() || !period.is_positive() || rate < Number::zero() {
        return Err(Unproved::NoClaim);
    }
    let Range { low, high } = &motion.range;
    let square = |x: &Number| x * x;
    let a4 = square(&square(low));
    let change = &rate * &period;
    let x2 = square(&(high * &change));
    // δ and b − a, both times 12a⁴.
    let twelve = &a4 * &Number::from(12);
    let delta = &change * &(&twelve + &x2);
    let width = high - low;
    let most = &width * &twelve;
    let mut kappa = Number::zero();
    for (j, h) in (1..).zip(&taps) {
        let step = (&delta * &Number::from(j)).min(most.clone());
        kappa = &kappa + &(&h.size() * &step);
    }
    let thrice = &twelve * &Number::from(3);
    let half = square(&width).shifted(-2);
    let whole = &(&(&half * &thrice) + &(&kappa * &Number::from(3))) + &(&drift * &x2);
    level(joints, &motion.range, &Level { drift, whole, unit: thrice, taps })
}

/// Proves (P4): the arm's loop is stable however fast `W` moves in its range: (X2) at rest, without taps, with `λ =
/// 3ab`.
///
/// # Errors
///
/// [`Unproved`], with the joint and the frequency.
pub fn any_speed(joints: &[JointLoop], range: &Range) -> Result<(), Unproved> {
    let drift = &(&range.low * &range.high) * &Number::from(3);
    let width = &range.high - &range.low;
    let whole = (&width * &width).shifted(-2);
    level(joints, range, &Level { drift, whole, unit: Number::from(1), taps: Vec::new() })
}

/// Numbers of (X2): `λ`, `(r² + κ + λη²) · unit`, that unit, and the taps.
struct Level {
    drift: Number,
    whole: Number,
    unit: Number,
    taps: Vec<Number>,
}

/// (X2) for each joint.
///
/// `above + U turning − U² bent` with `U = y/sin θ` is concave in `U`: over a cell its least value is at an end of what
/// `U` can be, on one side of a line or the other.
fn level(joints: &[JointLoop], range: &Range, of: &Level) -> Result<(), Unproved> {
    alone(joints, range)?;
    let (middle, sine) = (range.middle(), sine_squared());
    let left = (&of.drift * &of.unit).shifted(2);
    let multiplier = Multiplier::new(&of.taps);
    for (index, joint) in joints.iter().enumerate() {
        let JointLoop { back, open, kick: Some(kick), .. } = joint else {
            return Err(Unproved::NoLoop);
        };
        let size = |p: &Polynomial| real(p, p);
        let kick = size(kick);
        let below = size(open).times(&of.drift).plus(&kick).times(&of.whole.shifted(2));
        let above = size(&joint.at(&middle)).times(&left).minus(&below);
        let turning = sine.product(&turned(back, open)).times(&left);
        let bent = sine.product(&kick).times(&of.unit);
        everywhere(&[vec![above, turning, bent]], |cell| concave(cell, &multiplier))
            .map_err(|fails| at(fails, Some(index)))?;
    }
    Ok(())
}

/// Returns true if `above + U turning − U² bent > 0` on a cell, `bent ≥ 0`.
fn concave(cell: &BernsteinCell, multiplier: &Multiplier<'_>) -> bool {
    let all: Vec<&Vec<BigInt>> = cell.groups.iter().flatten().collect();
    let ([above, turning, bent], Some((from, to))) = (all.as_slice(), cell.ends()) else {
        return false;
    };
    let Line { ends: [start, end], off } = multiplier.over(&from, &to);
    [-&off, off].iter().all(|off| {
        // Both ends of the line in one unit 2^u: above/2^{2u} + U/2^u · turning/2^u − (U/2^u)² bent.
        let (start, end) = (&start + off, &end + off);
        let unit =
            [&start, &end].into_iter().filter_map(Number::exponent).min().unwrap_or(0).min(0);
        let (start, end) = (start.in_units(unit), end.in_units(unit));
        let one = BigInt::from(1) << -unit;
        let raised = |form: &[BigInt], by: [(&BigInt, &BigInt); 2]| {
            by.iter().fold(form.to_vec(), |form, (start, end)| times_line(&form, start, end))
        };
        let [even, line] = [(&one, &one), (&start, &end)];
        let terms = [
            raised(above, [even, even]),
            raised(turning, [line, even]),
            raised(bent, [line, line]),
        ];
        let [above, turning, bent] = &terms;
        above.iter().zip(turning).zip(bent).all(|((a, t), b)| (a + t - b).sign() == Sign::Plus)
    })
}

/// Proves `|1 + L/μ| > modulus` on the unit circle for each `μ` of a range, and stability there.
///
/// # Method
///
/// `q(μ) = |N + μΔ|² − (modulus · μ|Δ|)²` is a parabola in `μ`, open above. It is positive over the range where it is
/// at the low end and rises, where it is at the high end and falls, and where it has no zero at all.
///
/// # Errors
///
/// [`Unproved`], with the frequency.
pub fn modulus(joint: &JointLoop, range: &Range, modulus: f64) -> Result<(), Unproved> {
    let modulus = Number::of(modulus).ok_or(Unproved::NoClaim)?;
    let one = Number::from(1);
    if modulus < Number::zero() || modulus > one {
        return Err(Unproved::NoClaim);
    }
    frozen(core::slice::from_ref(joint), range)?;
    let (back, open) = (real(&joint.back, &joint.back), real(&joint.open, &joint.open));
    let cross = real(&joint.back, &joint.open);
    let own = open.times(&(&one - &(&modulus * &modulus)));
    let ends = [&range.low, &range.high].map(|mu| {
        let slope = cross.plus(&own.times(mu));
        [back.plus(&cross.plus(&slope).times(mu)), slope]
    });
    let apart = back.product(&own).minus(&cross.product(&cross));
    let [low, high] = ends;
    let groups = vec![vec![apart], low.to_vec(), high.to_vec()];
    let holds = |cell: &BernsteinCell| {
        let all: Vec<&Vec<BigInt>> = cell.groups.iter().flatten().collect();
        let [apart, low, rising, high, falling] = all.as_slice() else { return false };
        positive(apart)
            || (positive(low) && not_negative(rising))
            || (positive(high) && not_positive(falling))
    };
    everywhere(&groups, holds).map_err(|fails| at(fails, None))
}

/// Proves that no `−L/μ` with `μ` of a range equals `e^{jψ}` with `|ψ| ≤ angle` \[rad\], on the unit circle.
///
/// # Method
///
/// `C ≤ cos(angle)` is a rational number. At each `t` the loop is larger than the range, or smaller, or `−L` points
/// elsewhere: `−Re(NΔ*) < C |N||Δ|`.
///
/// # Errors
///
/// [`Unproved`], with the frequency.
pub fn phase(joint: &JointLoop, range: &Range, angle: f64) -> Result<(), Unproved> {
    let angle = Number::of(angle).ok_or(Unproved::NoClaim)?;
    if angle < Number::zero() || angle > Number::from(4) {
        return Err(Unproved::NoClaim);
    }
    let (cosine, unit) = cosine_from_below(&angle);
    let (back, open) = (real(&joint.back, &joint.back), real(&joint.open, &joint.open));
    let cross = real(&joint.back, &joint.open);
    let end = |mu: &Number| back.minus(&open.times(&(mu * mu)));
    let sizes = back.product(&open).times(&(&cosine * &cosine));
    let turned = sizes.minus(&cross.product(&cross).times(&(&unit * &unit)));
    let acute = cosine.is_positive();
    let groups = vec![vec![end(&range.high)], vec![end(&range.low)], vec![cross], vec![turned]];
    let holds = |cell: &BernsteinCell| {
        let all: Vec<&Vec<BigInt>> = cell.groups.iter().flatten().collect();
        let [above, below, cross, turned] = all.as_slice() else { return false };
        let elsewhere = if acute {
            positive(cross) || positive(turned)
        } else {
            positive(cross) && negative(turned)
        };
        positive(above) || negative(below) || elsewhere
    };
    everywhere(&groups, holds).map_err(|fails| at(fails, None))
}

/// Proves that no `−L/μ` with `μ` of a range equals `e^{jκθ}`, `0 ≤ κ ≤ samples`, at any `θ` of the unit circle, and
/// that with so many whole samples more of delay, or fewer, the loop is stable.
///
/// # Method
///
/// Over a cell up to `θ_1` the loop is larger than the range, or smaller, or the angle of `−L` lies beyond
/// `samples · θ_1`. `N + μ e^{jκθ} Δ` then has no zero for any `κ`; its argument over `0 … π` is that without a lag,
/// and more by what it is at `θ = π`, where `|N| < μ|Δ|` makes that `πκ`: of `κ` more roots, all are inside.
///
/// # Not exact
///
/// Sine, cosine and arc sine are the platform's, taken to be right within 1e-12.
///
/// # Errors
///
/// [`Unproved`], with the frequency.
pub fn delay(joint: &JointLoop, range: &Range, samples: f64) -> Result<(), Unproved> {
    if !(samples >= 0.0 && samples.is_finite()) {
        return Err(Unproved::NoClaim);
    }
    frozen(core::slice::from_ref(joint), range)?;
    let (back, open) = (real(&joint.back, &joint.back), real(&joint.open, &joint.open));
    let (cross, turn) = (real(&joint.back, &joint.open), turned(&joint.back, &joint.open));
    let end = |mu: &Number| back.minus(&open.times(&(mu * mu)));
    let groups = vec![vec![end(&range.high)], vec![end(&range.low)], vec![cross, turn]];
    let holds = |cell: &BernsteinCell| {
        let all: Vec<&Vec<BigInt>> = cell.groups.iter().flatten().collect();
        let [above, below, cross, turn] = all.as_slice() else { return false };
        let small = negative(below);
        // A lag of a sample or more needs a loop that is small at θ = π.
        let ends_small = small || samples < 1.0 || cell.to() < 1.0;
        let alike = positive(above) || small;
        ends_small && (alike || Beyond::new(cell, samples).is_some_and(|b| b.holds(cross, turn)))
    };
    everywhere(&groups, holds).map_err(|fails| at(fails, None))
}

/// Relative and absolute error of the platform's functions, at most.
const ROOM: f64 = 1e-12;

/// Directions beyond an angle `B < 2π` in `[0, 2π)`, over a cell.
struct Beyond {
    /// `B > π`.
    reflex: bool,
    /// `cos B`, `sin B`.
    toward: [Number; 2],
    /// Bounds of `sin θ`.
    sines: [Number; 2],
}

impl Beyond {
    fn new(cell: &BernsteinCell, samples: f64) -> Option<Self> {
        cell.ends()?;
        let (from, to) = (angle(cell.from), angle(cell.to()));
        let most = samples * to * (1.0 + ROOM) + ROOM;
        if most >= core::f64::consts::TAU - ROOM {
            return None;
        }
        let (sine, cosine) = libm::sincos(most);
        let ends = [libm::sin(from), libm::sin(to)];
        let least = ends[0].min(ends[1]).max(0.0) * (1.0 - ROOM) - ROOM;
        let top = if cell.from < 0.5 && cell.to() > 0.5 { 1.0 } else { ends[0].max(ends[1]) };
        let top = top * (1.0 + ROOM) + ROOM;
        Some(Self {
            reflex: most > core::f64::consts::PI,
            toward: [Number::of(cosine)?, Number::of(sine)?],
            sines: [Number::of(least.max(0.0))?, Number::of(top)?],
        })
    }

    /// `−L` in directions `(−Re, −sin θ · turn)` lies beyond.
    fn holds(&self, cross: &[BigInt], turn: &[BigInt]) -> bool {
        let [cosine, sine] = &self.toward;
        // cos B · Im(−L) − sin B · Re(−L) > 0, linear in sin θ.
        let past =
            self.sines.iter().all(|sin| above_zero((sine, cross), (&-&(cosine * sin), turn)));
        let below_axis = positive(turn);
        if self.reflex { past && below_axis } else { past || below_axis }
    }
}

/// Returns true if `a f + b g > 0` of all coefficients.
fn above_zero((a, f): (&Number, &[BigInt]), (b, g): (&Number, &[BigInt])) -> bool {
    let unit = [a, b].into_iter().filter_map(Number::exponent).min().unwrap_or(0);
    let (a, b) = (a.in_units(unit), b.in_units(unit));
    f.iter().zip(g).all(|(f, g)| (&a * f + &b * g).sign() == Sign::Plus)
}

/// `θ` of `t = sin²(θ/2)` \[rad\].
fn angle(t: f64) -> f64 {
    2.0 * libm::asin(t.sqrt())
}

/// Returns true if `radius ≤ e^{−x}`, `x ≥ 0`: roots within it decay at least as fast.
pub fn decays(radius: &Number, x: &Number) -> bool {
    // e^{−x} lies above each of its Taylor sums that ends with an odd power.
    let (sum, unit) = series(&-x, |k| k, 15);
    *x >= Number::zero() && radius * &unit <= sum
}

/// `C` and a positive unit with `C/unit ≤ cos x`: the cosine lies above each of its Taylor sums that ends below zero.
fn cosine_from_below(x: &Number) -> (Number, Number) {
    series(&-&(x * x), |k| 2 * k * (2 * k - 1), 15)
}

/// `Σ_{k ≤ last} x^k/(f_1 … f_k)` and 1, both times `f_1 … f_last`.
fn series(x: &Number, factor: impl Fn(i64) -> i64, last: i64) -> (Number, Number) {
    let (mut sum, mut unit) = (Number::from(1), Number::from(1));
    for k in (1..=last).rev() {
        unit = &unit * &Number::from(factor(k));
        sum = &(&sum * x) + &unit;
    }
    (sum, unit)
}

/// Each joint alone is stable at the middle of the range.
fn alone(joints: &[JointLoop], range: &Range) -> Result<(), Unproved> {
    let middle = range.middle();
    let bad = joints.iter().position(|joint| !inside(&joint.at(&middle)));
    bad.map_or(Ok(()), |joint| Err(Unproved::Unstable { joint }))
}

/// Frequency at which a condition on `t = sin²(θ/2)` fails.
fn at(fails: Fails, joint: Option<usize>) -> Unproved {
    Unproved::At { joint, theta: angle(fails.0) }
}

/// Returns true if one `κ` makes `f + κg > 0` of all coefficients `f`, `g` of all groups.
fn one_multiplier(groups: &[Forms]) -> bool {
    // Bounds of κ as fractions with positive denominators.
    let mut least: Option<(BigInt, BigInt)> = None;
    let mut most: Option<(BigInt, BigInt)> = None;
    for forms in groups {
        let [values, slopes] = forms.as_slice() else { return false };
        for (f, g) in values.iter().zip(slopes) {
            let (bound, wanted) = match g.sign() {
                Sign::Plus => (&mut least, Ordering::Greater),
                Sign::Minus => (&mut most, Ordering::Less),
                Sign::NoSign if f.sign() == Sign::Plus => continue,
                Sign::NoSign => return false,
            };
            // κ > −f/g where g > 0, κ < f/|g| where g < 0.
            let own = if g.sign() == Sign::Plus { (-f, g.clone()) } else { (f.clone(), -g) };
            let tighter = bound.as_ref().is_none_or(|old| compared(&own, old) == wanted);
            if tighter {
                *bound = Some(own);
            }
        }
    }
    match (least, most) {
        (Some(least), Some(most)) => compared(&least, &most) == Ordering::Less,
        _ => true,
    }
}

/// Order of two fractions with positive denominators: by signs, lengths and leading bits, and by
/// products where these do not decide.
fn compared(a: &(BigInt, BigInt), b: &(BigInt, BigInt)) -> Ordering {
    let (sign, other) = (a.0.sign(), b.0.sign());
    if sign != other || sign == Sign::NoSign {
        return sign.cmp(&other);
    }
    let sizes = sizes((&a.0, &b.1), (&b.0, &a.1));
    if sign == Sign::Minus { sizes.reverse() } else { sizes }
}

/// Order of the sizes of two products, none of which is zero.
fn sizes(left: (&BigInt, &BigInt), right: (&BigInt, &BigInt)) -> Ordering {
    // A product has as many bits as its factors together, or one less.
    let bits = |(x, y): (&BigInt, &BigInt)| x.bits() + y.bits();
    if bits(left).abs_diff(bits(right)) >= 2 {
        return bits(left).cmp(&bits(right));
    }
    let [one, other] = [left, right].map(|(x, y)| {
        let ([x, i], [y, j]) = (leading(x), leading(y));
        (x * y, (x + 1) * (y + 1), i + j)
    });
    let unit = one.2.min(other.2);
    let [(low, high), (other_low, other_high)] =
        [one, other].map(|(low, high, at)| (low << (at - unit), high << (at - unit)));
    if low >= other_high {
        Ordering::Greater
    } else if high <= other_low {
        Ordering::Less
    } else {
        (left.0 * left.1).magnitude().cmp((right.0 * right.1).magnitude())
    }
}

/// The first 62 bits of a size, and the number of bits after them: it lies from these to these and one.
fn leading(x: &BigInt) -> [u128; 2] {
    let rest = x.bits().saturating_sub(62);
    [u128::try_from(x.magnitude() >> rest).unwrap_or_default(), rest.into()]
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;

    use super::compared;

    #[test]
    fn fractions_are_in_the_order_of_their_products() {
        // Small ones, and long ones that differ in their last bits or nowhere.
        let long = BigInt::from(3) << 300;
        let fraction = |i: i64| match i % 3 {
            0 => (BigInt::from(i % 41 - 20), BigInt::from(i / 41 + 1)),
            1 => (&long + i % 5 - 2, &long + i % 7),
            _ => (-&long * (i % 4 + 1) - i % 2, (&long << (i % 9)) + 1),
        };
        for (a, b) in (0..820).flat_map(|i| (0..820).step_by(7).map(move |j| (i, j))) {
            let (a, b) = (fraction(a), fraction(b));
            assert_eq!(compared(&a, &b), (&a.0 * &b.1).cmp(&(&b.0 * &a.1)), "{a:?} {b:?}");
        }
    }
}
