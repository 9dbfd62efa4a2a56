//! Parameters of the ROS 2 `joint_trajectory_controller`.

use core::fmt::Write;

use super::error::ExportError;
use super::notes;
use super::number::{exact, up};
use super::pid::{Pid, PidClaims};
use crate::Gains;

const HOW: [&str; 10] = [
    "Parameters of joint_trajectory_controller (ros2_controllers of Jazzy from mid-2025, Kilted and later)",
    "for effort commands. ROS 2 counts its error as q_d - q, so that p, i, d are positive.",
    "  - Feed-forward: set `effort` of every trajectory point to M qdd_d of the joint (M below). Versions",
    "    that ignore it add nothing: then the error is that without feed-forward, below.",
    "  - i_clamp_max/min limit the integral term [N m]: to the torque limit; without one, to twice what phi",
    "    can ask for; without either, they are left out (no clamp). u_clamp_max/min is the torque limit.",
    "  - Humble reads i_clamp in place of i_clamp_max/min and no u_clamp; its default of 0 is no integral.",
    "  - The controller manager must run at update_rate; the velocity state interface must be the velocity",
    "    named below. Check the effort limits of your driver: nothing here raises them.",
    "",
];

/// Room of the integral clamp over what `φ` can ask for: start-up, encoder, no feed-forward.
const ROOM: f64 = 2.0;

pub(super) fn text(gains: &Gains) -> Result<String, ExportError> {
    if let Some(hz) = gains.torque_filter_hz {
        return Err(ExportError::TorqueFilter(hz));
    }
    if let Some(joint) = gains.joints.iter().find(|joint| joint.observer.is_some()) {
        let filtered = !joint.innovation_filter().is_empty();
        return Err(ExportError::Positions { joint: joint.name.clone(), filtered });
    }
    let other = gains.joints.iter().find(|joint| joint.a.len() != 1);
    if let Some(joint) = other {
        return Err(ExportError::Order { joint: joint.name.clone(), order: joint.a.len() });
    }
    let rate = gains.rate_hz.round();
    if (gains.rate_hz - rate).abs() > 1e-9 * rate {
        return Err(ExportError::Rate(gains.rate_hz));
    }
    let claims = PidClaims::of(gains).map_err(ExportError::Pid)?;
    let pids = notes::pids(gains).unwrap_or_default();
    let mut lines = notes::origin(gains);
    lines.push(String::new());
    lines.extend(HOW.map(str::to_owned));
    lines.extend(notes::pid(gains, &claims));
    let mut text = notes::commented("#", &lines);
    let names: Vec<String> = gains.joints.iter().map(|joint| quoted(&joint.name)).collect();
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "controller_manager:\n  ros__parameters:\n    update_rate: {rate:.0}\n    joint_trajectory_controller:\n      \
         type: joint_trajectory_controller/JointTrajectoryController\n\njoint_trajectory_controller:\n  \
         ros__parameters:\n    joints:\n"
    );
    for name in &names {
        let _ = writeln!(text, "      - {name}");
    }
    text += "    command_interfaces: [effort]\n    state_interfaces: [position, velocity]\n    gains:\n";
    for (j, (name, pid)) in names.iter().zip(&pids).enumerate() {
        let _ = write!(text, "      {name}:\n{}", joint(pid, torque_max(gains, j), claims.get(j)));
    }
    Ok(text)
}

fn joint(pid: &Pid, torque_max: Option<f64>, claim: Option<&PidClaims>) -> String {
    let mut text = String::new();
    let mut entry = |key: &str, value: &str| {
        let _ = writeln!(text, "        {key}: {value}");
    };
    entry("p", &exact(pid.p));
    entry("i", &exact(pid.i));
    entry("d", &exact(pid.d));
    let needed = claim.and_then(|c| c.integral_nm).map(|size| ROOM * size);
    if let Some(clamp) = torque_max.or(needed) {
        let clamp = if torque_max.is_some() { exact(clamp) } else { decimal(&up(clamp)) };
        entry("i_clamp_max", &clamp);
        entry("i_clamp_min", &format!("-{clamp}"));
        entry("i_clamp", &clamp);
    }
    if let Some(limit) = torque_max {
        entry("u_clamp_max", &exact(limit));
        entry("u_clamp_min", &format!("-{}", exact(limit)));
        entry("antiwindup_strategy", "conditional_integration");
    } else {
        entry("antiwindup_strategy", "none");
    }
    text
}

/// A rounded number as a floating-point one: ROS refuses a whole number for a parameter of type double.
fn decimal(text: &str) -> String {
    text.parse().map_or_else(|_| text.to_owned(), exact)
}

fn torque_max(gains: &Gains, joint: usize) -> Option<f64> {
    gains.certificate.as_ref().and_then(|c| c.joints.get(joint)).and_then(|j| j.limits.0)
}

/// A double-quoted YAML scalar: JSON's escapes are a part of YAML's.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
