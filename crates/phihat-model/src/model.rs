//! The constant part: a tree of rigid bodies, ready for the recursions.

use crate::body::Body;
use crate::compile::{Compiled, compile};
use crate::description::Description;
use crate::error::ModelError;
use crate::placement::{Placement, apply, transpose};
use crate::segment::Segment;

/// Gravity unless the model is told otherwise \[m/s²\], world axes.
pub const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];

/// Rigid-body model of a robot: constant, shareable, and the first argument of all dynamics.
///
/// Fixed joints are merged: a coordinate is a joint that moves. All functions take slices in the
/// order of [`joint_names`](Self::joint_names); a [`Workspace`](crate::Workspace) holds what they
/// compute on the way.
///
/// # Law
///
/// ```text
/// M(q) q̈ + C(q, q̇) q̇ + g(q) = τ                                                   (1)
/// ```
///
/// symbol | code | unit | meaning
/// ---|---|---|---
/// `q, q̇, q̈` | `q, dq, ddq` | rad, rad/s, rad/s² (m for prismatic joints) | joint motion
/// `τ` | `tau` | N·m (N) | torque on the joint's child, positive along the joint's axis
///
/// # Real time
///
/// The dynamics neither allocate nor branch on values, but for angles beyond 1e5 rad, whose sine
/// takes longer; else their cost depends on the robot only. NaN
/// goes in, NaN comes out.
///
/// # Panics
///
/// Every function of the dynamics panics if a slice's length is not what its text says, or if the
/// workspace or the frame was made for another model: these are mistakes of the program, not of
/// its data.
///
/// # Example
///
/// ```
/// use phihat_model::{Robot, Workspace};
///
/// let robot = Robot::named("planar3r")?;
/// let model = robot.plant_model(); // with the rotors' inertia
/// let mut ws = Workspace::new(&model);
/// let (q, dq, ddq) = ([0.4, 1.2, 0.6], [0.1, -0.2, 0.3], [1.0_f64, 2.0, -1.0]);
///
/// // Torques for a motion, and the motion for these torques: the same motion.
/// let (mut tau, mut again) = ([0.0; 3], [0.0; 3]);
/// model.inverse_dynamics(&mut ws, &q, &dq, &ddq, &mut tau);
/// model.forward_dynamics(&mut ws, &q, &dq, &tau, &mut again);
/// assert!(ddq.iter().zip(again).all(|(a, b)| (a - b).abs() < 1e-12));
/// # Ok::<(), phihat_model::RobotError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    description: Description,
    compiled: Compiled,
    gravity: [f64; 3],
    armature: Vec<f64>,
    joint_names: Vec<String>,
    frame_names: Vec<String>,
}

/// A frame of one model: a link of its description.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FrameId(pub(crate) usize);

impl Model {
    pub(crate) fn new(description: Description) -> Self {
        let compiled = compile(&description);
        let joint_names: Vec<String> = description.moving().map(|(_, j)| j.name.clone()).collect();
        let frame_names = description.links.iter().map(|link| link.name.clone()).collect();
        let armature = vec![0.0; joint_names.len()];
        Self { description, compiled, gravity: GRAVITY, armature, joint_names, frame_names }
    }

    /// Number of coordinates `n`.
    pub fn joint_count(&self) -> usize {
        self.joint_names.len()
    }

    /// Names of the joints that move, in coordinate order: depth first, as the description lists
    /// them.
    pub fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    /// Coordinate of the joint called `name`.
    pub fn joint_index(&self, name: &str) -> Option<usize> {
        self.joint_names.iter().position(|n| n == name)
    }

    /// Names of all frames: every link of the description, also those behind fixed joints.
    pub fn frame_names(&self) -> &[String] {
        &self.frame_names
    }

    /// The frame of the link called `name`.
    pub fn frame(&self, name: &str) -> Option<FrameId> {
        self.frame_names.iter().position(|n| n == name).map(FrameId)
    }

    /// The frame that joint `joint` moves: its child link's.
    pub fn frame_of_joint(&self, joint: usize) -> Option<FrameId> {
        self.compiled.link_of_joint.get(joint).copied().map(FrameId)
    }

