//! Figures of a run.

use phihat_report::{TubeRun, limits_acted};
use phihat_sim::{Divergence, JointMetrics, Metrics};

use super::{Fitted, MILLI, align, figure, in_unit, plain_table};

/// A torque held at its limit may differ from it by rounding.
const ROUNDING: f64 = 1e-9;

/// One measured figure of every joint, and the bound it must keep, both in the unit of the heading.
struct MetricsColumn {
    heading: &'static str,
    unit: &'static str,
    decimals: usize,
    value: fn(&JointMetrics) -> f64,
    bound: fn(&JointMetrics) -> Option<f64>,
    /// Of the steady part alone.
    steady: bool,
}

const COLUMNS: [MetricsColumn; 9] = [
    MetricsColumn::free(("rms e", "mrad", 4), true, |j| j.error_rms_rad * MILLI),
    MetricsColumn {
        heading: "max |e|",
        unit: "mrad",
        decimals: 3,
        value: |j| j.error_steady_max_rad * MILLI,
        bound: |j| j.error_bound_rad.map(|b| b * MILLI),
        steady: true,
    },
    MetricsColumn {
        heading: "max |∫e|",
        unit: "mrad·s",
        decimals: 3,
        value: |j| j.error_integral_steady_max_rad_s * MILLI,
        bound: |j| j.error_integral_bound_rad_s.map(|b| b * MILLI),
        steady: true,
    },
    MetricsColumn {
        heading: "max |ė|",
        unit: "mrad/s",
        decimals: 1,
        value: |j| j.velocity_error_steady_max_rad_s * MILLI,
        bound: |j| j.velocity_error_bound_rad_s.map(|b| b * MILLI),
        steady: true,
    },
    MetricsColumn {
        heading: "peak |τ|",
        unit: "N·m",
        decimals: 1,
        value: |j| j.tau_max_nm,
        bound: |j| j.tau_limit_nm,
        steady: false,
    },
    MetricsColumn {
        heading: "max |Δτ|",
        unit: "N·m/sample",
        decimals: 2,
        value: |j| j.tau_step_max_nm,
        bound: |j| j.tau_step_limit_nm,
        steady: false,
    },
    MetricsColumn::free(("limited", "% steady", 2), true, |j| 1e2 * j.limited_steady_share),
    MetricsColumn::free(("max |φ|", "N·m", 2), false, |j| j.phi_max_nm),
    MetricsColumn::free(("max |φ−φ̂|", "N·m", 2), true, |j| j.phi_error_steady_max_nm),
];

impl MetricsColumn {
    const fn free(
        (heading, unit, decimals): (&'static str, &'static str, usize),
        steady: bool,
        value: fn(&JointMetrics) -> f64,
    ) -> Self {
        Self { heading, unit, decimals, value, bound: |_| None, steady }
    }

    /// The bound, if all joints share one: it then stands in the heading.
    fn shared(&self, joints: &[JointMetrics]) -> Option<f64> {
        let first = (self.bound)(joints.first()?)?;
        let same = |j: &JointMetrics| (self.bound)(j).map(f64::to_bits) == Some(first.to_bits());
        joints.iter().all(same).then_some(first)
    }

    fn header(&self, shared: Option<f64>) -> String {
        match shared {
            Some(bound) => format!("{}\n{}\n≤ {}", self.heading, self.unit, short(bound)),
            None => format!("{}\n{}", self.heading, self.unit),
        }
    }

    fn cell(&self, joint: &JointMetrics, (shared, settled): (bool, bool)) -> String {
        // A run that ended before its steady part has no such figure, and a zero would be one.
        if self.steady && !settled {
            return "–".to_owned();
        }
        let value = (self.value)(joint);
        let figure = figure(value, self.decimals);
        let figure = in_unit(figure, self.unit, joint.slides);
        match (self.bound)(joint) {
            // NaN is no value within a bound.
            Some(bound) if value.is_nan() || value > bound * (1.0 + ROUNDING) => {
                format!("{figure} > {} !", short(bound))
            }
            Some(bound) if !shared => format!("{figure} ≤ {}", short(bound)),
            _ => figure,
        }
    }
}

