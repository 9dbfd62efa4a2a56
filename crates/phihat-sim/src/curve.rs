//! A closed curve in space, as samples of the joints that follow it.

use core::f64::consts::TAU;

use phihat_model::{FrameId, IkError, IkOptions, Model, PoseTarget, Robot, Workspace};
use phihat_study::{Curve, ReferenceRequest};

use crate::error::{OutOfReach, SimError};
use crate::spline::Spline;

/// Longest time between samples \[s\].
const STEP_MAX: f64 = 5e-3;

/// Samples per turn, at least.
const STEPS_PER_TURN: f64 = 500.0;

/// Largest change of a joint between samples \[rad, m\]: beyond it the arm has changed its branch.
const JUMP_MAX: f64 = 0.1;

/// Samples beyond the end of the run: what the spline's free end does dies out by 0.27 per sample.
const BEYOND: f64 = 16.0;

/// Samples beyond the end of the run that must be reachable.
const NEEDED: f64 = 2.0;

/// Times and joint positions along a Cartesian reference, a little beyond the end of the run.
///
/// # Method
///
/// The first point is solved from the study's seed, each following one from its predecessor.
pub(crate) fn joint_samples(
    reference: &ReferenceRequest,
    robot: &Robot,
    duration: f64,
) -> Result<(Vec<f64>, Vec<Vec<f64>>), SimError> {
    let ReferenceRequest::Cartesian { frame, curve, period, fade_in, hold_orientation, seed } =
        reference
    else {
        return Err(SimError::UnknownReference);
    };
    let curve = CurveShape::new(curve);
    let at = |t: f64| curve.point(travelled(t, *fade_in) / period);
    let unreachable =
        |t: f64, reason: OutOfReach| SimError::Unreachable { t, point: at(t), reason };
    let frame = robot
        .model
        .frame(frame)
        .ok_or_else(|| unreachable(0.0, OutOfReach::NoFrame(frame.clone())))?;
    let mut follower = Follower::new(robot, frame);
    let mut q = follower.solve(at(0.0), seed, 16).map_err(|e| unreachable(0.0, e.into()))?;
    if *hold_orientation {
        follower.hold(&q);
    }
    let step = STEP_MAX.min(period / STEPS_PER_TURN);
    let (mut times, mut rows) = (vec![0.0], vec![q.clone()]);
    for k in 1_u32.. {
        let t = f64::from(k) * step;
        if t > duration + BEYOND * step {
            break;
        }
        match follower.next(at(t), &q) {
            Ok(next) => q = next,
            Err(_) if t > duration + NEEDED * step => break,
            Err(reason) => return Err(unreachable(t, reason)),
        }
        times.push(t);
        rows.push(q.clone());
    }
    Ok((times, rows))
}

/// Seconds at full speed that the quintic start-up of the speed leaves after `t` seconds.
fn travelled(t: f64, fade_in: f64) -> f64 {
    if t >= fade_in {
        return t - 0.5 * fade_in;
    }
    let s = t / fade_in;
    fade_in * s * s * s * s * (2.5 + s * (s - 3.0))
}

/// A curve over one turn.
enum CurveShape {
    Circle { center: [f64; 3], u: [f64; 3], v: [f64; 3] },
    Spline { axes: [Spline; 3], points: f64 },
}

impl CurveShape {
    fn new(curve: &Curve) -> Self {
        match curve {
            Curve::Circle { center, radius, normal } => {
                let (u, v) = plane(normal, *radius);
                Self::Circle { center: *center, u, v }
            }
            Curve::Spline { points } => Self::closed_spline(points),
        }
    }

    /// A periodic spline: the middle turn of thirteen. What the free ends do dies out by 0.27 per knot.
    fn closed_spline(points: &[[f64; 3]]) -> Self {
        const TURNS_BEFORE: usize = 6;
        let n = points.len();
        let first = (TURNS_BEFORE * n) as f64;
        let knots = (2 * TURNS_BEFORE + 1) * n;
        let t: Vec<f64> = (0..knots).map(|i| i as f64 - first).collect();
        let axis = |a: usize| {
            let y: Vec<f64> = (0..knots).map(|i| points[i % n][a]).collect();
            Spline::new(&t, &y)
        };
        Self::Spline { axes: [axis(0), axis(1), axis(2)], points: n as f64 }
    }

    /// The point after a number of turns.
    fn point(&self, turns: f64) -> [f64; 3] {
        match self {
            Self::Circle { center, u, v } => {
                let (sin, cos) = libm::sincos(TAU * turns);
                core::array::from_fn(|i| center[i] + cos * u[i] + sin * v[i])
            }
            Self::Spline { axes, points } => {
                let at = (turns - turns.floor()) * points;
                core::array::from_fn(|i| axes[i].at(at)[0])
            }
        }
    }
}

/// Two perpendicular vectors of length `radius` in the plane of a unit normal; the first points along x,
/// or along y where the normal is x.
fn plane(normal: &[f64; 3], radius: f64) -> ([f64; 3], [f64; 3]) {
    let along = if normal[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let share: f64 = along.iter().zip(normal).map(|(a, n)| a * n).sum();
    let flat: [f64; 3] = core::array::from_fn(|i| along[i] - share * normal[i]);
    let length = flat.iter().map(|x| x * x).sum::<f64>().sqrt();
    let u = flat.map(|x| x / length * radius);
    let v = [
        normal[1] * u[2] - normal[2] * u[1],
        normal[2] * u[0] - normal[0] * u[2],
        normal[0] * u[1] - normal[1] * u[0],
    ];
    (u, v)
}

/// Inverse kinematics along a curve.
struct Follower<'a> {
    model: &'a Model,
    workspace: Workspace<f64>,
    frame: FrameId,
    options: IkOptions,
    orientation: Option<[[f64; 3]; 3]>,
}

impl<'a> Follower<'a> {
    fn new(robot: &'a Robot, frame: FrameId) -> Self {
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        let limits: Vec<_> = robot.joints.iter().map(|j| j.position.unwrap_or(free)).collect();
        let bounded = limits.iter().all(|(low, high)| low.is_finite() && high.is_finite());
        let options = IkOptions {
            limits: if bounded { limits } else { Vec::new() },
            tolerance: 1e-10,
            ..IkOptions::default()
        };
        let workspace = Workspace::new(&robot.model);
        Self { model: &robot.model, workspace, frame, options, orientation: None }
    }

    /// From now on the orientation stays as it is at `q`.
    fn hold(&mut self, q: &[f64]) {
        self.model.forward_kinematics(&mut self.workspace, q);
        self.orientation = Some(self.model.pose(&self.workspace, self.frame).r);
    }

    /// The position near `q` for the next point.
    fn next(&mut self, p: [f64; 3], q: &[f64]) -> Result<Vec<f64>, OutOfReach> {
        let next = self.solve(p, q, 0)?;
        let jump = next.iter().zip(q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if jump > JUMP_MAX {
            return Err(OutOfReach::Jump(jump));
        }
        Ok(next)
    }

    fn solve(&mut self, p: [f64; 3], seed: &[f64], restarts: usize) -> Result<Vec<f64>, IkError> {
        let target = match self.orientation {
            Some(r) => PoseTarget::Pose(phihat_model::Pose { p, r }),
            None => PoseTarget::Position(p),
        };
        self.options.restarts = restarts;
        self.model.inverse_kinematics(&mut self.workspace, self.frame, &target, seed, &self.options)
    }
}
