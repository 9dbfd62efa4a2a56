//! The quantities that are drawn of a run: which curves, in which unit, against which bound.

use crate::band::{self, EnvelopeParts};
use phihat_sim::{JointMetrics, JointTrace, Metrics};

/// Beyond this a sample is drawn as a gap: the run has diverged, and no axis helps.
pub(crate) const DRAWABLE_MAX: f64 = 1e12;

/// Plane in which a chart draws its curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlotPlane {
    /// Every curve over time.
    Time,
    /// The second curve over the first: the phase plane.
    Phase,
}

/// One curve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KindCurve {
    pub label: &'static str,
    pub unit: &'static str,
    pub dashed: bool,
    /// True if it is constant from one sample to the next: a step, no slope.
    pub held: bool,
    /// Its value at a sample of a block, in SI units; with the command before the block.
    pub of: ValueOf,
}

/// Meaning of `± bound`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KindBound {
    /// `bound` for the study's, `limit` for the robot's, empty where neither makes sense.
    pub label: &'static str,
    /// True if it holds from the settling time on only.
    pub after_settle: bool,
    /// Its value, in SI units.
    pub of: fn(&JointMetrics) -> Option<f64>,
}

/// One quantity: what its chart shows of any run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ChartKind {
    /// File stem.
    pub stem: &'static str,
    /// Title; the second with a tube around the first curve, the third with a class bound.
    pub title: [&'static str; 3],
    /// File stem and titles of a figure of the steady part alone, where there is one. On paper nobody can
    /// zoom: the start-up would hide how the error sits in its bound.
    pub steady: Option<(&'static str, [&'static str; 3])>,
    pub x_label: &'static str,
    pub y_label: &'static str,
    pub plane: PlotPlane,
    /// From SI units to those of the chart.
    pub scale: f64,
    pub curves: &'static [KindCurve],
    pub bound: KindBound,
    /// Parts of an envelope that are around the first curve.
    pub envelope: EnvelopeParts,
    /// Returns true if it is shown of a run with these figures, and with an envelope or without.
    pub shown: fn(&Metrics, bool) -> bool,
}

/// No envelope.
const NO_PARTS: EnvelopeParts = EnvelopeParts { tube: None, class: None };

/// A quantity over time, with nothing to hold it against.
const PLAIN: ChartKind = ChartKind {
    stem: "",
    title: [""; 3],
    steady: None,
    x_label: "time t [s]",
    y_label: "",
    plane: PlotPlane::Time,
    scale: 1.0,
    curves: &[],
    bound: KindBound { label: "", after_settle: false, of: |_| None },
    envelope: NO_PARTS,
    shown: |_, _| true,
};

const fn spec(of: fn(&JointMetrics) -> Option<f64>) -> KindBound {
    KindBound { label: "bound", after_settle: true, of }
}

const fn limit(of: fn(&JointMetrics) -> Option<f64>) -> KindBound {
    KindBound { label: "limit", after_settle: false, of }
}

type ValueOf = fn(&JointTrace, usize, Option<f64>) -> f64;

/// A solid curve between samples.
const fn curve(label: &'static str, unit: &'static str, of: ValueOf) -> KindCurve {
    KindCurve { label, unit, dashed: false, held: false, of }
}

/// A curve that is constant from one sample to the next.
const fn held(label: &'static str, unit: &'static str, dashed: bool, of: ValueOf) -> KindCurve {
    KindCurve { label, unit, dashed, held: true, of }
}

/// Not a number where the column has no entry.
fn at(column: &[f64], k: usize) -> f64 {
    column.get(k).copied().unwrap_or(f64::NAN)
}

/// `τ_k − τ_{k−1}`; the first sample of a run has none.
fn step(joint: &JointTrace, k: usize, before: Option<f64>) -> f64 {
    let tau = &joint.tau_command;
    let before = k.checked_sub(1).map_or(before.unwrap_or(f64::NAN), |k| at(tau, k));
    at(tau, k) - before
}

const E: KindCurve = curve("e", "mrad", |j, k, _| at(&j.e, k));
const DE: KindCurve = curve("ė", "mrad/s", |j, k, _| at(&j.de, k));

