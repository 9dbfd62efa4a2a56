//! The loop in frequency, from gains and model: what returns to the torque.

use core::f64::consts::TAU;
use phihat::{Form, TorqueSource, VelocitySource};

use super::complex::{Complex, Disc, horner};
use super::estimator;
use super::sight::Sight;
use crate::{JointRecord, LoopModel};

/// `Δ(w)` and `N(w)` with the characteristic polynomial `Δ + N/μ`, `w = z − 1`, as products that lose nothing near
/// `w = 0`.
///
/// # Law
///
/// Torque told `U`, in units of `M̄`; drive `X = w + ℓ`, `ℓ = 1 − e^{−ωT}`, mean torque `(X − c w)U/X`,
/// double integral `(T²X/2 − D w)U/X`:
///
/// ```text
/// q = (T²(X − cw) + w(T²X/2 − Dw))/(w²Xμ) U =: n_q/(w²Xμ) U,      q̇ = T(X − cw)/(wXμ) U
/// y = q̇ | f z q̇/F | f w q/(T F),   F = w + f                      as sensed, filtered, differenced
/// observer: Δ = w³F (w^{m−1}z^d X + A (X Σ_{i<d} z^i + c)),   N = (A_o K_d + A w/T) y_n + A_o K_p n_q F
/// literal:  Δ = w^{m+2}z^d X F,
///           N = w^m ((K_d + k_{m+2})y_n + (K_p + k_{m+1})n_qF) + Σ_j k_{m+1−j}(Tz)^j w^{m−j} n_qF
/// ```
///
/// `A = Σ b_i w^i`, `A_o = w^m + A`, `b` of (T5); the bracket's `c` only where the observer is fed with the torque that
/// acted; `k` of (16); `d` counts both delays.
#[derive(Debug, Clone)]
pub(crate) struct Returns {
    form: Form,
    order: usize,
    period: f64,
    late: usize,
    kp: f64,
    kd: f64,
    /// `b` of (T5).
    b: Vec<f64>,
    /// `k_1 … k_{m+2}` of (16).
    k: Vec<f64>,
    velocity: VelocitySource,
    filter: Option<f64>,
    drive: Option<Drive>,
    fed_applied: bool,
    sight: Option<Sight>,
}

/// A first-order drive over one interval.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drive {
    /// `ℓ = 1 − e^{−ωT}`.
    pub(crate) lost: f64,
    /// `c = (1/T) ∫_0^T e^{−ωt} dt`.
    pub(crate) mean: f64,
    /// `D = ∫_0^T (T − t) e^{−ωt} dt` \[s²\].
    pub(crate) double: f64,
}

impl Drive {
    /// The drive of a loop; `None`: torque acts at once.
    pub(crate) fn of(model: &LoopModel) -> Option<Self> {
        model.drive_bandwidth_hz.map(|hz| {
            let x = TAU * hz * model.period_s;
            let lost = -(-x).exp_m1();
            // (x − ℓ)/x² by its series where the difference would cancel.
            let bent = if x < 0.03 {
                0.5 - x / 6.0 + x * x / 24.0 - x * x * x / 120.0 + x * x * x * x / 720.0
            } else {
                (x - lost) / (x * x)
            };
            Self { lost, mean: lost / x, double: bent * model.period_s * model.period_s }
        })
    }
}

/// Gain of the velocity's low-pass per sample; `None`: no filter.
pub(crate) fn filter(model: &LoopModel) -> Option<f64> {
    model.velocity_filter_hz.map(|hz| -(-TAU * hz * model.period_s).exp_m1())
}

/// `k_1 … k_{m+2}` of (16), the coefficients of `D(s)(a_{m−1}s^{m−1} + … + a_0)`, ascending.
pub(crate) fn literal(record: &JointRecord) -> Vec<f64> {
    let mut k = vec![0.0; record.a.len() + 2];
    for (i, a) in record.a.iter().enumerate() {
        for (j, d) in [record.kp_per_s2, record.kd_per_s, 1.0].into_iter().enumerate() {
            k[i + j] += a * d;
        }
    }
    k
}

/// Values of `Δ` and `N` at one frequency, or over a disc of frequencies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Return {
    /// `Δ`.
    pub(crate) open: Disc,
    /// `N`.
    pub(crate) back: Disc,
}

