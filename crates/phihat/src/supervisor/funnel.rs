//! A bound on the error at the start, before the estimator has learnt the load.

use super::memory::JointMemory;
use super::moment::ArmMoment;
use super::option_error::{positive, value};
use crate::{Events, Form, JointGains, Measurement, OptionError, Real, Reference};

/// The funnel has come to its final width once what it is wider by is this share of it.
const NARROW_SHARE: f64 = 0.05;

/// A bound `|e| < ψ(t)` for the start, before the estimator takes over.
///
/// # Law
///
/// ```text
/// ψ(t) = final + (initial − final) e^{−t/decay}
/// τ = M̄ (q̈_d − g K_d ė − g² K_p e),    g = 1/(1 − (e/ψ)²),  at most (K_d + a_{m−1})/K_d
/// ```
///
/// The bound on `g` keeps the derivative gain that of the full law, which the inertia window allows; so the
/// funnel holds while `|φ| < M̄ g² K_p ψ` and the torque limit suffices, and leaving it is an event. The
/// estimator listens meanwhile. 0.1 s after ψ has come close to its final value, the torque is blended over to
/// the law, which takes the rest of the error away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Funnel {
    /// ψ at the start \[rad\].
    pub initial: f64,
    /// ψ at the end \[rad\].
    pub r#final: f64,
    /// \[s\]
    pub decay_s: f64,
}

/// [`Funnel`] in the running scalar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FunnelRules<R> {
    pub(crate) excess: R,
    pub(crate) width: R,
    /// Factor of the excess width per sample.
    pub(crate) factor: R,
}

impl Funnel {
    pub(crate) fn rules<R: Real>(
        &self,
        period: f64,
        joint: usize,
    ) -> Result<FunnelRules<R>, OptionError> {
        positive(self.r#final, "final funnel width", joint)?;
        positive(self.decay_s, "funnel decay", joint)?;
        let wider = self.initial.is_finite() && self.initial >= self.r#final;
        value(wider, "initial funnel width", self.initial, "at least the final one", joint)?;
        let [alpha, ..] = crate::sampled::sampled_coefficients(&[1.0 / self.decay_s], period);
        Ok(FunnelRules {
            excess: R::from_f64(self.initial - self.r#final),
            width: R::from_f64(self.r#final),
            factor: R::from_f64(1.0 - alpha * period),
        })
    }
}

impl<R: Real> FunnelRules<R> {
    /// The demand inside the funnel, while there is one; the law's demand otherwise.
    #[allow(clippy::too_many_arguments, reason = "one call, all of it needed")]
    pub(crate) fn demand(
        &self,
        memory: &mut JointMemory<R>,
        gains: &JointGains<R>,
        m: &Measurement<R>,
        reference: &Reference<R>,
        law: R,
        now: &ArmMoment<R>,
        events: &mut Events,
    ) -> R {
        if memory.funnel < R::ZERO {
            return law;
        }
        *events |= Events::FUNNEL;
        let one = R::from_f64(1.0);
        let width = self.width + memory.funnel;
        memory.funnel = (memory.funnel * self.factor).snap();
        let e = m.q - reference.q;
        let de = m.dq - reference.dq;
        let share = e / width;
        let most = one + gains.alpha[0] / gains.kd;
        let room = one - share * share;
        *events |= Events::FUNNEL_LEFT.when(room <= R::ZERO);
        let g = if room * most > one { one / room } else { most };
        let demand = gains.inertia * (reference.ddq - g * (gains.kd * de + g * gains.kp * e));
        let narrow = memory.funnel < R::from_f64(NARROW_SHARE) * self.width;
        memory.funnel_settled = if narrow { memory.funnel_settled.saturating_add(1) } else { 0 };
        if memory.funnel_settled >= now.dwell {
            // Handed over: what the law demands differently is faded out, from this sample on.
            memory.funnel = -one;
            if gains.form != Form::Positions {
                memory.fade_out(demand - law);
            }
            *events |= Events::FUNNEL_OVER;
            return law;
        }
        demand
    }
}
