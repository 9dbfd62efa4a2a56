//! Comparison of the arm that a robot describes with the arm of a study.

use core::f64::consts::PI;
use std::collections::BTreeMap;

use phihat_model::{ModelError, Part, Robot, RobotError, Workspace, evenly};
use phihat_study::Study;
use thiserror::Error;

/// Postures in which both are compared.
const POSTURES: u32 = 200;

/// Place of the description in errors.
const ORIGIN: &str = "the description that the robot hands out";

/// Why a description cannot be compared with a study's arm.
#[derive(Debug, Error)]
pub(crate) enum NotComparable {
    #[error(transparent)]
    Robot(#[from] RobotError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error("the robot describes an arm of {theirs} joints, the study's has {ours}")]
    Joints { theirs: usize, ours: usize },
    #[error("the robot describes an arm without inertia")]
    Massless,
}

/// Least and greatest of `xᵀM'(q) x / xᵀM(q) x`, with `M` of the study's arm without payload, and `M'` of the
/// links of the description with the study's rotors, which no description contains; over postures of the
/// whole range, and over `x` of single joints and of pairs that turn with or against each other.
pub(crate) fn apart(study: &Study, urdf: &str) -> Result<(f64, f64), NotComparable> {
    let mut described = Robot::from_text(urdf, None, ORIGIN)?;
    if described.joints.len() > study.robot.joints.len() {
        // With its hand: the study's joints by their names. The others are where the study has them, or, under other
        // names, where a description leaves them.
        let joints = Some(study.robot.joint_names());
        let mut locked = [study.robot.held.clone(), BTreeMap::new()].into_iter();
        let part = |locked| Part { joints: joints.clone(), locked, ..Part::default() };
        let arm = locked.find_map(|locked| Robot::part_of_text(urdf, &part(locked), ORIGIN).ok());
        described = arm.unwrap_or(described);
    }
    let (ours, theirs) = (study.robot.joints.len(), described.joints.len());
    if ours != theirs {
        return Err(NotComparable::Joints { theirs, ours });
    }
    let own = study.robot.plant_model();
    let other = described.model.with_armature(own.armature())?;
    let mut rooms = (Workspace::new(&own), Workspace::new(&other));
    let (mut a, mut b) = (vec![0.0; ours * ours], vec![0.0; ours * ours]);
    let range = study.robot.joints.iter().map(|joint| joint.position.unwrap_or((-PI, PI)));
    let (mut low, mut high) = (f64::INFINITY, 0.0);
    for q in evenly(&range.collect::<Vec<_>>(), POSTURES) {
        own.mass_matrix(&mut rooms.0, &q, &mut a);
        other.mass_matrix(&mut rooms.1, &q, &mut b);
        for (theirs, own) in energies(&b, ours).zip(energies(&a, ours)) {
            let ratio = theirs / own;
            if !ratio.is_finite() {
                return Err(NotComparable::Massless);
            }
            (low, high) = (f64::min(low, ratio), f64::max(high, ratio));
        }
    }
    Ok((low, high))
}

/// `xᵀM x` of `n` joints for `x = e_i`, and `e_i + e_j` and `e_i − e_j` for `j < i`.
fn energies(m: &[f64], n: usize) -> impl Iterator<Item = f64> {
    let at = move |i: usize, j: usize| m.get(i * n + j).copied().unwrap_or(f64::NAN);
    (0..n).flat_map(move |i| {
        let pairs = (0..i).flat_map(move |j| {
            let (sum, both) = (at(i, i) + at(j, j), 2.0 * at(i, j));
            [sum + both, sum - both]
        });
        core::iter::once(at(i, i)).chain(pairs)
    })
}

#[cfg(test)]
mod tests {
    use super::{NotComparable, apart};
    use phihat_study::Study;

    fn panda() -> Study {
        let text = "duration_s = 1.0\n[robot]\nname = \"panda\"\n[spec]\nsettle_s = 0.5\n[gains]\norder = \
                    1\nbandwidth_rad_s = 10.0\nestimator_bandwidth_rad_s = 20.0\ninertia_kg_m2 = [1.0, 1.0, 1.0, 1.0, \
                    0.2, 0.2, 0.2]\n[reference]\nkind = \"sines\"\ncenter = \
                    \"ready\"\n[[reference.sine]]\namplitude_rad = 0.05\nfrequency_hz = 0.1\n";
        Study::from_text(text, "test.toml", "".as_ref()).unwrap()
    }

    #[test]
    fn an_arm_is_itself_and_a_heavier_link_is_found() {
        let study = panda();
        let urdf = study.robot.urdf().unwrap();
        assert_eq!(apart(&study, &urdf).unwrap(), (1.0, 1.0));
        let mass = urdf.find("<mass value=\"").unwrap();
        // The last link with mass is the hand's side: all that carries it becomes heavier, none lighter.
        let last = urdf.rfind("<mass value=\"").unwrap() + "<mass value=\"".len();
        assert!(last > mass);
        let end = last + urdf[last..].find('"').unwrap();
        let grams: f64 = urdf[last..end].parse().unwrap();
        let heavy = format!("{}{}{}", &urdf[..last], grams + 1.0, &urdf[end..]);
        let (low, high) = apart(&study, &heavy).unwrap();
        assert!((1.0 - 1e-9..1.01).contains(&low) && high > 1.1, "{low} {high}");
    }

    #[test]
    fn a_finger_is_carried_and_no_joint_of_the_arm() {
        let study = panda();
        let finger = "<joint name=\"finger\" type=\"prismatic\"><parent link=\"panda_hand\"/><child link=\"pad\"/>\
                      <axis xyz=\"0 1 0\"/>\
                      <limit lower=\"0\" upper=\"0.04\" effort=\"9\" velocity=\"1\"/></joint>\
                      <link name=\"pad\"><inertial><mass value=\"0.1\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" \
                      iyy=\"0\" \
                      iyz=\"0\" izz=\"0\"/></inertial></link></robot>";
        let urdf = study.robot.urdf().unwrap().replace("</robot>", finger);
        let (low, high) = apart(&study, &urdf).unwrap();
        assert!((1.0 - 1e-9..1.01).contains(&low) && (1.001..1.2).contains(&high), "{low} {high}");
    }

    #[test]
    fn what_is_no_such_arm_is_told() {
        let study = panda();
        assert!(matches!(apart(&study, "<robot/>"), Err(NotComparable::Robot(_))));
        let other = phihat_model::Robot::named("ur5").unwrap().urdf().unwrap();
        let found = apart(&study, &other);
        assert!(matches!(found, Err(NotComparable::Joints { theirs: 6, ours: 7 })), "{found:?}");
    }
}
