//! `[robot]`: the arm, its names, its poses, and whether a position is one it can have.

use phihat_model::{Part, Robot};
use toml::de::DeValue;

use crate::base::Base;
use crate::entries::{clip, in_file_order};
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::joint::{self, Stated};
use crate::node::Node;
use crate::per_joint::Joints;
use crate::springs::JointSprings;
use crate::suggest::did_you_mean;
use crate::value::number;

/// Slack on a limit, for figures that were rounded when they were written down \[rad, rad/s, m\].
const ROUNDING: f64 = 1e-6;

/// The part of a description that the study says its arm is; what it locks belongs to it where it does say one.
fn part(node: &Node<'_>) -> Result<Part, StudyError> {
    let word = |key: &str| node.has(key).then(|| node.word(key).map(str::to_owned)).transpose();
    let mut part = Part { base: word("base")?, tip: word("tip")?, ..Part::default() };
    if part.is_stated()
        && let Some(DeValue::Table(table)) = node.value("locked").map(toml::Spanned::get_ref)
    {
        for (name, value) in in_file_order(table) {
            let at = number(value.get_ref()).unwrap_or_default();
            part.locked.insert(name.get_ref().to_string(), at);
        }
    }
    Ok(part)
}

/// The arm of a study and the names by which the study speaks of it.
#[derive(Debug, Clone)]
pub(crate) struct StudyArm {
    pub(crate) robot: Robot,
    pub(crate) joints: Joints,
    /// Values that `[[joint]]` states for a design.
    pub(crate) stated: Option<Stated>,
    pub(crate) springs: JointSprings,
}

impl StudyArm {
    /// Reads `[robot]`, or the joints that stand in its place; files are relative to `base`.
    pub(crate) fn read(top: &Node<'_>, base: Base<'_>) -> Result<Self, StudyError> {
        let (node, world) = (&top.child("robot"), top.child("world"));
        if top.has("joint") {
            let (robot, stated) = joint::read(top, world.word("joint_inertia")? == "low")?;
            let names = robot.joint_names();
            let joints = Joints { names, locked: Vec::new() };
            return Ok(Self {
                robot,
                joints,
                stated: Some(stated),
                springs: JointSprings::Unstated,
            });
        }
        if !node.exists() {
            let help = "`[robot]` with `name` or `file`, or a `[[joint]]` for each joint of an arm without a \
                description";
            let error = top.error(Kind::MissingKey, "robot", "missing section [robot]");
            return Err(error.with_help(help));
        }
        if world.has("joint_inertia") {
            let why = "the arm is not known by [[joint]]";
            return Err(world
                .error(Kind::Conflict, "joint_inertia", why)
                .with_help("leave it out"));
        }
        let part = part(node)?;
        let robot = if node.either("name", "file")? == "name" {
            if let Some(key) = ["base", "tip"].into_iter().find(|key| node.has(key)) {
                let why = "built-in robots are arms already: lock what shall not move";
                return Err(node.error(Kind::Conflict, key, why));
            }
            built_in(node)?
        } else {
            let path = base.join(node.word("file")?);
            let refuse = |error| node.error(Kind::Robot, "file", format!("{error}"));
            let read = Robot::read_from(base.files, &path, &part);
            read.map_err(|error| refuse(error).with_help(base.beside(&path)))?
        };
        let names = |robot: &Robot| robot.joint_names();
        let all = Joints { names: names(&robot), locked: Vec::new() };
        let mut arm = Self { robot, joints: all, stated: None, springs: JointSprings::Unstated };
        if part.is_stated() {
            // Cut out with the part: those of the arm as well as those beside it.
            arm.joints.locked = part.locked.into_keys().collect();
            return arm.with_drives(node);
        }
        let locks = arm.locks(node)?;
        if !locks.is_empty() {
            let refuse = |error| node.error(Kind::Robot, "locked", format!("{error}"));
            arm.robot = arm.robot.lock(&locks).map_err(refuse)?;
            arm.joints.names = names(&arm.robot);
            arm.joints.locked = locks.into_iter().map(|(name, _)| name).collect();
        }
        arm.with_drives(node)
    }

    /// With the rotor inertia and the springs that the study states in place of the description's.
    fn with_drives(mut self, node: &Node<'_>) -> Result<Self, StudyError> {
        if let Some(armature) = self.joints.numbers_if(node, "armature_kg_m2")? {
            for (joint, value) in self.robot.joints.iter_mut().zip(armature) {
                joint.armature = value;
                joint.armature_range = None;
            }
        }
        self.springs = JointSprings::read(node, &self.robot, &self.joints)?;
        Ok(self)
    }

    fn locks(&self, node: &Node<'_>) -> Result<Vec<(String, f64)>, StudyError> {
        let mut locks = Vec::new();
        let Some(DeValue::Table(table)) = node.value("locked").map(toml::Spanned::get_ref) else {
            return Ok(locks);
        };
        for (name, value) in in_file_order(table) {
            let j = self.joints.known(node, "locked", name.get_ref())?;
            let q = number(value.get_ref()).unwrap_or_default();
            self.check_position(node, "locked", j, q)?;
            locks.push((name.get_ref().to_string(), q));
        }
        if !locks.is_empty() && locks.len() == self.joints.count() {
            return Err(node.error(Kind::Conflict, "locked", "every joint is locked"));
        }
        Ok(locks)
    }

