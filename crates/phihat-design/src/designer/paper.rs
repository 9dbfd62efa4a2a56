//! The paper's recipe to the letter (its sections V and VII), with a certificate that says what holds.

use phihat_certificate::extremes::Extremes as _;
use phihat_study::{PaperRequest, Study};

use super::error::DesignError;
use super::known::PhiOf;
use crate::Certificate;
use crate::arm::Arm;
use crate::claims::least_by_40::{areas, by_40};
use crate::claims::paper::Feedback;
use crate::claims::times::{estimator_at, from_rise_time, from_settling_time};
use crate::claims::weights::q_diagonal;
use crate::claims::{ErrorLimits, MinimalGains, RadiusGains, RadiusRow, UnitLaw};
use crate::prelude::*;
use crate::{Gains, JointRecord};

/// Gains by the recipe.
///
/// # Method
///
/// 1. `K̃, K_p, K_d, b` at which every row of (44), corrected, is an equality: in closed form for m = 1, by
///    Newton's method beyond. Or the least `K̃` by (40), per entry of x, raised where (40) is no bound.
/// 2. `K_p`, `K_d` from the settling or rise time, where one is stated, not below those of step 1.
/// 3. Estimator poles in one place, `factor` times faster than `√K_p`, and faster where `a_{m−1} > K̃` or
///    `b_i` of step 1 ask for it.
///
/// One law for all joints, from the strictest limits and the largest φ of any; or one per joint, from its own.
pub(super) fn design(study: &Study, arm: &Arm, phi: PhiOf<'_>) -> Result<Gains, DesignError> {
    let request = &study.design.paper;
    let count = study.robot.joints.len();
    let known = |joint: usize| phi(joint, request.inertia[joint]);
    let size = |joint: usize| {
        if let Some(typed) = &request.phi_max {
            return Ok(typed[joint]);
        }
        let size = known(joint).size_nm.ok_or(DesignError::PaperSpec("design.paper.phi_max"));
        size.map(|size| size / request.inertia[joint])
    };
    let sizes = (0..count).map(size).collect::<Result<Vec<f64>, DesignError>>()?;
    let groups: Vec<Vec<usize>> = if request.per_joint {
        (0..count).map(|joint| vec![joint]).collect()
    } else {
        vec![(0..count).collect()]
    };
    let (mut laws, mut told) = (Vec::new(), Vec::new());
    for group in &groups {
        let phi_max = group.iter().map(|joint| sizes[*joint]).largest();
        let limits = ErrorLimits { phi_max, x_max: limits(study, group)? };
        let (law, text) = recipe(study, &limits)?;
        laws.extend(group.iter().map(|_| law.clone()));
        told.push(match (request.per_joint, group.first()) {
            (true, Some(joint)) => format!("{}: {text}", study.robot.joints[*joint].name),
            _ => text,
        });
    }
    let head =
        if request.per_joint { "the paper's recipe, joint by joint" } else { "the paper's recipe" };
    let between = if request.per_joint { "\n  " } else { " " };
    let method = format!("{head}:{between}{}", told.join(between));
    let mut gains = gains(study, &laws, method);
    let against = arm.against(request.inertia.clone())?;
    let phi: Vec<_> = (0..count).map(|i| Some(known(i))).collect();
    match Certificate::find(study, &gains, against, &phi) {
        Ok(found) => gains.certificate = Some(found),
        // What (40) asks for can be too fast beside the outer loop for any claim to be found.
        Err(why) if request.by_40 => {
            gains.method = format!("{}; no certificate: {why}", gains.method);
        }
        Err(why) => return Err(why.into()),
    }
    Ok(gains)
}

/// The three steps for one law, and what decided in words.
fn recipe(study: &Study, limits: &ErrorLimits) -> Result<(UnitLaw, String), DesignError> {
    let request = &study.design.paper;
    let (least, why) = minimum(limits, request)?;
    let outer = outer_loop(study, &least);
    let (law, how) = law(&least, outer, request.estimator_factor);
    let mut text = format!(
        "φ_max = {:.4} rad/s², minimum K̃ = {:.4}, K_p = {:.4}, K_d = {:.4} ({}); {how}",
        limits.phi_max, least.k_tilde, least.kp, least.kd, least.from[0]
    );
    if let Some(why) = why {
        let after = after(&law, limits);
        text = format!("{text}; {why}; {after}");
    }
    Ok((law, text))
}