/// All charts, in the order of the page.
pub(crate) static CHARTS: [ChartKind; 9] = [
    ChartKind {
        stem: "tracking",
        title: ["Tracking: position q and desired position q_d"; 3],
        y_label: "position [rad]",
        curves: &[
            curve("q", "rad", |j, k, _| at(&j.q, k)),
            held("q_d", "rad", true, |j, k, _| at(&j.q_desired, k)),
        ],
        ..PLAIN
    },
    ChartKind {
        stem: "error",
        title: [
            "Error e = q − q_d against its bound",
            "Error e = q − q_d in its tube (shaded), against its bound",
            "Error e = q − q_d in the class bound (shaded), against its bound",
        ],
        steady: Some((
            "error-steady",
            [
                "Error e in the steady part against its bound",
                "Error e in the steady part, in its tube (shaded), against its bound",
                "Error e in the steady part, in the class bound (shaded), against its bound",
            ],
        )),
        y_label: "error e [mrad]",
        scale: 1e3,
        curves: &[E],
        bound: spec(|m| m.error_bound_rad),
        envelope: EnvelopeParts {
            tube: Some(band::error),
            class: Some(|class| &class.error_bound_rad),
        },
        ..PLAIN
    },
    ChartKind {
        stem: "error-integral",
        title: ["Integral of the error ∫e against its bound"; 3],
        y_label: "∫e [mrad·s]",
        scale: 1e3,
        curves: &[curve("∫e", "mrad·s", |j, k, _| at(&j.e_integral, k))],
        bound: spec(|m| m.error_integral_bound_rad_s),
        shown: |metrics, _| metrics.joints.iter().any(|j| j.error_integral_bound_rad_s.is_some()),
        ..PLAIN
    },
    ChartKind {
        stem: "velocity-error",
        title: [
            "Velocity error ė against its bound",
            "Velocity error ė in its tube (shaded), against its bound",
            "Velocity error ė in the class bound (shaded), against its bound",
        ],
        y_label: "ė [mrad/s]",
        scale: 1e3,
        curves: &[DE],
        bound: spec(|m| m.velocity_error_bound_rad_s),
        envelope: EnvelopeParts {
            tube: Some(band::velocity),
            class: Some(|class| &class.velocity_error_bound_rad_s),
        },
        shown: |metrics, enveloped| {
            enveloped || metrics.joints.iter().any(|j| j.velocity_error_bound_rad_s.is_some())
        },
        ..PLAIN
    },
    ChartKind {
        stem: "torque",
        title: [
            "Torque applied and commanded against the limit",
            "Torque applied and commanded against the limit",
            "Torque applied and commanded in the class bound (shaded), against the limit",
        ],
        y_label: "torque τ [N·m]",
        curves: &[
            held("τ applied", "N·m", false, |j, k, _| at(&j.tau_applied, k)),
            held("τ commanded", "N·m", true, |j, k, _| at(&j.tau_command, k)),
        ],
        bound: limit(|m| m.tau_limit_nm),
        envelope: EnvelopeParts { class: Some(|class| &class.torque_nm), ..NO_PARTS },
        ..PLAIN
    },
    ChartKind {
        stem: "unknown-dynamics",
        title: ["Unknown dynamics φ and its estimate φ̂"; 3],
        y_label: "φ, φ̂ [N·m]",
        curves: &[
            curve("φ", "N·m", |j, k, _| at(&j.phi, k)),
            held("φ̂", "N·m", true, |j, k, _| at(&j.phi_hat, k)),
        ],
        ..PLAIN
    },
    ChartKind {
        stem: "estimate-error",
        title: ["What the estimate misses: φ − φ̂"; 3],
        y_label: "φ − φ̂ [N·m]",
        curves: &[curve("φ − φ̂", "N·m", |j, k, _| at(&j.phi, k) - at(&j.phi_hat, k))],
        ..PLAIN
    },
    ChartKind {
        stem: "phase",
        title: ["Start-up in the phase plane, ė over e"; 3],
        x_label: "error e [mrad]",
        y_label: "ė [mrad/s]",
        plane: PlotPlane::Phase,
        scale: 1e3,
        curves: &[E, DE],
        bound: spec(|m| m.error_bound_rad),
        ..PLAIN
    },
    ChartKind {
        stem: "torque-step",
        title: [
            "Torque change per sample against the rate limit",
            "Torque change per sample against the rate limit",
            "Torque change per sample in the class bound (shaded), against the rate limit",
        ],
        y_label: "Δτ [N·m/sample]",
        curves: &[held("Δτ", "N·m/sample", false, step)],
        bound: limit(|m| m.tau_step_limit_nm),
        envelope: EnvelopeParts { class: Some(|class| &class.torque_step_nm), ..NO_PARTS },
        ..PLAIN
    },
];
