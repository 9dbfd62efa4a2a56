//! The bound from below: multipliers played backward through the loop.

use phihat_certificate::extremes::{Extremes as _, larger};

use super::multipliers::{Multipliers, ends};
use super::programme::Programme;

/// Cost that no stable law undercuts, whatever the multipliers: those outside of their box are put on its edge.
///
/// For every law that holds `Σ|s_k| ≤ change`, `s_k = ρ_k − ρ_{k−1}`, with the signals of [`PlayedMultipliers`],
///
/// ```text
/// cost ≥ Σ κ^C C + κ^φ e^φ + κ^n e^n = −β²/2 (x_1 + x_2) + Σ σ_k s_k ≥ −β²/2 (x_1 + x_2) − max|σ_k| change
/// ```
///
/// The sums are over all samples without end. The first step is `|κ| ≤` cost. The second is summation by
/// parts: nothing is left at the end, because a stable loop's responses die out while `x`, `y`, `σ` are
/// constant. A constant may be added to `σ`, as the sum of `s` is 0; half the way between the ends of `σ` is
/// the best.
///
/// # Rounding
///
/// Each recursion but the last has a multiplier as its input, so what was computed is exact for multipliers that differ
/// by the rounding of their sample. Their box is then too small by a share `excess`, and all is linear in them: the
/// bound, divided by `1 + excess`, holds.
pub(super) fn bound(programme: &Programme, multipliers: &Multipliers) -> Option<f64> {
    let change = programme.change?;
    let played = PlayedMultipliers::of(programme, multipliers);
    let (low, high) = played.sigma.iter().copied().chain([0.0]).ends();
    let price = 0.5 * (high - low) + played.slip;
    let bound = (played.value - price * change) / (1.0 + played.excess.iter().sum::<f64>());
    // The last operations round too, and the programme's own numbers.
    Some(bound - SLACK * (played.value.abs() + price * change)).filter(|bound| bound.is_finite())
}

/// Far above the rounding of a dozen operations.
const SLACK: f64 = 1e-12;

/// Multipliers, clamped to their box, played from the last sample to the first:
///
/// ```text
/// y_k = y_{k+1} + κ^C_k                                         of C
/// x_k = 2x_{k+1} − x_{k+2} + κ^φ_k + β y_k                       of e^φ
/// ξ_k = 2ξ_{k+1} − ξ_{k+2} + κ^n_k − β²/2 (x_{k+1} + x_{k+2})   of e^n
/// σ_k = σ_{k+1} + β²/2 (ξ_{k+1+d} + ξ_{k+2+d})                   of ρ_k − ρ_{k−1}
/// ```
///
/// After the last sample `y` and `x` are constant, by `κ^φ = −β y` and `κ^n = β² x`; `κ^C` and `ξ` are 0 and `σ` stays.
struct PlayedMultipliers {
    /// `−β²/2 (x_1 + x_2)`: what `φ`'s impulse does without a law.
    value: f64,
    sigma: Vec<f64>,
    /// Rounding of each signal, over the box of the multiplier that takes it up.
    excess: [f64; 3],
    /// Rounding of `σ`.
    slip: f64,
}

/// Four operations at most, each off by half of the machine's step.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl PlayedMultipliers {
    fn of(programme: &Programme, multipliers: &Multipliers) -> Self {
        let (n, late) = (programme.length, programme.delay + 1);
        let (step, half) = (programme.step, programme.half());
        let [y_most, x_most] = ends(programme);
        let mut y = inside(multipliers.end[0], y_most);
        let mut x = vec![inside(multipliers.end[1], x_most); n + 2];
        let mut xi = vec![0.0; n + late + 1];
        // After the last sample a multiplier is off by the rounding of one product.
        let (mut last, mut excess, mut slip) = (0.0_f64, [ROUNDING; 3], 0.0);
        let mut sigma = vec![0.0; n];
        let mut off = |signal: usize, size: f64, most: f64| {
            if most > 0.0 {
                excess[signal] = larger(excess[signal], ROUNDING * size / most);
            }
        };
        // Where φ does not jump, y takes up what x is off, and κ^C its difference from sample to sample.
        let most = larger(programme.jump, 0.5 * step * programme.ramp);
        for k in (0..n).rev() {
            y += inside(multipliers.ramp[k], programme.ramp);
            off(0, y.abs() + programme.ramp, programme.ramp);
            let pushed = inside(multipliers.jump[k], programme.jump) + step * y;
            x[k] = 2.0 * x[k + 1] - x[k + 2] + pushed;
            let both = x[k + 1].abs() + x[k + 2].abs();
            off(1, 2.0 * both + programme.jump + step * y.abs(), most);
            let pushed = inside(multipliers.read[k], programme.read) - half * (x[k + 1] + x[k + 2]);
            xi[k] = 2.0 * xi[k + 1] - xi[k + 2] + pushed;
            let size = 2.0 * (xi[k + 1].abs() + xi[k + 2].abs()) + programme.read + half * both;
            off(2, size, programme.read);
            last += half * (xi[k + late] + xi[k + late + 1]);
            sigma[k] = last;
            slip += ROUNDING * (last.abs() + half * (xi[k + late].abs() + xi[k + late + 1].abs()));
        }
        Self { value: -half * (x[1] + x[2]), sigma, excess, slip }
    }
}

