//! The robot's TOML file: what a URDF leaves out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::error::RobotError;
use crate::joint::{Friction, JointSpring, Sigmoid};
use crate::named_texts::NamedTexts;
use crate::part::Part;
use crate::profile::Profile;
use crate::robot::Robot;
use crate::robot_text::read_text;

/// Largest file that is read \[bytes\].
const BYTES_MAX: usize = 1 << 20;

type Result<T> = core::result::Result<T, RobotError>;

/// The file as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ExtrasFile {
    name: Option<String>,
    #[serde(default)]
    description: String,
    #[serde(alias = "mjcf")]
    urdf: String,
    tip: Option<String>,
    /// Link from which the arm starts in a larger robot: its joints are those from here to the tip.
    base: Option<String>,
    /// Joints held fixed, each with its position.
    #[serde(default)]
    locked: BTreeMap<String, f64>,
    #[serde(default)]
    licence: String,
    provenance: Option<String>,
    /// The order of the lists; none: the URDF's.
    #[serde(default)]
    joints: Vec<String>,
    rotor: Option<RotorExtras>,
    transmission: Option<TransmissionExtras>,
    friction: Option<FrictionKeys>,
    limits: Option<ExtrasLimits>,
    drive: Option<DriveExtras>,
    encoder: Option<Encoder>,
    profile: Option<ProfileKey>,
    #[serde(default)]
    poses: BTreeMap<String, Vec<f64>>,
}

