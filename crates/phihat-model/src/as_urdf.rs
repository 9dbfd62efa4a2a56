//! A robot as the text of a URDF, from its model.

use std::fmt::Write as _;

use crate::Robot;
use crate::body::LumpedBody;
use crate::description::{DescribedLink, JointMotion, JointOf};
use crate::joint::{Joint, JointKind};
use crate::markup::escaped;
use crate::placement::{Matrix3, Placement, about, mul};

impl Robot {
    /// The text of a URDF with the same motion: links, joints, masses, limits, viscous and dry
    /// friction. What moves but is none of the arm's joints is fixed where it is held. Rotor inertia,
    /// intervals and geometry have no place in it.
    ///
    /// # Example
    ///
    /// ```
    /// use phihat_model::Robot;
    ///
    /// let mjcf = r#"<mujoco model="one"><worldbody><body name="arm"><joint name="lift" axis="0 1 0"/>
    ///   <geom type="capsule" size="0.03" fromto="0 0 0 0.4 0 0"/></body></worldbody></mujoco>"#;
    /// let robot = Robot::from_text(mjcf, None, "one.xml")?;
    /// let again = Robot::from_text(&robot.as_urdf(), None, "one.urdf")?;
    /// assert_eq!(again.joint_names(), ["lift"]);
    /// # Ok::<(), phihat_model::RobotError>(())
    /// ```
    pub fn as_urdf(&self) -> String {
        let mut text = String::from("<?xml version=\"1.0\"?>\n");
        let description = self.model.description();
        // Infallible: a String takes everything.
        let _ = writeln!(text, "<robot name=\"{}\">", escaped(&self.name));
        for link in &description.links {
            write_link(link, &mut text);
            let Some(joint) = &link.joint else { continue };
            let parent = description.links.get(joint.parent).map_or("", |parent| &parent.name);
            let own = self.joints.iter().find(|own| own.name == joint.name);
            write_joint((joint, own), (parent, &link.name), &mut text);
        }
        text.push_str("</robot>\n");
        text
    }
}

fn write_link(link: &DescribedLink, text: &mut String) {
    let name = escaped(&link.name);
    if link.matter == LumpedBody::default() {
        let _ = writeln!(text, "  <link name=\"{name}\"/>");
        return;
    }
    let LumpedBody { m, h, .. } = link.matter;
    let com = if m > 0.0 { h.map(|x| x / m) } else { [0.0; 3] };
    let back = Placement { p: com.map(|x| -x), ..Placement::IDENTITY };
    let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = link.matter.seen_from(&back).i;
    let _ = writeln!(
        text,
        "  <link name=\"{name}\">\n    <inertial>\n      <origin xyz=\"{}\"/>\n      <mass value=\"{m:?}\"/>\n      \
         <inertia ixx=\"{xx:?}\" ixy=\"{xy:?}\" ixz=\"{xz:?}\" iyy=\"{yy:?}\" iyz=\"{yz:?}\" izz=\"{zz:?}\"/>\n    \
         </inertial>\n  </link>",
        numbers(com)
    );
}

fn write_joint(
    (joint, own): (&JointOf, Option<&Joint>),
    (parent, child): (&str, &str),
    text: &mut String,
) {
    let kind = match (joint.motion, own.map(|own| own.kind)) {
        (JointMotion::Fixed, _) => "fixed",
        (JointMotion::Prismatic, _) => "prismatic",
        (JointMotion::Revolute, Some(JointKind::Continuous) | None) => "continuous",
        (JointMotion::Revolute, _) => "revolute",
    };
    let _ = writeln!(
        text,
        "  <joint name=\"{}\" type=\"{kind}\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n    \
         <origin xyz=\"{}\" rpy=\"{}\"/>",
        escaped(&joint.name),
        escaped(parent),
        escaped(child),
        numbers(joint.placement.p),
        numbers(rpy(&joint.placement.r))
    );
    if let Some(own) = own.filter(|_| joint.motion != JointMotion::Fixed) {
        let _ = writeln!(text, "    <axis xyz=\"{}\"/>", numbers(joint.axis));
        let ends = own.position.map(|(low, high)| format!(" lower=\"{low:?}\" upper=\"{high:?}\""));
        // Other programs want both: 0 says that there is no figure.
        let [effort, speed] = [own.torque_max, own.velocity_max].map(Option::unwrap_or_default);
        let ends = ends.unwrap_or_default();
        let _ = writeln!(text, "    <limit{ends} effort=\"{effort:?}\" velocity=\"{speed:?}\"/>");
        let (viscous, coulomb) = (own.friction.viscous, own.friction.coulomb);
        let _ = writeln!(text, "    <dynamics damping=\"{viscous:?}\" friction=\"{coulomb:?}\"/>");
    }
    text.push_str("  </joint>\n");
}

/// Roll, pitch and yaw \[rad\] of a rotation, one after the other from what the one before leaves: exact to
/// rounding also where the pitch is a right angle.
fn rpy(r: &Matrix3) -> [f64; 3] {
    let yaw = libm::atan2(r[1][0], r[0][0]);
    let left = mul(&about([0.0, 0.0, 1.0], -yaw), r);
    let pitch = libm::atan2(-left[2][0], left[0][0]);
    let left = mul(&about([0.0, 1.0, 0.0], -pitch), &left);
    [libm::atan2(left[2][1], left[1][1]), pitch, yaw]
}

fn numbers(values: [f64; 3]) -> String {
    let [x, y, z] = values;
    format!("{x:?} {y:?} {z:?}")
}
