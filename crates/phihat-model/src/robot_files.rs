//! A robot from its files, or from those that come with the crate.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::error::RobotError;
use crate::robot_text::read_text;
use crate::{Model, Robot, extras, urdf};

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
        let text = read_text(path)?;
        let origin = path.display().to_string();
        if path.extension().is_none_or(|extension| extension != "toml") {
            let beside = path.with_extension("toml");
            let Some(more) = extras::about_urdf(&beside, path)? else {
                return Ok(Self::from_text(&text, None, &origin)?.of([path.to_owned()]));
            };
            let more_origin = beside.display().to_string();
            let robot = Self::assemble(&text, &origin, Some((&more, &more_origin)))?;
            return Ok(robot.of([path.to_owned(), beside]));
        }
        let urdf = extras::urdf_beside(path, &text, &origin)?;
        let (urdf_text, urdf_origin) = (read_text(&urdf)?, urdf.display().to_string());
        let robot = Self::assemble(&urdf_text, &urdf_origin, Some((&text, &origin)))?;
        Ok(robot.of([path.to_owned(), urdf]))
    }

    fn of(mut self, files: impl Into<Vec<PathBuf>>) -> Self {
        self.files = files.into();
        self
    }

    /// Makes a robot from the text of its URDF and, if there is one, of its TOML file; `origin`
    /// stands for the file in errors.
    ///
    /// # Errors
    ///
    /// [`RobotError`], as for [`read`](Self::read).
    pub fn from_text(urdf: &str, toml: Option<&str>, origin: &str) -> Result<Self, RobotError> {
        Self::assemble(urdf, origin, toml.map(|text| (text, origin)))
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
                hint: nearest(name, NAMES)
                    .map_or_else(String::new, |n| format!(", did you mean \"{n}\"?")),
                known: NAMES,
            });
        };
        Self::assemble(urdf, &format!("{name}.urdf"), Some((toml, &format!("{name}.toml"))))
    }

    /// Names of the arms that come with the crate.
    pub fn names() -> &'static [&'static str] {
        NAMES
    }

    fn assemble(urdf: &str, origin: &str, toml: Option<(&str, &str)>) -> Result<Self, RobotError> {
        let read = urdf::read(urdf, origin).map_err(RobotError::plain)?;
        let tip = outermost_frame(&read.model);
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
            poses: BTreeMap::new(),
            warnings: read.warnings,
            files: Vec::new(),
        };
        match toml {
            None => Ok(robot),
            Some((text, origin)) => extras::apply(robot, text, origin).map_err(RobotError::plain),
        }
    }
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
