//! A robot: its model, and what a model leaves out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::Model;
use crate::error::RobotError;
use crate::joint::{Joint, JointKind, Rotor};
use crate::named_texts::NamedTexts;

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
    /// Source of the figures, in words.
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
    /// Joints of the description that move but are none of the arm's, and where they are held \[rad, m\].
    pub held: BTreeMap<String, f64>,
    /// Oddities of the description that do not prevent its use.
    pub warnings: Vec<String>,
    /// Files that it was read from, the one that was named first, those that are included last; none of
    /// an arm that comes with the crate.
    pub files: Vec<PathBuf>,
    /// Source of these files.
    pub(crate) source: NamedTexts,
}

impl Robot {
    /// Names of the joints, in order.
    #[must_use]
    pub fn joint_names(&self) -> Vec<String> {
        self.joints.iter().map(|joint| joint.name.clone()).collect()
    }

    /// File of its description, where it was read from that alone: no TOML file says what that leaves out.
    #[must_use]
    pub fn bare_file(&self) -> Option<&Path> {
        let first = self.files.first()?;
        self.toml_file().is_none().then_some(first)
    }

    /// TOML file that states what its description leaves out; `None` of a bare description and of a built-in arm.
    #[must_use]
    pub fn toml_file(&self) -> Option<&Path> {
        let mut files = self.files.iter().map(PathBuf::as_path);
        files.find(|path| path.extension().is_some_and(|extension| extension == "toml"))
    }

    /// Names of the joints that slide: their positions are in m, their torques forces in N.
    #[must_use]
    pub fn sliding(&self) -> Vec<String> {
        let slides = |joint: &&Joint| joint.kind == JointKind::Prismatic;
        self.joints.iter().filter(slides).map(|joint| joint.name.clone()).collect()
    }

    /// This robot with some joints fixed at a position \[rad, m\]; their rotors, limits and
    /// friction are gone with them.
    ///
    /// # Errors
    ///
    /// [`RobotError::Lock`] for a joint the robot does not have, a position outside its limits, or
    /// if no joint is left, or none that moves the tip.
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
            self.held.insert(name.clone(), *position);
            self.joints.remove(at);
            self.poses.values_mut().for_each(|pose| {
                pose.remove(at);
            });
        }
        self.model = Model::new(description).with_gravity(self.model.gravity());
        match joints.last() {
            Some((joint, _)) if !self.moves(&self.tip) => Err(RobotError::Lock {
                why: format!("no joint that is left moves the tip \"{}\"", self.tip),
                robot: self.name,
                joint: joint.clone(),
            }),
            _ => Ok(self),
        }
    }

    /// Returns true if a joint moves the frame of this name.
    pub(crate) fn moves(&self, frame: &str) -> bool {
        self.model.frame(frame).is_some_and(|frame| self.model.moves(frame))
    }

    /// Returns true if a rotor inertia is known by an interval alone.
    pub fn has_rotor_interval(&self) -> bool {
        self.joints.iter().any(|joint| joint.armature_range.is_some_and(|(low, high)| low < high))
    }

    /// This robot without its rotors: the links alone, as they hang on the springs of their joints.
    #[must_use]
    pub fn links_alone(mut self) -> Self {
        for joint in &mut self.joints {
            joint.armature = 0.0;
            joint.armature_range = None;
        }
        self
    }

    /// The model with the joints' rotor inertia: what a simulated plant is made of.
    ///
    /// # Panics
    ///
    /// If a joint's `armature` was set to what is none, negative or not finite: a model without its rotors would pass
    /// for the arm. Files cannot do that: reading refuses such a value.
    pub fn plant_model(&self) -> Model {
        self.plant_model_at(Rotor::Stated)
    }

    /// As [`plant_model`](Self::plant_model), with every rotor inertia at one place of its interval.
    ///
    /// # Panics
    ///
    /// As [`plant_model`](Self::plant_model).
    pub fn plant_model_at(&self, place: Rotor) -> Model {
        let armature: Vec<f64> = self.joints.iter().map(|joint| joint.armature_at(place)).collect();
        let model = self.model.clone().with_armature(&armature);
        model.unwrap_or_else(|error| unreachable!("{}: set by hand: {error}", self.name))
    }
}
