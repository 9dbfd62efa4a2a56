//! Torque interface of a robot: its effect on a torque command, and the limits at which it stops.

use serde::Deserialize;

use crate::error::RobotError;

/// A torque interface: torque means something else on every robot.
///
/// # Law
///
/// ```text
/// τ_drive = τ_command + [g(q)] + share · τ_f(q̇),                                               (1)
/// ```
///
/// with `g` of the robot's own model, which knows of no payload, and its own friction figures.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Name, as studies use it.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// Source of the figures, and their uncertainty.
    pub source: String,
    /// Slowest rate of commands \[Hz\]; `None`: any.
    #[serde(rename = "rate_min_hz")]
    pub rate_min: Option<f64>,
    /// Fastest rate of commands \[Hz\]; `None`: any.
    #[serde(rename = "rate_max_hz")]
    pub rate_max: Option<f64>,
    /// True if the robot adds the torque that holds it against gravity.
    #[serde(default)]
    pub adds_gravity: bool,
    /// Share of its own friction that the robot adds, 0 … 1.
    #[serde(default)]
    pub adds_friction: f64,
    /// True if the robot clamps torques beyond its joints' limits.
    #[serde(default)]
    pub clamps_torque: bool,
    /// Torque rate \[N·m/s\] beyond which the robot stops.
    #[serde(rename = "torque_rate_max_nm_s")]
    pub torque_rate_max: Option<f64>,
    /// Largest first torque \[N·m\]; beyond it the robot does not start.
    #[serde(rename = "first_torque_max_nm")]
    pub first_torque_max: Option<f64>,
    /// Consecutive lost commands on which the robot stops.
    pub losses_max: Option<u32>,
    /// First-order low-pass \[Hz\] on the commands.
    #[serde(rename = "torque_filter_hz")]
    pub torque_filter: Option<f64>,
}

const FILES: [(&str, &str); 5] = [
    ("ideal", include_str!("../robots/profiles/ideal.toml")),
    ("franka", include_str!("../robots/profiles/franka.toml")),
    ("ur", include_str!("../robots/profiles/ur.toml")),
    ("kuka_fri", include_str!("../robots/profiles/kuka_fri.toml")),
    ("kortex", include_str!("../robots/profiles/kortex.toml")),
];

impl Profile {
    /// Names of the interfaces that come with the crate.
    pub const NAMES: &'static [&'static str] = &["ideal", "franka", "ur", "kuka_fri", "kortex"];

    /// Gives the torque interface of this name: one of [`NAMES`](Self::NAMES).
    ///
    /// # Errors
    ///
    /// [`RobotError::Value`] for a name that is none of [`NAMES`](Self::NAMES).
    pub fn named(name: &str) -> Result<Self, RobotError> {
        let origin = format!("profiles/{name}.toml");
        let Some((_, text)) = FILES.iter().find(|(known, _)| *known == name) else {
            let why = format!("\"{name}\" is none of {}", Self::NAMES.join(", "));
            return Err(RobotError::Value { origin, key: "profile.name".to_owned(), why });
        };
        toml::from_str(text).map_err(|error| RobotError::Toml { origin, why: error.to_string() })
    }
}
