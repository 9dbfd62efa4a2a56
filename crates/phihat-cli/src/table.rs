//! Tables and sentences for the terminal. Units are converted here for reading, nothing else.

use comfy_table::presets::UTF8_BORDERS_ONLY;
use comfy_table::{CellAlignment, Table};
use phihat_design::{Certificate, Gains, Infeasible};
use phihat_model::{InertiaRange, Robot};
use phihat_sim::{Abort, Divergence, JointMetrics, Metrics};
use phihat_study::{Study, VelocitySource};

/// Thousandths, for reading: mrad, mrad·s, mrad/s.
const MILLI: f64 = 1e3;

/// A torque held at its limit may differ from it by rounding.
const ROUNDING: f64 = 1e-9;

/// One measured figure of every joint, and the bound it must keep, both in the unit of the heading.
struct Column {
    heading: &'static str,
    unit: &'static str,
    decimals: usize,
    value: fn(&JointMetrics) -> f64,
    bound: fn(&JointMetrics) -> Option<f64>,
}

const COLUMNS: [Column; 9] = [
    Column::free("rms e", "mrad", 4, |j| j.error_rms_rad * MILLI),
    Column {
        heading: "max |e|",
        unit: "mrad",
        decimals: 3,
        value: |j| j.error_steady_max_rad * MILLI,
        bound: |j| j.error_spec_rad.map(|b| b * MILLI),
    },
    Column {
        heading: "max |∫e|",
        unit: "mrad·s",
        decimals: 3,
        value: |j| j.error_integral_steady_max_rad_s * MILLI,
        bound: |j| j.error_integral_spec_rad_s.map(|b| b * MILLI),
    },
    Column {
        heading: "max |ė|",
        unit: "mrad/s",
        decimals: 1,
        value: |j| j.velocity_error_steady_max_rad_s * MILLI,
        bound: |j| j.velocity_error_spec_rad_s.map(|b| b * MILLI),
    },
    Column {
        heading: "peak |τ|",
        unit: "N·m",
        decimals: 1,
        value: |j| j.tau_max_nm,
        bound: |j| j.tau_limit_nm,
    },
    Column {
        heading: "max |Δτ|",
        unit: "N·m/sample",
        decimals: 2,
        value: |j| j.tau_step_max_nm,
        bound: |j| j.tau_step_limit_nm,
    },
    Column::free("saturated", "samples", 0, |j| j.saturated_samples as f64),
    Column::free("max |φ|", "N·m", 2, |j| j.phi_max_nm),
    Column::free("max |φ−φ̂|", "N·m", 2, |j| j.phi_error_steady_max_nm),
];

