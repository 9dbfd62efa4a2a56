//! The arm that a study is made for: chosen from a file, and completed by estimates.

use std::fs;
use std::path::{Component, Path, PathBuf};

use phihat_model::{Chain, NamedTexts, Part, Robot};

use super::known::completed;
use super::options::{ArmOptions, BeginOptions};
use super::posture::{Easy, easy_posture};
use super::torque::assume;
use crate::disk::folder_of;
use crate::error::SessionError;

/// The posture that a study moves about.
pub(super) const READY: &str = "ready";

/// Chosen arm: its lines in the study, its own file and notes.
pub(super) struct ChosenArm {
    pub(super) robot: Robot,
    pub(super) part: Part,
    /// Lines of `[robot]`.
    pub(super) lines: Vec<String>,
    /// The arm's own file, where it is written.
    pub(super) written: Option<ArmFile>,
    pub(super) notes: Vec<String>,
    /// True if the posture of the motion is not one of the arm's own poses.
    pub(super) posture_added: bool,
    /// Why the drives cannot hold the arm anywhere that was looked at.
    pub(super) unheld: Option<String>,
}

/// A file of an arm, its description beside it.
pub(super) struct ArmFile {
    pub(super) name: String,
    pub(super) urdf: String,
    /// A copy of the description, where it is in another folder: its name and its text.
    pub(super) copy: Option<(String, String)>,
    text: String,
}

impl ChosenArm {
    pub(super) fn of(
        options: &BeginOptions,
        folder: &Path,
        name: &str,
    ) -> Result<Self, SessionError> {
        let (mut robot, part, mut notes) = described(&options.arm)?;
        // Where a file of the arm is written, an assumption has its place.
        if robot.bare_file().is_some() {
            notes.extend(assume(&mut robot, options.payload_kg, &options.arm.arm)?);
        }
        let (lines, written, posture_added) = (Vec::new(), None, false);
        let (before, unheld) = (Vec::new(), None);
        let mut chosen = Self { robot, part, lines, written, notes: before, posture_added, unheld };
        if Robot::names().contains(&options.arm.arm.as_str()) && chosen.robot.files.is_empty() {
            chosen.lines.push(format!("name = {:?}", options.arm.arm));
        } else if let Some(bare) = chosen.robot.bare_file().map(Path::to_owned) {
            notes.extend(chosen.complete((&options.arm.files, &bare), folder, name)?);
        } else {
            let file = Path::new(&options.arm.arm);
            chosen.lines.push(format!("file = {}", quoted(&relative(folder, file))));
            let part = &chosen.part;
            let ends = [("base", &part.base), ("tip", &part.tip)];
            let stated = ends.into_iter().filter_map(|(key, link)| Some((key, link.as_ref()?)));
            chosen.lines.extend(stated.map(|(key, link)| format!("{key} = {}", quoted(link))));
        }
        chosen.notes = notes;
        if !chosen.robot.poses.contains_key(READY) || chosen.written.is_some() {
            let Easy { posture, unheld } = easy_posture(&chosen.robot, options.payload_kg)?;
            chosen.robot.poses.insert(READY.to_owned(), posture);
            chosen.unheld = unheld;
            chosen.posture_added = true;
        }
        Ok(chosen)
    }

    /// Estimates what a bare description leaves out.
    fn complete(
        &mut self,
        (files, urdf): (&NamedTexts, &Path),
        folder: &Path,
        name: &str,
    ) -> Result<Vec<String>, SessionError> {
        let (text, extension) =
            Robot::description_text(files, urdf).map_err(SessionError::other)?;
        self.robot = self.robot.clone().estimated();
        let beside = !files.has_text(urdf)
            && fs::canonicalize(folder_of(urdf)).ok() == fs::canonicalize(folder).ok();
        let own = urdf.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let copied = format!("{name}_arm.{extension}");
        let urdf = if beside { own } else { copied };
        let copy = (!beside).then(|| (urdf.clone(), text.clone()));
        let file = ArmFile { name: format!("{name}_arm.toml"), urdf, copy, text };
        self.lines.push(format!("file = {}", quoted(&file.name)));
        let note = format!(
            "rotor inertia, friction and encoder are estimates, as intervals, in {}: it says what to measure",
            file.name
        );
        self.written = Some(file);
        Ok(vec![note])
    }

    /// The text of the arm's own file.
    pub(super) fn arm_text(&self) -> String {
        let urdf = self.written.as_ref().map_or("", |file| &file.urdf);
        self.robot.arm_file(urdf, &self.part)
    }

    /// Files of the arm as a study in a folder names them: its own ones, where they are still to be written.
    pub(super) fn files(&self, options: &ArmOptions, folder: &Path) -> NamedTexts {
        let Some(file) = &self.written else { return options.files.clone() };
        options.files.with([
            (folder.join(&file.urdf), file.text.clone()),
            (folder.join(&file.name), self.arm_text()),
        ])
    }
}

/// The arm that is asked for, the part of its file that it is, and what was chosen.
///
/// # Errors
///
/// [`SessionError`]: it cannot be read, or a joint of an arm with a file of its own has no torque limit.
pub fn described(options: &ArmOptions) -> Result<(Robot, Part, Vec<String>), SessionError> {
    let (mut robot, part, mut notes) = read(options)?;
    let n = robot.joints.len();
    if robot.bare_file().is_some() {
        notes.extend(completed(&mut robot, options)?);
    } else if let Some(known) = &options.known {
        let why =
            format!("--arm {known}: it has a file of its own already, which says what arm it is");
        return Err(SessionError::at(Path::new(&options.arm), why));
    }
    options.limit(&mut robot.joints)?;
    let without = robot.without_torque_limit();
    if without.is_empty() || robot.bare_file().is_some() {
        return Ok((robot, part, notes));
    }
    let names = without.join(", ");
    let why = format!(
        "no torque limit is stated for {names}, and nothing can be estimated without it: --torque-max NM states one \
         for all {n} joints, or a list with one each, as in the drives' data sheet; --base and --tip leave joints out"
    );
    Err(SessionError::at(Path::new(&options.arm), why))
}

