//! The gains an arm starts with: they have to hold for its inertia as the running ones do.

use nalgebra::{Complex, DMatrix, DVector};
use phihat::Form;
use phihat_study::Study;

use super::inside::inside;
use crate::ArmInertia;
use crate::JointRecord;
use crate::claims::Refutation;
use crate::portable;
use crate::prelude::*;
use crate::sampled::eigenvalues::eigenvalues;
use crate::sampled::{InertiaWindow, LoopModel, estimator_coefficients};

/// Checks that the start gains' window contains the arm, where the study's supervisor starts with other gains.
///
/// # Errors
///
/// The [`Refutation`] that forbids it.
pub(super) fn start_inside_window(
    study: &Study,
    record: &JointRecord,
    model: &LoopModel,
    arm: &ArmInertia,
) -> Result<(), Refutation> {
    let Some(start) = start(study, record, model) else { return Ok(()) };
    InertiaWindow::find(&start, model)
        .and_then(|window| inside(&window, arm, 1.0))
        .map_err(|why| Refutation { claim: format!("{} of the start gains", why.claim), ..why })
}

/// The gains that the supervisor starts with, as the estimator `a` that samples to them.
fn start(study: &Study, record: &JointRecord, model: &LoopModel) -> Option<JointRecord> {
    let request = study.supervisor.as_ref()?;
    let first = request.start_first_order.then(|| first_order(record, model));
    match request.start_factor {
        Some(factor) => Some(slower(&first.unwrap_or_else(|| record.clone()), factor, model)),
        None => first,
    }
}

/// The gains of `JointGains::first_order`: in the observer form `α = α_0^{1/m}`, which is the estimator
/// `a = −ln(1 − αT)/T`; in the literal form `a_0^{1/m}`.
fn first_order(record: &JointRecord, model: &LoopModel) -> JointRecord {
    let root = |lowest: Option<&f64>| {
        libm::pow(lowest.copied().unwrap_or(f64::NAN), 1.0 / record.a.len() as f64)
    };
    let a = if model.form == Form::Literal {
        root(record.a.first())
    } else {
        let alpha = root(estimator_coefficients(record, model.period_s).first());
        -libm::log1p(-alpha * model.period_s) / model.period_s
    };
    JointRecord { a: vec![a], ..record.clone() }
}

/// The gains of `JointGains::slower`: in the literal form `a_i f^{m−i}`; in the observer form the estimator
/// whose sampled poles are `f` times as far from 1.
fn slower(record: &JointRecord, factor: f64, model: &LoopModel) -> JointRecord {
    let m = record.a.len();
    let a = if model.form == Form::Literal {
        let mut power = 1.0;
        let mut a = record.a.clone();
        for entry in a.iter_mut().rev() {
            power *= factor;
            *entry *= power;
        }
        a
    } else {
        let period = model.period_s;
        let companion = DMatrix::from_fn(m, m, |i, j| {
            let below = if i == j + 1 { 1.0 } else { 0.0 };
            if j + 1 == m { -record.a[i] } else { below }
        });
        // (z − 1) of each pole, taken closer, and back: Π (s − ln(1 + f(e^{sT} − 1))/T).
        let one = Complex::new(1.0, 0.0);
        let mut product = vec![one];
        // Where they are not found, what comes of it is no number, and no claim.
        let poles = eigenvalues(companion)
            .unwrap_or_else(|| DVector::from_element(m, Complex::new(f64::NAN, 0.0)));
        for pole in poles.iter() {
            let moved = portable::ln(one + (portable::exp(pole * period) - one) * factor) / period;
            let mut next = vec![Complex::new(0.0, 0.0); product.len() + 1];
            for (i, c) in product.iter().enumerate() {
                next[i + 1] += c;
                next[i] -= c * moved;
            }
            product = next;
        }
        product.iter().take(m).map(|c| c.re).collect()
    };
    JointRecord { a, ..record.clone() }
}
