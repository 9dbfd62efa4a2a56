//! Softest springs that a law bears.

use core::f64::consts::TAU;

use phihat_certificate::EncoderSide;
use phihat_certificate::extremes::smaller;
use phihat_model::JointSpring;

use super::actuator::{Actuator, CircleRoom};
use super::grid::SpringGrid;

/// Frequencies of a rotor on its spring that are tried, from the stiffest \[Hz\] down, by steps of this share.
const STIFFEST_HZ: f64 = 1e3;
const SOFTEST_HZ: f64 = 1.0;
const STEP: f64 = 0.02;

/// An arm whose springs are sought.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unsprung<'a> {
    pub(super) grid: &'a SpringGrid,
    pub(super) side: EncoderSide,
    /// Range of the links' inertia.
    pub(super) range: (f64, f64),
    /// Rotor inertia of each joint \[kg·m²\].
    pub(super) rotor: &'a [f64],
}

impl Unsprung<'_> {
    /// Stiffness of each joint \[N·m/rad\] from which on, with any stiffness above it on every joint and 1 % of
    /// critical damping, the grid has no gap; `None`: it has one even where joints are rigid.
    ///
    /// # Method
    ///
    /// Each joint gets softer by itself, the others rigid, until a gap opens: that are the ratios of the frequencies of
    /// rotors on their springs. With these ratios all get softer together; then each goes on while the others stay.
    pub(super) fn softest(&self) -> Option<Vec<f64>> {
        let n = self.rotor.len();
        let mut rigid = vec![vec![CircleRoom::ALL; n]; self.grid.omega.len()];
        if !(0..n).all(|joint| self.take(&mut rigid, joint, f64::INFINITY)) {
            return None;
        }
        let alone: Vec<f64> =
            (0..n).map(|joint| self.softer(&mut rigid.clone(), joint, STIFFEST_HZ)).collect();
        let mut rooms = rigid;
        let mut hz = vec![STIFFEST_HZ; n];
        let mut factor = STIFFEST_HZ / SOFTEST_HZ;
        loop {
            let mut tried = rooms.clone();
            let together: Vec<f64> =
                alone.iter().map(|own| smaller(own * factor, STIFFEST_HZ)).collect();
            if factor < 1.0 || !(0..n).all(|joint| self.take(&mut tried, joint, together[joint])) {
                break;
            }
            (rooms, hz) = (tried, together);
            factor /= 1.0 + STEP;
        }
        for joint in 0..n {
            hz[joint] = self.softer(&mut rooms, joint, hz[joint]);
        }
        Some((0..n).map(|joint| self.stiffness(joint, hz[joint])).collect())
    }

    /// Lowest frequency \[Hz\] of a joint's rotor on its spring from another one down; takes all of them in.
    fn softer(&self, rooms: &mut Vec<Vec<CircleRoom>>, joint: usize, from_hz: f64) -> f64 {
        let mut hz = from_hz;
        loop {
            let next = hz / (1.0 + STEP);
            let mut tried = rooms.clone();
            if next < SOFTEST_HZ || !self.take(&mut tried, joint, next) {
                return hz;
            }
            (*rooms, hz) = (tried, next);
        }
    }

    /// Stiffness \[N·m/rad\] at which a joint's rotor has this frequency \[Hz\].
    fn stiffness(&self, joint: usize, hz: f64) -> f64 {
        self.rotor[joint] * (TAU * hz) * (TAU * hz)
    }

    /// Takes one stiffness of a joint into its rooms; returns false where that leaves no room at some frequency.
    fn take(&self, rooms: &mut [Vec<CircleRoom>], joint: usize, hz: f64) -> bool {
        let (inertia, rotor) = (self.grid.inertia[joint], self.rotor[joint]);
        let stiffness = self.stiffness(joint, hz);
        let rigid = stiffness.is_infinite();
        let damping = if rigid { 0.0 } else { JointSpring::damping_assumed(stiffness, rotor) };
        let point = Actuator {
            rotor: rotor / inertia,
            compliance: inertia / stiffness,
            damping: damping / inertia,
        };
        let each = rooms.iter_mut().zip(self.grid.omega.iter().zip(&self.grid.laws));
        for (rooms, (omega, laws)) in each {
            let admittance = point.admittance(laws[joint], *omega, self.side);
            rooms[joint].add(joint, admittance, self.range);
            if rooms.iter().fold(CircleRoom::ALL, CircleRoom::and).is_empty() {
                return false;
            }
        }
        true
    }
}
