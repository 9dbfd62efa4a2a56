//! Estimates of values that a URDF omits, from those that it has: rotor inertia and dry friction, as
//! intervals.
//!
//! # Law
//!
//! A drive is chosen such that it brings its own rotor to full speed in a few hundredths of a second. At the joint,
//!
//! ```text
//! J = τ_max t / ω_max                                                                    (RO1)
//! ```
//!
//! with `t` the time in which the largest torque alone would bring the rotor to the largest speed, and `τ_max`,
//! `ω_max` the limits of the joint. A gear drops out: torque grows with its ratio, speed falls with it, and the
//! reflected inertia grows with its square. `t` of published drives \[s\]:
//!
//! | drive | J \[kg·m²\] | τ \[N·m\] | ω \[rad/s\] | t \[s\] |
//! |---|---|---|---|---|
//! | Franka, joints 1 and 2 | 0.606 | 87 | 2.175 | 0.0151 |
//! | Franka, joints 3 and 4 | 0.462 | 87 | 2.175 | 0.0116 |
//! | Franka, joints 5 to 7 | 0.206 | 12 | 2.61 | 0.0447 |
//! | iiwa 14, axes 1 and 2 | 3.38 | 320 | 1.48 | 0.0157 |
//! | iiwa 14, axis 3 | 3.38 | 176 | 1.75 | 0.0335 |
//! | iiwa 14, axis 4 | 3.38 | 176 | 1.31 | 0.0252 |
//! | iiwa 14, axis 5 | 1.32 | 110 | 2.27 | 0.0273 |
//! | iiwa 14, axes 6 and 7 | 1.16 | 40 | 2.36 | 0.0685 |
//! | Unitree 5020, 7520-14, 7520-22 (geared 14 to 22) | 0.0036, 0.0102, 0.0251 | 25, 88, 139 | 37, 32, 20 | 0.0053, 0.0037, 0.0036 |
//! | Unitree 4010 (geared 25) | 0.0043 | 5 | 22 | 0.0187 |
//!
//! Sources: Franka, the `[rotor]` of `robots/panda.toml`; iiwa 14, motor and gear types assumed, limits of KUKA's
//! brochure, both in `RobotLocomotion/drake`, `manipulation/models/iiwa_description/README.md`; Unitree, figures of the
//! manufacturer in `mujocolab/mjlab`, `asset_zoo/robots/unitree_g1`.
//!
//! # Not claimed
//!
//! That a drive's own figure lies inside: a limit in a URDF may be a placeholder, or chosen for safety. A
//! data sheet, or a measurement, replaces the estimate.

/// An interval with the value in it that is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedInterval {
    /// Lower end.
    pub low: f64,
    /// The geometric middle.
    pub value: f64,
    /// Upper end.
    pub high: f64,
}

/// `t` of (RO1) of drives with a high gear ratio \[s\]: Franka and iiwa are inside.
const GEARED_S: (f64, f64) = (0.011, 0.07);

/// `t` of (RO1) of drives with a low gear ratio \[s\]: Unitree's are inside.
const DIRECT_S: (f64, f64) = (0.0035, 0.02);

/// Joints faster than this have a low gear ratio \[rad/s\].
const DIRECT_RAD_S: f64 = 12.0;

/// Speed that is assumed where a description states none \[rad/s, m/s\]: half a turn per second, as many arms have.
pub const SPEED_ASSUMED: f64 = core::f64::consts::PI;

/// Dry friction over the torque limit \[1\].
const FRICTION: (f64, f64) = (0.006, 0.07);

impl EstimatedInterval {
    fn over(unit: f64, (low, high): (f64, f64)) -> Self {
        Self { low: unit * low, value: unit * (low * high).sqrt(), high: unit * high }
    }
}

/// Reflected rotor inertia \[kg·m²\], (RO1), from the largest torque \[N·m\] and the largest speed \[rad/s\]
/// of a joint; of a sliding joint \[kg\], from N and m/s. Without a speed, [`SPEED_ASSUMED`].
///
/// # Example
///
/// ```
/// use phihat_model::rotor_inertia;
///
/// let estimate = rotor_inertia(87.0, Some(2.175)); // Franka's joint 1, which has 0.606 kg·m²
/// assert!(estimate.low < 0.606 && 0.606 < estimate.high);
/// ```
pub fn rotor_inertia(torque_max: f64, velocity_max: Option<f64>) -> EstimatedInterval {
    let speed = velocity_max.unwrap_or(SPEED_ASSUMED);
    let time = if speed > DIRECT_RAD_S { DIRECT_S } else { GEARED_S };
    EstimatedInterval::over(torque_max / speed, time)
}

/// Dry friction \[N·m\] from the largest torque \[N·m\] of a joint: 0.6 to 7 % of it.
///
/// Of the Panda's identified friction (`robots/panda.toml`) the amplitudes are 0.6 to 7 % of the torque
/// limits. Of the PUMA 560 (P. I. Corke, B. Armstrong-Hélouvry, A meta-study of PUMA 560 dynamics, Robotica
/// 13, 1995) joints 2 to 6 have 1 to 8 %; its first one a quarter, which is far outside.
pub fn dry_friction(torque_max: f64) -> EstimatedInterval {
    EstimatedInterval::over(torque_max, FRICTION)
}
