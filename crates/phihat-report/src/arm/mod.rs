//! The arm of a run: what is needed to draw it at any moment.

mod camera;
mod kinematics;
mod picture;
mod surface;

use serde::Serialize;

pub(crate) use picture::{animation, poster};
pub use surface::Surface;

/// The arm, and what acts on it from outside: plain data.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct DrawnArm {
    /// Every link, each after its parent.
    pub links: Vec<ArmLink>,
    /// Gravity \[m/s²\], base axes.
    pub gravity: [f64; 3],
    /// The link that does the work.
    pub tip: usize,
    /// Bodies that it carries.
    pub payloads: Vec<DrawnLoad>,
    /// External torques on single joints.
    pub torques: Vec<JointTorque>,
    /// External forces.
    pub forces: Vec<PointForce>,
    /// Planes that it can touch.
    pub walls: Vec<Plane>,
    /// Shapes of its links; where there is none, they are drawn from their masses.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shapes: Vec<Surface>,
    /// In words: what is drawn of its description's shapes, and what is not, and why.
    #[serde(skip)]
    pub looks: String,
}

/// A link and how it hangs on its parent.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArmLink {
    /// Its name; no page needs it.
    #[serde(skip)]
    pub name: String,
    /// The link that it hangs on; `None`: the root.
    pub parent: Option<usize>,
    /// The joint that moves it; `None`: it is fixed to its parent.
    pub joint: Option<usize>,
    /// True if that joint is prismatic.
    pub slides: bool,
    /// Origin in its parent at position 0 \[m\].
    pub p: [f64; 3],
    /// Rotation in its parent at position 0, row by row.
    pub r: [[f64; 3]; 3],
    /// The joint's axis, in the link's own axes.
    pub axis: [f64; 3],
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\].
    pub com: [f64; 3],
}

/// A body on a link, from `start` to `end` \[s\].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DrawnLoad {
    /// The link.
    pub link: usize,
    /// Mass \[kg\].
    pub mass: f64,
    /// Centre of mass in the link \[m\].
    pub com: [f64; 3],
    /// When it is picked up \[s\].
    pub start: f64,
    /// When it is dropped \[s\]; infinite: never.
    pub end: f64,
}

/// An external torque on a joint, from `start` to `end` \[s\].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointTorque {
    /// The joint.
    pub joint: usize,
    /// Torque \[N·m, N\].
    pub torque: f64,
    /// Start \[s\].
    pub start: f64,
    /// End \[s\].
    pub end: f64,
}

/// An external force at a link's origin, from `start` to `end` \[s\].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PointForce {
    /// The link.
    pub link: usize,
    /// Force \[N\], base axes.
    pub force: [f64; 3],
    /// Start \[s\].
    pub start: f64,
    /// End \[s\].
    pub end: f64,
}

/// A stiff plane that one link can touch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plane {
    /// The link.
    pub link: usize,
    /// A point of it \[m\], base axes.
    pub point: [f64; 3],
    /// The unit normal, to where the arm is.
    pub normal: [f64; 3],
}
