//! Outline of a description: every link, its attachment to its parent, and its body.

use crate::Model;
use crate::body::Body;
use crate::description::{DescribedLink, JointMotion};
use crate::kinematics::Pose;
use crate::placement::{Matrix3, dot};

/// One link of a description, as [`Model::outline`] lists them.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Its name.
    pub name: String,
    /// The link that it hangs on, by its place in the list, which is before its own; `None`: the root.
    pub parent: Option<usize>,
    /// The coordinate that moves it against its parent; `None`: it is fixed to it.
    pub joint: Option<usize>,
    /// True if that coordinate slides \[m\]; else it turns \[rad\].
    pub slides: bool,
    /// Its pose in its parent at position 0.
    pub pose: Pose,
    /// The joint's axis, a unit vector in the link's own axes.
    pub axis: [f64; 3],
    /// Its body, a payload welded to it among it.
    pub body: Body,
}

impl Model {
    /// Every link, each after its parent, with what is needed to draw it at any position.
    ///
    /// # Example
    ///
    /// ```
    /// let robot = phihat_model::Robot::named("planar3r")?;
    /// let links = robot.model.outline();
    /// assert_eq!(links.iter().filter(|link| link.joint.is_some()).count(), 3);
    /// # Ok::<(), phihat_model::RobotError>(())
    /// ```
    pub fn outline(&self) -> Vec<Outline> {
        let mut joints = 0;
        let links = self.description().links.iter();
        links.map(|link| outline(link, &mut joints)).collect()
    }
}

fn outline(link: &DescribedLink, joints: &mut usize) -> Outline {
    let own = link.joint.as_ref();
    let moving = own.filter(|joint| joint.motion != JointMotion::Fixed);
    let joint = moving.map(|_| *joints);
    *joints += usize::from(moving.is_some());
    let at = own.map_or(crate::placement::Placement::IDENTITY, |joint| joint.placement);
    let m = link.matter.m;
    let com = if m > 0.0 { link.matter.h.map(|h| h / m) } else { [0.0; 3] };
    Outline {
        name: link.name.clone(),
        parent: own.map(|joint| joint.parent),
        joint,
        slides: moving.is_some_and(|joint| joint.motion == JointMotion::Prismatic),
        pose: Pose { p: at.p, r: at.r },
        axis: own.map_or([0.0, 0.0, 1.0], |joint| joint.axis),
        body: Body { mass: m, com, inertia: about(com, m, &link.matter.i) },
    }
}

/// The inertia about the centre of mass, of one about the origin.
fn about(com: [f64; 3], m: f64, i: &Matrix3) -> [f64; 6] {
    let square = dot(com, com);
    let entry =
        |a: usize, b: usize| i[a][b] - m * (if a == b { square } else { 0.0 } - com[a] * com[b]);
    [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)]
}
