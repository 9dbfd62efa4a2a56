//! Claims of a certificate about a run, as bounds for every joint and time.

use phihat_certificate::extremes::{Extremes as _, larger};
use phihat_certificate::tube::UNREAD;
use phihat_certificate::{LeftOut, NotCounted, Tube, TubeJoint};
use phihat_design::Gains;
use phihat_design::claims::Refutation;
use phihat_session::tube_reference;
use phihat_study::Study;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::start::held_at_start;

/// Bounds on error and velocity error of every joint, until the end of the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AttackClaim {
    /// Joints, in the robot's order.
    pub joints: Vec<JointClaim>,
    /// When the steady part begins \[s\].
    pub settle_s: f64,
    /// True if it is claimed that no torque or rate limit acts. If false, a run in which one acts is outside
    /// of the claim.
    pub limits_silent: bool,
}

/// Bounds of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointClaim {
    /// Its name.
    pub name: String,
    /// When the first bin begins \[s\].
    pub from_s: f64,
    /// Length of a bin \[s\]; infinite: one bin.
    pub bin_s: Option<f64>,
    /// Least and largest error of each bin \[rad\].
    pub error: Vec<(f64, f64)>,
    /// Least and largest velocity error \[rad/s\].
    pub velocity: Vec<(f64, f64)>,
    /// Largest torque commanded \[N·m\]; empty: not claimed.
    pub torque: Vec<f64>,
    /// Largest change of it from one sample to the next \[N·m\].
    pub step: Vec<f64>,
    /// Torque that held the joint before the first sample \[N·m\]: where its first change begins.
    #[serde(default)]
    pub held: f64,
}

/// Why gains claim nothing about a study, as the certificate has it.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NoClaim {
    /// There is no certificate.
    #[error("no certificate")]
    NoCertificate,
    /// A claim without which the gains do not arm is refused.
    #[error("refused: {0}")]
    Refused(Refutation),
    /// There is no tube.
    #[error("tube: {0}")]
    NoTube(String),
    /// The loop or the world has an effect that nothing counts; its key.
    #[error("not counted: {0}")]
    NotCounted(String),
    /// A joint has no bounds.
    #[error("no bounds")]
    NoBounds,
}

/// Bounds that gains claim for the study that they were designed for.
///
/// # Errors
///
/// [`NoClaim`], the reason as the certificate has it.
pub fn claimed(gains: &Gains, study: &Study) -> Result<AttackClaim, NoClaim> {
    let certificate = gains.certificate.as_ref().ok_or(NoClaim::NoCertificate)?;
    if let Some(refused) = certificate.refused() {
        return Err(NoClaim::Refused(refused));
    }
    if let Some(why) = &certificate.tube_refused {
        return Err(NoClaim::NoTube(why.clone()));
    }
    let tube = certificate.tube.as_ref();
    // Of an assumption, the drawn arms are as assumed.
    let counted = |left_out: &&NotCounted| {
        left_out.claims == LeftOut::Assumed || tube.is_some() && left_out.in_tube()
    };
    if let Some(left_out) = certificate.not_counted.iter().find(|left_out| !counted(left_out)) {
        return Err(NoClaim::NotCounted(left_out.key.clone()));
    }
    if let Some(tube) = tube {
        return Ok(documented(tube, study));
    }
    // Without a tube: bounds on the steady error of each joint by itself.
    let joints = certificate.joints.iter().enumerate().map(|(i, joint)| {
        let bounds = certificate.own_bounds(i).ok_or(NoClaim::NoBounds)?;
        let (e, v) = (bounds.error_bound_rad, bounds.velocity_error_bound_rad_s);
        Ok(JointClaim {
            name: joint.name.clone(),
            from_s: study.spec.settle,
            bin_s: None,
            error: vec![(-e, e)],
            velocity: vec![(-v, v)],
            torque: Vec::new(),
            step: Vec::new(),
            held: 0.0,
        })
    });
    let joints = joints.collect::<Result<_, NoClaim>>()?;
    Ok(AttackClaim { joints, settle_s: study.spec.settle, limits_silent: false })
}

/// Bounds of the tube by the certificate's own derivation, and the largest ratio of its error bound of a joint to the
/// claimed one; `None` where it does not close.
pub(crate) fn derived_again(gains: &Gains, study: &Study) -> Option<(AttackClaim, f64)> {
    let certificate = gains.certificate.as_ref()?;
    let claimed = certificate.tube.as_ref()?;
    let reference = tube_reference(gains, study)?;
    let own = certificate.tube_again(gains, (study, &reference), &|_| ())?.ok()?;
    let pairs = own.joints.iter().zip(&claimed.joints);
    let ratio = |(own, claimed): (&TubeJoint, &TubeJoint)| {
        own.error_bound_rad / larger(claimed.error_bound_rad, UNREAD)
    };
    Some((documented(&own, study), pairs.map(ratio).largest()))
}

/// Bounds of a tube in a certificate.
fn documented(tube: &Tube, study: &Study) -> AttackClaim {
    let before = held_at_start(study).ok().flatten();
    let zip = |low: &[f64], high: &[f64]| low.iter().copied().zip(high.iter().copied()).collect();
    let joint = |(i, joint): (usize, &TubeJoint)| JointClaim {
        name: joint.name.clone(),
        from_s: 0.0,
        bin_s: Some(tube.bin_s),
        error: zip(&joint.error_low_rad, &joint.error_high_rad),
        velocity: zip(&joint.velocity_low_rad_s, &joint.velocity_high_rad_s),
        torque: vec![joint.torque_max_nm; joint.error_low_rad.len()],
        step: joint.torque_step_nm.clone(),
        held: before.as_ref().map_or(0.0, |held| held[i]),
    };
    AttackClaim {
        joints: tube.joints.iter().enumerate().map(joint).collect(),
        settle_s: tube.settle_s,
        limits_silent: tube.limits_silent,
    }
}
