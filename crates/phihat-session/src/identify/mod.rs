//! From records of a real arm to the numbers that a design needs of it.

mod moving;
mod recording;

use std::path::{Path, PathBuf};

use phihat_certificate::extremes::{Extremes as _, hull, larger, smaller};
use phihat_design::{
    DryFriction, InertiaEstimate, JointSignals, RecordedJoint, Smoothed, Undetermined,
    enclose_dry_friction, enclose_inertia,
};
use phihat_sim::Observed;
use serde::Serialize;

use crate::error::SessionError;
pub use moving::identify_moving;
use recording::{IdentifyRecording, read};

/// Options of an identification.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifyOptions {
    /// Records (CSV, Parquet, or folders of runs) of the same joints: in other postures, with other loads.
    /// The result holds for all of them.
    pub records: Vec<PathBuf>,
    /// Seconds that are left out at the beginning of each.
    pub from: f64,
    /// Width of the boxes that positions are differenced over \[s\]: see [`Smoothed`].
    pub width: f64,
    /// Factor on sizes and rates of φ: no record contains the worst case to come.
    pub margin: f64,
    /// Names of joints that slide: their positions are in m, their torques forces in N.
    pub slides: Vec<String>,
}

impl Default for IdentifyOptions {
    fn default() -> Self {
        Self { records: Vec::new(), from: 0.0, width: 0.01, margin: 1.5, slides: Vec::new() }
    }
}

/// Result of an identification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Identification {
    /// Joints whose inertia the records determine, in the robot's order.
    pub joints: Vec<IdentifiedJoint>,
    /// The other joints.
    pub undetermined: Vec<UndeterminedJoint>,
}

/// A joint whose inertia no record determines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UndeterminedJoint {
    /// Joint name.
    pub name: String,
    /// The reason in the first record, and the motion that would do.
    pub why: Undetermined,
}

/// Result of an identification for one joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IdentifiedJoint {
    /// Joint name.
    pub name: String,
    /// True if it slides: read m for rad, N for N·m and kg for kg·m².
    pub slides: bool,
    /// Its inertia at the postures of the records: see [`enclose_inertia`]; an estimate, not a proof.
    pub inertia: InertiaEstimate,
    /// `φ` for the middle of that interval in logarithms, times the margin: its size \[N·m\],
    pub phi_max_nm: f64,
    /// how fast its smooth part changes \[N·m/s\],
    pub phi_rate_max_nm_s: f64,
    /// and how far it jumps, at least by what it swings by where the joint reverses: dry friction \[N·m\].
    pub phi_jump_max_nm: f64,
    /// The level of its dry friction, without the margin; `None` where it never reversed between two strokes
    /// that are long enough.
    pub dry_friction: Option<DryFriction>,
    /// Measured positions, from and to \[rad\].
    pub position_rad: (f64, f64),
    /// Largest estimated |q̇| \[rad/s\].
    pub velocity_max_rad_s: f64,
    /// Largest recorded torque \[N·m\].
    pub torque_max_nm: f64,
}

/// Records and what went through their filter, each with the inertia of every joint.
type Records = Vec<(IdentifyRecording, Smoothed, Vec<Result<InertiaEstimate, Undetermined>>)>;

/// Identifies each joint from records.
///
/// # Errors
///
/// [`SessionError::File`]: a record cannot be read, is of other joints, too short, or has no joint of a name that
/// slides. A joint that no record determines is an answer.
pub fn identify(options: &IdentifyOptions) -> Result<Identification, SessionError> {
    let mut records: Records = Vec::new();
    for path in &options.records {
        let record = read(path, options.from)?;
        let smoothed = smoothed(path, &record, options)?;
        if let Some((_, first, _)) = records.first() {
            same_joints(path, first, &smoothed)?;
        }
        known(path, &smoothed, &options.slides)?;
        let inertia = enclose_inertia(&record.joints, record.period_ns, options.width);
        records.push((record, smoothed, inertia.map_err(|e| SessionError::at(path, e))?));
    }
    let joints = records.first().map_or(0, |(_, _, inertia)| inertia.len());
    let (mut identified, mut undetermined) = (Vec::new(), Vec::new());
    for joint in 0..joints {
        match together(&records, joint, options) {
            Ok(found) => identified.push(found),
            Err(why) => undetermined.extend(why),
        }
    }
    Ok(Identification { joints: identified, undetermined })
}

fn smoothed(
    path: &Path,
    record: &IdentifyRecording,
    options: &IdentifyOptions,
) -> Result<Smoothed, SessionError> {
    Smoothed::new(&record.joints, record.period_ns, options.width).ok_or_else(|| {
        let needed = 4.0 * options.width;
        SessionError::at(path, format!("too short: its filter alone needs more than {needed} s"))
    })
}

fn same_joints(path: &Path, first: &Smoothed, other: &Smoothed) -> Result<(), SessionError> {
    let names = |of: &Smoothed| -> Vec<String> {
        of.signals().iter().map(|joint| joint.name.to_owned()).collect()
    };
    let (expected, found) = (names(first), names(other));
    if expected == found {
        return Ok(());
    }
    let (found, expected) = (found.join(", "), expected.join(", "));
    let why = format!("its joints are {found}; those of the first record are {expected}");
    Err(SessionError::at(path, why))
}

