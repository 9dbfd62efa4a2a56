//! Numbers for tests that look random and are the same in every run.

/// A linear congruential generator.
pub(crate) struct CheckDice(pub(crate) u64);

impl CheckDice {
    /// A number in [−1, 1].
    pub(crate) fn roll(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * ((self.0 >> 33) as f64 / f64::from(1_u32 << 31)) - 1.0
    }
}
