//! Words of a bound and of a stop, the same in the terminal and on the page.

use phihat_design::Gains;
use phihat_sim::Metrics;

use crate::kit::text::line;
use crate::record::RunInfo;

/// Condition of every bound of a run whose contacts are watched: a push that is too small to be reported is not
/// counted either.
pub(crate) const UNTOUCHED: &str = "as long as nothing touches the arm";

/// Longest time from a contact to the stop that it asked for \[s\].
const ASKED_WITHIN_S: f64 = 0.02;

/// Motions that the bound of a run is about, and its condition: `, for any motion within ±0.3 rad, as long as nothing
/// touches the arm`; empty where it is about the motion of the run, in which nobody looks for contacts.
pub fn scope_of_bound(gains: Option<&Gains>, metrics: &Metrics, run: &RunInfo) -> String {
    let certificate = gains.and_then(|gains| gains.certificate.as_ref());
    let class = certificate.filter(|all| all.tube.is_none()).and_then(|all| all.class.as_deref());
    let slides: Vec<bool> = metrics.joints.iter().map(|joint| joint.slides).collect();
    let motions = class.map_or_else(String::new, |class| {
        format!(", for any motion within {}", class.limits_in_words(&slides))
    });
    match run.contact {
        Some(_) => format!("{motions}, {UNTOUCHED}"),
        None => motions,
    }
}

/// The stop of a run in a sentence without its full stop, with the contact that it followed; `None`: the supervisor did
/// not stop the arm.
pub fn stop_in_words(metrics: &Metrics, run: &RunInfo) -> Option<String> {
    let stopped = metrics.stopped.as_deref()?;
    let events = run.contact.iter().flat_map(|record| &record.events);
    let mut before = events.filter(|event| {
        (0.0..=ASKED_WITHIN_S).contains(&(stopped.t_s - event.t_s)) && stopped.fault.is_none()
    });
    let cause = before.next().map_or_else(String::new, |event| {
        format!("; it follows the contact at t = {:.3} s on {}", event.t_s, line(&event.joint))
    });
    Some(format!("{}{cause}", line(&stopped.sentence())))
}
