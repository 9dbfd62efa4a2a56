//! Reasons why a record does not determine a joint's inertia.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Rows that a fit needs at least.
pub(crate) const ROWS_LEAST: usize = 200;

/// Why a record does not tell a joint's inertia, and the motion that would.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Error)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Undetermined {
    /// The joint stands still.
    #[error("it moves by {moved_rad:.1e} rad: excite it by two sines of different frequencies")]
    Still {
        /// From its least to its largest position \[rad\].
        moved_rad: f64,
    },
    /// Gravity and inertia look alike on the motion.
    #[error(
        "it moves with one sine of {frequency_hz:.2} Hz, on which gravity and inertia look alike; excite it so: beside \
         that, a sine of {add_hz:.2} Hz and {add_rad:.3} rad or more"
    )]
    OneSine {
        /// Frequency of the motion \[Hz\].
        frequency_hz: f64,
        /// Frequency of the sine to add \[Hz\].
        add_hz: f64,
        /// Its amplitude \[rad\].
        add_rad: f64,
    },
    /// The part of its acceleration that nothing else explains is not above the noise.
    #[error(
        "the part of its acceleration that neither its position, its velocity nor the other joints explain is \
         {own_rad_s2:.2e} rad/s² rms, and noise may be {noise_rad_s2:.2e}; excite it so: frequencies that no other \
         joint has, and a sine of {add_hz:.2} Hz and {add_rad:.3} rad or more"
    )]
    Noise {
        /// Root mean square of that part \[rad/s²\].
        own_rad_s2: f64,
        /// Bound on the noise in it \[rad/s²\].
        noise_rad_s2: f64,
        /// Frequency of the sine to add \[Hz\].
        add_hz: f64,
        /// Its amplitude \[rad\].
        add_rad: f64,
    },
    /// The torque that is left unexplained could be inertia.
    #[error(
        "up to {unexplained_nm:.3} N·m of its torque are explained by no constant inertia, gravity and friction, and \
         its own acceleration is {own_rad_s2:.2e} rad/s² rms; excite it so: {times:.1} times that, by a sine of \
         {add_hz:.2} Hz and {add_rad:.3} rad, the other joints at rest or slower"
    )]
    Unexplained {
        /// Largest torque of a sample that the fit leaves \[N·m\].
        unexplained_nm: f64,
        /// Root mean square of the part of the acceleration that nothing else explains \[rad/s²\].
        own_rad_s2: f64,
        /// Factor on it at which the interval would be an answer.
        times: f64,
        /// Frequency of the sine to add \[Hz\].
        add_hz: f64,
        /// Its amplitude \[rad\].
        add_rad: f64,
    },
    /// Too few samples in which it moves one way.
    #[error(
        "it moves one way for less than {ROWS_LEAST} samples at a time: excite it by slower sines, for longer"
    )]
    Short,
}
