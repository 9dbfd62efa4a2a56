//! A random chain as the text of its URDF and of its robot file.

use core::fmt::Write as _;

use phihat_model::JointKind;
use phihat_session::Dice;

use crate::link::{LinkOfJoint, weight};

pub(crate) fn urdf(dice: &mut Dice, parts: &[LinkOfJoint], tool: [f64; 3]) -> String {
    let v = |x: [f64; 3]| format!("{} {} {}", x[0], x[1], x[2]);
    let strong = dice.log_between(2.0, 12.0);
    let mut text =
        String::from("<?xml version=\"1.0\"?>\n<robot name=\"chain\">\n  <link name=\"base\"/>\n");
    for (i, part) in parts.iter().enumerate() {
        let kind = match part.kind {
            JointKind::Revolute => "revolute",
            JointKind::Continuous => "continuous",
            JointKind::Prismatic => "prismatic",
        };
        let parent = if i == 0 { "base".to_owned() } else { format!("link{i}") };
        let (k, (low, high)) = (i + 1, part.range);
        let range = if part.kind == JointKind::Continuous {
            String::new()
        } else {
            format!("lower=\"{low}\" upper=\"{high}\" ")
        };
        let effort = strong * weight(parts, i) + 1.0;
        let [ixx, iyy, izz] = part.inertia;
        let _ = write!(
            text,
            "  <joint name=\"joint{k}\" type=\"{kind}\">\n    <parent link=\"{parent}\"/>\n    \
             <child link=\"link{k}\"/>\n    <origin xyz=\"{}\" rpy=\"{}\"/>\n    <axis xyz=\"{}\"/>\n    \
             <limit {range}effort=\"{effort}\" velocity=\"{}\"/>\n  </joint>\n  <link name=\"link{k}\">\n    \
             <inertial>\n      <origin xyz=\"{}\" rpy=\"{}\"/>\n      <mass value=\"{}\"/>\n      \
             <inertia ixx=\"{ixx}\" ixy=\"0\" ixz=\"0\" iyy=\"{iyy}\" iyz=\"0\" izz=\"{izz}\"/>\n    \
             </inertial>\n  </link>\n",
            v(part.xyz),
            v(part.rpy),
            v(part.axis),
            part.speed,
            v(part.com),
            v(part.com_rpy),
            part.mass
        );
    }
    let last = parts.len();
    let _ = write!(
        text,
        "  <joint name=\"tool_joint\" type=\"fixed\">\n    <parent link=\"link{last}\"/>\n    \
         <child link=\"tool\"/>\n    <origin xyz=\"{}\"/>\n  </joint>\n  <link name=\"tool\"/>\n</robot>\n",
        v(tool)
    );
    text
}

pub(crate) fn toml(dice: &mut Dice, parts: &[LinkOfJoint], rotor: &[f64]) -> String {
    let n = parts.len();
    let names: Vec<String> = (1..=n).map(|i| format!("\"joint{i}\"")).collect();
    let mut text = format!(
        "name = \"chain{n}\"\ndescription = \"Random chain\"\nurdf = \"arm.urdf\"\ntip = \"tool\"\nlicence = \"none\"\n\
         provenance = \"drawn at random\"\njoints = [{}]\n",
        names.join(", ")
    );
    if rotor.iter().any(|x| *x > 0.0) {
        let _ = write!(text, "\n[rotor]\narmature_kg_m2 = {rotor:?}\n");
    }
    let scale: Vec<f64> = (0..n).map(|i| weight(parts, i)).collect();
    let times = |factor: f64| scale.iter().map(|x| x * factor).collect::<Vec<_>>();
    let viscous = if dice.chance(0.6) { dice.log_between(1e-3, 0.1) } else { 0.0 };
    let coulomb = if dice.chance(0.3) { dice.log_between(1e-3, 0.03) } else { 0.0 };
    let _ = write!(
        text,
        "\n[friction]\nviscous_nm_s_rad = {:?}\ncoulomb_nm = {:?}\n",
        times(viscous),
        times(coulomb)
    );
    if dice.chance(0.3) {
        let _ = write!(
            text,
            "sigmoid_amplitude_nm = {:?}\nsigmoid_steepness_s_rad = {}\nsigmoid_offset_rad_s = {}\n",
            times(dice.log_between(5e-3, 0.1)),
            dice.between(2.0, 20.0),
            dice.between(-0.05, 0.05)
        );
    }
    if dice.chance(0.3) {
        let _ = write!(text, "\n[encoder]\nbits = {}\n", dice.pick(&[14, 16, 18, 20, 22]));
    }
    text
}
