//! Reasons why bounds that gains carry say nothing of a run.

use phihat_design::{Certificate, Gains};

use crate::kit::text::key_in_words;

/// Reason why bounds that gains carry are no promise for a run of a study with this SHA-256, in which a supervisor
/// stopped the arm or did not.
pub(crate) fn no_promise(gains: &Gains, study_sha256: &str, stopped: bool) -> Option<String> {
    let left_out = |certificate: &Certificate| {
        let left_out = certificate
            .not_counted
            .iter()
            .filter(|one| !one.in_tube() && (stopped || !one.stops()));
        let mut keys: Vec<String> = left_out.map(|one| key_in_words(&one.key)).collect();
        keys.dedup();
        (!keys.is_empty()).then(|| format!("it does not count {}", keys.join(", ")))
    };
    let certificate = gains.certificate.as_ref()?;
    match certificate.refused() {
        _ if gains.study_sha256 != study_sha256 => Some("it was made for another study".to_owned()),
        Some(why) => Some(format!("the gains do not arm: {why}")),
        None => left_out(certificate),
    }
}
