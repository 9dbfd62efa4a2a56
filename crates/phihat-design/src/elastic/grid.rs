//! The laws of an arm on a grid of frequencies, and the first band in which no circle serves all joints.

use core::f64::consts::{PI, TAU};

use nalgebra::Complex;
use phihat_certificate::{ElasticJoint, EncoderSide};

use super::actuator::{Actuator, CircleRoom};
use crate::JointRecord;
use crate::sampled::{LoopModel, OpenLoop};

/// Lowest frequency that is tried \[rad/sample\].
const LOWEST: f64 = 1e-4;

/// A law in its loop.
pub(super) type LawInLoop<'a> = (&'a JointRecord, &'a LoopModel);

/// `L_i` of every joint on the grid, per unit of its link inertia.
#[derive(Debug, Clone)]
pub(super) struct SpringGrid {
    /// Frequencies \[rad/s\], ascending to half the sample rate.
    pub(super) omega: Vec<f64>,
    /// One list per frequency, one entry per joint.
    pub(super) laws: Vec<Vec<Complex<f64>>>,
    /// Inertia of the links per joint that everything is in units of \[kg·m²\].
    pub(super) unit: Vec<f64>,
}

/// A band of frequency in which no circle serves all joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gap {
    /// First and last frequency \[Hz\].
    pub(super) hz: (f64, f64),
    /// The two joints that ask for the opposite; the same one where it is alone.
    pub(super) joints: (usize, usize),
}

impl SpringGrid {
    /// A grid with steps of this share of the frequency, for links in these units.
    pub(super) fn new(loops: &[LawInLoop<'_>], unit: &[f64], share: f64) -> Self {
        let period = loops.first().map_or(1.0, |(_, model)| model.period_s);
        let open: Vec<OpenLoop> =
            loops.iter().map(|(record, model)| OpenLoop::new(record, model)).collect();
        let lower = |theta: &f64| (*theta > LOWEST).then(|| theta / (1.0 + share));
        let mut theta: Vec<f64> = core::iter::successors(Some(PI), lower).collect();
        theta.reverse();
        let per_unit: Vec<f64> =
            loops.iter().zip(unit).map(|((record, _), unit)| record.inertia_kg_m2 / unit).collect();
        let at = |theta: &f64| {
            let each = open.iter().zip(&per_unit);
            each.map(|(own, factor)| own.at_angle(*theta) * *factor).collect()
        };
        Self {
            omega: theta.iter().map(|theta| theta / period).collect(),
            laws: theta.iter().map(at).collect(),
            unit: unit.to_vec(),
        }
    }

    /// The first band in which no circle through `−range.0` and `−range.1` has every `L″` outside.
    pub(super) fn gap(
        &self,
        joints: &[ElasticJoint],
        (side, range): (EncoderSide, (f64, f64)),
    ) -> Option<Gap> {
        let points: Vec<Vec<Actuator>> = joints
            .iter()
            .zip(&self.unit)
            .map(|(joint, unit)| Actuator::points(joint, *unit))
            .collect();
        let mut gap: Option<Gap> = None;
        for (omega, laws) in self.omega.iter().zip(&self.laws) {
            let mut room = CircleRoom::ALL;
            for (i, (law, points)) in laws.iter().zip(&points).enumerate() {
                for point in points {
                    room.add(i, point.admittance(*law, *omega, side), range);
                }
            }
            let hz = omega / TAU;
            match (&mut gap, room.is_empty()) {
                (Some(gap), true) => gap.hz.1 = hz,
                (None, true) => {
                    gap = Some(Gap { hz: (hz, hz), joints: (room.low.1, room.high.1) });
                }
                (Some(_), false) => break,
                (None, false) => (),
            }
        }
        gap
    }
}
