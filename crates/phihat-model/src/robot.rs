//! A robot: its model, and what a model leaves out.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::RobotError;
use crate::{Model, extras, input, urdf};

/// A robot as its files describe it.
///
/// # Example
///
/// ```
/// use phihat_model::Robot;
///
/// // One of the arms that come with the crate; `Robot::read` takes a file of yours.
/// let panda = Robot::named("panda")?;
/// assert_eq!(panda.joints.len(), 7);
/// let elbow = &panda.joints[3];
/// assert_eq!(elbow.torque_max, Some(87.0));
///
/// // From text: a pendulum of 2 kg on 0.4 m.
/// let urdf = r#"
///   <robot name="pendulum">
///     <link name="base"/>
///     <joint name="pivot" type="revolute">
///       <parent link="base"/> <child link="rod"/> <axis xyz="0 1 0"/>
///       <limit lower="-3" upper="3" effort="40" velocity="5"/>
///     </joint>
///     <link name="rod"><inertial>
///       <origin xyz="0 0 -0.4"/> <mass value="2"/>
///       <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>
///     </inertial></link>
///   </robot>"#;
/// let pendulum = Robot::from_text(urdf, None, "pendulum.urdf")?;
/// assert_eq!(pendulum.model.joint_names(), ["pivot"]);
/// # Ok::<(), phihat_model::RobotError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Robot {
    /// Name: short, as used in file names.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// Licence of the description.
    pub licence: String,
    /// Where the figures come from, in words.
    pub provenance: String,
    /// Source of each section of the TOML file, by the section's name.
    pub sources: BTreeMap<String, String>,
    /// Links and joints only: no rotor inertia. With it: [`plant_model`](Self::plant_model).
    pub model: Model,
    /// One entry per coordinate of `model`.
    pub joints: Vec<Joint>,
    /// Name of the frame that does the work; without a TOML file, the last that the last joint moves.
    pub tip: String,
    /// Name of the torque interface it has: see [`Profile`](crate::Profile).
    pub profile: String,
    /// Named postures \[rad, m for prismatic joints\].
    pub poses: BTreeMap<String, Vec<f64>>,
    /// What is odd about the description but does not prevent its use.
    pub warnings: Vec<String>,
    /// Files that it was read from, the one that was named first; none of an arm that comes with the crate.
    pub files: Vec<PathBuf>,
}

/// A joint that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name.
    pub name: String,
    /// What the joint lets its child do.
    pub kind: JointKind,
    /// Lower and upper end of travel \[rad, m\]; `None`: endless.
    pub position: Option<(f64, f64)>,
    /// Largest speed \[rad/s, m/s\].
    pub velocity_max: Option<f64>,
    /// Largest torque \[N·m, N\].
    pub torque_max: Option<f64>,
    /// Largest rate of torque \[N·m/s\].
    pub torque_rate_max: Option<f64>,
    /// Reflected rotor inertia \[kg·m²\].
    pub armature: f64,
    /// Friction between rotor and child.
    pub friction: Friction,
    /// Bandwidth of the drive's torque loop \[Hz\]; `None`: torque acts at once.
    pub drive_bandwidth_hz: Option<f64>,
    /// Encoder resolution \[bit\] over one turn; `None`: exact.
    pub encoder_bits: Option<u32>,
}

/// What a joint lets its child do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Turns between two ends.
    Revolute,
    /// Turns without end.
    Continuous,
    /// Slides between two ends.
    Prismatic,
}

/// Friction of one joint: `τ_f = viscous q̇ + coulomb sign(q̇) + sigmoid(q̇)`, against the motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction {
    /// Viscous part \[N·m·s/rad\].
    pub viscous: f64,
    /// Coulomb part \[N·m\].
    pub coulomb: f64,
    /// Identified smooth part.
    pub sigmoid: Option<Sigmoid>,
}

/// Smooth friction `A/(1 + e^{−s(q̇ + o)}) − A/(1 + e^{−s o})`.
///
/// # References
///
/// C. Gaz, M. Cognetti, A. Oliva, P. Robuffo Giordano, A. De Luca, IEEE RA-L 4(4), 2019.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sigmoid {
    /// `A` \[N·m\].
    pub amplitude_nm: f64,
    /// `s` \[s/rad\].
    pub steepness_s_rad: f64,
    /// `o` \[rad/s\].
    pub offset_rad_s: f64,
}

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

    /// This robot with some joints fixed at a position \[rad, m\]; their rotors, limits and
    /// friction are gone with them.
    ///
    /// # Errors
    ///
    /// [`RobotError::Lock`] for a joint the robot does not have, a position outside its limits, or
    /// if no joint is left.
    ///
    /// # Example
    ///
    /// ```
    /// use phihat_model::Robot;
    ///
    /// let panda = Robot::named("panda")?;
    /// let arm = panda.lock(&[("panda_joint3".to_owned(), 0.0)])?;
    /// assert_eq!(arm.joints.len(), 6);
    /// # Ok::<(), phihat_model::RobotError>(())
    /// ```
    pub fn lock(mut self, joints: &[(String, f64)]) -> Result<Self, RobotError> {
        let mut description = self.model.description().clone();
        for (name, position) in joints {
            let refuse =
                |why| RobotError::Lock { robot: self.name.clone(), joint: name.clone(), why };
            let Some(at) = self.joints.iter().position(|joint| joint.name == *name) else {
                let names: Vec<&str> = self.joints.iter().map(|j| j.name.as_str()).collect();
                return Err(refuse(format!("there is none; there are {}", names.join(", "))));
            };
            let (low, high) = self.joints[at].position.unwrap_or((f64::MIN, f64::MAX));
            if !(low..=high).contains(position) {
                return Err(refuse(format!("position {position} is outside [{low}, {high}]")));
            }
            if self.joints.len() == 1 {
                return Err(refuse("it is the last that moves".to_owned()));
            }
            description.fix(name, *position);
            self.joints.remove(at);
            self.poses.values_mut().for_each(|pose| {
                pose.remove(at);
            });
        }
        self.model = Model::new(description).with_gravity(self.model.gravity());
        Ok(self)
    }

    /// The model with the joints' rotor inertia: what a simulated plant is made of.
    pub fn plant_model(&self) -> Model {
        let armature: Vec<f64> = self.joints.iter().map(|joint| joint.armature).collect();
        // A robot's armature was checked when it was read; a changed one is checked here.
        self.model.clone().with_armature(&armature).unwrap_or_else(|_| self.model.clone())
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

impl Sigmoid {
    /// Friction torque \[N·m\] at speed `dq` \[rad/s\].
    pub fn torque(&self, dq: f64) -> f64 {
        let Self { amplitude_nm, steepness_s_rad, offset_rad_s } = *self;
        let logistic = |v: f64| amplitude_nm / (1.0 + libm::exp(-steepness_s_rad * v));
        logistic(dq + offset_rad_s) - logistic(offset_rad_s)
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

pub(crate) fn read_text(path: &Path) -> Result<String, RobotError> {
    let (origin, limit) = (path.display().to_string(), urdf::BYTES_MAX);
    input::text(path, limit as u64).map_err(|source| match source.kind() {
        ErrorKind::FileTooLarge => {
            RobotError::TooMuch { origin, what: "bytes", found: limit + 1, limit }
        }
        _ => RobotError::Read { origin, source },
    })
}
