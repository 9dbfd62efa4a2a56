//! The gains of one joint: checked once, then immutable.

use crate::position_gains::PositionGains;
use crate::sampled::sampled_coefficients;
use crate::{Form, Gain, GainError, Limits, ORDER_MAX, Real};

/// Largest measured value, in any unit: 2³².
const VALUE_MAX: f64 = 4_294_967_296.0;

/// Numbers of the observer form, see [`JointGains::update`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObserverNumbers<R> {
    /// `T` \[s\].
    pub period: R,
    /// `M̄` \[kg·m²\].
    pub inertia: R,
    /// `K_p` \[1/s²\].
    pub kp: R,
    /// `K_d` \[1/s\].
    pub kd: R,
    /// `α_{m−1}` first; 0 beyond the order.
    pub alpha: [R; ORDER_MAX],
}

/// Machine code that a sample runs through: that of a form, or that of any form with a low-pass behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Path {
    Observer,
    Literal,
    Positions,
    Filtered,
}

impl Path {
    /// Without a low-pass.
    pub(crate) fn of(form: Form) -> Self {
        match form {
            Form::Observer => Self::Observer,
            Form::Literal => Self::Literal,
            Form::Positions => Self::Positions,
        }
    }
}

/// A [`Form`] that the compiler knows, so that each has machine code of its own: one decision per sample.
pub(crate) trait Built {
    const FORM: Form;
    /// True if a low-pass on the torque command is behind it.
    const FILTERED: bool = false;
}

/// The same with a low-pass on the torque command.
pub(crate) struct Filtered<S>(core::marker::PhantomData<S>);

impl<S: Built> Built for Filtered<S> {
    const FORM: Form = S::FORM;
    const FILTERED: bool = true;
}

/// [`Form::Observer`].
pub(crate) struct AsObserver;
/// [`Form::Literal`].
pub(crate) struct AsLiteral;
/// [`Form::Positions`].
pub(crate) struct FromPositions;

impl Built for AsObserver {
    const FORM: Form = Form::Observer;
}
impl Built for AsLiteral {
    const FORM: Form = Form::Literal;
}
impl Built for FromPositions {
    const FORM: Form = Form::Positions;
}

/// Design of one joint. Always `f64`; the running law may be `f32`.
///
/// # Example
///
/// ```
/// use phihat::{Form, GainError, JointDesign, JointGains};
///
/// // Bandwidth ω = 20 rad/s and damping 1: K_p = ω², K_d = 2ω. Estimator poles at 70 rad/s, 1 kHz.
/// let (w, w_o) = (20.0, 70.0);
/// let design = JointDesign {
///     inertia: 0.8,
///     kp: w * w,
///     kd: 2.0 * w,
///     a: &[w_o * w_o, 2.0 * w_o],
///     period: 1e-3,
///     form: Form::Observer,
/// };
/// assert!(JointGains::<f64>::new(&design).is_ok());
///
/// // An estimator of order 3 with a root in the right half-plane is refused.
/// let unstable = JointDesign { a: &[1e6, 10.0, 10.0], ..design };
/// let why = JointGains::<f64>::new(&unstable);
/// assert_eq!(why, Err(GainError::UnstableEstimator { order: 3 }));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointDesign<'a> {
    /// Nominal inertia `M̄` \[kg·m²\].
    pub inertia: f64,
    /// `K_p` \[1/s²\].
    pub kp: f64,
    /// `K_d` \[1/s\].
    pub kd: f64,
    /// `a_0 … a_{m−1}`, `a_i` in \[1/s^(m−i)\]; the length is the order `m`, 1 … 4.
    pub a: &'a [f64],
    /// Sample period `T` \[s\].
    pub period: f64,
    /// Form of the law: [`Form::Positions`] has a design of its own.
    pub form: Form,
}

