//! Forward dynamics of many arms of one structure, one arm per lane, each with its own numbers.

pub(crate) mod part;
pub(crate) mod sweep;

use thiserror::Error;

use crate::description::JointMotion;
use crate::shape::SegmentShape;
use crate::straight::Kernel;
use crate::vector::Vec3;
use crate::{Lanes, Model};
use part::{LockstepSegment, in_lanes};

/// Most segments of a chain: joints, and what stands between two nearly parallel axes.
const MOST: usize = 12;

/// Up to [`Lanes::COUNT`] arms of one structure: chains of the same joints, each with numbers of its own
/// (lengths, masses, a payload, rotors, gravity).
///
/// # Law
///
/// That of [`Model::forward_dynamics`], arm by arm, in the same order of operations: every lane equals the
/// result of its own model to the last bit. There are two exceptions: a zero may have the other sign, and
/// where the model's result has an infinity or NaN, the lane's may have another one. Structure (a tilt of 0
/// or a quarter turn, a screw without length) is a branch that all lanes share, and costs no product.
///
/// # Real time
///
/// Neither allocates nor branches on values, but for angles of 1e5 rad and beyond.
///
/// # Example
///
/// ```
/// use phihat_model::{Body, Lanes, Lockstep, Robot, Scalar, Workspace};
///
/// let panda = Robot::named("panda")?;
/// let held = |mass: f64| {
///     let body = Body { mass, com: [0.0, 0.0, 0.05], inertia: [0.0; 6] };
///     panda.plant_model().with_payload_on("panda_link8", &body)
/// };
/// let models = [held(0.0)?, held(0.5)?, held(1.0)?];
/// let arms = Lockstep::new(&[&models[0], &models[1], &models[2]])?;
///
/// let q = panda.poses["ready"].iter().map(|q| Lanes::splat(*q)).collect::<Vec<_>>();
/// let (rest, mut ddq) = (vec![Lanes::splat(0.0); 7], vec![Lanes::splat(0.0); 7]);
/// arms.forward_dynamics(&q, &rest, &rest, &mut ddq);
///
/// // The arm in lane 2 falls as it does alone.
/// let (mut ws, mut alone) = (Workspace::new(&models[2]), [0.0; 7]);
/// let q = &panda.poses["ready"];
/// models[2].forward_dynamics(&mut ws, q, &[0.0; 7], &[0.0; 7], &mut alone);
/// assert!((0..7).all(|i| <[f64; 8]>::from(ddq[i])[2] == alone[i]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Lockstep {
    parts: Vec<LockstepSegment<Lanes>>,
    joints: usize,
    /// Code written out for their structure.
    kernel: Option<Kernel>,
    lift: Vec3<Lanes>,
}

/// Why arms cannot go in lockstep.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum LockstepError {
    /// No arm, or more than there are lanes.
    #[error("{0} arms; lanes hold from 1 to {most}", most = Lanes::COUNT)]
    Arms(usize),
    /// An arm with a fork.
    #[error("arm {0} is no chain: some link bears two joints")]
    Fork(usize),
    /// An arm of another structure than the first one.
    #[error("arm {0} has other joints than the first one")]
    Structure(usize),
    /// An arm without a joint, or with too many.
    #[error("{0} segments; a chain in lanes has from 1 to {MOST}")]
    Segments(usize),
}

impl Lockstep {
    /// Puts arms side by side; lanes beyond them repeat the last one.
    ///
    /// # Errors
    ///
    /// [`LockstepError`]: none or too many, not chains, or not of one structure.
    pub fn new(models: &[&Model]) -> Result<Self, LockstepError> {
        let first = match models {
            [first, ..] if models.len() <= Lanes::COUNT => first.segments(),
            _ => return Err(LockstepError::Arms(models.len())),
        };
        if first.is_empty() || first.len() > MOST {
            return Err(LockstepError::Segments(first.len()));
        }
        for (k, model) in models.iter().enumerate() {
            let own = model.segments();
            let chain = |(i, s): (usize, &crate::segment::Segment)| match i {
                0 => s.parent.is_none(),
                _ => s.follows_parent(i),
            };
            if !own.iter().enumerate().all(chain) {
                return Err(LockstepError::Fork(k));
            }
            let alike = own.iter().zip(first).all(|(a, b)| a.motion == b.motion);
            if own.len() != first.len() || !alike {
                return Err(LockstepError::Structure(k));
            }
        }
        let lift = |axis: usize| in_lanes(models, |model| model.lift()[axis]);
        let parts: Vec<_> =
            (0..first.len()).filter_map(|i| LockstepSegment::of(models, i)).collect();
        let plain = first.iter().all(|segment| segment.motion == JointMotion::Revolute);
        let shapes: Vec<SegmentShape> = parts.iter().map(|part| part.shape).collect();
        Ok(Self {
            parts,
            joints: first.iter().filter(|segment| segment.motion != JointMotion::Fixed).count(),
            kernel: if plain { Kernel::of(&shapes) } else { None },
            lift: Vec3::new(lift(0), lift(1), lift(2)),
        })
    }

    /// Number of coordinates `n` of every arm.
    pub fn joint_count(&self) -> usize {
        self.joints
    }

    /// Gives the accelerations that `tau` causes, as [`Model::forward_dynamics`] does.
    ///
    /// # Panics
    ///
    /// If a slice is not of length [`joint_count`](Self::joint_count).
    pub fn forward_dynamics(&self, q: &[Lanes], dq: &[Lanes], tau: &[Lanes], ddq: &mut [Lanes]) {
        let n = self.joints;
        let fits = [q.len(), dq.len(), tau.len(), ddq.len()] == [n; 4];
        assert!(fits, "one position, velocity, torque and acceleration per joint");
        let state = [q, dq, tau];
        let arms = (&self.parts[..], self.lift);
        // Code that is written out for eight lanes is large, and a browser's module has few of these runs.
        let written_out = !cfg!(target_arch = "wasm32");
        let kernel = self.kernel.filter(|_| written_out);
        if kernel.is_none_or(|kernel| !kernel.beside(arms, state, ddq)) {
            self.any_chain(state, ddq);
        }
    }

    #[inline(never)]
    fn any_chain(&self, state: [&[Lanes]; 3], ddq: &mut [Lanes]) {
        sweep::forward::<Lanes, MOST>((&self.parts, self.lift), state, ddq);
    }
}
