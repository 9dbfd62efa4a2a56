//! xacro on the command line. Wrong if an argument did not count, if a file were replaced unasked, if a study of
//! such an arm did not read, or if a description of several arms ended in an error.

use std::fs;

use crate::support::{Answer, files_of, folder, json, phihat};

/// An arm whose links are as heavy as an argument says, and which has as many joints.
const ARM: &str = r#"<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:arg name="joints" default="2"/>
  <xacro:arg name="mass" default="1.0"/>
  <link name="link0"/>
  <xacro:macro name="piece" params="i below">
    <link name="link${i}"><inertial><origin xyz="0 0 0.1"/><mass value="$(arg mass)"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
    <joint name="joint${i}" type="revolute"><parent link="link${below}"/><child link="link${i}"/>
      <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="40" velocity="2"/></joint>
  </xacro:macro>
  <xacro:macro name="pieces" params="i">
    <xacro:if value="${i &lt;= $(arg joints)}"><xacro:piece i="${i}" below="${i - 1 if i &lt; 20 else 0}"/></xacro:if>
    <xacro:if value="${i &lt; $(arg joints)}"><xacro:pieces i="${i + 1}"/></xacro:if>
  </xacro:macro>
  <xacro:pieces i="1"/>
</robot>"#;

fn passes(answer: Answer) -> String {
    assert_eq!(answer.code, 0, "{}", answer.err);
    answer.out
}

fn fails(answer: &Answer, clues: &[&str]) {
    assert_eq!(answer.code, 2, "{}", answer.out);
    assert!(clues.iter().all(|clue| answer.err.contains(clue)), "{clues:?} in: {}", answer.err);
}

#[test]
fn a_file_of_xacro_is_shown_and_written_with_its_arguments() {
    let folder = folder("xacro");
    fs::write(folder.join("arm.urdf.xacro"), ARM).unwrap();
    let shown = json(&folder, &["robots", "arm.urdf.xacro", "joints:=3", "--json"]);
    assert_eq!(shown["joints"].as_array().map(Vec::len), Some(3), "{shown:#}");
    let write = ["robots", "arm.urdf.xacro", "joints:=3", "mass:=2.5", "--urdf", "arm.urdf"];
    let told = json(&folder, &[&write[..], &["--json"]].concat());
    assert_eq!(told["arguments"]["mass"], "2.5", "{told:#}");
    let urdf = fs::read_to_string(folder.join("arm.urdf")).unwrap();
    assert!(
        urdf.matches("<mass value=\"2.5\"/>").count() == 3 && !urdf.contains("xacro"),
        "{urdf}"
    );
    // It is there: replaced only if that is asked for.
    fails(&phihat(&folder, &write), &["arm.urdf", "--force"]);
    passes(phihat(&folder, &[&write[..], &["--force"]].concat()));
    for (line, clues) in [
        (&["robots", "arm.urdf.xacro", "joint:=3"][..], ["no argument \"joint\"", "joints, mass"]),
        (&["robots", "arm.urdf.xacro", "joints=3"], ["joints=3", "NAME:=VALUE"]),
        (&["robots", "arm.urdf", "joints:=3"], ["joints:=", "no file of xacro"]),
        (&["robots", "arm.urdf.xacro", "--package", "a=nowhere"], ["a=nowhere", "no folder"]),
        (
            &["robots", "arm.urdf.xacro", "mass:=nan"],
            ["arm.urdf.xacro, expanded:", "finite number"],
        ),
        (&["new", "arm.urdf.xacro", "mass:=nan"], ["arm.urdf.xacro, expanded:", "finite number"]),
        (&["robots", "none.xacro", "joints:=3"], ["none.xacro", "cannot be read"]),
    ] {
        fails(&phihat(&folder, line), &clues);
    }
    let before = files_of(&folder);
    fails(&phihat(&folder, &["new", "arm.urdf.xacro", "joint:=3"]), &["no argument \"joint\""]);
    assert_eq!(files_of(&folder), before);
}

#[test]
fn more_joints_than_an_arm_has_are_listed_as_chains() {
    let folder = folder("xacro-many");
    fs::write(folder.join("many.xacro"), ARM).unwrap();
    let shown = passes(phihat(&folder, &["robots", "many.xacro", "joints:=35"]));
    assert!(
        shown.contains("joint19") && shown.contains("note: many.xacro, expanded: 35 joints"),
        "{shown}"
    );
}

#[test]
fn a_study_is_made_of_a_file_of_xacro() {
    let folder = folder("xacro-new");
    fs::write(folder.join("arm.urdf.xacro"), ARM).unwrap();
    let told = json(&folder, &["new", "arm.urdf.xacro", "joints:=1", "--error", "20", "--json"]);
    assert_eq!(told["study"], "arm.toml", "{told:#}");
    let urdf = fs::read_to_string(folder.join("arm_arm.urdf")).unwrap();
    assert!(urdf.contains("link1") && !urdf.contains("link2"), "{urdf}");
    passes(phihat(&folder, &["check", "arm.toml"]));
}