/// Gains of one joint, checked and prepared for the running scalar.
///
/// # Law
///
/// ```text
/// τ = M̄ (q̈_d − K_d ė − K_p e) + φ̂                                       as (T1)
/// Φ̂(s) = Q(s) Φ(s),   Q = (Σ_{i<m} a_i s^i)/(s^m + Σ_{i<m} a_i s^i)         as (T2)
/// φ = τ_applied − M̄ q̈
/// ```
///
/// | symbol | code | unit | meaning |
/// |---|---|---|---|
/// | `e = q − q_d` | | rad | position error: measured minus desired |
/// | `M̄` | `inertia` | kg·m² | nominal inertia |
/// | `K_p, K_d` | `kp`, `kd` | 1/s², 1/s | outer loop |
/// | `a_i` | `a` | 1/s^(m−i) | estimator polynomial |
/// | `φ, φ̂` | `phi`, `phi_hat` | N·m | lumped unknown dynamics, its estimate; `φ̂` is *added* to the torque |
///
/// # Not claimed
///
/// Valid gains are not yet stable gains: the loop is stable only while the joint's inertia lies in a
/// window around `M̄` that is closed at both ends. See `docs/theory/window.md`.
///
/// # References
///
/// Hayat, Leibold, Buss (2018), equations (5) to (10), (16).
///
/// # Example
///
/// ```
/// use phihat::{Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference};
///
/// let design = JointDesign {
///     inertia: 0.8, kp: 400.0, kd: 40.0, a: &[4900.0, 140.0], period: 1e-3, form: Form::Observer,
/// };
/// let limits = Limits::new(Some(87.0), Some(1000.0), design.period)?; // N·m, N·m/s
/// let gains = JointGains::<f64>::new(&design)?.with_limits(limits);
/// assert_eq!((gains.order(), gains.inertia()), (2, 0.8));
///
/// // One sample: 2 mrad above a reference at rest. The torque pushes back, M̄ K_p e = 0.64 N·m.
/// let measurement = Measurement { q: 0.002, dq: 0.0, tau_applied: 0.0 };
/// let command = gains.update(&mut JointState::new(), &measurement, &Reference::default());
/// assert!((command.tau + 0.64).abs() < 1e-12);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointGains<R> {
    pub(crate) form: Form,
    pub(crate) path: Path,
    /// Share of the way to the law's torque per sample: `1 − α` of a low-pass, else 1.
    pub(crate) torque_share: R,
    /// Of a law from positions.
    pub(crate) position: PositionGains<R>,
    pub(crate) order: usize,
    pub(crate) period: R,
    pub(crate) inertia: R,
    pub(crate) inertia_inverse: R,
    pub(crate) kp: R,
    pub(crate) kd: R,
    /// Observer: `α_{m−1}, α_{m−2}, …, α_0`, so that entry `j` feeds memory `j`. Literal: `a_{m−1}, …, a_0`.
    pub(crate) alpha: [R; ORDER_MAX],
    /// Literal: the factors of `∫e, ∬e, …` in `−φ̂/M̄`.
    pub(crate) on_integrals: [R; ORDER_MAX],
    /// Literal: the factors of `e` and `ė` in `−φ̂/M̄`.
    pub(crate) on_error: [R; 2],
    pub(crate) limits: Limits<R>,
}

