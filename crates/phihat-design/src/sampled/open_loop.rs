//! The loop cut open at the torque: one rational function that does not depend on the inertia.

use nalgebra::Complex;
use phihat::{Form, TorqueSource, VelocitySource};

use super::estimator::sampled_coefficients;
use super::model::LoopModel;
use super::model::LoopParts;
use super::polynomial::{Polynomial, on_circle};
use super::positions::Positions;
use crate::JointRecord;

/// `L(z) = N(z)/Δ(z)` of one joint: the closed loop at inertia ratio `μ` has the characteristic
/// polynomial `Δ(z) + N(z)/μ`.
///
/// # Law
///
/// In `w = z − 1`, torque `U` (in units of `M̄`) at the drive's input, drive `X = w + 1 − e^{−ωT}`:
///
/// ```text
/// q = q_n/(w² X) U/μ,    q_n = T²(X − c₁w) + w(T²X/2 − c₂w)            held torque, double integrator
/// y = y_n/(w² X F) U/μ,  y_n = f z T w (X − c₁w)  or  f w q_n/T,  F = w + f      velocity and its filter
/// observer:  Δ = w² F (A_o z^d X − A_α (X − c₁w)),   N = (A_o K_d + A_α w/T) y_n + A_o K_p q_n F
/// positions: [`positions`]
/// literal:   Δ = w^{m+2} z^d X F,   N = w^m ((K_d + κ_1) y_n + (K_p + κ_0) q_n F) + Σ_j k_j (Tz)^j w^{m−j} q_n F
/// ```
///
/// `A_α = Σ α_i (w/T)^i`, `A_o = (w/T)^m + A_α` (multiplied by `T^m`); `κ`, `k_j` the factors of (16).
///
/// `d` counts the samples of both delays. An observer that receives the torque demanded has `X` in place of
/// `X − c₁w` in `Δ`.
///
/// The loop is cut where the torque meets the inertia: what the observer is told has acted stays known.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenLoop {
    pub(crate) numerator: Polynomial,
    pub(crate) denominator: Polynomial,
    period: f64,
}

impl OpenLoop {
    /// The open loop of one joint's gains in a loop model.
    pub fn new(gains: &JointRecord, model: &LoopModel) -> Self {
        Self::with_drive_gain(gains, model, 1.0)
    }

    /// The same where the drive gives `gain` times the torque that it is told.
    pub(crate) fn with_drive_gain(gains: &JointRecord, model: &LoopModel, gain: f64) -> Self {
        let plant = Plant::new(model).times(gain);
        let (numerator, denominator) = by_form(gains, model, &plant);
        Self { numerator, denominator, period: model.period_s }
    }

    /// The open loop, and the numerator over the same `Δ` from kicks in position of `T²/2`, one at the end of each
    /// sample, to minus the torque. A measured velocity does not see them.
    pub(crate) fn with_kick(gains: &JointRecord, model: &LoopModel) -> (Self, Polynomial) {
        let t = model.period_s;
        let q = Polynomial::new(vec![0.0, 0.5 * t * t]);
        let y = match model.velocity {
            VelocitySource::Measured => Polynomial::new(vec![0.0]),
            VelocitySource::Differenced => q.scaled(model.filter_gain() / t).raised(1),
        };
        let plant = Plant { q, y, ..Plant::new(model) };
        let (kick, _) = by_form(gains, model, &plant);
        (Self::new(gains, model), kick)
    }

    /// `L(e^{jθ})` at the frequency `θ` \[rad/sample\]; the loop at inertia ratio `μ` is `L/μ`.
    pub fn at_angle(&self, theta: f64) -> Complex<f64> {
        let w = on_circle(theta, 1.0);
        self.numerator.at(w) / self.denominator.at(w)
    }

    /// Sample period \[s\].
    pub fn period(&self) -> f64 {
        self.period
    }

    /// `Δ + N/μ`.
    pub(crate) fn closed(&self, mu: f64) -> Polynomial {
        self.denominator.plus(&self.numerator.scaled(1.0 / mu))
    }
}

/// From held torque to position and velocity at the samples.
struct Plant {
    /// `X`.
    drive: Polynomial,
    /// `X − c₁w`: numerator of the mean torque over `X`.
    mean: Polynomial,
    q: Polynomial,
    y: Polynomial,
    /// `F`.
    filter: Polynomial,
}

impl Plant {
    /// Behind a drive of this gain.
    fn times(self, gain: f64) -> Self {
        let [mean, q, y] = [&self.mean, &self.q, &self.y].map(|p| p.scaled(gain));
        Self { mean, q, y, ..self }
    }

