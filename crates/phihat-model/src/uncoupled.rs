//! Joints that are known by themselves: an arm without a description.

use std::collections::BTreeMap;

use crate::Model;
use crate::body::LumpedBody;
use crate::description::{DescribedLink, Description, JointMotion, JointOf};
use crate::joint::{Joint, JointKind};
use crate::named_texts::NamedTexts;
use crate::placement::Placement;
use crate::robot::Robot;

impl Robot {
    /// Joints that do not push each other: of each, all inertia is its rotor's, and gravity does nothing.
    ///
    /// For arms without a description: a stand-in that joints can be simulated on, and no model of the arm.
    ///
    /// # Example
    ///
    /// ```
    /// use phihat_model::{Friction, Joint, JointKind, Robot, Workspace};
    ///
    /// let joint = |name: &str, armature: f64| Joint {
    ///     name: name.to_owned(),
    ///     kind: JointKind::Continuous,
    ///     position: None,
    ///     velocity_max: None,
    ///     torque_max: Some(40.0),
    ///     torque_rate_max: None,
    ///     armature,
    ///     armature_range: None,
    ///     friction: Friction::default(),
    ///     drive_bandwidth_hz: None,
    ///     spring: None,
    ///     encoder_bits: None,
    /// };
    /// let robot = Robot::uncoupled(vec![joint("a", 0.3), joint("b", 0.1)]);
    /// let model = robot.plant_model();
    /// let mut m = [0.0; 4];
    /// model.mass_matrix(&mut Workspace::new(&model), &[0.4, -1.0], &mut m);
    /// assert_eq!(m, [0.3, 0.0, 0.0, 0.1]);
    /// ```
    pub fn uncoupled(joints: Vec<Joint>) -> Self {
        let nothing = LumpedBody::default();
        let root = DescribedLink { name: "base".to_owned(), matter: nothing, joint: None };
        let link = |joint: &Joint| DescribedLink {
            name: joint.name.clone(),
            matter: nothing,
            joint: Some(JointOf {
                name: joint.name.clone(),
                motion: match joint.kind {
                    JointKind::Prismatic => JointMotion::Prismatic,
                    JointKind::Revolute | JointKind::Continuous => JointMotion::Revolute,
                },
                parent: 0,
                placement: Placement::IDENTITY,
                axis: [0.0, 0.0, 1.0],
            }),
        };
        let links = std::iter::once(root).chain(joints.iter().map(link)).collect();
        let tip = joints.last().map(|joint| joint.name.clone()).unwrap_or_default();
        Self {
            name: "joints".to_owned(),
            description: format!("{} joints without a description", joints.len()),
            licence: String::new(),
            provenance: "stated joint by joint".to_owned(),
            sources: BTreeMap::new(),
            model: Model::new(Description { links }),
            joints,
            tip,
            profile: "ideal".to_owned(),
            poses: BTreeMap::new(),
            held: BTreeMap::new(),
            warnings: Vec::new(),
            files: Vec::new(),
            source: NamedTexts::DISK,
        }
    }
}
