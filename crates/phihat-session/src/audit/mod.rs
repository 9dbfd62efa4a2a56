//! Assumptions of a certificate, held against a record.

mod arm;
mod claims;
mod row;
mod signals;

use std::ops::Range;
use std::path::Path;

use phihat::Mode;
use phihat_design::Gains;
use phihat_sim::Trace;
use phihat_study::Study;
use serde::Serialize;

use crate::design;
use crate::error::SessionError;
use crate::files::read_gains;
use crate::run_record::recorded;
pub use row::{Assumption, AuditRow, Standing};

/// A record with what is assumed of it.
pub(crate) struct Audited<'a> {
    study: &'a Study,
    gains: Option<&'a Gains>,
    trace: &'a Trace,
    /// Samples in which the law follows the reference.
    tracked: Range<usize>,
    /// Sample period \[s\].
    period: f64,
}

impl Audited<'_> {
    fn time(&self, k: usize) -> f64 {
        self.trace.t_ns.get(k).map_or(0.0, |t| *t as f64 * 1e-9)
    }

    /// Names of the joints.
    fn names(&self) -> impl Iterator<Item = (usize, &str)> {
        self.trace.joints.iter().map(|joint| &*joint.name).enumerate()
    }
}

/// Result of an audit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Audit {
    /// One row per assumption and joint.
    pub rows: Vec<AuditRow>,
}

impl Audit {
    /// Rows that the record contradicts.
    pub fn broken(&self) -> impl Iterator<Item = &AuditRow> {
        self.rows.iter().filter(|row| row.standing == Standing::Broken)
    }
}

/// Holds the record in a folder against its study and gains, or against others.
///
/// # Errors
///
/// [`SessionError`]: the record, the gains or the study cannot be read, or are not of one arm.
pub fn audit(
    record: &Path,
    gains: Option<&Path>,
    study: Option<&Path>,
) -> Result<Audit, SessionError> {
    let (done, trace) = recorded(record)?;
    let mut assumed = study.map(design::read).transpose()?.unwrap_or(done.study);
    let given = gains.map(read_gains).transpose()?.or(done.gains);
    if let Some(given) = &given {
        given.complete(&mut assumed).map_err(|e| SessionError::at(record, e))?;
    }
    let names: Vec<&str> = trace.joints.iter().map(|joint| &*joint.name).collect();
    if assumed.robot.joint_names() != names {
        let why = format!("its joints are {}, and the study's are others", names.join(", "));
        return Err(SessionError::at(record, why));
    }
    Ok(audited(&assumed, given.as_ref(), &trace))
}

/// Holds a trace against a study and gains of the same joints.
///
/// # Method
///
/// Delay, torque, losses, encoder, limits and reference are read off the signals. Rotors, dry friction and payload are
/// coefficients of one fit of what the study's model leaves of the torque, each with the largest error that a torque
/// can cause which no sample exceeds ([`phihat_design::bounded_coefficients`]): broken is an interval that has no value
/// in common with the assumed one. φ is broken where two samples differ by more than its rate and jump allow.
///
/// # Not claimed
///
/// That a record in which nothing is broken proves what is assumed: it is one record.
pub fn audited(study: &Study, gains: Option<&Gains>, trace: &Trace) -> Audit {
    let tracked = tracked(trace);
    let period = trace.period_ns as f64 * 1e-9;
    let audited = Audited { study, gains, trace, tracked, period };
    let mut rows = audited.error_rows();
    rows.extend(audited.phi_rows());
    rows.extend(audited.arm_rows());
    rows.extend(audited.torque_rows());
    rows.extend(audited.sample_rows());
    rows.extend(audited.encoder_rows());
    rows.extend(audited.limit_rows());
    rows.extend(audited.reference_rows());
    Audit { rows }
}

/// The longest run of samples in which the law follows the reference: all, without a supervisor.
fn tracked(trace: &Trace) -> Range<usize> {
    let Some(supervision) = &trace.supervision else { return 0..trace.len() };
    let mut best = 0..0;
    let mut begin = None;
    for k in 0..=trace.len() {
        let tracks = supervision.mode.get(k).is_some_and(|mode| *mode == Mode::Tracking);
        match (tracks, begin) {
            (true, None) => begin = Some(k),
            (false, Some(from)) => {
                if k - from > best.len() {
                    best = from..k;
                }
                begin = None;
            }
            _ => {}
        }
    }
    best
}
