//! The sentence on joints that claims take as rigid.

use phihat_design::elastic::{links_of, softest_springs};
use phihat_design::{EncoderSide, Gains};
use phihat_model::{Joint, JointSpring};
use phihat_study::{InertiaSource, Study};

/// One sentence on joints that are taken as rigid: the stiffness that the gains need of each, searched, beside that of
/// such joints; `None`: the study states its springs, or the arm is not known by a description.
pub fn rigid_joints(study: &Study, gains: &Gains) -> Option<String> {
    if study.springs.stated().is_some() || study.design.inertia != InertiaSource::Robot {
        return None;
    }
    let mut own = study.clone();
    gains.complete(&mut own).ok()?;
    let side = EncoderSide::of(&own).word();
    let links = phihat_synthesis::arm_along(&links_of(&own)).ok();
    let Some(softest) = links.and_then(|links| softest_springs(&own, gains, &links)) else {
        return Some(
            "rigid joints: ASSUMED, not checked; no springs were found on which these gains are stable".to_owned(),
        );
    };
    let joints = own.robot.joints.iter().zip(softest);
    let words: Vec<String> = joints.map(|(joint, least)| needs(joint, least)).collect();
    Some(format!(
        "rigid joints: ASSUMED, not checked; with encoders at the {side} and 1 % damping of the springs these gains are \
         stable (searched) if {}",
        words.join("; ")
    ))
}

/// The need of a joint, and the stiffness of such joints where that is less.
fn needs(joint: &Joint, least: f64) -> String {
    let unit = 10.0_f64.powf(least.log10().floor() - 1.0);
    let least = (least / unit).ceil() * unit;
    let usual = joint.spring.or_else(|| JointSpring::assumed(joint)).map(|own| own.stiffness);
    let usual = usual.filter(|usual| usual.0 < least).map_or_else(String::new, |(low, high)| {
        format!(" (such joints have {} … {})", 1e-3 * low, 1e-3 * high)
    });
    format!("{} has ≥ {:.1} kN·m/rad{usual}", joint.name, 1e-3 * least)
}
