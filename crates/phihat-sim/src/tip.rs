//! The tip of the arm: where it is, where the reference has it, and what joints may be off for it.

use phihat_model::{FrameId, Lanes, Model, Pose, Scalar, Workspace};
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use crate::error::SimError;
use crate::motion::Motion;
use crate::trace::{JointTrace, Trace};

/// Figures of the arm's tip over a run. "Steady" means: after `Spec::settle`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TipMetrics {
    /// The tip's frame (link).
    pub frame: String,
    /// Largest distance of the tip from where the reference has it, of the whole run \[m\].
    #[serde(alias = "error_max_m")]
    pub error_peak_m: f64,
    /// The same of the steady part.
    pub error_steady_max_m: f64,
    /// The study's bound on the steady one, if it states one \[m\].
    #[serde(alias = "error_spec_m")]
    pub error_bound_m: Option<f64>,
    /// Largest angle between the tip's axes and those of the reference in the steady part \[rad\].
    pub angle_steady_max_rad: f64,
}

impl TipMetrics {
    /// Returns true if the bound that the study states, if any, is satisfied.
    pub fn within_spec(&self) -> bool {
        // Written so that NaN does not pass.
        self.error_bound_m.is_none_or(|bound| self.error_steady_max_m <= bound)
    }
}

/// Measures the tip while the record of a run goes by.
#[derive(Debug, Clone)]
pub(crate) struct TipMeasured {
    model: Model,
    frame: FrameId,
    workspace: Workspace<Lanes>,
    /// Postures of so many samples.
    q: Vec<Lanes>,
    /// Sine of half the largest angle of the steady part.
    half: f64,
    pub(crate) metrics: TipMetrics,
}

impl TipMeasured {
    /// `None`: the robot's description names no such frame, or there is no description.
    pub(crate) fn new(study: &Study) -> Option<Self> {
        if !study.has_tip() {
            return None;
        }
        let model = study.robot.model.clone();
        let frame = model.frame(&study.robot.tip)?;
        let metrics = TipMetrics {
            frame: study.robot.tip.clone(),
            error_peak_m: 0.0,
            error_steady_max_m: 0.0,
            error_bound_m: study.spec.tip_error_bound,
            angle_steady_max_rad: 0.0,
        };
        let q = Vec::with_capacity(model.joint_count());
        Some(Self { workspace: Workspace::new(&model), model, frame, q, half: 0.0, metrics })
    }

    /// More samples, those from `first` on of the steady part: as many at a time as there are lanes.
    pub(crate) fn block(&mut self, trace: &Trace, first: usize) {
        for from in (0..trace.len()).step_by(Lanes::COUNT) {
            let (offs, halves) = self.apart(trace, from);
            for (k, (off, half)) in (from..trace.len()).zip(offs.into_iter().zip(halves)) {
                raise(&mut self.metrics.error_peak_m, off);
                if k >= first {
                    raise(&mut self.metrics.error_steady_max_m, off);
                    let widest = self.half;
                    raise(&mut self.half, half);
                    if widest.to_bits() != self.half.to_bits() {
                        raise_angle(&mut self.metrics.angle_steady_max_rad, half);
                    }
                }
            }
        }
    }

    /// Distance \[m\] between the tips of both postures of so many samples, and the sine of half the angle
    /// between their axes; entries beyond the last sample repeat it.
    fn apart(&mut self, trace: &Trace, from: usize) -> ([f64; Lanes::COUNT], [f64; Lanes::COUNT]) {
        let last = trace.len() - 1;
        let side = |values: &[f64]| match values.get(from..).and_then(<[f64]>::first_chunk) {
            Some(whole) => Lanes::from(*whole),
            None => Lanes::from(core::array::from_fn(|k| values[last.min(from + k)])),
        };
        let mut pose = |of: fn(&JointTrace) -> &Vec<f64>| {
            self.q.clear();
            self.q.extend(trace.joints.iter().map(|joint| side(of(joint))));
            self.model.forward_kinematics(&mut self.workspace, &self.q);
            self.model.pose(&self.workspace, self.frame)
        };
        let (a, b) = (pose(|joint| &joint.q), pose(|joint| &joint.q_desired));
        let (off, half) = between(&a, &b);
        (off.into(), half.into())
    }
}

/// Distance \[m\] of two poses, and the sine of half the angle between their axes, lane by lane.
#[inline]
pub(crate) fn between(a: &Pose<Lanes>, b: &Pose<Lanes>) -> (Lanes, Lanes) {
    let squares = |differences: &mut dyn Iterator<Item = Lanes>| {
        differences.fold(Lanes::splat(0.0), |sum, difference| sum + difference * difference)
    };
    let off = squares(&mut (0..3).map(|i| a.p[i] - b.p[i]));
    // ‖A − B‖ = 2√2 |sin(θ/2)| by Frobenius: exact also for small angles.
    let apart = squares(&mut (0..9).map(|i| a.r[i / 3][i % 3] - b.r[i / 3][i % 3]));
    (off.sqrt(), (apart / Lanes::splat(8.0)).sqrt())
}

/// Raises a largest angle \[rad\] to the one of which half the sine is told; NaN if there is one.
pub(crate) fn raise_angle(most: &mut f64, half: f64) {
    let sine = if half > 1.0 { 1.0 } else { half };
    raise(most, 2.0 * libm::asin(sine));
}

/// Raises a largest value; NaN if there is one.
fn raise(most: &mut f64, value: f64) {
    let keeps = most.is_nan() || value <= *most;
    if !keeps {
        *most = value;
    }
}

/// Error of every joint \[rad; m\] that satisfies the study's bound on its tip, along its whole motion;
/// `None`: it states none.
///
/// ```text
/// ε = bound / max_t Σ_i ℓ_i(q_d(t))                                                       (1)
/// ```
///
/// With `|e_i| ≤ ε` on all joints the tip is at most `Σ ℓ_i |e_i| ≤ bound` away, see
/// `phihat_certificate::TubeTip`; `ℓ_i` are the distances of the tip from the joints' axes at the samples of
/// the motion.
///
/// # Errors
///
/// [`SimError`]: the arm cannot follow the reference.
pub fn error_for_tip(study: &Study) -> Result<Option<f64>, SimError> {
    let Some(bound) = study.spec.tip_error_bound else { return Ok(None) };
    let Some(frame) = study.robot.model.frame(&study.robot.tip) else { return Ok(None) };
    let motion = Motion::new(&study.reference, &study.robot, study.duration)?;
    let model = &study.robot.model;
    let n = study.robot.joints.len();
    let mut workspace = Workspace::new(model);
    let mut columns = vec![0.0; 6 * n];
    let mut most = 0.0_f64;
    for k in 0..crate::simulation::samples(study.duration, study.control.period_ns) {
        let t = (k * study.control.period_ns) as f64 * 1e-9;
        let q: Vec<f64> = (0..n).map(|joint| motion.at(joint, t)[0]).collect();
        model.jacobian(&mut workspace, &q, frame, &mut columns);
        let lever = |i: usize| {
            let squares = (0..3).map(|row| columns[row * n + i] * columns[row * n + i]);
            squares.sum::<f64>().sqrt()
        };
        raise(&mut most, (0..n).map(lever).sum());
    }
    // A hair less, so that rounding does not lose it again; the tube's levers are rounded up in the fourth digit.
    Ok((most > 0.0).then(|| bound / most / (1.0 + 2e-3)))
}
