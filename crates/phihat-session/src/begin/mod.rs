//! A study that runs, made of an arm alone.
//!
//! # Method
//!
//! Quantities that the arm's description lacks are estimated, as intervals ([`phihat_model::rotor_inertia`],
//! [`phihat_model::dry_friction`]). The arm is put where gravity loads it little, and moved by a sine per
//! joint that keeps well inside the limits of position, speed and torque. Then the smallest error that the
//! design can prove is searched, and stated with a margin; the loop is run with every rotor at both ends of
//! its interval and between them before the study is written.
//!
//! # Not claimed
//!
//! That the estimates hold for the arm that stands in the laboratory: what to measure is said in its file.
//! That the motion hits nothing: a description's links have no bodies here.

mod arm;
mod known;
mod motion;
mod motion_only;
mod options;
mod posture;
mod search;
mod text;
mod torque;

use std::path::{Path, PathBuf};

use phihat_design::Gains;
use phihat_model::xacro::{XacroOptions, expand, is_xacro};
use phihat_model::{JointKind, MotionOnly, Robot, RobotError};
use phihat_study::Study;

pub use arm::described;
pub use known::{ambiguity_text, recognition_text};
pub use options::{ArmOptions, BeginOptions};

use crate::disk::{DiskError, Whole, folder_of, make_folder};
use crate::error::SessionError;
use crate::hash::sha256;
use crate::watch::Watch;
use arm::ChosenArm;
use search::{BeginResult, BeginStudy};

/// A study that was made.
#[derive(Debug)]
pub struct Begun {
    /// The study file.
    pub study: PathBuf,
    /// Every file that was written, the study last.
    pub files: Vec<PathBuf>,
    /// Joints of the arm.
    pub joints: Vec<String>,
    /// True for each joint that slides.
    pub slides: Vec<bool>,
    /// Notes for the reader: assumptions, and choices that were made for him.
    pub notes: Vec<String>,
    /// The error that the study asks for \[rad, m\], one per joint.
    pub error_bound: Vec<f64>,
    /// The largest errors that were simulated \[rad, m\], one per joint, over all rotors tried; `None`: there
    /// are no gains.
    pub simulated: Option<Vec<f64>>,
    /// Why there are no gains, and what would make them possible.
    pub infeasible: Option<String>,
    /// The gains that the search ended with, as a design for the study's text would find them.
    pub gains: Option<Box<Gains>>,
    /// False of a study that asks for the inertia of each joint: it cannot be read before that is filled in.
    readable: bool,
}

/// Makes a study for an arm and writes it, with the arm's file beside it where the arm is a bare URDF.
///
/// # Errors
///
/// [`SessionError`]: the arm cannot be used, or a file is there already. That no gains exist is an answer, as it is
/// that a description has no masses: then the study asks for each joint's inertia.
pub fn begin(given: &BeginOptions, watch: &mut dyn Watch) -> Result<Begun, SessionError> {
    let (begun, files) = begun(given, &mut |step| watch.step(step))?;
    watch.ended();
    write(&files, given.replace)?;
    // What was written is what was looked at. A study without masses cannot be read before they are filled in.
    if begun.readable {
        Study::read(&given.out)?;
    }
    Ok(begun)
}

/// As [`begin`], but nothing is written: with the texts of the files, the study last. `step` receives each step.
///
/// # Errors
///
/// As [`begin`].
pub fn begun(
    given: &BeginOptions,
    step: &mut dyn FnMut(&str),
) -> Result<(Begun, Vec<(PathBuf, String)>), SessionError> {
    let folder = folder_of(&given.out);
    let name = given.study_name()?;
    let options = &expanded(given)?;
    if let Some(joints) = motion_only::joints_of(options) {
        return motion_only((options, &given.arm.arm), joints);
    }
    let mut chosen = ChosenArm::of(options, folder, &name)?;
    let mut looked = BeginStudy::new(options, &mut chosen)?;
    let found = looked.search((&mut chosen, &options.out), step)?;
    let text = looked.study_text(&found, &chosen);
    let study_sha256 = sha256(&mut text.as_bytes()).map_err(SessionError::other)?;
    let mut files = Vec::new();
    let mut put = |name: &str, text: &str| files.push((folder.join(name), text.to_owned()));
    if let Some(file) = &chosen.written {
        if let Some((urdf, text)) = &file.copy {
            put(urdf, text);
        }
        put(&file.name, &chosen.arm_text());
    }
    files.push((options.out.clone(), text));
    let notes = chosen.notes.iter().chain(&found.notes).cloned().collect();
    let joints = chosen.robot.joints.iter();
    let (joints, slides) =
        joints.map(|joint| (joint.name.clone(), joint.kind == JointKind::Prismatic)).unzip();
    let BeginResult { error_bound, simulated, infeasible, gains, .. } = found;
    let gains = gains.map(|own| Box::new(Gains { study_sha256, ..*own }));
    let (study, paths) =
        (options.out.clone(), files.iter().map(|(path, _)| path.clone()).collect());
    let begun = Begun {
        study,
        files: paths,
        joints,
        slides,
        notes,
        error_bound,
        simulated,
        infeasible,
        gains,
        readable: true,
    };
    Ok((begun, files))
}

