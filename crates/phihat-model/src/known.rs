//! Arms known by name: recognised by the names in a description, with what their makers publish beyond it.

use std::sync::OnceLock;

use serde::Deserialize;

use crate::error::RobotError;
use crate::profile::Profile;
use crate::robot::Robot;

/// Masses of a link that are one \[kg/kg\].
const SAME_MASS: f64 = 2e-3;

/// Table of the arms.
const ARMS: &str = include_str!("../robots/known.toml");

/// An arm known by name; its figures are in `robots/known.toml`, with their sources.
///
/// # Example
///
/// ```
/// use phihat_model::{KnownArm, Recognition, Robot};
///
/// let panda = Robot::named("panda")?;
/// let Recognition::Known(arm, by) = KnownArm::of(&panda) else { panic!() };
/// assert_eq!((&*arm.name, &*arm.profile), ("panda", "franka"));
/// assert!(by.contains("panda_joint1"));
/// # Ok::<(), phihat_model::RobotError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownArm {
    /// Short name, as options use it.
    pub name: String,
    /// Name of the product.
    pub title: String,
    /// Words that arms told apart by mass or name share; an empty list: their joints' names are enough.
    family: Option<Vec<String>>,
    #[serde(default)]
    words: Vec<String>,
    joints: Vec<String>,
    #[serde(default)]
    links: Vec<String>,
    link_mass: Option<LinkMass>,
    /// Number of its joints.
    pub count: usize,
    /// Torque interface: one of [`Profile::NAMES`].
    pub profile: String,
    /// Side and resolution of its encoders, in words.
    pub encoder: String,
    /// Resolution of its encoders \[bit\] over one turn of the joint; `None`: not published.
    pub encoder_bits: Option<u32>,
    /// Largest torque of each joint \[N·m\]; `None`: not published.
    pub torque_max_nm: Option<Vec<f64>>,
    /// Largest speed of each joint \[rad/s\]; `None`: not published.
    pub velocity_max_rad_s: Option<Vec<f64>>,
    /// Reflected rotor inertia of each joint \[kg·m²\]; `None`: not published.
    pub armature_kg_m2: Option<Vec<f64>>,
    armature_source: Option<String>,
    /// Dry friction of each joint \[N·m\]; `None`: not published.
    pub coulomb_nm: Option<Vec<f64>>,
    /// Factor by which dry friction may differ either way.
    coulomb_factor: Option<f64>,
    coulomb_source: Option<String>,
    /// Sentences that its user has to know.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Sources, and what is not published.
    pub source: String,
}

/// Mass of a link by which arms with the same names are told apart.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct LinkMass {
    link: String,
    kg: f64,
}

/// Arm that a description is of.
#[derive(Debug, Clone, PartialEq)]
pub enum Recognition {
    /// A known one, and the names by which it is one.
    Known(&'static KnownArm, String),
    /// One of these, whose names are the same.
    OneOf(Vec<&'static KnownArm>),
    /// None that is known.
    None,
}

#[derive(Deserialize)]
struct ArmsFile {
    arm: Vec<KnownArm>,
}

impl KnownArm {
    /// Word in place of a name: none of them.
    pub const NO_ARM: &str = "none";

    /// Every known arm, in the order of the table.
    pub fn all() -> &'static [Self] {
        static ALL: OnceLock<Vec<KnownArm>> = OnceLock::new();
        ALL.get_or_init(|| {
            toml::from_str::<ArmsFile>(ARMS).map_or_else(|_| Vec::new(), |file| file.arm)
        })
    }

    /// Gives the arm of this name.
    ///
    /// # Errors
    ///
    /// [`RobotError::Value`] for a name that is none of the table's.
    pub fn named(name: &str) -> Result<&'static Self, RobotError> {
        let found = Self::all().iter().find(|arm| arm.name == name);
        found.ok_or_else(|| {
            let names: Vec<&str> = Self::all().iter().map(|arm| &*arm.name).collect();
            let why = format!("\"{name}\" is none of the known arms: {}", names.join(", "));
            RobotError::Value {
                origin: "robots/known.toml".to_owned(),
                key: "name".to_owned(),
                why,
            }
        })
    }

