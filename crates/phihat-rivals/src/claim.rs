//! Claims of a law before a run, and the declared properties of the arm on which they are based.

use serde::Serialize;

/// Declared properties of an arm, its load and its loop before a run. The judge fills them in; rivals only
/// read them in their claims, never in their law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeclaredArm {
    /// Smallest eigenvalue of `M(q)` over the postures \[kg·m²\].
    pub inertia_min: f64,
    /// Largest eigenvalue of `M(q)` over the postures \[kg·m²\].
    pub inertia_max: f64,
    /// Range of the eigenvalues of `U^{-1/2} M(q) U^{-1/2}`, `U` the units of the tuning: `[low, high]`.
    pub ratio: [f64; 2],
    /// Transport delay \[samples\].
    pub delay_samples: u32,
    /// Largest |φ̇| of the smooth part of `φ = τ − U q̈` along the task \[N·m/s\] per joint.
    pub phi_rate: Vec<f64>,
    /// Largest size of the part of φ that jumps \[N·m\] per joint.
    pub phi_jump: Vec<f64>,
    /// Largest |φ| \[N·m\] per joint.
    pub phi_max: Vec<f64>,
    /// Largest torque that the motion demands, `|τ| = |φ + U q̈_d|` \[N·m\] per joint.
    pub demand_max: Vec<f64>,
}

impl DeclaredArm {
    /// Smallest inertia ratio `μ` at which a sampled velocity feedback of `gain` \[1/s\] per unit of inertia is
    /// stable behind the arm's delay of `d` samples:
    ///
    /// ```text
    /// gain T < 2 cos(π d / (2d + 1)) μ          2 μ without delay, μ with one sample
    /// ```
    ///
    /// S. A. Levin, R. M. May, "A note on difference-delay equations", Theor. Population Biology 9, 1976.
    pub fn ratio_min(&self, gain: f64, period: f64) -> f64 {
        let d = f64::from(self.delay_samples);
        gain * period / (2.0 * (core::f64::consts::PI * d / (2.0 * d + 1.0)).cos())
    }
}

/// A stability condition and whether it holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Condition {
    /// The condition: `K_P² > 2 K_I`.
    pub text: &'static str,
    /// True if it holds for the arm and the tuning.
    pub holds: bool,
    /// Left side over right side where it is an inequality: above 1 it holds.
    pub margin: f64,
}

impl Condition {
    /// The condition that `larger` is above `smaller`, both positive.
    pub fn above(text: &'static str, larger: f64, smaller: f64) -> Self {
        Self { text, holds: larger > smaller, margin: larger / smaller }
    }

    /// The condition that the arm's range of inertia ratios is inside a window.
    pub fn inside(text: &'static str, ratio: [f64; 2], window: [f64; 2]) -> Self {
        let ([low, high], [floor, ceiling]) = (ratio, window);
        let holds = low > floor && high < ceiling;
        Self { text, holds, margin: (low / floor).min(ceiling / high) }
    }

    /// Both conditions at once, under the text of this one.
    #[must_use]
    pub fn and(self, other: &Self) -> Self {
        let margin = self.margin.min(other.margin);
        Self { text: self.text, holds: self.holds && other.holds, margin }
    }

    /// The condition that the arm's smallest inertia ratio is above [`DeclaredArm::ratio_min`] of a velocity
    /// gain \[1/s\].
    pub fn sampled(text: &'static str, gain: f64, period: f64, arm: &DeclaredArm) -> Self {
        Self::above(text, arm.ratio[0], arm.ratio_min(gain, period))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The delayed velocity loop itself, `v ← v − (gain T/μ) v` of `d` samples ago, 2 % inside and outside.
    #[test]
    fn the_smallest_inertia_is_where_the_delayed_loop_turns() {
        for delay_samples in 0..5 {
            let none = vec![];
            let arm = DeclaredArm {
                inertia_min: 0.0,
                inertia_max: 0.0,
                ratio: [1.0, 1.0],
                delay_samples,
                phi_rate: none.clone(),
                phi_jump: none.clone(),
                phi_max: none.clone(),
                demand_max: none,
            };
            let edge = arm.ratio_min(100.0, 1e-3);
            let grows = |mu: f64| {
                let mut past = vec![1.0; delay_samples as usize + 1];
                for _ in 0..4000 {
                    let next = past[0] - 100.0 * 1e-3 / mu * past[past.len() - 1];
                    past.rotate_right(1);
                    past[0] = next;
                }
                past.iter().any(|v| v.abs() > 1.0)
            };
            assert!(grows(0.98 * edge) && !grows(1.02 * edge), "{delay_samples}: {edge}");
        }
    }
}
