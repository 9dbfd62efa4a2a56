//! Limits that acted in the steady part of a run: no claim about gains speaks of those samples.

use phihat_sim::{JointMetrics, Metrics};

use crate::kit::number::{percent, stated};
use crate::kit::text::line;

/// Joints named for each limit; the others are counted.
const NAMED: usize = 3;

/// Number of commands in a joint's steady part that met a limit.
type Met = fn(&JointMetrics) -> u64;

/// Limits that acted in a run after its `settle_s`, in words; `None`: none did.
///
/// "the torque-rate limit acted in 30 % of the samples of joint2 (4.3 % of all joints') after t = 2 s: no certificate
/// speaks of that"
pub fn limits_acted(metrics: &Metrics) -> Option<String> {
    let limits: [(&str, Met); 2] = [
        ("the torque limit", |joint| joint.saturated_steady_samples),
        ("the torque-rate limit", |joint| joint.rate_limited_steady_samples),
    ];
    let phrases = limits.iter().filter_map(|(name, met)| phrase(metrics, name, *met));
    let phrases: Vec<String> = phrases.collect();
    if phrases.is_empty() {
        return None;
    }
    let settle = stated(metrics.settle_s);
    Some(format!("{} after t = {settle} s: no certificate speaks of that", phrases.join(", and ")))
}

fn phrase(metrics: &Metrics, limit: &str, met: Met) -> Option<String> {
    let mut acted: Vec<(&JointMetrics, u64)> =
        metrics.joints.iter().map(|joint| (joint, met(joint))).filter(|(_, n)| *n > 0).collect();
    acted.sort_by_key(|(_, n)| core::cmp::Reverse(*n));
    let total: u64 = acted.iter().map(|(_, n)| n).sum();
    let steady = metrics.steady_samples as f64;
    let named = acted.iter().take(NAMED).map(|(joint, n)| {
        format!("{} of the samples of {}", percent(*n as f64, steady), line(&joint.name))
    });
    let mut named: Vec<String> = named.collect();
    match acted.len().saturating_sub(NAMED) {
        0 => {}
        1 => named.push("some of 1 more joint".to_owned()),
        more => named.push(format!("some of {more} more joints")),
    }
    let all = percent(total as f64, steady * metrics.joints.len() as f64);
    let of_all = if metrics.joints.len() > 1 { format!(" ({all} of all)") } else { String::new() };
    (total > 0).then(|| format!("{limit} acted in {}{of_all}", named.join(", ")))
}