/// The study of an arm whose description, the file `named`, has no masses.
fn motion_only(
    (options, named): (&BeginOptions, &str),
    joints: MotionOnly,
) -> Result<(Begun, Vec<(PathBuf, String)>), SessionError> {
    let own = motion_only::study_of((options, named), joints)?;
    let files = vec![(options.out.clone(), own.text)];
    let begun = Begun {
        study: options.out.clone(),
        files: vec![options.out.clone()],
        joints: own.joints.iter().map(|joint| joint.name.clone()).collect(),
        slides: own.joints.iter().map(|joint| joint.kind == JointKind::Prismatic).collect(),
        notes: own.warnings,
        error_bound: vec![own.error_bound; own.joints.len()],
        simulated: None,
        infeasible: Some(own.lacks),
        gains: None,
        readable: false,
    };
    Ok((begun, files))
}

/// The options with the text of a URDF in place of a file of xacro.
fn expanded(options: &BeginOptions) -> Result<BeginOptions, SessionError> {
    let path = Path::new(&options.arm.arm);
    let files = options.arm.files.clone();
    if !is_xacro(path, &files) {
        return match options.arm.xacro.arguments.keys().next() {
            None => Ok(options.clone()),
            Some(name) => {
                let why = format!("{name}:= is an argument of xacro, and this is no file of xacro");
                Err(SessionError::at(path, why))
            }
        };
    }
    let xacro = XacroOptions { files, ..options.arm.xacro.clone() };
    let expanded = expand(path, &xacro).map_err(SessionError::other)?;
    let text = expanded.urdf;
    // What is wrong with the arm is said of the file that somebody has.
    match Robot::part_of_text(&text, &options.arm.part, &expanded.origin) {
        Ok(_) | Err(RobotError::NoInertia { .. } | RobotError::SeveralArms { .. }) => {}
        Err(why) => return Err(SessionError::other(why)),
    }
    let stem =
        path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    // No file can be there, nor another beside it.
    let urdf = path.join(format!("{}.urdf", stem.trim_end_matches(".urdf")));
    let mut own = options.clone();
    own.arm.files = own.arm.files.with([(urdf.clone(), text)]);
    own.arm.arm = urdf.display().to_string();
    Ok(own)
}

fn write(files: &[(PathBuf, String)], replace: bool) -> Result<(), SessionError> {
    let there = files.iter().find(|(path, _)| path.exists() && !replace);
    if let Some((path, _)) = there {
        return Err(SessionError::at(
            path,
            "it is there already: --force replaces it, --out names another",
        ));
    }
    put(files).map_err(SessionError::from)
}

fn put(files: &[(PathBuf, String)]) -> Result<(), DiskError> {
    if let Some((path, _)) = files.first() {
        make_folder(folder_of(path)).map_err(|why| DiskError::untouched(path, why))?;
    }
    let mut whole = Whole::default();
    for (path, text) in files {
        whole.add(path, text.as_bytes())?;
    }
    whole.commit()
}