impl<R: Real> JointGains<R> {
    /// Checks a design and prepares it.
    ///
    /// # Errors
    ///
    /// [`GainError`], naming the gain: not finite, not positive, an order outside 1 … 4, an estimator
    /// polynomial with a root in the right half-plane, or gains with which torques would overflow.
    pub fn new(design: &JointDesign<'_>) -> Result<Self, GainError> {
        design.check()?;
        let a = design.a;
        let m = a.len();
        let at = |i: usize| a.get(i).copied().unwrap_or(0.0);
        let factor = |i: usize| ladder_factor(&at, [design.kp, design.kd], i);
        let mut on_integrals = [R::ZERO; ORDER_MAX];
        for (j, entry) in on_integrals.iter_mut().enumerate().take(m) {
            *entry = R::from_f64(factor(m - j)); // j = 0 is ∫e, which is x[m]
        }
        let mut alpha = [R::ZERO; ORDER_MAX];
        let sampled = sampled_coefficients(a, design.period);
        let literal = design.form == Form::Literal;
        for (i, (entry, value)) in alpha.iter_mut().zip(sampled.iter().take(m).rev()).enumerate() {
            *entry = R::from_f64(if literal { at(m - 1 - i) } else { *value });
        }
        let gains = Self {
            form: design.form,
            path: Path::of(design.form),
            torque_share: R::from_f64(1.0),
            position: PositionGains::default(),
            order: m,
            period: R::from_f64(design.period),
            inertia: R::from_f64(design.inertia),
            inertia_inverse: R::from_f64(1.0 / design.inertia),
            kp: R::from_f64(design.kp),
            kd: R::from_f64(design.kd),
            alpha,
            on_integrals,
            on_error: [R::from_f64(factor(m + 1)), R::from_f64(factor(m + 2))],
            limits: Limits::none(),
        };
        if gains.hold_samples_in() { Ok(gains) } else { Err(GainError::Overflow) }
    }

    /// Returns true if samples within ±2³² give finite numbers, with a factor of 2³² to spare for sums and
    /// peaks.
    pub(crate) fn hold_samples_in(&self) -> bool {
        let reach = R::from_f64(VALUE_MAX);
        let most = reach * reach * self.inertia;
        let [on_e, on_de] = self.on_error;
        let own = match self.form {
            Form::Observer => self.alpha,
            Form::Literal => self.on_integrals,
            Form::Positions => self.position.largest(),
        };
        let outer = [self.kp, self.kd, on_e, on_de, R::from_f64(1.0)];
        own.iter().chain(&outer).all(|factor| (most * *factor).is_finite())
            && self.inertia_inverse.is_finite()
            && (most / self.period).is_finite()
    }

    /// These gains with torque limits behind them.
    #[must_use]
    pub fn with_limits(self, limits: Limits<R>) -> Self {
        Self { limits, ..self }
    }

    /// These gains with an estimator of first order, whose pole is at the geometric mean of the poles they have (of the
    /// sampled ones in the observer form, of those of `A_o(s)` in the literal form): for a start without peaking; see
    /// [`Schedule`](crate::Schedule). Gains from positions are left alone.
    #[must_use]
    pub fn first_order(self) -> Self {
        if self.form == Form::Positions || self.order == 1 {
            return self;
        }
        let Some(lowest) = self.alpha.get(self.order - 1).copied() else { return self };
        // Newton's iteration for the m-th root, from the arithmetic mean.
        let m = R::from_f64(self.order as f64);
        let [highest, ..] = self.alpha;
        let mut root = highest / m;
        for _ in 0..60 {
            let mut power = R::from_f64(1.0);
            for _ in 1..self.order {
                power = power * root;
            }
            root = root - (power * root - lowest) / (m * power);
        }
        let mut alpha = [R::ZERO; ORDER_MAX];
        alpha[0] = root;
        let first = Self { order: 1, alpha, ..self }.with_ladder();
        if root > R::ZERO && first.hold_samples_in() { first } else { self }
    }

    /// These gains with every pole of the estimator `factor` times as far from where it stands still, a slower
    /// estimator: of order 1, `a_0` times `factor`. In the literal form the poles of `A_o(s)` count,
    /// `a_i` times `factor^{m−i}`; in the observer form the sampled ones, likewise in `α_i`. For a gentler start; see
    /// [`Schedule`](crate::Schedule). `None` where `factor` is not above 0 and at most 1, and for gains from positions.
    #[must_use]
    pub fn slower(self, factor: R) -> Option<Self> {
        let fits = factor > R::ZERO && factor <= R::from_f64(1.0);
        if !fits || self.form == Form::Positions {
            return None;
        }
        let (mut alpha, mut power) = (self.alpha, R::from_f64(1.0));
        for entry in &mut alpha {
            power = power * factor;
            *entry = *entry * power;
        }
        let slower = Self { alpha, ..self }.with_ladder();
        let whole = alpha.iter().take(self.order).all(|entry| *entry > R::ZERO);
        if whole && slower.hold_samples_in() { Some(slower) } else { None }
    }

