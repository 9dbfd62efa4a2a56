//! Joint positions that bring a frame to a target.

use thiserror::Error;

use crate::model::FrameId;
use crate::placement::{IDENTITY, Matrix3, add, dot, mul, normalised, transpose};
use crate::{Model, Workspace};

/// Target of a frame, in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PoseTarget {
    /// Origin \[m\] only; orientation as it comes.
    Position([f64; 3]),
    /// Origin and orientation.
    Pose(crate::Pose),
}

/// Options of inverse kinematics.
#[derive(Debug, Clone, PartialEq)]
pub struct IkOptions {
    /// Lower and upper limit \[rad, m\] per joint; empty: none.
    pub limits: Vec<(f64, f64)>,
    /// Largest error of position \[m\] and of orientation \[rad\] that counts as reached.
    pub tolerance: f64,
    /// Steps per start.
    pub steps_max: usize,
    /// Starts from other postures if the seed does not lead there.
    pub restarts: usize,
}

impl Default for IkOptions {
    fn default() -> Self {
        Self { limits: Vec::new(), tolerance: 1e-9, steps_max: 200, restarts: 16 }
    }
}

/// Why no joint positions were found.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum IkError {
    /// The best posture found misses the target: perhaps out of reach.
    #[error(
        "target not reached: the nearest posture found misses it by {position} m and {rotation} rad"
    )]
    NotReached {
        /// Remaining error of the position \[m\].
        position: f64,
        /// Remaining error of the orientation \[rad\]; 0 if only a position was requested.
        rotation: f64,
        /// The posture that comes nearest.
        nearest: Vec<f64>,
    },
    /// The seed or the limits have not one finite entry per joint, or a lower limit is above an
    /// upper.
    #[error("seed and limits must be finite and ordered, {joints} entries each")]
    Shape {
        /// Number of joints.
        joints: usize,
    },
}

/// Smallest and largest damping, relative to the largest diagonal entry of `JᵀJ`.
const DAMPING: (f64, f64) = (1e-12, 1e6);

impl Model {
    /// Finds joint positions that bring `frame` to `target`, near `seed` if possible.
    ///
    /// # Method
    ///
    /// Levenberg–Marquardt on the error `e` of position and orientation (as a rotation vector):
    ///
    /// ```text
    /// (JᵀJ + μ 1) Δq = Jᵀ e                                                           (1)
    /// ```
    ///
    /// `μ` falls after a step that helps and rises after one that does not. A joint at a limit that
    /// would be pushed through it sits the step out. From where that ends short of the target, it
    /// starts again from other postures inside the limits, in an order fixed once and for all: the
    /// same call gives the same answer, bit for bit.
    ///
    /// # Not claimed
    ///
    /// That [`IkError::NotReached`] proves the target out of reach.
    ///
    /// # Errors
    ///
    /// [`IkError`], with what is left of the error.
    ///
    /// # References
    ///
    /// T. Sugihara, "Solvability-unconcerned inverse kinematics by the Levenberg–Marquardt method",
    /// IEEE Trans. Robotics 27(5), 2011.
    ///
    /// # Example
    ///
    /// ```
    /// use phihat_model::{IkOptions, Robot, PoseTarget, Workspace};
    ///
    /// let arm = Robot::named("planar3r")?;
    /// let tip = arm.model.frame(&arm.tip).ok_or("no such frame")?;
    /// let mut ws = Workspace::new(&arm.model);
    /// let target = PoseTarget::Position([0.25, 0.0, 0.35]);
    /// let seed = &arm.poses["ready"];
    /// let q = arm.model.inverse_kinematics(&mut ws, tip, &target, seed, &IkOptions::default())?;
    /// arm.model.forward_kinematics(&mut ws, &q);
    /// let [x, _, z] = arm.model.pose(&ws, tip).p;
    /// assert!((x - 0.25).abs() < 1e-8 && (z - 0.35).abs() < 1e-8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse_kinematics(
        &self,
        ws: &mut Workspace<f64>,
        frame: FrameId,
        target: &PoseTarget,
        seed: &[f64],
        options: &IkOptions,
    ) -> Result<Vec<f64>, IkError> {
        let n = self.joint_count();
        let shape = seed.len() == n
            && seed.iter().all(|x| x.is_finite())
            && (options.limits.is_empty() || options.limits.len() == n)
            && options.limits.iter().all(|(low, high)| low <= high);
        if !shape {
            return Err(IkError::Shape { joints: n });
        }
        let mut search = PoseSearch::new(self, ws, frame, *target, options);
        let mut best: Option<(f64, Vec<f64>)> = None;
        for start in 0..=options.restarts {
            let from = if start == 0 { seed.to_vec() } else { search.start(start) };
            let (cost, q) = search.descend(from);
            if search.reached(&q) {
                return Ok(q);
            }
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, q));
            }
        }
        let nearest = best.map_or_else(|| seed.to_vec(), |(_, q)| q);
        let (position, rotation) = norms(search.error(&nearest));
        Err(IkError::NotReached { position, rotation, nearest })
    }
}

