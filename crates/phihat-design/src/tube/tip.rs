//! The tip of the arm along a tube: lever arms of all joints along the motion.

use phihat_certificate::extremes::larger;
use phihat_certificate::{Tube, TubeTip};
use phihat_model::{JointKind, Workspace};
use phihat_study::Study;

use super::desired::Desired;

/// Significant digits of a lever arm, rounded up.
const DIGITS: f64 = 4.0;

/// Lever arms of the tip along the joints' tubes, by the Jacobian's columns, see [`TubeTip`]. Its summaries
/// are 0 until [`Tube::steady_from`] sums them up. `None`: the robot's description names no such frame.
pub fn tip_along(study: &Study, desired: &Desired, tube: &Tube) -> Option<TubeTip> {
    let robot = &study.robot;
    let frame = robot.model.frame(&robot.tip)?;
    let (n, bins) = (tube.joints.len(), tube.bins());
    let mut workspace = Workspace::new(&robot.model);
    let mut columns = vec![0.0; 6 * n];
    let (mut levers, mut turns) = (vec![vec![0.0_f64; bins]; n], vec![false; n]);
    for (k, q) in desired.q.chunks_exact(n).enumerate() {
        let bin = tube.bin_of(k as u64 * study.control.period_ns);
        robot.model.jacobian(&mut workspace, q, frame, &mut columns);
        for i in 0..n {
            let norm = |rows: core::ops::Range<usize>| {
                let squares = rows.map(|row| columns[row * n + i] * columns[row * n + i]);
                squares.sum::<f64>().sqrt()
            };
            let lever = outward(norm(0..3));
            if let Some(most) = levers[i].get_mut(bin) {
                *most = larger(*most, lever);
            }
            turns[i] |= norm(3..6) > 0.5 && robot.joints[i].kind != JointKind::Prismatic;
        }
    }
    let frame = robot.tip.clone();
    Some(TubeTip { frame, turns, lever_m: levers, error_bound_m: 0.0, angle_max_rad: 0.0 })
}

/// A size with a few digits, not smaller; of nothing a hair.
fn outward(size: f64) -> f64 {
    if size <= 1e-12 {
        return 1e-12;
    }
    let power = (DIGITS - 1.0) - libm::log10(size).floor();
    let unit = libm::pow(10.0, power);
    (size * (1.0 + 1e-12) * unit).ceil() / unit
}