/// The nearest in the box; what is no number stays none.
fn inside(multiplier: f64, size: f64) -> f64 {
    multiplier.clamp(-size, size)
}

#[cfg(test)]
mod tests {
    use super::{Multipliers, PlayedMultipliers, Programme, bound};
    use crate::limit::law;
    use crate::limit::multipliers::find;
    use crate::limit::responses::Responses;
    use crate::limit::tied::tied;

    /// Numbers in −1 … 1, the same each time.
    fn noise(seed: u32, count: usize) -> Vec<f64> {
        let next = |x: &u32| Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        let all = core::iter::successors(Some(seed), next).skip(1);
        all.take(count).map(|x| f64::from(x) / f64::from(u32::MAX) * 2.0 - 1.0).collect()
    }

    fn programme(delay: usize) -> Programme {
        Programme {
            length: 40,
            delay,
            frequency: 100.0,
            step: 0.2,
            ramp: 0.7,
            jump: 1.0,
            read: 0.3,
            change: Some(60.0),
            unit_rad: 1.0,
        }
    }

    fn multipliers(seed: u32, end: [f64; 2]) -> Multipliers {
        let signal = |seed, size: f64| noise(seed, 40).iter().map(|x| size * x).collect();
        Multipliers {
            ramp: signal(seed, 0.7),
            jump: signal(seed + 1000, 1.0),
            read: signal(seed + 2000, 0.3),
            end,
        }
    }

    fn product(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// Both sides of the summation by parts.
    fn sides(programme: &Programme, multipliers: &Multipliers, r: &[f64]) -> (f64, f64) {
        let forward = Responses::of(programme, r);
        let cost = product(&multipliers.ramp, &forward.ramp)
            + product(&multipliers.jump, &forward.jump)
            + product(&multipliers.read, &forward.read);
        let played = PlayedMultipliers::of(programme, multipliers);
        let before = core::iter::once(&0.0).chain(r);
        let changes: Vec<f64> = r.iter().zip(before).map(|(r, before)| r - before).collect();
        (cost, played.value + product(&played.sigma, &changes))
    }

    /// Wrong if the loop backward were not the transpose of the loop forward.
    #[test]
    fn backward_is_the_transpose_of_forward() {
        for delay in 0..4_u32 {
            let programme = programme(delay as usize);
            // Nothing after the last sample: any ρ, though its loop has not ended.
            let (cost, again) = sides(&programme, &multipliers(7 + delay, [0.0; 2]), &noise(3, 40));
            assert!((cost - again).abs() < 1e-10 * cost.abs().max(1.0), "{cost} {again}");
            // A loop that has ended: any constants.
            let r = tied(&programme, law::find(&programme).unwrap()).unwrap();
            let (cost, again) = sides(&programme, &multipliers(70 + delay, [3.0, -2.0]), &r);
            assert!((cost - again).abs() < 1e-8 * cost.abs().max(1.0), "{cost} {again}");
        }
    }

    /// Wrong if a solver's mistake could raise the bound over what a law costs.
    #[test]
    fn no_multipliers_raise_the_bound_over_a_law() {
        let programme = programme(1);
        let r = tied(&programme, law::find(&programme).unwrap()).unwrap();
        let [ramp, jump, read] = Responses::of(&programme, &r).sums();
        let cost = 0.7 * ramp + jump + 0.3 * read;
        let best = find(&programme).unwrap();
        let highest = bound(&programme, &best).unwrap();
        assert!(highest < cost && highest > 0.9 * cost, "{highest} {cost}");
        for seed in 0..50 {
            // The best ones, spoilt a little and a lot, far outside of the box.
            for size in [1e-6, 1e-3, 1.0, 1e3] {
                let mut spoilt = best.clone();
                let spoil = noise(seed, 42);
                spoilt.jump.iter_mut().zip(&spoil).for_each(|(x, noise)| *x += size * noise);
                spoilt.end.iter_mut().zip(&spoil[40..]).for_each(|(x, noise)| *x += size * noise);
                assert!(bound(&programme, &spoilt).unwrap() < cost);
            }
        }
        let mut broken = best;
        broken.jump[20] = f64::NAN;
        assert_eq!(bound(&programme, &broken), None);
    }
}
