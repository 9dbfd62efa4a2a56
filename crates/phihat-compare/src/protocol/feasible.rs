//! Candidates under constraints, in one order.

use serde::{Deserialize, Serialize};

/// Caps on torque noise, over the joint's torque limit, worst joint: one tuning each.
pub const CAPS: [f64; 5] = [5e-4, 1e-3, 2e-3, 5e-3, 1e-2];

/// Largest violation that still tells two candidates apart: everything beyond is as bad.
const HOPELESS: f64 = 1e12;

/// Result of a candidate over all worlds that it was tried in.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Assessed {
    /// Objective where all constraints are satisfied, 0 or more: an error \[rad\], or the exponential of the
    /// mean of its logarithm.
    pub error: f64,
    /// Sum of the violations of constraints, each over its own limit; 0: all are satisfied. NaN counts as the
    /// largest violation.
    pub violation: f64,
}

impl Assessed {
    /// The same with one more constraint: `value` up to `limit`, `limit` above 0.
    #[must_use]
    pub fn within(self, value: f64, limit: f64) -> Self {
        let over = if value.is_nan() { HOPELESS } else { (value / limit - 1.0).max(0.0) };
        Self { violation: self.violation + over, ..self }
    }

    /// The same with one more worlds' worth of an all-or-nothing constraint, such as to survive.
    #[must_use]
    pub fn provided(self, kept: bool) -> Self {
        Self { violation: self.violation + if kept { 0.0 } else { 1.0 }, ..self }
    }

    /// Returns true if every constraint is satisfied.
    pub fn feasible(&self) -> bool {
        self.violation <= 0.0
    }

    /// One number in the order of [`better`], for optimisers that go by order alone:
    ///
    /// ```text
    /// e/(1 + e) where feasible,     else 1 + v                                          (1)
    /// ```
    pub fn cost(&self) -> f64 {
        if self.feasible() && !self.error.is_nan() {
            return if self.error.is_finite() { self.error / (1.0 + self.error) } else { 1.0 };
        }
        let violation = if self.violation.is_nan() { HOPELESS } else { self.violation };
        1.0 + violation.clamp(f64::MIN_POSITIVE, HOPELESS)
    }
}

/// Returns true if one candidate is better than another: feasible before infeasible ones, of feasible ones
/// the smaller error, of infeasible ones the smaller violation. No weight between the two has to be chosen.
///
/// # References
///
/// K. Deb, "An efficient constraint handling method for genetic algorithms", Computer Methods in Applied
/// Mechanics and Engineering 186, 2000.
pub fn better(one: &Assessed, other: &Assessed) -> bool {
    match (one.feasible(), other.feasible()) {
        (true, true) => one.error < other.error,
        (false, false) => one.violation < other.violation,
        (kept, _) => kept,
    }
}

#[cfg(test)]
mod tests {
    use super::{Assessed, better};
    use phihat_session::Dice;

    /// The number is in the order of the rules, for every pair of many draws; and violations add up.
    #[test]
    fn the_cost_orders_as_the_rules_do() {
        let mut dice = Dice::new(9, 0);
        let mut drawn = || {
            let kept = dice.chance(0.5);
            let violation = if kept { 0.0 } else { dice.log_between(1e-6, 1e6) };
            Assessed { error: dice.log_between(1e-7, 10.0), violation }
        };
        let all: Vec<Assessed> = (0..60).map(|_| drawn()).collect();
        for a in &all {
            for b in &all {
                assert_eq!(better(a, b), a.cost() < b.cost(), "{a:?} {b:?}");
            }
        }
        let one = Assessed { error: 1.0, violation: 0.0 };
        assert!(one.within(0.9, 1.0).feasible());
        let broken = one.within(3.0, 2.0).within(1.0, 4.0).provided(false);
        assert!((broken.violation - 1.5).abs() < 1e-12 && broken.cost() > one.cost());
        assert!(!one.within(f64::NAN, 1.0).feasible());
        assert!(one.within(f64::NAN, 1.0).cost().is_finite());
    }
}
