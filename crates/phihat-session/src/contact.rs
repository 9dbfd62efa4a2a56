//! The watch over torques from outside, with the bounds of a certificate.

use std::path::Path;

use phihat_certificate::Tube;
use phihat_certificate::extremes::larger;
use phihat_design::Gains;
use phihat_report::RunInfo;
use phihat_sim::{ContactRecord, ContactRefusal, ContactWatch, Simulation, VelocityErrorBounds};
use phihat_study::{AfterContact, Study};

use crate::error::SessionError;
use crate::observer::class_in_force;

/// The watch that a study asks for, by the certificate of gains; `Ok(None)`: it asks for none.
///
/// # Errors
///
/// [`ContactRefusal`]: no bound on the velocity error, or an effect without a bound.
pub fn contact_watch(study: &Study, gains: &Gains) -> Result<Option<ContactWatch>, ContactRefusal> {
    if study.contact.is_none() {
        return Ok(None);
    }
    let bounds = velocity_error_bounds(study, gains).ok_or(ContactRefusal::NoVelocityBound)?;
    ContactWatch::new(study, bounds).map(Some)
}

/// A simulation with the watch that its study asks for. That nothing is watched is a warning, and an error where a stop
/// hangs on it.
#[inline(never)]
pub(crate) fn watched(
    simulation: Simulation,
    (study, gains): (&Study, &Gains),
    path: &Path,
    warnings: &mut Vec<String>,
) -> Result<Simulation, SessionError> {
    match contact_watch(study, gains) {
        Ok(watch) => Ok(simulation.watched(watch)),
        Err(why) if study.contact.is_some_and(|own| own.then == AfterContact::Stop) => {
            Err(SessionError::at(path, why))
        }
        Err(why) => {
            warnings.push(why.to_string());
            Ok(simulation)
        }
    }
}

/// Bounds on the velocity error of a study's runs by the certificate of its gains.
fn velocity_error_bounds(study: &Study, gains: &Gains) -> Option<VelocityErrorBounds> {
    if let Some(class) = class_in_force(study, gains) {
        let period = study.control.period_ns as f64 * 1e-9;
        let joints = class.torque_nm.iter().zip(&class.torque_step_nm).enumerate();
        let silent = joints.into_iter().all(|(i, (torque, step))| {
            let (most, rate) = study.limits(i);
            most.is_none_or(|most| *torque <= most)
                && rate.is_none_or(|rate| *step <= rate * period)
        });
        let bounds = class.velocity_error_bound_rad_s.clone();
        return Some(VelocityErrorBounds::constant(bounds, silent));
    }
    let certificate = gains.certificate.as_ref()?;
    let own = gains.study_sha256 == study.sha256;
    certificate.tube.as_ref().filter(|_| own).map(along)
}

/// Bounds of a tube, bin by bin.
fn along(tube: &Tube) -> VelocityErrorBounds {
    let joint = |own: &phihat_certificate::TubeJoint| {
        let ends = own.velocity_low_rad_s.iter().zip(&own.velocity_high_rad_s);
        ends.map(|(low, high)| larger(low.abs(), high.abs())).collect()
    };
    let bounds = tube.joints.iter().map(joint).collect();
    VelocityErrorBounds::along(tube.bin_s, bounds, tube.settle_s, tube.limits_silent)
}

/// The origin of a run with what was watched of it.
pub(crate) fn recorded(mut run: RunInfo, record: Option<Box<ContactRecord>>) -> RunInfo {
    let lines = record.iter().flat_map(|record| contact_lines(record));
    run.world.extend(lines.map(|line| ("from outside".to_owned(), line)));
    run.contact = record.map(|record| *record);
    run
}

/// Lines about contacts and payload.
pub fn contact_lines(record: &ContactRecord) -> Vec<String> {
    let ended = record
        .ended
        .as_ref()
        .map(|(t, why)| format!("contact is watched until t = {t:.3} s: {why}"));
    let events = record.events.iter().map(phihat_sim::ContactEvent::sentence);
    let payloads = record.payloads.iter().map(phihat_sim::PayloadEstimate::sentence);
    let none = record.events.is_empty().then(|| {
        format!("no contact: the model explains every torque ({} windows)", record.watched_samples)
    });
    let reach = record.reach.iter().map(phihat_sim::ContactReach::sentence);
    none.into_iter().chain(events).chain(ended).chain(payloads).chain(reach).collect()
}
