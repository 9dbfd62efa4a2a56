//! Filters on the innovation that no design chose.

use core::f64::consts::PI;

use phihat_design::{FilterSection, Gains};
use phihat_session::Dice;

/// Share of typed laws from positions that filter their innovation.
const SHARE: f64 = 0.4;

/// Share of their joints that do.
const JOINTS: f64 = 0.85;

/// Largest weight of a section, relative to the observer's own gain from the innovation.
const MOST: f64 = 0.5;

/// Seed of the innovation filter of typed laws; `None`: no filter. Drawn from their text, so that a study's
/// number draws the same study as before there were filters.
pub(crate) fn seed(gains: &str) -> Option<u64> {
    let seed = gains.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    Dice::at(seed).chance(SHARE).then_some(seed)
}

/// Gives laws from positions random stable filters of one section or two.
pub(crate) fn filter(gains: &mut Gains, period: f64, seed: u64) {
    let mut dice = Dice::new(seed, 1);
    for joint in &mut gains.joints {
        let outer = joint.kp_per_s2.sqrt();
        let (kp, kd) = (joint.kp_per_s2, joint.kd_per_s);
        let Some(own) = &mut joint.observer else { continue };
        if !dice.chance(JOINTS) {
            continue;
        }
        let &[on_e, on_de, on_phi, ..] = own.correction.as_slice() else { continue };
        let unit = kp * on_e.abs() + kd * on_de.abs() + on_phi.abs();
        let sections = 1 + dice.below(2);
        own.innovation_filter =
            (0..sections).map(|_| section(&mut dice, outer * period, unit)).collect();
    }
}

/// A section near a loop's speed \[rad/sample\].
fn section(dice: &mut Dice, speed: f64, unit: f64) -> FilterSection {
    let rate = (speed * dice.log_between(0.2, 20.0)).clamp(1e-3, 0.9 * PI);
    let damping = dice.log_between(0.2, 2.0);
    // The roots of s² + 2 z w s + w², sampled.
    let (sum, product) = if damping < 1.0 {
        let turn = rate * (1.0 - damping * damping).sqrt();
        (2.0 * (-damping * rate).exp() * turn.cos(), (-2.0 * damping * rate).exp())
    } else {
        let split = rate * (damping * damping - 1.0).sqrt();
        let [a, b] = [split, -split].map(|x| (x - damping * rate).exp());
        (a + b, a * b)
    };
    let rates = [1.0 - sum + product, 2.0 - sum];
    let mut weight = || unit * dice.between(-MOST, MOST);
    let held = weight() * rates[0];
    FilterSection { rates, weights_per_s2: [held, held + weight() * rates[1]] }
}
