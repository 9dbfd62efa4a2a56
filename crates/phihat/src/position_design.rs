//! Design of a law from positions: checked before it runs.

use crate::delay::PENDING_MAX;
use crate::square::characteristic_polynomial;
use crate::{Gain, GainError};

/// States of the observer at most: error, its velocity, `φ` and two derivatives.
pub(crate) const STATES: usize = 5;

type DesignSquare = [[f64; STATES]; STATES];

/// Design of one joint whose observer uses the position, not a filtered velocity.
///
/// The law is [`JointGains::from_positions`](crate::JointGains::from_positions).
///
/// # Example
///
/// ```
/// use phihat::{GainError, JointGains, PositionDesign};
///
/// // Observer with all three sampled poles at 0.9, one sample of delay, 1 kHz.
/// let t = 1e-3;
/// let design = PositionDesign {
///     inertia: 0.8,
///     kp: 900.0,
///     kd: 60.0,
///     correction: &[1.0 - 0.729, 0.0285 / t, -0.001 / (t * t)],
///     velocity_correction: &[],
///     share: 0.5,
///     delay: 1,
///     period: t,
/// };
/// assert!(JointGains::<f64>::from_positions(&design).is_ok());
///
/// // A correction of the wrong sign drives the estimate away from the joint.
/// let wrong = PositionDesign { correction: &[0.271, 28.5, 1000.0], ..design };
/// let why = JointGains::<f64>::from_positions(&wrong);
/// assert_eq!(why, Err(GainError::UnstableEstimator { order: 1 }));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionDesign<'a> {
    /// Nominal inertia `M̄` \[kg·m²\].
    pub inertia: f64,
    /// `K_p` \[1/s²\].
    pub kp: f64,
    /// `K_d` \[1/s\].
    pub kd: f64,
    /// `ℓ`: what one radian that the joint is farther than expected adds to `ê`, `ė̂` \[1/s\], `φ̂/M̄` \[1/s²\] and the
    /// derivatives of that; `m + 2` entries, `m` = 1 … 3. From the third on they are negative: a joint that is farther
    /// than expected was held back less.
    pub correction: &'a [f64],
    /// `λ`: the same per rad/s of a measured velocity; empty, or all zero, where the velocity is not used.
    pub velocity_correction: &'a [f64],
    /// `g`: share of the way to the wanted torque that is gone in one sample, above 0, at most 1.
    pub share: f64,
    /// Transport delay `d` from sample to acting torque \[samples\], 0 … 4.
    pub delay: usize,
    /// Sample period `T` \[s\].
    pub period: f64,
}