impl Returns {
    pub(crate) fn new(record: &JointRecord, model: &LoopModel) -> Self {
        Self {
            form: model.form,
            order: record.order(),
            period: model.period_s,
            late: (model.delay_samples + model.sample_delay_samples) as usize,
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            b: estimator::sampled(&record.a, model.period_s),
            k: literal(record),
            velocity: model.velocity,
            filter: filter(model),
            drive: Drive::of(model),
            fed_applied: model.torque == TorqueSource::Applied,
            sight: Sight::of(record, model.period_s),
        }
    }

    /// Degree of `Δ + N/μ` in `z`.
    pub(crate) fn degree(&self) -> usize {
        if let Some(sight) = &self.sight {
            let longer = self.late.max(sight.ahead);
            let law = 5 + self.order + sight.filtered();
            return law + longer + usize::from(self.drive.is_some());
        }
        let filters = self.velocity == VelocitySource::Differenced || self.filter.is_some();
        2 + self.order + self.late + usize::from(filters) + usize::from(self.drive.is_some())
    }

    /// The numerator over the same `Δ` from kicks of `T²/2` in position, one at the end of each sample, which
    /// do not show in a measured velocity, over a disc of `w`; without a drive.
    pub(crate) fn kicked(&self, w: Disc) -> Disc {
        let t = self.period;
        let n_q = w.times(0.5 * t * t);
        let (y, f) = match (self.velocity, self.filter) {
            (VelocitySource::Measured, None) => (Disc::real(0.0), Disc::real(1.0)),
            (VelocitySource::Measured, Some(f)) => (Disc::real(0.0), w + Disc::real(f)),
            (VelocitySource::Differenced, f) => {
                let f = f.unwrap_or(1.0);
                ((w * n_q).times(f / t), w + Disc::real(f))
            }
        };
        let one = Disc::real(1.0);
        self.by_form(w, (one, f), (n_q, y), one).back
    }

    /// `Δ` and `N` over a disc of `w`.
    pub(crate) fn at(&self, w: Disc) -> Return {
        let t = self.period;
        let z = w + Disc::real(1.0);
        let (x, mean, double) = self.drive_at(w);
        let n_q = mean.times(t * t) + w * double;
        let (y, f) = match (self.velocity, self.filter) {
            (VelocitySource::Measured, None) => (w * mean.times(t), Disc::real(1.0)),
            (VelocitySource::Measured, Some(f)) => ((w * z * mean).times(f * t), w + Disc::real(f)),
            (VelocitySource::Differenced, f) => {
                let f = f.unwrap_or(1.0);
                ((w * n_q).times(f / t), w + Disc::real(f))
            }
        };
        self.by_form(w, (x, f), (n_q, y), mean)
    }

    fn by_form(&self, w: Disc, (x, f): (Disc, Disc), (n_q, y): (Disc, Disc), mean: Disc) -> Return {
        match (self.form, &self.sight) {
            (Form::Positions, Some(sight)) => self.positions(sight, w, (x, mean), n_q),
            (Form::Literal, _) => self.literal(w, (x, f), (n_q, y)),
            _ => self.observer(w, (x, f), (n_q, y)),
        }
    }

    /// `Δ = w² (A_o (z^D X (z − 1 + g) − g X Σ c_j z^{D−j}) − g R_a (X − cw) z^{D−d})`,
    /// `N = −g z^{D+1−d} R_y n_q`: `R_y`, `R_a`, `c` of the wanted torque, `D` the longer of the delay and
    /// the law's prediction. A filter's `P` is in `A_o`: its modes are among the roots, whatever their effect
    /// on the torque.
    fn positions(&self, sight: &Sight, w: Disc, (x, mean): (Disc, Disc), n_q: Disc) -> Return {
        let z = w + Disc::real(1.0);
        let (g, longer) = (sight.share(), self.late.max(sight.ahead));
        let answer = sight.at(w);
        let fed = if self.fed_applied { mean } else { x };
        let coming = sight.coming().iter().enumerate();
        let own = (w + Disc::real(g)) * z.power(longer);
        let own = coming.fold(own, |sum, (j, c)| sum + z.power(longer - j).times(-g * c));
        let acted = (answer.acted * fed * z.power(longer - self.late)).times(-g);
        let back = (answer.reading * n_q * z.power(longer + 1 - self.late)).times(-g);
        Return { open: w.power(2) * (answer.whole * x * own + acted), back }
    }