/// The arm and the part of its file that it is: where none is stated, the first chain of those that could be arms.
fn read(options: &ArmOptions) -> Result<(Robot, Part, Vec<String>), SessionError> {
    let path = Path::new(&options.arm);
    let mut part = options.part.clone();
    let refuse = |why: phihat_model::RobotError| SessionError::other(why);
    let files = &options.files;
    if path.extension().is_none() && !files.is_file(path) {
        if part.is_stated() {
            let why = "--base and --tip cut an arm out of a file; built-in robots are arms already";
            return Err(SessionError::other(why));
        }
        return Ok((Robot::named(&options.arm).map_err(refuse)?, part, Vec::new()));
    }
    let mut notes = Vec::new();
    let chains = Robot::chains_from(files, path).map_err(refuse)?;
    let whole = if part.is_stated() { None } else { Some(Robot::read_from(files, path, &part)) };
    let alone = |robot: &Robot| match &chains[..] {
        [first, ..] if robot.bare_file().is_some() => {
            first.joints == robot.model.joint_names() && first.tip == robot.tip
        }
        _ => true,
    };
    if let Some(read) = whole {
        match (read, &chains[..]) {
            (Ok(robot), _) if alone(&robot) => return Ok((robot, part, notes)),
            (read, []) => return Ok((read.map_err(refuse)?, part, notes)),
            (_, [first, others @ ..]) => {
                if let [_, ..] = &first.tips[..] {
                    return Err(which_tip(path, first));
                }
                (part.base, part.tip) = (Some(first.base.clone()), Some(first.tip.clone()));
                let other = others.first().map_or_else(String::new, |chain| {
                    format!("; others, such as --base {} --tip {}", chain.base, chain.tip)
                });
                notes.push(format!(
                    "the arm is the chain from {} to {} ({} joints), all else stands still{other}",
                    first.base,
                    first.tip,
                    first.joints.len()
                ));
            }
        }
    }
    let robot = Robot::read_from(files, path, &part).map_err(refuse)?;
    notes.extend(fixed_joints_note(&robot));
    Ok((robot, part, notes))
}

/// Note on joints that are none of the arm's: their links are carried.
fn fixed_joints_note(robot: &Robot) -> Option<String> {
    let fixed: Vec<String> =
        robot.held.iter().map(|(name, at)| format!("{name} at {at}")).collect();
    let fixed = fixed.join(", ");
    (!fixed.is_empty()).then(|| {
        format!(
            "no joints of the arm, fixed and carried with their mass: {fixed}; a payload is on {}",
            robot.tip
        )
    })
}

/// Refusal of a file with more than one link that could do the work.
fn which_tip(path: &Path, chain: &Chain) -> SessionError {
    let tips: Vec<String> = chain.tips.iter().map(|tip| format!("--tip {tip}")).collect();
    let why = format!(
        "which link does the work and carries the payload? {}, each with --base {}",
        tips.join(" or "),
        chain.base
    );
    SessionError::at(path, why)
}

/// An arm with its estimates, for a file of its own: with the part that it is, its URDF's name, and what was chosen.
pub(super) fn to_write(
    options: &ArmOptions,
    out: &Path,
) -> Result<(Robot, Part, String, Vec<String>), SessionError> {
    let (mut robot, part, mut notes) = read(options)?;
    let Some(urdf) = robot.bare_file().map(Path::to_owned) else {
        let why =
            "it has a file of its own already: a bare description is what a file is written for";
        return Err(SessionError::at(Path::new(&options.arm), why));
    };
    let place = relative(folder_of(out), &urdf);
    if Path::new(&place).components().any(|part| !matches!(part, Component::Normal(_))) {
        let why =
            format!("the description {} must be beside this file or below it", urdf.display());
        return Err(SessionError::at(out, why));
    }
    if options.torque_max_nm.is_empty() {
        notes.extend(completed(&mut robot, options)?);
    } else {
        (robot, _, notes) = described(options)?;
    }
    let mut robot = robot.estimated();
    if robot.without_torque_limit().is_empty()
        && let Ok(Easy { posture, unheld: None }) = easy_posture(&robot, 0.0)
    {
        robot.poses.insert(READY.to_owned(), posture);
    }
    Ok((robot, part, place, notes))
}

fn quoted(word: &str) -> String {
    toml::Value::String(word.to_owned()).to_string()
}

/// A file as it is named from a folder.
fn relative(folder: &Path, file: &Path) -> String {
    // Texts have no folder that the disk could name in full: then both are taken as they are named.
    let (from, to) = match (fs::canonicalize(folder), fs::canonicalize(file)) {
        (Ok(from), Ok(to)) => (from, to),
        _ => (folder.to_owned(), file.to_owned()),
    };
    let parts = |path: &Path| -> Vec<PathBuf> {
        let own = path.components().filter(|part| *part != Component::CurDir);
        own.map(|part| PathBuf::from(part.as_os_str())).collect()
    };
    let (from, to) = (parts(&from), parts(&to));
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let mut named = PathBuf::new();
    from.iter().skip(shared).for_each(|_| named.push(".."));
    to.iter().skip(shared).for_each(|part| named.push(part));
    named.to_string_lossy().replace('\\', "/")
}
