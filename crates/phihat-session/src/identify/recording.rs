//! A record of a real arm: a table of positions and torques.

use std::path::Path;

use phihat_design::RecordedJoint;

use crate::error::SessionError;
use crate::files;

/// A step between samples may differ by this share from the middle one.
const JITTER: f64 = 0.2;

/// The columns: what each may be called.
const COLUMNS: [&[&str]; 4] =
    [&["t_s"], &["joint"], &["q_rad", "q_measured_rad"], &["tau_nm", "tau_applied_nm"]];

/// Positions and torques of every joint at equal times.
pub(super) struct Recording {
    pub(super) period_ns: u64,
    pub(super) joints: Vec<RecordedJoint>,
}

/// Reads a record from `from` \[s\] after its first sample on: one row per sample and joint, columns by name in any order,
/// others left alone.
///
/// # Errors
///
/// [`SessionError::File`], with line, column, value and what would be valid.
pub(super) fn read(path: &Path, from: f64) -> Result<Recording, SessionError> {
    let refuse = |why: String| SessionError::at(path, why);
    let mut csv = csv::Reader::from_reader(files::open(path)?);
    let header = csv.headers().map_err(|e| refuse(e.to_string()))?.clone();
    let place = |names: &[&str]| {
        let found = header.iter().position(|column| names.contains(&column.trim()));
        found.ok_or_else(|| {
            let all = COLUMNS.map(|names| names.join(" or ")).join(", ");
            refuse(format!("line 1: there is no column {}; needed: {all}", names.join(" or ")))
        })
    };
    let [t, name, q, tau] = COLUMNS.map(place);
    let places = [t?, name?, q?, tau?];
    let (mut times, mut joints): (Vec<f64>, Vec<RecordedJoint>) = (Vec::new(), Vec::new());
    let mut first = None;
    for row in csv.records() {
        let row = row.map_err(|e| refuse(e.to_string()))?;
        let line = row.position().map_or(0, csv::Position::line);
        let text = |column: usize| row.get(places[column]).unwrap_or("").trim();
        let number = |column: usize| {
            let value: Option<f64> = text(column).parse().ok();
            value.filter(|x| x.is_finite()).ok_or_else(|| {
                let (name, found) = (COLUMNS[column][0], text(column));
                refuse(format!("line {line}: {name} is {found:?}; it must be a finite number"))
            })
        };
        let (t, q, tau) = (number(0)?, number(2)?, number(3)?);
        let begun = *first.get_or_insert(t);
        if t - begun < from {
            continue;
        }
        let at = joints.iter().position(|joint| joint.name == text(1)).unwrap_or(joints.len());
        if at == joints.len() {
            let name = text(1).to_owned();
            joints.push(RecordedJoint { name, q: Vec::new(), tau: Vec::new() });
        }
        if at == 0 {
            times.push(t);
        }
        joints[at].q.push(q);
        joints[at].tau.push(tau);
    }
    let Some(joint) = joints.iter().find(|joint| joint.q.len() != times.len()) else {
        let period_ns = period(path, &times)?;
        return Ok(Recording { period_ns, joints });
    };
    let (name, found, expected) = (&joint.name, joint.q.len(), times.len());
    let most = &joints[0].name;
    let rows = format!("joint {name} has {found} rows and joint {most} has {expected}");
    Err(refuse(format!("{rows}: each sample needs a row of every joint")))
}

/// Time between samples \[ns\].
fn period(path: &Path, times: &[f64]) -> Result<u64, SessionError> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let uneven = steps.clone();
    steps.sort_by(f64::total_cmp);
    let Some(middle) = steps.get(steps.len() / 2).copied().filter(|step| *step > 0.0) else {
        return Err(SessionError::at(path, "there are not two samples, one after the other"));
    };
    let off = |step: &f64| (step - middle).abs() > JITTER * middle;
    if let Some(k) = uneven.iter().position(off) {
        let (t, step) = (times[k], uneven[k]);
        let why = format!(
            "t_s = {t}: the next sample comes {step} s later, and samples are {middle} s apart"
        );
        return Err(SessionError::at(path, format!("{why}; cut the record there")));
    }
    // The whole span: single stamps are rounded.
    let span = times[times.len() - 1] - times[0];
    let period = 1e9 * span / (times.len() - 1) as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
    let period = period.round() as u64;
    Ok(period.max(1))
}
