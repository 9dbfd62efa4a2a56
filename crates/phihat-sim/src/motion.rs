//! The reference as a function of time: position, velocity, acceleration, all continuous.

use core::f64::consts::TAU;

use phihat_study::{ReferenceRequest, Sine, Study};

use crate::curve;
use crate::error::SimError;
use crate::jerk_limited::JerkLimitedMotion;
use crate::spline::{Jet, Spline, quintic_step};

/// A C² motion of all joints.
///
/// # Example
///
/// ```
/// use phihat_sim::Motion;
/// use phihat_study::Study;
///
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_bound_rad = 2e-3
/// #     [gains]
/// #     order = 1
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// let motion = Motion::new(&study.reference, &study.robot, study.duration)?;
/// let [q, dq, ddq] = motion.at(0, 0.0); // joint 0 at t = 0: the fade-in starts at rest
/// assert_eq!((q, dq, ddq), (0.4, 0.0, 0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    path: Path,
    /// From a sample to the interval in which its torque acts, and how long that is \[s\]; `None`: no preview.
    preview: Option<(f64, f64)>,
}

#[derive(Debug, Clone, PartialEq)]
enum Path {
    Sines { center: Vec<f64>, terms: Vec<Sine>, fade_in: f64 },
    Waypoints { t: Vec<f64>, q: Vec<Vec<f64>> },
    Splines(Vec<Spline>),
    JerkLimited(Vec<JerkLimitedMotion>),
}

impl Motion {
    /// Prepares a study's reference for a robot and a duration \[s\]; solves the inverse kinematics of
    /// a Cartesian curve.
    ///
    /// # Errors
    ///
    /// [`SimError::Unreachable`] when the arm cannot follow a Cartesian curve.
    pub fn new(
        reference: &ReferenceRequest,
        robot: &phihat_model::Robot,
        duration: f64,
    ) -> Result<Self, SimError> {
        let path = match reference {
            ReferenceRequest::Sines { center, terms, fade_in } => {
                Path::Sines { center: center.clone(), terms: terms.clone(), fade_in: *fade_in }
            }
            ReferenceRequest::Waypoints { t, q } => Path::Waypoints { t: t.clone(), q: q.clone() },
            ReferenceRequest::Samples { t, q, .. } => Path::Splines(per_joint(t, q)),
            ReferenceRequest::Any { class, seed } => {
                let joints = 0..class.center.len();
                let draw = |joint| JerkLimitedMotion::draw(class, joint, *seed, duration);
                Path::JerkLimited(joints.map(draw).collect())
            }
            ReferenceRequest::Setpoints { t, q, limits, .. } => {
                let joint = |(j, limits): (usize, &[f64; 3])| {
                    let targets = t.iter().zip(q).map(|(t, q)| (*t, q[j]));
                    JerkLimitedMotion::towards(targets, *limits, robot.joints[j].position, duration)
                        .map_err(|why| SimError::Setpoints {
                            joint: robot.joints[j].name.clone(),
                            why,
                        })
                };
                let motions = limits.iter().enumerate().map(joint);
                Path::JerkLimited(motions.collect::<Result<_, _>>()?)
            }
            ReferenceRequest::Cartesian { .. } => {
                let (t, q) = curve::joint_samples(reference, robot, duration)?;
                Path::Splines(per_joint(&t, &q))
            }
        };
        Ok(Self { path, preview: None })
    }

    /// The motion of a study as its controller gets it: with the preview that the study declares.
    ///
    /// # Errors
    ///
    /// As [`Self::new`].
    pub fn of(study: &Study) -> Result<Self, SimError> {
        let motion = Self::new(&study.reference, &study.robot, study.duration)?;
        let period = study.control.period_ns as f64 * 1e-9;
        let ahead = f64::from(study.control.delay_samples) * period;
        let preview = study.control.preview.then_some((ahead, period));
        Ok(Self { preview, ..motion })
    }

    /// Reference of one joint at a sample as the controller receives it: `q_d`, `q̇_d`, and the feed-forward
    /// acceleration.
    ///
    /// With preview that is the mean over the interval in which the torque of this sample acts,
    /// `(q̇_d(t + (d+1)T) − q̇_d(t + dT))/T`, else `q̈_d` of now.
    pub fn told(&self, joint: usize, t: f64) -> Jet {
        let [q, dq, ddq] = self.at(joint, t);
        let Some((ahead, period)) = self.preview else { return [q, dq, ddq] };
        let [[_, before, _], [_, after, _]] =
            [ahead, ahead + period].map(|later| self.at(joint, t + later));
        [q, dq, (after - before) / period]
    }

    /// `q_d`, `q̇_d`, `q̈_d` of one joint at a time \[s\].
    pub fn at(&self, joint: usize, t: f64) -> Jet {
        match &self.path {
            Path::Sines { center, terms, fade_in } => {
                sines(center[joint], terms, *fade_in, joint, t)
            }
            Path::Waypoints { t: times, q } => waypoints(times, q, joint, t),
            Path::Splines(splines) => splines[joint].at(t),
            Path::JerkLimited(motions) => motions[joint].at(t),
        }
    }
}

fn per_joint(t: &[f64], q: &[Vec<f64>]) -> Vec<Spline> {
    let joints = q.first().map_or(0, Vec::len);
    (0..joints).map(|j| Spline::new(t, &q.iter().map(|row| row[j]).collect::<Vec<_>>())).collect()
}

/// `c + w(t) Σ A sin(ωt + p)` with the quintic fade-in `w`.
fn sines(center: f64, terms: &[Sine], fade_in: f64, joint: usize, t: f64) -> Jet {
    let mut sum = [0.0; 3];
    for term in terms {
        let rate = TAU * term.frequency[joint];
        let (sin, cos) = libm::sincos(rate * t + term.phase[joint]);
        let amplitude = term.amplitude[joint];
        sum[0] += amplitude * sin;
        sum[1] += amplitude * rate * cos;
        sum[2] -= amplitude * rate * rate * sin;
    }
    let w = quintic_step(t, fade_in);
    [
        center + w[0] * sum[0],
        w[0] * sum[1] + w[1] * sum[0],
        w[0] * sum[2] + 2.0 * w[1] * sum[1] + w[2] * sum[0],
    ]
}

/// Rest to rest between waypoints; holds the last one.
fn waypoints(times: &[f64], q: &[Vec<f64>], joint: usize, t: f64) -> Jet {
    let passed = times.partition_point(|at| *at <= t).max(1);
    let from = q[passed - 1][joint];
    let Some(next) = times.get(passed) else { return [from, 0.0, 0.0] };
    let start = times[passed - 1];
    let change = q[passed][joint] - from;
    let [value, slope, bend] = quintic_step(t - start, next - start);
    [from + change * value, change * slope, change * bend]
}
