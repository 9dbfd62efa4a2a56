//! The sentence on joints that claims take as rigid.

use phihat_design::elastic::{SPREAD, links_of, softest_springs};
use phihat_design::{EncoderSide, Gains};
use phihat_model::{Joint, JointSpring, Rotor};
use phihat_study::{InertiaSource, Study};

/// A sentence or two on joints that claims take as rigid: the stiffness that is assumed of such joints, and that which
/// the gains bear, searched; `None`: the study states its springs, or the arm is not known by a description.
pub fn rigid_joints(study: &Study, gains: &Gains) -> Option<String> {
    if study.springs.stated().is_some() || study.design.inertia != InertiaSource::Robot {
        return None;
    }
    let mut own = study.clone();
    gains.complete(&mut own).ok()?;
    if own.robot.joints.iter().any(|joint| joint.armature_at(Rotor::Least) <= 0.0) {
        return Some(format!(
            "{OF_RIGID} Springs that this law bears are not known: rotor inertia (robot.armature_kg_m2) is not stated."
        ));
    }
    let side = EncoderSide::of(&own).word();
    let links = phihat_synthesis::arm_along(&links_of(&own)).ok();
    let Some(softest) = links.and_then(|links| softest_springs(&own, gains, &links)) else {
        return Some(format!("{OF_RIGID} No springs that this law bears were found."));
    };
    let needs: Vec<SpringNeed> =
        own.robot.joints.iter().zip(softest).filter_map(SpringNeed::of).collect();
    let on = format!(
        "searched: encoders at the {side}, each stiffness known within a factor of {SPREAD}, 1 % damping"
    );
    let worst = needs.iter().max_by(|a, b| (a.least / a.usual.0).total_cmp(&(b.least / b.usual.0)));
    Some(match worst.filter(|worst| worst.usual.0 < worst.least) {
        Some(SpringNeed { name, least, usual: (low, high) }) => format!(
            "{OF_RIGID} With joints of {} … {} kN·m/rad (assumed, not stated) this law may resonate: {name} needs ≥ {} \
             kN·m/rad ({on}). State springs in [robot.transmission].",
            thousands(*low),
            thousands(*high),
            thousands(rounded_up(*least)),
        ),
        None => format!("{OF_RIGID} This law also bears springs like those of such joints ({on})."),
    })
}

/// Subject of a bound where no springs are stated.
const OF_RIGID: &str = "Bound of the rigid arm.";

/// Stiffness of a joint \[N·m/rad\]: the least that a law bears, and the interval that is assumed.
struct SpringNeed {
    name: String,
    least: f64,
    usual: (f64, f64),
}

impl SpringNeed {
    fn of((joint, least): (&Joint, f64)) -> Option<Self> {
        let usual = joint.spring.or_else(|| JointSpring::assumed(joint))?.stiffness;
        Some(Self { name: joint.name.clone(), least, usual })
    }
}

/// Two figures, not below the value.
fn rounded_up(value: f64) -> f64 {
    let unit = libm::pow(10.0, libm::log10(value).floor() - 1.0);
    (value / unit).ceil() * unit
}

/// Thousands in three figures at most.
fn thousands(value: f64) -> String {
    let text = format!("{:.1}", 1e-3 * value);
    text.trim_end_matches(".0").to_owned()
}

#[cfg(test)]
mod tests {
    use super::{rounded_up, thousands};

    #[test]
    fn a_stiffness_is_rounded_up_to_two_figures() {
        assert_eq!(thousands(rounded_up(41_241.3)), "42");
        assert_eq!(thousands(rounded_up(9_110.0)), "9.2");
        assert_eq!(thousands(1e4), "10");
    }
}