    fn new(model: &LoopModel) -> Self {
        let t = model.period_s;
        let (drive, mean, double) = match model.drive() {
            Some(d) => (
                Polynomial::new(vec![d.lost, 1.0]),
                Polynomial::new(vec![d.lost, 1.0 - d.mean]),
                Polynomial::new(vec![0.0, -d.double]),
            ),
            None => (Polynomial::one(), Polynomial::one(), Polynomial::new(vec![0.0])),
        };
        let held = drive.scaled(0.5 * t * t).plus(&double);
        let q = mean.scaled(t * t).plus(&held.raised(1));
        let f = model.filter_gain();
        let filtered = Polynomial::new(vec![f, 1.0]);
        let (y, filter) = match (model.velocity, model.filters()) {
            (VelocitySource::Measured, false) => (mean.scaled(t).raised(1), Polynomial::one()),
            (VelocitySource::Measured, true) => {
                (mean.times(&Polynomial::z_power(1)).scaled(f * t).raised(1), filtered)
            }
            (VelocitySource::Differenced, _) => (q.scaled(f / t).raised(1), filtered),
        };
        Self { drive, mean, q, y, filter }
    }
}

/// `N` and `Δ`.
fn by_form(gains: &JointRecord, model: &LoopModel, plant: &Plant) -> (Polynomial, Polynomial) {
    match (model.form, Positions::of(gains, model.period_s)) {
        (_, Some(law)) => positions(&law, model, plant),
        (Form::Literal, None) => literal(gains, model, plant),
        _ => observer(gains, model, plant),
    }
}

/// `Δ = w² (A_o X (z^D (z − 1 + g) − g Σ c_j z^{D−j}) − g z^{D−d} R_a (X − c₁w))`,
/// `N = −g z^{D+1−d} R_y q_n`, `D` the longer of the delay and what the law predicts across.
fn positions(law: &Positions, model: &LoopModel, plant: &Plant) -> (Polynomial, Polynomial) {
    let (g, late) = (law.share, model.late() as usize);
    let longer = late.max(law.ahead());
    let [whole, reading, acted] = law.transfer();
    let fed = match model.torque {
        TorqueSource::Applied => &plant.mean,
        TorqueSource::Demanded => &plant.drive,
    };
    let own = Polynomial::new(vec![g, 1.0]).times(&Polynomial::z_power(longer));
    let own = own.plus(&law.on_their_way(longer).scaled(-g));
    let told = acted.times(fed).times(&Polynomial::z_power(longer - late)).scaled(-g);
    let unknown = whole.times(&plant.drive).times(&own).plus(&told);
    let back = reading.times(&plant.q).times(&Polynomial::z_power(longer + 1 - late)).scaled(-g);
    // A constant φ leaves nothing: what rounding leaves of the lowest coefficient is none.
    (back, unknown.without_lowest().raised(2))
}

fn observer(gains: &JointRecord, model: &LoopModel, plant: &Plant) -> (Polynomial, Polynomial) {
    let t = model.period_s;
    let part = Polynomial::new(sampled_coefficients(&gains.a, t));
    let whole = part.plus(&Polynomial::one().raised(gains.a.len()));
    let delay = Polynomial::z_power(model.late() as usize);
    let fed = match model.torque {
        TorqueSource::Applied => &plant.mean,
        TorqueSource::Demanded => &plant.drive,
    };
    let unknown = whole.times(&delay).times(&plant.drive).plus(&part.times(fed).scaled(-1.0));
    let on_velocity = whole.scaled(gains.kd_per_s).plus(&part.raised(1).scaled(1.0 / t));
    let on_position = whole.scaled(gains.kp_per_s2).times(&plant.filter);
    let numerator = on_velocity.times(&plant.y).plus(&on_position.times(&plant.q));
    (numerator, unknown.times(&plant.filter).raised(2))
}

fn literal(gains: &JointRecord, model: &LoopModel, plant: &Plant) -> (Polynomial, Polynomial) {
    let m = gains.a.len();
    let factors = literal_factors(gains);
    let position = plant.q.times(&plant.filter);
    let on_velocity = plant.y.scaled(gains.kd_per_s + factors[m + 1]);
    let mut numerator = on_velocity.plus(&position.scaled(gains.kp_per_s2 + factors[m])).raised(m);
    for j in 1..=m {
        let factor = factors[m - j] * model.period_s.powi(i32::try_from(j).unwrap_or(i32::MAX));
        let term = Polynomial::z_power(j).scaled(factor).raised(m - j);
        numerator = numerator.plus(&term.times(&position));
    }
    let delay = Polynomial::z_power(model.late() as usize);
    (numerator, delay.times(&plant.drive).times(&plant.filter).raised(m + 2))
}

/// `a_{i−1} K_p + a_{i−2} K_d + a_{i−3}`, `i = 1 … m+2`: (16), on `(∫…∫e, …, ∫e, e, ė)`.
pub(crate) fn literal_factors(gains: &JointRecord) -> Vec<f64> {
    let a = |i: usize, back: usize| {
        i.checked_sub(back).and_then(|k| gains.a.get(k)).copied().unwrap_or(0.0)
    };
    let factor = |i: usize| a(i, 1) * gains.kp_per_s2 + a(i, 2) * gains.kd_per_s + a(i, 3);
    (1..=gains.a.len() + 2).map(factor).collect()
}
