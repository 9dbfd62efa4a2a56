//! Scratch memory of the dynamics, allocated once.

use crate::columns::{Columns, LANES};
use crate::compile::Compiled;
use crate::description::JointMotion;
use crate::inertia::LinkInertia;
use crate::segment::Segment;
use crate::vector::{Turn, Vec3};
use crate::{Model, Scalar};

/// Preallocated scratch of one [`Model`], one per thread.
///
/// Nothing in it outlives a call, but for the poses that
/// [`forward_kinematics`](Model::forward_kinematics) leaves for [`pose`](Model::pose).
///
/// # Example
///
/// ```
/// use phihat_model::{Robot, Workspace};
///
/// let robot = Robot::named("ur5")?;
/// let mut ws = Workspace::new(&robot.model); // before the loop: nothing is allocated in it
/// let mut m = [0.0; 36];
/// for k in 0..100 {
///     let q = [0.01 * f64::from(k); 6];
///     robot.model.mass_matrix(&mut ws, &q, &mut m);
///     assert!(m[0] > 0.0 && (m[1] - m[6]).abs() < 1e-12); // symmetric
/// }
/// # Ok::<(), phihat_model::RobotError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Workspace<S: Scalar = f64> {
    pub(crate) screws: Screws<S>,
    pub(crate) nodes: Vec<WorkspaceNode<S>>,
    /// One lane per coordinate and one more.
    pub(crate) columns: Vec<Columns<S>>,
    /// `n` rows, each as many lanes.
    pub(crate) rows: Vec<[S; LANES]>,
}

/// Every segment's second screw, `Rz Tz(d)`, at the position of the moment.
#[derive(Debug, Clone)]
pub(crate) struct Screws<S> {
    angles: Vec<S>,
    sines: Vec<S>,
    cosines: Vec<S>,
    /// `d` of the prismatic ones.
    shifts: Vec<S>,
}

/// Intermediate results of the recursions per segment.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct WorkspaceNode<S> {
    pub(crate) motion: Spin<S>,
    pub(crate) force: Vec3<S>,
    pub(crate) moment: Vec3<S>,
    pub(crate) pose: Pose3<S>,
    /// Composite inertia of later branches, stored until their parent's turn comes.
    pub(crate) inertia: LinkInertia<S>,
}

/// Angular velocity, angular acceleration and linear acceleration of a frame, in its axes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Spin<S> {
    pub(crate) omega: Vec3<S>,
    pub(crate) alpha: Vec3<S>,
    pub(crate) acc: Vec3<S>,
}

/// Axes of a frame and its origin, in base axes.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Pose3<S> {
    pub(crate) x: Vec3<S>,
    pub(crate) y: Vec3<S>,
    pub(crate) z: Vec3<S>,
    pub(crate) p: Vec3<S>,
}

impl<S: Scalar> Workspace<S> {
    /// Scratch for `model`.
    pub fn new(model: &Model) -> Self {
        let zeros = || vec![S::splat(0.0); model.compiled().theta.len()];
        let screws = Screws { angles: zeros(), sines: zeros(), cosines: zeros(), shifts: zeros() };
        let n = model.joint_count();
        let chunks = (n + 1).div_ceil(LANES);
        Self {
            screws,
            nodes: vec![WorkspaceNode::default(); model.segments().len()],
            columns: vec![Columns::default(); chunks],
            rows: vec![[S::splat(0.0); LANES]; n * chunks],
        }
    }
}

impl<S: Scalar> Screws<S> {
    /// The screw of `segment`, which is number `i`.
    #[inline(always)]
    pub(crate) fn at(&self, i: usize, segment: &Segment) -> (Turn<S>, S) {
        let d = match segment.motion {
            JointMotion::Prismatic => self.shifts[i],
            _ => S::splat(segment.d),
        };
        (Turn { c: self.cosines[i], s: self.sines[i] }, d)
    }

    /// Returns true if this is scratch of `model`.
    #[inline(always)]
    pub(crate) fn fits(&self, model: &Model) -> bool {
        self.angles.len() == model.compiled().theta.len()
    }

    /// Fills in the screws of `model` at `q`.
    #[inline(always)]
    pub(crate) fn place(&mut self, model: &Model, q: &[S]) {
        let Compiled { theta, plain, segments, .. } = model.compiled();
        let angles = &mut self.angles[..];
        assert!(q.len() == model.joint_count(), "one position per joint");
        assert!(angles.len() == theta.len(), "a workspace of this model");
        if *plain {
            let ((angles, _), (theta, _)) =
                (angles.as_chunks_mut::<LANES>(), theta.as_chunks::<LANES>());
            let (whole, rest) = q.as_chunks::<LANES>();
            for ((angles, theta), q) in angles.iter_mut().zip(theta).zip(whole) {
                *angles = core::array::from_fn(|k| q[k] + S::splat(theta[k]));
            }
            let last = whole.len();
            if let (Some(angles), Some(theta)) = (angles.get_mut(last), theta.get(last)) {
                for ((angle, theta), q) in angles.iter_mut().zip(theta).zip(rest) {
                    *angle = *q + S::splat(*theta);
                }
            }
        } else {
            for (i, segment) in segments.iter().enumerate() {
                angles[i] = S::splat(theta[i]);
                match segment.motion {
                    JointMotion::Revolute => angles[i] += q[segment.joint],
                    JointMotion::Prismatic => {
                        self.shifts[i] = q[segment.joint] + S::splat(segment.d);
                    }
                    JointMotion::Fixed => {}
                }
            }
        }
        S::sin_cos_each(angles, &mut self.sines, &mut self.cosines);
    }
}
