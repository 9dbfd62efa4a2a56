//! A joint's gains, as C states them, checked.

use phihat::{Form, GainError, InnovationSection, JointDesign, JointGains, Limits, PositionDesign};

use crate::error::{RefusedCall, Status};
use crate::types::{
    PHIHAT_FORM_LITERAL, PHIHAT_FORM_OBSERVER, PHIHAT_FORM_POSITIONS, PHIHAT_SECTIONS_MAX,
    phihat_joint,
};

/// The law of a joint, behind its limits.
pub(crate) fn law(joint: &phihat_joint, period: f64) -> Result<JointGains<f64>, RefusedCall> {
    let gains = match joint.form {
        PHIHAT_FORM_OBSERVER => with_estimator(joint, period, Form::Observer),
        PHIHAT_FORM_LITERAL => with_estimator(joint, period, Form::Literal),
        PHIHAT_FORM_POSITIONS => from_positions(joint, period),
        other => {
            let why =
                "form is not PHIHAT_FORM_OBSERVER, PHIHAT_FORM_LITERAL or PHIHAT_FORM_POSITIONS";
            Err(RefusedCall::new(Status::BadGain, why).member("form", f64::from(other)))
        }
    }?;
    // A structure that nobody set to zero has any number here: one that would hold the torque is refused.
    if joint.torque_filter_hz.abs() < 1.0 && joint.torque_filter_hz != 0.0 {
        let why = "torque_filter_hz is neither 0, for none, nor at least 1 Hz";
        let refused = RefusedCall::new(Status::BadGain, why);
        return Err(refused.member("torque_filter_hz", joint.torque_filter_hz));
    }
    let low_pass = (joint.torque_filter_hz != 0.0).then_some(joint.torque_filter_hz);
    let gains = gains
        .with_torque_filter(low_pass)
        .map_err(|why| RefusedCall::gain(why).member("torque_filter_hz", joint.torque_filter_hz))?;
    let finite = |x: f64| (!(x.is_infinite() && x > 0.0)).then_some(x);
    let limits =
        Limits::new(finite(joint.torque_max_nm), finite(joint.torque_rate_max_nm_s), period);
    Ok(gains.with_limits(limits.map_err(RefusedCall::gain)?))
}

fn with_estimator(
    joint: &phihat_joint,
    period: f64,
    form: Form,
) -> Result<JointGains<f64>, RefusedCall> {
    let order = joint.order as usize;
    let a = joint.a.get(..order).ok_or(RefusedCall::gain(GainError::Order { order }))?;
    let design = JointDesign {
        inertia: joint.inertia_kg_m2,
        kp: joint.kp_per_s2,
        kd: joint.kd_per_s,
        a,
        period,
        form,
    };
    JointGains::new(&design).map_err(RefusedCall::gain)
}

fn from_positions(joint: &phihat_joint, period: f64) -> Result<JointGains<f64>, RefusedCall> {
    let entries = match joint.order {
        1..=3 => ..joint.order as usize + 2,
        other => {
            let why = "order of PHIHAT_FORM_POSITIONS is not 1, 2 or 3";
            return Err(RefusedCall::new(Status::BadGain, why).member("order", f64::from(other)));
        }
    };
    let design = PositionDesign {
        inertia: joint.inertia_kg_m2,
        kp: joint.kp_per_s2,
        kd: joint.kd_per_s,
        correction: &joint.correction[entries],
        velocity_correction: &joint.velocity_correction[entries],
        share: joint.share,
        delay: usize::try_from(joint.delay_samples).unwrap_or(usize::MAX),
        period,
    };
    let gains = JointGains::from_positions(&design).map_err(RefusedCall::of_positions)?;
    filtered(&gains, joint)
}

/// With the filter on the innovation that the joint asks for.
fn filtered(gains: &JointGains<f64>, joint: &phihat_joint) -> Result<JointGains<f64>, RefusedCall> {
    let count = usize::try_from(joint.sections).unwrap_or(usize::MAX);
    if count == 0 {
        return Ok(*gains);
    }
    let rates = joint.section_rates.get(..count);
    let rates = rates.ok_or(RefusedCall::of_positions(GainError::Sections { count }))?;
    let own = rates.iter().zip(&joint.section_weights_per_s2);
    let own = own.map(|(rates, weights)| InnovationSection { rates: *rates, weights: *weights });
    let mut sections = [InnovationSection::default(); PHIHAT_SECTIONS_MAX];
    for (place, section) in sections.iter_mut().zip(own) {
        *place = section;
    }
    gains
        .with_innovation_filter(&sections[..count])
        .map_err(|why| RefusedCall::of_filter(why, rates))
}
