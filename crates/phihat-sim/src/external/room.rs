//! Room for one comparison of torques with the model.

use super::body_set::BodyRow;
use super::known_arm::KnownTorque;
use super::window::WindowMean;

/// Room for one comparison.
#[derive(Debug, Default)]
pub(super) struct WatchRoom {
    pub(super) q: Vec<f64>,
    pub(super) dq: Vec<f64>,
    pub(super) ddq: Vec<f64>,
    pub(super) off: Vec<f64>,
    pub(super) gravity: Vec<f64>,
    pub(super) known: KnownTorque,
    pub(super) means: Vec<WindowMean>,
    pub(super) rows: Vec<BodyRow>,
    pub(super) reading: Vec<f64>,
    pub(super) posture: Vec<f64>,
    pub(super) allowed: Vec<f64>,
    pub(super) mass: [Vec<f64>; 3],
    pub(super) turned: Vec<f64>,
    pub(super) bent: Vec<f64>,
    /// Interval of the torque from outside, by the model \[N·m\].
    pub(super) outside: Vec<(f64, f64)>,
    /// Interval of the torque that a body alone would have to add \[N·m\].
    pub(super) strips: Vec<(f64, f64)>,
}

impl WatchRoom {
    pub(super) fn of(n: usize) -> Self {
        let zero = |count: usize| vec![0.0; count];
        let known =
            KnownTorque { bare: zero(n), more: vec![(0.0, 0.0); n], body: vec![[0.0; 4]; n] };
        Self {
            q: zero(n),
            dq: zero(n),
            ddq: zero(n),
            off: zero(n),
            gravity: zero(n),
            known,
            means: vec![WindowMean::default(); n],
            rows: vec![[0.0; 4]; n],
            reading: zero(n),
            posture: zero(n),
            allowed: zero(n),
            mass: [zero(n * n), zero(n * n), zero(n * n)],
            turned: zero(n * n),
            bent: zero(n * n),
            outside: vec![(0.0, 0.0); n],
            strips: vec![(0.0, 0.0); n],
        }
    }
}
