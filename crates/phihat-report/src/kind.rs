//! The quantities that are drawn of a run: which curves, in which unit, against which bound.

use crate::band::{self, Ends};
use phihat_sim::{JointMetrics, JointTrace, Metrics};

/// Beyond this a sample is drawn as a gap: the run has diverged, and no axis helps.
pub(crate) const DRAWABLE_MAX: f64 = 1e12;

/// Plane in which a chart draws its curves.
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
    /// True if it is constant from one sample to the next: a step, no slope.
    pub held: bool,
    /// Its value at a sample of a block, in SI units; with the command before the block.
    pub of: fn(&JointTrace, usize, Option<f64>) -> f64,
}

/// Meaning of `± bound`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bound {
    /// `bound` for the study's, `limit` for the robot's, empty where neither makes sense.
    pub label: &'static str,
    /// True if it holds from the settling time on only.
    pub after_settle: bool,
    /// Its value, in SI units.
    pub of: fn(&JointMetrics) -> Option<f64>,
}

/// One quantity: what its chart shows of any run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kind {
    /// File stem.
    pub stem: &'static str,
    /// Title; the second where there is a tube around the first curve.
    pub title: [&'static str; 2],
    /// File stem and titles of a figure of the steady part alone, where there is one. On paper nobody can
    /// zoom: the start-up would hide how the error sits in its bound.
    pub steady: Option<(&'static str, [&'static str; 2])>,
    pub x_label: &'static str,
    pub y_label: &'static str,
    pub plane: Plane,
    /// From SI units to those of the chart.
    pub scale: f64,
    pub curves: &'static [Curve],
    pub bound: Bound,
    /// The tube around the first curve.
    pub tube: Option<Ends>,
    /// Returns true if it is shown of a run with these figures, and with a tube or without.
    pub shown: fn(&Metrics, bool) -> bool,
}

const TIME: &str = "time t [s]";
const NONE: Bound = Bound { label: "", after_settle: false, of: |_| None };

const fn spec(of: fn(&JointMetrics) -> Option<f64>) -> Bound {
    Bound { label: "bound", after_settle: true, of }
}

const fn limit(of: fn(&JointMetrics) -> Option<f64>) -> Bound {
    Bound { label: "limit", after_settle: false, of }
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

const E: Curve =
    Curve { label: "e", unit: "mrad", dashed: false, held: false, of: |j, k, _| at(&j.e, k) };
const DE: Curve =
    Curve { label: "ė", unit: "mrad/s", dashed: false, held: false, of: |j, k, _| at(&j.de, k) };

/// All charts, in the order of the page.
pub(crate) static CHARTS: [Kind; 8] = [
    Kind {
        stem: "tracking",
        title: ["Tracking: position q and desired position q_d"; 2],
        steady: None,
        x_label: TIME,
        y_label: "position [rad]",
        plane: Plane::Time,
        scale: 1.0,
        curves: &[
            Curve {
                label: "q",
                unit: "rad",
                dashed: false,
                held: false,
                of: |j, k, _| at(&j.q, k),
            },
            Curve {
                label: "q_d",
                unit: "rad",
                dashed: true,
                held: true,
                of: |j, k, _| at(&j.q_desired, k),
            },
        ],
        bound: NONE,
        tube: None,
        shown: |_, _| true,
    },
    Kind {
        stem: "error",
        title: [
            "Error e = q − q_d against its bound",
            "Error e = q − q_d in its tube (shaded), against its bound",
        ],
        steady: Some((
            "error-steady",
            [
                "Error e in the steady part against its bound",
                "Error e in the steady part, in its tube (shaded), against its bound",
            ],
        )),
        x_label: TIME,
        y_label: "error e [mrad]",
        plane: Plane::Time,
        scale: 1e3,
        curves: &[E],
        bound: spec(|m| m.error_spec_rad),
        tube: Some(band::error),
        shown: |_, _| true,
    },
    Kind {
        stem: "error-integral",
        title: ["Integral of the error ∫e against its bound"; 2],
        steady: None,
        x_label: TIME,
        y_label: "∫e [mrad·s]",
        plane: Plane::Time,
        scale: 1e3,
        curves: &[Curve {
            label: "∫e",
            unit: "mrad·s",
            dashed: false,
            held: false,
            of: |j, k, _| at(&j.e_integral, k),
        }],
        bound: spec(|m| m.error_integral_spec_rad_s),
        tube: None,
        shown: |metrics, _| metrics.joints.iter().any(|j| j.error_integral_spec_rad_s.is_some()),
    },
    Kind {
        stem: "velocity-error",
        title: [
            "Velocity error ė against its bound",
            "Velocity error ė in its tube (shaded), against its bound",
        ],
        steady: None,
        x_label: TIME,
        y_label: "ė [mrad/s]",
        plane: Plane::Time,
        scale: 1e3,
        curves: &[DE],
        bound: spec(|m| m.velocity_error_spec_rad_s),
        tube: Some(band::velocity),
        shown: |metrics, tubed| {
            let mut joints = metrics.joints.iter();
            tubed || joints.any(|j| j.velocity_error_spec_rad_s.is_some())
        },
    },
    Kind {
        stem: "torque",
        title: ["Torque applied and commanded against the limit"; 2],
        steady: None,
        x_label: TIME,
        y_label: "torque τ [N·m]",
        plane: Plane::Time,
        scale: 1.0,
        curves: &[
            Curve {
                label: "τ applied",
                unit: "N·m",
                dashed: false,
                held: true,
                of: |j, k, _| at(&j.tau_applied, k),
            },
            Curve {
                label: "τ commanded",
                unit: "N·m",
                dashed: true,
                held: true,
                of: |j, k, _| at(&j.tau_command, k),
            },
        ],
        bound: limit(|m| m.tau_limit_nm),
        tube: None,
        shown: |_, _| true,
    },
    Kind {
        stem: "unknown-dynamics",
        title: ["Unknown dynamics φ and its estimate φ̂"; 2],
        steady: None,
        x_label: TIME,
        y_label: "φ, φ̂ [N·m]",
        plane: Plane::Time,
        scale: 1.0,
        curves: &[
            Curve {
                label: "φ",
                unit: "N·m",
                dashed: false,
                held: false,
                of: |j, k, _| at(&j.phi, k),
            },
            Curve {
                label: "φ̂",
                unit: "N·m",
                dashed: true,
                held: true,
                of: |j, k, _| at(&j.phi_hat, k),
            },
        ],
        bound: NONE,
        tube: None,
        shown: |_, _| true,
    },
    Kind {
        stem: "phase",
        title: ["Start-up in the phase plane, ė over e"; 2],
        steady: None,
        x_label: "error e [mrad]",
        y_label: "ė [mrad/s]",
        plane: Plane::Phase,
        scale: 1e3,
        curves: &[E, DE],
        bound: spec(|m| m.error_spec_rad),
        tube: None,
        shown: |_, _| true,
    },
    Kind {
        stem: "torque-step",
        title: ["Torque change per sample against the rate limit"; 2],
        steady: None,
        x_label: TIME,
        y_label: "Δτ [N·m/sample]",
        plane: Plane::Time,
        scale: 1.0,
        curves: &[Curve {
            label: "Δτ", unit: "N·m/sample", dashed: false, held: true, of: step
        }],
        bound: limit(|m| m.tau_step_limit_nm),
        tube: None,
        shown: |_, _| true,
    },
];
