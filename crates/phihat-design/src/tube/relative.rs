//! The sweep's bounds, put around the reference.

use phihat_certificate::extremes::{hull, larger};

use super::envelope::{Envelope, JointEnvelope};
use super::nominal::NominalRun;
use super::refusal::TubeRefusal;
use super::scene::Scene;
use super::sweep::Bin;

/// Bounds relative to the reference, and that no limit acts.
pub(super) fn relative(
    scene: &Scene<'_>,
    nominal: &NominalRun,
    bin: usize,
    results: &[Bin],
) -> Result<Envelope, TubeRefusal> {
    let n = scene.n;
    let mut joints = vec![JointEnvelope::default(); n];
    for (b, result) in results.iter().enumerate() {
        let from = b * bin;
        let rows = result.command.len() / n;
        for (i, joint) in joints.iter_mut().enumerate() {
            let none = (f64::INFINITY, f64::NEG_INFINITY);
            let (mut error, mut velocity) = (none, none);
            let (mut torque, mut step) = (0.0_f64, 0.0_f64);
            for row in 0..rows {
                let k = from + row;
                let at = k * n + i;
                let wide = |out: &mut (f64, f64), middle: f64, around: (f64, f64)| {
                    *out = hull([*out, (middle + around.0, middle + around.1)].into_iter());
                };
                wide(&mut error, nominal.q[at] - scene.desired.q[at], result.e[row * n + i]);
                wide(&mut velocity, nominal.dq[at] - scene.desired.dq[at], result.v[row * n + i]);
                let own = result.command[row * n + i];
                let middle = nominal.command[at];
                let most_torque = larger(middle + own.1, -(middle + own.0));
                let before = if k > 0 { nominal.command[at - n] } else { scene.held[i] };
                let own = result.change[row * n + i];
                let change = larger(middle - before + own.1, -(middle - before + own.0));
                let (most, most_step) = scene.limits[i];
                let inside = |x: f64, limit: f64| x <= limit;
                if !inside(most_torque, most) || !inside(change, most_step) {
                    let t = k as f64 * scene.period;
                    let joint = scene.names[i].clone();
                    return Err(TubeRefusal::Limit {
                        joint,
                        t,
                        torque: !inside(most_torque, most),
                    });
                }
                torque = larger(torque, most_torque);
                step = larger(step, change);
            }
            joint.error.push(error);
            joint.velocity.push(velocity);
            joint.torque.push(torque);
            joint.step.push(step);
        }
    }
    Ok(Envelope { bin_s: bin as f64 * scene.period, joints, slices: 1 })
}
