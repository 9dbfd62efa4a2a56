//! Numbers that nobody could know beforehand, and postures drawn by them.

use phihat_study::MotionClass;

/// Numbers that a seed decides (splitmix64).
pub(super) struct PostureDice(u64);

impl PostureDice {
    /// The stream of a seed: of the SHA-256 of the file and of the reader's number.
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// From 0 up to 1.
    pub(super) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn sign(&mut self) -> f64 {
        if self.share() < 0.5 { -1.0 } else { 1.0 }
    }

    /// Of a box, every second time a corner.
    pub(super) fn place(&mut self, class: &MotionClass) -> Vec<f64> {
        let corner = self.share() < 0.5;
        let ends = class.low.iter().zip(&class.high);
        ends.map(|(low, high)| {
            let share = self.share();
            low + (high - low) * if corner { share.round() } else { share }
        })
        .collect()
    }
}