impl PositionDesign<'_> {
    pub(crate) fn check(&self) -> Result<(), GainError> {
        Gain::Inertia.positive(self.inertia)?;
        Gain::Kp.positive(self.kp)?;
        Gain::Kd.positive(self.kd)?;
        Gain::Period.positive(self.period)?;
        Gain::Share.positive(self.share)?;
        if self.share > 1.0 {
            return Err(GainError::Share { value: self.share });
        }
        if self.delay > PENDING_MAX {
            return Err(GainError::Delay { samples: self.delay });
        }
        let states = self.correction.len();
        let order = states.saturating_sub(2);
        let velocities = self.velocity_correction.len();
        if !(3..=STATES).contains(&states) || !(velocities == 0 || velocities == states) {
            return Err(GainError::Corrections { position: states, velocity: velocities });
        }
        for (index, value) in self.correction.iter().enumerate() {
            Gain::Correction(index).finite(*value)?;
        }
        for (index, value) in self.velocity_correction.iter().enumerate() {
            Gain::VelocityCorrection(index).finite(*value)?;
        }
        if settles(&self.error_dynamics(), states) {
            Ok(())
        } else {
            Err(GainError::UnstableEstimator { order })
        }
    }

    /// Approximate rate at which `φ̂` follows \[1/s\]: `a_{m−1}` of an estimator from velocity and torque.
    pub(crate) fn estimator_rate(&self) -> f64 {
        match *self.correction {
            [_, de, phi, ..] if de > 0.0 && phi < 0.0 => -phi / de,
            _ => 0.0,
        }
    }

    /// Weights of `ê`, `ė̂`, `φ̂`, its derivatives, and of the torques on their way, the newest first, in the
    /// wanted torque: `K F^d`, and `K F^j G` for the torque that acts last but `j`.
    ///
    /// ```text
    /// K = (−M̄ K_p, −M̄ K_d, 1, T (1/g − 1), 0)
    /// ```
    ///
    /// The fourth entry makes up for what `g` makes the torque late.
    pub(crate) fn weights(&self) -> ([f64; STATES], [f64; PENDING_MAX]) {
        let t = self.period;
        let (velocity, position) = (t / self.inertia, 0.5 * t * t / self.inertia);
        let lead = t * (1.0 / self.share - 1.0);
        let mut row = [-self.inertia * self.kp, -self.inertia * self.kd, 1.0, lead, 0.0];
        let mut coming = [0.0; PENDING_MAX];
        for weight in coming.iter_mut().take(self.delay) {
            let [e, de, phi, d1, d2] = row;
            *weight = e * position + de * velocity;
            row = [e, e * t + de, phi - *weight, phi * t + d1, d1 * t + d2];
        }
        (row, coming)
    }

    /// `(1 − ℓC)F`: what becomes of an error of the estimate in one sample, in time units of `T`.
    fn error_dynamics(&self) -> DesignSquare {
        let mut carried = DesignSquare::default();
        // ê, T ė̂, T² φ̂/M̄, …: F is without T in it.
        let [position, velocity, phi, d1, d2] = &mut carried;
        *position = [1.0, 1.0, -0.5, 0.0, 0.0];
        *velocity = [0.0, 1.0, -1.0, 0.0, 0.0];
        *phi = [0.0, 0.0, 1.0, 1.0, 0.0];
        *d1 = [0.0, 0.0, 0.0, 1.0, 1.0];
        *d2 = [0.0, 0.0, 0.0, 0.0, 1.0];
        let mut out = carried;
        let [position, velocity, ..] = carried;
        let mut scale = 1.0;
        for (i, row) in out.iter_mut().enumerate() {
            let on_position = self.correction.get(i).copied().unwrap_or(0.0) * scale;
            let on_velocity = self.velocity_correction.get(i).copied().unwrap_or(0.0) * scale;
            for ((value, p), v) in row.iter_mut().zip(&position).zip(&velocity) {
                *value -= on_position * p + on_velocity / self.period * v;
            }
            scale *= self.period;
        }
        out
    }
}

/// Returns true if all eigenvalues of the leading `n × n` block are inside the unit circle: the
/// characteristic polynomial by Faddeev and LeVerrier, its roots by Schur and Cohn.
fn settles(a: &DesignSquare, n: usize) -> bool {
    // c_0 … c_n of det(z − A), c_n = 1.
    let mut c = [0.0; STATES + 1];
    for (into, value) in c.iter_mut().zip(characteristic_polynomial(a, n)) {
        *into = value;
    }
    if let Some(top) = c.get_mut(n) {
        *top = 1.0;
    }
    let mut degree = n;
    while degree > 0 {
        let mut reversed = c;
        let (Some(head), Some(&low)) = (reversed.get_mut(..=degree), c.first()) else {
            return false;
        };
        head.reverse();
        let high = reversed.first().copied().unwrap_or(0.0);
        let reflection = low / high;
        let inside = reflection.abs() < 1.0;
        if !inside {
            return false;
        }
        // (p − k p*)/z
        let mut lower = [0.0; STATES + 1];
        for (i, value) in lower.iter_mut().enumerate().take(degree) {
            let at = |of: &[f64; STATES + 1]| of.get(i + 1).copied().unwrap_or(0.0);
            *value = at(&c) - reflection * at(&reversed);
        }
        c = lower;
        degree -= 1;
    }
    true
}