/// The document of these laws, without a certificate.
fn gains(study: &Study, laws: &[UnitLaw], method: String) -> Gains {
    let joint = |((i, joint), law): ((usize, &phihat_model::Joint), &UnitLaw)| JointRecord {
        name: joint.name.clone(),
        inertia_kg_m2: study.design.paper.inertia[i],
        kp_per_s2: law.kp,
        kd_per_s: law.kd,
        a: law.a.clone(),
        observer: None,
    };
    let joints = study.robot.joints.iter().enumerate().zip(laws).map(joint).collect();
    Gains::of(study, joints, method)
}

/// `(∫…∫e, …, ∫e, e, ė)`, each the strictest of these joints.
fn limits(study: &Study, group: &[usize]) -> Result<Vec<f64>, DesignError> {
    let spec = &study.spec;
    let least = |values: &Option<Vec<f64>>, key| {
        let values = values.as_ref().ok_or(DesignError::PaperSpec(key))?;
        Ok::<f64, DesignError>(group.iter().map(|joint| values[*joint]).least())
    };
    let order = study.design.orders.first().copied().unwrap_or(1);
    let repeated = &study.design.paper.integrals_max;
    if repeated.len() + 1 < order {
        return Err(DesignError::PaperSpec("design.paper.integrals_max"));
    }
    let mut x_max: Vec<f64> = repeated[..order - 1].iter().rev().copied().collect();
    x_max.push(least(&spec.error_integral_bound, "spec.error_integral_bound_rad_s")?);
    x_max.push(least(&spec.error_bound, "spec.error_bound_rad")?);
    x_max.push(least(&spec.velocity_error_bound, "spec.velocity_error_bound_rad_s")?);
    Ok(x_max)
}

/// Step 1, and what is to be said of (40) where it was asked for.
fn minimum(
    limits: &ErrorLimits,
    request: &PaperRequest,
) -> Result<(MinimalGains, Option<String>), DesignError> {
    if request.by_40 {
        let found = RadiusGains::of(limits)?;
        let why = correction(&found);
        return Ok((found.gains, Some(why)));
    }
    let found = match (limits.x_max.len(), request.feedback) {
        (3, false) => MinimalGains::first_order(limits)?,
        (_, false) => MinimalGains::newton(limits, Feedback::Ignored)?,
        (_, true) => MinimalGains::newton(limits, Feedback::Included)?,
    };
    Ok((found, None))
}

/// Report of where (40) is false at its own least gains, and of the correction.
fn correction(found: &RadiusGains) -> String {
    let names = names(found.rows.len());
    let row = |(name, row): (&String, &RadiusRow)| {
        let sign = if row.refuted() { "FALSE, " } else { "" };
        format!(
            "|{name}| ≤ {:.3e} ({sign}the worst φ makes {:.3e}, allowed {:.3e})",
            row.by_40, row.worst, row.limit
        )
    };
    let rows: Vec<String> = names.iter().zip(&found.rows).map(row).collect();
    let (least, raised) = (found.by_40.k_tilde, found.gains.k_tilde);
    let done = if raised > least {
        format!("K̃ raised from {least:.4} to {raised:.4}, with which no φ exceeds a limit")
    } else {
        "no φ exceeds a limit: K̃ stays".to_owned()
    };
    format!("(40) at K̃ = {least:.4}: {}; {done}", rows.join(", "))
}

/// Report of the bounds by (40) on the law of steps 2 and 3, and of the errors at the worst φ.
fn after(law: &UnitLaw, limits: &ErrorLimits) -> String {
    let k_tilde = law.a_top();
    if !q_diagonal(law, k_tilde).iter().all(|q| *q > 0.0) {
        return "after steps 2 and 3: Q is not positive at K̃ = a_(m−1), and (40) says nothing"
            .to_owned();
    }
    let by_40 = by_40(law, k_tilde, limits.phi_max);
    let entry = |((name, by_40), (area, limit)): ((&String, &f64), (f64, &f64))| {
        let worst = area * limits.phi_max;
        let kept = if worst <= *limit { "kept" } else { "NOT kept" };
        format!("|{name}| ≤ {by_40:.3e} by (40), {worst:.3e} at the worst φ, {kept}")
    };
    let names = names(by_40.len());
    let pairs = names.iter().zip(&by_40).zip(areas(law).into_iter().zip(&limits.x_max));
    let all: Vec<String> = pairs.map(entry).collect();
    format!("after steps 2 and 3: {}", all.join(", "))
}

/// `(∫…∫e, …, ∫e, e, ė)` in words.
fn names(count: usize) -> Vec<String> {
    let integrals = (1..=count.saturating_sub(2)).rev().map(|k| "∫".repeat(k) + "e");
    integrals.chain(["e".to_owned(), "ė".to_owned()]).collect()
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
        let w = libm::pow(b * m / counts[i], 1.0 / (order - 1 - i) as f64);
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