impl Column {
    const fn free(
        heading: &'static str,
        unit: &'static str,
        decimals: usize,
        value: fn(&JointMetrics) -> f64,
    ) -> Self {
        Self { heading, unit, decimals, value, bound: |_| None }
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

    fn cell(&self, joint: &JointMetrics, shared: bool) -> String {
        let value = (self.value)(joint);
        let figure = format!("{value:.*}", self.decimals);
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

/// One row per joint. "Steady" figures are those after the start-up; a `!` marks a bound exceeded.
pub(crate) fn metrics(metrics: &Metrics) -> Table {
    let joints = &metrics.joints;
    let shared: Vec<Option<f64>> = COLUMNS.iter().map(|c| c.shared(joints)).collect();
    let mut table = Table::new();
    table.load_style(UTF8_BORDERS_ONLY);
    let headers = COLUMNS.iter().zip(&shared).map(|(c, s)| c.header(*s));
    table.set_header(std::iter::once("joint".to_owned()).chain(headers));
    for joint in joints {
        let cells = COLUMNS.iter().zip(&shared).map(|(c, s)| c.cell(joint, s.is_some()));
        table.add_row(std::iter::once(joint.name.clone()).chain(cells));
    }
    align(&mut table);
    table
}

/// Figures to the right, names to the left, one space around.
fn align(table: &mut Table) {
    for column in table.column_iter_mut() {
        column.set_padding((0, 1));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
}

/// One sentence.
pub(crate) fn verdict(metrics: &Metrics, divergence: Option<&Divergence>) -> String {
    if let Some(d) = divergence {
        return format!("DIVERGED at t = {:.3} s on joint {}; the run was stopped", d.t, d.joint);
    }
    let stated = metrics.joints.iter().any(|j| {
        j.error_spec_rad.is_some()
            || j.error_integral_spec_rad_s.is_some()
            || j.velocity_error_spec_rad_s.is_some()
    });
    let steady = format!("after the first {} s", metrics.settle_s);
    if !stated {
        return format!("the study states no bound; maxima are taken {steady}");
    }
    let beyond: Vec<&str> =
        metrics.joints.iter().filter(|j| !j.within_spec()).map(|j| j.name.as_str()).collect();
    if metrics.within_spec {
        format!("within spec on all {} joints {steady}", metrics.joints.len())
    } else {
        format!("OUT OF SPEC on {} {steady}", beyond.join(", "))
    }
}

/// One sentence.
pub(crate) fn abort(abort: &Abort) -> String {
    let on = abort.joint.as_ref().map_or_else(String::new, |joint| format!(" on {joint}"));
    format!(
        "STOPPED by the robot ({}) at t = {:.3} s{on}: {}",
        abort.interface, abort.t, abort.reason
    )
}

/// What was in the world, for the report.
pub(crate) fn world(study: &Study) -> Vec<(String, String)> {
    let world = &study.world;
    let mut lines = vec![
        ("gravity".to_owned(), format!("{:?} m/s²", world.gravity)),
        ("identified friction of the robot".to_owned(), yes_no(world.robot_friction)),
        ("Coulomb friction on top".to_owned(), per_joint(&world.extra_coulomb, "N·m")),
        ("viscous friction on top".to_owned(), per_joint(&world.extra_viscous, "N·m·s/rad")),
    ];
    let rotor: Vec<f64> = study.robot.joints.iter().map(|j| j.armature).collect();
    lines.push(("rotor inertia".to_owned(), per_joint(&rotor, "kg·m²")));
    if let Some(payload) = &world.payload {
        let text = format!("{} kg at {}, unknown to the controller", payload.mass, payload.frame);
        lines.push(("payload".to_owned(), text));
    }
    for push in &world.pushes {
        let joint = &study.robot.joints[push.joint].name;
        let text = format!("{} N·m at t = {} s for {} s", push.torque, push.start, push.duration);
        lines.push((format!("push on {joint}"), text));
    }
    if let Some(bandwidth) = &world.drive_bandwidth_hz {
        lines.push(("drive bandwidth".to_owned(), per_joint(bandwidth, "Hz")));
    }
    if let Some(bits) = &study.sensor.encoder_bits {
        let bits: Vec<f64> = bits.iter().map(|b| f64::from(*b)).collect();
        lines.push(("encoder".to_owned(), per_joint(&bits, "bit per turn")));
    }
    let velocity = match study.sensor.velocity {
        VelocitySource::Measured => "measured",
        VelocitySource::Differenced => "differenced from the encoder",
    };
    lines.push(("velocity".to_owned(), velocity.to_owned()));
    if let Some(filter) = study.sensor.velocity_filter_hz {
        lines.push(("velocity filter".to_owned(), format!("first order, {filter} Hz")));
    }
    lines.extend(trouble(study));
    lines.push(("plant".to_owned(), format!("RK4, {} step(s) per sample", world.substeps)));
    lines
}

/// The torque interface and what goes wrong.
fn trouble(study: &Study) -> Vec<(String, String)> {
    let profile = &study.interface.profile;
    let interface = format!("{}: {}", profile.name, profile.description);
    let mut lines = vec![("torque interface".to_owned(), interface)];
    for fault in &study.faults {
        let joint = fault.joint.map_or("", |joint| study.robot.joints[joint].name.as_str());
        let until = if fault.duration.is_finite() {
            format!("for {} s", fault.duration)
        } else {
            "to the end".to_owned()
        };
        let what =
            format!("{} {}, from t = {} s {until}", fault.size, fault.kind.unit(), fault.start);
        lines.push((format!("fault {} {joint}", fault.kind.word()), what.replace(" ,", ",")));
    }
    lines
}

fn yes_no(value: bool) -> String {
    if value { "acts" } else { "off" }.to_owned()
}

/// One figure when all joints share it.
fn per_joint(values: &[f64], unit: &str) -> String {
    match values {
        [first, rest @ ..] if rest.iter().all(|v| v.to_bits() == first.to_bits()) => {
            format!("{first} {unit} on every joint")
        }
        _ => {
            let list: Vec<String> = values.iter().map(f64::to_string).collect();
            format!("{} {unit}", list.join(", "))
        }
    }
}

/// One row per arm.
pub(crate) fn robots(robots: &[Robot]) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_BORDERS_ONLY);
    table.set_header(["name", "joints", "description"]);
    for robot in robots {
        let joints = robot.joints.len().to_string();
        table.add_row([robot.name.clone(), joints, robot.description.clone()]);
    }
    table
}

/// One row per joint of an arm.
pub(crate) fn joints(robot: &Robot, range: &InertiaRange) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_BORDERS_ONLY);
    table.set_header([
        "joint",
        "position\nrad",
        "|q̇| max\nrad/s",
        "|τ| max\nN·m",
        "|τ̇| max\nN·m/s",
        "rotor\nkg·m²",
        "M_ii range\nkg·m²",
        "good M̄\nkg·m²",
        "Coulomb\nN·m",
        "encoder\nbit",
    ]);
    for (i, joint) in robot.joints.iter().enumerate() {
        let limits = joint.position.map(|(low, high)| format!("{low:.2} … {high:.2}"));
        table.add_row([
            joint.name.clone(),
            limits.unwrap_or_else(|| "–".to_owned()),
            stated(joint.velocity_max),
            stated(joint.torque_max),
            stated(joint.torque_rate_max),
            format!("{:.3}", joint.armature),
            format!("{:.3} … {:.3}", range.min[i], range.max[i]),
            format!("{:.3}", range.mean[i]),
            format!("{}", joint.friction.coulomb),
            joint.encoder_bits.map_or_else(|| "–".to_owned(), |bits| bits.to_string()),
        ]);
    }
    align(&mut table);
    table
}

