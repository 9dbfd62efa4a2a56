//! A task as a closed path, without a time table.

use std::sync::Arc;

use crate::error::RivalRefusal;
use crate::handed::Knows;
use crate::needs::Needs;
use crate::supply::{Supply, TaskCurve};

/// Places on the path that the first projection looks at.
const PLACES: u32 = 400;

/// The path of the task.
#[derive(Debug, Clone)]
pub struct Orbit {
    curve: Arc<dyn TaskCurve>,
    /// `Φ, Φ′, Φ″` at the last projection.
    place: [Vec<f64>; 3],
}

impl Orbit {
    /// `Φ, Φ′, Φ″` at the last projection.
    pub fn place(&self) -> [&[f64]; 3] {
        let [q, dq, ddq] = &self.place;
        [q, dq, ddq]
    }

    /// The place nearest to `q` among a number of places of the whole path: `θ` \[s\].
    pub fn search(&mut self, q: &[f64]) -> f64 {
        let period = self.curve.period();
        let (mut best, mut least) = (0.0, f64::INFINITY);
        for k in 0..PLACES {
            let theta = period * f64::from(k) / f64::from(PLACES);
            self.go(theta);
            let distance: f64 = q.iter().zip(&self.place[0]).map(|(a, b)| (a - b) * (a - b)).sum();
            if distance < least {
                (best, least) = (theta, distance);
            }
        }
        best
    }

    /// The place nearest to `q` close to `theta`, by two Newton steps on `|q − Φ(θ)|²`, with `r = q − Φ`:
    ///
    /// ```text
    /// θ ← θ + rᵀΦ′/(Φ′ᵀΦ′ − rᵀΦ″)                                                      (1)
    /// ```
    ///
    /// If the denominator is not above half of `Φ′ᵀΦ′`, `Φ′ᵀΦ′` stands in its place.
    pub fn project(&mut self, q: &[f64], mut theta: f64) -> f64 {
        for _ in 0..2 {
            self.go(theta);
            let [phi, slope, bend] = &self.place;
            let (mut along, mut speed, mut curvature) = (0.0, 0.0, 0.0);
            for i in 0..q.len() {
                let r = q[i] - phi[i];
                along += r * slope[i];
                speed += slope[i] * slope[i];
                curvature += r * bend[i];
            }
            if speed > 0.0 {
                theta += along / (speed - curvature).max(0.5 * speed);
            }
        }
        theta = theta.rem_euclid(self.curve.period());
        self.go(theta);
        theta
    }

    fn go(&mut self, theta: f64) {
        let [q, dq, ddq] = &mut self.place;
        self.curve.at(theta, q, dq, ddq);
    }
}

impl Knows for Orbit {
    const NEEDS: Needs = Needs { orbit: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        let missing = || RivalRefusal::NotApplicable("the reference is no closed path".to_owned());
        let curve = supply.orbit.clone().ok_or_else(missing)?;
        let zero = vec![0.0; supply.joints()];
        Ok(Self { curve, place: [zero.clone(), zero.clone(), zero] })
    }
}
