//! The arm that a description is of, where it is known by name; and its torque interface.

use std::path::Path;

use phihat_model::{KnownArm, Profile, Recognition, Robot};

use super::options::ArmOptions;
use crate::error::SessionError;

/// Recognises the arm of a bare description by its names, or takes the one that is stated, and completes it by what its
/// maker publishes; gives what is to be said of it.
pub(super) fn completed(
    robot: &mut Robot,
    options: &ArmOptions,
) -> Result<Vec<String>, SessionError> {
    let refuse = |why| SessionError::at(Path::new(&options.arm), why);
    let (arm, by) = match KnownArm::chosen(robot, options.known.as_deref()).map_err(refuse)? {
        Recognition::Known(arm, by) => (arm, by),
        Recognition::OneOf(arms) => {
            let note = ambiguity_text(&arms);
            return with_profile(robot, options, vec![note]);
        }
        Recognition::None => return with_profile(robot, options, Vec::new()),
    };
    let mut notes = arm.complete(robot).map_err(refuse)?;
    notes.insert(
        0,
        format!("{}; --profile ideal or --arm none to ignore it", recognition_text(arm, &by)),
    );
    notes.extend(arm.notes.iter().cloned());
    with_profile(robot, options, notes)
}

/// Sentence on the arm that a description was recognised as, and `why`.
pub fn recognition_text(arm: &KnownArm, why: &str) -> String {
    let KnownArm { title, name, profile, encoder, .. } = arm;
    let interface = Profile::named(profile).map_or_else(|_| String::new(), |own| own.description);
    format!(
        "recognised as {title} ({name}), {why}; profile {profile} ({interface}); encoders: {encoder}"
    )
}

/// Sentence on arms with the same names.
pub fn ambiguity_text(arms: &[&KnownArm]) -> String {
    let names: Vec<&str> = arms.iter().map(|arm| &*arm.name).collect();
    let names = names.join(", ");
    format!(
        "its joints are named as those of {names}: --arm NAME says which one it is, --arm none that it is none of them"
    )
}

/// The torque interface that is stated, in place of the arm's.
fn with_profile(
    robot: &mut Robot,
    options: &ArmOptions,
    notes: Vec<String>,
) -> Result<Vec<String>, SessionError> {
    if let Some(name) = &options.profile {
        let own = Profile::named(name).map_err(SessionError::other)?;
        robot.sources.insert("profile".to_owned(), own.source);
        robot.profile = own.name;
    }
    Ok(notes)
}
