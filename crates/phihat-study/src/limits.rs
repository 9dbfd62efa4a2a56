//! The torque limits in force: the study's own, and those of the robot's interface that the controller keeps.

use crate::Study;

impl Study {
    /// Largest |τ| \[N·m\] and largest |τ̇| \[N·m/s\] that the controller gives a joint; `None`: no limit. The
    /// smaller one where study and `[profile]` both state one.
    pub fn limits(&self, joint: usize) -> (Option<f64>, Option<f64>) {
        let per = |values: &Option<Vec<f64>>| values.as_ref().map(|v| v[joint]);
        let (torque, rate) = (per(&self.control.torque_max), per(&self.control.torque_rate_max));
        if !self.interface.kept {
            return (torque, rate);
        }
        let profile = &self.interface.profile;
        let most = self.robot.joints[joint].torque_max.filter(|_| profile.clamps_torque);
        (smaller(torque, most), smaller(rate, profile.torque_rate_max))
    }
}

/// The smaller of two limits, where there are two.
fn smaller(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.min(b)),
        (a, b) => a.or(b),
    }
}
