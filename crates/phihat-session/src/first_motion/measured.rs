//! Measurements from the record of a first motion.

use std::ops::Range;
use std::path::Path;

use phihat::Mode;
use phihat_certificate::extremes::Extremes as _;
use phihat_design::RecordedJoint;
use phihat_sim::Trace;
use phihat_study::{InertiaSource, Study};
use serde::Serialize;

use super::plan::{described, described_with_payload};
use crate::error::SessionError;
use crate::files;
use crate::identify::{IdentifiedJoint, IdentifyOptions, identify_moving};
use crate::origin::trace_of;

/// Samples that were lost in a row, at most, that a line is drawn over.
const LOST_MOST: usize = 20;

/// Share of a joint's way from which on it counts as moving.
const AWAY: f64 = 0.05;

/// A reference that goes further than this was told to move \[rad, m\].
const MOVED: f64 = 1e-3;

/// Width of the boxes that positions of a first motion are differenced over \[s\]: its legs take ten times as long.
pub const FIRST_WIDTH: f64 = 0.03;

/// Measurements of an arm in a first motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FirstMeasured {
    /// One entry per joint, in the study's order.
    pub joints: Vec<MeasuredJoint>,
}

/// Measurements of a joint in a first motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeasuredJoint {
    /// Joint name.
    pub name: String,
    /// Inertia by the study in this posture, without payload, from and to \[kg·m²\]; the two differ only for
    /// an arm known joint by joint.
    pub study_kg_m2: (f64, f64),
    /// Inertia of the links by the description, in this posture, without rotor, from no payload to the heaviest of the
    /// study's design \[kg·m²\]; `None` for an arm known joint by joint.
    pub links_kg_m2: Option<(f64, f64)>,
    /// Result; `None`: the reason stands in `why`.
    pub found: Option<IdentifiedJoint>,
    /// Why nothing was found.
    pub why: Option<String>,
}

impl FirstMeasured {
    /// The joints' figures, where all of them were found.
    pub fn all(&self) -> Option<Vec<IdentifiedJoint>> {
        self.joints.iter().map(|joint| joint.found.clone()).collect()
    }
}

impl MeasuredJoint {
    /// Returns true if the measured inertia and that of the study have a value in common; `None`: there is no
    /// result.
    pub fn as_told(&self) -> Option<bool> {
        let (low, high) = self.study_kg_m2;
        let inertia = &self.found.as_ref()?.inertia;
        Some(inertia.low_kg_m2 <= high && low <= inertia.high_kg_m2)
    }
}

/// Reads the record that a first motion left in a folder.
///
/// # Errors
///
/// [`SessionError`]: the record cannot be read.
pub fn first_measured(
    study: &Study,
    folder: &Path,
    options: &IdentifyOptions,
) -> Result<FirstMeasured, SessionError> {
    let path = trace_of(folder);
    let read = Trace::read(files::open(&path)?, study);
    let trace = read.map_err(|e| SessionError::at(&path, e))?;
    let q: Vec<f64> =
        trace.joints.iter().filter_map(|joint| joint.q_desired.first().copied()).collect();
    let told = told(study, &q);
    let loaded = match study.design.inertia {
        InertiaSource::Typed { .. } => Vec::new(),
        _ => described_with_payload(study, &q),
    };
    let joint = |(i, study_kg_m2): (usize, &(f64, f64))| {
        let moving = moving(&trace, i);
        let most = trace.joints[i].q_desired.iter().map(|wanted| (wanted - q[i]).abs());
        let moved = most.largest() > MOVED;
        let found =
            moved.then(|| identify_moving(&cut(&trace, &moving), i, trace.period_ns, options));
        let (found, why) = match found {
            Some(Ok(found)) => (Some(found), None),
            Some(Err(why)) => (None, Some(why.to_string())),
            None => (None, Some("the drive ended before it was moved".to_owned())),
        };
        let rotor = study.robot.joints[i].armature;
        let links_kg_m2 = loaded.get(i).map(|(low, high)| (low - rotor, high - rotor));
        let name = trace.joints[i].name.clone();
        MeasuredJoint { name, study_kg_m2: *study_kg_m2, links_kg_m2, found, why }
    };
    let joints = told.iter().enumerate().map(joint).collect();
    Ok(FirstMeasured { joints })
}

/// Inertia of each joint by the study, from and to \[kg·m²\].
fn told(study: &Study, q: &[f64]) -> Vec<(f64, f64)> {
    if let InertiaSource::Typed { low, high } = &study.design.inertia {
        return low.iter().copied().zip(high.iter().copied()).collect();
    }
    described(study, q).into_iter().map(|inertia| (inertia, inertia)).collect()
}

/// The samples in which a joint was to move, and the arm followed.
fn moving(trace: &Trace, joint: usize) -> Range<usize> {
    let wanted = &trace.joints[joint].q_desired;
    let tracks = |k: usize| trace.supervision.as_ref().is_none_or(|s| s.mode[k] == Mode::Tracking);
    // On arming, the reference is the position of the arm, and moves from there to its own beginning: less
    // than the smallest part of this motion.
    let away = |k: usize| (wanted[k] - wanted[0]).abs();
    let most = (0..trace.len()).map(away).largest();
    let moves = |k: &usize| away(*k) > AWAY * most && tracks(*k);
    let first = (0..trace.len()).find(moves).unwrap_or(0);
    let last = (first..trace.len()).rev().find(moves).unwrap_or(first);
    first..last
}

/// Positions and torques of some samples. Positions are interpolated over those in which no joint's position
/// changed: they were lost, or the arm stood still.
fn cut(trace: &Trace, samples: &Range<usize>) -> Vec<RecordedJoint> {
    let is_lost = |k: &usize| {
        let same = |q: &[f64]| *k > 0 && q[*k].to_bits() == q[*k - 1].to_bits();
        trace.joints.iter().all(|joint| same(&joint.q_measured))
    };
    let lost: Vec<usize> = samples.clone().filter(is_lost).collect();
    let joints = trace.joints.iter().map(|joint| {
        let mut q = joint.q_measured.clone();
        for run in lost.chunk_by(|a, b| a + 1 == *b) {
            let (before, after) = (run[0] - 1, run[run.len() - 1] + 1);
            if run.len() > LOST_MOST || after >= samples.end {
                continue;
            }
            for k in run {
                let share = (k - before) as f64 / (after - before) as f64;
                q[*k] = q[before] + share * (q[after] - q[before]);
            }
        }
        RecordedJoint {
            name: joint.name.clone(),
            q: q[samples.clone()].to_vec(),
            tau: joint.tau_applied[samples.clone()].to_vec(),
        }
    });
    joints.collect()
}
