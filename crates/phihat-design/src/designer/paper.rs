//! The paper's recipe to the letter (its sections V and VII), with a certificate that says what holds.

use phihat_certificate::extremes::Extremes as _;
use phihat_study::Study;

use super::error::DesignError;
use super::known::PhiOf;
use crate::Certificate;
use crate::arm::Arm;
use crate::claims::paper::Feedback;
use crate::claims::times::{estimator_at, from_rise_time, from_settling_time};
use crate::claims::{ErrorLimits, MinimalGains, UnitLaw};
use crate::prelude::*;
use crate::{FORMAT, Gains, JointRecord, VERSION};

/// Gains by the recipe.
///
/// # Method
///
/// 1. `K̃, K_p, K_d, b` at which every row of (44), corrected, is an equality: in closed form for m = 1, by
///    Newton's method beyond.
/// 2. `K_p`, `K_d` from the settling or rise time, where one is stated, not below those of step 1.
/// 3. Estimator poles in one place, `factor` times faster than `√K_p`, and faster where `a_{m−1} > K̃` or
///    `b_i` of step 1 ask for it.
///
/// One law for all joints, from the strictest limits and the largest φ of any.
pub(super) fn design(study: &Study, arm: &Arm, phi: PhiOf<'_>) -> Result<Gains, DesignError> {
    let request = &study.design.paper;
    let joints = &study.robot.joints;
    let known = |joint: usize| phi(joint, request.inertia[joint]);
    let size = |most: f64, joint: usize| {
        let size = known(joint).size_nm.ok_or(DesignError::PaperSpec("design.paper.phi_max"))?;
        Ok::<f64, DesignError>(most.max(size / request.inertia[joint]))
    };
    let phi_max = match request.phi_max {
        Some(typed) => typed,
        None => (0..joints.len()).try_fold(0.0, size)?,
    };
    let limits = ErrorLimits { phi_max, x_max: limits(study)? };
    let least = minimum(&limits, request.feedback)?;
    let (kp, kd) = outer_loop(study, &least);
    let (law, how) = law(&least, (kp, kd), request.estimator_factor);
    let joint = |(i, joint): (usize, &phihat_model::Joint)| JointRecord {
        name: joint.name.clone(),
        inertia_kg_m2: request.inertia[i],
        kp_per_s2: law.kp,
        kd_per_s: law.kd,
        a: law.a.clone(),
        observer: None,
    };
    let mut gains = Gains {
        format: FORMAT.to_owned(),
        version: VERSION,
        study: study.name.clone(),
        study_sha256: study.sha256.clone(),
        rate_hz: 1e9 / study.control.period_ns as f64,
        method: format!(
            "the paper's recipe: φ_max = {phi_max:.4} rad/s², minimum K̃ = {:.4}, K_p = {:.4}, K_d = {:.4} ({}); {how}",
            least.k_tilde, least.kp, least.kd, least.from[0]
        ),
        velocity_filter_hz: None,
        joints: joints.iter().enumerate().map(joint).collect(),
        certificate: None,
        trade_off: Vec::new(),
        limit: Vec::new(),
        coarser: Vec::new(),
    };
    let against = arm.against(request.inertia.clone())?;
    let phi: Vec<_> = (0..joints.len()).map(|i| Some(known(i))).collect();
    gains.certificate = Some(Certificate::find(study, &gains, against, &phi)?);
    Ok(gains)
}

/// `(∫…∫e, …, ∫e, e, ė)`, each the strictest of any joint.
fn limits(study: &Study) -> Result<Vec<f64>, DesignError> {
    let spec = &study.spec;
    let least = |values: &Option<Vec<f64>>, key| {
        let values = values.as_ref().ok_or(DesignError::PaperSpec(key))?;
        Ok::<f64, DesignError>(values.iter().copied().least())
    };
    let order = study.design.orders.first().copied().unwrap_or(1);
    let repeated = &study.design.paper.integrals_max;
    if repeated.len() + 1 < order {
        return Err(DesignError::PaperSpec("design.paper.integrals_max"));
    }
    let mut x_max: Vec<f64> = repeated[..order - 1].iter().rev().copied().collect();
    x_max.push(least(&spec.error_integral_max, "spec.error_integral_max_rad_s")?);
    x_max.push(least(&spec.error_bound, "spec.error_max_rad")?);
    x_max.push(least(&spec.velocity_error_max, "spec.velocity_error_max_rad_s")?);
    Ok(x_max)
}

/// Step 1.
fn minimum(limits: &ErrorLimits, feedback: bool) -> Result<MinimalGains, DesignError> {
    let found = match (limits.x_max.len(), feedback) {
        (3, false) => MinimalGains::first_order(limits)?,
        (_, false) => MinimalGains::newton(limits, Feedback::Ignored)?,
        (_, true) => MinimalGains::newton(limits, Feedback::Included)?,
    };
    Ok(found)
}

/// Step 2.
fn outer_loop(study: &Study, least: &MinimalGains) -> (f64, f64) {
    let damping = study.design.paper.damping;
    let settling = study.design.settling_time.map(|time| from_settling_time(time, damping));
    let rise = study.design.rise_time.map(|time| from_rise_time(time, damping));
    let faster = |(kp, kd): (f64, f64), (p, d): (f64, f64)| (kp.max(p), kd.max(d));
    settling.into_iter().chain(rise).fold((least.kp, least.kd), faster)
}

/// Step 3, and what decided in words.
fn law(least: &MinimalGains, (kp, kd): (f64, f64), factor: f64) -> (UnitLaw, String) {
    let order = least.b.len() + 1;
    // All poles at w: a_i = C(m,i) w^{m−i}, so b_i = C(m,i) w^{m−1−i}/m.
    let counts = estimator_at(order, 1.0);
    let m = order as f64;
    let mut needed = least.k_tilde / m;
    let mut why = "a_{m−1} = K̃";
    for (i, b) in least.b.iter().enumerate() {
        let w = (b * m / counts[i]).powf(1.0 / (order - 1 - i) as f64);
        if w > needed {
            (needed, why) = (w, "the least b_i");
        }
    }
    let asked = factor * kp.sqrt();
    let how = if asked >= needed {
        format!("estimator {factor} times faster than the outer loop")
    } else {
        format!("estimator {:.2} times faster than the outer loop, for {why}", needed / kp.sqrt())
    };
    // A hair above, so that 1/γ² = a_{m−1} − K̃ is not negative by rounding.
    let w = asked.max(needed * (1.0 + 1e-9));
    (UnitLaw { kp, kd, a: estimator_at(order, w) }, how)
}
