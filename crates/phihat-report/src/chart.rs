//! The charts of a run: which quantity, in which unit, against which bound.

use crate::band::{self, Band, Ends};
use crate::record::Seen;
use phihat_design::Tube;
use phihat_sim::{JointMetrics, JointTrace};

/// Beyond this a sample is drawn as a gap: the run has diverged, and no axis helps.
pub(crate) const DRAWABLE_MAX: f64 = 1e12;

/// How the curves of a chart are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Plane {
    /// Every curve over time.
    Time,
    /// The second curve over the first: the phase plane.
    Phase,
}

/// One curve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Curve {
    pub label: &'static str,
    pub unit: &'static str,
    pub dashed: bool,
}

/// What `± bound` means.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bound {
    /// `bound` for the study's, `limit` for the robot's, empty where neither makes sense.
    pub label: &'static str,
    /// Whether it holds from the settling time on only.
    pub after_settle: bool,
}

/// One joint's curves, in the chart's units.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub joint: String,
    pub curves: Vec<Vec<f64>>,
    pub bound: Option<f64>,
    /// The tube that the first curve is in.
    pub tube: Option<Band>,
}

/// One quantity of all joints.
#[derive(Debug, Clone)]
pub(crate) struct Chart {
    /// File stem.
    pub stem: &'static str,
    pub title: &'static str,
    pub x_label: &'static str,
    pub y_label: &'static str,
    pub plane: Plane,
    pub curves: Vec<Curve>,
    pub bound: Bound,
    pub panels: Vec<Panel>,
}

/// How a chart is read from a joint: its curves in SI units, its bound, and one scale for all.
type Columns = fn(&JointTrace) -> Vec<Vec<f64>>;
type BoundOf = fn(&JointMetrics) -> Option<f64>;

const TIME: &str = "time t [s]";
const SPEC: Bound = Bound { label: "bound", after_settle: true };
const NONE: Bound = Bound { label: "", after_settle: false };
const LIMIT: Bound = Bound { label: "limit", after_settle: false };

const fn curve(label: &'static str, unit: &'static str, dashed: bool) -> Curve {
    Curve { label, unit, dashed }
}

/// The charts of a record, in the order of the page.
pub(crate) fn charts(record: &Seen<'_>) -> Vec<Chart> {
    let joints = &record.metrics.joints;
    let mut charts = vec![tracking(record), error(record)];
    if joints.iter().any(|j| j.error_integral_spec_rad_s.is_some()) {
        charts.push(error_integral(record));
    }
    if record.tube.is_some() || joints.iter().any(|j| j.velocity_error_spec_rad_s.is_some()) {
        charts.push(velocity_error(record));
    }
    charts.extend([torque(record), unknown_dynamics(record), phase(record), torque_step(record)]);
    charts
}

fn tracking(record: &Seen<'_>) -> Chart {
    let curves = vec![curve("q", "rad", false), curve("q_d", "rad", true)];
    Chart {
        stem: "tracking",
        title: "Tracking: position q and desired position q_d",
        x_label: TIME,
        y_label: "position [rad]",
        plane: Plane::Time,
        curves,
        bound: NONE,
        panels: panels(record, 1.0, |j| vec![j.q.clone(), j.q_desired.clone()], |_| None),
    }
}

fn error(record: &Seen<'_>) -> Chart {
    Chart {
        stem: "error",
        title: match record.tube {
            Some(_) => "Error e = q − q_d in its tube (shaded), against its bound",
            None => "Error e = q − q_d against its bound",
        },
        x_label: TIME,
        y_label: "error e [mrad]",
        plane: Plane::Time,
        curves: vec![curve("e", "mrad", false)],
        bound: SPEC,
        panels: tubed(
            panels(record, 1e3, |j| vec![j.e.clone()], |m| m.error_spec_rad),
            (record, 1e3),
            band::error,
        ),
    }
}

fn error_integral(record: &Seen<'_>) -> Chart {
    let bound: BoundOf = |m| m.error_integral_spec_rad_s;
    Chart {
        stem: "error-integral",
        title: "Integral of the error ∫e against its bound",
        x_label: TIME,
        y_label: "∫e [mrad·s]",
        plane: Plane::Time,
        curves: vec![curve("∫e", "mrad·s", false)],
        bound: SPEC,
        panels: panels(record, 1e3, |j| vec![j.e_integral.clone()], bound),
    }
}