/// One call's problem and scratch.
struct PoseSearch<'a> {
    model: &'a Model,
    ws: &'a mut Workspace<f64>,
    frame: FrameId,
    target: PoseTarget,
    options: &'a IkOptions,
    jacobian: Vec<f64>,
    normal: Vec<f64>,
}

impl<'a> PoseSearch<'a> {
    fn new(
        model: &'a Model,
        ws: &'a mut Workspace<f64>,
        frame: FrameId,
        target: PoseTarget,
        options: &'a IkOptions,
    ) -> Self {
        let n = model.joint_count();
        let (jacobian, normal) = (vec![0.0; 6 * n], vec![0.0; n * n]);
        Self { model, ws, frame, target, options, jacobian, normal }
    }

    /// Start number `k`: additive recurrences with irrational steps cover the box evenly.
    fn start(&self, k: usize) -> Vec<f64> {
        let half_turn = (-core::f64::consts::PI, core::f64::consts::PI);
        let within = |joint: usize| {
            let (low, high) = self.options.limits.get(joint).copied().unwrap_or(half_turn);
            let step = (joint as f64 + 2.0).sqrt() * 0.618_033_988_749_894_9;
            let fraction = (0.5 + k as f64 * step).fract();
            low + fraction * (high - low)
        };
        (0..self.model.joint_count()).map(within).collect()
    }

    fn clamp(&self, joint: usize, position: f64) -> f64 {
        match self.options.limits.get(joint) {
            Some((low, high)) => position.clamp(*low, *high),
            None => position,
        }
    }

    /// Error of the frame at `q`: three of position, three of rotation, world axes.
    fn error(&mut self, q: &[f64]) -> [f64; 6] {
        self.model.forward_kinematics(self.ws, q);
        let pose = self.model.pose(self.ws, self.frame);
        let (p, rotation) = match self.target {
            PoseTarget::Position(p) => (p, [0.0; 3]),
            PoseTarget::Pose(wanted) => (wanted.p, rotation_between(&pose.r, &wanted.r)),
        };
        let [x, y, z] = core::array::from_fn(|k| p[k] - pose.p[k]);
        [x, y, z, rotation[0], rotation[1], rotation[2]]
    }

    fn reached(&mut self, q: &[f64]) -> bool {
        let (position, rotation) = norms(self.error(q));
        position <= self.options.tolerance && rotation <= self.options.tolerance
    }

    /// Descends from `q`; gives the cost `|e|²` and the posture it ends at.
    fn descend(&mut self, mut q: Vec<f64>) -> (f64, Vec<f64>) {
        for joint in 0..q.len() {
            q[joint] = self.clamp(joint, q[joint]);
        }
        let mut error = self.error(&q);
        let (mut cost, mut damping) = (square(&error), 1e-3);
        for _ in 0..self.options.steps_max {
            let (position, rotation) = norms(error);
            // Ten times closer than asked: the last step is quadratic and costs little.
            if position.max(rotation) <= 0.1 * self.options.tolerance || damping > DAMPING.1 {
                break;
            }
            let step = self.step(&q, &error, damping);
            let moved: Vec<f64> =
                (0..q.len()).map(|joint| self.clamp(joint, q[joint] + step[joint])).collect();
            let error_there = self.error(&moved);
            let cost_there = square(&error_there);
            if cost_there < cost {
                (q, error, cost) = (moved, error_there, cost_there);
                damping = (damping * 0.2).max(DAMPING.0);
            } else {
                damping *= 5.0;
            }
        }
        (cost, q)
    }