    /// Returns true if any joint moves the frame; false if the frame is fixed to the base.
    pub fn moves(&self, frame: FrameId) -> bool {
        self.compiled.seats[frame.0].segment.is_some()
    }

    /// Gravity \[m/s²\] in world axes.
    pub fn gravity(&self) -> [f64; 3] {
        self.gravity
    }

    /// This robot under another gravity \[m/s²\], world axes: a robot on a wall, or on the moon.
    #[must_use]
    pub fn with_gravity(mut self, gravity: [f64; 3]) -> Self {
        self.gravity = gravity;
        self
    }

    /// Reflected rotor inertia \[kg·m²\] per joint; 0 unless set.
    pub fn armature(&self) -> &[f64] {
        &self.armature
    }

    /// This robot with reflected rotor inertia \[kg·m²\] added to the diagonal of `M`.
    ///
    /// # Errors
    ///
    /// [`ModelError::Armature`] if there is not one finite value ≥ 0 per joint.
    pub fn with_armature(mut self, armature: &[f64]) -> Result<Self, ModelError> {
        let valid = armature.iter().all(|x| x.is_finite() && *x >= 0.0);
        if armature.len() != self.joint_count() || !valid {
            let (given, joints) = (armature.to_vec(), self.joint_count());
            return Err(ModelError::Armature { given, joints });
        }
        self.armature.copy_from_slice(armature);
        Ok(self)
    }

    /// This robot with links `factor` times as heavy: mass and inertia of every link, not the rotors.
    ///
    /// # Errors
    ///
    /// [`ModelError::MassFactor`] if the factor is not above 0 and finite.
    pub fn with_masses_times(mut self, factor: f64) -> Result<Self, ModelError> {
        if !(factor.is_finite() && factor > 0.0) {
            return Err(ModelError::MassFactor(factor));
        }
        for link in &mut self.description.links {
            link.matter = link.matter.times(factor);
        }
        self.compiled = compile(&self.description);
        Ok(self)
    }

    /// This robot with `body`, given in the frame's axes, welded to `frame`.
    ///
    /// # Errors
    ///
    /// [`ModelError::Payload`] if no rigid body is like that.
    pub fn with_payload(mut self, frame: FrameId, body: &Body) -> Result<Self, ModelError> {
        let name = &self.frame_names[frame.0];
        let refuse = |why| ModelError::Payload { frame: name.clone(), why };
        body.check().map_err(refuse)?;
        let link = &mut self.description.links[frame.0];
        link.matter = link.matter.plus(&body.lumped());
        self.compiled = compile(&self.description);
        Ok(self)
    }

    /// This robot with `body` welded to the frame of this name: [`with_payload`](Self::with_payload) by name.
    ///
    /// # Errors
    ///
    /// [`ModelError::PayloadFrame`] if there is no such frame, [`ModelError::Payload`] if no rigid body is like that.
    pub fn with_payload_on(self, frame: &str, body: &Body) -> Result<Self, ModelError> {
        let seat = self.frame(frame).ok_or_else(|| ModelError::PayloadFrame(frame.to_owned()))?;
        self.with_payload(seat, body)
    }

    /// The ten dynamic parameters of each joint's body, fixed links merged, in the axes of the
    /// joint's child link: `m, m·cx, m·cy, m·cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz`, the inertia about
    /// the link's origin.
    ///
    /// `τ = Y(q, q̇, q̈) π` with [`regressor`](Self::regressor) as `Y` and these, joint after joint,
    /// as `π`.
    pub fn dynamic_parameters(&self) -> Vec<[f64; 10]> {
        self.compiled.lumped.iter().map(crate::body::LumpedBody::parameters).collect()
    }

    pub(crate) fn description(&self) -> &Description {
        &self.description
    }

    pub(crate) fn compiled(&self) -> &Compiled {
        &self.compiled
    }

    pub(crate) fn segments(&self) -> &[Segment] {
        &self.compiled.segments
    }

    pub(crate) fn base(&self) -> &Placement {
        &self.compiled.base
    }

    /// Acceleration of the base that acts like gravity: `−g` in base axes.
    pub(crate) fn lift(&self) -> [f64; 3] {
        apply(&transpose(&self.compiled.base.r), self.gravity).map(|x| -x)
    }
}