    /// The arm that somebody states by its name, [`NO_ARM`](Self::NO_ARM) for none; where nothing is stated, the one
    /// that [`of`](Self::of) recognises. Beside a known arm stands why it is that one, in words.
    ///
    /// # Errors
    ///
    /// [`RobotError::Value`] for a name that is none of the table's, and for an arm with another number of joints.
    pub fn chosen(robot: &Robot, stated: Option<&str>) -> Result<Recognition, RobotError> {
        let arm = match stated {
            Some(Self::NO_ARM) => return Ok(Recognition::None),
            Some(name) => Self::named(name)?,
            None => {
                return Ok(match Self::of(robot) {
                    Recognition::Known(arm, by) => Recognition::Known(arm, format!("by {by}")),
                    other => other,
                });
            }
        };
        let (n, count) = (robot.joints.len(), arm.count);
        if n != count {
            let why = format!(
                "{} has {count} joints, and this arm {n}: --base and --tip leave joints out",
                arm.title
            );
            return Err(RobotError::Value {
                origin: robot.name.clone(),
                key: "arm".to_owned(),
                why,
            });
        }
        Ok(Recognition::Known(arm, "as stated".to_owned()))
    }

    /// Recognises an arm by the names in its description: joints, links, robot.
    pub fn of(robot: &Robot) -> Recognition {
        let similar: Vec<&'static Self> =
            Self::all().iter().filter(|arm| arm.is_named_as(robot)).collect();
        let sure = similar.iter().find(|arm| arm.is_distinguished(robot));
        if let Some(arm) = sure {
            return Recognition::Known(arm, arm.evidence(robot));
        }
        let family: Vec<&'static Self> =
            similar.into_iter().filter(|arm| arm.is_of_family(robot)).collect();
        if family.is_empty() { Recognition::None } else { Recognition::OneOf(family) }
    }

    /// Returns true if the names of joints and links are this arm's.
    fn is_named_as(&self, robot: &Robot) -> bool {
        let links = robot.model.frame_names();
        let has = |end: &String| links.iter().any(|link| ends_with(link, end));
        robot.joints.len() == self.count
            && self.joint_prefix(robot).is_some()
            && self.links.iter().all(has)
    }

    /// Beginning of the joints' names, before the ends by which this arm is recognised.
    fn joint_prefix<'a>(&self, robot: &'a Robot) -> Option<&'a str> {
        let numbered = |end: &str, from: usize| {
            let name = |(i, joint): (usize, &'a crate::Joint)| {
                joint.name.strip_suffix(&end.replace('#', &(i + from).to_string()))
            };
            same(robot.joints.iter().enumerate().map(name))
        };
        if self.joints.len() == self.count && !self.joints.iter().any(|end| end.contains('#')) {
            let each = robot.joints.iter().zip(&self.joints);
            return same(each.map(|(joint, end)| joint.name.strip_suffix(&**end)));
        }
        self.joints.iter().find_map(|end| numbered(end, 1).or_else(|| numbered(end, 0)))
    }

    fn is_distinguished(&self, robot: &Robot) -> bool {
        let named = has_word(robot, self.joint_prefix(robot), &self.words);
        let weighs = self.link_mass.as_ref().is_some_and(|mass| mass.is_of(robot));
        let stated = !self.words.is_empty() || self.link_mass.is_some();
        named
            || (weighs && !Self::all().iter().any(|arm| has_word(robot, None, &arm.words)))
            || !stated
    }

    fn is_of_family(&self, robot: &Robot) -> bool {
        let Some(words) = &self.family else { return false };
        words.is_empty() || has_word(robot, self.joint_prefix(robot), words)
    }

    /// Evidence by which the arm was recognised, in words.
    fn evidence(&self, robot: &Robot) -> String {
        let (first, last) = (robot.joints.first(), robot.joints.last());
        let name =
            |joint: Option<&crate::Joint>| joint.map_or_else(String::new, |j| j.name.clone());
        let mut by = format!("its joints {} … {}", name(first), name(last));
        if has_word(robot, self.joint_prefix(robot), &self.words) {
            if !has_word_in(self.joint_prefix(robot).unwrap_or_default(), &self.words) {
                by = format!("{by} and the robot's name {}", robot.name);
            }
        } else if let Some(LinkMass { link, kg }) = &self.link_mass {
            by = format!("{by} and {kg} kg of its {link}");
        } else if let Some(link) = self.links.first() {
            by = format!("{by} and its link {link}");
        }
        by
    }

    /// Takes over what the maker publishes and the description leaves out; gives what its user has to know.
    ///
    /// Torque interface, torque and speed limits, rotor inertia, dry friction and encoders: each only where the
    /// description states nothing. Zero friction counts as nothing stated.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: the table's torque interface is none.
    pub fn complete(&self, robot: &mut Robot) -> Result<Vec<String>, RobotError> {
        let profile = Profile::named(&self.profile)?;
        robot.profile.clone_from(&profile.name);
        let mut added: Vec<(&str, &str)> = vec![("profile", &profile.source)];
        let mut notes = Vec::new();
        let at =
            |list: &Option<Vec<f64>>, i: usize| list.as_ref().and_then(|list| list.get(i)).copied();
        for (i, joint) in robot.joints.iter_mut().enumerate() {
            match (joint.torque_max, at(&self.torque_max_nm, i)) {
                (None, Some(torque)) => {
                    joint.torque_max = Some(torque);
                    added.push(("limits", &self.source));
                }
                (Some(own), Some(torque)) if own > torque => notes.push(format!(
                    "{} has {own} N·m by the description, which is used; {torque} N·m is published",
                    joint.name
                )),
                _ => {}
            }
            if let (None, Some(speed)) = (joint.velocity_max, at(&self.velocity_max_rad_s, i)) {
                joint.velocity_max = Some(speed);
                added.push(("limits", &self.source));
            }
            if let (true, Some(rotor)) = (
                joint.armature <= 0.0 && joint.armature_range.is_none(),
                at(&self.armature_kg_m2, i),
            ) {
                joint.armature = rotor;
                added.push(("rotor", self.armature_source.as_deref().unwrap_or(&self.source)));
            }
            let own = joint.friction;
            let states = own.coulomb > 0.0 || own.coulomb_range.is_some() || own.sigmoid.is_some();
            if let (false, Some(dry), Some(factor)) =
                (states, at(&self.coulomb_nm, i), self.coulomb_factor)
            {
                joint.friction.coulomb = dry;
                joint.friction.coulomb_range = Some((tidy(dry / factor), tidy(dry * factor)));
                added.push(("friction", self.coulomb_source.as_deref().unwrap_or(&self.source)));
            }
            if let (None, Some(bits)) = (joint.encoder_bits, self.encoder_bits) {
                joint.encoder_bits = Some(bits);
                added.push(("encoder", &self.source));
            }
        }
        robot.sources.extend(added.into_iter().map(|(of, from)| (of.to_owned(), from.to_owned())));
        Ok(notes)
    }
}