fn stated(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| value.to_string())
}

fn plain_table<const N: usize>(headers: [&str; N]) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_BORDERS_ONLY);
    table.set_header(headers);
    table
}

/// One row of gains per joint.
pub(crate) fn gains(gains: &Gains) -> Table {
    let mut table =
        plain_table(["joint", "M̄\nkg·m²", "K_p\n1/s²", "K_d\n1/s", "m", "a_0 … a_(m−1)"]);
    for joint in &gains.joints {
        let a: Vec<String> = joint.a.iter().map(|a| format!("{a:.1}")).collect();
        table.add_row([
            joint.name.clone(),
            format!("{:.4}", joint.inertia_kg_m2),
            format!("{:.1}", joint.kp_per_s2),
            format!("{:.2}", joint.kd_per_s),
            joint.a.len().to_string(),
            a.join(", "),
        ]);
    }
    align(&mut table);
    table
}

/// What is claimed, one row per joint.
pub(crate) fn certificate(certificate: &Certificate) -> String {
    let mut table = plain_table([
        "joint",
        "bound |e|\nmrad",
        "bound |ė|\nmrad/s",
        "window\nμ",
        "gain margin\n÷ … ×",
        "phase\n°",
        "delay\nms",
        "modulus",
        "|Δτ| from encoder\nN·m, rms / bound",
        "largest step\nmrad",
    ]);
    for joint in &certificate.joints {
        let bound = |value: Option<f64>, decimals: usize| {
            value.map_or_else(|| "–".to_owned(), |v| format!("{:.*}", decimals, v * MILLI))
        };
        let noise = joint.noise.as_ref().map_or_else(
            || "–".to_owned(),
            |n| format!("{:.3} / {:.3}", n.change_rms_nm, n.change_max_nm),
        );
        table.add_row([
            joint.name.clone(),
            bound(joint.bounds.map(|b| b.error_rad), 3),
            bound(joint.bounds.map(|b| b.velocity_error_rad_s), 1),
            format!("{:.3} … {:.2}", joint.window.low, joint.window.high),
            format!("{:.2} … {:.2}", joint.margins.gain_down, joint.margins.gain_up),
            format!("{:.0}", joint.margins.phase_deg),
            format!("{:.1}", joint.margins.delay_s * MILLI),
            format!("{:.2}", joint.margins.modulus),
            noise,
            bound(joint.step.step_rad, 2),
        ]);
    }
    align(&mut table);
    let arm = &certificate.arm;
    let inside = format!(
        "the arm's inertia: μ = {:.3} … {:.3}, inside every window by a factor of {} at both ends",
        arm.low, arm.high, certificate.window_margin
    );
    let optimal = certificate.joints.first().map_or_else(String::new, |joint| {
        let gamma = joint.attenuation.gamma_return_difference;
        gamma.map_or_else(
            || "no H-infinity level: the return difference fails".to_owned(),
            |gamma| format!("inverse optimal for every H-infinity level γ > {gamma:.4}"),
        )
    });
    format!("{table}\n{inside}\n({})\n{optimal}", arm.source)
}

/// Why no gains keep every clause.
pub(crate) fn infeasible(no: &Infeasible) -> String {
    let mut lines = vec![format!(
        "NO GAINS keep every clause: {} laws tried, with up to three nominal inertias each; {} keep the \
         stability window and margin",
        no.tried, no.stable
    )];
    for clause in &no.clauses {
        let joint = clause.joint.as_ref().map_or_else(String::new, |j| format!(" on {j}"));
        let possible = clause.possible.map_or_else(
            || "no value alone makes it possible".to_owned(),
            |value| format!("{value:.3e} is possible while all others stand"),
        );
        lines.push(format!("  {}{joint}: {:.3e} is wanted, {possible}", clause.key, clause.wanted));
    }
    lines.push(
        "a higher loop rate, less delay or a slower velocity filter change what is possible".into(),
    );
    lines.join("\n")
}