/// At most six digits, no trailing zeros.
fn short(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// One row per joint, without φ where it is no torque of the arm. "Steady" figures are those after the start-up; a `!`
/// marks a bound exceeded.
pub(crate) fn metrics(metrics: &Metrics, phi: bool) -> Fitted {
    let joints = &metrics.joints;
    let columns = || COLUMNS.iter().filter(|column| phi || !column.heading.contains('φ'));
    let shared: Vec<Option<f64>> = columns().map(|c| c.shared(joints)).collect();
    let headers = columns().zip(&shared).map(|(c, s)| c.header(*s));
    let headers: Vec<String> = std::iter::once("joint".to_owned()).chain(headers).collect();
    let mut table = plain_table(headers);
    for joint in joints {
        let cells = columns()
            .zip(&shared)
            .map(|(c, s)| c.cell(joint, (s.is_some(), metrics.steady_samples > 0)));
        table.add_row(std::iter::once(joint.name.clone()).chain(cells));
    }
    align(&mut table);
    table
}

/// Largest error of the tip, in millimetres and degrees, with its bound.
pub(crate) fn tip(metrics: &Metrics) -> Option<String> {
    let tip = metrics.tip.as_ref()?;
    let (most, turned) = (tip.error_steady_max_m * MILLI, tip.angle_steady_max_rad.to_degrees());
    let bound = tip.error_bound_m.map(|bound| {
        let over = if tip.within_spec() { "" } else { " !" };
        format!(", {} allowed{over}", short(bound * MILLI))
    });
    Some(format!(
        "tip {}: at most {most:.3} mm and {turned:.4}° off{}",
        tip.frame,
        bound.unwrap_or_default()
    ))
}

/// One sentence.
pub(crate) fn verdict(metrics: &Metrics, divergence: Option<&Divergence>) -> String {
    if let Some(d) = divergence {
        return format!("DIVERGED at t = {:.3} s on joint {}; the run was stopped", d.t, d.joint);
    }
    let untracked = metrics.untracked_steady_samples;
    if untracked > 0 {
        let (steady, seconds) = (metrics.steady_samples, metrics.settle_s);
        return format!(
            "NOT FOLLOWED: in {untracked} of {steady} samples after the first {seconds} s the supervisor did not let \
                the arm follow its motion"
        );
    }
    let stated = metrics.joints.iter().any(|j| {
        j.error_bound_rad.is_some()
            || j.error_integral_bound_rad_s.is_some()
            || j.velocity_error_bound_rad_s.is_some()
    });
    let tip = metrics.tip.as_ref().filter(|tip| tip.error_bound_m.is_some());
    let stated = stated || tip.is_some();
    let steady = format!("after the first {} s", metrics.settle_s);
    if !stated {
        return format!("the study states no bound; maxima are taken {steady}");
    }
    let joints = metrics.joints.iter().filter(|j| !j.within_spec()).map(|j| j.name.as_str());
    let beyond: Vec<&str> =
        joints.chain(tip.filter(|tip| !tip.within_spec()).map(|_| "the tip")).collect();
    if metrics.within_spec {
        let on = match metrics.joints.len() {
            1 => String::new(),
            joints => format!(" on all {joints} joints"),
        };
        let within = format!("within spec{on} {steady}");
        match limits_acted(metrics) {
            Some(limited) => format!("{within}, BUT {limited}"),
            None => within,
        }
    } else {
        format!("OUT OF SPEC on {} {steady}", beyond.join(", "))
    }
}

/// Promised and measured, joint by joint, and whether any sample left the tube.
pub(crate) fn tube(run: &TubeRun, metrics: &Metrics) -> String {
    let mut table = plain_table([
        "joint",
        "max |e|\nmrad",
        "tube\nmrad",
        "tube /\nmeasured",
        "max |ė|\nmrad/s",
        "tube\nmrad/s",
        "least distance\nfrom its edge, mrad",
    ]);
    for joint in &run.kept.joints {
        let edge = if joint.room_rad < 0.0 { " !" } else { "" };
        let slides = metrics.joints.iter().any(|own| own.slides && own.name == joint.name);
        let error = |rad: f64| in_unit(figure(rad * MILLI, 3), "mrad", slides);
        let velocity = |rad_s: f64| in_unit(figure(rad_s * MILLI, 1), "mrad/s", slides);
        table.add_row([
            joint.name.clone(),
            error(joint.error_peak_rad),
            error(joint.error_bound_rad),
            format!("{:.2}", joint.error_bound_rad / joint.error_peak_rad),
            velocity(joint.velocity_error_peak_rad_s),
            velocity(joint.velocity_error_bound_rad_s),
            format!("{}{edge}", error(joint.room_rad)),
        ]);
    }
    align(&mut table);
    let steady = format!("maxima from t = {} s on", run.kept.settle_s);
    let sentence = run.sentence();
    match run.broken() {
        Some(_) => format!("{table}\n({steady})\nOUTSIDE ITS TUBE: {sentence}"),
        None => format!("{table}\n({steady}) {sentence}"),
    }
}