impl LinkMass {
    fn is_of(&self, robot: &Robot) -> bool {
        let links = robot.model.outline();
        let mut own = links.iter().filter(|link| ends_with(&link.name, &self.link));
        own.any(|link| (link.body.mass - self.kg).abs() <= SAME_MASS * self.kg)
    }
}

/// Returns true if `name` is `end`, or ends in it after a prefix.
fn ends_with(name: &str, end: &str) -> bool {
    name.to_lowercase().ends_with(&end.to_lowercase())
}

/// One common value of all.
fn same<'a>(mut each: impl Iterator<Item = Option<&'a str>>) -> Option<&'a str> {
    let first = each.next()??;
    each.all(|next| next == Some(first)).then_some(first)
}

/// Returns true if one of the words is in the robot's name, or in what its joints' names begin with.
fn has_word(robot: &Robot, prefix: Option<&str>, words: &[String]) -> bool {
    has_word_in(&robot.name, words) || has_word_in(prefix.unwrap_or_default(), words)
}

/// Returns true if one of the words is in a text, between marks that are no letters or digits.
fn has_word_in(text: &str, words: &[String]) -> bool {
    let text = text.to_lowercase();
    let mut parts = text.split(|c: char| !c.is_ascii_alphanumeric());
    parts.any(|part| words.iter().any(|word| word == part))
}

/// A number with three digits.
fn tidy(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::{ArmsFile, KnownArm};
    use crate::Profile;

    /// Fails where an entry of the table is incomplete: a list that is not one per joint, no such interface, no source.
    #[test]
    fn the_table_is_whole() {
        let file = toml::from_str::<ArmsFile>(super::ARMS).unwrap();
        assert_eq!(file.arm, KnownArm::all());
        for arm in KnownArm::all() {
            Profile::named(&arm.profile).unwrap();
            let lists =
                [&arm.torque_max_nm, &arm.velocity_max_rad_s, &arm.armature_kg_m2, &arm.coulomb_nm];
            for list in lists.into_iter().flatten() {
                assert_eq!(list.len(), arm.count, "{}", arm.name);
                assert!(list.iter().all(|x| *x > 0.0), "{}", arm.name);
            }
            let said = [&arm.source, &arm.encoder].into_iter().all(|text| !text.is_empty());
            assert!(said && !arm.joints.is_empty(), "{}", arm.name);
            let unknown = arm.torque_max_nm.is_none() || arm.encoder_bits.is_none();
            let told = format!("{} {} {:?}", arm.source, arm.encoder, arm.notes);
            assert!(!unknown || told.contains("not published"), "{}", arm.name);
            let names = KnownArm::all().iter().filter(|other| other.name == arm.name);
            assert_eq!(names.count(), 1, "{}", arm.name);
        }
    }
}