/// One number for all joints, or one each.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum Each {
    All(f64),
    One(Vec<f64>),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RotorExtras {
    armature_kg_m2: Option<Each>,
    armature_min_kg_m2: Option<Each>,
    armature_max_kg_m2: Option<Each>,
    source: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TransmissionExtras {
    stiffness_min_nm_rad: Each,
    stiffness_max_nm_rad: Each,
    damping_min_nm_s_rad: Each,
    damping_max_nm_s_rad: Each,
    source: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FrictionKeys {
    viscous_nm_s_rad: Option<Each>,
    coulomb_nm: Option<Each>,
    coulomb_min_nm: Option<Each>,
    coulomb_max_nm: Option<Each>,
    sigmoid_amplitude_nm: Option<Each>,
    sigmoid_steepness_s_rad: Option<Each>,
    sigmoid_offset_rad_s: Option<Each>,
    source: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ExtrasLimits {
    torque_max_nm: Option<Each>,
    torque_rate_max_nm_s: Option<Each>,
    velocity_max_rad_s: Option<Each>,
    source: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct DriveExtras {
    bandwidth_hz: Each,
    source: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Encoder {
    bits: Each,
    source: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProfileKey {
    name: String,
}

/// Path of the URDF or MJCF that the TOML file at `path` names: beside or below it.
pub(crate) fn urdf_beside(path: &Path, text: &str, origin: &str) -> Result<PathBuf> {
    let file = parse(text, origin)?;
    let named = Path::new(&file.urdf);
    let inside = named.components().all(|c| matches!(c, std::path::Component::Normal(_)));
    if !inside || file.urdf.is_empty() {
        let why = format!("\"{}\" must be a file beside the TOML file or below it", file.urdf);
        return Err(RobotError::Value { origin: origin.to_owned(), key: "urdf".to_owned(), why });
    }
    Ok(path.parent().unwrap_or(Path::new("")).join(named))
}

/// The part of the URDF that the TOML file `text` is about.
pub(crate) fn part(text: &str, origin: &str) -> Result<Part> {
    let file = parse(text, origin)?;
    let tip = file.tip.filter(|_| file.base.is_some());
    Ok(Part { base: file.base, tip, joints: None, locked: file.locked })
}

/// The text of a robot file beside a URDF, if there is one that is about this URDF; another file of that name, such
/// as a study, is left alone.
pub(crate) fn about_urdf(files: &NamedTexts, path: &Path, urdf: &Path) -> Result<Option<String>> {
    if !files.is_file(path) {
        return Ok(None);
    }
    let text = read_text(files, path)?;
    let about = match toml::from_str::<toml::Table>(&text) {
        Ok(table) => {
            let named = table.get("urdf").or_else(|| table.get("mjcf"));
            let named = named.and_then(toml::Value::as_str);
            named.is_some_and(|named| Path::new(named).file_name() == urdf.file_name())
        }
        // Whoever reads it says what is wrong.
        Err(_) => true,
    };
    Ok(about.then_some(text))
}

/// Adds to `robot` what the TOML file `text` says.
pub(crate) fn apply(mut robot: Robot, text: &str, origin: &str) -> Result<Robot> {
    let file = parse(text, origin)?;
    let own = robot.joint_names();
    let names = if file.joints.is_empty() { &own } else { &file.joints };
    let order = order_of(names, &robot, origin)?;
    let lists = Lists { order, names, origin };
    if let Some(tip) = file.tip.as_ref().filter(|tip| robot.model.frame(tip).is_none()) {
        return Err(lists.error("tip", format!("\"{tip}\" is not a link of the description")));
    }
    for (name, pose) in &file.poses {
        let key = format!("poses.{name}");
        let pose = lists.each(&key, &Each::One(pose.clone()), f64::is_finite, "finite")?;
        robot.poses.insert(name.clone(), pose);
    }
    let sources = [
        ("rotor", file.rotor.as_ref().and_then(|s| s.source.clone())),
        ("transmission", file.transmission.as_ref().and_then(|s| s.source.clone())),
        ("friction", file.friction.as_ref().and_then(|s| s.source.clone())),
        ("limits", file.limits.as_ref().and_then(|s| s.source.clone())),
        ("drive", file.drive.as_ref().and_then(|s| s.source.clone())),
        ("encoder", file.encoder.as_ref().and_then(|s| s.source.clone())),
    ];
    let stated = |(section, source): (&str, Option<String>)| Some((section.to_owned(), source?));
    robot.sources = sources.into_iter().filter_map(stated).collect();
    lists.set_joints(&mut robot, &file)?;
    if let Some(profile) = file.profile {
        robot.sources.insert("profile".to_owned(), Profile::named(&profile.name)?.source);
        robot.profile = profile.name;
    }
    Ok(Robot {
        name: file.name.unwrap_or(robot.name),
        description: file.description,
        licence: file.licence,
        provenance: file.provenance.unwrap_or(robot.provenance),
        tip: file.tip.unwrap_or(robot.tip),
        ..robot
    })
}

fn parse(text: &str, origin: &str) -> Result<ExtrasFile> {
    if text.len() > BYTES_MAX {
        let (origin, found) = (origin.to_owned(), text.len());
        return Err(RobotError::TooMuch { origin, what: "bytes", found, limit: BYTES_MAX });
    }
    toml::from_str(text).map_err(|error| RobotError::Toml {
        origin: origin.to_owned(),
        why: error.to_string().trim_end().to_owned(),
    })
}

/// For each joint of the robot, its place in the file's list.
fn order_of(names: &[String], robot: &Robot, origin: &str) -> Result<Vec<usize>> {
    let mismatch = |why| {
        let (origin, key) = (origin.to_owned(), "joints".to_owned());
        RobotError::Value { origin, key, why }
    };
    let known: Vec<&str> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    if let Some(stranger) = names.iter().find(|name| !known.contains(&name.as_str())) {
        let why =
            format!("\"{stranger}\" does not move in the description; {} do", known.join(", "));
        return Err(mismatch(why));
    }
    if names.len() > known.len() {
        return Err(mismatch("a joint is listed twice".to_owned()));
    }
    let place = |name: &&str| {
        let missing = || mismatch(format!("\"{name}\" moves in the description but is not listed"));
        names.iter().position(|n| n == name).ok_or_else(missing)
    };
    known.iter().map(place).collect()
}

/// The file's lists, brought into the robot's order.
struct Lists<'a> {
    order: Vec<usize>,
    names: &'a [String],
    origin: &'a str,
}

impl Lists<'_> {
    fn error(&self, key: &str, why: String) -> RobotError {
        RobotError::Value { origin: self.origin.to_owned(), key: key.to_owned(), why }
    }

    /// One valid value per joint, in the robot's order.
    fn each(
        &self,
        key: &str,
        stated: &Each,
        valid: impl Fn(f64) -> bool,
        wanted: &str,
    ) -> Result<Vec<f64>> {
        let n = self.order.len();
        let listed = match stated {
            Each::All(value) => vec![*value; n],
            Each::One(values) if values.len() == n => values.clone(),
            Each::One(values) => {
                let why = format!("{} values for {n} joints", values.len());
                return Err(self.error(key, why));
            }
        };
        if let Some(at) = listed.iter().position(|value| !valid(*value)) {
            let (value, joint) = (listed[at], &self.names[at]);
            return Err(self.error(key, format!("{value} of joint \"{joint}\" must be {wanted}")));
        }
        Ok(self.order.iter().map(|at| listed[*at]).collect())
    }

    /// As [`each`](Self::each), if the key is there at all: calls `set` for each joint.
    fn set(
        &self,
        robot: &mut Robot,
        key: &str,
        stated: Option<&Each>,
        range: ExtrasRange,
        set: impl Fn(&mut crate::Joint, f64),
    ) -> Result<()> {
        let Some(stated) = stated else { return Ok(()) };
        let (valid, wanted): (fn(f64) -> bool, _) = match range {
            ExtrasRange::Any => (f64::is_finite, "finite"),
            ExtrasRange::NotNegative => (|x| x.is_finite() && x >= 0.0, "finite and at least 0"),
            ExtrasRange::Positive => (|x| x.is_finite() && x > 0.0, "finite and above 0"),
            ExtrasRange::Bits => (
                |x| (1.0..=32.0).contains(&x) && (x - x.round()).abs() < f64::EPSILON,
                "a whole number from 1 to 32",
            ),
        };
        let values = self.each(key, stated, valid, wanted)?;
        robot.joints.iter_mut().zip(values).for_each(|(joint, value)| set(joint, value));
        Ok(())
    }

    fn set_joints(&self, robot: &mut Robot, file: &ExtrasFile) -> Result<()> {
        if let Some(rotor) = &file.rotor {
            self.set_rotor(robot, rotor)?;
        }
        if let Some(transmission) = &file.transmission {
            self.set_transmission(robot, transmission)?;
        }
        if let Some(friction) = &file.friction {
            self.set_friction(robot, friction)?;
        }
        if let Some(limits) = &file.limits {
            let (torque, rate) = (limits.torque_max_nm.as_ref(), &limits.torque_rate_max_nm_s);
            self.set(robot, "limits.torque_max_nm", torque, ExtrasRange::Positive, |joint, x| {
                joint.torque_max = Some(x);
            })?;
            let (speed, key) = (limits.velocity_max_rad_s.as_ref(), "limits.velocity_max_rad_s");
            self.set(robot, key, speed, ExtrasRange::Positive, |joint, x| {
                joint.velocity_max = Some(x);
            })?;
            let key = "limits.torque_rate_max_nm_s";
            self.set(robot, key, rate.as_ref(), ExtrasRange::Positive, |joint, x| {
                joint.torque_rate_max = Some(x);
            })?;
        }
        if let Some(drive) = &file.drive {
            let stated = Some(&drive.bandwidth_hz);
            self.set(robot, "drive.bandwidth_hz", stated, ExtrasRange::Positive, |joint, x| {
                joint.drive_bandwidth_hz = Some(x);
            })?;
        }
        if let Some(encoder) = &file.encoder {
            self.set(robot, "encoder.bits", Some(&encoder.bits), ExtrasRange::Bits, |joint, x| {
                joint.encoder_bits = (1..=32).find(|bits| f64::from(*bits) > x - 0.5);
            })?;
        }
        Ok(())
    }

    /// Rotor inertia: a value, an interval, or a value in an interval; alone, an interval is simulated in its geometric
    /// middle.
    fn set_rotor(&self, robot: &mut Robot, rotor: &RotorExtras) -> Result<()> {
        let named =
            ["rotor.armature_min_kg_m2", "rotor.armature_kg_m2", "rotor.armature_max_kg_m2"];
        let stated = rotor.armature_kg_m2.as_ref();
        self.set(robot, named[1], stated, ExtrasRange::NotNegative, |joint, x| joint.armature = x)?;
        let ends = (rotor.armature_min_kg_m2.as_ref(), rotor.armature_max_kg_m2.as_ref());
        let Some(ends) = self.ends(named, ends)? else {
            return match stated {
                Some(_) => Ok(()),
                None => Err(self.error(named[1], "it is missing, or its two ends".to_owned())),
            };
        };
        for (joint, (low, high)) in robot.joints.iter_mut().zip(ends) {
            let stated = stated.map(|_| joint.armature);
            joint.armature = self.inside(named, &joint.name, (low, stated, high))?;
            joint.armature_range = Some((low, high));
        }
        Ok(())
    }

    /// Intervals of stiffness and damping of each joint's transmission.
    fn set_transmission(&self, robot: &mut Robot, keys: &TransmissionExtras) -> Result<()> {
        let stiffness =
            ["transmission.stiffness_min_nm_rad", "", "transmission.stiffness_max_nm_rad"];
        let damping =
            ["transmission.damping_min_nm_s_rad", "", "transmission.damping_max_nm_s_rad"];
        let both =
            |named, low, high| Ok(self.ends(named, (Some(low), Some(high)))?.unwrap_or_default());
        let k = both(stiffness, &keys.stiffness_min_nm_rad, &keys.stiffness_max_nm_rad)?;
        let c = both(damping, &keys.damping_min_nm_s_rad, &keys.damping_max_nm_s_rad)?;
        for (joint, (stiff, damp)) in robot.joints.iter_mut().zip(k.into_iter().zip(c)) {
            if stiff.0 <= 0.0 {
                let why = format!("{} of joint \"{}\" must be above 0", stiff.0, joint.name);
                return Err(self.error(stiffness[0], why));
            }
            self.inside(stiffness, &joint.name, (stiff.0, None, stiff.1))?;
            self.inside(damping, &joint.name, (damp.0, None, damp.1))?;
            joint.spring = Some(JointSpring { stiffness: stiff, damping: damp });
        }
        Ok(())
    }

    /// Both ends of an interval per joint, in the robot's order, or none.
    fn ends(
        &self,
        [first, _, second]: [&str; 3],
        ends: (Option<&Each>, Option<&Each>),
    ) -> Result<Option<Vec<(f64, f64)>>> {
        let (low, high) = match ends {
            (None, None) => return Ok(None),
            (Some(low), Some(high)) => (low, high),
            (Some(_), None) => return Err(self.error(second, format!("it comes with {first}"))),
            (None, Some(_)) => return Err(self.error(first, format!("it comes with {second}"))),
        };
        let valid = |x: f64| x.is_finite() && x >= 0.0;
        let low = self.each(first, low, valid, "finite and at least 0")?;
        let high = self.each(second, high, valid, "finite and at least 0")?;
        Ok(Some(low.into_iter().zip(high).collect()))
    }

    /// A value inside its interval: the stated one, else the geometric middle.
    fn inside(
        &self,
        [first, key, second]: [&str; 3],
        joint: &str,
        (low, stated, high): (f64, Option<f64>, f64),
    ) -> Result<f64> {
        if low > high {
            let why = format!("{low} of joint \"{joint}\" is above {second} = {high}");
            return Err(self.error(first, why));
        }
        let value = stated.unwrap_or_else(|| (low * high).sqrt().clamp(low, high));
        if (low..=high).contains(&value) {
            return Ok(value);
        }
        let why = format!("{value} of joint \"{joint}\" must be from {low} to {high}");
        Err(self.error(key, why))
    }

    fn set_friction(&self, robot: &mut Robot, keys: &FrictionKeys) -> Result<()> {
        let viscous = keys.viscous_nm_s_rad.as_ref();
        self.set(
            robot,
            "friction.viscous_nm_s_rad",
            viscous,
            ExtrasRange::NotNegative,
            |joint, x| {
                joint.friction.viscous = x;
            },
        )?;
        let coulomb = keys.coulomb_nm.as_ref();
        self.set(robot, "friction.coulomb_nm", coulomb, ExtrasRange::NotNegative, |joint, x| {
            joint.friction.coulomb = x;
        })?;
        let ends = (keys.coulomb_min_nm.as_ref(), keys.coulomb_max_nm.as_ref());
        let named = ["friction.coulomb_min_nm", "friction.coulomb_nm", "friction.coulomb_max_nm"];
        if let Some(ends) = self.ends(named, ends)? {
            for (joint, (low, high)) in robot.joints.iter_mut().zip(ends) {
                let stated = coulomb.map(|_| joint.friction.coulomb);
                joint.friction.coulomb = self.inside(named, &joint.name, (low, stated, high))?;
                joint.friction.coulomb_range = Some((low, high));
            }
        }
        let sigmoid = [
            ("friction.sigmoid_amplitude_nm", &keys.sigmoid_amplitude_nm, ExtrasRange::NotNegative),
            (
                "friction.sigmoid_steepness_s_rad",
                &keys.sigmoid_steepness_s_rad,
                ExtrasRange::Positive,
            ),
            ("friction.sigmoid_offset_rad_s", &keys.sigmoid_offset_rad_s, ExtrasRange::Any),
        ];
        if sigmoid.iter().all(|(_, stated, _)| stated.is_none()) {
            return Ok(());
        }
        for (at, (key, stated, range)) in sigmoid.into_iter().enumerate() {
            let Some(stated) = stated else {
                return Err(self.error(key, "the three sigmoid keys come together".to_owned()));
            };
            self.set(robot, key, Some(stated), range, |joint, x| {
                set_sigmoid(&mut joint.friction, at, x);
            })?;
        }
        Ok(())
    }
}

/// Range of a value.
#[derive(Debug, Clone, Copy)]
enum ExtrasRange {
    Any,
    NotNegative,
    Positive,
    Bits,
}

fn set_sigmoid(friction: &mut Friction, at: usize, value: f64) {
    let none = Sigmoid { amplitude_nm: 0.0, steepness_s_rad: 0.0, offset_rad_s: 0.0 };
    let sigmoid = friction.sigmoid.get_or_insert(none);
    match at {
        0 => sigmoid.amplitude_nm = value,
        1 => sigmoid.steepness_s_rad = value,
        _ => sigmoid.offset_rad_s = value,
    }
}
