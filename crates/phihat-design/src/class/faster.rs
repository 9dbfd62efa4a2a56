//! The same laws at other paces: sums over responses do not depend on the class.

use phihat_certificate::ClassPace;
use phihat_certificate::extremes::Extremes as _;

use super::close::Problem;
use super::extent::{Bent, ClassPaceLimits, Rates};
use super::scene::ClassScene;
use super::sums::PostureSums;

/// Factors on the speed of the class.
const FACTORS: [f64; 6] = [0.25, 0.5, 0.75, 1.5, 2.0, 3.0];

/// Bounds of the class at each of some paces.
pub(super) fn paces(
    scene: &ClassScene<'_>,
    pace: &ClassPaceLimits,
    (bent, all): (&Bent, &[PostureSums]),
) -> Vec<ClassPace> {
    let list: Vec<usize> = (0..FACTORS.len()).collect();
    phihat_certificate::parallel::parallel(&list, phihat_certificate::parallel::threads(), |k| {
        let factor = FACTORS[k];
        let pace = pace.times(factor);
        let rates = Rates::of(scene, &pace);
        let closed = Problem::new(scene, (&pace, &rates), bent).solve(all);
        let largest = |list: &[f64]| list.iter().copied().largest();
        ClassPace {
            factor,
            error_bound_rad: closed.as_ref().ok().map(|c| largest(&c.bounds.error)),
            torque_step_nm: closed.as_ref().ok().map(|c| largest(&c.step)),
            spectral_radius: closed.as_ref().map_or_else(|radius| *radius, |c| c.radius),
        }
    })
}

impl ClassPaceLimits {
    /// The same motions, so many times as fast.
    pub(super) fn times(&self, factor: f64) -> Self {
        let scaled = |list: &[f64], factor: f64| list.iter().map(|x| factor * x).collect();
        Self {
            v: scaled(&self.v, factor),
            a: scaled(&self.a, factor * factor),
            j: scaled(&self.j, factor * factor * factor),
        }
    }
}