fn velocity_error(record: &Seen<'_>) -> Chart {
    let bound: BoundOf = |m| m.velocity_error_spec_rad_s;
    Chart {
        stem: "velocity-error",
        title: match record.tube {
            Some(_) => "Velocity error ė in its tube (shaded), against its bound",
            None => "Velocity error ė against its bound",
        },
        x_label: TIME,
        y_label: "ė [mrad/s]",
        plane: Plane::Time,
        curves: vec![curve("ė", "mrad/s", false)],
        bound: SPEC,
        panels: tubed(
            panels(record, 1e3, |j| vec![j.de.clone()], bound),
            (record, 1e3),
            band::velocity,
        ),
    }
}

fn torque(record: &Seen<'_>) -> Chart {
    let columns: Columns = |j| vec![j.tau_applied.clone(), j.tau_command.clone()];
    Chart {
        stem: "torque",
        title: "Torque applied and commanded against the limit",
        x_label: TIME,
        y_label: "torque τ [N·m]",
        plane: Plane::Time,
        curves: vec![curve("τ applied", "N·m", false), curve("τ commanded", "N·m", true)],
        bound: LIMIT,
        panels: panels(record, 1.0, columns, |m| m.tau_limit_nm),
    }
}

fn unknown_dynamics(record: &Seen<'_>) -> Chart {
    Chart {
        stem: "unknown-dynamics",
        title: "Unknown dynamics φ and its estimate φ̂",
        x_label: TIME,
        y_label: "φ, φ̂ [N·m]",
        plane: Plane::Time,
        curves: vec![curve("φ", "N·m", false), curve("φ̂", "N·m", true)],
        bound: NONE,
        panels: panels(record, 1.0, |j| vec![j.phi.clone(), j.phi_hat.clone()], |_| None),
    }
}

fn phase(record: &Seen<'_>) -> Chart {
    let columns: Columns = |j| vec![j.e.clone(), j.de.clone()];
    Chart {
        stem: "phase",
        title: "Start-up in the phase plane, ė over e",
        x_label: "error e [mrad]",
        y_label: "ė [mrad/s]",
        plane: Plane::Phase,
        curves: vec![curve("e", "mrad", false), curve("ė", "mrad/s", false)],
        bound: SPEC,
        panels: panels(record, 1e3, columns, |m| m.error_spec_rad),
    }
}

fn torque_step(record: &Seen<'_>) -> Chart {
    Chart {
        stem: "torque-step",
        title: "Torque change per sample against the rate limit",
        x_label: TIME,
        y_label: "Δτ [N·m/sample]",
        plane: Plane::Time,
        curves: vec![curve("Δτ", "N·m/sample", false)],
        bound: LIMIT,
        panels: panels(record, 1.0, |j| vec![steps(&j.tau_command)], |m| m.tau_step_limit_nm),
    }
}

/// `τ_k − τ_{k−1}`; the first sample has none.
fn steps(tau: &[f64]) -> Vec<f64> {
    let changes = tau.windows(2).map(|w| w[1] - w[0]);
    tau.first().map(|_| f64::NAN).into_iter().chain(changes).collect()
}

fn panels(record: &Seen<'_>, scale: f64, columns: Columns, bound: BoundOf) -> Vec<Panel> {
    let samples = record.trace.t_ns.len();
    let panel = |(j, joint): (usize, &JointTrace)| Panel {
        joint: crate::text::line(&joint.name),
        curves: columns(joint).iter().map(|c| drawable(c, samples, scale)).collect(),
        bound: record.metrics.joints.get(j).and_then(bound).map(|b| scale * b),
        tube: None,
    };
    record.trace.joints.iter().enumerate().map(panel).collect()
}

/// The same panels with the tube around their first curve.
fn tubed(mut panels: Vec<Panel>, (record, scale): (&Seen<'_>, f64), ends: Ends) -> Vec<Panel> {
    for (j, panel) in panels.iter_mut().enumerate() {
        let joint =
            |tube: &Tube| tube.joints.get(j).map(|joint| Band::of(tube, joint, ends, scale));
        panel.tube = record.tube.and_then(joint);
    }
    panels
}

/// Exactly `samples` values; NaN where there is nothing to draw.
fn drawable(column: &[f64], samples: usize, scale: f64) -> Vec<f64> {
    let value = |k: usize| column.get(k).map_or(f64::NAN, |v| scale * v);
    (0..samples).map(value).map(|v| if v.abs() <= DRAWABLE_MAX { v } else { f64::NAN }).collect()
}

/// Time of every sample \[s\].
pub(crate) fn times(record: &Seen<'_>) -> Vec<f64> {
    record.trace.t_ns.iter().map(|&t| t as f64 * 1e-9).collect()
}

/// Index of the first sample of the steady part.
pub(crate) fn settle_index(record: &Seen<'_>) -> usize {
    let settle = record.metrics.settle_s;
    record.trace.t_ns.partition_point(|&t| (t as f64 * 1e-9) < settle)
}
