//! Softest springs that a law bears.

use phihat_certificate::EncoderSide;
use phihat_model::JointSpring;

use super::actuator::{Actuator, CircleRoom};
use super::grid::SpringGrid;

/// Ratio of the largest stiffness to the least that a joint may have without being measured.
pub const SPREAD: f64 = 1.5;

/// Largest factor of the usual stiffness that is tried, the steps down from it, and how many (down to a thousandth).
const STIFFEST: f64 = 1e3;
const STEP: f64 = 1.04;
const STEPS: i32 = 352;

/// An arm whose springs are sought.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unsprung<'a> {
    pub(super) grid: &'a SpringGrid,
    pub(super) side: EncoderSide,
    /// Range of the links' inertia.
    pub(super) range: (f64, f64),
    /// Rotor inertia of each joint \[kg·m²\].
    pub(super) rotor: &'a [f64],
    /// Usual stiffness of each joint \[N·m/rad\]: their ratios.
    pub(super) usual: &'a [f64],
}

/// Room that a joint leaves at each frequency of the grid.
type Rooms = Vec<CircleRoom>;

impl Unsprung<'_> {
    /// Least stiffness of each joint \[N·m/rad\] with which the grid has no gap, where every joint's stiffness is
    /// anywhere between its own and [`SPREAD`] times that, and damping 1 % of critical; so do all larger ones in the
    /// same ratios. `None`: it has a gap even where joints are rigid.
    ///
    /// # Method
    ///
    /// All get softer together, in the ratios of the usual stiffness, until a gap opens; then each goes on while the
    /// others stay.
    pub(super) fn softest(&self) -> Option<Vec<f64>> {
        let n = self.rotor.len();
        let rigid: Vec<Rooms> = (0..n).map(|joint| self.rooms(joint, &[f64::INFINITY])).collect();
        if !no_gap(&rigid) {
            return None;
        }
        let (mut rooms, mut borne) = (rigid, 0);
        for step in 0..STEPS {
            let tried: Vec<Rooms> = (0..n).map(|joint| self.spread(joint, factor(step))).collect();
            if !no_gap(&tried) {
                break;
            }
            (rooms, borne) = (tried, step);
        }
        Some((0..n).map(|joint| self.softer(&mut rooms, joint, borne)).collect())
    }

    /// Lowest stiffness \[N·m/rad\] of one joint while the others stay; takes it in.
    fn softer(&self, rooms: &mut [Rooms], joint: usize, from: i32) -> f64 {
        let mut borne = from;
        for step in from + 1..STEPS {
            let before = core::mem::replace(&mut rooms[joint], self.spread(joint, factor(step)));
            if !no_gap(rooms) {
                rooms[joint] = before;
                break;
            }
            borne = step;
        }
        factor(borne) * self.usual[joint]
    }

    /// Room that a joint leaves, its stiffness anywhere in its spread above a factor of the usual.
    fn spread(&self, joint: usize, factor: f64) -> Rooms {
        let low = factor * self.usual[joint];
        let next = |k: &f64| Some(k * STEP).filter(|k| *k < SPREAD * low);
        let mut all: Vec<f64> = core::iter::successors(Some(low), next).collect();
        all.push(SPREAD * low);
        self.rooms(joint, &all)
    }

    /// Room that a joint leaves with each of some springs.
    fn rooms(&self, joint: usize, stiffnesses: &[f64]) -> Rooms {
        let (unit, rotor) = (self.grid.unit[joint], self.rotor[joint]);
        let point = |stiffness: &f64| {
            let rigid = stiffness.is_infinite();
            let damping = if rigid { 0.0 } else { JointSpring::damping_assumed(*stiffness, rotor) };
            Actuator { rotor: rotor / unit, compliance: unit / stiffness, damping: damping / unit }
        };
        let points: Vec<Actuator> = stiffnesses.iter().map(point).collect();
        let each = self.grid.omega.iter().zip(&self.grid.laws);
        each.map(|(omega, laws)| {
            let mut room = CircleRoom::ALL;
            for point in &points {
                let admittance = point.admittance(laws[joint], *omega, self.side);
                room.add(joint, admittance, self.range);
            }
            room
        })
        .collect()
    }
}

/// Factor of the usual stiffness after some steps down.
fn factor(step: i32) -> f64 {
    STIFFEST / STEP.powi(step)
}

/// Returns true if at every frequency there is room that all joints leave.
fn no_gap(rooms: &[Rooms]) -> bool {
    let count = rooms.first().map_or(0, Vec::len);
    (0..count).all(|at| {
        let of = |sum: CircleRoom, own: &Rooms| own.get(at).map_or(sum, |own| sum.and(own));
        !rooms.iter().fold(CircleRoom::ALL, of).is_empty()
    })
}
