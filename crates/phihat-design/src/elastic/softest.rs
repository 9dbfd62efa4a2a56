//! Softest springs that a law bears.

use core::f64::consts::TAU;

use phihat_certificate::EncoderSide;
use phihat_model::JointSpring;

use super::actuator::{Actuator, Room};
use super::grid::Grid;

/// Frequencies of a rotor on its spring that are tried, from the stiffest \[Hz\] down, by steps of this share.
const STIFFEST_HZ: f64 = 2e4;
const SOFTEST_HZ: f64 = 1.0;
const STEP: f64 = 0.02;

/// An arm whose springs are sought.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unsprung<'a> {
    pub(super) grid: &'a Grid,
    pub(super) side: EncoderSide,
    /// Range of the links' inertia.
    pub(super) range: (f64, f64),
    /// Rotor inertia of each joint \[kg·m²\].
    pub(super) rotor: &'a [f64],
}

impl Unsprung<'_> {
    /// Stiffness of each joint \[N·m/rad\] from which on, with any stiffness above it on every joint and 1 % of critical
    /// damping, the grid has no gap; `None`: it has one even where joints are rigid.
    ///
    /// # Method
    ///
    /// All joints get softer together, at the same frequency of the rotor on its spring, until a gap opens; then each
    /// goes on alone while the others stay.
    pub(super) fn softest(&self) -> Option<Vec<f64>> {
        let n = self.rotor.len();
        let mut rooms = vec![vec![Room::ALL; n]; self.grid.omega.len()];
        if !(0..n).all(|joint| self.take(&mut rooms, joint, f64::INFINITY)) {
            return None;
        }
        let mut hz = vec![STIFFEST_HZ; n];
        let mut together = STIFFEST_HZ;
        loop {
            let mut tried = rooms.clone();
            if together < SOFTEST_HZ || !(0..n).all(|joint| self.take(&mut tried, joint, together)) {
                break;
            }
            rooms = tried;
            hz.fill(together);
            together /= 1.0 + STEP;
        }
        for joint in 0..n {
            loop {
                let softer = hz[joint] / (1.0 + STEP);
                let mut tried = rooms.clone();
                if softer < SOFTEST_HZ || !self.take(&mut tried, joint, softer) {
                    break;
                }
                rooms = tried;
                hz[joint] = softer;
            }
        }
        Some((0..n).map(|joint| self.stiffness(joint, hz[joint])).collect())
    }

    /// Stiffness \[N·m/rad\] at which a joint's rotor has this frequency \[Hz\].
    fn stiffness(&self, joint: usize, hz: f64) -> f64 {
        self.rotor[joint] * (TAU * hz) * (TAU * hz)
    }

    /// Takes one stiffness of a joint into its rooms; returns false where that leaves no room at some frequency.
    fn take(&self, rooms: &mut [Vec<Room>], joint: usize, hz: f64) -> bool {
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
            if rooms.iter().fold(Room::ALL, Room::and).is_empty() {
                return false;
            }
        }
        true
    }
}