    /// Solves (1) for the joints that may move.
    fn step(&mut self, q: &[f64], error: &[f64; 6], damping: f64) -> Vec<f64> {
        let n = q.len();
        self.model.jacobian(self.ws, q, self.frame, &mut self.jacobian);
        if matches!(self.target, PoseTarget::Position(_)) {
            self.jacobian[3 * n..].fill(0.0);
        }
        let column = |j: &[f64], joint: usize| -> [f64; 6] {
            core::array::from_fn(|row| j[row * n + joint])
        };
        let product = |a: &[f64; 6], b: &[f64; 6]| (0..6).map(|k| a[k] * b[k]).sum::<f64>();
        let mut slope: Vec<f64> =
            (0..n).map(|joint| product(&column(&self.jacobian, joint), error)).collect();
        for joint in 0..n {
            let stuck = self.options.limits.get(joint).is_some_and(|(low, high)| {
                (q[joint] <= *low && slope[joint] < 0.0)
                    || (q[joint] >= *high && slope[joint] > 0.0)
            });
            if stuck {
                slope[joint] = 0.0;
                self.jacobian[joint..].iter_mut().step_by(n).for_each(|entry| *entry = 0.0);
            }
        }
        let mut largest = f64::MIN_POSITIVE;
        for i in 0..n {
            for j in 0..n {
                let entry = product(&column(&self.jacobian, i), &column(&self.jacobian, j));
                self.normal[i * n + j] = entry;
                largest = if i == j { largest.max(entry) } else { largest };
            }
        }
        for i in 0..n {
            self.normal[i * n + i] += damping * largest;
        }
        solve(&mut self.normal, &mut slope);
        slope
    }
}

/// Solves `A x = b` for positive definite `A`, row by row; leaves `x` in `b`.
fn solve(a: &mut [f64], b: &mut [f64]) {
    let n = b.len();
    for k in 0..n {
        for i in k + 1..n {
            let factor = a[i * n + k] / a[k * n + k];
            for j in k..n {
                a[i * n + j] -= factor * a[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k * n + j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k * n + k];
    }
}

/// The rotation vector, in world axes, that takes orientation `from` to `to`.
fn rotation_between(from: &Matrix3, to: &Matrix3) -> [f64; 3] {
    let r = mul(to, &transpose(from));
    let axis = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]].map(|x| 0.5 * x);
    let (sine, cosine) = (dot(axis, axis).sqrt(), 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1.0));
    let angle = libm::atan2(sine, cosine);
    if sine > 1e-6 {
        return axis.map(|x| x * angle / sine);
    }
    if cosine > 0.0 {
        return axis;
    }
    // Half a turn: r + 1 = 2 a aᵀ, so its longest row is along the axis.
    let rows: [[f64; 3]; 3] = core::array::from_fn(|i| add(r[i], IDENTITY[i]));
    let longest = (0..3).max_by(|&i, &j| dot(rows[i], rows[i]).total_cmp(&dot(rows[j], rows[j])));
    let along = longest.and_then(|i| normalised(rows[i])).unwrap_or(IDENTITY[0]);
    along.map(|x| x * angle)
}

fn square(error: &[f64; 6]) -> f64 {
    error.iter().map(|x| x * x).sum()
}

fn norms(error: [f64; 6]) -> (f64, f64) {
    let [x, y, z, u, v, w] = error;
    (dot([x, y, z], [x, y, z]).sqrt(), dot([u, v, w], [u, v, w]).sqrt())
}