    /// `X`, `X − cw`, `T²X/2 − Dw`.
    fn drive_at(&self, w: Disc) -> (Disc, Disc, Disc) {
        let half = 0.5 * self.period * self.period;
        match self.drive {
            None => (Disc::real(1.0), Disc::real(1.0), Disc::real(half)),
            Some(Drive { lost, mean, double }) => (
                w + Disc::real(lost),
                w.times(1.0 - mean) + Disc::real(lost),
                w.times(half - double) + Disc::real(half * lost),
            ),
        }
    }

    fn observer(&self, w: Disc, (x, f): (Disc, Disc), (n_q, y): (Disc, Disc)) -> Return {
        let z = w + Disc::real(1.0);
        let part = horner(&self.b, w);
        let whole = w.power(self.order) + part;
        let late = (0..self.late).fold(Disc::real(0.0), |sum, i| sum + z.power(i));
        let lag = self.drive.filter(|_| self.fed_applied).map_or(0.0, |drive| drive.mean);
        let unknown =
            w.power(self.order - 1) * z.power(self.late) * x + part * (x * late + Disc::real(lag));
        let on_velocity = whole.times(self.kd) + (part * w).times(1.0 / self.period);
        Return {
            open: w.power(3) * f * unknown,
            back: on_velocity * y + (whole * n_q * f).times(self.kp),
        }
    }

    fn literal(&self, w: Disc, (x, f): (Disc, Disc), (n_q, y): (Disc, Disc)) -> Return {
        let (m, z) = (self.order, w + Disc::real(1.0));
        let position = n_q * f;
        let plain = y.times(self.kd + self.k[m + 1]) + position.times(self.kp + self.k[m]);
        let mut back = w.power(m) * plain;
        for j in 1..=m {
            let sums = z.times(self.period).power(j) * w.power(m - j);
            back = back + (sums * position).times(self.k[m - j]);
        }
        Return { open: w.power(m + 2) * z.power(self.late) * x * f, back }
    }

    /// Torque commanded per reading error, at one point: `−z^d w² X (…)/(Δ + N/μ)`.
    pub(crate) fn reading_to_torque(&self, w: Complex, mu: f64) -> Complex {
        let at = Disc::new(w, 0.0);
        let z = at + Disc::real(1.0);
        let (x, _, _) = self.drive_at(at);
        let (f, share) = match (self.velocity, self.filter) {
            (VelocitySource::Measured, None) => (Disc::real(1.0), 0.0),
            (VelocitySource::Measured, Some(f)) => (at + Disc::real(f), 0.0),
            (VelocitySource::Differenced, f) => {
                let f = f.unwrap_or(1.0);
                (at + Disc::real(f), f / self.period)
            }
        };
        // n in place of n_q, and what differencing makes of it in place of y.
        let sensed = at.times(share);
        let m = self.order;
        let both = self.at(at);
        let closed = both.open.centre + both.back.centre.times(1.0 / mu);
        if let Some(sight) = &self.sight {
            let longer = self.late.max(sight.ahead);
            let heard = sight.at(at).reading * x * at.power(2) * z.power(longer + 1);
            return heard.times(sight.share()).centre.over(closed);
        }
        let heard = match self.form {
            Form::Observer | Form::Positions => {
                let part = horner(&self.b, at);
                let whole = at.power(m) + part;
                let on_velocity = whole.times(self.kd) + (part * at).times(1.0 / self.period);
                on_velocity * sensed + (whole * f).times(self.kp)
            }
            Form::Literal => {
                let plain = sensed.times(self.kd + self.k[m + 1]) + f.times(self.kp + self.k[m]);
                let sums = |j: usize| z.times(self.period).power(j) * at.power(m - j) * f;
                let first = at.power(m) * plain;
                (1..=m).fold(first, |sum, j| sum + sums(j).times(self.k[m - j]))
            }
        };
        let up = z.power(self.late) * at.power(2) * x * heard;
        -up.centre.over(closed)
    }
}