    /// Joint values under `direct`, or the pose named under `named`: exactly one of them.
    pub(crate) fn position(
        &self,
        node: &Node<'_>,
        direct: &str,
        named: &str,
    ) -> Result<Vec<f64>, StudyError> {
        let key = node.either(direct, named)?;
        let q = if key == direct {
            self.joints.numbers(node, direct)?
        } else {
            self.pose(node, named)?
        };
        q.iter().enumerate().try_for_each(|(j, &x)| self.check_position(node, key, j, x))?;
        Ok(q)
    }

    fn pose(&self, node: &Node<'_>, key: &str) -> Result<Vec<f64>, StudyError> {
        let name = node.word(key)?;
        let found = self.robot.poses.get(name).filter(|q| q.len() == self.joints.count());
        found.cloned().ok_or_else(|| {
            let names: Vec<&str> = self.robot.poses.keys().map(String::as_str).collect();
            let message = format!("the robot has no pose `{}`", clip(name));
            let help = if names.is_empty() {
                "it has no poses".into()
            } else {
                did_you_mean(name, &names)
            };
            node.error(Kind::UnknownName, key, message).with_help(help)
        })
    }

    /// The frame under `key`, or the robot's tip.
    pub(crate) fn frame(&self, node: &Node<'_>, key: &str) -> Result<String, StudyError> {
        let Some(name) = node.text(key) else { return Ok(self.robot.tip.clone()) };
        if self.robot.model.frame(name).is_some() {
            return Ok(name.to_owned());
        }
        let names: Vec<&str> = self.robot.model.frame_names().iter().map(String::as_str).collect();
        let message = format!("the robot has no frame `{}`", clip(name));
        node.note(
            node.error(Kind::UnknownName, key, message).with_help(did_you_mean(name, &names)),
        )?;
        Ok(self.robot.tip.clone())
    }

    /// The frame under `key`, or the robot's tip; some joint moves it.
    pub(crate) fn moved_frame(&self, node: &Node<'_>, key: &str) -> Result<String, StudyError> {
        let name = self.frame(node, key)?;
        self.moves(node, key, &name).map(|()| name)
    }

    /// Refuses a payload on a frame that no joint moves.
    pub(crate) fn moves(&self, node: &Node<'_>, key: &str, name: &str) -> Result<(), StudyError> {
        let model = &self.robot.model;
        let moved = |name: &str| model.frame(name).is_some_and(|frame| model.moves(frame));
        if moved(name) {
            return Ok(());
        }
        let names = model.frame_names().iter().map(String::as_str).filter(|name| moved(name));
        let message = format!("no joint moves frame `{}`: a payload there is no load", clip(name));
        let help = format!("valid: {}", names.collect::<Vec<_>>().join(", "));
        node.note(node.error(Kind::Conflict, key, message).with_help(help))
    }

    /// Refuses a position of joint `j` that is outside its limits.
    pub(crate) fn check_position(
        &self,
        node: &Node<'_>,
        key: &str,
        j: usize,
        q: f64,
    ) -> Result<(), StudyError> {
        let Some(limits) = self.outside(j, q) else { return Ok(()) };
        let name = &self.joints.names[j];
        let message = format!("joint `{name}`: {q} is outside its limits {limits}");
        let in_degrees = self.outside(j, q.to_radians()).is_none() && q.abs() > 3.2;
        let help = if in_degrees {
            format!("if these are degrees: {q} deg = {:.4} rad", q.to_radians())
        } else {
            String::new()
        };
        node.note(node.error_at(Kind::BeyondLimits, key, (j, name), message).with_help(help))
    }

    /// Refuses a velocity of joint `j` that is beyond its limit.
    pub(crate) fn check_velocity(
        &self,
        node: &Node<'_>,
        key: &str,
        j: usize,
        dq: f64,
    ) -> Result<(), StudyError> {
        let Some(limit) = self.too_fast(j, dq) else { return Ok(()) };
        let name = &self.joints.names[j];
        let message = format!("joint `{name}`: {:.4} rad/s is beyond its limit {limit}", dq.abs());
        Err(node.error_at(Kind::BeyondLimits, key, (j, name), message))
    }

    /// The limits of joint `j`, if `q` is outside them.
    pub(crate) fn outside(&self, j: usize, q: f64) -> Option<String> {
        let (low, high) = self.robot.joints.get(j)?.position?;
        let inside = q >= low - ROUNDING && q <= high + ROUNDING;
        (!inside).then(|| format!("{low} to {high}"))
    }

    /// The ends of travel of joint `j`; refused where it has none.
    pub(crate) fn range(&self, node: &Node<'_>, j: usize) -> Result<(f64, f64), StudyError> {
        let own = self.robot.joints.get(j).and_then(|joint| joint.position);
        own.filter(|(low, high)| (high - low).is_finite()).ok_or_else(|| {
            let message = format!("joint `{}` has no ends of travel", self.joints.names[j]);
            node.error(Kind::MissingKey, "box_rad", message).with_help("state the box")
        })
    }

    /// The velocity limit of joint `j`, if `dq` is beyond it.
    pub(crate) fn too_fast(&self, j: usize, dq: f64) -> Option<f64> {
        let limit = self.robot.joints.get(j)?.velocity_max?;
        (dq.abs() > limit + ROUNDING).then_some(limit)
    }
}

fn built_in(node: &Node<'_>) -> Result<Robot, StudyError> {
    let name = node.text("name").unwrap_or_default();
    let names = Robot::names();
    if !names.contains(&name) {
        let message = format!("no built-in robot `{}`", clip(name));
        let help = did_you_mean(name, names);
        return Err(node.error(Kind::UnknownName, "name", message).with_help(help));
    }
    Robot::named(name).map_err(|error| node.error(Kind::Robot, "name", format!("{error}")))
}
