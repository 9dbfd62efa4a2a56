//! A robot from its files, or from those that come with the crate.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::RobotError;
use crate::input::plain;
use crate::named_texts::{NamedFile, NamedTexts};
use crate::robot_text::read_text;
use crate::source::{described, is_mjcf};
use crate::{Chain, KnownArm, Model, MotionOnly, Part, Robot, extras, mjcf};

/// Files of the arms that come with the crate: name, URDF, TOML.
macro_rules! arms {
    ($($name:literal),*) => {
        const NAMES: &[&str] = &[$($name),*];
        const ARMS: &[(&str, &str, &str)] = &[$((
            $name,
            include_str!(concat!("../robots/", $name, ".urdf")),
            include_str!(concat!("../robots/", $name, ".toml")),
        )),*];
    };
}

arms!("planar3r", "panda", "iiwa14", "ur5");

impl Robot {
    /// Reads a robot from its TOML file, which names its URDF, or from a URDF with the TOML file of the same name
    /// that stands beside it, if one does.
    ///
    /// # Errors
    ///
    /// [`RobotError`], with file, line where there is one, link or joint, value and what would be
    /// valid.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        Self::read_part(path, &Part::default())
    }

    /// As [`read`](Self::read), but for a part of the description alone; a TOML file lists the joints of that part.
    ///
    /// # Errors
    ///
    /// [`RobotError`]
    pub fn read_part(path: &Path, part: &Part) -> Result<Self, RobotError> {
        Self::read_from(&NamedTexts::DISK, path, part)
    }

    /// As [`read_part`](Self::read_part), with files that are texts in place of those of the disk.
    ///
    /// # Errors
    ///
    /// [`RobotError`]
    pub fn read_from(files: &NamedTexts, path: &Path, part: &Part) -> Result<Self, RobotError> {
        let text = read_text(files, path)?;
        let origin = path.display().to_string();
        if path.extension().is_none_or(|extension| extension != "toml") {
            let beside = path.with_extension("toml");
            let Some(more) = extras::about_urdf(files, &beside, path)? else {
                let robot = Self::assemble((&text, Some((files, path))), part, &origin, None)?;
                return Ok(robot.of(files, [path.to_owned()]));
            };
            let more = Some((&*more, &*beside.display().to_string()));
            let robot = Self::assemble((&text, Some((files, path))), part, &origin, more)?;
            return Ok(robot.of(files, [path.to_owned(), beside]));
        }
        let urdf = extras::urdf_beside(path, &text, &origin)?;
        let (urdf_text, urdf_origin) = (read_text(files, &urdf)?, urdf.display().to_string());
        let whole = (&*urdf_text, Some((files, &*urdf)));
        let robot = Self::assemble(whole, part, &urdf_origin, Some((&text, &origin)))?;
        Ok(robot.of(files, [path.to_owned(), urdf]))
    }

    /// The robot of these files, and of those that they include.
    fn of(mut self, source: &NamedTexts, files: impl Into<Vec<PathBuf>>) -> Self {
        self.source = source.clone();
        self.files = [files.into(), self.files].concat();
        self
    }

    /// Makes a robot from the text of its URDF and, if there is one, of its TOML file; `origin`
    /// stands for the file in errors.
    ///
    /// # Errors
    ///
    /// [`RobotError`], as for [`read`](Self::read).
    pub fn from_text(urdf: &str, toml: Option<&str>, origin: &str) -> Result<Self, RobotError> {
        Self::assemble((urdf, None), &Part::default(), origin, toml.map(|text| (text, origin)))
    }

    /// Makes a robot from a part of the text of a URDF.
    ///
    /// # Errors
    ///
    /// [`RobotError`], as for [`read`](Self::read).
    pub fn part_of_text(urdf: &str, part: &Part, origin: &str) -> Result<Self, RobotError> {
        Self::assemble((urdf, None), part, origin, None)
    }

    /// The chains of joints in a URDF, or in that which a TOML file names, that could be arms, the longest first.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: the file is no URDF. A chain of which no arm can be made is refused by
    /// [`read_part`](Self::read_part).
    pub fn chains(path: &Path) -> Result<Vec<Chain>, RobotError> {
        Self::chains_from(&NamedTexts::DISK, path)
    }

    /// As [`chains`](Self::chains), with files that are texts in place of those of the disk.
    ///
    /// # Errors
    ///
    /// As for [`chains`](Self::chains).
    pub fn chains_from(files: &NamedTexts, path: &Path) -> Result<Vec<Chain>, RobotError> {
        let (text, origin) = (read_text(files, path)?, path.display().to_string());
        if path.extension().is_none_or(|extension| extension != "toml") {
            return chains_of((&text, Some((files, path))), &origin);
        }
        let urdf = extras::urdf_beside(path, &text, &origin)?;
        chains_of((&read_text(files, &urdf)?, Some((files, &urdf))), &urdf.display().to_string())
    }

    /// The chains of joints in the text of a URDF that could be arms, the longest first.
    ///
    /// # Errors
    ///
    /// As for [`chains`](Self::chains).
    pub fn chains_of_text(urdf: &str, origin: &str) -> Result<Vec<Chain>, RobotError> {
        chains_of((urdf, None), origin)
    }

    /// Joints of a part of a URDF with their limits; the links may be without mass ([`RobotError::NoInertia`]).
    ///
    /// # Errors
    ///
    /// [`RobotError`], as for [`read_from`](Self::read_from).
    pub fn joints_of(
        files: &NamedTexts,
        path: &Path,
        part: &Part,
    ) -> Result<MotionOnly, RobotError> {
        let (text, origin) = (read_text(files, path)?, path.display().to_string());
        let read = described(&text, Some((files, path)), &origin);
        read.and_then(|file| file.motion(part)).map_err(RobotError::plain)
    }

    /// Gives one of the arms that come with the crate: those of [`names`](Self::names).
    ///
    /// # Errors
    ///
    /// [`RobotError::Unknown`] with the nearest name there is.
    pub fn named(name: &str) -> Result<Self, RobotError> {
        let Some((_, urdf, toml)) = ARMS.iter().find(|(known, ..)| *known == name) else {
            return Err(RobotError::Unknown {
                name: name.to_owned(),
                hint: if KnownArm::named(name).is_ok() {
                    ": it is known by name, and its description does not come along: name its URDF"
                        .to_owned()
                } else {
                    nearest(name, NAMES)
                        .map_or_else(String::new, |n| format!(", did you mean \"{n}\"?"))
                },
                known: NAMES,
            });
        };
        let toml = Some((*toml, &*format!("{name}.toml")));
        Self::assemble((urdf, None), &Part::default(), &format!("{name}.urdf"), toml)
    }

    /// The text of the URDF that it was read from; of another format, that of [`as_urdf`](Self::as_urdf).
    ///
    /// # Errors
    ///
    /// [`RobotError`]: it was made from text that nobody kept, or its file cannot be read any more.
    pub fn urdf(&self) -> Result<String, RobotError> {
        let is_description =
            |path: &&PathBuf| path.extension().is_none_or(|extension| extension != "toml");
        if let Some(path) = self.files.iter().find(is_description) {
            let text = read_text(&self.source, path)?;
            return Ok(if is_mjcf(&text) { self.as_urdf() } else { text });
        }
        let kept = ARMS.iter().find(|(name, ..)| *name == self.name);
        let kept = kept.map(|(_, urdf, _)| (*urdf).to_owned());
        kept.ok_or_else(|| RobotError::Value {
            origin: self.name.clone(),
            key: "urdf".to_owned(),
            why: "this arm was made from text that was not kept".to_owned(),
        })
    }

    /// The text of a description in a file, with the files that it includes in their places, and the extension of its
    /// format.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: a file cannot be read, or is no XML.
    pub fn description_text(
        files: &NamedTexts,
        path: &Path,
    ) -> Result<(String, &'static str), RobotError> {
        let text = read_text(files, path)?;
        if !is_mjcf(&text) {
            return Ok((text, "urdf"));
        }
        let flat = mjcf::flat(&text, (files, path)).map_err(RobotError::plain)?;
        Ok((flat.unwrap_or(text), "xml"))
    }

    /// Names of the arms that come with the crate.
    pub fn names() -> &'static [&'static str] {
        NAMES
    }

    fn assemble(
        (text, path): (&str, Option<NamedFile<'_>>),
        part: &Part,
        origin: &str,
        toml: Option<(&str, &str)>,
    ) -> Result<Self, RobotError> {
        // Whoever asks for a part of his own, asks for it in place of the file's.
        let stated = match toml {
            Some((text, origin)) if !part.is_stated() => {
                let mut stated = extras::part(text, origin).map_err(RobotError::plain)?;
                stated.locked.extend(part.locked.clone());
                stated
            }
            _ => part.clone(),
        };
        let read = described(text, path, origin).and_then(|file| file.cut(&stated));
        let read = read.map_err(RobotError::plain)?;
        let tip = read.tip.unwrap_or_else(|| outermost_frame(&read.model));
        let robot = Self {
            name: read.name,
            description: String::new(),
            licence: String::new(),
            provenance: origin.to_owned(),
            sources: BTreeMap::new(),
            model: read.model,
            joints: read.joints,
            tip,
            profile: "ideal".to_owned(),
            poses: read.poses,
            held: read.held,
            warnings: read.warnings.iter().map(|warning| plain(warning)).collect(),
            files: read.included,
            source: NamedTexts::DISK,
        };
        match toml {
            None => Ok(robot),
            Some((text, origin)) => {
                let robot = extras::apply(robot, text, origin);
                robot
                    .and_then(|robot| robot.with_a_tip_that_moves(origin))
                    .map_err(RobotError::plain)
            }
        }
    }

    /// Checks that a joint moves the tip: a link that no joint moves does no work.
    fn with_a_tip_that_moves(self, origin: &str) -> Result<Self, RobotError> {
        if self.moves(&self.tip) {
            return Ok(self);
        }
        let moved = self.model.frame_names().iter().filter(|name| self.moves(name));
        let moved = moved.cloned().collect::<Vec<_>>().join(", ");
        let why = format!("no joint moves link \"{}\"; these move: {moved}", self.tip);
        Err(RobotError::Value { origin: origin.to_owned(), key: "tip".to_owned(), why })
    }
}

fn chains_of(
    (text, path): (&str, Option<NamedFile<'_>>),
    origin: &str,
) -> Result<Vec<Chain>, RobotError> {
    described(text, path, origin).and_then(|file| file.chains()).map_err(RobotError::plain)
}

/// The last frame that the last joint moves: the best guess at the one that does the work.
fn outermost_frame(model: &Model) -> String {
    let compiled = model.compiled();
    let last = compiled.segment_of_joint.last().copied();
    let at = compiled.seats.iter().rposition(|seat| seat.segment == last);
    at.and_then(|at| model.frame_names().get(at).cloned()).unwrap_or_default()
}

/// The known name closest to `name`, if it is close.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let score = |candidate: &&str| strsim::jaro_winkler(name, candidate);
    let best = known.iter().copied().max_by(|a, b| score(a).total_cmp(&score(b)))?;
    (score(&best) > 0.6).then_some(best)
}