    /// The literal form's factors, from its `a`.
    fn with_ladder(self) -> Self {
        if self.form != Form::Literal {
            return self;
        }
        let m = self.order;
        let at = |i: usize| {
            let entry = m.checked_sub(i + 1).and_then(|j| self.alpha.get(j));
            entry.copied().unwrap_or(R::ZERO)
        };
        let factor = |i: usize| ladder_factor(&at, [self.kp, self.kd], i);
        let mut on_integrals = [R::ZERO; ORDER_MAX];
        for (j, entry) in on_integrals.iter_mut().enumerate().take(m) {
            *entry = factor(m - j);
        }
        Self { on_integrals, on_error: [factor(m + 1), factor(m + 2)], ..self }
    }

    /// Returns true if a state of the other gains has the same meaning here: `φ̂` and its derivatives, of the
    /// same observer.
    pub(crate) fn knows_as(&self, other: &Self) -> bool {
        self.form == other.form
            && self.form != Form::Literal
            && self.position.filter.reads_as(&other.position.filter)
    }

    /// The numbers of the observer form, for code that computes the very law of [`update`](Self::update) for
    /// many joints side by side; `None`: another form, or a low-pass behind it.
    pub fn observer(&self) -> Option<ObserverNumbers<R>> {
        let Self { period, inertia, kp, kd, alpha, .. } = *self;
        let numbers = ObserverNumbers { period, inertia, kp, kd, alpha };
        (self.path == Path::Observer).then_some(numbers)
    }

    /// Form of the law.
    pub fn form(&self) -> Form {
        self.form
    }

    /// Order `m` of the estimator.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Nominal inertia `M̄` \[kg·m²\].
    pub fn inertia(&self) -> R {
        self.inertia
    }

    /// The limits in force.
    pub fn limits(&self) -> &Limits<R> {
        &self.limits
    }
}

/// Lemma 1 (16): `x = (∫…∫e, …, ∫e, e, ė)` meets `a_{i−1} K_p + a_{i−2} K_d + a_{i−3}`, `i = 1 … m+2`.
fn ladder_factor<R: Real>(a: &impl Fn(usize) -> R, [kp, kd]: [R; 2], i: usize) -> R {
    let kd_part = if i >= 2 { a(i - 2) * kd } else { R::ZERO };
    let last = if i >= 3 { a(i - 3) } else { R::ZERO };
    a(i - 1) * kp + kd_part + last
}

impl JointDesign<'_> {
    fn check(&self) -> Result<(), GainError> {
        if self.form == Form::Positions {
            return Err(GainError::Form);
        }
        Gain::Inertia.positive(self.inertia)?;
        Gain::Kp.positive(self.kp)?;
        Gain::Kd.positive(self.kd)?;
        Gain::Period.positive(self.period)?;
        if self.a.is_empty() || self.a.len() > ORDER_MAX {
            return Err(GainError::Order { order: self.a.len() });
        }
        for (index, value) in self.a.iter().enumerate() {
            Gain::A(index).positive(*value)?;
        }
        // Routh: with positive coefficients, orders 1 and 2 are stable.
        let stable = match *self.a {
            [a0, a1, a2] => a2 * a1 > a0,
            [a0, a1, a2, a3] => a1 * (a3 * a2 - a1) > a3 * a3 * a0,
            _ => true,
        };
        if stable { Ok(()) } else { Err(GainError::UnstableEstimator { order: self.a.len() }) }
    }
}
