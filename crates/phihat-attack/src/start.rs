//! Torque that holds an arm before the first sample.

use phihat_sim::{Motion, SimError};
use phihat_study::Study;

/// Torque \[N·m\] per joint that holds a study's arm where its run begins; `None`: nothing does.
///
/// # Errors
///
/// [`SimError`]: it begins nowhere, since its reference cannot be followed.
pub(crate) fn held_at_start(study: &Study) -> Result<Option<Vec<f64>>, SimError> {
    if study.world.held.is_none() {
        return Ok(None);
    }
    let q = if let Some(start) = &study.world.start {
        start.q.clone()
    } else {
        let motion = Motion::of(study)?;
        (0..study.robot.joints.len()).map(|joint| motion.told(joint, 0.0)[0]).collect()
    };
    Ok(study.held_torque(&q))
}
