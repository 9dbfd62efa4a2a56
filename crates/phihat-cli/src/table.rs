//! Tables and sentences for the terminal. Units are converted here for reading, nothing else.

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{Cell, CellAlignment, Table};
use phihat_sim::{Divergence, JointMetrics, Metrics};
use phihat_study::{Study, VelocitySource};

/// Thousandths, for reading: mrad, mrad·s, mrad/s.
const MILLI: f64 = 1e3;

/// One row per joint.
pub(crate) fn metrics(metrics: &Metrics) -> Table {
    let mut table = Table::new();
    table.load_preset(UTF8_HORIZONTAL_ONLY);
    table.set_header([
        "joint", "rms e", "max |e|", "max |∫e|", "max |ė|", "peak |τ|", "max Δτ", "satur.", "max |φ|",
        "max |φ−φ̂|",
    ]);
    table.add_row([
        "", "mrad", "mrad", "mrad·s", "mrad/s", "N·m", "N·m/sample", "samples", "N·m", "N·m",
    ]);
    for joint in &metrics.joints {
        table.add_row(row(joint));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn row(joint: &JointMetrics) -> Vec<Cell> {
    let text = |text: String| Cell::new(text);
    vec![
        text(joint.name.clone()),
        text(format!("{:.4}", joint.error_rms_rad * MILLI)),
        text(against(joint.error_steady_max_rad * MILLI, joint.error_spec_rad.map(|s| s * MILLI))),
        text(against(
            joint.error_integral_steady_max_rad_s * MILLI,
            joint.error_integral_spec_rad_s.map(|s| s * MILLI),
        )),
        text(against(
            joint.velocity_error_steady_max_rad_s * MILLI,
            joint.velocity_error_spec_rad_s.map(|s| s * MILLI),
        )),
        text(against_limit(joint.tau_max_nm, joint.tau_limit_nm)),
        text(against_limit(joint.tau_step_max_nm, joint.tau_step_limit_nm)),
        text(joint.saturated_samples.to_string()),
        text(format!("{:.2}", joint.phi_max_nm)),
        text(format!("{:.2}", joint.phi_error_steady_max_nm)),
    ]
}

/// A value and the bound it must stay below.
fn against(value: f64, bound: Option<f64>) -> String {
    match bound {
        Some(bound) if value <= bound => format!("{value:.3} ≤ {bound:.3}"),
        Some(bound) => format!("{value:.3} > {bound:.3} !"),
        None => format!("{value:.3}"),
    }
}

fn against_limit(value: f64, limit: Option<f64>) -> String {
    limit.map_or_else(|| format!("{value:.2}"), |limit| format!("{value:.2} of {limit}"))
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
    lines.push(("plant".to_owned(), format!("RK4, {} step(s) per sample", world.substeps)));
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