/// Writes the commented file of an arm.
///
/// # Errors
///
/// [`SessionError`]: the arm cannot be used, its URDF is not beside or below the file, or the file is there already.
pub fn write_arm(
    options: &ArmOptions,
    out: &Path,
    replace: bool,
) -> Result<Vec<String>, SessionError> {
    let (robot, part, urdf, notes) = arm::to_write(options, out)?;
    write(&[(out.to_owned(), robot.arm_file(&urdf, &part))], replace)?;
    Robot::read(out).map_err(|why| SessionError::at(out, why))?;
    Ok(notes)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use phihat_study::Study;

    use super::search::followed;
    use super::{ArmOptions, BeginOptions, ChosenArm, begin};

    /// Options for an arm of one joint: half a kilogram 0.1 m out, 0.49 N·m by hand calculation; `friction`
    /// and `effort` of its file.
    fn options(folder: &Path, friction: f64, effort: f64) -> BeginOptions {
        let urdf = format!(
            "<robot name=\"one\"><link name=\"base\"/><joint name=\"lift\" type=\"revolute\"><parent link=\"base\"/>\
             <child link=\"arm\"/><axis xyz=\"0 1 0\"/><limit lower=\"-1\" upper=\"1\" effort=\"{effort}\" \
             velocity=\"3\"/><dynamics friction=\"{friction}\"/></joint><link name=\"arm\"><inertial><origin xyz=\"0.1 \
             0 0\"/><mass value=\"0.5\"/><inertia ixx=\"0.005\" ixy=\"0\" ixz=\"0\" iyy=\"0.005\" iyz=\"0\" \
             izz=\"0.005\"/></inertial></link></robot>"
        );
        let arm = folder.join("one.urdf");
        fs::write(&arm, urdf).unwrap();
        let arm = ArmOptions { arm: arm.display().to_string(), ..ArmOptions::default() };
        let out = folder.join("first.toml");
        BeginOptions { arm, out, replace: true, ..BeginOptions::default() }
    }

    #[test]
    fn what_the_drives_cannot_bear_is_an_answer_with_joint_need_limit_and_remedy() {
        let folder = tempfile::tempdir().unwrap();
        for (friction, effort, said) in [
            // At most cos(0.6) of what holds it stretched out can be saved inside of its travel.
            (0.0, 0.3, ["cannot hold itself", "of joint lift", "0.3 N·m", "--torque-max"]),
            (
                5.8,
                6.0,
                ["even a slow and small motion", "of joint lift", "alone up to 5.8 N·m", "6 N·m"],
            ),
        ] {
            let begun = begin(&options(folder.path(), friction, effort), &mut ()).unwrap();
            let why = begun.infeasible.unwrap();
            assert!(said.iter().all(|part| why.contains(part)), "{why}");
            assert_eq!(begun.simulated, None);
            // Its files are there to be changed.
            let study = Study::read(&begun.study).unwrap();
            assert_eq!(study.robot.joints[0].torque_max, Some(effort));
        }
    }

    #[test]
    fn friction_of_most_of_a_limit_is_said_and_no_refusal() {
        let folder = tempfile::tempdir().unwrap();
        // With nearly half a newton metre of gravity, of 6 N·m: nine tenths, and a half.
        for (friction, told) in [(4.9, true), (2.5, false)] {
            let options = options(folder.path(), friction, 6.0);
            let chosen = ChosenArm::of(&options, folder.path(), "first").unwrap();
            let found = followed(&options, &chosen, &options.out).unwrap();
            assert_eq!(found.weak, None);
            assert_eq!(found.notes.len(), usize::from(told), "{:?}", found.notes);
            let said = ["up to 4.9 N·m", "little is left for control"];
            assert!(found.notes.iter().all(|n| said.iter().all(|part| n.contains(part))));
        }
    }
    #[test]
    fn where_gravity_leaves_little_the_motion_is_smaller() {
        let folder = tempfile::tempdir().unwrap();
        // Held within seven tenths of the limit, at cos(0.6) of what it takes stretched out, and not a whole
        // motion further.
        for (effort, angle) in [(0.6, 0.075), (2.0, 0.3)] {
            let options = options(folder.path(), 0.0, effort);
            let chosen = ChosenArm::of(&options, folder.path(), "first").unwrap();
            let found = followed(&options, &chosen, &options.out).unwrap();
            assert_eq!((found.weak, found.notes.len()), (None, 0));
            assert!((found.motion.angle - angle).abs() < 1e-12, "{}", found.motion.angle);
        }
    }
}