/// Refuses a name that no joint has.
fn known(path: &Path, record: &Smoothed, slides: &[String]) -> Result<(), SessionError> {
    let names: Vec<&str> = record.signals().iter().map(|joint| joint.name).collect();
    match slides.iter().find(|name| !names.contains(&name.as_str())) {
        Some(name) => {
            let why = format!(
                "no joint of it is \"{name}\", which is said to slide; it has {}",
                names.join(", ")
            );
            Err(SessionError::at(path, why))
        }
        None => Ok(()),
    }
}

/// A joint in all records; its interval contains those of all records that determine it. An error: none does.
fn together(
    records: &Records,
    joint: usize,
    options: &IdentifyOptions,
) -> Result<IdentifiedJoint, Option<UndeterminedJoint>> {
    let found = || records.iter().filter_map(|(_, _, inertia)| inertia.get(joint));
    let both = |a: InertiaEstimate, b: InertiaEstimate| InertiaEstimate {
        low_kg_m2: smaller(a.low_kg_m2, b.low_kg_m2),
        high_kg_m2: larger(a.high_kg_m2, b.high_kg_m2),
        records: a.records + b.records,
    };
    let undetermined = || {
        let why = found().find_map(|found| found.err())?;
        let name = records.first()?.1.signals().get(joint)?.name.to_owned();
        Some(UndeterminedJoint { name, why })
    };
    let inertia = found().filter_map(|found| found.ok()).reduce(both).ok_or_else(undetermined)?;
    let all = records
        .iter()
        .map(|(record, smoothed, _)| shown((&record.joints, smoothed), joint, inertia, options));
    all.reduce(|before, next| before.and(&next)).ok_or(None)
}

/// A joint of this inertia in one record.
fn shown(
    (record, smoothed): (&[RecordedJoint], &Smoothed),
    joint: usize,
    inertia: InertiaEstimate,
    options: &IdentifyOptions,
) -> IdentifiedJoint {
    let margin = options.margin;
    let nominal = (inertia.low_kg_m2 * inertia.high_kg_m2).sqrt();
    let signals = &smoothed.signals()[joint];
    let period = smoothed.period_ns as f64 * 1e-9;
    let rows = smoothed.reach();
    let phi = Observed::of_signals(&[(signals.tau, signals.ddq)], period).phi(0, nominal);
    let size = |values: &[f64]| values.iter().map(|value| value.abs()).largest();
    IdentifiedJoint {
        name: signals.name.to_owned(),
        slides: options.slides.iter().any(|name| name == signals.name),
        inertia,
        phi_max_nm: margin * phi.size,
        phi_rate_max_nm_s: margin * phi.rate,
        // A filter smears what dry friction does where a joint reverses: over its length φ swings by the whole jump.
        phi_jump_max_nm: margin * larger(phi.jump, swing(signals, nominal, rows)),
        dry_friction: dry_friction(record, smoothed, joint, rows),
        position_rad: signals.q.iter().copied().ends(),
        velocity_max_rad_s: size(signals.dq),
        torque_max_nm: size(signals.tau),
    }
}

/// The level of dry friction in one record, its interval widened to what the record does not exclude.
fn dry_friction(
    record: &[RecordedJoint],
    smoothed: &Smoothed,
    joint: usize,
    rows: usize,
) -> Option<DryFriction> {
    let level = DryFriction::of(&smoothed.signals(), joint, smoothed.period_ns, rows)?;
    Some(level.widened(enclose_dry_friction(record, joint, smoothed)?))
}

/// Largest change of φ over so many rows in which the joint reverses \[N·m\].
fn swing(signals: &JointSignals<'_>, nominal: f64, rows: usize) -> f64 {
    let phi = |k: usize| signals.tau[k] - nominal * signals.ddq[k];
    let reverses = |k: &usize| signals.dq[*k] * signals.dq[k + rows] < 0.0;
    let all = (0..signals.dq.len().saturating_sub(rows)).filter(reverses);
    all.map(|k| (phi(k + rows) - phi(k)).abs()).largest()
}

impl IdentifiedJoint {
    /// Result that holds for two records.
    fn and(self, other: &Self) -> Self {
        let dry = [self.dry_friction, other.dry_friction].into_iter().flatten();
        Self {
            dry_friction: dry.reduce(|a, b| a.and(&b)),
            phi_max_nm: larger(self.phi_max_nm, other.phi_max_nm),
            phi_rate_max_nm_s: larger(self.phi_rate_max_nm_s, other.phi_rate_max_nm_s),
            phi_jump_max_nm: larger(self.phi_jump_max_nm, other.phi_jump_max_nm),
            position_rad: hull([self.position_rad, other.position_rad].into_iter()),
            velocity_max_rad_s: larger(self.velocity_max_rad_s, other.velocity_max_rad_s),
            torque_max_nm: larger(self.torque_max_nm, other.torque_max_nm),
            ..self
        }
    }
}
